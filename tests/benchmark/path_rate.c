/* Rates of the tracing kernels on the OpenCL device beside the same functions compiled as native C
 * with 16 lanes, on the same scenes (those of the paper's Figures 6 and 7) and the same number of
 * cores, in the same run; fails only if the two disagree in a single bit. And the noise of the
 * two-interaction energy around the target, at equal time, of the ways to find its paths. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/report.h"
#include "benchmark_scene.h"
#include "native_kernel.h"
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
    const char *name;
    native_program *run;
    struct launch *launch;
    size_t bytes[LAUNCH_BUFFERS_MAX]; /* of the launch's buffers */
    size_t tallies;                   /* the buffer that both sides fill, and must agree in */
    struct chain_trace *chains;       /* all of whose fans are traced; NULL: the launch's alone */
};

/* A launch on all threads, with tallies of their own. */
struct native_work {
    const struct program *program;
    void *buffers[LAUNCH_BUFFERS_MAX];
    void *tallies[THREADS_MAX];
    struct outcome_record *outcomes;
};

static void run_strips(const void *what, unsigned thread, uint32_t first, uint32_t last)
{
    const struct native_work *work = what;
    void *buffers[LAUNCH_BUFFERS_MAX];
    memcpy(buffers, work->buffers, sizeof buffers);
    buffers[work->program->tallies] = work->tallies[thread];
    work->program->run(&work->program->launch->fan, buffers, first, last, work->outcomes);
}

/* Adds the tallies of all threads to `sum`; returns the seconds that the tracing took. */
static double run_native(struct native_work *work, unsigned threads, int64_t *sum)
{
    const struct program *program = work->program;
    const uint32_t strips = (uint32_t)program->launch->fan.strips;
    const size_t cells = program->bytes[program->tallies] / sizeof *sum;
    work->outcomes = benchmark_array(strips, sizeof *work->outcomes);
    for (unsigned i = 0; i < threads; i++)
        work->tallies[i] = benchmark_array(cells, sizeof *sum);
    const double start = clock_seconds();
    benchmark_share_out(run_strips, work, threads, strips, 1);
    const double taken = clock_seconds() - start;
    for (unsigned i = 0; i < threads; i++) {
        for (size_t k = 0; k < cells; k++)
            sum[k] += ((const int64_t *)work->tallies[i])[k];
        free(work->tallies[i]);
    }
    free(work->outcomes);
    return taken;
}

static double trace_fan(struct benchmark_scene *set, struct chain_trace *trace,
                        struct chain_fan *fan)
{
    const double start = clock_seconds();
    benchmark_expect(&set->report, chain_trace_strips(trace, &set->tracer, fan, fan->strips));
    return clock_seconds() - start;
}

/* Fan number i, or the launch as it is. */
static double run_device(struct benchmark_scene *set, const struct program *program, uint32_t i)
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

/* Runs both versions REPEATS times, prints the best, and returns whether the tallies differ. */
static int compare(struct benchmark_scene *set, const struct program *program)
{
    struct tracer *tracer = &set->tracer;
    const size_t bytes = program->bytes[program->tallies];
    const device_buffer tallies = program->launch->buffers[program->tallies];
    const uint32_t fans = program->chains ? chain_fan_count(tracer) : 1;
    int64_t *native = benchmark_array(bytes, 1);
    double device_s = INFINITY, native_s = INFINITY, paths = 0.0;
    struct native_work work = {.program = program};
    for (size_t i = 0; i < program->launch->buffer_count; i++)
        if (i != program->tallies && program->bytes[i] > 0)
            work.buffers[i] = read_back(set, program->launch->buffers[i], program->bytes[i]);
    for (int i = 0; i < REPEATS; i++) {
        const uint64_t rays = tracer->counts.rays;
        double on_device = 0.0, in_c = 0.0;
        memset(native, 0, bytes);
        benchmark_expect(&set->report, buffer_clear(&set->report, tracer->device, tallies, bytes));
        for (uint32_t fan = 0; fan < fans; fan++) {
            on_device += run_device(set, program, fan);
            in_c += run_native(&work, benchmark_threads(tracer->device), native);
        }
        device_s = fmin(device_s, on_device);
        native_s = fmin(native_s, in_c);
        paths = (double)(tracer->counts.rays - rays);
    }
    int64_t *device = read_back(set, tallies, bytes);
    const int differs = memcmp(device, native, bytes) != 0;
    printf("%s: %.1f Mpath/s on the device, %.1f Mpath/s native C, ratio %.2f; same bits: %s\n",
           program->name, paths / device_s / 1e6, paths / native_s / 1e6, native_s / device_s,
           differs ? "NO" : "yes");
    for (size_t i = 0; i < LAUNCH_BUFFERS_MAX; i++)
        free(work.buffers[i]);
    free(native);
    free(device);
    return differs;
}

static int compare_single_hits(struct benchmark_scene *set)
{
    static struct rough_trace rough;
    struct smooth_trace smooth;
    benchmark_expect(&set->report, rough_trace_begin(&rough, &set->tracer, NULL));
    rough.launch.fan.first_strip = rough.grid.strips.first;
    rough.launch.fan.strips = rough.chunk;
    const size_t lines = (size_t)rough.chunk * (size_t)rough.grid.bins.count;
    const struct program seabed = {
        .name = "seabed and rough surfaces",
        .run = native_trace_rough,
        .launch = &rough.launch,
        .bytes = {sizeof(struct object_record), 0, rough.edges.count * sizeof(float),
                  lines * sizeof(int64_t), rough.tile_elements * sizeof(int64_t)},
        .tallies = ROUGH_TALLIES};
    int differs = compare(set, &seabed);
    rough_trace_end(&rough);
    benchmark_expect(&set->report, smooth_trace_begin(&smooth, &set->tracer, 0, NULL));
    smooth.launch.fan.first_strip = smooth.grid.strips.first;
    smooth.launch.fan.strips = smooth.chunk;
    const size_t cells = (size_t)smooth.chunk * (size_t)smooth.grid.bins.count;
    const struct program glints = {
        .name = "glints",
        .run = native_trace_smooth,
        .launch = &smooth.launch,
        .bytes = {sizeof(struct object_record), 2 * cells * sizeof(int64_t)},
        .tallies = SMOOTH_TALLIES};
    differs |= compare(set, &glints);
    smooth_trace_end(&smooth);
    return differs;
}

static int compare_chains(struct benchmark_scene *set, uint32_t interactions)
{
    struct chain_trace trace;
    set->scene.injection.interactions = interactions;
    benchmark_expect(&set->report, chain_trace_begin(&trace, &set->tracer, NULL));
    struct chain_record *record =
        read_back(set, trace.launch.buffers[CHAIN_RECORD], sizeof *record);
    const struct program chains = {
        .name = interactions == 2 ? "two interactions" : "three interactions",
        .run = native_trace_chains,
        .launch = &trace.launch,
        .bytes = {sizeof *record, sizeof(struct object_record),
                  record->target_words * sizeof(float) + sizeof(struct target_record), 0,
                  line_grid_cells(&trace.grid) * sizeof(int64_t)},
        .tallies = CHAIN_TALLIES,
        .chains = &trace};
    const int differs = compare(set, &chains);
    free(record);
    chain_trace_end(&trace);
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
    benchmark_set_up(&set, 512);
    set.scene.injection.ray_scale = 16.0; /* kernels, not launches, are what is timed */
    int differs = compare_single_hits(&set);
    benchmark_clear(&set);
    benchmark_set_up(&set, 256);
    set.scene.injection.ray_scale = 8.0;
    differs |= compare_chains(&set, 2);
    differs |= compare_chains(&set, 3);
    compare_searches(&set);
    benchmark_clear(&set);
    return differs;
}
