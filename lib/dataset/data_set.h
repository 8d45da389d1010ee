/* A data set in its folder: the files of a campaign's images, and the documents of the whole. */
#ifndef SONJECT_DATASET_DATA_SET_H
#define SONJECT_DATASET_DATA_SET_H

#include "base/file.h"
#include "dataset/campaign.h"

#define CLASSES_MAX (2 * CAMPAIGN_ITEMS_MAX)

/* Where files of enum output lie; extension NULL: ".png" where that stores the pixels as they are,
 * else ".tif". */
extern const struct output_kind {
    const char *folder, *extension;
} output_kinds[OUTPUT_KINDS];

#define IMAGE_NAME_CAPACITY 48

/* The name of an image's file within its split, "images/00000007.png". extension: of pixels.
 * Returns name. */
const char *image_file_name(uint64_t id, enum output output, const char *extension,
                            char name[IMAGE_NAME_CAPACITY]);

/* What campaign.json says that documents need. Starts as all zeros, is for data_set_clear. */
struct data_set {
    struct report *report;
    const char *folder;
    json_t *head; /* campaign.json */
    uint64_t images;
    uint32_t outputs;
    size_t split_count;
    const char *split_names[CAMPAIGN_SPLITS_MAX]; /* of head */
    uint64_t split_first[CAMPAIGN_SPLITS_MAX], split_images[CAMPAIGN_SPLITS_MAX];
    sonject_progress_function progress; /* may be NULL */
    void *user;
};

/* Opens the campaign's folder: publishes campaign.json, or checks that the folder's is this
 * campaign's, and makes the folders of the splits; overwrites: removes the images of another.
 * Errors: ARGUMENT (it is another's, or another version's), INPUT (it is damaged), STORAGE, MEMORY.
 */
sonject_status data_set_begin(struct data_set *set, struct sonject_campaign *campaign,
                              const char *folder, bool overwrites);

/* Opens a folder by its campaign.json. Errors: INPUT, STORAGE, MEMORY. */
sonject_status data_set_open(struct data_set *set, struct report *report, const char *folder);
void data_set_clear(struct data_set *set);

/* Whether the documents are there as they were written. Errors: STORAGE, MEMORY. */
sonject_status data_set_is_finished(const struct data_set *set, bool *is_finished);

/* Checks that all images are there as they were written, writes the documents and tidies up.
 * Errors: INPUT (what is missing), STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
sonject_status data_set_finish(struct data_set *set);

/* An image's record, for json_decref. One that was changed, or is another image's, is INPUT.
 * Errors: also STORAGE, MEMORY. */
sonject_status data_set_record(const struct data_set *set, size_t split, uint64_t id,
                               json_t **record);

/* Whether an image is there, each file as its record says. changed, where it is "", becomes the
 * path of a file that is not, or of a damaged record; it may be NULL. Errors: STORAGE, MEMORY. */
sonject_status data_set_has_image(const struct data_set *set, size_t split, uint64_t id,
                                  char changed[PATH_CAPACITY], bool *has);

/* Writes report.html and its pictures from images that are all there: contact_sheet.png, and below
 * CHIPS_FOLDER what browsers do not show. Errors: as data_set_finish. */
#define CHIPS_FOLDER  "chips"
#define SWATHS_FOLDER "swaths" /* their pictures, by their numbers */
sonject_status write_report_page(const struct data_set *set);

#define SHEET_CELLS 64 /* at most, of a picture of images */

/* The sides of an image in such a picture, rows first. Errors: as data_set_finish. */
sonject_status sheet_image_sides(const struct data_set *set, size_t split, const json_t *record,
                                 uint32_t sides[2]);

/* Writes a picture of images; cell_height: of the highest of all pictures. Errors: as
 * data_set_finish. */
sonject_status write_sheet(const struct data_set *set, const char *name, const uint64_t *ids,
                           uint32_t count, uint32_t cell_height);

/* That of images from all over the set, and whether it shows one. document: how pictures are laid
 * out, and the images of this one; for json_decref. */
bool contact_sheet_shows(const struct data_set *set, uint64_t id);
sonject_status write_contact_sheet(const struct data_set *set, uint32_t cell_height,
                                   json_t **document);

/* Write data.yaml, and croissant.json, which lists the named documents of the whole, those of
 * splits and folders. Errors: STORAGE, MEMORY, INPUT. */
sonject_status write_yolo_card(const struct data_set *set);
sonject_status write_croissant(const struct data_set *set, const char *const *names, size_t count);

#endif
