/* The image that a run works on: a file, or one that sonject makes. */
#ifndef SONJECT_INJECT_SWATH_H
#define SONJECT_INJECT_SWATH_H

#include "base/hash.h"
#include "base/report.h"
#include "image/raster.h"
#include "inject/injection.h"
#include "scene/scene.h"
#include "swath/recording.h"
#include "swath/swath_file.h"

#define PING_LIST_CAPACITY 200

/* Owned parts are freed by swath_close. */
struct swath {
    struct raster_layout layout; /* of the whole swath */
    struct region patch;
    sonject_transfer_params
        transfer;  /* the scene's, with the file's largest number as full scale */
    void *stored;  /* the patch's pixels as the file stores them; if made, the whole swath's; NULL:
                      they are linear, in memory */
    float *pixels; /* the patch, linear: amplitudes or pairs */
    bool is_complex;
    bool is_made;  /* by sonject */
    bool is_whole; /* numbers that the file limits: integers, also where the layout has floats */
    const char *new_extension; /* of the image; NULL: it is the input's file with other pixels */
    struct track track;        /* of a recording */
    struct ping_list skipped;  /* of a recording's pings, those that make no row */
    struct ping_list empty;    /* rows of the swath in the patch that hold nothing but 0; pixels has
                                  the row's above that is not, else below, in their place */
    uint64_t clipped;          /* pixels at full scale */
    char identity[HASH_TEXT_CAPACITY]; /* of the swath's size and the patch's pixels; if made, of
                                          all pixels */
};

/* Finds layout and patch without reading pixels (a made swath: from its parameters). To be given to
 * swath_close; on failure nothing is held. Errors: INPUT, STORAGE, MEMORY, UNSUPPORTED. */
sonject_status swath_describe(struct report *report, const struct scene *scene,
                              struct swath *swath);

/* The same, and reads (or makes) the patch. */
sonject_status swath_open(struct report *report, const struct scene *scene, struct swath *swath);
void swath_close(struct swath *swath);

/* A file that many patches are cut out of: it stays open, and where it is small its pixels are read
 * once. Starts as all zeros, is for swath_store_close. */
struct swath_store {
    struct swath_file *file;
    char *path;
    int32_t channel;
    char *array;  /* NULL: the only one */
    void *pixels; /* all of them; NULL: regions are read as they are asked for */
};

/* swath_open for a scene whose input is a file, by way of the store, which takes that file instead
 * of the one it holds. */
sonject_status swath_open_stored(struct report *report, const struct scene *scene,
                                 struct swath_store *store, struct swath *swath);
void swath_store_close(struct swath_store *store);

/* For pixels in memory, of which rows, columns, transfer, stored and is_whole are set: makes the
 * linear ones, and finds the empty rows, as for a file. path: for messages; NULL: no file. Errors:
 * INPUT, MEMORY. */
sonject_status swath_linearise(struct report *report, const char *path, struct swath *swath);
sonject_status swath_find_empty(struct report *report, const struct scene *scene,
                                struct swath *swath);

/* The patch as the file would store it, pixels touched by the result replaced; for free(), NULL
 * when memory is out. clipped: as of swath_write. */
void *swath_stored_result(const struct swath *swath, const struct injection_result *result,
                          uint64_t *clipped);

/* The patch, as an injection takes it; its pixels stay the swath's. */
struct injection_input swath_input(const struct swath *swath);

/* Takes the swath's empty rows out of what the result changes, and out of the patch. */
void swath_leave_empty(const struct swath *swath, struct injection_result *result);

/* Pings or rows for messages: "3, 5, 17 and 8 more". */
const char *ping_list_text(const struct ping_list *list, char text[PING_LIST_CAPACITY]);

/* "image.png" and the like: the input's extension where it is patched, else .tif. To be given to
 * free(); NULL when memory is out. */
char *swath_image_name(const struct scene *scene, const struct swath *swath);

/* Writes the swath with the result's patch at path, in the input's format, type and transfer;
 * pixels that were not touched keep their stored bytes. *clipped gets the number of touched pixels
 * that full scale cut. Errors: INPUT, STORAGE, MEMORY, CANCELLED. */
sonject_status swath_write(struct report *report, const struct scene *scene,
                           const struct swath *swath, const struct injection_result *result,
                           const char *path, sonject_progress_function progress, void *user,
                           uint64_t *clipped);

/* Writes the synthetic seabed that is the scene's input with its geometry as metadata:
 * sonject_seabed_write. */
sonject_status write_seabed(struct report *report, const struct scene *scene, const char *path);

#endif
