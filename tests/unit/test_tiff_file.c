/* Tests TIFF files of every build: copies differ from their source in the patch alone, and files
 * that could not be changed in this way are refused. */
#include "image_drafts.h"

/* Counts the bytes of b that are not those of a. Bytes beyond the end of a do not count. */
static size_t count_changes(const unsigned char *a, size_t a_count, const unsigned char *b)
{
    size_t changes = 0;
    for (size_t i = 0; i < a_count; i++)
        changes += a[i] != b[i];
    return changes;
}

/* Builds a file, reads it, and reads a copy. Returns the file's bytes. *copy: the copy's. */
static const unsigned char *copy_build(const struct tiff_build *build, const struct region *region,
                                       const unsigned char *pixels, const unsigned char **copy,
                                       size_t *count, size_t *copy_count)
{
    const char *path = file_in("a.tif");
    const char *copied = file_in("b.tif");
    const unsigned char *patch = make_pixels(&build->layout, region, 99);
    build_tiff(path, build, pixels);
    expect_pixels(path, &build->layout, pixels, NULL, NULL);
    EXPECT_OK(&report, copy_with_patch(path, copied, region, patch, NULL, NULL));
    expect_pixels(copied, &build->layout, pixels, region, patch);
    *copy = load(copied, copy_count);
    return load(path, count);
}

static void expect_copy_of_build(const struct tiff_build *build)
{
    size_t count, copy_count;
    const unsigned char *copy;
    const unsigned char *source =
        copy_build(build, &patch_region, make_image(&build->layout), &copy, &count, &copy_count);
    const size_t changes = count_changes(source, count, copy);
    if (build->compression == COMPRESSION_NONE) {
        assert_int_equal(copy_count, count);
        assert_true(changes > 0 && changes <= patch_region.rows * patch_region.columns *
                                                  pixel_size(&build->layout));
    } else {
        /* places and sizes of blocks, and their entries; a second page and the text lie behind */
        const size_t directory = (size_t)number_from_bytes(
            source + (build->is_big ? 8 : 4), build->is_big ? 8 : 4, build->is_big_endian);
        const size_t blocks = build->is_tiled ? 4 * 3 : 4;
        assert_true(copy_count >= count && changes > 0 && directory < count);
        assert_true(count_changes(source + directory, count - directory, copy + directory) <=
                    2 * 18 + 2 * 16 * blocks);
    }
    assert_string_equal(copy + tiff_place(copy, TIFF_PRIVATE_TAG, true), TIFF_PRIVATE_TEXT);
}

CLEAN(tiff_of_every_build_is_patched_in_place)
{
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
        expect_copy_of_build(&build);
    }
}

/* Blocks that grow a lot need a new place with the new size. One strip may hold all rows, which
 * TIFF tells by the largest number of rows. The image is taller than wide, and the patch lies at
 * its lower end. Deflate stores at most 65535 bytes at a time. */
CLEAN(blocks_may_grow_and_hold_all_rows)
{
    static const uint16_t codings[] = {COMPRESSION_NONE, COMPRESSION_LZW,
                                       COMPRESSION_ADOBE_DEFLATE};
    static const struct region bottom = {275, 23, 20, 31};
    const struct tiff_build growing = {
        .layout = grey8, .compression = COMPRESSION_PACKBITS, .predictor = 1, .block_rows = 16};
    unsigned char *pixels = scratch();
    const unsigned char *copy;
    size_t count, copy_count;
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        pixels[i] = (unsigned char)(i / COLUMNS);
    const unsigned char *source =
        copy_build(&growing, &patch_region, pixels, &copy, &count, &copy_count);
    assert_true(copy_count > count);
    assert_memory_equal(copy + 8, source + 8, 16 * 2); /* the first block is not touched */
    for (uint32_t i = 0; i < 6; i++) {
        const struct tiff_build build = {.layout = {297, COLUMNS, 1 + i % 2, PIXEL_FLOAT32},
                                         .is_separate = i % 2 == 1,
                                         .compression = codings[i / 2],
                                         .predictor = 1,
                                         .block_rows = UINT32_MAX};
        (void)copy_build(&build, &bottom, make_image(&build.layout), &copy, &count, &copy_count);
    }
}

/* Some writers store equal tiles once: changing one would change the others. A patch to a strip
 * that is said to lie in the directory would destroy it, or make it another image's. */
CLEAN(blocks_in_each_others_place_are_refused)
{
    const struct tiff_build build = {
        .layout = grey8, .compression = COMPRESSION_NONE, .predictor = 1, .block_rows = 16};
    const struct region bottom = {ROWS - 5, 0, 5, COLUMNS};
    unsigned char *pixels = make_image(&grey8);
    const char *path = file_in("a.tif");
    size_t count;
    build_tiff(path, &build, pixels);
    unsigned char *bytes = load(path, &count);
    unsigned char *places = bytes + tiff_place(bytes, TIFFTAG_STRIPOFFSETS, true);
    const uint64_t kept = number_from_bytes(places + 4, 4, false);
    memcpy(places + 4, places, 4);
    write_bytes(path, bytes, count);
    expect_no_open(path, "in the same place");
    number_to_bytes(kept, places + 4, 4, false);
    number_to_bytes(number_from_bytes(places + 12, 4, false) + 100, places + 12, 4, false);
    write_bytes(path, bytes, count);
    assert_int_equal(copy_with_patch(path, file_in("b.tif"), &bottom, pixels, NULL, NULL),
                     SONJECT_ERROR_INPUT);
    expect_message(path, "cannot be replaced");
    assert_int_equal(count_entries(folder->path), 1);
    const size_t directory = (size_t)number_from_bytes(bytes + 4, 4, false);
    number_to_bytes(directory, places + 12, 4, false);
    write_bytes(path, bytes, count + 5 * COLUMNS);
    tiff_say(bytes, TIFFTAG_BITSPERSAMPLE, 32);
    tiff_say(bytes, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
    tiff_say(bytes, TIFFTAG_IMAGEWIDTH, COLUMNS / 4);
    assert_int_equal(
        copy_with_patch(path, file_in("b.tif"), &bottom, bytes + directory, NULL, NULL),
        SONJECT_ERROR_INPUT);
    expect_message(path, "cannot be replaced");
}

/* The second page's directory is a copy of the first's, and so names the same strips. */
CLEAN(pages_in_each_others_place_are_refused)
{
    const struct tiff_build build = {
        .layout = grey8, .compression = COMPRESSION_NONE, .predictor = 1, .block_rows = 16};
    static unsigned char bytes[1 << 15];
    const char *path = file_in("a.tif");
    size_t count;
    build_tiff(path, &build, make_image(&grey8));
    const unsigned char *source = load(path, &count);
    const size_t directory = (size_t)number_from_bytes(source + 4, 4, false);
    const size_t entries = 2 + 12 * (size_t)number_from_bytes(source + directory, 2, false);
    const size_t second = (count + 1) / 2 * 2;
    assert_true(second + entries + 4 < sizeof bytes);
    memcpy(bytes, source, count);
    memcpy(bytes + second, source + directory, entries);
    number_to_bytes(second, bytes + directory + entries, 4, false);
    write_bytes(path, bytes, second + entries + 4);
    expect_no_open(path, "strips of several pages in the same place");
}

/* libtiff writes the files. Some then get a tag (tag, number) that libtiff would not write. */
CLEAN(tiff_that_is_not_for_sonject_is_refused)
{
    const struct tiff_build other_order = {.layout = real32,
                                           .is_big_endian = !machine_is_big_endian(),
                                           .compression = COMPRESSION_ADOBE_DEFLATE,
                                           .predictor = 2};
    const struct {
        struct tiff_build build; /* differences from a plain one */
        const char *part;
        uint16_t tag;
        uint32_t number;
    } cases[] = {
        {{.bits = 1}, "1-bit", 0, 0},
        {{.bits = 4}, "4-bit", 0, 0},
        {{.sample_format = SAMPLEFORMAT_INT}, "signed", 0, 0},
        {{.sample_format = SAMPLEFORMAT_COMPLEXINT}, "complex", 0, 0},
        {{.photometric = 1 + PHOTOMETRIC_MINISWHITE}, "0 is white", 0, 0},
        {{.photometric = 1 + PHOTOMETRIC_PALETTE}, "palette", 0, 0},
        {{.fill_order = FILLORDER_LSB2MSB}, "how pixels are stored", 0, 0},
        {{.has_second_page = true, .second_page_kind = 1}, "smaller copies", 0, 0},
        {{.layout = complex32, .extra_channel = 2}, "transparency", 0, 0},
        {{.more_tag = TIFFTAG_SUBFILETYPE, .more_value = 1}, "begins with a smaller copy", 0, 0},
        {{.more_tag = TIFFTAG_ORIENTATION, .more_value = 3}, "write it upright", 0, 0},
        {{.more_tag = TIFFTAG_IMAGEDEPTH, .more_value = 2}, "a volume", 0, 0},
        {{.is_tiled = true, .block_columns = 32, .more_tag = TIFFTAG_TILEDEPTH, .more_value = 2},
         "a volume",
         0,
         0},
        {other_order, "compression (number 50000)", TIFFTAG_COMPRESSION, 50000},
        {other_order, "in the other byte order", TIFFTAG_PREDICTOR, 3}};
    const char *path = file_in("a.tif");
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct tiff_build build = cases[i].build;
        size_t count;
        build.layout = build.layout.rows == 0 ? grey8 : build.layout;
        build.compression = build.compression == 0 ? COMPRESSION_NONE : build.compression;
        build.block_rows = 16;
        build_tiff(path, &build, make_image(&build.layout));
        unsigned char *bytes = load(path, &count);
        if (cases[i].tag != 0)
            tiff_say(bytes, cases[i].tag, cases[i].number);
        write_bytes(path, bytes, count);
        expect_no_open(path, cases[i].part);
        path = file_in("a.tif");
    }
}

/* The file has holes: only its head and its last row are really there. */
CLEAN(more_than_4_gb_are_read)
{
    const struct raster_layout layout = {70000, 70000, 1, PIXEL_UINT8};
    const struct region last = {69998, 69990, 2, 10};
    const struct region first = {0, 0, 1, 3};
    const char *path = file_in("a.tif");
    const struct tiff_build build = {.layout = {1, 3, 1, PIXEL_UINT8},
                                     .is_big = true,
                                     .compression = COMPRESSION_NONE,
                                     .block_rows = UINT32_MAX};
    size_t count;
    build_tiff(path, &build, "end");
    unsigned char *head = load(path, &count);
    tiff_say(head, TIFFTAG_IMAGEWIDTH, layout.columns);
    tiff_say(head, TIFFTAG_IMAGELENGTH, layout.rows);
    tiff_say(head, TIFFTAG_STRIPOFFSETS, count);
    tiff_say(head, TIFFTAG_STRIPBYTECOUNTS, layout.rows * layout.columns);
    write_bytes(path, head, count);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseeko(file, (off_t)(count + layout.rows * layout.columns - 3), SEEK_SET), 0);
    assert_int_equal(fwrite("end", 1, 3, file), 3);
    assert_int_equal(fclose(file), 0);
    assert_memory_equal(read_file(path, &layout, &last), "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0end",
                        20);
    assert_memory_equal(read_file(path, &layout, &first), "\0\0", 3);
    assert_int_equal(truncate(path, (off_t)(count + layout.rows * layout.columns - 1)), 0);
    expect_no_open(path, "cut short");
}

TEST_PROGRAM(NULL, NULL)
