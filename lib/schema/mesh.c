/* The keys of meshes: the file, and the meaning of its numbers. */
#include <math.h>
#include <stdlib.h>

#include "base/file.h"
#include "schema/keys.h"

/* The range of target lengths that a mesh without a unit may have. */
#define LEAST_M 0.01
#define MOST_M  100.0

/* The values of a mesh's keys. */
struct mesh_text {
    char *path;        /* owned; NULL: not given */
    double unit_m;     /* length of one unit of the file, m; 0: not given */
    uint32_t nose, up; /* enum file_axis: axes of the file that become the object's nose and up */
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

/* Returns 1, 2 or 3, negative where reversed, as in struct mesh_options. */
static int signed_axis(uint32_t axis)
{
    return axis < AXIS_X_REVERSED ? (int)axis + 1 : -(int)(axis - AXIS_X_REVERSED) - 1;
}

/* Finds own y = up x nose from nose and up. Returns false where both lie along one line. */
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
    {"file", "mesh file of triangles: STL, OBJ or PLY", .kind = FIELD_FILE, MEMBER(path), REQUIRED},
    {"unit", "length of one unit of the mesh file's numbers, such as cm or 2.54 cm; by default m",
     LENGTH_UNIT(unit_m)},
    {"nose", "axis of the mesh file that points along the object's nose", WORD(nose) = AXIS_WORDS},
    {"up", "axis of the mesh file that points up when level", WORD(up) = AXIS_WORDS,
     .preset = AXIS_Z},
    {"open", "true takes a mesh that is not watertight as thin sheets; by default it is refused",
     FLAG(allows_open)},
    {"smooth",
     "facets that meet at a smaller angle scatter as one smooth surface; by default none do",
     QUANTITY(smooth_angle_rad, ANGLE), WITHIN(0.0, PI)},
};
const struct section mesh_section = {ROWS(mesh_fields), .finish = finish_mesh};
#undef STRUCTURE

/* Refuses a mesh without a unit whose size no sonar is for, such as a file in mm. */
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

/* Loads a mesh into the scene. Messages about the file get its place in the scene file. */
static sonject_status load(struct reader *reader, const struct tree_node *node,
                           const struct mesh_text *mesh, uint32_t *number)
{
    struct report report = {.host = NULL};
    struct mesh_options options;
    mesh_options_init(&options);
    options.unit_m = mesh->unit_m > 0.0 ? mesh->unit_m : 1.0;
    options.smooth_angle_rad = mesh->smooth_angle_rad;
    turn_file_axes(mesh, options.axes);
    CHECK(file_note_read(reader->report, mesh->path));
    const sonject_status status =
        scene_share_mesh(reader->scene, &report, mesh->path, &options, mesh->allows_open, number);
    if (status == SONJECT_OK)
        return mesh->unit_m > 0.0 ? status : doubt_size(reader, node, *number);
    if (status == SONJECT_ERROR_MEMORY)
        return report_out_of_memory(reader->report, mesh->path);
    /* A mistake in a file is reported once, however many objects show the mesh. */
    if (is_valid_in_file(reader, mesh->path))
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
