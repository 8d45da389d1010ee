/* Rates of the tracing kernels on the device native beside OpenCL's, on the same scenes (those of
 * the paper's Figures 6 and 7) in the same run; fails only if two disagree in a single bit. And the
 * noise of the two-interaction energy around the target, at equal time, of the ways to find its
 * paths. */
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

#define COSINE_RAYS_PER_BIN 4.0
#define REPEATS             5
#define SEEDS               12
#define CELL                8 /* bins of a resolution cell */

static void *read_back(struct benchmark_scene *set, device_buffer buffer, size_t bytes)
{
    void *copy = benchmark_array(bytes, 1);
    benchmark_expect(&set->report,
                     buffer_read(&set->report, set->tracer.device, buffer, 0, bytes, copy));
    return copy;
}

/* What is timed. */
struct program {
    struct launch *launch;
    size_t tallies; /* the launch's buffer, and the bytes of it */
    size_t bytes;
    struct chain_trace *chains; /* all of whose fans are traced; NULL: the launch's alone */
};

/* What a device makes of it. */
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

/* Fan number i, or the launch as it is. */
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

/* The best of REPEATS runs, and the tallies of the last. */
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

/* native beside another device, in turn; returns whether their tallies differ. */
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
                row < 2 ? 16.0 : 8.0; /* kernels are timed, not launches */
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

/* How paths are looked for. */
enum search {
    SEARCH_LED,        /* from the seabed to the target on purpose, one way for both */
    SEARCH_COSINE,     /* plain cosine sampling, every hit connected to the source */
    SEARCH_BRUTE_FORCE /* the paper's */
};

struct noise {
    double relative_variance; /* of a cell's energy over the square of its mean, on average */
    double seconds;           /* a trace */
    double energy;            /* all of it, m^2 */
};

/* Turns what the library would do into plain cosine sampling. */
static void make_plain(struct benchmark_scene *set, struct chain_trace *trace)
{
    const device_buffer buffer = trace->launch.buffers[CHAIN_RECORD];
    struct chain_record *chains = read_back(set, buffer, sizeof *chains);
    chains->spheres = 0;
    chains->is_reciprocal = 0;
    chains->seabed_share = 0.0f;
    benchmark_expect(&set->report, buffer_write(&set->report, set->tracer.device, buffer, 0,
                                                sizeof *chains, chains));
    free(chains);
}

static double trace_once(struct benchmark_scene *set, enum search search, float *energy,
                         struct line_grid *grid)
{
    struct chain_trace trace;
    struct tracer *tracer = &set->tracer;
    double seconds = 0.0;
    benchmark_expect(&set->report, chain_trace_begin(&trace, tracer, NULL));
    if (search == SEARCH_COSINE)
        make_plain(set, &trace);
    *grid = trace.grid;
    const uint32_t fans = search == SEARCH_LED ? chain_fan_count(tracer) : 1;
    for (uint32_t i = 0; i < fans; i++) {
        struct chain_fan fan;
        benchmark_expect(&set->report, chain_fan_init(&fan, tracer, &trace.grid, false, i));
        if (search == SEARCH_COSINE) { /* one fan for all, as the paper's */
            benchmark_expect(&set->report, patch_fan_init(&fan.record, tracer, &trace.grid, false,
                                                          COSINE_RAYS_PER_BIN));
            fan.strips = trace.grid.strips;
            fan.record.only_object = -2;
        }
        seconds += trace_fan(set, &trace, &fan);
    }
    /* the plane of two interactions; brute force counts one interaction too */
    benchmark_expect(&set->report, chain_trace_read(&trace, tracer,
                                                    search == SEARCH_BRUTE_FORCE ? 1 : 0, energy));
    chain_trace_end(&trace);
    return seconds;
}

/* Adds a trace's energies to sums over resolution cells. */
static void add_cells(const struct line_grid *grid, const float *energy, double *sum,
                      double *square)
{
    for (size_t cell = 0; cell < line_grid_cells(grid) / CELL; cell++) {
        double value = 0.0;
        for (size_t k = 0; k < CELL; k++)
            value += (double)energy[cell * CELL + k];
        sum[cell] += value;
        square[cell] += value * value;
    }
}

/* Cells around the target that matter: where the led search finds at least a thousandth of its
 * brightest cell. The noise is that of each cell against its mean by that search, which is left in
 * `reference` (0: does not matter). */
static struct noise measure(struct benchmark_scene *set, enum search search, double *reference)
{
    struct noise noise = {0.0, 0.0, 0.0};
    struct line_grid grid;
    line_grid_for_patch(&grid, &set->tracer.view, &set->tracer.response);
    const size_t cells = line_grid_cells(&grid) / CELL;
    float *energy = benchmark_array(line_grid_cells(&grid), sizeof *energy);
    double *sum = benchmark_array(cells, sizeof *sum);
    double *square = benchmark_array(cells, sizeof *square);
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        set->scene.injection.seed = 1 + seed;
        noise.seconds += trace_once(set, search, energy, &grid) / SEEDS;
        add_cells(&grid, energy, sum, square);
    }
    double most = 0.0;
    for (size_t i = 0; i < cells; i++)
        most = fmax(most, sum[i]);
    size_t counted = 0;
    for (size_t i = 0; i < cells; i++) {
        const double mean = sum[i] / SEEDS;
        if (search == SEARCH_LED)
            reference[i] = sum[i] > 0.001 * most ? mean : 0.0;
        noise.energy += mean;
        if (reference[i] == 0.0)
            continue;
        noise.relative_variance +=
            (square[i] / SEEDS - mean * mean) / (reference[i] * reference[i]) * SEEDS / (SEEDS - 1);
        counted++;
    }
    noise.relative_variance /= (double)counted;
    free(energy);
    free(sum);
    free(square);
    return noise;
}

static void print_gain(const char *what, const struct noise *slow, const struct noise *fast)
{
    printf(
        "%s: %.3g times the variance at equal time (rms %.1f %% in %.3f s against %.1f %% in %.3f "
        "s; energies %.4g and %.4g m2)\n",
        what, slow->relative_variance * slow->seconds / (fast->relative_variance * fast->seconds),
        100.0 * sqrt(slow->relative_variance), slow->seconds, 100.0 * sqrt(fast->relative_variance),
        fast->seconds, slow->energy, fast->energy);
}

static void compare_searches(struct benchmark_scene *set)
{
    struct line_grid grid;
    sonject_injection_params *injection = &set->scene.injection;
    line_grid_for_patch(&grid, &set->tracer.view, &set->tracer.response);
    double *reference = benchmark_array(line_grid_cells(&grid) / CELL, sizeof *reference);
    injection->interactions = 2;
    set->scene.objects[0].material.reflection = 0.0; /* Lambert's law, as the paper's */
    injection->ray_scale = 1.0;
    const struct noise led = measure(set, SEARCH_LED, reference);
    const struct noise cosine = measure(set, SEARCH_COSINE, reference);
    print_gain("plain cosine sampling", &cosine, &led);
    set->scene.sonar.transducer_side_m = 8.0;
    injection->column_rule = SONJECT_COLUMNS_PAPER;
    const struct noise connected = measure(set, SEARCH_LED, reference);
    injection->estimator = SONJECT_ESTIMATOR_BRUTE_FORCE;
    injection->mode = SONJECT_MODE_RESYNTHESISE;
    injection->order_energies = 1;
    const struct noise brute = measure(set, SEARCH_BRUTE_FORCE, reference);
    print_gain("brute force into a source of 8 m x 8 m", &brute, &connected);
    free(reference);
}

int main(void)
{
    static struct benchmark_scene set;
    static char names[BENCHMARK_DEVICES][128];
    const size_t count = benchmark_opencl_devices(names);
    int differs = 0;
    for (size_t i = 0; i < count; i++)
        differs |= compare(names[i]);
    benchmark_set_up(&set, NULL, 256);
    set.scene.injection.ray_scale = 8.0;
    compare_searches(&set);
    benchmark_clear(&set);
    return differs;
}
