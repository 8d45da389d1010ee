#include "trace/beam.h"

#include <math.h>

#include "scene/sonar_array.h"
#include "trace/patch_fan.h"

#define NULLS         2.0  /* main lobe and first side lobes: all but 3e-4 of the energy */
#define STEEPEST_SINE 0.95 /* of kernels/aspects.h */

/* Direction cosines off the middle that rays go out to, along the long side. */
static double reach_of_beam(const struct tracer *tracer)
{
    return fmin(NULLS * tracer->view.wavelength_m / tracer->scene->sonar.array_length_m, 1.0);
}

double beam_largest_sine(const struct tracer *tracer)
{
    double axes[3][3];
    sonar_array_axes(axes, &tracer->scene->sonar, tracer->view.is_mirrored);
    const double slope = hypot(axes[0][1], axes[0][2]) / axes[0][0];
    return fmin(slope / hypot(1.0, slope) + reach_of_beam(tracer) / axes[0][0], STEEPEST_SINE);
}

double beam_largest_weight(const struct tracer *tracer, const struct fan_record *fan)
{
    const double sine = beam_largest_sine(tracer);
    const double cosine = sqrt(1.0 - sine * sine);
    return 6.0 * sine * 2.0 * fan->reference_range / (fan->strip_width * pow(cosine, 3.0));
}

sonject_status beam_record_init(struct fan_record *fan, const struct tracer *tracer,
                                const struct line_grid *grid)
{
    const sonject_sonar_params *sonar = &tracer->scene->sonar;
    const struct patch_view *view = &tracer->view;
    const double sine = beam_largest_sine(tracer);
    double axes[3][3];
    sonar_array_axes(axes, sonar, view->is_mirrored);
    fan->beam.reach = (float)reach_of_beam(tracer);
    fan->beam.length = (float)(sonar->array_length_m / view->wavelength_m);
    fan->beam.height = (float)(sonar->array_height_m / view->wavelength_m);
    for (int k = 0; k < 3; k++) {
        fan->beam.along[k] = (float)axes[0][k];
        fan->beam.across[k] = (float)axes[2][k];
    }
    /* what lies at the near end's range off broadside is nearer abreast */
    const double near = line_grid_near_end(grid, view) * sqrt(1.0 - sine * sine);
    double origin[3];
    patch_fan_origin(origin, view);
    const double central = water_way_grazing(&view->water, origin[1], 0.0);
    const double highest = fan->first_elevation + (double)fan->rays * fan->elevation_step;
    return fan_lay_rays(fan, tracer->report,
                        fmin(central - view_grazing(view, near), fan->first_elevation), highest,
                        fan->elevation_step);
}
