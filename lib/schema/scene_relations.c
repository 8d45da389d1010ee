/* What a table cannot say: keys that need or exclude each other, and the few that are read in a way
 * of their own. */
#include <string.h>

#include "scene/element_plan.h"
#include "schema/scene_schema.h"

#define RIGHT_ANGLE 1.5707963267948966

sonject_status read_version(struct reader *reader, const struct tree_node *node, void *structure)
{
    (void)structure;
    if (node->kind != TREE_TEXT || !node->text || strcmp(node->text, "1") != 0)
        return refuse_value(reader, node, "must be 1, the version of the format that is read here");
    return SONJECT_OK;
}

sonject_status read_noise_floor(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    sonject_injection_params *injection = structure;
    injection->estimate_noise =
        node->kind == TREE_TEXT && node->text && strcmp(node->text, "estimate") == 0;
    if (injection->estimate_noise)
        return SONJECT_OK;
    return read_quantity(reader, node, QUANTITY_DECIBEL, &injection->noise_floor_db);
}

sonject_status read_match_looks(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    sonject_injection_params *injection = structure;
    injection->match_looks = 0.0;
    if (node->kind == TREE_TEXT && node->text && strcmp(node->text, "image") == 0)
        return SONJECT_OK;
    sonject_status status = read_quantity(reader, node, QUANTITY_NUMBER, &injection->match_looks);
    if (status == SONJECT_OK && injection->match_looks == 0.0)
        status = refuse_value(reader, node, "must be image, or a number from 1 to 64");
    return status;
}

sonject_status read_aperture(struct reader *reader, const struct tree_node *node, void *structure)
{
    sonject_sonar_params *sonar = structure;
    const char *text = node->kind == TREE_TEXT && node->text ? node->text : "";
    if (strcmp(text, "auto") == 0 || strcmp(text, "none") == 0) {
        sonar->aperture_rad = strcmp(text, "auto") == 0 ? -1.0 : 0.0;
        return SONJECT_OK;
    }
    const sonject_status status = read_quantity(reader, node, QUANTITY_ANGLE, &sonar->aperture_rad);
    if (status == SONJECT_OK && !(sonar->aperture_rad >= 0.0 && sonar->aperture_rad <= RIGHT_ANGLE))
        return refuse_value(reader, node, "must be from 0 to 90 deg, auto or none");
    return status;
}

sonject_status finish_sonar(struct reader *reader, const struct tree_node *node, void *structure)
{
    const sonject_sonar_params *sonar = structure;
    const bool is_real = sonar->kind == SONJECT_SONAR_REAL;
    if (is_real && !is_given(node, "array"))
        refuse_key(reader, node, "array", "missing; a real aperture needs its length");
    if (!is_real && is_given(node, "array"))
        refuse_relation(reader, node, "array", "kind",
                        "belongs to a real aperture; set kind: real");
    if (is_real && is_given(node, "aperture"))
        refuse_key(reader, node, "aperture",
                   "belongs to a synthetic aperture; a real one has that of its array");
    return check_sonar(sonar, NULL, listen_at(reader, node));
}

sonject_status finish_scene(struct reader *reader, const struct tree_node *node, void *structure)
{
    const struct scene *scene = structure;
    const bool is_complex = scene->input_kind == SONJECT_INPUT_SYNTHETIC
                                ? scene->synthetic.complex_pixels
                                : scene->input_is_complex;
    if (scene->seabed.map == SONJECT_MAP_COHERENT && !is_complex &&
        scene->input_kind != SONJECT_INPUT_MEMORY)
        refuse_relation(reader, node, "seabed.map",
                        "input.complex input.synthetic input.uniform input.path",
                        "coherent needs complex pixels; set complex: true in input if they are");
    if (scene->surface.water_depth_m > 0.0 &&
        scene->surface.water_depth_m <= scene->sonar.altitude_m)
        refuse_relation(reader, node, "surface.depth", "sonar.altitude",
                        "must be above the sonar's altitude of %g m, not %g m",
                        scene->sonar.altitude_m, scene->surface.water_depth_m);
    if (scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE &&
        !(scene->sonar.transducer_side_m > 0.0))
        refuse_relation(reader, node, "injection.estimator", "sonar.transducer",
                        "brute_force needs a source that rays can hit; set transducer in sonar");
    const double least_rate = element_least_rate(&scene->elements, scene->sonar.centre_frequency_hz,
                                                 scene->sonar.bandwidth_hz);
    if (scene->elements.sampling_rate_hz != 0.0 && scene->elements.sampling_rate_hz < least_rate)
        refuse_relation(reader, node, "elements.sampling_rate",
                        "elements.form sonar.frequency sonar.bandwidth",
                        "must be at least %g Hz for the sonar's band, not %g Hz", least_rate,
                        scene->elements.sampling_rate_hz);
    return SONJECT_OK;
}

sonject_status finish_input(struct reader *reader, const struct tree_node *node, void *structure)
{
    static const char *const file_keys[] = {"channel", "array", "complex", "transfer"};
    struct scene *scene = structure;
    const bool is_file = is_given(node, "path");
    const bool is_uniform = is_given(node, "uniform");
    if (reader->takes_pixels && count_given(node, "path uniform synthetic") == 0) {
        scene->input_kind = SONJECT_INPUT_MEMORY;
        return SONJECT_OK;
    }
    if (check_one_given(reader, node, "path uniform synthetic", "path, uniform and synthetic") !=
        SONJECT_OK)
        return SONJECT_ERROR_INPUT;
    for (int i = 0; i < 4; i++)
        if (!is_file && is_given(node, file_keys[i]))
            refuse_key(reader, node, file_keys[i],
                       "belongs to an image file (path), not to %s; remove it",
                       is_uniform ? "uniform" : "synthetic");
    scene->input_kind = is_file      ? SONJECT_INPUT_FILE
                        : is_uniform ? SONJECT_INPUT_UNIFORM
                                     : SONJECT_INPUT_SYNTHETIC;
    return SONJECT_OK;
}

sonject_status finish_uniform(struct reader *reader, const struct tree_node *node, void *structure)
{
    const struct scene *scene = structure;
    return check_uniform(scene->uniform_rows, scene->uniform_columns, NULL,
                         listen_at(reader, node));
}

sonject_status check_position(struct reader *reader, const struct tree_node *node, uint32_t *kind)
{
    const bool is_metres = is_given(node, "along_track");
    const char *pair = is_metres ? "along_track slant_range" : "row column";
    *kind = is_metres ? SONJECT_POSITION_METRES : SONJECT_POSITION_PIXELS;
    if ((count_given(node, pair) != 2 || node->count != 2) &&
        are_sound(reader, "along_track slant_range row column"))
        return refuse_value(reader, node,
                            "needs along_track and slant_range, or row and column; give one pair");
    return SONJECT_OK;
}

/* The check of a structure that a section fills. */
#define FINISH(name, type)                                                                         \
    sonject_status finish_##name(struct reader *reader, const struct tree_node *node,              \
                                 void *structure)                                                  \
    {                                                                                              \
        return check_##name((const type *)structure, NULL, listen_at(reader, node));               \
    }

FINISH(synthetic, sonject_synthetic_params)
FINISH(geometry, sonject_geometry_params)
FINISH(patch, sonject_patch_params)
FINISH(seabed, sonject_seabed_params)
FINISH(surface, sonject_surface_params)
FINISH(injection, sonject_injection_params)

sonject_status finish_transfer(struct reader *reader, const struct tree_node *node, void *structure)
{
    const sonject_transfer_params *transfer = structure;
    const bool has_parameter = transfer->kind == SONJECT_TRANSFER_DECIBEL ||
                               transfer->kind == SONJECT_TRANSFER_GAMMA ||
                               transfer->kind == SONJECT_TRANSFER_SCHLICK;
    if (has_parameter && !is_given(node, "parameter"))
        refuse_key(reader, node, "parameter", "missing; this kind of transfer needs it");
    if (!has_parameter && is_given(node, "parameter"))
        refuse_relation(reader, node, "parameter", "kind",
                        "this kind of transfer has none; remove it");
    if (transfer->kind != SONJECT_TRANSFER_DECIBEL && is_given(node, "offset"))
        refuse_relation(reader, node, "offset", "kind", "only the decibel kind has one; remove it");
    return check_transfer(transfer, NULL, listen_at(reader, node));
}

sonject_status finish_response(struct reader *reader, const struct tree_node *node, void *structure)
{
    sonject_sonar_params *sonar = structure;
    (void)reader;
    (void)node;
    sonar->response_window = SONJECT_WINDOW_TAYLOR;
    return SONJECT_OK;
}
