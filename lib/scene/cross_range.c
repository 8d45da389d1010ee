#include "scene/cross_range.h"

#include <math.h>

#define PI               3.14159265358979323846
#define BEAM_LOBES       8.0  /* of the pattern; 4e-6 of its energy lies beyond */
#define TAIL_LOBES       10.0 /* beyond which the two-way amplitude is below 1e-3 */
#define BEAM_STEPS       4096
#define HALF_POWER_POINT 0.31895 /* sinc(z)^4 = 1/2 */
#define MIGRATION_SHARE  0.25    /* of a range cell, that an echo may move within the beam */

static double sinc(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

bool cross_range_is_plain(const struct point_response *response)
{
    return response->array_length_m == 0.0 && !response->cross_range_table && !response->motion;
}

/* Two-way amplitude of the beam at the tangent x / range. */
static double beam_at(const struct point_response *response, double tangent)
{
    const double one_way = sinc(response->array_length_m / response->wavelength_m * tangent /
                                sqrt(1.0 + tangent * tangent));
    return one_way * one_way;
}

/* The beam's half width as a tangent, of a pattern's argument z. */
static double tangent_at(const struct point_response *response, double z)
{
    const double sine = fmin(0.99, z * response->wavelength_m / response->array_length_m);
    return sine / sqrt(1.0 - sine * sine);
}

void point_response_set_array(struct point_response *response, double array_length_m,
                              double wavelength_m, double range_ratio)
{
    response->array_length_m = array_length_m;
    response->wavelength_m = wavelength_m;
    response->range_ratio = range_ratio;
    /* its band of spatial frequencies, 2 sin(aspect) / wavelength, is 4 / length wide at the foot
     */
    response->strip_m = 0.25 * array_length_m;
    const double step = tangent_at(response, BEAM_LOBES) / BEAM_STEPS;
    response->beam_energy = 0.0;
    for (int i = 0; i < BEAM_STEPS; i++)
        response->beam_energy += 2.0 * pow(beam_at(response, (i + 0.5) * step), 2.0) * step;
}

struct complex_number cross_range_response(const struct point_response *response, double range_m,
                                           double distance_m)
{
    struct complex_number w = {0.0, 0.0};
    if (response->cross_range_table)
        return response_table_at(response->cross_range_table, distance_m);
    if (response->array_length_m == 0.0) {
        w.real_part = along_track_response(response, distance_m);
        return w;
    }
    const double range = range_m / response->range_ratio;
    const double detour =
        distance_m * distance_m / (sqrt(range * range + distance_m * distance_m) + range);
    const double phase = 4.0 * PI / response->wavelength_m * detour;
    const double amplitude = beam_at(response, distance_m / range);
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
    return along_track_energy_width(response);
}

static double beam_energy_reach(const struct point_response *response, double share)
{
    const double step = tangent_at(response, BEAM_LOBES) / BEAM_STEPS;
    double inside = 0.0;
    int i = 0;
    for (; i < BEAM_STEPS && inside < (1.0 - share) * response->beam_energy; i++)
        inside += 2.0 * pow(beam_at(response, (i + 0.5) * step), 2.0) * step;
    return i * step;
}

double cross_range_energy_reach(const struct point_response *response, double range_m, double share)
{
    if (response->cross_range_table)
        return response_table_reach(response->cross_range_table, share);
    if (response->array_length_m > 0.0)
        return range_m / response->range_ratio * beam_energy_reach(response, share);
    return along_track_energy_reach(response, share) + response->motion_spread_m;
}

double cross_range_tail(const struct point_response *response, double range_m)
{
    if (response->array_length_m == 0.0)
        return HUGE_VAL;
    return range_m / response->range_ratio * tangent_at(response, TAIL_LOBES);
}

sonject_status cross_range_check(const struct point_response *response, struct report *report,
                                 const struct scene *scene, const struct patch_view *view)
{
    if (response->array_length_m == 0.0)
        return SONJECT_OK;
    if (scene->sonar.array_heading_rad != 0.0 || scene->sonar.array_pitch_rad != 0.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "images of an array that is turned from the track are not formed: "
                              "set its heading and pitch to 0");
    const double range = view_apparent_range(view, (double)view->columns - 1.0);
    const double tangent = tangent_at(response, HALF_POWER_POINT);
    const double migration = range * (sqrt(1.0 + tangent * tangent) - 1.0);
    const double most = MIGRATION_SHARE * response->range_resolution_m;
    if (migration > most)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "echoes at %.4g m move by %.3g m in range over the beam of an array of %.3g m, which "
            "is more than a quarter of the range cell: use a longer array, less bandwidth or a "
            "nearer patch",
            range, migration, response->array_length_m);
    return SONJECT_OK;
}
