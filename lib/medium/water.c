/* Layers of water, and absorption by Francois and Garrison's formula (J. Acoust. Soc. Am. 72, 1982:
 * part I, page 896, pure water and magnesium sulphate; part II, page 1879, boric acid and the
 * total). Frequencies are in kHz and absorption in dB/km, as in the papers. */
#include "medium/water.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/scene.h>

#include "base/memory.h"
#include "base/report.h"

#define STEPS_PER_SPEED     20000.0
#define KELVIN_AT_0_CELSIUS 273.0 /* the papers' own, without the 0.15 */
#define JOINED_DIFFERENCE   0.002 /* relative, of layers that become the straight water */
/* The largest relative difference of sound speeds in a slice, and error of the way straight up.
 * Levels depend on half the former over the square of the tangent of the grazing angle. */
#define SLICE_DIFFERENCE 3.0e-5
#define SLICE_ERROR_M    5.0e-6

struct stack {
    struct water_layer *layers; /* room for WATER_LAYERS_MAX */
    size_t count;
    bool is_full; /* room was wanted for another layer */
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

/* Adds the layers of a linear piece; low >= 0. */
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
                              "needs more than %d layers; take fewer samples, or layers",
                              WATER_LAYERS_MAX);
    }
    *layers = stack.layers;
    *layer_count = stack.count;
    return SONJECT_OK;
}

/* Returns the absorption of a substance that follows the pressure late, for unit strength. */
static double relaxation(double frequency, double relaxation_frequency)
{
    const double square = frequency * frequency;
    return relaxation_frequency * square / (relaxation_frequency * relaxation_frequency + square);
}

static double sound_speed(const struct sea_water *water)
{
    return 1412.0 + 3.21 * water->temperature_celsius + 1.19 * water->salinity_permille +
           0.0167 * water->depth_m;
}

static double boric_acid(const struct sea_water *water, double frequency)
{
    const double kelvin = KELVIN_AT_0_CELSIUS + water->temperature_celsius;
    const double strength = 8.86 / sound_speed(water) * pow(10.0, 0.78 * water->ph - 5.0);
    const double relaxation_frequency =
        2.8 * sqrt(water->salinity_permille / 35.0) * pow(10.0, 4.0 - 1245.0 / kelvin);
    return strength * relaxation(frequency, relaxation_frequency);
}

static double magnesium_sulphate(const struct sea_water *water, double frequency)
{
    const double kelvin = KELVIN_AT_0_CELSIUS + water->temperature_celsius;
    const double strength = 21.44 * water->salinity_permille / sound_speed(water) *
                            (1.0 + 0.025 * water->temperature_celsius);
    const double pressure = 1.0 + water->depth_m * (-1.37e-4 + water->depth_m * 6.2e-9);
    const double relaxation_frequency = 8.17 * pow(10.0, 8.0 - 1990.0 / kelvin) /
                                        (1.0 + 0.0018 * (water->salinity_permille - 35.0));
    return strength * pressure * relaxation(frequency, relaxation_frequency);
}

static double pure_water(const struct sea_water *water, double frequency)
{
    const double t = water->temperature_celsius;
    const double strength = t <= 20.0 ? 4.937e-4 + t * (-2.59e-5 + t * (9.11e-7 - t * 1.50e-8))
                                      : 3.964e-4 + t * (-1.146e-5 + t * (1.45e-7 - t * 6.5e-10));
    const double pressure = 1.0 + water->depth_m * (-3.83e-5 + water->depth_m * 4.9e-10);
    return strength * pressure * frequency * frequency;
}

static bool is_within(double value, double least, double most)
{
    return value >= least && value <= most;
}

double sonject_absorption(double frequency_hz, double temperature_celsius, double salinity_permille,
                          double depth_m, double ph)
{
    const struct sea_water water = {temperature_celsius, salinity_permille, depth_m, ph};
    const double frequency = frequency_hz / 1e3;
    if (!is_within(frequency_hz, ABSORPTION_FREQUENCY_MIN_HZ, ABSORPTION_FREQUENCY_MAX_HZ) ||
        !is_within(temperature_celsius, -2.0, 30.0) || !is_within(salinity_permille, 0.0, 40.0) ||
        !is_within(depth_m, 0.0, 5000.0) || !is_within(ph, 7.0, 9.0))
        return NAN;
    return (boric_acid(&water, frequency) + magnesium_sulphate(&water, frequency) +
            pure_water(&water, frequency)) /
           1e3;
}

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

/* Returns the height, m, over which layer i overlaps with [low, high]. */
static double overlap(const struct water *water, size_t i, double low, double high)
{
    const double bottom = fmax(water->layers[i].bottom_m, low);
    const double top = i + 1 < water->count ? fmin(water->layers[i + 1].bottom_m, high) : high;
    return fmax(0.0, top - bottom);
}

/* Joins all layers below `highest` into one. */
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
                "layers of water that differ by more than 1/500 (%.1f m/s at %.2f m, %.1f m/s on "
                "average) begin below %.2f m over the seabed: remove what needs one sound speed up "
                "to there (seabed.relief, or objects with injection.interactions above 1, "
                "sonar.transducer or a top over the sonar), or let the layers begin higher",
                layer->speed_mps, layer->bottom_m, 1.0 / slowness, highest);
    }
    /* the rest of the highest one stays a layer */
    water->layers[within].bottom_m = highest;
    water->layers[0].bottom_m = 0.0;
    water->layers[0].speed_mps = 1.0 / slowness;
    water->layers[0].density = density;
    memmove(&water->layers[1], &water->layers[within],
            (water->count - within) * sizeof *water->layers);
    water->count -= within - 1;
    return SONJECT_OK;
}

/* Returns the mean slowness of the first layers. */
static double mean_slowness(const struct water_layer *layers, size_t count)
{
    double time = 0.0;
    for (size_t i = 0; i < count; i++)
        time += (layers[i + 1].bottom_m - layers[i].bottom_m) / layers[i].speed_mps;
    return time / (layers[count].bottom_m - layers[0].bottom_m);
}

/* Returns whether the first layers may be one slice. */
static bool are_near(const struct water_layer *layers, size_t count)
{
    const double slowness = mean_slowness(layers, count);
    double lead = 0.0; /* lead of the way straight up to a layer's top, m */
    for (size_t i = 0; i < count; i++) {
        const double excess = 1.0 / (layers[i].speed_mps * slowness) - 1.0;
        lead += (layers[i + 1].bottom_m - layers[i].bottom_m) * excess;
        if (fabs(excess) > SLICE_DIFFERENCE || fabs(lead) > SLICE_ERROR_M ||
            layers[i].density != layers[0].density)
            return false;
    }
    return true;
}

/* Joins layers that begin below a height into slices, from the seabed upwards. */
static void slice_below(struct water *water, double highest)
{
    struct water_layer *layers = water->layers;
    size_t kept = 0;
    water->slices = 1;
    for (size_t first = 0, end; first < water->count; first = end) {
        struct water_layer slice = layers[first];
        end = first + 1;
        while (end + 1 < water->count && layers[end].bottom_m < highest &&
               are_near(&layers[first], end + 1 - first))
            end++;
        if (end > first + 1)
            slice.speed_mps = 1.0 / mean_slowness(&layers[first], end - first);
        if (slice.bottom_m < highest)
            water->slices = kept + 1;
        layers[kept++] = slice;
    }
    water->count = kept;
}

sonject_status water_init(struct water *water, struct report *report,
                          const struct water_layer *layers, size_t count,
                          double isovelocity_speed_mps, double straight_m, double sliced_m)
{
    const struct water_layer isovelocity = {0.0, isovelocity_speed_mps, 1.0};
    memset(water, 0, sizeof *water);
    water->count = count > 0 ? count : 1;
    water->layers = allocate_array(water->count, sizeof *water->layers);
    CHECK_MEMORY(report, water->layers, "the layers of water");
    memcpy(water->layers, count > 0 ? layers : &isovelocity, water->count * sizeof *water->layers);
    join_equals(water);
    const sonject_status status = join_below(water, report, straight_m);
    if (status != SONJECT_OK) {
        water_clear(water);
        return status;
    }
    join_equals(water);
    slice_below(water, sliced_m);
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
