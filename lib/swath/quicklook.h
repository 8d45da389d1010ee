/* Pictures of image files, with axes in metres. */
#ifndef SONJECT_SWATH_QUICKLOOK_H
#define SONJECT_SWATH_QUICKLOOK_H

#include <sonject/run.h>

#include "base/report.h"
#include "image/raster.h"
#include "scene/params.h"

/* Draws sonject_quicklook's picture, whose parameters are checked, with frames around boxes. */
sonject_status draw_quicklook(struct report *report, const sonject_quicklook_params *params,
                              const struct image_options *options, const struct region *boxes,
                              size_t box_count);

#endif
