/* The cross-range response: combines lines of columns into rows. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "form/form.h"
#include "scene/motion_response.h"

#define ROWS_PER_ITEM 8 /* equals FORM_ROWS of kernels/image_formation.h */
#define TAPS_OF_A_RUN ((size_t)1 << 22)

/* Returns W (or |W|^2) at the offsets n * strips_per_row - q of pixel row n from strip q. Zeros
 * around it let a work-item take one strip into all of its rows. */
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
        taps[zeros + i] = (float)(form_is_of_energies(lines) ? w * w : w);
    }
    return taps;
}

/* Returns the number of the grid's first strip, counted from that of the first row formed. */
static int32_t first_strip_of(const struct form_lines *lines)
{
    return lines->grid.strips.first - (int32_t)(lines->at.first_row * lines->grid.strips_per_row);
}

/* Combines lines by one real response for all rows and columns. */
static sonject_status combine_plain(struct form_lines *lines, const device_buffer out[2])
{
    size_t count;
    const int32_t first_strip = first_strip_of(lines);
    const int32_t end_strip = first_strip + lines->grid.strips.count;
    const int32_t per_row = (int32_t)lines->grid.strips_per_row;
    const int32_t stride = (int32_t)lines->stride;
    const int32_t rows = (int32_t)lines->at.rows;
    device_buffer buffer = NULL;
    device_kernel kernel = NULL;
    float *taps = response_taps(lines, &count);
    CHECK_MEMORY(lines->report, taps, "image formation");
    sonject_status status = kernel_create(lines->report, lines->device, PROGRAM_IMAGE_FORMATION,
                                          PROGRAM_PLAIN, "combine_aspects", &kernel);
    THEN(status, buffer_create(lines->report, lines->device, count * sizeof *taps, taps, &buffer));
    if (status == SONJECT_OK) {
        const struct kernel_argument arguments[] = {
            ARGUMENT(first_strip),   ARGUMENT(end_strip),       ARGUMENT(per_row),
            ARGUMENT(lines->reach),  ARGUMENT(lines->lines[0]), ARGUMENT(lines->lines[1]),
            ARGUMENT(lines->filled), ARGUMENT(stride),          ARGUMENT(buffer),
            ARGUMENT(rows),          ARGUMENT(out[0]),          ARGUMENT(out[1])};
        const size_t global[3] = {lines->stride / lines->device->width,
                                  (lines->at.rows + ROWS_PER_ITEM - 1) / ROWS_PER_ITEM,
                                  lines->planes};
        status = kernel_run(lines->report, lines->device, kernel, arguments,
                            sizeof arguments / sizeof *arguments, 3, global);
    }
    buffer_release(lines->device, &buffer);
    kernel_release(lines->device, &kernel);
    free(taps);
    return status;
}

/* The taps of a run of rows where the cross-range response is not one real function. It is complex
 * where it was measured, differs with range in a real aperture, and by row with residual motion. */
struct taps {
    size_t each;         /* taps of one response */
    size_t rows, blocks; /* numbers of responses: 1 where all rows, or all columns, share one */
    float *parts[2];
    double *response[2]; /* one response */
};

static sonject_status taps_init(struct taps *taps, const struct form_lines *lines)
{
    memset(taps, 0, sizeof *taps);
    taps->each = 2 * (size_t)lines->reach + 1;
    taps->blocks = lines->response.array_length_m > 0.0
                       ? (lines->at.columns + FORM_BLOCK_COLUMNS - 1) / FORM_BLOCK_COLUMNS
                       : 1;
    taps->rows = 1;
    if (lines->response.motion) {
        const size_t most = TAPS_OF_A_RUN / taps->each / ROWS_PER_ITEM * ROWS_PER_ITEM;
        taps->rows = most < ROWS_PER_ITEM ? ROWS_PER_ITEM : most;
        taps->rows = taps->rows < lines->at.rows ? taps->rows : lines->at.rows;
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

/* Returns the distance, m, of a pixel from the middle of the strip of the middle tap: the middle of
 * a row is that of its strips. */
static double offset_of(const struct form_lines *lines)
{
    return (0.5 - 0.5 / lines->grid.strips_per_row) * lines->row_spacing_m;
}

/* Stores the response as one of many: W, or |W|^2. */
static void store(struct taps *taps, const struct form_lines *lines, size_t number)
{
    const size_t first = number * taps->each;
    for (size_t i = 0; i < taps->each; i++) {
        const double a = taps->response[0][i];
        const double b = taps->response[1][i];
        taps->parts[0][first + i] = (float)(form_is_of_energies(lines) ? a * a + b * b : a);
        taps->parts[1][first + i] = form_is_of_energies(lines) ? 0.0f : (float)b;
    }
}

/* Fills in one response for each block of columns. */
static void fill_blocks(struct taps *taps, const struct form_lines *lines)
{
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    for (size_t block = 0; block < taps->blocks; block++) {
        const double column =
            (double)lines->at.first_column + ((double)block + 0.5) * FORM_BLOCK_COLUMNS - 0.5;
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
        const size_t left = lines->at.rows - first_row;
        const size_t some = by_row && taps->rows < left ? taps->rows : left;
        const int32_t first_strip = first_strip_of(lines);
        const int32_t end_strip = first_strip + lines->grid.strips.count;
        const int32_t per_row = (int32_t)lines->grid.strips_per_row;
        const int32_t row = (int32_t)first_row;
        const int32_t row_step = by_row ? (int32_t)taps->each : 0;
        const int32_t block_columns = FORM_BLOCK_COLUMNS;
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
    buffer_release(lines->device, &parts[0]);
    buffer_release(lines->device, &parts[1]);
    return status;
}

/* Combines rows that have their own responses, some at a time. */
static sonject_status run_moved(struct form_lines *lines, device_kernel kernel, struct taps *taps,
                                const device_buffer out[2])
{
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    struct motion_response motion;
    CHECK(motion_response_begin(&motion, lines->report, &lines->response, lines->view, strip,
                                offset_of(lines), lines->reach));
    sonject_status status = SONJECT_OK;
    for (size_t first = 0; status == SONJECT_OK && first < lines->at.rows; first += taps->rows) {
        for (size_t i = 0; i < taps->rows && first + i < lines->at.rows; i++) {
            motion_response_row(&motion, (double)(lines->at.first_row + first + i),
                                taps->response[0], taps->response[1]);
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
    THEN(status, kernel_create(lines->report, lines->device, PROGRAM_IMAGE_FORMATION, PROGRAM_PLAIN,
                               "combine_varied", &kernel));
    if (status == SONJECT_OK && lines->response.motion) {
        status = run_moved(lines, kernel, &taps, out);
    } else if (status == SONJECT_OK) {
        fill_blocks(&taps, lines);
        status = run_rows(lines, kernel, &taps, 0, out);
    }
    kernel_release(lines->device, &kernel);
    taps_clear(&taps);
    return status;
}

sonject_status form_combine(struct form_lines *lines, const device_buffer out[2])
{
    return cross_range_is_plain(&lines->response) ? combine_plain(lines, out)
                                                  : combine_varied(lines, out);
}
