/* Pieces of work that the library does, each from making a context to releasing it. A piece leaves
 * files, or numbers that tell whether all came out as it should. */
#ifndef SONJECT_TESTS_WORK_H
#define SONJECT_TESTS_WORK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/sonject.h>

#include "unit/temporary_folder.h"

#define WORK_PATH  (TEMPORARY_CAPACITY + 64)
#define WORK_FILES 32

struct work_file {
    char name[64];
    uint64_t digest;
};

struct work {
    struct temporary_folder *folder; /* holds scene, targets and input image */
    char scene[WORK_PATH], campaign[WORK_PATH], image[WORK_PATH], seabed[WORK_PATH],
        impulses[WORK_PATH];
    char results[WORK_PATH]; /* folder of the work's files */
    char message[1024]; /* message of the last piece's failure; "" if the context was not made */
    uint64_t digest;    /* digest of the numbers that the last piece returned */
    /* Results of a piece when nothing fails. */
    uint64_t expected_digest;
    struct work_file expected[WORK_FILES];
    size_t expected_count;
};

/* A piece of work in a context and, where has_scene is set, with the scene. */
struct work_piece {
    const char *name;
    sonject_status (*act)(struct work *work, sonject_context *context, sonject_scene *scene);
    bool has_scene;
};

extern const struct work_piece work_read, work_inject, work_measure, work_check, work_run,
    work_quicklook, work_seabed, work_trace, work_form, work_shards, work_campaign;

sonject_status work_do(struct work *work, const struct work_piece *piece);

/* Set up and tear down. Return 0, or 1 for failure. */
int work_prepare(struct work *work);
int work_remove(struct work *work);

/* Takes the results that a piece just left as the right ones, and removes them. */
void work_expect(struct work *work);

/* Fails the test unless all files under final names are right and no part of a file is left. All
 * files must be there where run.json or dataset.json is, or is_done is set. Removes the files. */
void work_check_results(struct work *work, bool is_done);

#endif
