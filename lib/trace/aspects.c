#include "trace/aspects.h"

#include <math.h>

#define LARGEST_SINE 0.70710678118654752 /* of 45 degrees */

double aspects_sine(const struct tracer *tracer)
{
    const double aperture = tracer->scene->sonar.aperture_rad;
    if (tracer->scene->sonar.kind != SONJECT_SONAR_SYNTHETIC)
        return 0.0;
    if (aperture >= 0.0)
        return sin(0.5 * aperture);
    return fmin(0.25 * tracer->view.wavelength_m / tracer->response.resolution_m, LARGEST_SINE);
}

double aspects_slide(const struct tracer *tracer, double length_m)
{
    const double sine = aspects_sine(tracer);
    return length_m * sine / sqrt(1.0 - sine * sine);
}

/* True range of the grid's end. */
static double range_of_end(const struct tracer *tracer, const struct line_grid *grid)
{
    return line_grid_far_end(grid, &tracer->view) / tracer->view.range_ratio;
}

void aspects_record_init(struct fan_record *fan, const struct tracer *tracer,
                         const struct line_grid *grid)
{
    const struct point_response *response = &tracer->response;
    struct aspects_record *aspects = &fan->aspects;
    double square = 1.0;
    aspects->sine = (float)aspects_sine(tracer);
    if (!(aspects->sine > 0.0f))
        return;
    aspects->end = (float)(range_of_end(tracer, grid) - fan->reference_range);
    aspects->terms = response->terms;
    for (int term = 0; term < response->terms; term++) {
        aspects->weights[term] = (float)(2.0 * response->weights[term]);
        square += 2.0 * response->weights[term] * response->weights[term];
    }
    aspects->scale = (float)(1.0 / square);
}

int32_t aspects_relief_halo(const struct tracer *tracer, const struct line_grid *grid)
{
    const double height = fmax(fabs(tracer_lowest_seabed(tracer)), tracer_highest_seabed(tracer));
    if (height == 0.0 || !(aspects_sine(tracer) > 0.0))
        return 0;
    /* from the mean plane to the relief along the ray that is closest to level */
    const double range = range_of_end(tracer, grid) * tracer->view.range_ratio;
    const double slide = aspects_slide(tracer, height / sin(view_grazing(&tracer->view, range)));
    return (int32_t)ceil(slide * grid->strips_per_row / tracer->view.row_spacing_m) + 1;
}
