/* Tests the seabed's relief in scene files: what is taken or refused, and the ground itself. */
#include "claims.h"
#include "scene/placement.h"
#include "scene_folder.h"

/* The first five lines of a scene. A feature's keys begin in column 7. */
#define SEEN_FROM(side)                                                                            \
    "sonject: 1\n"                                                                                 \
    "input: {uniform: {rows: 400, columns: 400}, geometry: {row_spacing: 2.5 cm, "                 \
    "column_spacing: 2.5 cm, first_slant_range: 40, side: " side "}}\n"                            \
    "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"                                   \
    "seabed:\n"                                                                                    \
    "  relief:\n"
#define FEATURES                                                                                   \
    "  - mound: {position: {along_track: 3 m, slant_range: 43 m}, radius: 1 m, height: 30 cm}\n"   \
    "  - pit: {position: {row: 280, column: 240}, radius: 1 m, depth: 20 cm}\n"
#define RIPPLES(more) "  - ripples: {wavelength: 80 cm, height: 6 cm, " more "}\n"
#define OBJECTS                                                                                    \
    "objects:\n"                                                                                   \
    "  - {name: can, shape: cylinder, length: 2 m, diameter: 0.5 m, heading: 90 deg, burial: "     \
    "{fraction: 0.5}, position: {along_track: 5 m, slant_range: 45 m}}\n"

/* The scene as it is used, over the whole swath. */
struct ground {
    struct water water;
    struct patch_view view;
    struct placements placements;
};

static sonject_status lay(struct ground *ground)
{
    struct scene *scene = &folder->scene;
    memset(ground, 0, sizeof *ground);
    sonject_status status = scene_lay_water(scene, &folder->report, &ground->water);
    THEN(status, patch_view_init(&ground->view, &folder->report, scene, &ground->water, 0.0, 0.0,
                                 scene->uniform_rows, scene->uniform_columns));
    THEN(status,
         placements_init(&ground->placements, &folder->report, scene, &ground->view, 0.0, 0.0));
    return status;
}

static void ground_clear(struct ground *ground)
{
    placements_clear(&ground->placements);
    water_clear(&ground->water);
}

/* Returns the height at a place of the image, m. */
static double height_at(const struct ground *ground, double along, double slant_range)
{
    return relief_height(ground->placements.relief, ground->view.is_mirrored ? -along : along,
                         view_ground_range(&ground->view, slant_range));
}

static void expect_height(const char *what, double height, double expected, double tolerance)
{
    if (!(fabs(height - expected) <= tolerance))
        fail_msg("%s: height %.5f m, not %.5f", what, height, expected);
}

static void take(struct ground *ground, const char *text)
{
    expect_scene_taken(text);
    EXPECT_OK(&folder->report, lay(ground));
}

/* Both sides of the track see the same ground. */
TEST(test_features_lie_where_they_are_told)
{
    static const char *const texts[] = {
        SEEN_FROM("port") FEATURES "  - scour: {object: can, width: 50 cm, depth: 10 cm}\n" OBJECTS,
        SEEN_FROM("starboard") FEATURES "  - scour: {width: 50 cm, depth: 10 cm}\n" OBJECTS};
    for (int side = 0; side < 2; side++) {
        struct ground ground;
        take(&ground, texts[side]);
        const struct placed_object *can = &ground.placements.objects[0];
        expect_height("top of the mound", height_at(&ground, 3.0, 43.0), 0.3, 1e-4);
        expect_height("half its radius", height_at(&ground, 3.5, 43.0), 0.15, 1e-3);
        expect_height("bottom of the pit", height_at(&ground, 7.0, 46.0), -0.2, 1e-4);
        expect_height("under the can", height_at(&ground, 5.0, 45.0), -0.1, 1e-6);
        /* the can points outwards: it covers 1 m of range and 0.25 m along the track */
        expect_height("at its side", height_at(&ground, 5.24, 45.0), -0.1, 1e-4);
        expect_height("beside it", height_at(&ground, 5.5, 45.0), -0.05, 2e-3);
        expect_height("beyond the scour", height_at(&ground, 5.76, 45.0), 0.0, 0.0);
        expect_height("level ground", height_at(&ground, 5.0, 48.0), 0.0, 0.0);
        expect_height("the can's middle", can->origin[2], -0.1, 1e-6);
        expect_height("the ground that it rests on", can->seabed_m, -0.1, 1e-6);
        expect_height("the can's lowest point", can->bottom_m, -0.35, 1e-6);
        ground_clear(&ground);
    }
}

/* Ripples have their phase and height, are level at the edges, and are alike from both sides. */
TEST(test_ripples)
{
#define WAVES RIPPLES("heading: 30 deg, sharpness: 0.5, phase: 20 deg")
    static const char *const texts[] = {SEEN_FROM("port") WAVES, SEEN_FROM("starboard") WAVES};
    for (int side = 0; side < 2; side++) {
        struct ground ground;
        take(&ground, texts[side]);
        for (int i = 0; i < 50; i++) {
            const double along = 1.5 + 0.14 * i;
            const double range = 42.0 + 0.12 * i;
            const double y = view_ground_range(&ground.view, range);
            const double phase =
                2.0 * PI * (along * cos(PI / 6.0) + y * sin(PI / 6.0)) / 0.8 + PI / 9.0;
            /* bilinear between 64 points a wavelength: (2 pi/64)^2/8 of 4 cm */
            expect_height("ripples", height_at(&ground, along, range),
                          0.03 * (cos(phase) + 0.125 * cos(2.0 * phase)), 6e-5);
        }
        const struct relief *relief = ground.placements.relief;
        for (uint32_t i = 0; i < relief->columns; i++)
            assert_true(relief->heights[i] == 0.0f &&
                        relief->heights[(size_t)(relief->rows - 1) * relief->columns + i] == 0.0f);
        assert_true(relief->highest_m < 0.0338 && relief->highest_m > 0.0337);
        ground_clear(&ground);
    }
}

TEST(test_irregular_ripples)
{
    struct ground one, same, other;
    take(&one, SEEN_FROM("port") RIPPLES("irregularity: 1, seed: 4"));
    take(&same, SEEN_FROM("port") RIPPLES("irregularity: 1, seed: 4"));
    take(&other, SEEN_FROM("port") RIPPLES("irregularity: 1, seed: 5"));
    const struct relief *relief = one.placements.relief;
    const size_t bytes = (size_t)relief->rows * relief->columns * sizeof(float);
    assert_memory_equal(relief->heights, same.placements.relief->heights, bytes);
    assert_true(memcmp(relief->heights, other.placements.relief->heights, bytes) != 0);
    /* no higher than the bounds that the water's layers and the checks use */
    double lowest, highest;
    relief_features_bounds(&folder->scene.relief, &lowest, &highest);
    assert_true(relief->lowest_m >= lowest && relief->highest_m <= highest);
    ground_clear(&one);
    ground_clear(&same);
    ground_clear(&other);
}

/* Some mistakes show only when the scene is used. */
TEST(test_refusals_in_use)
{
    static const struct refusal cases[] = {
        {SEEN_FROM("port") "  - scour: {object: tin, width: 1 m, depth: 1 cm}\n" OBJECTS,
         "scour around 'tin': no object has that name"},
        {SEEN_FROM("port") "  - mound: {radius: 1 m, height: 2 m}\n", "rises by"},
        {SEEN_FROM("port") "  - mound: {radius: 20 m, height: 6 m}\n", "half the sonar's altitude"},
        {SEEN_FROM("port") "  - ripples: {wavelength: 5 mm, height: 1 mm}\n",
         "use a smaller patch"},
        {SEEN_FROM("port") "  - mound: {radius: 1 m, height: 10 cm}\n"
                           "  forward: medium sand\n",
         "cannot be smooth"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct ground ground;
        expect_scene_taken(cases[i].text);
        assert_int_equal(lay(&ground), SONJECT_ERROR_INPUT);
        if (!strstr(folder->report.message, cases[i].message))
            fail_msg("'%s' does not say '%s'", folder->report.message, cases[i].message);
        ground_clear(&ground);
    }
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
