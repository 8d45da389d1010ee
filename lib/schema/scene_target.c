#include "schema/scene_target.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "schema/scene_parts.h"
#include "schema/scene_shape.h"

/* Only noted: read_target_parts reads them. */
static sonject_status note_parts(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    struct target_text *target = structure;
    (void)reader;
    target->object.shape = SONJECT_SHAPE_PARTS;
    target->parts = node;
    return SONJECT_OK;
}

static sonject_status finish_target(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    const struct target_text *target = structure;
    if (count_given(node, "shape parts") == 1)
        check_shape_keys(reader, node, target->object.shape);
    check_shape_values(reader, node, &target->object);
    return check_one_given(reader, node, "shape parts", "shape and parts");
}

/* There is no key for another file: targets are described in one. */
static const struct field target_fields[] = {
    {"sonject_target", "version of the format, 1", .kind = FIELD_SPECIAL, .read = read_version,
     REQUIRED},
    {"name", "of the target", LABEL(sonject_object_params, name)},
    {"class", "label for training", LABEL(sonject_object_params, class_name)},
    SHAPE_FIELDS,
    SURFACE_FIELD("surface of the target: a material's name, or a section"),
    {"parts", "instead of one shape: the target is their union", .kind = FIELD_SPECIAL,
     .unit = "list", .read = note_parts},
};
static const struct section target_section = {target_fields, COUNT(target_fields), finish_target};

static struct reader reader_of_target(const struct reader *reader, const struct target_text *target)
{
    return (struct reader){.report = reader->report,
                           .tree = &target->tree,
                           .scene = reader->scene,
                           .allows_user_shapes = reader->allows_user_shapes};
}

/* Reads the file that the target names. */
static sonject_status read_target_file(struct reader *reader, struct tree_place named_at,
                                       struct target_text *target)
{
    char *text = NULL;
    size_t bytes;
    sonject_status status =
        file_read_whole(reader->report, target->file, TREE_BYTES_MAX, &text, &bytes);
    if (status != SONJECT_OK)
        return status;
    tree_init(&target->tree, reader->report, target->file);
    target->tree.mistakes = reader->tree->mistakes;
    target->tree.named_at = named_at;
    status = tree_parse(&target->tree, text, bytes);
    free(text);
    struct reader inner = reader_of_target(reader, target);
    if (status == SONJECT_OK && tree_is_null(&target->tree.root))
        status = refuse_value(&inner, &target->tree.root,
                              "there is nothing in it; start with 'sonject_target: 1'");
    THEN(status, read_section(&inner, &target_section, &target->tree.root, target));
    return status;
}

sonject_status read_target(struct reader *reader, const struct tree_node *node,
                           struct target_text *target)
{
    sonject_status status = read_existing_path(reader, node, &target->file);
    if (status != SONJECT_OK)
        return status;
    status = read_target_file(reader, node->place, target);
    if (target->tree.file && mistakes_concern(reader->tree->mistakes, &target->tree, ""))
        mark_wrong(reader, node, ""); /* whatever the file says is told already */
    return status;
}

sonject_status read_target_parts(struct reader *reader, const struct target_text *target)
{
    if (!target->parts)
        return SONJECT_OK;
    struct reader inner = reader_of_target(reader, target);
    key_path_add(&inner.path, "parts");
    return read_parts(&inner, target->parts, &target->object.material);
}

void target_text_clear(struct target_text *target)
{
    if (target->file)
        tree_clear(&target->tree);
    free(target->file);
    target->file = NULL;
}

/* Place, pose and level of an object, and what it is called, where that is said. */
static void take_placing(sonject_object_params *to, const sonject_object_params *from)
{
    if (from->name[0])
        memcpy(to->name, from->name, sizeof to->name);
    if (from->class_name[0])
        memcpy(to->class_name, from->class_name, sizeof to->class_name);
    to->position_kind = from->position_kind;
    to->position_along = from->position_along;
    to->position_range = from->position_range;
    to->heading_rad = from->heading_rad;
    to->pitch_rad = from->pitch_rad;
    to->roll_rad = from->roll_rad;
    to->burial_kind = from->burial_kind;
    to->burial_m = from->burial_m;
    to->burial_fraction = from->burial_fraction;
    to->proud_height_m = from->proud_height_m;
    to->level_kind = from->level_kind;
    to->level_db = from->level_db;
}

static sonject_status append_target(struct reader *reader, struct target_text *target,
                                    const sonject_object_params *placing)
{
    static const struct tree_place nowhere;
    sonject_status status = read_target_file(reader, nowhere, target);
    if (status == SONJECT_OK) {
        take_placing(&target->object, placing);
        status = check_object(&target->object, reader->report, NULL);
    }
    if (!reading_ends(status)) {
        const sonject_status of_parts = read_target_parts(reader, target);
        status = of_parts == SONJECT_OK ? status : of_parts;
    }
    THEN(status, scene_append_object(reader->scene, reader->report, &target->object));
    return status;
}

sonject_status scene_append_target(struct scene *scene, struct report *report, const char *path,
                                   bool allows_user_shapes, const sonject_object_params *placing)
{
    char excerpt[400];
    struct target_text target;
    struct mistakes mistakes = {NULL, 0, 0, 0};
    struct tree tree = {.mistakes = &mistakes};
    struct reader reader = {
        .report = report, .tree = &tree, .scene = scene, .allows_user_shapes = allows_user_shapes};
    const struct scene_counts before = scene_count(scene);
    if (!file_exists(path))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: there is no such target file; check its name",
                              text_excerpt(excerpt, sizeof excerpt, path));
    memset(&target, 0, sizeof target);
    start_shape(&target.object, NULL);
    target.file = copy_text(path);
    if (!target.file)
        return report_out_of_memory(report, "a path");
    const sonject_status status =
        mistakes_tell(&mistakes, report, append_target(&reader, &target, placing));
    target_text_clear(&target);
    if (status != SONJECT_OK)
        scene_cut_back(scene, &before);
    return status;
}
