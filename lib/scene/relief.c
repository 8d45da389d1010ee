#include "scene/relief.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/relief_bumps.h"
#include "scene/relief_ripples.h"

#define PI 3.14159265358979323846

#define POINTS_PER_PIXEL      2.0
#define POINTS_PER_WAVELENGTH 24.0 /* wanted; of ripples and of a bump's radius */
#define POINTS_LEAST          8.0  /* slopes then err by 1 % */
#define POINTS_MAX            (UINT32_C(1) << 22)
#define SIDE_MAX              16384.0
#define SLOPE_MAX             1.75 /* 60 degrees: sand never stands so steep, rocks may */

double relief_x(const struct relief *relief, uint32_t row)
{
    return relief->first_x_m + row * relief->row_step_m;
}

double relief_y(const struct relief *relief, uint32_t column)
{
    return relief->first_y_m + column * relief->column_step_m;
}

bool scene_has_relief(const struct scene *scene)
{
    return scene->relief.count > 0 || scene->relief.heights_m;
}

sonject_status relief_check_scene(const struct scene *scene, struct report *report)
{
    const sonject_material_params *forward = &scene->seabed.forward;
    double lowest, highest;
    if (!scene_has_relief(scene))
        return SONJECT_OK;
    if (forward->reflection_kind == SONJECT_REFLECTION_FLUID || forward->reflection != 0.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "a seabed with relief cannot be smooth, for the mirror is a level "
                              "plane: remove seabed.relief or the reflection of seabed.forward");
    if (scene->injection.mode == SONJECT_MODE_RESYNTHESISE &&
        scene->seabed.map == SONJECT_MAP_COHERENT)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the coherent seabed map needs a level seabed: remove seabed.relief "
                              "or use map: intensity or despeckled");
    relief_features_bounds(&scene->relief, &lowest, &highest);
    if (fmax(highest, -lowest) > 0.5 * scene->sonar.altitude_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the seabed's relief may reach from %.3f to %.3f m, more than half "
                              "the sonar's altitude of %.3f m: lower it",
                              lowest, highest, scene->sonar.altitude_m);
    return SONJECT_OK;
}

/* Where the grid lies: over the whole patch, pixels' edges included. */
static sonject_status lay_grid(struct relief *relief, struct report *report,
                               const struct scene *scene, const struct patch_view *view)
{
    const double near = view_ground_range(view, view_processor_range(view, -0.5));
    const double first_y =
        near > 0.0 ? near : view_ground_range(view, view_processor_range(view, 0.0));
    const double length = (double)view->rows * view->row_spacing_m;
    const double width =
        view_ground_range(view, view_processor_range(view, (double)view->columns - 0.5)) - first_y;
    double finest = INFINITY;   /* m, of all features */
    double coarsest = INFINITY; /* step that shows them */
    double step = fmin(view->row_spacing_m, view->column_spacing_m) / POINTS_PER_PIXEL;
    for (uint32_t i = 0; i < scene->relief.count; i++) {
        const struct relief_feature *feature = &scene->relief.features[i];
        const double size = feature->kind == RELIEF_RIPPLES ? feature->wavelength_m
                            : feature->kind == RELIEF_SCOUR ? feature->width_m
                                                            : feature->radius_m;
        finest = fmin(finest, size);
    }
    if (scene->relief.heights_m) {
        /* as fine as the caller's, down to what no pixel shows */
        const sonject_relief_params *grid = &scene->relief.grid;
        const double wanted = fmax(0.5 * step, fmin(grid->row_spacing_m, grid->column_spacing_m));
        step = fmin(step, wanted);
        coarsest = 2.0 * wanted;
    }
    step = fmin(step, finest / POINTS_PER_WAVELENGTH);
    coarsest = fmin(coarsest, finest / POINTS_LEAST);
    step = fmax(step, sqrt(length * width / POINTS_MAX));
    step = fmax(step, fmax(length, width) / SIDE_MAX);
    if (step * POINTS_LEAST > finest)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "the seabed's relief has features of %.3g m, too fine for a patch of "
            "%.1f m x %.1f m, whose heights lie %.3g m apart: use a smaller patch",
            finest, length, width, step);
    relief->rows = (uint32_t)fmax(5.0, ceil(length / step) + 1.0);
    relief->columns = (uint32_t)fmax(5.0, ceil(width / step) + 1.0);
    relief->row_step_m = length / (relief->rows - 1);
    relief->column_step_m = width / (relief->columns - 1);
    relief->first_x_m = view_x_of_row(view, -0.5);
    relief->first_y_m = first_y;
    return SONJECT_OK;
}

/* What a patch's edge leaves of heights `inside` m from it. */
static double taper(double inside, double side)
{
    const double width = fmin(RELIEF_TAPER_M, RELIEF_TAPER_SHARE * side);
    return relief_raised_cosine(1.0 - fmin(1.0, fmax(0.0, inside / width)));
}

static sonject_status find_object(struct report *report, const struct scene *scene,
                                  const char *name, uint32_t *number)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < scene->object_count; i++)
        if (strcmp(scene->objects[i].name, name) == 0) {
            *number = i;
            found++;
        }
    if (found == 1)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "seabed.relief: scour around '%s': %s object has that name", name,
                          found == 0 ? "no" : "more than one");
}

static sonject_status add_feature(const struct relief *relief, struct report *report,
                                  const struct scene *scene, const struct patch_view *view,
                                  double first_row, double first_column,
                                  const struct footprint *footprints,
                                  const struct relief_feature *feature, double *heights)
{
    const double sign = feature->kind == RELIEF_MOUND ? 1.0 : -1.0;
    double row, column;
    uint32_t object = 0;
    if (feature->kind == RELIEF_RIPPLES)
        return relief_add_ripples(relief, report, feature, view->is_mirrored, heights);
    if (feature->kind == RELIEF_SCOUR) {
        const sonject_status status = find_object(report, scene, feature->object, &object);
        if (status == SONJECT_OK)
            relief_add_scour(relief, heights, &footprints[object], feature->width_m,
                             feature->height_m);
        return status;
    }
    view_find_pixel(view, first_row, first_column, feature->position_kind, feature->position_along,
                    feature->position_range, &row, &column);
    relief_add_bump(relief, heights, view_x_of_row(view, row),
                    view_ground_range(view, view_processor_range(view, column)), feature->radius_m,
                    sign * feature->height_m);
    return SONJECT_OK;
}

/* Bilinear on a grid at fractional indices; 0 outside. */
static double mix_grid(const float *heights, uint32_t rows, uint32_t columns, double row,
                       double column)
{
    if (!(row >= 0.0 && row <= rows - 1.0 && column >= 0.0 && column <= columns - 1.0))
        return 0.0;
    const uint32_t r = (uint32_t)fmin(row, rows - 2.0);
    const uint32_t c = (uint32_t)fmin(column, columns - 2.0);
    const float *at = heights + (size_t)r * columns + c;
    const double along = row - r;
    const double across = column - c;
    return (1.0 - along) * ((1.0 - across) * (double)at[0] + across * (double)at[1]) +
           along * ((1.0 - across) * (double)at[columns] + across * (double)at[columns + 1]);
}

static void add_grid(const struct relief *relief, const struct relief_features *features,
                     bool is_mirrored, double *heights)
{
    const sonject_relief_params *grid = &features->grid;
    for (uint32_t row = 0; row < relief->rows; row++)
        for (uint32_t column = 0; column < relief->columns; column++) {
            const double x = relief_x(relief, row);
            heights[(size_t)row * relief->columns + column] += mix_grid(
                features->heights_m, grid->rows, grid->columns,
                ((is_mirrored ? -x : x) - grid->first_along_track_m) / grid->row_spacing_m,
                (relief_y(relief, column) - grid->first_ground_range_m) / grid->column_spacing_m);
        }
}

/* Lets the heights fall to 0 at the edges. */
static void taper_heights(struct relief *relief, const double *heights)
{
    const double length = (relief->rows - 1) * relief->row_step_m;
    const double width = (relief->columns - 1) * relief->column_step_m;
    for (uint32_t row = 0; row < relief->rows; row++)
        for (uint32_t column = 0; column < relief->columns; column++) {
            const size_t i = (size_t)row * relief->columns + column;
            const bool is_edge =
                row == 0 || column == 0 || row + 1 == relief->rows || column + 1 == relief->columns;
            const double x = row * relief->row_step_m;
            const double y = column * relief->column_step_m;
            const double kept =
                taper(fmin(x, length - x), length) * taper(fmin(y, width - y), width);
            relief->heights[i] = is_edge ? 0.0f : (float)(kept * heights[i]);
        }
}

/* At point `at` of `count` points that lie `stride` apart; 0 at the ends, where all is level. */
static double difference(const float *line, size_t stride, uint32_t at, uint32_t count)
{
    const float *here = line + at * stride;
    if (at == 0 || at + 1 == count)
        return 0.0;
    const double near = (double)here[stride] - (double)*(here - stride);
    if (at == 1 || at + 2 == count)
        return 0.5 * near;
    return (8.0 * near - ((double)here[2 * stride] - (double)*(here - 2 * stride))) / 12.0;
}

void relief_finish(struct relief *relief)
{
    relief->lowest_m = 0.0;
    relief->highest_m = 0.0;
    for (uint32_t row = 0; row < relief->rows; row++)
        for (uint32_t column = 0; column < relief->columns; column++) {
            const size_t i = (size_t)row * relief->columns + column;
            relief->slopes[2 * i] =
                (float)(difference(relief->heights + column, relief->columns, row, relief->rows) /
                        relief->row_step_m);
            relief->slopes[2 * i + 1] =
                (float)(difference(relief->heights + (size_t)row * relief->columns, 1, column,
                                   relief->columns) /
                        relief->column_step_m);
            relief->lowest_m = fmin(relief->lowest_m, (double)relief->heights[i]);
            relief->highest_m = fmax(relief->highest_m, (double)relief->heights[i]);
        }
}

/* By the cells' own edges, which no step between two points escapes. */
static sonject_status check_slopes(const struct relief *relief, struct report *report,
                                   const struct patch_view *view)
{
    for (uint32_t row = 0; row + 1 < relief->rows; row++)
        for (uint32_t column = 0; column + 1 < relief->columns; column++) {
            const float *at = relief->heights + (size_t)row * relief->columns + column;
            const double along = ((double)at[relief->columns] - (double)at[0]) / relief->row_step_m;
            const double across = ((double)at[1] - (double)at[0]) / relief->column_step_m;
            const double x = relief_x(relief, row);
            if (hypot(along, across) > SLOPE_MAX)
                return report_failure(report, SONJECT_ERROR_INPUT,
                                      "the seabed's relief rises by %.0f degrees at %.2f m "
                                      "along-track, %.2f m ground "
                                      "range; at most 60 are possible: make it lower or wider",
                                      atan(hypot(along, across)) * 180.0 / PI,
                                      view->is_mirrored ? -x : x, relief_y(relief, column));
        }
    return SONJECT_OK;
}

static sonject_status fill(struct relief *relief, struct report *report, const struct scene *scene,
                           const struct patch_view *view, double first_row, double first_column,
                           const struct footprint *footprints)
{
    const size_t points = (size_t)relief->rows * relief->columns;
    double *heights = allocate_array(points, sizeof *heights);
    relief->heights = allocate_array(points, sizeof *relief->heights);
    relief->slopes = allocate_array(points, 2 * sizeof *relief->slopes);
    sonject_status status = heights && relief->heights && relief->slopes
                                ? SONJECT_OK
                                : report_out_of_memory(report, "the seabed's relief");
    for (uint32_t i = 0; status == SONJECT_OK && i < scene->relief.count; i++)
        status = add_feature(relief, report, scene, view, first_row, first_column, footprints,
                             &scene->relief.features[i], heights);
    if (status == SONJECT_OK) {
        if (scene->relief.heights_m)
            add_grid(relief, &scene->relief, view->is_mirrored, heights);
        taper_heights(relief, heights);
        relief_finish(relief);
        status = check_slopes(relief, report, view);
    }
    free(heights);
    return status;
}

sonject_status relief_create(struct relief **relief, struct report *report,
                             const struct scene *scene, const struct patch_view *view,
                             double first_row, double first_column,
                             const struct footprint *footprints)
{
    *relief = NULL;
    sonject_status status = relief_check_scene(scene, report);
    if (status != SONJECT_OK || !scene_has_relief(scene))
        return status;
    struct relief *made = allocate_array(1, sizeof *made);
    if (!made)
        return report_out_of_memory(report, "the seabed's relief");
    status = lay_grid(made, report, scene, view);
    THEN(status, fill(made, report, scene, view, first_row, first_column, footprints));
    if (status != SONJECT_OK)
        relief_release(&made);
    *relief = made;
    return status;
}

void relief_release(struct relief **relief)
{
    if (!*relief)
        return;
    free((*relief)->heights);
    free((*relief)->slopes);
    free(*relief);
    *relief = NULL;
}

double relief_height(const struct relief *relief, double x_m, double y_m)
{
    if (!relief)
        return 0.0;
    return mix_grid(relief->heights, relief->rows, relief->columns,
                    (x_m - relief->first_x_m) / relief->row_step_m,
                    (y_m - relief->first_y_m) / relief->column_step_m);
}
