/* Records of the element level that host and device share: see layout.h. */
#ifndef SONJECT_KERNELS_ELEMENT_SERIES_RECORDS_H
#define SONJECT_KERNELS_ELEMENT_SERIES_RECORDS_H

#include "layout.h"

/* Where impulses lie on the grid they were traced on, and how their echoes become samples.
 * Positions on the track count strips, ranges bins from the reference range on. */
struct impulse_grid_record {
    float strip_width, bin_width; /* m */
    float reference_range;        /* m, the processor's, of bin 0 */
    RECORD_INT first_strip;       /* of the impulses */
    RECORD_INT strips;
    float largest_range;      /* m, of any impulse */
    float cycles_per_metre;   /* of the way: 1 / wavelength */
    float samples_per_metre;  /* fine samples, of the way */
    float first_sample;       /* fine: of an echo without any way beyond twice the reference */
    float transmitter_cycles; /* length / (2 wavelength): the pattern's argument at end-fire */
    float hydrophone_cycles;
    float largest_slope_squared; /* (x / r)^2 of the aspect limit */
    RECORD_INT samples;          /* fine, of each line */
    RECORD_INT segments;         /* work-items that share a line */
};

/* A transmitter and a hydrophone on the track: strip number and what is left, 0...1. */
struct element_pair_record {
    RECORD_INT transmitter_strip;
    float transmitter_fraction;
    RECORD_INT hydrophone_strip;
    float hydrophone_fraction;
};

#endif
