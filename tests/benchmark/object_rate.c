/* What clutter costs: 1...1000 parts strewn over a patch, once all of one size and once all
 * together of one area. Prints a table of seconds and ns a ray: the rough part, glints, two
 * interactions, and the whole injection of these with its share of image formation. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "base/report.h"
#include "benchmark_scene.h"
#include "inject/injection.h"
#include "trace/chains.h"
#include "trace/glints.h"
#include "trace/rough.h"

#define PIXELS      512
#define SIZE_M      0.2 /* of each, where size is kept */
#define AREA_M2     4.0 /* of all together, where area is kept */
#define OBJECTS_MAX 250 /* of a scene; more parts make clusters */

/* The digits of i to a base, mirrored about the point: points that leave no gaps. */
static double mirrored_digits(uint32_t i, uint32_t base)
{
    double value = 0.0;
    double digit = 1.0;
    for (; i > 0; i /= base) {
        digit /= base;
        value += digit * (i % base);
    }
    return value;
}

static void shape_part(sonject_object_params *part, uint32_t number, double size)
{
    static const sonject_shape shapes[] = {SONJECT_SHAPE_SPHERE, SONJECT_SHAPE_CAPSULE,
                                           SONJECT_SHAPE_BOX, SONJECT_SHAPE_CYLINDER};
    sonject_object_params_init(part);
    part->shape = shapes[number % 4];
    part->length_m = 1.3 * size;
    part->width_m = 0.8 * size;
    part->height_m = 0.6 * size;
    part->diameter_m = part->shape == SONJECT_SHAPE_SPHERE ? size : 0.6 * size;
}

static void strew(struct benchmark_scene *set, uint32_t parts, double size)
{
    const uint32_t objects = parts < OBJECTS_MAX ? parts : OBJECTS_MAX;
    const uint32_t in_cluster = parts / objects;
    for (uint32_t i = 0; i < objects; i++) {
        sonject_object_params object;
        shape_part(&object, i, size);
        if (in_cluster > 1)
            object.shape = SONJECT_SHAPE_PARTS;
        object.heading_rad = 6.28 * mirrored_digits(i + 1, 5);
        object.position_kind = SONJECT_POSITION_PIXELS;
        object.position_along = PIXELS * (0.08 + 0.84 * mirrored_digits(i + 1, 2));
        object.position_range = PIXELS * (0.08 + 0.78 * mirrored_digits(i + 1, 3));
        for (uint32_t k = 0; in_cluster > 1 && k < in_cluster; k++) {
            struct scene_part part;
            memset(&part, 0, sizeof part);
            part.object = i;
            shape_part(&part.shape, i + k, size);
            part.shape.material = object.material;
            for (int axis = 0; axis < 3; axis++)
                part.axes[axis][axis] = 1.0;
            part.centre[k % 2] = (k < 2 ? -0.8 : 0.8) * size;
            if (scene_append_part(&set->scene, &set->report, &part) != SONJECT_OK)
                benchmark_fail(&set->report, "part");
        }
        if (scene_append_object(&set->scene, &set->report, &object) != SONJECT_OK)
            benchmark_fail(&set->report, "object");
    }
}

/* Of a CPU its processors' time over their number, as other programs may run too. */
static double seconds_of(const struct benchmark_scene *set)
{
    const struct device *device = set->tracer.device;
    return device->is_cpu ? (double)clock() / CLOCKS_PER_SEC / device->compute_units
                          : clock_seconds();
}

struct cost {
    double seconds, rays;
};

static void print_cost(const struct cost *cost)
{
    printf(" | %8.3f %7.1f", cost->seconds, 1e9 * cost->seconds / fmax(cost->rays, 1.0));
}

static struct cost since(double start, const struct benchmark_scene *set, uint64_t rays)
{
    const struct cost cost = {seconds_of(set) - start, (double)(set->tracer.counts.rays - rays)};
    return cost;
}

static struct cost cost_of_rough(struct benchmark_scene *set)
{
    static struct rough_trace trace;
    struct tracer *tracer = &set->tracer;
    const uint64_t rays = tracer->counts.rays;
    const double start = seconds_of(set);
    if (rough_trace_begin(&trace, tracer, NULL) != SONJECT_OK)
        benchmark_fail(&set->report, "rough part");
    float *energy = allocate_array(line_grid_cells(&trace.grid), sizeof *energy);
    if (!energy || rough_trace_strips(&trace, tracer, trace.grid.strips, energy) != SONJECT_OK)
        benchmark_fail(&set->report, "rough part");
    const struct cost cost = since(start, set, rays);
    free(energy);
    rough_trace_end(&trace);
    return cost;
}

static void trace_glints_of(struct benchmark_scene *set, uint32_t part)
{
    struct glints glints;
    if (glints_begin(&glints, &set->tracer, part) != SONJECT_OK)
        benchmark_fail(&set->report, "glints");
    const size_t chunk = (size_t)glints.chunk * (size_t)glints.grid.bins.count;
    float *field = allocate_array(2 * chunk, sizeof *field);
    const int32_t end = glints.grid.strips.first + glints.grid.strips.count;
    struct span strips = {glints.grid.strips.first, glints.chunk};
    for (; strips.first < end; strips.first += strips.count) {
        if (strips.count > end - strips.first)
            strips.count = end - strips.first;
        if (!field ||
            glints_trace(&glints, &set->tracer, strips, field, field + chunk) != SONJECT_OK)
            benchmark_fail(&set->report, "glints");
    }
    free(field);
    glints_end(&glints);
}

static struct cost cost_of_glints(struct benchmark_scene *set)
{
    const uint64_t rays = set->tracer.counts.rays;
    const double start = seconds_of(set);
    for (uint32_t i = 0; i < set->tracer.part_count; i++)
        trace_glints_of(set, i);
    return since(start, set, rays);
}

/* Fan 0 begins on the seabed, the others on the objects. */
static struct cost cost_of_chains(struct benchmark_scene *set, uint32_t first_fan, uint32_t end)
{
    struct tracer *tracer = &set->tracer;
    struct chain_trace trace;
    if (chain_trace_begin(&trace, tracer, NULL) != SONJECT_OK)
        benchmark_fail(&set->report, "chains");
    const uint64_t rays = tracer->counts.rays;
    const double start = seconds_of(set);
    for (uint32_t i = first_fan; i < end && i < chain_fan_count(tracer); i++) {
        struct chain_fan fan;
        if (chain_fan_init(&fan, tracer, &trace.grid, false, i) != SONJECT_OK ||
            chain_trace_strips(&trace, tracer, &fan, fan.strips) != SONJECT_OK)
            benchmark_fail(&set->report, "chains");
    }
    const struct cost cost = since(start, set, rays);
    chain_trace_end(&trace);
    return cost;
}

static void print_injection(struct benchmark_scene *set)
{
    struct injection_result result;
    struct injection_input input = {PIXELS, PIXELS, 0.0, 0.0, false, false, NULL, NULL};
    float *pixels = allocate_array((size_t)PIXELS * PIXELS, sizeof *pixels);
    for (size_t i = 0; pixels && i < (size_t)PIXELS * PIXELS; i++)
        pixels[i] = 1.0f;
    input.pixels = pixels;
    const double start = seconds_of(set);
    if (!pixels || injection_run(&set->report, set->tracer.device, &set->scene, &input, NULL, NULL,
                                 &result) != SONJECT_OK)
        benchmark_fail(&set->report, "injection");
    printf(" | %8.3f %8.3f %8.3f\n", seconds_of(set) - start, result.statistics.trace_s,
           result.statistics.form_s);
    injection_result_clear(&result);
    free(pixels);
}

static void print_row(uint32_t parts, double size)
{
    static struct benchmark_scene set;
    benchmark_begin(&set, PIXELS);
    strew(&set, parts, size);
    set.scene.injection.interactions = 2;
    benchmark_place(&set, PIXELS);
    cost_of_rough(&set); /* programs are built */
    const struct cost rough = cost_of_rough(&set);
    const struct cost glints = cost_of_glints(&set);
    const struct cost seabed = cost_of_chains(&set, 0, 1);
    const struct cost objects = cost_of_chains(&set, 1, UINT32_MAX);
    printf("%5u %6.3f", (unsigned)parts, size);
    print_cost(&rough);
    print_cost(&glints);
    print_cost(&seabed);
    print_cost(&objects);
    print_injection(&set);
    fflush(stdout);
    benchmark_clear(&set);
}

int main(int argc, char **argv)
{
    /* another range of numbers: from, to */
    const uint32_t least = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 1;
    const uint32_t most = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1000;
    printf("parts size m |  rough s  ns/ray | glints s  ns/ray | seabed's s   ns | objects' s   ns "
           "| inject s  trace s   form s\n");
    for (uint32_t parts = least; parts <= most; parts *= 10)
        print_row(parts, SIZE_M);
    for (uint32_t parts = least; parts <= most; parts *= 10)
        print_row(parts, sqrt(AREA_M2 / parts));
    return 0;
}
