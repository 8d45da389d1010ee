/* The hierarchy over many objects that kernels look for the nearest in (kernels/object_tree.h). */
#ifndef SONJECT_TRACE_OBJECT_TREE_H
#define SONJECT_TRACE_OBJECT_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"
#include "kernels/layout.h"
#include "kernels/object_tree_records.h"

/* A record and its branches, in 4-byte words as the device reads them. */
struct object_tree {
    uint32_t *words; /* owned */
    size_t count;    /* 0: few objects, which need no tree */
};

/* A box about an object, m from its centre, in axes of the frame: it reaches so far each way. */
struct object_reach {
    double lower[3], upper[3]; /* lower <= 0 <= upper */
};

/* Builds the tree over `count` objects, by the surface-area heuristic. reaches: one for each
 * record. The same objects give the same tree everywhere. Errors: MEMORY; on failure *tree is
 * empty. */
sonject_status object_tree_build(struct report *report, const struct object_record *records,
                                 const struct object_reach *reaches, uint32_t count,
                                 struct object_tree *tree);
void object_tree_clear(struct object_tree *tree);

#endif
