/* Spheres that hold the targets: what rays from the seabed are led to. */
#ifndef SONJECT_TRACE_TARGET_SPHERES_H
#define SONJECT_TRACE_TARGET_SPHERES_H

#include "trace/tracer.h"

#define TARGET_SPHERES_MAX 256 /* as kernels/target_cones.h has it */

/* Covers every object with a row of spheres along its length, about as many as it is times longer
 * than wide (fewer when there are many objects, at least one). Spheres wholly below the seabed are
 * left out. records: room for TARGET_SPHERES_MAX. Returns their number. */
uint32_t target_spheres_init(struct sphere_record *records, const struct tracer *tracer,
                             const double origin[3]);

#endif
