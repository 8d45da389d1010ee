/* Impulses from rays. */
#ifndef SONJECT_INJECT_TRACED_IMPULSES_H
#define SONJECT_INJECT_TRACED_IMPULSES_H

#include "inject/echoes.h"
#include "inject/impulses.h"

/* Traces the patch and hands out its impulses as they come; a chunk of strips is held at a time. Of
 * the request it takes map, field and progress. Errors: INPUT, DEVICE, MEMORY, CANCELLED, and the
 * sink's own. */
sonject_status trace_impulses(struct tracer *tracer, const struct echo_request *request,
                              const struct impulse_sink *sink);

/* The same as a source. */
struct impulse_source traced_impulses(void);

#endif
