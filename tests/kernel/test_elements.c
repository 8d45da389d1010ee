/* Element level: the same bits at every width and number of work-items, and series that are what
 * the formula of kernels/MATH.md gives in double precision. */
#include "claims.h"
#include "element_series.h"

#include "device/device.h"
#include "elements/elements.h"
#include "physics/bench.h"

#define STRIPS   40
#define IMPULSES 3000
#define ROOM     16 /* behind impulses */
#define PAIRS    6
#define SAMPLES  5000
#define FINE     3
#define TAPS     101
#define OUT      ((SAMPLES - TAPS) / FINE / 16 * 16)

/* Uniform in -1...1. */
static float random_number(uint64_t *state)
{
    return (float)((double)(next_random(state) >> 40) / 8388608.0 - 1.0);
}

/* Everything that the two kernels take. */
struct workload {
    struct impulse_grid_record grid;
    struct element_pair_record pairs[PAIRS];
    int32_t starts[STRIPS + 1], bins[IMPULSES + ROOM];
    float impulses_real[IMPULSES + ROOM], impulses_imaginary[IMPULSES + ROOM];
    float pulse_real[TAPS], pulse_imaginary[TAPS];
};

struct lines {
    float line_real[PAIRS][SAMPLES], line_imaginary[PAIRS][SAMPLES];
    float out_real[PAIRS][OUT], out_imaginary[PAIRS][OUT];
};

/* Impulses on both sides of the window, and elements of both sides of the strips. */
static void fill_workload(struct workload *work)
{
    uint64_t state = 1;
    memset(work, 0, sizeof *work);
    work->grid.strip_width = 3.75e-3f;
    work->grid.bin_width = 9.4e-4f;
    work->grid.reference_range = 40.0f;
    work->grid.first_strip = -7;
    work->grid.strips = STRIPS;
    work->grid.largest_range = 42.0f;
    work->grid.cycles_per_metre = 66.7f;
    work->grid.samples_per_metre = 533.0f;
    work->grid.first_sample = 250.0f;
    work->grid.transmitter_cycles = 1.7f;
    work->grid.hydrophone_cycles = 3.3f;
    work->grid.largest_slope_squared = 0.02f;
    work->grid.samples = SAMPLES;
    for (int i = 0; i < PAIRS; i++) {
        work->pairs[i].transmitter_strip = 450 * i - 1000;
        work->pairs[i].transmitter_fraction = 0.5f + 0.5f * random_number(&state);
        work->pairs[i].hydrophone_strip = 300 * i - 500;
        work->pairs[i].hydrophone_fraction = 0.5f + 0.5f * random_number(&state);
    }
    for (int strip = 0; strip <= STRIPS; strip++) /* the first strips have none */
        work->starts[strip] = strip < 3 ? 0 : IMPULSES * (strip - 2) / (STRIPS - 2);
    for (int strip = 0; strip < STRIPS; strip++)
        for (int i = work->starts[strip]; i < work->starts[strip + 1]; i++) {
            work->bins[i] = -600 + 73 * (i - work->starts[strip]) + i % 5;
            work->impulses_real[i] = random_number(&state);
            work->impulses_imaginary[i] = random_number(&state);
        }
    for (int tap = 0; tap < TAPS; tap++) {
        work->pulse_real[tap] = random_number(&state);
        work->pulse_imaginary[tap] = random_number(&state);
    }
}

static void compute_as_c(struct workload *work, struct lines *lines)
{
    memset(lines, 0, sizeof *lines);
    work->grid.segments = 1;
    for (int i = 0; i < PAIRS; i++) {
        hear_grid(&work->grid, &work->pairs[i], work->starts, work->bins, work->impulses_real,
                  work->impulses_imaginary, 0, lines->line_real[i], lines->line_imaginary[i]);
        for (int sample = 0; sample < OUT; sample++)
            pulse_series(lines->line_real[i], lines->line_imaginary[i], FINE, work->pulse_real,
                         work->pulse_imaginary, TAPS, sample, lines->out_real[i],
                         lines->out_imaginary[i]);
    }
}

static void expect_ok(struct bench *bench, sonject_status status)
{
    EXPECT_OK(&bench->report, status);
}

static device_buffer buffer_of(struct bench *bench, size_t bytes, const void *contents)
{
    device_buffer buffer;
    expect_ok(bench, buffer_create(&bench->report, bench->tracer.device, bytes, contents, &buffer));
    return buffer;
}

static device_kernel kernel_of(struct bench *bench, const char *name)
{
    device_kernel kernel;
    expect_ok(bench, kernel_create(&bench->report, bench->tracer.device, PROGRAM_ELEMENT_SERIES,
                                   PROGRAM_PLAIN, name, &kernel));
    return kernel;
}

static void read_and_release(struct bench *bench, device_buffer *buffer, size_t bytes,
                             void *contents)
{
    expect_ok(bench,
              buffer_read(&bench->report, bench->tracer.device, *buffer, 0, bytes, contents));
    buffer_release(bench->tracer.device, buffer);
}

static void compute_on_device(struct bench *bench, struct workload *work, int32_t segments,
                              struct lines *lines)
{
    struct device *device = bench->tracer.device;
    work->grid.segments = segments;
    device_buffer grid = buffer_of(bench, sizeof work->grid, &work->grid);
    device_buffer pairs = buffer_of(bench, sizeof work->pairs, work->pairs);
    device_buffer starts = buffer_of(bench, sizeof work->starts, work->starts);
    device_buffer bins = buffer_of(bench, sizeof work->bins, work->bins);
    device_buffer real_part = buffer_of(bench, sizeof work->impulses_real, work->impulses_real);
    device_buffer imaginary =
        buffer_of(bench, sizeof work->impulses_imaginary, work->impulses_imaginary);
    device_buffer pulse_real = buffer_of(bench, sizeof work->pulse_real, work->pulse_real);
    device_buffer pulse_imaginary =
        buffer_of(bench, sizeof work->pulse_imaginary, work->pulse_imaginary);
    device_buffer line_real = buffer_of(bench, sizeof lines->line_real, NULL);
    device_buffer line_imaginary = buffer_of(bench, sizeof lines->line_imaginary, NULL);
    device_buffer out_real = buffer_of(bench, sizeof lines->out_real, NULL);
    device_buffer out_imaginary = buffer_of(bench, sizeof lines->out_imaginary, NULL);
    const int32_t stride = SAMPLES, fine = FINE, taps = TAPS, out = OUT;
    const struct kernel_argument hearing[] = {
        ARGUMENT(grid),   ARGUMENT(pairs),     ARGUMENT(starts),
        ARGUMENT(bins),   ARGUMENT(real_part), ARGUMENT(imaginary),
        ARGUMENT(stride), ARGUMENT(line_real), ARGUMENT(line_imaginary)};
    const struct kernel_argument pulsing[] = {
        ARGUMENT(line_real),  ARGUMENT(line_imaginary),  ARGUMENT(stride), ARGUMENT(fine),
        ARGUMENT(pulse_real), ARGUMENT(pulse_imaginary), ARGUMENT(taps),   ARGUMENT(out),
        ARGUMENT(out_real),   ARGUMENT(out_imaginary)};
    const size_t hear_global[2] = {(size_t)segments, PAIRS};
    const size_t pulse_global[2] = {OUT / device->width, PAIRS};
    device_kernel hear = kernel_of(bench, "hear_elements");
    device_kernel pulse = kernel_of(bench, "pulse_elements");
    expect_ok(bench, kernel_run(&bench->report, device, hear, hearing, 9, 2, hear_global));
    expect_ok(bench, kernel_run(&bench->report, device, pulse, pulsing, 10, 2, pulse_global));
    kernel_release(bench->tracer.device, &hear);
    kernel_release(bench->tracer.device, &pulse);
    read_and_release(bench, &line_real, sizeof lines->line_real, lines->line_real);
    read_and_release(bench, &line_imaginary, sizeof lines->line_imaginary, lines->line_imaginary);
    read_and_release(bench, &out_real, sizeof lines->out_real, lines->out_real);
    read_and_release(bench, &out_imaginary, sizeof lines->out_imaginary, lines->out_imaginary);
    device_buffer *const rest[] = {&grid,      &pairs,     &starts,     &bins,
                                   &real_part, &imaginary, &pulse_real, &pulse_imaginary};
    for (size_t i = 0; i < COUNT(rest); i++)
        buffer_release(bench->tracer.device, rest[i]);
}

/* How many fine samples hold something: a test of nothing but zeros would pass. */
static int count_heard(const struct lines *lines)
{
    int heard = 0;
    for (int i = 0; i < PAIRS; i++)
        for (int sample = 0; sample < SAMPLES; sample++)
            heard += lines->line_real[i][sample] != 0.0f;
    return heard;
}

/* CPUs from four lanes on: see test_bits.c. */
static void test_same_bits(void **state)
{
    static const int32_t segments[] = {1, 2, 7, 500};
    static struct workload work;
    static struct lines expected, measured;
    uint32_t widths[BENCH_WIDTHS];
    const size_t count = bench_widths(widths);
    fill_workload(&work);
    compute_as_c(&work, &expected);
    assert_true(count_heard(&expected) > PAIRS * SAMPLES / 20);
    for (size_t w = 0; w < count; w++) {
        struct bench bench;
        bench_open(&bench, 8, 8, 18.0);
        bench_set_width(&bench, widths[w]);
        for (size_t i = 0; i < COUNT(segments); i++) {
            if (bench.tracer.device->is_cpu && widths[w] < 4)
                continue;
            compute_on_device(&bench, &work, segments[i], &measured);
            assert_memory_equal(&measured, &expected, sizeof expected);
        }
        bench_close(&bench);
    }
}

/* The formula, in double precision, for one impulse; pairs of real and imaginary part. */
static void hear_exactly(const sonject_element_layout *layout,
                         const struct point_response *response, double x, double range,
                         double amplitude, double *series)
{
    const sonject_elements_params *elements = &layout->elements;
    const double c = layout->sound_speed_mps;
    const double wavelength = c / layout->centre_frequency_hz;
    for (uint32_t ping = 0; ping < elements->pings; ping++) {
        const double to = x - element_transmitter_m(elements, ping);
        const double back = x - element_hydrophone_m(elements, ping, 0);
        const double there = hypot(to, range);
        const double home = hypot(back, range);
        const double delay = (there + home) / c;
        const double u = PI * elements->transmitter_length_m * to / (there * wavelength);
        const double v = PI * elements->hydrophone_length_m * back / (home * wavelength);
        const double gain = amplitude * sin(u) / u * sin(v) / v / (there * home);
        /* amplitudes on the grid carry the phase of twice the range */
        const double phase = 2.0 * PI * layout->centre_frequency_hz * (delay - 2.0 * range / c);
        for (uint64_t n = 0; n < layout->samples; n++) {
            const double time = elements->first_time_s + (double)n / elements->sampling_rate_hz;
            const double g = range_response(response, 0.5 * c * (time - delay));
            series[2 * (ping * layout->samples + n)] = gain * g * cos(phase);
            series[2 * (ping * layout->samples + n) + 1] = gain * g * sin(phase);
        }
    }
}

/* 100 kHz and 100 m, aspects to 25 deg, at the end of a long track. */
static void test_delays_and_phases(void **state)
{
    const float one = 0.03f;
    const float none = 0.0f;
    struct bench bench;
    bench_open(&bench, 4, 64, 100.0);
    struct scene *scene = &bench.scene;
    scene->geometry.first_along_track_m = 20000.0;
    scene->elements.pings = 19;
    scene->elements.first_ping_m = 20000.0 - 45.0;
    scene->elements.ping_spacing_m = 5.0;
    scene->elements.transmitter_offset_m = -0.3;
    scene->elements.first_hydrophone_m = 0.21;
    scene->elements.transmitter_length_m = 0.02;
    scene->elements.hydrophone_length_m = 0.013;
    scene->elements.last_time_s = 0.16;
    bench_ready(&bench);
    const struct tracer *tracer = &bench.tracer;
    sonject_element_layout layout;
    memset(&layout, 0, sizeof layout);
    expect_ok(&bench,
              element_plan(&layout, &bench.report, scene, &tracer->view, &tracer->response));
    /* the impulse: strip 11 of 7 a row, bin 613 of 26 a pixel */
    const struct line_grid grid = {7, 26, {11, 1}, {613, 1}};
    const double x = view_x_of_row(&tracer->view, 11.5 / 7.0 - 0.5);
    const double range = view_processor_range(&tracer->view, 613.0 / 26.0);
    struct impulse_list impulses;
    impulse_list_init(&impulses, &bench.report, tracer->device);
    expect_ok(&bench, impulse_list_add(&impulses, &grid, grid.strips, &one, &none));
    assert_int_equal(impulses.count, 1);
    const size_t values = 2 * element_plan_samples(&layout);
    float *series = calloc(values, sizeof *series);
    double *expected = calloc(values, sizeof *expected);
    assert_true(series && expected);
    const struct series_request request = {
        &layout, &tracer->view, &tracer->response, &impulses, NULL, NULL, 0.0};
    expect_ok(&bench, series_compute(&request, &bench.report, tracer->device, series));
    hear_exactly(&layout, &tracer->response, x, range, (double)one, expected);
    for (uint32_t ping = 0; ping < layout.elements.pings; ping++) {
        const size_t at = 2 * ping * (size_t)layout.samples;
        double product_real = 0.0, product_imaginary = 0.0, square = 0.0, worst = 0.0, peak = 0.0;
        for (size_t n = at; n < at + 2 * (size_t)layout.samples; n += 2) {
            const double a = (double)series[n], b = (double)series[n + 1];
            product_real += a * expected[n] + b * expected[n + 1];
            product_imaginary += b * expected[n] - a * expected[n + 1];
            square += expected[n] * expected[n] + expected[n + 1] * expected[n + 1];
            worst = fmax(worst, hypot(a - expected[n], b - expected[n + 1]));
            peak = fmax(peak, hypot(expected[n], expected[n + 1]));
        }
        assert_true(square > 0.0);
        /* single precision of offsets: 2 * 45 m * 2^-24 * 0.43 / 1.5 cm is 1.5e-4 cycles */
        expect_below("phase, rad", fabs(atan2(product_imaginary, product_real)), 2e-3);
        expect_close("level", product_real / square, 1.0, 1e-3);
        /* sharing between fine samples (5e-4 at the peak), phase, and delays of 1/100 of those */
        expect_below("worst sample over the peak", worst / peak, 3e-3);
    }
    free(series);
    free(expected);
    impulse_list_clear(&impulses);
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_delays_and_phases),
    };
    return bench_run_on_devices(tests, COUNT(tests));
}
