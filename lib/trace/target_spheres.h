/* Spheres that hold the targets: what rays from the seabed are led to. */
#ifndef SONJECT_TRACE_TARGET_SPHERES_H
#define SONJECT_TRACE_TARGET_SPHERES_H

#include "trace/tracer.h"

/* Spheres, and behind them the groups that they lie in where they are many. */
struct target_spheres {
    struct sphere_record *records; /* owned; count, then the groups, then those around groups */
    uint32_t count, groups;        /* groups 0: few spheres */
    size_t bytes;                  /* of all */
};

/* Covers every part with a row of spheres along its length, about as many as it is times longer
 * than wide (fewer when there are many parts, at least one). Spheres wholly below the seabed are
 * left out. Errors: MEMORY; on failure *spheres is
 * empty. */
sonject_status target_spheres_init(struct target_spheres *spheres, const struct tracer *tracer,
                                   const double origin[3]);
void target_spheres_clear(struct target_spheres *spheres);

#endif
