#include "image/transfer.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

/* One stored value (as a number) to amplitude. */
static double amplitude_of(const sonject_transfer_params *transfer, double stored, double full_scale)
{
    const double q = stored / full_scale;
    switch (transfer->kind) {
    case SONJECT_TRANSFER_INTENSITY:
        return sqrt(fmax(0.0, q));
    case SONJECT_TRANSFER_DECIBEL:
        return pow(10.0, (stored * transfer->parameter + transfer->offset) / 20.0);
    case SONJECT_TRANSFER_GAMMA:
        return pow(fmax(0.0, q), transfer->parameter);
    case SONJECT_TRANSFER_SCHLICK:
        return q / (transfer->parameter - (transfer->parameter - 1.0) * q);
    default:
        return q;
    }
}

static double stored_of(const sonject_transfer_params *transfer, double amplitude, double full_scale)
{
    switch (transfer->kind) {
    case SONJECT_TRANSFER_INTENSITY:
        return amplitude * amplitude * full_scale;
    case SONJECT_TRANSFER_DECIBEL:
        /* amplitude 0 is minus infinity dB: the smallest number that is one */
        return (20.0 * log10(fmax(amplitude, 1e-30)) - transfer->offset) / transfer->parameter;
    case SONJECT_TRANSFER_GAMMA:
        return pow(amplitude, 1.0 / transfer->parameter) * full_scale;
    case SONJECT_TRANSFER_SCHLICK:
        return transfer->parameter * amplitude /
               (1.0 + (transfer->parameter - 1.0) * amplitude) * full_scale;
    default:
        return amplitude * full_scale;
    }
}

static double read_stored(enum pixel_type type, const void *stored, size_t index)
{
    switch (type) {
    case PIXEL_UINT8:
        return ((const uint8_t *)stored)[index];
    case PIXEL_UINT16:
        return ((const uint16_t *)stored)[index];
    default:
        return (double)((const float *)stored)[index];
    }
}

sonject_status transfer_to_amplitude(const sonject_transfer_params *transfer, enum pixel_type type,
                                     const void *stored, size_t count, float *amplitude,
                                     size_t *bad, uint64_t *clipped)
{
    const double full_scale = pixel_full_scale(type);
    for (size_t i = 0; i < count; i++) {
        const double value = read_stored(type, stored, i);
        const bool is_plain_float =
            type == PIXEL_FLOAT32 && transfer->kind == SONJECT_TRANSFER_AMPLITUDE;
        const double linear =
            is_plain_float ? value : amplitude_of(transfer, value, full_scale);
        if (!isfinite(value) || !(fabs(linear) < 1e30)) {
            *bad = i;
            return SONJECT_ERROR_INPUT;
        }
        amplitude[i] = (float)linear;
        *clipped += type != PIXEL_FLOAT32 && value == full_scale;
    }
    return SONJECT_OK;
}

void transfer_to_stored(const sonject_transfer_params *transfer, enum pixel_type type,
                        const float *amplitude, size_t count, void *stored, uint64_t *clipped)
{
    const double full_scale = pixel_full_scale(type);
    for (size_t i = 0; i < count; i++) {
        const double value = stored_of(transfer, amplitude[i], full_scale);
        if (type == PIXEL_FLOAT32) {
            ((float *)stored)[i] = (float)value;
            continue;
        }
        const double rounded = floor(value + 0.5);
        const double limited = fmin(fmax(rounded, 0.0), full_scale);
        *clipped += rounded > full_scale;
        if (type == PIXEL_UINT8)
            ((uint8_t *)stored)[i] = (uint8_t)limited;
        else
            ((uint16_t *)stored)[i] = (uint16_t)limited;
    }
}
