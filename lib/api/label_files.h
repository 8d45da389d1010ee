/* The files of labels in a run's folder. */
#ifndef SONJECT_API_LABEL_FILES_H
#define SONJECT_API_LABEL_FILES_H

#include "api/documents.h"

/* Writes coco.json, contacts.json, contacts.csv, and what formats (sum of sonject_labels) asks for;
 * label files of other formats that an earlier run left are removed. Errors: STORAGE, MEMORY. */
sonject_status write_labels(struct report *report, const struct run_facts *facts,
                            const char *folder);

#endif
