/* The steps of a conversion, each on the whole image. */
#ifndef SONJECT_SWATH_CONVERSION_H
#define SONJECT_SWATH_CONVERSION_H

#include <sonject/convert.h>

#include "base/report.h"
#include "swath/geometry_notes.h"

/* sonject_convert, whose choices are checked. */
sonject_status convert_file(struct report *report, const sonject_convert_params *params);

struct conversion {
    struct raster_layout layout;
    void *pixels; /* owned */
    struct noted_geometry geometry;
    bool is_resampled;
};

/* "complex float32" and the like. */
const char *conversion_type_name(const struct raster_layout *layout);

/* What the file, and before it the parameters, say of where the pixels lie. Errors: INPUT (the file
 * says ground range, the parameters slant range). */
sonject_status conversion_take_geometry(struct report *report, struct conversion *conversion,
                                        const struct swath_file *file,
                                        const sonject_convert_params *params);

/* Magnitudes of complex samples. Errors: INPUT (they are not), MEMORY. */
sonject_status conversion_to_magnitude(struct report *report, struct conversion *conversion,
                                       const char *input);

/* Another type. Errors: INPUT (the same type, a sample out of its range: says which), MEMORY. */
sonject_status conversion_to_type(struct report *report, struct conversion *conversion,
                                  const sonject_convert_params *params);

/* Columns at equal steps of the other range axis, each from the nearest one. Errors: INPUT (it is
 * the same or not known, no altitude, nothing beyond the altitude), MEMORY. */
sonject_status conversion_resample(struct report *report, struct conversion *conversion,
                                   const sonject_convert_params *params);

#endif
