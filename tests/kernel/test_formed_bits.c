/* Images are formed with the same bits everywhere: at every width and chunking, what plain C gives
 * one lane at a time. */
#include "claims.h"
#include "image_formation.h"

#include "device/device.h"
#include "physics/bench.h"
#include "scene/motion_response.h"
#include "scene/point_response.h"

#define ROWS    96
#define COLUMNS 128

/* Planes of lines or pixels, real part first. */
struct planes {
    size_t count;
    float *part[2];
};

static struct planes planes_of(size_t count)
{
    struct planes planes = {count, {calloc(count, sizeof(float)), calloc(count, sizeof(float))}};
    assert_true(planes.part[0] && planes.part[1]);
    return planes;
}

static void planes_clear(struct planes *planes)
{
    free(planes->part[0]);
    free(planes->part[1]);
}

static void expect_same_planes(const struct planes *a, const struct planes *b)
{
    assert_int_equal(a->count, b->count);
    for (int part = 0; part < 2; part++)
        for (size_t i = 0; i < a->count; i++)
            if (memcmp(&a->part[part][i], &b->part[part][i], sizeof(float)) != 0)
                fail_msg("element %zu of %zu is %.9g, not %.9g", i, a->count,
                         (double)a->part[part][i], (double)b->part[part][i]);
}

static void compress_as_c(struct bench *bench, const struct form_lines *lines,
                          const struct planes *bins, const float *pulse, struct planes *compressed)
{
    const size_t strips = (size_t)lines->grid.strips.count;
    const int count = lines->grid.bins.count;
    const struct filled_span all = {0, count}; /* zeros too, which the device leaves out */
    const int per_pixel = (int)lines->grid.bins_per_pixel;
    const int first = lines->pulse_first + (int)lines->first_column * per_pixel;
    float *imaginary = calloc((size_t)lines->pulse_taps, sizeof *imaginary);
    assert_non_null(imaginary);
    if (lines->imaginary_pulse)
        EXPECT_OK(&bench->report,
                  buffer_read(&bench->report, bench->tracer.device, lines->imaginary_pulse, 0,
                              (size_t)lines->pulse_taps * sizeof *imaginary, imaginary));
    const int stride = (int)lines->columns + (lines->pulse_taps - 1) / per_pixel + 1;
    struct planes sorted = planes_of((size_t)(stride * per_pixel));
    for (size_t s = 0; s < strips; s++) {
        const size_t out = s * lines->stride;
        for (int part = 0; part < 2; part++)
            for (int column = 0; column < stride; column++)
                sort_bins_of(bins->part[part] + s * (size_t)count, count, first, per_pixel, stride,
                             column, sorted.part[part]);
        for (int column = 0; column < (int)lines->columns; column++) {
            if (lines->imaginary_pulse)
                compress_complex_of(sorted.part[0], sorted.part[1], stride, all, first, per_pixel,
                                    pulse, imaginary, lines->pulse_taps, column,
                                    compressed->part[0] + out, compressed->part[1] + out);
            for (int part = 0; part < 2 && !lines->imaginary_pulse; part++)
                compress_range_of(sorted.part[part], stride, all, first, per_pixel, pulse,
                                  lines->pulse_taps, column, compressed->part[part] + out);
        }
    }
    planes_clear(&sorted);
    free(imaginary);
}

static struct aspects aspects_of(const struct form_lines *lines)
{
    const struct aspects aspects = {lines->grid.strips.first,
                                    lines->grid.strips.first + lines->grid.strips.count,
                                    (int)lines->grid.strips_per_row, lines->reach};
    return aspects;
}

/* As if every line were filled: zeros too are added, which the device leaves out. */
static struct filled_span *all_filled(const struct form_lines *lines)
{
    struct filled_span *filled = calloc((size_t)lines->grid.strips.count, sizeof *filled);
    assert_non_null(filled);
    for (int32_t i = 0; i < lines->grid.strips.count; i++)
        filled[i].end = (int32_t)lines->stride;
    return filled;
}

/* The response of a row and column, from its definition. */
static void response_as_c(struct bench *bench, const struct form_lines *lines, int row, int column,
                          float *real_part, float *imaginary_part)
{
    const int taps = 2 * lines->reach + 1;
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    const double offset = (0.5 - 0.5 / lines->grid.strips_per_row) * lines->row_spacing_m;
    double *a = calloc((size_t)taps, sizeof *a);
    double *b = calloc((size_t)taps, sizeof *b);
    assert_true(a && b);
    if (lines->response.motion) {
        struct motion_response motion;
        assert_int_equal(motion_response_begin(&motion, &bench->report, &lines->response,
                                               lines->view, strip, offset, lines->reach),
                         SONJECT_OK);
        motion_response_row(&motion, row, a, b);
        motion_response_end(&motion);
    } else {
        const double middle = (double)lines->first_column + column / 16 * 16 + 7.5;
        for (int i = 0; i < taps; i++) {
            const struct complex_number w =
                cross_range_response(&lines->response, view_processor_range(lines->view, middle),
                                     (i - lines->reach) * strip + offset);
            a[i] = w.real_part;
            b[i] = w.imaginary_part;
        }
    }
    for (int i = 0; i < taps; i++) {
        const bool is_energy = lines->kind == FORM_TWO_ENERGIES;
        real_part[i] = (float)(is_energy ? a[i] * a[i] + b[i] * b[i] : a[i]);
        imaginary_part[i] = is_energy ? 0.0f : (float)b[i];
    }
    free(a);
    free(b);
}

static void combine_varied_as_c(struct bench *bench, const struct form_lines *lines,
                                const struct planes *compressed, struct planes *padded)
{
    const struct aspects aspects = aspects_of(lines);
    struct filled_span *all = all_filled(lines);
    const size_t taps = 2 * (size_t)lines->reach + 1;
    float *real_part = calloc(taps, sizeof *real_part);
    float *imaginary_part = calloc(taps, sizeof *imaginary_part);
    assert_true(real_part && imaginary_part);
    for (int row = 0; row < (int)lines->rows; row++)
        for (int column = 0; column < (int)lines->columns; column++) {
            const struct response_set one = {row, 0, 1 << 30, 0};
            if (lines->response.motion ? column == 0 : column % 16 == 0)
                response_as_c(bench, lines, row, column, real_part, imaginary_part);
            combine_varied_of(aspects, one, compressed->part[0], compressed->part[1], all,
                              (int)lines->stride, real_part, imaginary_part, row, row + 1, column,
                              padded->part[0], padded->part[1]);
        }
    free(all);
    free(real_part);
    free(imaginary_part);
}

static struct planes form_as_c(struct bench *bench, const struct form_lines *lines,
                               const struct planes *bins)
{
    const size_t strips = (size_t)lines->grid.strips.count;
    const int taps = 2 * lines->reach + 1;
    struct planes compressed = planes_of(strips * lines->stride);
    struct planes padded = planes_of(lines->rows * lines->stride);
    struct planes pixels = planes_of(lines->rows * lines->columns);
    float *pulse = calloc((size_t)lines->pulse_taps, sizeof *pulse);
    const int zeros = (FORM_ROWS - 1) * (int)lines->grid.strips_per_row;
    float *response = calloc((size_t)(taps + 2 * zeros), sizeof *response);
    assert_true(pulse && response);
    assert_int_equal(buffer_read(&bench->report, bench->tracer.device, lines->pulse, 0,
                                 (size_t)lines->pulse_taps * sizeof *pulse, pulse),
                     SONJECT_OK);
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    for (int i = 0; i < taps; i++) {
        /* pixel rows sit in the middle of their strips */
        const double rows = (double)(i - lines->reach) / lines->grid.strips_per_row + 0.5 -
                            0.5 / lines->grid.strips_per_row;
        assert_true(fabs(rows * lines->row_spacing_m -
                         (i - lines->reach + 0.5 * (lines->grid.strips_per_row - 1)) * strip) <
                    1e-9);
        const double w = along_track_response(&lines->response, rows * lines->row_spacing_m);
        response[zeros + i] = (float)(lines->kind == FORM_TWO_ENERGIES ? w * w : w);
    }
    compress_as_c(bench, lines, bins, pulse, &compressed);
    const struct aspects aspects = aspects_of(lines);
    struct filled_span *all = all_filled(lines);
    if (!cross_range_is_plain(&lines->response))
        combine_varied_as_c(bench, lines, &compressed, &padded);
    else
        for (int row = 0; row < (int)lines->rows; row += FORM_ROWS)
            for (int column = 0; column < (int)lines->columns; column++)
                for (int part = 0; part < 2; part++)
                    combine_aspects_of(aspects, compressed.part[part], all, (int)lines->stride,
                                       response, row, (int)lines->rows, column, padded.part[part]);
    for (int part = 0; part < 2; part++)
        for (size_t row = 0; row < lines->rows; row++)
            memcpy(pixels.part[part] + row * lines->columns,
                   padded.part[part] + row * lines->stride, lines->columns * sizeof(float));
    free(all);
    free(pulse);
    free(response);
    planes_clear(&compressed);
    planes_clear(&padded);
    return pixels;
}

/* Energies of a seabed: 0 here and there. */
static struct planes make_bins(const struct line_grid *grid, uint32_t stream)
{
    struct planes bins = planes_of(line_grid_cells(grid));
    for (uint32_t i = 0; i < bins.count; i++) {
        float u, v;
        two_uniforms(random_key_of(8, 0, stream, 3), i, 0, &u, &v);
        bins.part[0][i] = u < 0.05f ? 0.0f : u * 1e-5f;
        bins.part[1][i] = (v - 0.5f) * 1e-5f;
        /* as of glints: nothing on some strips, on others only in a few bins */
        const uint32_t strip = i / (uint32_t)grid->bins.count;
        const uint32_t bin = i % (uint32_t)grid->bins.count;
        const uint32_t first = 30 + strip * 7 % 37;
        if (strip < 3 || strip % 5 == 2 || (strip % 5 == 3 && (bin < first || bin > first + 11)))
            bins.part[0][i] = bins.part[1][i] = 0.0f;
    }
    return bins;
}

static struct planes form_on_device(struct bench *bench, struct form_lines *lines,
                                    const struct planes *bins, int32_t chunk, int is_speckle)
{
    const size_t count = (size_t)lines->grid.bins.count;
    const int32_t strips = lines->grid.strips.count;
    struct planes pixels = planes_of(lines->rows * lines->columns);
    for (int32_t done = 0; done < strips; done += chunk) {
        const size_t at = (size_t)done * count;
        const int32_t some = strips - done < chunk ? strips - done : chunk;
        const int32_t first = lines->grid.strips.first + done;
        const sonject_status status =
            is_speckle ? form_lines_add_speckle(lines, first, some, bins->part[0] + at,
                                                0xfedcba9876543210u, STREAM_SEABED_SPECKLE)
                       : form_lines_add(lines, first, some, bins->part[0] + at, bins->part[1] + at);
        EXPECT_OK(&bench->report, status);
    }
    EXPECT_OK(&bench->report, form_lines_finish(lines, pixels.part[0], pixels.part[1]));
    return pixels;
}

static void begin_lines(struct form_lines *lines, struct bench *bench, enum form_kind kind,
                        const struct line_grid *grid)
{
    EXPECT_OK(&bench->report,
              form_lines_begin(lines, &bench->report, bench->tracer.device, &bench->tracer.view,
                               &bench->tracer.response, kind, grid));
}

/* The amplitudes that speckle gives to energies. */
static struct planes draw_as_c(const struct line_grid *grid, const struct planes *bins)
{
    struct planes drawn = planes_of(bins->count);
    for (size_t i = 0; i < bins->count; i++) {
        const int32_t strip = grid->strips.first + (int32_t)(i / (size_t)grid->bins.count);
        const int32_t bin = grid->bins.first + (int32_t)(i % (size_t)grid->bins.count);
        float a, b;
        complex_normal(
            random_key_of(0x76543210u, 0xfedcba98u, STREAM_SEABED_SPECKLE, (uint32_t)strip),
            (uint32_t)bin, &a, &b);
        drawn.part[0][i] = sqrtf(bins->part[0][i]) * a;
        drawn.part[1][i] = sqrtf(bins->part[0][i]) * b;
    }
    return drawn;
}

static uint32_t widths[BENCH_WIDTHS];
static size_t width_count;

/* Intel's compiler spreads a scalar sum over lanes, which changes its order. No CPU is given one
 * lane: every one that OpenCL runs on has at least four. */
static void compare_forming(struct bench *bench, enum form_kind kind, const struct line_grid *grid,
                            int is_speckle)
{
    static const int32_t chunks[] = {1 << 20, 37, 1 << 20, 1};
    struct form_lines lines;
    struct planes bins = make_bins(grid, 4);
    struct planes drawn = {0, {NULL, NULL}};
    if (is_speckle)
        drawn = draw_as_c(grid, &bins);
    begin_lines(&lines, bench, kind, grid);
    struct planes expected = form_as_c(bench, &lines, is_speckle ? &drawn : &bins);
    form_lines_end(&lines);
    for (size_t w = 0; w < width_count; w++) {
        if (widths[w] == 1 && bench->tracer.device->is_cpu)
            continue;
        bench_set_width(bench, widths[w]);
        begin_lines(&lines, bench, kind, grid);
        for (size_t i = 0; i < COUNT(chunks); i++) {
            struct planes measured = form_on_device(bench, &lines, &bins, chunks[i], is_speckle);
            expect_same_planes(&measured, &expected);
            planes_clear(&measured);
        }
        form_lines_end(&lines);
    }
    planes_clear(&expected);
    planes_clear(&bins);
    planes_clear(&drawn);
}

static const struct line_grid corner = {7, 26, {-20, 150}, {-40, 333}};

static void begin_bench(struct bench *bench)
{
    width_count = bench_widths(widths);
    bench_open(bench, ROWS, COLUMNS, 18.0);
    bench->scene.sonar.altitude_m = 7.3;
    bench->scene.sonar.along_track_resolution_m = 0.03;
    bench->scene.sonar.response_window = SONJECT_WINDOW_RECTANGULAR;
    bench->scene.medium.reference_sound_speed_mps = 1480.0;
}

static void compare_patch(struct bench *bench)
{
    struct line_grid patch;
    bench_ready(bench);
    line_grid_for_patch(&patch, &bench->tracer.view, &bench->tracer.response);
    compare_forming(bench, FORM_FIELD, &patch, 1);
    compare_forming(bench, FORM_TWO_ENERGIES, &patch, 0);
    compare_forming(bench, FORM_GLINT, &corner, 0);
}

/* Fine grids in corners too, partly outside the patch, as a glint's is. */
static void test_images(void **state)
{
    const struct line_grid far_corner = {7, 26, {600, 90}, {26 * (COLUMNS - 3), 200}};
    struct bench bench;
    begin_bench(&bench);
    compare_patch(&bench);
    compare_forming(&bench, FORM_GLINT, &far_corner, 0);
    bench_close(&bench);
}

/* A pulse that is complex; a beam that differs from range to range, motion from row to row. */
static void test_images_of_varied_responses(void **state)
{
    static const double x[] = {-0.06, -0.03, -0.01, 0.0, 0.02, 0.05};
    static const double a[] = {0.0, 0.3, 0.9, 1.0, 0.5, 0.0};
    static const double b[] = {0.0, 0.2, 0.1, 0.0, -0.3, 0.0};
    struct bench bench;
    begin_bench(&bench);
    EXPECT_OK(&bench.report,
              response_table_set(&bench.scene.pulse_table, &bench.report, x, a, b, 6, false));
    bench.scene.pulse.kind = SONJECT_PULSE_TABLE;
    bench.scene.sonar.array_length_m = 0.6;
    for (int i = 0; i < 3; i++) {
        bench.scene.sonar.kind = i == 1 ? SONJECT_SONAR_REAL : SONJECT_SONAR_SYNTHETIC;
        bench.scene.motion.params.random_rms_m = i == 2 ? 1e-3 : 0.0;
        compare_patch(&bench);
    }
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {TEST(test_images), TEST(test_images_of_varied_responses)};
    return bench_run_on_devices(tests, COUNT(tests));
}
