/* Image files: what is written comes back, and a copy differs from its source in the patch alone.
 */
#define _POSIX_C_SOURCE   200809L
#define _FILE_OFFSET_BITS 64

#include <signal.h>
#include <sys/resource.h>

#include "claims.h"
#include "swath/raster_file.h"
#include "swath/swath_file.h"
#include "temporary_folder.h"
#include "tiff_builder.h"

#define ROWS    53
#define COLUMNS 71

static const struct raster_layout grey8 = {ROWS, COLUMNS, 1, PIXEL_UINT8};
static const struct raster_layout grey16 = {ROWS, COLUMNS, 1, PIXEL_UINT16};
static const struct raster_layout real32 = {ROWS, COLUMNS, 1, PIXEL_FLOAT32};
static const struct raster_layout complex32 = {ROWS, COLUMNS, 2, PIXEL_FLOAT32};
static const struct region patch_region = {17, 23, 20, 31};

/* One decoder for all, as a context has it. */
static struct decoder decoder;
static const struct report_host host = {.decoder = &decoder};
static struct report report = {{0}, NULL, &host};

static struct region whole_of(const struct raster_layout *layout)
{
    const struct region region = {0, 0, layout->rows, layout->columns};
    return region;
}

static size_t pixel_size(const struct raster_layout *layout)
{
    return layout->channels * pixel_bytes(layout->type);
}

/* Pixels of a region, for free(); noisy, so that compression has to work. */
static unsigned char *make_pixels(const struct raster_layout *layout, const struct region *region,
                                  uint32_t seed)
{
    size_t bytes = 0;
    assert_true(region_bytes(layout, region, &bytes));
    unsigned char *pixels = calloc(bytes, 1);
    float *floats = (float *)(void *)pixels;
    assert_non_null(pixels);
    for (size_t i = 0; i < bytes; i++) {
        seed = seed * 1664525u + 1013904223u;
        if (layout->type == PIXEL_FLOAT32 && i % 4 == 0)
            floats[i / 4] = (float)(seed >> 8) * 1e-5f - 60.0f;
        else if (layout->type != PIXEL_FLOAT32)
            pixels[i] = (unsigned char)(seed >> 24);
    }
    return pixels;
}

static sonject_status copy_with_patch(const char *source, const char *path,
                                      const struct region *region, const void *pixels,
                                      sonject_progress_function progress, void *user)
{
    struct swath_file *file;
    sonject_status status =
        swath_file_open_array(&report, source, SONJECT_CHANNEL_ONLY, NULL, &file);
    if (status == SONJECT_OK)
        status = swath_file_copy_with_patch(&report, file, path, region, pixels, progress, user);
    swath_file_close(&file);
    return status;
}

static unsigned char *read_file(const char *path, const struct raster_layout *expected,
                                const struct region *region)
{
    struct swath_file *file;
    struct raster_layout layout;
    size_t bytes = 0;
    EXPECT_OK(&report, swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file));
    swath_file_layout(file, &layout);
    assert_int_equal(layout.rows, expected->rows);
    assert_int_equal(layout.columns, expected->columns);
    assert_int_equal(layout.channels, expected->channels);
    assert_int_equal(layout.type, expected->type);
    assert_true(region_bytes(&layout, region, &bytes));
    unsigned char *pixels = calloc(bytes, 1);
    assert_non_null(pixels);
    EXPECT_OK(&report, swath_file_read(&report, file, region, pixels));
    swath_file_close(&file);
    assert_null(file);
    return pixels;
}

/* The file's pixels are those of whole, but in region those of patch (NULL: no patch). */
static void expect_pixels(const char *path, const struct raster_layout *layout,
                          const unsigned char *whole, const struct region *region,
                          const unsigned char *patch)
{
    const struct region everything = whole_of(layout);
    const size_t size = pixel_size(layout);
    unsigned char *pixels = read_file(path, layout, &everything);
    for (uint64_t row = 0; row < layout->rows; row++)
        for (uint64_t i = 0; i < layout->columns; i++) {
            const bool is_patch =
                patch && row >= region->first_row && row < region->first_row + region->rows &&
                i >= region->first_column && i < region->first_column + region->columns;
            const unsigned char *expected =
                is_patch ? patch + ((row - region->first_row) * region->columns + i -
                                    region->first_column) *
                                       size
                         : whole + (row * layout->columns + i) * size;
            if (memcmp(pixels + (row * layout->columns + i) * size, expected, size) != 0)
                fail_msg("%s: the pixel at row %d, column %d is wrong", path, (int)row, (int)i);
        }
    free(pixels);
}

static void expect_message(const char *path, const char *part)
{
    if (!strstr(report.message, path) || !strstr(report.message, part))
        fail_msg("'%s' does not name '%s' and '%s'", report.message, path, part);
}

static void expect_no_open(const char *path, const char *part)
{
    struct swath_file *file = (struct swath_file *)&report;
    if (swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file) !=
        SONJECT_ERROR_INPUT)
        fail_msg("%s was not refused (%s)", path, part);
    assert_null(file);
    expect_message(path, part);
}

struct format {
    const char *name;
    const struct raster_layout *layout;
};

static const struct format lossless[] = {{"a.tif", &grey8},  {"b.tiff", &grey16},
                                         {"c.TIF", &real32}, {"d.tif", &complex32},
                                         {"e.png", &grey8},  {"f.PNG", &grey16}};

static void test_what_is_written_comes_back(void **state)
{
    struct temporary_folder *folder = *state;
    for (size_t i = 0; i < COUNT(lossless); i++) {
        const struct raster_layout *layout = lossless[i].layout;
        const char *path = temporary_file(folder, lossless[i].name);
        const struct region everything = whole_of(layout);
        unsigned char *pixels = make_pixels(layout, &everything, 1);
        EXPECT_OK(&report, raster_file_write(&report, path, layout, NULL, NULL, 0, pixels));
        expect_pixels(path, layout, pixels, NULL, NULL);
        assert_int_equal(count_entries(folder->path), i + 1);
        free(pixels);
    }
}

/* Decoders run forwards; asking for earlier rows, or the same ones again, must not confuse them. */
static void test_regions_are_cut_out_in_any_order(void **state)
{
    struct temporary_folder *folder = *state;
    static const struct format formats[] = {
        {"a.tif", &grey8}, {"a.png", &grey8}, {"a.jpg", &grey8}, {"b.tif", &complex32}};
    const struct region regions[] = {{30, 5, 10, 20}, {2, 7, 20, 3},  {2, 7, 20, 3}, {52, 0, 1, 71},
                                     {0, 0, 1, 1},    {52, 70, 1, 1}, {0, 5, 53, 1}};
    for (size_t i = 0; i < COUNT(formats); i++) {
        const struct raster_layout *layout = formats[i].layout;
        const struct region everything = whole_of(layout);
        const size_t size = pixel_size(layout);
        const char *path = temporary_file(folder, formats[i].name);
        struct swath_file *file;
        unsigned char *pixels = make_pixels(layout, &everything, 1);
        EXPECT_OK(&report, raster_file_write(&report, path, layout, NULL, NULL, 0, pixels));
        unsigned char *stored = read_file(path, layout, &everything);
        EXPECT_OK(&report, swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file));
        for (size_t j = 0; j < COUNT(regions); j++) {
            unsigned char part[ROWS * COLUMNS * 8];
            EXPECT_OK(&report, swath_file_read(&report, file, &regions[j], part));
            for (uint64_t row = 0; row < regions[j].rows; row++)
                assert_memory_equal(
                    part + row * regions[j].columns * size,
                    stored +
                        ((regions[j].first_row + row) * COLUMNS + regions[j].first_column) * size,
                    regions[j].columns * size);
        }
        swath_file_close(&file);
        free(stored);
        free(pixels);
    }
}

static void test_a_region_outside_is_refused(void **state)
{
    struct temporary_folder *folder = *state;
    const char *path = temporary_file(folder, "a.png");
    const struct region everything = whole_of(&grey8);
    const struct region outside = {40, 0, 14, 1};
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    struct swath_file *file;
    EXPECT_OK(&report, raster_file_write(&report, path, &grey8, NULL, NULL, 0, pixels));
    EXPECT_OK(&report, swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file));
    assert_int_equal(swath_file_read(&report, file, &outside, pixels), SONJECT_ERROR_INPUT);
    swath_file_close(&file);
    assert_int_equal(copy_with_patch(path, path, &outside, pixels, NULL, NULL),
                     SONJECT_ERROR_INPUT);
    assert_int_equal(raster_file_write_placed(&report, path, &grey8, &outside, pixels, NULL),
                     SONJECT_ERROR_STORAGE);
    expect_pixels(path, &grey8, pixels, NULL, NULL);
    free(pixels);
}

static void test_attributes(void **state)
{
    struct temporary_folder *folder = *state;
    static const char *const names[] = {"a.tif", "b.png", "c.jpg"};
    static const struct raster_attribute attributes[] = {{"sonject:frequency", "100000 Hz"},
                                                         {"sonject:side", "port"}};
    static const char *const channels[] = {"intensity"};
    const struct region everything = whole_of(&grey8);
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    for (size_t i = 0; i < COUNT(names); i++) {
        const char *path = temporary_file(folder, names[i]);
        char value[10];
        struct swath_file *file;
        EXPECT_OK(&report,
                  raster_file_write(&report, path, &grey8, channels, attributes, 2, pixels));
        EXPECT_OK(&report, swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file));
        assert_true(swath_file_attribute(file, "sonject:frequency", value, sizeof value));
        assert_string_equal(value, "100000 Hz"); /* just fits */
        assert_false(swath_file_attribute(file, "sonject:frequency", value, sizeof value - 1));
        assert_true(swath_file_attribute(file, "sonject:side", value, sizeof value));
        assert_string_equal(value, "port");
        assert_true(swath_file_attribute(file, "channels", value, sizeof value));
        assert_string_equal(value, "intensity");
        assert_false(swath_file_attribute(file, "frequency", value, sizeof value));
        assert_false(swath_file_attribute(file, "sonject:side", value, 0));
        swath_file_close(&file);
    }
    free(pixels);
}

static void test_the_same_pixels_give_the_same_file(void **state)
{
    struct temporary_folder *folder = *state;
    static const char *const names[] = {"a.tif", "b.png", "c.jpg"};
    const struct region everything = whole_of(&grey8);
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    unsigned char *first[3];
    size_t counts[3];
    for (size_t i = 0; i < 3; i++) {
        const char *path = temporary_file(folder, names[i]);
        EXPECT_OK(&report, raster_file_write(&report, path, &grey8, NULL, NULL, 0, pixels));
        first[i] = bytes_of_file(path, &counts[i]);
    }
    sleep(1); /* a file that holds the second of its making would differ now */
    for (size_t i = 0; i < 3; i++) {
        size_t count;
        const char *path = temporary_file(folder, names[i]);
        EXPECT_OK(&report, raster_file_write(&report, path, &grey8, NULL, NULL, 0, pixels));
        unsigned char *again = bytes_of_file(path, &count);
        assert_int_equal(count, counts[i]);
        assert_memory_equal(again, first[i], count);
        free(again);
        free(first[i]);
    }
    free(pixels);
}

static void test_what_a_format_does_not_hold(void **state)
{
    struct temporary_folder *folder = *state;
    const struct raster_layout colour = {4, 4, 3, PIXEL_UINT8};
    const struct raster_layout empty = {0, 4, 1, PIXEL_UINT8};
    const struct raster_layout two = {4, 4, 2, PIXEL_UINT8};
    const struct raster_layout small = {4, 4, 1, PIXEL_FLOAT32};
    const struct raster_layout wide = {4, 4, 1, PIXEL_UINT16};
    const struct format refused[] = {{"a.png", &small}, {"a.jpg", &small}, {"a.jpg", &wide},
                                     {"a.exr", &small}, {"a", &small},     {"a.png", &two},
                                     {"a.png", &empty}, {"a.tif", &empty}};
    const float pixels[48] = {0};
    for (size_t i = 0; i < COUNT(refused); i++)
        if (raster_file_write(&report, temporary_file(folder, refused[i].name), refused[i].layout,
                              NULL, NULL, 0, pixels) != SONJECT_ERROR_UNSUPPORTED)
            fail_msg("%s (case %zu) was taken", refused[i].name, i);
    assert_int_equal(count_entries(folder->path), 0);
    EXPECT_OK(&report, raster_file_write(&report, temporary_file(folder, "a.png"), &colour, NULL,
                                         NULL, 0, pixels));
    expect_no_open(folder->file, "3 channels");
    EXPECT_OK(&report, raster_file_write(&report, temporary_file(folder, "a.tif"), &colour, NULL,
                                         NULL, 0, pixels));
    expect_no_open(folder->file, "has 3 channels; sonject reads 1 (amplitude) or 2");
    EXPECT_OK(&report, raster_file_write(&report, temporary_file(folder, "a.jpg"), &colour, NULL,
                                         NULL, 0, pixels));
    expect_no_open(folder->file, "3 channels");
}

static void test_placed(void **state)
{
    struct temporary_folder *folder = *state;
    for (size_t i = 0; i < COUNT(lossless); i++) {
        const struct raster_layout *layout = lossless[i].layout;
        const char *path = temporary_file(folder, lossless[i].name);
        unsigned char *patch = make_pixels(layout, &patch_region, 3);
        unsigned char *zeros = calloc(ROWS * COLUMNS, pixel_size(layout));
        assert_non_null(zeros);
        EXPECT_OK(&report,
                  raster_file_write_placed(&report, path, layout, &patch_region, patch, NULL));
        expect_pixels(path, layout, zeros, &patch_region, patch);
        free(zeros);
        free(patch);
    }
}

/* Copies source into the folder and compares pixels; returns the copy's name. */
static const char *copy_and_compare(struct temporary_folder *folder, const char *source,
                                    const char *name, const struct raster_layout *layout,
                                    const struct region *region, const unsigned char *pixels)
{
    char from[TEMPORARY_CAPACITY + 300];
    snprintf(from, sizeof from, "%s", source);
    const char *path = temporary_file(folder, name);
    unsigned char *patch = make_pixels(layout, region, 99);
    EXPECT_OK(&report, copy_with_patch(from, path, region, patch, NULL, NULL));
    expect_pixels(path, layout, pixels, region, patch);
    free(patch);
    return path;
}

/* Neither the coding of a JPEG nor a PNG's chunks are kept, but pixels and description are. */
static void test_png_and_jpeg_become_a_png_of_their_pixels(void **state)
{
    struct temporary_folder *folder = *state;
    static const struct raster_attribute attribute = {"sonject:side", "port"};
    static const struct format sources[] = {
        {"a.png", &grey8}, {"b.png", &grey16}, {"c.jpg", &grey8}};
    for (size_t i = 0; i < 3; i++) {
        const struct raster_layout *layout = sources[i].layout;
        const struct region everything = whole_of(layout);
        unsigned char *pixels = make_pixels(layout, &everything, 1);
        const char *path = temporary_file(folder, sources[i].name);
        struct swath_file *file;
        char value[8];
        EXPECT_OK(&report, raster_file_write(&report, path, layout, NULL, &attribute, 1, pixels));
        unsigned char *stored = read_file(path, layout, &everything);
        path = copy_and_compare(folder, path, "copy.png", layout, &patch_region, stored);
        size_t count;
        unsigned char *copy = bytes_of_file(path, &count);
        assert_memory_equal(copy, "\x89PNG", 4);
        EXPECT_OK(&report, swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file));
        assert_true(swath_file_attribute(file, "sonject:side", value, sizeof value));
        assert_string_equal(value, "port");
        assert_string_equal(swath_file_new_extension(file), ".png");
        swath_file_close(&file);
        free(copy);
        free(stored);
        free(pixels);
    }
}

/* Bytes of b that are not those of a; what b is longer does not count. */
static size_t count_changes(const unsigned char *a, size_t a_count, const unsigned char *b)
{
    size_t changes = 0;
    for (size_t i = 0; i < a_count; i++)
        changes += a[i] != b[i];
    return changes;
}

static void expect_copy_of_build(struct temporary_folder *folder, const struct tiff_build *build)
{
    const struct region everything = whole_of(&build->layout);
    unsigned char *pixels = make_pixels(&build->layout, &everything, 7);
    const char *path = temporary_file(folder, "a.tif");
    size_t count, copy_count;
    build_tiff(path, build, pixels);
    unsigned char *source = bytes_of_file(path, &count);
    expect_pixels(path, &build->layout, pixels, NULL, NULL);
    path = copy_and_compare(folder, path, "b.tif", &build->layout, &patch_region, pixels);
    unsigned char *copy = bytes_of_file(path, &copy_count);
    const size_t changes = count_changes(source, count, copy);
    if (build->compression == COMPRESSION_NONE) {
        assert_int_equal(copy_count, count);
        assert_true(changes > 0 && changes <= patch_region.rows * patch_region.columns *
                                                  pixel_size(&build->layout));
    } else {
        /* places and sizes of blocks, and entries of these; a second page and the text lie behind
         */
        const size_t directory = (size_t)number_from_bytes(
            source + (build->is_big ? 8 : 4), build->is_big ? 8 : 4, build->is_big_endian);
        const size_t blocks = build->is_tiled ? 4 * 3 : 4;
        assert_true(copy_count >= count && changes > 0 && directory < count);
        assert_true(count_changes(source + directory, count - directory, copy + directory) <=
                    2 * 18 + 2 * 16 * blocks);
    }
    free(copy);
    free(source);
    free(pixels);
}

static void expect_build_refused(struct temporary_folder *folder, const struct tiff_build *build,
                                 const char *part)
{
    const struct region everything = whole_of(&build->layout);
    unsigned char *pixels = make_pixels(&build->layout, &everything, 7);
    const char *path = temporary_file(folder, "a.tif");
    build_tiff(path, build, pixels);
    expect_no_open(path, part);
    free(pixels);
}

static void test_tiff_of_every_build(void **state)
{
    struct temporary_folder *folder = *state;
    static const uint16_t codings[][2] = {
        {COMPRESSION_NONE, 1},    {COMPRESSION_PACKBITS, 1},      {COMPRESSION_LZW, 1},
        {COMPRESSION_LZW, 2},     {COMPRESSION_ADOBE_DEFLATE, 1}, {COMPRESSION_ADOBE_DEFLATE, 2},
        {COMPRESSION_DEFLATE, 1}, {COMPRESSION_LZW, 3},           {COMPRESSION_ADOBE_DEFLATE, 3}};
    const struct raster_layout *layouts[] = {&grey8, &grey16, &real32, &complex32};
    for (unsigned i = 0; i < COUNT(codings) * 4 * 16; i++) {
        struct tiff_build build = {.layout = *layouts[i / 16 % 4],
                                   .is_big = i & 1,
                                   .is_big_endian = (i & 2) != 0,
                                   .is_tiled = (i & 4) != 0,
                                   .is_separate = (i & 8) != 0,
                                   .has_second_page = (i & 1) != 0,
                                   .compression = codings[i / 64][0],
                                   .predictor = codings[i / 64][1],
                                   .block_rows = 16,
                                   .block_columns = 32};
        if ((build.predictor == 3 && build.layout.type != PIXEL_FLOAT32) ||
            (build.is_separate && build.layout.channels == 1))
            continue;
        if (build.predictor == 3 && build.is_big_endian != machine_is_big_endian())
            build.is_big_endian = !build.is_big_endian; /* libtiff writes no others */
        expect_copy_of_build(folder, &build);
    }
}

/* Some writers store equal tiles once: changing one would change the others. A strip that is said
 * to lie where the directory is: the patch would destroy it. */
static void test_blocks_in_each_others_place(void **state)
{
    struct temporary_folder *folder = *state;
    const struct tiff_build build = {
        .layout = grey8, .compression = COMPRESSION_NONE, .predictor = 1, .block_rows = 16};
    const struct region everything = whole_of(&grey8);
    const struct region bottom = {ROWS - 5, 0, 5, COLUMNS};
    unsigned char *pixels = make_pixels(&grey8, &everything, 7);
    char path[TEMPORARY_CAPACITY + 300];
    size_t count;
    snprintf(path, sizeof path, "%s", temporary_file(folder, "a.tif"));
    build_tiff(path, &build, pixels);
    unsigned char *bytes = bytes_of_file(path, &count);
    unsigned char *places = bytes + tiff_place(bytes, TIFFTAG_STRIPOFFSETS, true);
    unsigned char kept[4];
    memcpy(kept, places + 4, 4);
    memcpy(places + 4, places, 4);
    write_bytes(path, bytes, count);
    expect_no_open(path, "in the same place");
    memcpy(places + 4, kept, 4);
    number_to_bytes(number_from_bytes(places + 12, 4, false) + 100, places + 12, 4, false);
    write_bytes(path, bytes, count);
    assert_int_equal(
        copy_with_patch(path, temporary_file(folder, "b.tif"), &bottom, pixels, NULL, NULL),
        SONJECT_ERROR_INPUT);
    expect_message(path, "cannot be replaced");
    assert_int_equal(count_entries(folder->path), 1);
    free(bytes);
    free(pixels);
}

/* The new place must come with the new size: here blocks grow a lot. */
static void test_blocks_that_grow(void **state)
{
    struct temporary_folder *folder = *state;
    const struct tiff_build build = {
        .layout = grey8, .compression = COMPRESSION_PACKBITS, .predictor = 1, .block_rows = 16};
    unsigned char pixels[ROWS * COLUMNS];
    size_t count, copy_count;
    for (size_t i = 0; i < sizeof pixels; i++)
        pixels[i] = (unsigned char)(i / COLUMNS);
    const char *path = temporary_file(folder, "a.tif");
    build_tiff(path, &build, pixels);
    unsigned char *source = bytes_of_file(path, &count);
    expect_pixels(path, &grey8, pixels, NULL, NULL);
    path = copy_and_compare(folder, path, "b.tif", &grey8, &patch_region, pixels);
    unsigned char *copy = bytes_of_file(path, &copy_count);
    assert_true(copy_count > count);
    assert_memory_equal(copy + 8, source + 8, 16 * 2); /* the first block is not touched */
    free(copy);
    free(source);
}

/* What TIFF says of one strip for all rows: as many in it as a number can say. The image is taller
 * than wide, and the patch lies at its lower end. Deflate stores at most 65535 bytes at a time. */
static void test_strips_of_all_rows(void **state)
{
    struct temporary_folder *folder = *state;
    static const uint16_t codings[] = {COMPRESSION_NONE, COMPRESSION_LZW,
                                       COMPRESSION_ADOBE_DEFLATE};
    const struct region bottom = {275, 23, 20, 31};
    for (uint32_t i = 0; i < 6; i++) {
        const struct tiff_build build = {.layout = {297, COLUMNS, 1 + i % 2, PIXEL_FLOAT32},
                                         .is_separate = i % 2 == 1,
                                         .compression = codings[i / 2],
                                         .predictor = 1,
                                         .block_rows = UINT32_MAX};
        const struct region everything = whole_of(&build.layout);
        unsigned char *pixels = make_pixels(&build.layout, &everything, 7);
        const char *path = temporary_file(folder, "a.tif");
        build_tiff(path, &build, pixels);
        expect_pixels(path, &build.layout, pixels, NULL, NULL);
        (void)copy_and_compare(folder, path, "b.tif", &build.layout, &bottom, pixels);
        free(pixels);
    }
}

static void test_tiff_that_is_not_for_sonject(void **state)
{
    struct temporary_folder *folder = *state;
    static const struct {
        struct tiff_build build; /* what differs from a plain one */
        const char *part;
    } cases[] = {
        {{.bits = 1}, "1-bit"},
        {{.bits = 4}, "4-bit"},
        {{.sample_format = SAMPLEFORMAT_INT}, "signed"},
        {{.sample_format = SAMPLEFORMAT_COMPLEXINT}, "complex"},
        {{.photometric = 1 + PHOTOMETRIC_MINISWHITE}, "0 is white"},
        {{.photometric = 1 + PHOTOMETRIC_PALETTE}, "palette"},
        {{.fill_order = FILLORDER_LSB2MSB}, "how pixels are stored"},
        {{.has_second_page = true, .second_page_kind = 1}, "smaller copies"},
        {{.layout = {ROWS, COLUMNS, 2, PIXEL_FLOAT32}, .extra_channel = 2}, "transparency"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct tiff_build build = cases[i].build;
        if (build.layout.rows == 0)
            build.layout = grey8;
        build.compression = COMPRESSION_NONE;
        build.block_rows = 16;
        expect_build_refused(folder, &build, cases[i].part);
    }
}

/* What libtiff itself would not write. */
static void test_tiff_that_says_what_is_not_for_sonject(void **state)
{
    struct temporary_folder *folder = *state;
    const struct tiff_build build = {.layout = real32,
                                     .is_big_endian = !machine_is_big_endian(),
                                     .compression = COMPRESSION_ADOBE_DEFLATE,
                                     .predictor = 2,
                                     .block_rows = 16};
    const struct region everything = whole_of(&real32);
    static const struct {
        uint16_t tag;
        uint32_t number;
        const char *part;
    } cases[] = {{TIFFTAG_COMPRESSION, 50000, "compression (number 50000)"},
                 {TIFFTAG_PREDICTOR, 3, "in the other byte order"}};
    unsigned char *pixels = make_pixels(&real32, &everything, 7);
    const char *path = temporary_file(folder, "a.tif");
    for (size_t i = 0; i < COUNT(cases); i++) {
        size_t count;
        build_tiff(path, &build, pixels);
        unsigned char *bytes = bytes_of_file(path, &count);
        tiff_say(bytes, cases[i].tag, cases[i].number);
        write_bytes(path, bytes, count);
        expect_no_open(path, cases[i].part);
        free(bytes);
    }
    free(pixels);
}

/* Makes the checksum of the PNG's first chunk right. */
static void sum_png_header(unsigned char *png)
{
    uint32_t sum = 0xFFFFFFFF;
    for (size_t i = 12; i < 29; i++) {
        sum ^= png[i];
        for (int bit = 0; bit < 8; bit++)
            sum = sum & 1 ? sum >> 1 ^ 0xEDB88320 : sum >> 1;
    }
    number_to_bytes(~sum & 0xFFFFFFFF, png + 29, 4, true);
}

static void test_png_that_is_not_for_sonject(void **state)
{
    struct temporary_folder *folder = *state;
    const struct region everything = whole_of(&grey8);
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    const char *path = temporary_file(folder, "a.png");
    size_t count;
    EXPECT_OK(&report, raster_file_write(&report, path, &grey8, NULL, NULL, 0, pixels));
    unsigned char *bytes = bytes_of_file(path, &count);
    static const struct {
        unsigned char bits, colours;
        const char *part;
    } cases[] = {{1, 0, "1-bit"}, {4, 0, "4-bit"},       {8, 2, "3 channels"}, {8, 3, "palette"},
                 {8, 4, "2 ch"},  {16, 6, "4 channels"}, {8, 1, "IHDR"},       {8, 255, "IHDR"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        bytes[24] = cases[i].bits;
        bytes[25] = cases[i].colours;
        sum_png_header(bytes);
        write_bytes(path, bytes, count);
        expect_no_open(path, cases[i].part);
    }
    free(bytes);
    free(pixels);
}

static void put_big(unsigned char *bytes, uint64_t number)
{
    number_to_bytes(number, bytes, 4, true);
}

static void test_absurd_dimensions(void **state)
{
    struct temporary_folder *folder = *state;
    const struct region everything = whole_of(&grey8);
    static const uint64_t sides[][2] = {{1u << 31, 1u << 31},
                                        {(1u << 31) - 1, (1u << 31) - 1},
                                        {1u << 20, (1u << 20) + 1},
                                        {0, 5},
                                        {5, 0},
                                        {1u << 19, 1u << 19},
                                        {1, (1u << 31) - 1},
                                        {(1u << 31) - 1, 1},
                                        {0xFFFFFFFF, 0xFFFFFFFF}};
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    size_t count;
    const char *path = temporary_file(folder, "a.png");
    EXPECT_OK(&report, raster_file_write(&report, path, &grey8, NULL, NULL, 0, pixels));
    unsigned char *png = bytes_of_file(path, &count);
    for (size_t i = 0; i < COUNT(sides); i++) {
        put_big(png + 16, sides[i][0]);
        put_big(png + 20, sides[i][1]);
        sum_png_header(png);
        write_bytes(path, png, count);
        expect_no_open(path, "");
    }
    put_big(png + 16, 1000001); /* more than libpng reads, but not too much for the file's size */
    put_big(png + 20, 1);
    sum_png_header(png);
    write_bytes(path, png, count);
    expect_no_open(path, "IHDR");
    free(png);
    path = temporary_file(folder, "a.tif");
    EXPECT_OK(&report, raster_file_write(&report, path, &grey8, NULL, NULL, 0, pixels));
    unsigned char *tiff = bytes_of_file(path, &count);
    for (size_t i = 0; i < COUNT(sides); i++) {
        tiff_say(tiff, TIFFTAG_IMAGEWIDTH, sides[i][0]);
        tiff_say(tiff, TIFFTAG_IMAGELENGTH, sides[i][1]);
        write_bytes(path, tiff, count);
        expect_no_open(path, "");
    }
    free(tiff);
    free(pixels);
}

/* A file with holes: only its head and its last row are really there. */
static void test_more_than_4_gb(void **state)
{
    struct temporary_folder *folder = *state;
    const struct raster_layout layout = {70000, 70000, 1, PIXEL_UINT8};
    const struct region last = {69998, 69990, 2, 10};
    const struct region first = {0, 0, 1, 3};
    const char *path = temporary_file(folder, "a.tif");
    const struct tiff_build build = {.layout = {1, 3, 1, PIXEL_UINT8},
                                     .is_big = true,
                                     .compression = COMPRESSION_NONE,
                                     .block_rows = UINT32_MAX};
    size_t count;
    build_tiff(path, &build, "end");
    unsigned char *head = bytes_of_file(path, &count);
    tiff_say(head, TIFFTAG_IMAGEWIDTH, layout.columns);
    tiff_say(head, TIFFTAG_IMAGELENGTH, layout.rows);
    tiff_say(head, TIFFTAG_STRIPOFFSETS, count);
    tiff_say(head, TIFFTAG_STRIPBYTECOUNTS, layout.rows * layout.columns);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(head, 1, count, file), count);
    free(head);
    assert_int_equal(fseeko(file, (off_t)(count + layout.rows * layout.columns - 3), SEEK_SET), 0);
    assert_int_equal(fwrite("end", 1, 3, file), 3);
    assert_int_equal(fclose(file), 0);
    unsigned char *pixels = read_file(path, &layout, &last);
    assert_memory_equal(pixels, "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0end", 20);
    free(pixels);
    pixels = read_file(path, &layout, &first);
    assert_memory_equal(pixels, "\0\0", 3);
    assert_int_equal(truncate(path, (off_t)(count + layout.rows * layout.columns - 1)), 0);
    expect_no_open(path, "cut short");
    free(pixels);
}

static void test_files_that_are_no_images(void **state)
{
    struct temporary_folder *folder = *state;
    expect_no_open(temporary_file(folder, "missing.tif"), "No such file");
    expect_no_open(folder->path, "directory");
    write_bytes(temporary_file(folder, "a.tif"), "", 0);
    expect_no_open(folder->file, "empty");
    write_bytes(temporary_file(folder, "a.tif"), "Please convert me.", 18);
    expect_no_open(folder->file, "of no format that sonject knows");
    write_bytes(temporary_file(folder, "a.tif"), "GIF89a", 6);
    expect_no_open(folder->file, "is a GIF file");
    const unsigned char pixels[4] = {0};
    const struct region region = {0, 0, 1, 1};
    char missing[TEMPORARY_CAPACITY + 300];
    snprintf(missing, sizeof missing, "%s", temporary_file(folder, "missing.tif"));
    assert_int_equal(
        copy_with_patch(missing, temporary_file(folder, "b.tif"), &region, pixels, NULL, NULL),
        SONJECT_ERROR_INPUT);
    expect_message(missing, "No such file");
    assert_int_equal(count_entries(folder->path), 1);
}

/* libjpeg fills what is missing with grey and only warns. */
static void test_a_jpeg_that_ends_early(void **state)
{
    struct temporary_folder *folder = *state;
    const struct region everything = whole_of(&grey8);
    const char *path = temporary_file(folder, "a.jpg");
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    size_t count;
    EXPECT_OK(&report, raster_file_write(&report, path, &grey8, NULL, NULL, 0, pixels));
    unsigned char *bytes = bytes_of_file(path, &count);
    bytes[count / 2] = 0xFF;
    bytes[count / 2 + 1] = 0xD9;
    write_bytes(path, bytes, count);
    expect_no_open(path, "cut short or damaged");
    free(bytes);
    free(pixels);
}

/* What a damaged file may lead to. */
struct damage {
    const char *source, *copy;
    unsigned char *patch;
    size_t taken, refused;  /* files */
    size_t refused_at_once; /* when they were opened */
};

static void try_damaged(struct damage *damage, const unsigned char *bytes, size_t count)
{
    struct swath_file *file;
    FILE *out = open_new_file(damage->source);
    if (!out || fwrite(bytes, 1, count, out) != count || fclose(out) != 0)
        return;
    unlink(damage->copy);
    sonject_status status =
        swath_file_open_array(&report, damage->source, SONJECT_CHANNEL_ONLY, NULL, &file);
    damage->refused_at_once += status == SONJECT_ERROR_INPUT;
    if (status == SONJECT_OK) {
        struct raster_layout layout;
        swath_file_layout(file, &layout);
        if (region_is_inside(&layout, &patch_region) && layout.channels == 1 &&
            layout.type == PIXEL_UINT8)
            status = swath_file_read(&report, file, &patch_region, damage->patch);
        swath_file_close(&file);
        if (status == SONJECT_OK)
            status = copy_with_patch(damage->source, damage->copy, &patch_region, damage->patch,
                                     NULL, NULL);
    }
    const bool has_copy = access(damage->copy, F_OK) == 0;
    if (status == SONJECT_OK && has_copy)
        damage->taken++;
    else if (status == SONJECT_ERROR_INPUT && !has_copy && strstr(report.message, damage->source))
        damage->refused++;
}

/* Everything that goes to stdout or stderr meanwhile lands in a file. */
struct silence {
    int kept_out, kept_error;
};

static struct silence listen_to_output(const char *path)
{
    const struct silence silence = {dup(1), dup(2)};
    fflush(stdout);
    fflush(stderr);
    FILE *file = fopen(path, "wb");
    if (file) {
        (void)dup2(fileno(file), 1);
        (void)dup2(fileno(file), 2);
        fclose(file);
    }
    return silence;
}

static void stop_listening(struct silence silence)
{
    fflush(stdout);
    fflush(stderr);
    (void)dup2(silence.kept_out, 1);
    (void)dup2(silence.kept_error, 2);
    close(silence.kept_out);
    close(silence.kept_error);
}

static void expect_silence(const char *path)
{
    size_t count;
    unsigned char *said = bytes_of_file(path, &count);
    if (count > 0)
        fail_msg("something was printed: %s", (const char *)said);
    free(said);
}

static const char *const damaged_names[] = {"plain.tif", "deflate.tif", "lzw.tif", "a.png",
                                            "a.jpg"};

/* A good file to do harm to, for free(). */
static unsigned char *make_victim(struct temporary_folder *folder, size_t index,
                                  const unsigned char *pixels, size_t *count)
{
    const struct tiff_build build = {.layout = grey8,
                                     .compression =
                                         index == 1 ? COMPRESSION_ADOBE_DEFLATE : COMPRESSION_LZW,
                                     .predictor = 2,
                                     .is_tiled = index == 2,
                                     .has_second_page = true,
                                     .block_rows = 16,
                                     .block_columns = 16};
    const char *path = temporary_file(folder, damaged_names[index]);
    if (index == 1 || index == 2)
        build_tiff(path, &build, pixels);
    else
        EXPECT_OK(&report, raster_file_write(&report, path, &grey8, NULL, NULL, 0, pixels));
    return bytes_of_file(path, count);
}

/* Every length near the beginning and the end, some between. Returns how many. */
static size_t cut_short(struct damage *damage, const unsigned char *bytes, size_t count)
{
    size_t tried = 0;
    for (size_t length = 0; length < count; tried++) {
        try_damaged(damage, bytes, length);
        length += length > 300 && length + 320 < count ? 13 : 1;
    }
    return tried;
}

/* Three bytes at a time, half of them among the first and last ones, where directories are. */
static void change_bytes(struct damage *damage, unsigned char *bytes, size_t count, size_t tries)
{
    uint32_t random = 1;
    for (size_t attempt = 0; attempt < tries; attempt++) {
        unsigned char kept[3];
        size_t places[3];
        for (int j = 0; j < 3; j++) {
            random = random * 1664525u + 1013904223u;
            places[j] = random % 4 < 2   ? (random >> 8) % count
                        : random % 4 < 3 ? (random >> 8) % 200
                                         : count - 1 - (random >> 8) % 300;
            kept[j] = bytes[places[j]];
            bytes[places[j]] = (unsigned char)(random >> 24);
        }
        try_damaged(damage, bytes, count);
        for (int j = 3; j-- > 0;)
            bytes[places[j]] = kept[j];
    }
}

/* Files that are cut short are refused at once. Changed bytes give some other image or none, but
 * never a crash, a half-written file or noise. */
static void test_files_that_are_cut_short_or_damaged(void **state)
{
    struct temporary_folder *folder = *state;
    const struct region everything = whole_of(&grey8);
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    unsigned char *patch = make_pixels(&grey8, &patch_region, 2);
    const size_t tries = 150;
    for (size_t i = 0; i < COUNT(damaged_names); i++) {
        size_t count;
        char source[TEMPORARY_CAPACITY + 300], copy[TEMPORARY_CAPACITY + 310];
        char output[TEMPORARY_CAPACITY + 300];
        unsigned char *bytes = make_victim(folder, i, pixels, &count);
        snprintf(source, sizeof source, "%s", temporary_file(folder, damaged_names[i]));
        snprintf(output, sizeof output, "%s", temporary_file(folder, "output"));
        snprintf(copy, sizeof copy, "%s/copy-%s", folder->path, damaged_names[i]);
        struct damage cut = {source, copy, patch, 0, 0, 0};
        struct damage changed = cut;
        const struct silence silence = listen_to_output(output);
        const size_t lengths = cut_short(&cut, bytes, count);
        change_bytes(&changed, bytes, count, tries);
        stop_listening(silence);
        expect_silence(output);
        /* all but a PNG's mark of its end, which holds no pixels */
        const size_t harmless = strcmp(damaged_names[i], "a.png") == 0 ? 12 : 0;
        if (cut.refused != lengths - harmless || cut.refused_at_once != cut.refused ||
            cut.taken != harmless)
            fail_msg("%s: of %zu, %zu were refused, %zu at once, and %zu taken", damaged_names[i],
                     lengths, cut.refused, cut.refused_at_once, cut.taken);
        if (changed.taken + changed.refused != tries)
            fail_msg("%s: of %zu, %zu were refused and %zu taken, last: %s", damaged_names[i],
                     tries, changed.refused, changed.taken, report.message);
        try_damaged(&cut, bytes, count);
        assert_int_equal(cut.taken, harmless + 1);
        (void)unlink(copy);
        (void)unlink(source);
        (void)unlink(output);
        assert_int_equal(count_entries(folder->path), 0);
        free(bytes);
    }
    free(patch);
    free(pixels);
}

static int cancel(void *user, double fraction, const char *stage)
{
    int *calls = user;
    assert_true(fraction >= 0.0 && fraction <= 1.0 && stage != NULL);
    return ++*calls == 1;
}

static int count_calls(void *user, double fraction, const char *stage)
{
    int *calls = user;
    (void)stage;
    assert_true(fraction >= 0.0 && fraction <= 1.0);
    ++*calls;
    return 0;
}

static void test_cancelling(void **state)
{
    struct temporary_folder *folder = *state;
    static const char *const names[] = {"a.tif", "a.png", "a.jpg"};
    const struct region everything = whole_of(&grey8);
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    for (size_t i = 0; i < 3; i++) {
        char source[TEMPORARY_CAPACITY + 300];
        char copy[TEMPORARY_CAPACITY + 310];
        snprintf(source, sizeof source, "%s", temporary_file(folder, names[i]));
        snprintf(copy, sizeof copy, "%s/copy-%s", folder->path, names[i]);
        int calls = 0;
        EXPECT_OK(&report, raster_file_write(&report, source, &grey8, NULL, NULL, 0, pixels));
        assert_int_equal(copy_with_patch(source, copy, &patch_region, pixels, cancel, &calls),
                         SONJECT_CANCELLED);
        assert_int_equal(count_entries(folder->path), i + 1);
        calls = 0;
        EXPECT_OK(&report,
                  copy_with_patch(source, copy, &patch_region, pixels, count_calls, &calls));
        assert_true(calls > 0);
        unlink(copy);
    }
    free(pixels);
}

/* A limit on the size of files is as near as a test gets to a full disk. */
static void test_a_full_disk(void **state)
{
    struct temporary_folder *folder = *state;
    static const char *const names[] = {"a.tif", "a.png", "a.jpg"};
    const struct region everything = whole_of(&grey8);
    unsigned char *pixels = make_pixels(&grey8, &everything, 1);
    struct rlimit kept;
    struct rlimit low;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &kept), 0);
    low = kept;
    signal(SIGXFSZ, SIG_IGN);
    for (size_t i = 0; i < 3; i++) {
        char source[TEMPORARY_CAPACITY + 300];
        char copy[TEMPORARY_CAPACITY + 310];
        snprintf(source, sizeof source, "%s", temporary_file(folder, names[i]));
        snprintf(copy, sizeof copy, "%s/copy-%s", folder->path, names[i]);
        EXPECT_OK(&report, raster_file_write(&report, source, &grey8, NULL, NULL, 0, pixels));
        for (rlim_t limit = 0; limit < 3000; limit += 200) {
            low.rlim_cur = limit;
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
            const sonject_status copied =
                copy_with_patch(source, copy, &patch_region, pixels, NULL, NULL);
            const bool names_it = strstr(report.message, copy) != NULL &&
                                  strstr(report.message, "File too large") != NULL;
            const sonject_status written =
                raster_file_write(&report, copy, &grey8, NULL, NULL, 0, pixels);
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &kept), 0);
            if (copied != SONJECT_ERROR_STORAGE || !names_it || written != SONJECT_ERROR_STORAGE)
                fail_msg("%s, limit %d: copy %d, write %d, message '%s'", names[i], (int)limit,
                         (int)copied, (int)written, report.message);
            expect_message(copy, "File too large");
            assert_int_equal(count_entries(folder->path), i + 1);
        }
    }
    free(pixels);
}

#define WITH_FOLDER(test)                                                                          \
    cmocka_unit_test_setup_teardown(test, make_temporary_folder, remove_temporary_folder)

TEST_PROGRAM(NULL, NULL, WITH_FOLDER(test_what_is_written_comes_back),
             WITH_FOLDER(test_regions_are_cut_out_in_any_order),
             WITH_FOLDER(test_a_region_outside_is_refused), WITH_FOLDER(test_attributes),
             WITH_FOLDER(test_the_same_pixels_give_the_same_file),
             WITH_FOLDER(test_what_a_format_does_not_hold), WITH_FOLDER(test_placed),
             WITH_FOLDER(test_png_and_jpeg_become_a_png_of_their_pixels),
             WITH_FOLDER(test_tiff_of_every_build), WITH_FOLDER(test_blocks_in_each_others_place),
             WITH_FOLDER(test_blocks_that_grow), WITH_FOLDER(test_strips_of_all_rows),
             WITH_FOLDER(test_tiff_that_is_not_for_sonject),
             WITH_FOLDER(test_tiff_that_says_what_is_not_for_sonject),
             WITH_FOLDER(test_png_that_is_not_for_sonject), WITH_FOLDER(test_absurd_dimensions),
             WITH_FOLDER(test_more_than_4_gb), WITH_FOLDER(test_files_that_are_no_images),
             WITH_FOLDER(test_a_jpeg_that_ends_early),
             WITH_FOLDER(test_files_that_are_cut_short_or_damaged), WITH_FOLDER(test_cancelling),
             WITH_FOLDER(test_a_full_disk))
