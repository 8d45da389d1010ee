#include "scene/point_response.h"

#include <math.h>
#include <string.h>

#include "scene/aperture_motion.h"
#include "scene/cross_range.h"
#include "scene/motion_response.h"
#include "scene/patch_view.h"
#include "scene/scene.h"

#define PI 3.14159265358979323846

#define GAUSSIAN_REACH         5.0  /* deviations of the envelope: -108 dB */
#define TAIL_LEVEL             1e-3 /* amplitude below which a glint's side lobes in range are cut */
#define TAIL_MAX               512.0 /* resolutions */
#define SPACING_OVER_WIDTH_MAX 64
#define STRIPS_OF_REACH_MAX    4096
#define PULSE_ENERGY_SHARE     0.001 /* of |G|^2 that is cut off from speckle and energies */

static double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

/* Cosine weights of Taylor's window, from T. T. Taylor, "Design of line-source antennas for narrow
 * beamwidth and low side lobes", IRE Trans. AP-3 (1955): side lobes of equal height out to the
 * terms-th zero. */
static int taylor_weights(double *weights, double sidelobe_db, int terms)
{
    const double a = acosh(pow(10.0, sidelobe_db / 20.0)) / PI;
    const double n = terms;
    const double stretch = n * n / (a * a + (n - 0.5) * (n - 0.5));
    for (int m = 1; m < terms; m++) {
        double numerator = 1.0;
        double denominator = 1.0;
        for (int i = 1; i < terms; i++) {
            numerator *= 1.0 - m * m / (stretch * (a * a + (i - 0.5) * (i - 0.5)));
            if (i != m)
                denominator *= 1.0 - (double)(m * m) / (i * i);
        }
        weights[m - 1] = (m % 2 ? 0.5 : -0.5) * numerator / denominator;
    }
    return terms - 1;
}

/* Transform of the weighting 1 + sum of 2 w cos(2 pi m u), u from -1/2 to 1/2, over its mean. */
static double transform_at(const double *weights, int terms, double x)
{
    double sum = sinc(x);
    for (int m = 1; m <= terms; m++)
        sum += weights[m - 1] * (sinc(x - m) + sinc(x + m));
    return sum;
}

/* Integral of its square over x: Parseval. */
static double transform_energy(const double *weights, int terms)
{
    double sum = 1.0;
    for (int m = 0; m < terms; m++)
        sum += 2.0 * weights[m] * weights[m];
    return sum;
}

/* Beyond x = terms the transform is sin(pi x) / (pi x) times a function without zeros. Where that
 * has fallen below `level` for good. */
static double transform_tail(const double *weights, int terms, double level)
{
    double x = terms + 1.0;
    for (; x < TAIL_MAX; x += 0.5) {
        double sum = 1.0;
        for (int m = 1; m <= terms; m++)
            sum += (m % 2 ? -2.0 : 2.0) * weights[m - 1] * x * x / (x * x - m * m);
        if (fabs(sum) / (PI * x) < level)
            break;
    }
    return x;
}

void point_response_init(struct point_response *response, const sonject_sonar_params *sonar,
                         double reference_sound_speed_mps, double row_spacing_m)
{
    memset(response, 0, sizeof *response);
    response->resolution_m =
        sonar->along_track_resolution_m > 0.0 ? sonar->along_track_resolution_m : row_spacing_m;
    response->strip_m = response->resolution_m;
    response->range_resolution_m = reference_sound_speed_mps / (2.0 * sonar->bandwidth_hz);
    response->range_deviation_m = response->range_resolution_m / (2.0 * sqrt(log(2.0)));
    response->pulse_reach_m = GAUSSIAN_REACH * response->range_deviation_m;
    response->pulse_tail_m = response->pulse_reach_m;
    response->pulse_margin_m = response->pulse_reach_m;
    if (sonar->response_window == SONJECT_WINDOW_HAMMING) {
        response->terms = 1;
        response->weights[0] = 0.5 * 0.46 / 0.54;
    } else if (sonar->response_window == SONJECT_WINDOW_TAYLOR) {
        response->terms =
            taylor_weights(response->weights, sonar->taylor_sidelobe_db, (int)sonar->taylor_terms);
    }
}

static void set_chirp(struct point_response *response, const sonject_pulse_params *pulse)
{
    const double cell = response->range_resolution_m;
    response->pulse_kind = SONJECT_PULSE_CHIRP;
    if (pulse->window == SONJECT_PULSE_HANN) {
        response->pulse_terms = 1;
        response->pulse_weights[0] = 0.5;
    } else if (pulse->window == SONJECT_PULSE_TAYLOR) {
        response->pulse_terms = taylor_weights(response->pulse_weights, pulse->taylor_sidelobe_db,
                                               (int)pulse->taylor_terms);
    }
    response->pulse_tail_m =
        cell * transform_tail(response->pulse_weights, response->pulse_terms, TAIL_LEVEL);
    response->pulse_reach_m = range_energy_reach(response, PULSE_ENERGY_SHARE);
    response->pulse_margin_m = range_energy_reach(response, MARGIN_ENERGY_SHARE);
}

static void set_pulse_table(struct point_response *response, const struct response_table *table,
                            double reference_sound_speed_mps)
{
    const double length = fmax(-table->positions[0], table->positions[table->count - 1]);
    response->pulse_kind = SONJECT_PULSE_TABLE;
    response->pulse_table = table;
    response->metres_per_position = table->is_time ? 0.5 * reference_sound_speed_mps : 1.0;
    const double width = response_table_width(table) * response->metres_per_position;
    response->range_resolution_m = fmin(response->range_resolution_m, width);
    response->range_deviation_m = response->range_resolution_m / (2.0 * sqrt(log(2.0)));
    response->pulse_energy_m =
        response_table_energy(table, -HUGE_VAL, HUGE_VAL) * response->metres_per_position;
    response->pulse_tail_m = length * response->metres_per_position;
    response->pulse_reach_m = range_energy_reach(response, PULSE_ENERGY_SHARE);
    response->pulse_margin_m = range_energy_reach(response, MARGIN_ENERGY_SHARE);
}

void point_response_set_pulse(struct point_response *response, const sonject_pulse_params *pulse,
                              const struct response_table *table, double reference_sound_speed_mps)
{
    if (pulse->kind == SONJECT_PULSE_CHIRP)
        set_chirp(response, pulse);
    else if (pulse->kind == SONJECT_PULSE_TABLE)
        set_pulse_table(response, table, reference_sound_speed_mps);
}

void point_response_set_cross_range_table(struct point_response *response,
                                          const struct response_table *table)
{
    response->cross_range_table = table;
    response->cross_range_energy_m = response_table_energy(table, -HUGE_VAL, HUGE_VAL);
    response->strip_m = fmin(response->strip_m, response_table_width(table));
}

double along_track_response(const struct point_response *response, double distance_m)
{
    return transform_at(response->weights, response->terms, distance_m / response->resolution_m);
}

double along_track_energy_width(const struct point_response *response)
{
    return response->resolution_m * transform_energy(response->weights, response->terms);
}

/* Half width, in units of step, within which midpoints of a response's energy make up all but
 * `share` of the total. */
static double reach_of(const struct point_response *response, double total, double step,
                       double longest, double share,
                       double (*energy_at)(const struct point_response *, double))
{
    double inside = 0.0;
    double x = 0.0;
    while (x < longest && inside < (1.0 - share) * total) {
        inside += energy_at(response, x + 0.5 * step) * step;
        x += step;
    }
    return x;
}

static double window_energy_at(const struct point_response *response, double distance_m)
{
    const double w = along_track_response(response, distance_m);
    return 2.0 * w * w;
}

double along_track_energy_reach(const struct point_response *response, double share)
{
    /* a sinc keeps 1 / (pi^2 x) of its energy beyond x resolutions, so this ends */
    return reach_of(response, along_track_energy_width(response), response->resolution_m / 8.0,
                    4096.0 * response->resolution_m, share, window_energy_at);
}

double range_response(const struct point_response *response, double distance_m)
{
    if (response->pulse_kind == SONJECT_PULSE_CHIRP)
        return transform_at(response->pulse_weights, response->pulse_terms,
                            distance_m / response->range_resolution_m);
    if (response->pulse_kind == SONJECT_PULSE_TABLE)
        return response_table_at(response->pulse_table, distance_m / response->metres_per_position)
            .real_part;
    const double x = distance_m / response->range_deviation_m;
    return exp(-0.5 * x * x);
}

bool range_response_is_real(const struct point_response *response)
{
    return response->pulse_kind != SONJECT_PULSE_TABLE;
}

struct complex_number range_response_complex(const struct point_response *response,
                                             double distance_m)
{
    if (response->pulse_kind == SONJECT_PULSE_TABLE)
        return response_table_at(response->pulse_table, distance_m / response->metres_per_position);
    const struct complex_number g = {range_response(response, distance_m), 0.0};
    return g;
}

double range_energy_width(const struct point_response *response)
{
    if (response->pulse_kind == SONJECT_PULSE_CHIRP)
        return response->range_resolution_m *
               transform_energy(response->pulse_weights, response->pulse_terms);
    if (response->pulse_kind == SONJECT_PULSE_TABLE)
        return response->pulse_energy_m;
    return sqrt(PI) * response->range_deviation_m;
}

static double chirp_energy_at(const struct point_response *response, double distance_m)
{
    const double g = range_response(response, distance_m);
    return 2.0 * g * g;
}

double range_energy_reach(const struct point_response *response, double share)
{
    const double cell = response->range_resolution_m;
    if (response->pulse_kind == SONJECT_PULSE_CHIRP)
        return fmax(3.0 * cell, reach_of(response, range_energy_width(response), cell / 8.0,
                                         TAIL_MAX * cell, share, chirp_energy_at));
    if (response->pulse_kind == SONJECT_PULSE_TABLE)
        return fmin(response->pulse_tail_m,
                    fmax(3.0 * cell, response_table_reach(response->pulse_table, share) *
                                         response->metres_per_position));
    return GAUSSIAN_REACH * response->range_deviation_m;
}

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
    if (response->pulse_reach_m >= view->first_range_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the pulse reaches %.4g m to each side, farther than from the sonar "
                              "to the patch: cut its table",
                              response->pulse_reach_m);
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
    const double middle = view_apparent_range(view, 0.5 * (double)(view->columns - 1));
    response->motion = &scene->motion;
    response->motion_range_m = middle / view->range_ratio;
    response->motion_phase_per_m = -4.0 * PI / view->wavelength_m * cos(view_grazing(view, middle));
    return motion_response_spread(report, response, view, &response->motion_spread_m);
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
    if (is_real_aperture &&
        (scene->sonar.array_heading_rad != 0.0 || scene->sonar.array_pitch_rad != 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "images of an array that is turned from the track are not formed: "
                              "set its heading and pitch to 0");
    if (has_table)
        point_response_set_cross_range_table(response, &scene->cross_range_table);
    if (is_real_aperture)
        point_response_set_array(response, scene->sonar.array_length_m, view->wavelength_m,
                                 view->range_ratio);
    const double patch_m = (double)view->columns * view->column_spacing_m;
    response->pulse_tail_m = fmin(response->pulse_tail_m, fmax(response->pulse_reach_m, patch_m));
    sonject_status status = check_size(response, report, view);
    if (status == SONJECT_OK && has_motion)
        status = set_motion(response, report, scene, view);
    if (status == SONJECT_OK)
        status = cross_range_check(response, report, view);
    return status;
}
