/* Windows of the patch that hold all that objects can change. */
#ifndef SONJECT_INJECT_WINDOWS_H
#define SONJECT_INJECT_WINDOWS_H

#include <stdbool.h>
#include <stddef.h>

#include "trace/tracer.h"

struct influence_window {
    struct window at;
    bool follows[SCENE_OBJECTS_MAX]; /* the scene's objects in this window */
};

struct influence_windows {
    struct influence_window *list; /* owned */
    size_t count;
};

/* Finds a composite's windows. Each object is in one. A window holds echoes and shadows as far as
 * the point response spreads them (glints' side lobes to -60 dB), seabed that exchanges sound with
 * the objects, and the pixels around from which truth is measured. Overlapping or close windows are
 * joined. There is one window, the patch, where all of it is traced: is_whole, a resynthesis, brute
 * force, relief, residual motion, or no object. Errors: MEMORY. */
sonject_status influence_windows_find(struct influence_windows *windows,
                                      const struct tracer *tracer, bool is_whole);
void influence_windows_clear(struct influence_windows *windows);

#endif
