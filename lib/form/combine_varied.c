#include "form/combine_varied.h"

#include <stdlib.h>

#include "base/memory.h"
#include "device/device.h"
#include "scene/motion_response.h"
#include "scene/point_response.h"

#define BLOCK_COLUMNS 16 /* that share a response; holds whole groups of any width */
#define ROWS_PER_ITEM 8  /* FORM_ROWS of kernels/image_formation.h */
#define TAPS_OF_A_RUN ((size_t)1 << 22)

/* The taps of a run of rows. */
struct taps {
    size_t each;         /* taps of one response */
    size_t rows, blocks; /* responses: 1 where all rows, all columns share one */
    float *real_part, *imaginary_part;
    double *row_real, *row_imaginary; /* one response */
};

static size_t blocks_of(const struct form_lines *lines)
{
    return lines->response.array_length_m > 0.0
               ? (lines->columns + BLOCK_COLUMNS - 1) / BLOCK_COLUMNS
               : 1;
}

static sonject_status taps_init(struct taps *taps, const struct form_lines *lines)
{
    taps->each = 2 * (size_t)lines->reach + 1;
    taps->blocks = blocks_of(lines);
    taps->rows = 1;
    if (lines->response.motion) {
        const size_t most = TAPS_OF_A_RUN / taps->each / ROWS_PER_ITEM * ROWS_PER_ITEM;
        taps->rows = most < ROWS_PER_ITEM ? ROWS_PER_ITEM : most;
        taps->rows = taps->rows < lines->rows ? taps->rows : lines->rows;
    }
    const size_t count = taps->each * taps->rows * taps->blocks;
    taps->real_part = allocate_array(count, sizeof(float));
    taps->imaginary_part = allocate_array(count, sizeof(float));
    taps->row_real = allocate_array(taps->each, sizeof(double));
    taps->row_imaginary = allocate_array(taps->each, sizeof(double));
    if (!taps->real_part || !taps->imaginary_part || !taps->row_real || !taps->row_imaginary)
        return report_out_of_memory(lines->report, "image formation");
    return SONJECT_OK;
}

static void taps_clear(struct taps *taps)
{
    free(taps->real_part);
    free(taps->imaginary_part);
    free(taps->row_real);
    free(taps->row_imaginary);
}

/* Distance of a pixel from the middle of the strip of the tap in the middle: rows' middles are
 * those of their strips. */
static double offset_of(const struct form_lines *lines)
{
    return (0.5 - 0.5 / lines->grid.strips_per_row) * lines->row_spacing_m;
}

/* Stores the response in row_real and row_imaginary: W, or |W|^2. */
static void store(struct taps *taps, const struct form_lines *lines, size_t number)
{
    const size_t first = number * taps->each;
    for (size_t i = 0; i < taps->each; i++) {
        const double a = taps->row_real[i];
        const double b = taps->row_imaginary[i];
        const bool is_energy = form_is_of_energies(lines->kind);
        taps->real_part[first + i] = (float)(is_energy ? a * a + b * b : a);
        taps->imaginary_part[first + i] = is_energy ? 0.0f : (float)b;
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
            taps->row_real[i] = w.real_part;
            taps->row_imaginary[i] = w.imaginary_part;
        }
        store(taps, lines, block);
    }
}

static sonject_status run_rows(struct form_lines *lines, device_kernel kernel,
                               const struct taps *taps, size_t first_row, device_buffer real_out,
                               device_buffer imaginary_out)
{
    const size_t bytes = taps->each * taps->rows * taps->blocks * sizeof(float);
    device_buffer real_taps = NULL;
    device_buffer imaginary_taps = NULL;
    sonject_status status =
        buffer_create(lines->report, lines->device, bytes, taps->real_part, &real_taps);
    THEN(status,
         buffer_create(lines->report, lines->device, bytes, taps->imaginary_part, &imaginary_taps));
    if (status == SONJECT_OK) {
        const bool by_row = lines->response.motion != NULL;
        const size_t left = lines->rows - first_row;
        const size_t some = by_row && taps->rows < left ? taps->rows : left;
        const int32_t first_strip = lines->grid.strips.first;
        const int32_t end_strip = first_strip + lines->grid.strips.count;
        const int32_t per_row = (int32_t)lines->grid.strips_per_row;
        const int32_t reach = lines->reach;
        const int32_t row = (int32_t)first_row;
        const int32_t row_step = by_row ? (int32_t)taps->each : 0;
        const int32_t block_columns = BLOCK_COLUMNS;
        const int32_t block_step = taps->blocks > 1 ? (int32_t)taps->each : 0;
        const int32_t stride = (int32_t)lines->stride;
        const int32_t rows = (int32_t)(first_row + some);
        const struct kernel_argument arguments[] = {ARGUMENT(first_strip),
                                                    ARGUMENT(end_strip),
                                                    ARGUMENT(per_row),
                                                    ARGUMENT(reach),
                                                    ARGUMENT(row),
                                                    ARGUMENT(row_step),
                                                    ARGUMENT(block_columns),
                                                    ARGUMENT(block_step),
                                                    ARGUMENT(lines->real_lines),
                                                    ARGUMENT(lines->imaginary_lines),
                                                    ARGUMENT(lines->filled),
                                                    ARGUMENT(stride),
                                                    ARGUMENT(real_taps),
                                                    ARGUMENT(imaginary_taps),
                                                    ARGUMENT(rows),
                                                    ARGUMENT(real_out),
                                                    ARGUMENT(imaginary_out)};
        const size_t global[2] = {lines->stride / lines->device->width,
                                  (some + ROWS_PER_ITEM - 1) / ROWS_PER_ITEM};
        status = kernel_run(lines->report, lines->device, kernel, arguments,
                            sizeof arguments / sizeof *arguments, 2, global);
    }
    buffer_release(&real_taps);
    buffer_release(&imaginary_taps);
    return status;
}

/* Rows of their own responses, some at a time. */
static sonject_status run_moved(struct form_lines *lines, device_kernel kernel, struct taps *taps,
                                device_buffer real_out, device_buffer imaginary_out)
{
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    struct motion_response motion;
    sonject_status status =
        motion_response_begin(&motion, lines->report, &lines->response, lines->view, strip,
                              offset_of(lines), lines->reach);
    if (status != SONJECT_OK)
        return status;
    for (size_t first = 0; status == SONJECT_OK && first < lines->rows; first += taps->rows) {
        for (size_t i = 0; i < taps->rows && first + i < lines->rows; i++) {
            motion_response_row(&motion, (double)(first + i), taps->row_real, taps->row_imaginary);
            store(taps, lines, i);
        }
        status = run_rows(lines, kernel, taps, first, real_out, imaginary_out);
    }
    motion_response_end(&motion);
    return status;
}

sonject_status combine_varied(struct form_lines *lines, device_buffer real_out,
                              device_buffer imaginary_out)
{
    struct taps taps = {0, 0, 0, NULL, NULL, NULL, NULL};
    device_kernel kernel = NULL;
    sonject_status status = taps_init(&taps, lines);
    THEN(status, kernel_create(lines->report, lines->device, PROGRAM_IMAGE_FORMATION, 0,
                               "combine_varied", &kernel));
    if (status == SONJECT_OK && lines->response.motion) {
        status = run_moved(lines, kernel, &taps, real_out, imaginary_out);
    } else if (status == SONJECT_OK) {
        fill_blocks(&taps, lines);
        status = run_rows(lines, kernel, &taps, 0, real_out, imaginary_out);
    }
    kernel_release(&kernel);
    taps_clear(&taps);
    return status;
}
