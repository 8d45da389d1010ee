/* The sea surface within chains of several interactions: its rough part, its mirror inside and at
 * an end of a path, and the number of times that a path is counted. */
#include "reference_paths.h"
#include "trace/chains.h"

#define ORDERS   2 /* two and three interactions */
#define RANGES   10
#define MIDDLE_M 52.0
#define SEEDS    16
#define ROWS     160
#define COLUMNS  480
#define DEPTH_M  15.0
#define RAYS     300000 /* of each fan of the reference */

static const struct ranges ranges = {RANGES, MIDDLE_M - 0.5 * RANGES, 1.0};

/* Opens a Lambert sphere over a Lambert seabed, 16 m of track, the surface 5 m over the sonar. */
static struct sea *open_scene(double height_m, double radius_m)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, MIDDLE_M);
    sea->geometry->row_spacing_m = 0.1;
    make_rough(sea_add_sphere(sea, radius_m, height_m - radius_m), 0.3);
    sea->seabed->lambert = 0.2;
    sea->surface->water_depth_m = DEPTH_M;
    sea->surface->material.glossy_albedo = 0.0;
    sea->injection->interactions = 3;
    sea->injection->order_energies = 1;
    sea->injection->column_rule = SONJECT_COLUMNS_PAPER;
    return sea;
}

/* Returns half the length of the track on which echoes are tallied. Both have the same middle. */
static double half_track(struct sea *sea)
{
    double first_x, last_x;
    sea_grid(sea, &first_x, &last_x);
    assert_true(fabs(first_x + last_x - 2.0 * sea_centre(sea, 0)[0]) < 0.2);
    return 0.5 * (last_x - first_x);
}

/* --- A small disc that faces a Lambert surface: double integral --- */

#define DISC_M 0.2
#define STEPS  600 /* of the integral over the surface, in each direction */

/* Adds the path sonar, disc, a piece of the surface at (x, y), sonar, in the disc's column, and its
 * reverse in the piece's column. */
static void add_piece(const struct sea *sea, double x, double y, double area, double track,
                      struct estimate *expected)
{
    const double altitude = sea->sonar->altitude_m;
    const double *centre = sea_centre(sea, 0);
    const double disc = PI * 0.25 * DISC_M * DISC_M;
    const double lambert = sea_object(sea, 0)->material.lambert * sea->surface->material.lambert;
    const double up = DEPTH_M - centre[2];
    const double between = sqrt(x * x + pow(y - centre[1], 2.0) + up * up);
    const bool is_focused = sea->injection->column_rule == SONJECT_COLUMNS_FOCUSED;
    /* paper columns: the sonar broadside of the disc, then of the surface; else in the middle */
    for (int way = 0; way < (is_focused ? 1 : 2); way++) {
        const double sonar = is_focused ? 0.5 * x : way == 0 ? 0.0 : x;
        const double one =
            sqrt(sonar * sonar + pow(centre[1], 2.0) + pow(altitude - centre[2], 2.0));
        const double other = sqrt(pow(x - sonar, 2.0) + y * y + pow(DEPTH_M - altitude, 2.0));
        const double half_path = 0.5 * (one + between + other);
        const int range = (int)floor((half_path - ranges.first_m) / ranges.width_m);
        if (range < 0 || range >= ranges.count || fabs(sonar) > track)
            continue;
        expected[range].mean += (is_focused ? 4.0 : 1.0) * area * disc * lambert *
                                (altitude - centre[2]) / pow(one, 3.0) * pow(up, 2.0) /
                                pow(between, 4.0) * (DEPTH_M - altitude) / pow(other, 3.0) *
                                pow(half_path, 4.0);
    }
}

/* 1.5 % is for a disc that is no point, and for its angles, those of the first hit's column. */
CLAIM(a_disc_under_a_lambert_surface)
{
    for (int is_focused = 0; is_focused < 2; is_focused++) {
        struct estimate expected[RANGES];
        struct sea *sea = sea_open(ROWS, COLUMNS, MIDDLE_M);
        sonject_object_params *disc = sea_add(sea, SHAPE_DISC, 0.0, 0.0, DISC_M);
        sea->geometry->row_spacing_m = 0.1;
        sea->injection->ray_scale = 4.0;
        disc->burial_m = -1.5;
        make_rough(disc, 0.3);
        sea->surface->water_depth_m = DEPTH_M;
        sea->surface->material.reflection = 0.0;
        sea->surface->material.lambert = 0.25;
        sea->injection->interactions = 2;
        sea->injection->order_energies = 1;
        sea->injection->column_rule = is_focused ? SONJECT_COLUMNS_FOCUSED : SONJECT_COLUMNS_PAPER;
        sea_ready(sea);
        memset(expected, 0, sizeof expected);
        const double size = 120.0, track = half_track(sea);
        for (int i = 0; i < STEPS; i++)
            for (int k = 0; k < STEPS; k++)
                add_piece(sea, size * ((i + 0.5) / STEPS - 0.5), size * ((k + 0.5) / STEPS - 0.4),
                          size * size / STEPS / STEPS, track, expected);
        const struct energies measured = sea_chains(sea, &ranges, 1, SEEDS);
        expect_energies(is_focused ? "focused columns" : "paper columns", &measured, 1, expected,
                        RANGES, 0.015, 0.1, 3);
    }
}

/* --- Every path, against a reference that runs all of them --- */

enum convention {
    AS_CONNECTED, /* paper columns: every path counts in its first hit's column */
    AS_FOCUSED,   /* a path and its reverse are one echo, together four times the energy of one */
    AS_BY_CHANCE  /* brute force: a path that ends on the surface also for its reverse */
};

static bool is_of_surface(int met)
{
    return met == MET_SURFACE || met == MET_MIRROR;
}

/* Returns how often the image holds a path (MATH.md, "Chains by way of the sea surface"). */
static double ways_of(int path, enum convention convention, int *order)
{
    int met[REFERENCE_ORDERS];
    const int count = reference_met(path, met);
    int targets = 0, mirrors = 0;
    for (int i = 0; i < count; i++) {
        if (met[i] == 0)
            return 0.0;
        targets += met[i] == MET_TARGET;
        mirrors += met[i] == MET_MIRROR;
    }
    *order = count - 2;
    if (count < 2 || targets == 0 ||
        (convention != AS_BY_CHANCE && targets == 1 && mirrors == count - 1))
        return 0.0;
    const int last = met[count - 1];
    const bool begins_there = is_of_surface(met[0]);
    const bool goes_there = met[0] == MET_SEABED && is_of_surface(met[1]);
    const bool comes_from_there = last == MET_SEABED && is_of_surface(met[count - 2]);
    if (convention == AS_CONNECTED)
        return begins_there && is_of_surface(last) ? 0.0 : 1.0;
    /* the library runs these in the other direction */
    if (begins_there || (convention == AS_FOCUSED && goes_there))
        return 0.0;
    if (convention == AS_BY_CHANCE)
        return is_of_surface(last) ? 2.0 : 1.0;
    if (is_of_surface(last) || comes_from_there)
        return 4.0;
    if (met[0] == last)
        return 2.0;
    return met[0] == MET_SEABED ? 4.0 : 0.0;
}

/* Sets the seabed on which paths begin: near the target, or the patch's by brute force. */
static void look_at_seabed(struct sea *sea, enum convention convention,
                           struct reference_request *request)
{
    const struct tracer *tracer = &sea->bench->tracer;
    const struct chain_reach reach = chain_reach_of(tracer, &sea->bench->placements[0]);
    struct line_grid grid;
    line_grid_for_patch(&grid, &tracer->view, &tracer->response);
    request->near_ground = sea_centre(sea, 0)[1] - reach.towards_sonar_m;
    request->far_ground = sea_centre(sea, 0)[1] + reach.around_m;
    request->reach_x = reach.around_m;
    request->is_focused = convention == AS_FOCUSED;
    if (convention != AS_BY_CHANCE)
        return;
    request->near_ground = sea_ground(sea, line_grid_near_end(&grid, &tracer->view));
    request->far_ground = request->reach_x = INFINITY;
}

static void find_expected(struct sea *sea, enum convention convention,
                          struct estimate expected[ORDERS][RANGES])
{
    static struct reference_energy energy;
    struct reference_scene scene;
    struct reference_request request;
    reference_of_sea(sea, REFERENCE_SPHERE, &scene, &request);
    scene.source_grazing = asin(sea->sonar->altitude_m / MIDDLE_M);
    request.ranges = ranges;
    request.rays = RAYS;
    look_at_seabed(sea, convention, &request);
    reference_trace(&scene, &request, &energy);
    memset(expected, 0, ORDERS * sizeof *expected);
    for (int path = 0; path < REFERENCE_PATHS; path++) {
        int order = 0;
        const double ways = ways_of(path, convention, &order);
        for (int range = 0; range < RANGES && ways > 0.0; range++) {
            const struct estimate first = energy.in_first[path][range];
            const struct estimate both = energy.in_both[path][range];
            struct estimate *value = &expected[order][range];
            const bool is_twice = convention == AS_BY_CHANCE && ways == 2.0;
            value->mean += is_twice ? first.mean + both.mean : ways * first.mean;
            value->error =
                hypot(value->error, is_twice ? hypot(first.error, both.error) : ways * first.error);
        }
    }
}

/* The surface has its rough part and its mirror at once: 1 - exp(-P^2) at right angles is 0.92.
 * Where the library gives a path's reverse its column, it keeps the angles at the far end, which is
 * 3 %. A bin of 3 mm, shared at either end of a range, is 1 %. Brute force is the paper's own
 * estimator. Few of its paths meet the source, so five times the rays know three ranges to 13 %. */
CLAIM(every_path_has_its_energy)
{
    static const struct {
        const char *name;
        uint32_t column_rule;
        enum convention convention;
        double systematic;
    } cases[] = {{"paper columns", SONJECT_COLUMNS_PAPER, AS_CONNECTED, 0.03},
                 {"focused columns", SONJECT_COLUMNS_FOCUSED, AS_FOCUSED, 0.01},
                 {"by chance", SONJECT_COLUMNS_PAPER, AS_BY_CHANCE, 0.01}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct estimate expected[ORDERS][RANGES];
        struct sea *sea = open_scene(1.5, 0.4);
        sea->surface->material.reflection = -0.9;
        sea->surface->material.lambert = 0.25;
        sea->surface->material.roughness_m = 1.9e-3;
        sea->injection->column_rule = cases[i].column_rule;
        if (cases[i].convention == AS_BY_CHANCE) {
            sea->sonar->transducer_side_m = 8.0;
            sea->injection->estimator = SONJECT_ESTIMATOR_BRUTE_FORCE;
            sea->injection->mode = SONJECT_MODE_RESYNTHESISE;
            sea->injection->ray_scale = 5.0;
        }
        sea_ready(sea);
        find_expected(sea, cases[i].convention, expected);
        const struct energies measured = sea_chains(sea, &ranges, 1, SEEDS);
        for (int order = 0; order < ORDERS; order++)
            expect_energies(cases[i].name, &measured, order + 1, expected[order], RANGES,
                            cases[i].systematic, cases[i].convention == AS_BY_CHANCE ? 0.13 : 0.1,
                            3);
    }
}

/* --- Surfaces that change nothing --- */

struct change {
    const char *name;
    double depth_m, roughness_m, glossy_albedo; /* depth 0: no surface */
    uint32_t interactions;
    bool has_layers;
};

static struct energies trace_changed(const struct change *change)
{
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.0}, {12.0, 1500.0, 1.0}};
    struct sea *sea = open_scene(1.5, 0.4);
    sea->surface->water_depth_m = change->depth_m;
    sea->surface->material.roughness_m = change->roughness_m;
    sea->surface->material.glossy_albedo = change->glossy_albedo;
    sea->injection->interactions = change->interactions;
    sea_set_layers(sea, layers, change->has_layers ? 2 : 0);
    sea_ready(sea);
    print_message("%s\n", change->name);
    return sea_chains(sea, &ranges, 1, 1);
}

/* Chains of both scenes of a pair have the same bits, or have not, as `agrees` says. */
CLAIM(what_is_not_heard_changes_nothing)
{
    static const struct {
        struct change one, other;
        bool agrees;
    } pairs[] = {
        {{"no surface", 0.0, 0.0, 1.0, 3, false}, {"far away", 200.0, 0.01, 1.0, 3, false}, true},
        {{"no surface", 0.0, 0.0, 1.0, 3, false}, {"near", 15.0, 0.01, 1.0, 3, false}, false},
        {{"no surface", 0.0, 0.0, 1.0, 2, false}, {"mirror, 2", 15.0, 0.0, 1.0, 2, false}, true},
        {{"no surface", 0.0, 0.0, 1.0, 3, false}, {"mirror, 3", 15.0, 0.0, 1.0, 3, false}, false},
        {{"mirror", 15.0, 0.0, 0.0, 3, false}, {"no roughness", 15.0, 0.0, 1.0, 3, false}, true},
        {{"bare waves", 15.0, 0.01, 0.0, 3, false}, {"waves", 15.0, 0.01, 1.0, 3, false}, false},
        {{"layers", 0.0, 0.01, 1.0, 3, true}, {"and surface", 15.0, 0.01, 1.0, 3, true}, true},
    };
    for (size_t i = 0; i < COUNT(pairs); i++) {
        const struct energies one = trace_changed(&pairs[i].one);
        const struct energies other = trace_changed(&pairs[i].other);
        assert_true(one.sum[1][RANGES / 2] > 0.0);
        assert_int_equal(memcmp(&one, &other, sizeof one) == 0, pairs[i].agrees);
    }
}

/* The surface is in chains from its first echo on. A patch that ends before holds no echo by way of
 * the surface. The sphere's radius is 0.4 m. */
CLAIM(the_surface_is_in_chains_from_its_first_echo_on)
{
    for (int holds = 0; holds < 2; holds++) {
        struct line_grid grid;
        struct sea *sea = open_scene(1.5, 0.4);
        sea->surface->material.roughness_m = 0.01;
        sea->surface->material.glossy_albedo = 1.0;
        sea_ready(sea);
        const struct tracer *tracer = &sea->bench->tracer;
        const double *centre = sea_centre(sea, 0), altitude = sea->sonar->altitude_m;
        const double by_centre = 0.5 * (hypot(centre[1], altitude - centre[2]) +
                                        hypot(centre[1], 2.0 * DEPTH_M - altitude - centre[2]));
        line_grid_for_patch(&grid, &tracer->view, &tracer->response);
        const double last =
            sea_range(sea, (double)(grid.bins.first + grid.bins.count) / grid.bins_per_pixel);
        grid.bins.count -= (int32_t)((last - by_centre + (holds ? 0.3 : 0.5)) *
                                     grid.bins_per_pixel / sea->geometry->column_spacing_m);
        assert_int_equal(sea_surface_is_in_chains(tracer, &grid), holds);
    }
}
