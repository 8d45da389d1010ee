/* Where the files of a campaign's data set lie, and its JSON. */
#ifndef SONJECT_DATASET_CAMPAIGN_FILES_H
#define SONJECT_DATASET_CAMPAIGN_FILES_H

#include <stdbool.h>
#include <stdint.h>

#include <jansson.h>

#include "base/report.h"
#include "dataset/campaign.h"
#include "image/raster.h"

#define OUTPUT_KINDS 7

struct output_file {
    uint32_t output; /* enum output */
    const char *folder, *extension;
};

extern const struct output_file output_files[OUTPUT_KINDS];

/* The files of one image; owned. */
struct image_files {
    size_t folder_length; /* of "folder/split/", which paths begin with */
    char *image, *truth, *record;
    struct {
        const struct output_file *kind;
        char *path;
    } outputs[OUTPUT_KINDS];
    size_t output_count;
};

/* ".png" where that stores the pixels as they are, else ".tif". */
const char *image_extension(enum pixel_type type, bool is_complex);

/* files: for image_files_clear, also on failure. Errors: MEMORY. */
sonject_status image_files_init(struct image_files *files, struct report *report,
                                const char *folder, const char *split, uint64_t id,
                                enum pixel_type type, bool is_complex, uint32_t outputs);
void image_files_clear(struct image_files *files);

/* Size and hash of all files but the record, for it. Errors: STORAGE, MEMORY. */
sonject_status image_files_list(const struct image_files *files, struct report *report,
                                json_t **list);

/* Whether they are all there as the list says; *changed is the path of the first that is not, or
 * the record's. Errors: STORAGE, MEMORY. */
sonject_status image_files_check(const struct image_files *files, struct report *report,
                                 const json_t *list, const char **changed);

/* Makes the folders of a split. Errors: STORAGE, MEMORY. */
sonject_status split_folders_make(struct report *report, const char *folder, const char *split,
                                  uint32_t outputs);

/* Removes them with the images in them. Never fails. */
void split_folders_remove(const char *folder, const char *split);

/* folder_tidy on each of them. */
void split_folders_tidy(const char *folder, const char *split, uint32_t outputs);

/* "folder/split/kind/name" for free(); parts may be NULL from the end. NULL when memory is out. */
char *campaign_file(const char *folder, const char *split, const char *kind, const char *name);

#endif
