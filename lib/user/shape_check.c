/* Rays from all around meet the shape on the device; what they met is judged. */
#include "user/shape_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "user/snippet.h"

#define PI         3.14159265358979323846
#define STEP       2e-3   /* radii, from a ray to its neighbours; then half of it */
#define STEEP      0.2    /* least cosine of incidence where normals are compared */
#define BEND       0.1    /* of the neighbours' plane, over their distance */
#define AGREE_RAD  8.7e-3 /* half a degree */
#define OFF_M      2.0e-5 /* start_from of kernels/chain_hit.h */
#define AGAIN      1e-3   /* radii before a hit that is looked for again */
#define SAME       1e-4   /* radii */
#define DISC       1.3    /* radii about the origin that rays pass within */
#define OUTSIDE    1.0001 /* radii: beyond, for the rounding of what lies on the sphere */
#define NEIGHBOURS 8      /* of each ray, at most */
#define GRAZING    0.05   /* cosine of incidence below which sides are not judged */

/* In the shape's own frame, as the kernels ask: see sonject/user_shape.h. */
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
    struct probe_ray *rays; /* room for NEIGHBOURS rays for each of SHAPE_CHECK_RAYS */
    struct probe_hit *hits;
    uint64_t random;
};

/* "name: what", with arguments; INPUT. */
#define REFUSE(trial, what, ...)                                                                   \
    report_failure((trial)->report, SONJECT_ERROR_INPUT, "%s: " what, (trial)->name, __VA_ARGS__)

static void shape_probe_end(struct shape_probe *probe)
{
    kernel_release(probe->device, &probe->kernel);
    buffer_release(probe->device, &probe->shape);
}

static sonject_status shape_probe_begin(struct shape_probe *probe, struct report *report,
                                        struct device *device, const struct user_shapes *shapes,
                                        uint32_t number)
{
    const struct user_record record = user_record_of(&shapes->shapes[number]);
    memset(probe, 0, sizeof *probe);
    probe->report = report;
    probe->device = device;
    sonject_status status =
        user_kernel_create(report, device, shapes, PROGRAM_FULL, PROGRAM_PROBE_USER_SHAPE,
                           "probe_user_shape", &probe->kernel);
    THEN(status, buffer_create(report, device, sizeof record, &record, &probe->shape));
    if (status != SONJECT_OK)
        shape_probe_end(probe);
    return status;
}

static sonject_status shape_probe_ask(struct shape_probe *probe, const struct probe_ray *rays,
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
    buffer_release(probe->device, &ray_buffer);
    buffer_release(probe->device, &hit_buffer);
    return status;
}

static const char *const box_keys[3] = {"half_length", "half_width", "half_height"};

static double dot_product(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross_product(double c[3], const double a[3], const double b[3])
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

static void find_across(const double direction[3], double u[3], double v[3])
{
    const double helper[3] = {fabs(direction[0]) < 0.6, fabs(direction[0]) >= 0.6, 0.0};
    cross_product(u, direction, helper);
    const double length = sqrt(dot_product(u, u));
    for (int k = 0; k < 3; k++)
        u[k] /= length;
    cross_product(v, direction, u);
}

static void set_ray(struct probe_ray *ray, const double point[3], const double direction[3],
                    double nearest)
{
    for (int k = 0; k < 3; k++) {
        ray->point[k] = (float)point[k];
        ray->direction[k] = (float)direction[k];
    }
    ray->nearest = (float)nearest;
    ray->reserved = 0.0f;
}

static bool is_met(const struct probe_hit *hit)
{
    return isfinite(hit->distance) && fabsf(hit->distance) < 1e30f;
}

static sonject_status ask(struct trial *trial, size_t count)
{
    return shape_probe_ask(&trial->probe, trial->rays, trial->hits, count);
}

static bool is_too_many(size_t wrong, size_t count)
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
            return REFUSE(trial, "%s", "shape_normal gives what is not a finite number");
    }
    if (dot_product(ray->point, ray->point) > pow(OUTSIDE * trial->radius, 2.0))
        return REFUSE(trial,
                      "a ray meets the shape %g m from its origin, beyond the "
                      "bounding_radius of %g m; make that larger",
                      sqrt(dot_product(ray->point, ray->point)), trial->radius);
    for (int k = 0; k < 3; k++)
        if (fabs(ray->point[k]) > trial->half_sizes[k] + (OUTSIDE - 1.0) * trial->radius)
            return REFUSE(trial,
                          "a ray meets the shape %g m from its middle, beyond the "
                          "%s of %g m; make that larger",
                          fabs(ray->point[k]), box_keys[k], trial->half_sizes[k]);
    if (!(largest > 0.0))
        return REFUSE(trial, "%s", "shape_normal gives a normal of length 0");
    for (int k = 0; k < 3; k++)
        ray->normal[k] /= largest;
    double length = sqrt(dot_product(ray->normal, ray->normal));
    if (trial->is_open && dot_product(ray->normal, ray->direction) > 0.0)
        length = -length;
    for (int k = 0; k < 3; k++)
        ray->normal[k] /= length;
    return SONJECT_OK;
}

static sonject_status shoot(struct trial *trial)
{
    const double nearest = -(1.0 + 1e-6) * trial->radius;
    for (size_t i = 0; i < SHAPE_CHECK_RAYS; i++) {
        draw_ray(trial, &trial->meetings[i]);
        set_ray(&trial->rays[i], trial->meetings[i].offset, trial->meetings[i].direction, nearest);
    }
    sonject_status status = ask(trial, SHAPE_CHECK_RAYS);
    for (size_t i = 0; status == SONJECT_OK && i < SHAPE_CHECK_RAYS; i++) {
        const struct probe_hit *hit = &trial->hits[i];
        if (isnan(hit->distance))
            return REFUSE(trial, "%s", "shape_distance gives what is not a number");
        if (!is_met(hit))
            continue;
        if (!(hit->distance > trial->rays[i].nearest))
            return REFUSE(trial,
                          "shape_distance gives %g m where the nearest that is asked "
                          "for is %g m; give the first surface beyond it, or INFINITY",
                          (double)hit->distance, (double)trial->rays[i].nearest);
        struct meeting *met = &trial->meetings[trial->count];
        *met = trial->meetings[i];
        status = copy_meeting(trial, met, hit);
        trial->count++;
    }
    if (status == SONJECT_OK && trial->count == 0)
        return REFUSE(trial, "none of %d rays through the bounding sphere meets the shape",
                      SHAPE_CHECK_RAYS);
    return status;
}

static double angle_between(const double a[3], const double b[3])
{
    double c[3];
    cross_product(c, a, b);
    return atan2(sqrt(dot_product(c, c)), dot_product(a, b));
}

/* Normal of the plane through four neighbours; false where they are not on one. */
static bool plane_through(const struct meeting *met, const struct probe_ray *rays,
                          const struct probe_hit *hits, double normal[3])
{
    double across[2][3];
    for (int pair = 0; pair < 2; pair++) {
        double bend[3];
        for (int k = 0; k < 3; k++) {
            double ends[2];
            for (int end = 0; end < 2; end++) {
                const size_t i = (size_t)(2 * pair + end);
                if (!is_met(&hits[i]))
                    return false;
                ends[end] = rays[i].point[k] + (double)hits[i].distance * met->direction[k];
            }
            across[pair][k] = ends[0] - ends[1];
            bend[k] = ends[0] + ends[1] - 2.0 * met->point[k];
        }
        if (dot_product(bend, bend) > BEND * BEND * dot_product(across[pair], across[pair]))
            return false;
    }
    cross_product(normal, across[0], across[1]);
    const double length = sqrt(dot_product(normal, normal));
    const double side = dot_product(normal, met->direction) > 0.0 ? -length : length;
    for (int k = 0; k < 3; k++)
        normal[k] /= side;
    return -dot_product(normal, met->direction) > STEEP;
}

static void set_neighbours(const struct trial *trial, const struct meeting *met,
                           struct probe_ray *rays)
{
    const double nearest = -(1.0 + 1e-6) * trial->radius;
    double across[2][3];
    find_across(met->direction, across[0], across[1]);
    for (int i = 0; i < NEIGHBOURS; i++) {
        const double step = (i < 4 ? STEP : 0.5 * STEP) * trial->radius * (i % 2 == 0 ? 1.0 : -1.0);
        double point[3];
        for (int k = 0; k < 3; k++)
            point[k] = met->offset[k] + step * across[i / 2 % 2][k];
        set_ray(&rays[i], point, met->direction, nearest);
    }
}

static sonject_status judge_angles(const struct trial *trial, double *angles,
                                   struct shape_check *check)
{
    if (check->compared == 0)
        return SONJECT_OK;
    qsort(angles, check->compared, sizeof *angles, compare_doubles);
    size_t far_off = 0;
    for (size_t i = 0; i < check->compared; i++)
        far_off += angles[i] > SHAPE_CHECK_ANGLE_DEG;
    check->median_deg = angles[check->compared / 2];
    check->largest_deg = angles[check->compared - 1];
    if (check->median_deg <= SHAPE_CHECK_MEDIAN_DEG && !is_too_many(far_off, check->compared))
        return SONJECT_OK;
    return REFUSE(trial,
                  "shape_normal is not the normal of what shape_distance gives: off by "
                  "%.3g deg in the median, %.3g deg at most; %zu of %zu by more than %g "
                  "deg",
                  check->median_deg, check->largest_deg, far_off, check->compared,
                  SHAPE_CHECK_ANGLE_DEG);
}

static sonject_status compare_normals(struct trial *trial, struct shape_check *check)
{
    double *angles = allocate_array(trial->count, sizeof *angles);
    CHECK_MEMORY(trial->report, angles, "the check of a shape");
    for (size_t i = 0; i < trial->count; i++)
        set_neighbours(trial, &trial->meetings[i], &trial->rays[NEIGHBOURS * i]);
    sonject_status status = ask(trial, NEIGHBOURS * trial->count);
    for (size_t i = 0; status == SONJECT_OK && i < trial->count; i++) {
        const struct meeting *met = &trial->meetings[i];
        const size_t first = NEIGHBOURS * i;
        double wide[3], narrow[3];
        if (plane_through(met, &trial->rays[first], &trial->hits[first], wide) &&
            plane_through(met, &trial->rays[first + 4], &trial->hits[first + 4], narrow) &&
            angle_between(wide, narrow) < AGREE_RAD)
            angles[check->compared++] = angle_between(met->normal, narrow) * 180.0 / PI;
    }
    THEN(status, judge_angles(trial, angles, check));
    free(angles);
    return status;
}

/* From outside, a ray first meets an outer side. */
static sonject_status check_sides(const struct trial *trial)
{
    size_t wrong = 0;
    for (size_t i = 0; i < trial->count; i++)
        wrong += dot_product(trial->meetings[i].normal, trial->meetings[i].direction) > GRAZING;
    if (trial->is_open || !is_too_many(wrong, trial->count))
        return SONJECT_OK;
    return REFUSE(trial,
                  "%zu of %zu normals point away from the ray where it first meets the "
                  "shape: they must point out of the solid (or let the shape be open)",
                  wrong, trial->count);
}

/* The same surface from just before it; and of a solid, an inner side behind it. */
static sonject_status check_nearest(struct trial *trial)
{
    size_t lost = 0;
    size_t inner = 0;
    for (size_t i = 0; i < trial->count; i++) {
        const struct meeting *met = &trial->meetings[i];
        set_ray(&trial->rays[2 * i], met->offset, met->direction,
                fmax(met->distance - AGAIN * trial->radius, -trial->radius));
        set_ray(&trial->rays[2 * i + 1], met->offset, met->direction, met->distance + OFF_M);
    }
    CHECK(ask(trial, 2 * trial->count));
    for (size_t i = 0; i < trial->count; i++) {
        const struct meeting *met = &trial->meetings[i];
        const struct probe_hit *again = &trial->hits[2 * i];
        const struct probe_hit *behind = &trial->hits[2 * i + 1];
        const double way[3] = {behind->normal[0], behind->normal[1], behind->normal[2]};
        lost += !is_met(again) || fabs(again->distance - met->distance) > SAME * trial->radius;
        if (is_met(behind) && !(behind->distance > trial->rays[2 * i + 1].nearest))
            return REFUSE(trial, "%s",
                          "shape_distance gives a surface that is not beyond `nearest`");
        inner += !trial->is_open && -dot_product(met->normal, met->direction) > GRAZING &&
                 !(is_met(behind) && dot_product(way, met->direction) > 0.0);
    }
    if (is_too_many(lost, trial->count))
        return REFUSE(trial,
                      "%zu of %zu surfaces are not found again by the same ray from "
                      "just before them; `nearest` must only leave out what lies before it",
                      lost, trial->count);
    if (is_too_many(inner, trial->count))
        return REFUSE(trial,
                      "%zu of %zu rays that enter the solid do not next meet its inner "
                      "side: distances are not good to 20 um, or the surface is not closed "
                      "(then let the shape be open)",
                      inner, trial->count);
    return SONJECT_OK;
}

/* Rays go on in the specular direction from just off the surface: what they meet first is not an
 * inner side, nor, of an open shape, the place that they come from. */
static sonject_status check_restarts(struct trial *trial, struct shape_check *check)
{
    for (size_t i = 0; i < trial->count; i++) {
        struct meeting *met = &trial->meetings[i];
        const double cosine = dot_product(met->normal, met->direction);
        double start[3];
        if (-cosine < GRAZING)
            continue;
        for (int k = 0; k < 3; k++) {
            start[k] = met->point[k] + OFF_M * met->normal[k];
            met->direction[k] -= 2.0 * cosine * met->normal[k];
        }
        met->distance = dot_product(start, met->direction);
        if (met->distance >= trial->radius)
            continue;
        for (int k = 0; k < 3; k++)
            start[k] -= met->distance * met->direction[k];
        set_ray(&trial->rays[check->restarts], start, met->direction,
                fmax(met->distance, -trial->radius));
        check->restarts++;
    }
    CHECK(ask(trial, check->restarts));
    for (size_t i = 0; i < check->restarts; i++) {
        const struct probe_ray *ray = &trial->rays[i];
        const struct probe_hit *hit = &trial->hits[i];
        const double way = (double)hit->normal[0] * ray->direction[0] +
                           (double)hit->normal[1] * ray->direction[1] +
                           (double)hit->normal[2] * ray->direction[2];
        const double gap = (double)hit->distance - (double)ray->nearest;
        if (is_met(hit))
            check->acne += trial->is_open ? gap < AGAIN * trial->radius : way > 0.0;
    }
    if (!is_too_many(check->acne, check->restarts))
        return SONJECT_OK;
    return REFUSE(trial,
                  "%zu of %zu rays that leave the surface meet it again at once: "
                  "distances are not good to 20 um",
                  check->acne, check->restarts);
}

static sonject_status try_shape(struct trial *trial, struct shape_check *check)
{
    sonject_status status = shoot(trial);
    THEN(status, check_sides(trial));
    THEN(status, compare_normals(trial, check));
    THEN(status, check_nearest(trial));
    THEN(status, check_restarts(trial, check));
    check->hits = trial->count;
    return status;
}

sonject_status shape_check_run(struct report *report, struct device *device,
                               const struct user_shapes *shapes, uint32_t number,
                               struct shape_check *check)
{
    const struct user_shape *shape = &shapes->shapes[number];
    struct trial trial;
    memset(check, 0, sizeof *check);
    memset(&trial, 0, sizeof trial);
    trial.report = report;
    trial.name = shapes->snippets[shape->snippet].name;
    trial.is_open = shape->is_open;
    trial.radius = shape->bounding_radius_m;
    trial.half_sizes[0] = shape->half_length_m;
    trial.half_sizes[1] = shape->half_width_m;
    trial.half_sizes[2] = shape->half_height_m;
    CHECK(shape_probe_begin(&trial.probe, report, device, shapes, number));
    trial.meetings = allocate_array(SHAPE_CHECK_RAYS, sizeof *trial.meetings);
    trial.rays = allocate_array(NEIGHBOURS * SHAPE_CHECK_RAYS, sizeof *trial.rays);
    trial.hits = allocate_array(NEIGHBOURS * SHAPE_CHECK_RAYS, sizeof *trial.hits);
    sonject_status status = trial.meetings && trial.rays && trial.hits
                                ? try_shape(&trial, check)
                                : report_out_of_memory(report, "the check of a shape");
    free(trial.meetings);
    free(trial.rays);
    free(trial.hits);
    shape_probe_end(&trial.probe);
    return status;
}
