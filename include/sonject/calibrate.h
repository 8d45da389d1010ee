/* What a swath tells of itself, for scenes to take. */
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
    uint32_t as_json;  /* 1: the text is JSON, which scenes take, too; 0: YAML */
    const char *image; /* file; or NULL */
    const sonject_pixels
        *pixels; /* instead of a file: numbers as they are stored, of any kind, whose transfer
                    is NULL; floats that are all whole count as 8 or 16 bit integers */
    const char *channel; /* of the file, as of sonject_quicklook_params, like the next two */
    const char *array;
    const char *geometry; /* NULL: what the file's metadata says, if anything */
    const char *picture;  /* PNG of a page that shows why to believe it; NULL: none */
    const char *output;   /* file that gets the text; NULL: none */
} sonject_calibrate_params;

/* Estimates a swath's transfer function and how well it fits, ceiling and clipped share, looks,
 * texture, response, noise floor, water column and gain against range, from fixed tiles all over
 * it. *text, which may be asked for by a pointer that is not NULL, gets a document whose keys are a
 * scene's, for input.calibration, and a section `measured`: of each estimate `value`,
 * `standard_error` and `how` it was found, or `not_seen` with the reason (kernels/MATH.md,
 * "Calibration", lists them). Numbers have four significant digits. *text is the caller's, for
 * sonject_text_release; on failure NULL. Scenes for sonject_inject, whose pixels are linear, take
 * the keys above `measured` by sonject_scene_set(scene, "injection.noise_floor", ...) and so on, or
 * all by "input.calibration". Files appear whole or not at all. Errors: ARGUMENT, INPUT, STORAGE,
 * MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_calibrate(sonject_context *context,
                                             const sonject_calibrate_params *params, char **text);

SONJECT_END_DECLARATIONS

#endif
