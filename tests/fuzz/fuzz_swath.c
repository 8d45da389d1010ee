/* Swath files that are read in this process: each choice of a channel or an array, its samples and
 * its geometry. */
#include "fuzz.h"

#include <stdlib.h>

#include "base/file.h"
#include "base/memory.h"
#include "image/raster.h"
#include "swath/swath_format.h"

/* More than that and it is not read: compressed files may hold a thousand times their size. */
#define BYTES_READ_MAX ((size_t)1 << 24)

/* All lines that the file says to hold are in it. MATLAB's numbers, which may be compressed, are
 * no lines. */
static void expect_inside(const struct swath_file *file, size_t bytes)
{
    const struct sample_lines *lines = &file->lines;
    const struct raster_layout *layout = &file->layout;
    const uint64_t count = lines->is_transposed ? layout->columns : layout->rows;
    for (uint64_t i = 0; (lines->places || lines->line_bytes > 0) && i < count; i++) {
        const uint64_t place =
            lines->places ? lines->places[i] : lines->first_place + i * lines->line_bytes;
        const uint64_t line = lines->places ? bytes / count : lines->line_bytes;
        if (place > file->bytes || line > file->bytes - place)
            abort();
    }
}

static void read_all(struct swath_file *file)
{
    struct report report = {{0}, NULL, NULL};
    const struct region whole = {0, 0, file->layout.rows, file->layout.columns};
    size_t size;
    if (!region_bytes(&file->layout, &whole, &size))
        abort();
    expect_inside(file, size);
    void *pixels = size <= BYTES_READ_MAX ? allocate_array(size, 1) : NULL;
    if (pixels)
        fuzz_expect(FORMAT.read(&report, file, &whole, pixels), &report);
    if (swath_file_xtf(file))
        (void)xtf_geometry_of(&file->xtf, 0, file->layout.rows);
    free(pixels);
}

static void read_file(const uint8_t *bytes, size_t count, int32_t channel, const char *array)
{
    struct report report = {{0}, NULL, NULL};
    struct swath_file *file = allocate_array(1, sizeof *file);
    if (!file || !(file->path = copy_text("fuzz.swath")))
        abort();
    file->format = &FORMAT;
    file->stream = byte_file_open(file->path, &file->bytes);
    if (!file->stream)
        abort();
    if (FORMAT.is_of(file, bytes, count)) {
        const sonject_status status = FORMAT.open(&report, file, channel, array);
        fuzz_expect(status, &report);
        if (status == SONJECT_OK)
            read_all(file);
    }
    swath_file_close(&file);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    fuzz_write("fuzz.swath", bytes, count);
    read_file(bytes, count, SONJECT_CHANNEL_ONLY, NULL);
    if (FORMAT.has_names)
        read_file(bytes, count, SONJECT_CHANNEL_ONLY, "swath");
    if (FORMAT.has_channels) {
        read_file(bytes, count, SONJECT_CHANNEL_PORT, NULL);
        read_file(bytes, count, 1, NULL);
    }
    return 0;
}
