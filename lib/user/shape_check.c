/* Normals of a shape against finite differences of what it meets. */
#include "user/shape_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "user/shape_trial.h"

#define PI        3.14159265358979323846
#define STEP      2e-3   /* radii, from a ray to its neighbours; then half of it */
#define STEEP     0.2    /* least cosine of incidence where normals are compared */
#define BEND      0.1    /* of the neighbours' plane, over their distance */
#define AGREE_RAD 8.7e-3 /* half a degree */
#define OFF_M     2.0e-5 /* start_from of kernels/chain_hit.h */
#define AGAIN     1e-3   /* radii before a hit that is looked for again */
#define SAME      1e-4   /* radii */

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
                if (!probe_hit_is_met(&hits[i]))
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
    for (int i = 0; i < TRIAL_NEIGHBOURS; i++) {
        const double step = (i < 4 ? STEP : 0.5 * STEP) * trial->radius * (i % 2 == 0 ? 1.0 : -1.0);
        double point[3];
        for (int k = 0; k < 3; k++)
            point[k] = met->offset[k] + step * across[i / 2 % 2][k];
        probe_ray_set(&rays[i], point, met->direction, nearest);
    }
}

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static sonject_status judge_angles(const struct trial *trial, double *angles,
                                   struct shape_check *check)
{
    if (check->compared == 0)
        return SONJECT_OK;
    qsort(angles, check->compared, sizeof *angles, compare_numbers);
    size_t far_off = 0;
    for (size_t i = 0; i < check->compared; i++)
        far_off += angles[i] > SHAPE_CHECK_ANGLE_DEG;
    check->median_deg = angles[check->compared / 2];
    check->largest_deg = angles[check->compared - 1];
    if (check->median_deg <= SHAPE_CHECK_MEDIAN_DEG && !trial_is_too_many(far_off, check->compared))
        return SONJECT_OK;
    return report_failure(trial->report, SONJECT_ERROR_INPUT,
                          "%s: shape_normal is not the normal of what shape_distance gives: off by "
                          "%.3g deg in the median, %.3g deg at most; %zu of %zu by more than %g "
                          "deg",
                          trial->name, check->median_deg, check->largest_deg, far_off,
                          check->compared, SHAPE_CHECK_ANGLE_DEG);
}

sonject_status trial_compare_normals(struct trial *trial, struct shape_check *check)
{
    double *angles = allocate_array(trial->count, sizeof *angles);
    CHECK_MEMORY(trial->report, angles, "the check of a shape");
    for (size_t i = 0; i < trial->count; i++)
        set_neighbours(trial, &trial->meetings[i], &trial->rays[TRIAL_NEIGHBOURS * i]);
    sonject_status status = trial_ask(trial, TRIAL_NEIGHBOURS * trial->count);
    for (size_t i = 0; status == SONJECT_OK && i < trial->count; i++) {
        const struct meeting *met = &trial->meetings[i];
        const size_t first = TRIAL_NEIGHBOURS * i;
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
        wrong +=
            dot_product(trial->meetings[i].normal, trial->meetings[i].direction) > TRIAL_GRAZING;
    if (trial->is_open || !trial_is_too_many(wrong, trial->count))
        return SONJECT_OK;
    return report_failure(trial->report, SONJECT_ERROR_INPUT,
                          "%s: %zu of %zu normals point away from the ray where it first meets the "
                          "shape: they must point out of the solid (or let the shape be open)",
                          trial->name, wrong, trial->count);
}

/* The same surface from just before it; and of a solid, an inner side behind it. */
static sonject_status check_nearest(struct trial *trial)
{
    size_t lost = 0;
    size_t inner = 0;
    for (size_t i = 0; i < trial->count; i++) {
        const struct meeting *met = &trial->meetings[i];
        probe_ray_set(&trial->rays[2 * i], met->offset, met->direction,
                      fmax(met->distance - AGAIN * trial->radius, -trial->radius));
        probe_ray_set(&trial->rays[2 * i + 1], met->offset, met->direction, met->distance + OFF_M);
    }
    CHECK(trial_ask(trial, 2 * trial->count));
    for (size_t i = 0; i < trial->count; i++) {
        const struct meeting *met = &trial->meetings[i];
        const struct probe_hit *again = &trial->hits[2 * i];
        const struct probe_hit *behind = &trial->hits[2 * i + 1];
        const double way[3] = {behind->normal[0], behind->normal[1], behind->normal[2]};
        lost += !probe_hit_is_met(again) ||
                fabs(again->distance - met->distance) > SAME * trial->radius;
        if (probe_hit_is_met(behind) && !(behind->distance > trial->rays[2 * i + 1].nearest))
            return trial_refuse(trial,
                                "shape_distance gives a surface that is not beyond `nearest`");
        inner += !trial->is_open && -dot_product(met->normal, met->direction) > TRIAL_GRAZING &&
                 !(probe_hit_is_met(behind) && dot_product(way, met->direction) > 0.0);
    }
    if (trial_is_too_many(lost, trial->count))
        return report_failure(trial->report, SONJECT_ERROR_INPUT,
                              "%s: %zu of %zu surfaces are not found again by the same ray from "
                              "just before them; `nearest` must only leave out what lies before it",
                              trial->name, lost, trial->count);
    if (trial_is_too_many(inner, trial->count))
        return report_failure(trial->report, SONJECT_ERROR_INPUT,
                              "%s: %zu of %zu rays that enter the solid do not next meet its inner "
                              "side: distances are not good to 20 um, or the surface is not closed "
                              "(then let the shape be open)",
                              trial->name, inner, trial->count);
    return SONJECT_OK;
}

/* Rays go on in the mirror's direction from just off the surface: what they meet first is not an
 * inner side, nor, of an open shape, the place that they come from. */
static sonject_status check_restarts(struct trial *trial, struct shape_check *check)
{
    for (size_t i = 0; i < trial->count; i++) {
        struct meeting *met = &trial->meetings[i];
        const double cosine = dot_product(met->normal, met->direction);
        double start[3];
        if (-cosine < TRIAL_GRAZING)
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
        probe_ray_set(&trial->rays[check->restarts], start, met->direction,
                      fmax(met->distance, -trial->radius));
        check->restarts++;
    }
    CHECK(trial_ask(trial, check->restarts));
    for (size_t i = 0; i < check->restarts; i++) {
        const struct probe_ray *ray = &trial->rays[i];
        const struct probe_hit *hit = &trial->hits[i];
        const double way = (double)hit->normal[0] * ray->direction[0] +
                           (double)hit->normal[1] * ray->direction[1] +
                           (double)hit->normal[2] * ray->direction[2];
        const double gap = (double)hit->distance - (double)ray->nearest;
        if (probe_hit_is_met(hit))
            check->acne += trial->is_open ? gap < AGAIN * trial->radius : way > 0.0;
    }
    if (!trial_is_too_many(check->acne, check->restarts))
        return SONJECT_OK;
    return report_failure(trial->report, SONJECT_ERROR_INPUT,
                          "%s: %zu of %zu rays that leave the surface meet it again at once: "
                          "distances are not good to 20 um",
                          trial->name, check->acne, check->restarts);
}

static sonject_status try_shape(struct trial *trial, struct shape_check *check)
{
    sonject_status status = trial_shoot(trial);
    THEN(status, check_sides(trial));
    THEN(status, trial_compare_normals(trial, check));
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
    trial.rays = allocate_array(TRIAL_NEIGHBOURS * SHAPE_CHECK_RAYS, sizeof *trial.rays);
    trial.hits = allocate_array(TRIAL_NEIGHBOURS * SHAPE_CHECK_RAYS, sizeof *trial.hits);
    sonject_status status = trial.meetings && trial.rays && trial.hits
                                ? try_shape(&trial, check)
                                : report_out_of_memory(report, "the check of a shape");
    free(trial.meetings);
    free(trial.rays);
    free(trial.hits);
    shape_probe_end(&trial.probe);
    return status;
}
