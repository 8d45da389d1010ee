/* Tests that images are formed with the same bits everywhere. At every width and chunking, a device
 * must give what the same kernels give as plain C with the fewest lanes. */
#include "claims.h"
#include "random.h"

#include "device/device.h"
#include "physics/bench.h"

#define ROWS    96
#define COLUMNS 128

/* Planes of lines or pixels, real part first. */
struct planes {
    size_t count;
    float *part[2];
};

static struct planes planes_of(size_t count)
{
    struct planes planes = {count, {zeroed(count, sizeof(float)), zeroed(count, sizeof(float))}};
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

/* Makes energies of a seabed, with zeros here and there. */
static struct planes make_bins(const struct line_grid *grid, uint32_t stream)
{
    struct planes bins = planes_of(line_grid_cells(grid));
    for (uint32_t i = 0; i < bins.count; i++) {
        float u, v;
        two_uniforms(random_key_of(8, 0, stream, 3), i, 0, &u, &v);
        bins.part[0][i] = u < 0.05f ? 0.0f : u * 1e-5f;
        bins.part[1][i] = (v - 0.5f) * 1e-5f;
        /* like glints: some strips hold nothing, others hold only a few bins */
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
    const struct span whole = {0, lines->grid.bins.count};
    const int32_t strips = lines->grid.strips.count;
    struct planes pixels = planes_of(lines->at.rows * lines->at.columns);
    for (int32_t done = 0; done < strips; done += chunk) {
        const size_t at = (size_t)done * count;
        const int32_t some = strips - done < chunk ? strips - done : chunk;
        const int32_t first = lines->grid.strips.first + done;
        const sonject_status status =
            is_speckle
                ? form_lines_add_speckle(lines, first, some, bins->part[0] + at,
                                         0xfedcba9876543210u, STREAM_SEABED_SPECKLE)
                : form_lines_add(lines, first, some, whole, bins->part[0] + at, bins->part[1] + at);
        EXPECT_OK(&bench->report, status);
    }
    EXPECT_OK(&bench->report, form_lines_finish(lines, pixels.part[0], pixels.part[1]));
    return pixels;
}

/* A value next to nothing, in place of zeros, which forming leaves out. */
#define NEXT_TO_NOTHING 1e-42f
static void fill_gaps(struct planes *bins)
{
    for (int part = 0; part < 2; part++)
        for (size_t i = 0; i < bins->count; i++)
            if (bins->part[part][i] == 0.0f)
                bins->part[part][i] = NEXT_TO_NOTHING;
}

/* Compares planes. Speckle of NEXT_TO_NOTHING has amplitudes of 1e-21, the image of 1e-6. */
static void expect_alike(const struct planes *a, const struct planes *b)
{
    double most = 0.0;
    for (int part = 0; part < 2; part++)
        for (size_t i = 0; i < a->count; i++) {
            most = fmax(most, fabs((double)b->part[part][i]));
            assert_true(fabs((double)a->part[part][i] - (double)b->part[part][i]) < 1e-18);
        }
    assert_true(most > 1e-7);
}

static void begin_lines(struct form_lines *lines, struct bench *bench, enum form_kind kind,
                        const struct line_grid *grid)
{
    EXPECT_OK(&bench->report,
              form_lines_begin(lines, &bench->report, bench->tracer.device, &bench->tracer.view,
                               &bench->tracer.response, kind, grid));
}

static uint32_t widths[BENCH_WIDTHS];
static size_t width_count;

/* Compares all widths but one lane on a CPU. Intel's compiler spreads a scalar sum over lanes,
 * which changes its order. No CPU is given one lane, as every CPU of OpenCL has at least four. */
static void compare_forming(struct bench *bench, enum form_kind kind, const struct line_grid *grid,
                            int is_speckle)
{
    static const int32_t chunks[] = {1 << 20, 37, 1 << 20, 1};
    struct form_lines lines;
    struct planes bins = make_bins(grid, 4);
    struct device *own = bench->tracer.device;
    bench->tracer.device = bench_open_reference(bench);
    begin_lines(&lines, bench, kind, grid);
    struct planes expected = form_on_device(bench, &lines, &bins, 1 << 20, is_speckle);
    fill_gaps(&bins);
    struct planes filled = form_on_device(bench, &lines, &bins, 1 << 20, is_speckle);
    expect_alike(&filled, &expected);
    planes_clear(&filled);
    planes_clear(&bins);
    bins = make_bins(grid, 4);
    form_lines_end(&lines);
    device_close(&bench->tracer.device);
    bench->tracer.device = own;
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
}

/* Forms cells alone, and among the empty cells of a grid that reaches all pixels. Alone they give a
 * window of the same pixels, and outside it nothing is lost. The grid needs no empty cells. */
static void compare_window(struct bench *bench, enum form_kind kind)
{
    const struct line_grid all = {2, 3, {-20, 2 * ROWS + 40}, {-40, 3 * COLUMNS + 80}};
    const struct line_grid some = {2, 3, {100, 20}, {150, 60}};
    struct form_lines lines;
    struct planes bins = make_bins(&some, 4);
    struct planes around = planes_of(line_grid_cells(&all));
    for (size_t i = 0; i < bins.count; i++) {
        const size_t strip = 100 + 20 + i / 60, bin = 150 + 40 + i % 60;
        for (int part = 0; part < 2; part++)
            around.part[part][strip * (size_t)all.bins.count + bin] = bins.part[part][i];
    }
    begin_lines(&lines, bench, kind, &all);
    struct planes whole = form_on_device(bench, &lines, &around, 1 << 20, 0);
    form_lines_end(&lines);
    assert_int_equal(whole.count, ROWS * COLUMNS);
    struct planes sparse = planes_of(whole.count);
    const struct span filled = {150 + 40, 60};
    begin_lines(&lines, bench, kind, &all);
    EXPECT_OK(&bench->report, form_lines_add(&lines, 100, 20, filled, bins.part[0], bins.part[1]));
    EXPECT_OK(&bench->report, form_lines_finish(&lines, sparse.part[0], sparse.part[1]));
    form_lines_end(&lines);
    expect_same_planes(&sparse, &whole);
    planes_clear(&sparse);
    begin_lines(&lines, bench, kind, &some);
    struct planes window = form_on_device(bench, &lines, &bins, 1 << 20, 0);
    const struct window at = lines.at;
    form_lines_end(&lines);
    assert_true(at.rows < ROWS && at.columns < COLUMNS);
    for (int part = 0; part < 2; part++)
        for (size_t i = 0; i < whole.count; i++) {
            const size_t row = i / COLUMNS - at.first_row, column = i % COLUMNS - at.first_column;
            const bool is_inside = row < at.rows && column < at.columns;
            const float expected = is_inside ? window.part[part][row * at.columns + column] : 0.0f;
            assert_true(whole.part[part][i] == expected);
        }
    planes_clear(&bins);
    planes_clear(&around);
    planes_clear(&whole);
    planes_clear(&window);
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

/* Forms fine grids in corners, too, partly outside the patch as a glint's grid is. */
TEST(test_images)
{
    const struct line_grid far_corner = {7, 26, {600, 90}, {26 * (COLUMNS - 3), 200}};
    struct bench bench;
    begin_bench(&bench);
    compare_patch(&bench);
    compare_forming(&bench, FORM_GLINT, &far_corner, 0);
    bench_close(&bench);
}

/* Forms images with a complex pulse, a beam that varies with range, and motion from row to row. */
TEST(test_images_of_varied_responses)
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

/* Hamming's side lobes end within the patch, and so does a long array's beam. */
TEST(test_windows_hold_all_that_their_cells_reach)
{
    struct bench bench;
    begin_bench(&bench);
    bench.scene.sonar.response_window = SONJECT_WINDOW_HAMMING;
    bench.scene.sonar.array_length_m = 6.0;
    for (int i = 0; i < 3; i++) {
        bench.scene.sonar.kind = i == 1 ? SONJECT_SONAR_REAL : SONJECT_SONAR_SYNTHETIC;
        bench.scene.motion.params.random_rms_m = i == 2 ? 1e-3 : 0.0;
        bench_ready(&bench);
        compare_window(&bench, FORM_FIELD);
        compare_window(&bench, FORM_TWO_ENERGIES);
    }
    bench_close(&bench);
}

int main(void)
{
    return bench_run_on_devices(own_tests, own_test_count);
}
