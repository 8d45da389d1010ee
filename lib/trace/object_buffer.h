/* What kernels know of targets. The buffer that they find objects in: a record of each part, behind
 * them the seabed's relief (kernels/layout.h), the meshes and,
 * where there are many, the hierarchy over all (kernels/object_tree.h). Rays of a launch that is
 * aimed at one part can meet few others: of much clutter, only what lies in the way goes to the
 * device. And spheres that hold the targets: what rays from the seabed are led to. */
#ifndef SONJECT_TRACE_OBJECT_BUFFER_H
#define SONJECT_TRACE_OBJECT_BUFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "kernels/layout.h"
#include "scene/relief.h"
#include "trace/tracer.h"

/* Four-byte words that it takes: record, heights, slopes, blocks. */
size_t relief_word_count(const struct relief *relief);

/* Writes them. words: room for relief_word_count. */
void relief_words_init(uint32_t *words, const struct relief *relief);

/* The parts that a launch knows, in the order of its records. */
struct part_list {
    uint32_t *numbers; /* of the scene's parts, ascending; owned; NULL: 0, 1, 2... */
    uint32_t count;
    uint32_t target; /* index of the part that is aimed at, if one is */
};

struct part_list all_parts(const struct tracer *tracer);

/* Those that rays aimed at a part may meet. All rays stay in planes across the track on the grid's
 * strips. is_straight: they also stay in the elevations of the part as seen from the sonar, and
 * what lies behind it does not matter. Few parts are all listed. Errors: MEMORY. */
sonject_status parts_in_way(struct part_list *parts, const struct tracer *tracer, uint32_t target,
                            const struct line_grid *grid, bool is_straight);
void part_list_clear(struct part_list *parts);

/* The record of one part in a frame; its tile left 0. */
void object_record_init(struct object_record *record, const struct tracer *tracer,
                        const struct placement *placement, const double origin[3]);

/* Records of parts, to be given to free(). Errors: MEMORY; then *records is NULL. */
sonject_status object_records_create(struct object_record **records, const struct tracer *tracer,
                                     const struct part_list *parts, const double origin[3]);

/* records: those of the parts listed; where their meshes and the hierarchy lie is filled in.
 * Errors: INPUT (too large for the device), DEVICE, MEMORY. */
sonject_status object_buffer_create(struct tracer *tracer, struct object_record *records,
                                    const struct part_list *parts, device_buffer *buffer);

struct rough_trace;

/* Adds such a buffer to a launch, of parts in a frame about an origin. tiles: where what the
 * objects return is tallied; NULL: nowhere. */
sonject_status launch_add_objects(struct launch *launch, struct tracer *tracer,
                                  const struct part_list *parts, const double origin[3],
                                  const struct rough_trace *tiles);

/* Where the relief is, in words from the first record of a launch that knows so many parts; 0 where
 * there is none. */
uint32_t object_buffer_relief_words(const struct tracer *tracer, uint32_t part_count);

/* Tells a fan which parts its launch knows, and which it is aimed at. */
void fan_set_parts(struct fan_record *fan, const struct tracer *tracer,
                   const struct part_list *parts);

/* A record and its branches, in 4-byte words as the device reads them. */
struct object_tree {
    uint32_t *words; /* owned */
    size_t count;    /* 0: few objects, which need no tree */
};

/* Builds the hierarchy over a launch's parts, by the surface-area heuristic. The same objects give
 * the same tree everywhere. Errors: MEMORY; on failure *tree is empty. */
sonject_status object_tree_build(const struct tracer *tracer, const struct object_record *records,
                                 const struct part_list *parts, struct object_tree *tree);

/* Spheres, behind them the groups that they lie in where they are many, and room for as many target
 * records as there are parts. */
struct target_spheres {
    struct sphere_record *records; /* owned; count, then the groups, then those around groups */
    uint32_t count, groups;        /* groups 0: few spheres */
    size_t bytes;                  /* of all */
};

/* Covers every part with a row of spheres along its length, about as many as it is times longer
 * than wide (fewer when there are many parts, at least one). Spheres wholly below the seabed are
 * left out. records are the caller's for free(), NULL on failure. Errors: MEMORY. */
sonject_status target_spheres_init(struct target_spheres *spheres, const struct tracer *tracer,
                                   const double origin[3]);

/* A launch's part number i. */
static inline const struct placement *placement_of(const struct tracer *tracer,
                                                   const struct part_list *parts, uint32_t i)
{
    return &tracer->placements[parts->numbers ? parts->numbers[i] : i];
}

#endif
