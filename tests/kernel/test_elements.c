/* Tests element level. Series have the same bits at every width and number of work-items, and agree
 * with the formula of kernels/MATH.md in double precision. */
#include "claims.h"

#include "device/device.h"
#include "elements/elements.h"
#include "physics/bench.h"

/* Lays a scene at 100 kHz and 100 m, with aspects to 25 deg, at the end of a long track. */
static void lay(struct bench *bench, sonject_element_layout *layout)
{
    struct scene *scene = &bench->scene;
    bench_open(bench, 4, 64, 100.0);
    scene->geometry.first_along_track_m = 20000.0;
    scene->elements.pings = 19;
    scene->elements.first_ping_m = 20000.0 - 45.0;
    scene->elements.ping_spacing_m = 5.0;
    scene->elements.transmitter_offset_m = -0.3;
    scene->elements.first_hydrophone_m = 0.21;
    scene->elements.transmitter_length_m = 0.02;
    scene->elements.hydrophone_length_m = 0.013;
    scene->elements.last_time_s = 0.16;
    bench_ready(bench);
    memset(layout, 0, sizeof *layout);
    EXPECT_OK(&bench->report, element_plan(layout, &bench->report, scene, &bench->tracer.view,
                                           &bench->tracer.response));
}

/* Returns the series that the bench's device makes of impulses on a grid. The caller frees them. */
static float *series_of(struct bench *bench, const sonject_element_layout *layout,
                        const struct line_grid *grid, const float *real_part,
                        const float *imaginary_part)
{
    const struct tracer *tracer = &bench->tracer;
    float *series = zeroed(2 * element_plan_samples(layout), sizeof *series);
    struct impulse_list impulses;
    const struct series_request request = {
        layout, &tracer->view, &tracer->response, &impulses, NULL, NULL, 0.0};
    impulse_list_init(&impulses, &bench->report, tracer->device);
    EXPECT_OK(&bench->report,
              impulse_list_add(&impulses, grid, grid->strips, real_part, imaginary_part));
    EXPECT_OK(&bench->report, series_compute(&request, &bench->report, tracer->device, series));
    impulse_list_clear(&impulses);
    return series;
}

/* Impulses lie within and beyond the window; the first strips have none. A GPU shares a line among
 * hundreds of work-items. CPUs are tested from four lanes on: see test_formed_bits.c. */
TEST(test_same_bits)
{
    enum {
        STRIPS = 40,
        BINS = 26 * 80
    };
    static float parts[2][STRIPS * BINS];
    const struct line_grid grid = {7, 26, {-7, STRIPS}, {-26 * 8, BINS}};
    uint32_t widths[BENCH_WIDTHS];
    const size_t count = bench_widths(widths);
    struct bench bench;
    sonject_element_layout layout;
    uint64_t random = 1;
    for (size_t i = 3 * BINS; i < COUNT(parts[0]); i += 1 + next_random(&random) % 60)
        for (int part = 0; part < 2; part++)
            parts[part][i] = (float)((double)(next_random(&random) >> 40) / 8388608.0 - 1.0);
    lay(&bench, &layout);
    struct device *own = bench.tracer.device;
    bench.tracer.device = bench_open_reference(&bench);
    float *expected = series_of(&bench, &layout, &grid, parts[0], parts[1]);
    device_close(&bench.tracer.device);
    bench.tracer.device = own;
    size_t heard = 0;
    for (size_t i = 0; i < 2 * element_plan_samples(&layout); i++)
        heard += expected[i] != 0.0f;
    assert_true(heard > element_plan_samples(&layout) / 20); /* zeros alone would show nothing */
    for (size_t w = 0; w < count; w++) {
        bench_set_width(&bench, widths[w]);
        struct device *device = bench.tracer.device;
        const bool is_cpu = device->is_cpu;
        for (int is_shared = 0; is_shared < 2 && !(is_cpu && widths[w] < 4); is_shared++) {
            device->is_cpu = !is_shared;
            float *measured = series_of(&bench, &layout, &grid, parts[0], parts[1]);
            device->is_cpu = is_cpu;
            assert_memory_equal(measured, expected,
                                2 * element_plan_samples(&layout) * sizeof *expected);
            free(measured);
        }
    }
    free(expected);
    bench_close(&bench);
}

/* Computes one impulse's series by the formula, in pairs of real and imaginary part. */
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

TEST(test_delays_and_phases)
{
    const float one = 0.03f;
    const float none = 0.0f;
    struct bench bench;
    sonject_element_layout layout;
    lay(&bench, &layout);
    const struct tracer *tracer = &bench.tracer;
    /* the impulse is in strip 11, 7 a row, and bin 613, 26 a pixel */
    const struct line_grid grid = {7, 26, {11, 1}, {613, 1}};
    const double x = view_x_of_row(&tracer->view, 11.5 / 7.0 - 0.5);
    const double range = view_processor_range(&tracer->view, 613.0 / 26.0);
    double *expected = zeroed(2 * element_plan_samples(&layout), sizeof *expected);
    float *series = series_of(&bench, &layout, &grid, &one, &none);
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
        /* sharing between fine samples (5e-4 at the peak), phase, and delays by 1/100 sample */
        expect_below("worst sample over the peak", worst / peak, 3e-3);
    }
    free(series);
    free(expected);
    bench_close(&bench);
}

int main(void)
{
    return bench_run_on_devices(own_tests, own_test_count);
}
