/* The steps of a conversion, each on the whole image. */
#ifndef SONJECT_API_CONVERSION_H
#define SONJECT_API_CONVERSION_H

#include <sonject/convert.h>

#include "base/report.h"
#include "io/raster_file.h"
#include "io/swath_file.h"

#define CONVERSION_NOTES_MAX 12

struct conversion {
    struct raster_layout layout;
    void *pixels; /* owned */
    /* Where they lie, as far as it is known: NaN where it is not. */
    enum range_axis axis;
    double row_spacing_m, column_spacing_m, first_along_track_m, first_range_m, altitude_m;
    double frequency_hz, bandwidth_hz;
    uint32_t side;
    bool knows_side, is_resampled;
    char texts[CONVERSION_NOTES_MAX][48];
    struct raster_attribute notes[CONVERSION_NOTES_MAX];
    size_t note_count;
};

/* "complex float32" and the like. */
const char *conversion_type_name(const struct raster_layout *layout);

/* What the file, and before it the parameters, say of where the pixels lie. */
void conversion_take_notes(struct conversion *conversion, const struct swath_file *file,
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

/* Makes the texts that go with the pixels. */
void conversion_make_notes(struct conversion *conversion);

#endif
