/* A synthetic seabed, row by row: circular Gaussian speckle with the sonar's point response, times
 * the square root of the local intensity, which is the product of sediment, ripples and the Gamma
 * texture of K-distributed speckle. Every number comes from a counter and + - * / and square roots
 * in a fixed order: the bits are the same wherever float and double are IEEE types that are
 * neither contracted nor held in wider registers, as this library is built. */
#include "image/synthetic.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/random_field.h"
#include "image/ripples.h"
#include "image/speckle_texture.h"
#include "kernels/elementary.h"

/* Streams of random numbers, none of which the tracer uses: a seabed and an injection may have the
 * same seed and yet must not share numbers. */
enum stream {
    STREAM_SEABED = 0x5eabed00,
    STREAM_TEXTURE,
    STREAM_PATCHES = STREAM_SEABED + 16, /* + octave */
    STREAM_RIPPLES = STREAM_SEABED + 32
};

/* Patches are where a field is above 0. A finer octave roughens the borders, and the narrow range
 * over which the level steps is sharp where the field is steep and soft where it is flat. */
#define OCTAVES      5
#define OCTAVE_GAIN  0.55f
#define BORDER_WIDTH 0.22f /* of the sediments, in deviations of the first octave */
/* Ripples die away more gently, and along a smoother line. */
#define RIPPLE_OCTAVES 2
#define FADING_WIDTH   0.8f
/* Mean distance between the zeros of a field with autocorrelation exp(-x^2 / 4 width^2). */
#define CHORD_PER_WIDTH 4.44288293815836624702 /* sqrt(2) pi */

/* How much of the field that ripples depend on is that of the sediment: they like one sort. */
#define RIPPLES_FOLLOW_SEDIMENT 0.6f

struct seabed {
    const sonject_synthetic_params *synthetic;
    struct random_field *speckle, *texture_deviates, *octaves[OCTAVES];
    struct ripples *ripples;
    struct speckle_texture texture;
    bool has_texture, has_patches;
    float bright_excess;        /* intensity of the brighter sediment over the darker one's, - 1 */
    float *sediment, *presence; /* one row of fields, then of what they mean */
    float *intensity;
};

/* A step from 0 to 1 around field = 0, without corners. */
static float step_of(float field, float width)
{
    const float t = fminf(fmaxf(0.5f + field / width, 0.0f), 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

/* A Gaussian blur whose deviation is `width` metres. */
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
    const bool has_ripples = synthetic->ripple_contrast > 0.0;
    sonject_status status = SONJECT_OK;
    seabed->has_texture = isfinite(synthetic->speckle_shape);
    seabed->has_patches = synthetic->patch_contrast_db > 0.0;
    if (seabed->has_texture) {
        speckle_texture_init(&seabed->texture, synthetic->speckle_shape);
        status = create_field(report, seabed, geometry, STREAM_TEXTURE,
                              0.5 * synthetic->texture_length_m, &seabed->texture_deviates);
    }
    if (status == SONJECT_OK && has_ripples)
        status = ripples_create(report, synthetic, geometry, STREAM_RIPPLES, &seabed->ripples);
    if (status == SONJECT_OK && (has_ripples || seabed->has_patches))
        status = create_patches(report, seabed, geometry);
    seabed->sediment = allocate_array(synthetic->columns, sizeof(float));
    seabed->presence = allocate_array(synthetic->columns, sizeof(float));
    seabed->intensity = allocate_array(synthetic->columns, sizeof(float));
    if (status == SONJECT_OK && !(seabed->sediment && seabed->presence && seabed->intensity))
        status = report_out_of_memory(report, "the synthetic seabed");
    return status;
}

static void release_parts(struct seabed *seabed)
{
    random_field_release(&seabed->speckle);
    random_field_release(&seabed->texture_deviates);
    for (int i = 0; i < OCTAVES; i++)
        random_field_release(&seabed->octaves[i]);
    ripples_release(&seabed->ripples);
    free(seabed->sediment);
    free(seabed->presence);
    free(seabed->intensity);
}

/* The next row of the fields that say where the sediments and the ripples are. */
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
    if (seabed->ripples)
        ripples_modulate_next_row(seabed->ripples, seabed->presence, seabed->intensity);
}

static void next_row(struct seabed *seabed, float *pixels)
{
    const uint32_t columns = seabed->synthetic->columns;
    /* the speckle's two parts have variance 1 each */
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
