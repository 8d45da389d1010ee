/* Whole runs on files, as the command's verbs do them. */
#ifndef SONJECT_RUN_H
#define SONJECT_RUN_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/scene.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* Label files beside coco.json; values may be added up. */
typedef enum sonject_labels {
    SONJECT_LABELS_YOLO = 1, /* image.txt, and names of the classes in classes.txt */
    SONJECT_LABELS_VOC = 2   /* image.xml, in the format of Pascal VOC */
} sonject_labels;

typedef struct sonject_run_params {
    uint32_t struct_size;
    uint32_t labels;      /* sum of sonject_labels; 0: none */
    const char *folder;   /* folder for the results; created if missing */
    uint32_t shard_index; /* 1 to shard_count; 0 with shard_count 0: the whole run */
    uint32_t shard_count; /* at most 9999; 0: the run is not shared out */
    double exit_after_s;  /* time after which the call stops tracing by itself; 0: never */
    double checkpoint_s;  /* longest time between checkpoints; 0: 60 s */
    uint32_t
        overwrites; /* 1: another result, or other files, in the folder are replaced; 0: refused */
    uint32_t reserved; /* 0 */
} sonject_run_params;

/* Reads the scene's input, injects, and writes the result files into params->folder. run.json is
 * published last, so a folder with run.json is complete; it names each file with size, time and
 * hash. *was_finished (may be NULL) gets 1, with nothing done, if the folder already holds the
 * finished result of the same inputs. Files are compared by size, and also by hash if they have
 * less than 16 MB or another time. Missing or changed files are made again. A result of other
 * inputs is refused unless params->overwrites, and stays until the new one is ready to be written.
 * The same holds for files of the result's names that no run has written.
 * Each file appears whole or not at all.
 * Shards: with shard_count K this call traces one of K parts of all rays. It leaves its tallies in
 * params->folder/work and writes no results. Other processes, also on other machines of the same
 * kind, trace the other parts in the same folder, in any order. sonject_merge then makes the
 * result, byte for byte that of a whole run. For a shard that was there already *was_finished stays
 * 0.
 * Checkpoints: a call returns CANCELLED if it is cancelled while it traces, or if it stops by
 * itself after exit_after_s (never before some progress). Its work stays in the folder work, and
 * the same call continues from there. A process that is killed loses what came after its last
 * checkpoint. A whole run removes the folder work once its results are written. Work of another
 * scene, image or version is refused; that of a whole run is dropped.
 * Calibration: if the scene's input.calibration is auto, the first call makes calibration.yaml in
 * the folder from the scene's image (sonject_calibrate), with a picture beside it. The run and all
 * shards use this file.
 * Errors: ARGUMENT (also another result in the folder: the message names what differs), INPUT,
 * DEVICE, STORAGE, MEMORY, UNSUPPORTED (no raster files in this build), CANCELLED. */
SONJECT_API sonject_status sonject_run(sonject_context *context, const sonject_scene *scene,
                                       const sonject_run_params *params,
                                       sonject_progress_function progress, void *user,
                                       int *was_finished);

typedef struct sonject_merge_params {
    uint32_t struct_size;
    uint32_t labels;    /* see sonject_run_params */
    const char *folder; /* folder of the shards, and for the results */
} sonject_merge_params;

/* Makes the result of all shards of a run, and removes their tallies once the result is written.
 * scene: the traced scene; NULL: the scene whose text the shards keep (its files are read again).
 * If that scene has bands, each has its shards in a folder of its name below the folder. All bands
 * are merged, once each has at least one shard. Every file is byte for byte that of a whole run,
 * except for times, memory and the device in run.json. *was_finished is as in sonject_run, also if
 * the folder has a result and no shards; INPUT if this result lacks the labels asked for. Errors:
 * ARGUMENT, INPUT (shards that are missing, not finished, damaged, of another scene, image or
 * version: the message names them), DEVICE, STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
SONJECT_API sonject_status sonject_merge(sonject_context *context, const sonject_scene *scene,
                                         const sonject_merge_params *params,
                                         sonject_progress_function progress, void *user,
                                         int *was_finished);

/* Checks the scene against its input image (which must exist) without tracing. *text gets a
 * description of the geometry with a drawing: track, patch, objects, grazing angles, shadow
 * lengths. *text is the caller's, for sonject_text_release. Errors: ARGUMENT, INPUT, STORAGE,
 * MEMORY. */
SONJECT_API sonject_status sonject_check(sonject_context *context, const sonject_scene *scene,
                                         char **text);
SONJECT_API void sonject_text_release(char **text);

/* The horizontal axis of a quick look. */
typedef enum sonject_range_axis {
    SONJECT_AXIS_SLANT = 0, /* the image's own axis */
    SONJECT_AXIS_GROUND = 1 /* ground range; a slant range image is resampled and needs geometry and
                               altitude */
} sonject_range_axis;

typedef struct sonject_quicklook_params {
    uint32_t struct_size;
    uint32_t range_axis; /* sonject_range_axis */
    const char *image;   /* file to look at */
    const char *picture; /* PNG to write */
    double minimum_db;   /* dark end of the grey scale, below maximum_db; both 0: chosen from the
                            image */
    double maximum_db;
    double altitude_m; /* 0: the altitude of the image's metadata */
    /* Texts as in the section input of scenes; each may be NULL. */
    const char *channel;  /* "port", "starboard" or a number, in an XTF or JSF file of several
                             channels */
    const char *array;    /* name of the array in an HDF5 or MATLAB file of several */
    const char *transfer; /* "{kind: decibel, parameter: 0.5}"; NULL: plain amplitude */
    const char *geometry; /* "{row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 40 m}";
                             NULL: the image's metadata, or without any, axes that count pixels */
} sonject_quicklook_params;

/* Draws an image file with axes in metres. Errors: ARGUMENT, INPUT (such as an axis of ground range
 * for an image that has it already, or whose columns' ranges are unknown), STORAGE, MEMORY,
 * UNSUPPORTED. */
SONJECT_API sonject_status sonject_quicklook(sonject_context *context,
                                             const sonject_quicklook_params *params);

/* Writes the synthetic seabed of the scene's input (input.synthetic), with its geometry as
 * metadata. path: .tif (float32) or .png (8 bit, amplitude 1 = 255). Errors: ARGUMENT, INPUT,
 * STORAGE, MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_seabed_write(sonject_context *context,
                                                const sonject_scene *scene, const char *path);

SONJECT_END_DECLARATIONS

#endif
