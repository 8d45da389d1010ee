/* Windows of the patch that hold all that objects can change. */
#ifndef SONJECT_INJECT_WINDOWS_H
#define SONJECT_INJECT_WINDOWS_H

#include <stdbool.h>
#include <stddef.h>

#include "trace/tracer.h"

struct influence_window {
    struct window at;
    bool follows[SCENE_OBJECTS_MAX]; /* the scene's objects that belong to it */
};

struct influence_windows {
    struct influence_window *list; /* owned */
    size_t count;
};

/* Finds windows of a composite, each object in one of them: its echoes and its shadow with all the
 * point response spreads of them (glints' side lobes to -60 dB), seabed that it exchanges sound
 * with, and the pixels about it that its truth is measured from. Windows that overlap, or nearly,
 * are one. Where all of the patch is traced (is_whole; a resynthesis, brute force, relief, residual
 * motion, no object), that is the only one. Errors: MEMORY. */
sonject_status influence_windows_find(struct influence_windows *windows,
                                      const struct tracer *tracer, bool is_whole);
void influence_windows_clear(struct influence_windows *windows);

#endif
