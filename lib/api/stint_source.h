/* The scene that tallies keep with them: path and folder of its file, its text, its overrides. */
#ifndef SONJECT_API_STINT_SOURCE_H
#define SONJECT_API_STINT_SOURCE_H

#include "api/run_scene.h"
#include "trace/stint_file.h"

/* Where a scene came from as texts one after the other; of none where it came from no file. The
 * texts are for free(), also on failure. Errors: MEMORY. */
sonject_status stint_source_take(struct stint_source *texts, struct report *report,
                                 const struct scene_source *source);

/* The other way round. head is the caller's for impulse_head_clear, also on failure. Errors: INPUT,
 * MEMORY. */
sonject_status stint_source_read(struct impulse_head *head, struct report *report,
                                 const struct stint_file *file);

#endif
