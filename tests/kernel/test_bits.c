/* The same bits everywhere: what a device tallies and forms, at every width, chunking, core count
 * and time, is what the same kernel functions give as plain C, one lane at a time. */
#include "claims.h"
#include "image_formation.h"
#include "trace_rough_mirrored.h"
#include "trace_smooth_mirrored.h"

#include "device/opencl.h"
#include "physics/bench.h"
#include "scene/cross_range.h"
#include "scene/motion_response.h"
#include "trace/rough.h"

#define ROWS    96
#define COLUMNS 128

enum scene_kind {
    SCENE_ALL_SHAPES,   /* several objects, source at the receiver */
    SCENE_WIDE_SOURCE,  /* the same, source rectangle: visibility tests */
    SCENE_WITH_MAP,     /* and a reflectivity map */
    SCENE_EMPTY,        /* seabed alone */
    SCENE_MORE_SHAPES,  /* shapes that are not plain, whole and cut; source rectangle */
    SCENE_LAYERS,       /* the first one's objects, under a layer of faster water */
    SCENE_RELIEF,       /* the first one's objects among ripples, a mound and scour */
    SCENE_WIDE_RELIEF,  /* the same, source rectangle and map */
    SCENE_ASPECTS,      /* the first one's objects, seen by a weighted synthetic aperture */
    SCENE_WIDE_ASPECTS, /* the same among relief, source rectangle and map */
    SCENE_BEAM,         /* the first one's objects, seen by the beam of a turned real aperture */
    SCENE_KINDS
};

static void place(sonject_object_params *object, double row, double column, double heading,
                  double pitch, double roll)
{
    object->position_kind = SONJECT_POSITION_PIXELS;
    object->position_along = row;
    object->position_range = column;
    object->heading_rad = heading;
    object->pitch_rad = pitch;
    object->roll_rad = roll;
    object->material.lambert = 0.05;
    object->material.reflection = 0.8;
    object->material.roughness_m = 1e-3;
}

static void cut(sonject_object_params *object, double azimuth, double elevation, double distance)
{
    sonject_cut *added = &object->cuts[object->cut_count++];
    added->azimuth_rad = azimuth;
    added->elevation_rad = elevation;
    added->distance_m = distance;
}

static void place_more_shapes(struct bench *bench)
{
    const struct {
        sonject_shape shape;
        double length, width, height, diameter, row, column;
    } shapes[] = {
        {SONJECT_SHAPE_DISC, 0.0, 0.0, 0.0, 0.4, 20.0, 25.0},
        {SONJECT_SHAPE_ELLIPSOID, 0.6, 0.4, 0.3, 0.0, 20.0, 55.0},
        {SONJECT_SHAPE_BOX, 0.5, 0.4, 0.3, 0.0, 20.0, 85.0},
        {SONJECT_SHAPE_WEDGE, 0.6, 0.4, 0.3, 0.0, 45.0, 35.0},
        {SONJECT_SHAPE_TRUNCATED_CONE, 0.0, 0.0, 0.3, 0.6, 45.0, 70.0},
        {SONJECT_SHAPE_TORUS, 0.0, 0.0, 0.15, 0.6, 75.0, 25.0},
        {SONJECT_SHAPE_CYLINDER, 0.8, 0.0, 0.0, 0.3, 75.0, 55.0},
        {SONJECT_SHAPE_CYLINDER, 0.8, 0.0, 0.0, 0.3, 75.0, 90.0},
    };
    for (size_t i = 0; i < BENCH_OBJECTS; i++) {
        sonject_object_params *object = bench_add(bench, shapes[i].shape, shapes[i].length,
                                                  shapes[i].width, shapes[i].diameter);
        object->height_m = shapes[i].height;
        object->top_diameter_m = 0.3;
        place(object, shapes[i].row, shapes[i].column, 0.3 + 0.7 * (double)i, 0.2, 0.1);
    }
    sonject_object_params *objects = bench->scene.objects;
    cut(&objects[1], 0.4, 0.9, 0.05);
    cut(&objects[1], 2.4, -0.2, 0.1);
    cut(&objects[4], 1.0, 0.5, 0.1);
    objects[5].pitch_rad = 1.0;
    cut(&objects[5], -1.0, 0.1, 0.15);
    objects[6].nose_end = SONJECT_END_SPHERICAL;
    objects[6].nose_end_depth_m = 0.05;
    objects[6].tail_end = SONJECT_END_SPHERICAL;
    objects[7].nose_end = objects[7].tail_end = SONJECT_END_OPEN;
}

static void make_relief(struct bench *bench)
{
    struct relief_feature *ripples = bench_add_relief(bench, RELIEF_RIPPLES);
    ripples->wavelength_m = 0.4;
    ripples->height_m = 0.05;
    ripples->heading_rad = 1.2;
    ripples->sharpness = 0.5;
    ripples->irregularity = 0.5;
    struct relief_feature *mound = bench_add_relief(bench, RELIEF_MOUND);
    mound->radius_m = 0.5;
    mound->height_m = 0.3;
    struct relief_feature *scour = bench_add_relief(bench, RELIEF_SCOUR);
    scour->width_m = 0.3;
    scour->height_m = 0.08;
    strcpy(scour->object, "sphere");
    strcpy(bench->scene.objects[0].name, "sphere");
}

static void make_scene(struct bench *bench, enum scene_kind kind)
{
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.02}, {3.0, 1530.0, 1.0}};
    bench->scene.injection.seed = 0x123456789abcdefu;
    bench->scene.sonar.altitude_m = 7.3;
    bench->scene.medium.reference_sound_speed_mps = 1480.0;
    bench->scene.sonar.along_track_resolution_m = 0.03;
    bench->scene.injection.ray_scale = 0.5;
    if (kind == SCENE_LAYERS)
        bench_set_layers(bench, layers, 2);
    if (kind == SCENE_MORE_SHAPES) {
        place_more_shapes(bench);
    } else if (kind != SCENE_EMPTY) {
        place(bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.4), 20.2, 40.7, 0.0, 0.0, 0.0);
        place(bench_add(bench, SONJECT_SHAPE_CYLINDER, 0.8, 0.0, 0.3), 50.0, 30.0, 0.7, 0.2, 0.0);
        place(bench_add(bench, SONJECT_SHAPE_CAPSULE, 1.0, 0.0, 0.3), 60.0, 70.0, -0.4, 0.1, 0.3);
        place(bench_add(bench, SONJECT_SHAPE_PLANE, 0.6, 0.4, 0.0), 40.0, 55.0, 0.3, -0.5, 0.4);
        bench->scene.objects[3].burial_m = 0.05;
    }
    bench->scene.sonar.aperture_rad = 0.0;
    bench->scene.sonar.response_window = SONJECT_WINDOW_RECTANGULAR;
    bench->scene.sonar.kind = SONJECT_SONAR_SYNTHETIC;
    if (kind == SCENE_BEAM) {
        bench->scene.sonar.kind = SONJECT_SONAR_REAL;
        bench->scene.sonar.array_length_m = 0.4;
        bench->scene.sonar.array_height_m = 0.05;
        bench->scene.sonar.array_heading_rad = 0.05;
        bench->scene.sonar.array_pitch_rad = -0.03;
        bench->scene.sonar.array_depression_rad = 0.4;
    }
    if (kind == SCENE_ASPECTS || kind == SCENE_WIDE_ASPECTS) {
        bench->scene.sonar.aperture_rad = 0.3;
        bench->scene.sonar.response_window = SONJECT_WINDOW_TAYLOR;
    }
    if (kind == SCENE_RELIEF || kind == SCENE_WIDE_RELIEF || kind == SCENE_WIDE_ASPECTS)
        make_relief(bench);
    if (kind == SCENE_WIDE_RELIEF || kind == SCENE_WIDE_ASPECTS || kind == SCENE_WIDE_SOURCE ||
        kind == SCENE_WITH_MAP || kind == SCENE_MORE_SHAPES)
        bench->scene.sonar.transducer_side_m = 0.2;
    bench_ready(bench);
}

static float *make_map(enum scene_kind kind)
{
    if (kind != SCENE_WITH_MAP && kind != SCENE_WIDE_RELIEF && kind != SCENE_WIDE_ASPECTS)
        return NULL;
    float *map = malloc(ROWS * COLUMNS * sizeof *map);
    assert_non_null(map);
    const struct random_key key = random_key_of(5, 0, 99, 0);
    for (uint32_t i = 0; i < ROWS * COLUMNS; i++) {
        float u, v;
        two_uniforms(key, i, 0, &u, &v);
        map[i] = u < 0.1f ? 0.0f : -3.0f * natural_logarithm(v);
    }
    return map;
}

/* Everything a trace leaves behind. */
struct tallies {
    size_t lines, tiles; /* elements */
    int64_t *line, *tile;
    struct trace_counts counts;
};

static void tallies_clear(struct tallies *tallies)
{
    free(tallies->line);
    free(tallies->tile);
}

static void expect_same(const char *what, const struct tallies *a, const struct tallies *b)
{
    assert_int_equal(a->lines, b->lines);
    assert_int_equal(a->tiles, b->tiles);
    for (size_t i = 0; i < a->lines; i++)
        if (a->line[i] != b->line[i])
            fail_msg("%s: line element %zu of %zu is %lld, not %lld", what, i, a->lines,
                     (long long)a->line[i], (long long)b->line[i]);
    for (size_t i = 0; i < a->tiles; i++)
        if (a->tile[i] != b->tile[i])
            fail_msg("%s: tile element %zu of %zu is %lld, not %lld", what, i, a->tiles,
                     (long long)a->tile[i], (long long)b->tile[i]);
    assert_int_equal(a->counts.rays, b->counts.rays);
    assert_int_equal(a->counts.impulses, b->counts.impulses);
    assert_int_equal(a->counts.queries, b->counts.queries);
}

/* A sum without weight would let a dead trace pass. */
static bool is_alive(const struct tallies *tallies)
{
    size_t filled = 0;
    for (size_t i = 0; i < tallies->lines; i++)
        filled += tallies->line[i] != 0;
    return filled > tallies->lines / 20;
}

static void expect_alive(const struct tallies *tallies)
{
    assert_true(is_alive(tallies));
}

static void begin_rough(struct rough_trace *trace, struct bench *bench, const float *map)
{
    struct tracer *tracer = &bench->tracer;
    const sonject_status status = bench->scene.sonar.kind == SONJECT_SONAR_REAL
                                      ? rough_trace_begin_beam(trace, tracer, &tracer->response)
                                      : rough_trace_begin(trace, tracer, map);
    EXPECT_OK(&bench->report, status);
}

static struct tallies trace_rough_on_device(struct bench *bench, const float *map, int32_t chunk)
{
    struct rough_trace trace;
    struct tallies tallies = {0, 0, NULL, NULL, {0, 0, 0, 0}};
    memset(&bench->tracer.counts, 0, sizeof bench->tracer.counts);
    begin_rough(&trace, bench, map);
    const size_t bins = (size_t)trace.grid.bins.count;
    const int32_t count = trace.grid.strips.count;
    tallies.lines = line_grid_cells(&trace.grid);
    tallies.tiles = trace.tile_elements;
    tallies.line = calloc(tallies.lines, sizeof(int64_t));
    tallies.tile = calloc(tallies.tiles + 1, sizeof(int64_t));
    float *energy = calloc(tallies.lines, sizeof *energy);
    assert_true(tallies.line && tallies.tile && energy);
    assert_true(trace.chunk >= count);
    for (int32_t done = 0; done < count; done += chunk) {
        const int32_t left = count - done;
        const struct span strips = {trace.grid.strips.first + done, left < chunk ? left : chunk};
        EXPECT_OK(&bench->report, rough_trace_strips(&trace, &bench->tracer, strips, energy));
        EXPECT_OK(&bench->report, buffer_read(&bench->report, bench->tracer.device,
                                              trace.launch.buffers[ROUGH_TALLIES], 0,
                                              (size_t)strips.count * bins * sizeof(int64_t),
                                              tallies.line + (size_t)done * bins));
        for (size_t i = 0; i < (size_t)strips.count * bins; i++)
            assert_true(energy[i] == (float)((double)tallies.line[(size_t)done * bins + i] *
                                             trace.energy_of_quantum));
    }
    if (tallies.tiles > 0)
        assert_int_equal(buffer_read(&bench->report, bench->tracer.device,
                                     trace.launch.buffers[ROUGH_TILES], 0,
                                     tallies.tiles * sizeof(int64_t), tallies.tile),
                         SONJECT_OK);
    tallies.counts = bench->tracer.counts;
    free(energy);
    rough_trace_end(&trace);
    return tallies;
}

static void count_outcome(struct tallies *tallies, struct outcome_record outcome)
{
    assert_int_equal(outcome.faults, 0);
    tallies->counts.queries += outcome.queries;
    tallies->counts.impulses += outcome.impulses;
}

static struct tallies trace_rough_as_c(struct bench *bench, const float *map)
{
    struct rough_trace trace;
    struct tallies tallies = {0, 0, NULL, NULL, {0, 0, 0, 0}};
    begin_rough(&trace, bench, map);
    struct object_record *objects = bench_copy_buffer(bench, trace.launch.buffers[0]);
    tallies.lines = line_grid_cells(&trace.grid);
    tallies.tiles = trace.tile_elements;
    tallies.line = calloc(tallies.lines, sizeof(int64_t));
    tallies.tile = calloc(tallies.tiles + 1, sizeof(int64_t));
    assert_true(tallies.line && tallies.tile);
    rough_trace_aim(&trace, trace.grid.strips);
    trace.launch.fan.segments = 1;
    for (int strip = 0; strip < trace.launch.fan.strips; strip++)
        count_outcome(&tallies,
                      trace_rough_strip(&trace.launch.fan, trace.launch.rays.pieces, objects, map,
                                        tallies.line, tallies.tile, strip, 0));
    tallies.counts.rays = (uint64_t)trace.launch.fan.rays * (uint64_t)trace.launch.fan.strips;
    free(objects);
    rough_trace_end(&trace);
    return tallies;
}

/* By way of mirrors where there is a pair of sources, else straight. */
static void begin_smooth(struct smooth_trace *trace, struct bench *bench, uint32_t object,
                         const struct image_pair *pair)
{
    EXPECT_OK(&bench->report, smooth_trace_begin(trace, &bench->tracer, object, pair));
}

static struct tallies trace_smooth_on_device(struct bench *bench, uint32_t object,
                                             const struct image_pair *pair, int32_t wanted_chunk)
{
    struct smooth_trace trace;
    struct tallies tallies = {0, 0, NULL, NULL, {0, 0, 0, 0}};
    memset(&bench->tracer.counts, 0, sizeof bench->tracer.counts);
    begin_smooth(&trace, bench, object, pair);
    const size_t bins = (size_t)trace.grid.bins.count;
    const int32_t count = trace.grid.strips.count;
    const int32_t most = trace.chunk;
    const int32_t chunk = wanted_chunk < most ? wanted_chunk : most;
    tallies.lines = 2 * line_grid_cells(&trace.grid);
    tallies.line = calloc(tallies.lines, sizeof(int64_t));
    float *a = calloc(tallies.lines, sizeof *a);
    float *b = calloc(tallies.lines, sizeof *b);
    assert_true(tallies.line && a && b);
    for (int32_t done = 0; done < count; done += chunk) {
        const int32_t left = count - done;
        const struct span strips = {trace.grid.strips.first + done, left < chunk ? left : chunk};
        EXPECT_OK(&bench->report, smooth_trace_strips(&trace, &bench->tracer, strips, a, b));
        EXPECT_OK(&bench->report, buffer_read(&bench->report, bench->tracer.device,
                                              trace.launch.buffers[SMOOTH_TALLIES], 0,
                                              2 * (size_t)strips.count * bins * sizeof(int64_t),
                                              tallies.line + 2 * (size_t)done * bins));
    }
    tallies.counts = bench->tracer.counts;
    free(a);
    free(b);
    smooth_trace_end(&trace);
    return tallies;
}

static struct tallies trace_smooth_as_c(struct bench *bench, uint32_t object,
                                        const struct image_pair *pair)
{
    struct smooth_trace trace;
    struct image_pair_record sources;
    struct tallies tallies = {0, 0, NULL, NULL, {0, 0, 0, 0}};
    begin_smooth(&trace, bench, object, pair);
    assert_true(trace.grid.bins.count > 0);
    struct object_record *objects = bench_copy_buffer(bench, trace.launch.buffers[0]);
    if (pair)
        assert_int_equal(buffer_read(&bench->report, bench->tracer.device,
                                     trace.launch.buffers[SMOOTH_SOURCES], 0, sizeof sources,
                                     &sources),
                         SONJECT_OK);
    tallies.lines = 2 * line_grid_cells(&trace.grid);
    tallies.line = calloc(tallies.lines, sizeof(int64_t));
    assert_non_null(tallies.line);
    trace.launch.fan.first_strip = trace.grid.strips.first;
    trace.launch.fan.strips = trace.grid.strips.count;
    trace.launch.fan.segments = 1;
    for (int strip = 0; strip < trace.launch.fan.strips; strip++)
        count_outcome(&tallies,
                      pair
                          ? trace_smooth_mirrored_strip(&trace.launch.fan, trace.launch.rays.pieces,
                                                        &sources, objects, tallies.line, strip, 0)
                          : trace_smooth_strip(&trace.launch.fan, trace.launch.rays.pieces, objects,
                                               tallies.line, strip, 0));
    tallies.counts.rays = (uint64_t)trace.launch.fan.rays * trace.launch.fan.strata *
                          (uint64_t)trace.launch.fan.strips;
    free(objects);
    smooth_trace_end(&trace);
    return tallies;
}

typedef void body(struct bench *bench, enum scene_kind kind);

/* The same device with kernels of each number of lanes; plain C, which is the same for all, runs
 * once. */
static uint32_t widths[BENCH_WIDTHS];
static struct device *devices[BENCH_WIDTHS];
static size_t width_count;

static void on_all_kinds(body *run)
{
    struct bench bench;
    width_count = bench_widths(widths);
    bench_open(&bench, ROWS, COLUMNS, 18.0);
    sonject_context_params params;
    memset(&params, 0, sizeof params);
    params.struct_size = sizeof params;
    params.device_name = bench_device;
    struct device *first = bench.tracer.device;
    for (size_t w = 0; w < width_count; w++) {
        EXPECT_OK(&bench.report, device_open(&bench.report, &params, &devices[w]));
        devices[w]->width = widths[w];
    }
    for (int kind = 0; kind < SCENE_KINDS; kind++) {
        scene_clear(&bench.scene);
        bench_move(&bench, 18.0);
        bench.tracer.device = devices[width_count - 1];
        run(&bench, (enum scene_kind)kind);
    }
    for (size_t w = 0; w < width_count; w++)
        device_close(&devices[w]);
    bench.tracer.device = first;
    bench_close(&bench);
}

/* Lets the device have another number of lanes. */
static void take_width(struct bench *bench, size_t w)
{
    bench->tracer.device = devices[w];
}

/* Programs take long to compile, and all are of the same vectors: those of the plain scenes are
 * compared at the ends of the row of widths, one also amid it, others at the upper end alone. */
static bool is_at_end(size_t w)
{
    return w == 0 || w == width_count - 1;
}

static bool is_rough_compared(enum scene_kind kind, size_t w)
{
    if (kind < SCENE_RELIEF)
        return is_at_end(w) || widths[w] == 8;
    return w == width_count - 1 || (w == 0 && kind != SCENE_ASPECTS && kind != SCENE_BEAM);
}

static bool is_smooth_compared(const struct bench *bench, size_t w)
{
    return w == width_count - 1 || (w == 0 && !bench->tracer.relief);
}

/* Strips that are traced or formed at once: all, twice, and few; at the lower end, where each takes
 * longest, some of these. */
#define CHUNKINGS 4
static size_t chunkings_at(size_t w)
{
    return w < width_count - 1 && w == 0 ? 2 : CHUNKINGS;
}

static void compare_rough(struct bench *bench, enum scene_kind kind)
{
    make_scene(bench, kind);
    float *map = make_map(kind);
    struct tallies expected = trace_rough_as_c(bench, map);
    expect_alive(&expected);
    static const int32_t chunks[CHUNKINGS] = {1 << 20, 37, 1 << 20, 1};
    for (size_t w = 0; w < width_count; w++) {
        if (!is_rough_compared(kind, w))
            continue;
        take_width(bench, w);
        print_message("scene %d, width %u\n", (int)kind, (unsigned)widths[w]);
        for (size_t i = 0; i < chunkings_at(w); i++) {
            /* a strip alone would be traced again for each of its many neighbours */
            if (chunks[i] == 1 && kind == SCENE_WIDE_ASPECTS)
                continue;
            struct tallies measured = trace_rough_on_device(bench, map, chunks[i]);
            expect_same("rough", &measured, &expected);
            tallies_clear(&measured);
        }
    }
    tallies_clear(&expected);
    free(map);
}

static void test_rough_tallies(void **state)
{
    on_all_kinds(compare_rough);
}

/* Whether there was anything to compare. */
static bool compare_pair(struct bench *bench, uint32_t object, const struct image_pair *pair)
{
    struct tallies expected = trace_smooth_as_c(bench, object, pair);
    const bool had_echoes = is_alive(&expected);
    static const int32_t chunks[CHUNKINGS] = {1 << 20, 37, 1 << 20, 5};
    for (size_t w = 0; w < width_count; w++) {
        if (!is_smooth_compared(bench, w))
            continue;
        take_width(bench, w);
        for (size_t i = 0; i < chunkings_at(w); i++) {
            struct tallies measured = trace_smooth_on_device(bench, object, pair, chunks[i]);
            expect_same("smooth", &measured, &expected);
            tallies_clear(&measured);
        }
    }
    tallies_clear(&expected);
    return had_echoes;
}

static void compare_smooth(struct bench *bench, enum scene_kind kind)
{
    if (kind != SCENE_ALL_SHAPES && kind != SCENE_MORE_SHAPES && kind != SCENE_LAYERS &&
        kind != SCENE_RELIEF)
        return; /* neither source nor map matter to glints */
    make_scene(bench, kind);
    for (uint32_t object = 0; object < bench->scene.object_count; object++)
        assert_true(compare_pair(bench, object, NULL));
}

static void test_smooth_tallies(void **state)
{
    on_all_kinds(compare_smooth);
}

/* Over relief the sea surface alone is a mirror. */
static void compare_under_relief(struct bench *bench)
{
    struct sound_source sources[SOURCES_MAX];
    size_t alive = 0;
    make_scene(bench, SCENE_RELIEF);
    bench->scene.surface.water_depth_m = 7.5;
    assert_int_equal(sources_list(&bench->scene, &bench->water, 2, sources), 2);
    for (uint32_t object = 0; object < bench->scene.object_count; object++) {
        const struct image_pair there_and_back = {&sources[0], &sources[1], 0};
        const struct image_pair twice = {&sources[1], &sources[1], 1};
        alive += compare_pair(bench, object, &there_and_back);
        alive += compare_pair(bench, object, &twice);
    }
    assert_true(alive >= 6);
}

/* A fluid seabed, a rough surface, and pairs of the sonar and its images in both. */
static void compare_mirrored(struct bench *bench, enum scene_kind kind)
{
    static const size_t numbers[][2] = {{0, 1}, {1, 1}, {0, 2}, {1, 4}, {2, 4}};
    struct sound_source sources[SOURCES_MAX];
    if (kind == SCENE_RELIEF)
        compare_under_relief(bench);
    if (kind != SCENE_ALL_SHAPES && kind != SCENE_LAYERS)
        return;
    make_scene(bench, kind);
    bench->scene.seabed.forward.reflection_kind = SONJECT_REFLECTION_FLUID;
    bench->scene.seabed.forward.density_ratio = 1.845;
    bench->scene.seabed.forward.speed_ratio = 1.1782;
    bench->scene.seabed.forward.loss = 0.01624;
    bench->scene.surface.water_depth_m = 7.5;
    bench->scene.surface.material.roughness_m = 1e-3;
    assert_int_equal(sources_list(&bench->scene, &bench->water, 2, sources), 5);
    size_t alive = 0;
    for (uint32_t object = 0; object < bench->scene.object_count; object++)
        for (size_t i = 0; i < COUNT(numbers); i++) {
            const struct image_pair pair = {&sources[numbers[i][0]], &sources[numbers[i][1]],
                                            (uint32_t)i};
            alive += compare_pair(bench, object, &pair);
        }
    /* of 20: the plate is not seen from two sides everywhere */
    assert_true(alive >= 15);
}

static void test_mirrored_tallies(void **state)
{
    on_all_kinds(compare_mirrored);
}

/* Tiles of the rough part by way of mirrors, on a fresh trace. */
static int64_t *mirrored_tiles(struct bench *bench, size_t *elements)
{
    struct rough_trace trace;
    EXPECT_OK(&bench->report, rough_trace_begin(&trace, &bench->tracer, NULL));
    EXPECT_OK(&bench->report, rough_trace_mirrored(&trace, &bench->tracer));
    *elements = trace.tile_elements;
    int64_t *tiles = calloc(*elements, sizeof *tiles);
    assert_non_null(tiles);
    assert_int_equal(buffer_read(&bench->report, bench->tracer.device,
                                 trace.launch.buffers[ROUGH_TILES], 0, *elements * sizeof *tiles,
                                 tiles),
                     SONJECT_OK);
    rough_trace_end(&trace);
    return tiles;
}

static void compare_rough_mirrored(struct bench *bench, enum scene_kind kind)
{
    int64_t *first = NULL;
    size_t first_elements = 0;
    if (kind != SCENE_ALL_SHAPES && kind != SCENE_LAYERS && kind != SCENE_RELIEF)
        return;
    bench->scene.seabed.forward.reflection = kind == SCENE_RELIEF ? 0.0 : 0.9;
    bench->scene.surface.water_depth_m = 7.5;
    bench->scene.injection.interactions = 4;
    make_scene(bench, kind);
    for (int end = 0; end < 2; end++) { /* of the row of widths, where that has one alone, twice */
        size_t elements, filled = 0;
        take_width(bench, end == 0 ? 0 : width_count - 1);
        int64_t *tiles = mirrored_tiles(bench, &elements);
        for (size_t i = 0; i < elements; i++)
            filled += tiles[i] != 0;
        assert_true(filled > 1000);
        if (first) {
            assert_int_equal(elements, first_elements);
            assert_memory_equal(tiles, first, elements * sizeof *tiles);
        }
        free(first);
        first = tiles;
        first_elements = elements;
    }
    free(first);
}

static void test_rough_mirrored_tallies(void **state)
{
    on_all_kinds(compare_rough_mirrored);
}

/* Planes of lines or pixels, real part first. */
struct planes {
    size_t count;
    float *part[2];
};

static struct planes planes_of(size_t count)
{
    struct planes planes = {count, {calloc(count, sizeof(float)), calloc(count, sizeof(float))}};
    assert_true(planes.part[0] && planes.part[1]);
    return planes;
}

static void planes_clear(struct planes *planes)
{
    free(planes->part[0]);
    free(planes->part[1]);
}

static void expect_same_planes(const struct planes *a, const struct planes *b)
{
    assert_int_equal(a->count, b->count);
    for (int part = 0; part < 2; part++)
        for (size_t i = 0; i < a->count; i++)
            if (memcmp(&a->part[part][i], &b->part[part][i], sizeof(float)) != 0)
                fail_msg("element %zu of %zu is %.9g, not %.9g", i, a->count,
                         (double)a->part[part][i], (double)b->part[part][i]);
}

static void compress_as_c(struct bench *bench, const struct form_lines *lines,
                          const struct planes *bins, const float *pulse, struct planes *compressed)
{
    const size_t strips = (size_t)lines->grid.strips.count;
    const int count = lines->grid.bins.count;
    const struct filled_span all = {0, count}; /* zeros too, which the device leaves out */
    const int per_pixel = (int)lines->grid.bins_per_pixel;
    const int first = lines->pulse_first + (int)lines->first_column * per_pixel;
    float *imaginary = calloc((size_t)lines->pulse_taps, sizeof *imaginary);
    assert_non_null(imaginary);
    if (lines->imaginary_pulse)
        assert_int_equal(buffer_read(&bench->report, bench->tracer.device, lines->imaginary_pulse,
                                     0, (size_t)lines->pulse_taps * sizeof *imaginary, imaginary),
                         SONJECT_OK);
    for (size_t s = 0; s < strips; s++)
        for (int column = 0; column < (int)lines->columns; column++) {
            const size_t in = s * (size_t)count;
            const size_t out = s * lines->stride;
            if (lines->imaginary_pulse)
                compress_complex_of(bins->part[0] + in, bins->part[1] + in, count, all, first,
                                    per_pixel, pulse, imaginary, lines->pulse_taps, column,
                                    compressed->part[0] + out, compressed->part[1] + out);
            for (int part = 0; part < 2 && !lines->imaginary_pulse; part++)
                compress_range_of(bins->part[part] + in, count, all, first, per_pixel, pulse,
                                  lines->pulse_taps, column, compressed->part[part] + out);
        }
    free(imaginary);
}

static struct aspects aspects_of(const struct form_lines *lines)
{
    const struct aspects aspects = {lines->grid.strips.first,
                                    lines->grid.strips.first + lines->grid.strips.count,
                                    (int)lines->grid.strips_per_row, lines->reach};
    return aspects;
}

/* As if every line were filled: zeros too are added, which the device leaves out. */
static struct filled_span *all_filled(const struct form_lines *lines)
{
    struct filled_span *filled = calloc((size_t)lines->grid.strips.count, sizeof *filled);
    assert_non_null(filled);
    for (int32_t i = 0; i < lines->grid.strips.count; i++)
        filled[i].end = (int32_t)lines->stride;
    return filled;
}

/* The response of a row and column, from its definition. */
static void response_as_c(struct bench *bench, const struct form_lines *lines, int row, int column,
                          float *real_part, float *imaginary_part)
{
    const int taps = 2 * lines->reach + 1;
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    const double offset = (0.5 - 0.5 / lines->grid.strips_per_row) * lines->row_spacing_m;
    double *a = calloc((size_t)taps, sizeof *a);
    double *b = calloc((size_t)taps, sizeof *b);
    assert_true(a && b);
    if (lines->response.motion) {
        struct motion_response motion;
        assert_int_equal(motion_response_begin(&motion, &bench->report, &lines->response,
                                               lines->view, strip, offset, lines->reach),
                         SONJECT_OK);
        motion_response_row(&motion, row, a, b);
        motion_response_end(&motion);
    } else {
        const double middle = (double)lines->first_column + column / 16 * 16 + 7.5;
        for (int i = 0; i < taps; i++) {
            const struct complex_number w =
                cross_range_response(&lines->response, view_processor_range(lines->view, middle),
                                     (i - lines->reach) * strip + offset);
            a[i] = w.real_part;
            b[i] = w.imaginary_part;
        }
    }
    for (int i = 0; i < taps; i++) {
        const bool is_energy = lines->kind == FORM_TWO_ENERGIES;
        real_part[i] = (float)(is_energy ? a[i] * a[i] + b[i] * b[i] : a[i]);
        imaginary_part[i] = is_energy ? 0.0f : (float)b[i];
    }
    free(a);
    free(b);
}

static void combine_varied_as_c(struct bench *bench, const struct form_lines *lines,
                                const struct planes *compressed, struct planes *padded)
{
    const struct aspects aspects = aspects_of(lines);
    struct filled_span *all = all_filled(lines);
    const size_t taps = 2 * (size_t)lines->reach + 1;
    float *real_part = calloc(taps, sizeof *real_part);
    float *imaginary_part = calloc(taps, sizeof *imaginary_part);
    assert_true(real_part && imaginary_part);
    for (int row = 0; row < (int)lines->rows; row++)
        for (int column = 0; column < (int)lines->columns; column++) {
            const struct response_set one = {row, 0, 1 << 30, 0};
            if (lines->response.motion ? column == 0 : column % 16 == 0)
                response_as_c(bench, lines, row, column, real_part, imaginary_part);
            combine_varied_of(aspects, one, compressed->part[0], compressed->part[1], all,
                              (int)lines->stride, real_part, imaginary_part, row, row + 1, column,
                              padded->part[0], padded->part[1]);
        }
    free(all);
    free(real_part);
    free(imaginary_part);
}

static struct planes form_as_c(struct bench *bench, const struct form_lines *lines,
                               const struct planes *bins)
{
    const size_t strips = (size_t)lines->grid.strips.count;
    const int taps = 2 * lines->reach + 1;
    struct planes compressed = planes_of(strips * lines->stride);
    struct planes padded = planes_of(lines->rows * lines->stride);
    struct planes pixels = planes_of(lines->rows * lines->columns);
    float *pulse = calloc((size_t)lines->pulse_taps, sizeof *pulse);
    const int zeros = (FORM_ROWS - 1) * (int)lines->grid.strips_per_row;
    float *response = calloc((size_t)(taps + 2 * zeros), sizeof *response);
    assert_true(pulse && response);
    assert_int_equal(buffer_read(&bench->report, bench->tracer.device, lines->pulse, 0,
                                 (size_t)lines->pulse_taps * sizeof *pulse, pulse),
                     SONJECT_OK);
    const double strip = lines->row_spacing_m / lines->grid.strips_per_row;
    for (int i = 0; i < taps; i++) {
        /* pixel rows sit in the middle of their strips */
        const double rows = (double)(i - lines->reach) / lines->grid.strips_per_row + 0.5 -
                            0.5 / lines->grid.strips_per_row;
        assert_true(fabs(rows * lines->row_spacing_m -
                         (i - lines->reach + 0.5 * (lines->grid.strips_per_row - 1)) * strip) <
                    1e-9);
        const double w = along_track_response(&lines->response, rows * lines->row_spacing_m);
        response[zeros + i] = (float)(lines->kind == FORM_TWO_ENERGIES ? w * w : w);
    }
    compress_as_c(bench, lines, bins, pulse, &compressed);
    const struct aspects aspects = aspects_of(lines);
    struct filled_span *all = all_filled(lines);
    if (!cross_range_is_plain(&lines->response))
        combine_varied_as_c(bench, lines, &compressed, &padded);
    else
        for (int row = 0; row < (int)lines->rows; row += FORM_ROWS)
            for (int column = 0; column < (int)lines->columns; column++)
                for (int part = 0; part < 2; part++)
                    combine_aspects_of(aspects, compressed.part[part], all, (int)lines->stride,
                                       response, row, (int)lines->rows, column, padded.part[part]);
    for (int part = 0; part < 2; part++)
        for (size_t row = 0; row < lines->rows; row++)
            memcpy(pixels.part[part] + row * lines->columns,
                   padded.part[part] + row * lines->stride, lines->columns * sizeof(float));
    free(all);
    free(pulse);
    free(response);
    planes_clear(&compressed);
    planes_clear(&padded);
    return pixels;
}

/* Energies of a seabed: 0 here and there. */
static struct planes make_bins(const struct line_grid *grid, uint32_t stream)
{
    struct planes bins = planes_of(line_grid_cells(grid));
    for (uint32_t i = 0; i < bins.count; i++) {
        float u, v;
        two_uniforms(random_key_of(8, 0, stream, 3), i, 0, &u, &v);
        bins.part[0][i] = u < 0.05f ? 0.0f : u * 1e-5f;
        bins.part[1][i] = (v - 0.5f) * 1e-5f;
        /* as of glints: nothing on some strips, on others only in a few bins */
        const uint32_t strip = i / (uint32_t)grid->bins.count;
        const uint32_t bin = i % (uint32_t)grid->bins.count;
        const uint32_t first = 30 + strip * 7 % 37;
        if (strip < 3 || strip % 5 == 2 || (strip % 5 == 3 && (bin < first || bin > first + 11)))
            bins.part[0][i] = bins.part[1][i] = 0.0f;
    }
    return bins;
}

static struct planes form_on_device(struct bench *bench, struct form_lines *lines,
                                    const struct planes *bins, int32_t chunk, int is_speckle)
{
    const size_t count = (size_t)lines->grid.bins.count;
    const int32_t strips = lines->grid.strips.count;
    struct planes pixels = planes_of(lines->rows * lines->columns);
    for (int32_t done = 0; done < strips; done += chunk) {
        const size_t at = (size_t)done * count;
        const int32_t some = strips - done < chunk ? strips - done : chunk;
        const int32_t first = lines->grid.strips.first + done;
        const sonject_status status =
            is_speckle ? form_lines_add_speckle(lines, first, some, bins->part[0] + at,
                                                0xfedcba9876543210u, STREAM_SEABED_SPECKLE)
                       : form_lines_add(lines, first, some, bins->part[0] + at, bins->part[1] + at);
        EXPECT_OK(&bench->report, status);
    }
    EXPECT_OK(&bench->report, form_lines_finish(lines, pixels.part[0], pixels.part[1]));
    return pixels;
}

static void begin_lines(struct form_lines *lines, struct bench *bench, enum form_kind kind,
                        const struct line_grid *grid)
{
    EXPECT_OK(&bench->report,
              form_lines_begin(lines, &bench->report, bench->tracer.device, &bench->tracer.view,
                               &bench->tracer.response, kind, grid));
}

/* The amplitudes that speckle gives to energies. */
static struct planes draw_as_c(const struct line_grid *grid, const struct planes *bins)
{
    struct planes drawn = planes_of(bins->count);
    for (size_t i = 0; i < bins->count; i++) {
        const int32_t strip = grid->strips.first + (int32_t)(i / (size_t)grid->bins.count);
        const int32_t bin = grid->bins.first + (int32_t)(i % (size_t)grid->bins.count);
        float a, b;
        complex_normal(
            random_key_of(0x76543210u, 0xfedcba98u, STREAM_SEABED_SPECKLE, (uint32_t)strip),
            (uint32_t)bin, &a, &b);
        drawn.part[0][i] = sqrtf(bins->part[0][i]) * a;
        drawn.part[1][i] = sqrtf(bins->part[0][i]) * b;
    }
    return drawn;
}

/* Intel's compiler spreads a scalar sum over lanes, which changes its order. No CPU is given one
 * lane: every one that OpenCL runs on has at least four. */
static void compare_forming(struct bench *bench, enum form_kind kind, const struct line_grid *grid,
                            int is_speckle)
{
    struct form_lines lines;
    struct planes bins = make_bins(grid, 4);
    struct planes drawn = {0, {NULL, NULL}};
    if (is_speckle)
        drawn = draw_as_c(grid, &bins);
    begin_lines(&lines, bench, kind, grid);
    struct planes expected = form_as_c(bench, &lines, is_speckle ? &drawn : &bins);
    form_lines_end(&lines);
    static const int32_t chunks[CHUNKINGS] = {1 << 20, 37, 1 << 20, 1};
    for (size_t w = 0; w < width_count; w++) {
        take_width(bench, w);
        if (widths[w] == 1 && bench->tracer.device->is_cpu)
            continue;
        begin_lines(&lines, bench, kind, grid);
        for (size_t i = 0; i < chunkings_at(w); i++) {
            struct planes measured = form_on_device(bench, &lines, &bins, chunks[i], is_speckle);
            expect_same_planes(&measured, &expected);
            planes_clear(&measured);
        }
        form_lines_end(&lines);
    }
    planes_clear(&expected);
    planes_clear(&bins);
    planes_clear(&drawn);
}

static void compare_formation(struct bench *bench, enum scene_kind kind)
{
    if (kind != SCENE_EMPTY)
        return;
    make_scene(bench, kind);
    struct line_grid patch;
    line_grid_for_patch(&patch, &bench->tracer.view, &bench->tracer.response);
    compare_forming(bench, FORM_SPECKLE, &patch, 1);
    compare_forming(bench, FORM_TWO_ENERGIES, &patch, 0);
    /* a fine grid in a corner, partly outside the patch, as a glint's is */
    const struct line_grid corner = {7, 26, {-20, 150}, {-40, 333}};
    compare_forming(bench, FORM_GLINT, &corner, 0);
    const struct line_grid far_corner = {7, 26, {600, 90}, {26 * (COLUMNS - 3), 200}};
    compare_forming(bench, FORM_GLINT, &far_corner, 0);
}

/* A pulse that is complex; a beam that differs from range to range, motion from row to row. */
static void compare_varied_formation(struct bench *bench, enum scene_kind kind)
{
    static const double x[] = {-0.06, -0.03, -0.01, 0.0, 0.02, 0.05};
    static const double a[] = {0.0, 0.3, 0.9, 1.0, 0.5, 0.0};
    static const double b[] = {0.0, 0.2, 0.1, 0.0, -0.3, 0.0};
    const struct line_grid corner = {7, 26, {-20, 150}, {-40, 333}};
    if (kind != SCENE_EMPTY)
        return;
    for (int i = 0; i < 3; i++) {
        sonject_motion_params_init(&bench->scene.motion.params);
        bench->scene.sonar.kind = i == 1 ? SONJECT_SONAR_REAL : SONJECT_SONAR_SYNTHETIC;
        bench->scene.sonar.array_length_m = 0.6;
        bench->scene.motion.params.random_rms_m = i == 2 ? 1e-3 : 0.0;
        assert_int_equal(
            response_table_set(&bench->scene.pulse_table, &bench->report, x, a, b, 6, false),
            SONJECT_OK);
        bench->scene.pulse.kind = SONJECT_PULSE_TABLE;
        make_scene(bench, kind);
        struct line_grid patch;
        line_grid_for_patch(&patch, &bench->tracer.view, &bench->tracer.response);
        compare_forming(bench, FORM_SPECKLE, &patch, 1);
        compare_forming(bench, FORM_TWO_ENERGIES, &patch, 0);
        compare_forming(bench, FORM_GLINT, &corner, 0);
    }
    sonject_motion_params_init(&bench->scene.motion.params);
    bench->scene.sonar.kind = SONJECT_SONAR_SYNTHETIC;
}

static void test_varied_image_formation(void **state)
{
    on_all_kinds(compare_varied_formation);
}

static void test_image_formation(void **state)
{
    on_all_kinds(compare_formation);
}

/* One core of a device instead of all. */
static void test_one_core(void **state)
{
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, 18.0);
    const cl_device_partition_property one_core[] = {CL_DEVICE_PARTITION_BY_COUNTS, 1,
                                                     CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
    /* never released: a thread of PoCL may still be busy with its last event, which does not hold a
     * sub-device */
    static cl_device_id core;
    cl_uint cores = 0;
    if (clCreateSubDevices(bench.tracer.device->id, one_core, 1, &core, &cores) != CL_SUCCESS ||
        cores != 1) {
        print_message("%s cannot be divided\n", bench_device);
        bench_close(&bench);
        return;
    }
    make_scene(&bench, SCENE_WITH_MAP);
    float *map = make_map(SCENE_WITH_MAP);
    struct tallies expected = trace_rough_on_device(&bench, map, 1 << 20);
    cl_int error = CL_SUCCESS;
    cl_context context = clCreateContext(NULL, 1, &core, NULL, NULL, &error);
    assert_int_equal(error, CL_SUCCESS);
    sonject_context_params params;
    memset(&params, 0, sizeof params);
    params.struct_size = sizeof params;
    params.opencl_context = context;
    params.opencl_device = core;
    struct device *all_cores = bench.tracer.device;
    EXPECT_OK(&bench.report, device_open(&bench.report, &params, &bench.tracer.device));
    assert_int_equal(bench.tracer.device->compute_units, 1);
    struct tallies measured = trace_rough_on_device(&bench, map, 1 << 20);
    expect_same("one core", &measured, &expected);
    tallies_clear(&measured);
    tallies_clear(&expected);
    free(map);
    device_close(&bench.tracer.device);
    bench.tracer.device = all_cores;
    bench_close(&bench);
    clReleaseContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rough_tallies),    cmocka_unit_test(test_smooth_tallies),
        cmocka_unit_test(test_mirrored_tallies), cmocka_unit_test(test_rough_mirrored_tallies),
        cmocka_unit_test(test_image_formation),  cmocka_unit_test(test_varied_image_formation),
        cmocka_unit_test(test_one_core),
    };
    return bench_run_on_devices(tests, COUNT(tests));
}
