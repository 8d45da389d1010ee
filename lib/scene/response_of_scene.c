/* The point response that a scene describes, and what no image could have. */
#include <math.h>

#include "scene/aperture_motion.h"
#include "scene/cross_range.h"
#include "scene/motion_response.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"
#include "scene/scene.h"

#define PI                     3.14159265358979323846
#define SPACING_OVER_WIDTH_MAX 64
#define CELLS_OF_REACH_MAX     256
#define STRIPS_OF_REACH_MAX    4096

static sonject_status refuse_pair(struct report *report, const char *first, const char *second)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s and %s exclude each other: take one of them away", first, second);
}

/* Measured responses that no grid of this patch could hold. */
static sonject_status check_size(const struct point_response *response, struct report *report,
                                 const struct patch_view *view)
{
    const double finest = view->column_spacing_m / SPACING_OVER_WIDTH_MAX;
    if (response->range_resolution_m < finest)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the pulse's half-power width of %.3g m is below 1/%d of the column "
                              "spacing: correct its table or bandwidth",
                              response->range_resolution_m, SPACING_OVER_WIDTH_MAX);
    if (response->pulse_reach_m > CELLS_OF_REACH_MAX * response->range_resolution_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the pulse reaches %.4g m to each side, more than %d range cells: "
                              "cut its table",
                              response->pulse_reach_m, CELLS_OF_REACH_MAX);
    if (!response->cross_range_table)
        return SONJECT_OK;
    if (response->strip_m < view->row_spacing_m / SPACING_OVER_WIDTH_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the cross-range response's half-power width of %.3g m is below 1/%d "
                              "of the row spacing: correct its table",
                              response->strip_m, SPACING_OVER_WIDTH_MAX);
    const double reach = response_table_reach(response->cross_range_table, MARGIN_ENERGY_SHARE);
    if (reach > STRIPS_OF_REACH_MAX * response->strip_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the cross-range response reaches %.4g m to each side, more than %d "
                              "times its half-power width: cut its table",
                              reach, STRIPS_OF_REACH_MAX);
    return SONJECT_OK;
}

static sonject_status set_motion(struct point_response *response, struct report *report,
                                 const struct scene *scene, const struct patch_view *view)
{
    const double middle = view_processor_range(view, 0.5 * (double)(view->columns - 1));
    if (aperture_motion_has_yaw(&scene->motion) && scene->motion.params.yaw_advance_m == 0.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "sonar.motion.yaw: a table of yaw is given without the advance from "
                              "ping to ping: give that too");
    response->motion = &scene->motion;
    response->motion_range_m = middle / view->range_ratio;
    response->motion_phase_per_m = -4.0 * PI / view->wavelength_m * cos(view_grazing(view, middle));
    return motion_response_spread(report, response, view);
}

sonject_status point_response_of_scene(struct point_response *response, struct report *report,
                                       const struct scene *scene, const struct patch_view *view,
                                       double reference_sound_speed_mps)
{
    const bool is_real_aperture = scene->sonar.kind == SONJECT_SONAR_REAL;
    const bool has_table = scene->cross_range_table.count > 0;
    const bool has_motion = !aperture_motion_is_still(&scene->motion);
    point_response_init(response, &scene->sonar, reference_sound_speed_mps, view->row_spacing_m);
    point_response_set_pulse(response, &scene->pulse, &scene->pulse_table,
                             reference_sound_speed_mps);
    if (has_table && has_motion)
        return refuse_pair(report, "a measured cross-range response", "motion");
    if (is_real_aperture && (has_table || has_motion))
        return refuse_pair(report, "a real aperture",
                           has_table ? "a measured cross-range response" : "residual motion");
    if (has_table)
        point_response_set_cross_range_table(response, &scene->cross_range_table);
    if (is_real_aperture)
        point_response_set_array(response, &scene->sonar, view);
    const double patch_m = (double)view->columns * view->column_spacing_m;
    response->pulse_tail_m = fmin(response->pulse_tail_m, fmax(response->pulse_reach_m, patch_m));
    sonject_status status = check_size(response, report, view);
    if (status == SONJECT_OK && has_motion)
        status = set_motion(response, report, scene, view);
    return status;
}
