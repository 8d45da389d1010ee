#include "scene/relief.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/random_field.h"

#define PI 3.14159265358979323846

#define POINTS_PER_PIXEL      2.0
#define POINTS_PER_WAVELENGTH 24.0 /* points wanted, also over a bump's radius */
#define POINTS_LEAST          8.0  /* least points; slopes then err by 1 % */
#define POINTS_MAX            (UINT32_C(1) << 22)
#define SIDE_MAX              16384.0
#define SLOPE_MAX             1.75 /* 60 degrees: sand never stands so steep, rocks may */

/* The wander of crests, as in lib/image/synthetic.c. It is relative to the regular train of crests;
 * where the two cancel a crest forks. Lengths are deviations of the blur in wavelengths. */
#define WANDERS        2
#define STREAM_WANDERS 0x5eabed60u /* a stream that neither tracer nor synthetic seabed uses */
#define FULL_STRENGTH  0.6         /* relative height from which a crest has its full height */
static const double wander_lengths[WANDERS] = {1.5, 0.5};
static const double wander_strengths[WANDERS] = {1.1, 0.25};

/* A relief while it is made. */
struct making {
    struct report *report;
    const struct scene *scene;
    const struct patch_view *view;
    double first_row, first_column; /* patch's first pixel in the swath */
    const struct footprint *footprints;
    struct relief *relief;
    double *heights; /* heights before they fall to 0 at the edges */
};

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

/* Refuses combinations with relief: a smooth seabed, a coherent map, heights near the sonar. */
static sonject_status check_scene(const struct scene *scene, struct report *report)
{
    const sonject_material_params *forward = &scene->seabed.forward;
    double lowest, highest;
    if (forward->reflection_kind == SONJECT_REFLECTION_FLUID || forward->reflection != 0.0)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "a seabed with relief cannot be smooth, because mirror images of the sonar need a "
            "level plane: remove seabed.relief or the reflection of seabed.forward");
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

/* Lays the grid over the whole patch, including the pixels' edges. */
static sonject_status lay_grid(struct making *making)
{
    const struct scene *scene = making->scene;
    const struct patch_view *view = making->view;
    struct relief *relief = making->relief;
    const double near = view_ground_range(view, view_processor_range(view, -0.5));
    const double first_y =
        near > 0.0 ? near : view_ground_range(view, view_processor_range(view, 0.0));
    const double length = (double)view->rows * view->row_spacing_m;
    const double width =
        view_ground_range(view, view_processor_range(view, (double)view->columns - 0.5)) - first_y;
    double finest = INFINITY; /* finest scale of all features, m */
    double step = fmin(view->row_spacing_m, view->column_spacing_m) / POINTS_PER_PIXEL;
    for (uint32_t i = 0; i < scene->relief.count; i++) {
        const struct relief_feature *feature = &scene->relief.features[i];
        finest = fmin(finest, feature->kind == RELIEF_RIPPLES ? feature->wavelength_m
                              : feature->kind == RELIEF_SCOUR ? feature->width_m
                                                              : feature->radius_m);
    }
    if (scene->relief
            .heights_m) { /* the step follows the file's, down to one that no pixel shows */
        const sonject_relief_params *grid = &scene->relief.grid;
        step = fmin(step, fmax(0.5 * step, fmin(grid->row_spacing_m, grid->column_spacing_m)));
    }
    step = fmin(step, finest / POINTS_PER_WAVELENGTH);
    step = fmax(step, sqrt(length * width / POINTS_MAX));
    step = fmax(step, fmax(length, width) / SIDE_MAX);
    if (step * POINTS_LEAST > finest)
        return report_failure(
            making->report, SONJECT_ERROR_INPUT,
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

/* Returns a raised cosine: 1 at 0, 0 from 1 on. */
static double raised_cosine(double share)
{
    return share < 1.0 ? 0.5 + 0.5 * cos(PI * share) : 0.0;
}

/* ---- Features. */

/* Returns the distance from the ground that an object covers, 0 within it. */
static double outside_of(const struct footprint *footprint, double x, double y)
{
    const double dx = x - footprint->x_m;
    const double dy = y - footprint->y_m;
    const double along = fabs(dx * footprint->along_x + dy * footprint->along_y);
    const double across = fabs(dx * footprint->along_y - dy * footprint->along_x);
    return fmax(0.0, hypot(fmax(0.0, along - footprint->half_length_m), across) -
                         footprint->half_width_m);
}

static uint32_t limited_index(double index, uint32_t count)
{
    return (uint32_t)fmin(fmax(index, 0.0), count);
}

/* Adds a height (of any sign) that falls to 0 over a width around a footprint. */
static void add_bump(const struct making *making, const struct footprint *footprint, double width,
                     double height)
{
    const struct relief *relief = making->relief;
    const double reach = footprint->half_length_m + footprint->half_width_m + width;
    const double row = (footprint->x_m - relief->first_x_m) / relief->row_step_m;
    const double column = (footprint->y_m - relief->first_y_m) / relief->column_step_m;
    const double rows = reach / relief->row_step_m;
    const double columns = reach / relief->column_step_m;
    const uint32_t end_row = limited_index(ceil(row + rows) + 1.0, relief->rows);
    const uint32_t end_column = limited_index(ceil(column + columns) + 1.0, relief->columns);
    for (uint32_t i = limited_index(floor(row - rows), relief->rows); i < end_row; i++)
        for (uint32_t k = limited_index(floor(column - columns), relief->columns); k < end_column;
             k++) {
            const double outside = outside_of(footprint, relief_x(relief, i), relief_y(relief, k));
            if (outside / width < 1.0)
                making->heights[(size_t)i * relief->columns + k] +=
                    height * raised_cosine(outside / width);
        }
}

static sonject_status find_object(const struct making *making, const char *name, uint32_t *number)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < making->scene->object_count; i++)
        if (strcmp(making->scene->objects[i].name, name) == 0) {
            *number = i;
            found++;
        }
    if (found == 1)
        return SONJECT_OK;
    return report_failure(making->report, SONJECT_ERROR_INPUT,
                          "seabed.relief: scour around '%s': %s object has that name", name,
                          found == 0 ? "no" : "more than one");
}

/* Returns the profile of ripples, of mean 0 and 2 from trough to crest. The second harmonic narrows
 * crests and widens troughs. Above a quarter of the first it would add a crest in each trough. */
static double ripple_profile(double cosine, double sharpness)
{
    return cosine + 0.25 * sharpness * (2.0 * cosine * cosine - 1.0);
}

static void add_ripples_to_row(const struct relief *relief, const struct relief_feature *feature,
                               struct random_field *fields[WANDERS], double along, double *heights)
{
    const float *wander_cosine[WANDERS];
    const float *wander_sine[WANDERS];
    const double wavenumber = 2.0 * PI / feature->wavelength_m;
    for (int i = 0; i < WANDERS; i++)
        if (fields[i])
            random_field_next_row(fields[i], &wander_cosine[i], &wander_sine[i]);
    for (uint32_t column = 0; column < relief->columns; column++) {
        const double phase = wavenumber * (along * cos(feature->heading_rad) +
                                           relief_y(relief, column) * sin(feature->heading_rad)) +
                             feature->phase_rad;
        double a = 1.0;
        double b = 0.0;
        for (int i = 0; i < WANDERS; i++)
            if (fields[i]) {
                const double strength = feature->irregularity * wander_strengths[i];
                a += strength * (double)wander_cosine[i][column];
                b += strength * (double)wander_sine[i][column];
            }
        const double length = hypot(a, b) + 1e-20;
        const double cosine = (cos(phase) * a - sin(phase) * b) / length;
        heights[column] += 0.5 * feature->height_m * fmin(1.0, length / FULL_STRENGTH) *
                           ripple_profile(cosine, feature->sharpness);
    }
}

/* Adds ripples. Wanders are drawn in the scene's row order, also where the view is mirrored. */
static sonject_status add_ripples(const struct making *making, const struct relief_feature *feature)
{
    const struct relief *relief = making->relief;
    struct random_field *fields[WANDERS] = {NULL, NULL};
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; i < WANDERS && feature->irregularity > 0.0; i++) {
        const double length = wander_lengths[i] * feature->wavelength_m;
        const struct blur along_track = {BLUR_GAUSSIAN, length / relief->row_step_m};
        const struct blur range = {BLUR_GAUSSIAN, length / relief->column_step_m};
        THEN(status, random_field_create(making->report, feature->seed, STREAM_WANDERS + i,
                                         relief->columns, along_track, range, &fields[i]));
    }
    for (uint32_t i = 0; status == SONJECT_OK && i < relief->rows; i++) {
        const uint32_t row = making->view->is_mirrored ? relief->rows - 1 - i : i;
        const double x = relief_x(relief, row);
        add_ripples_to_row(relief, feature, fields, making->view->is_mirrored ? -x : x,
                           making->heights + (size_t)row * relief->columns);
    }
    for (int i = 0; i < WANDERS; i++)
        random_field_release(&fields[i]);
    return status;
}

static sonject_status add_feature(const struct making *making, const struct relief_feature *feature)
{
    const struct patch_view *view = making->view;
    double row, column;
    uint32_t object = 0;
    if (feature->kind == RELIEF_RIPPLES)
        return add_ripples(making, feature);
    if (feature->kind == RELIEF_SCOUR) {
        uint32_t end = making->scene->object_count;
        if (*feature->object) {
            CHECK(find_object(making, feature->object, &object));
            end = object + 1;
        }
        for (; object < end; object++)
            add_bump(making, &making->footprints[object], feature->width_m, -feature->height_m);
        return SONJECT_OK;
    }
    view_find_pixel(view, making->first_row, making->first_column, feature->position_kind,
                    feature->position_along, feature->position_range, &row, &column);
    const struct footprint point = {.x_m = view_x_of_row(view, row),
                                    .y_m =
                                        view_ground_range(view, view_processor_range(view, column)),
                                    .along_x = 1.0};
    add_bump(making, &point, feature->radius_m,
             feature->kind == RELIEF_MOUND ? feature->height_m : -feature->height_m);
    return SONJECT_OK;
}

/* Interpolates a grid bilinearly at fractional indices; 0 outside. */
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

/* Returns the factor of the patch's edge on heights `inside` m from it. */
static double taper(double inside, double side)
{
    const double width = fmin(RELIEF_TAPER_M, RELIEF_TAPER_SHARE * side);
    return raised_cosine(1.0 - fmin(1.0, fmax(0.0, inside / width)));
}

/* Adds the file's heights, and lets all fall to 0 at the edges. */
static void finish_heights(const struct making *making)
{
    struct relief *relief = making->relief;
    const struct relief_features *features = &making->scene->relief;
    const sonject_relief_params *grid = &features->grid;
    const double length = (relief->rows - 1) * relief->row_step_m;
    const double width = (relief->columns - 1) * relief->column_step_m;
    for (uint32_t row = 0; row < relief->rows; row++)
        for (uint32_t column = 0; column < relief->columns; column++) {
            const size_t i = (size_t)row * relief->columns + column;
            const double view_x = relief_x(relief, row);
            const double x = row * relief->row_step_m;
            const double y = column * relief->column_step_m;
            double height = making->heights[i];
            if (features->heights_m)
                height += mix_grid(
                    features->heights_m, grid->rows, grid->columns,
                    ((making->view->is_mirrored ? -view_x : view_x) - grid->first_along_track_m) /
                        grid->row_spacing_m,
                    (relief_y(relief, column) - grid->first_ground_range_m) /
                        grid->column_spacing_m);
            const bool is_edge =
                row == 0 || column == 0 || row + 1 == relief->rows || column + 1 == relief->columns;
            const double kept =
                taper(fmin(x, length - x), length) * taper(fmin(y, width - y), width);
            relief->heights[i] = is_edge ? 0.0f : (float)(kept * height);
        }
}

/* Returns the difference at point `at` of `count` points, `stride` apart; 0 at the level ends. */
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
            const float *of_row = relief->heights + (size_t)row * relief->columns;
            relief->slopes[2 * i] =
                (float)(difference(relief->heights + column, relief->columns, row, relief->rows) /
                        relief->row_step_m);
            relief->slopes[2 * i + 1] =
                (float)(difference(of_row, 1, column, relief->columns) / relief->column_step_m);
            relief->lowest_m = fmin(relief->lowest_m, (double)relief->heights[i]);
            relief->highest_m = fmax(relief->highest_m, (double)relief->heights[i]);
        }
}

/* Checks slopes along the cells' edges, which no step between two points escapes. */
static sonject_status check_slopes(const struct making *making)
{
    const struct relief *relief = making->relief;
    for (uint32_t row = 0; row + 1 < relief->rows; row++)
        for (uint32_t column = 0; column + 1 < relief->columns; column++) {
            const float *at = relief->heights + (size_t)row * relief->columns + column;
            const double along = ((double)at[relief->columns] - (double)at[0]) / relief->row_step_m;
            const double across = ((double)at[1] - (double)at[0]) / relief->column_step_m;
            const double x = relief_x(relief, row);
            if (hypot(along, across) > SLOPE_MAX)
                return report_failure(making->report, SONJECT_ERROR_INPUT,
                                      "the seabed's relief rises by %.0f degrees at %.2f m "
                                      "along-track, %.2f m ground range; at most 60 are possible: "
                                      "make it lower or wider",
                                      atan(hypot(along, across)) * 180.0 / PI,
                                      making->view->is_mirrored ? -x : x, relief_y(relief, column));
        }
    return SONJECT_OK;
}

static sonject_status make(struct making *making)
{
    struct relief *relief = making->relief;
    CHECK(lay_grid(making));
    const size_t points = (size_t)relief->rows * relief->columns;
    making->heights = allocate_array(points, sizeof *making->heights);
    relief->heights = allocate_array(points, sizeof *relief->heights);
    relief->slopes = allocate_array(points, 2 * sizeof *relief->slopes);
    CHECK_MEMORY(making->report, making->heights && relief->heights && relief->slopes,
                 "the seabed's relief");
    for (uint32_t i = 0; i < making->scene->relief.count; i++)
        CHECK(add_feature(making, &making->scene->relief.features[i]));
    finish_heights(making);
    relief_finish(relief);
    return check_slopes(making);
}

sonject_status relief_create(struct relief **relief, struct report *report,
                             const struct scene *scene, const struct patch_view *view,
                             double first_row, double first_column,
                             const struct footprint *footprints)
{
    *relief = NULL;
    if (!scene_has_relief(scene))
        return SONJECT_OK;
    CHECK(check_scene(scene, report));
    *relief = allocate_array(1, sizeof **relief);
    CHECK_MEMORY(report, *relief, "the seabed's relief");
    struct making making = {report,       scene,      view,    first_row,
                            first_column, footprints, *relief, NULL};
    const sonject_status status = make(&making);
    free(making.heights);
    if (status != SONJECT_OK)
        relief_release(relief);
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
