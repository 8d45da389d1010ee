/* Rates of the tracing kernels on the device native and on each OpenCL device, on the scenes of the
 * paper's Figures 6 and 7 in the same run. Fails only if two devices differ in a single bit. */
#include "base/system/process.h"
#include "device/backend.h"
#include "physics/bench.h"
#include "trace/chains.h"
#include "trace/fan.h"
#include "trace/glints.h"
#include "trace/rough.h"

#define REPEATS 5

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

/* Lays a capsule on a patch around 50 m. */
static void open_scene(struct bench *bench, const char *device, size_t pixels)
{
    sonject_object_params usual;
    object_init(&usual);
    bench_device = device;
    bench_open(bench, pixels, pixels, 50.0);
    sonject_object_params *capsule = bench_add(bench, SHAPE_CAPSULE, 2.3, 0.0, 0.3);
    capsule->heading_rad = 0.6;
    capsule->burial_m = 0.1;
    capsule->material = usual.material;
    bench_ready(bench);
}

static double trace_fan(struct bench *bench, struct chain_trace *trace, struct chain_fan *fan)
{
    const double start = clock_seconds();
    EXPECT_OK(&bench->report, chain_trace_strips(trace, &bench->tracer, fan, fan->strips));
    return clock_seconds() - start;
}

/* Traces fan number i of the chains, or the launch as it is. Returns the time, s. */
static double run_once(struct bench *bench, const struct program *program, uint32_t i)
{
    struct tracer *tracer = &bench->tracer;
    struct chain_fan fan;
    if (program->chains) {
        EXPECT_OK(&bench->report, chain_fan_init(&fan, tracer, &program->chains->grid, false, i));
        return trace_fan(bench, program->chains, &fan);
    }
    const double start = clock_seconds();
    EXPECT_OK(&bench->report, launch_run(program->launch, tracer));
    return clock_seconds() - start;
}

/* Returns the best rate of REPEATS runs, and the tallies of the last run. */
static struct measured time_program(struct bench *bench, const struct program *program)
{
    struct tracer *tracer = &bench->tracer;
    const device_buffer tallies = program->launch->buffers[program->tallies];
    const uint32_t fans = program->chains ? chain_fan_count(tracer) : 1;
    struct measured measured = {0.0, NULL, program->bytes};
    for (int i = 0; i < REPEATS; i++) {
        const uint64_t rays = tracer->counts.rays;
        double seconds = 0.0;
        EXPECT_OK(&bench->report,
                  buffer_clear(&bench->report, tracer->device, tallies, program->bytes));
        for (uint32_t fan = 0; fan < fans; fan++)
            seconds += run_once(bench, program, fan);
        measured.paths_per_s =
            fmax(measured.paths_per_s, (double)(tracer->counts.rays - rays) / seconds);
    }
    measured.tallies = bench_copy_buffer(bench, tallies);
    return measured;
}

static struct measured time_rough(struct bench *bench)
{
    static struct rough_trace rough;
    EXPECT_OK(&bench->report, rough_trace_begin(&rough, &bench->tracer, NULL));
    rough.launch.fan.first_strip = rough.grid.strips.first;
    rough.launch.fan.strips = rough.chunk;
    const struct program program = {
        &rough.launch, LAUNCH_TALLIES,
        (size_t)rough.chunk * (size_t)rough.grid.bins.count * sizeof(int64_t), NULL};
    const struct measured measured = time_program(bench, &program);
    rough_trace_end(&rough);
    return measured;
}

static struct measured time_glints(struct bench *bench)
{
    struct smooth_trace smooth;
    EXPECT_OK(&bench->report, smooth_trace_begin(&smooth, &bench->tracer, 0, NULL));
    smooth.launch.fan.first_strip = smooth.grid.strips.first;
    smooth.launch.fan.strips = smooth.chunk;
    const struct program program = {
        &smooth.launch, LAUNCH_TALLIES,
        2 * (size_t)smooth.chunk * (size_t)smooth.grid.bins.count * sizeof(int64_t), NULL};
    const struct measured measured = time_program(bench, &program);
    smooth_trace_end(&smooth);
    return measured;
}

static struct measured time_chains(struct bench *bench, uint32_t interactions)
{
    struct chain_trace trace;
    bench->scene.injection.interactions = interactions;
    EXPECT_OK(&bench->report, chain_trace_begin(&trace, &bench->tracer, NULL));
    const struct program program = {&trace.launch, LAUNCH_TALLIES,
                                    line_grid_cells(&trace.grid) * sizeof(int64_t), &trace};
    const struct measured measured = time_program(bench, &program);
    chain_trace_end(&trace);
    return measured;
}

static struct measured time_row(struct bench *bench, int row)
{
    return row == 0   ? time_rough(bench)
           : row == 1 ? time_glints(bench)
                      : time_chains(bench, (uint32_t)row);
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
            static struct bench bench;
            open_scene(&bench, i == 0 ? "native" : other, row < 2 ? 512 : 256);
            bench.scene.injection.ray_scale =
                row < 2 ? 16.0 : 8.0; /* so that the overhead of launches does not count */
            measured[i] = time_row(&bench, row);
            bench_close(&bench);
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
    char names[BENCH_DEVICES][128];
    const size_t count = bench_devices(names);
    int differs = 0;
    for (size_t i = 0; i < count; i++)
        if (!native_is_named(names[i]))
            differs |= compare(names[i]);
    return differs;
}
