/* A data set in its folder: the files of a campaign's images, and the documents of the whole. */
#ifndef SONJECT_DATASET_DATA_SET_H
#define SONJECT_DATASET_DATA_SET_H

#include "dataset/campaign.h"

#define CLASSES_MAX (2 * CAMPAIGN_ITEMS_MAX)

/* Where files of enum output lie; extension NULL: ".png" where that stores the pixels as they are,
 * else ".tif". */
extern const struct output_kind {
    const char *folder, *extension;
} output_kinds[OUTPUT_KINDS];

/* The files of one image. */
struct image_files {
    char *folder; /* of its split; owned */
    uint64_t id;
    uint32_t outputs;      /* bits of enum output */
    const char *extension; /* of its pixels; static */
};

/* files: for free() of its folder. Errors: MEMORY. */
sonject_status image_files_init(struct image_files *files, struct report *report,
                                const char *folder, const char *split, uint64_t id,
                                uint32_t outputs, const char *extension);

#define IMAGE_NAME_CAPACITY 48

/* The file's name within its split, "images/00000007.png". Returns name. */
const char *image_file_name(const struct image_files *files, enum output output,
                            char name[IMAGE_NAME_CAPACITY]);

/* Size and hash of all files but the record, for it. Errors: STORAGE, MEMORY. */
sonject_status image_files_list(const struct image_files *files, struct report *report,
                                json_t **list);

/* Makes the folders of a split. Errors: STORAGE, MEMORY. */
sonject_status split_folders_make(struct report *report, const char *folder, const char *split,
                                  uint32_t outputs);

/* What campaign.json says that documents need. Starts as all zeros, is for data_set_clear. */
struct data_set {
    struct report *report;
    const char *folder;
    json_t *head; /* campaign.json */
    uint64_t images;
    json_int_t rows, columns; /* of each */
    uint32_t outputs;
    size_t split_count;
    const char *split_names[CAMPAIGN_SPLITS_MAX]; /* of head */
    uint64_t split_first[CAMPAIGN_SPLITS_MAX], split_images[CAMPAIGN_SPLITS_MAX];
    sonject_progress_function progress; /* may be NULL */
    void *user;
};

/* Publishes campaign.json, or checks that the folder's is this campaign's; overwrites: removes the
 * images of another. device: what images are made on if they depend on that, or NULL. Errors:
 * ARGUMENT (it is another's, another version's, or of another device), INPUT (it is damaged),
 * STORAGE, MEMORY. */
sonject_status data_set_begin(struct sonject_campaign *campaign, const struct device *device,
                              const char *folder, bool overwrites);

/* Opens a folder by its campaign.json. Errors: INPUT, STORAGE, MEMORY. */
sonject_status data_set_open(struct data_set *set, struct report *report, const char *folder);
void data_set_clear(struct data_set *set);

/* Whether the documents are there as they were written. Errors: STORAGE, MEMORY. */
sonject_status data_set_is_finished(const struct data_set *set, bool *is_finished);

/* Checks that all images are there as they were written, writes the documents and tidies up.
 * Errors: INPUT (what is missing), STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
sonject_status data_set_finish(struct data_set *set);

/* An image's record, and where they are not NULL its truth, each for json_decref, and the path of
 * its pixels, for free(). Every member that documents take is checked: what is not as it should be
 * is INPUT. Errors: also STORAGE, MEMORY. */
sonject_status data_set_image(const struct data_set *set, size_t split, uint64_t id,
                              json_t **record, json_t **truth, char **image);

/* Whether an image is there, each file as its record says. *changed, where it is NULL, becomes the
 * path of a file that is not, or of a damaged record, for free(); changed may be NULL. Errors:
 * STORAGE, MEMORY. */
sonject_status data_set_has_image(const struct data_set *set, size_t split, uint64_t id,
                                  char **changed, bool *has);

/* The text of a member, "" if there is none. */
const char *member_text(const json_t *object, const char *key);

/* Whether a member is a text that may stand in documents and on terminals, and is not empty. */
bool has_plain(const json_t *object, const char *key);

/* Whether a value is a list, and all of its elements are what is_one takes. */
bool all_are(const struct data_set *set, const json_t *list,
             bool (*is_one)(const struct data_set *set, const json_t *element));

/* Each writes its document from images that are all there. Errors: as data_set_finish. */
sonject_status write_contact_sheet(const struct data_set *set);
sonject_status write_report_page(const struct data_set *set);

#endif
