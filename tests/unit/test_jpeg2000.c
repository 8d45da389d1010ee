/* JPEG 2000 images: what a copy keeps, and files that say what is not so. */
#include "file_drafts.h"

#define SIDE 40 /* columns; fewer rows */

/* Where the parts of a draft with boxes are. */
#define BRAND_PLACE 28
#define HEADS_PLACE 32
#define IMAGE_HEAD  48
#define CODED_PLACE 77
#define STREAM      85
#define SIZE_PLACE  (STREAM + 4)
#define CODING      (STREAM + 45)
#define STEPS       (CODING + 14)
#define TILES       (STEPS + 6)

struct shape {
    uint64_t rows, columns, tile_rows, tile_columns;
    unsigned bits;
};

static const struct shape plain = {33, SIDE, 33, SIDE, 8};

static void add_big(struct draft *draft, uint64_t number, size_t size)
{
    unsigned char bytes[8];
    number_to_bytes(number, bytes, size, true);
    add(draft, bytes, size);
}

/* Every packet is empty, so all samples are of the middle level. */
static void add_stream(struct draft *draft, const struct shape *shape)
{
    const uint64_t tiles = ((shape->rows + shape->tile_rows - 1) / shape->tile_rows) *
                           ((shape->columns + shape->tile_columns - 1) / shape->tile_columns);
    add(draft, "\xFF\x4F\xFF\x51\0\x29\0\0", 8);
    add_big(draft, shape->columns, 4);
    add_big(draft, shape->rows, 4);
    add_big(draft, 0, 8);
    add_big(draft, shape->tile_columns, 4);
    add_big(draft, shape->tile_rows, 4);
    add_big(draft, 0, 8);
    add_big(draft, 1, 2);
    add_big(draft, shape->bits - 1, 1);
    add(draft, "\1\1", 2);
    add(draft, "\xFF\x52\0\x0C\0\0\0\1\0\0\4\4\0\1", 14); /* a layer, nothing halved, exact */
    add(draft, "\xFF\x5C\0\4\x40", 5);
    add_big(draft, shape->bits << 3, 1);
    for (uint64_t i = 0; i < tiles; i++) {
        add(draft, "\xFF\x90\0\x0A", 4);
        add_big(draft, i, 2);
        add_big(draft, 15, 4);
        add(draft, "\0\1\xFF\x93\0", 5);
    }
    add(draft, "\xFF\xD9", 2);
}

static void make_jp2(struct draft *draft, const struct shape *shape)
{
    draft->count = 0;
    add(draft, "\0\0\0\x0CjP  \x0D\x0A\x87\x0A", 12);
    add(draft,
        "\0\0\0\x14"
        "ftypjp2 \0\0\0\0jp2 ",
        20);
    add(draft, "\0\0\0\x2Djp2h\0\0\0\x16ihdr", 16);
    add_big(draft, shape->rows, 4);
    add_big(draft, shape->columns, 4);
    add_big(draft, 1, 2);
    add_big(draft, shape->bits - 1, 1);
    add(draft, "\7\0\0", 3);
    add(draft,
        "\0\0\0\x0F"
        "colr\1\0\0\0\0\0\x11",
        15);
    const size_t place = draft->count;
    add(draft, "\0\0\0\0jp2c", 8);
    add_stream(draft, shape);
    number_to_bytes(draft->count - place, draft->bytes + place, 4, true);
    add(draft, "\0\0\0\x0Cxml <a/>", 12);
}

static void make_noise(unsigned char *samples, size_t count, uint32_t seed)
{
    for (size_t i = 0; i < count; i++) {
        seed = seed * 1664525u + 1013904223u;
        samples[i] = (unsigned char)(seed >> 24);
    }
}

static void copy(struct swath_file *file, const char *path, const struct region *region,
                 const void *samples)
{
    struct report report = {{0}, NULL, NULL};
    if (swath_file_copy_with_patch(&report, file, path, region, samples, NULL, NULL) != SONJECT_OK)
        fail_msg("%s", report.message);
}

static void load(const char *path, struct draft *draft)
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    draft->count = fread(draft->bytes, 1, sizeof draft->bytes, stream);
    fclose(stream);
}

static void expect_samples(struct swath_file *file, const struct region *whole,
                           const unsigned char *expected, size_t count)
{
    static unsigned char found[2 * SIDE * SIDE];
    struct report report = {{0}, NULL, NULL};
    assert_true(count <= sizeof found);
    if (swath_file_read(&report, file, whole, found) != SONJECT_OK)
        fail_msg("%s", report.message);
    assert_memory_equal(found, expected, count);
}

/* Samples of all levels come back, those around a patch as they were, and so do all boxes. */
static void expect_copies(const char *folder, const struct shape *shape)
{
    static const struct region part = {5, 7, 9, 11};
    const struct region whole = {0, 0, shape->rows, shape->columns};
    static unsigned char samples[2 * SIDE * SIDE];
    struct draft draft, back;
    struct raster_layout layout;
    unsigned char fresh[2 * 9 * 11];
    const size_t bytes = shape->bits / 8;
    const size_t count = (size_t)(shape->rows * shape->columns) * bytes;
    make_jp2(&draft, shape);
    struct swath_file *file = open_draft(folder, "a.jp2", NULL, &draft);
    swath_file_layout(file, &layout);
    assert_int_equal(layout.rows, shape->rows);
    assert_int_equal(layout.columns, shape->columns);
    assert_int_equal(layout.channels, 1);
    assert_int_equal(layout.type, bytes == 1 ? PIXEL_UINT8 : PIXEL_UINT16);
    assert_true(swath_file_is_lossless(file));
    make_noise(samples, count, 1);
    copy(file, file_in(folder, "b.jp2"), &whole, samples);
    swath_file_close(&file);
    file = open_draft(folder, "b.jp2", NULL, NULL);
    expect_samples(file, &whole, samples, count);
    make_noise(fresh, sizeof fresh, 2);
    copy(file, file_in(folder, "c.jp2"), &part, fresh);
    swath_file_close(&file);
    for (size_t row = 0; row < part.rows; row++)
        memcpy(samples + ((part.first_row + row) * shape->columns + part.first_column) * bytes,
               fresh + row * part.columns * bytes, part.columns * bytes);
    file = open_draft(folder, "c.jp2", NULL, NULL);
    expect_samples(file, &whole, samples, count);
    swath_file_close(&file);
    load(file_in(folder, "c.jp2"), &back);
    assert_memory_equal(back.bytes, draft.bytes, CODED_PLACE);
    assert_memory_equal(back.bytes + back.count - 12, draft.bytes + draft.count - 12, 12);
}

static void test_copies(void **state)
{
    const struct shape shapes[] = {plain, {33, SIDE, 33, SIDE, 16}, {SIDE, 35, 16, 9, 16}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        expect_copies(*state, &shapes[i]);
}

static void test_without_boxes(void **state)
{
    static const struct region whole = {0, 0, 33, SIDE};
    static unsigned char samples[33 * SIDE];
    struct draft draft = {{0}, 0};
    add_stream(&draft, &plain);
    make_noise(samples, sizeof samples, 3);
    struct swath_file *file = open_draft(*state, "a.j2k", NULL, &draft);
    copy(file, file_in(*state, "b.j2k"), &whole, samples);
    swath_file_close(&file);
    file = open_draft(*state, "b.j2k", NULL, NULL);
    expect_samples(file, &whole, samples, sizeof samples);
    swath_file_close(&file);
    load(file_in(*state, "b.j2k"), &draft);
    assert_memory_equal(draft.bytes, "\xFF\x4F\xFF\x51", 4);
}

struct lie {
    size_t place;
    const char *bytes;
    size_t count;
    const char *words;
};

static void test_lies(void **state)
{
    static const struct lie lies[] = {
        {0, "\0\0\0\x0D", 4, "of no format"},
        {8, "\x0A", 1, "its boxes are not as they must be"},
        {12, "\xFF\xFF\xFF\xFF", 4, "its boxes are not as they must be"},
        {12, "\0\0\0\4", 4, "its boxes are not as they must be"},
        {BRAND_PLACE, "jpx ", 4, NULL},
        {HEADS_PLACE, "\0\0\0\x1C", 4, "its boxes are not as they must be"},
        {HEADS_PLACE + 4, "free", 4, "its boxes are not as they must be"},
        {IMAGE_HEAD + 3, "\x22", 1, "do not agree"},
        {IMAGE_HEAD + 7, "\x20", 1, "do not agree"},
        {IMAGE_HEAD + 10, "\x0F", 1, "do not agree"},
        {IMAGE_HEAD + 18, "pclr", 4, "palette or transparency"},
        {IMAGE_HEAD + 18, "cdef", 4, "palette or transparency"},
        {CODED_PLACE + 4, "xml ", 4, "its boxes are not as they must be"},
        {CODED_PLACE, "\0\0\0\1", 4, "its boxes are not as they must be"},
        {SIZE_PLACE, "\0\x28", 2, "not one a pixel"},
        {SIZE_PLACE + 4, "\0\0\0\x1F", 4, "fewer than the 32 rows and columns"},
        {SIZE_PLACE + 8, "\0\0\0\0", 4, "fewer than the 32 rows and columns"},
        {SIZE_PLACE + 4, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", 8, "more than the 2^27 pixels"},
        {SIZE_PLACE + 4, "\0\1\0\0\0\0\4\0", 8, "cut short"},
        {SIZE_PLACE + 15, "\1", 1, "have an offset"},
        {SIZE_PLACE + 35, "\1", 1, "have an offset"},
        {SIZE_PLACE + 20, "\0\0\0\0", 4, "tiles have no size"},
        {SIZE_PLACE + 20, "\xFF\xFF\xFF\xFF", 4, "tiles have no size"},
        {SIZE_PLACE + 4, "\0\0\4\0\0\0\4\0\0\0\0\0\0\0\0\0\0\0\0\1\0\0\0\1", 24,
         "more than 16384 tiles"},
        {SIZE_PLACE + 20, "\0\0\0\x14", 4, "cut short"}, /* two tiles, of which one is there */
        {SIZE_PLACE + 36, "\0\3", 2, "has 3 components"},
        {SIZE_PLACE + 38, "\x0B", 1, "has 12-bit unsigned"},
        {SIZE_PLACE + 38, "\x87", 1, "has 8-bit signed"},
        {SIZE_PLACE + 39, "\2", 1, "not one a pixel"},
        {CODING + 1, "\x53", 1, "marker FF53"},
        {CODING + 2, "\xFF\xFF", 2, "cut short"},
        {CODING + 2, "\0\1", 2, "cut short"},
        {CODING + 6, "\0\0", 2, "in no way that there is"},
        {CODING + 6, "\xFF\xFF", 2, "too many parts"},
        {CODING + 8, "\1", 1, "in no way that there is"},
        {CODING + 9, "\x21", 1, "in no way that there is"},
        {CODING + 10, "\0", 1, "too many parts"},
        {CODING + 10, "\5", 1, "too many parts"},
        {CODING + 13, "\2", 1, "in no way that there is"},
        {STEPS + 1, "\x64", 1, "does not say how it is coded"},
        {TILES + 4, "\0\1", 2, "cut short"},
        {TILES + 6, "\0\0\0\x10", 4, "cut short"},
        {TILES + 6, "\0\0\0\x0D", 4, "cut short"},
        {TILES + 6, "\xFF\xFF\xFF\xFF", 4, "cut short"},
        {TILES + 10, "\1", 1, "cut short"},
        {TILES + 11, "\2", 1, "cut short"},
        {TILES + 12, "\xFF\x52", 2, "cut short"},
        {TILES + 15, "\xFF\xD8", 2, "cut short"},
    };
    struct draft draft;
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        make_jp2(&draft, &plain);
        memcpy(draft.bytes + lies[i].place, lies[i].bytes, lies[i].count);
        if (lies[i].words) {
            expect_refused(*state, "a.jp2", NULL, &draft, lies[i].words);
        } else { /* the one that says that it keeps to this part as well */
            struct swath_file *file = open_draft(*state, "a.jp2", NULL, &draft);
            swath_file_close(&file);
        }
    }
    make_jp2(&draft, &plain);
    memcpy(draft.bytes + 20, "jpx \0\0\0\0jpx ", 12);
    expect_refused(*state, "a.jp2", NULL, &draft, "another part of JPEG 2000");
    make_jp2(&draft, &plain);
    const size_t image = draft.count - 12 - CODED_PLACE;
    memmove(draft.bytes + draft.count, draft.bytes + CODED_PLACE, image);
    draft.count += image;
    expect_refused(*state, "a.jp2", NULL, &draft, "several images");
}

/* Sizes of precincts, one for each time that the image is halved: many small ones. */
static void test_many_precincts(void **state)
{
    static const struct shape large = {1024, 1024, 1024, 1024, 8};
    struct draft draft = {{0}, 0}, tail = {{0}, 0};
    add_stream(&draft, &large);
    const size_t coding = 45;
    add(&tail, draft.bytes + coding + 14, draft.count - coding - 14);
    for (int small = 0; small < 2; small++) {
        draft.count = coding;
        add(&draft, "\xFF\x52\0\x0D\1\0\0\1\0\0\4\4\0\1", 14);
        add(&draft, small ? "\1" : "\x77", 1);
        add(&draft, tail.bytes, tail.count);
        if (small) {
            expect_refused(*state, "a.j2k", NULL, &draft, "too many parts");
        } else {
            struct swath_file *file = open_draft(*state, "a.j2k", NULL, &draft);
            swath_file_close(&file);
        }
    }
}

/* A draft of coded noise, as the encoder makes it. */
static void make_coded(const char *folder, struct draft *draft)
{
    static const struct region whole = {0, 0, 33, SIDE};
    static unsigned char samples[33 * SIDE];
    make_jp2(draft, &plain);
    make_noise(samples, sizeof samples, 4);
    struct swath_file *file = open_draft(folder, "a.jp2", NULL, draft);
    copy(file, file_in(folder, "b.jp2"), &whole, samples);
    swath_file_close(&file);
    load(file_in(folder, "b.jp2"), draft);
}

static void test_cut_short(void **state)
{
    struct draft draft, shorter;
    make_coded(*state, &draft);
    const size_t count = draft.count;
    for (draft.count = 0; draft.count < count; draft.count++)
        if (draft.count != count - 12) /* without the last box it is whole */
            expect_refused(*state, "c.jp2", NULL, &draft, "c.jp2: ");
    /* what is missing from the coded image, with lengths that fit: its tile's is too long */
    for (size_t missing = 1; missing < 200; missing += 9) {
        const size_t end = count - 14; /* of what is coded: the end's marker and a box follow */
        memcpy(shorter.bytes, draft.bytes, end - missing);
        memcpy(shorter.bytes + end - missing, draft.bytes + end, 14);
        number_to_bytes(count - 12 - CODED_PLACE - missing, shorter.bytes + CODED_PLACE, 4, true);
        shorter.count = count - missing;
        expect_refused(*state, "c.jp2", NULL, &shorter, "cut short");
    }
}

static void test_damaged(void **state)
{
    struct draft draft;
    make_coded(*state, &draft);
    mutate(*state, "line.jp2", SONJECT_CHANNEL_ONLY, draft.bytes, draft.count, MUTATIONS / 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_copies),    cmocka_unit_test(test_without_boxes),
        cmocka_unit_test(test_lies),      cmocka_unit_test(test_many_precincts),
        cmocka_unit_test(test_cut_short), cmocka_unit_test(test_damaged),
    };
    return cmocka_run_group_tests(tests, make_temporary_folder, remove_temporary_folder);
}
