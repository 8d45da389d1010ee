/* Files of one format made of those of another. */
#ifndef SONJECT_SWATH_CONVERSION_H
#define SONJECT_SWATH_CONVERSION_H

#include <sonject/convert.h>

#include "base/report.h"
#include "swath/geometry_notes.h"

/* sonject_convert, whose choices are checked. */
sonject_status convert_file(struct report *report, const sonject_convert_params *params,
                            const struct image_options *options);

/* Where an image's columns lie. */
struct range_columns {
    enum range_axis axis;
    double first_m, spacing_m; /* NaN: nobody said */
    bool has_nadir;            /* some lie to the left of it */
    size_t count;
};

/* Replaces an image's columns by those at steps of another range axis over a level seabed, each the
 * nearest one. bytes: of a pixel. *pixels are the caller's, before and after. path: in messages.
 * Errors: INPUT (columns of which this cannot be made: says why), MEMORY; on failure all is as it
 * was. */
sonject_status range_axis_change(struct report *report, const char *path, enum range_axis axis,
                                 double altitude_m, double step_m, size_t rows, size_t bytes,
                                 struct range_columns *columns, void **pixels);

#endif
