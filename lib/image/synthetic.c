/* A synthetic seabed, row by row: circular Gaussian speckle with the sonar's point response, times
 * the square root of the local intensity. The intensity is the product of sediment, ripples and the
 * Gamma texture of K-distributed speckle. Every number comes from a counter and from + - * / and
 * square roots in a fixed order. The bits are the same wherever float and double are IEEE types,
 * neither contracted nor held in wider registers, as this library is built. */
#include "image/synthetic.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/random_field.h"
#include "kernels/elementary.h"

/* Sand ripples: crests that wander, fork and end, and faces that scatter differently. */

#define PI             3.14159265358979323846
#define PROFILE_PHASES 256

/* The wander is relative to the regular train of crests. Where the two cancel, a crest forks.
 * Lengths are deviations of the blur in wavelengths. */
#define WANDERS 2
static const double wander_lengths[WANDERS] = {1.5, 0.5};
static const float wander_strengths[WANDERS] = {1.1f, 0.25f};

#define FULL_STRENGTH 0.6f /* relative height from which a crest has its full contrast */

/* The face towards the sonar is steeper than the back. Slopes saturate at the angle of repose. */
#define SECOND_HARMONIC_COSINE 0.30f
#define SECOND_HARMONIC_SINE   0.10f
#define SATURATION             0.20f

#define SHADOW_FLOOR 0.003f /* -25 dB: no face of a measured ripple is empty */

struct ripples {
    struct random_field *wanders[WANDERS];
    float contrast;
    float profile_mean, profile_scale, profile_square; /* facing()'s, see measure_profile */
    double row_cycles, column_cycles;                  /* phase from pixel to pixel */
    uint32_t columns, next_row;
    float *carrier[2]; /* cosine and sine of each column's phase; borrowed */
};

/* Returns the slope towards the sonar, of either sign. cosine, sine: of the phase. */
static float slope_towards_sonar(float cosine, float sine)
{
    const float double_sine = 2.0f * sine * cosine;
    const float double_cosine = cosine * cosine - sine * sine;
    const float slope =
        sine - 0.25f - SECOND_HARMONIC_COSINE * double_cosine + SECOND_HARMONIC_SINE * double_sine;
    return slope / sqrtf(SATURATION + slope * slope);
}

/* Returns the slope scaled to mean 0 and lowest value -1, which full contrast turns dark. */
static float facing(const struct ripples *ripples, float cosine, float sine)
{
    return (slope_towards_sonar(cosine, sine) - ripples->profile_mean) * ripples->profile_scale;
}

static void measure_profile(struct ripples *ripples)
{
    float sum = 0.0f;
    float squares = 0.0f;
    float lowest = 0.0f;
    for (int i = 0; i < PROFILE_PHASES; i++) {
        float sine, cosine;
        sine_cosine_of_cycles((float)i / PROFILE_PHASES, &sine, &cosine);
        const float slope = slope_towards_sonar(cosine, sine);
        sum += slope;
        squares += slope * slope;
        lowest = fminf(lowest, slope);
    }
    ripples->profile_mean = sum / PROFILE_PHASES;
    ripples->profile_scale = 1.0f / (ripples->profile_mean - lowest);
    ripples->profile_square =
        (squares / PROFILE_PHASES - ripples->profile_mean * ripples->profile_mean) *
        ripples->profile_scale * ripples->profile_scale;
}

/* Sets the phase's direction. The sonar looks towards growing range, so the phase must not fall
 * with range. Crests of the opposite heading are the same crests. */
static void set_direction(struct ripples *ripples, const sonject_synthetic_params *synthetic,
                          const sonject_geometry_params *geometry)
{
    float sine, cosine;
    const double turns = fmod(synthetic->ripple_heading_rad, 2.0 * PI) / (2.0 * PI);
    sine_cosine_of_cycles((float)turns, &sine, &cosine);
    const double sign = sine < 0.0f ? -1.0 : 1.0;
    ripples->row_cycles =
        sign * (double)cosine * geometry->row_spacing_m / synthetic->ripple_wavelength_m;
    ripples->column_cycles =
        sign * (double)sine * geometry->column_spacing_m / synthetic->ripple_wavelength_m;
}

static void phase_of(double cycles, float *cosine, float *sine)
{
    sine_cosine_of_cycles((float)(cycles - floor(cycles)), sine, cosine);
}

/* Sets up the ripples. carriers: two rows. Uses streams from `stream` on. Errors: MEMORY. */
static sonject_status ripples_init(struct ripples *ripples, struct report *report,
                                   const sonject_synthetic_params *synthetic,
                                   const sonject_geometry_params *geometry, uint32_t stream,
                                   float *carriers)
{
    ripples->columns = synthetic->columns;
    ripples->contrast = (float)synthetic->ripple_contrast;
    ripples->carrier[0] = carriers;
    ripples->carrier[1] = carriers + ripples->columns;
    measure_profile(ripples);
    set_direction(ripples, synthetic, geometry);
    for (uint32_t i = 0; i < WANDERS; i++) {
        const double length = wander_lengths[i] * synthetic->ripple_wavelength_m;
        const struct blur along_track = {BLUR_GAUSSIAN, length / geometry->row_spacing_m};
        const struct blur range = {BLUR_GAUSSIAN, length / geometry->column_spacing_m};
        CHECK(random_field_create(report, synthetic->seed, stream + i, ripples->columns,
                                  along_track, range, &ripples->wanders[i]));
    }
    for (uint32_t column = 0; column < ripples->columns; column++)
        phase_of(ripples->column_cycles * column, &ripples->carrier[0][column],
                 &ripples->carrier[1][column]);
    return SONJECT_OK;
}

/* Multiplies the next row of intensities by the ripples' modulation. Its mean is 1 at any presence
 * (0...1 for each column: the share of the full contrast that ripples have there). */
static void ripples_modulate_next_row(struct ripples *ripples, const float *presence,
                                      float *intensity)
{
    const float *wander_cosine[WANDERS];
    const float *wander_sine[WANDERS];
    float row_cosine, row_sine;
    for (int i = 0; i < WANDERS; i++)
        random_field_next_row(ripples->wanders[i], &wander_cosine[i], &wander_sine[i]);
    phase_of(ripples->row_cycles * ripples->next_row++, &row_cosine, &row_sine);
    for (uint32_t i = 0; i < ripples->columns; i++) {
        const float column_cosine = ripples->carrier[0][i];
        const float column_sine = ripples->carrier[1][i];
        const float train_cosine = row_cosine * column_cosine - row_sine * column_sine;
        const float train_sine = row_cosine * column_sine + row_sine * column_cosine;
        float x = 1.0f;
        float y = 0.0f;
        for (int j = 0; j < WANDERS; j++) {
            x += wander_strengths[j] * wander_cosine[j][i];
            y += wander_strengths[j] * wander_sine[j][i];
        }
        const float height = sqrtf(x * x + y * y) + 1e-20f;
        const float cosine = (train_cosine * x - train_sine * y) / height;
        const float sine = (train_cosine * y + train_sine * x) / height;
        const float strength = fminf(1.0f, height / FULL_STRENGTH);
        const float contrast = ripples->contrast * presence[i] * strength;
        const float amplitude = 1.0f + contrast * facing(ripples, cosine, sine);
        const float mean = 1.0f + contrast * contrast * ripples->profile_square;
        intensity[i] *= SHADOW_FLOOR + (1.0f - SHADOW_FLOOR) * amplitude * amplitude / mean;
    }
}

/* The streams of random numbers. The tracer uses none of them: a seabed and an injection may have
 * the same seed and yet must not share numbers. */
enum stream {
    STREAM_SEABED = 0x5eabed00,
    STREAM_TEXTURE,
    STREAM_PATCHES = STREAM_SEABED + 16, /* + octave */
    STREAM_RIPPLES = STREAM_SEABED + 32
};

/* Patches lie where a field is above 0. Finer octaves roughen the borders. The level steps over a
 * narrow range of the field: borders are sharp where the field is steep and soft where it is
 * flat. */
#define OCTAVES      5
#define OCTAVE_GAIN  0.55f
#define BORDER_WIDTH 0.22f /* the sediments', in deviations of the first octave */
/* Ripples fade more gently, and along a smoother line. */
#define RIPPLE_OCTAVES 2
#define FADING_WIDTH   0.8f
/* The mean distance between zeros of a field with autocorrelation exp(-x^2 / 4 width^2). */
#define CHORD_PER_WIDTH 4.44288293815836624702 /* sqrt(2) pi */

/* The weight of the sediment's field in that of the ripples, which prefer one sediment. */
#define RIPPLES_FOLLOW_SEDIMENT 0.6f

struct seabed {
    const sonject_synthetic_params *synthetic;
    struct random_field *speckle, *texture_deviates, *octaves[OCTAVES];
    struct ripples ripples;
    struct speckle_texture texture;
    bool has_texture, has_patches, has_ripples;
    float bright_excess;        /* intensity of the brighter sediment over the darker, minus 1 */
    float *sediment, *presence; /* one row of fields, then of levels and presence */
    float *intensity;
    float *rows; /* memory of these and of the ripples' carriers; owned */
};

/* Returns a step from 0 to 1 around field = 0, without corners. */
static float step_of(float field, float width)
{
    const float t = fminf(fmaxf(0.5f + field / width, 0.0f), 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

/* Creates a field by a Gaussian blur whose deviation is `width` metres. */
static sonject_status create_field(struct report *report, const struct seabed *seabed,
                                   const sonject_geometry_params *geometry, uint32_t stream,
                                   double width, struct random_field **field)
{
    const struct blur along_track = {BLUR_GAUSSIAN, width / geometry->row_spacing_m};
    const struct blur range = {BLUR_GAUSSIAN, width / geometry->column_spacing_m};
    return random_field_create(report, seabed->synthetic->seed, stream, seabed->synthetic->columns,
                               along_track, range, field);
}

static sonject_status create_patches(struct report *report, struct seabed *seabed,
                                     const sonject_geometry_params *geometry)
{
    double width = seabed->synthetic->patch_length_m / CHORD_PER_WIDTH;
    for (uint32_t i = 0; i < OCTAVES; i++, width *= 0.5) {
        CHECK(
            create_field(report, seabed, geometry, STREAM_PATCHES + i, width, &seabed->octaves[i]));
    }
    const float decibels_to_nepers = 0.11512925f; /* ln 10 / 20 */
    const float dark =
        exponential_of_negative(-decibels_to_nepers * (float)seabed->synthetic->patch_contrast_db);
    seabed->bright_excess = 1.0f / (dark * dark) - 1.0f;
    return SONJECT_OK;
}

static sonject_status create_speckle(struct report *report, struct seabed *seabed,
                                     const sonject_geometry_params *geometry,
                                     double along_track_resolution_m, double range_resolution_m)
{
    const double sqrt_ln_2 = 0.83255461115769775635;
    const struct blur along_track = {BLUR_BAND_LIMITED,
                                     along_track_resolution_m / geometry->row_spacing_m};
    const struct blur range = {BLUR_GAUSSIAN,
                               range_resolution_m / (2.0 * sqrt_ln_2) / geometry->column_spacing_m};
    return random_field_create(report, seabed->synthetic->seed, STREAM_SEABED,
                               seabed->synthetic->columns, along_track, range, &seabed->speckle);
}

static sonject_status create_parts(struct report *report, struct seabed *seabed,
                                   const sonject_geometry_params *geometry)
{
    const sonject_synthetic_params *synthetic = seabed->synthetic;
    const size_t columns = synthetic->columns;
    seabed->has_texture = isfinite(synthetic->speckle_shape);
    seabed->has_patches = synthetic->patch_contrast_db > 0.0;
    seabed->has_ripples = synthetic->ripple_contrast > 0.0;
    seabed->rows = allocate_array(columns, 5 * sizeof *seabed->rows);
    CHECK_MEMORY(report, seabed->rows, "the synthetic seabed");
    seabed->sediment = seabed->rows + 2 * columns;
    seabed->presence = seabed->sediment + columns;
    seabed->intensity = seabed->presence + columns;
    if (seabed->has_texture) {
        speckle_texture_init(&seabed->texture, synthetic->speckle_shape);
        CHECK(create_field(report, seabed, geometry, STREAM_TEXTURE,
                           0.5 * synthetic->texture_length_m, &seabed->texture_deviates));
    }
    if (seabed->has_ripples)
        CHECK(ripples_init(&seabed->ripples, report, synthetic, geometry, STREAM_RIPPLES,
                           seabed->rows));
    return seabed->has_ripples || seabed->has_patches ? create_patches(report, seabed, geometry)
                                                      : SONJECT_OK;
}

static void release_parts(struct seabed *seabed)
{
    random_field_release(&seabed->speckle);
    random_field_release(&seabed->texture_deviates);
    for (int i = 0; i < OCTAVES; i++)
        random_field_release(&seabed->octaves[i]);
    for (int i = 0; i < WANDERS; i++)
        random_field_release(&seabed->ripples.wanders[i]);
    free(seabed->rows);
}

/* Makes the next row of the fields that place the sediments and the ripples. */
static void next_patches(struct seabed *seabed)
{
    const uint32_t columns = seabed->synthetic->columns;
    const float follow = seabed->has_patches ? RIPPLES_FOLLOW_SEDIMENT : 0.0f;
    const float rest = sqrtf(1.0f - follow * follow);
    float gain = 1.0f;
    memset(seabed->sediment, 0, columns * sizeof(float));
    memset(seabed->presence, 0, columns * sizeof(float));
    for (int i = 0; i < OCTAVES; i++, gain *= OCTAVE_GAIN) {
        const float *first;
        const float *second;
        random_field_next_row(seabed->octaves[i], &first, &second);
        for (uint32_t column = 0; column < columns; column++)
            seabed->sediment[column] += gain * first[column];
        for (uint32_t column = 0; i < RIPPLE_OCTAVES && column < columns; column++)
            seabed->presence[column] += gain * (follow * first[column] + rest * second[column]);
    }
    for (uint32_t column = 0; column < columns; column++) {
        seabed->sediment[column] = step_of(seabed->sediment[column], BORDER_WIDTH);
        seabed->presence[column] = step_of(seabed->presence[column], FADING_WIDTH);
    }
}

static void next_intensities(struct seabed *seabed)
{
    const uint32_t columns = seabed->synthetic->columns;
    for (uint32_t column = 0; column < columns; column++)
        seabed->intensity[column] = 1.0f;
    if (seabed->octaves[0])
        next_patches(seabed);
    if (seabed->has_patches)
        for (uint32_t column = 0; column < columns; column++)
            seabed->intensity[column] += seabed->sediment[column] * seabed->bright_excess;
    if (seabed->has_ripples)
        ripples_modulate_next_row(&seabed->ripples, seabed->presence, seabed->intensity);
}

static void next_row(struct seabed *seabed, float *pixels)
{
    const uint32_t columns = seabed->synthetic->columns;
    /* The speckle's two parts have variance 1 each. */
    const float level = 0.70710678f * (float)seabed->synthetic->mean_amplitude;
    const float *real_part;
    const float *imaginary_part;
    const float *deviates = NULL;
    const float *unused;
    random_field_next_row(seabed->speckle, &real_part, &imaginary_part);
    if (seabed->has_texture)
        random_field_next_row(seabed->texture_deviates, &deviates, &unused);
    next_intensities(seabed);
    for (uint32_t column = 0; column < columns; column++) {
        float amplitude = level * sqrtf(seabed->intensity[column]);
        if (deviates)
            amplitude *= speckle_texture_amplitude(&seabed->texture, deviates[column]);
        const float x = amplitude * real_part[column];
        const float y = amplitude * imaginary_part[column];
        if (seabed->synthetic->complex_pixels) {
            pixels[2 * (size_t)column] = x;
            pixels[2 * (size_t)column + 1] = y;
        } else {
            pixels[column] = sqrtf(x * x + y * y);
        }
    }
}

sonject_status synthesise_seabed(struct report *report, const sonject_synthetic_params *synthetic,
                                 const sonject_geometry_params *geometry,
                                 double along_track_resolution_m, double range_resolution_m,
                                 float *pixels)
{
    struct seabed *seabed = allocate_array(1, sizeof *seabed);
    CHECK_MEMORY(report, seabed, "the synthetic seabed");
    seabed->synthetic = synthetic;
    const size_t row_length = (size_t)synthetic->columns * (synthetic->complex_pixels ? 2 : 1);
    sonject_status status = create_parts(report, seabed, geometry);
    THEN(status,
         create_speckle(report, seabed, geometry, along_track_resolution_m, range_resolution_m));
    for (size_t row = 0; status == SONJECT_OK && row < synthetic->rows; row++)
        next_row(seabed, pixels + row * row_length);
    release_parts(seabed);
    free(seabed);
    return status;
}
