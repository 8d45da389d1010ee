/* Images of plain rows, PGM, PFM, BMP, Targa and FITS: which sample is where, what a copy keeps,
 * and files that are damaged. */
#include "file_drafts.h"

static void make_pgm(struct draft *draft, unsigned largest)
{
    char head[100];
    snprintf(head, sizeof head, "P5\n# sonject:side=port\n%d %d # width, height\n%u\n", COLUMNS,
             ROWS, largest);
    draft->count = 0;
    add(draft, head, strlen(head));
    for (unsigned i = 0; i < ROWS * COLUMNS; i++) {
        const unsigned char sample[2] = {(unsigned char)(3 * i >> 8), (unsigned char)(3 * i)};
        add(draft, sample + (largest < 256), largest < 256 ? 1 : 2);
    }
}

static void test_pgm(void **state)
{
    struct draft draft, back;
    struct report report = {{0}, NULL, NULL};
    uint16_t wide[ROWS * COLUMNS];
    uint8_t narrow[ROWS * COLUMNS];
    char side[8] = "";
    make_pgm(&draft, 4095);
    struct swath_file *file = open_draft(*state, "a.pgm", NULL, &draft);
    expect_layout(file, 1, PIXEL_UINT16);
    assert_int_equal(swath_file_largest(file), 4095);
    assert_true(swath_file_attribute(file, "sonject:side", side, sizeof side));
    assert_string_equal(side, "port");
    read_all(file, wide);
    for (unsigned i = 0; i < ROWS * COLUMNS; i++)
        assert_int_equal(wide[i], 3 * i);
    patch(file, *state, "b.pgm", (uint16_t[]){1000, 1001, 1002, 4095}, &back);
    assert_int_equal(back.count, draft.count);
    const size_t first = draft.count - 2 * ROWS * COLUMNS;
    for (size_t i = 0; i < draft.count; i++) {
        const size_t sample = i < first ? 0 : (i - first) / 2;
        if (i < first || sample / COLUMNS < 1 || sample % COLUMNS < 2)
            assert_int_equal(back.bytes[i], draft.bytes[i]);
    }
    assert_memory_equal(back.bytes + first + 2 * 6, "\x03\xE8\x03\xE9", 4);
    assert_memory_equal(back.bytes + first + 2 * 10, "\x03\xEA\x0F\xFF", 4);
    const uint16_t too_large[4] = {1, 2, 3, 4096};
    assert_int_equal(swath_file_copy_with_patch(&report, file, file_in(*state, "c.pgm"), &inside,
                                                too_large, NULL, NULL),
                     SONJECT_ERROR_INPUT);
    assert_non_null(strstr(report.message, "row 2, column 3 is 4096"));
    swath_file_close(&file);
    make_pgm(&draft, 200);
    file = open_draft(*state, "a.pgm", NULL, &draft);
    expect_layout(file, 1, PIXEL_UINT8);
    read_all(file, narrow);
    assert_int_equal(narrow[11], 33);
    swath_file_close(&file);
}

static void make_pfm(struct draft *draft, bool is_big_endian)
{
    const char *head = is_big_endian ? "Pf\n4 3\n1.0\n" : "Pf\n4 3\n-1.0\n";
    draft->count = 0;
    add(draft, head, strlen(head));
    for (unsigned i = 0; i < ROWS * COLUMNS; i++) {
        const float sample = 0.1f * (float)i;
        unsigned char bytes[4];
        uint32_t word;
        memcpy(&word, &sample, sizeof word);
        number_to_bytes(word, bytes, 4, is_big_endian);
        add(draft, bytes, 4);
    }
}

/* The file's first row is the image's last. */
static void test_pfm(void **state)
{
    for (int order = 0; order < 2; order++) {
        struct draft draft, back;
        float samples[ROWS * COLUMNS];
        make_pfm(&draft, order);
        struct swath_file *file = open_draft(*state, "a.pfm", NULL, &draft);
        expect_layout(file, 1, PIXEL_FLOAT32);
        read_all(file, samples);
        for (unsigned i = 0; i < ROWS * COLUMNS; i++)
            assert_true(samples[i] ==
                        0.1f * (float)((ROWS - 1 - i / COLUMNS) * COLUMNS + i % COLUMNS));
        patch(file, *state, "b.pfm", (float[]){7.0f, 8.0f, 9.0f, 10.0f}, &back);
        swath_file_close(&file);
        assert_int_equal(back.count, draft.count);
        file = open_draft(*state, "b.pfm", NULL, NULL);
        read_all(file, samples);
        assert_true(samples[6] == 7.0f && samples[11] == 10.0f && samples[5] == 0.1f * 5.0f);
        swath_file_close(&file);
    }
    struct draft draft = {"Pf 4 3 2.0\n", 11};
    expect_refused(*state, "a.pfm", NULL, &draft, "scaled");
    draft = (struct draft){"P5 4 3 255\nabc", 14};
    expect_refused(*state, "a.pgm", NULL, &draft, "cut short");
    draft = (struct draft){"P5 4294967296 4294967296 255\n", 29};
    expect_refused(*state, "a.pgm", NULL, &draft, "width or height");
}

/* Rows of 4 samples and no padding, or of 3 and one byte of it. */
static void make_bmp(struct draft *draft, uint32_t columns, int32_t rows, uint32_t levels)
{
    const uint32_t kept = levels ? levels : 256;
    draft->count = 0;
    add(draft, "BM", 2);
    add_number(draft, 54 + 4 * kept + 4 * ROWS, 4);
    add_number(draft, 0, 4);
    add_number(draft, 54 + 4 * kept, 4);
    add_number(draft, 40, 4);
    add_number(draft, columns, 4);
    add_number(draft, (uint32_t)rows, 4);
    add_number(draft, 1 | 8 << 16, 4); /* planes, bits */
    add_number(draft, 0, 4);
    add_number(draft, 0, 4);
    add_number(draft, 2835, 4);
    add_number(draft, 2835, 4);
    add_number(draft, levels, 4);
    add_number(draft, 0, 4);
    for (uint32_t i = 0; i < kept; i++)
        add_number(draft, i * 0x010101, 4);
    for (unsigned char i = 0; i < 4 * ROWS; i++)
        add(draft, &i, 1);
}

/* The file's first row is the image's last, but where its height is negative. */
static void test_bmp(void **state)
{
    struct draft draft, back;
    struct report report = {{0}, NULL, NULL};
    struct raster_layout layout;
    uint8_t samples[ROWS * COLUMNS];
    for (int is_upright = 0; is_upright < 2; is_upright++) {
        make_bmp(&draft, COLUMNS, is_upright ? -ROWS : ROWS, 0);
        struct swath_file *file = open_draft(*state, "a.bmp", NULL, &draft);
        expect_layout(file, 1, PIXEL_UINT8);
        read_all(file, samples);
        assert_int_equal(samples[0], is_upright ? 0 : 8);
        assert_int_equal(samples[7], 7);
        patch(file, *state, "b.bmp", (uint8_t[]){100, 101, 102, 103}, &back);
        assert_int_equal(back.count, draft.count);
        const size_t first = draft.count - ROWS * COLUMNS;
        assert_memory_equal(back.bytes, draft.bytes, first);
        assert_memory_equal(back.bytes + first + 6, "\x64\x65", 2);
        assert_memory_equal(back.bytes + first + (is_upright ? 10 : 2), "\x66\x67", 2);
        swath_file_close(&file);
    }
    make_bmp(&draft, 3, ROWS, 20);
    struct swath_file *file = open_draft(*state, "a.bmp", NULL, &draft);
    swath_file_layout(file, &layout);
    assert_int_equal(layout.columns, 3);
    assert_int_equal(swath_file_largest(file), 19);
    const struct region all = {0, 0, ROWS, 3};
    assert_int_equal(swath_file_read(&report, file, &all, samples), SONJECT_OK);
    assert_memory_equal(samples, "\x08\x09\x0a\x04\x05\x06\x00\x01\x02", 9);
    swath_file_close(&file);
    draft.count--;
    expect_refused(*state, "a.bmp", NULL, &draft, "cut short");
    make_bmp(&draft, COLUMNS, ROWS, 0);
    draft.bytes[54 + 4 * 7] ^= 1;
    expect_refused(*state, "a.bmp", NULL, &draft, "not a plain grey image");
    make_bmp(&draft, COLUMNS, ROWS, 257);
    expect_refused(*state, "a.bmp", NULL, &draft, "not a plain grey image");
    make_bmp(&draft, COLUMNS, ROWS, 0);
    draft.bytes[11] = 0; /* pixels from byte 54 on, where the palette is */
    expect_refused(*state, "a.bmp", NULL, &draft, "pixels begin within its head");
    make_bmp(&draft, 0x7FFFFFFF, INT32_MIN, 0);
    expect_refused(*state, "a.bmp", NULL, &draft, "cut short");
}

static void add_card(struct draft *draft, const char *card)
{
    char text[81];
    snprintf(text, sizeof text, "%-80s", card);
    add(draft, text, 80);
}

static void fill_block(struct draft *draft, int filler)
{
    while (draft->count % 2880 != 0)
        draft->bytes[draft->count++] = (unsigned char)filler;
}

/* Numbers 3 i + base, stored in the first `bytes` of big-endian words. */
static void make_fits(struct draft *draft, const char *bits, const char *more, uint64_t base,
                      size_t bytes)
{
    draft->count = 0;
    add_card(draft, "SIMPLE  =                    T / as the standard wants");
    add_card(draft, bits);
    add_card(draft, "NAXIS   =                    2");
    add_card(draft, "NAXIS1  =                    4 / columns");
    add_card(draft, "NAXIS2  =                    3");
    add_card(draft, more);
    add_card(draft, "END");
    fill_block(draft, ' ');
    for (unsigned i = 0; i < ROWS * COLUMNS; i++) {
        unsigned char word[8];
        number_to_bytes(base + 3 * i, word, bytes, true);
        add(draft, word, bytes);
    }
    fill_block(draft, 0);
}

#define BITS_8   "BITPIX  =                    8"
#define BITS_16  "BITPIX  =                   16"
#define BITS_32F "BITPIX  = -32"

/* corner: where the first sample is, as the head's last byte says. */
static void make_tga(struct draft *draft, unsigned corner)
{
    draft->count = 0;
    add(draft, "\4\0\3\0\0\0\0\0\0\0\0\0", 12);
    add_number(draft, COLUMNS, 2);
    add_number(draft, ROWS, 2);
    add_number(draft, 8 | corner << 8, 2);
    add(draft, "note", 4);
    for (unsigned char i = 0; i < ROWS * COLUMNS; i++)
        add(draft, &i, 1);
    add(draft, "\0\0\0\0\0\0\0\0TRUEVISION-XFILE.", 26);
}

/* Rows go up or down, columns to the right or to the left. */
static void test_tga(void **state)
{
    static const struct {
        unsigned corner;
        uint8_t first, last;
        const char *bottom, *top; /* the replaced samples' rows in the file */
    } corners[] = {{0x00, 8, 3, "\x66\x67", "\x64\x65"},
                   {0x10, 11, 0, "\x67\x66", "\x65\x64"},
                   {0x20, 0, 11, "\x64\x65", "\x66\x67"},
                   {0x30, 3, 8, "\x65\x64", "\x67\x66"}};
    struct draft draft, back;
    uint8_t samples[ROWS * COLUMNS];
    for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
        const bool is_upright = corners[i].corner & 0x20;
        const size_t in_row = corners[i].corner & 0x10 ? 0 : 2;
        make_tga(&draft, corners[i].corner);
        struct swath_file *file = open_draft(*state, "a.tga", NULL, &draft);
        expect_layout(file, 1, PIXEL_UINT8);
        read_all(file, samples);
        assert_int_equal(samples[0], corners[i].first);
        assert_int_equal(samples[ROWS * COLUMNS - 1], corners[i].last);
        patch(file, *state, "b.tga", (uint8_t[]){100, 101, 102, 103}, &back);
        const size_t row = 22 + in_row + (is_upright ? COLUMNS : 0);
        memcpy(draft.bytes + row, corners[i].bottom, 2);
        memcpy(draft.bytes + row + COLUMNS, corners[i].top, 2);
        assert_int_equal(back.count, draft.count);
        assert_memory_equal(back.bytes, draft.bytes, draft.count);
        swath_file_close(&file);
    }
}

static void test_refused_tga(void **state)
{
    static const struct {
        size_t place;
        const char *bytes;
        size_t count;
        const char *words;
    } lies[] = {{1, "\1\1", 2, "not a plain grey Targa"},
                {1, "\1", 1, "not a plain grey Targa"},
                {2, "\2", 1, "not a plain grey Targa"},
                {2, "\x0A", 1, "not a plain grey Targa"},
                {16, "\x10\x08", 2, "not a plain grey Targa"},
                {16, "\x18", 1, "not a plain grey Targa"},
                {17, "\x08", 1, "not a plain grey Targa"},
                {2, "\x0B", 1, "runs of equal samples"},
                {2, "\0", 1, "of no format"},
                {2, "\1", 1, "of no format"},
                {5, "\1", 1, "of no format"},
                {12, "\0\0", 2, "of no format"},
                {14, "\0\0", 2, "of no format"},
                {16, "\x09", 1, "of no format"},
                {17, "\x80", 1, "of no format"},
                {12, "\xFF\xFF\xFF\xFF", 4, "cut short"},
                {0, "\xFF", 1, "cut short"}};
    struct draft draft;
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        make_tga(&draft, 0);
        memcpy(draft.bytes + lies[i].place, lies[i].bytes, lies[i].count);
        expect_refused(*state, "a.tga", NULL, &draft, lies[i].words);
    }
    make_tga(&draft, 0);
    for (draft.count = 0; draft.count < 22 + ROWS * COLUMNS; draft.count++)
        expect_refused(*state, "a.tga", NULL, &draft,
                       draft.count == 0   ? "is empty"
                       : draft.count < 18 ? "of no format"
                                          : "cut short");
}

static void test_fits(void **state)
{
    struct draft draft, back;
    struct report report = {{0}, NULL, NULL};
    uint8_t narrow[ROWS * COLUMNS];
    uint16_t wide[ROWS * COLUMNS];
    float real[ROWS * COLUMNS];
    make_fits(&draft, BITS_8, "", 1, 1);
    struct swath_file *file = open_draft(*state, "a.fits", NULL, &draft);
    expect_layout(file, 1, PIXEL_UINT8);
    read_all(file, narrow);
    assert_int_equal(narrow[11], 34);
    swath_file_close(&file);
    /* 40000 and on, stored as 7232 and on */
    make_fits(&draft, BITS_16, "BZERO   =              32768.0", 40000 - 32768, 2);
    file = open_draft(*state, "a.fits", NULL, &draft);
    expect_layout(file, 1, PIXEL_UINT16);
    assert_int_equal(swath_file_largest(file), 0);
    read_all(file, wide);
    for (unsigned i = 0; i < ROWS * COLUMNS; i++)
        assert_int_equal(wide[i], 40000 + 3 * i);
    patch(file, *state, "b.fits", (uint16_t[]){0, 32768, 65535, 1}, &back);
    swath_file_close(&file);
    assert_int_equal(back.count, draft.count);
    assert_memory_equal(back.bytes, draft.bytes, 2880 + 12);
    assert_memory_equal(back.bytes + 2880 + 12, "\x80\x00\x00\x00", 4);
    assert_memory_equal(back.bytes + 2880 + 20, "\x7f\xff\x80\x01", 4);
    assert_memory_equal(back.bytes + 2880 + 24, draft.bytes + 2880 + 24, 2880 - 24);
    make_fits(&draft, BITS_16, "", 32767 - 30, 2); /* the last one is negative */
    file = open_draft(*state, "a.fits", NULL, &draft);
    assert_int_equal(swath_file_largest(file), 32767);
    const struct region whole = {0, 0, ROWS, COLUMNS};
    assert_int_equal(swath_file_read(&report, file, &whole, wide), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(report.message, "row 2, column 3 is negative"));
    swath_file_close(&file);
    make_fits(&draft, BITS_32F, "BSCALE  = 1.", 0x3F800000, 4);
    file = open_draft(*state, "a.fits", NULL, &draft);
    expect_layout(file, 1, PIXEL_FLOAT32);
    read_all(file, real);
    assert_true(real[0] == 1.0f && real[1] > 1.0f);
    swath_file_close(&file);
}

static void test_refused_fits(void **state)
{
    static const struct {
        const char *bits, *more, *words;
    } refused[] = {
        {"BITPIX  = -64", "", "of a type that sonject does not read"},
        {BITS_8, "BSCALE  = 2", "numbers are scaled"},
        {BITS_8, "BZERO   = 32768", "numbers are scaled"},
        {BITS_16, "BSCALE  = 1.0D0", "numbers are scaled"}, /* which it might be */
        {BITS_8, "NAXIS   = 3", "no image of rows and columns"},
        {BITS_8, "NAXIS   = 0", "no image of rows and columns"},
        {BITS_8, "NAXIS1  = 3.5", "no image of rows and columns"},
        {BITS_8, "NAXIS2  = 2147483647", "cut short"},
        {BITS_16, "NAXIS2  = 1e300", "no image of rows and columns"},
        {"BITPIX  = eight", "", "lacks BITPIX"},
        {BITS_16, "BLANK   = -32768", "samples of one number mean none"},
    };
    struct draft draft;
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        make_fits(&draft, refused[i].bits, refused[i].more, 0, 1);
        expect_refused(*state, "a.fits", NULL, &draft, refused[i].words);
    }
    draft.count = 2880 - 1;
    expect_refused(*state, "a.fits", NULL, &draft, "header does not end");
}

static uint32_t sum_words(const unsigned char *bytes, size_t count)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i += 4)
        sum += number_from_bytes(bytes + i, 4, true);
    while (sum >> 32)
        sum = (sum & 0xFFFFFFFF) + (sum >> 32);
    return (uint32_t)sum;
}

static void put_card(struct draft *draft, size_t number, const char *card)
{
    char text[81];
    snprintf(text, sizeof text, "%-80s", card);
    memcpy(draft->bytes + 80 * number, text, 80);
}

/* With sums that are right: a number in card 8 makes them so. */
static void make_summed_fits(struct draft *draft)
{
    char card[81];
    make_fits(draft, BITS_16, "BZERO   = 32768", 100, 2);
    const uint32_t data = sum_words(draft->bytes + 2880, 2880);
    snprintf(card, sizeof card, "DATASUM = '%lu' / of the numbers", (unsigned long)data);
    put_card(draft, 6, card);
    put_card(draft, 7, "CHECKSUM= 'abcdefghijklmnop'   / of all");
    put_card(draft, 8, "");
    put_card(draft, 9, "END");
    number_to_bytes(0, draft->bytes + 80 * 8 + 40, 4, true);
    number_to_bytes(~sum_words(draft->bytes, draft->count) & 0xFFFFFFFF, draft->bytes + 80 * 8 + 40,
                    4, true);
}

/* A copy's sums are those of its numbers, and of all its words all ones, as the standard wants it;
 * sums that are wrong before are not made right. */
static void test_sums_of_fits(void **state)
{
    struct draft draft, back;
    struct report report = {{0}, NULL, NULL};
    make_summed_fits(&draft);
    assert_int_equal(sum_words(draft.bytes, draft.count), 0xFFFFFFFF);
    struct swath_file *file = open_draft(*state, "a.fits", NULL, &draft);
    for (unsigned i = 0; i < 40; i++) {
        const uint16_t fresh[4] = {(uint16_t)(7919 * i), (uint16_t)(104729 * i), 0,
                                   (uint16_t)(31 * i)};
        char card[81];
        patch(file, *state, "b.fits", fresh, &back);
        assert_int_equal(sum_words(back.bytes, back.count), 0xFFFFFFFF);
        assert_int_equal(back.count, draft.count);
        assert_memory_equal(back.bytes, draft.bytes, 80 * 6);
        snprintf(card, sizeof card, "DATASUM = '%lu'",
                 (unsigned long)sum_words(back.bytes + 2880, 2880));
        assert_memory_equal(back.bytes + 80 * 6, card, strlen(card) - 1);
        assert_non_null(memchr(back.bytes + 80 * 6 + strlen(card) - 1, '\'', 4));
        assert_memory_equal(back.bytes + 80 * 7, draft.bytes + 80 * 7, 11);
        for (size_t k = 80 * 7 + 11; k < 80 * 7 + 27; k++)
            assert_true((back.bytes[k] >= '0' && back.bytes[k] <= '9') ||
                        (back.bytes[k] >= 'A' && back.bytes[k] <= 'Z') ||
                        (back.bytes[k] >= 'a' && back.bytes[k] <= 'z'));
        assert_memory_equal(back.bytes + 80 * 7 + 27, draft.bytes + 80 * 7 + 27,
                            2880 - 80 * 7 - 27);
    }
    swath_file_close(&file);
    for (size_t i = 0; i < 2; i++) { /* in the numbers, in the sum over them */
        make_summed_fits(&draft);
        draft.bytes[i ? 80 * 6 + 11 : 2880 + 3] ^= 1;
        file = open_draft(*state, "a.fits", NULL, &draft);
        assert_int_equal(swath_file_copy_with_patch(&report, file, file_in(*state, "b.fits"),
                                                    &inside, draft.bytes, NULL, NULL),
                         SONJECT_ERROR_INPUT);
        assert_non_null(strstr(report.message, "its sums (DATASUM, CHECKSUM)"));
        swath_file_close(&file);
    }
}

static void test_damaged_images(void **state)
{
    struct draft draft;
    make_pgm(&draft, 4095);
    mutate(*state, "line.pgm", SONJECT_CHANNEL_ONLY, draft.bytes, draft.count, MUTATIONS);
    make_pfm(&draft, false);
    mutate(*state, "line.pfm", SONJECT_CHANNEL_ONLY, draft.bytes, draft.count, MUTATIONS);
    make_bmp(&draft, 3, ROWS, 0);
    mutate(*state, "line.bmp", SONJECT_CHANNEL_ONLY, draft.bytes, draft.count, MUTATIONS);
    make_tga(&draft, 0x20);
    mutate(*state, "line.tga", SONJECT_CHANNEL_ONLY, draft.bytes, draft.count, MUTATIONS);
    make_summed_fits(&draft);
    mutate(*state, "line.fits", SONJECT_CHANNEL_ONLY, draft.bytes, draft.count, MUTATIONS);
}

/* Formats that sonject does not read are named, and those that it reads. */
static void test_foreign_formats(void **state)
{
    static const struct {
        const char *bytes, *words;
    } foreign[] = {{"SDPX and more of it", "is a DPX file"},
                   {"8BPS and more of it", "is a PSD file"},
                   {"BM and more of it all", "of no format that sonject knows"},
                   {"P6 and more of it all", "is a PPM file"},
                   {"#?RADIANCE and more", "is a Radiance file"},
                   {"\x01\xDA\x01\x01 and more of it all", "is an SGI file"},
                   {"FOR4 and more of it all", "is an IFF file"},
                   {"DDS and more of it all", "is a DDS file"},
                   {"abcdftypheic and on it", "is a HEIF file"},
                   {"nothing that is known", "of no format that sonject knows"}};
    for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) {
        struct draft draft = {{0}, 0};
        add(&draft, foreign[i].bytes, 19);
        expect_refused(*state, "a.bin", NULL, &draft, foreign[i].words);
        expect_refused(
            *state, "a.bin", NULL, &draft,
            "TIFF, PNG, JPEG, JPEG 2000, OpenEXR, PGM (P5), PFM (Pf), BMP, Targa, FITS, XTF, NumPy "
            "(.npy), HDF5 and MATLAB");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pgm),
        cmocka_unit_test(test_pfm),
        cmocka_unit_test(test_bmp),
        cmocka_unit_test(test_tga),
        cmocka_unit_test(test_refused_tga),
        cmocka_unit_test(test_fits),
        cmocka_unit_test(test_refused_fits),
        cmocka_unit_test(test_sums_of_fits),
        cmocka_unit_test(test_damaged_images),
        cmocka_unit_test(test_foreign_formats),
    };
    return cmocka_run_group_tests(tests, make_temporary_folder, remove_temporary_folder);
}
