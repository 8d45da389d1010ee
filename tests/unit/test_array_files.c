/* Arrays of MATLAB and HDF5 files: which sample is where, what a copy keeps, and files that are
 * damaged. */
#include "file_drafts.h"

#include <zlib.h>

#ifdef HAS_HDF5
#include "hdf5_drafts.h"
#endif

/* As the format numbers them. */
enum {
    MAT_INT8 = 1,
    MAT_UINT8 = 2,
    MAT_UINT16 = 4,
    MAT_INT32 = 5,
    MAT_UINT32 = 6,
    MAT_DOUBLE = 9,
    MAT_MATRIX = 14,
    MAT_COMPRESSED = 15,
    MAT_CLASS_DOUBLE = 6
};

static void begin_mat(struct draft *draft)
{
    draft->count = 0;
    memset(draft->bytes, ' ', 116);
    memcpy(draft->bytes, "MATLAB 5.0 MAT-file", 19);
    memset(draft->bytes + 116, 0, 8);
    memcpy(draft->bytes + 124, "\x00\x01IM", 4);
    draft->count = 128;
}

static void add_element(struct draft *draft, uint32_t type, const void *bytes, size_t count)
{
    static const unsigned char zeros[8];
    add_number(draft, type, 4);
    add_number(draft, count, 4);
    add(draft, bytes, count);
    add(draft, zeros, (8 - count % 8) % 8);
}

static size_t number_bytes(uint32_t type)
{
    return type == MAT_DOUBLE ? 8 : type == MAT_UINT16 ? 2 : 1;
}

/* parts: one or two, of rows x columns numbers of the stored type. */
static void add_variable(struct draft *draft, const char *name, uint32_t kind, uint32_t rows,
                         uint32_t columns, uint32_t type, const void *const *parts)
{
    const size_t start = draft->count;
    const uint32_t flags[2] = {kind | (parts[1] ? 0x800u : 0), 0};
    const uint32_t sides[2] = {rows, columns};
    add_element(draft, MAT_MATRIX, "", 0);
    add_element(draft, MAT_UINT32, flags, sizeof flags);
    add_element(draft, MAT_INT32, sides, sizeof sides);
    add_element(draft, MAT_INT8, name, strlen(name));
    for (int i = 0; i < 2 && parts[i]; i++)
        add_element(draft, type, parts[i], rows * columns * number_bytes(type));
    number_to_bytes(draft->count - start - 8, draft->bytes + start + 4, 4, false);
}

/* Column after column: 0.1, 1.1, 2.1, 0.2, ... : row + (column + 1) / 10. */
static double number_at(size_t row, size_t column)
{
    return (double)row + 0.1 * (double)(column + 1);
}

/* A scalar, an image of doubles (with imaginary parts), numbers packed into bytes, and a text. */
static void make_mat(struct draft *draft, bool is_complex)
{
    double numbers[2][ROWS * COLUMNS];
    uint8_t packed[ROWS * COLUMNS];
    const double rate = 48000.0;
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        numbers[0][i] = number_at(i % ROWS, i / ROWS);
        numbers[1][i] = -numbers[0][i];
        packed[i] = (uint8_t)(10 * (i % ROWS) + i / ROWS);
    }
    begin_mat(draft);
    add_variable(draft, "rate", MAT_CLASS_DOUBLE, 1, 1, MAT_DOUBLE,
                 (const void *const[]){&rate, NULL});
    add_variable(draft, "img", MAT_CLASS_DOUBLE, ROWS, COLUMNS, MAT_DOUBLE,
                 (const void *const[]){numbers[0], is_complex ? numbers[1] : NULL});
    add_variable(draft, "packed", MAT_CLASS_DOUBLE, ROWS, COLUMNS, MAT_UINT8,
                 (const void *const[]){packed, NULL});
    add_variable(draft, "note", 4, 1, 4, MAT_UINT16, (const void *const[]){"t\0e\0x\0t", NULL});
}

static void expect_numbers(struct swath_file *file, bool is_patched)
{
    float samples[ROWS * COLUMNS];
    read_all(file, samples);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        const size_t row = i / COLUMNS;
        const size_t column = i % COLUMNS;
        const bool is_new = is_patched && row == 2 && column == 3;
        assert_true(samples[i] == (is_new ? 99.5f : (float)number_at(row, column)));
    }
}

/* What the region inside holds, the last sample changed. */
static const float *changed_samples(void)
{
    static float samples[4];
    for (size_t i = 0; i < 4; i++)
        samples[i] = (float)number_at(1 + i / 2, 2 + i % 2);
    samples[3] = 99.5f;
    return samples;
}

static void test_matlab_array(void **state)
{
    struct draft draft, back;
    make_mat(&draft, false);
    expect_refused(*state, "a.mat", NULL, &draft, "img (3 x 4), packed (3 x 4)");
    expect_refused(*state, "a.mat", "other", NULL, "choose one of img (3 x 4), packed (3 x 4)");
    struct swath_file *file = open_draft(*state, "a.mat", "img", NULL);
    expect_layout(file, 1, PIXEL_FLOAT32);
    expect_numbers(file, false);
    patch(file, *state, "b.mat", changed_samples(), &back);
    swath_file_close(&file);
    /* one double has changed, the last of the last column; 0.1 and the like kept all bits */
    assert_int_equal(back.count, draft.count);
    size_t different = 0;
    size_t last = 0;
    for (size_t i = 0; i < draft.count; i++)
        if (back.bytes[i] != draft.bytes[i]) {
            different++;
            last = i;
        }
    assert_in_range(different, 1, 8);
    double number;
    memcpy(&number, back.bytes + last / 8 * 8, 8);
    assert_true(number == 99.5);
    file = open_draft(*state, "b.mat", "img", NULL);
    expect_numbers(file, true);
    swath_file_close(&file);
}

/* Where MATLAB packed doubles into bytes, the copy has room for any; all else is in place. */
static void test_packed_matlab_array(void **state)
{
    struct draft draft, back;
    float samples[ROWS * COLUMNS];
    make_mat(&draft, false);
    struct swath_file *file = open_draft(*state, "a.mat", "packed", &draft);
    read_all(file, samples);
    assert_true(samples[0] == 0.0f && samples[3] == 3.0f && samples[4] == 10.0f);
    patch(file, *state, "b.mat", (float[]){12.0f, 13.0f, 22.0f, 0.25f}, &back);
    swath_file_close(&file);
    assert_int_equal(back.count, draft.count + 8 * ROWS * COLUMNS - 16);
    file = open_draft(*state, "b.mat", "packed", NULL);
    read_all(file, samples);
    assert_true(samples[11] == 0.25f && samples[10] == 22.0f && samples[4] == 10.0f);
    swath_file_close(&file);
    file = open_draft(*state, "b.mat", "img", NULL);
    expect_numbers(file, false);
    swath_file_close(&file);
    const size_t text = 8 + 16 + 16 + 16 + 16;
    assert_memory_equal(back.bytes + back.count - text, draft.bytes + draft.count - text, text);
}

static void test_complex_matlab_array(void **state)
{
    struct draft draft, back;
    float samples[2 * ROWS * COLUMNS];
    make_mat(&draft, true);
    struct swath_file *file = open_draft(*state, "a.mat", "img", &draft);
    expect_layout(file, 2, PIXEL_FLOAT32);
    read_all(file, samples);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        assert_true(samples[2 * i] == (float)number_at(i / COLUMNS, i % COLUMNS));
        assert_true(samples[2 * i + 1] == -samples[2 * i]);
    }
    patch(file, *state, "b.mat", (float[]){1, 2, 3, 4, 5, 6, 7, 8}, &back);
    swath_file_close(&file);
    file = open_draft(*state, "b.mat", "img", NULL);
    read_all(file, samples);
    assert_true(samples[2 * 6] == 1.0f && samples[2 * 11 + 1] == 8.0f);
    swath_file_close(&file);
}

static void add_compressed(struct draft *draft, const unsigned char *bytes, size_t count)
{
    static unsigned char deflated[LARGEST_FILE];
    uLongf deflated_bytes = sizeof deflated;
    assert_int_equal(compress2(deflated, &deflated_bytes, bytes, (uLong)count, 6), Z_OK);
    add_number(draft, MAT_COMPRESSED, 4);
    add_number(draft, deflated_bytes, 4);
    add(draft, deflated, deflated_bytes);
}

/* The variables of the first draft, each compressed. */
static void compress_all(const struct draft *draft, struct draft *compressed)
{
    begin_mat(compressed);
    for (size_t place = 128; place < draft->count;) {
        const size_t bytes = 8 + (size_t)number_from_bytes(draft->bytes + place + 4, 4, false);
        add_compressed(compressed, draft->bytes + place, bytes);
        place += bytes;
    }
}

static void test_compressed_matlab_array(void **state)
{
    struct draft draft, compressed, back;
    make_mat(&draft, false);
    compress_all(&draft, &compressed);
    struct swath_file *file = open_draft(*state, "a.mat", "img", &compressed);
    expect_numbers(file, false);
    patch(file, *state, "b.mat", changed_samples(), &back);
    swath_file_close(&file);
    file = open_draft(*state, "b.mat", "img", NULL);
    expect_numbers(file, true);
    swath_file_close(&file);
    file = open_draft(*state, "b.mat", "packed", NULL);
    swath_file_close(&file);
    /* the scalar before it, to the byte */
    const size_t before = 8 + (size_t)number_from_bytes(compressed.bytes + 132, 4, false);
    assert_memory_equal(back.bytes, compressed.bytes, 128 + before);
}

#ifdef HAS_HDF5
/* "img" as MATLAB keeps it or rows first; with another one where is_full. */
static void make_hdf5(const char *path, bool is_matlab, bool is_chunked, bool is_complex,
                      bool is_full)
{
    static const char *const pair[] = {"real", "imag"};
    double numbers[2 * ROWS * COLUMNS];
    const hsize_t sides[2] = {is_matlab ? COLUMNS : ROWS, is_matlab ? ROWS : COLUMNS};
    const size_t parts = is_complex ? 2 : 1;
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        const size_t row = is_matlab ? i % ROWS : i / COLUMNS;
        const size_t column = is_matlab ? i / ROWS : i % COLUMNS;
        numbers[parts * i] = number_at(row, column);
        if (is_complex)
            numbers[parts * i + 1] = -number_at(row, column);
    }
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_userblock(creation, is_matlab ? 512 : 0);
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, creation, H5P_DEFAULT);
    assert_true(file >= 0);
    put_set(file, "img", sides, numbers, is_complex ? pair : NULL, is_matlab,
            is_chunked ? (const hsize_t[]){2, 2} : NULL, NULL);
    put_set(file, "scalar", (const hsize_t[]){1, 1}, numbers, NULL, is_matlab, NULL, NULL);
    if (is_full) {
        H5Gclose(H5Gcreate2(file, "more", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        put_set(file, "more/other", sides, numbers, NULL, false, NULL, NULL);
        H5Lcreate_external("elsewhere.h5", "/img", file, "outside", H5P_DEFAULT, H5P_DEFAULT);
    }
    H5Pclose(creation);
    H5Fclose(file);
}

static size_t read_bytes(const char *path, unsigned char *bytes)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t count = fread(bytes, 1, LARGEST_FILE, file);
    fclose(file);
    return count;
}

static void test_hdf5_array(void **state)
{
    static struct draft before, back;
    for (int kind = 0; kind < 4; kind++) {
        const char *path = file_in(*state, "a.h5");
        make_hdf5(path, kind & 1, kind & 2, false, false);
        before.count = read_bytes(path, before.bytes);
        struct swath_file *file = open_draft(*state, "a.h5", NULL, NULL);
        expect_layout(file, 1, PIXEL_FLOAT32);
        expect_numbers(file, false);
        patch(file, *state, "b.h5", changed_samples(), &back);
        swath_file_close(&file);
        file = open_draft(*state, "b.h5", NULL, NULL);
        expect_numbers(file, true);
        swath_file_close(&file);
        if (kind & 2)
            continue;
        size_t different = 0;
        assert_int_equal(back.count, before.count);
        for (size_t i = 0; i < before.count; i++)
            different += back.bytes[i] != before.bytes[i];
        assert_in_range(different, 1, 8); /* one double, nothing else of the file */
    }
}

static void test_complex_hdf5_array(void **state)
{
    float samples[2 * ROWS * COLUMNS];
    make_hdf5(file_in(*state, "a.h5"), true, true, true, false);
    struct swath_file *file = open_draft(*state, "a.h5", NULL, NULL);
    expect_layout(file, 2, PIXEL_FLOAT32);
    read_all(file, samples);
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        assert_true(samples[2 * i] == (float)number_at(i / COLUMNS, i % COLUMNS));
        assert_true(samples[2 * i + 1] == -samples[2 * i]);
    }
    swath_file_close(&file);
}

static void test_hdf5_names(void **state)
{
    make_hdf5(file_in(*state, "a.h5"), false, false, false, true);
    expect_refused(*state, "a.h5", NULL, NULL, "img (3 x 4), more/other (3 x 4)");
    expect_refused(*state, "a.h5", "none", NULL, "choose one of img (3 x 4), more/other (3 x 4)");
    expect_refused(*state, "a.h5", "outside", NULL, "holds no array 'outside'");
    struct swath_file *file = open_draft(*state, "a.h5", "/more/other", NULL);
    expect_layout(file, 1, PIXEL_FLOAT32);
    swath_file_close(&file);
}
#endif

/* The scalar and the image alone, so that the image is the only one. */
static void keep_two(struct draft *draft)
{
    size_t place = 128;
    for (int i = 0; i < 2; i++)
        place += 8 + (size_t)number_from_bytes(draft->bytes + place + 4, 4, false);
    draft->count = place;
}

static void test_damaged_matlab_arrays(void **state)
{
    struct draft draft, compressed;
    make_mat(&draft, true);
    keep_two(&draft);
    mutate(*state, "line.mat", SONJECT_CHANNEL_ONLY, draft.bytes, draft.count, MUTATIONS);
    compress_all(&draft, &compressed);
    mutate(*state, "line.mat", SONJECT_CHANNEL_ONLY, compressed.bytes, compressed.count, MUTATIONS);
}

/* 2^31 x 2^31 doubles, and 4 GB, in a few hundred bytes. */
static void test_matlab_sizes_that_lie(void **state)
{
    struct draft draft, compressed;
    make_mat(&draft, false);
    keep_two(&draft);
    const size_t image = 128 + 8 + (size_t)number_from_bytes(draft.bytes + 132, 4, false);
    memset(draft.bytes + image + 8 + 16 + 8, 0x7F, 8);
    expect_refused(*state, "a.mat", NULL, &draft, "damaged");
    make_mat(&draft, false);
    keep_two(&draft);
    memset(draft.bytes + image + 4, 0xFF, 4);
    begin_mat(&compressed);
    add_compressed(&compressed, draft.bytes + image, draft.count - image);
    expect_refused(*state, "a.mat", NULL, &compressed, "damaged");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_matlab_array),
        cmocka_unit_test(test_packed_matlab_array),
        cmocka_unit_test(test_complex_matlab_array),
        cmocka_unit_test(test_compressed_matlab_array),
#ifdef HAS_HDF5
        cmocka_unit_test(test_hdf5_array),
        cmocka_unit_test(test_complex_hdf5_array),
        cmocka_unit_test(test_hdf5_names),
#endif
        cmocka_unit_test(test_damaged_matlab_arrays),
        cmocka_unit_test(test_matlab_sizes_that_lie),
    };
    return cmocka_run_group_tests(tests, make_temporary_folder, remove_temporary_folder);
}
