#include "scene/point_response.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

static double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

/* Cosine weights of Taylor's window, from T. T. Taylor, "Design of line-source antennas for narrow
 * beamwidth and low side lobes", IRE Trans. AP-3 (1955): side lobes of equal height out to the
 * terms-th zero. */
static void taylor_weights(struct point_response *response, double sidelobe_db, int terms)
{
    const double a = acosh(pow(10.0, sidelobe_db / 20.0)) / PI;
    const double n = terms;
    const double stretch = n * n / (a * a + (n - 0.5) * (n - 0.5));
    response->terms = terms - 1;
    for (int m = 1; m < terms; m++) {
        double numerator = 1.0;
        double denominator = 1.0;
        for (int i = 1; i < terms; i++) {
            numerator *= 1.0 - m * m / (stretch * (a * a + (i - 0.5) * (i - 0.5)));
            if (i != m)
                denominator *= 1.0 - (double)(m * m) / (i * i);
        }
        response->weights[m - 1] = (m % 2 ? 0.5 : -0.5) * numerator / denominator;
    }
}

void point_response_init(struct point_response *response, const sonject_sonar_params *sonar,
                         double reference_sound_speed_mps, double row_spacing_m)
{
    memset(response, 0, sizeof *response);
    response->resolution_m =
        sonar->along_track_resolution_m > 0.0 ? sonar->along_track_resolution_m : row_spacing_m;
    const double range_resolution = reference_sound_speed_mps / (2.0 * sonar->bandwidth_hz);
    response->range_deviation_m = range_resolution / (2.0 * sqrt(log(2.0)));
    if (sonar->response_window == SONJECT_WINDOW_HAMMING) {
        response->terms = 1;
        response->weights[0] = 0.5 * 0.46 / 0.54;
    } else if (sonar->response_window == SONJECT_WINDOW_TAYLOR) {
        taylor_weights(response, sonar->taylor_sidelobe_db, (int)sonar->taylor_terms);
    }
}

double along_track_response(const struct point_response *response, double distance_m)
{
    const double x = distance_m / response->resolution_m;
    double sum = sinc(x);
    for (int m = 1; m <= response->terms; m++)
        sum += response->weights[m - 1] * (sinc(x - m) + sinc(x + m));
    return sum;
}

double range_response(const struct point_response *response, double distance_m)
{
    const double x = distance_m / response->range_deviation_m;
    return exp(-0.5 * x * x);
}

double along_track_energy_width(const struct point_response *response)
{
    /* Parseval on the aspect weighting 1 + sum 2 w cos */
    double sum = 1.0;
    for (int m = 0; m < response->terms; m++)
        sum += 2.0 * response->weights[m] * response->weights[m];
    return response->resolution_m * sum;
}

double range_energy_width(const struct point_response *response)
{
    return sqrt(PI) * response->range_deviation_m;
}

double along_track_energy_reach(const struct point_response *response, double share)
{
    const double total = along_track_energy_width(response);
    const double step = response->resolution_m / 8.0;
    double inside = 0.0;
    double x = 0.0;
    /* midpoints; a sinc keeps 1 / (pi^2 x) of its energy beyond x resolutions, so this ends */
    while (x < 4096.0 * response->resolution_m && inside < (1.0 - share) * total) {
        const double w = along_track_response(response, x + 0.5 * step);
        inside += 2.0 * w * w * step;
        x += step;
    }
    return x;
}
