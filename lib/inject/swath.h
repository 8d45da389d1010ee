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
    struct raster_layout layout; /* layout of the whole swath */
    struct region patch;
    sonject_transfer_params
        transfer;  /* the scene's; full_scale at most the file's largest number */
    void *stored;  /* the patch's pixels as the file stores them; if made, the whole swath's; NULL:
                      linear pixels in memory */
    float *pixels; /* the patch in linear amplitudes or pairs */
    bool borrows_pixels; /* pixels are a caller's, who keeps them, and must not be changed */
    bool is_complex;
    bool is_made;        /* made by sonject */
    bool is_whole;       /* the file stores integers, even if the layout has floats */
    double full_scale;   /* of the numbers that the file stores */
    bool tells_geometry; /* the file tells its geometry */
    sonject_geometry_params files_geometry;
    double grey_db[2];         /* see struct noted_geometry */
    const char *new_extension; /* the image's; NULL: a copy of the input's file with other pixels */
    struct track track;        /* track of a recording */
    struct ping_list skipped;  /* a recording's pings that make no row */
    struct ping_list empty;    /* the swath's rows in the patch that are all 0; pixels has the row
                                  above, else one below, in their place */
    uint64_t clipped;          /* number of pixels at full scale */
    char identity[HASH_TEXT_CAPACITY]; /* hash of the swath's size and the pixels: the patch's; if
                                          made, all */
};

/* Finds layout and patch without pixels; a made swath's from its parameters. The caller gives the
 * swath to swath_close; on failure nothing is held. Errors: INPUT, STORAGE, MEMORY, UNSUPPORTED. */
sonject_status swath_describe(struct report *report, const struct scene *scene,
                              struct swath *swath);

/* Describes the swath, and reads or makes the patch. */
sonject_status swath_open(struct report *report, const struct scene *scene, struct swath *swath);
void swath_close(struct swath *swath);

/* A file that many patches are cut out of. It stays open, and if it is small its pixels are read
 * once. Starts as all zeros; the caller gives it to swath_store_close. */
struct swath_store {
    struct swath_file *file;
    char *path;
    int32_t channel;
    char *array;  /* NULL: the file's only array */
    void *pixels; /* all pixels; NULL: regions are read when they are asked for */
};

/* Opens the swath of a scene whose input is a file, as swath_open does, through the store. The
 * store closes the file that it holds if that is another. */
sonject_status swath_open_stored(struct report *report, const struct scene *scene,
                                 struct swath_store *store, struct swath *swath);
void swath_store_close(struct swath_store *store);

/* Linearise pixels in memory, and find their empty rows, as for a file. rows, columns, transfer,
 * stored (or pixels, to find empty rows) and is_whole must be set. path: for messages; NULL: no
 * file. Errors: INPUT, MEMORY. */
sonject_status swath_linearise(struct report *report, const char *path, struct swath *swath);
sonject_status swath_find_empty(struct report *report, const struct scene *scene,
                                struct swath *swath);

/* Returns the patch as the file would store it, with touched pixels replaced; for free(), NULL
 * where memory is out. clipped: as in swath_write. */
void *swath_stored_result(const struct swath *swath, const struct injection_result *result,
                          uint64_t *clipped);

/* Returns the patch as an injection takes it. The swath keeps its pixels. */
struct injection_input swath_input(const struct swath *swath);

/* Restores the swath's empty rows in the patch, and removes them from the result. */
void swath_leave_empty(const struct swath *swath, struct injection_result *result);

/* Writes pings or rows for messages: "3, 5, 17 and 8 more". */
const char *ping_list_text(const struct ping_list *list, char text[PING_LIST_CAPACITY]);

/* Returns a name such as "image.png": with the input's extension where that is patched, else .tif.
 * For free(); NULL where memory is out. */
char *swath_image_name(const struct scene *scene, const struct swath *swath);

/* Writes the swath with the result's patch at path, in the input's format, type and transfer.
 * Untouched pixels keep their stored bytes. *clipped gets the number of touched pixels that full
 * scale cut. Errors: INPUT, STORAGE, MEMORY, CANCELLED. */
sonject_status swath_write(struct report *report, const struct scene *scene,
                           const struct swath *swath, const struct injection_result *result,
                           const char *path, sonject_progress_function progress, void *user,
                           uint64_t *clipped);

/* Writes the scene's synthetic seabed with its geometry as metadata: sonject_seabed_write. */
sonject_status write_seabed(struct report *report, const struct scene *scene, const char *path);

#endif
