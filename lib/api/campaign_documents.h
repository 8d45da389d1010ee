/* The documents of a whole data set, from what lies in its folder. */
#ifndef SONJECT_API_CAMPAIGN_DOCUMENTS_H
#define SONJECT_API_CAMPAIGN_DOCUMENTS_H

#include <stdio.h>

#include "api/campaign_files.h"
#include "api/campaign_handle.h"

#define CLASSES_MAX (2 * CAMPAIGN_ITEMS_MAX)

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

/* Publishes campaign.json, or checks that the folder's is this campaign's. device: what images are
 * made on if they depend on that, or NULL. Errors: INPUT (it is another's, another version's, or of
 * another device), STORAGE, MEMORY. */
sonject_status data_set_begin(struct sonject_campaign *campaign, const struct device *device,
                              const char *folder);

/* Opens a folder by its campaign.json. Errors: INPUT, STORAGE, MEMORY. */
sonject_status data_set_open(struct data_set *set, struct report *report, const char *folder);
void data_set_clear(struct data_set *set);

/* Whether the documents are there, the last of them at least. */
bool data_set_is_finished(const struct data_set *set);

/* Checks that all images are there, writes the documents and tidies up. Errors: INPUT (what is
 * missing), STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
sonject_status data_set_finish(struct data_set *set);

/* An image's record, and its truth where that is not NULL, each for json_decref. Errors: INPUT,
 * STORAGE, MEMORY. */
sonject_status data_set_image(const struct data_set *set, size_t split, uint64_t id,
                              json_t **record, json_t **truth);

/* The text of a member, "" if there is none; its number, NAN if there is none. */
const char *member_text(const json_t *object, const char *key);
double member_number(const json_t *object, const char *key);

/* Each writes its documents from images that are all there. Errors: as data_set_finish. */
sonject_status write_data_set_coco(const struct data_set *set);
sonject_status write_contact_sheet(const struct data_set *set);
sonject_status write_report_page(const struct data_set *set);

#endif
