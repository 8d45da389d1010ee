/* Random rays in double precision and as the kernels get them. */
#ifndef SONJECT_TESTS_RANDOM_RAYS_H
#define SONJECT_TESTS_RANDOM_RAYS_H

#include <math.h>
#include <stdint.h>

#include "intersection.h"

struct point {
    double x, y, z;
};

static uint64_t generator = 88172645463325252u;

static inline double uniform(double low, double high)
{
    generator ^= generator << 13;
    generator ^= generator >> 7;
    generator ^= generator << 17;
    return low + (high - low) * ((double)(generator >> 11) + 0.5) / 9007199254740992.0;
}

static inline struct point add(struct point a, struct point b, double t)
{
    const struct point sum = {a.x + b.x * t, a.y + b.y * t, a.z + b.z * t};
    return sum;
}

static inline double dot(struct point a, struct point b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct point scaled(struct point a, double factor)
{
    const struct point result = {a.x * factor, a.y * factor, a.z * factor};
    return result;
}

static inline struct point random_direction(void)
{
    for (;;) {
        const struct point p = {uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)};
        const double square = dot(p, p);
        if (square > 1e-4 && square < 1.0)
            return scaled(p, 1.0 / sqrt(square));
    }
}

static inline struct point turned(const struct object_record *object, struct point v)
{
    const float *a = object->axes;
    const struct point result = {v.x * a[0] + v.y * a[1] + v.z * a[2],
                                 v.x * a[3] + v.y * a[4] + v.z * a[5],
                                 v.x * a[6] + v.y * a[7] + v.z * a[8]};
    return result;
}

static inline struct point turned_back(const struct object_record *object, struct point v)
{
    const float *a = object->axes;
    const struct point result = {v.x * a[0] + v.y * a[3] + v.z * a[6],
                                 v.x * a[1] + v.y * a[4] + v.z * a[7],
                                 v.x * a[2] + v.y * a[5] + v.z * a[8]};
    return result;
}

/* A ray as the kernel gets it, and the very same numbers in double. */
struct ray {
    struct vector3 p, d;
    struct point origin, direction;
};

static inline struct ray ray_of(struct point closest, struct point way)
{
    struct ray ray;
    ray.p = (struct vector3){(float)closest.x, (float)closest.y, (float)closest.z};
    ray.d = (struct vector3){(float)way.x, (float)way.y, (float)way.z};
    ray.origin = (struct point){ray.p.x, ray.p.y, ray.p.z};
    ray.direction = (struct point){ray.d.x, ray.d.y, ray.d.z};
    return ray;
}

/* Returns a ray towards a target from a sonar `range` away from the frame's origin, at a random
 * depression. The ray counts from its point closest to the origin. */
static inline struct ray ray_towards(struct point target, double range)
{
    const double depression = uniform(0.02, 1.5);
    const double x = target.x + uniform(-0.2, 0.2);
    const struct point sonar = {x, -range * cos(depression), range * sin(depression)};
    struct point way = add(target, sonar, -1.0);
    way = scaled(way, 1.0 / sqrt(dot(way, way)));
    return ray_of(add(sonar, way, -dot(sonar, way)), way);
}

#endif
