/* OpenEXR images: what a copy keeps, and files that say what is not so. */
#include "file_drafts.h"

#define ROW_BYTES   ((size_t)COLUMNS * 4)
#define CHUNK_BYTES (8 + ROW_BYTES)
#define DATA_BYTES  (ROWS * (8 + CHUNK_BYTES))

static void add_attribute(struct draft *draft, const char *name, const char *kind,
                          const void *content, size_t count)
{
    add(draft, name, strlen(name) + 1);
    add(draft, kind, strlen(kind) + 1);
    add_number(draft, count, 4);
    add(draft, content, count);
}

static float sample_at(unsigned row, unsigned column)
{
    return 0.1f * (float)(row * COLUMNS + column);
}

/* One channel of 32-bit samples without compression. more: another attribute, or NULL. */
static void make_exr(struct draft *draft, bool is_upwards, const char *more, const char *kind,
                     const void *content, size_t count)
{
    static const unsigned char channel[] = {'Y', 0, 2, 0, 0, 0, 0, 0, 0, 0,
                                            1,   0, 0, 0, 1, 0, 0, 0, 0};
    static const unsigned char window[16] = {[8] = COLUMNS - 1, [12] = ROWS - 1};
    static const unsigned char zeros[8] = {0};
    static const unsigned char one[4] = {0, 0, 0x80, 0x3F};
    draft->count = 0;
    add(draft, "\x76\x2F\x31\x01\x02\0\0\0", 8);
    add_attribute(draft, "channels", "chlist", channel, sizeof channel);
    add_attribute(draft, "compression", "compression", zeros, 1);
    add_attribute(draft, "dataWindow", "box2i", window, 16);
    add_attribute(draft, "displayWindow", "box2i", window, 16);
    add_attribute(draft, "lineOrder", "lineOrder", is_upwards ? "\1" : "\0", 1);
    add_attribute(draft, "pixelAspectRatio", "float", one, 4);
    add_attribute(draft, "screenWindowCenter", "v2f", zeros, 8);
    add_attribute(draft, "screenWindowWidth", "float", one, 4);
    if (more)
        add_attribute(draft, more, kind, content, count);
    add(draft, zeros, 1);
    const size_t first = draft->count + (size_t)8 * ROWS;
    for (unsigned row = 0; row < ROWS; row++)
        add_number(draft, first + (is_upwards ? ROWS - 1 - row : row) * CHUNK_BYTES, 8);
    for (unsigned i = 0; i < ROWS; i++) {
        const unsigned row = is_upwards ? ROWS - 1 - i : i;
        add_number(draft, row, 4);
        add_number(draft, ROW_BYTES, 4);
        for (unsigned column = 0; column < COLUMNS; column++) {
            const float sample = sample_at(row, column);
            uint32_t word;
            memcpy(&word, &sample, sizeof word);
            add_number(draft, word, 4);
        }
    }
}

static size_t place_of(const struct draft *draft, const char *word)
{
    for (size_t i = 0; i + strlen(word) < draft->count; i++)
        if (memcmp(draft->bytes + i, word, strlen(word) + 1) == 0)
            return i;
    fail_msg("there is no %s", word);
    return 0;
}

static void put(struct draft *draft, size_t place, uint64_t number, size_t bytes)
{
    number_to_bytes(number, draft->bytes + place, bytes, false);
}

/* Attributes of kinds that nobody knows among it, and the order of rows. */
static void test_a_copy_keeps_all_but_the_samples(void **state)
{
    for (int is_upwards = 0; is_upwards < 2; is_upwards++) {
        static const float fresh[] = {7.0f, 8.0f, 9.0f, 10.0f};
        struct draft draft, back;
        float samples[ROWS * COLUMNS];
        make_exr(&draft, is_upwards, "sonar", "of its maker", "\1\2\3", 3);
        struct swath_file *file = open_draft(*state, "a.exr", NULL, &draft);
        expect_layout(file, 1, PIXEL_FLOAT32);
        read_all(file, samples);
        for (unsigned i = 0; i < ROWS * COLUMNS; i++)
            assert_true(samples[i] == sample_at(i / COLUMNS, i % COLUMNS));
        patch(file, *state, "b.exr", fresh, &back);
        swath_file_close(&file);
        for (unsigned row = 0; row < 2; row++) {
            const unsigned chunk = is_upwards ? ROWS - 2 - row : row + 1;
            unsigned char *at = draft.bytes + draft.count - (ROWS - chunk) * CHUNK_BYTES + 8 + 8;
            for (unsigned i = 0; i < 2; i++) {
                uint32_t word;
                memcpy(&word, &fresh[2 * row + i], sizeof word);
                number_to_bytes(word, at + 4 * i, 4, false);
            }
        }
        assert_int_equal(back.count, draft.count);
        assert_memory_equal(back.bytes, draft.bytes, draft.count);
    }
}

static void test_headers_that_lie(void **state)
{
    struct draft draft;
    static const struct {
        const char *attribute;
        size_t place; /* behind name, kind and count */
        uint64_t number;
        size_t bytes;
        const char *words;
    } lies[] = {
        {"compression", 0, 5, 1, "compressed by pxr24"},
        {"compression", 0, 10, 1, "compressed in no way"},
        {"compression", 0, 255, 1, "compressed in no way"},
        {"lineOrder", 0, 2, 1, "in no order"},
        {"dataWindow", 8, 4, 4, "cut short or damaged at rows 0...0"},
        {"dataWindow", 8, 1 << 22, 4, "more than the 1048576 columns"},
        {"dataWindow", 8, 0x7FFFFFFF, 4, "its window is nowhere"},
        {"dataWindow", 0, COLUMNS, 4, "it has no pixels"},
        {"dataWindow", 12, 1 << 29, 4, "cannot hold 536870913 rows"},
        {"dataWindow", 4, 0xFFFFFFFF, 4, "cut short or damaged at rows"},
        {"channels", 2, 3, 4, "of no type"},
        {"channels", 10, 2, 4, "a channel of fewer pixels"},
        {"channels", 0, 0, 1, "it has no channels"},
    };
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        make_exr(&draft, false, NULL, NULL, NULL, 0);
        const size_t name = place_of(&draft, lies[i].attribute);
        const size_t kind = name + strlen(lies[i].attribute) + 1;
        const size_t content = kind + strlen((const char *)draft.bytes + kind) + 1 + 4;
        put(&draft, content + lies[i].place, lies[i].number, lies[i].bytes);
        expect_refused(*state, "a.exr", NULL, &draft, lies[i].words);
    }
    static const unsigned char preview[12] = {[2] = 1, [6] = 1}; /* 65536 x 65536 */
    make_exr(&draft, false, "preview", "preview", preview, sizeof preview);
    expect_refused(*state, "a.exr", NULL, &draft, "its preview is of another size");
    make_exr(&draft, false, "lineOrder", "lineOrder", "\0", 1);
    expect_refused(*state, "a.exr", NULL, &draft, "its header is not as it must be");
    make_exr(&draft, false, NULL, NULL, NULL, 0);
    draft.bytes[place_of(&draft, "lineOrder")] = 'L';
    expect_refused(*state, "a.exr", NULL, &draft, "lacks what it must say");
    static const unsigned char flags[] = {0x02, 0x08, 0x10};
    for (size_t i = 0; i < sizeof flags; i++) {
        make_exr(&draft, false, NULL, NULL, NULL, 0);
        draft.bytes[5] = flags[i];
        expect_refused(*state, "a.exr", NULL, &draft, "tiles, several parts or depths");
    }
}

/* Many rows of one chunk would be decoded from a file of few bytes. */
static void test_chunks_that_lie(void **state)
{
    struct draft draft;
    make_exr(&draft, false, NULL, NULL, NULL, 0);
    const size_t table = draft.count - DATA_BYTES;
    const size_t first = table + (size_t)8 * ROWS;
    static const struct {
        size_t chunk, place; /* in its head */
        uint64_t number;
    } lies[] = {{1, 0, 0}, {1, 0, 2}, {2, 4, ROW_BYTES + 1}, {0, 4, ROW_BYTES - 4}, {0, 4, 0}};
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        make_exr(&draft, false, NULL, NULL, NULL, 0);
        put(&draft, first + lies[i].chunk * CHUNK_BYTES + lies[i].place, lies[i].number, 4);
        expect_refused(*state, "a.exr", NULL, &draft, "cut short or damaged at rows");
    }
    const uint64_t places[] = {0, table, first + CHUNK_BYTES, draft.count - 4, UINT64_MAX};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        make_exr(&draft, false, NULL, NULL, NULL, 0);
        put(&draft, table, places[i], 8);
        expect_refused(*state, "a.exr", NULL, &draft, "cut short or damaged at rows 0...0");
    }
    make_exr(&draft, false, NULL, NULL, NULL, 0);
    draft.count--;
    expect_refused(*state, "a.exr", NULL, &draft, "cut short or damaged at rows 2...2");
    make_exr(&draft, false, NULL, NULL, NULL, 0);
    draft.count -= CHUNK_BYTES;
    put(&draft, table + 8 * 2, first + 12, 8); /* within the samples of the first */
    put(&draft, first + 12, 2, 4);
    put(&draft, first + 16, ROW_BYTES, 4);
    expect_refused(*state, "a.exr", NULL, &draft, "cut short or damaged at rows 2...2");
    draft.count = table - 1;
    expect_refused(*state, "a.exr", NULL, &draft, "its header does not end");
}

static void test_damaged_files(void **state)
{
    struct draft draft;
    make_exr(&draft, false, "comments", "string", "of a sonar", 10);
    mutate(*state, "line.exr", SONJECT_CHANNEL_ONLY, draft.bytes, draft.count, MUTATIONS / 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_copy_keeps_all_but_the_samples),
        cmocka_unit_test(test_headers_that_lie),
        cmocka_unit_test(test_chunks_that_lie),
        cmocka_unit_test(test_damaged_files),
    };
    return cmocka_run_group_tests(tests, make_temporary_folder, remove_temporary_folder);
}
