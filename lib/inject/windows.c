#include "inject/windows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "form/form.h"
#include "inject/echoes.h"
#include "measure/contacts.h"
#include "trace/chains.h"
#include "trace/multibounce.h"
#include "trace/rough.h"

#define TRUTH_MARGIN  (CONTACT_MARGIN + SEABED_MARGIN)
#define JOINING_COSTS 65536.0 /* pixels that can be traced while a window is set up */

/* A range of the view's rows and columns, both ends included. */
struct extent {
    double first_row, last_row, first_column, last_column;
};

static void include_rows(struct extent *extent, double first, double last)
{
    extent->first_row = fmin(extent->first_row, first);
    extent->last_row = fmax(extent->last_row, last);
}

static void include_columns(struct extent *extent, double first, double last)
{
    extent->first_column = fmin(extent->first_column, first);
    extent->last_column = fmax(extent->last_column, last);
}

/* Includes the echoes and the shadow of a part on a grid, as the response spreads them. */
static void include_echoes(struct extent *extent, const struct tracer *tracer, uint32_t part,
                           const struct point_response *response, bool by_beam)
{
    struct line_grid grid;
    line_grid_for_patch(&grid, &tracer->view, response);
    const double per_row = grid.strips_per_row;
    const double per_pixel = grid.bins_per_pixel;
    const struct span strips = rough_strips_of_part(tracer, part, &grid, by_beam);
    const struct span bins = rough_bins_of_part(tracer, part, &grid, by_beam);
    const bool is_smooth = material_is_smooth(&tracer->placements[part].material);
    const double along = form_reach(&tracer->view, response, is_smooth ? FORM_GLINT : FORM_FIELD,
                                    grid.strips_per_row);
    const double pulse = is_smooth ? pulse_tail_bins(&tracer->view, response, grid.bins_per_pixel)
                                   : pulse_reach_bins(&tracer->view, response, grid.bins_per_pixel);
    include_rows(extent, (strips.first - along) / per_row,
                 (strips.first + strips.count + along) / per_row);
    include_columns(extent, (bins.first - pulse) / per_pixel,
                    (bins.first + bins.count + pulse) / per_pixel);
}

/* Includes echoes of several interactions, in the columns behind the part's own. Each detour to
 * seabed within reach adds at most the distance there and back to the path. Along the track two
 * interactions focus halfway. */
static void include_chains(struct extent *extent, const struct tracer *tracer, uint32_t part)
{
    const struct patch_view *view = &tracer->view;
    const struct placement *placement = &tracer->placements[part];
    const double around = chain_reach_of(tracer, placement).around_m;
    const sonject_injection_params *injection = &tracer->scene->injection;
    const bool is_halfway =
        injection->interactions == 2 && injection->column_rule == SONJECT_COLUMNS_FOCUSED;
    const double farthest =
        placement_range(placement, view) + (injection->interactions - 1.0) * around;
    struct line_grid grid;
    line_grid_for_patch(&grid, view, &tracer->response);
    if (sea_surface_is_in_chains(tracer, &grid)) {
        include_rows(extent, 0.0, (double)view->rows);
        include_columns(extent, extent->first_column, (double)view->columns);
        return;
    }
    const double along = is_halfway ? 0.5 * around + placement->bounding_radius_m : around;
    include_rows(extent, view_row_of_x(view, placement->centre[0] - along),
                 view_row_of_x(view, placement->centre[0] + along));
    include_columns(extent, extent->first_column,
                    view_column_of_range(view, farthest * view->range_ratio));
}

/* Includes echoes by several smooth faces, which lie along the track between their parts. */
static void include_multibounce(struct extent *extent, const struct tracer *tracer, uint32_t part)
{
    struct line_grid grid;
    line_grid_for_patch(&grid, &tracer->view, &tracer->response);
    const struct span bins = multibounce_bins(tracer, part, &grid, false);
    const double pulse = pulse_tail_bins(&tracer->view, &tracer->response, grid.bins_per_pixel);
    if (bins.count > 0)
        include_columns(extent, (bins.first - pulse) / grid.bins_per_pixel,
                        (bins.first + bins.count + pulse) / grid.bins_per_pixel);
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *placement = &tracer->placements[i];
        if (material_is_smooth(&placement->material))
            include_rows(
                extent,
                view_row_of_x(&tracer->view, placement->centre[0] - placement->bounding_radius_m),
                view_row_of_x(&tracer->view, placement->centre[0] + placement->bounding_radius_m));
    }
}

static struct extent extent_of_object(const struct tracer *tracer,
                                      const struct placed_object *object)
{
    struct extent extent = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    struct point_response of_pings;
    response_of_pings(&of_pings, tracer);
    for (uint32_t k = 0; k < object->part_count; k++) {
        const uint32_t part = object->first_part + k;
        include_echoes(&extent, tracer, part, &tracer->response, false);
        if (has_beam_shadows(tracer))
            include_echoes(&extent, tracer, part, &of_pings, true);
        if (multibounce_may_echo(tracer, part))
            include_multibounce(&extent, tracer, part);
        if (tracer->scene->injection.interactions > 1)
            include_chains(&extent, tracer, part);
    }
    return extent;
}

/* Returns whole blocks of pixels of `count` from first to last with a margin. The columns of a
 * block share a beam's response in the patch. With whole blocks, a response that differs a little
 * has the same window. */
static size_t pixels_between(double first, double last, size_t count, size_t *start)
{
    const double block = floor((first - TRUTH_MARGIN) / FORM_BLOCK_COLUMNS);
    const double end_block = ceil((last + TRUTH_MARGIN + 1.0) / FORM_BLOCK_COLUMNS);
    const double begin = fmax(0.0, block * FORM_BLOCK_COLUMNS);
    const double end = fmin((double)count, end_block * FORM_BLOCK_COLUMNS);
    *start = (size_t)fmin(begin, (double)count - 1.0);
    return end > (double)*start ? (size_t)end - *start : 1;
}

static void join(struct influence_window *one, const struct influence_window *other)
{
    const size_t row = one->at.first_row + one->at.rows;
    const size_t column = one->at.first_column + one->at.columns;
    const size_t other_row = other->at.first_row + other->at.rows;
    const size_t other_column = other->at.first_column + other->at.columns;
    if (other->at.first_row < one->at.first_row)
        one->at.first_row = other->at.first_row;
    if (other->at.first_column < one->at.first_column)
        one->at.first_column = other->at.first_column;
    one->at.rows = (row > other_row ? row : other_row) - one->at.first_row;
    one->at.columns = (column > other_column ? column : other_column) - one->at.first_column;
    for (size_t i = 0; i < SCENE_OBJECTS_MAX; i++)
        one->follows[i] = one->follows[i] || other->follows[i];
}

static double pixels_in(const struct influence_window *window)
{
    return (double)window->at.rows * (double)window->at.columns;
}

/* Returns whether one window for both costs less than two. Overlapping windows share pixels and are
 * always joined. */
static bool belong_together(const struct influence_window *one,
                            const struct influence_window *other)
{
    struct influence_window both = *one;
    join(&both, other);
    const bool overlap = both.at.rows < one->at.rows + other->at.rows &&
                         both.at.columns < one->at.columns + other->at.columns;
    return overlap || pixels_in(&both) < pixels_in(one) + pixels_in(other) + JOINING_COSTS;
}

static void join_neighbours(struct influence_windows *windows)
{
    bool has_joined = true;
    while (has_joined) {
        has_joined = false;
        for (size_t i = 0; i < windows->count; i++)
            for (size_t k = i + 1; k < windows->count; k++)
                if (belong_together(&windows->list[i], &windows->list[k])) {
                    join(&windows->list[i], &windows->list[k]);
                    windows->list[k--] = windows->list[--windows->count];
                    has_joined = true;
                }
    }
}

static bool changes_all(const struct tracer *tracer)
{
    const struct scene *scene = tracer->scene;
    return scene->injection.mode == SONJECT_MODE_RESYNTHESISE ||
           scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE || tracer->relief ||
           tracer->response.motion || scene->object_count == 0;
}

sonject_status influence_windows_find(struct influence_windows *windows,
                                      const struct tracer *tracer, bool is_whole)
{
    const struct patch_view *view = &tracer->view;
    const uint32_t objects = tracer->scene->object_count;
    const bool is_one = is_whole || changes_all(tracer);
    windows->count = is_one ? 1 : objects;
    windows->list = allocate_array(windows->count, sizeof *windows->list);
    CHECK_MEMORY(tracer->report, windows->list, "the objects' windows");
    for (uint32_t i = 0; is_one && i < objects; i++)
        windows->list[0].follows[i] = true;
    if (is_one)
        windows->list[0].at = (struct window){0, view->rows, 0, view->columns};
    for (uint32_t i = 0; !is_one && i < objects; i++) {
        struct influence_window *window = &windows->list[i];
        const struct extent extent = extent_of_object(tracer, &tracer->objects[i]);
        window->follows[i] = true;
        window->at.rows =
            pixels_between(extent.first_row, extent.last_row, view->rows, &window->at.first_row);
        window->at.columns = pixels_between(extent.first_column, extent.last_column, view->columns,
                                            &window->at.first_column);
    }
    join_neighbours(windows);
    return SONJECT_OK;
}

void influence_windows_clear(struct influence_windows *windows)
{
    free(windows->list);
    memset(windows, 0, sizeof *windows);
}
