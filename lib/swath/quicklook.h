/* Pictures of image files, with axes in metres. */
#ifndef SONJECT_SWATH_QUICKLOOK_H
#define SONJECT_SWATH_QUICKLOOK_H

#include <sonject/run.h>

#include "base/report.h"

/* sonject_quicklook, whose parameters are checked. */
sonject_status draw_quicklook(struct report *report, const sonject_quicklook_params *params);

#endif
