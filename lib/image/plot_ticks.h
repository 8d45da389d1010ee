/* Ticks of an axis: multiples of 1, 2 or 5 times a power of ten. */
#ifndef SONJECT_IMAGE_PLOT_TICKS_H
#define SONJECT_IMAGE_PLOT_TICKS_H

#include <stddef.h>
#include <stdint.h>

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
