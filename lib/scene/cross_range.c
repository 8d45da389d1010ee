/* The cross-range response as the image has it, and the whole response of a scene. */

#include <math.h>
#include <string.h>

#include "scene/aperture_motion.h"
#include "scene/motion_response.h"
#include "scene/patch_view.h"
#include "scene/placement.h"
#include "scene/point_response.h"
#include "scene/relief.h"
#include "scene/scene.h"

#define PI               3.14159265358979323846
#define BEAM_LOBES       8.0  /* lobes of the pattern that count; 4e-6 of the energy lies beyond */
#define TAIL_LOBES       10.0 /* the lobe beyond which the two-way amplitude is below 1e-3 */
#define BEAM_STEPS       4096
#define HALF_POWER_POINT 0.31895 /* sinc(z)^4 = 1/2 */
#define MIGRATION_SHARE  0.25    /* share of a range cell that an echo may move within the beam */

#define SPACING_OVER_WIDTH_MAX 64
#define CELLS_OF_REACH_MAX     256
#define STRIPS_OF_REACH_MAX    4096

static double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

bool cross_range_is_plain(const struct point_response *response)
{
    return response->array_length_m == 0.0 && !response->cross_range_table && !response->motion;
}

/* Returns the cosine between the array's long side and the broadside path to a range's seabed. */
static double lean_of_array(const struct point_response *response, double range)
{
    const double down = fmin(response->array_altitude_m / range, 1.0);
    return response->array_along[1] * sqrt(1.0 - down * down) - response->array_along[2] * down;
}

/* Returns the beam's two-way amplitude at the tangent x / range, with x ahead of the array. */
static double beam_at(const struct point_response *response, double lean, double tangent)
{
    const double along = response->array_along[0] * tangent + lean;
    const double one_way = sinc(response->array_length_m / response->wavelength_m * along /
                                sqrt(1.0 + tangent * tangent));
    return one_way * one_way;
}

/* Returns how far along the track a turned array's beam is off broadside at most, at a range. */
static double largest_shift(const struct point_response *response, double range)
{
    return (range * fabs(response->array_along[1]) +
            response->array_altitude_m * fabs(response->array_along[2])) /
           response->array_along[0];
}

/* Returns the beam's half width as a tangent, for an argument z of the pattern. */
static double tangent_at(const struct point_response *response, double z)
{
    const double sine = fmin(0.99, z * response->wavelength_m / response->array_length_m);
    return sine / sqrt(1.0 - sine * sine);
}

/* Sets the beam of the array, a real aperture of uniform weighting, in place of the window. */
static void set_array(struct point_response *response, const sonject_sonar_params *sonar,
                      const struct patch_view *view)
{
    double axes[3][3];
    sonar_array_axes(axes, sonar, view->is_mirrored);
    memcpy(response->array_along, axes[0], sizeof response->array_along);
    response->array_altitude_m = view->altitude_m;
    response->array_length_m = sonar->array_length_m;
    response->wavelength_m = view->wavelength_m;
    response->range_ratio = view->range_ratio;
    /* the band of spatial frequencies, 2 sin(aspect) / wavelength, is 4 / length wide at the foot
     */
    response->strip_m = 0.25 * sonar->array_length_m;
    const double step = tangent_at(response, BEAM_LOBES) / BEAM_STEPS;
    response->beam_energy = 0.0;
    for (int i = 0; i < BEAM_STEPS; i++)
        response->beam_energy += 2.0 * pow(beam_at(response, 0.0, (i + 0.5) * step), 2.0) * step;
}

struct complex_number cross_range_response(const struct point_response *response, double range_m,
                                           double distance_m)
{
    struct complex_number w = {0.0, 0.0};
    if (response->cross_range_table)
        return response_table_at(response->cross_range_table,
                                 response->is_mirrored ? -distance_m : distance_m);
    if (response->array_length_m == 0.0) {
        w.real_part = along_track_response(response, distance_m);
        return w;
    }
    const double range = range_m / response->range_ratio;
    const double detour =
        distance_m * distance_m / (sqrt(range * range + distance_m * distance_m) + range);
    const double phase = 4.0 * PI / response->wavelength_m * detour;
    const double amplitude = beam_at(response, lean_of_array(response, range), -distance_m / range);
    w.real_part = amplitude * cos(phase);
    w.imaginary_part = amplitude * sin(phase);
    return w;
}

double cross_range_energy_width(const struct point_response *response, double range_m)
{
    if (response->cross_range_table)
        return response->cross_range_energy_m;
    if (response->array_length_m > 0.0)
        return range_m / response->range_ratio * response->beam_energy;
    return along_track_energy_width(response) *
           (response->motion ? response->motion_energy_share : 1.0);
}

static double beam_energy_reach(const struct point_response *response, double share)
{
    const double step = tangent_at(response, BEAM_LOBES) / BEAM_STEPS;
    double inside = 0.0;
    int i = 0;
    for (; i < BEAM_STEPS && inside < (1.0 - share) * response->beam_energy; i++)
        inside += 2.0 * pow(beam_at(response, 0.0, (i + 0.5) * step), 2.0) * step;
    return i * step;
}

double cross_range_energy_reach(const struct point_response *response, double range_m, double share)
{
    if (response->cross_range_table)
        return response_table_reach(response->cross_range_table, share);
    if (response->array_length_m > 0.0)
        return range_m / response->range_ratio * beam_energy_reach(response, share) +
               largest_shift(response, range_m / response->range_ratio);
    return along_track_energy_reach(response, share) + motion_spread(response, share);
}

double cross_range_shift(const struct point_response *response, double range_m)
{
    if (response->cross_range_table)
        return response_table_reach(response->cross_range_table, LOBE_LOSS);
    if (response->array_length_m > 0.0)
        return largest_shift(response, range_m / response->range_ratio);
    return response->motion ? motion_spread(response, LOBE_LOSS) : 0.0;
}

double cross_range_tail(const struct point_response *response, double range_m)
{
    if (response->motion)
        return HUGE_VAL;
    if (response->cross_range_table)
        return response_table_reach(response->cross_range_table, 0.0);
    if (response->array_length_m == 0.0)
        return along_track_tail(response);
    return range_m / response->range_ratio * tangent_at(response, TAIL_LOBES) +
           largest_shift(response, range_m / response->range_ratio);
}

/* Refuses what a turned array's images cannot show: its shadows over relief, paths that arrive at
 * another angle than from the seabed there, and the map, whose pixels are seen from broadside. */
static sonject_status check_turned(struct report *report, const struct scene *scene,
                                   const struct patch_view *view)
{
    const char *what = NULL;
    if (scene_has_relief(scene))
        what = "the seabed's relief";
    else if (!view->water.is_straight)
        what = "the layers of water";
    else if (scene->injection.interactions > 1)
        what = "interactions above 1";
    else if (scene->injection.mode == SONJECT_MODE_RESYNTHESISE)
        what = "mode: resynthesise";
    if (!what)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "images of an array that is turned from the track cannot have %s: remove "
                          "it, or set sonar.array's heading and pitch to 0",
                          what);
}

/* Returns the change of an echo's range, at a processor range, within the beam's half power. */
static double migration_at(const struct point_response *response, double processor_range)
{
    const double range = processor_range / response->range_ratio;
    const double tangent = tangent_at(response, HALF_POWER_POINT) +
                           fabs(lean_of_array(response, range)) / response->array_along[0];
    return processor_range * (sqrt(1.0 + tangent * tangent) - 1.0);
}

sonject_status cross_range_check(const struct point_response *response, struct report *report,
                                 const struct scene *scene, const struct patch_view *view)
{
    if (response->array_length_m == 0.0)
        return SONJECT_OK;
    const bool is_column_major = sonar_array_is_turned(&scene->sonar);
    CHECK(is_column_major ? check_turned(report, scene, view) : SONJECT_OK);
    const double most = MIGRATION_SHARE * response->range_resolution_m;
    const double ends[2] = {view_processor_range(view, (double)view->columns - 1.0),
                            view_processor_range(view, 0.0)};
    for (int i = 0; i < 2; i++) {
        const double migration = migration_at(response, ends[i]);
        if (migration > most)
            return report_failure(
                report, SONJECT_ERROR_INPUT,
                "echoes at %.4g m move by %.3g m in range over the beam of an array of %.3g m, "
                "which is more than a quarter of the range cell: use a longer array, %sless "
                "bandwidth or a nearer patch",
                ends[i], migration, response->array_length_m,
                is_column_major ? "less heading and pitch, " : "");
    }
    return SONJECT_OK;
}

/* Refuses measured responses that no grid of this patch can hold. */
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
    response->motion = &scene->motion;
    response->motion_range_m = middle / view->range_ratio;
    response->motion_phase_per_m = -4.0 * PI / view->wavelength_m * cos(view_grazing(view, middle));
    return motion_response_spread(report, response, view);
}

sonject_status point_response_of_scene(struct point_response *response, struct report *report,
                                       const struct scene *scene, const struct patch_view *view,
                                       double reference_sound_speed_mps)
{
    const struct response_table *table = &scene->cross_range_table;
    const bool is_real_aperture = scene->sonar.kind == SONJECT_SONAR_REAL;
    const bool has_motion = !aperture_motion_is_still(&scene->motion);
    point_response_init(response, &scene->sonar, reference_sound_speed_mps, view->row_spacing_m);
    point_response_set_pulse(response, &scene->pulse, &scene->pulse_table,
                             reference_sound_speed_mps);
    if ((table->count > 0) + has_motion + is_real_aperture > 1)
        return report_failure(
            report, SONJECT_ERROR_INPUT, "%s and %s exclude each other: remove one of the two",
            table->count > 0 && has_motion ? "a measured cross-range response" : "a real aperture",
            table->count > 0 && has_motion ? "motion"
            : table->count > 0             ? "a measured cross-range response"
                                           : "residual motion");
    if (table->count > 0) {
        response->cross_range_table = table;
        response->is_mirrored = view->is_mirrored;
        response->cross_range_energy_m = response_table_energy(table, -HUGE_VAL, HUGE_VAL);
        response->strip_m = fmin(response->strip_m, response_table_width(table));
    }
    if (is_real_aperture)
        set_array(response, &scene->sonar, view);
    const double patch_m = (double)view->columns * view->column_spacing_m;
    response->pulse_tail_m = fmin(response->pulse_tail_m, fmax(response->pulse_reach_m, patch_m));
    CHECK(check_size(response, report, view));
    return has_motion ? set_motion(response, report, scene, view) : SONJECT_OK;
}
