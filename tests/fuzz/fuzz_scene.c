/* Scene files, with code of users allowed; among the targets in ../targets. */
#include "fuzz.h"

#include <stdlib.h>

#include "schema/scene_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct report report = {{0}, NULL, NULL};
    struct scene scene;
    char *text = fuzz_text(bytes, count);
    const struct scene_text source = {
        .path = "scenes/fuzz.yaml", .text = text, .bytes = count, .allows_user_shapes = true};
    scene_init(&scene);
    fuzz_expect_lines(scene_text_read(&report, &source, &scene), &report);
    scene_clear(&scene);
    free(text);
    return 0;
}
