/* The scene that sums keep with them: path and folder of its file, its text, its overrides. */
#ifndef SONJECT_INJECT_KEPT_SCENE_H
#define SONJECT_INJECT_KEPT_SCENE_H

#include <stddef.h>

#include "trace/sums_file.h"

/* The file that a scene was read from, as it was then; owned. */
struct scene_source {
    char *path, *text; /* NULL: it was not read from a file */
    char **overrides;
    size_t override_count;
};

/* Where a scene came from as texts one after the other; of none where it came from no file. The
 * texts are for free(), also on failure. Errors: MEMORY. */
sonject_status kept_scene_join(struct sums_source *texts, struct report *report,
                               const struct scene_source *source);

/* Lies in the texts of a file, but for the list of overrides. All NULL: it came from no file. */
struct kept_scene {
    const char *path, *folder, *text;
    const char **overrides; /* owned */
    size_t override_count;
};

/* kept is the caller's for free(kept->overrides), also on failure. Errors: INPUT, MEMORY. */
sonject_status kept_scene_find(struct kept_scene *kept, struct report *report,
                               const struct sums_file *file);

#endif
