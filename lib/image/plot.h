/* Pictures of images to look at: panels in grey on a dB scale with axes in metres. */
#ifndef SONJECT_IMAGE_PLOT_H
#define SONJECT_IMAGE_PLOT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"

struct plot_panel {
    const char *title;      /* ASCII; NULL: none */
    const float *amplitude; /* rows x columns, >= 0 */
    bool is_difference;     /* values are dB already, drawn on +-difference_db in blue-white-red */
};

struct plot_frame {
    uint64_t rows, columns; /* of every panel */
    double first_along_track_m, row_spacing_m;
    double first_range_m, column_spacing_m; /* of the axis that is labelled; it may fall */
    /* "slant range, m" or "ground range, m"; "column": axes in pixels, the other one called "row"
     */
    const char *range_label;
    /* grey scale; unless minimum < maximum it is chosen from the first panel of amplitudes: 3rd and
     * 99.8th percentile of what is drawn */
    double minimum_db, maximum_db;
    double difference_db; /* > 0 */
};

/* Where the pixels of a panel lie in the picture. */
struct plot_place {
    uint32_t left, top, width, height;
};

/* Draws the panels side by side (range to the right, row 0 at the top), large images reduced by
 * averaging energy, small ones enlarged by whole factors, to about 500...1000 pixels a panel.
 * Pixels that are zero or no number are black. *picture gets *height x *width x 3 bytes (RGB), for
 * free(); on failure NULL. places: of each panel; may be NULL. Errors: INPUT (no pixel above 0 in
 * the panel that the grey scale is chosen from, or nothing to draw), MEMORY. */
sonject_status plot_panels(struct report *report, const struct plot_frame *frame,
                           const struct plot_panel *panels, uint32_t count, uint8_t **picture,
                           uint32_t *height, uint32_t *width, struct plot_place *places);

/* The sides of a picture of a small image to scale, rows first, of which none is longer than
 * `longest`; nor are the finer sides of its pixels drawn longer. Spacings that are no numbers above
 * 0 make square pixels. */
void plot_small_sides(uint64_t rows, uint64_t columns, double row_spacing_m,
                      double column_spacing_m, uint32_t longest, uint32_t sides[2]);

/* Ticks of an axis: multiples of 1, 2 or 5 times a power of ten. */
#define TICK_LABEL_CAPACITY 40

struct plot_ticks {
    int64_t first, last; /* a tick is number * multiple * 10^exponent; none if last < first */
    int multiple;        /* 1, 2 or 5 */
    int exponent;
};

/* The closest ticks within low...high of which there are at most about `most`; none where the axis
 * has no use for them (not finite, or so narrow that labels would not differ). */
struct plot_ticks plot_ticks_between(double low, double high, double most);

double plot_tick_value(const struct plot_ticks *ticks, int64_t number);

/* The tick as a decimal number, the same under every locale. Returns label. */
const char *plot_tick_label(const struct plot_ticks *ticks, int64_t number,
                            char label[TICK_LABEL_CAPACITY]);

#endif
