/* Measures of contacts recover the geometry of injected objects: in random poses, on a seabed of
 * speckle, through the public interface. */
#include "sea.h"

#define ROWS     112
#define COLUMNS  224
#define SPACING  0.025
#define FIRST    38.0 /* slant range of column 0, m */
#define ALTITUDE 10.0
#define POSES    100
#define SOLIDS   10 /* poses of each thick kind */
#ifndef SEED
#define SEED 20240611 /* for the poses and the seabeds' speckle */
#endif
#define SIDES          32 /* of the polygon for a circle, 0.5 % narrower */
#define CORNERS        (2 * SIDES)
#define EDGES          (3 * SIDES)
#define CONTRAST_ERROR 0.4 /* dB, from sonject/measure.h */
#define LINES          33  /* across the middle third of the rows */

/* A convex body in a random pose. */
struct pose {
    sonject_object_params object;
    double corners[CORNERS][3]; /* x along the track, y ground range, z height */
    int corner_count;
    int edges[EDGES][2];
    int edge_count;
    bool has_dark_top; /* the shadow begins before the top */
};

static uint64_t random_state;

static double draw(double low, double high)
{
    return low + (high - low) * (double)(next_random(&random_state) >> 11) * 0x1p-53;
}

/* Moves corners from the body's own axes to the pose: above its place on the seabed, with the
 * lowest corner at its burial. */
static void place_corners(struct pose *pose)
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
    const double range = FIRST + object->position_range * SPACING;
    const double origin[3] = {object->position_along * SPACING,
                              sqrt(range * range - ALTITUDE * ALTITUDE), 0.0};
    double lowest = 0.0;
    for (int i = 0; i < pose->corner_count; i++) {
        const double own[3] = {pose->corners[i][0], pose->corners[i][1], pose->corners[i][2]};
        for (int k = 0; k < 3; k++)
            pose->corners[i][k] =
                origin[k] + own[0] * axes[0][k] + own[1] * axes[1][k] + own[2] * axes[2][k];
        lowest = fmin(lowest, pose->corners[i][2]);
    }
    for (int i = 0; i < pose->corner_count; i++)
        pose->corners[i][2] -= lowest + object->burial_m;
}

static void add_edge(struct pose *pose, int from, int to)
{
    pose->edges[pose->edge_count][0] = from;
    pose->edges[pose->edge_count++][1] = to;
}

/* Makes a prism or a truncated pyramid: rings of corners around an axis of the body, at both ends.
 * first_angle: of the first corner; aspect: ratio of the ring's second direction to the first. */
static void make_prism(struct pose *pose, int sides, int axis, double length, const double radii[2],
                       double first_angle, double aspect)
{
    const int across[2] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
    pose->corner_count = 2 * sides;
    pose->edge_count = 0;
    for (int end = 0; end < 2; end++)
        for (int i = 0; i < sides; i++) {
            const double angle = first_angle + 2.0 * PI * i / sides;
            double *corner = pose->corners[end * sides + i];
            corner[axis] = (end - 0.5) * length;
            corner[across[0]] = radii[end] * cos(angle);
            corner[across[1]] = radii[end] * aspect * sin(angle);
            add_edge(pose, end * sides + i, end * sides + (i + 1) % sides);
            if (end == 0)
                add_edge(pose, i, sides + i);
        }
    place_corners(pose);
}

static void make_box(struct pose *pose)
{
    const sonject_object_params *object = &pose->object;
    const double half_diagonal = 0.5 * sqrt(2.0) * object->width_m;
    const double radii[2] = {half_diagonal, half_diagonal};
    make_prism(pose, 4, 0, object->length_m, radii, 0.25 * PI, object->height_m / object->width_m);
}

static void draw_place(struct pose *pose)
{
    sonject_object_params *object = &pose->object;
    object_init(object);
    pose->has_dark_top = false;
    object->position_kind = SONJECT_POSITION_PIXELS;
    object->position_along = draw(50.0, 60.0);
    object->position_range = draw(50.0, 70.0);
    object->heading_rad = draw(-0.7, 0.7);
    object->burial_m = draw(0.0, 0.1);
    object->level_kind = SONJECT_LEVEL_OVER_SEABED;
    object->level_db = 15.0;
}

/* Draws a slab so thin that only the side facing the sonar is seen. It is nearly level, since the
 * tip of a raised end is fainter than the seabed. */
static void draw_slab(struct pose *pose)
{
    sonject_object_params *object = &pose->object;
    draw_place(pose);
    object->shape = SHAPE_BOX;
    object->length_m = draw(0.7, 1.3);
    object->width_m = draw(0.03, 0.05);
    object->height_m = draw(0.25, 0.5);
    object->pitch_rad = draw(-0.03, 0.03);
    object->roll_rad = draw(0.05, 0.3);
    make_box(pose);
}

/* Draws a smooth box. Its level top returns nothing and is as dark as the shadow. */
static void draw_smooth_box(struct pose *pose)
{
    sonject_object_params *object = &pose->object;
    draw_place(pose);
    object->shape = SHAPE_BOX;
    object->length_m = draw(0.7, 1.3);
    object->width_m = draw(0.2, 0.6);
    object->height_m = draw(0.25, 0.5);
    pose->has_dark_top = true;
    make_box(pose);
}

/* Draws a rough box. Its level top, a few dB darker than the seabed, is no highlight, no shadow. */
static void draw_box(struct pose *pose)
{
    draw_smooth_box(pose);
    pose->has_dark_top = false;
    pose->object.material.reflection = 0.0;
}

static void draw_truncated_cone(struct pose *pose)
{
    sonject_object_params *object = &pose->object;
    draw_place(pose);
    object->material.reflection = 0.0;
    object->shape = SHAPE_TRUNCATED_CONE;
    object->diameter_m = draw(0.8, 1.2);
    object->top_diameter_m = draw(0.3, 0.6);
    object->height_m = draw(0.3, 0.5);
    const double radii[2] = {0.5 * object->diameter_m, 0.5 * object->top_diameter_m};
    make_prism(pose, SIDES, 2, object->height_m, radii, 0.0, 1.0);
}

/* Finds where the line between two points passes a height or a track position. False: nowhere. */
static bool cross(const double a[3], const double b[3], int axis, double value, double point[3])
{
    if ((a[axis] < value) == (b[axis] < value))
        return false;
    const double share = (value - a[axis]) / (b[axis] - a[axis]);
    for (int k = 0; k < 3; k++)
        point[k] = a[k] + share * (b[k] - a[k]);
    return true;
}

/* Gives the along-track ends of the part above the seabed. */
static void ends_along_track(const struct pose *pose, double *low, double *high)
{
    *low = INFINITY;
    *high = -INFINITY;
    for (int i = 0; i < pose->edge_count; i++) {
        const double *ends[2] = {pose->corners[pose->edges[i][0]],
                                 pose->corners[pose->edges[i][1]]};
        double point[3];
        if (cross(ends[0], ends[1], 2, 0.0, point)) {
            *low = fmin(*low, point[0]);
            *high = fmax(*high, point[0]);
        }
        for (int k = 0; k < 2; k++)
            if (ends[k][2] >= 0.0) {
                *low = fmin(*low, ends[k][0]);
                *high = fmax(*high, ends[k][0]);
            }
    }
}

/* Gives the corners of the section at a track position. Returns their number. */
static int section(const struct pose *pose, double x, double points[][3])
{
    int count = 0;
    for (int i = 0; i < pose->edge_count; i++)
        count += cross(pose->corners[pose->edges[i][0]], pose->corners[pose->edges[i][1]], 0, x,
                       points[count]);
    return count;
}

/* Returns the slant range from the end of the section's lit part, or of the seabed before it, to
 * the end of the shadow, m. */
static double shadow_length(const struct pose *pose, double x)
{
    double points[EDGES][3];
    const int count = section(pose, x, points);
    double near = INFINITY; /* nearest and farthest ground point of rays through the section */
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
    return hypot(far, ALTITUDE) - fmax(pose->has_dark_top ? 0.0 : lit, hypot(near, ALTITUDE));
}

/* Returns the mean over the middle third of the rows, pixels. */
static double expected_shadow(const struct pose *pose)
{
    double low, high;
    double sum = 0.0;
    ends_along_track(pose, &low, &high);
    for (int i = 0; i < LINES; i++)
        sum += shadow_length(pose, low + (high - low) / 3.0 * (1.0 + (i + 0.5) / LINES));
    return sum / LINES / SPACING;
}

/* Returns whether no sound passes below the body in the middle third of the rows. Sound that does
 * lights the seabed behind the highlight, up to 2 pixels deep, which drowns in side lobes. */
static bool stands_in_seabed(const struct pose *pose)
{
    double low, high;
    ends_along_track(pose, &low, &high);
    for (int i = 0; i < LINES; i++) {
        double points[EDGES][3];
        const int count =
            section(pose, low + (high - low) / 3.0 * (1.0 + (i + 0.5) / LINES), points);
        int buried = 0;
        for (int k = 0; k < count; k++)
            buried += points[k][2] <= 0.0;
        if (buried < 2)
            return false;
    }
    return true;
}

static void expect_ok(sonject_context *context, sonject_status status)
{
    if (status != SONJECT_OK)
        fail_msg("%s", sonject_context_message(context));
}

/* Appends a length of the object's shape unless it is 0. Returns the text's length. */
static size_t add_key(char *text, size_t capacity, size_t length, const char *key, double value)
{
    return value > 0.0 ? length + (size_t)snprintf(text + length, capacity - length, ", %s: %.17g",
                                                   key, value)
                       : length;
}

static void set_object(sonject_context *context, sonject_scene *scene,
                       const sonject_object_params *object)
{
    char text[800];
    size_t length = (size_t)snprintf(
        text, sizeof text,
        "{shape: %s, position: {row: %.17g, column: %.17g}, heading: %.17g rad, pitch: %.17g rad, "
        "roll: %.17g rad, burial: %.17g, level: {over_seabed: %.17g}, material: {reflection: "
        "%.17g}",
        object->shape == SHAPE_BOX ? "box" : "truncated_cone", object->position_along,
        object->position_range, object->heading_rad, object->pitch_rad, object->roll_rad,
        object->burial_m, object->level_db, object->material.reflection);
    length = add_key(text, sizeof text, length, "length", object->length_m);
    length = add_key(text, sizeof text, length, "width", object->width_m);
    length = add_key(text, sizeof text, length, "height", object->height_m);
    length = add_key(text, sizeof text, length, "diameter", object->diameter_m);
    length = add_key(text, sizeof text, length, "top_diameter", object->top_diameter_m);
    snprintf(text + length, sizeof text - length, "}");
    expect_ok(context, sonject_scene_set(scene, "objects[0]", text));
}

/* Makes a scene without penumbrae (aperture none), since closed forms are of one aspect. */
static sonject_scene *make_scene(sonject_context *context, uint64_t seed)
{
    sonject_scene *scene = NULL;
    char text[800];
    const sonject_scene_read_params params = {.struct_size = sizeof params, .text = text};
    snprintf(text, sizeof text,
             "sonject: 1\n"
             "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: %.17g, aperture: none, "
             "response: rectangular}\n"
             "input: {geometry: {row_spacing: %.17g, column_spacing: %.17g, first_slant_range: "
             "%.17g},\n"
             "  synthetic: {rows: %d, columns: %d, seed: %llu, speckle_shape: inf,\n"
             "    ripple_contrast: 0, patch_contrast: 0}}\n"
             "injection: {seed: %llu}\n",
             ALTITUDE, SPACING, SPACING, FIRST, ROWS, COLUMNS, (unsigned long long)seed,
             (unsigned long long)seed);
    expect_ok(context, sonject_scene_read(context, NULL, &params, &scene));
    return scene;
}

/* Members that truth and measures share, and the standard errors that measures tell. */
static const struct {
    const char *name;
    size_t in_truth, in_measures, error_in_measures; /* error 0: CONTRAST_ERROR */
} shared_names[] = {
#define LENGTH(name)                                                                               \
    {                                                                                              \
#name "_m", offsetof(sonject_object_truth, name##_m),                                      \
            offsetof(sonject_contact_measures, name##_m),                                          \
            offsetof(sonject_contact_measures, name##_error_pixels)                                \
    }
#define CONTRAST(name)                                                                             \
    {                                                                                              \
#name, offsetof(sonject_object_truth, name), offsetof(sonject_contact_measures, name), 0   \
    }
    LENGTH(highlight_along),
    LENGTH(highlight_range),
    LENGTH(shadow_along),
    LENGTH(shadow_range),
    LENGTH(gap_range),
    LENGTH(dim_range),
    CONTRAST(highlight_contrast_db),
    CONTRAST(shadow_contrast_db)};

#define SHARED_NAMES (sizeof shared_names / sizeof *shared_names)

static int disagreements[SHARED_NAMES]; /* differences above 4 standard errors */

static void add_agreement(const sonject_object_truth *truth,
                          const sonject_contact_measures *measures)
{
    for (size_t i = 0; i < SHARED_NAMES; i++) {
        const size_t place = shared_names[i].error_in_measures;
        double told, measured, error;
        memcpy(&told, (const char *)truth + shared_names[i].in_truth, sizeof told);
        memcpy(&measured, (const char *)measures + shared_names[i].in_measures, sizeof measured);
        memcpy(&error, (const char *)measures + place, sizeof error);
        error = place > 0 ? error * SPACING : CONTRAST_ERROR;
        disagreements[i] += !(fabs(measured - told) <= 4.0 * error);
    }
}

/* Injects the body and measures it in the box of its truth with a margin. */
static void measure(sonject_context *context, const struct pose *pose, uint64_t seed,
                    sonject_contact_measures *measures)
{
    sonject_scene *scene = make_scene(context, seed);
    sonject_result *result = NULL;
    sonject_object_truth truth;
    static float image[ROWS * COLUMNS];
    set_object(context, scene, &pose->object);
    expect_ok(context, sonject_inject(context, scene, NULL, NULL, NULL, &result));
    truth.struct_size = sizeof truth;
    expect_ok(context, sonject_result_object(result, 0, &truth));
    expect_ok(context, sonject_result_layer(result, SONJECT_LAYER_IMAGE, image, sizeof image));
    const sonject_pixels pixels = {
        .struct_size = sizeof pixels, .rows = ROWS, .columns = COLUMNS, .data = image};
    sonject_box box = truth.both;
    assert_true(truth.both.first_row >= 6 && truth.both.first_column >= 6);
    box.first_row -= 6;
    box.first_column -= 6;
    box.rows += 12;
    box.columns += 12;
    measures->struct_size = sizeof *measures;
    expect_ok(context, sonject_measure_contact(context, &pixels, &box, SPACING, SPACING, measures));
    assert_true(fabs(measures->dim_range_m - measures->dim_range_pixels * SPACING) < 1e-9);
    add_agreement(&truth, measures);
    sonject_result_release(&result);
    sonject_scene_release(&scene);
}

/* Returns the along-track length of the face that the sonar sees and of the end beside it, pixels.
 * The face leans, so it ends where the middle of its edge is. */
static double expected_highlight(const struct pose *pose)
{
    const sonject_object_params *object = &pose->object;
    return (object->length_m * cos(object->heading_rad) * cos(object->pitch_rad) +
            object->width_m * fabs(sin(object->heading_rad))) /
           SPACING;
}

/* Results of many poses. Biases are measured less expected, pixels. */
struct tally {
    int poses, good_shadows, good_highlights;
    int told_shadows; /* good as they are or without their dim part */
    double shadow_bias, highlight_bias;
    int standing;         /* those of stands_in_seabed */
    double standing_bias; /* of shadows */
    double pulls[2];      /* rms of errors over their told standard errors: of shadows of standing
                             bodies, of highlights */
};

static bool is_good_shadow(double measured, double expected)
{
    return fabs(measured - expected) <= 1.0 + 0.02 * expected;
}

/* A highlight is good within the point response, which is a pixel at each end. */
static void add_pose(struct tally *tally, const struct pose *pose,
                     const sonject_contact_measures *measures)
{
    const double shadow = expected_shadow(pose);
    const double highlight = expected_highlight(pose);
    const double shadow_error = measures->shadow_range_pixels - shadow;
    const double highlight_error = measures->highlight_along_pixels - highlight;
    const bool is_good = is_good_shadow(measures->shadow_range_pixels, shadow);
    tally->poses++;
    tally->good_shadows += is_good;
    tally->told_shadows +=
        is_good ||
        is_good_shadow(measures->shadow_range_pixels - measures->dim_range_pixels, shadow);
    tally->good_highlights += fabs(highlight_error) <= 2.0;
    tally->shadow_bias += shadow_error;
    tally->highlight_bias += highlight_error;
    if (stands_in_seabed(pose)) {
        tally->standing++;
        tally->standing_bias += shadow_error;
        tally->pulls[0] += pow(shadow_error / measures->shadow_range_error_pixels, 2.0);
    }
    tally->pulls[1] += pow(highlight_error / measures->highlight_along_error_pixels, 2.0);
    if (!is_good)
        print_message("shadow %.2f (dim %.2f, gap %.2f) of %.2f +- %.2f pixels\n",
                      measures->shadow_range_pixels, measures->dim_range_pixels,
                      measures->gap_range_pixels, shadow, measures->shadow_range_error_pixels);
}

static struct tally measure_poses(const char *what, void (*draw_pose)(struct pose *), int poses)
{
    sonject_context_params params = {.struct_size = sizeof params};
    sonject_context *context = NULL;
    struct tally tally;
    memset(&tally, 0, sizeof tally);
    memset(disagreements, 0, sizeof disagreements);
    params.device_name = claim_device();
    assert_int_equal(sonject_context_create(&params, &context), SONJECT_OK);
    random_state = SEED;
    for (int i = 0; i < poses; i++) {
        struct pose pose;
        sonject_contact_measures measures;
        draw_pose(&pose);
        measure(context, &pose, SEED + (uint64_t)i, &measures);
        add_pose(&tally, &pose, &measures);
    }
    sonject_context_release(&context);
    tally.shadow_bias /= poses;
    tally.highlight_bias /= poses;
    tally.standing_bias /= tally.standing;
    tally.pulls[0] = sqrt(tally.pulls[0] / tally.standing);
    tally.pulls[1] = sqrt(tally.pulls[1] / poses);
    print_message(
        "of %d %s: %d shadows, %d less their dim part (mean error %.2f pixels; of %d that "
        "stand in the seabed %.2f, %.2f standard errors rms)\n",
        poses, what, tally.good_shadows, tally.told_shadows, tally.shadow_bias, tally.standing,
        tally.standing_bias, tally.pulls[0]);
    return tally;
}

/* Speckle leaves standard errors of 0.3 pixels to a shadow and of 0.4 to 1 to a highlight. In some
 * poses that is more than a third of the tolerance. No shadow and 1 highlight miss it in 400 poses,
 * with this seed and 8001 to 8003. More than 2 in 100 would occur once in 500 such tests. The rms
 * of errors over told ones is 1.11 to 1.26 for shadows and 0.76 to 0.88 for highlights with those
 * seeds. 80 poses know the rms to 1/sqrt(160) = 8 %. */
CLAIM(random_slabs_are_measured)
{
    const struct tally tally = measure_poses("slabs", draw_slab, POSES);
    print_message("%d highlights (mean error %.2f pixels, %.2f standard errors rms)\n",
                  tally.good_highlights, tally.highlight_bias, tally.pulls[1]);
    assert_true(tally.good_shadows >= POSES - 2);
    assert_true(tally.good_highlights >= POSES - 2);
    assert_true(tally.standing > POSES / 2);
    expect_below("mean error of shadows", fabs(tally.shadow_bias), 0.5);
    expect_below("mean error of highlights", fabs(tally.highlight_bias), 0.5);
    for (int i = 0; i < 2; i++)
        assert_true(tally.pulls[i] > 0.75 && tally.pulls[i] < 1.35);
    /* truth has the same members; rarely one edge is taken for another */
    for (size_t i = 0; i < SHARED_NAMES; i++) {
        print_message("%s: ", shared_names[i].name);
        expect_below("off truth by more than 4 standard errors, of 100", disagreements[i], 3.0);
    }
}

/* The lit top of a thick target is no part of its shadow. The top of a smooth one is as dark as the
 * shadow and is part of it, for nobody could tell them apart. */
CLAIM(solids_are_measured)
{
    const struct tally boxes = measure_poses("boxes", draw_box, SOLIDS);
    const struct tally cones = measure_poses("truncated cones", draw_truncated_cone, SOLIDS);
    const struct tally smooth = measure_poses("smooth boxes", draw_smooth_box, SOLIDS);
    assert_int_equal(boxes.good_shadows, SOLIDS);
    assert_true(cones.good_shadows >= SOLIDS - 1);
    assert_int_equal(cones.told_shadows, SOLIDS);
    assert_true(smooth.good_shadows >= SOLIDS - 1);
}
