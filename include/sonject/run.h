/* Whole runs on files: what the command's verbs do. */
#ifndef SONJECT_RUN_H
#define SONJECT_RUN_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/scene.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* Labels beside coco.json; they may be added up. */
typedef enum sonject_labels {
    SONJECT_LABELS_YOLO = 1, /* image.txt, and the names of its classes in classes.txt */
    SONJECT_LABELS_VOC = 2   /* image.xml, as Pascal VOC has it */
} sonject_labels;

typedef struct sonject_run_params {
    uint32_t struct_size;
    uint32_t labels;      /* sum of sonject_labels; 0: none */
    const char *folder;   /* for the results; made where missing */
    uint32_t shard_index; /* 1 to shard_count; 0 with it: the whole run */
    uint32_t shard_count; /* at most 9999; 0: the run is not shared out */
    double exit_after_s;  /* the call stops tracing by itself after so long; 0: never */
    double checkpoint_s;  /* what was traced is kept so often at least; 0: every 60 s */
    uint32_t overwrites;  /* 1: another result in the folder is replaced; 0: it is refused */
    uint32_t reserved;    /* 0 */
} sonject_run_params;

/* With shard_count K this call traces one of K parts of all rays and leaves its tallies in
 * params->folder/work, no results; other processes, also on other machines of the same kind, do the
 * other parts in the same folder, in any order, and sonject_merge makes the result of them, byte
 * for byte that of a whole run. *was_finished then stays 0 where the part was there already.
 *
 * A call that is cancelled while it traces, or that stops by itself after exit_after_s (never
 * before it has got a little further), returns CANCELLED and leaves what it traced in the folder
 * work too, from where the same call goes on; a process that is killed loses what came after its
 * last checkpoint. A whole run removes the folder work once its results are written. Work of
 * another scene, image or version is refused, that of a whole run is dropped.
 *
 * A scene whose input.calibration is auto is run with the file calibration.yaml of the folder,
 * which the first call makes of the scene's image (sonject_calibrate), with a picture beside it;
 * shards share it.
 *
 * Reads the scene's input, injects, and writes the result files into params->folder; run.json is
 * published last, so a folder with run.json is complete; it names each file with size, time and
 * hash. *was_finished (may be NULL) gets 1, with nothing done, if the folder already holds the
 * finished result of the same inputs: files are compared by size, and by hash where they have less
 * than 16 MB or another time. What is missing or changed is made again. A result of other inputs is
 * refused unless params->overwrites, and stays until the new one is there to be written. Each file
 * appears whole or not at all.
 * Errors: ARGUMENT (also another result in the folder: the message names what differs), INPUT,
 * DEVICE, STORAGE, MEMORY, UNSUPPORTED (no raster files in this build), CANCELLED. */
SONJECT_API sonject_status sonject_run(sonject_context *context, const sonject_scene *scene,
                                       const sonject_run_params *params,
                                       sonject_progress_function progress, void *user,
                                       int *was_finished);

typedef struct sonject_merge_params {
    uint32_t struct_size;
    uint32_t labels;    /* as of sonject_run_params */
    const char *folder; /* that the shards were given; the results go there */
} sonject_merge_params;

/* Makes the result of all shards of a run, and removes their tallies once it is written. scene: the
 * one that was traced; NULL: that whose text the shards keep (the files that it names are read
 * again). Where that scene has bands, each with its shards in a folder of its name below the
 * folder, all of them are merged, once each has a shard at least. Every file is that of a whole run
 * byte for byte, but for times, memory and the device in run.json. *was_finished as of sonject_run,
 * also where the folder has a result and no shards; INPUT where that lacks labels that are wanted.
 * Errors: ARGUMENT, INPUT (shards that are missing, not finished, damaged, of another scene, image
 * or version: the message names them), DEVICE, STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
SONJECT_API sonject_status sonject_merge(sonject_context *context, const sonject_scene *scene,
                                         const sonject_merge_params *params,
                                         sonject_progress_function progress, void *user,
                                         int *was_finished);

/* Checks the scene against its input image (which must exist) without tracing, and describes the
 * geometry as a text with a drawing: track, patch, objects, grazing angles, shadow lengths. *text
 * is the caller's, for sonject_text_release.
 * Errors: ARGUMENT, INPUT, STORAGE, MEMORY. */
SONJECT_API sonject_status sonject_check(sonject_context *context, const sonject_scene *scene,
                                         char **text);
SONJECT_API void sonject_text_release(char **text);

/* The horizontal axis of a quick look. */
typedef enum sonject_range_axis {
    SONJECT_AXIS_SLANT = 0, /* as the image is */
    SONJECT_AXIS_GROUND = 1 /* a slant range image is resampled; needs geometry and altitude */
} sonject_range_axis;

typedef struct sonject_quicklook_params {
    uint32_t struct_size;
    uint32_t range_axis; /* sonject_range_axis */
    const char *image;   /* file to look at */
    const char *picture; /* PNG to write */
    double minimum_db;   /* of the grey scale, below maximum_db; both 0: chosen from the image */
    double maximum_db;
    double altitude_m; /* 0: from the image's metadata */
    /* As in the section input of scenes; each may be NULL. */
    const char *channel;  /* "port", "starboard" or a number, of an XTF or JSF file of several */
    const char *array;    /* its name in an HDF5 or MATLAB file of several */
    const char *transfer; /* "{kind: decibel, parameter: 0.5}"; NULL: plain amplitude */
    const char *geometry; /* "{row_spacing: 5 cm, column_spacing: 5 cm, first_slant_range: 40 m}";
                             NULL: the image's metadata, and without any the axes count pixels */
} sonject_quicklook_params;

/* Draws an image file with axes in metres. Errors: ARGUMENT, INPUT (such as an axis of ground range
 * for an image that has it already, or does not tell where its columns lie), STORAGE, MEMORY,
 * UNSUPPORTED. */
SONJECT_API sonject_status sonject_quicklook(sonject_context *context,
                                             const sonject_quicklook_params *params);

/* Writes the synthetic seabed that the scene's input is (input.synthetic) with its geometry as
 * metadata. path: .tif (float32) or .png (8 bit, amplitude 1 = 255). Errors: ARGUMENT, INPUT,
 * STORAGE, MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_seabed_write(sonject_context *context,
                                                const sonject_scene *scene, const char *path);

SONJECT_END_DECLARATIONS

#endif
