/* Tests TIFF, PNG and JPEG: pixels come back as written, and a copy differs from its source in the
 * patch alone. */
#include "image_drafts.h"

#include <errno.h>
#include <signal.h>
#include <sys/resource.h>

#include <zlib.h>

#include "swath/image_library.h"

struct format {
    const char *name;
    const struct raster_layout *layout;
};

/* Formats with the layouts to write. The last one is lossy. */
static const struct format formats[] = {
    {"a.tif", &grey8}, {"b.tiff", &grey16}, {"c.TIF", &real32}, {"d.tif", &complex32},
    {"e.png", &grey8}, {"f.PNG", &grey16},  {"g.jpg", &grey8}};
#define LOSSLESS (COUNT(formats) - 1)

/* Files are written whole, placed among zeros, and again a second later, when a file that holds the
 * time of its making would differ. Decoders run forwards: a request for earlier rows, or the same
 * rows again, must not confuse them. */
CLEAN(what_is_written_comes_back)
{
    static const struct region regions[] = {{30, 5, 10, 20}, {2, 7, 20, 3}, {2, 7, 20, 3},
                                            {52, 0, 1, 71},  {0, 0, 1, 1},  {52, 70, 1, 1},
                                            {0, 5, 53, 1}};
    for (size_t i = 0; i < 2 * COUNT(formats); i++) {
        const struct format *format = &formats[i % COUNT(formats)];
        const struct raster_layout *layout = format->layout;
        const struct region whole = whole_of(layout);
        const size_t size = pixel_size(layout);
        const char *path = file_in(format->name);
        struct swath_file *file;
        size_t count, again_count;
        if (i == COUNT(formats))
            sleep(1);
        if (i < COUNT(formats)) {
            EXPECT_OK(&report, write_image(path, layout, make_image(layout)));
            assert_int_equal(count_entries(folder->path), i + 1);
            continue;
        }
        const unsigned char *before = load(path, &count);
        EXPECT_OK(&report, write_image(path, layout, make_image(layout)));
        const unsigned char *again = load(path, &again_count);
        assert_int_equal(count, again_count);
        assert_memory_equal(before, again, count);
        if (i % COUNT(formats) < LOSSLESS)
            expect_pixels(path, layout, make_image(layout), NULL, NULL);
        const unsigned char *stored = read_file(path, layout, &whole);
        EXPECT_OK(&report, open_image(path, &file));
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
        const unsigned char *patch = make_pixels(layout, &patch_region, 3);
        EXPECT_OK(&report,
                  raster_file_write_placed(&report, path, layout, &patch_region, patch, NULL));
        if (i % COUNT(formats) < LOSSLESS)
            expect_pixels(path, layout, scratch(), &patch_region, patch);
    }
}

CLEAN(a_region_outside_is_refused)
{
    const struct region outside = {40, 0, 14, 1};
    const char *path = file_in("a.png");
    unsigned char *pixels = make_image(&grey8);
    struct swath_file *file;
    EXPECT_OK(&report, write_image(path, &grey8, pixels));
    EXPECT_OK(&report, open_image(path, &file));
    assert_int_equal(swath_file_read(&report, file, &outside, scratch()), SONJECT_ERROR_INPUT);
    swath_file_close(&file);
    assert_int_equal(copy_with_patch(path, path, &outside, pixels, NULL, NULL),
                     SONJECT_ERROR_INPUT);
    assert_int_equal(raster_file_write_placed(&report, path, &grey8, &outside, pixels, NULL),
                     SONJECT_ERROR_STORAGE);
    expect_pixels(path, &grey8, pixels, NULL, NULL);
}

static void expect_attribute(const char *path, const char *name, size_t capacity,
                             const char *expected)
{
    char value[16];
    struct swath_file *file;
    EXPECT_OK(&report, open_image(path, &file));
    assert_int_equal(swath_file_attribute(file, name, value, capacity), expected != NULL);
    if (expected)
        assert_string_equal(value, expected);
    swath_file_close(&file);
}

/* Copies keep pixels and attributes, but neither a JPEG's coding nor a PNG's chunks. */
CLEAN(attributes_stay_in_copies_of_png_and_jpeg_which_are_png)
{
    static const struct format sources[] = {
        {"a.png", &grey8}, {"b.png", &grey16}, {"c.jpg", &grey8}, {"d.tif", &grey8}};
    static const struct raster_attribute attributes[] = {{"sonject:frequency", "100000 Hz"},
                                                         {"sonject:side", "port"}};
    static const char *const channels[] = {"intensity"};
    for (size_t i = 0; i < COUNT(sources); i++) {
        const struct raster_layout *layout = sources[i].layout;
        const struct region whole = whole_of(layout);
        const char *path = file_in(sources[i].name);
        const char *copy = file_in("copy");
        struct swath_file *file;
        size_t count;
        EXPECT_OK(&report, raster_file_write(&report, path, layout, channels, attributes, 2,
                                             make_image(layout)));
        const unsigned char *stored = read_file(path, layout, &whole);
        const unsigned char *patch = make_pixels(layout, &patch_region, 99);
        EXPECT_OK(&report, copy_with_patch(path, copy, &patch_region, patch, NULL, NULL));
        expect_pixels(copy, layout, stored, &patch_region, patch);
        assert_memory_equal(load(copy, &count), i == 3 ? "II*" : "\x89PN", 3);
        EXPECT_OK(&report, open_image(path, &file));
        const char *extension = swath_file_new_extension(file);
        assert_true(i == 3 ? !extension : extension && strcmp(extension, ".png") == 0);
        swath_file_close(&file);
        for (int k = 0; k < 2; k++, path = copy) {
            expect_attribute(path, "sonject:frequency", 10, "100000 Hz"); /* just fits */
            expect_attribute(path, "sonject:frequency", 9, NULL);
            expect_attribute(path, "sonject:side", 16, "port");
            expect_attribute(path, "sonject:side", 0, NULL);
            expect_attribute(path, "channels", 16, "intensity");
            expect_attribute(path, "frequency", 16, NULL);
        }
    }
}

CLEAN(what_a_format_does_not_hold_is_refused)
{
    static const struct raster_layout colour = {4, 4, 3, PIXEL_UINT8};
    static const struct raster_layout empty = {0, 4, 1, PIXEL_UINT8};
    static const struct raster_layout two = {4, 4, 2, PIXEL_UINT8};
    static const struct format refused[] = {
        {"a.png", &real32}, {"a.jpg", &real32}, {"a.jpg", &grey16}, {"a.exr", &real32},
        {"a", &real32},     {"a.png", &two},    {"a.png", &empty},  {"a.tif", &empty}};
    static const char *const pictures[] = {"a.png", "a.tif", "a.jpg"};
    for (size_t i = 0; i < COUNT(refused); i++)
        if (write_image(file_in(refused[i].name), refused[i].layout, scratch()) !=
            SONJECT_ERROR_UNSUPPORTED)
            fail_msg("%s (case %zu) was taken", refused[i].name, i);
    assert_int_equal(count_entries(folder->path), 0);
    for (size_t i = 0; i < COUNT(pictures); i++) {
        EXPECT_OK(&report, write_image(file_in(pictures[i]), &colour, scratch()));
        expect_no_open(file_in(pictures[i]), "has 3 channels; sonject reads 1 (amplitude) or 2");
    }
}

/* Writes a PNG with other sides, bits and colours in its header, whose checksum is right. */
static void say_in_png(const char *path, const uint64_t sides[2], unsigned bits, unsigned colours)
{
    size_t count;
    EXPECT_OK(&report, write_image(path, &grey8, make_image(&grey8)));
    unsigned char *png = load(path, &count);
    number_to_bytes(sides[0], png + 16, 4, true);
    number_to_bytes(sides[1], png + 20, 4, true);
    png[24] = (unsigned char)bits;
    png[25] = (unsigned char)colours;
    number_to_bytes(crc32(0, png + 12, 17), png + 29, 4, true);
    write_bytes(path, png, count);
}

/* A library that takes rows and may fail at one, and a source of rows that may fail. */
struct hand {
    uint64_t taken, fails_at;
    bool has_rows;
};

static bool take_strip(void *user, const unsigned char *rows, uint64_t count)
{
    struct hand *hand = user;
    const bool fails = hand->taken <= hand->fails_at && hand->fails_at < hand->taken + count;
    assert_non_null(rows);
    hand->taken += count;
    return !fails;
}

static sonject_status give_strip(void *user, uint64_t first, uint64_t end, void *pixels)
{
    const struct hand *hand = user;
    assert_true(first < end && pixels);
    return hand->has_rows ? SONJECT_OK : SONJECT_ERROR_INPUT;
}

CLEAN(a_failure_in_the_midst_of_writing_ends_it)
{
    const uint64_t rows = 40; /* three strips */
    struct hand hand = {0, rows, true};
    const struct image_encoding encoding = {
        .path = "a.png",
        .name = "a.png",
        .layout = {.rows = rows, .columns = (uint64_t)1 << 22, .channels = 1, .type = PIXEL_UINT8},
        .give_rows = give_strip,
        .user = &hand};
    bool are_put = false;
    assert_true(2 * rows_at_once(&encoding.layout) < rows);
    EXPECT_OK(&report, encode_rows(&report, &encoding, take_strip, &hand, &are_put));
    assert_true(are_put && hand.taken == rows);
    hand = (struct hand){0, rows / 2, true};
    EXPECT_OK(&report, encode_rows(&report, &encoding, take_strip, &hand, &are_put));
    assert_true(!are_put && hand.taken < rows);
    hand = (struct hand){0, rows, false};
    assert_int_equal(encode_rows(&report, &encoding, take_strip, &hand, &are_put),
                     SONJECT_ERROR_INPUT);
    assert_int_equal(hand.taken, 0);
    assert_int_equal(encoding_failure(&report, &encoding, &(struct library_fault){"", ENOMEM}),
                     SONJECT_ERROR_MEMORY);
    assert_int_equal(encoding_failure(&report, &encoding, &(struct library_fault){"", ENOSPC}),
                     SONJECT_ERROR_STORAGE);
    assert_non_null(strstr(report.message, "No space left"));
    assert_int_equal(encoding_failure(&report, &encoding, &(struct library_fault){"odd", 0}),
                     SONJECT_ERROR_STORAGE);
    assert_non_null(strstr(report.message, "cannot write: odd"));
}

static int jpeg_quality(const char *path)
{
    struct swath_file *file;
    EXPECT_OK(&report, swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file));
    const int quality = swath_file_jpeg_quality(file);
    swath_file_close(&file);
    return quality;
}

CLEAN(the_quality_of_a_jpeg_is_that_it_was_written_with)
{
    const char *path = file_in("a.jpg");
    const unsigned char *pixels = make_image(&grey8);
    size_t count;
    for (int quality = 10; quality <= 100; quality++) {
        EXPECT_OK(&report, raster_file_write_jpeg(&report, path, &grey8, NULL, 0, pixels, quality));
        assert_int_equal(jpeg_quality(path), quality);
    }
    char *bytes = (char *)load(path, &count);
    size_t table = 0;
    while (memcmp(bytes + table, "\xFF\xDB", 2) != 0)
        table++;
    for (size_t i = 0; i < 64; i++) /* behind the table's mark, length and number */
        bytes[table + 5 + i] = i % 2 ? 1 : 120;
    write_bytes(path, bytes, count);
    assert_int_equal(jpeg_quality(path), JPEG_QUALITY_UNTOLD);
    EXPECT_OK(&report, write_image(file_in("a.png"), &grey8, pixels));
    assert_int_equal(jpeg_quality(file_in("a.png")), 0);
}

CLEAN(png_and_jpeg_that_are_not_for_sonject_are_refused)
{
    static const struct {
        unsigned bits, colours;
        const char *part;
    } cases[] = {{1, 0, "1-bit"}, {4, 0, "4-bit"},       {8, 2, "3 channels"}, {8, 3, "PLTE"},
                 {8, 4, "2 ch"},  {16, 6, "4 channels"}, {8, 1, "IHDR"},       {8, 255, "IHDR"}};
    size_t count;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *path = file_in("a.png");
        say_in_png(path, (const uint64_t[]){COLUMNS, ROWS}, cases[i].bits, cases[i].colours);
        expect_no_open(path, cases[i].part);
    }
    const char *path = file_in("a.jpg");
    EXPECT_OK(&report, write_image(path, &grey8, make_image(&grey8)));
    unsigned char *bytes = load(path, &count);
    memcpy(bytes + count / 2, "\xFF\xD9", 2); /* an end: libjpeg fills with grey and only warns */
    write_bytes(path, bytes, count);
    expect_no_open(path, "cut short or damaged");
}

#define EXIF_BYTES 22

/* Writes an image with EXIF data: after the mark of a JPEG, or after the first chunk of a PNG. */
static void write_with_exif(const char *path, bool is_jpeg, const unsigned char *exif)
{
    static unsigned char bytes[1 << 16];
    unsigned char *end = bytes + (is_jpeg ? 2 : 33);
    size_t count;
    EXPECT_OK(&report, write_image(path, &grey8, make_image(&grey8)));
    const unsigned char *image = load(path, &count);
    const size_t before = (size_t)(end - bytes);
    assert_true(count + 100 < sizeof bytes);
    memcpy(bytes, image, before);
    memcpy(end,
           is_jpeg ? "\xFF\xE1\0\x1E"
                     "Exif\0\0"
                   : "\0\0\0\x16"
                     "eXIf",
           is_jpeg ? 10 : 8);
    end += is_jpeg ? 10 : 8;
    memcpy(end, exif, EXIF_BYTES);
    end += EXIF_BYTES;
    if (!is_jpeg) {
        number_to_bytes(crc32(0, end - EXIF_BYTES - 4, EXIF_BYTES + 4), end, 4, true);
        end += 4;
    }
    memcpy(end, image + before, count - before);
    write_bytes(path, bytes, (size_t)(end - bytes) + count - before);
}

/* Upright images are taken, and those whose EXIF data say nothing or point beyond their end. */
CLEAN(images_that_viewers_turn_are_refused)
{
    static const struct {
        unsigned char orientation, offset;
        bool is_turned;
    } cases[] = {{6, 8, true}, {3, 8, true}, {1, 8, false}, {9, 8, false}, {6, 21, false}};
    for (size_t i = 0; i < 2 * COUNT(cases); i++) {
        unsigned char exif[EXIF_BYTES + 1] = "MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\0\0";
        const bool is_jpeg = i % 2 == 0;
        const char *path = file_in(is_jpeg ? "a.jpg" : "a.png");
        struct swath_file *file;
        exif[7] = cases[i / 2].offset;
        exif[19] = cases[i / 2].orientation;
        write_with_exif(path, is_jpeg, exif);
        if (cases[i / 2].is_turned) {
            expect_no_open(path, "write it upright");
        } else {
            EXPECT_OK(&report, open_image(path, &file));
            swath_file_close(&file);
        }
    }
}

CLEAN(absurd_sides_are_refused)
{
    static const uint64_t sides[][2] = {{1u << 31, 1u << 31},
                                        {(1u << 31) - 1, (1u << 31) - 1},
                                        {1u << 20, (1u << 20) + 1},
                                        {0, 5},
                                        {5, 0},
                                        {1u << 19, 1u << 19},
                                        {1, (1u << 31) - 1},
                                        {(1u << 31) - 1, 1},
                                        {0xFFFFFFFF, 0xFFFFFFFF},
                                        {1000001, 1}}; /* more than libpng reads, not too much for
                                                          the file's size */
    for (size_t i = 0; i < COUNT(sides); i++) {
        const char *png = file_in("a.png");
        const char *tiff = file_in("a.tif");
        size_t count;
        say_in_png(png, sides[i], 8, 0);
        expect_no_open(png, i + 1 == COUNT(sides) ? "IHDR" : "");
        EXPECT_OK(&report, write_image(tiff, &grey8, make_image(&grey8)));
        unsigned char *bytes = load(tiff, &count);
        tiff_say(bytes, TIFFTAG_IMAGEWIDTH, sides[i][0]);
        tiff_say(bytes, TIFFTAG_IMAGELENGTH, sides[i][1]);
        write_bytes(tiff, bytes, count);
        if (i + 1 < COUNT(sides))
            expect_no_open(tiff, "");
    }
}

/* Trials of damaged files, and what came of them. */
struct damage {
    const char *source, *copy;
    const unsigned char *patch;
    size_t taken, refused, refused_at_once; /* numbers of files; the last: refused when opened */
};

static void try_damaged(struct damage *damage, const unsigned char *bytes, size_t count)
{
    static unsigned char pixels[ROWS * COLUMNS];
    struct swath_file *file;
    write_bytes(damage->source, bytes, count);
    unlink(damage->copy);
    sonject_status status = open_image(damage->source, &file);
    damage->refused_at_once += status == SONJECT_ERROR_INPUT;
    if (status == SONJECT_OK) {
        struct raster_layout layout;
        swath_file_layout(file, &layout);
        if (region_is_inside(&layout, &patch_region) && layout.channels == 1 &&
            layout.type == PIXEL_UINT8)
            status = swath_file_read(&report, file, &patch_region, pixels);
        THEN(status, swath_file_copy_with_patch(&report, file, damage->copy, &patch_region,
                                                damage->patch, NULL, NULL));
        swath_file_close(&file);
    }
    const bool has_copy = access(damage->copy, F_OK) == 0;
    if (status == SONJECT_OK && has_copy)
        damage->taken++;
    else if (status == SONJECT_ERROR_INPUT && !has_copy && strstr(report.message, damage->source))
        damage->refused++;
}

/* Tries every length near the beginning and the end, and some between. Returns their number. */
static size_t cut_short(struct damage *damage, const unsigned char *bytes, size_t count)
{
    size_t tried = 0;
    for (size_t length = 0; length < count; tried++) {
        try_damaged(damage, bytes, length);
        length += length > 300 && length + 320 < count ? 13 : 1;
    }
    return tried;
}

/* Changes three bytes at a time, half of them near both ends, where directories are. */
static void change_bytes(struct damage *damage, const unsigned char *bytes, size_t count,
                         size_t tries)
{
    static unsigned char changed[BYTES_MOST];
    uint32_t random = 1;
    for (size_t attempt = 0; attempt < tries; attempt++) {
        memcpy(changed, bytes, count);
        for (int j = 0; j < 3; j++) {
            random = random * 1664525u + 1013904223u;
            changed[random % 4 < 2   ? (random >> 8) % count
                    : random % 4 < 3 ? (random >> 8) % 200
                                     : count - 1 - (random >> 8) % 300] =
                (unsigned char)(random >> 24);
        }
        try_damaged(damage, changed, count);
    }
}

/* Files that are cut short are refused at once. Changed bytes give some other image or none, but
 * never a crash, a half-written file or noise. */
CLEAN(files_that_are_cut_short_or_damaged_do_no_harm)
{
    static const char *const names[] = {"plain.tif", "deflate.tif", "lzw.tif", "a.png", "a.jpg"};
    static unsigned char bytes[BYTES_MOST], patch[ROWS * COLUMNS];
    const size_t tries = 150;
    memcpy(patch, make_pixels(&grey8, &patch_region, 2), patch_region.rows * patch_region.columns);
    for (size_t i = 0; i < COUNT(names); i++) {
        char source[TEMPORARY_CAPACITY + 300], copy[TEMPORARY_CAPACITY + 310];
        size_t count, said;
        const struct tiff_build build = {.layout = grey8,
                                         .compression =
                                             i == 1 ? COMPRESSION_ADOBE_DEFLATE : COMPRESSION_LZW,
                                         .predictor = 2,
                                         .is_tiled = i == 2,
                                         .has_second_page = true,
                                         .block_rows = 16,
                                         .block_columns = 16};
        snprintf(source, sizeof source, "%s", temporary_file(folder, names[i]));
        snprintf(copy, sizeof copy, "%s/copy-%s", folder->path, names[i]);
        if (i == 1 || i == 2)
            build_tiff(source, &build, make_image(&grey8));
        else
            EXPECT_OK(&report, write_image(source, &grey8, make_image(&grey8)));
        memcpy(bytes, load(source, &count), BYTES_MOST);
        struct damage cut = {source, copy, patch, 0, 0, 0};
        struct damage changed = cut;
        /* all that is printed meanwhile goes to a file */
        const char *output = temporary_file(folder, "output");
        const int kept[2] = {dup(1), dup(2)};
        FILE *file = fopen(output, "wb");
        assert_non_null(file);
        fflush(NULL);
        for (int k = 0; k < 2; k++)
            (void)dup2(fileno(file), k + 1);
        fclose(file);
        const size_t lengths = cut_short(&cut, bytes, count);
        change_bytes(&changed, bytes, count, tries);
        fflush(NULL);
        for (int k = 0; k < 2; k++) {
            (void)dup2(kept[k], k + 1);
            close(kept[k]);
        }
        const char *words = (const char *)load(output, &said);
        if (said > 0)
            fail_msg("something was printed: %s", words);
        /* a PNG's end mark, which holds no pixels, may be missing */
        const size_t harmless = strcmp(names[i], "a.png") == 0 ? 12 : 0;
        if (cut.refused != lengths - harmless || cut.refused_at_once != cut.refused ||
            cut.taken != harmless || changed.taken + changed.refused != tries)
            fail_msg("%s: of %zu cut short, %zu were refused, %zu at once, and %zu taken; of %zu "
                     "changed, %zu refused and %zu taken, last: %s",
                     names[i], lengths, cut.refused, cut.refused_at_once, cut.taken, tries,
                     changed.refused, changed.taken, report.message);
        try_damaged(&cut, bytes, count);
        assert_int_equal(cut.taken, harmless + 1);
        (void)unlink(copy);
        (void)unlink(source);
        (void)unlink(output);
        assert_int_equal(count_entries(folder->path), 0);
    }
}

struct calls {
    int count, most;
};

static int count_calls(void *user, double fraction, const char *stage)
{
    struct calls *calls = user;
    assert_true(fraction >= 0.0 && fraction <= 1.0 && stage != NULL);
    return ++calls->count == calls->most;
}

/* A limit on the size of files is as near as a test gets to a full disk. */
CLEAN(who_cancels_or_has_a_full_disk_gets_no_file)
{
    static const char *const names[] = {"a.tif", "a.png", "a.jpg"};
    struct rlimit kept;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &kept), 0);
    signal(SIGXFSZ, SIG_IGN);
    for (size_t i = 0; i < COUNT(names); i++) {
        char source[TEMPORARY_CAPACITY + 300], copy[TEMPORARY_CAPACITY + 310];
        struct calls first = {0, 1}, all = {0, -1};
        snprintf(source, sizeof source, "%s", temporary_file(folder, names[i]));
        snprintf(copy, sizeof copy, "%s/copy-%s", folder->path, names[i]);
        const unsigned char *pixels = make_image(&grey8);
        EXPECT_OK(&report, write_image(source, &grey8, pixels));
        assert_int_equal(copy_with_patch(source, copy, &patch_region, pixels, count_calls, &first),
                         SONJECT_CANCELLED);
        for (rlim_t limit = 0; limit < 3000; limit += 200) {
            const struct rlimit low = {limit, kept.rlim_max};
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
            const sonject_status copied =
                copy_with_patch(source, copy, &patch_region, pixels, NULL, NULL);
            const bool names_it = strstr(report.message, copy) != NULL &&
                                  strstr(report.message, "File too large") != NULL;
            const sonject_status written = write_image(copy, &grey8, pixels);
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &kept), 0);
            if (copied != SONJECT_ERROR_STORAGE || !names_it || written != SONJECT_ERROR_STORAGE)
                fail_msg("%s, limit %d: copy %d, write %d, message '%s'", names[i], (int)limit,
                         (int)copied, (int)written, report.message);
            expect_message(copy, "File too large");
            assert_int_equal(count_entries(folder->path), i + 1);
        }
        EXPECT_OK(&report, copy_with_patch(source, copy, &patch_region, pixels, count_calls, &all));
        assert_true(all.count > 0);
        unlink(copy);
    }
}

TEST_PROGRAM(NULL, NULL)
