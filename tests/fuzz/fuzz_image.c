/* What sonject itself reads of image files: the heads of BMP and PGM. Decoding is OpenImageIO's. */
#include "fuzz.h"

#include "swath/image_head.h"

static void check_head(sonject_status (*check)(struct report *report, const char *name,
                                               const char *path))
{
    struct report report = {{0}, NULL, NULL};
    fuzz_expect(check(&report, "fuzz.image", "fuzz.image"), &report);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    fuzz_write("fuzz.image", bytes, count);
    if (count > 1 && (bytes[0] == 'B' || bytes[0] == 'P'))
        check_head(bytes[0] == 'B' ? bmp_check : pgm_check);
    return 0;
}
