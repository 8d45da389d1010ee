/* The kernels' sources, flattened at build time (embed.py) so that no file is needed at run time.
 */
#ifndef SONJECT_CL_SOURCES_H
#define SONJECT_CL_SOURCES_H

#include <stddef.h>

struct embedded_source {
    const char *name;
    const char *text; /* terminated */
    size_t bytes;     /* without the terminator */
};

/* In the order of enum device_program. */
extern const struct embedded_source embedded_sources[];

#endif
