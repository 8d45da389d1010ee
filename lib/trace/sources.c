#include "trace/sources.h"

#define MORE_BOUNCES_MAX ((SOURCES_MAX - 1) / 2)

bool material_is_smooth(const sonject_material_params *material)
{
    return material->reflection_kind == SONJECT_REFLECTION_FLUID || material->reflection != 0.0;
}

bool material_is_rough(const sonject_material_params *material)
{
    return (material->lambert > 0.0 || material->glossy_albedo > 0.0) &&
           (!material_is_smooth(material) || material->roughness_m > 0.0);
}

bool scene_mirror(const struct scene *scene, enum mirror_kind kind, double *height_m,
                  const sonject_material_params **material)
{
    if (kind == MIRROR_SEABED) {
        *height_m = 0.0;
        *material = &scene->seabed.forward;
        return material_is_smooth(*material);
    }
    *height_m = scene->surface.water_depth_m;
    *material = &scene->surface.material;
    return *height_m > 0.0 && material_is_smooth(*material);
}

static enum mirror_kind opposite(enum mirror_kind kind)
{
    return kind == MIRROR_SEABED ? MIRROR_SURFACE : MIRROR_SEABED;
}

/* The image of a source in the next mirror; false if the scene has no such mirror. */
static bool image_of(const struct scene *scene, const struct water *water,
                     const struct sound_source *source, enum mirror_kind kind,
                     struct sound_source *image)
{
    double mirror_height;
    const sonject_material_params *material;
    if (!scene_mirror(scene, kind, &mirror_height, &material))
        return false;
    image->bounces = source->bounces + 1;
    image->last_mirror = kind;
    image->way = water_way_mirrored(water, scene->sonar.altitude_m, scene->surface.water_depth_m,
                                    image->bounces, kind == MIRROR_SEABED);
    return true;
}

size_t sources_list(const struct scene *scene, const struct water *water, uint32_t bounces,
                    struct sound_source sources[SOURCES_MAX])
{
    const uint32_t limit = bounces < MORE_BOUNCES_MAX ? bounces : MORE_BOUNCES_MAX;
    size_t count = 1;
    sources[0].way = water_way_direct(water, scene->sonar.altitude_m);
    sources[0].bounces = 0;
    sources[0].last_mirror = MIRROR_SEABED;
    if (limit == 0)
        return count;
    count += image_of(scene, water, &sources[0], MIRROR_SEABED, &sources[count]);
    count += image_of(scene, water, &sources[0], MIRROR_SURFACE, &sources[count]);
    /* a level line cannot meet the same mirror twice in turn */
    for (size_t i = 1; i < count && sources[i].bounces < limit; i++)
        count +=
            image_of(scene, water, &sources[i], opposite(sources[i].last_mirror), &sources[count]);
    return count;
}
