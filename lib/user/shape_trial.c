#include "user/shape_trial.h"

#include <math.h>
#include <string.h>

#include "device/device.h"
#include "user/user_program.h"

#define PI      3.14159265358979323846
#define DISC    1.3    /* radii about the origin that rays pass within */
#define OUTSIDE 1.0001 /* radii: beyond, for the rounding of what lies on the sphere */

sonject_status shape_probe_begin(struct shape_probe *probe, struct report *report,
                                 struct device *device, const struct user_shapes *shapes,
                                 uint32_t number)
{
    const struct user_record record = user_record_of(&shapes->shapes[number]);
    memset(probe, 0, sizeof *probe);
    probe->report = report;
    probe->device = device;
    sonject_status status =
        user_kernel_create(report, device, shapes, false, PROGRAM_PROBE_USER_SHAPE,
                           "probe_user_shape", &probe->kernel);
    THEN(status, buffer_create(report, device, sizeof record, &record, &probe->shape));
    if (status != SONJECT_OK)
        shape_probe_end(probe);
    return status;
}

void shape_probe_end(struct shape_probe *probe)
{
    kernel_release(&probe->kernel);
    buffer_release(&probe->shape);
}

sonject_status shape_probe_ask(struct shape_probe *probe, const struct probe_ray *rays,
                               struct probe_hit *hits, size_t count)
{
    struct report *report = probe->report;
    struct device *device = probe->device;
    device_buffer ray_buffer = NULL;
    device_buffer hit_buffer = NULL;
    if (count == 0)
        return SONJECT_OK;
    sonject_status status = buffer_create(report, device, count * sizeof *rays, rays, &ray_buffer);
    THEN(status, buffer_create(report, device, count * sizeof *hits, NULL, &hit_buffer));
    if (status == SONJECT_OK) {
        const struct kernel_argument arguments[] = {{sizeof probe->shape, &probe->shape},
                                                    {sizeof ray_buffer, &ray_buffer},
                                                    {sizeof hit_buffer, &hit_buffer}};
        status = kernel_run(report, device, probe->kernel, arguments, 3, 1, &count);
    }
    THEN(status, buffer_read(report, device, hit_buffer, 0, count * sizeof *hits, hits));
    buffer_release(&ray_buffer);
    buffer_release(&hit_buffer);
    return status;
}

static const char *const box_keys[3] = {"half_length", "half_width", "half_height"};

double dot_product(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void cross_product(double c[3], const double a[3], const double b[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* 0...1; the generator is Steele, Lea and Flood's SplitMix64. */
static double next_random(struct trial *trial)
{
    uint64_t z = trial->random += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

void find_across(const double direction[3], double u[3], double v[3])
{
    const double helper[3] = {fabs(direction[0]) < 0.6, fabs(direction[0]) >= 0.6, 0.0};
    cross_product(u, direction, helper);
    const double length = sqrt(dot_product(u, u));
    for (int k = 0; k < 3; k++)
        u[k] /= length;
    cross_product(v, direction, u);
}

void probe_ray_set(struct probe_ray *ray, const double point[3], const double direction[3],
                   double nearest)
{
    for (int k = 0; k < 3; k++) {
        ray->point[k] = (float)point[k];
        ray->direction[k] = (float)direction[k];
    }
    ray->nearest = (float)nearest;
    ray->reserved = 0.0f;
}

bool probe_hit_is_met(const struct probe_hit *hit)
{
    return isfinite(hit->distance) && fabsf(hit->distance) < 1e30f;
}

sonject_status trial_ask(struct trial *trial, size_t count)
{
    return shape_probe_ask(&trial->probe, trial->rays, trial->hits, count);
}

sonject_status trial_refuse(const struct trial *trial, const char *what)
{
    return report_failure(trial->report, SONJECT_ERROR_INPUT, "%s: %s", trial->name, what);
}

bool trial_is_too_many(size_t wrong, size_t count)
{
    return (double)wrong > SHAPE_CHECK_SHARE * (double)count;
}

/* A random ray, past the origin at less than DISC radii. */
static void draw_ray(struct trial *trial, struct meeting *ray)
{
    double u[3], v[3];
    const double z = 2.0 * next_random(trial) - 1.0;
    const double turn = 2.0 * PI * next_random(trial);
    const double away = DISC * trial->radius * sqrt(next_random(trial));
    const double around = 2.0 * PI * next_random(trial);
    ray->direction[0] = sqrt(1.0 - z * z) * cos(turn);
    ray->direction[1] = sqrt(1.0 - z * z) * sin(turn);
    ray->direction[2] = z;
    find_across(ray->direction, u, v);
    for (int k = 0; k < 3; k++)
        ray->offset[k] = away * (cos(around) * u[k] + sin(around) * v[k]);
}

/* Takes what a ray met; the normal is made a unit vector, on the ray's side if the shape is open.
 */
static sonject_status copy_meeting(const struct trial *trial, struct meeting *ray,
                                   const struct probe_hit *hit)
{
    double largest = 0.0;
    ray->distance = hit->distance;
    for (int k = 0; k < 3; k++) {
        ray->point[k] = ray->offset[k] + ray->distance * ray->direction[k];
        ray->normal[k] = hit->normal[k];
        largest = fmax(largest, fabs(ray->normal[k]));
        if (!isfinite(ray->normal[k]))
            return trial_refuse(trial, "shape_normal gives what is not a finite number");
    }
    if (dot_product(ray->point, ray->point) > pow(OUTSIDE * trial->radius, 2.0))
        return report_failure(trial->report, SONJECT_ERROR_INPUT,
                              "%s: a ray meets the shape %g m from its origin, beyond the "
                              "bounding_radius of %g m; make that larger",
                              trial->name, sqrt(dot_product(ray->point, ray->point)),
                              trial->radius);
    for (int k = 0; k < 3; k++)
        if (fabs(ray->point[k]) > trial->half_sizes[k] + (OUTSIDE - 1.0) * trial->radius)
            return report_failure(trial->report, SONJECT_ERROR_INPUT,
                                  "%s: a ray meets the shape %g m from its middle, beyond the "
                                  "%s of %g m; make that larger",
                                  trial->name, fabs(ray->point[k]), box_keys[k],
                                  trial->half_sizes[k]);
    if (!(largest > 0.0))
        return trial_refuse(trial, "shape_normal gives a normal of length 0");
    for (int k = 0; k < 3; k++)
        ray->normal[k] /= largest;
    double length = sqrt(dot_product(ray->normal, ray->normal));
    if (trial->is_open && dot_product(ray->normal, ray->direction) > 0.0)
        length = -length;
    for (int k = 0; k < 3; k++)
        ray->normal[k] /= length;
    return SONJECT_OK;
}

sonject_status trial_shoot(struct trial *trial)
{
    const double nearest = -(1.0 + 1e-6) * trial->radius;
    for (size_t i = 0; i < SHAPE_CHECK_RAYS; i++) {
        draw_ray(trial, &trial->meetings[i]);
        probe_ray_set(&trial->rays[i], trial->meetings[i].offset, trial->meetings[i].direction,
                      nearest);
    }
    sonject_status status = trial_ask(trial, SHAPE_CHECK_RAYS);
    for (size_t i = 0; status == SONJECT_OK && i < SHAPE_CHECK_RAYS; i++) {
        const struct probe_hit *hit = &trial->hits[i];
        if (isnan(hit->distance))
            return trial_refuse(trial, "shape_distance gives what is not a number");
        if (!probe_hit_is_met(hit))
            continue;
        if (!(hit->distance > trial->rays[i].nearest))
            return report_failure(trial->report, SONJECT_ERROR_INPUT,
                                  "%s: shape_distance gives %g m where the nearest that is asked "
                                  "for is %g m; give the first surface beyond it, or INFINITY",
                                  trial->name, (double)hit->distance,
                                  (double)trial->rays[i].nearest);
        struct meeting *met = &trial->meetings[trial->count];
        *met = trial->meetings[i];
        status = copy_meeting(trial, met, hit);
        trial->count++;
    }
    if (status == SONJECT_OK && trial->count == 0)
        return report_failure(trial->report, SONJECT_ERROR_INPUT,
                              "%s: none of %d rays through the bounding sphere meets the shape",
                              trial->name, SHAPE_CHECK_RAYS);
    return status;
}
