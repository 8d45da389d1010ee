#include "api/handles.h"
#include "scene/check_cuts.h"
#include "scene/pose.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/recording.h"
#include "io/scene_file.h"
#include "io/scene_target.h"
#include "io/xtf_file.h"
#include "medium/profile.h"

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

sonject_status sonject_scene_create(sonject_context *context, sonject_scene **scene)
{
    if (!context || !scene)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    *scene = allocate_array(1, sizeof **scene);
    if (!*scene)
        return report_out_of_memory(&context->report, "a scene");
    (*scene)->report = &context->report;
    scene_init(&(*scene)->scene);
    return SONJECT_OK;
}

static void source_clear(struct scene_source *source)
{
    for (size_t i = 0; i < source->override_count; i++)
        free(source->overrides[i]);
    free(source->overrides);
    free(source->path);
    free(source->text);
    memset(source, 0, sizeof *source);
}

void sonject_scene_release(sonject_scene **scene)
{
    if (!scene || !*scene)
        return;
    scene_clear(&(*scene)->scene);
    source_clear(&(*scene)->source);
    free(*scene);
    *scene = NULL;
}

/* Keeps what the scene is read from; takes the text over. */
static sonject_status source_keep(struct scene_source *source, struct report *report,
                                  const char *path, char *text, const char *const *overrides,
                                  size_t count)
{
    source->text = text;
    source->path = copy_text(path);
    source->overrides = allocate_array(count, sizeof *source->overrides);
    bool is_whole = source->path && source->overrides;
    for (size_t i = 0; is_whole && i < count; i++) {
        source->overrides[i] = copy_text(overrides[i]);
        is_whole = source->overrides[i] != NULL;
        source->override_count = i + 1;
    }
    return is_whole ? SONJECT_OK : report_out_of_memory(report, "a scene");
}

static sonject_status read_file(struct sonject_scene *scene, const char *path,
                                const char *const *overrides, size_t count, bool allows_user_shapes)
{
    char *text;
    size_t bytes;
    sonject_status status = scene_file_load(scene->report, path, &text, &bytes);
    if (status == SONJECT_OK)
        status = source_keep(&scene->source, scene->report, path, text, overrides, count);
    if (status != SONJECT_OK)
        return status;
    const struct scene_text source = {path,  text, bytes, overrides,
                                      count, NULL, 0,     allows_user_shapes};
    return scene_text_read(scene->report, &source, &scene->scene);
}

static sonject_status check_overrides(struct report *report, const char *path,
                                      const char *const *overrides, size_t count)
{
    if (!path || (count > 0 && !overrides))
        return null_argument(report, "path and overrides");
    for (size_t i = 0; i < count; i++)
        if (!overrides[i])
            return null_argument(report, "an override");
    return SONJECT_OK;
}

sonject_status sonject_scene_bands(sonject_context *context, const char *path,
                                   const char *const *overrides, size_t count, char **names)
{
    if (!context)
        return SONJECT_ERROR_ARGUMENT;
    context_begin_call(context);
    struct report *report = &context->report;
    if (!names)
        return null_argument(report, "names");
    *names = NULL;
    char *text;
    size_t bytes;
    sonject_status status = check_overrides(report, path, overrides, count);
    if (status == SONJECT_OK)
        status = scene_file_load(report, path, &text, &bytes);
    if (status != SONJECT_OK)
        return status;
    const struct scene_text source = {path, text, bytes, overrides, count, NULL, 0, false};
    status = scene_text_bands(report, &source, names);
    free(text);
    return status;
}

void sonject_scene_read_params_init(sonject_scene_read_params *params)
{
    memset(params, 0, sizeof *params);
    params->struct_size = sizeof *params;
}

sonject_status sonject_scene_read(sonject_context *context, const char *path,
                                  const char *const *overrides, size_t count, sonject_scene **scene)
{
    sonject_scene_read_params params;
    sonject_scene_read_params_init(&params);
    return sonject_scene_read_with(context, path, overrides, count, &params, scene);
}

sonject_status sonject_scene_read_with(sonject_context *context, const char *path,
                                       const char *const *overrides, size_t count,
                                       const sonject_scene_read_params *params,
                                       sonject_scene **scene)
{
    if (!context || !scene)
        return SONJECT_ERROR_ARGUMENT;
    *scene = NULL;
    context_begin_call(context);
    sonject_scene_read_params taken;
    sonject_scene_read_params_init(&taken);
    sonject_status status = params_take(&context->report, &taken, sizeof taken, params,
                                        sizeof taken, "scene read parameters");
    if (status != SONJECT_OK)
        return status;
    status = check_overrides(&context->report, path, overrides, count);
    if (status != SONJECT_OK)
        return status;
    sonject_scene *made;
    status = sonject_scene_create(context, &made);
    if (status != SONJECT_OK)
        return status;
    status = read_file(made, path, overrides, count, taken.allows_user_shapes != 0);
    if (status == SONJECT_OK)
        *scene = made;
    else
        sonject_scene_release(&made);
    return status;
}

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
    if (status == SONJECT_OK)
        status = layers_of_profile(heights_m, sound_speeds_mps, count, scene->report, &layers,
                                   &layer_count);
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
    if (status == SONJECT_OK)
        status = relief_features_set_grid(&scene->scene.relief, scene->report, &taken, heights_m);
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
    return scene ? recording_describe(scene->report, true, true, &scene->scene)
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

sonject_status sonject_scene_add_mesh(sonject_scene *scene, const char *path,
                                      const sonject_mesh_params *params, uint32_t *mesh)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (!path)
        return null_argument(scene->report, "path");
    sonject_mesh_params taken;
    struct mesh_options options;
    sonject_mesh_params_init(&taken);
    mesh_options_init(&options);
    sonject_status status =
        params_take(scene->report, &taken, sizeof taken, params, sizeof taken, "mesh");
    options.unit_m = taken.unit_m;
    options.smooth_angle_rad = taken.smooth_angle_rad;
    for (int axis = 0; axis < 3; axis++)
        options.axes[axis] = taken.axes[axis];
    if (status == SONJECT_OK)
        status =
            scene_append_mesh(&scene->scene, scene->report, path, &options, taken.allows_open != 0);
    if (status == SONJECT_OK && mesh)
        *mesh = scene->scene.mesh_count - 1;
    return status;
}

sonject_status sonject_scene_add_user_shape(sonject_scene *scene,
                                            const sonject_user_shape_params *shape,
                                            uint32_t *user_shape)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    sonject_user_shape_params taken;
    sonject_user_shape_params_init(&taken);
    sonject_status status =
        params_take(scene->report, &taken, sizeof taken, shape, sizeof taken, "user shape");
    if (status == SONJECT_OK && (!taken.name || !taken.code))
        status = null_argument(scene->report, "name and code of a user shape");
    if (status == SONJECT_OK)
        status = check_user_shape(&taken, scene->report, NULL);
    if (status == SONJECT_OK)
        status = user_shapes_append(&scene->scene.user_shapes, scene->report, &taken);
    if (status == SONJECT_OK && user_shape)
        *user_shape = scene->scene.user_shapes.count - 1;
    return status;
}

/* Whether a shape's mesh, or its code, is one of the scene, and its cuts leave something of it. */
static sonject_status check_number(const sonject_scene *scene, const sonject_object_params *shape)
{
    if (shape->shape == SONJECT_SHAPE_USER && shape->user_shape >= scene->scene.user_shapes.count)
        return report_failure(scene->report, SONJECT_ERROR_ARGUMENT,
                              "there is no user shape %lu in the scene",
                              (unsigned long)shape->user_shape);
    if (shape->shape == SONJECT_SHAPE_MESH && shape->mesh >= scene->scene.mesh_count)
        return report_failure(scene->report, SONJECT_ERROR_ARGUMENT,
                              "there is no mesh %lu in the scene", (unsigned long)shape->mesh);
    return check_cuts_in_scene(&scene->scene, shape, scene->report, NULL);
}

sonject_status sonject_scene_add_object(sonject_scene *scene, const sonject_object_params *object,
                                        uint32_t *index)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    sonject_object_params taken;
    sonject_object_params_init(&taken);
    sonject_status status =
        params_take(scene->report, &taken, sizeof taken, object, sizeof taken, "object");
    if (status == SONJECT_OK)
        status = check_object(&taken, scene->report, NULL);
    if (status == SONJECT_OK)
        status = check_number(scene, &taken);
    if (status == SONJECT_OK)
        status = scene_append_object(&scene->scene, scene->report, &taken);
    if (status == SONJECT_OK && index)
        *index = scene->scene.object_count - 1;
    return status;
}

sonject_status sonject_scene_add_target(sonject_scene *scene, const char *path,
                                        const sonject_scene_read_params *params,
                                        const sonject_object_params *object, uint32_t *index)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (!path)
        return null_argument(scene->report, "path");
    sonject_scene_read_params reading;
    sonject_object_params placing;
    sonject_scene_read_params_init(&reading);
    sonject_object_params_init(&placing);
    sonject_status status = SONJECT_OK;
    if (params)
        status = params_take(scene->report, &reading, sizeof reading, params, sizeof reading,
                             "scene read parameters");
    if (status == SONJECT_OK && object)
        status =
            params_take(scene->report, &placing, sizeof placing, object, sizeof placing, "object");
    if (status == SONJECT_OK)
        status = scene_append_target(&scene->scene, scene->report, path,
                                     reading.allows_user_shapes != 0, &placing);
    if (status == SONJECT_OK && index)
        *index = scene->scene.object_count - 1;
    return status;
}

sonject_status sonject_scene_add_part(sonject_scene *scene, uint32_t object,
                                      const sonject_object_params *shape,
                                      const sonject_part_params *part)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (object >= scene->scene.object_count)
        return report_failure(scene->report, SONJECT_ERROR_ARGUMENT,
                              "there is no object %lu to add a part to", (unsigned long)object);
    if (scene->scene.objects[object].shape != SONJECT_SHAPE_PARTS)
        return report_failure(scene->report, SONJECT_ERROR_INPUT,
                              "object %lu has a shape of its own; only an object of parts takes "
                              "parts",
                              (unsigned long)object);
    struct scene_part taken;
    sonject_part_params place;
    memset(&taken, 0, sizeof taken);
    sonject_part_params_init(&place);
    sonject_object_params_init(&taken.shape);
    sonject_status status = params_take(scene->report, &taken.shape, sizeof taken.shape, shape,
                                        sizeof taken.shape, "shape");
    if (status == SONJECT_OK)
        status = params_take(scene->report, &place, sizeof place, part, sizeof place, "part");
    if (status == SONJECT_OK && taken.shape.shape == SONJECT_SHAPE_PARTS)
        status = report_failure(scene->report, SONJECT_ERROR_INPUT,
                                "shape of a part must be a single one");
    if (status == SONJECT_OK)
        status = check_object(&taken.shape, scene->report, NULL);
    if (status == SONJECT_OK)
        status = check_number(scene, &taken.shape);
    if (status == SONJECT_OK)
        status = check_part(&place, scene->report, NULL);
    if (status != SONJECT_OK)
        return status;
    taken.object = object;
    taken.centre[0] = place.along_m;
    taken.centre[1] = place.across_m;
    taken.centre[2] = place.up_m;
    turn_axes(taken.axes, place.heading_rad, place.pitch_rad, place.roll_rad);
    return scene_append_part(&scene->scene, scene->report, &taken);
}

sonject_status sonject_scene_object_count(const sonject_scene *scene, uint32_t *count)
{
    if (!scene || !count)
        return SONJECT_ERROR_ARGUMENT;
    *count = scene->scene.object_count;
    return SONJECT_OK;
}
