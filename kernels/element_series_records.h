/* Records of the element level that host and device share: see layout.h. */
#ifndef SONJECT_KERNELS_ELEMENT_SERIES_RECORDS_H
#define SONJECT_KERNELS_ELEMENT_SERIES_RECORDS_H

#include "layout.h"

/* The grid of impulses as they were traced, and the samples of their echoes. Positions on the track
 * count strips; ranges count bins from the reference range on. */
struct impulse_grid_record {
    float strip_width, bin_width; /* m */
    float reference_range;        /* m, the processor's range of bin 0 */
    RECORD_INT first_strip;       /* first strip with impulses */
    RECORD_INT strips;
    float largest_range;      /* largest range of any impulse, m */
    float cycles_per_metre;   /* 1 / wavelength, for cycles per m of the way */
    float samples_per_metre;  /* fine samples per m of the way */
    float first_sample;       /* fine sample of an echo whose way is twice the reference range */
    float transmitter_cycles; /* length / (2 wavelength): the pattern's argument at end-fire */
    float hydrophone_cycles;
    float largest_slope_squared; /* (x / r)^2 of the aspect limit */
    RECORD_INT samples;          /* fine samples of each line */
    RECORD_INT segments;         /* work-items that share a line */
};

/* A transmitter and a hydrophone on the track: strip number and the rest of a strip, 0...1. */
struct element_pair_record {
    RECORD_INT transmitter_strip;
    float transmitter_fraction;
    RECORD_INT hydrophone_strip;
    float hydrophone_fraction;
};

#endif
