/* What tracing leaves: lines come back bit for bit, and none are formed that are not the scene's.
 */
#define _POSIX_C_SOURCE 200809L

#include "claims.h"

#include <sonject/version.h>

#include "base/file.h"
#include "base/memory.h"
#include "inject/echoes.h"
#include "inject/injection.h"
#include "trace/glints.h"
#include "unit/temporary_folder.h"

#define ROWS    6
#define COLUMNS 9

/* A scene of one sphere, as far as reading needs it: no device. */
struct set_up {
    struct report report;
    struct scene scene;
    struct injection_setup setup;
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
    object_init(&object);
    object.shape = SONJECT_SHAPE_SPHERE;
    object.diameter_m = 0.02;
    assert_int_equal(scene_append_object(&set->scene, &set->report, &object), SONJECT_OK);
    struct tracer *tracer = &set->setup.tracer;
    const struct injection_input input = {.rows = ROWS, .columns = COLUMNS};
    assert_int_equal(
        injection_setup_init_scene(&set->setup, &set->report, NULL, &set->scene, &input),
        SONJECT_OK);
    point_response_init(&tracer->response, &set->scene.sonar,
                        tracer->view.range_ratio * set->setup.water.straight_speed_mps, 0.025);
    line_grid_for_patch(&set->patch, &tracer->view, &tracer->response);
    glint_strips_init(&set->glints, tracer, 0);
    set->glints.bins.first = -3;
    set->glints.bins.count = 40;
}

static void set_up_clear(struct set_up *set)
{
    injection_setup_clear(&set->setup);
    scene_clear(&set->scene);
}

/* A value of its own for each cell of each plane; some are noisy, so that chunks deflate badly. */
static float value_of(enum impulse_kind kind, uint32_t plane, size_t cell)
{
    const uint32_t mixed = (uint32_t)(cell * 2654435761u + plane * 40503u + (uint32_t)kind * 977u);
    return cell % 7 == 0 ? 0.0f : (float)mixed * 1e-9f;
}

static size_t cells_of(const struct impulse_lines *lines)
{
    return (size_t)lines->strips.count * (size_t)lines->grid.bins.count;
}

/* A set, seabed and glints in pieces of five strips. */
static void write_set(struct sums_writer *writer, struct impulse_lines lines)
{
    const int32_t end = lines.grid.strips.first + lines.grid.strips.count;
    const bool is_whole = lines.kind == IMPULSES_OBJECT || lines.kind == IMPULSES_CHAINS;
    lines.strips.first = lines.grid.strips.first;
    do {
        const int32_t left = end - lines.strips.first;
        const size_t before =
            (size_t)(lines.strips.first - lines.grid.strips.first) * (size_t)lines.grid.bins.count;
        float *values[IMPULSE_PLANES_MAX] = {NULL, NULL, NULL};
        lines.strips.count = is_whole || left < 5 ? left : 5;
        for (uint32_t i = 0; i < lines.planes; i++) {
            lines.plane[i] = values[i] = allocate_array(cells_of(&lines), sizeof(float));
            assert_non_null(values[i]);
            for (size_t k = 0; k < cells_of(&lines); k++)
                values[i][k] = value_of(lines.kind, i, before + k);
        }
        assert_int_equal(impulse_lines_write(writer, &lines), SONJECT_OK);
        for (int i = 0; i < IMPULSE_PLANES_MAX; i++)
            free(values[i]);
        lines.strips.first += lines.strips.count;
    } while (lines.strips.first < end);
}

/* What a trace of the scene hands out, as it is or not. */
#define SETS 4
struct draft {
    struct impulse_lines sets[SETS];
    size_t count;
    struct sums_head head;
    struct impulse_facts facts;
};

static char *overrides[] = {"injection.seed=7"};
static const struct scene_source kept = {
    .path = "scene.yaml", .text = "sonject: 1\n", .overrides = overrides, .override_count = 1};

static struct draft draft_of(const struct set_up *set)
{
    struct draft draft;
    memset(&draft, 0, sizeof draft);
    draft.count = SETS;
    draft.sets[0] = (struct impulse_lines){.grid = set->patch, .planes = 1};
    draft.sets[1] =
        (struct impulse_lines){.kind = IMPULSES_OBJECT, .grid = set->patch, .planes = 3};
    draft.sets[1].grid.strips.count = 4;
    draft.sets[1].grid.bins.count = 5;
    draft.sets[2] =
        (struct impulse_lines){.kind = IMPULSES_GLINT, .grid = set->glints, .planes = 2};
    draft.sets[3] = (struct impulse_lines){
        .kind = IMPULSES_CHAINS, .number = 2, .grid = set->patch, .planes = 1};
    strcpy(draft.head.identity.version, "1.2");
    strcpy(draft.head.identity.scene, "0123456789abcdef0123456789abcdef");
    strcpy(draft.facts.image_hash, "fedcba9876543210fedcba9876543210");
    draft.facts.image_rows = ROWS;
    draft.facts.image_columns = COLUMNS;
    impulse_facts_note_sonar(&draft.facts, &set->scene.sonar);
    draft.facts.counts.rays = (uint64_t)1 << 40;
    return draft;
}

static void write_draft(struct set_up *set, const char *path, const struct draft *draft)
{
    struct sums_writer writer;
    assert_int_equal(sums_writer_begin(&writer, &set->report, path, NULL), SONJECT_OK);
    for (size_t i = 0; i < draft->count; i++)
        write_set(&writer, draft->sets[i]);
    assert_int_equal(impulse_file_publish(&writer, &draft->head, &kept, &draft->facts, "line.tif"),
                     SONJECT_OK);
    sums_writer_clear(&writer);
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
    struct impulse_file file;
    struct echo_request request;
    const struct impulse_sink sink = {take, taken};
    memset(taken, 0, sizeof *taken);
    memset(&request, 0, sizeof request);
    sonject_status status = impulse_file_open(&set->report, path, &file);
    if (status != SONJECT_OK)
        return status;
    const struct impulse_source source = impulse_file_source(&file);
    status = source.deliver(source.giver, &set->setup.tracer, &request, &sink);
    impulse_file_close(&file);
    return status;
}

static void lines_and_facts_come_back(void **state)
{
    struct temporary_folder *folder = *state;
    struct set_up set;
    struct taken taken;
    struct impulse_file file;
    sonject_sonar_params sonar;
    set_up_init(&set);
    const char *path = temporary_file(folder, "traced.sums");
    const struct draft draft = draft_of(&set);
    write_draft(&set, path, &draft);
    assert_int_equal(read_file(&set, path, &taken), SONJECT_OK);
    assert_int_equal(taken.cells[IMPULSES_SEABED], line_grid_cells(&set.patch));
    assert_int_equal(taken.cells[IMPULSES_OBJECT], 20);
    assert_int_equal(taken.cells[IMPULSES_GLINT], line_grid_cells(&set.glints));
    assert_int_equal(taken.cells[IMPULSES_LEVEL], 0);
    assert_int_equal(taken.cells[IMPULSES_CHAINS], line_grid_cells(&set.patch));
    assert_true(set.setup.tracer.counts.rays == (uint64_t)1 << 40);
    assert_int_equal(impulse_file_open(&set.report, path, &file), SONJECT_OK);
    assert_memory_equal(&file.facts, &draft.facts, sizeof draft.facts);
    assert_memory_equal(&file.sums.head.identity, &draft.head.identity, sizeof draft.head.identity);
    assert_string_equal(file.sums.scene.overrides[0], overrides[0]);
    assert_string_equal(file.image_path, "line.tif");
    memset(&sonar, 0, sizeof sonar);
    impulse_facts_take_sonar(&file.facts, &sonar);
    assert_true(sonar.bandwidth_hz == set.scene.sonar.bandwidth_hz);
    impulse_file_close(&file);
    set_up_clear(&set);
}

/* What another program might have put there, with sound digests. */
enum change {
    BANDWIDTH_IS_ZERO,
    BANDWIDTH_IS_NOT_A_NUMBER,
    WINDOW_IS_UNKNOWN,
    HASH_IS_ENDLESS,
    THERE_IS_NOTHING,
    SEABED_IS_MISSING,
    SEABED_COMES_TWICE,
    THERE_ARE_MORE_PLANES,
    OBJECT_IS_OF_NO_SCENE,
    CHAINS_ARE_TOO_LONG,
    FIRST_BIN_OVERFLOWS,
    TILE_IS_ELSEWHERE,
    GRID_IS_FINER,
    GLINTS_ARE_COARSE,
    SEABED_IS_SMALLER_THAN_THE_PATCH,
    IT_IS_A_SHARD,
    CHANGES
};

/* Makes the change. Returns a word of the message. */
static const char *make_change(struct draft *draft, int change)
{
    struct impulse_lines *sets = draft->sets;
    const char *word = "not those of this scene";
    switch (change) {
    case BANDWIDTH_IS_ZERO:
        draft->facts.bandwidth_hz = 0.0;
        break;
    case BANDWIDTH_IS_NOT_A_NUMBER:
        draft->facts.bandwidth_hz = NAN;
        break;
    case WINDOW_IS_UNKNOWN:
        draft->facts.response_window = 77;
        break;
    case HASH_IS_ENDLESS:
        memset(draft->facts.image_hash, 'a', sizeof draft->facts.image_hash);
        word = "not what sonject trace leaves";
        break;
    case THERE_IS_NOTHING:
        draft->count = 0;
        break;
    case SEABED_IS_MISSING:
        memmove(sets, sets + 1, --draft->count * sizeof *sets);
        break;
    case SEABED_COMES_TWICE:
        sets[1] = sets[0];
        break;
    case THERE_ARE_MORE_PLANES:
        sets[0].planes = 2;
        break;
    case OBJECT_IS_OF_NO_SCENE:
        sets[1].number = 1;
        break;
    case CHAINS_ARE_TOO_LONG:
        sets[3].number = SCENE_INTERACTIONS_MAX + 1;
        break;
    case FIRST_BIN_OVERFLOWS:
        sets[1].grid.bins.first = INT32_MAX;
        break;
    case TILE_IS_ELSEWHERE:
        sets[1].grid.bins.first = sets[0].grid.bins.first - 1;
        break;
    case GRID_IS_FINER:
        sets[3].grid.bins_per_pixel++;
        break;
    case GLINTS_ARE_COARSE:
        sets[2].grid.bins_per_pixel = 1;
        word = "the glints of";
        break;
    case SEABED_IS_SMALLER_THAN_THE_PATCH:
        sets[0].grid.bins.count = 3;
        word = "is damaged";
        break;
    case IT_IS_A_SHARD:
        strcpy(draft->head.launches, "course");
        word = "sonject merge";
    }
    return word;
}

static void what_is_not_of_the_scene_is_refused(void **state)
{
    struct temporary_folder *folder = *state;
    struct set_up set;
    struct taken taken;
    set_up_init(&set);
    for (int change = 0; change < CHANGES; change++) {
        const char *path = temporary_file(folder, "traced.sums");
        struct draft draft = draft_of(&set);
        const char *word = make_change(&draft, change);
        write_draft(&set, path, &draft);
        const sonject_status status = read_file(&set, path, &taken);
        if (status != SONJECT_ERROR_INPUT || !strstr(set.report.message, word))
            fail_msg("change %d: status %d, %s", change, (int)status, set.report.message);
    }
    set_up_clear(&set);
}

/* Records of numbers that are no lines, and more numbers than the file could hold. */
static void words_that_are_no_lines_are_refused(void **state)
{
    static const int64_t records[][LINES_HEAD_WORDS + 1] = {
        {IMPULSE_KINDS, 0, 1, 1, 0, 1, 0, 1, 0, 1, 1},
        {-1, 0, 1, 1, 0, 1, 0, 1, 0, 1, 1},
        {0, 0, 0, 1, 0, 1, 0, 1, 0, 1, 1},
        {0, 0, 1, 1, 0, -1, 0, 1, 0, 1, 1},
        {0, 0, 1, 1, 0, INT64_MAX, 0, 1, 0, 1, 1},
        {0, 0, 1, 1, 0, 1, 0, 2, 0, 2, 1},
        {0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1},
        {0, 0, 1, 1, 0, 1, 0, 1, 0, 1, IMPULSE_PLANES_MAX + 1},
        {0, 0, 1, 1, 0, 1, 0, 1, 0, 1, 0},
    };
    struct temporary_folder *folder = *state;
    struct set_up set;
    struct taken taken;
    set_up_init(&set);
    const struct draft draft = draft_of(&set);
    const size_t count = COUNT(records);
    for (size_t i = 0; i < count + 2; i++) {
        const char *path = temporary_file(folder, "traced.sums");
        struct sums_writer writer;
        assert_int_equal(sums_writer_begin(&writer, &set.report, path, NULL), SONJECT_OK);
        if (i < count)
            assert_int_equal(sums_writer_sums(&writer, records[i], LINES_HEAD_WORDS + 1),
                             SONJECT_OK);
        else if (i == count)
            assert_int_equal(sums_writer_sums(&writer, records[0], 3), SONJECT_OK);
        else
            assert_true(sums_writer_begin_sums(&writer, (uint64_t)1 << 40) == SONJECT_OK &&
                        sums_writer_end_sums(&writer) == SONJECT_OK);
        assert_int_equal(impulse_file_publish(&writer, &draft.head, NULL, &draft.facts, ""),
                         SONJECT_OK);
        sums_writer_clear(&writer);
        assert_int_equal(read_file(&set, path, &taken), SONJECT_ERROR_INPUT);
        assert_int_equal(taken.cells[IMPULSES_SEABED], 0);
    }
    set_up_clear(&set);
}

#define IN_FOLDER(test)                                                                            \
    cmocka_unit_test_setup_teardown(test, make_temporary_folder, remove_temporary_folder)

TEST_PROGRAM(NULL, NULL, IN_FOLDER(lines_and_facts_come_back),
             IN_FOLDER(what_is_not_of_the_scene_is_refused),
             IN_FOLDER(words_that_are_no_lines_are_refused))
