#include "scene/point_response.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

#define GAUSSIAN_REACH     5.0   /* deviations of the envelope: -108 dB */
#define TAIL_LEVEL         1e-3  /* amplitude below which a glint's side lobes in range are cut */
#define TAIL_MAX           512.0 /* resolutions */
#define PULSE_ENERGY_SHARE 0.001 /* share of |G|^2 that is cut off from speckle and energies */

static double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

/* Computes the cosine weights of Taylor's window: side lobes of equal height out to the terms-th
 * zero (T. T. Taylor, "Design of line-source antennas for narrow beamwidth and low side lobes", IRE
 * Trans. AP-3, 1955). */
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

/* Returns the transform of 1 + sum of 2 w cos(2 pi m u), u = -1/2...1/2, over its mean. */
static double transform_at(const double *weights, int terms, double x)
{
    double sum = sinc(x);
    for (int m = 1; m <= terms; m++)
        sum += weights[m - 1] * (sinc(x - m) + sinc(x + m));
    return sum;
}

/* Returns the integral of that transform's square over x, by Parseval. */
static double transform_energy(const double *weights, int terms)
{
    double sum = 1.0;
    for (int m = 0; m < terms; m++)
        sum += 2.0 * weights[m] * weights[m];
    return sum;
}

/* Returns where the transform has fallen below `level` for good. Beyond x = terms the transform is
 * sin(pi x) / (pi x) times a function without zeros. */
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

void point_response_set_widths(struct point_response *response, double resolution_m,
                               double range_resolution_m)
{
    response->resolution_m = resolution_m;
    response->strip_m = resolution_m;
    response->range_resolution_m = range_resolution_m;
    response->range_deviation_m = range_resolution_m / (2.0 * sqrt(log(2.0)));
    response->pulse_reach_m = GAUSSIAN_REACH * response->range_deviation_m;
    response->pulse_tail_m = response->pulse_reach_m;
    response->pulse_margin_m = response->pulse_reach_m;
}

void point_response_init(struct point_response *response, const sonject_sonar_params *sonar,
                         double reference_sound_speed_mps, double row_spacing_m)
{
    memset(response, 0, sizeof *response);
    point_response_set_widths(
        response,
        sonar->along_track_resolution_m > 0.0 ? sonar->along_track_resolution_m : row_spacing_m,
        reference_sound_speed_mps / (2.0 * sonar->bandwidth_hz));
    if (sonar->response_window == SONJECT_WINDOW_HAMMING) {
        response->terms = 1;
        response->weights[0] = 0.5 * 0.46 / 0.54;
    } else if (sonar->response_window == SONJECT_WINDOW_TAYLOR) {
        response->terms =
            taylor_weights(response->weights, sonar->taylor_sidelobe_db, (int)sonar->taylor_terms);
    }
}

double along_track_response(const struct point_response *response, double distance_m)
{
    return transform_at(response->weights, response->terms, distance_m / response->resolution_m);
}

double along_track_energy_width(const struct point_response *response)
{
    return response->resolution_m * transform_energy(response->weights, response->terms);
}

/* Returns the half width, a multiple of step, within which a response's energy, summed at
 * midpoints, is all but `share` of the total. */
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
    /* a sinc keeps 1 / (pi^2 x) of its energy beyond x resolutions, so the search ends */
    return reach_of(response, along_track_energy_width(response), response->resolution_m / 8.0,
                    4096.0 * response->resolution_m, share, window_energy_at);
}

double along_track_tail(const struct point_response *response)
{
    return response->resolution_m * transform_tail(response->weights, response->terms, TAIL_LEVEL);
}

/* ---- Pulses. Each has four functions: its start after point_response_set_widths, G, the integral
 * of |G|^2, and the half width beyond which less than a share of that integral lies. */

/* Returns the energy at both sides for a G that is real and even. */
static double energy_at(const struct point_response *response, double distance_m)
{
    const double g = range_response(response, distance_m);
    return 2.0 * g * g;
}

static void gaussian_init(struct point_response *response, const sonject_pulse_params *pulse,
                          const struct response_table *table, double reference_sound_speed_mps)
{
    (void)response, (void)pulse, (void)table, (void)reference_sound_speed_mps; /* already set */
}

static double gaussian_at(const struct point_response *response, double distance_m)
{
    const double x = distance_m / response->range_deviation_m;
    return exp(-0.5 * x * x);
}

static double gaussian_energy_width(const struct point_response *response)
{
    return sqrt(PI) * response->range_deviation_m;
}

static double gaussian_energy_reach(const struct point_response *response, double share)
{
    (void)share;
    return GAUSSIAN_REACH * response->range_deviation_m;
}

static void chirp_init(struct point_response *response, const sonject_pulse_params *pulse,
                       const struct response_table *table, double reference_sound_speed_mps)
{
    (void)table, (void)reference_sound_speed_mps;
    if (pulse->window == SONJECT_PULSE_HANN) {
        response->pulse_terms = 1;
        response->pulse_weights[0] = 0.5;
    } else if (pulse->window == SONJECT_PULSE_TAYLOR) {
        response->pulse_terms = taylor_weights(response->pulse_weights, pulse->taylor_sidelobe_db,
                                               (int)pulse->taylor_terms);
    }
    response->pulse_tail_m =
        response->range_resolution_m *
        transform_tail(response->pulse_weights, response->pulse_terms, TAIL_LEVEL);
}

static double chirp_at(const struct point_response *response, double distance_m)
{
    return transform_at(response->pulse_weights, response->pulse_terms,
                        distance_m / response->range_resolution_m);
}

static double chirp_energy_width(const struct point_response *response)
{
    return response->range_resolution_m *
           transform_energy(response->pulse_weights, response->pulse_terms);
}

static double chirp_energy_reach(const struct point_response *response, double share)
{
    const double cell = response->range_resolution_m;
    return fmax(3.0 * cell, reach_of(response, chirp_energy_width(response), cell / 8.0,
                                     TAIL_MAX * cell, share, energy_at));
}

static void table_init(struct point_response *response, const sonject_pulse_params *pulse,
                       const struct response_table *table, double reference_sound_speed_mps)
{
    const double length = fmax(-table->positions[0], table->positions[table->count - 1]);
    (void)pulse;
    response->pulse_table = table;
    response->metres_per_position = table->is_time ? 0.5 * reference_sound_speed_mps : 1.0;
    const double width = response_table_width(table) * response->metres_per_position;
    response->range_resolution_m = fmin(response->range_resolution_m, width);
    response->range_deviation_m = response->range_resolution_m / (2.0 * sqrt(log(2.0)));
    response->pulse_energy_m =
        response_table_energy(table, -HUGE_VAL, HUGE_VAL) * response->metres_per_position;
    response->pulse_tail_m = length * response->metres_per_position;
}

static double table_at(const struct point_response *response, double distance_m)
{
    return range_response_complex(response, distance_m).real_part;
}

static double table_energy_width(const struct point_response *response)
{
    return response->pulse_energy_m;
}

static double table_energy_reach(const struct point_response *response, double share)
{
    return fmin(response->pulse_tail_m, fmax(3.0 * response->range_resolution_m,
                                             response_table_reach(response->pulse_table, share) *
                                                 response->metres_per_position));
}

static const struct {
    void (*init)(struct point_response *response, const sonject_pulse_params *pulse,
                 const struct response_table *table, double reference_sound_speed_mps);
    double (*at)(const struct point_response *response, double distance_m);
    double (*energy_width)(const struct point_response *response);
    double (*energy_reach)(const struct point_response *response, double share);
} pulses[PULSE_KINDS] = {
#define PULSE_ROW(NUMBER, word) {word##_init, word##_at, word##_energy_width, word##_energy_reach},
    PULSES(PULSE_ROW)};

void point_response_set_pulse(struct point_response *response, const sonject_pulse_params *pulse,
                              const struct response_table *table, double reference_sound_speed_mps)
{
    response->pulse_kind = (sonject_pulse_kind)pulse->kind;
    pulses[pulse->kind].init(response, pulse, table, reference_sound_speed_mps);
    response->pulse_reach_m = range_energy_reach(response, PULSE_ENERGY_SHARE);
    response->pulse_margin_m = range_energy_reach(response, MARGIN_ENERGY_SHARE);
}

double range_response(const struct point_response *response, double distance_m)
{
    return pulses[response->pulse_kind].at(response, distance_m);
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
    return (struct complex_number){range_response(response, distance_m), 0.0};
}

double range_energy_width(const struct point_response *response)
{
    return pulses[response->pulse_kind].energy_width(response);
}

double range_shift(const struct point_response *response)
{
    return response->pulse_kind == SONJECT_PULSE_TABLE
               ? response_table_reach(response->pulse_table, LOBE_LOSS) *
                     response->metres_per_position
               : 0.0;
}

double range_energy_reach(const struct point_response *response, double share)
{
    return pulses[response->pulse_kind].energy_reach(response, share);
}
