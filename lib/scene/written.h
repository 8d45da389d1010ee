/* Where each key of a scene stands in its file, for what is found wrong only once the image and its
 * geometry are known. */
#ifndef SONJECT_SCENE_WRITTEN_H
#define SONJECT_SCENE_WRITTEN_H

#include <stddef.h>

#include "base/report.h"

struct scene;

struct written_key {
    char *path;  /* owned: "objects[0].position" */
    char *place; /* within path's memory: "scene.yaml:12:5", "--set objects[0].position" */
};

/* Starts as all zeros, as that of a scene without a file stays. */
struct written_keys {
    struct written_key *keys; /* owned */
    size_t count;
};

/* Adds a key, whose section has been added before. Errors: MEMORY. */
sonject_status written_keys_add(struct written_keys *written, struct report *report,
                                const char *path, const char *place);
void written_keys_clear(struct written_keys *written);

/* Puts in front of the report's message where the scene's file has the key that path (a format)
 * names, or the nearest section around it. Returns status. Leaves the message as it is where status
 * is not INPUT or the file has no such key. */
sonject_status scene_locate(const struct scene *scene, struct report *report, sonject_status status,
                            const char *path, ...) REPORT_FORMAT(4);

#endif
