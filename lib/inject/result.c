/* The result of an injection, from windows in the view's order to the patch in the image's. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "inject/compose.h"
#include "inject/injection.h"

static void injected_window_clear(struct injected_window *window)
{
    free(window->memory);
    free(window->picture);
    for (int i = 0; i < SCENE_INTERACTIONS_MAX; i++)
        free(window->order_energy[i]);
    memset(window, 0, sizeof *window);
}

void injection_result_clear(struct injection_result *result)
{
    for (size_t i = 0; i < result->window_count; i++)
        injected_window_clear(&result->windows[i]);
    free(result->windows);
    free(result->image);
    free(result->highlight);
    free(result->seabed_energy);
    free(result->objects);
    memset(result, 0, sizeof *result);
}

sonject_status injection_result_init(struct injection_result *result, const struct tracer *tracer,
                                     size_t windows, bool is_complex)
{
    const struct patch_view *view = &tracer->view;
    const size_t pixels = view->rows * view->columns;
    sonject_statistics *statistics = &result->statistics;
    result->rows = view->rows;
    result->columns = view->columns;
    result->is_complex = is_complex;
    result->object_count = tracer->scene->object_count;
    statistics->level_change_db = statistics->histogram_distance = statistics->correlation = NAN;
    statistics->input_contrast = statistics->output_contrast = statistics->energy_error = NAN;
    statistics->struct_size = sizeof *statistics;
    result->highlight = allocate_array(pixels, 4);
    result->windows = allocate_array(windows, sizeof *result->windows);
    result->seabed_energy = allocate_array(view->columns, sizeof(float));
    result->objects = allocate_array(result->object_count, sizeof *result->objects);
    CHECK_MEMORY(tracer->report,
                 result->highlight && result->windows && result->seabed_energy && result->objects,
                 "the result");
    result->shadow = result->highlight + pixels;
    result->labels = result->shadow + pixels;
    result->influence = result->labels + pixels;
    fill_cell_energies(view, &tracer->response, result->seabed_energy);
    return SONJECT_OK;
}

sonject_status injected_window_init(struct injected_window *window, struct report *report,
                                    const struct window *at, bool is_complex,
                                    sonject_object_truth *objects)
{
    const size_t pixels = at->rows * at->columns;
    const size_t parts = is_complex ? 2 : 1;
    window->at = *at;
    window->is_complex = is_complex;
    window->objects = objects;
    window->memory = allocate_array(pixels, 4 * sizeof(float));
    window->picture = allocate_array(pixels, parts * sizeof(float) + 4);
    CHECK_MEMORY(report, window->memory && window->picture, "the result");
    window->field = window->memory;
    window->energy = window->field + 2 * pixels;
    window->visibility = window->energy + pixels;
    window->image = window->picture;
    window->highlight = (uint8_t *)(window->image + parts * pixels);
    window->shadow = window->highlight + pixels;
    window->labels = window->shadow + pixels;
    window->influence = window->labels + pixels;
    return SONJECT_OK;
}

void injection_result_paste(struct injection_result *result, struct injected_window *window)
{
    const size_t width = window->at.columns;
    const size_t pixel_bytes = sizeof(float) * (result->is_complex ? 2 : 1);
    uint8_t *const masks[] = {result->highlight, result->shadow, result->labels, result->influence};
    uint8_t *const parts[] = {window->highlight, window->shadow, window->labels, window->influence};
    for (size_t row = 0; row < window->at.rows; row++) {
        const size_t to = (window->at.first_row + row) * result->columns + window->at.first_column;
        memcpy((char *)result->image + to * pixel_bytes,
               (const char *)window->image + row * width * pixel_bytes, width * pixel_bytes);
        for (int mask = 0; mask < 4; mask++)
            memcpy(masks[mask] + to, parts[mask] + row * width, width);
    }
    for (size_t i = 0; i < window->at.rows * width; i++)
        result->statistics.changed_pixels += window->influence[i] != 0;
    free(window->picture);
    window->picture = NULL;
}

void object_truth_move(sonject_object_truth *truth, const struct window *at)
{
    sonject_box *const boxes[] = {&truth->highlight, &truth->shadow, &truth->both};
    truth->row += (double)at->first_row;
    truth->column += (double)at->first_column;
    for (int i = 0; i < 3; i++)
        if (boxes[i]->rows > 0) {
            boxes[i]->first_row += at->first_row;
            boxes[i]->first_column += at->first_column;
        }
}

static void turn_box(const struct patch_view *view, sonject_box *box)
{
    if (box->rows > 0 && view->is_mirrored)
        box->first_row = view->rows - box->first_row - box->rows;
    if (box->rows > 0 && view->is_reversed)
        box->first_column = view->columns - box->first_column - box->columns;
}

static void turn_window_back(const struct patch_view *view, struct injected_window *window,
                             uint32_t orders)
{
    struct window *at = &window->at;
    view_turn_plane(view, at->rows, at->columns, window->field, sizeof(float) * 2);
    view_turn_plane(view, at->rows, at->columns, window->energy, sizeof(float));
    view_turn_plane(view, at->rows, at->columns, window->visibility, sizeof(float));
    for (uint32_t i = 0; i < orders; i++)
        view_turn_plane(view, at->rows, at->columns, window->order_energy[i], sizeof(float));
    if (view->is_mirrored)
        at->first_row = view->rows - at->first_row - at->rows;
    if (view->is_reversed)
        at->first_column = view->columns - at->first_column - at->columns;
}

void injection_result_turn_back(struct injection_result *result, const struct patch_view *view)
{
    view_turn_plane(view, view->rows, view->columns, result->image,
                    sizeof(float) * (result->is_complex ? 2 : 1));
    view_turn_plane(view, view->rows, view->columns, result->highlight, 1);
    view_turn_plane(view, view->rows, view->columns, result->shadow, 1);
    view_turn_plane(view, view->rows, view->columns, result->labels, 1);
    view_turn_plane(view, view->rows, view->columns, result->influence, 1);
    view_turn_plane(view, 1, view->columns, result->seabed_energy, sizeof(float));
    for (size_t i = 0; i < result->window_count; i++)
        turn_window_back(view, &result->windows[i], result->orders);
    for (uint32_t i = 0; i < result->object_count; i++) {
        sonject_object_truth *truth = &result->objects[i];
        truth->column = view_patch_column(view, truth->column);
        if (view->is_mirrored) {
            truth->row = (double)(view->rows - 1) - truth->row;
            truth->along_track_m = -truth->along_track_m;
        }
        turn_box(view, &truth->highlight);
        turn_box(view, &truth->shadow);
        turn_box(view, &truth->both);
    }
}

void injection_result_plane(const struct injection_result *result, enum injected_plane plane,
                            float *out)
{
    const size_t parts = plane == INJECTED_FIELD ? 2 : 1;
    const bool is_energy = plane == INJECTED_ENERGY || plane == INJECTED_ORDER;
    for (size_t i = 0; i < parts * result->rows * result->columns; i++)
        out[i] = plane == INJECTED_VISIBILITY ? 1.0f
                 : is_energy                  ? result->seabed_energy[i % result->columns]
                                              : 0.0f;
    for (size_t k = 0; k < result->window_count; k++) {
        const struct injected_window *window = &result->windows[k];
        const float *from = plane == INJECTED_FIELD    ? window->field
                            : plane == INJECTED_ENERGY ? window->energy
                            : plane == INJECTED_VISIBILITY
                                ? window->visibility
                                : window->order_energy[plane - INJECTED_ORDER];
        for (size_t row = 0; row < window->at.rows; row++)
            memcpy(out + parts * ((window->at.first_row + row) * result->columns +
                                  window->at.first_column),
                   from + parts * row * window->at.columns,
                   parts * window->at.columns * sizeof *out);
    }
}
