/* Sound from a source to one object. */
#ifndef SONJECT_TRACE_OBJECT_RAYS_H
#define SONJECT_TRACE_OBJECT_RAYS_H

#include "trace/tracer.h"

/* Elevations that an object fills as seen on a way, from the direction of its centre; a little more
 * than that. */
struct elevations elevations_of_object(const struct tracer *tracer, uint32_t object,
                                       const struct water_way *way);

/* Appends the rays of a way to an object in the object's frame. Errors: as ray_table_add. */
sonject_status object_rays_add(struct ray_table *rays, const struct tracer *tracer, uint32_t object,
                               const struct water_way *way, struct ray_table_record *record);

#endif
