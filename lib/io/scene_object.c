/* The objects of a scene: their table, the keys that each shape has, and what is read in a way of
 * its own. */
#include <string.h>

#include "io/scene_fields.h"

#define STRUCTURE sonject_object_params

static bool is_given(const struct tree_node *node, const char *key)
{
    return tree_find(node, key) != NULL;
}

static const struct field position_fields[] = {
    {"along_track", "track position", QUANTITY(STRUCTURE, position_along, QUANTITY_LENGTH)},
    {"slant_range", "as the image shows it", QUANTITY(STRUCTURE, position_range, QUANTITY_LENGTH)},
    {"row", "of the swath, may be a fraction",
     QUANTITY(STRUCTURE, position_along, QUANTITY_NUMBER)},
    {"column", "of the swath, may be a fraction",
     QUANTITY(STRUCTURE, position_range, QUANTITY_NUMBER)},
};
static const struct section position_section = {position_fields, COUNT(position_fields),
                                                finish_position};

sonject_status finish_position(struct reader *reader, const struct tree_node *node, void *structure)
{
    sonject_object_params *object = structure;
    const int metres = is_given(node, "along_track") + is_given(node, "slant_range");
    const int pixels = is_given(node, "row") + is_given(node, "column");
    if (metres + pixels != 2 || metres == 1)
        return refuse_value(reader, node,
                            "needs along_track and slant_range, or row and column; give one pair");
    object->position_kind = metres ? SONJECT_POSITION_METRES : SONJECT_POSITION_PIXELS;
    return SONJECT_OK;
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
static const struct section nose_end_section = {nose_end_fields, COUNT(nose_end_fields),
                                                finish_nose_end};
static const struct field tail_end_fields[] = {
    {"depth", "of a spherical end, at most half the diameter",
     QUANTITY(STRUCTURE, tail_end_depth_m, QUANTITY_LENGTH), REQUIRED},
};
static const struct section tail_end_section = {tail_end_fields, COUNT(tail_end_fields),
                                                finish_tail_end};

/* A depth by itself. structure: the object. */
static sonject_status read_burial(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    sonject_object_params *object = structure;
    return read_quantity(reader, node, QUANTITY_LENGTH, &object->burial_m);
}

static sonject_status finish_burial(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    sonject_object_params *object = structure;
    if (is_given(node, "fraction") + is_given(node, "proud") != 1)
        return refuse_value(reader, node,
                            "needs fraction or proud; give one, or a depth by itself");
    object->burial_kind =
        is_given(node, "fraction") ? SONJECT_BURIAL_FRACTION : SONJECT_BURIAL_PROUD;
    return SONJECT_OK;
}

static const struct field burial_fields[] = {
    {"fraction", "of the height that the object has in its pose, 0 to 1",
     QUANTITY(STRUCTURE, burial_fraction, QUANTITY_NUMBER)},
    {"proud", "height of the highest point above the seabed",
     QUANTITY(STRUCTURE, proud_height_m, QUANTITY_LENGTH)},
};
static const struct section burial_section = {burial_fields, COUNT(burial_fields), finish_burial};

static const struct field cut_fields[] = {
    {"azimuth", "of the side that is cut off, from the nose towards the object's own y",
     QUANTITY(sonject_cut, azimuth_rad, QUANTITY_ANGLE)},
    {"elevation", "of that side; 90 deg: the top",
     QUANTITY(sonject_cut, elevation_rad, QUANTITY_ANGLE)},
    {"distance", "of the cut from the centre towards that side",
     QUANTITY(sonject_cut, distance_m, QUANTITY_LENGTH), REQUIRED},
};
static const struct section cut_section = {cut_fields, COUNT(cut_fields), NULL};

static sonject_status read_cuts(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    sonject_object_params *object = structure;
    sonject_status status = SONJECT_OK;
    if (tree_is_null(node))
        return SONJECT_OK;
    if (node->kind != TREE_LIST)
        return refuse_value(reader, node, "must be a list; start each cut with '- '");
    if (node->count > SONJECT_CUTS_CAPACITY)
        return refuse_value(reader, node, "has %zu entries; at most %d are possible", node->count,
                            SONJECT_CUTS_CAPACITY);
    for (size_t i = 0; status == SONJECT_OK && i < node->count; i++) {
        const size_t before = key_path_add_index(&reader->path, i);
        status = read_section(reader, &cut_section, &node->entries[i].value, &object->cuts[i]);
        key_path_shorten(&reader->path, before);
    }
    object->cut_count = (uint32_t)node->count;
    return status;
}

static const struct field object_fields[] = {
    {"name", "of this object", LABEL(STRUCTURE, name)},
    {"class", "label for training; by default the shape", LABEL(STRUCTURE, class_name)},
    {"shape", "of the object",
     WORD(STRUCTURE, shape) = {[SONJECT_SHAPE_PLANE] = "plane",
                               [SONJECT_SHAPE_SPHERE] = "sphere",
                               [SONJECT_SHAPE_CYLINDER] = "cylinder",
                               [SONJECT_SHAPE_CAPSULE] = "capsule",
                               [SONJECT_SHAPE_DISC] = "disc",
                               [SONJECT_SHAPE_ELLIPSOID] = "ellipsoid",
                               [SONJECT_SHAPE_BOX] = "box",
                               [SONJECT_SHAPE_WEDGE] = "wedge",
                               [SONJECT_SHAPE_CONE] = "cone",
                               [SONJECT_SHAPE_TRUNCATED_CONE] = "truncated_cone",
                               [SONJECT_SHAPE_TORUS] = "torus"},
     REQUIRED},
    {"length", "overall along the nose, of plane, cylinder, capsule, ellipsoid, box and wedge",
     QUANTITY(STRUCTURE, length_m, QUANTITY_LENGTH)},
    {"width", "overall across the nose, of plane, ellipsoid, box and wedge",
     QUANTITY(STRUCTURE, width_m, QUANTITY_LENGTH)},
    {"diameter", "overall, of sphere, cylinder, capsule, disc, cones (below) and torus",
     QUANTITY(STRUCTURE, diameter_m, QUANTITY_LENGTH)},
    {"height", "overall when level, of ellipsoid, box, wedge (at the tail), cones and torus",
     QUANTITY(STRUCTURE, height_m, QUANTITY_LENGTH)},
    {"top_diameter", "of a truncated cone", QUANTITY(STRUCTURE, top_diameter_m, QUANTITY_LENGTH)},
    {"front_height", "of a wedge at its nose, by default 0",
     QUANTITY(STRUCTURE, front_height_m, QUANTITY_LENGTH)},
    {"nose_end", "of a cylinder: flat, open, spherical or {depth: }",
     WORD(STRUCTURE, nose_end) = {[SONJECT_END_FLAT] = "flat",
                                  [SONJECT_END_OPEN] = "open",
                                  [SONJECT_END_SPHERICAL] = "spherical"},
     .section = &nose_end_section},
    {"tail_end", "of a cylinder: flat, open, spherical or {depth: }",
     WORD(STRUCTURE, tail_end) = {[SONJECT_END_FLAT] = "flat",
                                  [SONJECT_END_OPEN] = "open",
                                  [SONJECT_END_SPHERICAL] = "spherical"},
     .section = &tail_end_section},
    {"cuts", "planes that cut parts off, at most 2", .kind = FIELD_SPECIAL, .unit = "list",
     .section = &cut_section, .is_list = true, .read = read_cuts},
    {"position",
     "ground point under the centre: centre, {along_track: , slant_range: } or {row: , column: }",
     WORD(STRUCTURE, position_kind) = {[SONJECT_POSITION_PATCH_CENTRE] = "centre"},
     .section = &position_section},
    {"heading", "from along-track towards range", QUANTITY(STRUCTURE, heading_rad, QUANTITY_ANGLE)},
    {"pitch", "raises the nose", QUANTITY(STRUCTURE, pitch_rad, QUANTITY_ANGLE)},
    {"roll", "about the nose direction", QUANTITY(STRUCTURE, roll_rad, QUANTITY_ANGLE)},
    {"burial", "depth of the lowest point below the seabed, or {fraction: } or {proud: }",
     .kind = FIELD_NAMED, .offset = 0, .unit = "m, km, cm, mm", .section = &burial_section,
     .read = read_burial},
    {"material", "surface of the object: a material's name, or a section", .kind = FIELD_NAMED,
     .offset = offsetof(STRUCTURE, material), .section = &material_section,
     .read = read_material_name},
};
const struct section object_section = {object_fields, COUNT(object_fields), finish_object};

static sonject_status read_object(struct reader *reader, const struct tree_node *node)
{
    sonject_object_params object;
    sonject_object_params_init(&object);
    object.diameter_m = 0.0;
    sonject_status status = read_section(reader, &object_section, node, &object);
    if (status == SONJECT_OK)
        status = scene_append_object(reader->scene, reader->report, &object);
    return status;
}

sonject_status read_objects(struct reader *reader, const struct tree_node *node, void *structure)
{
    sonject_status status = SONJECT_OK;
    (void)structure;
    if (tree_is_null(node))
        return SONJECT_OK;
    if (node->kind != TREE_LIST)
        return refuse_value(reader, node, "must be a list; start each object with '- '");
    if (node->count > SCENE_OBJECTS_MAX)
        return refuse_value(reader, node, "has %zu entries; at most %d are possible", node->count,
                            SCENE_OBJECTS_MAX);
    for (size_t i = 0; status == SONJECT_OK && i < node->count; i++) {
        const size_t before = key_path_add_index(&reader->path, i);
        status = read_object(reader, &node->entries[i].value);
        key_path_shorten(&reader->path, before);
    }
    return status;
}

enum presence {
    ABSENT = 0,
    NEEDED,
    POSSIBLE
};

static const char *article_of(const char *name)
{
    return strchr("aeiou", *name) ? "an" : "a";
}

static sonject_status check_size_keys(struct reader *reader, const struct tree_node *node,
                                      uint32_t shape)
{
    static const struct {
        const char *key;
        unsigned char presence[SONJECT_SHAPE_TORUS + 1]; /* enum presence, by shape */
    } sizes[] = {
        {"length",
         {[SONJECT_SHAPE_PLANE] = NEEDED,
          [SONJECT_SHAPE_CYLINDER] = NEEDED,
          [SONJECT_SHAPE_CAPSULE] = NEEDED,
          [SONJECT_SHAPE_ELLIPSOID] = NEEDED,
          [SONJECT_SHAPE_BOX] = NEEDED,
          [SONJECT_SHAPE_WEDGE] = NEEDED}},
        {"width",
         {[SONJECT_SHAPE_PLANE] = NEEDED,
          [SONJECT_SHAPE_ELLIPSOID] = NEEDED,
          [SONJECT_SHAPE_BOX] = NEEDED,
          [SONJECT_SHAPE_WEDGE] = NEEDED}},
        {"diameter",
         {[SONJECT_SHAPE_SPHERE] = NEEDED,
          [SONJECT_SHAPE_CYLINDER] = NEEDED,
          [SONJECT_SHAPE_CAPSULE] = NEEDED,
          [SONJECT_SHAPE_DISC] = NEEDED,
          [SONJECT_SHAPE_CONE] = NEEDED,
          [SONJECT_SHAPE_TRUNCATED_CONE] = NEEDED,
          [SONJECT_SHAPE_TORUS] = NEEDED}},
        {"height",
         {[SONJECT_SHAPE_ELLIPSOID] = NEEDED,
          [SONJECT_SHAPE_BOX] = NEEDED,
          [SONJECT_SHAPE_WEDGE] = NEEDED,
          [SONJECT_SHAPE_CONE] = NEEDED,
          [SONJECT_SHAPE_TRUNCATED_CONE] = NEEDED,
          [SONJECT_SHAPE_TORUS] = NEEDED}},
        {"top_diameter", {[SONJECT_SHAPE_TRUNCATED_CONE] = NEEDED}},
        {"front_height", {[SONJECT_SHAPE_WEDGE] = POSSIBLE}},
        {"nose_end", {[SONJECT_SHAPE_CYLINDER] = POSSIBLE}},
        {"tail_end", {[SONJECT_SHAPE_CYLINDER] = POSSIBLE}},
    };
    const char *name = shape_name(shape);
    for (size_t i = 0; i < COUNT(sizes); i++) {
        const unsigned char presence = sizes[i].presence[shape];
        if (presence == NEEDED && !is_given(node, sizes[i].key))
            return refuse_key(reader, node, sizes[i].key, "missing; %s %s needs it",
                              article_of(name), name);
        if (presence == ABSENT && is_given(node, sizes[i].key))
            return refuse_key(reader, node, sizes[i].key, "%s %s has none; remove it",
                              article_of(name), name);
    }
    return SONJECT_OK;
}

sonject_status finish_object(struct reader *reader, const struct tree_node *node, void *structure)
{
    const sonject_object_params *object = structure;
    struct report report = {{0}, NULL, NULL};
    const char *key = "";
    const sonject_status status = check_size_keys(reader, node, object->shape);
    if (status != SONJECT_OK)
        return status;
    if (check_object(object, &report, &key) != SONJECT_OK)
        return place_check(reader, node, key, &report);
    return SONJECT_OK;
}
