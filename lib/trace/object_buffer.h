/* The buffer that kernels find objects in: a record of each part, behind them the seabed's relief
 * (kernels/relief_records.h), the meshes, what users' shapes are told and, where there are many,
 * the hierarchy over all. Rays of a launch that is aimed at one part can meet few others: of much
 * clutter, only what lies in the way goes to the device. */
#ifndef SONJECT_TRACE_OBJECT_BUFFER_H
#define SONJECT_TRACE_OBJECT_BUFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/relief.h"
#include "trace/tracer.h"

/* Four-byte words that it takes: record, heights, slopes, blocks. */
size_t relief_word_count(const struct relief *relief);

/* Writes them. words: room for relief_word_count. */
void relief_words_init(uint32_t *words, const struct relief *relief);

struct launch_parts {
    uint32_t *numbers; /* of the scene's parts, ascending; owned */
    uint32_t count;
    uint32_t target; /* index of the part that is aimed at */
};

/* All rays stay in planes across the track on the grid's strips. is_straight: they also stay in the
 * elevations of the part as seen from the sonar, and what lies behind it does not matter. Few parts
 * are all listed. Errors: MEMORY. */
sonject_status launch_parts_init(struct launch_parts *parts, const struct tracer *tracer,
                                 uint32_t target, const struct line_grid *grid, bool is_straight);
void launch_parts_clear(struct launch_parts *parts);

/* Objects of a launch: records of its parts in a frame; tiles left 0. */
sonject_status launch_records_create(struct object_record **records, const struct tracer *tracer,
                                     const struct launch_parts *parts, const double origin[3]);

/* Where the relief is, in words from the first record of a launch that knows so many parts; 0 where
 * there is none. */
uint32_t object_buffer_relief_words(const struct tracer *tracer, uint32_t part_count);

/* records: those of the parts listed; where their meshes and the hierarchy lie is filled in.
 * Errors: INPUT (too large for the device), DEVICE, MEMORY. */
sonject_status object_buffer_create(struct tracer *tracer, struct object_record *records,
                                    struct part_list parts, device_buffer *buffer);

#endif
