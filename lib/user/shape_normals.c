/* Normals of a shape against finite differences of what it meets. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "user/shape_trial.h"

#define PI        3.14159265358979323846
#define STEP      2e-3   /* radii, from a ray to its neighbours; then half of it */
#define STEEP     0.2    /* least cosine of incidence where normals are compared */
#define BEND      0.1    /* of the neighbours' plane, over their distance */
#define AGREE_RAD 8.7e-3 /* half a degree */

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
