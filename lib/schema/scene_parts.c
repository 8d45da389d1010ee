/* Parts of objects: a list of shapes, each with its place, or of groups of such. */
#include "schema/scene_parts.h"

#include <string.h>

#include "scene/placement.h"
#include "schema/scene_shape.h"

#define LEVELS_MAX 8 /* of lists within lists */

/* Where parts of a list are placed, in the object's own frame. */
struct frame {
    double axes[3][3]; /* rows: nose, own y, own z */
    double origin[3];  /* m */
};

/* A part, or a group of parts, on its way into the scene. */
struct part_text {
    sonject_object_params shape; /* first: tables of shapes fill it; angles: the part's */
    double along_m, across_m, up_m;
    const struct frame *outer;
    int level; /* of the list that it stands in, from 1 */
    bool is_group;
};

static sonject_status read_level(struct reader *reader, const struct tree_node *node,
                                 const struct frame *frame, const sonject_material_params *material,
                                 int level);

static struct frame frame_of(const struct part_text *part)
{
    struct frame frame;
    double turned[3][3];
    const double at[3] = {part->along_m, part->across_m, part->up_m};
    turn_axes(turned, part->shape.heading_rad, part->shape.pitch_rad, part->shape.roll_rad);
    compose_axes(frame.axes, turned, (double(*)[3])part->outer->axes);
    memcpy(frame.origin, part->outer->origin, sizeof frame.origin);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            frame.origin[k] += at[i] * part->outer->axes[i][k];
    return frame;
}

static sonject_status read_group(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    struct part_text *part = structure;
    const struct frame frame = frame_of(part);
    part->is_group = true;
    return read_level(reader, node, &frame, &part->shape.material, part->level + 1);
}

static sonject_status finish_part(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct part_text *part = structure;
    sonject_part_params place;
    sonject_part_params_init(&place);
    place.along_m = part->along_m;
    place.across_m = part->across_m;
    place.up_m = part->up_m;
    if (part->is_group)
        part->shape.shape = SONJECT_SHAPE_PARTS;
    if (count_given(node, "shape parts") == 1)
        check_shape_keys(reader, node, part->shape.shape);
    check_shape_values(reader, node, &part->shape);
    check_part(&place, NULL, listen_at(reader, node));
    return check_one_given(reader, node, "shape parts", "shape and parts");
}

#define STRUCTURE struct part_text
static const struct field at_fields[] = {
    {"along", "along the object's nose", QUANTITY(STRUCTURE, along_m, QUANTITY_LENGTH)},
    {"across", "along its own y, to which heading turns the nose",
     QUANTITY(STRUCTURE, across_m, QUANTITY_LENGTH)},
    {"up", "along its own z, up when level", QUANTITY(STRUCTURE, up_m, QUANTITY_LENGTH)},
};
static const struct section at_section = {at_fields, COUNT(at_fields), NULL};

/* Keys are read in this order: what is in a group needs the group's pose and surface. */
static const struct field part_fields[] = {
    {"name", "of this part or group", LABEL(sonject_object_params, name)},
    SHAPE_FIELDS,
    {"at", "place of the centre in the object or group, by default its origin", SAME(at_section)},
    TURN_FIELDS("of the part's nose, from that of the object or group towards its own y"),
    SURFACE_FIELD("surface of the part; by default that of the object or group"),
    {"parts", "instead of one shape: a group, placed and turned as one", .kind = FIELD_SPECIAL,
     .unit = "list", .read = read_group},
};
const struct section part_section = {part_fields, COUNT(part_fields), finish_part};
#undef STRUCTURE

static sonject_status append_part(struct reader *reader, const struct tree_node *node,
                                  const struct part_text *part)
{
    const struct frame frame = frame_of(part);
    struct scene_part made;
    if (reader->scene->part_count >= SCENE_PARTS_MAX)
        return refuse_value(reader, node, "is one part too many: a scene may have %d; split it",
                            SCENE_PARTS_MAX);
    memset(&made, 0, sizeof made);
    made.object = reader->scene->object_count;
    made.shape = part->shape;
    made.shape.heading_rad = made.shape.pitch_rad = made.shape.roll_rad = 0.0;
    memcpy(made.axes, frame.axes, sizeof made.axes);
    memcpy(made.centre, frame.origin, sizeof made.centre);
    return scene_append_part(reader->scene, reader->report, &made);
}

/* A list of parts, and what they have of the object or group that they are in. */
struct part_list {
    const struct frame *frame;
    const sonject_material_params *material;
    int level;
};

static sonject_status read_part(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    const struct part_list *list = structure;
    struct part_text part;
    memset(&part, 0, sizeof part);
    start_shape(&part.shape, list->material);
    part.outer = list->frame;
    part.level = list->level;
    const sonject_status status = read_section(reader, &part_section, node, &part);
    if (status != SONJECT_OK || part.is_group)
        return status;
    return append_part(reader, node, &part);
}

static sonject_status read_level(struct reader *reader, const struct tree_node *node,
                                 const struct frame *frame, const sonject_material_params *material,
                                 int level)
{
    static const struct list parts = {SIZE_MAX, "; start each part with '- '", read_part};
    struct part_list list = {frame, material, level};
    if (level > LEVELS_MAX)
        return refuse_value(reader, node, "nested too deeply; parts may be %d levels deep",
                            LEVELS_MAX);
    if (node->kind == TREE_LIST && node->count == 0)
        return refuse_value(reader, node, "is empty; give at least one part");
    return read_list(reader, node, &parts, &list);
}

sonject_status read_parts(struct reader *reader, const struct tree_node *node,
                          const sonject_material_params *material)
{
    static const struct frame own = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}},
                                     {0.0, 0.0, 0.0}};
    return read_level(reader, node, &own, material, 1);
}
