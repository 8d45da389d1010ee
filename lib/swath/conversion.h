/* Conversion of files from one format to another. */
#ifndef SONJECT_SWATH_CONVERSION_H
#define SONJECT_SWATH_CONVERSION_H

#include <sonject/convert.h>

#include "base/report.h"
#include "swath/geometry_notes.h"

/* Does the work of sonject_convert. The caller has checked the parameters. */
sonject_status convert_file(struct report *report, const sonject_convert_params *params,
                            const struct image_options *options);

/* The ranges of an image's columns. */
struct range_columns {
    enum range_axis axis;
    double first_m, spacing_m; /* NaN: unknown */
    bool has_nadir;            /* some columns lie to the left of the nadir */
    size_t count;
};

/* Replaces an image's columns by columns at equal steps of another range axis, over a level seabed.
 * Each new column is the nearest old one. bytes: size of a pixel. *pixels is the caller's, before
 * and after. path: for messages. Errors: INPUT (columns that cannot be replaced; the message says
 * why), MEMORY. On failure nothing has changed. */
sonject_status range_axis_change(struct report *report, const char *path, enum range_axis axis,
                                 double altitude_m, double step_m, size_t rows, size_t bytes,
                                 struct range_columns *columns, void **pixels);

#endif
