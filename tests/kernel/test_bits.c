/* Tests that results have the same bits everywhere. At every width, chunking and core count, a
 * device must tally what the same kernels tally as plain C with the fewest lanes. */
#include "claims.h"
#include "elementary.h"
#include "random.h"

#include "device/opencl/opencl.h"
#include "kernel/clutter.h"
#include "kernel/mesh_samples.h"
#include "kernel/reference_solids.h"
#include "mesh_arrays.h"
#include "physics/bench.h"

#define ROWS    96
#define COLUMNS 128

enum scene_flag {
    IN_LAYERS = 1,     /* under a layer of faster water */
    ON_RELIEF = 2,     /* among ripples, a mound and scour */
    ON_RIPPLES = 4,    /* among ripples alone */
    WITH_MAP = 8,      /* map of reflectivity, which chains use too */
    WITH_ASPECTS = 16, /* seen by a weighted synthetic aperture */
    WITH_BEAM = 32,    /* seen by the beam of a turned real aperture */
    UNDER_SURFACE = 64,
    SMOOTH_SEABED = 128,
    PAPER_COLUMNS = 256,
    BRUTE_FORCE = 512,
    /* parts that are compared */
    ROUGH = 1024,
    AT_ALL = 4096, /* at all widths; others at few, as programs take long to compile */
    GLINTS = 8192,
    IMAGES = 16384,
    CHAINS = 32768,
    FOULED = 131072,
    TILES = 65536 /* tiles of the rough part by all paths, at the least and the most lanes */
};

/* Objects of a scene. */
enum object_set {
    NO_OBJECTS,
    FOUR_OBJECTS,
    MORE_SHAPES, /* one of every row of solid_rows */
    RINGS,       /* meshes, one with smooth normals */
    CLUTTER,     /* enough to search a tree, and to aim rays at groups of targets */
    TWO_OBJECTS,
    CROWD /* a mesh and spheres, too many for one launch */
};

static const struct scene_case {
    const char *name;
    enum object_set objects;
    unsigned flags;
    double source_side; /* m; visibility is tested unless 0 */
    uint32_t interactions;
} scenes[] = {
    {"plain", FOUR_OBJECTS, ROUGH | AT_ALL | GLINTS | IMAGES | TILES, 0.0, 1},
    {"wide source", FOUR_OBJECTS, ROUGH | AT_ALL, 0.2, 1},
    {"map", FOUR_OBJECTS, ROUGH | AT_ALL | WITH_MAP, 0.2, 1},
    {"seabed alone", NO_OBJECTS, ROUGH | AT_ALL, 0.0, 1},
    {"more shapes", MORE_SHAPES, ROUGH | AT_ALL | GLINTS, 0.2, 1},
    {"meshes", RINGS, ROUGH | AT_ALL, 0.1, 1},
    {"clutter", CLUTTER, ROUGH | AT_ALL, 0.1, 1},
    {"layers", FOUR_OBJECTS, ROUGH | AT_ALL | GLINTS | IMAGES | TILES | IN_LAYERS, 0.0, 1},
    {"relief", FOUR_OBJECTS, ROUGH | AT_ALL | GLINTS | IMAGES | TILES | ON_RELIEF, 0.0, 1},
    {"crowd over relief", CROWD, TILES | ON_RELIEF, 0.0, 1},
    {"wide source over relief", FOUR_OBJECTS, ROUGH | AT_ALL | ON_RELIEF | WITH_MAP, 0.2, 1},
    {"aspects", FOUR_OBJECTS, ROUGH | WITH_ASPECTS, 0.0, 1},
    {"aspects over relief", FOUR_OBJECTS, ROUGH | AT_ALL | WITH_ASPECTS | ON_RELIEF | WITH_MAP, 0.2,
     1},
    {"beam", FOUR_OBJECTS, ROUGH | WITH_BEAM, 0.0, 1},
    {"fouling", FOUR_OBJECTS, ROUGH | AT_ALL | TILES | FOULED, 0.2, 1},
    {"chains", TWO_OBJECTS, CHAINS | AT_ALL, 0.0, 3},
    {"chains in clutter", CLUTTER, CHAINS | AT_ALL, 0.0, 3},
    {"chains off what is fouled", TWO_OBJECTS, CHAINS | FOULED | UNDER_SURFACE, 0.0, 3},
    {"chains, paper's columns, map", TWO_OBJECTS, CHAINS | PAPER_COLUMNS | WITH_MAP, 0.0, 3},
    {"chains, wide source", TWO_OBJECTS, CHAINS | SMOOTH_SEABED, 4.0, 4},
    {"brute force", TWO_OBJECTS, CHAINS | PAPER_COLUMNS | BRUTE_FORCE, 4.0, 3},
    {"chains through layers", TWO_OBJECTS, CHAINS | SMOOTH_SEABED | IN_LAYERS, 0.0, 3},
    {"chains through layers, wide source", TWO_OBJECTS,
     CHAINS | PAPER_COLUMNS | WITH_MAP | IN_LAYERS, 4.0, 3},
    {"chains below the surface", TWO_OBJECTS, CHAINS | SMOOTH_SEABED | UNDER_SURFACE, 0.0, 4},
    {"chains below the surface, wide source", TWO_OBJECTS,
     CHAINS | PAPER_COLUMNS | WITH_MAP | UNDER_SURFACE, 4.0, 3},
    {"brute force below the surface", TWO_OBJECTS,
     CHAINS | PAPER_COLUMNS | BRUTE_FORCE | UNDER_SURFACE, 4.0, 3},
    {"chains among ripples", TWO_OBJECTS, CHAINS | WITH_MAP | ON_RIPPLES, 0.0, 3},
    {"chains among ripples below the surface", TWO_OBJECTS,
     CHAINS | WITH_MAP | ON_RIPPLES | UNDER_SURFACE, 0.0, 3},
    {"brute force among ripples", TWO_OBJECTS, CHAINS | PAPER_COLUMNS | BRUTE_FORCE | ON_RIPPLES,
     4.0, 3},
};

/* Places a shape of every row of solid_rows. */
static void place_more_shapes(struct bench *bench)
{
    for (int i = 0; i < solid_row_count; i++) {
        const struct solid_row *row = &solid_rows[i];
        sonject_object_params *object = bench_add(bench, row->shape, 0.5, 0.4, 0.4);
        object->height_m = 0.3;
        object->top_diameter_m = 0.3;
        do { /* not both ends flat, as kernels have a shape of their own for round ones */
            if (row->fit)
                row->fit(object, 0.1);
        } while (row->shape == SHAPE_CYLINDER && object->nose_end == SONJECT_END_FLAT &&
                 object->tail_end == SONJECT_END_FLAT);
        bench_place(object, 15.0 + 22.0 * (i % 4), 20.0 + 25.0 * (i / 4), 0.3 + 0.7 * i, 0.2, 0.1);
    }
}

static void place_crowd(struct bench *bench)
{
    bench_add_tetrahedron(bench);
    for (int i = 0; i < 22; i++) {
        const enum shape_kind shape = i == 0 ? SHAPE_MESH : SHAPE_SPHERE;
        bench_place(bench_add(bench, shape, 0.0, 0.0, i == 0 ? 0.0 : 0.08 + 0.002 * i),
                    12.0 + 18.0 * (i % 5), 15.0 + 22.0 * (i / 5), 0.0, 0.0, 0.0);
    }
}

static void place_rings(struct bench *bench)
{
    bench->scene.meshes = zeroed(2, sizeof *bench->scene.meshes);
    for (uint32_t i = 0; i < 2; i++) {
        struct mesh_sample ring;
        sample_ring(&ring, 60, 40);
        mesh_of_sample(&ring, 0.4, i, &bench->scene.meshes[bench->scene.mesh_count++]);
        sample_clear(&ring);
        bench_place(bench_add(bench, SHAPE_MESH, 0.0, 0.0, 0.0), 30.0 + 35.0 * i, 60.0, 0.7 * i,
                    1.1 * i, 0.0)
            ->mesh = i;
    }
}

static void place_objects(struct bench *bench, enum object_set set)
{
    if (set == CROWD)
        place_crowd(bench);
    if (set == RINGS)
        place_rings(bench);
    if (set == CLUTTER)
        clutter_strew(bench, 200, 0.4);
    if (set == MORE_SHAPES) {
        place_more_shapes(bench);
    } else if (set == FOUR_OBJECTS) {
        bench_place(bench_add(bench, SHAPE_SPHERE, 0.0, 0.0, 0.4), 20.2, 40.7, 0.0, 0.0, 0.0);
        bench_place(bench_add(bench, SHAPE_CYLINDER, 0.8, 0.0, 0.3), 50.0, 30.0, 0.7, 0.2, 0.0);
        bench_place(bench_add(bench, SHAPE_CAPSULE, 1.0, 0.0, 0.3), 60.0, 70.0, -0.4, 0.1, 0.3);
        bench_place(bench_add(bench, SHAPE_PLANE, 0.6, 0.4, 0.0), 40.0, 55.0, 0.3, -0.5, 0.4)
            ->burial_m = 0.05;
    } else if (set == TWO_OBJECTS) {
        bench_place(bench_add(bench, SHAPE_SPHERE, 0.0, 0.0, 0.5), 47.5, 63.5, 0.0, 0.0, 0.0)
            ->material.lambert = 0.2;
        sonject_object_params *capsule =
            bench_place(bench_add(bench, SHAPE_CAPSULE, 1.0, 0.0, 0.3), 56.0, 55.0, 0.6, 0.0, 0.0);
        capsule->material.reflection = capsule->material.roughness_m = 0.0;
        capsule->material.lambert = 0.1;
        capsule->material.lambert_exponent = 2.0;
        capsule->material.glossy_albedo = 0.5;
        capsule->burial_m = 0.1;
    }
}

static void make_relief(struct bench *bench, bool is_ripples_alone)
{
    struct relief_feature *ripples = bench_add_relief(bench, RELIEF_RIPPLES);
    ripples->wavelength_m = 0.4;
    ripples->height_m = 0.05;
    ripples->heading_rad = 1.2;
    if (is_ripples_alone)
        return;
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

static void set_fluid_seabed(struct bench *bench)
{
    bench->scene.seabed.forward.reflection_kind = SONJECT_REFLECTION_FLUID;
    bench->scene.seabed.forward.density_ratio = 1.845;
    bench->scene.seabed.forward.speed_ratio = 1.1782;
    bench->scene.seabed.forward.loss = 0.01624;
}

static void make_scene(struct bench *bench, const struct scene_case *scene)
{
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.02}, {3.0, 1530.0, 1.0}};
    sonject_sonar_params *sonar = &bench->scene.sonar;
    sonject_injection_params *injection = &bench->scene.injection;
    injection->seed = 0x123456789abcdefu;
    injection->ray_scale = scene->objects == CLUTTER ? 0.06 : scene->flags & CHAINS ? 0.25 : 0.5;
    injection->interactions = scene->interactions;
    injection->order_energies = 1;
    injection->estimator =
        scene->flags & BRUTE_FORCE ? SONJECT_ESTIMATOR_BRUTE_FORCE : SONJECT_ESTIMATOR_CONNECT;
    injection->column_rule =
        scene->flags & PAPER_COLUMNS ? SONJECT_COLUMNS_PAPER : SONJECT_COLUMNS_FOCUSED;
    bench->scene.medium.reference_sound_speed_mps = 1480.0;
    bench->scene.seabed.lambert = scene->flags & CHAINS ? 0.2 : bench->scene.seabed.lambert;
    bench->scene.seabed.forward_rule =
        scene->flags & WITH_MAP ? SONJECT_FORWARD_MAP : SONJECT_FORWARD_MODEL;
    sonar->altitude_m = 7.3;
    sonar->along_track_resolution_m = 0.03;
    sonar->aperture_rad = scene->flags & WITH_ASPECTS ? 0.3 : 0.0;
    sonar->response_window =
        scene->flags & WITH_ASPECTS ? SONJECT_WINDOW_TAYLOR : SONJECT_WINDOW_RECTANGULAR;
    sonar->kind = scene->flags & WITH_BEAM ? SONJECT_SONAR_REAL : SONJECT_SONAR_SYNTHETIC;
    sonar->array_length_m = 0.4;
    sonar->array_height_m = 0.05;
    sonar->array_heading_rad = 0.05;
    sonar->array_pitch_rad = -0.03;
    sonar->array_depression_rad = 0.4;
    sonar->transducer_side_m = scene->source_side;
    bench_set_layers(bench, layers, scene->flags & IN_LAYERS ? 2 : 0);
    place_objects(bench, scene->objects);
    for (uint32_t i = 1; scene->flags & FOULED && i < bench->scene.object_count; i++)
        bench->scene.objects[i].fouling = (sonject_fouling_params){i * 2.0, 0.05, 0.004, 0.03};
    if (scene->flags & (ON_RELIEF | ON_RIPPLES))
        make_relief(bench, scene->flags & ON_RIPPLES);
    if (scene->flags & SMOOTH_SEABED) {
        set_fluid_seabed(bench);
        bench->scene.seabed.forward.roughness_m = 2e-3;
    }
    if (scene->flags & UNDER_SURFACE) {
        bench->scene.surface.water_depth_m = 13.0;
        bench->scene.surface.material.roughness_m = 2e-3;
        bench->scene.surface.material.lambert = 0.1;
        bench->scene.surface.material.lambert_exponent = 1.5;
    }
    bench_ready(bench);
}

static float *make_map(const struct scene_case *scene)
{
    float *map = scene->flags & WITH_MAP ? malloc(ROWS * COLUMNS * sizeof *map) : NULL;
    for (uint32_t i = 0; map && i < ROWS * COLUMNS; i++) {
        float u, v;
        two_uniforms(random_key_of(5, 0, 99, 0), i, 0, &u, &v);
        map[i] = u < 0.1f ? 0.0f : -3.0f * natural_logarithm(v);
    }
    return map;
}

/* The part of a scene that is traced. */
struct subject {
    const struct scene_case *scene;
    enum scene_flag part; /* ROUGH, GLINTS or CHAINS */
    const float *map;
    uint32_t object;               /* number of the object whose glints are traced */
    const struct image_pair *pair; /* pair of image sources; NULL: straight paths */
    bool is_whole;                 /* only traced with all strips at once */
};

/* The trace of a subject. Only the member for the subject's part is used. */
struct trace {
    struct rough_trace rough;
    struct smooth_trace smooth;
    struct chain_trace chains;
    struct launch *launch;
    device_buffer tallies;
    size_t line;        /* number of tallies in a strip */
    struct span strips; /* strips of the grid */
};

static void trace_begin(struct trace *trace, struct bench *bench, const struct subject *subject)
{
    struct tracer *tracer = &bench->tracer;
    const struct line_grid *grid;
    if (subject->part == ROUGH) {
        EXPECT_OK(&bench->report,
                  subject->scene->flags & WITH_BEAM
                      ? rough_trace_begin_beam(&trace->rough, tracer, &tracer->response)
                      : rough_trace_begin(&trace->rough, tracer, subject->map));
        trace->launch = &trace->rough.launch;
        trace->tallies = trace->launch->buffers[LAUNCH_TALLIES];
        grid = &trace->rough.grid;
        assert_true(trace->rough.chunk >= grid->strips.count);
    } else if (subject->part == GLINTS) {
        EXPECT_OK(&bench->report,
                  smooth_trace_begin(&trace->smooth, tracer, subject->object, subject->pair));
        trace->launch = &trace->smooth.launch;
        trace->tallies = trace->launch->buffers[LAUNCH_TALLIES];
        grid = &trace->smooth.grid;
        assert_true(grid->bins.count > 0);
    } else {
        EXPECT_OK(&bench->report, chain_trace_begin(&trace->chains, tracer, subject->map));
        trace->launch = &trace->chains.launch;
        trace->tallies = trace->launch->buffers[LAUNCH_TALLIES];
        grid = &trace->chains.grid;
    }
    trace->strips = grid->strips;
    trace->line = (size_t)grid->bins.count * (subject->part == GLINTS ? 2 : 1);
}

/* All that a trace leaves behind. */
struct tallies {
    size_t count, tile_count; /* numbers of elements */
    int64_t *sums, *tiles;
    struct trace_counts counts;
};

static struct tallies tallies_of(const struct trace *trace, const struct subject *subject)
{
    struct tallies tallies = {0, 0, NULL, NULL, {0, 0, 0, 0}};
    tallies.count = (size_t)trace->strips.count * trace->line;
    tallies.count *= subject->part == CHAINS ? trace->chains.orders : 1;
    tallies.tile_count = subject->part == ROUGH ? trace->rough.tile_elements : 0;
    tallies.sums = zeroed(tallies.count, sizeof(int64_t));
    tallies.tiles = zeroed(tallies.tile_count + 1, sizeof(int64_t));
    return tallies;
}

static void tallies_clear(struct tallies *tallies)
{
    free(tallies->sums);
    free(tallies->tiles);
}

static void expect_same(const struct subject *subject, const struct tallies *a,
                        const struct tallies *b)
{
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->tile_count, b->tile_count);
    bench_expect_sums(subject->scene->name, a->sums, b->sums, a->count);
    bench_expect_sums("tiles", a->tiles, b->tiles, a->tile_count);
    assert_int_equal(a->counts.rays, b->counts.rays);
    assert_int_equal(a->counts.impulses, b->counts.impulses);
    assert_int_equal(a->counts.queries, b->counts.queries);
}

/* Returns whether enough tallies are filled. Otherwise two dead traces would pass as the same. */
static bool is_alive(const struct subject *subject, const struct tallies *tallies)
{
    size_t filled = 0;
    for (size_t i = 0; i < tallies->count; i++)
        filled += tallies->sums[i] != 0;
    return filled > (subject->part == CHAINS ? 300 : tallies->count / 20);
}

/* Returns fan number i of the trace, with its strips. */
static struct chain_fan aim(struct trace *trace, struct bench *bench, const struct subject *subject,
                            uint32_t i)
{
    struct chain_fan fan = {.strips = trace->strips};
    if (subject->part == CHAINS)
        EXPECT_OK(&bench->report, chain_fan_init(&fan, &bench->tracer, &trace->chains.grid,
                                                 trace->chains.has_map, i));
    return fan;
}

static uint32_t fan_count(const struct bench *bench, const struct subject *subject)
{
    return subject->part == CHAINS ? chain_fan_count(&bench->tracer) : 1;
}

static void read_sums(struct bench *bench, device_buffer buffer, size_t count, int64_t *sums)
{
    EXPECT_OK(&bench->report, buffer_read(&bench->report, bench->tracer.device, buffer, 0,
                                          count * sizeof *sums, sums));
}

/* Traces the strips of one launch. Sums are read at once, but sums of chains later. */
static void run_strips(struct trace *trace, struct bench *bench, const struct subject *subject,
                       const struct chain_fan *fan, struct span strips, int64_t *sums)
{
    struct tracer *tracer = &bench->tracer;
    const size_t count = (size_t)strips.count * trace->line;
    float *found = zeroed(count, sizeof *found);
    EXPECT_OK(&bench->report,
              subject->part == CHAINS ? chain_trace_strips(&trace->chains, tracer, fan, strips)
              : subject->part == ROUGH
                  ? rough_trace_strips(&trace->rough, tracer, strips, found)
                  : smooth_trace_strips(&trace->smooth, tracer, strips, found, found + count / 2));
    if (subject->part != CHAINS)
        read_sums(bench, trace->tallies, count, sums);
    for (size_t i = 0; subject->part == ROUGH && i < count; i++)
        assert_true(found[i] == (float)((double)sums[i] * trace->rough.energy_of_quantum));
    free(found);
}

static struct tallies trace_on_device(struct bench *bench, const struct subject *subject,
                                      int32_t wanted_chunk)
{
    static struct trace trace;
    memset(&bench->tracer.counts, 0, sizeof bench->tracer.counts);
    trace_begin(&trace, bench, subject);
    struct tallies tallies = tallies_of(&trace, subject);
    const int32_t most = subject->part == GLINTS ? trace.smooth.chunk : INT32_MAX;
    const int32_t chunk = wanted_chunk < most ? wanted_chunk : most;
    for (uint32_t i = 0; i < fan_count(bench, subject); i++) {
        const struct chain_fan fan = aim(&trace, bench, subject, i);
        for (int32_t done = 0; done < fan.strips.count; done += chunk) {
            const int32_t left = fan.strips.count - done;
            const struct span strips = {fan.strips.first + done, left < chunk ? left : chunk};
            run_strips(&trace, bench, subject, &fan, strips,
                       tallies.sums + (subject->part == CHAINS ? 0 : (size_t)done * trace.line));
        }
    }
    if (subject->part == CHAINS)
        read_sums(bench, trace.tallies, tallies.count, tallies.sums);
    if (tallies.tile_count > 0)
        read_sums(bench, trace.launch->buffers[LAUNCH_TILES], tallies.tile_count, tallies.tiles);
    tallies.counts = bench->tracer.counts;
    launch_end(trace.launch);
    return tallies;
}

/* One device with kernels of each number of lanes, and the reference for all of them. */
static uint32_t widths[BENCH_WIDTHS];
static struct device *devices[BENCH_WIDTHS], *reference;
static size_t width_count;

/* Returns whether a subject is compared at a width. All are at the most lanes, but only some at all
 * widths, since programs take long to compile and all use the same vectors. */
static bool is_compared(const struct bench *bench, const struct subject *subject, size_t w)
{
    if (w == width_count - 1)
        return true;
    if (subject->part == ROUGH || subject->part == CHAINS)
        return (subject->scene->flags & AT_ALL) != 0;
    return subject->part == GLINTS && w == 0 && !bench->tracer.relief;
}

/* Compares a subject traced all at once and, unless it is whole, a few strips at a time. Returns
 * whether there was anything to compare. */
static bool compare_bits(struct bench *bench, const struct subject *subject)
{
    const int32_t least = subject->part == ROUGH ? 1 : subject->part == GLINTS ? 5 : 13;
    struct device *own = bench->tracer.device;
    bench->tracer.device = reference;
    struct tallies expected = trace_on_device(bench, subject, 1 << 20);
    const bool had_echoes = is_alive(subject, &expected);
    for (size_t w = 0; w < width_count; w++) {
        if (!is_compared(bench, subject, w))
            continue;
        bench->tracer.device = w == width_count - 1 && subject->part == CHAINS ? own : devices[w];
        print_message("%s, width %u\n", subject->scene->name,
                      (unsigned)bench->tracer.device->width);
        /* the fewest lanes take longest; with aspects over relief, a strip launched alone would be
         * traced again for each of its many neighbours */
        const bool is_slow = (w == 0 && width_count > 1) || (subject->scene->flags & WITH_ASPECTS &&
                                                             subject->scene->flags & ON_RELIEF);
        const int32_t chunks[] = {1 << 20, is_slow ? 37 : least};
        for (size_t i = 0; i < (subject->is_whole ? 1 : COUNT(chunks)); i++) {
            struct tallies measured = trace_on_device(bench, subject, chunks[i]);
            expect_same(subject, &measured, &expected);
            tallies_clear(&measured);
        }
    }
    bench->tracer.device = own;
    tallies_clear(&expected);
    return had_echoes;
}

typedef void body(struct bench *bench, const struct scene_case *scene);

static void on_scenes_with(unsigned flags, body *run)
{
    struct bench bench;
    width_count = bench_widths(widths);
    bench_open(&bench, ROWS, COLUMNS, 18.0);
    reference = bench_open_reference(&bench);
    for (size_t w = 0; w < width_count; w++)
        devices[w] = bench_open_width(&bench, widths[w]);
    for (size_t i = 0; i < COUNT(scenes); i++)
        if (scenes[i].flags & flags) {
            scene_clear(&bench.scene);
            scene_init(&bench.scene);
            bench_set_layers(&bench, NULL, 0);
            bench_move(&bench, 18.0);
            run(&bench, &scenes[i]);
        }
    for (size_t w = 0; w < width_count; w++)
        device_close(&devices[w]);
    device_close(&reference);
    bench_close(&bench);
}

static void compare_energies(struct bench *bench, const struct scene_case *scene)
{
    make_scene(bench, scene);
    float *map = make_map(scene);
    const struct subject subject = {scene, scene->flags & CHAINS ? CHAINS : ROUGH, map, 0, NULL,
                                    false};
    assert_true(compare_bits(bench, &subject));
    free(map);
}

TEST(test_rough_tallies)
{
    on_scenes_with(ROUGH, compare_energies);
}

TEST(test_chain_tallies)
{
    on_scenes_with(CHAINS, compare_energies);
}

static void compare_glints(struct bench *bench, const struct scene_case *scene)
{
    uint32_t alive = 0;
    make_scene(bench, scene);
    const uint32_t count = bench->scene.object_count;
    for (uint32_t object = 0; object < count; object++) {
        const struct subject subject = {scene, GLINTS, NULL, object, NULL, alive > 0};
        alive += compare_bits(bench, &subject);
    }
    print_message("%s: glints of %u of %u\n", scene->name, (unsigned)alive, (unsigned)count);
    assert_true(alive >= count);
}

TEST(test_smooth_tallies)
{
    on_scenes_with(GLINTS, compare_glints);
}

/* Compares glints by pairs of the sonar and its images in a rough sea surface and a fluid seabed.
 * Over relief the sea surface alone reflects. */
static void compare_images(struct bench *bench, const struct scene_case *scene)
{
    static const size_t numbers[][2] = {{0, 1}, {1, 1}, {0, 2}, {1, 4}, {2, 4}};
    const size_t pairs = scene->flags & ON_RELIEF ? 2 : COUNT(numbers);
    struct sound_source sources[SOURCES_MAX];
    size_t alive = 0;
    make_scene(bench, scene);
    bench->scene.surface.water_depth_m = 7.5;
    if (!(scene->flags & ON_RELIEF)) {
        set_fluid_seabed(bench);
        bench->scene.surface.material.roughness_m = 1e-3;
    }
    assert_int_equal(sources_list(&bench->scene, &bench->water, 2, sources), pairs == 2 ? 2 : 5);
    for (uint32_t object = 0; object < bench->scene.object_count; object++)
        for (size_t i = 0; i < pairs; i++) {
            const struct image_pair pair = {&sources[numbers[i][0]], &sources[numbers[i][1]],
                                            (uint32_t)i};
            const struct subject subject = {scene, GLINTS, NULL, object, &pair, alive > 0};
            alive += compare_bits(bench, &subject);
        }
    /* 8 or 20 subjects: some pairs of sources give no glint of the plate */
    assert_true(alive >= 3 * pairs);
}

TEST(test_image_tallies)
{
    on_scenes_with(IMAGES, compare_images);
}

/* Returns the tiles of the rough part by straight paths and image sources, of a fresh trace. */
static int64_t *all_tiles(struct bench *bench, size_t *elements)
{
    static struct rough_trace trace;
    EXPECT_OK(&bench->report, rough_trace_begin(&trace, &bench->tracer, NULL));
    float *energy = zeroed(line_grid_cells(&trace.grid), sizeof *energy);
    EXPECT_OK(&bench->report,
              rough_trace_strips(&trace, &bench->tracer, trace.grid.strips, energy));
    EXPECT_OK(&bench->report, rough_trace_images(&trace, &bench->tracer));
    free(energy);
    *elements = trace.tile_elements;
    int64_t *tiles = bench_copy_buffer(bench, trace.launch.buffers[LAUNCH_TILES]);
    rough_trace_end(&trace);
    return tiles;
}

static void compare_tiles(struct bench *bench, const struct scene_case *scene)
{
    struct device *own = bench->tracer.device;
    int64_t *tiles[2];
    size_t elements[2];
    bench->scene.seabed.forward.reflection = scene->flags & ON_RELIEF ? 0.0 : 0.9;
    bench->scene.surface.water_depth_m = 7.5;
    make_scene(bench, scene);
    bench->scene.injection.interactions = 4;
    for (int end = 0; end < 2; end++) { /* both ends of the row of widths, which may be one */
        bench->tracer.device = devices[end == 0 ? 0 : width_count - 1];
        tiles[end] = all_tiles(bench, &elements[end]);
    }
    bench->tracer.device = own;
    assert_int_equal(elements[0], elements[1]);
    assert_true(bench_expect_sums("tiles", tiles[1], tiles[0], elements[0]) > 1000);
    free(tiles[0]);
    free(tiles[1]);
}

TEST(test_tiles_by_all_ways)
{
    on_scenes_with(TILES, compare_tiles);
}

/* Tests that one core of a device gives the same bits as all cores. */
TEST(test_one_core)
{
    const struct scene_case *scene = &scenes[2];
    struct bench bench;
    bench_open(&bench, ROWS, COLUMNS, 18.0);
    struct device *all_cores = bench.tracer.device;
    sonject_context_params params = {
        .struct_size = sizeof params, .device_name = bench_device, .threads = 1};
    if (!native_is_named(all_cores->name)) {
        print_message("%s takes all its cores\n", bench_device);
        bench_close(&bench);
        return;
    }
    make_scene(&bench, scene);
    float *map = make_map(scene);
    const struct subject subject = {scene, ROUGH, map, 0, NULL, false};
    struct tallies expected = trace_on_device(&bench, &subject, 1 << 20);
    EXPECT_OK(&bench.report, device_open(&bench.report, &params, &bench.tracer.device));
    assert_int_equal(bench.tracer.device->compute_units, 1);
    struct tallies measured = trace_on_device(&bench, &subject, 1 << 20);
    expect_same(&subject, &measured, &expected);
    tallies_clear(&measured);
    tallies_clear(&expected);
    free(map);
    device_close(&bench.tracer.device);
    bench.tracer.device = all_cores;
    bench_close(&bench);
}

int main(void)
{
    return bench_run_on_devices(own_tests, own_test_count);
}
