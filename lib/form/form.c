#include "form/form.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "device/device.h"
#include "form/combine_varied.h"
#include "kernels/layout.h"
#include "scene/point_response.h"

#define SEARCH_STEP          64    /* bins that are looked at together */
#define SHORT_GAP            8     /* strips: their copy takes as long as another launch */
#define SPECKLE_ENERGY_SHARE 0.001 /* of |W|^2 that is cut off from speckle and energies */
#define COLUMN_STEP          16    /* lines are padded to whole groups of any width */
#define ROWS_PER_ITEM        8     /* FORM_ROWS of kernels/image_formation.h */

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

/* The columns that the grid's bins reach through the pulse. */
static void choose_window(struct form_lines *lines, const struct patch_view *view,
                          int32_t taps_each_side)
{
    const double per_pixel = lines->grid.bins_per_pixel;
    const double first = ceil((double)(lines->grid.bins.first - taps_each_side) / per_pixel);
    const double last = floor(
        (double)(lines->grid.bins.first + lines->grid.bins.count - 1 + taps_each_side) / per_pixel);
    const double low = fmax(first, 0.0);
    const double high = fmin(last, (double)view->columns - 1.0);
    lines->first_column = high < low ? 0 : (size_t)low;
    lines->columns = high < low ? 0 : (size_t)(high - low) + 1;
    lines->stride = (lines->columns + COLUMN_STEP - 1) / COLUMN_STEP * COLUMN_STEP;
}

static sonject_status send_taps(struct form_lines *lines, const float *taps, size_t count,
                                device_buffer *buffer)
{
    return buffer_create(lines->report, lines->device, count * sizeof *taps, taps, buffer);
}

/* G, or |G|^2; both parts where it is complex. */
static sonject_status make_pulse(struct form_lines *lines, const struct patch_view *view,
                                 int32_t taps_each_side)
{
    const double bin = view->column_spacing_m / lines->grid.bins_per_pixel;
    const bool is_energy = form_is_of_energies(lines->kind);
    const bool is_real = is_energy || range_response_is_real(&lines->response);
    lines->pulse_taps = 2 * taps_each_side + 1;
    lines->pulse_first = -taps_each_side - lines->grid.bins.first;
    const size_t count = (size_t)lines->pulse_taps;
    float *taps = allocate_array(count, sizeof *taps);
    float *imaginary_taps = allocate_array(count, sizeof *taps);
    sonject_status status =
        taps && imaginary_taps ? SONJECT_OK : report_out_of_memory(lines->report, "the pulse");
    for (int32_t tap = 0; status == SONJECT_OK && tap < lines->pulse_taps; tap++) {
        /* at the pixel's range less the bin's */
        const struct complex_number g =
            range_response_complex(&lines->response, (taps_each_side - tap) * bin);
        const double energy = g.real_part * g.real_part + g.imaginary_part * g.imaginary_part;
        taps[tap] = (float)(is_energy ? energy : g.real_part);
        imaginary_taps[tap] = (float)g.imaginary_part;
    }
    THEN(status, send_taps(lines, taps, count, &lines->pulse));
    if (status == SONJECT_OK && !is_real)
        status = send_taps(lines, imaginary_taps, count, &lines->imaginary_pulse);
    free(taps);
    free(imaginary_taps);
    return status;
}

bool form_is_of_energies(enum form_kind kind)
{
    return kind == FORM_ENERGY || kind == FORM_TWO_ENERGIES;
}

int32_t form_reach(const struct patch_view *view, const struct point_response *response,
                   enum form_kind kind, uint32_t strips_per_row)
{
    const double whole = (double)view->rows * strips_per_row;
    const double strip = view->row_spacing_m / strips_per_row;
    const double farthest = view_processor_range(view, (double)(view->columns - 1));
    const double reach = kind == FORM_GLINT
                             ? cross_range_tail(response, farthest)
                             : cross_range_energy_reach(response, farthest, SPECKLE_ENERGY_SHARE);
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
    lines->rows = view->rows;
    lines->row_spacing_m = view->row_spacing_m;
    lines->view = view;
    lines->response = *response;
    lines->reach = form_reach(view, response, kind, grid->strips_per_row);
    const int32_t taps_each_side = kind == FORM_GLINT
                                       ? pulse_tail_bins(view, response, grid->bins_per_pixel)
                                       : pulse_reach_bins(view, response, grid->bins_per_pixel);
    choose_window(lines, view, taps_each_side);
    if (lines->columns == 0)
        return SONJECT_OK;
    const size_t bytes = (size_t)grid->strips.count * lines->stride * sizeof(float);
    lines->filled_columns =
        allocate_array((size_t)grid->strips.count, sizeof *lines->filled_columns);
    sonject_status status = lines->filled_columns ? make_pulse(lines, view, taps_each_side)
                                                  : report_out_of_memory(report, "image formation");
    THEN(status, buffer_create(report, device, bytes, NULL, &lines->real_lines));
    THEN(status, buffer_create(report, device, bytes, NULL, &lines->imaginary_lines));
    THEN(status, kernel_create(report, device, PROGRAM_IMAGE_FORMATION, 0,
                               lines->imaginary_pulse ? "compress_range_complex" : "compress_range",
                               &lines->compress));
    THEN(status, kernel_create(report, device, PROGRAM_IMAGE_FORMATION, 0, "combine_aspects",
                               &lines->combine));
    THEN(status, kernel_create(report, device, PROGRAM_IMAGE_FORMATION, 0, "draw_speckle",
                               &lines->speckle));
    if (status != SONJECT_OK)
        form_lines_end(lines);
    return status;
}

void form_lines_end(struct form_lines *lines)
{
    kernel_release(&lines->compress);
    kernel_release(&lines->combine);
    kernel_release(&lines->speckle);
    lines->compress = NULL;
    lines->combine = NULL;
    lines->speckle = NULL;
    buffer_release(&lines->real_lines);
    buffer_release(&lines->imaginary_lines);
    buffer_release(&lines->pulse);
    buffer_release(&lines->imaginary_pulse);
    free(lines->filled_columns);
    lines->filled_columns = NULL;
}

static sonject_status compress(struct form_lines *lines, int32_t strip, int32_t count,
                               device_buffer real_bins, device_buffer imaginary_bins,
                               device_buffer filled)
{
    const int32_t bins = lines->grid.bins.count;
    const int32_t per_pixel = (int32_t)lines->grid.bins_per_pixel;
    const int32_t first = lines->pulse_first + (int32_t)lines->first_column * per_pixel;
    const int32_t taps = lines->pulse_taps;
    const int32_t stride = (int32_t)lines->stride;
    const int32_t out_strip = strip - lines->grid.strips.first;
    const bool is_complex = lines->imaginary_pulse != NULL; /* else its place is the next one's */
    struct kernel_argument arguments[13] = {
        ARGUMENT(real_bins), ARGUMENT(imaginary_bins), ARGUMENT(filled),      ARGUMENT(bins),
        ARGUMENT(first),     ARGUMENT(per_pixel),      ARGUMENT(lines->pulse)};
    const struct kernel_argument rest[] = {ARGUMENT(lines->imaginary_pulse),
                                           ARGUMENT(taps),
                                           ARGUMENT(stride),
                                           ARGUMENT(out_strip),
                                           ARGUMENT(lines->real_lines),
                                           ARGUMENT(lines->imaginary_lines)};
    const size_t left = is_complex ? 6 : 5;
    memcpy(&arguments[7], &rest[6 - left], left * sizeof *rest);
    const size_t global[3] = {lines->stride / lines->device->width, (size_t)count, lines->planes};
    return kernel_run(lines->report, lines->device, lines->compress, arguments, 7 + left,
                      is_complex ? 2 : 3, global);
}

/* Notes the columns of a strip's line that filled bins reach: column j takes the bins from
 * j * bins_per_pixel + `first` on. */
static void note_filled(struct form_lines *lines, int32_t strip, struct filled_span bins)
{
    const int32_t per_pixel = (int32_t)lines->grid.bins_per_pixel;
    const int32_t first = lines->pulse_first + (int32_t)lines->first_column * per_pixel;
    const int32_t before = bins.first - first - lines->pulse_taps; /* the last bin too early */
    struct filled_span *columns = &lines->filled_columns[strip - lines->grid.strips.first];
    columns->first = before < 0 ? 0 : before / per_pixel + 1;
    columns->end = bins.end - 1 < first ? 0 : (bins.end - 1 - first) / per_pixel + 1;
}

/* Compresses strips of which the device has the bins. */
static sonject_status compress_filled(struct form_lines *lines, int32_t strip, int32_t count,
                                      device_buffer real_bins, device_buffer imaginary_bins,
                                      const struct filled_span *filled)
{
    device_buffer buffer = NULL;
    for (int32_t i = 0; i < count; i++)
        if (!filled_span_is_empty(filled[i]))
            note_filled(lines, strip + i, filled[i]);
    sonject_status status = buffer_create(lines->report, lines->device,
                                          (size_t)count * sizeof *filled, filled, &buffer);
    THEN(status, compress(lines, strip, count, real_bins, imaginary_bins, buffer));
    buffer_release(&buffer);
    return status;
}

static sonject_status add_run(struct form_lines *lines, int32_t strip, int32_t count,
                              const float *real_part, const float *imaginary_part,
                              const struct filled_span *filled)
{
    const size_t bytes = (size_t)count * (size_t)lines->grid.bins.count * sizeof(float);
    device_buffer real_bins = NULL;
    device_buffer imaginary_bins = NULL;
    sonject_status status =
        buffer_create(lines->report, lines->device, bytes, real_part, &real_bins);
    THEN(status,
         buffer_create(lines->report, lines->device, bytes, imaginary_part, &imaginary_bins));
    THEN(status, compress_filled(lines, strip, count, real_bins, imaginary_bins, filled));
    buffer_release(&real_bins);
    buffer_release(&imaginary_bins);
    return status;
}

sonject_status form_lines_add(struct form_lines *lines, int32_t strip, int32_t count,
                              const float *real_part, const float *imaginary_part)
{
    const size_t bins = (size_t)lines->grid.bins.count;
    if (lines->columns == 0 || count == 0)
        return SONJECT_OK;
    struct filled_span *filled = allocate_array((size_t)count, sizeof *filled);
    CHECK_MEMORY(lines->report, filled, "image formation");
    for (size_t i = 0; i < (size_t)count; i++)
        filled[i] = filled_span_of(real_part + i * bins,
                                   imaginary_part ? imaginary_part + i * bins : NULL, bins);
    struct span run = {0, 0};
    sonject_status status = SONJECT_OK;
    while (status == SONJECT_OK && (run = next_filled_strips(filled, count, run)).count > 0) {
        const size_t at = (size_t)run.first * bins;
        status = add_run(lines, strip + run.first, run.count, real_part + at,
                         imaginary_part ? imaginary_part + at : NULL, filled + run.first);
    }
    free(filled);
    return status;
}

/* Of strips that are all taken for filled. */
static sonject_status compress_all(struct form_lines *lines, int32_t strip, int32_t count,
                                   device_buffer real_bins, device_buffer imaginary_bins)
{
    struct filled_span *filled = allocate_array((size_t)count, sizeof *filled);
    CHECK_MEMORY(lines->report, filled, "image formation");
    for (int32_t i = 0; i < count; i++)
        filled[i].end = lines->grid.bins.count;
    const sonject_status status =
        compress_filled(lines, strip, count, real_bins, imaginary_bins, filled);
    free(filled);
    return status;
}

sonject_status form_lines_add_speckle(struct form_lines *lines, int32_t strip, int32_t count,
                                      const float *energy, uint64_t seed, uint32_t stream)
{
    if (lines->columns == 0 || count == 0)
        return SONJECT_OK;
    const size_t bytes = (size_t)count * (size_t)lines->grid.bins.count * sizeof(float);
    device_buffer energies = NULL;
    device_buffer real_bins = NULL;
    device_buffer imaginary_bins = NULL;
    sonject_status status = buffer_create(lines->report, lines->device, bytes, energy, &energies);
    THEN(status, buffer_create(lines->report, lines->device, bytes, NULL, &real_bins));
    THEN(status, buffer_create(lines->report, lines->device, bytes, NULL, &imaginary_bins));
    if (status == SONJECT_OK) {
        const int32_t bins = lines->grid.bins.count;
        const int32_t first_bin = lines->grid.bins.first;
        const int32_t first_strip = strip;
        const uint32_t seed_low = (uint32_t)(seed & 0xffffffffu);
        const uint32_t seed_high = (uint32_t)(seed >> 32);
        const uint32_t stream_number = stream;
        const struct kernel_argument arguments[] = {
            ARGUMENT(energies),      ARGUMENT(bins),      ARGUMENT(first_bin),
            ARGUMENT(first_strip),   ARGUMENT(seed_low),  ARGUMENT(seed_high),
            ARGUMENT(stream_number), ARGUMENT(real_bins), ARGUMENT(imaginary_bins)};
        const size_t width = lines->device->width;
        const size_t global[2] = {((size_t)bins + width - 1) / width, (size_t)count};
        status = kernel_run(lines->report, lines->device, lines->speckle, arguments,
                            sizeof arguments / sizeof *arguments, 2, global);
    }
    THEN(status, compress_all(lines, strip, count, real_bins, imaginary_bins));
    buffer_release(&energies);
    buffer_release(&real_bins);
    buffer_release(&imaginary_bins);
    return status;
}

/* W (or |W|^2) at the offsets n * strips_per_row - q of pixel row n from strip q, among the zeros
 * that let a work-item take one strip into all of its rows. */
static float *response_taps(const struct form_lines *lines, size_t *count)
{
    const double per_row = lines->grid.strips_per_row;
    const size_t zeros = (ROWS_PER_ITEM - 1) * (size_t)lines->grid.strips_per_row;
    *count = 2 * (size_t)lines->reach + 1 + 2 * zeros;
    float *taps = allocate_array(*count, sizeof *taps);
    for (size_t i = 0; taps && i <= 2 * (size_t)lines->reach; i++) {
        const double strips = (double)i - lines->reach;
        const double rows = strips / per_row + 0.5 - 0.5 / per_row;
        const double w = along_track_response(&lines->response, rows * lines->row_spacing_m);
        taps[zeros + i] = (float)(form_is_of_energies(lines->kind) ? w * w : w);
    }
    return taps;
}

static sonject_status combine(struct form_lines *lines, device_buffer taps, device_buffer real_out,
                              device_buffer imaginary_out)
{
    if (!cross_range_is_plain(&lines->response))
        return combine_varied(lines, real_out, imaginary_out);
    const int32_t first_strip = lines->grid.strips.first;
    const int32_t end_strip = first_strip + lines->grid.strips.count;
    const int32_t per_row = (int32_t)lines->grid.strips_per_row;
    const int32_t reach = lines->reach;
    const int32_t stride = (int32_t)lines->stride;
    const int32_t rows = (int32_t)lines->rows;
    const struct kernel_argument arguments[] = {ARGUMENT(first_strip),
                                                ARGUMENT(end_strip),
                                                ARGUMENT(per_row),
                                                ARGUMENT(reach),
                                                ARGUMENT(lines->real_lines),
                                                ARGUMENT(lines->imaginary_lines),
                                                ARGUMENT(lines->filled),
                                                ARGUMENT(stride),
                                                ARGUMENT(taps),
                                                ARGUMENT(rows),
                                                ARGUMENT(real_out),
                                                ARGUMENT(imaginary_out)};
    const size_t global[3] = {lines->stride / lines->device->width,
                              (lines->rows + ROWS_PER_ITEM - 1) / ROWS_PER_ITEM, lines->planes};
    return kernel_run(lines->report, lines->device, lines->combine, arguments,
                      sizeof arguments / sizeof *arguments, 3, global);
}

/* Reads a plane and drops the padding of its rows. */
static sonject_status read_plane(struct form_lines *lines, device_buffer plane, float *padded,
                                 float *out)
{
    const sonject_status status = buffer_read(lines->report, lines->device, plane, 0,
                                              lines->rows * lines->stride * sizeof(float), padded);
    if (status == SONJECT_OK)
        for (size_t row = 0; row < lines->rows; row++)
            memcpy(out + row * lines->columns, padded + row * lines->stride,
                   lines->columns * sizeof *out);
    return status;
}

sonject_status form_lines_finish(struct form_lines *lines, float *real_part, float *imaginary_part)
{
    if (lines->columns == 0)
        return SONJECT_OK;
    size_t count;
    const size_t plane = lines->rows * lines->stride;
    device_buffer tap_buffer = NULL;
    device_buffer real_out = NULL;
    device_buffer imaginary_out = NULL;
    float *taps = response_taps(lines, &count);
    float *padded = allocate_array(plane, sizeof *padded);
    sonject_status status =
        taps && padded ? SONJECT_OK : report_out_of_memory(lines->report, "image formation");
    THEN(status,
         buffer_create(lines->report, lines->device, count * sizeof *taps, taps, &tap_buffer));
    THEN(status,
         buffer_create(lines->report, lines->device, plane * sizeof(float), NULL, &real_out));
    THEN(status,
         buffer_create(lines->report, lines->device, plane * sizeof(float), NULL, &imaginary_out));
    THEN(status, buffer_create(lines->report, lines->device,
                               (size_t)lines->grid.strips.count * sizeof *lines->filled_columns,
                               lines->filled_columns, &lines->filled));
    THEN(status, combine(lines, tap_buffer, real_out, imaginary_out));
    THEN(status, read_plane(lines, real_out, padded, real_part));
    if (status == SONJECT_OK && lines->planes == 2 && imaginary_part)
        status = read_plane(lines, imaginary_out, padded, imaginary_part);
    buffer_release(&tap_buffer);
    buffer_release(&real_out);
    buffer_release(&imaginary_out);
    buffer_release(&lines->filled);
    free(taps);
    free(padded);
    return status;
}
