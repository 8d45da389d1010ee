#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "inject/injection_setup.h"
#include "swath/geometry_notes.h"
#include "swath/raster_file.h"

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text);
    const size_t end_length = strlen(end);
    return length >= end_length && strcmp(text + length - end_length, end) == 0;
}

/* Amplitudes as 8-bit numbers, 1 = 255; in place, since they need less room. */
static void to_bytes(float *pixels, size_t count)
{
    unsigned char *bytes = (unsigned char *)pixels;
    for (size_t i = 0; i < count; i++)
        bytes[i] = (unsigned char)fminf(255.0f, floorf(pixels[i] * 255.0f + 0.5f));
}

sonject_status write_seabed(struct report *report, const struct scene *scene, const char *path)
{
    static const char *const complex_names[] = {"real", "imag"};
    const bool is_png = ends_with(path, ".png");
    const bool is_complex = scene->synthetic.complex_pixels != 0;
    struct geometry_notes notes;
    struct injection_input input;
    if (!is_png && !ends_with(path, ".tif"))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: a synthetic seabed is written as .tif or .png", path);
    if (is_complex && is_png)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: complex pixels need .tif", path);
    CHECK(make_input(report, scene, &input));
    const struct raster_layout layout = {input.rows, input.columns, is_complex ? 2 : 1,
                                         is_png ? PIXEL_UINT8 : PIXEL_FLOAT32};
    geometry_notes_init(&notes, &scene->sonar, &scene->geometry, 0.0, 0.0);
    if (is_png)
        to_bytes((float *)input.pixels, input.rows * input.columns);
    const sonject_status status =
        raster_file_write(report, path, &layout, is_complex ? complex_names : NULL,
                          notes.attributes, notes.count, input.pixels);
    free((void *)input.pixels);
    return status;
}
