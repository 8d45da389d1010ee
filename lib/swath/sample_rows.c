#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "swath/sample_rows.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_file.h"
#include "base/byte_order.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/array_list.h"

#define COPIED_AT_ONCE ((uint64_t)8 << 20)

sonject_status sample_rows_open(struct report *report, const char *path,
                                sonject_status (*read_header)(struct report *report,
                                                              struct sample_rows *rows),
                                struct sample_rows *rows)
{
    memset(rows, 0, sizeof *rows);
    rows->path = copy_text(path);
    if (!rows->path)
        return report_out_of_memory(report, "a file name");
    rows->file = byte_file_open(path, &rows->file_bytes);
    sonject_status status = rows->file ? SONJECT_OK : file_refuse(report, path, errno);
    if (status == SONJECT_OK)
        status = read_header(report, rows);
    if (status != SONJECT_OK)
        sample_rows_clear(rows);
    return status;
}

void sample_rows_clear(struct sample_rows *rows)
{
    if (rows->file)
        fclose(rows->file);
    free(rows->path);
    free(rows->places);
    memset(rows, 0, sizeof *rows);
}

static size_t stored_bytes(const struct sample_rows *rows)
{
    return rows->stored == STORED_FLOAT64 ? 8 : pixel_bytes(rows->layout.type);
}

/* A region's samples as runs of the file: parts of rows, or of columns. */
struct runs {
    uint64_t count, pixels; /* pixels of a run */
    size_t pixel_bytes;     /* as stored */
    size_t bytes;           /* of a run */
};

static struct runs runs_of(const struct sample_rows *rows, const struct region *region)
{
    struct runs runs;
    runs.count = rows->is_transposed ? region->columns : region->rows;
    runs.pixels = rows->is_transposed ? region->rows : region->columns;
    runs.pixel_bytes = rows->layout.channels * stored_bytes(rows);
    runs.bytes = (size_t)runs.pixels * runs.pixel_bytes;
    return runs;
}

/* Where a run of the region begins in the file. */
static uint64_t run_place(const struct sample_rows *rows, const struct runs *runs, uint64_t run,
                          const struct region *region)
{
    const struct raster_layout *layout = &rows->layout;
    const uint64_t line = run + (rows->is_transposed ? region->first_column : region->first_row);
    const uint64_t start =
        rows->places ? rows->places[line] : rows->first_place + line * rows->row_bytes;
    const uint64_t first = rows->is_transposed ? region->first_row
                           : rows->is_reversed
                               ? layout->columns - region->first_column - region->columns
                               : region->first_column;
    return start + first * runs->pixel_bytes;
}

/* Between a stored sample, in the machine's byte order, and one of the image: one way or the other.
 * A number that is shown as the same float as before keeps its bits. False if the other side cannot
 * hold it. */
static bool exchange_number(const struct sample_rows *rows, bool writes, unsigned char *stored,
                            unsigned char *shown)
{
    const size_t bytes = pixel_bytes(rows->layout.type);
    uint32_t whole = 0;
    uint16_t half = 0;
    double number = 0.0;
    float single = 0.0f;
    bool is_held = true;
    switch (rows->stored) {
    case STORED_AS_SHOWN:
        memcpy(writes ? stored : shown, writes ? shown : stored, bytes);
        half = *shown;
        if (rows->layout.type == PIXEL_UINT16)
            memcpy(&half, shown, sizeof half);
        return rows->largest == 0 || half <= rows->largest;
    case STORED_UINT32:
        memcpy(&whole, stored, sizeof whole);
        memcpy(&single, shown, sizeof single);
        if (writes && !(single == (float)whole)) {
            is_held = single >= 0.0f && single <= (float)rows->largest;
            number = is_held ? fmin(floor((double)single + 0.5), (double)rows->largest) : 0.0;
            whole = (uint32_t)number;
        }
        single = (float)whole;
        memcpy(writes ? stored : shown, writes ? (void *)&whole : (void *)&single, sizeof whole);
        return is_held && whole <= rows->largest;
    case STORED_FLOAT64:
        break;
    }
    memcpy(&number, stored, sizeof number);
    memcpy(&single, shown, sizeof single);
    if (writes)
        number = kept_or_new(number, single);
    else
        is_held = float_of_double(number, &single);
    memcpy(writes ? stored : shown, writes ? (void *)&number : (void *)&single, writes ? 8 : 4);
    return is_held;
}

/* The same with the file's byte order. */
static bool exchange(const struct sample_rows *rows, bool writes, unsigned char *stored,
                     unsigned char *shown)
{
    unsigned char ordered[8];
    const size_t bytes = stored_bytes(rows);
    const bool swaps = rows->is_big_endian != machine_is_big_endian();
    for (size_t i = 0; i < bytes; i++)
        ordered[i] = stored[swaps ? bytes - 1 - i : i];
    const bool is_held = exchange_number(rows, writes, ordered, shown);
    for (size_t i = 0; writes && i < bytes; i++)
        stored[i] = ordered[swaps ? bytes - 1 - i : i];
    return is_held;
}

static sonject_status cut_short(struct report *report, const struct sample_rows *rows)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: is cut short: copy it again",
                          rows->path);
}

/* pixel: of the region. shown: its sample in the image. */
static sonject_status refuse_sample(struct report *report, const struct sample_rows *rows,
                                    bool writes, const struct region *region, uint64_t pixel,
                                    const unsigned char *shown)
{
    char why[80] = "negative: sonject reads magnitudes, so convert the file first";
    uint16_t half = *shown;
    float single = 0.0f;
    if (rows->layout.type == PIXEL_UINT16)
        memcpy(&half, shown, sizeof half);
    if (rows->layout.type == PIXEL_FLOAT32)
        memcpy(&single, shown, sizeof single);
    if (rows->stored == STORED_FLOAT64)
        snprintf(why, sizeof why, "beyond what float32 holds: scale the array");
    else if (writes || !rows->above_is_negative)
        snprintf(why, sizeof why, "%.9g, more than the file's largest number of %lu",
                 rows->stored == STORED_UINT32 ? (double)single : (double)half,
                 (unsigned long)rows->largest);
    return report_failure(
        report, SONJECT_ERROR_INPUT, "%s: the sample at row %llu, column %llu is %s", rows->path,
        (unsigned long long)(region->first_row + pixel / region->columns),
        (unsigned long long)(region->first_column + pixel % region->columns), why);
}

/* All samples of a run, which is in memory. */
static sonject_status exchange_run(struct report *report, const struct sample_rows *rows,
                                   bool writes, const struct region *region, uint64_t number,
                                   unsigned char *run, unsigned char *pixels)
{
    const struct runs runs = runs_of(rows, region);
    const uint32_t channels = rows->layout.channels;
    const size_t shown = pixel_bytes(rows->layout.type);
    const size_t stored = stored_bytes(rows);
    for (uint64_t i = 0; i < runs.pixels; i++) {
        const uint64_t along = rows->is_reversed ? runs.pixels - 1 - i : i;
        const uint64_t pixel = rows->is_transposed ? along * region->columns + number
                                                   : number * region->columns + along;
        for (uint32_t k = 0; k < channels; k++) {
            unsigned char *sample = pixels + (pixel * channels + k) * shown;
            if (!exchange(rows, writes, run + (i * channels + k) * stored, sample))
                return refuse_sample(report, rows, writes, region, pixel, sample);
        }
    }
    return SONJECT_OK;
}

/* Reads the region's samples, or writes them to a copy (out, to become path). */
static sonject_status exchange_region(struct report *report, const struct sample_rows *rows,
                                      const struct region *region, void *pixels, FILE *out,
                                      const char *path)
{
    const struct runs runs = runs_of(rows, region);
    unsigned char *run = allocate_array(runs.bytes, 1);
    if (!run)
        return report_out_of_memory(report, "a row");
    sonject_status status = SONJECT_OK;
    for (uint64_t i = 0; status == SONJECT_OK && i < runs.count; i++) {
        const uint64_t place = run_place(rows, &runs, i, region);
        if (!byte_file_read(rows->file, place, run, runs.bytes))
            status = cut_short(report, rows);
        else
            status = exchange_run(report, rows, out != NULL, region, i, run, pixels);
        if (status == SONJECT_OK && out &&
            (fseeko(out, (off_t)place, SEEK_SET) != 0 ||
             fwrite(run, 1, runs.bytes, out) != runs.bytes))
            status = file_failure(report, path, "write", errno);
    }
    free(run);
    return status;
}

static sonject_status refuse_region(struct report *report, const struct sample_rows *rows)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: the region is not inside the image",
                          rows->path);
}

sonject_status sample_rows_read(struct report *report, const struct sample_rows *rows,
                                const struct region *region, void *pixels)
{
    return region_is_inside(&rows->layout, region)
               ? exchange_region(report, rows, region, pixels, NULL, NULL)
               : refuse_region(report, rows);
}

static sonject_status copy_all(struct report *report, const struct sample_rows *rows, FILE *out,
                               const char *path, sonject_progress_function progress, void *user)
{
    for (uint64_t place = 0; place < rows->file_bytes; place += COPIED_AT_ONCE) {
        const uint64_t left = rows->file_bytes - place;
        errno = 0;
        if (!byte_file_copy(rows->file, place, left < COPIED_AT_ONCE ? left : COPIED_AT_ONCE, out))
            return ferror(out) ? file_failure(report, path, "write", errno)
                               : cut_short(report, rows);
        if (progress && progress(user, (double)place / (double)rows->file_bytes, "write") != 0)
            return report_failure(report, SONJECT_CANCELLED, "cancelled");
    }
    return SONJECT_OK;
}

sonject_status sample_rows_copy_with_patch(struct report *report, const struct sample_rows *rows,
                                           const char *path, const struct region *region,
                                           const void *pixels, sonject_progress_function progress,
                                           void *user)
{
    if (!region_is_inside(&rows->layout, region))
        return refuse_region(report, rows);
    char *part = file_part_name(path);
    if (!part)
        return report_out_of_memory(report, "a file name");
    FILE *out = fopen(part, "w+b");
    sonject_status status = out ? copy_all(report, rows, out, path, progress, user)
                                : file_failure(report, path, "write", errno);
    if (status == SONJECT_OK)
        status = exchange_region(report, rows, region, (void *)(uintptr_t)pixels, out, path);
    if (out && fclose(out) != 0 && status == SONJECT_OK)
        status = file_failure(report, path, "write", errno);
    if (status == SONJECT_OK)
        status = file_publish(report, part, path);
    else
        file_discard(part);
    free(part);
    return status;
}
