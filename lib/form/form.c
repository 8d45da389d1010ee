#include "form/form.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "device/device.h"
#include "kernels/layout.h"
#include "scene/motion_response.h"
#include "scene/point_response.h"

#define SEARCH_STEP          64    /* bins that are looked at together */
#define SHORT_GAP            8     /* strips: their copy takes as long as another launch */
#define SPECKLE_ENERGY_SHARE 0.001 /* of |W|^2 that is cut off from speckle and energies */
#define COLUMN_STEP          16    /* lines are padded to whole groups of any width */
#define ROWS_PER_ITEM        8     /* FORM_ROWS of kernels/image_formation.h */
#define BLOCK_COLUMNS        16    /* that share a response; holds whole groups of any width */
#define TAPS_OF_A_RUN        ((size_t)1 << 22)

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

static bool is_of_energies(const struct form_lines *lines)
{
    return lines->kind == FORM_ENERGY || lines->kind == FORM_TWO_ENERGIES;
}

/* G, or |G|^2; both parts where it is complex. */
static sonject_status make_pulse(struct form_lines *lines, const struct patch_view *view,
                                 int32_t taps_each_side)
{
    const double bin = view->column_spacing_m / lines->grid.bins_per_pixel;
    const bool is_real = is_of_energies(lines) || range_response_is_real(&lines->response);
    lines->pulse_taps = 2 * taps_each_side + 1;
    lines->pulse_first = -taps_each_side - lines->grid.bins.first;
    const size_t count = (size_t)lines->pulse_taps;
    float *taps = allocate_array(2 * count, sizeof *taps);
    CHECK_MEMORY(lines->report, taps, "the pulse");
    for (int32_t tap = 0; tap < lines->pulse_taps; tap++) {
        /* at the pixel's range less the bin's */
        const struct complex_number g =
            range_response_complex(&lines->response, (taps_each_side - tap) * bin);
        const double energy = g.real_part * g.real_part + g.imaginary_part * g.imaginary_part;
        taps[tap] = (float)(is_of_energies(lines) ? energy : g.real_part);
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
    for (int part = 0; part < 2; part++)
        THEN(status, buffer_create(report, device, bytes, NULL, &lines->lines[part]));
    THEN(status, kernel_create(report, device, PROGRAM_IMAGE_FORMATION, 0,
                               lines->imaginary_pulse ? "compress_range_complex" : "compress_range",
                               &lines->compress));
    if (status != SONJECT_OK)
        form_lines_end(lines);
    return status;
}

void form_lines_end(struct form_lines *lines)
{
    kernel_release(&lines->compress);
    for (int part = 0; part < 2; part++)
        buffer_release(&lines->lines[part]);
    buffer_release(&lines->pulse);
    buffer_release(&lines->imaginary_pulse);
    free(lines->filled_columns);
    lines->filled_columns = NULL;
}

static sonject_status compress(struct form_lines *lines, int32_t strip, int32_t count,
                               const device_buffer bins[2], device_buffer filled)
{
    const int32_t bin_count = lines->grid.bins.count;
    const int32_t per_pixel = (int32_t)lines->grid.bins_per_pixel;
    const int32_t first = lines->pulse_first + (int32_t)lines->first_column * per_pixel;
    const int32_t taps = lines->pulse_taps;
    const int32_t stride = (int32_t)lines->stride;
    const int32_t out_strip = strip - lines->grid.strips.first;
    const bool is_complex = lines->imaginary_pulse != NULL; /* else its place is the next one's */
    struct kernel_argument arguments[13] = {
        ARGUMENT(bins[0]), ARGUMENT(bins[1]),   ARGUMENT(filled),      ARGUMENT(bin_count),
        ARGUMENT(first),   ARGUMENT(per_pixel), ARGUMENT(lines->pulse)};
    const struct kernel_argument rest[] = {ARGUMENT(lines->imaginary_pulse),
                                           ARGUMENT(taps),
                                           ARGUMENT(stride),
                                           ARGUMENT(out_strip),
                                           ARGUMENT(lines->lines[0]),
                                           ARGUMENT(lines->lines[1])};
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
                                      const device_buffer bins[2], const struct filled_span *filled)
{
    device_buffer buffer = NULL;
    for (int32_t i = 0; i < count; i++)
        if (!filled_span_is_empty(filled[i]))
            note_filled(lines, strip + i, filled[i]);
    sonject_status status = buffer_create(lines->report, lines->device,
                                          (size_t)count * sizeof *filled, filled, &buffer);
    THEN(status, compress(lines, strip, count, bins, buffer));
    buffer_release(&buffer);
    return status;
}

sonject_status form_lines_add(struct form_lines *lines, int32_t strip, int32_t count,
                              const float *real_part, const float *imaginary_part)
{
    const size_t width = (size_t)lines->grid.bins.count;
    if (lines->columns == 0 || count == 0)
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
        device_buffer bins[2] = {NULL, NULL};
        for (int part = 0; part < 2; part++)
            THEN(status,
                 buffer_create(lines->report, lines->device, bytes, parts[part], &bins[part]));
        THEN(status,
             compress_filled(lines, strip + run.first, run.count, bins, filled + run.first));
        buffer_release(&bins[0]);
        buffer_release(&bins[1]);
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
    sonject_status status =
        kernel_create(report, device, PROGRAM_IMAGE_FORMATION, 0, "draw_speckle", &kernel);
    THEN(status, buffer_create(report, device, bytes, energy, &energies));
    THEN(status, buffer_create(report, device, bytes, NULL, &parts[0]));
    THEN(status, buffer_create(report, device, bytes, NULL, &parts[1]));
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
    buffer_release(&energies);
    kernel_release(&kernel);
    return status;
}

sonject_status form_lines_add_speckle(struct form_lines *lines, int32_t strip, int32_t count,
                                      const float *energy, uint64_t seed, uint32_t stream)
{
    const struct span strips = {strip, count};
    device_buffer bins[2];
    if (lines->columns == 0 || count == 0)
        return SONJECT_OK;
    struct filled_span *filled = allocate_array((size_t)count, sizeof *filled);
    CHECK_MEMORY(lines->report, filled, "image formation");
    for (int32_t i = 0; i < count; i++) /* all are taken for filled */
        filled[i].end = lines->grid.bins.count;
    sonject_status status = speckle_draw(lines->report, lines->device, lines->grid.bins, strips,
                                         energy, seed, stream, bins);
    THEN(status, compress_filled(lines, strip, count, bins, filled));
    buffer_release(&bins[0]);
    buffer_release(&bins[1]);
    free(filled);
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
        taps[zeros + i] = (float)(is_of_energies(lines) ? w * w : w);
    }
    return taps;
}

/* One real response for all rows and columns. */
static sonject_status combine_plain(struct form_lines *lines, const device_buffer out[2])
{
    size_t count;
    const int32_t first_strip = lines->grid.strips.first;
    const int32_t end_strip = first_strip + lines->grid.strips.count;
    const int32_t per_row = (int32_t)lines->grid.strips_per_row;
    const int32_t stride = (int32_t)lines->stride;
    const int32_t rows = (int32_t)lines->rows;
    device_buffer buffer = NULL;
    device_kernel kernel = NULL;
    float *taps = response_taps(lines, &count);
    CHECK_MEMORY(lines->report, taps, "image formation");
    sonject_status status = kernel_create(lines->report, lines->device, PROGRAM_IMAGE_FORMATION, 0,
                                          "combine_aspects", &kernel);
    THEN(status, buffer_create(lines->report, lines->device, count * sizeof *taps, taps, &buffer));
    if (status == SONJECT_OK) {
        const struct kernel_argument arguments[] = {
            ARGUMENT(first_strip),   ARGUMENT(end_strip),       ARGUMENT(per_row),
            ARGUMENT(lines->reach),  ARGUMENT(lines->lines[0]), ARGUMENT(lines->lines[1]),
            ARGUMENT(lines->filled), ARGUMENT(stride),          ARGUMENT(buffer),
            ARGUMENT(rows),          ARGUMENT(out[0]),          ARGUMENT(out[1])};
        const size_t global[3] = {lines->stride / lines->device->width,
                                  (lines->rows + ROWS_PER_ITEM - 1) / ROWS_PER_ITEM, lines->planes};
        status = kernel_run(lines->report, lines->device, kernel, arguments,
                            sizeof arguments / sizeof *arguments, 3, global);
    }
    buffer_release(&buffer);
    kernel_release(&kernel);
    free(taps);
    return status;
}

/* The taps of a run of rows, where the cross-range response is not one real function: complex (a
 * measured one), another at each range (a real aperture), or another for each row (residual
 * motion). */
struct taps {
    size_t each;         /* taps of one response */
    size_t rows, blocks; /* responses: 1 where all rows, all columns share one */
    float *parts[2];
    double *response[2]; /* one response */
};

static sonject_status taps_init(struct taps *taps, const struct form_lines *lines)
{
    memset(taps, 0, sizeof *taps);
    taps->each = 2 * (size_t)lines->reach + 1;
    taps->blocks = lines->response.array_length_m > 0.0
                       ? (lines->columns + BLOCK_COLUMNS - 1) / BLOCK_COLUMNS
                       : 1;
    taps->rows = 1;
    if (lines->response.motion) {
        const size_t most = TAPS_OF_A_RUN / taps->each / ROWS_PER_ITEM * ROWS_PER_ITEM;
        taps->rows = most < ROWS_PER_ITEM ? ROWS_PER_ITEM : most;
        taps->rows = taps->rows < lines->rows ? taps->rows : lines->rows;
    }
    for (int part = 0; part < 2; part++) {
        taps->parts[part] = allocate_array(taps->each * taps->rows * taps->blocks, sizeof(float));
        taps->response[part] = allocate_array(taps->each, sizeof(double));
        CHECK_MEMORY(lines->report, taps->parts[part] && taps->response[part], "image formation");
    }
    return SONJECT_OK;
}

static void taps_clear(struct taps *taps)
{
    for (int part = 0; part < 2; part++) {
        free(taps->parts[part]);
        free(taps->response[part]);
    }
}

/* Distance of a pixel from the middle of the strip of the tap in the middle: rows' middles are
 * those of their strips. */
static double offset_of(const struct form_lines *lines)
{
    return (0.5 - 0.5 / lines->grid.strips_per_row) * lines->row_spacing_m;
}

/* Keeps the response as one of many: W, or |W|^2. */
static void store(struct taps *taps, const struct form_lines *lines, size_t number)
{
    const size_t first = number * taps->each;
    for (size_t i = 0; i < taps->each; i++) {
        const double a = taps->response[0][i];
        const double b = taps->response[1][i];
        taps->parts[0][first + i] = (float)(is_of_energies(lines) ? a * a + b * b : a);
        taps->parts[1][first + i] = is_of_energies(lines) ? 0.0f : (float)b;
    }
}

/* One response for each block of columns. */
static void fill_blocks(struct taps *taps, const struct form_lines *lines)
{
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    for (size_t block = 0; block < taps->blocks; block++) {
        const double column =
            (double)lines->first_column + ((double)block + 0.5) * BLOCK_COLUMNS - 0.5;
        const double range = view_processor_range(lines->view, column);
        for (size_t i = 0; i < taps->each; i++) {
            const struct complex_number w = cross_range_response(
                &lines->response, range, ((double)i - lines->reach) * strip + offset_of(lines));
            taps->response[0][i] = w.real_part;
            taps->response[1][i] = w.imaginary_part;
        }
        store(taps, lines, block);
    }
}

static sonject_status run_rows(struct form_lines *lines, device_kernel kernel,
                               const struct taps *taps, size_t first_row,
                               const device_buffer out[2])
{
    const size_t bytes = taps->each * taps->rows * taps->blocks * sizeof(float);
    device_buffer parts[2] = {NULL, NULL};
    sonject_status status = SONJECT_OK;
    for (int part = 0; part < 2; part++)
        THEN(status,
             buffer_create(lines->report, lines->device, bytes, taps->parts[part], &parts[part]));
    if (status == SONJECT_OK) {
        const bool by_row = lines->response.motion != NULL;
        const size_t left = lines->rows - first_row;
        const size_t some = by_row && taps->rows < left ? taps->rows : left;
        const int32_t first_strip = lines->grid.strips.first;
        const int32_t end_strip = first_strip + lines->grid.strips.count;
        const int32_t per_row = (int32_t)lines->grid.strips_per_row;
        const int32_t row = (int32_t)first_row;
        const int32_t row_step = by_row ? (int32_t)taps->each : 0;
        const int32_t block_columns = BLOCK_COLUMNS;
        const int32_t block_step = taps->blocks > 1 ? (int32_t)taps->each : 0;
        const int32_t stride = (int32_t)lines->stride;
        const int32_t rows = (int32_t)(first_row + some);
        const struct kernel_argument arguments[] = {
            ARGUMENT(first_strip),     ARGUMENT(end_strip),     ARGUMENT(per_row),
            ARGUMENT(lines->reach),    ARGUMENT(row),           ARGUMENT(row_step),
            ARGUMENT(block_columns),   ARGUMENT(block_step),    ARGUMENT(lines->lines[0]),
            ARGUMENT(lines->lines[1]), ARGUMENT(lines->filled), ARGUMENT(stride),
            ARGUMENT(parts[0]),        ARGUMENT(parts[1]),      ARGUMENT(rows),
            ARGUMENT(out[0]),          ARGUMENT(out[1])};
        const size_t global[2] = {lines->stride / lines->device->width,
                                  (some + ROWS_PER_ITEM - 1) / ROWS_PER_ITEM};
        status = kernel_run(lines->report, lines->device, kernel, arguments,
                            sizeof arguments / sizeof *arguments, 2, global);
    }
    buffer_release(&parts[0]);
    buffer_release(&parts[1]);
    return status;
}

/* Rows of their own responses, some at a time. */
static sonject_status run_moved(struct form_lines *lines, device_kernel kernel, struct taps *taps,
                                const device_buffer out[2])
{
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    struct motion_response motion;
    CHECK(motion_response_begin(&motion, lines->report, &lines->response, lines->view, strip,
                                offset_of(lines), lines->reach));
    sonject_status status = SONJECT_OK;
    for (size_t first = 0; status == SONJECT_OK && first < lines->rows; first += taps->rows) {
        for (size_t i = 0; i < taps->rows && first + i < lines->rows; i++) {
            motion_response_row(&motion, (double)(first + i), taps->response[0], taps->response[1]);
            store(taps, lines, i);
        }
        status = run_rows(lines, kernel, taps, first, out);
    }
    motion_response_end(&motion);
    return status;
}

static sonject_status combine_varied(struct form_lines *lines, const device_buffer out[2])
{
    struct taps taps;
    device_kernel kernel = NULL;
    sonject_status status = taps_init(&taps, lines);
    THEN(status, kernel_create(lines->report, lines->device, PROGRAM_IMAGE_FORMATION, 0,
                               "combine_varied", &kernel));
    if (status == SONJECT_OK && lines->response.motion) {
        status = run_moved(lines, kernel, &taps, out);
    } else if (status == SONJECT_OK) {
        fill_blocks(&taps, lines);
        status = run_rows(lines, kernel, &taps, 0, out);
    }
    kernel_release(&kernel);
    taps_clear(&taps);
    return status;
}

/* Reads a plane and drops the padding of its rows. */
static sonject_status read_plane(struct form_lines *lines, device_buffer plane, float *out)
{
    float *padded = allocate_array(lines->rows * lines->stride, sizeof *padded);
    CHECK_MEMORY(lines->report, padded, "image formation");
    const sonject_status status = buffer_read(lines->report, lines->device, plane, 0,
                                              lines->rows * lines->stride * sizeof(float), padded);
    for (size_t row = 0; status == SONJECT_OK && row < lines->rows; row++)
        memcpy(out + row * lines->columns, padded + row * lines->stride,
               lines->columns * sizeof *out);
    free(padded);
    return status;
}

sonject_status form_lines_finish(struct form_lines *lines, float *real_part, float *imaginary_part)
{
    if (lines->columns == 0)
        return SONJECT_OK;
    const size_t bytes = lines->rows * lines->stride * sizeof(float);
    device_buffer out[2] = {NULL, NULL};
    sonject_status status = buffer_create(lines->report, lines->device, bytes, NULL, &out[0]);
    THEN(status, buffer_create(lines->report, lines->device, bytes, NULL, &out[1]));
    THEN(status, buffer_create(lines->report, lines->device,
                               (size_t)lines->grid.strips.count * sizeof *lines->filled_columns,
                               lines->filled_columns, &lines->filled));
    THEN(status, cross_range_is_plain(&lines->response) ? combine_plain(lines, out)
                                                        : combine_varied(lines, out));
    THEN(status, read_plane(lines, out[0], real_part));
    if (status == SONJECT_OK && lines->planes == 2 && imaginary_part)
        status = read_plane(lines, out[1], imaginary_part);
    buffer_release(&out[0]);
    buffer_release(&out[1]);
    buffer_release(&lines->filled);
    return status;
}
