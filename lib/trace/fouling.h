/* The random fields of what grows on objects, as the kernels know them. */
#ifndef SONJECT_TRACE_FOULING_H
#define SONJECT_TRACE_FOULING_H

#include "trace/tracer.h"

/* Returns whether anything grows on an object of the scene. */
bool object_is_fouled(const struct tracer *tracer, uint32_t object);

/* Fills in the waves of a part of a fouled object, in the axes of the view. The scene's seed, the
 * object's number and the part's place in the object determine the waves. */
void fouling_record_init(struct fouling_record *record, const struct tracer *tracer,
                         const struct placement *part);

/* Returns the largest factor by which fouling brightens what a part scatters; 1 without fouling. */
double fouling_brightest(const struct tracer *tracer, uint32_t part);

#endif
