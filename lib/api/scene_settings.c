/* What a scene is told of sonar, water, seabed, injection and image. */
#include "api/handles.h"

#include <stdlib.h>

#include "base/memory.h"
#include "medium/water.h"
#include "swath/geometry_notes.h"
#include "swath/xtf_file.h"

/* Takes a structure into a local copy, checks it, and only then changes the scene. */
#define SET_CHECKED(scene_handle, type, member, params, checker, name)                             \
    do {                                                                                           \
        if (!(scene_handle))                                                                       \
            return SONJECT_ERROR_ARGUMENT;                                                         \
        type taken = (scene_handle)->scene.member;                                                 \
        sonject_status status =                                                                    \
            params_take((scene_handle)->report, &taken, sizeof taken, params, sizeof taken, name); \
        if (status == SONJECT_OK)                                                                  \
            status = checker(&taken, (scene_handle)->report, NULL);                                \
        if (status == SONJECT_OK)                                                                  \
            (scene_handle)->scene.member = taken;                                                  \
        return status;                                                                             \
    } while (0)

sonject_status sonject_scene_set_sonar(sonject_scene *scene, const sonject_sonar_params *sonar)
{
    SET_CHECKED(scene, sonject_sonar_params, sonar, sonar, check_sonar, "sonar");
}

sonject_status sonject_scene_set_medium(sonject_scene *scene, const sonject_medium_params *medium)
{
    SET_CHECKED(scene, sonject_medium_params, medium, medium, check_medium, "medium");
}

/* Takes the layers over. */
static void replace_layers(struct scene *scene, struct water_layer *layers, size_t count)
{
    free(scene->water_layers);
    scene->water_layers = layers;
    scene->water_layer_count = count;
}

sonject_status sonject_scene_set_water_layers(sonject_scene *scene, const double *bottoms_m,
                                              const double *sound_speeds_mps,
                                              const double *densities, size_t count)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (count == 0) {
        replace_layers(&scene->scene, NULL, 0);
        return SONJECT_OK;
    }
    if (!bottoms_m || !sound_speeds_mps)
        return null_argument(scene->report, "bottoms_m and sound_speeds_mps");
    if (count > WATER_LAYERS_MAX)
        return report_failure(scene->report, SONJECT_ERROR_INPUT,
                              "layers: %zu of them; at most %d are possible", count,
                              WATER_LAYERS_MAX);
    struct water_layer *layers = allocate_array(count, sizeof *layers);
    if (!layers)
        return report_out_of_memory(scene->report, "the layers of water");
    for (size_t i = 0; i < count; i++) {
        layers[i].bottom_m = bottoms_m[i];
        layers[i].speed_mps = sound_speeds_mps[i];
        layers[i].density = densities ? densities[i] : 1.0;
    }
    const sonject_status status = check_water_layers(layers, count, scene->report, NULL);
    if (status == SONJECT_OK)
        replace_layers(&scene->scene, layers, count);
    else
        free(layers);
    return status;
}

sonject_status sonject_scene_set_sound_speed_profile(sonject_scene *scene, const double *heights_m,
                                                     const double *sound_speeds_mps, size_t count)
{
    struct water_layer *layers = NULL;
    size_t layer_count = 0;
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (!heights_m || !sound_speeds_mps)
        return null_argument(scene->report, "heights_m and sound_speeds_mps");
    sonject_status status =
        check_sound_speed_profile(heights_m, sound_speeds_mps, count, scene->report, NULL);
    THEN(status, layers_of_profile(heights_m, sound_speeds_mps, count, scene->report, &layers,
                                   &layer_count));
    if (status == SONJECT_OK)
        replace_layers(&scene->scene, layers, layer_count);
    return status;
}

sonject_status sonject_scene_set_seabed(sonject_scene *scene, const sonject_seabed_params *seabed)
{
    SET_CHECKED(scene, sonject_seabed_params, seabed, seabed, check_seabed, "seabed");
}

sonject_status sonject_scene_set_relief(sonject_scene *scene, const sonject_relief_params *relief,
                                        const float *heights_m)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    sonject_relief_params taken;
    sonject_relief_params_init(&taken);
    sonject_status status =
        params_take(scene->report, &taken, sizeof taken, relief, sizeof taken, "relief");
    if (status == SONJECT_OK && taken.rows > 0 && !heights_m)
        status = null_argument(scene->report, "heights_m");
    THEN(status, relief_features_set_grid(&scene->scene.relief, scene->report, &taken, heights_m));
    return status;
}

sonject_status sonject_scene_set_surface(sonject_scene *scene,
                                         const sonject_surface_params *surface)
{
    SET_CHECKED(scene, sonject_surface_params, surface, surface, check_surface, "surface");
}

sonject_status sonject_scene_set_geometry(sonject_scene *scene,
                                          const sonject_geometry_params *geometry)
{
    SET_CHECKED(scene, sonject_geometry_params, geometry, geometry, check_geometry, "geometry");
}

sonject_status sonject_scene_set_transfer(sonject_scene *scene,
                                          const sonject_transfer_params *transfer)
{
    SET_CHECKED(scene, sonject_transfer_params, transfer, transfer, check_transfer, "transfer");
}

sonject_status sonject_scene_set_injection(sonject_scene *scene,
                                           const sonject_injection_params *injection)
{
    SET_CHECKED(scene, sonject_injection_params, injection, injection, check_injection,
                "injection");
}

sonject_status sonject_scene_set_elements(sonject_scene *scene,
                                          const sonject_elements_params *elements)
{
    SET_CHECKED(scene, sonject_elements_params, elements, elements, check_elements, "elements");
}

sonject_status sonject_scene_set_patch(sonject_scene *scene, const sonject_patch_params *patch)
{
    SET_CHECKED(scene, sonject_patch_params, patch, patch, check_patch, "patch");
}

sonject_status sonject_scene_set_input_file(sonject_scene *scene, const char *path)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (!path)
        return null_argument(scene->report, "path");
    char *copy = copy_text(path);
    if (!copy)
        return report_out_of_memory(scene->report, "a path");
    free(scene->scene.input_path);
    scene->scene.input_path = copy;
    scene->scene.input_kind = SONJECT_INPUT_FILE;
    return SONJECT_OK;
}

sonject_status sonject_scene_set_input_channel(sonject_scene *scene, int32_t channel)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (channel < SONJECT_CHANNEL_ONLY || channel > XTF_CHANNEL_MAX)
        return report_failure(scene->report, SONJECT_ERROR_ARGUMENT,
                              "channel: %d is none of an XTF file", (int)channel);
    scene->scene.channel = channel;
    return SONJECT_OK;
}

sonject_status sonject_scene_set_input_array(sonject_scene *scene, const char *array)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    char *copy = array ? copy_text(array) : NULL;
    if (array && !copy)
        return report_out_of_memory(scene->report, "the name of an array");
    free(scene->scene.array);
    scene->scene.array = copy;
    return SONJECT_OK;
}

sonject_status sonject_scene_take_geometry(sonject_scene *scene)
{
    const char *key;
    return scene ? recording_describe(scene->report, true, true, &scene->scene, &key)
                 : SONJECT_ERROR_ARGUMENT;
}

sonject_status sonject_scene_set_input_uniform(sonject_scene *scene, uint32_t rows,
                                               uint32_t columns)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    const sonject_status status = check_uniform(rows, columns, scene->report, NULL);
    if (status == SONJECT_OK) {
        scene->scene.uniform_rows = rows;
        scene->scene.uniform_columns = columns;
        scene->scene.input_kind = SONJECT_INPUT_UNIFORM;
    }
    return status;
}

static sonject_status take_synthetic(sonject_scene *scene,
                                     const sonject_synthetic_params *synthetic)
{
    SET_CHECKED(scene, sonject_synthetic_params, synthetic, synthetic, check_synthetic,
                "synthetic");
}

sonject_status sonject_scene_set_input_synthetic(sonject_scene *scene,
                                                 const sonject_synthetic_params *synthetic)
{
    const sonject_status status = take_synthetic(scene, synthetic);
    if (status == SONJECT_OK)
        scene->scene.input_kind = SONJECT_INPUT_SYNTHETIC;
    return status;
}
