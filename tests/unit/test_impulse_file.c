/* Files of impulses: what is written comes back bit for bit, and what others wrote is refused. */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <hdf5.h>

#include <sonject/version.h>

#include "base/memory.h"
#include "inject/echoes.h"
#include "inject/impulse_file.h"
#include "inject/impulse_seal.h"
#include "inject/injection.h"
#include "trace/smooth.h"
#include "unit/temporary_folder.h"

#define ROWS    6
#define COLUMNS 9

/* A scene of one sphere, as far as reading needs it: no device. */
struct set_up {
    struct report report;
    struct scene scene;
    struct water water;
    struct placements placements;
    struct tracer tracer;
    struct line_grid patch, glints;
};

static void set_up_init(struct set_up *set)
{
    sonject_object_params object;
    memset(set, 0, sizeof *set);
    scene_init(&set->scene);
    set->scene.geometry.row_spacing_m = 0.025;
    set->scene.geometry.column_spacing_m = 0.025;
    set->scene.geometry.first_slant_range_m = 25.0;
    sonject_object_params_init(&object);
    object.shape = SONJECT_SHAPE_SPHERE;
    object.diameter_m = 0.02;
    assert_int_equal(scene_append_object(&set->scene, &set->report, &object), SONJECT_OK);
    struct tracer *tracer = &set->tracer;
    tracer->report = &set->report;
    tracer->scene = &set->scene;
    assert_int_equal(injection_check(&set->report, &set->scene, 0.0, 0.0, ROWS, COLUMNS,
                                     &set->water, &tracer->view, &set->placements),
                     SONJECT_OK);
    tracer->placements = set->placements.parts;
    tracer->part_count = set->placements.part_count;
    tracer->objects = set->placements.objects;
    point_response_init(&tracer->response, &set->scene.sonar,
                        tracer->view.range_ratio * set->water.straight_speed_mps, 0.025);
    line_grid_for_patch(&set->patch, &tracer->view, &tracer->response);
    glint_strips_lay(&set->glints, tracer, 0);
    set->glints.bins.first = -3;
    set->glints.bins.count = 40;
}

static void set_up_clear(struct set_up *set)
{
    placements_clear(&set->placements);
    water_clear(&set->water);
    scene_clear(&set->scene);
}

/* A value of its own for each cell of each plane; some are noisy, so that chunks deflate badly. */
static float value_of(enum impulse_kind kind, uint32_t plane, size_t cell)
{
    const uint32_t mixed = (uint32_t)(cell * 2654435761u + plane * 40503u + (uint32_t)kind * 977u);
    return cell % 7 == 0 ? 0.0f : (float)mixed * 1e-9f;
}

static void give(const struct impulse_sink *sink, enum impulse_kind kind, uint32_t number,
                 const struct line_grid *grid, uint32_t planes)
{
    const size_t width = (size_t)grid->bins.count;
    const int32_t most = kind == IMPULSES_OBJECT || kind == IMPULSES_CHAINS ? INT32_MAX : 5;
    struct impulse_lines lines;
    memset(&lines, 0, sizeof lines);
    lines.kind = kind;
    lines.number = number;
    lines.grid = *grid;
    lines.planes = planes;
    lines.strips.first = grid->strips.first;
    do {
        const int32_t done = lines.strips.first - grid->strips.first;
        const int32_t left = grid->strips.count - done;
        float *values[IMPULSE_PLANES_MAX] = {NULL, NULL, NULL};
        lines.strips.count = left < most ? left : most;
        for (uint32_t i = 0; i < planes; i++) {
            const size_t cells = (size_t)lines.strips.count * width;
            values[i] = allocate_array(cells, sizeof(float));
            assert_non_null(values[i]);
            for (size_t k = 0; k < cells; k++)
                values[i][k] = value_of(kind, i, (size_t)done * width + k);
            lines.plane[i] = values[i];
        }
        assert_int_equal(sink->take(sink->taker, &lines), SONJECT_OK);
        for (int i = 0; i < IMPULSE_PLANES_MAX; i++)
            free(values[i]);
        lines.strips.first += lines.strips.count;
    } while (lines.strips.first < grid->strips.first + grid->strips.count);
}

static void describe(struct impulse_head *head, const struct set_up *set)
{
    static char *overrides[] = {"injection.seed=7", "input.path=a b.tif"};
    memset(head, 0, sizeof *head);
    strcpy(head->scene_hash, "0123456789abcdef0123456789abcdef");
    head->scene_text = "sonject: 1\n# \xc3\xa4\n";
    head->scene_path = "scene.yaml";
    head->scene_folder = "/data";
    head->overrides = overrides;
    head->override_count = 2;
    head->seed = UINT64_MAX;
    head->image_path = "";
    strcpy(head->image_hash, "fedcba9876543210fedcba9876543210");
    head->image_rows = ROWS;
    head->image_columns = COLUMNS;
    head->sonar = set->scene.sonar;
    head->rows = ROWS;
    head->columns = COLUMNS;
    head->counts.rays = (uint64_t)1 << 40;
}

static void write_file(struct set_up *set, const char *path)
{
    struct impulse_head head;
    struct impulse_writer *writer;
    struct line_grid tile = set->patch;
    tile.strips.count = 4;
    tile.bins.count = 5;
    assert_int_equal(impulse_writer_begin(&set->report, path, &writer), SONJECT_OK);
    const struct impulse_sink sink = impulse_writer_sink(writer);
    give(&sink, IMPULSES_SEABED, 0, &set->patch, 1);
    give(&sink, IMPULSES_OBJECT, 0, &tile, 3);
    give(&sink, IMPULSES_GLINT, 0, &set->glints, 2);
    give(&sink, IMPULSES_CHAINS, 2, &set->patch, 1);
    describe(&head, set);
    assert_int_equal(impulse_writer_publish(writer, &head), SONJECT_OK);
    impulse_writer_release(&writer);
}

/* Counts the cells of each kind and checks their values. */
struct taken {
    size_t cells[IMPULSE_KINDS];
};

static sonject_status take(void *taker, const struct impulse_lines *lines)
{
    struct taken *taken = taker;
    const size_t width = (size_t)lines->grid.bins.count;
    const size_t first = (size_t)(lines->strips.first - lines->grid.strips.first) * width;
    const size_t cells = (size_t)lines->strips.count * width;
    for (uint32_t i = 0; i < lines->planes; i++)
        for (size_t k = 0; k < cells; k++) {
            const float expected = value_of(lines->kind, i, first + k);
            assert_memory_equal(&lines->plane[i][k], &expected, sizeof expected);
        }
    taken->cells[lines->kind] += cells;
    return SONJECT_OK;
}

static sonject_status read_file(struct set_up *set, const char *path, struct taken *taken)
{
    struct impulse_file *file;
    struct echo_request request;
    const struct impulse_sink sink = {take, taken};
    memset(taken, 0, sizeof *taken);
    memset(&request, 0, sizeof request);
    sonject_status status = impulse_file_open(&set->report, path, &file);
    if (status != SONJECT_OK)
        return status;
    const struct impulse_source source = impulse_file_source(file);
    status = source.deliver(source.giver, &set->tracer, &request, &sink);
    impulse_file_close(&file);
    return status;
}

static void lines_come_back(void **state)
{
    struct temporary_folder *folder = *state;
    struct set_up set;
    struct taken taken;
    set_up_init(&set);
    const char *path = temporary_file(folder, "impulses.h5");
    write_file(&set, path);
    assert_int_equal(read_file(&set, path, &taken), SONJECT_OK);
    assert_int_equal(taken.cells[IMPULSES_SEABED], line_grid_cells(&set.patch));
    assert_int_equal(taken.cells[IMPULSES_OBJECT], 20);
    assert_int_equal(taken.cells[IMPULSES_GLINT], line_grid_cells(&set.glints));
    assert_int_equal(taken.cells[IMPULSES_LEVEL], 0);
    assert_int_equal(taken.cells[IMPULSES_CHAINS], line_grid_cells(&set.patch));
    assert_true(set.tracer.counts.rays == (uint64_t)1 << 40);
    set_up_clear(&set);
}

static void the_head_comes_back(void **state)
{
    struct temporary_folder *folder = *state;
    struct set_up set;
    struct impulse_file *file;
    struct impulse_head written;
    set_up_init(&set);
    const char *path = temporary_file(folder, "impulses.h5");
    write_file(&set, path);
    assert_int_equal(impulse_file_open(&set.report, path, &file), SONJECT_OK);
    const struct impulse_head *head = impulse_file_head(file);
    describe(&written, &set);
    assert_string_equal(head->version, sonject_version());
    assert_string_equal(head->scene_hash, written.scene_hash);
    assert_string_equal(head->scene_text, written.scene_text);
    assert_string_equal(head->scene_path, written.scene_path);
    assert_string_equal(head->scene_folder, written.scene_folder);
    assert_int_equal(head->override_count, 2);
    assert_string_equal(head->overrides[0], written.overrides[0]);
    assert_string_equal(head->overrides[1], written.overrides[1]);
    assert_true(head->seed == UINT64_MAX);
    assert_string_equal(head->image_path, "");
    assert_string_equal(head->image_hash, written.image_hash);
    assert_true(head->image_rows == ROWS && head->image_columns == COLUMNS);
    assert_true(head->sonar.bandwidth_hz == written.sonar.bandwidth_hz);
    assert_true(head->rows == ROWS && head->columns == COLUMNS);
    impulse_file_close(&file);
    set_up_clear(&set);
}

/* What another program might have put there. */

static void remove_attribute(hid_t file, const char *path, const char *name)
{
    assert_true(H5Adelete_by_name(file, path, name, H5P_DEFAULT) >= 0);
}

static void put_attribute(hid_t file, const char *path, const char *name, hid_t type, hid_t space,
                          const void *value)
{
    remove_attribute(file, path, name);
    const hid_t attribute =
        H5Acreate_by_name(file, path, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(attribute >= 0 && H5Awrite(attribute, type, value) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
}

static void put_whole(hid_t file, const char *path, const char *name, int64_t value)
{
    put_attribute(file, path, name, H5T_NATIVE_INT64, H5Screate(H5S_SCALAR), &value);
}

static void put_number(hid_t file, const char *path, const char *name, double value)
{
    put_attribute(file, path, name, H5T_NATIVE_DOUBLE, H5Screate(H5S_SCALAR), &value);
}

/* Zeros; no byte of them is stored where they are many. */
static void put_plane(hid_t file, const char *path, hid_t type, hsize_t strips, hsize_t bins,
                      hsize_t chunk_strips)
{
    const hsize_t extent[2] = {strips, bins};
    const hsize_t chunk[2] = {chunk_strips, bins};
    const hid_t space = H5Screate_simple(2, extent, NULL);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    assert_true(H5Ldelete(file, path, H5P_DEFAULT) >= 0);
    assert_true(H5Pset_chunk(creation, 2, chunk) >= 0);
    const hid_t plane = H5Dcreate2(file, path, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    assert_true(plane >= 0);
    if (strips * bins < 1000000) {
        double *values = allocate_array((size_t)(strips * bins), sizeof *values);
        assert_non_null(values);
        assert_true(H5Dwrite(plane, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
        free(values);
    }
    H5Dclose(plane);
    H5Pclose(creation);
    H5Sclose(space);
}

static void hash_is_missing(hid_t file, const struct set_up *set)
{
    (void)set;
    remove_attribute(file, "/scene", "hash");
}

static void hash_is_a_number(hid_t file, const struct set_up *set)
{
    (void)set;
    put_whole(file, "/scene", "hash", 5);
}

static void hash_is_long(hid_t file, const struct set_up *set)
{
    static const char text[100] = "0123456789012345678901234567890123456789";
    const hid_t type = H5Tcopy(H5T_C_S1);
    (void)set;
    H5Tset_size(type, sizeof text);
    put_attribute(file, "/scene", "hash", type, H5Screate(H5S_SCALAR), text);
    H5Tclose(type);
}

static void path_is_of_variable_length(hid_t file, const struct set_up *set)
{
    const char *text = "scene.yaml";
    const hid_t type = H5Tcopy(H5T_C_S1);
    (void)set;
    H5Tset_size(type, H5T_VARIABLE);
    put_attribute(file, "/scene", "path", type, H5Screate(H5S_SCALAR), &text);
    H5Tclose(type);
}

static void rows_are_many_numbers(hid_t file, const struct set_up *set)
{
    const hsize_t extent = 2;
    const uint64_t values[2] = {1, 2};
    (void)set;
    put_attribute(file, "/image", "rows", H5T_NATIVE_UINT64, H5Screate_simple(1, &extent, NULL),
                  values);
}

static void format_is_newer(hid_t file, const struct set_up *set)
{
    (void)set;
    put_whole(file, "/", "format_version", IMPULSE_FORMAT_VERSION + 1);
}

static void text_is_a_plane(hid_t file, const struct set_up *set)
{
    (void)set;
    put_plane(file, "/scene/text", H5T_NATIVE_FLOAT, 3, 3, 1);
}

static void bandwidth_is_zero(hid_t file, const struct set_up *set)
{
    (void)set;
    put_number(file, "/sonar", "bandwidth_hz", 0.0);
}

static void bandwidth_is_not_a_number(hid_t file, const struct set_up *set)
{
    (void)set;
    put_number(file, "/sonar", "bandwidth_hz", NAN);
}

static void window_is_unknown(hid_t file, const struct set_up *set)
{
    (void)set;
    put_whole(file, "/sonar", "response_window", 77);
}

static void seabed_is_missing(hid_t file, const struct set_up *set)
{
    (void)set;
    assert_true(H5Ldelete(file, "/seabed", H5P_DEFAULT) >= 0);
}

static void seabed_is_a_plane(hid_t file, const struct set_up *set)
{
    seabed_is_missing(file, set);
    assert_true(
        H5Lcreate_hard(file, "/objects/0/energy", file, "/seabed", H5P_DEFAULT, H5P_DEFAULT) >= 0);
}

static void energy_leads_nowhere(hid_t file, const struct set_up *set)
{
    (void)set;
    assert_true(H5Ldelete(file, "/seabed/energy", H5P_DEFAULT) >= 0);
    assert_true(H5Lcreate_soft("/none", file, "/seabed/energy", H5P_DEFAULT, H5P_DEFAULT) >= 0);
}

static void energies_are_integers(hid_t file, const struct set_up *set)
{
    put_plane(file, "/seabed/energy", H5T_NATIVE_INT32, (hsize_t)set->patch.strips.count,
              (hsize_t)set->patch.bins.count, 1);
}

static void energies_are_double(hid_t file, const struct set_up *set)
{
    put_plane(file, "/seabed/energy", H5T_NATIVE_DOUBLE, (hsize_t)set->patch.strips.count,
              (hsize_t)set->patch.bins.count, 1);
}

static void energies_are_fewer(hid_t file, const struct set_up *set)
{
    put_plane(file, "/seabed/energy", H5T_NATIVE_FLOAT, (hsize_t)set->patch.strips.count - 1,
              (hsize_t)set->patch.bins.count, 1);
}

static void strips_overflow(hid_t file, const struct set_up *set)
{
    (void)set;
    put_whole(file, "/seabed", "strips", (int64_t)1 << 40);
}

static void strips_are_negative(hid_t file, const struct set_up *set)
{
    (void)set;
    put_whole(file, "/seabed", "strips", -1);
}

static void first_bin_overflows(hid_t file, const struct set_up *set)
{
    (void)set;
    put_whole(file, "/objects/0", "first_bin", INT32_MAX);
}

static void tile_is_elsewhere(hid_t file, const struct set_up *set)
{
    put_whole(file, "/objects/0", "first_bin", set->patch.bins.first - 1);
}

static void grid_is_finer(hid_t file, const struct set_up *set)
{
    put_whole(file, "/chains/2", "bins_per_pixel", set->patch.bins_per_pixel + 1);
}

/* Terabytes that no byte is stored of. */
static void glints_are_empty_and_huge(hid_t file, const struct set_up *set)
{
    (void)set;
    put_whole(file, "/glints/0", "strips", (int64_t)1 << 20);
    put_whole(file, "/glints/0", "bins", (int64_t)1 << 12);
    put_plane(file, "/glints/0/real", H5T_NATIVE_FLOAT, (hsize_t)1 << 20, (hsize_t)1 << 12, 4);
    put_plane(file, "/glints/0/imaginary", H5T_NATIVE_FLOAT, (hsize_t)1 << 20, (hsize_t)1 << 12, 4);
}

static const struct {
    const char *name;
    void (*change)(hid_t file, const struct set_up *set);
    const char *word; /* of the message */
} changes[] = {
    {"hash is missing", hash_is_missing, "/scene"},
    {"hash is a number", hash_is_a_number, "/scene"},
    {"hash is long", hash_is_long, "/scene"},
    {"path of variable length", path_is_of_variable_length, "/scene"},
    {"text is a plane", text_is_a_plane, "/scene"},
    {"many rows", rows_are_many_numbers, "/image"},
    {"newer format", format_is_newer, "format is 2"},
    {"bandwidth 0", bandwidth_is_zero, "/sonar"},
    {"bandwidth NaN", bandwidth_is_not_a_number, "/sonar"},
    {"unknown window", window_is_unknown, "/sonar"},
    {"no seabed", seabed_is_missing, "/seabed is missing"},
    {"seabed is a plane", seabed_is_a_plane, "/seabed"},
    {"energy leads nowhere", energy_leads_nowhere, "/seabed"},
    {"integers", energies_are_integers, "/seabed"},
    {"doubles", energies_are_double, "/seabed"},
    {"fewer strips", energies_are_fewer, "/seabed"},
    {"strips overflow", strips_overflow, "/seabed"},
    {"negative strips", strips_are_negative, "/seabed"},
    {"first bin overflows", first_bin_overflows, "/objects/0"},
    {"tile elsewhere", tile_is_elsewhere, "/objects/0"},
    {"finer grid", grid_is_finer, "/chains/2"},
    {"empty and huge", glints_are_empty_and_huge, "announces 1048576 x 4096"},
};

static void what_others_wrote_is_refused(void **state)
{
    struct temporary_folder *folder = *state;
    struct set_up set;
    struct taken taken;
    set_up_init(&set);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        const char *path = temporary_file(folder, "impulses.h5");
        write_file(&set, path);
        const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
        assert_true(file >= 0);
        changes[i].change(file, &set);
        assert_true(H5Fclose(file) >= 0);
        /* unsealed, then sealed anew */
        assert_int_equal(read_file(&set, path, &taken), SONJECT_ERROR_INPUT);
        assert_int_equal(impulse_seal_write(&set.report, path, path), SONJECT_OK);
        const sonject_status status = read_file(&set, path, &taken);
        if (status != SONJECT_ERROR_INPUT || !strstr(set.report.message, changes[i].word))
            print_error("%s: status %d, %s\n", changes[i].name, (int)status, set.report.message);
        assert_int_equal(status, SONJECT_ERROR_INPUT);
        assert_non_null(strstr(set.report.message, changes[i].word));
    }
    set_up_clear(&set);
}

/* None of its bytes may change; where they do on purpose, with the right hash, the host goes on. */
static void what_is_damaged_is_refused(void **state)
{
    struct temporary_folder *folder = *state;
    struct set_up set;
    struct taken taken;
    set_up_init(&set);
    const char *path = temporary_file(folder, "impulses.h5");
    write_file(&set, path);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    const long bytes = ftell(file);
    for (long i = 0; i < 40; i++) {
        const long at = (bytes - 1) * i / 39;
        fseek(file, at, SEEK_SET);
        const int byte = fgetc(file);
        fseek(file, at, SEEK_SET);
        fputc(byte ^ 16, file);
        fflush(file);
        assert_int_equal(read_file(&set, path, &taken), SONJECT_ERROR_INPUT);
        assert_int_equal(impulse_seal_write(&set.report, path, path), SONJECT_OK);
        const sonject_status status = read_file(&set, path, &taken);
        assert_true(status == SONJECT_OK || status == SONJECT_ERROR_INPUT);
        fseek(file, at, SEEK_SET);
        fputc(byte, file);
        fflush(file);
    }
    fclose(file);
    assert_int_equal(impulse_seal_write(&set.report, path, path), SONJECT_OK);
    assert_int_equal(read_file(&set, path, &taken), SONJECT_OK);
    set_up_clear(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(lines_come_back, make_temporary_folder,
                                        remove_temporary_folder),
        cmocka_unit_test_setup_teardown(the_head_comes_back, make_temporary_folder,
                                        remove_temporary_folder),
        cmocka_unit_test_setup_teardown(what_others_wrote_is_refused, make_temporary_folder,
                                        remove_temporary_folder),
        cmocka_unit_test_setup_teardown(what_is_damaged_is_refused, make_temporary_folder,
                                        remove_temporary_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
