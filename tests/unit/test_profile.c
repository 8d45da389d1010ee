/* Layers of water, and those that sound-speed profiles become. */
#include "api/handles.h"
#include "claims.h"

#define STEP (1.0 / 20000.0) /* of the sound speed between layers, at most */

static int make_scene(void **state)
{
    sonject_context *context = NULL;
    sonject_scene *scene = NULL;
    if (sonject_context_create(NULL, &context) != SONJECT_OK ||
        sonject_scene_create(context, &scene) != SONJECT_OK)
        return 1;
    static void *both[2];
    both[0] = context;
    both[1] = scene;
    *state = both;
    return 0;
}

static int remove_scene(void **state)
{
    void **both = *state;
    sonject_context *context = both[0];
    sonject_scene *scene = both[1];
    sonject_scene_release(&scene);
    sonject_context_release(&context);
    return 0;
}

static sonject_scene *scene_of(void **state)
{
    return ((void **)*state)[1];
}

static void expect_message(const sonject_scene *scene, const char *message)
{
    if (strcmp(scene->report->message, message) != 0)
        fail_msg("the message is\n%s\nand not\n%s", scene->report->message, message);
}

static sonject_status set_layers(sonject_scene *scene, struct water_layer *layers, size_t count)
{
    free(scene->scene.water_layers);
    scene->scene.water_layers = layers;
    scene->scene.water_layer_count = count;
    return SONJECT_OK;
}

static sonject_status set_profile(sonject_scene *scene, const double *heights, const double *speeds,
                                  size_t count)
{
    struct water_layer *layers = NULL;
    size_t layer_count = 0;
    CHECK(check_sound_speed_profile(heights, speeds, count, scene->report, NULL));
    CHECK(layers_of_profile(heights, speeds, count, scene->report, &layers, &layer_count));
    return set_layers(scene, layers, layer_count);
}

/* ---- layers ---- */

static void test_wrong_layers_are_refused(void **state)
{
    static const struct {
        double bottoms[3], speeds[3], densities[3];
        const char *message;
    } wrong[] = {
        {{1, 2, 3},
         {1500, 1500, 1500},
         {1, 1, 1},
         "layers[0].bottom must be 0 m: the first layer lies on the seabed; not 1 m"},
        {{NAN, 2, 3},
         {1500, 1500, 1500},
         {1, 1, 1},
         "layers[0].bottom must be -1e+06...1e+06 m, not nan"},
        {{0, 2, HUGE_VAL},
         {1500, 1500, 1500},
         {1, 1, 1},
         "layers[2].bottom must be -1e+06...1e+06 m, not inf"},
        {{0, 2, NAN},
         {1500, 1500, 1500},
         {1, 1, 1},
         "layers[2].bottom must be -1e+06...1e+06 m, not nan"},
        {{0, 2, 2},
         {1500, 1500, 1500},
         {1, 1, 1},
         "layers[2].bottom must lie over the one before it, 2 m, by at least 1e-06 m, not at 2 m"},
        {{0, -1, 2},
         {1500, 1500, 1500},
         {1, 1, 1},
         "layers[1].bottom must lie over the one before it, 0 m, by at least 1e-06 m, not at -1 m"},
        {{0, 1, 2},
         {1500, 99.9, 1500},
         {1, 1, 1},
         "layers[1].sound_speed must be 100...10000 m/s, not 99.9"},
        {{0, 1, 2},
         {10000.1, 1500, 1500},
         {1, 1, 1},
         "layers[0].sound_speed must be 100...10000 m/s, not 10000.1"},
        {{0, 1, 2},
         {1500, 1500, NAN},
         {1, 1, 1},
         "layers[2].sound_speed must be 100...10000 m/s, not nan"},
        {{0, 1, 2},
         {1500, 1500, 1500},
         {1, 0, 1},
         "layers[1].density must be 1e-06...1e+06, not 0"},
        {{0, 1, 2},
         {1500, 1500, 1500},
         {-1, 1, 1},
         "layers[0].density must be 1e-06...1e+06, not -1"},
        {{0, 1, 2},
         {1500, 1500, 1500},
         {1, 1, NAN},
         "layers[2].density must be 1e-06...1e+06, not nan"},
    };
    sonject_scene *scene = scene_of(state);
    for (size_t i = 0; i < COUNT(wrong); i++) {
        struct water_layer layers[3];
        for (size_t j = 0; j < COUNT(layers); j++) {
            layers[j].bottom_m = wrong[i].bottoms[j];
            layers[j].speed_mps = wrong[i].speeds[j];
            layers[j].density = wrong[i].densities[j];
        }
        assert_int_equal(check_water_layers(layers, COUNT(layers), scene->report, NULL),
                         SONJECT_ERROR_INPUT);
        expect_message(scene, wrong[i].message);
    }
}

/* ---- profiles ---- */

struct profile {
    double heights[5], speeds[5];
    size_t count;
};

/* The sound speed that the samples mean. */
static double speed_at(const struct profile *profile, double height)
{
    size_t i = 0;
    if (height <= profile->heights[0])
        return profile->speeds[0];
    if (height >= profile->heights[profile->count - 1])
        return profile->speeds[profile->count - 1];
    while (profile->heights[i + 1] < height)
        i++;
    const double share =
        (height - profile->heights[i]) / (profile->heights[i + 1] - profile->heights[i]);
    return (1.0 - share) * profile->speeds[i] + share * profile->speeds[i + 1];
}

/* Layers of the straight pieces that lie over the seabed: as few as the step allows, and one where
 * it is constant, which the next one joins if it has the same speed. */
static void expect_layers(void **state, const struct profile *profile, size_t count)
{
    sonject_scene *scene = scene_of(state);
    EXPECT_OK(scene->report, set_profile(scene, profile->heights, profile->speeds, profile->count));
    const struct water_layer *layers = scene->scene.water_layers;
    assert_int_equal(scene->scene.water_layer_count, count);
    assert_true(layers[0].bottom_m == 0.0);
    for (size_t i = 0; i < count; i++) {
        const bool is_last = i + 1 == count;
        const double bottom = layers[i].bottom_m;
        const double middle = is_last ? bottom + 1.0 : 0.5 * (bottom + layers[i + 1].bottom_m);
        /* 1e-12: roundings of the middle and of the interpolation */
        assert_true(fabs(layers[i].speed_mps / speed_at(profile, middle) - 1.0) < 1e-12);
        assert_true(layers[i].density == layers[0].density);
        if (is_last)
            continue;
        const double next = layers[i + 1].speed_mps;
        assert_true(layers[i + 1].bottom_m > bottom && next != layers[i].speed_mps);
        assert_true(fabs(next - layers[i].speed_mps) <=
                    STEP * (1.0 + 1e-9) * fmin(next, layers[i].speed_mps));
    }
}

static void test_profiles_become_thin_layers(void **state)
{
    /* 1490 to 1520 m/s: 30 / (1490 / 20000) = 402.7 layers, and one below and above */
    const struct profile thermocline = {{0, 12, 16, 25}, {1490, 1490, 1520, 1520}, 4};
    const struct profile falling = {{3, 20}, {1500.0, 1499.0}, 2};          /* 13.3, and two */
    const struct profile buried = {{-4, 4, 6}, {1500, 1504, 1504}, 3};      /* 1502...1504: 26.6 */
    const struct profile below = {{-9, -5, 10}, {1400, 1500, 1501}, 3};     /* 2/3 m/s: 8.9 */
    const struct profile little = {{1, 2, 3}, {1500, 1500.06, 1500.01}, 3}; /* less than a step */
    const struct profile constant = {{1, 2, 3}, {1480, 1480, 1480}, 3};
    const struct profile corner = {{0, 10, 20}, {1500, 1503.1, 1499}, 3}; /* 41.3 and 54.7 */
    expect_layers(state, &thermocline, 405);
    expect_layers(state, &falling, 16);
    expect_layers(state, &buried, 28);
    expect_layers(state, &below, 10);
    expect_layers(state, &little, 4);
    expect_layers(state, &constant, 1);
    expect_layers(state, &corner, 98);
}

static void test_wrong_profiles_change_nothing(void **state)
{
    static const struct {
        double heights[3], speeds[3];
        const char *message;
        size_t count;
    } wrong[] = {
        {{0}, {1500}, "heights[1] is missing; a profile needs at least two samples", 1},
        {{0}, {1500}, "heights[0] is missing; a profile needs at least two samples", 0},
        {{0, 1, 1},
         {1500, 1500, 1500},
         "heights[2] must lie over the one before it, 1 m, by at least 1e-06 m, not at 1 m",
         3},
        {{2, 1, 0},
         {1500, 1500, 1500},
         "heights[1] must lie over the one before it, 2 m, by at least 1e-06 m, not at 1 m",
         3},
        {{0, NAN, 2}, {1500, 1500, 1500}, "heights[1] must be -1e+06...1e+06 m, not nan", 3},
        {{-HUGE_VAL, 1, 2}, {1500, 1500, 1500}, "heights[0] must be -1e+06...1e+06 m, not -inf", 3},
        {{0, 1, 2}, {1500, NAN, 1500}, "sound_speeds[1] must be 100...10000 m/s, not nan", 3},
        {{0, 1, 2}, {99, 1500, 1500}, "sound_speeds[0] must be 100...10000 m/s, not 99", 3},
        {{0, 1, 2}, {1500, 1500, HUGE_VAL}, "sound_speeds[2] must be 100...10000 m/s, not inf", 3},
        {{-3, -2, 0},
         {1500, 1500, 1500},
         "heights[2] must lie over the seabed: the whole profile is below it (0 m)",
         3},
        {{0, 1, 2},
         {1300, 1700, 1700},
         "profile needs more than 4096 layers; take fewer samples, or layers",
         3},
    };
    sonject_scene *scene = scene_of(state);
    const double heights[] = {0.0, 10.0}, speeds[] = {1490.0, 1490.0};
    assert_int_equal(set_profile(scene, heights, speeds, 2), SONJECT_OK);
    const struct water_layer *before = scene->scene.water_layers;
    for (size_t i = 0; i < COUNT(wrong); i++) {
        assert_int_equal(set_profile(scene, wrong[i].heights, wrong[i].speeds, wrong[i].count),
                         SONJECT_ERROR_INPUT);
        expect_message(scene, wrong[i].message);
    }
    assert_ptr_equal(scene->scene.water_layers, before);
    assert_int_equal(scene->scene.water_layer_count, 1);
}

/* Samples closer than any height matters, and the steepest that fits: bottoms still rise. */
static void test_steep_profiles_keep_rising(void **state)
{
    sonject_scene *scene = scene_of(state);
    const double heights[] = {999999.0, 999999.000001}, speeds[] = {1400.0, 1660.0};
    if (set_profile(scene, heights, speeds, 2) == SONJECT_OK)
        for (size_t i = 1; i < scene->scene.water_layer_count; i++)
            assert_true(scene->scene.water_layers[i].bottom_m >
                        scene->scene.water_layers[i - 1].bottom_m);
    else
        expect_message(scene, "heights[1] must lie over the one before it, 999999 m, by at least "
                              "1e-06 m, not at 999999 m");
}

TEST_PROGRAM(make_scene, remove_scene, TEST(test_wrong_layers_are_refused),
             TEST(test_profiles_become_thin_layers), TEST(test_wrong_profiles_change_nothing),
             TEST(test_steep_profiles_keep_rising))
