/* Images of plain rows: header and samples of PGM, PFM, BMP, Targa and FITS, comments of PGM. */
#include "fuzz.h"

#include <stdlib.h>

#include "base/memory.h"
#include "io/bmp_file.h"
#include "io/fits_file.h"
#include "io/pnm_file.h"
#include "io/tga_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct report report = {{0}, NULL, NULL};
    struct sample_rows rows;
    char value[16];
    size_t size;
    fuzz_write("fuzz.image", bytes, count);
    const bool is_netpbm = pnm_begins(bytes, count);
    const sonject_status status =
        is_netpbm                   ? pnm_file_open(&report, "fuzz.image", &rows)
        : fits_begins(bytes, count) ? fits_file_open(&report, "fuzz.image", &rows)
        : bmp_begins(bytes, count)  ? bmp_file_open(&report, "fuzz.image", &rows)
                                    : tga_file_open(&report, "fuzz.image", &rows);
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
    if (is_netpbm)
        (void)pnm_file_attribute(&rows, "name", value, sizeof value);
    free(pixels);
    sample_rows_clear(&rows);
    return 0;
}
