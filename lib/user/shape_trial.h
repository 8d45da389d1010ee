/* A user's shape under trial: rays from all around, and what they met on the device. */
#ifndef SONJECT_USER_SHAPE_TRIAL_H
#define SONJECT_USER_SHAPE_TRIAL_H

#include "device/device.h"
#include "scene/user_shapes.h"
#include "user/shape_check.h"

/* In the shape's own frame, as the kernels ask: see sonject_user_shape_params. */
struct probe_ray {
    float point[3], direction[3];
    float nearest;
    float reserved;
};

/* As the code says it. */
struct probe_hit {
    float distance;
    float normal[3]; /* 0 where the distance is not finite */
};

struct shape_probe {
    struct report *report;
    struct device *device;
    device_kernel kernel;
    device_buffer shape;
};

/* On failure nothing is held. Errors: INPUT (code that does not compile), DEVICE, MEMORY. */
sonject_status shape_probe_begin(struct shape_probe *probe, struct report *report,
                                 struct device *device, const struct user_shapes *shapes,
                                 uint32_t number);
void shape_probe_end(struct shape_probe *probe);

/* Errors: DEVICE, MEMORY. */
sonject_status shape_probe_ask(struct shape_probe *probe, const struct probe_ray *rays,
                               struct probe_hit *hits, size_t count);

#define TRIAL_NEIGHBOURS 8    /* of each ray, at most */
#define TRIAL_GRAZING    0.05 /* cosine of incidence below which sides are not judged */

/* A ray that met the shape. */
struct meeting {
    double offset[3], direction[3]; /* of the ray: its point is the offset */
    double distance;
    double point[3], normal[3]; /* unit */
};

struct trial {
    struct report *report; /* borrowed */
    struct shape_probe probe;
    const char *name;
    bool is_open;
    double radius;        /* of the bounding sphere, m */
    double half_sizes[3]; /* of the box, m */
    struct meeting *meetings;
    size_t count;
    struct probe_ray *rays; /* room for TRIAL_NEIGHBOURS rays for each of SHAPE_CHECK_RAYS */
    struct probe_hit *hits;
    uint64_t random;
};

/* Rays from all around; keeps those that meet the shape. Errors: INPUT (distances or normals that
 * are none, surfaces outside the bounding sphere or before `nearest`, nothing met), DEVICE, MEMORY.
 */
sonject_status trial_shoot(struct trial *trial);

/* Normals at the meetings against finite differences. Errors: INPUT (see shape_check.h), DEVICE,
 * MEMORY. */
sonject_status trial_compare_normals(struct trial *trial, struct shape_check *check);

/* Asks for the first count of trial->rays. Errors: DEVICE, MEMORY. */
sonject_status trial_ask(struct trial *trial, size_t count);

/* "name: what"; returns INPUT. */
sonject_status trial_refuse(const struct trial *trial, const char *what);

/* Whether more than SHAPE_CHECK_SHARE of count are wrong. */
bool trial_is_too_many(size_t wrong, size_t count);

void probe_ray_set(struct probe_ray *ray, const double point[3], const double direction[3],
                   double nearest);
bool probe_hit_is_met(const struct probe_hit *hit);

/* Two unit vectors across a direction. */
void find_across(const double direction[3], double u[3], double v[3]);

double dot_product(const double a[3], const double b[3]);
void cross_product(double c[3], const double a[3], const double b[3]);

#endif
