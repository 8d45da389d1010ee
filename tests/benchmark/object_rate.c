/* The cost of clutter: 1...1000 parts strewn over a patch, once with one size for each part and
 * once with one area for all together. Prints a table: ns per ray of the rough part and of two
 * interactions; seconds of the whole injection, of its tracing and of its image formation. */
#include <time.h>

#include "base/system/process.h"
#include "inject/injection.h"
#include "physics/bench.h"

#define PIXELS      512
#define SIZE_M      0.2 /* size of each part, in the rows of one size */
#define AREA_M2     4.0 /* area of all parts, in the rows of one area */
#define OBJECTS_MAX 250 /* most objects of a scene; more parts make clusters */

/* Returns the radical inverse of i: its digits to a base, mirrored about the point. */
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
    static const enum shape_kind shapes[] = {SHAPE_SPHERE, SHAPE_CAPSULE, SHAPE_BOX,
                                             SHAPE_CYLINDER};
    object_init(part);
    part->shape = shapes[number % 4];
    part->length_m = 1.3 * size;
    part->width_m = 0.8 * size;
    part->height_m = 0.6 * size;
    part->diameter_m = part->shape == SHAPE_SPHERE ? size : 0.6 * size;
}

static void strew(struct bench *bench, uint32_t parts, double size)
{
    const uint32_t objects = parts < OBJECTS_MAX ? parts : OBJECTS_MAX;
    const uint32_t in_cluster = parts / objects;
    for (uint32_t i = 0; i < objects; i++) {
        sonject_object_params object;
        shape_part(&object, i, size);
        if (in_cluster > 1)
            object.shape = SHAPE_PARTS;
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
            EXPECT_OK(&bench->report, scene_append_part(&bench->scene, &bench->report, &part));
        }
        EXPECT_OK(&bench->report, scene_append_object(&bench->scene, &bench->report, &object));
    }
}

/* Returns the clock's time, s. On a CPU it is the processors' time over their number, since other
 * programs may run, too. */
static double seconds_of(const struct bench *bench)
{
    const struct device *device = bench->tracer.device;
    return device->is_cpu ? (double)clock() / CLOCKS_PER_SEC / device->compute_units
                          : clock_seconds();
}

static double ns_of_rough_rays(struct bench *bench)
{
    static struct rough_trace trace;
    struct tracer *tracer = &bench->tracer;
    const uint64_t rays = tracer->counts.rays;
    const double start = seconds_of(bench);
    EXPECT_OK(&bench->report, rough_trace_begin(&trace, tracer, NULL));
    const struct span strips = {trace.grid.strips.first, trace.chunk};
    float *energy = zeroed(line_grid_cells(&trace.grid), sizeof *energy);
    EXPECT_OK(&bench->report, rough_trace_strips(&trace, tracer, strips, energy));
    const double taken = seconds_of(bench) - start;
    free(energy);
    rough_trace_end(&trace);
    return 1e9 * taken / (double)(tracer->counts.rays - rays);
}

/* Returns the time per ray of two interactions, over all fans and samples. */
static double ns_of_chains(struct bench *bench)
{
    struct tracer *tracer = &bench->tracer;
    struct chain_trace trace;
    struct chain_fan fan;
    EXPECT_OK(&bench->report, chain_trace_begin(&trace, tracer, NULL));
    const uint64_t rays = tracer->counts.rays;
    const double start = seconds_of(bench);
    for (uint32_t i = 0; i < chain_fan_count(tracer); i++) {
        EXPECT_OK(&bench->report, chain_fan_init(&fan, tracer, &trace.grid, false, i));
        if (fan.strips.count > 0)
            EXPECT_OK(&bench->report, chain_trace_strips(&trace, tracer, &fan, fan.strips));
    }
    const double taken = seconds_of(bench) - start;
    chain_trace_end(&trace);
    return 1e9 * taken / (double)(tracer->counts.rays - rays);
}

static void print_injection(struct bench *bench)
{
    struct injection_result result;
    static float pixels[PIXELS * PIXELS];
    const struct injection_input input = {.rows = PIXELS, .columns = PIXELS, .pixels = pixels};
    for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++)
        pixels[i] = 1.0f;
    const double start = seconds_of(bench);
    EXPECT_OK(&bench->report, injection_run(&bench->report, bench->tracer.device, &bench->scene,
                                            &input, NULL, NULL, &result));
    printf(" | %8.3f %8.3f %8.3f\n", seconds_of(bench) - start, result.statistics.trace_s,
           result.statistics.form_s);
    injection_result_clear(&result);
}

static void print_row(uint32_t parts, double size)
{
    static struct bench bench;
    bench_open(&bench, PIXELS, PIXELS, 50.0);
    strew(&bench, parts, size);
    bench.scene.injection.interactions = 2;
    bench_ready(&bench);
    ns_of_rough_rays(&bench); /* builds the programs */
    printf("%5u %6.3f | %7.1f", (unsigned)parts, size, ns_of_rough_rays(&bench));
    printf(" | %9.1f", ns_of_chains(&bench));
    print_injection(&bench);
    fflush(stdout);
    bench_close(&bench);
}

int main(int argc, char **argv)
{
    /* arguments: another range of the number of parts */
    const uint32_t least = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 1;
    const uint32_t most = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1000;
    printf("parts size m |  ns/ray |  ns/chain | inject s  trace s   form s\n");
    for (uint32_t parts = least; parts <= most; parts *= 10)
        print_row(parts, SIZE_M);
    for (uint32_t parts = least; parts <= most; parts *= 10)
        print_row(parts, sqrt(AREA_M2 / parts));
    return 0;
}
