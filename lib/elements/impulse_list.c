#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "elements/elements.h"
#include "form/form.h"

#define MICROPASCAL 1e-6

static void scale_piece(struct impulse_piece *piece, const struct patch_view *view, double pressure,
                        double absorption_db_per_m)
{
    const double bin_width = view->column_spacing_m / piece->grid.bins_per_pixel;
    const double reference = view_processor_range(view, 0.0);
    for (size_t i = 0; i < piece->count; i++) {
        const double processor_range = reference + piece->bins[i] * bin_width;
        const double way = 2.0 * processor_range / view->range_ratio;
        const double factor = pressure * pow(10.0, -absorption_db_per_m * way / 20.0);
        piece->real_part[i] = (float)(piece->real_part[i] * factor);
        piece->imaginary_part[i] = (float)(piece->imaginary_part[i] * factor);
    }
}

void impulse_list_set_source_level(struct impulse_list *list, const struct patch_view *view,
                                   double source_level_db, double absorption_db_per_m)
{
    const double pressure = sqrt(2.0) * MICROPASCAL * pow(10.0, source_level_db / 20.0);
    for (size_t i = 0; i < list->count; i++)
        scale_piece(&list->pieces[i], view, pressure, absorption_db_per_m);
}

void impulse_list_init(struct impulse_list *list, struct report *report, struct device *device)
{
    memset(list, 0, sizeof *list);
    list->report = report;
    list->device = device;
}

static void piece_clear(struct impulse_piece *piece)
{
    free(piece->starts);
    free(piece->bins);
    free(piece->real_part);
    free(piece->imaginary_part);
    memset(piece, 0, sizeof *piece);
}

void impulse_list_clear(struct impulse_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        piece_clear(&list->pieces[i]);
    free(list->pieces);
    list->pieces = NULL;
    list->count = 0;
}

static size_t count_impulses(const float *real_part, const float *imaginary_part, size_t cells)
{
    size_t count = 0;
    for (size_t i = 0; i < cells; i++)
        count += real_part[i] != 0.0f || imaginary_part[i] != 0.0f;
    return count;
}

static sonject_status piece_init(struct impulse_piece *piece, struct report *report,
                                 const struct line_grid *grid, struct span strips, size_t count)
{
    memset(piece, 0, sizeof *piece);
    piece->grid = *grid;
    piece->grid.strips = strips;
    piece->count = count;
    piece->starts = allocate_array((size_t)strips.count + 1, sizeof *piece->starts);
    piece->bins = allocate_array(count, sizeof *piece->bins);
    piece->real_part = allocate_array(count, sizeof *piece->real_part);
    piece->imaginary_part = allocate_array(count, sizeof *piece->imaginary_part);
    if (piece->starts && piece->bins && piece->real_part && piece->imaginary_part)
        return SONJECT_OK;
    piece_clear(piece);
    return report_out_of_memory(report, "impulses");
}

static void piece_fill(struct impulse_piece *piece, const float *real_part,
                       const float *imaginary_part)
{
    const struct span bins = piece->grid.bins;
    int32_t next = 0;
    piece->last_bin = bins.first;
    for (int32_t strip = 0; strip < piece->grid.strips.count; strip++) {
        const size_t line = (size_t)strip * (size_t)bins.count;
        piece->starts[strip] = next;
        for (int32_t bin = 0; bin < bins.count; bin++) {
            const float a = real_part[line + (size_t)bin];
            const float b = imaginary_part[line + (size_t)bin];
            if (a == 0.0f && b == 0.0f)
                continue;
            const int32_t number = bins.first + bin;
            piece->bins[next] = number;
            piece->real_part[next] = a;
            piece->imaginary_part[next++] = b;
            piece->last_bin = number > piece->last_bin ? number : piece->last_bin;
        }
    }
    piece->starts[piece->grid.strips.count] = next;
}

sonject_status impulse_list_add(struct impulse_list *list, const struct line_grid *grid,
                                struct span strips, const float *real_part,
                                const float *imaginary_part)
{
    const size_t cells = (size_t)strips.count * (size_t)grid->bins.count;
    const size_t count = count_impulses(real_part, imaginary_part, cells);
    if (count == 0)
        return SONJECT_OK;
    if (count > INT32_MAX)
        return report_failure(list->report, SONJECT_ERROR_INPUT,
                              "elements: the patch has more than 2^31 - 1 impulses in one piece: "
                              "use a smaller patch");
    struct impulse_piece *grown = realloc(list->pieces, (list->count + 1) * sizeof *list->pieces);
    CHECK_MEMORY(list->report, grown, "impulses");
    list->pieces = grown;
    struct impulse_piece *piece = &list->pieces[list->count];
    CHECK(piece_init(piece, list->report, grid, strips, count));
    piece_fill(piece, real_part, imaginary_part);
    list->count++;
    return SONJECT_OK;
}

sonject_status impulse_list_add_speckle(struct impulse_list *list, const struct line_grid *grid,
                                        struct span strips, const float *energy, uint64_t seed,
                                        uint32_t stream)
{
    const size_t cells = (size_t)strips.count * (size_t)grid->bins.count;
    if (cells == 0)
        return SONJECT_OK;
    float *parts = allocate_array(2 * cells, sizeof *parts);
    CHECK_MEMORY(list->report, parts, "speckle");
    device_buffer drawn[2];
    sonject_status status =
        speckle_draw(list->report, list->device, grid->bins, strips, energy, seed, stream, drawn);
    for (size_t part = 0; part < 2; part++) {
        THEN(status, buffer_read(list->report, list->device, drawn[part], 0, cells * sizeof *parts,
                                 parts + part * cells));
        buffer_release(list->device, &drawn[part]);
    }
    THEN(status, impulse_list_add(list, grid, strips, parts, parts + cells));
    free(parts);
    return status;
}
