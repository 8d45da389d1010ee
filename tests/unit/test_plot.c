/* Tests pictures: size, grey levels, colours, ticks and text. Panels are looked for at the places
 * that the plot reports, within their frames, so that margins may change. */
#include "claims.h"
#include "image/canvas.h"
#include "image/plot.h"

#define FRAME_GREY 110

struct picture {
    uint8_t *rgb;
    uint32_t height, width;
    uint32_t x, y; /* place of the first panel's first pixel */
    uint32_t panel_height, panel_width;
};

/* The last picture that was drawn, and pixels to draw. */
static struct picture picture;
static float amplitude[3200 * 3202];

static struct plot_frame frame_of(uint64_t rows, uint64_t columns)
{
    const struct plot_frame frame = {rows,  columns,          0.0,   0.025, 44.0,
                                     0.025, "slant range, m", -30.0, 10.0,  20.0};
    return frame;
}

static bool is_frame(uint32_t x, uint32_t y)
{
    const uint8_t *pixel = picture.rgb + 3 * ((size_t)y * picture.width + x);
    return pixel[0] == FRAME_GREY && pixel[1] == FRAME_GREY && pixel[2] == FRAME_GREY;
}

static void draw(const struct plot_frame *frame, const struct plot_panel *panels, uint32_t count)
{
    struct report report;
    memset(&report, 0, sizeof report);
    free(picture.rgb);
    struct plot_place places[3];
    assert_true(count <= COUNT(places));
    assert_int_equal(plot_panels(&report, frame, panels, count, &picture.rgb, &picture.height,
                                 &picture.width, places),
                     SONJECT_OK);
    assert_non_null(picture.rgb);
    picture.x = places[0].left;
    picture.y = places[0].top;
    picture.panel_height = places[0].height;
    picture.panel_width = places[0].width;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t left = places[i].left - 1, right = places[i].left + picture.panel_width;
        const uint32_t top = picture.y - 1, bottom = picture.y + picture.panel_height;
        assert_int_equal(places[i].top, picture.y);
        assert_int_equal(places[i].width, picture.panel_width);
        assert_int_equal(places[i].height, picture.panel_height);
        for (uint32_t x = left; x <= right; x++)
            assert_true(is_frame(x, top) && is_frame(x, bottom));
        assert_true(!is_frame(left - 1, top) && !is_frame(right + 1, top));
        assert_true(is_frame(left, bottom) && is_frame(right, picture.y));
    }
}

static void draw_one(const struct plot_frame *frame)
{
    const struct plot_panel panel = {"title", amplitude, false};
    draw(frame, &panel, 1);
}

static const uint8_t *pixel_at(uint32_t x, uint32_t y)
{
    assert_true(x < picture.panel_width && y < picture.panel_height);
    return picture.rgb + 3 * ((size_t)(picture.y + y) * picture.width + picture.x + x);
}

static void expect_grey(uint32_t x, uint32_t y, int grey)
{
    const uint8_t *pixel = pixel_at(x, y);
    if (pixel[0] != grey || pixel[1] != grey || pixel[2] != grey)
        fail_msg("pixel %u, %u is %d %d %d, not %d", x, y, pixel[0], pixel[1], pixel[2], grey);
}

static void fill(size_t count, float value)
{
    for (size_t i = 0; i < count; i++)
        amplitude[i] = value;
}

/* 20 dB on a scale of 40 dB are half of the greys. Row 0 is at the top, column 0 at the left. */
TEST(test_grey_levels)
{
    const struct plot_frame frame = frame_of(40, 50);
    fill(40 * 50, 1.0f);
    for (size_t i = 0; i < 10 * 50; i++)
        amplitude[i] = 0.1f; /* the first ten rows */
    for (size_t row = 10; row < 40; row++)
        amplitude[row * 50] = 1e-6f;
    amplitude[39 * 50 + 49] = 1e6f;
    draw_one(&frame);
    assert_int_equal(picture.panel_width, 50 * 16); /* 800 / 50 */
    assert_int_equal(picture.panel_height, 40 * 16);
    expect_grey(0, 0, 64); /* 255 * 10 / 40 */
    expect_grey(799, 10 * 16 - 1, 64);
    expect_grey(799, 10 * 16, 191); /* 255 * 30 / 40 */
    expect_grey(15, 10 * 16, 0);
    expect_grey(16, 10 * 16, 191);
    expect_grey(799, 639, 255);
    expect_grey(783, 639, 191);
}

/* Levels rise from -40 to 0 dB in equal steps. Of a thousand pixels the 30th darkest and the 2nd
 * brightest bound the scale, each to the 0.01 dB of the count and the 0.04 dB between pixels. */
TEST(test_scale_from_percentiles)
{
    struct plot_frame frame = frame_of(100, 100);
    frame.minimum_db = frame.maximum_db = 0.0;
    fill(100 * 100, 0.0f);
    for (size_t i = 0; i < 10000; i++)
        amplitude[i] = powf(10.0f, (float)(i / 10) / 25.0f / 20.0f - 2.0f);
    draw_one(&frame);
    for (uint32_t i = 0; i < 100; i += 7) {
        const double decibels = -40.0 + 40.0 * (i / 100.0);
        const double expected = 255.0 * fmin(fmax((decibels + 38.8) / (38.8 - 0.08), 0.0), 1.0);
        const int grey = pixel_at(4, i * 8 + 4)[0];
        if (fabs(grey - expected) > 1.0)
            fail_msg("row %u is %d, not %.1f", i, grey, expected);
    }
}

/* Energies are averaged, not amplitudes or decibels: half of the pixels at 0 dB and half empty make
 * -3.01 dB, the grey 255 * 26.99 / 40. */
TEST(test_large_images_average_energy)
{
    const struct plot_frame frame = frame_of(3200, 3202);
    fill((size_t)3200 * 3202, 1.0f);
    for (size_t i = 0; i < (size_t)3200 * 3202; i += 2)
        amplitude[i] = 0.0f;
    amplitude[4] = amplitude[5] = NAN; /* NAN counts for nothing: the cell's mean is the same */
    draw_one(&frame);
    assert_int_equal(picture.panel_height, 800);
    assert_int_equal(picture.panel_width, 801); /* the last column of cells holds two pixels */
    for (uint32_t i = 0; i < 800; i += 13)
        expect_grey(i, i, 172);
    expect_grey(1, 0, 172);
    expect_grey(800, 799, 172);
}

TEST(test_difference_colours)
{
    const struct plot_frame frame = frame_of(4, 4);
    fill(16, 1.0f);
    float difference[16] = {20.0f, -20.0f, 500.0f, 0.0f, 10.0f, NAN};
    const struct plot_panel panels[] = {{"difference", difference, true}, {"", amplitude, false}};
    draw(&frame, panels, 2);
    const uint32_t cell = picture.panel_width / 4;
    const uint8_t *red = pixel_at(0, 0);
    const uint8_t *blue = pixel_at(cell, 0);
    const uint8_t *beyond = pixel_at(2 * cell, 0);
    const uint8_t *white = pixel_at(3 * cell, 0);
    const uint8_t *pale = pixel_at(0, cell);
    assert_true(red[0] > 150 && red[1] < 60 && red[2] < 60);
    assert_true(blue[2] > 150 && blue[0] < 60 && blue[1] < 100);
    assert_memory_equal(beyond, red, 3);
    assert_true(white[0] == white[1] && white[1] == white[2] && white[0] > 240);
    for (int i = 0; i < 3; i++) /* half way from white to red */
        assert_true(abs(2 * pale[i] - red[i] - white[i]) <= 1);
    expect_grey(cell, cell, 0);
}

/* Every panel that is drawn has the first one's size, and a picture has no more panels than asked
 * for. The upper edge has a frame for each panel, then one for each colour bar. */
TEST(test_panels_side_by_side)
{
    const struct plot_frame frame = frame_of(400, 480);
    fill(400 * 480, 1.0f);
    const struct plot_panel panels[] = {
        {"before", amplitude, false}, {"after", amplitude, false}, {"difference", amplitude, true}};
    draw(&frame, panels, 3);
    assert_int_equal(picture.panel_height, 400);
    uint32_t wide = 0;
    uint32_t narrow = 0;
    for (uint32_t x = 0, run = 0; x < picture.width; x++) {
        if (is_frame(x, picture.y - 1)) {
            run++;
        } else if (run > 0) {
            wide += run == 480 + 2;
            narrow += run != 480 + 2;
            run = 0;
        }
    }
    assert_int_equal(wide, 3);
    assert_int_equal(narrow, 2); /* one bar for both greys, one for the difference */
}

/* 480 columns from 44 m, 2.5 cm apart and 2 picture pixels wide: 46 m is column 80, whose middle is
 * drawn at 161. Along-track grows downwards: 3 m is row 120, drawn at 241. */
TEST(test_ticks_are_where_they_belong)
{
    const struct plot_frame frame = frame_of(400, 480);
    fill(400 * 480, 1.0f);
    draw_one(&frame);
    assert_int_equal(picture.panel_width, 960);
    const uint32_t below = picture.y + picture.panel_height + 3;
    const uint32_t beside = picture.x - 4;
    for (uint32_t i = 0; i < 960; i++)
        assert_int_equal(is_frame(picture.x + i, below), i % 80 == 1);
    for (uint32_t i = 0; i < 800; i++)
        assert_int_equal(is_frame(beside, picture.y + i), i % 80 == 1);
}

TEST(test_tick_numbers)
{
    static const struct {
        double low, high, most;
        int count;
        const char *first, *last;
    } cases[] = {{0.0, 10.0, 10.0, 11, "0", "10"},
                 {0.0, 10.0, 9.0, 6, "0", "10"},
                 {44.0, 56.0, 6.0, 7, "44", "56"},
                 {-0.31, 0.31, 7.0, 7, "-0.3", "0.3"},
                 {-20.0, 20.0, 4.0, 5, "-20", "20"},
                 {49.99, 50.04, 5.0, 6, "49.99", "50.04"},
                 {0.0, 123456.0, 5.0, 3, "0", "100000"},
                 {-0.06, -0.04, 4.0, 5, "-0.060", "-0.040"},
                 {0.9, 1.1, 1.0, 1, "1.0", "1.0"},
                 {0.0, 0.0, 5.0, 0, "", ""},
                 {1.0, 0.0, 5.0, 0, "", ""},
                 {NAN, 1.0, 5.0, 0, "", ""},
                 {0.0, INFINITY, 5.0, 0, "", ""},
                 {1e15, 1e15 + 1.0, 5.0, 0, "", ""},
                 {-1e300, 1e300, 5.0, 0, "", ""},
                 {0.0, 1e-300, 5.0, 0, "", ""}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const double low = cases[i].low;
        const double high = cases[i].high;
        const struct plot_ticks ticks = plot_ticks_between(low, high, cases[i].most);
        char label[TICK_LABEL_CAPACITY];
        assert_int_equal(ticks.last - ticks.first + 1, cases[i].count);
        if (cases[i].count == 0)
            continue;
        assert_string_equal(plot_tick_label(&ticks, ticks.first, label), cases[i].first);
        assert_string_equal(plot_tick_label(&ticks, ticks.last, label), cases[i].last);
        assert_true(plot_tick_value(&ticks, ticks.first) >= low - 1e-6 * (high - low));
        assert_true(plot_tick_value(&ticks, ticks.last) <= high + 1e-6 * (high - low));
    }
}

static void expect_no_picture(const struct plot_frame *frame)
{
    struct report report;
    memset(&report, 0, sizeof report);
    const struct plot_panel panel = {"", amplitude, false};
    uint8_t *drawn = (uint8_t *)&report;
    uint32_t height, width;
    assert_int_equal(plot_panels(&report, frame, &panel, 1, &drawn, &height, &width, NULL),
                     SONJECT_ERROR_INPUT);
    assert_null(drawn);
    assert_non_null(strstr(report.message, "nothing to draw"));
}

TEST(test_nothing_to_draw)
{
    struct plot_frame frame = frame_of(30, 20);
    frame.minimum_db = frame.maximum_db = 0.0;
    fill(600, 0.0f);
    expect_no_picture(&frame);
    amplitude[5] = NAN;
    amplitude[6] = INFINITY;
    expect_no_picture(&frame);
    frame.rows = 0;
    expect_no_picture(&frame);
    frame.rows = 30;
    frame.columns = 0;
    expect_no_picture(&frame);
}

/* Distances on both axes are in proportion as far as panels stay legible. Pixels without a level
 * are black or white. A single level is in the middle of the scale. */
TEST(test_shapes_and_pixels_without_levels)
{
    static const struct {
        uint64_t rows, columns;
        double row_spacing_m;
        uint32_t height, width; /* size of the panel; 0: any */
    } cases[] = {{1, 1, 0.025, 0, 0},       {1, 2, 0.025, 0, 0},     {1, 10000, 0.025, 0, 0},
                 {10000, 1, 0.025, 0, 0},   {3, 30000, 0.025, 0, 0}, {1201, 799, 0.025, 0, 0},
                 {100, 400, 0.1, 800, 800}, {801, 1, 0.025, 0, 0}};
    static const float values[] = {0.0f, NAN, INFINITY, 1.0f};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct plot_frame frame = frame_of(cases[i].rows, cases[i].columns);
        frame.row_spacing_m = cases[i].row_spacing_m;
        frame.maximum_db = frame.minimum_db;
        fill(cases[i].rows * cases[i].columns, 0.5f);
        draw_one(&frame);
        assert_true(picture.height < 1500 && picture.width < 1500);
        assert_true(picture.panel_height > 100 && picture.panel_width > 100);
        assert_true(cases[i].height == 0 || (picture.panel_height == cases[i].height &&
                                             picture.panel_width == cases[i].width));
        expect_grey(picture.panel_width - 1, picture.panel_height - 1, 128);
    }
    const struct plot_frame frame = frame_of(2, 2);
    memcpy(amplitude, values, sizeof values);
    draw_one(&frame);
    expect_grey(0, 0, 0);
    expect_grey(picture.panel_width - 1, 0, 0);
    expect_grey(0, picture.panel_height - 1, 255);
    expect_grey(picture.panel_width - 1, picture.panel_height - 1, 191);
}

TEST(test_extreme_axes_and_titles)
{
    static const double values[] = {0.0,    NAN,   INFINITY, -INFINITY, 1e300,
                                    1e-300, -1e-3, 1e15,     5e-324};
    for (size_t i = 0; i < 6; i++)
        amplitude[i] = 0.1f * (float)(i + 1);
    char title[1000];
    memset(title, 'W', sizeof title - 1);
    title[sizeof title - 1] = '\0';
    const struct plot_panel panels[] = {
        {title, amplitude, false}, {NULL, amplitude, true}, {"\xc3\xa9\x01\x7f", amplitude, false}};
    for (size_t i = 0; i < COUNT(values); i++) {
        for (int member = 0; member < 5; member++) {
            struct plot_frame frame = frame_of(2, 3);
            double *const members[] = {&frame.first_along_track_m, &frame.row_spacing_m,
                                       &frame.first_range_m, &frame.column_spacing_m,
                                       &frame.minimum_db};
            *members[member] = values[i];
            frame.range_label = i % 2 ? NULL : "column";
            draw(&frame, panels, 3);
            assert_true(picture.height < 2000 && picture.width < 4000);
        }
    }
}

static struct canvas blank_canvas(uint32_t height, uint32_t width)
{
    const struct colour white = {255, 255, 255};
    struct canvas canvas;
    assert_true(canvas_create(&canvas, height, width, white));
    return canvas;
}

/* Every printable character is drawn, differs from the others, and keeps to its box. Turned text is
 * the same text turned. */
TEST(test_font)
{
    const struct colour black = {0, 0, 0};
    static uint8_t all['~' + 1][40 * 40 * 3];
    for (char c = ' '; c <= '~'; c++) {
        const char text[] = {c, '\0'};
        const int64_t length = text_length(text, 1);
        struct canvas drawn = blank_canvas(40, 40);
        struct canvas turned = blank_canvas(40, 40);
        uint32_t inked = 0;
        draw_text(&drawn, 10, 25, text, 1, TEXT_RIGHTWARDS, black);
        draw_text(&turned, 25, 29, text, 1, TEXT_UPWARDS, black);
        for (uint32_t i = 0; i < 40 * 40; i++) {
            const uint32_t x = i % 40;
            const uint32_t y = i / 40;
            assert_int_equal(turned.rgb[3 * ((39 - x) * 40 + y)], drawn.rgb[3 * i]);
            if (drawn.rgb[3 * i] == 255)
                continue;
            assert_true(x >= 9 && x <= 11 + length && y >= 25 - FONT_ASCENT - 1 &&
                        y <= 25 + FONT_DESCENT);
            inked++;
        }
        assert_int_equal(inked > 0, c != ' ');
        memcpy(all[(int)c], drawn.rgb, sizeof all[0]);
        for (char other = ' '; other < c; other++)
            assert_memory_not_equal(all[(int)c], all[(int)other], sizeof all[0]);
        free(turned.rgb);
        free(drawn.rgb);
    }
}

/* Text that runs out of the picture is cut, on every side. */
TEST(test_text_is_cut_off)
{
    const struct colour black = {0, 0, 0};
    struct canvas canvas = blank_canvas(7, 9);
    for (int64_t x = -40; x < 20; x += 3) {
        for (int64_t y = -30; y < 40; y += 5) {
            draw_text(&canvas, x, y, "Wg@", SIZE_MAX, TEXT_RIGHTWARDS, black);
            draw_text(&canvas, x, y, "Wg@", SIZE_MAX, TEXT_UPWARDS, black);
        }
    }
    canvas_fill(&canvas, -5, -5, 100, 100, black);
    canvas_frame(&canvas, 2, 2, 100, 3, black);
    for (size_t i = 0; i < 7 * 9 * 3; i++)
        assert_int_equal(canvas.rgb[i], 0);
    free(canvas.rgb);
}

/* Pixels that are four times as high as wide, or the reverse, are drawn to scale. Only their longer
 * sides are enlarged. A picture's side is at least a fifth of the other side. */
TEST(test_small_images_are_to_scale)
{
    static const struct {
        uint64_t rows, columns;
        double shape;
        uint32_t sides[2];
    } cases[] = {{20, 64, 4.0, {80, 64}},    {72, 288, 4.0, {144, 144}}, {64, 20, 0.25, {64, 80}},
                 {64, 64, 1.0, {64, 64}},    {24, 150, 1.0, {28, 144}},  {5000, 50, 1.0, {144, 28}},
                 {288, 144, NAN, {144, 72}}, {1, 1, 1.0, {1, 1}}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        uint32_t sides[2];
        plot_small_sides(cases[i].rows, cases[i].columns, cases[i].shape, 1.0, 144, sides);
        assert_memory_equal(sides, cases[i].sides, sizeof sides);
    }
}

TEST_PROGRAM(NULL, NULL)
