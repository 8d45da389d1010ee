#include "schema/scene_user.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "schema/scene_fields.h"
#include "schema/scene_shape.h"

/* A shape on its way into the scene. */
struct user_text {
    sonject_user_shape_params shape;
    char *name, *code; /* owned */
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
    static const struct list parameters = {SONJECT_USER_PARAMETERS_CAPACITY,
                                           " of numbers, [1, 0.5]", read_parameter};
    return read_list(reader, node, &parameters, structure);
}

static sonject_status finish_user(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    const struct user_text *user = structure;
    check_user_shape(&user->shape, NULL, listen_at(reader, node));
    return check_one_given(reader, node, "file code", "file and code");
}

#define STRUCTURE struct user_text
static const struct field user_fields[] = {
    {"file", "OpenCL C with the functions shape_distance and shape_normal", .kind = FIELD_SPECIAL,
     .unit = "file name", .read = read_code_file},
    {"code", "the same, here: code: |", .kind = FIELD_SPECIAL, .unit = "text", .read = read_code},
    {"bounding_radius", "of a sphere about the origin that holds the shape",
     QUANTITY(STRUCTURE, shape.bounding_radius_m, QUANTITY_LENGTH), REQUIRED},
    {"half_length",
     "of a box that holds it, by which it rests on the seabed; by default the radius",
     QUANTITY(STRUCTURE, shape.half_length_m, QUANTITY_LENGTH)},
    {"half_width", "of that box; by default the radius",
     QUANTITY(STRUCTURE, shape.half_width_m, QUANTITY_LENGTH)},
    {"half_height", "of that box; by default the radius",
     QUANTITY(STRUCTURE, shape.half_height_m, QUANTITY_LENGTH)},
    {"open", "a surface without inside, which reflects on both sides", .kind = FIELD_FLAG32,
     .offset = offsetof(STRUCTURE, shape.is_open)},
    {"parameters", "numbers for the functions, at most 16", .kind = FIELD_SPECIAL,
     .unit = "list of numbers", .read = read_parameters},
};
#undef STRUCTURE
const struct section user_section = {user_fields, COUNT(user_fields), finish_user};

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
    sonject_user_shape_params_init(&user.shape);
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
