/* PGM, PFM, BMP and OpenEXR images: which sample is where, what a copy is, and files that are cut
 * short or damaged. */
#include "file_drafts.h"

#define SAMPLES (ROWS * COLUMNS)

static void add_float(struct draft *draft, float sample, bool is_big_endian)
{
    unsigned char bytes[4];
    uint32_t word;
    memcpy(&word, &sample, sizeof word);
    number_to_bytes(word, bytes, 4, is_big_endian);
    add(draft, bytes, 4);
}

static void make_pgm(struct draft *draft)
{
    static const char head[] = "P5\n# a note\n4 3 # width, height\n255\n";
    draft->count = 0;
    add(draft, head, sizeof head - 1);
    for (unsigned i = 0; i < SAMPLES; i++)
        add_number(draft, 23 * i, 1);
}

/* The file's first row is the image's last. */
static void make_pfm(struct draft *draft, bool is_big_endian)
{
    const char *head = is_big_endian ? "Pf\n4 3\n1.0\n" : "Pf\n4 3\n-1.0\n";
    draft->count = 0;
    add(draft, head, strlen(head));
    for (unsigned i = 0; i < SAMPLES; i++)
        add_float(draft, 0.1f * (float)((ROWS - 1 - i / COLUMNS) * COLUMNS + i % COLUMNS),
                  is_big_endian);
}

static void make_little_pfm(struct draft *draft)
{
    make_pfm(draft, false);
}

static void make_big_pfm(struct draft *draft)
{
    make_pfm(draft, true);
}

/* From the last row up. */
static void make_bmp(struct draft *draft)
{
    draft->count = 0;
    add(draft, "BM", 2);
    add_number(draft, 54 + 1024 + SAMPLES, 4);
    add_number(draft, 0, 4);
    add_number(draft, 54 + 1024, 4);
    add_number(draft, 40, 4);
    add_number(draft, COLUMNS, 4);
    add_number(draft, ROWS, 4);
    add_number(draft, 1, 2);
    add_number(draft, 8, 2);
    for (int i = 0; i < 6; i++)
        add_number(draft, 0, 4);
    for (unsigned i = 0; i < 256; i++)
        add_number(draft, i * 0x010101, 4);
    for (unsigned i = 0; i < SAMPLES; i++)
        add_number(draft, 23 * ((ROWS - 1 - i / COLUMNS) * COLUMNS + i % COLUMNS), 1);
}

static void add_attribute(struct draft *draft, const char *name, const char *kind,
                          const void *content, size_t count)
{
    add(draft, name, strlen(name) + 1);
    add(draft, kind, strlen(kind) + 1);
    add_number(draft, count, 4);
    add(draft, content, count);
}

/* Without compression, so without any check of the samples. */
static void make_exr(struct draft *draft)
{
    static const unsigned char channel[19] = {'Y', 0, 2, [10] = 1, [14] = 1};
    static const unsigned char window[16] = {[8] = COLUMNS - 1, [12] = ROWS - 1};
    static const unsigned char zeros[8] = {0};
    static const unsigned char one[4] = {0, 0, 0x80, 0x3F};
    draft->count = 0;
    add(draft, "\x76\x2F\x31\x01\x02\0\0\0", 8);
    add_attribute(draft, "channels", "chlist", channel, sizeof channel);
    add_attribute(draft, "compression", "compression", zeros, 1);
    add_attribute(draft, "dataWindow", "box2i", window, 16);
    add_attribute(draft, "displayWindow", "box2i", window, 16);
    add_attribute(draft, "lineOrder", "lineOrder", zeros, 1);
    add_attribute(draft, "pixelAspectRatio", "float", one, 4);
    add_attribute(draft, "screenWindowCenter", "v2f", zeros, 8);
    add_attribute(draft, "screenWindowWidth", "float", one, 4);
    add(draft, zeros, 1);
    const size_t first = draft->count + (size_t)8 * ROWS;
    for (unsigned row = 0; row < ROWS; row++)
        add_number(draft, first + row * (8 + 4 * COLUMNS), 8);
    for (unsigned row = 0; row < ROWS; row++) {
        add_number(draft, row, 4);
        add_number(draft, 4 * COLUMNS, 4);
        for (unsigned column = 0; column < COLUMNS; column++)
            add_float(draft, 0.1f * (float)(row * COLUMNS + column), false);
    }
}

static const struct kind {
    const char *name;
    void (*make)(struct draft *draft);
    enum pixel_type type;
    size_t data; /* bytes of samples at the end */
} kinds[] = {{"a.pgm", make_pgm, PIXEL_UINT8, SAMPLES},
             {"a.pfm", make_little_pfm, PIXEL_FLOAT32, 4 * SAMPLES},
             {"b.pfm", make_big_pfm, PIXEL_FLOAT32, 4 * SAMPLES},
             {"a.bmp", make_bmp, PIXEL_UINT8, SAMPLES},
             {"a.exr", make_exr, PIXEL_FLOAT32, 4 * SAMPLES + 16 * ROWS}};
#define KINDS (sizeof kinds / sizeof *kinds)

/* Row after row: 0, 23, 46... or 0, 0.1, 0.2... */
static double sample_of(enum pixel_type type, unsigned i)
{
    return type == PIXEL_FLOAT32 ? (double)(0.1f * (float)i) : 23.0 * i;
}

static double number_in(enum pixel_type type, const void *samples, unsigned i)
{
    return type == PIXEL_FLOAT32 ? (double)((const float *)samples)[i]
                                 : (double)((const uint8_t *)samples)[i];
}

/* OK: it was read; is_right: every sample is. */
static sonject_status take_by(const struct report_host *by, const char *path,
                              const struct kind *kind, bool *is_right)
{
    struct report report = {{0}, NULL, by};
    struct swath_file *file;
    struct raster_layout layout;
    float samples[SAMPLES];
    const struct region whole = {0, 0, ROWS, COLUMNS};
    sonject_status status = swath_file_open_array(&report, path, SONJECT_CHANNEL_ONLY, NULL, &file);
    *is_right = false;
    if (status == SONJECT_OK) {
        swath_file_layout(file, &layout);
        *is_right = layout.rows == ROWS && layout.columns == COLUMNS && layout.channels == 1 &&
                    layout.type == kind->type;
        if (*is_right)
            status = swath_file_read(&report, file, &whole, samples);
    }
    for (unsigned i = 0; *is_right && status == SONJECT_OK && i < SAMPLES; i++)
        *is_right = number_in(kind->type, samples, i) == sample_of(kind->type, i);
    swath_file_close(&file);
    return status;
}

static sonject_status take(const char *path, const struct kind *kind, bool *is_right)
{
    return take_by(&host, path, kind, is_right);
}

static void test_every_sample_is_read_by_the_child_and_here(void **state)
{
    struct decoder own = {.is_in_process = true};
    const struct report_host alone = {.decoder = &own};
    for (size_t i = 0; i < KINDS; i++) {
        struct draft draft;
        bool is_right;
        kinds[i].make(&draft);
        const char *path = file_in(*state, kinds[i].name);
        write_file(path, draft.bytes, draft.count);
        assert_int_equal(take(path, &kinds[i], &is_right), SONJECT_OK);
        assert_true(is_right);
        assert_int_equal(take_by(&alone, path, &kinds[i], &is_right), SONJECT_OK);
        assert_true(is_right);
    }
    assert_true(decoder.starts == 1 && own.starts == 0);
    decoder_stop(&own);
}

static void test_a_cut_file_is_never_taken(void **state)
{
    for (size_t i = 0; i < KINDS; i++) {
        struct draft draft;
        bool is_right;
        kinds[i].make(&draft);
        const char *path = file_in(*state, kinds[i].name);
        for (size_t count = 0; count < draft.count; count++) {
            write_file(path, draft.bytes, count);
            const sonject_status status = take(path, &kinds[i], &is_right);
            if (status != SONJECT_ERROR_INPUT)
                fail_msg("%s, %zu bytes of %zu: status %d", kinds[i].name, count, draft.count,
                         (int)status);
        }
    }
}

/* Samples of these files have no checksums, but what their heads say does not fit together. That
 * the sign of a PFM's scale, which tells the order of bytes, is another one nothing tells. */
static void test_a_damaged_head_never_gives_other_samples(void **state)
{
    for (size_t i = 0; i < KINDS; i++) {
        struct draft draft;
        bool is_right;
        kinds[i].make(&draft);
        const char *path = file_in(*state, kinds[i].name);
        for (size_t place = 0; place < draft.count - kinds[i].data; place++)
            for (unsigned change = 0; change < 4; change++) {
                const unsigned char kept = draft.bytes[place];
                draft.bytes[place] =
                    (unsigned char)(change < 3 ? kept ^ (1u << 3 * change) : 0xFFu);
                write_file(path, draft.bytes, draft.count);
                const sonject_status status = take(path, &kinds[i], &is_right);
                if (status == SONJECT_OK ? !is_right : status != SONJECT_ERROR_INPUT)
                    fail_msg("%s, byte %zu is %u in place of %u: status %d", kinds[i].name, place,
                             draft.bytes[place], kept, (int)status);
                draft.bytes[place] = kept;
            }
    }
}

static void test_a_copy_is_a_tiff_of_all_samples(void **state)
{
    for (size_t i = 0; i < KINDS; i++) {
        struct draft draft, back;
        float fresh[4], samples[SAMPLES];
        kinds[i].make(&draft);
        struct swath_file *file = open_draft(*state, kinds[i].name, NULL, &draft);
        assert_string_equal(swath_file_new_extension(file), ".tif");
        memset(fresh, 0x42, sizeof fresh);
        patch(file, *state, "copy.tif", fresh, &back);
        swath_file_close(&file);
        file = open_draft(*state, "copy.tif", NULL, NULL);
        assert_null(swath_file_new_extension(file));
        expect_layout(file, 1, kinds[i].type);
        read_all(file, samples);
        swath_file_close(&file);
        for (unsigned k = 0; k < SAMPLES; k++) {
            const bool is_new = k / COLUMNS >= 1 && k % COLUMNS >= 2;
            assert_true(
                number_in(kinds[i].type, samples, k) ==
                (is_new ? number_in(kinds[i].type, fresh, 0) : sample_of(kinds[i].type, k)));
        }
    }
}

/* OpenImageIO would hand on other numbers than the file has. */
static void test_scaled_numbers_are_refused(void **state)
{
    struct draft draft = {"Pf 4 3 2.0\n", 11};
    expect_refused(*state, "a.pfm", NULL, &draft, "scaled");
    draft = (struct draft){"P5 1 2 4095\nabcd", 16};
    expect_refused(*state, "a.pgm", NULL, &draft, "no PGM of 8 bits");
    draft = (struct draft){"P5 1 2 65535\nabcd", 17};
    expect_refused(*state, "a.pgm", NULL, &draft, "no PGM of 8 bits");
    draft = (struct draft){"P5 4294967296 4294967296 255\n", 29};
    expect_refused(*state, "a.pgm", NULL, &draft, "does not tell its size");
    make_bmp(&draft);
    draft.bytes[46] = 16; /* levels of grey */
    expect_refused(*state, "a.bmp", NULL, &draft, "not a plain grey image");
}

/* Formats that sonject does not read are named, and those that it reads. */
static void test_foreign_formats(void **state)
{
    static const struct {
        const char *bytes, *words;
    } foreign[] = {{"SDPX and more of it", "is a DPX file"},
                   {"8BPS and more of it", "is a PSD file"},
                   {"P6 and more of it all", "is a PPM file"},
                   {"#?RADIANCE and more", "is a Radiance file"},
                   {"\x01\xDA\x01\x01 and more of it all", "is an SGI file"},
                   {"FOR4 and more of it all", "is an IFF file"},
                   {"DDS and more of it all", "is a DDS file"},
                   {"abcdftypheic and on it", "is a HEIF file"},
                   {"\0\0\0\x0CjP  \r\n\x87\n and more", "is a JPEG 2000 file"},
                   {"\xFF\x4F\xFF\x51 and more of it", "is a JPEG 2000 file"},
                   {"SIMPLE  =          T", "is a FITS file"},
                   {"\0\0\3\0\0\0\0\0\0\0\0\0\4\0\3\0\x08 it", "is a Targa file"},
                   {"nothing that is known", "of no format that sonject knows"}};
    for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) {
        struct draft draft = {{0}, 0};
        add(&draft, foreign[i].bytes, 19);
        expect_refused(*state, "a.bin", NULL, &draft, foreign[i].words);
        expect_refused(*state, "a.bin", NULL, &draft,
                       "TIFF, PNG, JPEG, OpenEXR, PGM (P5), PFM (Pf), BMP, XTF, NumPy (.npy), HDF5 "
                       "and MATLAB");
    }
}

TEST_PROGRAM(make_temporary_folder, remove_temporary_folder,
             TEST(test_every_sample_is_read_by_the_child_and_here),
             TEST(test_a_cut_file_is_never_taken),
             TEST(test_a_damaged_head_never_gives_other_samples),
             TEST(test_a_copy_is_a_tiff_of_all_samples), TEST(test_scaled_numbers_are_refused),
             TEST(test_foreign_formats))
