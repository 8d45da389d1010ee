/* Runs of several bands, each in a folder of its name. */
#ifndef SONJECT_DATASET_MERGED_BANDS_H
#define SONJECT_DATASET_MERGED_BANDS_H

#include "base/report.h"

/* The names of all bands of the scene of which a folder below this one, which has a band's name,
 * holds shards or a result: one a line, for free(); "" where there is none, or where this folder
 * itself holds a run. Errors: INPUT, STORAGE, MEMORY. */
sonject_status find_bands(struct report *report, const char *folder, char **names);

/* Whether there is a shard or a result of each. Errors: INPUT (names one that has none), STORAGE,
 * MEMORY. */
sonject_status check_bands_begun(struct report *report, const char *folder, const char *names);

/* The next of the names, for free(); NULL where memory is out. There must be one. */
char *take_band(const char **names);

#endif
