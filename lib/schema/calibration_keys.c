/* The calibration that input.calibration names: a file with keys of scenes, which apply where the
 * scene has none of its own. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "scene/geometry.h"
#include "schema/keys.h"

struct layer {
    struct reader *reader;
    struct tree *tree;
    struct tree calibration;
    struct tree_place place; /* place of the key that names the file */
    struct key_path path;    /* path of the current key, the same in scene and calibration */
    struct growing_text taken;
};

/* Sets a value's place to where the scene names the file, for messages. */
static void move_place(struct tree_node *node, struct tree_place place)
{
    node->place = place;
    for (size_t i = 0; i < node->count; i++) {
        node->entries[i].place = place;
        move_place(&node->entries[i].value, place);
    }
}

static void note_taken(struct layer *layer, const struct tree_node *node)
{
    if (node->kind != TREE_SECTION) {
        growing_text_add(&layer->taken, "%s\n", layer->path.text);
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        const size_t before = key_path_add(&layer->path, node->entries[i].key);
        note_taken(layer, &node->entries[i].value);
        key_path_shorten(&layer->path, before);
    }
}

/* Returns whether a key of the calibration does not fit the scene's own keys: the parameter of
 * another transfer curve, or a nadir beside the range of column 0. */
static bool is_hidden(const struct layer *layer, const struct tree_node *scene, const char *key)
{
    const char *path = layer->path.text;
    return (strcmp(path, "input.transfer") == 0 && tree_find(scene, "kind") &&
            strcmp(key, "full_scale") != 0) ||
           (strcmp(path, "input.geometry") == 0 && tree_find(scene, "first_slant_range") &&
            strcmp(key, "nadir_column") == 0);
}

/* Moves the entries that the scene's section lacks from the calibration's section into it. */
static sonject_status lay_under(struct layer *layer, struct tree_node *scene,
                                struct tree_node *calibration)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < calibration->count; i++) {
        struct tree_entry *from = &calibration->entries[i];
        struct tree_entry *to = tree_find(scene, from->key);
        if (is_hidden(layer, scene, from->key))
            continue;
        const size_t before = key_path_add(&layer->path, from->key);
        if (to && to->value.kind == TREE_SECTION && from->value.kind == TREE_SECTION) {
            status = lay_under(layer, &to->value, &from->value);
        } else if (!to) {
            status = tree_append(layer->tree, scene, &layer->path, from->key, layer->place, &to);
            if (status == SONJECT_OK) {
                const struct tree_node empty = to->value;
                move_place(&from->value, layer->place);
                to->value = from->value;
                from->value = empty;
                note_taken(layer, &to->value);
            }
        }
        key_path_shorten(&layer->path, before);
    }
    return status;
}

/* Returns the number that a text is, or NAN if the text is no number or node is NULL. */
static double number_of_text(const struct tree_node *node)
{
    const char *rest;
    double number;
    return node && node->kind == TREE_TEXT && node->text &&
                   text_to_number(node->text, &number, &rest) && !*rest
               ? number
               : NAN;
}

/* Takes the first returns of a whole swath, if the file has all of them as columns. */
static sonject_status take_first_returns(struct report *report, const struct tree_node *measured,
                                         bool is_leftward, struct first_return_list *returns)
{
    const struct tree_node *columns = tree_value(measured, "first_return");
    const double width = number_of_text(tree_value(measured, "columns"));
    const double step = number_of_text(tree_value(measured, "first_return_every"));
    if (!columns || columns->kind != TREE_LIST || columns->count == 0 ||
        !(step >= 1.0 && step <= (double)PING_ROWS_MAX))
        return SONJECT_OK;
    double *found = allocate_array(columns->count, sizeof *found);
    CHECK_MEMORY(report, found, "first returns");
    bool are_columns = true;
    for (size_t i = 0; i < columns->count; i++) {
        found[i] = number_of_text(&columns->entries[i].value);
        are_columns = are_columns && found[i] >= 0.0 && isfinite(found[i]);
    }
    if (!are_columns) {
        free(found);
        return SONJECT_OK;
    }
    const bool has_width = tree_value(measured, "columns") != NULL;
    *returns = (struct first_return_list){found, columns->count, (size_t)step,
                                          is_leftward && has_width ? width - 0.5 : 0.0};
    return SONJECT_OK;
}

/* Returns whether the scene needs first returns, of which a long line has thousands. */
static bool asks_for_returns(const struct tree_node *scene)
{
    const struct tree_node *altitude = tree_value(tree_value(scene, "sonar"), "altitude");
    return altitude && is_word(altitude, "first_return");
}

/* Takes the swath, the side and the altitudes that the calibration was measured on. */
static void take_measured(struct scene *scene, const struct tree_node *measured)
{
    const struct tree_node *side = tree_value(measured, "side");
    const struct tree_node *sides = tree_value(measured, "sides");
    const struct tree_node *hash = tree_value(measured, "swath_xxh3");
    const double share =
        number_of_text(tree_value(tree_value(measured, "recorded_altitude"), "over_first_return"));
    if (side && side->kind == TREE_TEXT && side->text)
        snprintf(scene->calibrated_side, sizeof scene->calibrated_side, "%s", side->text);
    if (hash && hash->kind == TREE_TEXT && hash->text)
        snprintf(scene->calibrated_hash, sizeof scene->calibrated_hash, "%s", hash->text);
    scene->calibrated_leftward = sides && is_word(sides, LEFTWARD_SIDES);
    if (!isnan(share))
        scene->recorded_over_first_return = share;
}

/* Checks version and sections, and lays the sections' keys under the scene's. */
static sonject_status take_keys(struct layer *layer, const char *file)
{
    static const char *const sections[] = {"input", "sonar", "injection"};
    struct tree *own = &layer->calibration;
    const struct tree_entry *version = tree_find(&own->root, "sonject_calibration");
    if (!version || !is_word(&version->value, "1"))
        return tree_failure(own, version ? version->place : own->root.place, "sonject_calibration",
                            "must be 1: is it a file of sonject calibrate?");
    for (size_t i = 0; i < own->root.count; i++) {
        struct tree_entry *entry = &own->root.entries[i];
        bool is_known = false;
        for (size_t k = 0; k < COUNT(sections); k++)
            is_known = is_known || strcmp(entry->key, sections[k]) == 0;
        if (strcmp(entry->key, "measured") == 0) {
            struct scene *scene = layer->reader->scene;
            take_measured(scene, &entry->value);
            if (asks_for_returns(&layer->tree->root))
                CHECK(take_first_returns(layer->reader->report, &entry->value,
                                         scene->calibrated_leftward, &scene->first_returns));
        }
        if (strcmp(entry->key, "sonject_calibration") == 0 || strcmp(entry->key, "measured") == 0)
            continue;
        if (!is_known || entry->value.kind != TREE_SECTION)
            return tree_failure(own, entry->place, entry->key,
                                "a calibration has the sections input, sonar, injection and "
                                "measured");
        struct tree_node root = {.kind = TREE_SECTION, .entries = entry, .count = 1};
        CHECK(check_scene_keys(own, &root, &layer->path, "no key of scenes",
                               "; what was measured goes below measured"));
        CHECK(lay_under(layer, &layer->tree->root, &root));
    }
    layer->reader->scene->calibration = copy_text(file);
    layer->reader->scene->calibrated = growing_text_end(&layer->taken);
    memset(&layer->taken, 0, sizeof layer->taken);
    CHECK_MEMORY(layer->reader->report,
                 layer->reader->scene->calibration && layer->reader->scene->calibrated,
                 "a calibration");
    return SONJECT_OK;
}

static sonject_status lay_file(struct reader *reader, struct tree *tree,
                               const struct tree_node *named, const char *file)
{
    char *text = NULL;
    size_t bytes;
    struct layer layer = {.reader = reader, .tree = tree, .place = named->place};
    CHECK(file_read_whole(reader->report, file, TREE_BYTES_MAX, &text, &bytes));
    tree_init(&layer.calibration, reader->report, file);
    layer.calibration.mistakes = tree->mistakes;
    layer.calibration.named_at = named->place;
    sonject_status status = tree_parse(&layer.calibration, text, bytes);
    free(text);
    THEN(status, take_keys(&layer, file));
    free(layer.taken.characters);
    tree_clear(&layer.calibration);
    return status;
}

sonject_status take_calibration(struct reader *reader, struct tree *tree)
{
    const struct tree_node *input = tree_value(&tree->root, "input");
    const struct tree_node *named = tree_value(input, "calibration");
    const char *made = reader->made_calibration;
    char *file = NULL;
    if (!named || count_given(input, "uniform synthetic") > 0)
        return SONJECT_OK; /* read_section refuses these combinations */
    if (is_word(named, "auto")) {
        reader->scene->calibrates_itself = made == NULL;
        return made ? lay_file(reader, tree, named, made) : SONJECT_OK;
    }
    const size_t outer = key_path_add(&reader->path, "input");
    key_path_add(&reader->path, "calibration");
    sonject_status status = read_existing_path(reader, named, &file);
    key_path_shorten(&reader->path, outer);
    THEN(status, lay_file(reader, tree, named, file));
    free(file);
    return status;
}
