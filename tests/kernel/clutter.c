#include "kernel/clutter.h"

#include "claims.h"
#include "random.h"

/* Returns the next uniform random number in (0, 1). */
static double draw(uint32_t *counter)
{
    float u, v;
    two_uniforms(random_key_of(7, 0, 77, 0), (*counter)++, 0, &u, &v);
    return u;
}

static void shape_object(sonject_object_params *object, uint32_t number, double size,
                         uint32_t *counter)
{
    object_init(object);
    object->shape = number % SHAPE_PARTS; /* every shape but SHAPE_PARTS */
    object->length_m = size * (0.5 + draw(counter));
    object->width_m = 0.6 * object->length_m;
    object->height_m = 0.15 * object->length_m;
    object->diameter_m = object->shape == SHAPE_SPHERE ? size : 0.4 * object->length_m;
    object->heading_rad = 6.28 * draw(counter);
    object->pitch_rad = draw(counter) - 0.5;
    object->roll_rad = draw(counter) - 0.5;
    if (number % 3 == 0)
        object->pitch_rad = object->roll_rad = 0.0;
    object->material.lambert = 0.1;
    object->material.reflection = 0.8;
    object->material.roughness_m = 1e-3;
}

void clutter_strew(struct bench *bench, uint32_t count, double size)
{
    uint32_t counter = 0;
    bench_add_tetrahedron(bench);
    for (uint32_t i = 0; i < count; i++) {
        sonject_object_params object;
        shape_object(&object, i, size * (0.2 + 0.8 * draw(&counter)), &counter);
        object.position_kind = SONJECT_POSITION_PIXELS;
        object.position_along = (double)bench->rows * (0.1 + 0.8 * draw(&counter));
        object.position_range = (double)bench->columns * (0.1 + 0.75 * draw(&counter));
        if (i % 8 == 7) { /* a second object, equal to the bit */
            object = bench->scene.objects[i - 1];
        } else if (i % 8 == 5) { /* one inside the other */
            const sonject_object_params *outer = &bench->scene.objects[i - 1];
            object.position_along = outer->position_along;
            object.position_range = outer->position_range;
        } else if (i % 8 == 3) { /* side by side */
            const sonject_object_params *other = &bench->scene.objects[i - 1];
            object = *other;
            object.position_along += other->width_m / 0.025;
        }
        EXPECT_OK(&bench->report, scene_append_object(&bench->scene, &bench->report, &object));
    }
}
