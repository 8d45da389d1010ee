/* Shapes: their sizes, ends and cuts. */
#include "schema/scene_shape.h"

#include <string.h>

#include "scene/shapes/shape.h"

#define STRUCTURE sonject_object_params

void start_shape(sonject_object_params *shape, const sonject_material_params *material)
{
    sonject_object_params_init(shape);
    shape->diameter_m = 0.0;
    if (material)
        shape->material = *material;
}

/* {depth: } stands for a spherical end. */
static sonject_status finish_nose_end(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    sonject_object_params *object = structure;
    object->nose_end = SONJECT_END_SPHERICAL;
    if (!(object->nose_end_depth_m > 0.0))
        return refuse_key(reader, node, "depth",
                          "must be above 0; write 'spherical' for a half sphere, 'flat' for none");
    return SONJECT_OK;
}

static sonject_status finish_tail_end(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    sonject_object_params *object = structure;
    object->tail_end = SONJECT_END_SPHERICAL;
    if (!(object->tail_end_depth_m > 0.0))
        return refuse_key(reader, node, "depth",
                          "must be above 0; write 'spherical' for a half sphere, 'flat' for none");
    return SONJECT_OK;
}

static const struct field nose_end_fields[] = {
    {"depth", "of a spherical end, at most half the diameter",
     QUANTITY(STRUCTURE, nose_end_depth_m, QUANTITY_LENGTH), REQUIRED},
};
const struct section nose_end_section = {nose_end_fields, COUNT(nose_end_fields), finish_nose_end};
static const struct field tail_end_fields[] = {
    {"depth", "of a spherical end, at most half the diameter",
     QUANTITY(STRUCTURE, tail_end_depth_m, QUANTITY_LENGTH), REQUIRED},
};
const struct section tail_end_section = {tail_end_fields, COUNT(tail_end_fields), finish_tail_end};

static const struct field cut_fields[] = {
    {"azimuth", "of the side that is cut off, from the nose towards the object's own y",
     QUANTITY(sonject_cut, azimuth_rad, QUANTITY_ANGLE)},
    {"elevation", "of that side; 90 deg: the top",
     QUANTITY(sonject_cut, elevation_rad, QUANTITY_ANGLE)},
    {"distance", "of the cut from the centre towards that side",
     QUANTITY(sonject_cut, distance_m, QUANTITY_LENGTH), REQUIRED},
};
const struct section cut_section = {cut_fields, COUNT(cut_fields), NULL};

/* By the sound: no shape's name begins with a u as in "under". */
static const char *article_of(const char *name)
{
    return strchr("aeio", *name) ? "an" : "a";
}

void refuse_shape_keys(struct reader *reader, const struct tree_node *node, const char *reason)
{
    static const struct field fields[] = {SHAPE_FIELDS};
    for (size_t i = 0; i < COUNT(fields); i++)
        if (is_given(node, fields[i].key))
            refuse_key(reader, node, fields[i].key, "%s; remove it", reason);
}

void check_shape_keys(struct reader *reader, const struct tree_node *node, uint32_t shape)
{
    static const struct {
        const char *key;
        uint32_t bit;
    } sizes[] = {
        {"length", SHAPE_HAS_LENGTH},
        {"width", SHAPE_HAS_WIDTH},
        {"diameter", SHAPE_HAS_DIAMETER},
        {"height", SHAPE_HAS_HEIGHT},
        {"user", SHAPE_HAS_CODE},
        {"top_diameter", SHAPE_HAS_TOP_DIAMETER},
        {"front_height", SHAPE_HAS_FRONT_HEIGHT},
        {"nose_end", SHAPE_HAS_ENDS},
        {"tail_end", SHAPE_HAS_ENDS},
        {"mesh", SHAPE_HAS_MESH},
    };
    const struct shape *row = shape_of(shape);
    if (shape == SONJECT_SHAPE_PARTS) {
        refuse_shape_keys(reader, node, "the parts have shapes of their own");
        return;
    }
    for (size_t i = 0; i < COUNT(sizes); i++) {
        if ((row->needs & sizes[i].bit) && !is_given(node, sizes[i].key))
            refuse_relation(reader, node, sizes[i].key, "shape", "missing; %s %s needs it",
                            article_of(row->name), row->name);
        if (!((row->needs | row->may_have) & sizes[i].bit) && is_given(node, sizes[i].key))
            refuse_relation(reader, node, sizes[i].key, "shape", "%s %s has none; remove it",
                            article_of(row->name), row->name);
    }
}

/* Sizes say nothing where the shape is unknown; what another section or file tells is checked
 * there. */
void check_shape_values(struct reader *reader, const struct tree_node *node,
                        const sonject_object_params *shape)
{
    sonject_object_params checked = *shape;
    if (count_given(node, "shape parts target") != 1 || !are_sound(reader, "shape target")) {
        checked.shape = SONJECT_SHAPE_PARTS;
        checked.cut_count = 0;
    }
    if (!is_given(node, "name"))
        checked.name[0] = 0;
    if (!is_given(node, "class"))
        checked.class_name[0] = 0;
    if (!is_given(node, "material"))
        sonject_material_params_init(&checked.material);
    if (check_object(&checked, NULL, listen_at(reader, node)) == SONJECT_OK)
        check_cuts_in_scene(reader->scene, &checked, NULL, listen_at(reader, node));
}
