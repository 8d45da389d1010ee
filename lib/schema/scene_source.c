/* The source of a scene: the values that calls set, and the scene as text. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "schema/keys.h"
#include "schema/scene_file.h"

static void array_clear(struct number_array *array)
{
    free(array->name);
    free(array->columns);
    free(array->values);
}

void scene_source_clear(struct scene_source *source)
{
    for (size_t i = 0; i < source->override_count; i++)
        free((char *)source->overrides[i]);
    for (size_t i = 0; i < source->array_count; i++)
        array_clear(&source->arrays[i]);
    tree_clear(&source->tree);
    free(source->overrides);
    free(source->arrays);
    free((char *)source->path);
    free((char *)source->text);
    memset(source, 0, sizeof *source);
}

static void forget_tree(struct scene_source *source)
{
    tree_clear(&source->tree);
    source->tree.file = NULL;
}

sonject_status scene_source_keep_tree(struct scene_source *source, struct report *report)
{
    struct tree *tree = &source->tree;
    if (tree->file)
        return SONJECT_OK;
    tree_init(tree, report, source->path);
    const sonject_status status = scene_source_tree(source, tree);
    if (status != SONJECT_OK)
        forget_tree(source);
    return status;
}

/* Returns whether an override is of the key or of a key below it. */
static bool is_below(const char *override, const char *key, size_t length)
{
    return strncmp(override, key, length) == 0 && strchr("=.[", override[length]);
}

/* Keeps an override in the place of an earlier value of the key, so that a list's entries stay in
 * order, and removes values below the key. No later override sets a section around the key, because
 * that removes the values within. Takes the override over. There is room for one more. */
static void keep_override(struct scene_source *source, const char *override)
{
    const char *key = override;
    const size_t length = strcspn(key, "=");
    const size_t count = source->override_count;
    size_t kept = 0;
    size_t given = 0;
    for (size_t i = 0; i < count; i++) {
        const char *old = source->overrides[i];
        if (is_below(old, key, length)) {
            free((char *)old);
            old = override;
            override = NULL;
        }
        if (old)
            source->overrides[kept++] = old;
        if (i < count - source->set_count)
            given = kept;
    }
    if (override)
        source->overrides[kept++] = override;
    source->override_count = kept;
    source->set_count = kept - given;
}

sonject_status scene_source_keep(struct scene_source *source, struct report *report,
                                 const char *path, char *text, const char *const *overrides,
                                 size_t count)
{
    source->text = text;
    source->path = copy_text(path);
    source->overrides = allocate_array(count, sizeof *source->overrides);
    CHECK_MEMORY(report, text && source->path && source->overrides, "a scene");
    for (size_t i = 0; i < count; i++) {
        char *override = copy_text(overrides[i]);
        CHECK_MEMORY(report, override, "a scene");
        keep_override(source, override);
    }
    source->set_count = 0;
    return SONJECT_OK;
}

/* Returns "key=value", for free(), or NULL if memory is out. */
static char *join_override(const char *key, const char *value)
{
    const size_t key_bytes = strlen(key);
    char *override = malloc(key_bytes + strlen(value) + 2);
    if (!override)
        return NULL;
    memcpy(override, key, key_bytes);
    override[key_bytes] = '=';
    strcpy(override + key_bytes + 1, value);
    return override;
}

/* Checks that the key and the value's keys exist. The tree then has the value. */
static sonject_status check_override(struct scene_source *source, struct report *report,
                                     const char *override)
{
    struct tree *tree = &source->tree;
    char hint[HINT_CAPACITY];
    const struct tree_node *node;
    CHECK(scene_source_keep_tree(source, report));
    CHECK(tree_override(tree, override, &node));
    const char *key = tree->override_paths[tree->override_count - 1];
    const struct tree_place place = {key, 1, 1};
    if (!scene_key_is_known(key, hint))
        return tree_failure(tree, place, key, "there is no such key%s", hint);
    struct key_path path = {"", 0};
    path.length = (size_t)snprintf(path.text, sizeof path.text, "%.200s", key);
    return check_scene_keys(tree, node, &path, "unknown key", "");
}

sonject_status scene_source_set(struct scene_source *source, struct report *report, const char *key,
                                const char *value)
{
    const char **overrides =
        realloc(source->overrides, (source->override_count + 1) * sizeof *overrides);
    char *override = join_override(key, value);
    if (overrides)
        source->overrides = overrides;
    sonject_status status = !overrides || !override ? report_out_of_memory(report, "a scene")
                            : strchr(key, '=')
                                ? input_failure(report, key, "not a key; its value goes by itself")
                                : check_override(source, report, override);
    if (status == SONJECT_OK) {
        keep_override(source, override);
        return SONJECT_OK;
    }
    forget_tree(source); /* the tree may hold a part of the value */
    free(override);
    return status;
}

/* Returns whether a key names a table, or a grid of heights, and so may be given as an array. */
static bool takes_array(const char *key, bool *is_grid)
{
    static const char *const of_tables[] = {"sonar.pulse.file",    "sonar.measured_response",
                                            "sonar.motion.file",   "sonar.motion.yaw.file",
                                            "medium.profile.file", "input.pings"};
    static const char of_heights[] = "].heights.file";
    const char *index_end = strchr(key, ']');
    *is_grid =
        strncmp(key, "seabed.relief[", 14) == 0 && index_end && strcmp(index_end, of_heights) == 0;
    for (size_t i = 0; i < sizeof of_tables / sizeof *of_tables; i++)
        if (strcmp(key, of_tables[i]) == 0)
            return true;
    return *is_grid;
}

static bool copy_array(struct number_array *copy, const struct number_array *array)
{
    memset(copy, 0, sizeof *copy);
    copy->rows = array->rows;
    copy->column_count = array->column_count;
    copy->columns = array->columns ? copy_text(array->columns) : NULL;
    copy->name = malloc(strlen(array->name) + sizeof ", given as an array");
    copy->values = allocate_array(array->rows, array->column_count * sizeof *copy->values);
    if (!copy->name || !copy->values || (array->columns && !copy->columns)) {
        array_clear(copy);
        return false;
    }
    strcat(strcpy(copy->name, array->name), ", given as an array");
    memcpy(copy->values, array->values, array->rows * array->column_count * sizeof *copy->values);
    return true;
}

sonject_status scene_source_set_array(struct scene_source *source, struct report *report,
                                      const struct number_array *array)
{
    bool is_grid;
    const char *key = array->name;
    if (!takes_array(key, &is_grid))
        return input_failure(report, key,
                             "takes no array; sonar.pulse.file, sonar.measured_response, "
                             "sonar.motion.file, sonar.motion.yaw.file, medium.profile.file, "
                             "input.pings and seabed.relief[0].heights.file do");
    if (is_grid != (array->columns == NULL))
        return input_failure(report, key, "%s",
                             is_grid ? "heights have no names of columns" : "name the columns");
    if (array->rows == 0 || array->column_count == 0 || array->rows > ARRAY_VALUES_MAX ||
        array->column_count > ARRAY_VALUES_MAX / array->rows)
        return input_failure(report, key, "an array has 1 to 2^24 numbers, not %zu x %zu",
                             array->rows, array->column_count);
    struct number_array copy;
    struct number_array *arrays =
        realloc(source->arrays, (source->array_count + 1) * sizeof *arrays);
    if (arrays)
        source->arrays = arrays;
    if (!arrays || !copy_array(&copy, array))
        return report_out_of_memory(report, "an array");
    const sonject_status status = scene_source_set(source, report, key, copy.name);
    size_t i = 0;
    while (i < source->array_count && strcmp(arrays[i].name, copy.name) != 0)
        i++;
    if (status != SONJECT_OK) {
        array_clear(&copy);
    } else if (i < source->array_count) {
        array_clear(&arrays[i]);
        arrays[i] = copy;
    } else {
        arrays[source->array_count++] = copy;
    }
    return status;
}

sonject_status scene_source_text(struct scene_source *source, struct report *report, char **text)
{
    struct growing_text lines = {NULL, 0, 0, false};
    *text = NULL;
    CHECK(scene_source_keep_tree(source, report));
    sonject_status status = name_files_absolutely(source, report);
    const struct tree_node *root = &source->tree.root;
    growing_text_add(&lines, "%s", "");
    for (size_t i = 0; i < root->count; i++) {
        growing_text_add(&lines, "%s: ", root->entries[i].key);
        tree_write_flow(&root->entries[i].value, &lines);
        growing_text_add(&lines, "\n");
    }
    forget_tree(source); /* the next call may be made in another working folder */
    *text = growing_text_end(&lines);
    if (status == SONJECT_OK && !*text)
        status = report_out_of_memory(report, "the scene's text");
    if (status != SONJECT_OK) {
        free(*text);
        *text = NULL;
    }
    return status;
}
