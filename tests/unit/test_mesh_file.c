/* Reading meshes: files written here, whole and damaged. */
#define _POSIX_C_SOURCE 200809L

#include "claims.h"
#include "kernel/mesh_samples.h"
#include "mesh/mesh.h"
#include "mesh/mesh_reader.h"
#include "mesh_drafts.h"
#include "temporary_folder.h"

#ifndef MUTATIONS
#define MUTATIONS 2000
#endif

static struct report report;

static sonject_status load(struct temporary_folder *folder, const char *name, const void *bytes,
                           size_t count, struct mesh *mesh)
{
    struct mesh_options options;
    mesh_options_init(&options);
    report.message[0] = '\0';
    write_bytes(temporary_file(folder, name), bytes, count);
    return mesh_load(&report, folder->file, &options, mesh);
}

static void test_formats(void **state)
{
    struct mesh_sample sample;
    sample_sphere(&sample, 3);
    for (int format = 0; format < FORMATS; format++) {
        struct draft draft = write_format((enum format)format, &sample);
        struct mesh mesh;
        EXPECT_OK(&report, load(*state, draft_names[format], draft.bytes, draft.count, &mesh));
        assert_int_equal(mesh.triangle_count, 512);
        assert_int_equal(mesh.vertex_count, 258); /* closed: 2 + triangles / 2 */
        assert_true(mesh.topology.is_closed);
        assert_int_equal(mesh.topology.turned, 0);
        assert_true(fabs((double)mesh.radius_m - 1.0) < 1e-6);
        assert_true(mesh.volume_m3 > 4.0 && mesh.volume_m3 < 4.18879);
        for (int axis = 0; axis < 3; axis++) {
            assert_true(fabs(mesh.centre_m[axis]) < 1e-6);
            assert_true(fabs((double)mesh.upper_m[axis] - 1.0) < 1e-6);
        }
        mesh_clear(&mesh);
        clear_draft(&draft);
    }
    sample_clear(&sample);
}

/* Reads the first bytes of a file, from memory that ends where they do. */
static sonject_status read_part(enum format format, const char *bytes, size_t count,
                                struct mesh_soup *soup)
{
    char *part = malloc(count + 1);
    assert_non_null(part);
    memcpy(part, bytes, count);
    part[count] = '\0';
    *soup = (struct mesh_soup){.report = &report, .path = draft_names[format]};
    const sonject_status status = format <= STL_BINARY ? stl_read(soup, part, count)
                                  : format == OBJ      ? obj_read(soup, part, count)
                                                       : ply_read(soup, part, count);
    free(part);
    return status;
}

/* Every file that ends too soon is refused, with its name in the message, or (text that loses only
 * its last line) read. */
static void test_cut_short(void **state)
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
        clear_draft(&draft);
    }
    sample_clear(&sample);
}

/* Whatever bytes are wrong: an answer, and no harm (run under sanitizers). */
static void test_mutations(void **state)
{
    struct mesh_sample sample;
    sample_box(&sample);
    for (int format = 0; format < FORMATS; format++) {
        struct draft draft = write_format((enum format)format, &sample);
        char *changed = malloc(draft.count);
        assert_non_null(changed);
        for (int i = 0; i < MUTATIONS; i++) {
            struct mesh_soup soup;
            memcpy(changed, draft.bytes, draft.count);
            for (int k = 0; k <= i % 4; k++)
                changed[(size_t)sample_uniform(0.0, (double)draft.count)] =
                    (char)(int)sample_uniform(-128.0, 128.0);
            if (read_part((enum format)format, changed, draft.count, &soup) == SONJECT_OK)
                for (size_t corner = 0; corner < 3 * soup.triangles; corner++)
                    assert_true(soup.corners[corner] < soup.vertices);
            mesh_soup_clear(&soup);
        }
        free(changed);
        clear_draft(&draft);
    }
    sample_clear(&sample);
}

static void expect_refusal(struct temporary_folder *folder, const char *name, const void *bytes,
                           size_t count, const char *message)
{
    struct mesh mesh;
    const sonject_status status = load(folder, name, bytes, count, &mesh);
    if (status != SONJECT_ERROR_INPUT || !strstr(report.message, message))
        fail_msg("%s: status %d, '%s' lacks '%s'", name, (int)status, report.message, message);
    assert_null(mesh.vertices);
}

/* Headers that promise more than the file holds take no memory. */
static void test_wrong_counts(void **state)
{
    struct mesh_sample sample;
    struct draft draft;
    sample_box(&sample);
    draft = write_format(STL_BINARY, &sample);
    memcpy(draft.bytes + 80, "\xff\xff\xff\xff", 4);
    expect_refusal(*state, "a.stl", draft.bytes, draft.count,
                   "the header says 4294967295 triangles, the file holds 12");
    memcpy(draft.bytes + 80, "\x80\x96\x98\0", 4);
    expect_refusal(*state, "a.stl", draft.bytes, draft.count, "cut short");
    memcpy(draft.bytes + 80, "\x0b\0\0\0", 4);
    expect_refusal(*state, "a.stl", draft.bytes, draft.count, "11 triangles, the file holds 12");
    memcpy(draft.bytes + 80, "\0\0\0\0", 4);
    expect_refusal(*state, "a.stl", draft.bytes, 84, "no triangles");
    clear_draft(&draft);
    put_text(&draft, "ply\nformat binary_little_endian 1.0\nelement vertex 10000000000000\n"
                     "property float x\nproperty float y\nproperty float z\nelement face 1\n"
                     "property list uchar int vertex_index\nend_header\n");
    expect_refusal(*state, "a.ply", draft.bytes, draft.count, "the file holds 0 at most");
    clear_draft(&draft);
    put_text(&draft, "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                     "property float y\nproperty float z\nelement face 1\n"
                     "property list uint int vertex_index\nend_header\n"
                     "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n");
    expect_refusal(*state, "a.ply", draft.bytes, draft.count, "cut short");
    clear_draft(&draft);
    draft = write_format(PLY_LITTLE, &sample);
    put(&draft, "\0", 1);
    expect_refusal(*state, "a.ply", draft.bytes, draft.count, "more than its header says");
    clear_draft(&draft);
    sample_clear(&sample);
}

static void test_bad_content(void **state)
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
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        expect_refusal(*state, cases[i].name, cases[i].text, strlen(cases[i].text),
                       cases[i].message);
    struct mesh mesh;
    assert_int_equal(load(*state, "a.glb", "glTF", 4, &mesh), SONJECT_ERROR_UNSUPPORTED);
    assert_non_null(strstr(report.message, "a.glb: meshes are read from STL, OBJ and PLY"));
    struct mesh_options options;
    mesh_options_init(&options);
    assert_int_equal(mesh_load(&report, "/nowhere/a.stl", &options, &mesh), SONJECT_ERROR_STORAGE);
}

/* A binary file with a coordinate that is none. */
static void test_not_a_number(void **state)
{
    struct mesh_sample sample;
    sample_box(&sample);
    sample.positions[9] = NAN;
    struct draft draft = write_format(STL_BINARY, &sample);
    expect_refusal(*state, "a.stl", draft.bytes, draft.count, "not a finite number");
    clear_draft(&draft);
    draft = write_format(PLY_BIG, &sample);
    expect_refusal(*state, "a.ply", draft.bytes, draft.count, "vertex 4: a coordinate is not");
    clear_draft(&draft);
    sample_clear(&sample);
}

static void test_units_and_axes(void **state)
{
    struct mesh_sample sample;
    struct mesh_options options;
    struct mesh mesh;
    sample_box(&sample); /* 2 x 1.2 x 0.6 */
    for (size_t i = 0; i < sample.vertices; i++)
        sample.positions[3 * i + 1] += 1e6; /* far from the file's origin */
    mesh_options_init(&options);
    options.unit_m = 0.001;
    options.axes[0] = 1;
    options.axes[1] = -3;
    options.axes[2] = 2;
    assert_int_equal(mesh_from_arrays(&report, "box", sample.positions, sample.vertices,
                                      sample.corners, sample.triangles, &options, &mesh),
                     SONJECT_OK);
    assert_true(fabs(mesh.centre_m[2] - 1000.0) < 1e-9);
    assert_true(fabs((double)mesh.upper_m[0] - 1.0e-3) < 1e-9);
    assert_true(fabs((double)mesh.upper_m[1] - 0.3e-3) < 1e-9);
    assert_true(fabs((double)mesh.upper_m[2] - 0.6e-3) < 1e-9);
    assert_true(fabs(mesh.volume_m3 / 1.44e-9 - 1.0) < 1e-6);
    assert_int_equal(mesh.topology.turned, 0);
    mesh_clear(&mesh);
    options.axes[1] = 3;
    assert_int_equal(mesh_from_arrays(&report, "box", sample.positions, sample.vertices,
                                      sample.corners, sample.triangles, &options, &mesh),
                     SONJECT_ERROR_ARGUMENT);
    assert_non_null(strstr(report.message, "mirror"));
    options.axes[1] = 1;
    assert_int_equal(mesh_from_arrays(&report, "box", sample.positions, sample.vertices,
                                      sample.corners, sample.triangles, &options, &mesh),
                     SONJECT_ERROR_ARGUMENT);
    sample_clear(&sample);
}

/* A polygon becomes a fan. */
static void test_polygons(void **state)
{
    static const char text[] = "v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n";
    struct mesh mesh;
    assert_int_equal(load(*state, "a.obj", text, sizeof text - 1, &mesh), SONJECT_OK);
    assert_int_equal(mesh.triangle_count, 3);
    assert_int_equal(mesh.topology.open_edges, 5);
    mesh_clear(&mesh);
}

TEST_PROGRAM(make_temporary_folder, remove_temporary_folder, TEST(test_formats),
             TEST(test_cut_short), TEST(test_mutations), TEST(test_wrong_counts),
             TEST(test_bad_content), TEST(test_not_a_number), TEST(test_units_and_axes),
             TEST(test_polygons))
