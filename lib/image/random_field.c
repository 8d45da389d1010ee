#include "image/random_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "kernels/elementary.h"
#include "kernels/random.h"

#define GAUSSIAN_TAPS     8 /* lattice points one width apart, out to 4 widths */
#define BAND_LIMITED_TAPS 32
#define TAPS_MAX          32

/* A sinc needs lattice points at most one width apart. Cutting it off narrows the band; narrowing
 * the sinc makes up for that and keeps the autocorrelation within 0.005 of a sinc. */
#define BAND_LIMITED_STEP      0.8
#define BAND_LIMITED_NARROWING 1.015f

/* The lattice along one axis. Pixel i lies at i / step, and its taps begin at floor(i / step). */
struct axis {
    enum blur_kind kind;
    double step; /* pixels */
    uint32_t taps;
};

struct random_field {
    uint64_t seed;
    uint32_t stream, columns;
    struct axis along_track, range;
    size_t lattice_columns;
    float *memory;        /* memory of all members below but range_first; owned */
    float *range_weights; /* columns x range taps */
    float *noise[2];      /* one row of the lattice */
    float *blurred[2]; /* the last lattice rows, blurred in range; one for each along-track tap */
    float *row[2];
    uint32_t *range_first; /* lattice column of each pixel's first tap; owned */
    uint32_t next_lattice_row, next_row;
};

static struct axis axis_of(struct blur blur)
{
    const bool is_gaussian = blur.kind == BLUR_GAUSSIAN;
    const double smallest = is_gaussian ? BLUR_SMALLEST_GAUSSIAN : BLUR_SMALLEST_BAND_LIMITED;
    const struct axis axis = {blur.kind,
                              fmax(blur.width, smallest) * (is_gaussian ? 1.0 : BAND_LIMITED_STEP),
                              is_gaussian ? GAUSSIAN_TAPS : BAND_LIMITED_TAPS};
    return axis;
}

/* Returns the weight of a lattice point `distance` steps away. */
static float weight_of(enum blur_kind kind, float distance)
{
    if (kind == BLUR_GAUSSIAN)
        return exponential_of_negative(-0.5f * distance * distance);
    const float half_cycles_per_step = 0.5f * (float)BAND_LIMITED_STEP * BAND_LIMITED_NARROWING;
    const float x = distance / (0.5f * BAND_LIMITED_TAPS);
    return sinc_of_cycles(half_cycles_per_step * distance) * (1.0f - x * x * x * x);
}

/* Fills the weights of a pixel's taps. Their energy is 1, so every pixel has variance 1 exactly.
 * Returns the first tap's lattice index. */
static uint32_t weigh_taps(const struct axis *axis, uint32_t pixel, float *weights)
{
    const double position = (double)pixel / axis->step;
    const double whole_position = floor(position);
    const float offset = (float)(position - whole_position);
    float energy = 0.0f;
    for (uint32_t tap = 0; tap < axis->taps; tap++) {
        weights[tap] = weight_of(axis->kind, offset + (float)(axis->taps / 2 - 1) - (float)tap);
        energy += weights[tap] * weights[tap];
    }
    const float scale = 1.0f / sqrtf(energy);
    for (uint32_t tap = 0; tap < axis->taps; tap++)
        weights[tap] *= scale;
    return (uint32_t)whole_position;
}

/* Returns false where memory is out. */
static bool allocate_buffers(struct random_field *field)
{
    const size_t columns = field->columns;
    const size_t lines = field->along_track.taps;
    const size_t weights = columns * field->range.taps;
    field->range_first = allocate_array(columns, sizeof *field->range_first);
    field->memory = allocate_array(
        weights + 2 * (field->lattice_columns + columns * lines + columns), sizeof(float));
    if (!field->range_first || !field->memory)
        return false;
    field->range_weights = field->memory;
    float *next = field->memory + weights;
    for (int part = 0; part < 2; part++) {
        field->noise[part] = next;
        field->blurred[part] = field->noise[part] + field->lattice_columns;
        field->row[part] = field->blurred[part] + columns * lines;
        next = field->row[part] + columns;
    }
    return true;
}

sonject_status random_field_create(struct report *report, uint64_t seed, uint32_t stream,
                                   uint32_t columns, struct blur along_track, struct blur range,
                                   struct random_field **field)
{
    *field = NULL;
    struct random_field *made = allocate_array(1, sizeof *made);
    CHECK_MEMORY(report, made, "a random field");
    made->seed = seed;
    made->stream = stream;
    made->columns = columns;
    made->along_track = axis_of(along_track);
    made->range = axis_of(range);
    made->lattice_columns = (size_t)((double)columns / made->range.step) + made->range.taps + 1;
    if (!allocate_buffers(made)) {
        random_field_release(&made);
        return report_out_of_memory(report, "a random field");
    }
    for (uint32_t column = 0; column < columns; column++)
        made->range_first[column] = weigh_taps(
            &made->range, column, made->range_weights + (size_t)column * made->range.taps);
    *field = made;
    return SONJECT_OK;
}

void random_field_release(struct random_field **field)
{
    if (!*field)
        return;
    free((*field)->memory);
    free((*field)->range_first);
    free(*field);
    *field = NULL;
}

/* Makes white noise by Box and Muller's method. */
static void make_noise(struct random_field *field, uint32_t lattice_row)
{
    const struct random_key key = random_key_of(
        (uint32_t)field->seed, (uint32_t)(field->seed >> 32), field->stream, lattice_row);
    for (size_t i = 0; i < field->lattice_columns; i++) {
        float uniform, cycles, sine, cosine;
        two_uniforms(key, (uint32_t)i, 0, &uniform, &cycles);
        sine_cosine_of_cycles(cycles, &sine, &cosine);
        const float amplitude = sqrtf(-2.0f * natural_logarithm(uniform));
        field->noise[0][i] = amplitude * cosine;
        field->noise[1][i] = amplitude * sine;
    }
}

static void add_lattice_row(struct random_field *field)
{
    const uint32_t taps = field->range.taps;
    const size_t slot = field->next_lattice_row % field->along_track.taps;
    make_noise(field, field->next_lattice_row++);
    for (int part = 0; part < 2; part++) {
        float *blurred = field->blurred[part] + slot * field->columns;
        for (size_t column = 0; column < field->columns; column++) {
            const float *weights = field->range_weights + column * taps;
            const float *noise = field->noise[part] + field->range_first[column];
            float sum = 0.0f;
            for (uint32_t tap = 0; tap < taps; tap++)
                sum += weights[tap] * noise[tap];
            blurred[column] = sum;
        }
    }
}

void random_field_next_row(struct random_field *field, const float **first, const float **second)
{
    const uint32_t taps = field->along_track.taps;
    float weights[TAPS_MAX];
    const uint32_t start = weigh_taps(&field->along_track, field->next_row++, weights);
    while (field->next_lattice_row < start + taps)
        add_lattice_row(field);
    for (int part = 0; part < 2; part++) {
        float *row = field->row[part];
        memset(row, 0, field->columns * sizeof *row);
        for (uint32_t tap = 0; tap < taps; tap++) {
            const float *blurred =
                field->blurred[part] + (size_t)((start + tap) % taps) * field->columns;
            const float weight = weights[tap];
            for (size_t column = 0; column < field->columns; column++)
                row[column] += weight * blurred[column];
        }
    }
    *first = field->row[0];
    *second = field->row[1];
}
