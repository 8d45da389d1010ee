/* NumPy arrays: header and numbers. */
#include "fuzz.h"

#include <stdlib.h>

#include "base/memory.h"
#include "swath/npy_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct report report = {{0}, NULL, NULL};
    struct sample_rows rows;
    size_t size;
    fuzz_write("fuzz.npy", bytes, count);
    (void)npy_begins(bytes, count);
    const sonject_status status = npy_file_open(&report, "fuzz.npy", &rows);
    fuzz_expect(status, &report);
    if (status != SONJECT_OK)
        return 0;
    const struct region whole = {0, 0, rows.layout.rows, rows.layout.columns};
    /* All that it says to hold is in the file. */
    if (!region_bytes(&rows.layout, &whole, &size) || rows.first_place > count ||
        size > count - rows.first_place)
        abort();
    void *pixels = allocate_array(size, 1);
    if (!pixels)
        abort();
    fuzz_expect(sample_rows_read(&report, &rows, &whole, pixels), &report);
    free(pixels);
    sample_rows_clear(&rows);
    return 0;
}
