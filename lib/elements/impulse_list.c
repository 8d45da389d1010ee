#include "elements/impulse_list.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "device/device.h"

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

/* Buffers and the kernel of a drawing. */
struct drawing {
    device_buffer energy, real_part, imaginary_part;
    device_kernel kernel;
};

static sonject_status drawing_run(struct drawing *drawing, struct report *report,
                                  struct device *device, struct span bins, struct span strips,
                                  uint64_t seed, uint32_t stream)
{
    const int32_t bin_count = bins.count;
    const int32_t first_bin = bins.first;
    const int32_t first_strip = strips.first;
    const uint32_t seed_low = (uint32_t)(seed & 0xffffffffu);
    const uint32_t seed_high = (uint32_t)(seed >> 32);
    const uint32_t stream_number = stream;
    const struct kernel_argument arguments[] = {
        ARGUMENT(drawing->energy), ARGUMENT(bin_count),          ARGUMENT(first_bin),
        ARGUMENT(first_strip),     ARGUMENT(seed_low),           ARGUMENT(seed_high),
        ARGUMENT(stream_number),   ARGUMENT(drawing->real_part), ARGUMENT(drawing->imaginary_part)};
    const size_t global[2] = {((size_t)bins.count + device->width - 1) / device->width,
                              (size_t)strips.count};
    return kernel_run(report, device, drawing->kernel, arguments,
                      sizeof arguments / sizeof *arguments, 2, global);
}

/* sqrt(energy) times complex normal deviates that depend on seed, stream, strip and bin alone, for
 * strips.count x bins.count cells of one grid, in two planes. Errors: DEVICE, MEMORY. */
static sonject_status speckle_draw(struct report *report, struct device *device, struct span bins,
                                   struct span strips, const float *energy, uint64_t seed,
                                   uint32_t stream, float *real_part, float *imaginary_part)
{
    const size_t bytes = (size_t)strips.count * (size_t)bins.count * sizeof(float);
    struct drawing drawing = {NULL, NULL, NULL, NULL};
    sonject_status status =
        kernel_create(report, device, PROGRAM_IMAGE_FORMATION, 0, "draw_speckle", &drawing.kernel);
    THEN(status, buffer_create(report, device, bytes, energy, &drawing.energy));
    THEN(status, buffer_create(report, device, bytes, NULL, &drawing.real_part));
    THEN(status, buffer_create(report, device, bytes, NULL, &drawing.imaginary_part));
    THEN(status, drawing_run(&drawing, report, device, bins, strips, seed, stream));
    THEN(status, buffer_read(report, device, drawing.real_part, 0, bytes, real_part));
    THEN(status, buffer_read(report, device, drawing.imaginary_part, 0, bytes, imaginary_part));
    kernel_release(&drawing.kernel);
    buffer_release(&drawing.energy);
    buffer_release(&drawing.real_part);
    buffer_release(&drawing.imaginary_part);
    return status;
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
    float *real_part = allocate_array(cells, sizeof *real_part);
    float *imaginary_part = allocate_array(cells, sizeof *imaginary_part);
    sonject_status status =
        real_part && imaginary_part ? SONJECT_OK : report_out_of_memory(list->report, "speckle");
    THEN(status, speckle_draw(list->report, list->device, grid->bins, strips, energy, seed, stream,
                              real_part, imaginary_part));
    THEN(status, impulse_list_add(list, grid, strips, real_part, imaginary_part));
    free(real_part);
    free(imaginary_part);
    return status;
}
