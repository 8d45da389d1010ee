/* Mesh files that somebody spoilt, on purpose or not: every one is read or refused in one line that
 * names it, takes memory in proportion to its size, and leaves nothing behind (run under
 * sanitizers and valgrind). */
#define _POSIX_C_SOURCE 200809L

#include "claims.h"
#include "mesh/mesh.h"
#include "mesh_drafts.h"
#include "temporary_folder.h"

#ifndef MUTATIONS
#define MUTATIONS 2000
#endif

#define BYTES_MAX 65536

/* A triangle takes some 100 bytes while its mesh is made ready, and two bytes of a file can
 * make one ("f 1 2 3 1 2 3 ..."). To this come what is read at once, and the first steps of arrays
 * that grow. */
#define MEMORY_PER_BYTE 100
#define MEMORY_AT_ONCE  ((size_t)128 * 1024)

#if defined(COUNTS_MEMORY)
#include <malloc.h>

static size_t memory, memory_peak;

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t bytes);
void *__real_realloc(void *old, size_t bytes);
void __real_free(void *old);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t bytes);
void *__wrap_realloc(void *old, size_t bytes);
void __wrap_free(void *old);

static void *counted(void *made)
{
    memory += made ? malloc_usable_size(made) : 0;
    memory_peak = memory > memory_peak ? memory : memory_peak;
    return made;
}

void *__wrap_malloc(size_t bytes)
{
    return counted(__real_malloc(bytes));
}

void *__wrap_calloc(size_t count, size_t bytes)
{
    return counted(__real_calloc(count, bytes));
}

void *__wrap_realloc(void *old, size_t bytes)
{
    const size_t before = old ? malloc_usable_size(old) : 0;
    void *made = __real_realloc(old, bytes);
    memory -= made ? before : 0;
    return counted(made);
}

void __wrap_free(void *old)
{
    memory -= old ? malloc_usable_size(old) : 0;
    __real_free(old);
}

static size_t begin_counting(void)
{
    memory_peak = memory;
    return memory;
}

/* Nothing is left, and it never was more than the file's size allows. */
static void expect_bounded(size_t before, size_t file_bytes)
{
    assert_int_equal(memory, before);
    if (memory_peak - before > MEMORY_PER_BYTE * file_bytes + MEMORY_AT_ONCE)
        fail_msg("%zu bytes of memory for %zu bytes of a file", memory_peak - before, file_bytes);
}
#else
static size_t begin_counting(void)
{
    return 0;
}

static void expect_bounded(size_t before, size_t file_bytes)
{
    (void)before;
    (void)file_bytes;
}
#endif

struct dice {
    uint64_t state;
};

/* Marsaglia's xorshift. */
static size_t throw(struct dice * dice, size_t sides)
{
    dice->state ^= dice->state << 13;
    dice->state ^= dice->state >> 7;
    dice->state ^= dice->state << 17;
    return (size_t)(dice->state % sides);
}

/* A mesh that came through is one that can be traced. */
static void expect_sound(const struct mesh *mesh)
{
    const struct mesh_hierarchy *hierarchy = &mesh->hierarchy;
    size_t found = 0;
    assert_true(mesh->triangle_count > 0 && mesh->vertex_count >= 3);
    assert_true(mesh->radius_m > 0.0f && isfinite(mesh->radius_m));
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        assert_true(fabsf(mesh->vertices[i]) <= mesh->radius_m);
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        assert_true(mesh->corners[i] < mesh->vertex_count);
    for (size_t slot = 0; slot < hierarchy->leaf_count * MESH_SLOTS; slot++) {
        if (hierarchy->triangles[slot] == MESH_NO_TRIANGLE)
            continue;
        assert_true(hierarchy->triangles[slot] < mesh->triangle_count);
        const float *normals = mesh->normals[slot].a; /* b and c follow */
        for (size_t i = 0; i < 9; i++)
            assert_true(fabsf(normals[i]) <= 1.001f);
        found++;
    }
    assert_int_equal(found, mesh->triangle_count);
}

static sonject_status expect_taken_or_explained(struct temporary_folder *folder, const char *name,
                                                const char *bytes, size_t count)
{
    struct report report = {{0}, NULL, NULL};
    struct mesh_options options;
    struct mesh mesh;
    mesh_options_init(&options);
    options.smooth_angle_rad = 0.5;
    write_bytes(temporary_file(folder, name), bytes, count);
    const size_t before = begin_counting();
    const sonject_status status = mesh_load(&report, folder->file, &options, &mesh);
    if (status == SONJECT_OK) {
        expect_sound(&mesh);
        mesh_clear(&mesh);
    } else {
        assert_int_equal(status, SONJECT_ERROR_INPUT);
        if (!strstr(report.message, name) || strchr(report.message, '\n'))
            fail_msg("'%s' does not name %s in one line", report.message, name);
        assert_null(mesh.vertices);
        assert_int_equal(mesh.triangle_count, 0);
    }
    expect_bounded(before, count);
    assert_int_equal(unlink(folder->file), 0); /* to write it anew is slower */
    return status;
}

static size_t smaller_of(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Puts bytes in the place of `taken` others. */
static size_t replace(char *text, size_t bytes, size_t at, size_t taken, const char *with,
                      size_t length)
{
    if (bytes - taken + length > BYTES_MAX)
        return bytes;
    memmove(text + at + length, text + at + taken, bytes - at - taken);
    memcpy(text + at, with, length);
    return bytes - taken + length;
}

static int is_of_number(char c)
{
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == 'e' || c == '+';
}

/* Another number in the place of one in a text: counts of headers, numbers of vertices,
 * coordinates. */
static size_t change_number(struct dice *dice, char *text, size_t bytes)
{
    static const char *const numbers[] = {
        "0",     "-1",         "1",          "2",          "13",          "255",
        "256",   "4294967295", "4294967296", "2147483648", "-2147483649", "99999999999999999999",
        "1e999", "1e-999",     "nan",        "inf",        "-inf",        "0x10",
        "1e20",  "1.5",        "",           "1 1",        "3 3 3",       "1/2/3",
        "//",    "\\\n",       "#"};
    size_t at = throw(dice, bytes);
    while (at < bytes && !is_of_number(text[at]))
        at++;
    size_t end = at;
    while (at > 0 && is_of_number(text[at - 1]))
        at--;
    while (end < bytes && is_of_number(text[end]))
        end++;
    const char *with = numbers[throw(dice, COUNT(numbers))];
    return replace(text, bytes, at, end - at, with, strlen(with));
}

/* The same in binary: all ones, not a number, infinite, the largest and the smallest. */
static size_t change_word(struct dice *dice, char *text, size_t bytes)
{
    static const char words[][9] = {"\377\377\377\377\377\377\377\377",
                                    "\0\0\300\177\0\0\300\177",
                                    "\0\0\200\177\0\0\360\177",
                                    "\377\377\377\177\377\377\377\177",
                                    "\0\0\0\200\0\0\0\200",
                                    "\177\177\377\377\177\360\0\0",
                                    "\0\0\0\0\0\0\0\0",
                                    "\1\0\0\0\1\0\0\0"};
    /* the number of triangles of binary STL stands there */
    const size_t at = throw(dice, 8) == 0 && bytes > 84 ? 80 : throw(dice, bytes);
    const size_t length = smaller_of(throw(dice, 2) ? 4 : 8, bytes - at);
    memcpy(text + at, words[throw(dice, COUNT(words))], length);
    return bytes;
}

static size_t mutate(struct dice *dice, char *text, size_t bytes)
{
    char piece[64];
    const size_t at = throw(dice, bytes);
    const size_t length = 1 + throw(dice, smaller_of(sizeof piece, bytes - at));
    const size_t from = throw(dice, bytes - length + 1);
    memcpy(piece, text + from, length);
    switch (throw(dice, 8)) {
    case 0:
        return at; /* cut short */
    case 1:
        text[at] = (char) throw(dice, 256);
        return bytes;
    case 2:
        return replace(text, bytes, at, length, "", 0);
    case 3:
        return replace(text, bytes, at, 0, piece, length);
    case 4:
        memcpy(text + at, piece, length);
        return bytes;
    case 5:
    case 6:
        return change_number(dice, text, bytes);
    default:
        return change_word(dice, text, bytes);
    }
}

static void test_mutated_files(void **state)
{
    static char text[BYTES_MAX];
    struct dice dice = {UINT64_C(0x2545F4914F6CDD1D)};
    struct mesh_sample sample;
    sample_sphere(&sample, 1); /* 32 triangles */
    for (int format = 0; format < FORMATS; format++) {
        struct draft draft = write_format((enum format)format, &sample);
        size_t refused = 0;
        assert_true(draft.count < BYTES_MAX);
        for (int i = 0; i < MUTATIONS; i++) {
            size_t bytes = draft.count;
            memcpy(text, draft.bytes, bytes);
            for (size_t changes = 1 + throw(&dice, 4); changes > 0 && bytes > 0; changes--)
                bytes = mutate(&dice, text, bytes);
            refused +=
                expect_taken_or_explained(*state, draft_names[format], text, bytes) != SONJECT_OK;
        }
        print_message("%s: %zu of %d refused\n", draft_names[format], refused, MUTATIONS);
        assert_true(refused > MUTATIONS / 4 && refused < MUTATIONS);
        clear_draft(&draft);
    }
    sample_clear(&sample);
}

/* The most triangles that few bytes can make, all alike, in a row or strewn. */
static void test_dense_files(void **state)
{
    static const char *const corners[] = {" 1", " 2", " 3", " 4"};
    struct dice dice = {UINT64_C(0x9E3779B97F4A7C15)};
    for (int kind = 0; kind < 3; kind++) {
        struct draft draft = {NULL, 0, 0};
        put_text(&draft, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf");
        for (size_t i = 0; i < 20000; i++) {
            const size_t corner = kind == 0 ? 0 : kind == 1 ? i % 3 : throw(&dice, 4);
            put(&draft, corners[corner], 2);
        }
        put_text(&draft, "\n");
        const sonject_status status =
            expect_taken_or_explained(*state, "dense.obj", draft.bytes, draft.count);
        assert_int_equal(status, kind == 0 ? SONJECT_ERROR_INPUT : SONJECT_OK);
        clear_draft(&draft);
    }
}

/* PLY with lists of one byte an entry, and headers that promise what no file holds. */
static void test_promises(void **state)
{
    static const char *const counts[] = {
        "4294967295", "9223372036854775807", "18446744073709551615", "68719476736", "-5", "1e9"};
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    for (size_t i = 0; i < COUNT(counts); i++)
        for (size_t format = 0; format < 3; format++)
            for (int of_faces = 0; of_faces < 2; of_faces++) {
                struct draft draft = {NULL, 0, 0};
                put_text(&draft,
                         "ply\nformat %s 1.0\nelement nothing %s\nelement vertex %s\n"
                         "property char x\nproperty char y\nproperty char z\nelement face %s\n"
                         "property list uchar char vertex_indices\nend_header\n",
                         formats[format], counts[i], of_faces ? "3" : counts[i],
                         of_faces ? counts[i] : "1");
                for (int byte = 0; byte < 500; byte++)
                    put(&draft, format == 0 ? "1 " : "\1", format == 0 ? 2 : 1);
                assert_int_equal(
                    expect_taken_or_explained(*state, "promise.ply", draft.bytes, draft.count),
                    SONJECT_ERROR_INPUT);
                clear_draft(&draft);
            }
}

TEST_PROGRAM(make_temporary_folder, remove_temporary_folder, TEST(test_mutated_files),
             TEST(test_dense_files), TEST(test_promises))
