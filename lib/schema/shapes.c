/* The keys of shapes that files describe: meshes of triangles, and code of users. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "schema/keys.h"

/* ---- Meshes: the file, and how its numbers are meant. */

/* Lengths of targets. */
#define LEAST_M 0.01
#define MOST_M  100.0

#define PARAMETER_MOST 1e30 /* of numbers for users' code */

/* What is said about a mesh. */
struct mesh_text {
    char *path;        /* owned; NULL: not given */
    double unit_m;     /* m a unit of the file; 0: not given */
    uint32_t nose, up; /* enum file_axis: which axis of the file that one of the object is */
    bool allows_open;
    double smooth_angle_rad;
};

enum file_axis {
    AXIS_X,
    AXIS_Y,
    AXIS_Z,
    AXIS_X_REVERSED,
    AXIS_Y_REVERSED,
    AXIS_Z_REVERSED
};

static sonject_status read_unit(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    return read_length_unit(reader, node, &((struct mesh_text *)structure)->unit_m);
}

/* 1, 2, 3, negative where reversed, as struct mesh_options has it. */
static int signed_axis(uint32_t axis)
{
    return axis < AXIS_X_REVERSED ? (int)axis + 1 : -(int)(axis - AXIS_X_REVERSED) - 1;
}

/* Nose and up tell the third axis, own y = up x nose. False where both lie along one line. */
static bool turn_file_axes(const struct mesh_text *mesh, int axes[3])
{
    const int nose = signed_axis(mesh->nose);
    const int up = signed_axis(mesh->up);
    const int from = abs(up);
    const int to = abs(nose);
    if (from == to)
        return false;
    const bool is_cyclic = to == from % 3 + 1;
    const bool is_reversed = is_cyclic == ((nose < 0) != (up < 0));
    axes[0] = nose;
    axes[1] = is_reversed ? -(6 - from - to) : 6 - from - to;
    axes[2] = up;
    return true;
}

static sonject_status finish_mesh(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    const struct mesh_text *mesh = structure;
    int axes[3];
    if (!turn_file_axes(mesh, axes))
        return refuse_value(reader, node,
                            "nose and up are the same axis of the file; give both, such as "
                            "nose: x, up: y");
    return SONJECT_OK;
}

#define STRUCTURE struct mesh_text
#define AXIS_WORDS                                                                                 \
    {                                                                                              \
        [AXIS_X] = "x", [AXIS_Y] = "y", [AXIS_Z] = "z", [AXIS_X_REVERSED] = "-x",                  \
        [AXIS_Y_REVERSED] = "-y", [AXIS_Z_REVERSED] = "-z"                                         \
    }
static const struct field mesh_fields[] = {
    {"file", "of triangles: STL, OBJ or PLY", .kind = FIELD_FILE, MEMBER(path), REQUIRED},
    {"unit", "of the file's numbers, by default m", SPECIAL(read_unit, "m, km, cm, mm")},
    {"nose", "axis of the file that is the object's nose", WORD(nose) = AXIS_WORDS},
    {"up", "axis of the file that is up when level", WORD(up) = AXIS_WORDS, .preset = AXIS_Z},
    {"open", "a mesh that is not watertight is taken as thin sheets; by default it is refused",
     FLAG(allows_open)},
    {"smooth",
     "facets that meet at less stand for one smooth surface to what scatters; by default none do",
     QUANTITY(smooth_angle_rad, ANGLE), WITHIN(0.0, PI)},
};
const struct section mesh_section = {ROWS(mesh_fields), .finish = finish_mesh};
#undef STRUCTURE

/* A file in mm whose unit nobody gave makes a target that no sonar sees. */
static sonject_status doubt_size(struct reader *reader, const struct tree_node *node,
                                 uint32_t number)
{
    const struct mesh *mesh = &reader->scene->meshes[number];
    double longest = 0.0;
    for (int axis = 0; axis < 3; axis++)
        longest = fmax(longest, (double)mesh->upper_m[axis] - (double)mesh->lower_m[axis]);
    if (longest >= LEAST_M && longest <= MOST_M)
        return SONJECT_OK;
    return refuse_value(reader, node,
                        "the mesh is %.3g m long if its numbers are metres, and sonars are for "
                        "targets of 1 cm to 100 m: give its unit, such as unit: mm, or unit: m if "
                        "that is right",
                        longest);
}

/* Into the scene; the message about a mesh that cannot be read gets its place in the scene file. */
static sonject_status load(struct reader *reader, const struct tree_node *node,
                           const struct mesh_text *mesh, uint32_t *number)
{
    struct report report = {{0}, NULL, NULL};
    struct mesh_options options;
    mesh_options_init(&options);
    options.unit_m = mesh->unit_m > 0.0 ? mesh->unit_m : 1.0;
    options.smooth_angle_rad = mesh->smooth_angle_rad;
    turn_file_axes(mesh, options.axes);
    const sonject_status status =
        scene_share_mesh(reader->scene, &report, mesh->path, &options, mesh->allows_open, number);
    if (status == SONJECT_OK)
        return mesh->unit_m > 0.0 ? status : doubt_size(reader, node, *number);
    if (status == SONJECT_ERROR_MEMORY)
        return report_out_of_memory(reader->report, mesh->path);
    /* What is wrong in a file is one mistake, however many objects show it. */
    if (is_sound_in_file(reader, mesh->path))
        refuse_value(reader, node, "%s", report.message);
    mistakes_add(reader->tree->mistakes, reader->tree, &node->place, mesh->path, NULL);
    return status;
}

sonject_status read_mesh(struct reader *reader, const struct tree_node *node, void *structure)
{
    sonject_object_params *shape = structure;
    struct mesh_text mesh = {.path = NULL};
    const struct tree_entry *file = tree_find(node, "file");
    const size_t before = reader->path.length;
    section_defaults(&mesh_section, &mesh, NULL);
    sonject_status status = node->kind == TREE_TEXT
                                ? read_existing_path(reader, node, &mesh.path)
                                : read_section(reader, &mesh_section, node, &mesh);
    if (file)
        key_path_add(&reader->path, "file");
    THEN(status, load(reader, file ? &file->value : node, &mesh, &shape->mesh));
    key_path_shorten(&reader->path, before);
    free(mesh.path);
    return status;
}

/* ---- Code. */

/* A shape on its way into the scene. */
struct user_text {
    sonject_user_shape_params shape; /* first */
    char *name, *code;               /* owned */
};

static sonject_status read_code_file(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    char excerpt[400];
    struct user_text *user = structure;
    size_t bytes;
    sonject_status status = read_existing_path(reader, node, &user->name);
    if (status != SONJECT_OK)
        return status;
    status = file_read_whole(reader->report, user->name, SNIPPET_BYTES_MAX, &user->code, &bytes);
    if (status == SONJECT_OK && strlen(user->code) != bytes)
        status = refuse_value(reader, node, "%s contains a character 0; remove it",
                              text_excerpt(excerpt, sizeof excerpt, user->name));
    return status;
}

/* The compiler counts lines as the file does, where a block shows them as they are. */
static sonject_status read_code(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    struct user_text *user = structure;
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    user->code = copy_text(text);
    user->name = copy_text(node->place.override ? "code" : reader->tree->file);
    user->shape.first_line =
        node->place.override ? 1 : (uint32_t)(node->place.line + (node->is_block ? 1 : 0));
    return user->code && user->name ? SONJECT_OK
                                    : report_out_of_memory(reader->report, "a shape's code");
}

static sonject_status read_parameter(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    struct user_text *user = structure;
    return read_quantity(reader, node, QUANTITY_NUMBER,
                         &user->shape.parameters[user->shape.parameter_count++]);
}

static sonject_status read_parameters(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    static const struct list parameters = {0, SONJECT_USER_PARAMETERS_CAPACITY,
                                           " of numbers, [1, 0.5]", read_parameter};
    return read_list(reader, node, &parameters, structure);
}

static void relate_user_shape(struct check *check, const void *structure)
{
    const sonject_user_shape_params *shape = structure;
    for (uint32_t i = 0; check->status == SONJECT_OK && i < shape->parameter_count; i++)
        check_within(check, "parameters", shape->parameters[i], -PARAMETER_MOST, PARAMETER_MOST,
                     "");
}

/* Of a sonject_user_shape_params, with which a struct user_text begins. */
#define STRUCTURE sonject_user_shape_params
static const struct field user_fields[] = {
    {"file", "OpenCL C with the functions shape_distance and shape_normal",
     SPECIAL(read_code_file, "file name")},
    {"code", "the same, here: code: |", SPECIAL(read_code, "text")},
    {"bounding_radius", "of a sphere about the origin that holds the shape",
     QUANTITY(bounding_radius_m, LENGTH), POSITIVE, REQUIRED},
    {"half_length",
     "of a box that holds it, by which it rests on the seabed; by default the radius",
     QUANTITY(half_length_m, LENGTH), FROM_ZERO, NONE_IF_ZERO},
    {"half_width", "of that box; by default the radius", QUANTITY(half_width_m, LENGTH), FROM_ZERO,
     NONE_IF_ZERO},
    {"half_height", "of that box; by default the radius", QUANTITY(half_height_m, LENGTH),
     FROM_ZERO, NONE_IF_ZERO},
    {"open", "a surface without inside, which reflects on both sides", FLAG(is_open)},
    {"parameters", "numbers for the functions, at most 16",
     SPECIAL(read_parameters, "list of numbers")},
};
const struct section user_section = {ROWS(user_fields), .choice = "file code",
                                     .relations = relate_user_shape, .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

/* The end of a name that is too long for messages. */
static const char *short_name(const char *name)
{
    const size_t length = strlen(name);
    const char *end = length > SNIPPET_NAME_MAX ? name + length - SNIPPET_NAME_MAX : name;
    while (((unsigned char)*end & 0xc0u) == 0x80u)
        end++;
    return end;
}

sonject_status read_user_shape(struct reader *reader, const struct tree_node *node, void *structure)
{
    sonject_object_params *object = structure;
    struct user_text user;
    memset(&user, 0, sizeof user);
    if (!reader->allows_user_shapes)
        return refuse_value(reader, node,
                            "is code that would run with your rights; if you trust who wrote it, "
                            "use --allow-user-shapes");
    sonject_status status = read_section(reader, &user_section, node, &user);
    if (status == SONJECT_OK && user.code) {
        user.shape.name = short_name(user.name);
        user.shape.code = user.code;
        status = user_shapes_append(&reader->scene->user_shapes, reader->report, &user.shape);
        object->user_shape = reader->scene->user_shapes.count - 1;
    }
    free(user.name);
    free(user.code);
    return status;
}
