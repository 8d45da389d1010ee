/* How many spheres around targets there may be; host and device agree. */
#ifndef SONJECT_KERNELS_TARGET_NUMBERS_H
#define SONJECT_KERNELS_TARGET_NUMBERS_H

#define FEW_SPHERES_MAX    128 /* more lie in groups (many_targets.h) */
#define SPHERES_OF_GROUP   16
#define TARGET_SPHERES_MAX 1280
#define TARGET_GROUPS_MAX  (TARGET_SPHERES_MAX / SPHERES_OF_GROUP)

#endif
