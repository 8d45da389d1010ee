#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64
#include "io/sample_rows.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "io/byte_file.h"
#include "io/byte_order.h"

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
    sonject_status status = SONJECT_OK;
    if (!rows->file) {
        (void)file_failure(report, path, "open", errno);
        status = SONJECT_ERROR_INPUT;
    }
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

static size_t pixel_size(const struct sample_rows *rows)
{
    return rows->layout.channels * pixel_bytes(rows->layout.type);
}

/* Where the stored run begins that holds `columns` columns of a row from first_column on. */
static uint64_t run_place(const struct sample_rows *rows, uint64_t row, const struct region *region)
{
    const uint64_t stored = rows->is_upside_down ? rows->layout.rows - 1 - row : row;
    const uint64_t start =
        rows->places ? rows->places[row] : rows->first_place + stored * rows->row_bytes;
    const uint64_t first = rows->is_reversed
                               ? rows->layout.columns - region->first_column - region->columns
                               : region->first_column;
    return start + first * pixel_size(rows);
}

/* Between the file's order and the machine's: of columns, and of the bytes of each sample. */
static void turn_run(const struct sample_rows *rows, const unsigned char *from, unsigned char *to,
                     uint64_t columns)
{
    const size_t sample = pixel_bytes(rows->layout.type);
    const size_t pixel = pixel_size(rows);
    const bool swaps = rows->is_big_endian != machine_is_big_endian();
    for (uint64_t column = 0; column < columns; column++) {
        const unsigned char *source =
            from + (rows->is_reversed ? columns - 1 - column : column) * pixel;
        unsigned char *target = to + column * pixel;
        for (size_t i = 0; i < pixel; i++)
            target[i] = source[swaps ? i / sample * sample + (sample - 1 - i % sample) : i];
    }
}

/* Between stored signed numbers and unsigned ones, in the file's order. */
static void turn_signs(const struct sample_rows *rows, unsigned char *run, uint64_t columns)
{
    for (uint64_t i = 0; rows->is_offset && i < columns; i++)
        run[2 * i + (rows->is_big_endian ? 0 : 1)] ^= 0x80;
}

static sonject_status cut_short(struct report *report, const struct sample_rows *rows)
{
    return report_failure(report, SONJECT_ERROR_INPUT, "%s: is cut short: copy it again",
                          rows->path);
}

/* row, first_column: of the run's first sample in the image. */
static sonject_status check_largest(struct report *report, const struct sample_rows *rows,
                                    uint64_t row, const struct region *region,
                                    const unsigned char *run)
{
    for (uint64_t i = 0; rows->largest > 0 && i < region->columns; i++) {
        uint16_t sample = run[i];
        if (rows->layout.type == PIXEL_UINT16)
            memcpy(&sample, run + i * sizeof sample, sizeof sample);
        if (sample <= rows->largest)
            continue;
        if (rows->above_is_negative)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: the sample at row %llu, column %llu is negative: sonject "
                                  "reads magnitudes, so convert the file first",
                                  rows->path, (unsigned long long)row,
                                  (unsigned long long)(region->first_column + i));
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: the sample at row %llu, column %llu is %u, more than the file's "
                              "largest number of %u",
                              rows->path, (unsigned long long)row,
                              (unsigned long long)(region->first_column + i), (unsigned)sample,
                              (unsigned)rows->largest);
    }
    return SONJECT_OK;
}

sonject_status sample_rows_read(struct report *report, const struct sample_rows *rows,
                                const struct region *region, void *pixels)
{
    const size_t run_bytes = (size_t)region->columns * pixel_size(rows);
    if (!region_is_inside(&rows->layout, region))
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: the region is not inside the image",
                              rows->path);
    unsigned char *run = allocate_array(run_bytes, 1);
    if (!run)
        return report_out_of_memory(report, "a row");
    sonject_status status = SONJECT_OK;
    for (uint64_t i = 0; status == SONJECT_OK && i < region->rows; i++) {
        const uint64_t row = region->first_row + i;
        unsigned char *out = (unsigned char *)pixels + i * run_bytes;
        if (!byte_file_read(rows->file, run_place(rows, row, region), run, run_bytes)) {
            status = cut_short(report, rows);
        } else {
            turn_signs(rows, run, region->columns);
            turn_run(rows, run, out, region->columns);
            status = check_largest(report, rows, row, region, out);
        }
    }
    free(run);
    return status;
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

static sonject_status put_patch(struct report *report, const struct sample_rows *rows, FILE *out,
                                const char *path, const struct region *region, const void *pixels)
{
    const size_t run_bytes = (size_t)region->columns * pixel_size(rows);
    unsigned char *run = allocate_array(run_bytes, 1);
    if (!run)
        return report_out_of_memory(report, "a row");
    sonject_status status = SONJECT_OK;
    for (uint64_t i = 0; status == SONJECT_OK && i < region->rows; i++) {
        const unsigned char *row = (const unsigned char *)pixels + i * run_bytes;
        const uint64_t place = run_place(rows, region->first_row + i, region);
        turn_run(rows, row, run, region->columns);
        turn_signs(rows, run, region->columns);
        status = check_largest(report, rows, region->first_row + i, region, row);
        if (status != SONJECT_OK)
            break;
        if (fseeko(out, (off_t)place, SEEK_SET) != 0 || fwrite(run, 1, run_bytes, out) != run_bytes)
            status = file_failure(report, path, "write", errno);
    }
    free(run);
    return status;
}

sonject_status sample_rows_copy_with_patch(struct report *report, const struct sample_rows *rows,
                                           const char *path, const struct region *region,
                                           const void *pixels, sonject_progress_function progress,
                                           void *user)
{
    if (!region_is_inside(&rows->layout, region))
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: the region is not inside the image",
                              rows->path);
    char *part = file_part_name(path);
    if (!part)
        return report_out_of_memory(report, "a file name");
    FILE *out = fopen(part, "w+b");
    sonject_status status = out ? copy_all(report, rows, out, path, progress, user)
                                : file_failure(report, path, "write", errno);
    if (status == SONJECT_OK)
        status = put_patch(report, rows, out, path, region, pixels);
    if (status == SONJECT_OK && rows->finish_copy)
        status = rows->finish_copy(report, rows, out, path);
    if (out && fclose(out) != 0 && status == SONJECT_OK)
        status = file_failure(report, path, "write", errno);
    if (status == SONJECT_OK)
        status = file_publish(report, part, path);
    else
        file_discard(part);
    free(part);
    return status;
}
