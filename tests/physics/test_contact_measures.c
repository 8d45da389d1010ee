/* The ruler for contacts recovers the geometry of injected ones: slabs in random poses on a seabed
 * of speckle, through the public interface. Slabs, because the level top of a thick box is as dark
 * at such grazing angles as the shadow behind it, which hides where that begins;
 * nearly level ones, because the tip of a raised end is fainter than the seabed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include <sonject/sonject.h>

#include "bench.h"

#define ROWS     112
#define COLUMNS  224
#define SPACING  0.025
#define FIRST    38.0 /* slant range of column 0, m */
#define ALTITUDE 10.0
#define POSES    100
#define SEED     20240611 /* of the poses and of the seabeds' speckle */
#define CORNERS  8
#define LINES    33 /* across the middle third of the rows */

/* A box as it is drawn: all that is random. */
struct pose {
    sonject_object_params object;
    double corners[CORNERS][3]; /* x along the track, y ground range, z height */
};

static uint64_t random_state;

static double draw(double low, double high)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(random_state >> 11) * 0x1p-53;
}

/* Corners of the box, its lowest one so deep in the seabed, above a point of the seabed. */
static void find_corners(struct pose *pose)
{
    const sonject_object_params *object = &pose->object;
    const double ch = cos(object->heading_rad);
    const double sh = sin(object->heading_rad);
    const double cp = cos(object->pitch_rad);
    const double sp = sin(object->pitch_rad);
    const double cr = cos(object->roll_rad);
    const double sr = sin(object->roll_rad);
    const double axes[3][3] = {{ch * cp, sh * cp, sp},
                               {-sh * cr - ch * sp * sr, ch * cr - sh * sp * sr, cp * sr},
                               {-ch * sp * cr + sh * sr, -sh * sp * cr - ch * sr, cp * cr}};
    const double sizes[3] = {object->length_m, object->width_m, object->height_m};
    const double range = FIRST + object->position_range * SPACING;
    const double origin[3] = {object->position_along * SPACING,
                              sqrt(range * range - ALTITUDE * ALTITUDE), 0.0};
    double lowest = 0.0;
    for (int i = 0; i < CORNERS; i++) {
        for (int k = 0; k < 3; k++) {
            pose->corners[i][k] = origin[k];
            for (int axis = 0; axis < 3; axis++)
                pose->corners[i][k] += (i >> axis & 1 ? 0.5 : -0.5) * sizes[axis] * axes[axis][k];
        }
        lowest = fmin(lowest, pose->corners[i][2]);
    }
    for (int i = 0; i < CORNERS; i++)
        pose->corners[i][2] -= lowest + object->burial_m;
}

static void draw_pose(struct pose *pose)
{
    sonject_object_params *object = &pose->object;
    sonject_object_params_init(object);
    object->shape = SONJECT_SHAPE_BOX;
    object->length_m = draw(0.7, 1.3);
    object->width_m = draw(0.03, 0.05);
    object->height_m = draw(0.25, 0.5);
    object->position_kind = SONJECT_POSITION_PIXELS;
    object->position_along = draw(50.0, 60.0);
    object->position_range = draw(50.0, 70.0);
    object->heading_rad = draw(-0.7, 0.7);
    object->pitch_rad = draw(-0.03, 0.03);
    object->roll_rad = draw(0.05, 0.3);
    object->burial_m = draw(0.0, 0.1);
    object->level_kind = SONJECT_LEVEL_OVER_SEABED;
    object->level_db = 15.0;
    find_corners(pose);
}

/* Where the line between two points passes a height or a track position; false: nowhere. */
static bool cross(const double a[3], const double b[3], int axis, double value, double point[3])
{
    if ((a[axis] < value) == (b[axis] < value))
        return false;
    const double share = (value - a[axis]) / (b[axis] - a[axis]);
    for (int k = 0; k < 3; k++)
        point[k] = a[k] + share * (b[k] - a[k]);
    return true;
}

/* Along-track ends of what stands above the seabed. */
static void ends_along_track(const struct pose *pose, double *low, double *high)
{
    *low = INFINITY;
    *high = -INFINITY;
    for (int i = 0; i < CORNERS; i++)
        for (int k = 0; k < CORNERS; k++) {
            double point[3] = {pose->corners[i][0], 0.0, 0.0};
            if (pose->corners[i][2] < 0.0 &&
                !cross(pose->corners[i], pose->corners[k], 2, 0.0, point))
                continue;
            *low = fmin(*low, point[0]);
            *high = fmax(*high, point[0]);
        }
}

/* The points of the section at a track position; lines within the section do no harm. */
static int section(const struct pose *pose, double x, double points[][3])
{
    int count = 0;
    for (int i = 0; i < CORNERS; i++)
        for (int k = i + 1; k < CORNERS; k++)
            count += cross(pose->corners[i], pose->corners[k], 0, x, points[count]);
    return count;
}

/* Slant range between the end of what is lit of the section, or the seabed before it, and the end
 * of its shadow. */
static double shadow_length(const struct pose *pose, double x)
{
    double points[CORNERS * CORNERS][3];
    const int count = section(pose, x, points);
    double near = INFINITY; /* of the ground points that rays through the section go to */
    double far = 0.0;
    double lit = 0.0;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++) {
            double point[3] = {x, points[i][1], points[i][2]};
            if (point[2] < 0.0 && !cross(points[i], points[k], 2, 0.0, point))
                continue;
            const double ground = point[1] * ALTITUDE / (ALTITUDE - point[2]);
            near = fmin(near, ground);
            if (ground > far) {
                far = ground;
                lit = hypot(point[1], ALTITUDE - point[2]);
            }
        }
    return hypot(far, ALTITUDE) - fmax(lit, hypot(near, ALTITUDE));
}

/* The mean over the middle third of the rows. */
static double expected_shadow(const struct pose *pose)
{
    double low, high;
    double sum = 0.0;
    ends_along_track(pose, &low, &high);
    for (int i = 0; i < LINES; i++)
        sum += shadow_length(pose, low + (high - low) / 3.0 * (1.0 + (i + 0.5) / LINES));
    return sum / LINES / SPACING;
}

static void expect_ok(sonject_context *context, sonject_status status)
{
    if (status != SONJECT_OK)
        fail_msg("%s", sonject_context_message(context));
}

static sonject_scene *make_scene(sonject_context *context, uint64_t seed)
{
    sonject_scene *scene = NULL;
    sonject_sonar_params sonar;
    sonject_geometry_params geometry;
    sonject_synthetic_params seabed;
    sonject_injection_params injection;
    sonject_sonar_params_init(&sonar);
    sonject_geometry_params_init(&geometry);
    sonject_synthetic_params_init(&seabed);
    sonject_injection_params_init(&injection);
    sonar.altitude_m = ALTITUDE;
    sonar.aperture_rad = 0.0; /* no penumbra: closed forms are of one aspect */
    geometry.row_spacing_m = geometry.column_spacing_m = SPACING;
    geometry.first_slant_range_m = FIRST;
    seabed.rows = ROWS;
    seabed.columns = COLUMNS;
    seabed.seed = seed;
    seabed.speckle_shape = INFINITY;
    seabed.ripple_contrast = 0.0;
    seabed.patch_contrast_db = 0.0;
    injection.seed = seed;
    expect_ok(context, sonject_scene_create(context, &scene));
    expect_ok(context, sonject_scene_set_sonar(scene, &sonar));
    expect_ok(context, sonject_scene_set_geometry(scene, &geometry));
    expect_ok(context, sonject_scene_set_injection(scene, &injection));
    expect_ok(context, sonject_scene_set_input_synthetic(scene, &seabed));
    return scene;
}

/* Injects it, and measures it in the box that its truth gives with a margin. */
static void measure(sonject_context *context, const struct pose *pose, uint64_t seed,
                    sonject_contact_measures *measures)
{
    sonject_scene *scene = make_scene(context, seed);
    sonject_result *result = NULL;
    sonject_object_truth truth;
    sonject_contact_params params;
    static float image[ROWS * COLUMNS];
    expect_ok(context, sonject_scene_add_object(scene, &pose->object, NULL));
    expect_ok(context, sonject_inject(context, scene, NULL, NULL, NULL, &result));
    truth.struct_size = sizeof truth;
    expect_ok(context, sonject_result_object(result, 0, &truth));
    expect_ok(context, sonject_result_layer(result, SONJECT_LAYER_IMAGE, image, sizeof image));
    const sonject_pixels pixels = {sizeof pixels, SONJECT_PIXELS_AMPLITUDE, ROWS, COLUMNS, 0,
                                   image};
    sonject_contact_params_init(&params);
    params.box = truth.both;
    assert_true(truth.both.first_row >= 6 && truth.both.first_column >= 6);
    params.box.first_row -= 6;
    params.box.first_column -= 6;
    params.box.rows += 12;
    params.box.columns += 12;
    params.row_spacing_m = params.column_spacing_m = SPACING;
    measures->struct_size = sizeof *measures;
    expect_ok(context, sonject_measure_contact(context, &pixels, &params, measures));
    sonject_result_release(&result);
    sonject_scene_release(&scene);
}

/* The shadow's length within one pixel and 2 %, the highlight's within the point response, which is
 * a pixel at each end. Single-look speckle takes fading ends off some narrow echoes, and lets some
 * edges of shadows wander: of 300 poses with seeds 1, 2 and 20240611, 294 shadows and 294
 * highlights were that good; 3 in 100 more may fail. Means over all poses know no such excuse. */
static void test_random_poses(void **unused)
{
    (void)unused;
    sonject_context_params params;
    sonject_context *context = NULL;
    double shadow_bias = 0.0;
    double highlight_bias = 0.0;
    int good_shadows = 0;
    int good_highlights = 0;
    sonject_context_params_init(&params);
    params.device_name = bench_device;
    params.cache_folder = "";
    assert_int_equal(sonject_context_create(&params, &context), SONJECT_OK);
    random_state = SEED;
    for (int i = 0; i < POSES; i++) {
        struct pose pose;
        sonject_contact_measures measures;
        double low, high;
        draw_pose(&pose);
        measure(context, &pose, SEED + (uint64_t)i, &measures);
        ends_along_track(&pose, &low, &high);
        const double shadow = expected_shadow(&pose);
        const double highlight = (high - low) / SPACING;
        const double shadow_error = measures.shadow_range_pixels - shadow;
        const double highlight_error = measures.highlight_along_pixels - highlight;
        const bool is_good_shadow = fabs(shadow_error) <= 1.0 + 0.02 * shadow;
        const bool is_good_highlight = fabs(highlight_error) <= 2.0;
        shadow_bias += shadow_error / POSES;
        highlight_bias += highlight_error / POSES;
        good_shadows += is_good_shadow;
        good_highlights += is_good_highlight;
        if (!is_good_shadow || !is_good_highlight)
            print_message("pose %d: shadow %.2f of %.2f, highlight %.2f of %.2f pixels\n", i,
                          measures.shadow_range_pixels, shadow, measures.highlight_along_pixels,
                          highlight);
    }
    print_message("of %d: %d shadows (mean error %.2f pixels), %d highlights (%.2f)\n", POSES,
                  good_shadows, shadow_bias, good_highlights, highlight_bias);
    sonject_context_release(&context);
    assert_true(good_shadows >= POSES - 5);
    assert_true(good_highlights >= POSES - 5);
    expect_below("mean error of shadows", fabs(shadow_bias), 1.0);
    expect_below("mean error of highlights", fabs(highlight_bias), 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_poses),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
