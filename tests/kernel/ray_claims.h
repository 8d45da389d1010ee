/* What holds for any object's rays. */
#ifndef SONJECT_TESTS_RAY_CLAIMS_H
#define SONJECT_TESTS_RAY_CLAIMS_H

#include "claims.h"
#include "lanes.h"
#include "random_rays.h"

/* Lanes of native C give the bits of one. */
static inline void expect_same_in_all_lanes(const struct object_record *object,
                                            const struct ray single[LANES], float minimum)
{
    float rays[6][LANES], distance[LANES], normal[3][LANES];
    for (int lane = 0; lane < LANES; lane++) {
        const struct vector3 p = single[lane].p, d = single[lane].d;
        const float values[6] = {p.x, p.y, p.z, d.x, d.y, d.z};
        for (int k = 0; k < 6; k++)
            rays[k][lane] = values[k];
    }
    lanes_hit(object, rays, minimum, distance, normal);
    for (int lane = 0; lane < LANES; lane++) {
        const float alone = object_distance(object, single[lane].p, single[lane].d, minimum);
        assert_memory_equal(&alone, &distance[lane], sizeof alone);
        if (alone > 0.5f * FAR_AWAY)
            continue;
        const struct vector3 n = object_normal(object, single[lane].p, single[lane].d, alone);
        assert_memory_equal(&n.x, &normal[0][lane], sizeof n.x);
        assert_memory_equal(&n.y, &normal[1][lane], sizeof n.y);
        assert_memory_equal(&n.z, &normal[2][lane], sizeof n.z);
    }
}

/* Whether a way from where a ray meets a convex object, straight back or any, started as far off
 * the surface as the tracer does (2e-5 m), meets it again; -1: it does not lead outwards, or
 * nothing is met. */
static inline int meets_itself(const struct object_record *object, const struct ray *ray,
                               bool is_straight_back)
{
    const float distance = object_distance(object, ray->p, ray->d, -200.0f);
    if (distance > 0.5f * FAR_AWAY)
        return -1;
    const struct vector3 n = object_normal(object, ray->p, ray->d, distance);
    const struct vector3 start = along3(along3(ray->p, ray->d, distance), n, 2.0e-5f);
    const struct point back = is_straight_back ? scaled(ray->direction, -1.0) : random_direction();
    const struct vector3 way = {(float)back.x, (float)back.y, (float)back.z};
    return dot3(way, n) <= 0.0f ? -1 : object_distance(object, start, way, 0.0f) < 0.5f * FAR_AWAY;
}

#endif
