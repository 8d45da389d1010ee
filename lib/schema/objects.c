/* The keys of objects: a shape with sizes, ends and surface, parts, or a target's file; a place. */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "scene/placement.h"
#include "scene/shapes/shape.h"
#include "schema/keys.h"

#define LEVELS_MAX 8 /* levels of lists of parts within lists */

/* ---- The keys of a shape, the same in an object, in a part and in a target's file. Each of their
 * structures begins with a sonject_object_params. */

#define STRUCTURE sonject_object_params

/* The section {depth: } of a spherical end. */
#define END_SECTION(name, end)                                                                     \
    static const struct field name##_fields[] = {                                                  \
        {"depth", "depth of the spherical end, at most half the diameter",                         \
         QUANTITY(end##_depth_m, LENGTH), WITHIN(0.0, HUGE_VAL), .bounds = ABOVE_LEAST,            \
         .range = "above 0 (write 'spherical' for a half sphere, 'flat' for none)",                \
         SETS(end, SONJECT_END_SPHERICAL), REQUIRED},                                              \
    };                                                                                             \
    static const struct section name##_section = {ROWS(name##_fields)};
END_SECTION(nose_end, nose_end)
END_SECTION(tail_end, tail_end)

#define END_FIELD(end)                                                                             \
    WORD(end) = {[SONJECT_END_FLAT] = "flat",                                                      \
                 [SONJECT_END_OPEN] = "open",                                                      \
                 [SONJECT_END_SPHERICAL] = "spherical"},                                           \
    .section = &end##_section

#define SIZE(its) QUANTITY(its, LENGTH), POSITIVE

#define SHAPE_WORD(NUMBER, name, traits) [SHAPE_##NUMBER] = #name,
#define SHAPE_FIELDS                                                                               \
    {"shape", "shape of the object or part; objects measure at least half a wavelength",           \
     WORD(shape) = {ALL_SHAPES(SHAPE_WORD)[SHAPE_PARTS] = ""}, .preset = SHAPE_SPHERE},            \
        {"length", "overall length along the nose", SIZE(length_m)},                               \
        {"width", "overall width across the nose", SIZE(width_m)},                                 \
        {"diameter", "overall diameter; for cones, at the bottom", SIZE(diameter_m)},              \
        {"height", "overall height when level; for a wedge, at the tail", SIZE(height_m)},         \
        {"top_diameter", "top of a truncated cone; 0: a cone", QUANTITY(top_diameter_m, LENGTH),   \
         FROM_ZERO},                                                                               \
        {"front_height", "height of a wedge at its nose, at most the height at the tail",          \
         QUANTITY(front_height_m, LENGTH)},                                                        \
        {"nose_end", "cylinder's nose: flat, open, spherical or {depth: }", END_FIELD(nose_end)},  \
        {"tail_end", "cylinder's tail: flat, open, spherical or {depth: }", END_FIELD(tail_end)},  \
    {                                                                                              \
        "mesh", "mesh for the shape mesh: its file's name, or a section",                          \
            .kind = FIELD_SPECIAL, .unit = "file name", .section = &mesh_section,                  \
            .read = read_mesh                                                                      \
    }

/* The angles. Objects and parts count heading from different axes. */
#define TURN_FIELDS(heading_meaning)                                                               \
    {"heading", heading_meaning, QUANTITY(heading_rad, ANGLE)},                                    \
        {"pitch", "pitch angle, which raises the nose", QUANTITY(pitch_rad, ANGLE)},               \
    {                                                                                              \
        "roll", "roll angle about the nose direction", QUANTITY(roll_rad, ANGLE)                   \
    }

#define SURFACE_FIELD(meant)                                                                       \
    {                                                                                              \
        "material", meant, .kind = FIELD_NAMED, MEMBER(material), .section = &material_section,    \
                           .read = read_material_name                                              \
    }

#define STRUCTURE sonject_object_params
static const struct field fouling_fields[] = {
    {"albedo", "rms of the energy that the rough part scatters, about the material's mean",
     QUANTITY(fouling.albedo_db, DECIBEL), WITHIN(0.0, 10.0)},
    {"albedo_length", "correlation length of the albedo: autocorrelation exp(-(r / length)^2 / 2)",
     QUANTITY(fouling.albedo_length_m, LENGTH), WITHIN(1e-3, LENGTH_MAX_M), .preset = 0.15},
    {"relief", "rms relief height; tilts what scatters, and weakens smooth parts as roughness does",
     QUANTITY(fouling.relief_m, LENGTH), WITHIN(0.0, 1.0)},
    {"relief_length", "correlation length of the relief (as albedo_length); at least twice relief",
     QUANTITY(fouling.relief_length_m, LENGTH), WITHIN(1e-3, LENGTH_MAX_M), .preset = 0.05},
};
static void relate_fouling(struct check *check, const void *structure)
{
    const sonject_fouling_params *fouling = &((const sonject_object_params *)structure)->fouling;
    if (fouling->relief_m > 0.5 * fouling->relief_length_m)
        check_relation(check, "relief", "relief_length",
                       "must be at most half of relief_length, %g m, but is %g m",
                       fouling->relief_length_m, fouling->relief_m);
}
static const struct section fouling_section = {ROWS(fouling_fields), .relations = relate_fouling};

#define FOULING_FIELD                                                                              \
    {                                                                                              \
        "fouling", "growth on the object: random albedo and relief, in its own coordinates",       \
            SAME(fouling_section)                                                                  \
    }

static const struct field shape_fields[] = {SHAPE_FIELDS};

void object_init(sonject_object_params *object)
{
    section_defaults(&object_section, object, NULL);
}

/* Returns the article by the first letter. No shape's name begins with a u as in "under". */
static const char *article_of(const char *name)
{
    return strchr("aeio", *name) ? "an" : "a";
}

/* Refuses every key of a shape in the section. reason: why there can be none. */
static void refuse_shape_keys(struct reader *reader, const struct tree_node *node,
                              const char *reason)
{
    for (size_t i = 0; i < COUNT(shape_fields); i++)
        if (is_given(node, shape_fields[i].key))
            refuse_key(reader, node, shape_fields[i].key, "%s; remove it", reason);
}

/* Checks that the section has the sizes of its shape and no others; with parts, no sizes at all. */
static void check_shape_keys(struct reader *reader, const struct tree_node *node, uint32_t shape)
{
    const struct shape *row = shape_of(shape);
    const char *name = shape_name(shape);
    if (shape == SHAPE_PARTS) {
        refuse_shape_keys(reader, node, "the parts have shapes of their own");
        return;
    }
    for (const struct shape_key_name *its = shape_keys; its->key; its++) {
        if ((row->needs & its->bit) && !is_given(node, its->key))
            refuse_relation(reader, node, its->key, "shape", "missing; %s %s needs it",
                            article_of(name), name);
        if (!((row->needs | row->may_have) & its->bit) && is_given(node, its->key))
            refuse_relation(reader, node, its->key, "shape", "%s %s has none; remove it",
                            article_of(name), name);
    }
}

/* Checks the values that the section itself gives. Sizes are not checked where the shape is
 * unknown, nor values of another section or file, which are checked there. */
static sonject_status finish_shape(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    sonject_object_params checked = *(const sonject_object_params *)structure;
    struct check check = check_at(reader, node);
    const bool is_one = count_given(node, "shape parts target") == 1;
    if (is_one && !is_given(node, "target"))
        check_shape_keys(reader, node, checked.shape);
    if (!is_one || !are_valid(reader, "shape target"))
        checked.shape = SHAPE_PARTS;
    if (!is_given(node, "material"))
        section_defaults(&material_section, &checked.material, NULL);
    check_shape(&check, &checked);
    relate_energy(&check, "material.", &checked.material, NAN);
    return check.status;
}

/* ---- Parts: a list of shapes with their places, or of groups of shapes. */

/* The frame that parts of a list are placed in, in the object's own frame. */
struct frame {
    double axes[3][3]; /* rows: nose, own y, own z */
    double origin[3];  /* m */
};

/* The place of a part's centre in its object or group, m: along the nose, own y and own z. */
struct part_place {
    double along_m, across_m, up_m;
};

/* A part, or a group of parts, while it is read. */
struct part_text {
    sonject_object_params shape; /* first: filled by tables of shapes; angles are the part's */
    struct part_place place;
    const struct frame *outer;
    int level; /* level of the list that holds the part, from 1 */
    bool is_group;
};

/* A list of parts, with frame, material and level from the object or group around it. */
struct part_list {
    const struct frame *frame;
    const sonject_material_params *material;
    int level;
};

static struct frame frame_of(const struct part_text *part)
{
    struct frame frame;
    double turned[3][3];
    const double at[3] = {part->place.along_m, part->place.across_m, part->place.up_m};
    turn_axes(turned, part->shape.heading_rad, part->shape.pitch_rad, part->shape.roll_rad);
    compose_axes(frame.axes, turned, (double(*)[3])part->outer->axes);
    memcpy(frame.origin, part->outer->origin, sizeof frame.origin);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            frame.origin[k] += at[i] * part->outer->axes[i][k];
    return frame;
}

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

static sonject_status read_part(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    const struct part_list *list = structure;
    struct part_text part;
    memset(&part, 0, sizeof part);
    object_init(&part.shape);
    part.shape.material = *list->material;
    part.outer = list->frame;
    part.level = list->level;
    const sonject_status status = read_section(reader, &part_section, node, &part);
    return status != SONJECT_OK || part.is_group ? status : append_part(reader, node, &part);
}

static sonject_status read_part_list(struct reader *reader, const struct tree_node *node,
                                     struct part_list list)
{
    static const struct list parts = {0, SIZE_MAX, "; start each part with '- '", read_part};
    if (list.level > LEVELS_MAX)
        return refuse_value(reader, node, "nested too deeply; parts may be %d levels deep",
                            LEVELS_MAX);
    if (node->kind == TREE_LIST && node->count == 0)
        return refuse_value(reader, node, "is empty; give at least one part");
    return read_list(reader, node, &parts, &list);
}

/* Appends a list of parts to the scene. They belong to the object that will be the scene's next.
 * material: for parts that name none. */
static sonject_status read_parts(struct reader *reader, const struct tree_node *node,
                                 const sonject_material_params *material)
{
    static const struct frame own = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}},
                                     {0.0, 0.0, 0.0}};
    return read_part_list(reader, node, (struct part_list){&own, material, 1});
}

static sonject_status read_group(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    struct part_text *part = structure;
    const struct frame frame = frame_of(part);
    part->is_group = true;
    part->shape.shape = SHAPE_PARTS;
    return read_part_list(reader, node,
                          (struct part_list){&frame, &part->shape.material, part->level + 1});
}
#undef STRUCTURE

#define STRUCTURE struct part_place
static const struct field part_place_fields[] = {
    {"along", "place along the nose of the object or group", QUANTITY(along_m, LENGTH), COORDINATE},
    {"across", "place to the left of the nose of the object or group, seen from above",
     QUANTITY(across_m, LENGTH), COORDINATE},
    {"up", "place along the z axis of the object or group, which points up when level",
     QUANTITY(up_m, LENGTH), COORDINATE},
};
static const struct section part_place_section = {ROWS(part_place_fields)};
#undef STRUCTURE

/* Keys are read in this order, because parts in a group need the group's pose and surface. */
#define STRUCTURE sonject_object_params
static const struct field part_fields[] = {
    {"name", "name of this part or group", LABEL(name)},
    SHAPE_FIELDS,
    {"at", "place of the part's centre in the object or group; by default the origin",
     .kind = FIELD_SECTION, .section = &part_place_section,
     .offset = offsetof(struct part_text, place)},
    TURN_FIELDS(
        "heading of the nose, from the object's or group's nose to the left, seen from above"),
    SURFACE_FIELD("surface of the part; by default that of the object or group"),
    {"parts", "parts of a group, placed and turned as one, instead of one shape",
     SPECIAL(read_group, "list")},
};
const struct section part_section = {ROWS(part_fields), .choice = "shape parts",
                                     .finish = finish_shape};

/* ---- Targets: files that describe one target each. */

/* A target while it is read from its file. */
struct target_text {
    sonject_object_params object;  /* first member: tables of shapes fill it */
    char *file;                    /* owned; NULL: there is no file */
    struct tree tree;              /* tree of the file */
    const struct tree_node *parts; /* node of the tree; NULL: the target has a shape */
};

static void target_text_clear(struct target_text *target)
{
    if (target->file)
        tree_clear(&target->tree);
    free(target->file);
}

/* Notes the parts for read_target_parts, because the object may change their surface. */
static sonject_status note_parts(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    struct target_text *target = structure;
    (void)reader;
    target->object.shape = SHAPE_PARTS;
    target->parts = node;
    return SONJECT_OK;
}

/* The keys of targets. There is none for another target's file. */
static const struct field target_fields[] = {
    {"sonject_target", "version of the format, 1", SPECIAL(read_version, "whole number"), REQUIRED},
    {"name", "name of the target", LABEL(name)},
    {"class", "class label for training", LABEL(class_name)},
    SHAPE_FIELDS,
    SURFACE_FIELD("surface of the target: a material's name, or a section"),
    FOULING_FIELD,
    {"parts", "parts, instead of one shape: the target is their union",
     SPECIAL(note_parts, "list")},
};
static const struct section target_section = {ROWS(target_fields), .choice = "shape parts",
                                              .finish = finish_shape};

static struct reader reader_of_target(const struct reader *reader, const struct target_text *target)
{
    return (struct reader){.report = reader->report, .tree = &target->tree, .scene = reader->scene};
}

/* Reads the file that the target names, except its parts. */
static sonject_status read_target_file(struct reader *reader, struct tree_place named_at,
                                       struct target_text *target)
{
    char *text = NULL;
    size_t bytes;
    CHECK(file_read_whole(reader->report, target->file, TREE_BYTES_MAX, &text, &bytes));
    tree_init(&target->tree, reader->report, target->file);
    target->tree.mistakes = reader->tree->mistakes;
    target->tree.named_at = named_at;
    sonject_status status = tree_parse(&target->tree, text, bytes);
    free(text);
    struct reader inner = reader_of_target(reader, target);
    if (status == SONJECT_OK && tree_is_null(&target->tree.root))
        status = refuse_value(&inner, &target->tree.root,
                              "there is nothing in it; start with 'sonject_target: 1'");
    THEN(status, read_section(&inner, &target_section, &target->tree.root, target));
    return status;
}

/* Appends the target's parts, if any, to the scene. status: of the reading so far. */
static sonject_status read_target_parts(struct reader *reader, const struct target_text *target,
                                        sonject_status status)
{
    if (!target->parts || reading_ends(status))
        return status;
    struct reader inner = reader_of_target(reader, target);
    key_path_add(&inner.path, "parts");
    const sonject_status of_parts = read_parts(&inner, target->parts, &target->object.material);
    return of_parts == SONJECT_OK ? status : of_parts;
}

/* ---- Objects. */

static const struct field position_fields[] = {PLACE_FIELDS("slant range in the image", -1.0)};
static const struct section position_section = {ROWS(position_fields),
                                                .choice = "along_track+slant_range row+column"};

static const struct field burial_fields[] = {
    {"fraction", "buried fraction of the height that the object has in its pose, 0 to 1",
     QUANTITY(burial_fraction, NUMBER), WITHIN(0.0, 1.0),
     SETS(burial_kind, SONJECT_BURIAL_FRACTION)},
    {"proud", "height of the object's highest point above the seabed",
     QUANTITY(proud_height_m, LENGTH), FROM_ZERO, SETS(burial_kind, SONJECT_BURIAL_PROUD)},
};
static const struct section burial_section = {ROWS(burial_fields), .choice = "fraction proud"};

static const struct field level_fields[] = {
    {"target_strength",
     "target strength of the peak by one interaction, between pixels too, speckle averaged out, re "
     "1 m^2",
     QUANTITY(level_db, DECIBEL), WITHIN(-200.0, 200.0),
     SETS(level_kind, SONJECT_LEVEL_TARGET_STRENGTH)},
    {"over_seabed",
     "echo's peak level over the local mean seabed; by one interaction, as target_strength",
     QUANTITY(level_db, DECIBEL), WITHIN(-200.0, 200.0),
     SETS(level_kind, SONJECT_LEVEL_OVER_SEABED)},
};
static const struct section level_section = {ROWS(level_fields),
                                             .choice = "target_strength over_seabed"};

/* Fills the object from its target's file. The object's own keys then change it. */
static sonject_status read_object_target(struct reader *reader, const struct tree_node *node,
                                         void *structure)
{
    struct target_text *target = structure;
    CHECK(read_existing_path(reader, node, &target->file));
    const sonject_status status = read_target_file(reader, node->place, target);
    if (target->tree.file && mistakes_concern(reader->tree->mistakes, &target->tree, ""))
        mark_wrong(reader, node, ""); /* the file's mistakes are reported already */
    return status;
}

static sonject_status read_object_parts(struct reader *reader, const struct tree_node *node,
                                        void *structure)
{
    sonject_object_params *object = structure;
    object->shape = SHAPE_PARTS;
    return read_parts(reader, node, &object->material);
}

static sonject_status finish_object(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    if (is_given(node, "target") && count_given(node, "shape parts") == 0)
        refuse_shape_keys(reader, node, "the target's file has the shape");
    return finish_shape(reader, node, structure);
}

/* Keys are read in this order, not the file's. A target's file comes first, so that all other keys
 * change it. Parts come last, when their surface is known. */
static const struct field object_fields[] = {
    {"target", "target file that describes the object, instead of shape or parts",
     SPECIAL(read_object_target, "file name")},
    {"name", "name of this object", LABEL(name)},
    {"class", "class label for training; by default the shape", LABEL(class_name)},
    SHAPE_FIELDS,
    {"mesh", "number in the scene", HIDDEN, COUNT32(mesh, 0, 0)},
    {"position",
     "ground point under the object's centre, or the origin of its parts: centre (of the patch), "
     "{along_track: , slant_range: } or {row: , column: }",
     CENTRE_WORD, .section = &position_section},
    TURN_FIELDS("heading of the nose, from along-track towards range"),
    {"burial", "kind", HIDDEN, WORD(burial_kind) = {"depth", "fraction", "proud"}},
    {"burial", "depth of the object's lowest point below the seabed, or {fraction: } or {proud: }",
     QUANTITY(burial_m, LENGTH), COORDINATE, .section = &burial_section},
    {"level",
     "level of the echo: physical (from shape, material, seabed.lambert), or scaled to "
     "{target_strength: } or {over_seabed: }",
     WORD(level_kind) = {[SONJECT_LEVEL_PHYSICAL] = "physical",
                         [SONJECT_LEVEL_TARGET_STRENGTH] = "",
                         [SONJECT_LEVEL_OVER_SEABED] = ""},
     .section = &level_section},
    SURFACE_FIELD("surface of the object: a material's name, or a section"),
    FOULING_FIELD,
    {"parts", "parts, instead of one shape: the object is their union", .kind = FIELD_SPECIAL,
     .unit = "list", .section = &part_section, .is_list = true, .read = read_object_parts},
};
const struct section object_section = {ROWS(object_fields), .choice = "shape parts target",
                                       .finish = finish_object, .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

static sonject_status read_object(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    struct target_text text;
    (void)structure;
    memset(&text, 0, sizeof text);
    object_init(&text.object);
    sonject_status status = read_section(reader, &object_section, node, &text);
    status = read_target_parts(reader, &text, status);
    THEN(status, scene_append_object(reader->scene, reader->report, &text.object));
    target_text_clear(&text);
    return status;
}

sonject_status read_objects(struct reader *reader, const struct tree_node *node, void *structure)
{
    static const struct list objects = {0, SCENE_OBJECTS_MAX, "; start each object with '- '",
                                        read_object};
    return tree_is_null(node) ? SONJECT_OK : read_list(reader, node, &objects, structure);
}
