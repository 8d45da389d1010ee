/* Measured and traced sound in one image: the pixels that stay, the energy that is added, its
 * response, looks, saturation and level, and patches that are resynthesised. */
#include "inject/compose.h"
#include "sea.h"

#define SIDE    320 /* pixels */
#define PIXELS  ((size_t)SIDE * SIDE)
#define RANGE   40.0
#define SPACING 0.025
#define SEEDS   12

/* Returns a measured patch: a speckle field of unit mean square with the sonar's point response. */
static double complex *measured_field(struct sea *sea, uint64_t seed)
{
    const uint64_t own_seed = sea->injection->seed;
    sea->injection->seed = seed;
    sea_ready(sea);
    double complex *field = sea_noise(sea, NOISE_MEASURED);
    sea->injection->seed = own_seed;
    return field;
}

static double pixel_energy(const struct injected *result, bool is_complex, size_t i)
{
    const float *p = result->image;
    return is_complex ? (double)p[2 * i] * p[2 * i] + (double)p[2 * i + 1] * p[2 * i + 1]
                      : (double)p[i] * p[i];
}

/* Adds a black plate over the seabed. */
static void add_plate(struct sea *sea, double length, double width)
{
    sonject_object_params *plate = sea_add(sea, SHAPE_PLANE, length, width, 0.0);
    plate->material.reflection = 0.0;
    plate->burial_m = -0.5;
}

/* Asks for a noise floor instead of an estimated one. */
static void set_noise(struct sea *sea, double floor_db)
{
    sea->injection->estimate_noise = 0;
    sea->injection->noise_floor_db = floor_db;
}

/* Outside the influence every bit is the input's. Inside, V is a fraction. */
CLAIM(untouched_pixels_keep_every_bit)
{
    for (int is_complex = 0; is_complex < 2; is_complex++) {
        struct sea *sea = sea_open(SIDE, SIDE, RANGE);
        const double complex *field = measured_field(sea, 5);
        const float *pixels = is_complex ? pairs_of(field, PIXELS) : magnitudes_of(field, PIXELS);
        const size_t width = is_complex ? 2 : 1;
        sonject_object_params *object = sea_add_sphere(sea, 0.3, 0.0);
        object->material.reflection = 0.8;
        object->material.roughness_m = 1e-3;
        object->material.lambert = 0.1;
        const struct injected *result = sea_inject(sea, pixels, is_complex);
        size_t kept = 0, shaded = 0;
        for (size_t i = 0; i < PIXELS; i++) {
            assert_true(result->visibility[i] >= 0.0f && result->visibility[i] <= 1.0f);
            shaded += result->visibility[i] < 0.1f;
            if (result->influence[i])
                continue;
            assert_memory_equal(result->image + i * width, pixels + i * width,
                                width * sizeof(float));
            assert_true(result->visibility[i] == 1.0f);
            assert_int_equal(result->labels[i], 0);
            kept++;
        }
        print_message("%zu of %zu pixels kept, %zu in deep shadow\n", kept, PIXELS, shaded);
        assert_true(kept > PIXELS / 3);
        assert_true(shaded > 300);
        assert_int_equal(result->statistics.changed_pixels, PIXELS - kept);
    }
}

/* The deep shadow of a black object holds the noise that was asked for. Highlights have the
 * expected energy, each pixel over its own. Both are means over a few seeds. */
CLAIM(shadows_and_highlights_have_their_energy)
{
    for (int is_complex = 0; is_complex < 2; is_complex++) {
        double noise[SEEDS], highlight[SEEDS];
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            struct sea *sea = sea_open(SIDE, SIDE, RANGE);
            sea->injection->seed = seed + 1;
            set_noise(sea, -20.0);
            const double complex *field = measured_field(sea, seed + 100);
            const float *pixels =
                is_complex ? pairs_of(field, PIXELS) : magnitudes_of(field, PIXELS);
            add_plate(sea, 1.5, 1.0);
            sonject_object_params *ball = sea_add_sphere(sea, 0.4, 0.0);
            place_in_pixels(ball, 60.0, 60.0);
            make_rough(ball, 0.2);
            sea_ready(sea);
            const struct injected *result = sea_inject(sea, pixels, is_complex);
            const struct patch_level *level = sea_level(sea, pixels, is_complex);
            double in_shadow = 0.0, on_ball = 0.0, shadow_pixels = 0.0, ball_pixels = 0.0;
            for (size_t i = 0; i < PIXELS; i++) {
                const double ratio = pixel_energy(result, is_complex, i) / level->level[i];
                if (result->visibility[i] < 1e-3f && result->labels[i] == 1) {
                    in_shadow += ratio;
                    shadow_pixels++;
                }
                if (result->highlight[i] && result->labels[i] == 2) {
                    const double cell = level->cell_energy[i % SIDE];
                    on_ball += ratio * cell /
                               (result->energy[i] +
                                (1.0 - result->visibility[i]) * level->noise_ratio * cell);
                    ball_pixels++;
                }
            }
            assert_true(ball_pixels > 100.0 && shadow_pixels > 500.0);
            noise[seed] = in_shadow / shadow_pixels / 0.01;
            highlight[seed] = on_ball / ball_pixels;
        }
        const struct estimate floor_level = estimate_of(noise, SEEDS);
        const struct estimate echo_level = estimate_of(highlight, SEEDS);
        print_message("%s\n", is_complex ? "complex" : "amplitude");
        expect_estimate("noise in the shadow over what was asked", floor_level, 1.0, 0.0);
        expect_estimate("highlight energy over expected", echo_level, 1.0, 0.0);
        expect_below("standard errors", fmax(floor_level.error, echo_level.error), 0.047);
    }
}

/* A share V of the seabed's energy that arrives is in the image: the mean of |out|^2 / |in|^2
 * weighted by |in|^2 is V + (1 - V) noise. A lattice of narrow slats has V between 0 and 1 in all
 * of its shadow. */
CLAIM(a_partial_shadow_keeps_its_share)
{
    struct sea *sea = sea_open(SIDE, SIDE, RANGE);
    set_noise(sea, -60.0);
    const double complex *field = measured_field(sea, 5);
    for (int k = 0; k < 8; k++) {
        sonject_object_params *slat = sea_add(sea, SHAPE_PLANE, 0.06, 1.5, 0.0);
        slat->material.reflection = 0.0;
        slat->burial_m = -0.3;
        place_in_pixels(slat, 140.0 + 4.3 * k, 150.0);
    }
    const struct injected *result = sea_inject(sea, pairs_of(field, PIXELS), true);
    double out = 0.0, expected = 0.0;
    size_t partial = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        if (!result->influence[i])
            continue;
        out += pixel_energy(result, true, i);
        expected += result->visibility[i] * pow(cabs(field[i]), 2.0);
        partial += result->visibility[i] > 0.1f && result->visibility[i] < 0.9f;
    }
    assert_true(partial > 300);
    /* the tolerance is for the noise, 60 dB down, and its interference with the seabed */
    expect_close("energy over V of the input's", out / expected, 1.0, 2e-3);
}

/* ---- two interactions ---- */

/* A second interaction changes measured pixels about Figure 7's capsule, broadside, by the expected
 * energy: the change's mean square is compared with it. A path over seabed and target is never
 * shorter than there and back to the farther of both. So no pixel changes before the target, but
 * for the pulse: six deviations leave exp(-18). */
CLAIM(the_change_is_that_of_the_second_interaction)
{
    double ratios[SEEDS];
    const size_t rows = 240, columns = 320;
    float *field = claim_memory(2 * rows * columns, sizeof *field);
    uint64_t state = 20061;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct sea *sea = sea_open(rows, columns, 50.0);
        for (size_t i = 0; i < rows * columns; i++) { /* circular deviates of unit mean square */
            const double size = sqrt(-log(next_uniform(&state)));
            const double turn = 2.0 * PI * next_uniform(&state);
            field[2 * i] = (float)(size * cos(turn));
            field[2 * i + 1] = (float)(size * sin(turn));
        }
        const struct injected *result[2];
        sonject_object_params *object = sea_add(sea, SHAPE_CAPSULE, 2.3, 0.0, 0.3);
        object->burial_m = 0.1;
        assert_true(material_named("steel", &object->material));
        sea_ready(sea);
        sea->injection->seed = seed + 1;
        sea->injection->order_energies = true;
        for (uint32_t i = 0; i < 2; i++) {
            sea->injection->interactions = i + 1;
            result[i] = sea_inject(sea, field, true);
        }
        const double deviation = 0.601 * SPACING; /* of the pulse */
        const size_t first =
            (size_t)floor(sea_column(sea, sea_slant_range(sea, 0) - 0.15 - 6.0 * deviation));
        double change = 0.0, expected = 0.0;
        size_t kept = 0, shaded = 0;
        for (size_t column = 0; column < columns; column++) {
            double plain = 0.0; /* the seabed's energy in a pixel, from rows of seabed alone */
            for (size_t row = 0; row < rows / 8; row++)
                plain += result[0]->energy[row * columns + column] / ((double)rows / 8.0);
            for (size_t i = column; i < rows * columns; i += columns) {
                const float *one = &result[0]->image[2 * i], *two = &result[1]->image[2 * i];
                const double along = ((double)(i / columns) - 119.5) * SPACING;
                const double across = ((double)column - 159.5) * SPACING;
                kept += !result[1]->influence[i];
                if (!result[1]->influence[i])
                    assert_memory_equal(two, &field[2 * i], 2 * sizeof(float));
                if (column < first)
                    assert_memory_equal(two, one, 2 * sizeof(float));
                if (fabs(along) >= 1.15 || fabs(across) >= 0.5 || !result[0]->influence[i])
                    continue;
                change += pow((double)two[0] - one[0], 2.0) + pow((double)two[1] - one[1], 2.0);
                expected += result[1]->order_energy[1][i] / plain;
                shaded += result[0]->visibility[i] < 0.1f;
            }
        }
        assert_true(kept > rows * columns / 2 && shaded > 300);
        ratios[seed] = change / expected;
    }
    expect_estimate("change over what is expected", estimate_of(ratios, SEEDS), 1.0, 0.0);
}

/* ---- resynthesised ---- */

enum patch_kind {
    PATCH_UNIFORM, /* amplitude 1 */
    PATCH_WHITE,   /* exponential intensities, pixel by pixel */
    PATCH_MEASURED /* a speckle field of the sonar */
};

static float *make_patch(struct sea *sea, enum patch_kind kind, uint64_t seed)
{
    if (kind == PATCH_MEASURED)
        return magnitudes_of(measured_field(sea, seed), PIXELS);
    float *pixels = claim_memory(PIXELS, sizeof *pixels);
    for (size_t i = 0; i < PIXELS; i++)
        pixels[i] = kind == PATCH_UNIFORM ? 1.0f : (float)sqrt(-log(next_uniform(&seed)));
    return pixels;
}

/* Returns the share of a pixel's seabed energy from `column` columns beside: G^2 over the pixel. */
static double column_share(double resolution, int column)
{
    const double deviation = resolution / (2.0 * sqrt(log(2.0))) / sqrt(2.0) / 0.025;
    return 0.5 * (erf((column + 0.5) / deviation / sqrt(2.0)) -
                  erf((column - 0.5) / deviation / sqrt(2.0)));
}

/* Returns the contrast of new speckle on a map. The intensity is the map, smoothed by |W|^2 G^2,
 * times an exponential deviate, so contrast^2 = 1 + 2 v with v the smoothed map's variance. With
 * rows as wide as the resolution, |W|^2 takes its own row alone. v is the sum, over pairs of
 * shares, of the map's correlation: white, or exp(-(lag/s)^2/2) for measured speckle. An unsmoothed
 * map has v = 1 and sqrt(3). */
static double expected_contrast(enum patch_kind kind, double resolution)
{
    const double deviation = resolution / (2.0 * sqrt(log(2.0))) / 0.025;
    double variance = 0.0;
    for (int i = -6; i <= 6; i++)
        for (int j = -6; j <= 6; j++) {
            const double lag = (i - j) / deviation;
            const double correlation =
                kind == PATCH_MEASURED ? exp(-0.5 * lag * lag) : (i == j ? 1.0 : 0.0);
            variance += column_share(resolution, i) * column_share(resolution, j) * correlation;
        }
    return kind == PATCH_UNIFORM ? 1.0 : sqrt(1.0 + 2.0 * variance);
}

/* Four values give a poor scatter, so errors come from the number of independent pixels. It is at
 * least 50,000 in 4 patches of 102,400, with intensities correlated over 1.5 to 3 pixels. Errors
 * are 0.5 % of the level and 1 % of the contrast, whose variance grows with the contrast. A white
 * map at half a pixel's resolution leaves nearly sqrt(3). A despeckled map, a mean over 2 pi 2 4^2
 * pixels, leaves 1/200 of its variance. */
CLAIM(a_map_traced_anew_keeps_level_and_contrast)
{
    static const struct {
        const char *name;
        enum patch_kind kind;
        sonject_seabed_map map;
        double resolution;
    } cases[] = {
        {"uniform", PATCH_UNIFORM, SONJECT_MAP_INTENSITY, 0.025},
        {"white map, resolution of half a pixel", PATCH_WHITE, SONJECT_MAP_INTENSITY, 0.0125},
        {"white map, resolution of a pixel", PATCH_WHITE, SONJECT_MAP_INTENSITY, 0.025},
        {"measured speckle", PATCH_MEASURED, SONJECT_MAP_INTENSITY, 0.025},
        {"despeckled map", PATCH_MEASURED, SONJECT_MAP_DESPECKLED, 0.025},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        double level_db = 0.0, contrast = 0.0;
        const double expected = cases[i].map == SONJECT_MAP_DESPECKLED
                                    ? 1.0
                                    : expected_contrast(cases[i].kind, cases[i].resolution);
        print_message("%s\n", cases[i].name);
        for (uint64_t seed = 0; seed < 4; seed++) {
            struct sea *sea = sea_open(SIDE, SIDE, RANGE);
            sea->injection->mode = SONJECT_MODE_RESYNTHESISE;
            sea->injection->seed = seed + 1;
            sea->seabed->map = cases[i].map;
            sea->sonar->bandwidth_hz = 1500.0 / (2.0 * cases[i].resolution);
            sea_ready(sea);
            const float *pixels = make_patch(sea, cases[i].kind, seed + 40);
            const sonject_statistics statistics = sea_inject(sea, pixels, false)->statistics;
            level_db += statistics.level_change_db / 4.0;
            contrast += statistics.output_contrast / 4.0;
            if (cases[i].kind != PATCH_UNIFORM)
                expect_close("contrast of the input", statistics.input_contrast, 1.0, 0.03);
        }
        expect_close("level change, dB", level_db, 0.0, 4.0 * 0.02);
        expect_close("contrast", contrast, expected, 4.0 * 0.008 * expected);
    }
}

/* A complex patch used as reflectivity comes back as itself, seen through the sonar once more. The
 * level stays, also with few rays, whose energies scatter. The fields' correlation is the one that
 * a second Gaussian leaves in range, sqrt(2 sqrt(2)/3) = 0.971 (along-track the sinc is its own
 * square), and its square for intensities. Interpolating between columns as wide as the resolution
 * costs a little correlation. */
CLAIM(a_coherent_map_comes_back_as_itself)
{
    static const struct {
        double row, column, resolution; /* m; the range resolution is 2.5 cm */
        double rays;                    /* 0: as by default, and from broadside alone */
    } grids[] = {{0.025, 0.025, 0.025, 0.0},   {0.025, 0.0125, 0.05, 0.0},
                 {0.025, 0.0125, 0.0125, 0.0}, {0.02, 0.02, 0.03, 0.0},
                 {0.025, 0.025, 0.025, 1.0},   {0.025, 0.025, 0.025, 0.25}};
    for (size_t i = 0; i < COUNT(grids); i++) {
        struct sea *sea = sea_open(SIDE, SIDE, RANGE);
        sea->geometry->row_spacing_m = grids[i].row;
        sea->geometry->column_spacing_m = grids[i].column;
        sea->sonar->along_track_resolution_m = grids[i].resolution;
        if (grids[i].rays > 0.0) {
            sea->sonar->aperture_rad = -1.0;
            sea->injection->ray_scale = grids[i].rays;
        }
        sea_move(sea, RANGE);
        sea->injection->mode = SONJECT_MODE_RESYNTHESISE;
        sea->seabed->map = SONJECT_MAP_COHERENT;
        const float *field = pairs_of(measured_field(sea, 9), PIXELS);
        const struct injected *result = sea_inject(sea, field, true);
        double ab = 0.0, aa = 0.0, bb = 0.0;
        for (size_t k = 0; k < 2 * PIXELS; k++) {
            ab += (double)field[k] * result->image[k];
            aa += (double)field[k] * field[k];
            bb += (double)result->image[k] * result->image[k];
        }
        print_message("pixels of %.4f x %.4f m, resolution %.4f m along-track, rays %g\n",
                      grids[i].row, grids[i].column, grids[i].resolution, grids[i].rays);
        expect_close("correlation of the fields", ab / sqrt(aa * bb), 0.971, 0.03);
        expect_close("correlation of the intensities", result->statistics.correlation, 0.943, 0.05);
        expect_close("level change, dB", result->statistics.level_change_db, 0.0, 0.1);
        expect_close("contrast", result->statistics.output_contrast, 1.0, 0.05);
    }
}

/* ---- matched to the image ---- */

#define DEEP 5e-3f /* largest visibility in the deep shadow */

/* Returns amplitudes of a speckle field: a mean over looks, of an along-track resolution. */
static float *measured_amplitudes(struct sea *sea, int looks, double resolution_m)
{
    float *amplitude = claim_memory(PIXELS, sizeof *amplitude);
    sea_ready(sea);
    sea->bench->tracer.response.resolution_m = resolution_m;
    for (int look = 0; look < looks; look++) {
        const double complex *field = sea_noise(sea, (enum noise)(NOISE_MEASURED + look));
        for (size_t i = 0; i < PIXELS; i++)
            amplitude[i] += (float)(pow(cabs(field[i]), 2.0) / looks);
    }
    for (size_t i = 0; i < PIXELS; i++)
        amplitude[i] = sqrtf(amplitude[i]);
    return amplitude;
}

/* Speckle in the shadow, of some 9000 pixels, is the image's, of one look or three and as coarse:
 * contrast of the amplitudes, correlation of intensities from row to row. The shadow has some count
 * / (2.5 pixels of speckle) independent values, which know contrast to 0.6 / root and correlation
 * to 1.5 / root. The image's own widths are known to 5 %, its looks to 6 % and -2 %. */
CLAIM(speckle_in_shadows_is_the_images)
{
    static const double amplitude_contrast[] = {0.0, 0.5227, 0.0, 0.2940};
    for (int looks = 1; looks <= 3; looks += 2) {
        double n = 0.0, sum = 0.0, squares = 0.0, pairs = 0.0, product = 0.0, fourth = 0.0;
        struct sea *sea = sea_open(SIDE, SIDE, RANGE);
        add_plate(sea, 4.5, 2.4);
        set_noise(sea, -20.0);
        const float *pixels = measured_amplitudes(sea, looks, 1.6 * SPACING);
        const double expected =
            along_track_speckle_correlation(&sea->bench->tracer.response, SPACING); /* 0.22 */
        const struct injected *result = sea_inject(sea, pixels, false);
        for (size_t i = 0; i < PIXELS; i++) {
            const double value = result->visibility[i] < DEEP ? (double)result->image[i] : 0.0;
            n += result->visibility[i] < DEEP;
            sum += value;
            squares += value * value;
            fourth += value * value * value * value;
        }
        const double mean = squares / n, root = sqrt(n / 2.5);
        for (size_t i = 0; i + SIDE < PIXELS; i++) {
            if (!(result->visibility[i] < DEEP) || !(result->visibility[i + SIDE] < DEEP))
                continue;
            product +=
                (pow(result->image[i], 2.0) - mean) * (pow(result->image[i + SIDE], 2.0) - mean);
            pairs += 1.0;
        }
        const double contrast = sqrt(squares * n / (sum * sum) - 1.0);
        assert_true(n > 6000.0);
        expect_close("resolution", result->statistics.along_track_resolution_m, 1.6 * SPACING,
                     0.08 * SPACING);
        expect_close("looks", result->statistics.looks, looks, looks == 1 ? 0.0 : 0.06 * looks * 4);
        expect_close("contrast", contrast, amplitude_contrast[looks], 4.0 * 0.6 / root * contrast);
        expect_close("correlation", product / pairs / (fourth / n - mean * mean), expected,
                     4.0 * 1.5 / root);
    }
}

/* An image of the sonar's own response keeps it to the bit. One told to be nominal does, too. */
CLAIM(a_nominal_response_is_left_alone)
{
    for (int is_told = 0; is_told < 2; is_told++) {
        struct sea *sea = sea_open(SIDE, SIDE, RANGE);
        add_plate(sea, 4.5, 2.4);
        set_noise(sea, -20.0);
        if (is_told) {
            sea->injection->match_response = SONJECT_MATCH_NOMINAL;
            sea->injection->match_looks = 1.0;
        }
        const float *pixels = measured_amplitudes(sea, is_told ? 3 : 1, is_told ? 0.05 : SPACING);
        const sonject_statistics statistics = sea_inject(sea, pixels, false)->statistics;
        assert_true(statistics.along_track_resolution_m == SPACING);
        assert_true(statistics.looks == 1.0);
        assert_true(isinf(statistics.saturation_amplitude));
    }
}

/* Highlights saturate at the image's largest value, or with full_scale go beyond it. */
CLAIM(highlights_saturate_where_the_image_does)
{
    for (uint32_t is_cut = 0; is_cut < 2; is_cut++) {
        struct sea *sea = sea_open(SIDE, SIDE, RANGE);
        float largest = 0.0f;
        sea->injection->match_saturation = is_cut;
        sea_add_sphere(sea, 0.3, 0.0);
        float *pixels = measured_amplitudes(sea, 1, SPACING);
        for (size_t i = 0; i < PIXELS; i++)
            pixels[i] = fminf(pixels[i], 2.0f); /* cuts two in a hundred pixels */
        const struct injected *result = sea_inject(sea, pixels, false);
        for (size_t i = 0; i < PIXELS; i++)
            largest = fmaxf(largest, result->image[i]);
        assert_true(is_cut ? largest == 2.0f : largest > 20.0f);
    }
}

/* Returns the largest energy of some rows, dB. */
static double peak_of(const struct injected *result, size_t first_row, size_t end_row)
{
    double peak = 0.0;
    for (size_t i = first_row * SIDE; i < end_row * SIDE; i++)
        peak = fmax(peak, (double)result->energy[i]);
    return decibels_of_energy(peak);
}

/* One sphere is scaled to a target strength, one to a level over the seabed, a third is not. */
CLAIM(levels_are_those_asked_for)
{
    struct sea *sea = sea_open(SIDE, SIDE, RANGE);
    for (int i = 0; i < 3; i++) {
        sonject_object_params *ball = sea_add_sphere(sea, 0.2, 0.0);
        place_in_pixels(ball, 60.0 + 100.0 * i, 130.0 + 20.0 * i);
        ball->material.lambert = 0.1;
    }
    const float *pixels = measured_amplitudes(sea, 1, SPACING);
    const struct injected *before = sea_inject(sea, pixels, false);
    sea_object(sea, 0)->level_kind = SONJECT_LEVEL_TARGET_STRENGTH;
    sea_object(sea, 0)->level_db = -30.0;
    sea_object(sea, 1)->level_kind = SONJECT_LEVEL_OVER_SEABED;
    sea_object(sea, 1)->level_db = 18.0;
    const struct injected *after = sea_inject(sea, pixels, false);
    expect_close("target strength", after->objects[0].target_strength_db, -30.0, 1e-4);
    expect_close("over the seabed", after->objects[1].over_seabed_db, 18.0, 1e-4);
    for (uint32_t i = 0; i < 3; i++) {
        const sonject_object_truth *truth = &after->objects[i], *was = &before->objects[i];
        const size_t first = 20 + 100 * (size_t)i;
        expect_close("gain", truth->level_gain_db, truth->over_seabed_db - was->over_seabed_db,
                     1e-4);
        expect_close("target strength moves with the gain", truth->target_strength_db,
                     was->target_strength_db + truth->level_gain_db, 1e-4);
        assert_int_equal(truth->level_kind, sea_object(sea, i)->level_kind);
        /* the seabed that is left adds a hundredth at 18 dB over it */
        expect_close("energy layer",
                     peak_of(after, first, first + 80) - peak_of(before, first, first + 80),
                     truth->level_gain_db, 0.1);
    }
    assert_true(after->objects[2].level_gain_db == 0.0);
    assert_true(before->objects[0].level_gain_db == 0.0);
}

/* The looks' weights have the sum 1 and the sum of squares 1 / looks. None is negative. */
CLAIM(weights_of_looks_make_up_one)
{
    for (double looks = 1.0; looks <= 64.0; looks += 0.37) {
        double weight, last;
        const double others = (double)look_weights(looks, &weight, &last) - 1.0;
        assert_true(weight >= 0.0 && last >= -1e-12 && others < looks);
        assert_true(fabs(others * weight + last - 1.0) < 1e-12);
        assert_true(fabs((others * weight * weight + last * last) * looks - 1.0) < 1e-12);
    }
}

/* ---- the water column ---- */

#define FIRST_ROWS    48
#define FIRST_COLUMNS 241
#define FIRST_RANGE   10.6 /* of the middle: 7.6 m to 13.6 m, from 10 m over the seabed */

/* Beside a dark water column an even seabed has its own level up to the first return. A patch that
 * is resynthesised keeps the column's pixels. */
CLAIM(the_water_column_keeps_its_pixels)
{
    const size_t water = 97; /* 7.6 m + 96 * 2.5 cm is 10 m */
    struct sea *sea = sea_open(FIRST_ROWS, FIRST_COLUMNS, FIRST_RANGE);
    float *pixels = claim_memory(sea->pixels, sizeof *pixels);
    double seabed = 0.0;
    sea->injection->mode = SONJECT_MODE_RESYNTHESISE;
    sea_ready(sea);
    for (size_t i = 0; i < sea->pixels; i++)
        pixels[i] = i % FIRST_COLUMNS < water ? 0.01f : 1.0f;
    const struct patch_level *level = sea_level(sea, pixels, false);
    const struct injected *result = sea_inject(sea, pixels, false);
    for (size_t i = 0; i < sea->pixels; i++) {
        assert_true(fabsf(level->level[i] - 1.0f) < 1e-4f); /* sums in single precision */
        assert_true(i % FIRST_COLUMNS >= water || result->image[i] == pixels[i]);
        if (i % FIRST_COLUMNS >= water + 20)
            seabed += result->image[i] * result->image[i];
    }
    /* speckle on 48 x 124 pixels, 2.5 cm apart along the track and at half of that in range */
    expect_close("mean intensity of the seabed",
                 seabed / (FIRST_ROWS * (double)(FIRST_COLUMNS - water - 20)), 1.0, 0.1);
}

static sonject_status set_up(struct sea *sea)
{
    struct injection_setup setup;
    const struct injection_input input = {.rows = sea->rows, .columns = sea->columns};
    const sonject_status status =
        injection_setup_init_scene(&setup, &sea->bench->report, NULL, &sea->bench->scene, &input);
    injection_setup_clear(&setup);
    return status;
}

/* A patch is refused if it holds nothing but water, has layers, whose rays would start straight
 * down, or has a target before the bottom. */
CLAIM(what_lies_before_the_bottom_is_refused)
{
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.0}, {3.0, 1530.0, 1.0}};
    struct sea *sea = sea_open(FIRST_ROWS, FIRST_COLUMNS, 6.0);
    EXPECT_REFUSED(sea, "lies in the water column, before the bottom's first return at",
                   set_up(sea));
    sea_move(sea, FIRST_RANGE);
    sea_set_layers(sea, layers, 2);
    EXPECT_REFUSED(sea,
                   "which is not possible where layers bend the sound: begin the patch at column",
                   set_up(sea));
    sea_set_layers(sea, NULL, 0);
    place_in_pixels(sea_add_sphere(sea, 0.2, 0.0), 20.0, 90.0);
    EXPECT_REFUSED(sea, "lies in the water column", set_up(sea));
}
