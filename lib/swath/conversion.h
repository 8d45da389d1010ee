/* Files of one format made of those of another. */
#ifndef SONJECT_SWATH_CONVERSION_H
#define SONJECT_SWATH_CONVERSION_H

#include <sonject/convert.h>

#include "base/report.h"
#include "swath/geometry_notes.h"

/* sonject_convert, whose choices are checked. */
sonject_status convert_file(struct report *report, const sonject_convert_params *params,
                            const struct image_options *options);

#endif
