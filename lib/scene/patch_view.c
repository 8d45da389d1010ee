#include "scene/patch_view.h"

#include <math.h>

sonject_status patch_view_init(struct patch_view *view, struct report *report,
                               const struct scene *scene, double first_row, double first_column,
                               size_t rows, size_t columns)
{
    const sonject_geometry_params *geometry = &scene->geometry;
    const double reference = scene->medium.reference_sound_speed_mps > 0.0
                                 ? scene->medium.reference_sound_speed_mps
                                 : scene->medium.sound_speed_mps;
    if (rows == 0 || columns == 0)
        return report_failure(report, SONJECT_ERROR_INPUT, "the patch has no pixels");
    if (scene->surface.water_depth_m > 0.0 &&
        !(scene->surface.water_depth_m > scene->sonar.altitude_m))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the sea surface, %.3f m over the seabed, is not above the sonar at "
                              "%.3f m: correct the surface's depth or the altitude",
                              scene->surface.water_depth_m, scene->sonar.altitude_m);
    view->rows = rows;
    view->columns = columns;
    view->row_spacing_m = geometry->row_spacing_m;
    view->column_spacing_m = geometry->column_spacing_m;
    view->range_ratio = reference / scene->medium.sound_speed_mps;
    view->altitude_m = scene->sonar.altitude_m;
    view->wavelength_m = scene->medium.sound_speed_mps / scene->sonar.centre_frequency_hz;
    view->is_mirrored = geometry->side == SONJECT_SIDE_STARBOARD;
    const double along = geometry->first_along_track_m + first_row * geometry->row_spacing_m;
    view->first_x_m =
        view->is_mirrored ? -(along + (double)(rows - 1) * geometry->row_spacing_m) : along;
    view->first_range_m = geometry->first_slant_range_m + first_column * geometry->column_spacing_m;
    if (!(view->first_range_m > view->altitude_m * view->range_ratio))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the patch starts at %.3f m slant range, which is not beyond the "
                              "altitude of %.3f m: move the patch outwards or correct "
                              "first_slant_range or altitude",
                              view->first_range_m, view->altitude_m);
    return SONJECT_OK;
}

double view_x_of_row(const struct patch_view *view, double row)
{
    return view->first_x_m + row * view->row_spacing_m;
}

double view_row_of_x(const struct patch_view *view, double x_m)
{
    return (x_m - view->first_x_m) / view->row_spacing_m;
}

double view_apparent_range(const struct patch_view *view, double column)
{
    return view->first_range_m + column * view->column_spacing_m;
}

double view_column_of_range(const struct patch_view *view, double apparent_range_m)
{
    return (apparent_range_m - view->first_range_m) / view->column_spacing_m;
}

double view_ground_range(const struct patch_view *view, double apparent_range_m)
{
    const double range = apparent_range_m / view->range_ratio;
    const double square = range * range - view->altitude_m * view->altitude_m;
    return square > 0.0 ? sqrt(square) : 0.0;
}

double view_grazing_sine(const struct patch_view *view, double apparent_range_m)
{
    const double sine = view->altitude_m * view->range_ratio / apparent_range_m;
    return sine < 1.0 ? sine : 1.0;
}

double view_energy_scale(const struct patch_view *view)
{
    const double square = view->range_ratio * view->range_ratio;
    return square * square;
}
