/* Pictures of images: grey panels on a dB scale with axes in metres. */
#ifndef SONJECT_IMAGE_PLOT_H
#define SONJECT_IMAGE_PLOT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"

struct plot_panel {
    const char *title;      /* ASCII; NULL: none */
    const float *amplitude; /* rows x columns, >= 0 */
    bool is_difference;     /* values are dB, drawn on +-difference_db in blue, white and red */
};

struct plot_frame {
    uint64_t rows, columns; /* size of every panel */
    double first_along_track_m, row_spacing_m;
    double first_range_m, column_spacing_m; /* the labelled axis, which may fall */
    /* "slant range, m" or "ground range, m"; "column": axes in pixels, the other one is "row" */
    const char *range_label;
    /* The grey scale. Unless minimum < maximum, the scale spans the 3rd to the 99.8th percentile of
     * the first panel of amplitudes, as drawn. */
    double minimum_db, maximum_db;
    double difference_db; /* > 0 */
};

/* The place of a panel's pixels in the picture. */
struct plot_place {
    uint32_t left, top, width, height;
};

/* Draws the panels side by side, with range to the right and row 0 at the top. A panel has about
 * 500...1000 pixels: energies of large images are averaged, small images are enlarged by whole
 * factors. Pixels that are zero or no number are black. *picture gets *height x *width x 3 bytes
 * (RGB), for free(); on failure NULL. places: one for each panel; may be NULL. Errors: INPUT (no
 * pixel above 0 in the panel that the grey scale is chosen from, or nothing to draw), MEMORY. */
sonject_status plot_panels(struct report *report, const struct plot_frame *frame,
                           const struct plot_panel *panels, uint32_t count, uint8_t **picture,
                           uint32_t *height, uint32_t *width, struct plot_place *places);

/* Chooses the sides of a picture of a small image to scale, rows first. No side is longer than
 * `longest`, and the shorter sides of pixels are not enlarged. Spacings that are not above 0 make
 * square pixels. */
void plot_small_sides(uint64_t rows, uint64_t columns, double row_spacing_m,
                      double column_spacing_m, uint32_t longest, uint32_t sides[2]);

/* The ticks of an axis: multiples of 1, 2 or 5 times a power of ten. */
#define TICK_LABEL_CAPACITY 40

struct plot_ticks {
    int64_t first, last; /* a tick is number * multiple * 10^exponent; last < first: none */
    int multiple;        /* 1, 2 or 5 */
    int exponent;
};

/* Returns the closest ticks within low...high that are at most about `most`. There are none where
 * the axis is not finite, or so narrow that labels would not differ. */
struct plot_ticks plot_ticks_between(double low, double high, double most);

double plot_tick_value(const struct plot_ticks *ticks, int64_t number);

/* Writes the tick as a decimal number, independent of the locale. Returns label. */
const char *plot_tick_label(const struct plot_ticks *ticks, int64_t number,
                            char label[TICK_LABEL_CAPACITY]);

#endif
