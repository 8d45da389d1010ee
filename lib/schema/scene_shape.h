/* The keys that a shape has wherever one is described: in an object, in a part of one, in the file
 * of a target. Each of their structures begins with a sonject_object_params, which these keys fill.
 */
#ifndef SONJECT_SCHEMA_SCENE_SHAPE_H
#define SONJECT_SCHEMA_SCENE_SHAPE_H

#include "schema/scene_fields.h"
#include "schema/scene_user.h"

extern const struct section nose_end_section;
extern const struct section tail_end_section;
extern const struct section mesh_section;
extern const struct section cut_section;

/* Reads the mesh into the scene, which keeps one however many shapes show it; in scene_mesh.c. */
sonject_status read_mesh(struct reader *reader, const struct tree_node *node, void *structure);

/* A shape, its sizes, ends and cuts. */
#define SHAPE_FIELDS                                                                               \
    {"shape", "of the object or part; objects are at least half a wavelength large",               \
     WORD(sonject_object_params, shape) = {[SONJECT_SHAPE_PLANE] = "plane",                        \
                                           [SONJECT_SHAPE_SPHERE] = "sphere",                      \
                                           [SONJECT_SHAPE_CYLINDER] = "cylinder",                  \
                                           [SONJECT_SHAPE_CAPSULE] = "capsule",                    \
                                           [SONJECT_SHAPE_DISC] = "disc",                          \
                                           [SONJECT_SHAPE_ELLIPSOID] = "ellipsoid",                \
                                           [SONJECT_SHAPE_BOX] = "box",                            \
                                           [SONJECT_SHAPE_WEDGE] = "wedge",                        \
                                           [SONJECT_SHAPE_CONE] = "cone",                          \
                                           [SONJECT_SHAPE_TRUNCATED_CONE] = "truncated_cone",      \
                                           [SONJECT_SHAPE_TORUS] = "torus",                        \
                                           [SONJECT_SHAPE_PARTS] = "",                             \
                                           [SONJECT_SHAPE_MESH] = "mesh",                          \
                                           [SONJECT_SHAPE_USER] = "user"}},                        \
        {"user", "code that is the shape, where that is user", .kind = FIELD_SPECIAL,              \
         .section = &user_section, .read = read_user_shape},                                       \
        {"length",                                                                                 \
         "overall along the nose, of plane, cylinder, capsule, ellipsoid, box and wedge",          \
         QUANTITY(sonject_object_params, length_m, QUANTITY_LENGTH)},                              \
        {"width", "overall across the nose, of plane, ellipsoid, box and wedge",                   \
         QUANTITY(sonject_object_params, width_m, QUANTITY_LENGTH)},                               \
        {"diameter", "overall, of sphere, cylinder, capsule, disc, cones (below) and torus",       \
         QUANTITY(sonject_object_params, diameter_m, QUANTITY_LENGTH)},                            \
        {"height", "overall when level, of ellipsoid, box, wedge (at the tail), cones and torus",  \
         QUANTITY(sonject_object_params, height_m, QUANTITY_LENGTH)},                              \
        {"top_diameter", "of a truncated cone",                                                    \
         QUANTITY(sonject_object_params, top_diameter_m, QUANTITY_LENGTH)},                        \
        {"front_height", "of a wedge at its nose, by default 0",                                   \
         QUANTITY(sonject_object_params, front_height_m, QUANTITY_LENGTH)},                        \
        {"nose_end", "of a cylinder: flat, open, spherical or {depth: }",                          \
         WORD(sonject_object_params, nose_end) = {[SONJECT_END_FLAT] = "flat",                     \
                                                  [SONJECT_END_OPEN] = "open",                     \
                                                  [SONJECT_END_SPHERICAL] = "spherical"},          \
         .section = &nose_end_section},                                                            \
        {"tail_end", "of a cylinder: flat, open, spherical or {depth: }",                          \
         WORD(sonject_object_params, tail_end) = {[SONJECT_END_FLAT] = "flat",                     \
                                                  [SONJECT_END_OPEN] = "open",                     \
                                                  [SONJECT_END_SPHERICAL] = "spherical"},          \
         .section = &tail_end_section},                                                            \
        {"mesh",                                                                                   \
         "of the shape mesh: its file's name, or a section",                                       \
         .kind = FIELD_SPECIAL,                                                                    \
         .unit = "file name",                                                                      \
         .section = &mesh_section,                                                                 \
         .read = read_mesh},                                                                       \
    {                                                                                              \
        "cuts", "planes that cut parts off any shape, at most 2",                                  \
            ENTRIES(sonject_object_params, cuts, cut_count, "cut", cut_section)                    \
    }

/* Angles; what heading is counted from differs. */
#define TURN_FIELDS(heading_meaning)                                                               \
    {"heading", heading_meaning, QUANTITY(sonject_object_params, heading_rad, QUANTITY_ANGLE)},    \
        {"pitch", "raises the nose", QUANTITY(sonject_object_params, pitch_rad, QUANTITY_ANGLE)},  \
    {                                                                                              \
        "roll", "about the nose direction",                                                        \
            QUANTITY(sonject_object_params, roll_rad, QUANTITY_ANGLE)                              \
    }

#define SURFACE_FIELD(surface_meaning)                                                             \
    {                                                                                              \
        "material", surface_meaning, .kind = FIELD_NAMED,                                          \
                                     .offset = offsetof(sonject_object_params, material),          \
                                     .section = &material_section, .read = read_material_name      \
    }

/* Defaults, no size set, surface as given (NULL: the default one). */
void start_shape(sonject_object_params *shape, const sonject_material_params *material);

/* That the section has the sizes of its shape, and no others; of parts none. */
void check_shape_keys(struct reader *reader, const struct tree_node *node, uint32_t shape);

/* That it has no key of a shape: reason tells why. */
void refuse_shape_keys(struct reader *reader, const struct tree_node *node, const char *reason);

/* check_object, of what the section itself says. */
void check_shape_values(struct reader *reader, const struct tree_node *node,
                        const sonject_object_params *shape);

#endif
