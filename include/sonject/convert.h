/* Conversion of files from one format to another. */
#ifndef SONJECT_CONVERT_H
#define SONJECT_CONVERT_H

#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* The range axis of the converted file. */
typedef enum sonject_convert_axis {
    SONJECT_CONVERT_AXIS_KEPT = 0, /* the input's range axis */
    SONJECT_CONVERT_AXIS_SLANT = 1,
    SONJECT_CONVERT_AXIS_GROUND = 2
} sonject_convert_axis;

typedef struct sonject_convert_params {
    uint32_t struct_size;
    uint32_t range_axis; /* sonject_convert_axis; columns are resampled to equal steps of it, each
                            from the nearest column of the input, at the input's column spacing */
    const char *input;   /* any image, array or recording that runs can read */
    const char *output;  /* .tif, .png, .npy or .h5; any format with `into` */
    const char *into;    /* file of the output's size and type; the output is a copy of it with the
                            input's samples, all else untouched. PNG and JPEG are refused. NULL: no
                            copy */
    const char *channel; /* channel; see sonject_quicklook_params, also for array and geometry */
    const char *array;
    const char *geometry; /* geometry in slant range; NULL: the input's own. Refused for an input
                             that states ground range. With the axis SLANT, for an input that does
                             not state its axis: geometry in ground range, also its first range */
    double altitude_m;    /* 0: the input's own */
    double black_db; /* level of black in 8 bit grey levels, relative to full scale: 255, 65535 or,
                        for floats, 1 */
    double white_db; /* level of white, above black_db; both 0: the numbers stay as they are */
} sonject_convert_params;

/* Converts a file. Known geometry is written too, except to .npy, which has no place for it; a line
 * of the log says so. Channel and array select from `input`, and from `into` if it has several.
 * Doubles become floats. The output appears whole or not at all. Refused (INPUT): samples that the
 * file or its format cannot hold (numbers beyond the samples of a recording that scales each ping
 * are cut instead), a range axis for an input that does not state its own, and a call that would
 * change nothing. Errors: ARGUMENT, INPUT, STORAGE, MEMORY, UNSUPPORTED (a format that this build
 * lacks), CANCELLED. */
SONJECT_API sonject_status sonject_convert(sonject_context *context,
                                           const sonject_convert_params *params);

SONJECT_END_DECLARATIONS

#endif
