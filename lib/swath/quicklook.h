/* Pictures of image files, with axes in metres. */
#ifndef SONJECT_SWATH_QUICKLOOK_H
#define SONJECT_SWATH_QUICKLOOK_H

#include <sonject/run.h>

#include "base/report.h"
#include "image/raster.h"
#include "scene/params.h"

/* sonject_quicklook, whose parameters are checked; boxes of pixels are framed in it. */
sonject_status draw_quicklook(struct report *report, const sonject_quicklook_params *params,
                              const struct image_options *options, const struct region *boxes,
                              size_t box_count);

#endif
