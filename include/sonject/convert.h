/* Files of one format from files of another. */
#ifndef SONJECT_CONVERT_H
#define SONJECT_CONVERT_H

#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* The range axis that a conversion makes. */
typedef enum sonject_convert_axis {
    SONJECT_CONVERT_AXIS_KEPT = 0, /* the input's range axis */
    SONJECT_CONVERT_AXIS_SLANT = 1,
    SONJECT_CONVERT_AXIS_GROUND = 2
} sonject_convert_axis;

typedef struct sonject_convert_params {
    uint32_t struct_size;
    uint32_t range_axis; /* sonject_convert_axis; columns are resampled to equal steps of it, each
                            from the nearest column of the input, at the input's column spacing */
    const char *input;   /* any image, array or recording that runs read */
    const char *output;  /* .tif, .png, .npy, .h5; with `into` any */
    const char *into; /* NULL, or a file of the output's size and type: the output is a copy of it
                         with the input's samples, all else untouched; not of
                         PNG and JPEG, whose copies are new */
    const char *channel; /* as of sonject_quicklook_params, like the other two */
    const char *array;
    const char *geometry; /* of slant range; NULL: the input's own. Refused where that is of ground
                             range */
    double altitude_m;    /* 0: the input's own */
    double black_db;      /* of 8 bit grey levels, over full scale: 255, 65535 or, of floats, 1 */
    double white_db;      /* above it; both 0: the numbers stay as they are */
} sonject_convert_params;

/* Converts a file. Geometry that is known goes with the samples where the format keeps texts (all
 * but .npy; a line of the log tells of it). Channel and array are those of
 * `input`, and of `into` where that has several. Doubles become floats. Refused (INPUT): samples
 * that the file cannot hold (numbers beyond a JSF file's 16 bits are cut), formats that cannot
 * hold the samples as they are, a range axis of an input that does not tell its own, and whatever
 * would do nothing. The output appears whole or not at all. Errors: ARGUMENT, INPUT, STORAGE,
 * MEMORY, UNSUPPORTED (a format that this build lacks), CANCELLED. */
SONJECT_API sonject_status sonject_convert(sonject_context *context,
                                           const sonject_convert_params *params);

SONJECT_END_DECLARATIONS

#endif
