#include "medium/profile.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/ranges.h"

#define DENSITY_MIN     1e-6 /* so that ratios neither overflow nor vanish */
#define DENSITY_MAX     1e6
#define STEPS_PER_SPEED 20000.0

/* Checks one value after the other and remembers where it was. */
struct walk {
    struct check check;
    struct profile_place place;
    char name[64]; /* of the value that is checked */
};

/* "heights[3]", or "layers[3].bottom" where `of` is not NULL. */
static const char *name_value(struct walk *walk, const char *of, size_t index, const char *key)
{
    if (walk->check.status == SONJECT_OK) {
        if (of)
            snprintf(walk->name, sizeof walk->name, "%s[%zu].%s", of, index, key);
        else
            snprintf(walk->name, sizeof walk->name, "%s[%zu]", key, index);
        walk->place.index = index;
        walk->place.key = key;
    }
    return walk->name;
}

static sonject_status end_walk(const struct walk *walk, struct profile_place *place)
{
    if (walk->check.status != SONJECT_OK && place)
        *place = walk->place;
    return walk->check.status;
}

static void check_rise(struct walk *walk, double below, double height)
{
    if (!(height >= below + WATER_HEIGHT_STEP_MIN_M))
        check_failure(&walk->check, walk->name,
                      "must lie over the one before it, %g m, by at least %g m, not at %g m", below,
                      WATER_HEIGHT_STEP_MIN_M, height);
}

sonject_status check_water_layers(const struct water_layer *layers, size_t count,
                                  struct report *report, struct profile_place *place)
{
    struct walk walk = {{report, NULL, SONJECT_OK}, {0, NULL}, ""};
    if (count > WATER_LAYERS_MAX) {
        name_value(&walk, "layers", WATER_LAYERS_MAX, "bottom");
        check_failure(&walk.check, walk.name, "is one too many; at most %d layers are possible",
                      WATER_LAYERS_MAX);
    }
    for (size_t i = 0; i < count && walk.check.status == SONJECT_OK; i++) {
        check_coordinate(&walk.check, name_value(&walk, "layers", i, "bottom"), layers[i].bottom_m);
        if (i > 0)
            check_rise(&walk, layers[i - 1].bottom_m, layers[i].bottom_m);
        else if (layers[0].bottom_m != 0.0)
            check_failure(&walk.check, walk.name,
                          "must be 0 m: the first layer lies on the seabed; not %g m",
                          layers[0].bottom_m);
        check_within(&walk.check, name_value(&walk, "layers", i, "sound_speed"),
                     layers[i].speed_mps, WATER_SPEED_MIN_MPS, WATER_SPEED_MAX_MPS, " m/s");
        check_within(&walk.check, name_value(&walk, "layers", i, "density"), layers[i].density,
                     DENSITY_MIN, DENSITY_MAX, "");
    }
    return end_walk(&walk, place);
}

sonject_status check_sound_speed_profile(const double *heights_m, const double *speeds_mps,
                                         size_t count, struct report *report,
                                         struct profile_place *place)
{
    struct walk walk = {{report, NULL, SONJECT_OK}, {0, NULL}, ""};
    if (count < 2) {
        name_value(&walk, NULL, count, "heights");
        check_failure(&walk.check, walk.name, "is missing; a profile needs at least two samples");
    }
    for (size_t i = 0; i < count && walk.check.status == SONJECT_OK; i++) {
        check_coordinate(&walk.check, name_value(&walk, NULL, i, "heights"), heights_m[i]);
        if (i > 0)
            check_rise(&walk, heights_m[i - 1], heights_m[i]);
        if (i + 1 == count && !(heights_m[i] > 0.0))
            check_failure(&walk.check, walk.name,
                          "must lie over the seabed: the whole profile is below it (%g m)",
                          heights_m[i]);
        check_within(&walk.check, name_value(&walk, NULL, i, "sound_speeds"), speeds_mps[i],
                     WATER_SPEED_MIN_MPS, WATER_SPEED_MAX_MPS, " m/s");
    }
    return end_walk(&walk, place);
}

struct stack {
    struct water_layer *layers; /* room for WATER_LAYERS_MAX */
    size_t count;
    bool is_full; /* and another was wanted */
};

static void add_layer(struct stack *stack, double bottom_m, double speed_mps)
{
    if (stack->count > 0 && stack->layers[stack->count - 1].speed_mps == speed_mps)
        return;
    if (stack->count == WATER_LAYERS_MAX) {
        stack->is_full = true;
        return;
    }
    const struct water_layer layer = {bottom_m, speed_mps, 1.0};
    stack->layers[stack->count++] = layer;
}

/* A linear piece, low >= 0. */
static void add_piece(struct stack *stack, double low, double low_speed, double high,
                      double high_speed)
{
    const double step_limit = fmin(low_speed, high_speed) / STEPS_PER_SPEED;
    const double pieces = fmax(1.0, ceil(fabs(high_speed - low_speed) / step_limit));
    for (double i = 0.0; i < pieces && !stack->is_full; i++)
        add_layer(stack, low + i / pieces * (high - low),
                  low_speed + (i + 0.5) / pieces * (high_speed - low_speed));
}

static void add_profile(struct stack *stack, const double *heights_m, const double *speeds_mps,
                        size_t count)
{
    if (heights_m[0] > 0.0)
        add_layer(stack, 0.0, speeds_mps[0]);
    for (size_t i = 0; i + 1 < count && !stack->is_full; i++) {
        double low = heights_m[i];
        double low_speed = speeds_mps[i];
        const double high = heights_m[i + 1];
        if (high <= 0.0)
            continue;
        if (low < 0.0) {
            low_speed += (speeds_mps[i + 1] - low_speed) * (low / (low - high));
            low = 0.0;
        }
        add_piece(stack, low, low_speed, high, speeds_mps[i + 1]);
    }
    add_layer(stack, heights_m[count - 1], speeds_mps[count - 1]);
}

sonject_status layers_of_profile(const double *heights_m, const double *speeds_mps, size_t count,
                                 struct report *report, struct water_layer **layers,
                                 size_t *layer_count)
{
    struct stack stack = {allocate_array(WATER_LAYERS_MAX, sizeof **layers), 0, false};
    CHECK_MEMORY(report, stack.layers, "the layers of a profile");
    add_profile(&stack, heights_m, speeds_mps, count);
    if (stack.is_full) {
        free(stack.layers);
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "profile needs more than %d layers; take fewer samples, or layers",
                              WATER_LAYERS_MAX);
    }
    *layers = stack.layers;
    *layer_count = stack.count;
    return SONJECT_OK;
}
