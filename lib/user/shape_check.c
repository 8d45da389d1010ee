#include "user/shape_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "user/shape_trial.h"

#define OFF_M 2.0e-5 /* start_from of kernels/chain_hit.h */
#define AGAIN 1e-3   /* radii before a hit that is looked for again */
#define SAME  1e-4   /* radii */

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
