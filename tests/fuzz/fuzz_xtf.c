/* XTF files: every choice of a channel, its samples and its geometry. */
#include "fuzz.h"

#include <stdlib.h>

#include "base/memory.h"
#include "image/raster.h"
#include "swath/xtf_file.h"

static void read_channel(int32_t channel)
{
    struct report report = {{0}, NULL, NULL};
    struct xtf_file file;
    sonject_status status = xtf_file_open(&report, "fuzz.xtf", channel, &file);
    fuzz_expect(status, &report);
    if (status != SONJECT_OK)
        return;
    const struct raster_layout *layout = &file.rows.layout;
    const struct region whole = {0, 0, layout->rows, layout->columns};
    size_t bytes;
    /* All that it says to hold is in the file. */
    if (!region_bytes(layout, &whole, &bytes) || bytes > file.rows.file_bytes)
        abort();
    for (uint64_t row = 0; row < layout->rows; row++)
        if (file.rows.places[row] > file.rows.file_bytes ||
            bytes / layout->rows > file.rows.file_bytes - file.rows.places[row])
            abort();
    void *pixels = allocate_array(bytes, 1);
    if (!pixels)
        abort();
    fuzz_expect(sample_rows_read(&report, &file.rows, &whole, pixels), &report);
    (void)xtf_geometry_of(&file, 0, layout->rows);
    free(pixels);
    xtf_file_close(&file);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    fuzz_write("fuzz.xtf", bytes, count);
    read_channel(SONJECT_CHANNEL_ONLY);
    read_channel(SONJECT_CHANNEL_PORT);
    read_channel(1);
    return 0;
}
