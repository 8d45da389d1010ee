#include "image/raster.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

#define ROWS_BYTES  ((uint64_t)64 << 20)
#define STEPS_LEAST 16 /* fewest levels; a picture of fewer does not tell its step */

size_t pixel_bytes(enum pixel_type type)
{
    static const size_t bytes[] = {1, 2, 4};
    return bytes[type];
}

double pixel_full_scale(enum pixel_type type)
{
    static const double full_scales[] = {255.0, 65535.0, 1.0};
    return full_scales[type];
}

double pixel_number(enum pixel_type type, const void *pixels, size_t i)
{
    return type == PIXEL_UINT8    ? (double)((const uint8_t *)pixels)[i]
           : type == PIXEL_UINT16 ? (double)((const uint16_t *)pixels)[i]
                                  : (double)((const float *)pixels)[i];
}

double pixel_magnitude(const struct raster_layout *layout, const void *pixels, size_t i)
{
    const size_t k = i * layout->channels;
    const double first = pixel_number(layout->type, pixels, k);
    return layout->channels == 2 ? hypot(first, pixel_number(layout->type, pixels, k + 1)) : first;
}

bool pixel_store(enum pixel_type type, void *pixels, size_t i, double number)
{
    const double whole = floor(number + 0.5);
    if (type == PIXEL_FLOAT32 ? isfinite(number) && fabs(number) > (double)FLT_MAX
                              : !(whole >= 0.0 && whole <= pixel_full_scale(type)))
        return false;
    if (type == PIXEL_UINT8)
        ((uint8_t *)pixels)[i] = (uint8_t)whole;
    else if (type == PIXEL_UINT16)
        ((uint16_t *)pixels)[i] = (uint16_t)whole;
    else
        ((float *)pixels)[i] = (float)number;
    return true;
}

bool layouts_are_alike(const struct raster_layout *one, const struct raster_layout *other)
{
    return one->rows == other->rows && one->columns == other->columns &&
           one->channels == other->channels && one->type == other->type;
}

uint64_t rows_at_once(const struct raster_layout *layout)
{
    const uint64_t rows =
        ROWS_BYTES / (layout->columns * layout->channels * pixel_bytes(layout->type));
    return rows == 0 ? 1 : rows < layout->rows ? rows : layout->rows;
}

bool region_bytes(const struct raster_layout *layout, const struct region *region, size_t *bytes)
{
    if (region->rows > SIZE_MAX || region->columns > SIZE_MAX)
        return false;
    size_t total = 0;
    const bool fits = size_multiply((size_t)region->rows, (size_t)region->columns, &total) &&
                      size_multiply(total, layout->channels, &total) &&
                      size_multiply(total, pixel_bytes(layout->type), &total);
    if (fits)
        *bytes = total;
    return fits;
}

bool region_is_inside(const struct raster_layout *layout, const struct region *region)
{
    return region->rows > 0 && region->columns > 0 && region->rows <= layout->rows &&
           region->columns <= layout->columns && region->first_row <= layout->rows - region->rows &&
           region->first_column <= layout->columns - region->columns;
}

/* Returns NaN where the value has no amplitude. */
static double amplitude_of(const sonject_transfer_params *transfer, double full_scale, double value)
{
    const double q = value / full_scale;
    const double b = transfer->parameter;
    switch (transfer->kind) {
    case SONJECT_TRANSFER_INTENSITY:
        return sqrt(q);
    case SONJECT_TRANSFER_DECIBEL:
        return pow(10.0, (value * transfer->parameter + transfer->offset) / 20.0);
    case SONJECT_TRANSFER_GAMMA:
        return pow(q, transfer->parameter);
    case SONJECT_TRANSFER_SCHLICK:
        return q / (b - (b - 1.0) * q);
    default:
        return q;
    }
}

static double value_of(const sonject_transfer_params *transfer, double full_scale, double amplitude)
{
    const double a = amplitude;
    const double b = transfer->parameter;
    switch (transfer->kind) {
    case SONJECT_TRANSFER_INTENSITY:
        return a * a * full_scale;
    case SONJECT_TRANSFER_DECIBEL:
        /* 0 has no logarithm; the smallest normal number is quiet enough. */
        return (20.0 * log10(fmax(a, (double)FLT_MIN)) - transfer->offset) / transfer->parameter;
    case SONJECT_TRANSFER_GAMMA:
        return pow(a, 1.0 / transfer->parameter) * full_scale;
    case SONJECT_TRANSFER_SCHLICK:
        return a * b / (1.0 + (b - 1.0) * a) * full_scale;
    default:
        return a * full_scale;
    }
}

static double transfer_full_scale(const sonject_transfer_params *transfer, enum pixel_type type)
{
    const double most = pixel_full_scale(type);
    if (transfer->full_scale > 0.0 && (type == PIXEL_FLOAT32 || transfer->full_scale < most))
        return transfer->full_scale;
    return most;
}

/* Returns whether a number is an amplitude. The plain transfer takes parts of complex pixels,
 * too. */
static bool is_amplitude(const sonject_transfer_params *transfer, float amplitude)
{
    return isfinite(amplitude) &&
           (amplitude >= 0.0f || transfer->kind == SONJECT_TRANSFER_AMPLITUDE);
}

/* Returns the amplitudes of all values of an integer type. NULL where a table does not pay, or
 * memory is out. */
static float *table_of(const sonject_transfer_params *transfer, enum pixel_type type, size_t count)
{
    if (type == PIXEL_FLOAT32 || (double)count < pixel_full_scale(type))
        return NULL;
    const size_t length = (size_t)pixel_full_scale(type) + 1;
    float *table = malloc(length * sizeof *table);
    for (size_t i = 0; table && i < length; i++)
        table[i] = (float)amplitude_of(transfer, transfer_full_scale(transfer, type), (double)i);
    return table;
}

sonject_status transfer_to_amplitude(const sonject_transfer_params *transfer, enum pixel_type type,
                                     const void *stored, size_t count, float *amplitude,
                                     size_t *bad, uint64_t *clipped)
{
    const double full_scale = transfer_full_scale(transfer, type);
    float *table = table_of(transfer, type, count);
    sonject_status status = SONJECT_OK;
    uint64_t at_full_scale = 0;
    for (size_t i = 0; i < count; i++) {
        const double value = pixel_number(type, stored, i);
        amplitude[i] =
            table ? table[(size_t)value] : (float)amplitude_of(transfer, full_scale, value);
        if (!is_amplitude(transfer, amplitude[i])) {
            *bad = i;
            status = SONJECT_ERROR_INPUT;
            break;
        }
        at_full_scale += type != PIXEL_FLOAT32 && value >= full_scale;
    }
    *clipped += at_full_scale;
    free(table);
    return status;
}

void transfer_to_stored(const sonject_transfer_params *transfer, enum pixel_type type,
                        uint32_t step, const float *amplitude, size_t count, void *stored,
                        uint64_t *clipped)
{
    const double full_scale = transfer_full_scale(transfer, type);
    const double unit = step;
    const double largest = step == 0 ? (double)FLT_MAX : unit * floor(full_scale / unit);
    for (size_t i = 0; i < count; i++) {
        double value = value_of(transfer, full_scale, (double)amplitude[i]);
        if (step != 0)
            value = value > 0.0 ? unit * floor(value / unit + 0.5) : 0.0;
        if (value > largest) {
            value = largest;
            ++*clipped;
        }
        if (type == PIXEL_UINT8)
            ((uint8_t *)stored)[i] = (uint8_t)value;
        else if (type == PIXEL_UINT16)
            ((uint16_t *)stored)[i] = (uint16_t)value;
        else
            ((float *)stored)[i] = (float)value;
    }
}

double transfer_ceiling(const sonject_transfer_params *transfer, enum pixel_type type,
                        bool is_whole)
{
    const double full_scale = transfer_full_scale(transfer, type);
    return type == PIXEL_FLOAT32 && !is_whole
               ? INFINITY
               : amplitude_of(transfer, full_scale, full_scale - 0.5);
}

uint32_t quantisation_step(enum pixel_type type, const void *stored, size_t count)
{
    uint32_t step = 0;
    uint32_t largest = 0;
    if (type == PIXEL_FLOAT32)
        return 0;
    for (size_t i = 0; step != 1 && i < count; i++) {
        uint32_t value = (uint32_t)pixel_number(type, stored, i);
        largest = value > largest ? value : largest;
        while (value != 0) { /* Euclid's algorithm */
            const uint32_t rest = step % value;
            step = value;
            value = rest;
        }
    }
    return step == 0 || largest / step < STEPS_LEAST ? 1 : step;
}
