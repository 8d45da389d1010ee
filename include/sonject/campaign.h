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

/* Reads a campaign file and checks its keys, its distributions, its swaths (read whole, once) and
 * scenes with the ends of all distributions. path: YAML file. params: overrides of the campaign's
 * keys; params->text must be NULL. params may be NULL (all defaults). Relative file names are
 * resolved against the campaign file's folder. Names that overrides give to scene and swaths are
 * resolved against the working directory. The message of a failure names file:line:column, the key
 * and the mistake. On success *campaign is the caller's, for sonject_campaign_release, before its
 * context; on failure it is NULL. Errors: ARGUMENT, INPUT, STORAGE, UNSUPPORTED, MEMORY. */
SONJECT_API sonject_status sonject_campaign_read(sonject_context *context, const char *path,
                                                 const sonject_scene_read_params *params,
                                                 sonject_campaign **campaign);

/* Releases the campaign and sets *campaign to NULL; NULL allowed. */
SONJECT_API void sonject_campaign_release(sonject_campaign **campaign);

/* Gets the number of images; their ids count from 0. Errors: ARGUMENT. */
SONJECT_API sonject_status sonject_campaign_image_count(const sonject_campaign *campaign,
                                                        uint64_t *count);

/* The values drawn for an image. */
typedef struct sonject_campaign_image {
    uint32_t struct_size;
    uint32_t object_count;
    uint64_t id;
    uint64_t first_row; /* first row of the image in its swath; many failed draws change it */
    uint64_t first_column;
    uint64_t rows;
    uint64_t columns;
    uint64_t seed;       /* seed of the image's injection */
    uint32_t swath;      /* number of the swath in the campaign file, from 0 */
    uint32_t has_target; /* 0: the image is empty or has only clutter */
    char split[SONJECT_NAME_CAPACITY];
    char class_name[SONJECT_NAME_CAPACITY]; /* class of the target; "" without a target */
} sonject_campaign_image;

/* Describes an image. image->struct_size must be set. id: below the number of images. Errors:
 * ARGUMENT, MEMORY. */
SONJECT_API sonject_status sonject_campaign_describe(const sonject_campaign *campaign, uint64_t id,
                                                     sonject_campaign_image *image);

/* Makes the scene of an image. Its input is the swath's file, its patch is the image. Values are
 * those of the first draw whose values are consistent; if the objects do not fit, only
 * sonject_campaign_inject draws again. On success *scene is the caller's, for
 * sonject_scene_release; on failure it is NULL. Errors: ARGUMENT, INPUT, STORAGE, UNSUPPORTED,
 * MEMORY. */
SONJECT_API sonject_status sonject_campaign_scene(sonject_context *context,
                                                  sonject_campaign *campaign, uint64_t id,
                                                  sonject_scene **scene);

/* Makes an image in memory and writes no file. It injects the image's scene into its part of the
 * swath. If the objects do not fit, values and places are drawn again, up to 64 times. The layer
 * IMAGE is linear. For a complex swath it holds complex pixels. Otherwise it holds float
 * amplitudes, rounded and limited like the numbers in the image's file before any JPEG loss. The
 * amplitude 1 is full scale, unless a decibel curve sets another one. The truth of objects counts
 * pixels of the image. On success *result is the caller's, for sonject_result_release; on failure
 * it is NULL. Errors: ARGUMENT, INPUT, DEVICE, STORAGE, MEMORY, CANCELLED. */
SONJECT_API sonject_status sonject_campaign_inject(sonject_context *context,
                                                   sonject_campaign *campaign, uint64_t id,
                                                   sonject_progress_function progress, void *user,
                                                   sonject_result **result);

typedef struct sonject_campaign_run_params {
    uint32_t struct_size;
    uint32_t shard_index; /* 1...shard_count: only ids with id mod shard_count = shard_index - 1; 0:
                             no shards */
    uint32_t shard_count; /* 0 or 1: all images */
    uint32_t only_one;    /* 1: only the image `only`, which is made again if it exists */
    uint64_t only;        /* id of that image */
    const char *folder;   /* folder for the data set; created if missing */
    double exit_after_s; /* time after which the call stops as if cancelled, after images under way;
                            0: never */
    uint32_t overwrites; /* 1: images of another campaign in the folder are removed, not allowed
                            with shards; 0: they are refused */
    uint32_t reserved;   /* 0 */
} sonject_campaign_run_params;

/* Makes the images that the folder lacks. Each image is published file by file, its record last. If
 * all images were asked for, the documents of the whole data set are written too. A run that was
 * stopped or killed continues where it was, and the bytes do not depend on interruptions. Records
 * name each file with size and hash; they hold no time, which would differ from run to run. An
 * image whose files do not match its record is made again. *was_finished (may be NULL) gets 1 if
 * nothing was left to do. A folder of another campaign, or of another version, is refused unless
 * params->overwrites. progress (may be NULL) gets fractions of the missing images; its stage shows
 * the rate.
 * Threads: the library makes images on threads of its own, two for each processor, 16 at most, and
 * fewer if images are large. It calls progress and log only on the calling thread. If images fail,
 * the message is that of the lowest id; images under way are finished.
 * Errors: ARGUMENT (also a folder of another campaign: the message names what differs), INPUT,
 * DEVICE, STORAGE, MEMORY, UNSUPPORTED, CANCELLED (finished images stay). */
SONJECT_API sonject_status sonject_campaign_run(sonject_context *context,
                                                sonject_campaign *campaign,
                                                const sonject_campaign_run_params *params,
                                                sonject_progress_function progress, void *user,
                                                int *was_finished);

/* Checks that a folder holds all images of its campaign as their records describe them, whoever
 * made them. It then writes the documents of the whole data set, as a run of all images would.
 * Records are untrusted input: each member is checked. Errors: ARGUMENT, INPUT (names what is
 * missing, changed or damaged), STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
SONJECT_API sonject_status sonject_campaign_merge(sonject_context *context, const char *folder,
                                                  sonject_progress_function progress, void *user);

/* The part of a contact inside its box, unless the box's class is named shadow or highlight. */
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
     * campaign's scene reads its swaths. An image's own geometry and altitude count where its file
     * has them. The keys of a swath also hold for an image with the swath's file name. */
    const char *contacts;
    const char *fitted; /* campaign file to write, in the folder of the original; a page (".html")
                           and its picture (".png") are written beside it. If the scene's
                           input.calibration is auto, a folder named after it, with "_fit" for the
                           extension, gets calibrations of the swaths and of the contacts' images */
    const char *const *classes; /* contacts' classes to use, class_count of them; NULL: all */
    size_t class_count;
} sonject_campaign_fit_params;

/* Fits a campaign to real contacts. It moves the distributions of the targets' length, width,
 * height and level over the seabed, and of the noise floor, until injected contacts measure as the
 * real ones do. It sets range_over_altitude and visible from the contacts. Contacts do not tell
 * classes' shares, headings, burial, materials and fixed sizes; these stay as they are. The fit
 * makes about 1,250 images, on threads as in sonject_campaign_run. path, params: as in
 * sonject_campaign_read. The same inputs give the same bytes. progress may be NULL.
 * Errors: ARGUMENT, INPUT (fewer than ten contacts, labels that cannot be read, ...), DEVICE,
 * STORAGE, MEMORY, UNSUPPORTED, CANCELLED. On failure fit_params->fitted is not written. */
SONJECT_API sonject_status sonject_campaign_fit(sonject_context *context, const char *path,
                                                const sonject_scene_read_params *params,
                                                const sonject_campaign_fit_params *fit_params,
                                                sonject_progress_function progress, void *user);

SONJECT_END_DECLARATIONS

#endif
