#include "chain_hit.h"

#include "kernel/clutter.h"

#ifndef CLUTTER_SEARCH
#define CLUTTER_SEARCH clutter_search_one
#endif

static struct vector3 load_three(const float *planes, uint32_t rays)
{
    struct vector3 v;
    v.x = LOAD_VFLOAT(planes);
    v.y = LOAD_VFLOAT(planes + rays);
    v.z = LOAD_VFLOAT(planes + 2 * rays);
    return v;
}

void CLUTTER_SEARCH(const struct object_record *objects, int count, enum search_question question,
                    const float *input, float *distance, int32_t *object, uint32_t rays)
{
    const struct trace trace = {.fan = {.objects = count}, .objects = objects};
    for (uint32_t ray = 0; ray < rays; ray += WIDTH) {
        const struct vector3 point = load_three(input + ray, rays);
        const struct vector3 direction = load_three(input + 3 * rays + ray, rays);
        const vfloat limit = LOAD_VFLOAT(input + 6 * rays + ray);
        const vint left_behind = VINT_OF(LOAD_VFLOAT(input + 7 * rays + ray));
        struct nearest_hit hit;
        if (question == SEARCH_NEAREST) {
            hit = find_nearest_hit(objects, count, point, direction, -60.0f);
        } else if (question == SEARCH_OBSTACLE) {
            hit.distance = SPLAT(0.0f);
            hit.object = MASK_OF(find_obstacle(objects, count, point, direction, limit) <= limit);
        } else {
            /* some lanes rest */
            const mask is_ray = MASK_OF(limit > 0.5f);
            hit = find_nearest_ahead(&trace, point, direction, 0.0f, SPLAT(FAR_AWAY), 0,
                                     left_behind, is_ray);
            hit.distance = SELECT(is_ray, hit.distance, SPLAT(0.0f));
            hit.object = SELECT(is_ray, hit.object, SPLAT_VINT(-1));
        }
        STORE_VFLOAT(hit.distance, distance + ray);
        STORE_VINT(hit.object, object + ray);
    }
}
