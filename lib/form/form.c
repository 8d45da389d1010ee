#include "form/form.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/point_response.h"

#define SEARCH_STEP          64        /* bins looked at together */
#define SHORT_GAP            8         /* strips; copying them takes as long as another launch */
#define SPECKLE_ENERGY_SHARE 0.001     /* share of |W|^2 cut off from speckle and energies */
#define SORTED_FLOATS        (1 << 22) /* floats of a plane at a time */
#define COLUMN_STEP          16        /* lines are padded to whole groups of any width */

typedef char filled_span_is_packed[sizeof(struct filled_span) == 2 * 4 ? 1 : -1];

bool filled_span_is_empty(struct filled_span span)
{
    return span.first >= span.end;
}

static struct filled_span filled_part(const float *line, int32_t bins)
{
    static const float zeros[SEARCH_STEP];
    struct filled_span filled = {0, bins};
    while (filled.first + SEARCH_STEP <= filled.end &&
           memcmp(line + filled.first, zeros, sizeof zeros) == 0)
        filled.first += SEARCH_STEP;
    while (filled.first < filled.end && line[filled.first] == 0.0f)
        filled.first++;
    while (filled.end - SEARCH_STEP >= filled.first &&
           memcmp(line + filled.end - SEARCH_STEP, zeros, sizeof zeros) == 0)
        filled.end -= SEARCH_STEP;
    while (filled.end > filled.first && line[filled.end - 1] == 0.0f)
        filled.end--;
    return filled;
}

struct filled_span filled_span_of(const float *real_part, const float *imaginary_part, size_t bins)
{
    struct filled_span filled = filled_part(real_part, (int32_t)bins);
    if (!imaginary_part)
        return filled;
    const struct filled_span other = filled_part(imaginary_part, (int32_t)bins);
    if (filled_span_is_empty(filled))
        return other;
    if (filled_span_is_empty(other))
        return filled;
    filled.first = other.first < filled.first ? other.first : filled.first;
    filled.end = other.end > filled.end ? other.end : filled.end;
    return filled;
}

struct span next_filled_strips(const struct filled_span *filled, int32_t count, struct span before)
{
    struct span run = {before.first + before.count, 0};
    while (run.first < count && filled_span_is_empty(filled[run.first]))
        run.first++;
    for (int32_t i = run.first; i < count && i - run.first - run.count < SHORT_GAP; i++)
        if (!filled_span_is_empty(filled[i]))
            run.count = i - run.first + 1;
    return run;
}

/* Returns the pixels of `count` that cells first...end - 1 reach, at `per_pixel` cells a pixel and
 * `reach` cells to each side. */
static size_t reached(struct span cells, double per_pixel, int32_t reach, size_t count,
                      size_t *first)
{
    const double low = ceil(((double)cells.first - reach) / per_pixel);
    const double high = floor(((double)cells.first + cells.count - 1 + reach) / per_pixel);
    if (high < 0.0 || high < low || low >= (double)count)
        return 0;
    *first = (size_t)fmax(low, 0.0);
    return (size_t)fmin(high, (double)count - 1.0) + 1 - *first;
}

/* Chooses the pixels that the grid's cells reach through the pulse and the cross-range response. A
 * real aperture's columns begin with a block of the view's, so that all lines of the view share
 * their blocks' responses. */
static void choose_window(struct form_lines *lines, const struct patch_view *view,
                          int32_t taps_each_side)
{
    const struct line_grid *grid = &lines->grid;
    struct window *at = &lines->at;
    const size_t block = lines->response.array_length_m > 0.0 ? FORM_BLOCK_COLUMNS : 1;
    at->rows =
        reached(grid->strips, grid->strips_per_row, lines->reach, view->rows, &at->first_row);
    at->columns =
        reached(grid->bins, grid->bins_per_pixel, taps_each_side, view->columns, &at->first_column);
    at->columns = at->rows == 0 ? 0 : at->columns;
    if (at->columns == 0)
        return;
    at->columns += at->first_column % block;
    at->first_column -= at->first_column % block;
    lines->stride = (at->columns + COLUMN_STEP - 1) / COLUMN_STEP * COLUMN_STEP;
}

/* Makes the taps of G, or of |G|^2; both parts where G is complex. */
static sonject_status make_pulse(struct form_lines *lines, const struct patch_view *view,
                                 int32_t taps_each_side)
{
    const double bin = view->column_spacing_m / lines->grid.bins_per_pixel;
    const bool is_real = form_is_of_energies(lines) || range_response_is_real(&lines->response);
    lines->pulse_taps = 2 * taps_each_side + 1;
    lines->pulse_first = -taps_each_side - lines->grid.bins.first;
    const size_t count = (size_t)lines->pulse_taps;
    float *taps = allocate_array(2 * count, sizeof *taps);
    CHECK_MEMORY(lines->report, taps, "the pulse");
    for (int32_t tap = 0; tap < lines->pulse_taps; tap++) {
        /* G is taken at the pixel's range less the bin's */
        const struct complex_number g =
            range_response_complex(&lines->response, (taps_each_side - tap) * bin);
        const double energy = g.real_part * g.real_part + g.imaginary_part * g.imaginary_part;
        taps[tap] = (float)(form_is_of_energies(lines) ? energy : g.real_part);
        taps[count + (size_t)tap] = (float)g.imaginary_part;
    }
    sonject_status status =
        buffer_create(lines->report, lines->device, count * sizeof *taps, taps, &lines->pulse);
    if (status == SONJECT_OK && !is_real)
        status = buffer_create(lines->report, lines->device, count * sizeof *taps, taps + count,
                               &lines->imaginary_pulse);
    free(taps);
    return status;
}

int32_t form_reach(const struct patch_view *view, const struct point_response *response,
                   enum form_kind kind, uint32_t strips_per_row)
{
    const double whole = (double)view->rows * strips_per_row;
    const double strip = view->row_spacing_m / strips_per_row;
    const double reach = kind == FORM_GLINT ? cross_range_tail(response, view->farthest_m)
                                            : cross_range_energy_reach(response, view->farthest_m,
                                                                       SPECKLE_ENERGY_SHARE);
    return (int32_t)fmin(whole, ceil(reach / strip));
}

sonject_status form_lines_begin(struct form_lines *lines, struct report *report,
                                struct device *device, const struct patch_view *view,
                                const struct point_response *response, enum form_kind kind,
                                const struct line_grid *grid)
{
    memset(lines, 0, sizeof *lines);
    lines->report = report;
    lines->device = device;
    lines->grid = *grid;
    lines->kind = kind;
    lines->planes = kind == FORM_ENERGY && cross_range_is_plain(response) ? 1 : 2;
    lines->row_spacing_m = view->row_spacing_m;
    lines->view = view;
    lines->response = *response;
    lines->reach = form_reach(view, response, kind, grid->strips_per_row);
    const int32_t taps_each_side = kind == FORM_GLINT
                                       ? pulse_tail_bins(view, response, grid->bins_per_pixel)
                                       : pulse_reach_bins(view, response, grid->bins_per_pixel);
    choose_window(lines, view, taps_each_side);
    if (lines->at.columns == 0)
        return SONJECT_OK;
    const size_t bytes = (size_t)grid->strips.count * lines->stride * sizeof(float);
    lines->filled_columns =
        allocate_array((size_t)grid->strips.count, sizeof *lines->filled_columns);
    sonject_status status = lines->filled_columns ? make_pulse(lines, view, taps_each_side)
                                                  : report_out_of_memory(report, "image formation");
    for (int part = 0; part < 2; part++)
        THEN(status, buffer_reserve(report, device, bytes, &lines->lines[part]));
    THEN(status, kernel_create(report, device, PROGRAM_IMAGE_FORMATION, PROGRAM_PLAIN, "sort_bins",
                               &lines->sort));
    THEN(status, kernel_create(report, device, PROGRAM_IMAGE_FORMATION, PROGRAM_PLAIN,
                               lines->imaginary_pulse ? "compress_range_complex" : "compress_range",
                               &lines->compress));
    if (status != SONJECT_OK)
        form_lines_end(lines);
    return status;
}

void form_lines_end(struct form_lines *lines)
{
    kernel_release(lines->device, &lines->sort);
    kernel_release(lines->device, &lines->compress);
    for (int part = 0; part < 2; part++)
        buffer_release(lines->device, &lines->lines[part]);
    buffer_release(lines->device, &lines->pulse);
    buffer_release(lines->device, &lines->imaginary_pulse);
    free(lines->filled_columns);
    lines->filled_columns = NULL;
}

/* Lines that are compressed together. */
struct line_batch {
    int32_t strip;             /* number of the first line's strip */
    int32_t count;             /* lines */
    struct span bins;          /* of each line, counted from the grid's first */
    const device_buffer *data; /* two planes of count x bins.count; NULL: zeros */
    device_buffer filled;      /* struct filled_span of each line */
};

/* Returns the offset to j * bins_per_pixel from which column j takes bins of a line. */
static int32_t first_bin_of_columns(const struct form_lines *lines, struct span bins)
{
    return lines->pulse_first + (int32_t)(lines->at.first_column * lines->grid.bins_per_pixel) -
           bins.first;
}

/* Sorts some lines of each plane by the pixels that take their bins. */
static sonject_status sort_bins(struct form_lines *lines, const struct line_batch *batch,
                                struct span some, int32_t stride, device_buffer sorted[2])
{
    const int32_t bin_count = batch->bins.count;
    const int32_t per_pixel = (int32_t)lines->grid.bins_per_pixel;
    const int32_t first = first_bin_of_columns(lines, batch->bins);
    const size_t bytes = (size_t)some.count * (size_t)per_pixel * (size_t)stride * sizeof(float);
    const size_t global[2] = {(size_t)stride / lines->device->width, (size_t)some.count};
    for (size_t part = 0; part < lines->planes; part++) {
        if (!batch->data[part]) {
            CHECK(buffer_create(lines->report, lines->device, bytes, NULL, &sorted[part]));
            continue;
        }
        CHECK(buffer_reserve(lines->report, lines->device, bytes, &sorted[part]));
        const struct kernel_argument arguments[] = {ARGUMENT(batch->data[part]),
                                                    ARGUMENT(batch->filled),
                                                    ARGUMENT(some.first),
                                                    ARGUMENT(bin_count),
                                                    ARGUMENT(first),
                                                    ARGUMENT(per_pixel),
                                                    ARGUMENT(stride),
                                                    ARGUMENT(sorted[part])};
        CHECK(kernel_run(lines->report, lines->device, lines->sort, arguments, COUNT(arguments), 2,
                         global));
    }
    return SONJECT_OK;
}

static sonject_status compress_sorted(struct form_lines *lines, const struct line_batch *batch,
                                      struct span some, const device_buffer sorted[2],
                                      int32_t sorted_stride)
{
    const int32_t per_pixel = (int32_t)lines->grid.bins_per_pixel;
    const int32_t first = first_bin_of_columns(lines, batch->bins);
    const int32_t taps = lines->pulse_taps;
    const int32_t stride = (int32_t)lines->stride;
    const int32_t out_strip = batch->strip + some.first - lines->grid.strips.first;
    const bool is_complex = lines->imaginary_pulse != NULL; /* else the next one takes its place */
    struct kernel_argument arguments[14] = {
        ARGUMENT(sorted[0]),  ARGUMENT(sorted[1]), ARGUMENT(sorted_stride), ARGUMENT(batch->filled),
        ARGUMENT(some.first), ARGUMENT(first),     ARGUMENT(per_pixel),     ARGUMENT(lines->pulse)};
    const struct kernel_argument rest[] = {ARGUMENT(lines->imaginary_pulse),
                                           ARGUMENT(taps),
                                           ARGUMENT(stride),
                                           ARGUMENT(out_strip),
                                           ARGUMENT(lines->lines[0]),
                                           ARGUMENT(lines->lines[1])};
    const size_t left = is_complex ? 6 : 5;
    memcpy(&arguments[8], &rest[6 - left], left * sizeof *rest);
    const size_t global[3] = {lines->stride / lines->device->width, (size_t)some.count,
                              lines->planes};
    return kernel_run(lines->report, lines->device, lines->compress, arguments, 8 + left,
                      is_complex ? 2 : 3, global);
}

/* Compresses lines some at a time: a long pulse makes sorted lines far longer than the bins. */
static sonject_status compress(struct form_lines *lines, const struct line_batch *batch)
{
    const int32_t columns =
        (int32_t)lines->stride + (lines->pulse_taps - 1) / (int32_t)lines->grid.bins_per_pixel + 1;
    const int32_t stride = (columns + COLUMN_STEP - 1) / COLUMN_STEP * COLUMN_STEP;
    const int32_t fitting = SORTED_FLOATS / (stride * (int32_t)lines->grid.bins_per_pixel);
    const int32_t most = fitting > 1 ? fitting : 1;
    struct span some = {0, 0};
    sonject_status status = SONJECT_OK;
    for (; status == SONJECT_OK && some.first < batch->count; some.first += most) {
        device_buffer sorted[2] = {NULL, NULL};
        some.count = batch->count - some.first < most ? batch->count - some.first : most;
        status = sort_bins(lines, batch, some, stride, sorted);
        THEN(status, compress_sorted(lines, batch, some, sorted, stride));
        buffer_release(lines->device, &sorted[0]);
        buffer_release(lines->device, &sorted[1]);
    }
    return status;
}

/* Notes the columns that a line's filled bins reach. */
static void note_filled(struct form_lines *lines, const struct line_batch *batch, int32_t line,
                        struct filled_span filled)
{
    const int32_t per_pixel = (int32_t)lines->grid.bins_per_pixel;
    const int32_t first = first_bin_of_columns(lines, batch->bins);
    const int32_t before = filled.first - first - lines->pulse_taps; /* the last bin too early */
    struct filled_span *columns =
        &lines->filled_columns[batch->strip + line - lines->grid.strips.first];
    columns->first = before < 0 ? 0 : before / per_pixel + 1;
    columns->end = filled.end - 1 < first ? 0 : (filled.end - 1 - first) / per_pixel + 1;
}

/* Compresses lines that are on the device. */
static sonject_status compress_filled(struct form_lines *lines, struct line_batch *batch,
                                      const struct filled_span *filled)
{
    for (int32_t i = 0; i < batch->count; i++)
        if (!filled_span_is_empty(filled[i]))
            note_filled(lines, batch, i, filled[i]);
    sonject_status status =
        buffer_create(lines->report, lines->device, (size_t)batch->count * sizeof *filled, filled,
                      &batch->filled);
    THEN(status, compress(lines, batch));
    buffer_release(lines->device, &batch->filled);
    return status;
}

sonject_status form_lines_add(struct form_lines *lines, int32_t strip, int32_t count,
                              struct span bins, const float *real_part, const float *imaginary_part)
{
    const size_t width = (size_t)bins.count;
    if (lines->at.columns == 0 || count == 0 || bins.count == 0)
        return SONJECT_OK;
    struct filled_span *filled = allocate_array((size_t)count, sizeof *filled);
    CHECK_MEMORY(lines->report, filled, "image formation");
    for (size_t i = 0; i < (size_t)count; i++)
        filled[i] = filled_span_of(real_part + i * width,
                                   imaginary_part ? imaginary_part + i * width : NULL, width);
    struct span run = {0, 0};
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK && (run = next_filled_strips(filled, count, run)).count > 0) {
        const size_t at = (size_t)run.first * width;
        const size_t bytes = (size_t)run.count * width * sizeof(float);
        const float *parts[2] = {real_part + at, imaginary_part ? imaginary_part + at : NULL};
        device_buffer data[2] = {NULL, NULL};
        struct line_batch batch = {strip + run.first, run.count, bins, data, NULL};
        for (int part = 0; part < 2 && parts[part]; part++)
            THEN(status,
                 buffer_create(lines->report, lines->device, bytes, parts[part], &data[part]));
        THEN(status, compress_filled(lines, &batch, filled + run.first));
        buffer_release(lines->device, &data[0]);
        buffer_release(lines->device, &data[1]);
    }
    free(filled);
    return status;
}

sonject_status speckle_draw(struct report *report, struct device *device, struct span bins,
                            struct span strips, const float *energy, uint64_t seed, uint32_t stream,
                            device_buffer parts[2])
{
    const size_t bytes = (size_t)strips.count * (size_t)bins.count * sizeof(float);
    const uint32_t seed_low = (uint32_t)(seed & 0xffffffffu);
    const uint32_t seed_high = (uint32_t)(seed >> 32);
    device_buffer energies = NULL;
    device_kernel kernel = NULL;
    parts[0] = parts[1] = NULL;
    sonject_status status = kernel_create(report, device, PROGRAM_IMAGE_FORMATION, PROGRAM_PLAIN,
                                          "draw_speckle", &kernel);
    THEN(status, buffer_create(report, device, bytes, energy, &energies));
    THEN(status, buffer_reserve(report, device, bytes, &parts[0]));
    THEN(status, buffer_reserve(report, device, bytes, &parts[1]));
    if (status == SONJECT_OK) {
        const struct kernel_argument arguments[] = {
            ARGUMENT(energies),     ARGUMENT(bins.count), ARGUMENT(bins.first),
            ARGUMENT(strips.first), ARGUMENT(seed_low),   ARGUMENT(seed_high),
            ARGUMENT(stream),       ARGUMENT(parts[0]),   ARGUMENT(parts[1])};
        const size_t global[2] = {((size_t)bins.count + device->width - 1) / device->width,
                                  (size_t)strips.count};
        status = kernel_run(report, device, kernel, arguments, sizeof arguments / sizeof *arguments,
                            2, global);
    }
    buffer_release(device, &energies);
    kernel_release(device, &kernel);
    return status;
}

sonject_status form_lines_add_speckle(struct form_lines *lines, int32_t strip, int32_t count,
                                      const float *energy, uint64_t seed, uint32_t stream)
{
    const struct patch_view *view = lines->view;
    /* numbers are the whole patch's, so that a window's cells draw what they would there */
    const struct span strips = {strip + (int32_t)(view->first_row * lines->grid.strips_per_row),
                                count};
    const struct span numbers = {lines->grid.bins.first +
                                     (int32_t)(view->first_column * lines->grid.bins_per_pixel),
                                 lines->grid.bins.count};
    device_buffer data[2];
    struct line_batch batch = {strip, count, {0, lines->grid.bins.count}, data, NULL};
    if (lines->at.columns == 0 || count == 0)
        return SONJECT_OK;
    struct filled_span *filled = allocate_array((size_t)count, sizeof *filled);
    CHECK_MEMORY(lines->report, filled, "image formation");
    for (int32_t i = 0; i < count; i++) /* takes all bins for filled */
        filled[i].end = lines->grid.bins.count;
    sonject_status status =
        speckle_draw(lines->report, lines->device, numbers, strips, energy, seed, stream, data);
    THEN(status, compress_filled(lines, &batch, filled));
    buffer_release(lines->device, &data[0]);
    buffer_release(lines->device, &data[1]);
    free(filled);
    return status;
}

/* Reads a plane into rows that are `step` floats apart. */
static sonject_status read_plane(struct form_lines *lines, device_buffer plane, float *out,
                                 size_t step)
{
    const void *mapped;
    CHECK(buffer_map(lines->report, lines->device, plane,
                     lines->at.rows * lines->stride * sizeof *out, &mapped));
    const float *padded = mapped;
    for (size_t row = 0; row < lines->at.rows; row++)
        memcpy(out + row * step, padded + row * lines->stride, lines->at.columns * sizeof *out);
    buffer_unmap(lines->device, plane, mapped);
    return SONJECT_OK;
}

static sonject_status combine_into(struct form_lines *lines, float *real_part,
                                   float *imaginary_part, size_t step)
{
    const size_t bytes = lines->at.rows * lines->stride * sizeof(float);
    device_buffer out[2] = {NULL, NULL};
    sonject_status status = buffer_reserve(lines->report, lines->device, bytes, &out[0]);
    THEN(status, buffer_reserve(lines->report, lines->device, bytes, &out[1]));
    THEN(status, buffer_create(lines->report, lines->device,
                               (size_t)lines->grid.strips.count * sizeof *lines->filled_columns,
                               lines->filled_columns, &lines->filled));
    THEN(status, form_combine(lines, out));
    THEN(status, read_plane(lines, out[0], real_part, step));
    if (status == SONJECT_OK && lines->planes == 2 && imaginary_part)
        status = read_plane(lines, out[1], imaginary_part, step);
    buffer_release(lines->device, &out[0]);
    buffer_release(lines->device, &out[1]);
    buffer_release(lines->device, &lines->filled);
    return status;
}

sonject_status form_lines_finish(struct form_lines *lines, float *real_part, float *imaginary_part)
{
    return lines->at.columns == 0
               ? SONJECT_OK
               : combine_into(lines, real_part, imaginary_part, lines->at.columns);
}

sonject_status form_lines_finish_view(struct form_lines *lines, float *real_part,
                                      float *imaginary_part)
{
    const size_t columns = lines->view->columns;
    const size_t first = lines->at.first_row * columns + lines->at.first_column;
    if (lines->at.columns == 0)
        return SONJECT_OK;
    return combine_into(lines, real_part + first, imaginary_part ? imaginary_part + first : NULL,
                        columns);
}
