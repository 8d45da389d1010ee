#include "scene/patch_view.h"

#include <math.h>

#include "scene/placement.h"
#include "scene/point_response.h"
#include "scene/sediment.h"

#define PI                  3.14159265358979323846
#define BINS_PER_RESOLUTION 8    /* sharing an echo between bins then errs by 0.05 dB at most */
#define ROUNDING            1e-9 /* a ratio of 2.5 cm to 2.5 cm must give one strip, not two */

sonject_status scene_lay_water(const struct scene *scene, struct report *report,
                               struct water *water)
{
    double highest = 0.0;
    double lowest_seabed, highest_seabed;
    relief_features_bounds(&scene->relief, &lowest_seabed, &highest_seabed);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        double top;
        CHECK(object_top(scene, report, i, &top));
        highest = fmax(highest, top);
    }
    highest += highest_seabed;
    /* only fans from the sonar may cross layers near targets; other sound needs one sound speed */
    const bool is_sliced = scene->injection.interactions == 1 &&
                           scene->sonar.transducer_side_m == 0.0 &&
                           highest < scene->sonar.altitude_m;
    return water_init(water, report, scene->water_layers, scene->water_layer_count,
                      scene->medium.sound_speed_mps, is_sliced ? highest_seabed : highest, highest);
}

double scene_reference_speed(const struct scene *scene)
{
    if (scene->medium.reference_sound_speed_mps > 0.0)
        return scene->medium.reference_sound_speed_mps;
    return scene->water_layer_count > 0 ? scene->water_layers[0].speed_mps
                                        : scene->medium.sound_speed_mps;
}

/* Refuses water columns under layers or with relief, where rays would start at the nadir. */
static sonject_status check_water_column(const struct patch_view *view, struct report *report,
                                         const struct scene *scene, double first_column)
{
    const double last_range = view_processor_range(view, (double)view->columns - 1.0);
    const bool is_level = scene->relief.count == 0;
    if (!(view_ground_range(view, last_range) > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "all of the patch, up to %.3f m slant range, lies in the water "
                              "column, before the bottom's first return at %.3f m: move the patch "
                              "outwards or correct first_slant_range or altitude",
                              last_range, view_bottom_range(view));
    if (view_ground_range(view, view->first_range_m) > 0.0 || (view->water.is_straight && is_level))
        return SONJECT_OK;
    return report_failure(
        report, SONJECT_ERROR_INPUT,
        "the patch begins at %.3f m slant range, in the water column, which is not possible %s: %s "
        "the patch at column %.0f, behind the bottom's first return at %.3f m",
        view->first_range_m, is_level ? "where layers bend the sound" : "over a seabed with relief",
        view->is_reversed ? "end" : "begin",
        first_column + view_patch_column(view, (double)view_water_columns(view)),
        view_bottom_range(view));
}

static double seabed_lambert_of(const struct patch_view *view, const struct scene *scene)
{
    const double first = fmax(view->first_range_m, view_bottom_range(view));
    const double middle = 0.5 * (first + view_processor_range(view, (double)(view->columns - 1)));
    return isnan(scene->seabed.grain_size_phi)
               ? scene->seabed.lambert
               : sediment_lambert(scene->seabed.grain_size_phi, view->wavelength_m,
                                  view_grazing(view, middle));
}

sonject_status patch_view_init(struct patch_view *view, struct report *report,
                               const struct scene *scene, const struct water *water,
                               double first_row, double first_column, size_t rows, size_t columns)
{
    const sonject_geometry_params *geometry = &scene->geometry;
    const double reference = scene_reference_speed(scene);
    if (rows == 0 || columns == 0)
        return report_failure(report, SONJECT_ERROR_INPUT, "the patch has no pixels");
    view->rows = rows;
    view->columns = columns;
    view->first_row = view->first_column = 0;
    view->row_spacing_m = geometry->row_spacing_m;
    view->column_spacing_m = geometry->column_spacing_m;
    view->range_ratio = reference / water->straight_speed_mps;
    view->altitude_m = scene->sonar.altitude_m;
    view->water = ray_path_direct(water, view->altitude_m);
    view->wavelength_m = water->straight_speed_mps / scene->sonar.centre_frequency_hz;
    view->is_mirrored = geometry->side == SONJECT_SIDE_STARBOARD;
    const double along = geometry->first_along_track_m + first_row * geometry->row_spacing_m;
    view->first_x_m =
        view->is_mirrored ? -(along + (double)(rows - 1) * geometry->row_spacing_m) : along;
    view->is_reversed = geometry_is_reversed(geometry);
    view->first_range_m = geometry_range(geometry, first_column + view_patch_column(view, 0.0));
    if (view->first_range_m < geometry->first_slant_range_m && geometry->nadir_column > 0.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the patch's columns %.0f to %.0f are not all to %s of nadir_column "
                              "%g: choose others, or the other side",
                              first_column, first_column + (double)columns - 1.0,
                              view->is_mirrored ? "starboard" : "port", geometry->nadir_column);
    view->farthest_m = view_processor_range(view, (double)(columns - 1));
    CHECK(check_water_column(view, report, scene, first_column));
    view->seabed_lambert = seabed_lambert_of(view, scene);
    return SONJECT_OK;
}

struct patch_view patch_view_window(const struct patch_view *view, const struct window *window)
{
    struct patch_view part = *view;
    part.rows = window->rows;
    part.columns = window->columns;
    part.first_row = window->first_row;
    part.first_column = window->first_column;
    part.first_x_m = view_x_of_row(view, (double)window->first_row);
    part.first_range_m = view_processor_range(view, (double)window->first_column);
    return part;
}

/* Reverses the order of count things of so many bytes each. */
static void reverse(char *things, size_t count, size_t bytes)
{
    for (size_t k = 0; k < count / 2; k++) {
        char *a = things + k * bytes;
        char *b = things + (count - 1 - k) * bytes;
        for (size_t i = 0; i < bytes; i++) {
            const char kept = a[i];
            a[i] = b[i];
            b[i] = kept;
        }
    }
}

void view_turn_plane(const struct patch_view *view, size_t rows, size_t columns, void *plane,
                     size_t pixel_bytes)
{
    const size_t row_bytes = columns * pixel_bytes;
    if (view->is_mirrored)
        reverse(plane, rows, row_bytes);
    for (size_t row = 0; view->is_reversed && row < rows; row++)
        reverse((char *)plane + row * row_bytes, columns, pixel_bytes);
}

double view_patch_column(const struct patch_view *view, double column)
{
    return view->is_reversed ? (double)(view->columns - 1) - column : column;
}

void view_find_pixel(const struct patch_view *view, double first_row, double first_column,
                     uint32_t kind, double along, double range, double *row, double *column)
{
    *row = 0.5 * (double)(view->rows - 1);
    *column = 0.5 * (double)(view->columns - 1);
    if (kind == SONJECT_POSITION_METRES) {
        *row = view_row_of_x(view, view->is_mirrored ? -along : along);
        *column = view_column_of_range(view, range);
    } else if (kind == SONJECT_POSITION_PIXELS) {
        const double image_row = along - first_row;
        *row = view->is_mirrored ? (double)(view->rows - 1) - image_row : image_row;
        *column = view_patch_column(view, range - first_column);
    }
}

double view_bottom_range(const struct patch_view *view)
{
    return ray_path_range(&view->water, 0.0, 0.0) * view->range_ratio;
}

size_t view_water_columns(const struct patch_view *view)
{
    const double columns = view_column_of_range(view, view_bottom_range(view));
    return columns < 0.0 ? 0 : (size_t)floor(columns) + 1;
}

double view_x_of_row(const struct patch_view *view, double row)
{
    return view->first_x_m + row * view->row_spacing_m;
}

double view_row_of_x(const struct patch_view *view, double x_m)
{
    return (x_m - view->first_x_m) / view->row_spacing_m;
}

double view_processor_range(const struct patch_view *view, double column)
{
    return view->first_range_m + column * view->column_spacing_m;
}

double view_column_of_range(const struct patch_view *view, double processor_range_m)
{
    return (processor_range_m - view->first_range_m) / view->column_spacing_m;
}

double view_ground_range(const struct patch_view *view, double processor_range_m)
{
    return ray_path_ground_range(&view->water, processor_range_m / view->range_ratio);
}

double view_grazing(const struct patch_view *view, double processor_range_m)
{
    const double ground = view_ground_range(view, processor_range_m);
    return ground > 0.0 ? ray_path_grazing(&view->water, ground, 0.0) : 0.5 * PI;
}

double view_refraction_gain(const struct patch_view *view, double processor_range_m)
{
    if (view->water.is_straight)
        return 1.0;
    const struct arrival ray =
        ray_path_arrival(&view->water, view_grazing(view, processor_range_m), 0.0);
    const double gain = ray.spreading * ray.straight_range_m * ray.straight_range_m /
                        (ray.ground_range_m * ray.wavefront_m);
    return gain * gain;
}

double view_energy_scale(const struct patch_view *view)
{
    const double square = view->range_ratio * view->range_ratio;
    return square * square;
}

static int32_t bins_of(const struct patch_view *view, double length_m, uint32_t bins_per_pixel)
{
    return (int32_t)ceil(length_m * bins_per_pixel / view->column_spacing_m);
}

int32_t pulse_reach_bins(const struct patch_view *view, const struct point_response *response,
                         uint32_t bins_per_pixel)
{
    return bins_of(view, response->pulse_reach_m, bins_per_pixel);
}

int32_t pulse_tail_bins(const struct patch_view *view, const struct point_response *response,
                        uint32_t bins_per_pixel)
{
    return bins_of(view, response->pulse_tail_m, bins_per_pixel);
}

void line_grid_for_patch(struct line_grid *grid, const struct patch_view *view,
                         const struct point_response *response)
{
    const double resolution = 2.0 * sqrt(log(2.0)) * response->range_deviation_m;
    grid->strips_per_row = (uint32_t)ceil(view->row_spacing_m / response->strip_m - ROUNDING);
    grid->bins_per_pixel =
        (uint32_t)ceil(BINS_PER_RESOLUTION * view->column_spacing_m / resolution - ROUNDING);
    const double strip = view->row_spacing_m / grid->strips_per_row;
    const int32_t strip_margin = (int32_t)ceil(
        cross_range_energy_reach(response, view->farthest_m, MARGIN_ENERGY_SHARE) / strip);
    const int32_t bin_margin = bins_of(view, response->pulse_margin_m, grid->bins_per_pixel);
    /* there are no echoes from before range 0 */
    const int32_t bins_before = (int32_t)fmin(
        bin_margin, view->first_range_m * grid->bins_per_pixel / view->column_spacing_m);
    grid->strips.first = -strip_margin;
    grid->strips.count = (int32_t)(view->rows * grid->strips_per_row) + 2 * strip_margin;
    grid->bins.first = -bins_before;
    grid->bins.count =
        (int32_t)((view->columns - 1) * grid->bins_per_pixel) + 1 + bins_before + bin_margin;
}

double line_grid_shortest_deviation(const struct line_grid *grid, double column_spacing_m)
{
    return BINS_PER_RESOLUTION * column_spacing_m /
           (2.0 * sqrt(log(2.0)) * (double)grid->bins_per_pixel);
}

double line_grid_near_end(const struct line_grid *grid, const struct patch_view *view)
{
    return view_processor_range(view, (grid->bins.first - 1.0) / grid->bins_per_pixel);
}

double line_grid_far_end(const struct line_grid *grid, const struct patch_view *view)
{
    const double end = grid->bins.first + grid->bins.count;
    return view_processor_range(view, end / grid->bins_per_pixel);
}

size_t line_grid_cells(const struct line_grid *grid)
{
    return (size_t)grid->strips.count * (size_t)grid->bins.count;
}
