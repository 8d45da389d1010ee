/* What sonject itself reads of image files: the chunks of a PNG, the
 * segments of a JPEG, the heads of BMP, PGM and PFM. Decoding is OpenImageIO's. */
#include "fuzz.h"

#include <stdlib.h>

#include "io/byte_file.h"
#include "io/jpeg_segments.h"
#include "io/plain_head.h"
#include "io/png_chunks.h"

static void check_parts(sonject_status (*check)(struct report *report, const char *path,
                                                struct byte_ranges *parts),
                        uint64_t file_bytes)
{
    struct report report = {{0}, NULL, NULL};
    struct byte_ranges parts = {0};
    const sonject_status status = check(&report, "fuzz.image", &parts);
    fuzz_expect(status, &report);
    for (size_t i = 0; status == SONJECT_OK && i < parts.count; i++)
        if (parts.list[i].place > file_bytes ||
            parts.list[i].count > file_bytes - parts.list[i].place)
            abort();
    free(parts.list);
}

static void check_head(sonject_status (*check)(struct report *report, const char *path))
{
    struct report report = {{0}, NULL, NULL};
    fuzz_expect(check(&report, "fuzz.image"), &report);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    fuzz_write("fuzz.image", bytes, count);
    if (count > 0 && bytes[0] == 0x89)
        check_parts(png_check, count);
    else if (count > 0 && bytes[0] == 0xFF)
        check_parts(jpeg_check, count);
    else if (count > 1 && (bytes[0] == 'B' || bytes[0] == 'P'))
        check_head(bytes[0] == 'B' ? bmp_check : pnm_check);
    return 0;
}
