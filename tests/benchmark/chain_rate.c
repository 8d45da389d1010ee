/* Several interactions on Figure 7's scene: the rate of the kernel on the OpenCL device beside the
 * same functions as native C (fails only if they disagree in a bit), and the noise of the
 * two-interaction energy around the target, at equal time, of the ways to find its paths. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"
#include "benchmark_scene.h"
#include "device/device.h"
#include "native_kernel.h"
#include "trace/chains.h"

#define REPEATS 5
#define SEEDS   12
#define PIXELS  256
#define CELL    8 /* bins of a resolution cell */

/* One share of a fan's strips on its own thread, with tallies of its own. */
struct share {
    const struct fan_record *fan;
    const struct chain_record *chains;
    const struct object_record *objects;
    const struct sphere_record *spheres;
    struct outcome_record *outcomes;
    int64_t *tallies;
    int first, last;
};

static void *run_share(void *argument)
{
    const struct share *share = argument;
    native_trace_chains(share->fan, share->chains, share->objects, share->spheres, share->tallies,
                        share->first, share->last, share->outcomes);
    return NULL;
}

/* Adds the tallies of all threads to `sum`; returns the seconds that the tracing took. */
static double run_native(struct share work, size_t cells, unsigned threads, int64_t *sum)
{
    struct share shares[THREADS_MAX];
    for (unsigned i = 0; i < threads; i++) {
        shares[i] = work;
        shares[i].first = (int)((long)work.fan->strips * i / threads);
        shares[i].last = (int)((long)work.fan->strips * (i + 1) / threads);
        shares[i].tallies = allocate_array(cells, sizeof(int64_t));
        if (!shares[i].tallies)
            exit(1);
    }
    const double start = clock_seconds();
    benchmark_run_threads(run_share, shares, sizeof *shares, threads);
    const double taken = clock_seconds() - start;
    for (unsigned i = 0; i < threads; i++) {
        for (size_t k = 0; k < cells; k++)
            sum[k] += shares[i].tallies[k];
        free(shares[i].tallies);
    }
    return taken;
}

static void *read_back(struct benchmark_scene *set, device_buffer buffer, size_t bytes)
{
    void *copy = malloc(bytes);
    if (!copy ||
        buffer_read(&set->report, set->tracer.device, buffer, 0, bytes, copy) != SONJECT_OK)
        benchmark_fail(&set->report, "read");
    return copy;
}

struct timing {
    double device_s, native_s, paths;
};

/* Traces all fans once on both sides, into tallies that start at 0. */
static void trace_both(struct benchmark_scene *set, struct chain_trace *trace,
                       const struct share *work, size_t cells, int64_t *native,
                       struct timing *timing)
{
    struct tracer *tracer = &set->tracer;
    memset(timing, 0, sizeof *timing);
    if (buffer_clear(&set->report, tracer->device, trace->launch.buffers[CHAIN_TALLIES],
                     cells * sizeof(int64_t)) != SONJECT_OK)
        benchmark_fail(&set->report, "clear");
    for (uint32_t i = 0; i < chain_fan_count(tracer); i++) {
        struct chain_fan fan;
        if (chain_fan_init(&fan, tracer, &trace->grid, false, i) != SONJECT_OK)
            benchmark_fail(&set->report, "fan");
        const uint64_t rays = tracer->counts.rays;
        const double start = clock_seconds();
        if (chain_trace_strips(trace, tracer, &fan, fan.strips) != SONJECT_OK)
            benchmark_fail(&set->report, "trace");
        timing->device_s += clock_seconds() - start;
        timing->paths += (double)(tracer->counts.rays - rays);
        struct share native_work = *work;
        native_work.fan = &trace->launch.fan;
        native_work.outcomes =
            allocate_array((size_t)fan.strips.count, sizeof(struct outcome_record));
        if (!native_work.outcomes)
            exit(1);
        timing->native_s +=
            run_native(native_work, cells, benchmark_threads(tracer->device), native);
        free(native_work.outcomes);
    }
}

static int compare_rates(struct benchmark_scene *set, uint32_t interactions)
{
    struct chain_trace trace;
    set->scene.injection.interactions = interactions;
    if (chain_trace_begin(&trace, &set->tracer, NULL) != SONJECT_OK)
        benchmark_fail(&set->report, "chains");
    const size_t cells = line_grid_cells(&trace.grid);
    struct chain_record *chains =
        read_back(set, trace.launch.buffers[CHAIN_RECORD], sizeof *chains);
    struct share work;
    memset(&work, 0, sizeof work);
    work.chains = chains;
    work.objects = read_back(set, trace.launch.buffers[CHAIN_OBJECTS], sizeof *work.objects);
    work.spheres = read_back(set, trace.launch.buffers[CHAIN_SPHERES],
                             (size_t)chains->spheres * sizeof *work.spheres);
    int64_t *native = allocate_array(cells, sizeof *native);
    struct timing best = {1e9, 1e9, 0.0};
    for (int i = 0; native && i < REPEATS; i++) {
        struct timing timing;
        memset(native, 0, cells * sizeof *native);
        trace_both(set, &trace, &work, cells, native, &timing);
        best.device_s = fmin(best.device_s, timing.device_s);
        best.native_s = fmin(best.native_s, timing.native_s);
        best.paths = timing.paths;
    }
    int64_t *device = read_back(set, trace.launch.buffers[CHAIN_TALLIES], cells * sizeof *device);
    const int differs = !native || memcmp(device, native, cells * sizeof *device) != 0;
    printf("%u interactions: %.1f Mpath/s on the device, %.1f Mpath/s native C, ratio %.2f; same "
           "bits: %s\n",
           (unsigned)interactions, best.paths / best.device_s / 1e6,
           best.paths / best.native_s / 1e6, best.native_s / best.device_s, differs ? "NO" : "yes");
    free(native);
    free(device);
    free(chains);
    free((void *)work.objects);
    free((void *)work.spheres);
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
    struct chain_record *chains =
        read_back(set, trace->launch.buffers[CHAIN_RECORD], sizeof *chains);
    chains->spheres = 0;
    chains->is_reciprocal = 0;
    chains->seabed_share = 0.0f;
    buffer_release(&trace->launch.buffers[CHAIN_RECORD]);
    if (buffer_create(&set->report, set->tracer.device, sizeof *chains, chains,
                      &trace->launch.buffers[CHAIN_RECORD]) != SONJECT_OK)
        benchmark_fail(&set->report, "chains");
    free(chains);
}

static double trace_once(struct benchmark_scene *set, enum search search, float *energy,
                         struct line_grid *grid)
{
    struct chain_trace trace;
    struct tracer *tracer = &set->tracer;
    if (chain_trace_begin(&trace, tracer, NULL) != SONJECT_OK)
        benchmark_fail(&set->report, "chains");
    if (search == SEARCH_COSINE)
        make_plain(set, &trace);
    *grid = trace.grid;
    double seconds = 0.0;
    const uint32_t fans = search == SEARCH_LED ? chain_fan_count(tracer) : 1;
    for (uint32_t i = 0; i < fans; i++) {
        struct chain_fan fan;
        if (chain_fan_init(&fan, tracer, &trace.grid, false, i) != SONJECT_OK)
            benchmark_fail(&set->report, "fan");
        if (search == SEARCH_COSINE)
            fan.record.only_object = -2; /* one fan for all, as the paper's */
        const double start = clock_seconds();
        if (chain_trace_strips(&trace, tracer, &fan, fan.strips) != SONJECT_OK)
            benchmark_fail(&set->report, "trace");
        seconds += clock_seconds() - start;
    }
    /* the plane of two interactions; brute force counts one interaction too */
    if (chain_trace_read(&trace, tracer, search == SEARCH_BRUTE_FORCE ? 1 : 0, energy) !=
        SONJECT_OK)
        benchmark_fail(&set->report, "read");
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
    float *energy = allocate_array(line_grid_cells(&grid), sizeof *energy);
    double *sum = allocate_array(cells, sizeof *sum);
    double *square = allocate_array(cells, sizeof *square);
    if (!energy || !sum || !square)
        exit(1);
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
    double *reference = allocate_array(line_grid_cells(&grid) / CELL, sizeof *reference);
    if (!reference)
        exit(1);
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
    benchmark_set_up(&set, PIXELS);
    printf("device: %s, %u lanes, %u cores\n", set.tracer.device->name,
           (unsigned)set.tracer.device->width, (unsigned)set.tracer.device->compute_units);
    set.scene.injection.ray_scale = 8.0; /* kernels, not launches, are what is timed */
    int differs = 0;
    for (uint32_t interactions = 2; interactions <= 3; interactions++)
        differs |= compare_rates(&set, interactions);
    compare_searches(&set);
    benchmark_clear(&set);
    return differs;
}
