/* Pieces of work that the library does, each from making a context to releasing it. They leave
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
    struct temporary_folder *folder; /* scene, targets and input image */
    char scene[WORK_PATH], campaign[WORK_PATH], image[WORK_PATH], seabed[WORK_PATH],
        impulses[WORK_PATH];
    char results[WORK_PATH]; /* folder of what the work leaves */
    char message[1024];      /* of the last piece's failure, "" if the context was not made */
    uint64_t digest;         /* of the numbers that the last piece returned */
    /* What the piece leaves when nothing fails. */
    uint64_t expected_digest;
    struct work_file expected[WORK_FILES];
    size_t expected_count;
};

/* A piece of work, in a context and, where it wants one, with the scene. */
struct work_piece {
    const char *name;
    sonject_status (*act)(struct work *work, sonject_context *context, sonject_scene *scene);
    bool has_scene;
};

extern const struct work_piece work_read, work_inject, work_measure, work_check, work_run,
    work_quicklook, work_seabed, work_trace, work_form, work_shards, work_campaign;

sonject_status work_do(struct work *work, const struct work_piece *piece);

/* Set-up and tear-down; 0, or 1 where it failed. */
int work_prepare(struct work *work);
int work_remove(struct work *work);

/* Takes what the piece left just now for right, and removes it. */
void work_expect(struct work *work);

/* Fails the test unless what is there under final names is right, whole where run.json or
 * dataset.json is there, and without a part of a file; where is_done, all must be there. Removes
 * it. */
void work_check_results(struct work *work, bool is_done);

#endif
