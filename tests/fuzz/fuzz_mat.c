/* MATLAB's files of version 5: the only array, one by its name, and their numbers. */
#include "fuzz.h"

#include <stdlib.h>

#include "base/memory.h"
#include "swath/mat_file.h"

/* More than that and it is not read: compressed files may hold a thousand times their size. */
#define BYTES_READ_MAX ((size_t)1 << 24)

static void read_array(const char *name)
{
    struct report report = {{0}, NULL, NULL};
    struct mat_file file;
    size_t size;
    const sonject_status status = mat_file_open(&report, "fuzz.mat", name, &file);
    fuzz_expect(status, &report);
    if (status != SONJECT_OK)
        return;
    const struct region whole = {0, 0, file.layout.rows, file.layout.columns};
    if (!region_bytes(&file.layout, &whole, &size))
        abort();
    void *pixels = size <= BYTES_READ_MAX ? allocate_array(size, 1) : NULL;
    if (pixels)
        fuzz_expect(mat_file_read(&report, &file, &whole, pixels), &report);
    free(pixels);
    mat_file_close(&file);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    fuzz_write("fuzz.mat", bytes, count);
    (void)mat_begins(bytes, count);
    read_array(NULL);
    read_array("swath");
    return 0;
}
