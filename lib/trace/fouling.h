/* The random fields of what grows on objects, as the kernels know them. */
#ifndef SONJECT_TRACE_FOULING_H
#define SONJECT_TRACE_FOULING_H

#include "trace/tracer.h"

/* Whether anything grows on an object of the scene. */
bool object_is_fouled(const struct tracer *tracer, uint32_t object);

/* The waves of a part of a fouled object, in the axes of the view: as the scene's seed, the
 * object's number and where the part is in it say. */
void fouling_record_init(struct fouling_record *record, const struct tracer *tracer,
                         const struct placement *part);

/* By how much fouling may brighten what a part scatters; 1 where there is none. */
double fouling_brightest(const struct tracer *tracer, uint32_t part);

#endif
