#include "medium/water.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define JOINED_DIFFERENCE 0.002 /* of layers that targets reach into, relative */

static bool are_alike(const struct water_layer *one, const struct water_layer *other)
{
    return one->speed_mps == other->speed_mps && one->density == other->density;
}

/* Joins neighbours that do not differ. */
static void join_equals(struct water *water)
{
    size_t kept = 0;
    for (size_t i = 1; i < water->count; i++)
        if (!are_alike(&water->layers[i], &water->layers[kept]))
            water->layers[++kept] = water->layers[i];
    water->count = kept + 1;
}

/* Height in which layer i overlaps with [low, high]. */
static double overlap(const struct water *water, size_t i, double low, double high)
{
    const double bottom = fmax(water->layers[i].bottom_m, low);
    const double top = i + 1 < water->count ? fmin(water->layers[i + 1].bottom_m, high) : high;
    return fmax(0.0, top - bottom);
}

/* Makes one layer of all below `highest`. */
static sonject_status join_below(struct water *water, struct report *report, double highest)
{
    double slowness = 0.0, density = 0.0;
    size_t within = 0; /* the last layer that begins below */
    for (size_t i = 0; i < water->count && water->layers[i].bottom_m < highest; i++) {
        const double share = overlap(water, i, 0.0, highest) / highest;
        slowness += share / water->layers[i].speed_mps;
        density += share * water->layers[i].density;
        within = i;
    }
    if (within == 0)
        return SONJECT_OK;
    for (size_t i = 0; i <= within; i++) {
        const struct water_layer *layer = &water->layers[i];
        if (fabs(layer->speed_mps * slowness - 1.0) > JOINED_DIFFERENCE ||
            fabs(layer->density / density - 1.0) > JOINED_DIFFERENCE)
            return report_failure(
                report, SONJECT_ERROR_INPUT,
                "the objects, up to %.2f m over the seabed, reach into layers of water that differ "
                "by more than 1/500 (%.1f m/s at %.2f m, %.1f m/s on average): targets must lie "
                "below the layers that refract",
                highest, layer->speed_mps, layer->bottom_m, 1.0 / slowness);
    }
    /* what is left of the highest one stays a layer */
    water->layers[within].bottom_m = highest;
    water->layers[0].bottom_m = 0.0;
    water->layers[0].speed_mps = 1.0 / slowness;
    water->layers[0].density = density;
    memmove(&water->layers[1], &water->layers[within],
            (water->count - within) * sizeof *water->layers);
    water->count -= within - 1;
    return SONJECT_OK;
}

sonject_status water_init(struct water *water, struct report *report,
                          const struct water_layer *layers, size_t count,
                          double isovelocity_speed_mps, double highest_m)
{
    const struct water_layer isovelocity = {0.0, isovelocity_speed_mps, 1.0};
    memset(water, 0, sizeof *water);
    water->count = count > 0 ? count : 1;
    water->layers = allocate_array(water->count, sizeof *water->layers);
    CHECK_MEMORY(report, water->layers, "the layers of water");
    memcpy(water->layers, count > 0 ? layers : &isovelocity, water->count * sizeof *water->layers);
    join_equals(water);
    const sonject_status status = join_below(water, report, highest_m);
    if (status != SONJECT_OK) {
        water_clear(water);
        return status;
    }
    join_equals(water);
    water->straight_speed_mps = water->layers[0].speed_mps;
    return SONJECT_OK;
}

void water_clear(struct water *water)
{
    free(water->layers);
    memset(water, 0, sizeof *water);
}

const struct water_layer *water_layer_at(const struct water *water, double height_m)
{
    size_t i = 0;
    while (i + 1 < water->count && water->layers[i + 1].bottom_m <= height_m)
        i++;
    return &water->layers[i];
}
