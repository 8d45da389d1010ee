/* Scene files, from bytes to a scene: overrides, bands, then the tables of keys. */
#include "schema/scene_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "schema/keys.h"

/* ---- Bands: several sonars in one file. Each has a name and the keys in which it differs. */

bool is_band_name(const char *text)
{
    static const char letters[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    return text[0] && strlen(text) < SONJECT_NAME_CAPACITY && text[strspn(text, letters)] == '\0';
}

/* Checks a band, which may not hold the keys sonject, band and bands. */
static sonject_status check_band(struct reader *reader, const struct tree_entry *band)
{
    static const char *const others[] = {"sonject", "band", "bands"};
    sonject_status status = SONJECT_OK;
    const size_t before = key_path_add(&reader->path, band->key);
    if (!is_band_name(band->key))
        status = refuse_value(reader, &band->value,
                              "a band's name is that of a folder: 1 to %d letters, digits, _ and -",
                              SONJECT_NAME_CAPACITY - 1);
    else if (band->value.kind != TREE_SECTION)
        status = refuse_value(reader, &band->value,
                              "must be a section of the scene's keys that this band changes");
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (is_given(&band->value, others[i]))
            status =
                refuse_key(reader, &band->value, others[i], "cannot be a band's own; remove it");
    key_path_shorten(&reader->path, before);
    return status;
}

static sonject_status check_bands(struct reader *reader, const struct tree_node *bands)
{
    sonject_status status = SONJECT_OK;
    const size_t before = key_path_add(&reader->path, "bands");
    if (bands->kind != TREE_SECTION || bands->count == 0)
        status = refuse_value(reader, bands, "must be a section of bands: their names, and keys");
    for (size_t i = 0; bands->kind == TREE_SECTION && i < bands->count; i++)
        if (check_band(reader, &bands->entries[i]) != SONJECT_OK)
            status = SONJECT_ERROR_INPUT;
    key_path_shorten(&reader->path, before);
    return status;
}

/* Returns the node, or one within it, that an override made; NULL: none. */
static const struct tree_node *set_within(const struct tree_node *node)
{
    const struct tree_node *set = node->place.override ? node : NULL;
    for (size_t i = 0; !set && i < node->count; i++)
        set = set_within(&node->entries[i].value);
    return set;
}

/* Swaps the upper section's values into the lower one, except where an override has set the lower
 * value. */
static sonject_status lay_over(struct reader *reader, struct tree *tree, struct tree_node *lower,
                               struct tree_node *upper)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < upper->count; i++) {
        struct tree_entry *above = &upper->entries[i];
        struct tree_entry *below = tree_find(lower, above->key);
        const struct tree_node *set = below ? set_within(&below->value) : NULL;
        const size_t before = key_path_add(&reader->path, above->key);
        if (below && below->value.kind == TREE_SECTION && above->value.kind == TREE_SECTION) {
            status = lay_over(reader, tree, &below->value, &above->value);
        } else if (set && set != &below->value) {
            status = refuse_value(reader, set, "the band has its own %s: set the whole of it",
                                  above->key);
        } else if (!set) {
            if (!below)
                status = tree_append(tree, lower, &reader->path, above->key, above->place, &below);
            if (status == SONJECT_OK) {
                const struct tree_node hidden = below->value;
                below->value = above->value;
                above->value = hidden;
            }
        }
        key_path_shorten(&reader->path, before);
    }
    return status;
}

static void list_names(const struct tree_node *bands, struct word_list *list)
{
    for (size_t i = 0; i < bands->count; i++)
        list_word(list, bands->entries[i].key);
}

/* Returns the names, one per line, for free(); NULL: out of memory. */
static char *join_names(const struct tree_node *bands)
{
    struct growing_text text = {0};
    growing_text_add(&text, "%s", "");
    for (size_t i = 0; i < bands->count; i++)
        growing_text_add(&text, "%s\n", bands->entries[i].key);
    return growing_text_end(&text);
}

/* Keeps the band's name and all names in the scene. */
static sonject_status keep_names(struct reader *reader, const struct tree_node *bands,
                                 const char *name)
{
    reader->scene->band = copy_text(name);
    reader->scene->bands = join_names(bands);
    return reader->scene->band && reader->scene->bands
               ? SONJECT_OK
               : report_out_of_memory(reader->report, "the names of bands");
}

static sonject_status choose_band(struct reader *reader, struct tree *tree)
{
    struct word_list list = {{0}, 0};
    struct tree_entry *bands = tree_find(&tree->root, "bands");
    const struct tree_entry *chosen = tree_find(&tree->root, "band");
    if (!bands && !chosen)
        return SONJECT_OK;
    if (!bands)
        return refuse_key(reader, &tree->root, "band", "there are no bands to choose from");
    sonject_status status = check_bands(reader, &bands->value);
    if (status != SONJECT_OK)
        return status;
    list_names(&bands->value, &list);
    if (!chosen)
        return refuse_key(reader, &tree->root, "bands", "choose one of %s (--set band=%s)",
                          list.text, bands->value.entries[0].key);
    const size_t before = key_path_add(&reader->path, "band");
    const char *name = read_text(reader, &chosen->value);
    struct tree_entry *band = name ? tree_find(&bands->value, name) : NULL;
    if (!name)
        status = SONJECT_ERROR_INPUT;
    else if (!band)
        status = refuse_word(reader, &chosen->value, name, &list, NULL);
    key_path_shorten(&reader->path, before);
    THEN(status, keep_names(reader, &bands->value, name));
    return status == SONJECT_OK ? lay_over(reader, tree, &tree->root, &band->value) : status;
}

/* ---- The file. */

static sonject_status apply_overrides(struct tree *tree, const struct scene_source *source)
{
    sonject_status status = SONJECT_OK;
    tree->given_overrides = source->override_count - source->set_count;
    for (size_t i = 0; !reading_ends(status) && i < source->override_count; i++) {
        const sonject_status of_one = tree_override(tree, source->overrides[i], NULL);
        status = of_one == SONJECT_OK ? status : of_one;
    }
    return status;
}

static sonject_status fill_scene(struct tree *tree, const struct scene_source *source,
                                 struct scene *scene)
{
    struct reader reader = {.report = tree->report,
                            .tree = tree,
                            .scene = scene,
                            .moved_folder = source->moved_folder,
                            .moved_overrides = source->moved_overrides,
                            .arrays = source->arrays,
                            .array_count = source->array_count,
                            .made_calibration = source->made_calibration,
                            .has_no_channels = source->has_no_channels,
                            .takes_pixels = source->takes_pixels};
    sonject_status status = apply_overrides(tree, source);
    if (reading_ends(status))
        return status;
    if (tree_is_null(&tree->root))
        return refuse_value(&reader, &tree->root,
                            "there is nothing in it; start with 'sonject: 1'");
    status = choose_band(&reader, tree);
    THEN(status, take_calibration(&reader, tree));
    return status == SONJECT_OK ? read_section(&reader, &scene_section, &tree->root, scene)
                                : status;
}

sonject_status scene_file_load(struct report *report, const char *path, char **text, size_t *bytes)
{
    char excerpt[400];
    if (!file_exists(path))
        return input_failure(report, text_excerpt(excerpt, sizeof excerpt, path),
                             "there is no such scene file; check its name");
    CHECK(file_read_whole(report, path, TREE_BYTES_MAX, text, bytes));
    if (strlen(*text) == *bytes)
        return SONJECT_OK;
    /* Text after a zero byte would be ignored. YAML has none, so its parser says where one is. */
    struct tree tree;
    tree_init(&tree, report, path);
    const sonject_status status = tree_parse(&tree, *text, *bytes);
    tree_clear(&tree);
    free(*text);
    *text = NULL;
    return status != SONJECT_OK ? status : input_failure(report, path, "has a zero byte within it");
}

/* Notes the place of every key, for mistakes that show only when the image is known. */
static sonject_status write_down(const struct tree *tree, const struct tree_node *node,
                                 struct key_path *path, struct scene *scene)
{
    for (size_t i = 0; i < node->count; i++) {
        const struct tree_entry *entry = &node->entries[i];
        const size_t before =
            entry->key ? key_path_add(path, entry->key) : key_path_add_index(path, i);
        char place[TREE_PLACE_TEXT];
        tree_place_text(tree, entry->value.place, place);
        CHECK(scene_note_key(scene, tree->report, path->text, place));
        CHECK(write_down(tree, &entry->value, path, scene));
        key_path_shorten(path, before);
    }
    return SONJECT_OK;
}

sonject_status scene_source_read(const struct scene_source *source, struct report *report,
                                 struct scene *scene)
{
    struct tree tree;
    struct mistakes mistakes = {0};
    struct mesh_store *const store = scene->mesh_store;
    scene_init(scene);
    scene->mesh_store = store;
    tree_init(&tree, report, source->path);
    tree.mistakes = &mistakes;
    report->message[0] = 0;
    sonject_status status = tree_parse(&tree, source->text, strlen(source->text));
    THEN(status, fill_scene(&tree, source, scene));
    if (source->are_relations)
        *source->are_relations = status == SONJECT_ERROR_INPUT && mistakes_are_relations(&mistakes);
    status = mistakes_tell(&mistakes, report, status);
    struct key_path path = {"", 0};
    THEN(status, write_down(&tree, &tree.root, &path, scene));
    tree_clear(&tree);
    if (status != SONJECT_OK) {
        scene_clear(scene);
        scene->mesh_store = store;
    }
    return status;
}

sonject_status scene_source_tree(const struct scene_source *source, struct tree *tree)
{
    CHECK(tree_parse(tree, source->text, strlen(source->text)));
    return apply_overrides(tree, source);
}

sonject_status scene_source_bands(const struct scene_source *source, struct report *report,
                                  char **names)
{
    struct tree tree;
    tree_init(&tree, report, source->path);
    struct reader reader = {.report = report, .tree = &tree};
    static const struct tree_node none;
    *names = NULL;
    sonject_status status = scene_source_tree(source, &tree);
    const struct tree_entry *bands = tree_find(&tree.root, "bands");
    const struct tree_node *open = bands && !tree_find(&tree.root, "band") ? &bands->value : &none;
    if (open != &none)
        THEN(status, check_bands(&reader, open));
    if (status == SONJECT_OK && !(*names = join_names(open)))
        status = report_out_of_memory(report, "the names of bands");
    tree_clear(&tree);
    return status;
}
