/* Whether a user's shape keeps its contract (sonject/user_shape.h), tried with rays, and the
 * probe on the device that asks it. */
#ifndef SONJECT_USER_SHAPE_CHECK_H
#define SONJECT_USER_SHAPE_CHECK_H

#include "device/device.h"
#include "scene/scene.h"

#define SHAPE_CHECK_RAYS 4096 /* always the same ones, in radii of the bounding sphere */

/* Normals are compared with the plane through what four parallel rays 1/500 of the radius away
 * meet, where that holds: not where ray and surface make less than 12 deg, and not at edges, where
 * the four do not lie on one plane, or where rays half as far away give another one. Refused are
 * shapes of which half of the normals are off by more than 1 deg, or one in a hundred by more than
 * 3 deg. */
#define SHAPE_CHECK_MEDIAN_DEG 1.0
#define SHAPE_CHECK_ANGLE_DEG  3.0
#define SHAPE_CHECK_SHARE      0.01 /* of rays that may break a rule: at edges, grazing */

struct shape_check {
    size_t hits;
    size_t compared; /* normals */
    double median_deg, largest_deg;
    size_t restarts; /* rays that go on from hits as echoes do */
    size_t acne;     /* restarts that meet the surface they come from */
};

/* Errors: INPUT (what the shape does wrong, or its code does not compile), DEVICE, MEMORY. */
sonject_status shape_check_run(struct report *report, struct device *device,
                               const struct user_shapes *shapes, uint32_t number,
                               struct shape_check *check);

#endif
