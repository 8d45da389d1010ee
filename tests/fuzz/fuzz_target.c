/* Files of targets, as a scene reads them. */
#include "fuzz.h"

#include <string.h>

#include "schema/scene_file.h"

static const char scene_text[] =
    "sonject: 1\ninput: {uniform: {rows: 4, columns: 5}, geometry: {row_spacing: 1, "
    "column_spacing: 1, first_slant_range: 40}}\n"
    "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
    "objects: [{target: ../targets/fuzz.yaml}]\n";

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct report report = {{0}, NULL, NULL};
    struct scene scene;
    const struct scene_text source = {.path = "scenes/fuzz.yaml",
                                      .text = scene_text,
                                      .bytes = strlen(scene_text),
                                      .allows_user_shapes = true};
    fuzz_write("targets/fuzz.yaml", bytes, count);
    scene_init(&scene);
    fuzz_expect_lines(scene_text_read(&report, &source, &scene), &report);
    scene_clear(&scene);
    return 0;
}
