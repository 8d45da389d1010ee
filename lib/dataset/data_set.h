/* A data set in its folder: the files of a campaign's images, and the documents of the whole. */
#ifndef SONJECT_DATASET_DATA_SET_H
#define SONJECT_DATASET_DATA_SET_H

#include "base/file.h"
#include "dataset/campaign.h"

#define CLASSES_MAX (2 * CAMPAIGN_ITEMS_MAX)

/* The folders and extensions of enum output. extension NULL: ".jpg" for a JPEG, ".png" for other
 * images of 8 bit, else ".tif". */
extern const struct output_kind {
    const char *folder, *extension;
} output_kinds[OUTPUT_KINDS];

#define IMAGE_NAME_CAPACITY 48

/* Writes an image's file name within its split, "images/00000007.png". extension: of image files.
 * Returns name. */
const char *image_file_name(uint64_t id, enum output output, const char *extension,
                            char name[IMAGE_NAME_CAPACITY]);

/* The content of campaign.json for documents. Starts as all zeros; for data_set_clear. */
struct data_set {
    struct report *report;
    const char *folder;
    json_t *head; /* campaign.json */
    uint64_t images;
    uint32_t outputs;
    size_t split_count;
    const char *split_names[CAMPAIGN_SPLITS_MAX]; /* owned by head */
    uint64_t split_first[CAMPAIGN_SPLITS_MAX], split_images[CAMPAIGN_SPLITS_MAX];
    sonject_progress_function progress; /* may be NULL */
    void *user;
};

/* Opens the campaign's folder: publishes campaign.json, or checks that the folder's is this
 * campaign's, and makes the folders of the splits. overwrites: removes another campaign's images.
 * Errors: ARGUMENT (another campaign's, or another version's), INPUT (damaged), STORAGE, MEMORY. */
sonject_status data_set_begin(struct data_set *set, struct sonject_campaign *campaign,
                              const char *folder, bool overwrites);

/* Opens a folder by its campaign.json. Errors: INPUT, STORAGE, MEMORY. */
sonject_status data_set_open(struct data_set *set, struct report *report, const char *folder);
void data_set_clear(struct data_set *set);

/* Finds whether the documents are there as they were written. Errors: STORAGE, MEMORY. */
sonject_status data_set_is_finished(const struct data_set *set, bool *is_finished);

/* Checks that all images are there as they were written, writes the documents and tidies up.
 * Errors: INPUT (the message names what is missing), STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
sonject_status data_set_finish(struct data_set *set);

/* Reads an image's record, for json_decref. Errors: INPUT (the record was changed, or is another
 * image's), STORAGE, MEMORY. */
sonject_status data_set_record(const struct data_set *set, size_t split, uint64_t id,
                               json_t **record);

/* Finds whether an image is there, each file as its record says. changed (may be NULL): if "", it
 * gets the path of a file that is not so, or of a damaged record. Errors: STORAGE, MEMORY. */
sonject_status data_set_has_image(const struct data_set *set, size_t split, uint64_t id,
                                  char changed[PATH_CAPACITY], bool *has);

/* Writes report.html and its pictures; all images must be there. The pictures are
 * contact_sheet.png, and below CHIPS_FOLDER images that browsers do not show. Errors: those of
 * data_set_finish. */
#define CHIPS_FOLDER  "chips"
#define SWATHS_FOLDER "swaths" /* pictures of swaths, by number */
sonject_status write_report_page(const struct data_set *set);

#define SHEET_CELLS 64 /* most images in a picture */

/* Finds an image's sides in a picture of images, rows first. Errors: those of data_set_finish. */
sonject_status sheet_image_sides(const struct data_set *set, size_t split, const json_t *record,
                                 uint32_t sides[2]);

/* Writes a picture of images. cell_height: of the highest image in all pictures. Errors: those of
 * data_set_finish. */
sonject_status write_sheet(const struct data_set *set, const char *name, const uint64_t *ids,
                           uint32_t count, uint32_t cell_height);

/* The contact sheet, a picture of images from all over the set, and whether it shows an image.
 * document: layout of pictures, and the images of this one; for json_decref. */
bool contact_sheet_shows(const struct data_set *set, uint64_t id);
sonject_status write_contact_sheet(const struct data_set *set, uint32_t cell_height,
                                   json_t **document);

/* Write data.yaml, and croissant.json, which lists the named documents of the whole, and the
 * documents and folders of splits. Errors: STORAGE, MEMORY, INPUT. */
sonject_status write_yolo_card(const struct data_set *set);
sonject_status write_croissant(const struct data_set *set, const char *const *names, size_t count);

#endif
