/* What sonject itself reads of image files: where a TIFF keeps its pixels, the chunks of a PNG, the
 * segments of a JPEG, the boxes and the coded image of a JPEG 2000, the chunks of an OpenEXR file.
 * Decoding is OpenImageIO's. */
#include "fuzz.h"

#include <stdlib.h>

#include "io/byte_file.h"
#include "io/exr_chunks.h"
#include "io/jp2_boxes.h"
#include "io/jpeg_segments.h"
#include "io/png_chunks.h"
#include "io/tiff_structure.h"

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

static void check_blocks(uint64_t file_bytes)
{
    struct report report = {{0}, NULL, NULL};
    struct tiff_structure structure;
    const sonject_status status = tiff_structure_read(&report, "fuzz.image", &structure);
    fuzz_expect(status, &report);
    if (status != SONJECT_OK)
        return;
    for (uint64_t i = 0; i < structure.block_count; i++) {
        (void)tiff_block_rows(&structure, i);
        (void)tiff_block_bytes(&structure, i);
        if (structure.offsets[i] > file_bytes ||
            structure.counts[i] > file_bytes - structure.offsets[i])
            abort();
    }
    tiff_structure_clear(&structure);
}

/* With itself as what was coded anew. */
static void check_chunks(void)
{
    static const struct region region = {1, 0, 1, 1};
    struct report report = {{0}, NULL, NULL};
    const sonject_status status = exr_check(&report, "fuzz.image");
    fuzz_expect(status, &report);
    if (status != SONJECT_OK)
        return;
    if (exr_join(&report, "fuzz.image", "fuzz.image", &region, "fuzz.copy", "fuzz.copy") !=
            SONJECT_OK ||
        exr_check(&report, "fuzz.copy") != SONJECT_OK)
        abort();
}

/* With itself as what was coded anew. */
static void check_boxes(uint64_t file_bytes)
{
    struct report report = {{0}, NULL, NULL};
    struct byte_ranges parts = {0};
    check_parts(jp2_check, file_bytes);
    if (jp2_check(&report, "fuzz.image", &parts) == SONJECT_OK) {
        if (jp2_join(&report, "fuzz.image", "fuzz.image", "fuzz.copy", "fuzz.copy") != SONJECT_OK ||
            jp2_check(&report, "fuzz.copy", &parts) != SONJECT_OK)
            abort();
    }
    free(parts.list);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    fuzz_write("fuzz.image", bytes, count);
    if (count > 0 && bytes[0] == 0x89)
        check_parts(png_check, count);
    else if (count > 0 && (bytes[0] == 0 || (count > 1 && bytes[0] == 0xFF && bytes[1] == 0x4F)))
        check_boxes(count);
    else if (count > 0 && bytes[0] == 0xFF)
        check_parts(jpeg_check, count);
    else if (count > 0 && bytes[0] == 0x76)
        check_chunks();
    else
        check_blocks(count);
    return 0;
}
