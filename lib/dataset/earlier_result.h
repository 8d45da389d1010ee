/* What a folder holds of an earlier call: a result whose last document names what it was made of
 * and its files. */
#ifndef SONJECT_DATASET_EARLIER_RESULT_H
#define SONJECT_DATASET_EARLIER_RESULT_H

#include <jansson.h>

#include "base/report.h"
#include "scene/scene.h"

#define RUN_DOCUMENT "run.json"

struct earlier_request {
    const char *folder, *document; /* the name of its last one, such as RUN_DOCUMENT */
    const json_t *inputs;          /* of the call's result */
    const struct scene *scene;     /* whose input may be a file */
    uint32_t label_formats;        /* that are wanted */
    bool overwrites;               /* another result may be given up */
    bool hashes_all;               /* see file_entry_holds */
};

/* Whether the folder holds the call's result, every file of it as it was written. One with a file
 * that is not so, or without wanted labels, is to be made again. Errors: ARGUMENT (another result;
 * the message names what differs), STORAGE, MEMORY. */
sonject_status earlier_check(struct report *report, const struct earlier_request *request,
                             bool *is_finished);

/* Whether inputs are the same: two objects whose members name each. image: the name of one that
 * differs besides, or NULL. Errors: ARGUMENT (they differ, and overwrites is false: the message
 * names the first), MEMORY. */
sonject_status inputs_check(struct report *report, const char *folder, const json_t *there,
                            const json_t *here, const char *image, bool overwrites, bool *is_same);

/* The same as earlier_check of a folder whose inputs are not known. Errors: INPUT (there is no
 * result, a file of it is not as it was written, or labels are missing), STORAGE, MEMORY. */
sonject_status earlier_check_merged(struct report *report, const char *folder,
                                    uint32_t label_formats);

/* Removes a result's document, so that the folder is not taken for complete while another is
 * written over it, and returns the list of its files, for earlier_tidy. Never fails. */
json_t *earlier_withdraw(const char *folder, const char *document);

/* Removes the files of an earlier result that are not among the new ones, and what dead processes
 * left; releases the earlier list. Never fails. */
void earlier_tidy(const char *folder, json_t *earlier, const json_t *files);

/* Adds to a document what earlier_check reads: inputs and list of files are copied by reference.
 * Errors: STORAGE, MEMORY. */
sonject_status earlier_describe(struct report *report, json_t **document, json_t *inputs,
                                json_t *files, const struct scene *scene);

/* Whether a run's results are in the folder. */
bool folder_has_result(const char *folder);

/* A document of the folder, for json_decref; NULL where there is none or it is damaged. Errors:
 * STORAGE, MEMORY. */
sonject_status earlier_document(struct report *report, const char *folder, const char *name,
                                json_t **document);

#endif
