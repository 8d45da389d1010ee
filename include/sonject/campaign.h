/* Campaigns: many injections drawn from distributions, as a labelled data set. */
#ifndef SONJECT_CAMPAIGN_H
#define SONJECT_CAMPAIGN_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/result.h>
#include <sonject/scene.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_campaign sonject_campaign;

/* Reads a campaign file and checks it: keys, distributions, swaths (which are read whole, once) and
 * scenes with the ends of all distributions. path: YAML file. params: overrides of its keys, and
 * whether the base scene and targets may hold code; its text must be NULL. Relative file names are
 * resolved against the campaign file's folder, those that overrides give to scene and swaths
 * against the working directory. params may be NULL (all defaults). Message on failure:
 * file:line:column, the key, what is wrong. On success *campaign is the caller's, for
 * sonject_campaign_release, before its context; on failure NULL. Errors: ARGUMENT, INPUT, STORAGE,
 * UNSUPPORTED, MEMORY. */
SONJECT_API sonject_status sonject_campaign_read(sonject_context *context, const char *path,
                                                 const sonject_scene_read_params *params,
                                                 sonject_campaign **campaign);

/* Releases the campaign and sets *campaign to NULL; NULL allowed. */
SONJECT_API void sonject_campaign_release(sonject_campaign **campaign);

/* Number of images; their ids count from 0. Errors: ARGUMENT. */
SONJECT_API sonject_status sonject_campaign_image_count(const sonject_campaign *campaign,
                                                        uint64_t *count);

/* What is drawn for an image. */
typedef struct sonject_campaign_image {
    uint32_t struct_size;
    uint32_t object_count;
    uint64_t id;
    uint64_t first_row; /* of the image in its swath, unless it is drawn anew many times */
    uint64_t first_column;
    uint64_t rows;
    uint64_t columns;
    uint64_t seed;       /* of its injection */
    uint32_t swath;      /* number in the campaign file, from 0 */
    uint32_t has_target; /* 0: empty, or clutter alone */
    char split[SONJECT_NAME_CAPACITY];
    char class_name[SONJECT_NAME_CAPACITY]; /* of the target; "" without one */
} sonject_campaign_image;

/* image->struct_size must be set. id: below the number of images. Errors: ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_campaign_describe(const sonject_campaign *campaign, uint64_t id,
                                                     sonject_campaign_image *image);

/* The scene of an image, whose input is the swath's file and whose patch is the image: of the first
 * draw whose values go with each other. Where its objects do not fit, sonject_campaign_inject draws
 * anew. On success *scene is the caller's, for sonject_scene_release; on failure NULL. Errors:
 * ARGUMENT, INPUT, STORAGE, UNSUPPORTED, MEMORY. */
SONJECT_API sonject_status sonject_campaign_scene(sonject_context *context,
                                                  sonject_campaign *campaign, uint64_t id,
                                                  sonject_scene **scene);

/* Makes an image in memory: sonject_inject of that scene into the image's part of the swath, with
 * values and places of objects drawn anew, up to 64 times, where they do not fit; no file is
 * written. The layer IMAGE is linear: floats, the amplitudes of the numbers that the image's file
 * would store, rounded and limited as these are, before a JPEG's loss; 1 is full scale, but by a
 * decibel curve what that says; or complex pixels of a complex swath. Truth of objects counts the
 * image's pixels. On success *result is the caller's, for sonject_result_release; on failure NULL.
 * Errors: ARGUMENT, INPUT, DEVICE, STORAGE, MEMORY, CANCELLED. */
SONJECT_API sonject_status sonject_campaign_inject(sonject_context *context,
                                                   sonject_campaign *campaign, uint64_t id,
                                                   sonject_progress_function progress, void *user,
                                                   sonject_result **result);

typedef struct sonject_campaign_run_params {
    uint32_t struct_size;
    uint32_t shard_index; /* 1...shard_count, 0 without: only ids with id mod shard_count =
                             shard_index - 1 */
    uint32_t shard_count; /* 0 or 1: all images */
    uint32_t only_one;    /* 1: only the image `only`, anew if it is there */
    uint64_t only;        /* id */
    const char *folder;   /* for the data set; made where missing */
    double exit_after_s;  /* stops as if cancelled, when images then under way are done; 0: never */
    uint32_t overwrites;  /* 1: another campaign's images in the folder are removed, not with
                             shards; 0: they are refused */
    uint32_t reserved;    /* 0 */
} sonject_campaign_run_params;

/* Makes the images that are not in the folder yet, each published file by file with its record
 * last, and, if all were asked for, the documents of the whole. A run that was stopped, or killed,
 * goes on where it was; the bytes do not depend on that. Records name each file with size and hash
 * (no time, which would differ from run to run): an image with a file that is not so is made again.
 * *was_finished (may be NULL) gets 1 if nothing was left to do. A folder of another campaign, or of
 * another version, is refused unless params->overwrites. progress (may be NULL): fractions of what
 * was missing; its stage tells the rate.
 * Threads: images are made by threads of the library's own, two for each processor, 16 at most, and
 * fewer where images are large; progress and log are called by the calling thread alone. Where
 * images fail, the message is of the one with the lowest id; those under way are finished.
 * Errors: ARGUMENT (also a folder of another campaign: the message names what differs), INPUT,
 * DEVICE, STORAGE, MEMORY, UNSUPPORTED, CANCELLED (finished images stay).
 */
SONJECT_API sonject_status sonject_campaign_run(sonject_context *context,
                                                sonject_campaign *campaign,
                                                const sonject_campaign_run_params *params,
                                                sonject_progress_function progress, void *user,
                                                int *was_finished);

/* Checks that all images of a folder's campaign are there as their records say, whoever made them,
 * and writes the documents of the whole, as a run of all would. Records are input, each member of
 * which is checked. Errors: ARGUMENT, INPUT (names what is missing, changed or damaged),
 * STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
SONJECT_API sonject_status sonject_campaign_merge(sonject_context *context, const char *folder,
                                                  sonject_progress_function progress, void *user);

/* What boxes of contacts are around, where their class does not tell: the class names shadow and
 * highlight do. */
typedef enum sonject_label_part {
    SONJECT_LABELS_BOTH = 0, /* highlight and shadow */
    SONJECT_LABELS_HIGHLIGHT = 1,
    SONJECT_LABELS_SHADOW = 2
} sonject_label_part;

typedef struct sonject_campaign_fit_params {
    uint32_t struct_size;
    uint32_t part; /* sonject_label_part */
    /* Real contacts, ten or more: a COCO file (.json); a .csv file with the columns image, row,
     * column, rows, columns (and side, port or starboard, of a recording); a folder of YOLO's texts
     * or of VOC's XML; or a .yaml file of published quantiles of extents. Images are read as the
     * campaign's scene reads its swaths; geometry and altitude are the image's own where it tells
     * them, and a swath's own keys hold for an image with its file name. */
    const char *contacts;
    const char *fitted; /* the campaign file to write, in the folder of the one that is fitted; a
                           page and its picture come beside it: ".html", ".png"; where the scene's
                           input.calibration is auto, a folder of that name with "_fit" for an
                           extension has calibrations of swaths and contacts' images */
    const char *const *classes; /* contacts of these classes alone; NULL: of all */
    size_t class_count;
} sonject_campaign_fit_params;

/* Fits a campaign to real contacts: moves what its targets draw of length, width, height and level
 * over the seabed, and the noise floor, until contacts that it injects measure as the real ones do;
 * sets range_over_altitude and visible from the contacts. What cannot be told from contacts stays
 * as it is: classes' shares, headings, burial, materials, fixed sizes. Some 830 images are made, by
 * threads as in sonject_campaign_run. path, params: as of sonject_campaign_read. The same inputs
 * give the same bytes. progress may be NULL.
 * Errors: ARGUMENT, INPUT (fewer than ten contacts, labels that cannot be read, ...), DEVICE,
 * STORAGE, MEMORY, UNSUPPORTED, CANCELLED; then fit_params->fitted is not written. */
SONJECT_API sonject_status sonject_campaign_fit(sonject_context *context, const char *path,
                                                const sonject_scene_read_params *params,
                                                const sonject_campaign_fit_params *fit_params,
                                                sonject_progress_function progress, void *user);

SONJECT_END_DECLARATIONS

#endif
