/* The kernels' knowledge of targets. The buffer of objects holds a record of each part, then the
 * seabed's relief (kernels/layout.h), the meshes and fouling. For many parts the hierarchy over all
 * comes last (kernels/object_tree.h). Rays of a launch aimed at one part meet few others, so only
 * parts in the way go to the device. Spheres around the targets lead rays from the seabed. */
#ifndef SONJECT_TRACE_OBJECT_BUFFER_H
#define SONJECT_TRACE_OBJECT_BUFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "kernels/layout.h"
#include "scene/relief.h"
#include "trace/tracer.h"

/* Returns the four-byte words that the relief takes: record, heights, slopes, blocks. */
size_t relief_word_count(const struct relief *relief);

/* Writes the relief's words. words: room for relief_word_count. */
void relief_words_init(uint32_t *words, const struct relief *relief);

/* The parts that a launch knows, in the order of its records. */
struct part_list {
    uint32_t *numbers; /* numbers of the scene's parts, ascending; owned; NULL: 0, 1, 2... */
    uint32_t count;
    uint32_t target; /* index of the part that is aimed at, if any */
};

struct part_list all_parts(const struct tracer *tracer);

/* Lists the parts that rays aimed at a part may meet, or all parts where they are few. Rays stay in
 * planes across the track on the grid's strips. is_straight: rays also stay in the part's
 * elevations as seen from the sonar, and parts behind it do not matter. Errors: MEMORY. */
sonject_status parts_in_way(struct part_list *parts, const struct tracer *tracer, uint32_t target,
                            const struct line_grid *grid, bool is_straight);
void part_list_clear(struct part_list *parts);

/* Fills in the record of one part in a frame. Its tile is left 0. */
void object_record_init(struct object_record *record, const struct tracer *tracer,
                        const struct placement *placement, const double origin[3]);

/* Makes the records of parts, which the caller frees. Errors: MEMORY; then *records is NULL. */
sonject_status object_records_create(struct object_record **records, const struct tracer *tracer,
                                     const struct part_list *parts, const double origin[3]);

/* Makes the buffer of objects. records: those of the parts listed; the places of their meshes and
 * of the hierarchy are filled in. Errors: INPUT (too large for the device), DEVICE, MEMORY. */
sonject_status object_buffer_create(struct tracer *tracer, struct object_record *records,
                                    const struct part_list *parts, device_buffer *buffer);

struct rough_trace;

/* Adds a buffer of objects to a launch: the parts in a frame about an origin. tiles: the trace that
 * tallies what the objects return, or NULL. */
sonject_status launch_add_objects(struct launch *launch, struct tracer *tracer,
                                  const struct part_list *parts, const double origin[3],
                                  const struct rough_trace *tiles);

/* Returns the place of the relief, in words from the first record of a launch that knows so many
 * parts; 0 if there is none. */
uint32_t object_buffer_relief_words(const struct tracer *tracer, uint32_t part_count);

/* Tells a fan which parts its launch knows, and which part it is aimed at. */
void fan_set_parts(struct fan_record *fan, const struct tracer *tracer,
                   const struct part_list *parts);

/* The record and the branches of a tree, in 4-byte words as the device reads them. */
struct object_tree {
    uint32_t *words; /* owned */
    size_t count;    /* 0: few objects, which need no tree */
};

/* Builds the hierarchy over a launch's parts, by the surface-area heuristic. The same objects give
 * the same tree everywhere. Errors: MEMORY; on failure *tree is empty. */
sonject_status object_tree_build(const struct tracer *tracer, const struct object_record *records,
                                 const struct part_list *parts, struct object_tree *tree);

/* Spheres around the targets. The groups of many spheres come behind them, then room for as many
 * target records as there are parts. */
struct target_spheres {
    struct sphere_record *records; /* owned; spheres, groups, spheres around groups */
    uint32_t count, groups;        /* groups 0: few spheres */
    size_t bytes;                  /* size of all that is filled in so far */
};

/* Covers every part with a row of spheres along its length. A row has about as many spheres as the
 * part is times longer than wide; fewer, but at least one, when there are many parts. Spheres
 * wholly below the seabed are left out. records are for free(), NULL on failure. Errors: MEMORY. */
sonject_status target_spheres_init(struct target_spheres *spheres, const struct tracer *tracer,
                                   const double origin[3]);

/* Returns a launch's part number i. */
static inline const struct placement *placement_of(const struct tracer *tracer,
                                                   const struct part_list *parts, uint32_t i)
{
    return &tracer->placements[parts->numbers ? parts->numbers[i] : i];
}

#endif
