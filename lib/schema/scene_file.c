#include "schema/scene_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "schema/scene_bands.h"

static sonject_status apply_overrides(struct tree *tree, const struct scene_text *source)
{
    sonject_status status = SONJECT_OK;
    tree->given_overrides = source->override_count - source->call_overrides;
    for (size_t i = 0; !reading_ends(status) && i < source->override_count; i++) {
        const sonject_status of_one = tree_override(tree, source->overrides[i]);
        status = of_one == SONJECT_OK ? status : of_one;
    }
    return status;
}

static sonject_status fill_scene(struct tree *tree, const struct scene_text *source,
                                 struct scene *scene)
{
    struct reader reader = {.report = tree->report,
                            .tree = tree,
                            .scene = scene,
                            .allows_user_shapes = source->allows_user_shapes,
                            .moved_folder = source->moved_folder,
                            .moved_overrides = source->moved_overrides,
                            .arrays = source->arrays,
                            .array_count = source->array_count,
                            .takes_pixels = source->takes_pixels};
    sonject_status status = apply_overrides(tree, source);
    if (reading_ends(status))
        return status;
    if (tree_is_null(&tree->root))
        return refuse_value(&reader, &tree->root,
                            "there is nothing in it; start with 'sonject: 1'");
    status = choose_band(&reader, tree);
    return status == SONJECT_OK ? read_section(&reader, &scene_section, &tree->root, scene)
                                : status;
}

sonject_status scene_file_load(struct report *report, const char *path, char **text, size_t *bytes)
{
    char excerpt[400];
    if (!file_exists(path))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: there is no such scene file; check its name",
                              text_excerpt(excerpt, sizeof excerpt, path));
    return file_read_whole(report, path, TREE_BYTES_MAX, text, bytes);
}

/* The place of every key, for what is found wrong when the image is known. */
static sonject_status write_down(const struct tree *tree, const struct tree_node *node,
                                 struct key_path *path, struct scene *scene)
{
    for (size_t i = 0; i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        const size_t before =
            entry->key ? key_path_add(path, entry->key) : key_path_add_index(path, i);
        char place[TREE_PLACE_TEXT];
        tree_place_text(tree, entry->value.place, place);
        CHECK(written_keys_add(&scene->written, tree->report, path->text, place));
        CHECK(write_down(tree, &entry->value, path, scene));
        key_path_shorten(path, before);
    }
    return SONJECT_OK;
}

sonject_status scene_text_read(struct report *report, const struct scene_text *source,
                               struct scene *scene)
{
    struct tree tree;
    struct mistakes mistakes = {NULL, 0, 0, 0};
    tree_init(&tree, report, source->path);
    tree.mistakes = &mistakes;
    report->message[0] = 0;
    sonject_status status = tree_parse(&tree, source->text, source->bytes);
    THEN(status, fill_scene(&tree, source, scene));
    status = mistakes_tell(&mistakes, report, status);
    struct key_path path = {"", 0};
    THEN(status, write_down(&tree, &tree.root, &path, scene));
    tree_clear(&tree);
    if (status != SONJECT_OK)
        scene_clear(scene);
    return status;
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
    char *text;
    size_t bytes;
    sonject_status status = scene_file_load(report, path, &text, &bytes);
    if (status != SONJECT_OK)
        return status;
    const struct scene_text source = {.path = path,
                                      .text = text,
                                      .bytes = bytes,
                                      .overrides = overrides,
                                      .override_count = count,
                                      .allows_user_shapes = allows_user_shapes};
    status = scene_text_read(report, &source, scene);
    free(text);
    return status;
}

sonject_status scene_text_tree(const struct scene_text *source, struct tree *tree)
{
    CHECK(tree_parse(tree, source->text, source->bytes));
    return apply_overrides(tree, source);
}

sonject_status scene_text_bands(struct report *report, const struct scene_text *source,
                                char **names)
{
    struct tree tree;
    tree_init(&tree, report, source->path);
    struct reader reader = {.report = report, .tree = &tree};
    *names = NULL;
    sonject_status status = scene_text_tree(source, &tree);
    THEN(status, list_bands(&reader, names));
    tree_clear(&tree);
    return status;
}
