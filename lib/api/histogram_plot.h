/* Histograms for pages of statistics. */
#ifndef SONJECT_API_HISTOGRAM_PLOT_H
#define SONJECT_API_HISTOGRAM_PLOT_H

#include <stddef.h>

#include "base/growing_text.h"

/* Adds an HTML image that holds the histogram itself, as SVG in a data URI. values: count finite
 * ones. Nothing is added for no values. */
void histogram_write(struct growing_text *text, const char *name, const char *unit,
                     const double *values, size_t count);

#endif
