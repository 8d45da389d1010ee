/* Rates of the tracing kernels on the device native and on each OpenCL device, on the scenes of the
 * paper's Figures 6 and 7 in the same run. Fails only if two devices differ in a single bit. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/report.h"
#include "base/system/process.h"
#include "benchmark_scene.h"
#include "trace/chains.h"
#include "trace/fan.h"
#include "trace/glints.h"
#include "trace/rough.h"

#define REPEATS 5

static void *read_back(struct benchmark_scene *set, device_buffer buffer, size_t bytes)
{
    void *copy = benchmark_array(bytes, 1);
    benchmark_expect(&set->report,
                     buffer_read(&set->report, set->tracer.device, buffer, 0, bytes, copy));
    return copy;
}

/* The launch that is timed. */
struct program {
    struct launch *launch;
    size_t tallies; /* number of the launch's buffer, and the buffer's size */
    size_t bytes;
    struct chain_trace *chains; /* all its fans are traced; NULL: the launch's fan alone */
};

/* A device's rate and tallies. */
struct measured {
    double paths_per_s;
    int64_t *tallies;
    size_t bytes;
};

static double trace_fan(struct benchmark_scene *set, struct chain_trace *trace,
                        struct chain_fan *fan)
{
    const double start = clock_seconds();
    benchmark_expect(&set->report, chain_trace_strips(trace, &set->tracer, fan, fan->strips));
    return clock_seconds() - start;
}

/* Traces fan number i of the chains, or the launch as it is. Returns the time, s. */
static double run_once(struct benchmark_scene *set, const struct program *program, uint32_t i)
{
    struct tracer *tracer = &set->tracer;
    struct chain_fan fan;
    if (program->chains) {
        benchmark_expect(&set->report,
                         chain_fan_init(&fan, tracer, &program->chains->grid, false, i));
        return trace_fan(set, program->chains, &fan);
    }
    const double start = clock_seconds();
    benchmark_expect(&set->report, launch_run(program->launch, tracer));
    return clock_seconds() - start;
}

/* Returns the best rate of REPEATS runs, and the tallies of the last run. */
static struct measured time_program(struct benchmark_scene *set, const struct program *program)
{
    struct tracer *tracer = &set->tracer;
    const device_buffer tallies = program->launch->buffers[program->tallies];
    const uint32_t fans = program->chains ? chain_fan_count(tracer) : 1;
    struct measured measured = {0.0, NULL, program->bytes};
    for (int i = 0; i < REPEATS; i++) {
        const uint64_t rays = tracer->counts.rays;
        double seconds = 0.0;
        benchmark_expect(&set->report,
                         buffer_clear(&set->report, tracer->device, tallies, program->bytes));
        for (uint32_t fan = 0; fan < fans; fan++)
            seconds += run_once(set, program, fan);
        measured.paths_per_s =
            fmax(measured.paths_per_s, (double)(tracer->counts.rays - rays) / seconds);
    }
    measured.tallies = read_back(set, tallies, program->bytes);
    return measured;
}

static struct measured time_rough(struct benchmark_scene *set)
{
    static struct rough_trace rough;
    benchmark_expect(&set->report, rough_trace_begin(&rough, &set->tracer, NULL));
    rough.launch.fan.first_strip = rough.grid.strips.first;
    rough.launch.fan.strips = rough.chunk;
    const struct program program = {
        &rough.launch, ROUGH_TALLIES,
        (size_t)rough.chunk * (size_t)rough.grid.bins.count * sizeof(int64_t), NULL};
    const struct measured measured = time_program(set, &program);
    rough_trace_end(&rough);
    return measured;
}

static struct measured time_glints(struct benchmark_scene *set)
{
    struct smooth_trace smooth;
    benchmark_expect(&set->report, smooth_trace_begin(&smooth, &set->tracer, 0, NULL));
    smooth.launch.fan.first_strip = smooth.grid.strips.first;
    smooth.launch.fan.strips = smooth.chunk;
    const struct program program = {
        &smooth.launch, SMOOTH_TALLIES,
        2 * (size_t)smooth.chunk * (size_t)smooth.grid.bins.count * sizeof(int64_t), NULL};
    const struct measured measured = time_program(set, &program);
    smooth_trace_end(&smooth);
    return measured;
}

static struct measured time_chains(struct benchmark_scene *set, uint32_t interactions)
{
    struct chain_trace trace;
    set->scene.injection.interactions = interactions;
    benchmark_expect(&set->report, chain_trace_begin(&trace, &set->tracer, NULL));
    const struct program program = {&trace.launch, CHAIN_TALLIES,
                                    line_grid_cells(&trace.grid) * sizeof(int64_t), &trace};
    const struct measured measured = time_program(set, &program);
    chain_trace_end(&trace);
    return measured;
}

static struct measured time_row(struct benchmark_scene *set, int row)
{
    return row == 0   ? time_rough(set)
           : row == 1 ? time_glints(set)
                      : time_chains(set, (uint32_t)row);
}

/* Times native and another device in turn. Returns whether their tallies differ. */
static int compare(const char *other)
{
    static const char *const names[] = {"seabed and rough surfaces", "glints", "two interactions",
                                        "three interactions"};
    int differs = 0;
    printf("%s:\n", other);
    for (int row = 0; row < 4; row++) {
        struct measured measured[2];
        for (int i = 0; i < 2; i++) {
            static struct benchmark_scene set;
            benchmark_set_up(&set, i == 0 ? "native" : other, row < 2 ? 512 : 256);
            set.scene.injection.ray_scale =
                row < 2 ? 16.0 : 8.0; /* so that the overhead of launches does not count */
            measured[i] = time_row(&set, row);
            benchmark_clear(&set);
        }
        const int is_other =
            measured[0].bytes != measured[1].bytes ||
            memcmp(measured[0].tallies, measured[1].tallies, measured[0].bytes) != 0;
        printf("%s: %.1f Mpath/s native, %.1f Mpath/s there, ratio %.2f; same bits: %s\n",
               names[row], measured[0].paths_per_s / 1e6, measured[1].paths_per_s / 1e6,
               measured[0].paths_per_s / measured[1].paths_per_s, is_other ? "NO" : "yes");
        differs |= is_other;
        free(measured[0].tallies);
        free(measured[1].tallies);
    }
    return differs;
}

int main(void)
{
    static char names[BENCHMARK_DEVICES][128];
    const size_t count = benchmark_opencl_devices(names);
    int differs = 0;
    for (size_t i = 0; i < count; i++)
        differs |= compare(names[i]);
    return differs;
}
