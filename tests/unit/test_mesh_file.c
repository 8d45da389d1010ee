/* Tests the reading of meshes, with files written here, whole and spoilt on purpose. Every file is
 * read, or refused in one line that names the file. Every file takes memory in proportion to its
 * size, and leaves nothing behind (run under sanitizers and valgrind). */
#include "base/byte_order.h"
#include "claims.h"
#include "kernel/mesh_samples.h"
#include "mesh/mesh.h"
#include "mesh/mesh_reader.h"

#include "clean_folder.h"

/* ---- files as bytes in memory ---- */

struct draft {
    char *bytes; /* followed by a 0 that does not count */
    size_t count;
};

enum format {
    STL_TEXT,
    STL_BINARY,
    OBJ,
    PLY_AS_TEXT,
    PLY_LITTLE,
    PLY_BIG,
    FORMATS
};

static const char *const draft_names[] = {"text.stl", "binary.STL", "sample.obj",
                                          "text.ply", "little.ply", "big.ply"};

static void put_reversed(FILE *draft, const void *bytes, size_t count, int is_reversed)
{
    for (size_t i = 0; i < count; i++)
        fputc(((const unsigned char *)bytes)[is_reversed ? count - 1 - i : i], draft);
}

static float coordinate_of(const struct mesh_sample *sample, size_t corner, size_t axis)
{
    return (float)sample->positions[3 * (size_t)sample->corners[corner] + axis];
}

static void write_stl_text(FILE *draft, const struct mesh_sample *sample)
{
    fprintf(draft, "solid a sample of facets\n");
    for (size_t i = 0; i < sample->triangles; i++) {
        fprintf(draft, "  facet normal nan 0 0\r\n\touter loop\n");
        for (size_t corner = 3 * i; corner < 3 * i + 3; corner++)
            fprintf(draft, "VERTEX %.9g %.9e %.9g\n", (double)coordinate_of(sample, corner, 0),
                    (double)coordinate_of(sample, corner, 1),
                    (double)coordinate_of(sample, corner, 2));
        fprintf(draft, "endloop\nendfacet\n");
    }
    fprintf(draft, "endsolid a sample\n");
}

static void write_stl_binary(FILE *draft, const struct mesh_sample *sample)
{
    const char header[80] = "solid, says the header of a binary file";
    const uint32_t count = (uint32_t)sample->triangles;
    fwrite(header, 1, 80, draft);
    put_reversed(draft, &count, 4, machine_is_big_endian());
    for (size_t i = 0; i < sample->triangles; i++) {
        const float nothing = 0.0f;
        for (int axis = 0; axis < 3; axis++)
            fwrite(&nothing, 1, 4, draft);
        for (size_t corner = 3 * i; corner < 3 * i + 3; corner++)
            for (size_t axis = 0; axis < 3; axis++) {
                const float value = coordinate_of(sample, corner, axis);
                put_reversed(draft, &value, 4, machine_is_big_endian());
            }
        fwrite("\0\0", 1, 2, draft);
    }
}

static void write_obj(FILE *draft, const struct mesh_sample *sample)
{
    fprintf(draft, "# a sample\nmtllib none.mtl\no part\nv 1e3 1e3 1e3\n");
    for (size_t i = 0; i < sample->vertices; i++)
        fprintf(draft, "v %.17g %.17g %.17g 0.5 0.5 0.5\nvt 0 0\n", sample->positions[3 * i],
                sample->positions[3 * i + 1], sample->positions[3 * i + 2]);
    for (size_t i = 0; i < sample->triangles; i++) {
        const uint32_t *corners = &sample->corners[3 * i];
        if (i % 2)
            fprintf(draft, "f %u/1 %u//3 \\\n %u/1/2 # a face\n", corners[0] + 2, corners[1] + 2,
                    corners[2] + 2);
        else
            fprintf(draft, "f %d %d %d\n", (int)corners[0] - (int)sample->vertices,
                    (int)corners[1] - (int)sample->vertices,
                    (int)corners[2] - (int)sample->vertices);
    }
}

static void write_ply_header(FILE *draft, const struct mesh_sample *sample, const char *format)
{
    fprintf(draft,
            "ply\nformat %s 1.0\ncomment a sample\nelement vertex %zu\nproperty float confidence\n"
            "property double x\nproperty double y\nproperty double z\nelement camera 1\n"
            "property short number\nelement face %zu\nproperty list uchar float weights\n"
            "property list uchar int vertex_indices\nend_header\n",
            format, sample->vertices, sample->triangles);
}

static void write_ply_text(FILE *draft, const struct mesh_sample *sample)
{
    write_ply_header(draft, sample, "ascii");
    for (size_t i = 0; i < sample->vertices; i++)
        fprintf(draft, "0.5 %.17g %.17g %.17g\n", sample->positions[3 * i],
                sample->positions[3 * i + 1], sample->positions[3 * i + 2]);
    fprintf(draft, "7\n");
    for (size_t i = 0; i < sample->triangles; i++)
        fprintf(draft, "2 0.5 0.25 3 %u %u %u\n", sample->corners[3 * i],
                sample->corners[3 * i + 1], sample->corners[3 * i + 2]);
}

static void write_ply_binary(FILE *draft, const struct mesh_sample *sample, int is_big)
{
    const int is_reversed = is_big != machine_is_big_endian();
    const float weight = 0.5f;
    const int16_t camera = 7;
    write_ply_header(draft, sample, is_big ? "binary_big_endian" : "binary_little_endian");
    for (size_t i = 0; i < sample->vertices; i++) {
        put_reversed(draft, &weight, 4, is_reversed);
        for (size_t axis = 0; axis < 3; axis++)
            put_reversed(draft, &sample->positions[3 * i + axis], 8, is_reversed);
    }
    put_reversed(draft, &camera, 2, is_reversed);
    for (size_t i = 0; i < sample->triangles; i++) {
        fputc(1, draft);
        put_reversed(draft, &weight, 4, is_reversed);
        fputc(3, draft);
        for (size_t corner = 0; corner < 3; corner++)
            put_reversed(draft, &sample->corners[3 * i + corner], 4, is_reversed);
    }
}

static FILE *begin_draft(void)
{
    FILE *out = tmpfile();
    assert_non_null(out);
    return out;
}

static struct draft end_draft(FILE *out)
{
    struct draft draft;
    draft.bytes = (char *)bytes_of_stream(out, &draft.count);
    return draft;
}

/* Returns the sample in a format. The caller frees the bytes. */
static struct draft write_format(enum format format, const struct mesh_sample *sample)
{
    FILE *out = begin_draft();
    if (format == STL_TEXT)
        write_stl_text(out, sample);
    else if (format == STL_BINARY)
        write_stl_binary(out, sample);
    else if (format == OBJ)
        write_obj(out, sample);
    else if (format == PLY_AS_TEXT)
        write_ply_text(out, sample);
    else
        write_ply_binary(out, sample, format == PLY_BIG);
    return end_draft(out);
}

/* ---- files that are read, or end too soon ---- */

static sonject_status load(const char *name, const void *bytes, size_t count, struct mesh *mesh)
{
    struct mesh_options options;
    mesh_options_init(&options);
    report.message[0] = '\0';
    const char *path = file_in(name);
    write_bytes(path, bytes, count);
    return mesh_load(&report, path, &options, mesh);
}

TEST(test_formats)
{
    struct mesh_sample sample;
    sample_sphere(&sample, 3);
    for (int format = 0; format < FORMATS; format++) {
        struct draft draft = write_format((enum format)format, &sample);
        struct mesh mesh;
        EXPECT_OK(&report, load(draft_names[format], draft.bytes, draft.count, &mesh));
        assert_int_equal(mesh.triangle_count, 512);
        assert_int_equal(mesh.vertex_count, 258); /* closed: 2 + triangles / 2 */
        assert_true(mesh.topology.is_closed);
        assert_int_equal(mesh.topology.turned, 0);
        assert_true(fabs((double)mesh.radius_m - 1.0) < 1e-6);
        assert_true(mesh.topology.volume > 4.0 && mesh.topology.volume < 4.18879);
        for (int axis = 0; axis < 3; axis++) {
            assert_true(fabs(mesh.centre_m[axis]) < 1e-6);
            assert_true(fabs((double)mesh.upper_m[axis] - 1.0) < 1e-6);
        }
        mesh_clear(&mesh);
        free(draft.bytes);
    }
    sample_clear(&sample);
}

/* Reads the first bytes of a file, from memory that ends behind them. */
static sonject_status read_part(enum format format, const char *bytes, size_t count,
                                struct mesh_soup *soup)
{
    char *part = zeroed(count + 1, 1);
    memcpy(part, bytes, count);
    part[count] = '\0';
    *soup = (struct mesh_soup){.report = &report, .path = draft_names[format]};
    const sonject_status status = format <= STL_BINARY ? stl_read(soup, part, count)
                                  : format == OBJ      ? obj_read(soup, part, count)
                                                       : ply_read(soup, part, count);
    free(part);
    return status;
}

/* A file that ends too soon is refused, with its name in the message. Text that loses only its last
 * line may be read. */
TEST(test_cut_short)
{
    struct mesh_sample sample;
    sample_box(&sample);
    for (int format = 0; format < FORMATS; format++) {
        struct draft draft = write_format((enum format)format, &sample);
        size_t read = 0;
        for (size_t count = 0; count < draft.count; count++) {
            struct mesh_soup soup;
            if (read_part((enum format)format, draft.bytes, count, &soup) == SONJECT_OK)
                read++;
            else
                assert_non_null(strstr(report.message, draft_names[format]));
            mesh_soup_clear(&soup);
        }
        /* binary files are never read in part; OBJ has no end to miss */
        if (format == STL_BINARY || format == PLY_LITTLE || format == PLY_BIG)
            assert_int_equal(read, 0);
        else if (format == STL_TEXT)
            assert_in_range(read, 1, 12); /* "endsolid" is there */
        else if (format == PLY_AS_TEXT)
            assert_in_range(read, 1, 2); /* the last line's end, or a digit of its last number */
        free(draft.bytes);
    }
    sample_clear(&sample);
}

static void expect_refusal(const char *name, const void *bytes, size_t count, const char *message)
{
    struct mesh mesh;
    const sonject_status status = load(name, bytes, count, &mesh);
    if (status != SONJECT_ERROR_INPUT || !strstr(report.message, message))
        fail_msg("%s: status %d, '%s' lacks '%s'", name, (int)status, report.message, message);
    assert_null(mesh.vertices);
}

/* Headers that promise more than the file holds take no memory. Coordinates must be numbers. */
TEST(test_wrong_binary_files)
{
    static const struct {
        const char *number; /* number of triangles */
        size_t bytes;       /* bytes of the file; 0: all */
        const char *message;
    } headers[] = {{"\xff\xff\xff\xff", 0, "says 4294967295 triangles, the file holds 12"},
                   {"\x80\x96\x98\0", 0, "cut short"},
                   {"\x0b\0\0\0", 0, "11 triangles, the file holds 12"},
                   {"\0\0\0\0", 84, "no triangles"}};
    struct mesh_sample sample;
    sample_box(&sample);
    struct draft draft = write_format(STL_BINARY, &sample);
    for (size_t i = 0; i < COUNT(headers); i++) {
        memcpy(draft.bytes + 80, headers[i].number, 4);
        expect_refusal("a.stl", draft.bytes, headers[i].bytes ? headers[i].bytes : draft.count,
                       headers[i].message);
    }
    free(draft.bytes);
    draft = write_format(PLY_LITTLE, &sample);
    expect_refusal("a.ply", draft.bytes, draft.count + 1, "more than its header says");
    free(draft.bytes);
    sample.positions[9] = NAN;
    draft = write_format(STL_BINARY, &sample);
    expect_refusal("a.stl", draft.bytes, draft.count, "not a finite number");
    free(draft.bytes);
    draft = write_format(PLY_BIG, &sample);
    expect_refusal("a.ply", draft.bytes, draft.count, "vertex 4: a coordinate is not");
    free(draft.bytes);
    sample_clear(&sample);
}

TEST(test_bad_content)
{
    static const struct {
        const char *name, *text, *message;
    } cases[] = {
        {"a.obj", "v 0 0 0\nv 1 0 nan\n", "line 2: expected a finite coordinate, found 'nan'"},
        {"a.obj", "v 0 0 1e999\n", "expected a finite coordinate"},
        {"a.obj", "v 0 0\nv 1 0 0\n", "line 1: expected a finite coordinate, found 'end of line'"},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4: a face has vertex 4, but 3"},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "a face has vertex 0"},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "a face has vertex -4"},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "three vertices or more"},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 2\n", "none of its 1 triangles has an area"},
        {"a.obj", "", "no triangles"},
        {"a.obj", "v 0 0 0\nv 1e9 0 0\nv 0 1e9 0\nf 1 2 3\n", "check its unit"},
        {"a.obj", "v 0 0 0\nv 1e-9 0 0\nv 0 1e-9 0\nf 1 2 3\n", "check its unit"},
        {"a.stl", "", "too few"},
        {"a.stl", "solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
         "line 6: expected vertex, found 'endloop'"},
        {"a.stl", "solid a\nendsolid\nsolid b\n", "expected 'facet' or 'endsolid', but the file"},
        {"a.ply", "ply\nformat ascii 2.0\n", "line 2: expected version 1.0"},
        {"a.ply", "plx\n", "line 1: expected 'ply', found 'plx'"},
        {"a.ply", "ply\nformat ascii 1.0\nend_header\n", "one element 'vertex'"},
        {"a.ply", "ply\nproperty float x\n", "'element' before 'property'"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list char int vertex_index\nend_header\n"
         "0 0 0\n3 0 0 1\n",
         "vertex number 1, but numbers run from 0 to 0"},
        {"a.ply",
         "ply\nformat binary_little_endian 1.0\nelement vertex 10000000000000\n"
         "property float x\nproperty float y\nproperty float z\nelement face 1\n"
         "property list uchar int vertex_index\nend_header\n",
         "the file holds 0 at most"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uint int vertex_index\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n",
         "cut short"},
        {"a.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 3 2 0\nf 1 2 3 4\n",
         "a face of 4 corners about vertex 1 is not convex, and crosses itself"},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        expect_refusal(cases[i].name, cases[i].text, strlen(cases[i].text), cases[i].message);
    static const char polygon[] = "v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n";
    struct mesh mesh;
    EXPECT_OK(&report, load("a.obj", polygon, sizeof polygon - 1, &mesh)); /* a fan of triangles */
    assert_int_equal(mesh.triangle_count, 3);
    assert_int_equal(mesh.topology.open_edges, 5);
    mesh_clear(&mesh);
    assert_int_equal(load("a.glb", "glTF", 4, &mesh), SONJECT_ERROR_UNSUPPORTED);
    assert_non_null(strstr(report.message, "a.glb: meshes are read from STL, OBJ and PLY"));
    struct mesh_options options;
    mesh_options_init(&options);
    assert_int_equal(mesh_load(&report, "/nowhere/a.stl", &options, &mesh), SONJECT_ERROR_STORAGE);
}

/* The outline of a U has an area of 3 less that of its notch, 1.2. */
TEST(faces_that_are_not_convex_stay_inside_their_outline)
{
    static const double outline[8][2] = {{0, 0},     {2, 0},     {2, 1.5},   {1.5, 1.5},
                                         {1.5, 0.3}, {0.5, 0.3}, {0.5, 1.5}, {0, 1.5}};
    for (int first = 0; first < 16; first++) {
        char text[512] = "";
        size_t length = 0;
        struct mesh mesh;
        double area = 0.0;
        for (int i = 0; i < 8; i++) /* in both directions */
            length +=
                (size_t)snprintf(text + length, sizeof text - length, "v %g 0.2 %g\n",
                                 outline[first < 8 ? (first + i) % 8 : (first + 8 - i) % 8][0],
                                 outline[first < 8 ? (first + i) % 8 : (first + 8 - i) % 8][1]);
        length += (size_t)snprintf(text + length, sizeof text - length, "f 1 2 3 4 5 6 7 8\n");
        EXPECT_OK(&report, load("a.obj", text, length, &mesh));
        assert_int_equal(mesh.triangle_count, 6);
        for (size_t i = 0; i < 18; i += 3) {
            const float *a = &mesh.vertices[3 * mesh.corners[i]];
            const float *b = &mesh.vertices[3 * mesh.corners[i + 1]];
            const float *c = &mesh.vertices[3 * mesh.corners[i + 2]];
            area +=
                0.5 * fabs((double)((b[0] - a[0]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[0] - a[0])));
        }
        assert_true(fabs(area - 1.8) < 1e-5);
        mesh_clear(&mesh);
    }
}

TEST(test_units_and_axes)
{
    struct mesh_sample sample;
    struct mesh mesh = {.options = {.unit_m = 0.001, .axes = {1, -3, 2}}};
    sample_box(&sample); /* 2 x 1.2 x 0.6 */
    for (size_t i = 0; i < sample.vertices; i++)
        sample.positions[3 * i + 1] += 1e6; /* far from the file's origin */
    const struct mesh_soup soup = {.report = &report,
                                   .path = "box",
                                   .positions = sample.positions,
                                   .corners = sample.corners,
                                   .vertices = sample.vertices,
                                   .triangles = sample.triangles};
    EXPECT_OK(&report, mesh_of_soup(&soup, &mesh));
    assert_true(fabs(mesh.centre_m[2] - 1000.0) < 1e-9);
    assert_true(fabs((double)mesh.upper_m[0] - 1.0e-3) < 1e-9);
    assert_true(fabs((double)mesh.upper_m[1] - 0.3e-3) < 1e-9);
    assert_true(fabs((double)mesh.upper_m[2] - 0.6e-3) < 1e-9);
    assert_true(fabs(mesh.topology.volume / 1.44e-9 - 1.0) < 1e-6);
    assert_int_equal(mesh.topology.turned, 0);
    mesh_clear(&mesh);
    sample_clear(&sample);
}

/* ---- files that somebody spoilt ---- */

/* A triangle takes some 100 bytes while its mesh is made ready, and two bytes of a file can make a
 * triangle ("f 1 2 3 1 2 3 ..."). More memory goes to what is read at once, and to the first steps
 * of arrays that grow. */
#define MEMORY_PER_BYTE 100
#define MEMORY_AT_ONCE  ((size_t)128 * 1024)

#if defined(COUNTS_MEMORY)
#include <malloc.h>

static long memory, memory_peak; /* bytes; memory of others that this program frees counts, too */

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
    memory += made ? (long)malloc_usable_size(made) : 0;
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
    const long before = old ? (long)malloc_usable_size(old) : 0;
    void *made = __real_realloc(old, bytes);
    memory -= made ? before : 0;
    return counted(made);
}

void __wrap_free(void *old)
{
    memory -= old ? (long)malloc_usable_size(old) : 0;
    __real_free(old);
}

static long begin_counting(void)
{
    memory_peak = memory;
    return memory;
}

/* Expects no memory to be left, and never more to be held than the file's size allows. */
static void expect_bounded(long before, size_t file_bytes)
{
    assert_int_equal(memory, before);
    if ((size_t)(memory_peak - before) > MEMORY_PER_BYTE * file_bytes + MEMORY_AT_ONCE)
        fail_msg("%ld bytes of memory for %zu bytes of a file", memory_peak - before, file_bytes);
}
#else
#define begin_counting()                   0
#define expect_bounded(before, file_bytes) (void)(before)
#endif

static size_t throw(size_t sides)
{
    return (size_t)sample_uniform(0.0, (double)sides);
}

/* Expects a mesh that was read to be fit for tracing. */
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

static sonject_status expect_taken_or_explained(const char *name, const char *bytes, size_t count)
{
    struct mesh_options options;
    struct mesh mesh;
    mesh_options_init(&options);
    options.smooth_angle_rad = 0.5;
    const char *path = file_in(name);
    write_bytes(path, bytes, count);
    const long before = begin_counting();
    const sonject_status status = mesh_load(&report, path, &options, &mesh);
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
    assert_int_equal(unlink(path), 0); /* overwriting is slower */
    return status;
}

/* Few bytes make the most triangles: one place, one triangle time and again, or a tangle. */
TEST(test_dense_files)
{
    static const char *const corners[] = {" 1", " 2", " 3", " 4"};
    for (int kind = 0; kind < 3; kind++) {
        FILE *out = begin_draft();
        fprintf(out, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf");
        for (size_t i = 0; i < 20000; i++) {
            const size_t corner = kind == 0 ? 0 : kind == 1 ? i % 3 : throw(4);
            fputs(corners[corner], out);
        }
        fprintf(out, "\n");
        const struct draft draft = end_draft(out);
        const sonject_status status =
            expect_taken_or_explained("dense.obj", draft.bytes, draft.count);
        assert_int_equal(status, kind == 1 ? SONJECT_OK : SONJECT_ERROR_INPUT);
        free(draft.bytes);
    }
}

/* Tries PLY with lists of one byte an entry, and headers that promise more than a file holds. */
TEST(test_promises)
{
    static const char *const counts[] = {
        "4294967295", "9223372036854775807", "18446744073709551615", "68719476736", "-5", "1e9"};
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    for (size_t i = 0; i < COUNT(counts); i++)
        for (size_t format = 0; format < 3; format++)
            for (int of_faces = 0; of_faces < 2; of_faces++) {
                FILE *out = begin_draft();
                fprintf(out,
                        "ply\nformat %s 1.0\nelement nothing %s\nelement vertex %s\n"
                        "property char x\nproperty char y\nproperty char z\nelement face %s\n"
                        "property list uchar char vertex_indices\nend_header\n",
                        formats[format], counts[i], of_faces ? "3" : counts[i],
                        of_faces ? counts[i] : "1");
                for (int byte = 0; byte < 500; byte++)
                    fputs(format == 0 ? "1 " : "\1", out);
                const struct draft draft = end_draft(out);
                assert_int_equal(expect_taken_or_explained("promise.ply", draft.bytes, draft.count),
                                 SONJECT_ERROR_INPUT);
                free(draft.bytes);
            }
}

TEST_PROGRAM(begin, remove_temporary_folder)
