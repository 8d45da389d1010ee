/* Functions that the writers of image files share. */
#include <errno.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/memory.h"
#include "swath/image_library.h"

sonject_status encode_rows(struct report *report, const struct image_encoding *encoding,
                           bool (*put)(void *output, const unsigned char *rows, uint64_t count),
                           void *output, bool *are_put)
{
    const struct raster_layout *layout = &encoding->layout;
    const uint64_t at_once = rows_at_once(layout);
    sonject_status status = SONJECT_OK;
    unsigned char *strip = allocate_array(
        (size_t)at_once, (size_t)layout->columns * layout->channels * pixel_bytes(layout->type));
    CHECK_MEMORY(report, strip, encoding->name);
    *are_put = true;
    for (uint64_t first = 0; status == SONJECT_OK && *are_put && first < layout->rows;
         first += at_once) {
        const uint64_t end = layout->rows - first < at_once ? layout->rows : first + at_once;
        status = encoding->give_rows(encoding->user, first, end, strip);
        if (status == SONJECT_OK)
            *are_put = put(output, strip, end - first);
    }
    free(strip);
    return status;
}

sonject_status encoding_failure(struct report *report, const struct image_encoding *encoding,
                                const struct library_fault *fault)
{
    if (fault->error == ENOMEM)
        return report_out_of_memory(report, encoding->name);
    return fault->error != 0 ? file_failure(report, encoding->name, "write", fault->error)
                             : report_failure(report, SONJECT_ERROR_STORAGE, "%s: cannot write: %s",
                                              encoding->name, fault->message);
}

sonject_status encoding_end(struct report *report, const struct image_encoding *encoding,
                            FILE *file, struct library_fault *fault, bool is_written,
                            sonject_status status)
{
    if (file && fclose(file) != 0 && is_written) {
        is_written = false;
        fault->error = errno;
    }
    return status != SONJECT_OK || is_written ? status : encoding_failure(report, encoding, fault);
}
