/* Properties of a swath that are estimated from its own pixels, for use in scenes. */
#ifndef SONJECT_CALIBRATE_H
#define SONJECT_CALIBRATE_H

#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/result.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* A swath: a file, or stored numbers in memory. */
typedef struct sonject_calibrate_params {
    uint32_t struct_size;
    uint32_t as_json;             /* 1: the text is JSON, which scenes take, too; 0: YAML */
    const char *image;            /* file; NULL: pixels */
    const sonject_pixels *pixels; /* stored numbers of any kind instead of a file, with transfer
                                     NULL; floats that are all whole count as 8 or 16 bit integers
                                     */
    const char *channel; /* channel; see sonject_quicklook_params, also for array and geometry */
    const char *array;
    const char *geometry; /* NULL: the file's metadata, if any */
    const char *picture;  /* PNG of a page that shows the evidence; NULL: none */
    const char *output;   /* file for the text; NULL: none */
} sonject_calibrate_params;

/* Estimates a swath's transfer function and its fit, ceiling and clipped share, looks, texture,
 * response, noise floor, water column, and gain against range, from fixed tiles all over the swath.
 * text may be NULL. Otherwise *text gets a document with keys of scenes, for input.calibration, and
 * a section `measured`. This section has each estimate's `value`, `standard_error` and `how` it was
 * found, or `not_seen` with the reason (listed in kernels/MATH.md, "Calibration"). Numbers have
 * four significant digits. *text is the caller's, for sonject_text_release; on failure it is NULL.
 * Scenes for sonject_inject, whose pixels are linear, take the keys above `measured` by
 * sonject_scene_set(scene, "injection.noise_floor", ...) and so on, or all by "input.calibration".
 * Files appear whole or not at all. Errors: ARGUMENT, INPUT, STORAGE, MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_calibrate(sonject_context *context,
                                             const sonject_calibrate_params *params, char **text);

SONJECT_END_DECLARATIONS

#endif
