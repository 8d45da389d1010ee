/* The element level: the sound that a hydrophone hears of impulses, each a point at its track
 * position and range (kernels/MATH.md, "Element level"). Echoes as short as possible first fill a
 * line of fine samples, which then goes through the pulse. Every sample is a sum in one fixed
 * order, by strips and then by ranges, whatever the width and the number of work-items. */
#ifndef SONJECT_KERNELS_ELEMENT_SERIES_H
#define SONJECT_KERNELS_ELEMENT_SERIES_H

#include "element_series_records.h"
#include "elementary.h"

/* The way from an impulse to one element. */
struct element_leg {
    vfloat range;  /* m */
    vfloat beyond; /* m; range less the processor range */
    vfloat slope;  /* sine of the aspect */
};

/* Returns the leg. `beyond` comes from the difference of squares: a difference of ranges would lose
 * the digits that the phase needs. */
FUNCTION struct element_leg element_leg_of(float offset, vfloat processor_range)
{
    struct element_leg leg;
    leg.range = SQUARE_ROOT(processor_range * processor_range + offset * offset);
    leg.beyond = offset * offset / (leg.range + processor_range);
    leg.slope = offset / leg.range;
    return leg;
}

/* Returns the amplitude pattern of a line element. cycles: its length over twice the wavelength. */
FUNCTION vfloat element_pattern(float cycles, vfloat slope)
{
    return sinc_of_cycles(magnitude(cycles * slope));
}

/* Returns the way along-track from an element to a strip's middle, m. Whole strips are exact. */
FUNCTION float element_offset(const struct impulse_grid_record *grid, int strip, int element_strip,
                              float element_fraction)
{
    return ((float)(strip - element_strip) - element_fraction) * grid->strip_width;
}

/* The echoes of one group of impulses, lane by lane. */
struct element_echo {
    float real_part[WIDTH], imaginary_part[WIDTH];
    float fraction[WIDTH]; /* share of a fine sample beyond `sample` */
    int sample[WIDTH];     /* -2: none */
};

struct element_offsets {
    float transmitter, hydrophone; /* m, from the element to the strip */
};

FUNCTION void hear_impulses(const struct impulse_grid_record *grid, struct element_offsets offsets,
                            vint bins, vfloat amplitude_real, vfloat amplitude_imaginary,
                            mask is_impulse, struct element_echo *echo)
{
    const vfloat bin_range = VFLOAT_OF(bins) * grid->bin_width;
    const vfloat processor_range = grid->reference_range + bin_range;
    const vfloat range =
        larger(processor_range, SPLAT(1.0e-3f)); /* margins may reach behind the track */
    const struct element_leg to = element_leg_of(offsets.transmitter, range);
    const struct element_leg back = element_leg_of(offsets.hydrophone, range);
    const vfloat beyond = to.beyond + back.beyond;
    const vfloat limit = grid->largest_slope_squared * range * range;
    const vfloat position =
        (beyond + 2.0f * bin_range) * grid->samples_per_metre + grid->first_sample;
    const mask is_heard = is_impulse & MASK_OF(processor_range == range) &
                          MASK_OF(position >= -1.0f) & MASK_OF(position < (float)grid->samples) &
                          MASK_OF(limit >= offsets.transmitter * offsets.transmitter) &
                          MASK_OF(limit >= offsets.hydrophone * offsets.hydrophone);
    /* One is added, since truncation is floor on positive numbers only. */
    const vfloat kept = SELECT(is_heard, position + 1.0f, SPLAT(0.0f));
    const vint sample = VINT_OF(kept);
    const vfloat gain = element_pattern(grid->transmitter_cycles, to.slope) *
                        element_pattern(grid->hydrophone_cycles, back.slope) /
                        (to.range * back.range);
    vfloat sine, cosine;
    sine_cosine_of_cycles(smaller(beyond * grid->cycles_per_metre, SPLAT(4.0e6f)), &sine, &cosine);
    const vfloat real_part = gain * (amplitude_real * cosine - amplitude_imaginary * sine);
    const vfloat imaginary_part = gain * (amplitude_real * sine + amplitude_imaginary * cosine);
    const vfloat fraction = kept - VFLOAT_OF(sample);
    const vint sample_or_none = SELECT(is_heard, sample - 1, SPLAT_VINT(-2));
    STORE_VFLOAT(real_part, echo->real_part);
    STORE_VFLOAT(imaginary_part, echo->imaginary_part);
    STORE_VFLOAT(fraction, echo->fraction);
    STORE_VINT(sample_or_none, echo->sample);
}

/* Shares an echo between the two fine samples about it, if they are among first...end - 1. */
FUNCTION void add_element_echo(GLOBAL float *line_real, GLOBAL float *line_imaginary,
                               const struct element_echo *echo, int lane, int first, int end)
{
    const int sample = echo->sample[lane];
    const float later = echo->fraction[lane];
    const float sooner = 1.0f - later;
    if (sample >= first && sample < end) {
        line_real[sample] += echo->real_part[lane] * sooner;
        line_imaginary[sample] += echo->imaginary_part[lane] * sooner;
    }
    if (sample + 1 >= first && sample + 1 < end) {
        line_real[sample + 1] += echo->real_part[lane] * later;
        line_imaginary[sample + 1] += echo->imaginary_part[lane] * later;
    }
}

/* Returns the bin whose echo from a strip comes at a fine sample: the ellipse about the two
 * elements meets the strip there. Below the shortest way it is far before all bins. */
FUNCTION float bin_of_sample(const struct impulse_grid_record *grid, struct element_offsets offsets,
                             float sample)
{
    const float way =
        2.0f * grid->reference_range + (sample - grid->first_sample) / grid->samples_per_metre;
    const float apart = offsets.transmitter - offsets.hydrophone;
    const float middle = 0.5f * (offsets.transmitter + offsets.hydrophone);
    if (way <= 0.0f)
        return -4.0e8f;
    const float square = (way * way - apart * apart) * (0.25f - middle * middle / (way * way));
    const float inside = way * way > apart * apart && square > 0.0f ? square : 0.0f;
    const float bin = (ROOT_OF_ONE(inside) - grid->reference_range) / grid->bin_width;
    return bin < -4.0e8f ? -4.0e8f : bin > 4.0e8f ? 4.0e8f : bin;
}

/* Returns the first of the impulses low...high - 1, sorted by bins, that is not before a bin. */
FUNCTION int first_impulse_from(GLOBAL const int *bins, int low, int high, float bin)
{
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if ((float)bins[middle] < bin)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

#define BIN_MARGIN 4.0f /* bins, for rounding and the share of a neighbour */

/* Adds the impulses of one strip to the share [first, end) of a line. */
FUNCTION void hear_strip(const struct impulse_grid_record *grid, struct element_offsets offsets,
                         GLOBAL const int *bins, GLOBAL const float *impulses_real,
                         GLOBAL const float *impulses_imaginary, int low, int high, int first,
                         int end, GLOBAL float *line_real, GLOBAL float *line_imaginary)
{
    const float step = grid->bin_width * grid->samples_per_metre;
    const float margin = BIN_MARGIN + 2.0f / step + 1.0e-5f * grid->largest_range / grid->bin_width;
    low = first_impulse_from(bins, low, high,
                             bin_of_sample(grid, offsets, (float)first - 1.0f) - margin);
    high = first_impulse_from(bins, low, high, bin_of_sample(grid, offsets, (float)end) + margin);
    for (int impulse = low; impulse < high; impulse += WIDTH) {
        struct element_echo echo;
        const mask is_impulse = MASK_OF(AS_VINT(LANE_NUMBERS) < high - impulse);
        hear_impulses(grid, offsets, LOAD_VINT(bins + impulse),
                      LOAD_VFLOAT(impulses_real + impulse),
                      LOAD_VFLOAT(impulses_imaginary + impulse), is_impulse, &echo);
        for (int lane = 0; lane < WIDTH; lane++)
            add_element_echo(line_real, line_imaginary, &echo, lane, first, end);
    }
}

/* Adds all impulses to the share `segment` of a pair's line. starts: first impulse of each strip,
 * and the end of the last. Impulses are followed by room for WIDTH more. */
FUNCTION void hear_grid(const struct impulse_grid_record *grid,
                        const struct element_pair_record *pair, GLOBAL const int *starts,
                        GLOBAL const int *bins, GLOBAL const float *impulses_real,
                        GLOBAL const float *impulses_imaginary, int segment,
                        GLOBAL float *line_real, GLOBAL float *line_imaginary)
{
    const int share = (grid->samples + grid->segments - 1) / grid->segments;
    const int first = segment * share;
    const int end = first + share < grid->samples ? first + share : grid->samples;
    const float most = grid->largest_slope_squared * grid->largest_range * grid->largest_range;
    for (int strip = 0; strip < grid->strips; strip++) {
        const int number = grid->first_strip + strip;
        struct element_offsets offsets;
        offsets.transmitter =
            element_offset(grid, number, pair->transmitter_strip, pair->transmitter_fraction);
        offsets.hydrophone =
            element_offset(grid, number, pair->hydrophone_strip, pair->hydrophone_fraction);
        if (offsets.transmitter * offsets.transmitter > most ||
            offsets.hydrophone * offsets.hydrophone > most)
            continue;
        hear_strip(grid, offsets, bins, impulses_real, impulses_imaginary, starts[strip],
                   starts[strip + 1], first, end, line_real, line_imaginary);
    }
}

/* Computes the WIDTH samples from `sample` on of a line's series: the complex sum over taps of
 * line[sample * fine + tap] * pulse[tap]. The line is followed by room for WIDTH * fine more. `out`
 * has room for whole groups of WIDTH. */
FUNCTION void pulse_series(GLOBAL const float *line_real, GLOBAL const float *line_imaginary,
                           int fine, GLOBAL const float *pulse_real,
                           GLOBAL const float *pulse_imaginary, int taps, int sample,
                           GLOBAL float *out_real, GLOBAL float *out_imaginary)
{
    vfloat sum_real = SPLAT(0.0f);
    vfloat sum_imaginary = SPLAT(0.0f);
    for (int tap = 0; tap < taps; tap++) {
        float lanes_real[WIDTH], lanes_imaginary[WIDTH];
        for (int lane = 0; lane < WIDTH; lane++) {
            lanes_real[lane] = line_real[(sample + lane) * fine + tap];
            lanes_imaginary[lane] = line_imaginary[(sample + lane) * fine + tap];
        }
        const vfloat a = LOAD_VFLOAT(lanes_real);
        const vfloat b = LOAD_VFLOAT(lanes_imaginary);
        sum_real += a * pulse_real[tap] - b * pulse_imaginary[tap];
        sum_imaginary += a * pulse_imaginary[tap] + b * pulse_real[tap];
    }
    STORE_VFLOAT(sum_real, out_real + sample);
    STORE_VFLOAT(sum_imaginary, out_imaginary + sample);
}

#endif
