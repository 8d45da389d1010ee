#include "reference_layers.h"

#include <math.h>

/* The heights between which the sound runs, from mirror to mirror. */
struct ascents {
    double from[REFERENCE_BOUNCES_MAX + 1], to[REFERENCE_BOUNCES_MAX + 1];
    size_t count;
};

static struct ascents ascents_of(const struct reference_way *way, double height)
{
    struct ascents ascents;
    /* mirrors take turns, so the last one tells the first */
    bool is_seabed = way->bounces % 2 == 1 ? way->comes_from_seabed : !way->comes_from_seabed;
    double here = way->sonar_height;
    ascents.count = 0;
    for (uint32_t i = 0; i < way->bounces; i++, is_seabed = !is_seabed) {
        ascents.from[ascents.count] = here;
        here = is_seabed ? 0.0 : way->depth;
        ascents.to[ascents.count++] = here;
    }
    ascents.from[ascents.count] = here;
    ascents.to[ascents.count++] = height;
    return ascents;
}

long double reference_crossed(const struct reference_way *way, size_t layer, double height)
{
    const struct ascents ascents = ascents_of(way, height);
    const double bottom = way->layers[layer].bottom_m;
    const double top = layer + 1 < way->count ? way->layers[layer + 1].bottom_m : HUGE_VAL;
    long double sum = 0.0L;
    for (size_t i = 0; i < ascents.count; i++) {
        const double low = fmax(bottom, fmin(ascents.from[i], ascents.to[i]));
        const double high = fmin(top, fmax(ascents.from[i], ascents.to[i]));
        sum += high > low ? (long double)high - (long double)low : 0.0L;
    }
    return sum;
}

struct reference_ray reference_sum(const struct reference_way *way, double height, long double p)
{
    struct reference_ray sum = {0.0L, 0.0L, 0.0L, 0.0L};
    for (size_t i = 0; i < way->count; i++) {
        const long double h = reference_crossed(way, i, height);
        if (h == 0.0L)
            continue;
        const long double c = way->layers[i].speed_mps;
        const long double sine = sqrtl((1.0L - p * c) * (1.0L + p * c));
        sum.range += h * p * c / sine;
        sum.time += h / (c * sine);
        sum.length += h / sine;
        sum.growth += h * c / (sine * sine * sine);
    }
    return sum;
}

double reference_speed_at(const struct reference_way *way, double height)
{
    size_t i = way->count - 1;
    while (i > 0 && way->layers[i].bottom_m > height)
        i--;
    return way->layers[i].speed_mps;
}

double reference_fastest(const struct reference_way *way, double height)
{
    double speed = 0.0;
    for (size_t i = 0; i < way->count; i++)
        if (reference_crossed(way, i, height) > 0.0L)
            speed = fmax(speed, way->layers[i].speed_mps);
    return speed;
}

/* Finds p by bisection. Range and time both grow with p. */
static long double bisect(const struct reference_way *way, double height, long double wanted,
                          bool is_time)
{
    long double low = 0.0L;
    long double high = 1.0L / reference_fastest(way, height);
    for (int i = 0; i < 80; i++) {
        const long double p = 0.5L * (low + high);
        const struct reference_ray sum = reference_sum(way, height, p);
        *((is_time ? sum.time : sum.range) < wanted ? &low : &high) = p;
    }
    return 0.5L * (low + high);
}

long double reference_parameter(const struct reference_way *way, double range, double height)
{
    return bisect(way, height, range, false);
}

long double reference_parameter_of_time(const struct reference_way *way, long double time)
{
    return bisect(way, 0.0, time, true);
}

struct reference_sound reference_sound_at(const struct reference_way *way, double range,
                                          double height)
{
    const long double p = reference_parameter(way, range, height);
    const struct reference_ray ray = reference_sum(way, height, p);
    const long double there = p * (long double)way->layers[0].speed_mps;
    const long double here = p * (long double)reference_speed_at(way, way->sonar_height);
    const long double sine_there = sqrtl(1.0L - there * there);
    const long double sine_here = sqrtl(1.0L - here * here);
    struct reference_sound sound;
    sound.time = (double)ray.time;
    sound.grazing = (double)acosl(there) * (way->bounces > 0 && way->comes_from_seabed ? -1 : 1);
    /* dp = sin/c d(angle) at both ends */
    const long double turn_there = sine_there / (long double)way->layers[0].speed_mps;
    const long double turn_here =
        sine_here / (long double)reference_speed_at(way, way->sonar_height);
    sound.wavefront = (double)(sine_there * ray.growth * turn_there);
    sound.out = (double)(here / (ray.range * sine_there * ray.growth * turn_here));
    sound.home = (double)(there / (ray.range * sine_here * ray.growth * turn_there));
    return sound;
}
