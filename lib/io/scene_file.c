#include "io/scene_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "io/scene_schema.h"

static sonject_status fill_scene(struct tree *tree, const char *const *overrides, size_t count,
                                 bool allows_user_shapes, struct scene *scene)
{
    struct reader reader = {.report = tree->report,
                            .tree = tree,
                            .scene = scene,
                            .allows_user_shapes = allows_user_shapes};
    for (size_t i = 0; i < count; i++) {
        const sonject_status status = tree_override(tree, overrides[i]);
        if (status != SONJECT_OK)
            return status;
    }
    if (tree_is_null(&tree->root))
        return refuse_value(&reader, &tree->root,
                            "there is nothing in it; start with 'sonject: 1'");
    return read_section(&reader, &scene_section, &tree->root, scene);
}

sonject_status scene_file_read(struct report *report, const char *path,
                               const char *const *overrides, size_t count, struct scene *scene)
{
    return scene_file_read_with(report, path, overrides, count, false, scene);
}

sonject_status scene_file_read_with(struct report *report, const char *path,
                                    const char *const *overrides, size_t count,
                                    bool allows_user_shapes, struct scene *scene)
{
    char excerpt[400];
    char *text;
    size_t bytes;
    struct tree tree;
    if (!file_exists(path))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: there is no such scene file; check its name",
                              text_excerpt(excerpt, sizeof excerpt, path));
    sonject_status status = file_read_whole(report, path, TREE_BYTES_MAX, &text, &bytes);
    if (status != SONJECT_OK)
        return status;
    tree_init(&tree, report, path);
    status = tree_parse(&tree, text, bytes);
    free(text);
    if (status == SONJECT_OK)
        status = fill_scene(&tree, overrides, count, allows_user_shapes, scene);
    tree_clear(&tree);
    if (status != SONJECT_OK)
        scene_clear(scene);
    return status;
}
