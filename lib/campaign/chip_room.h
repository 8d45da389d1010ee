/* Where in a swath chips may lie: inside, and touching no box that is to be avoided. */
#ifndef SONJECT_CAMPAIGN_CHIP_ROOM_H
#define SONJECT_CAMPAIGN_CHIP_ROOM_H

#include <stdint.h>

#include "base/report.h"
#include "image/raster.h"

/* First pixels of chips, in bands of rows that have the same columns. */
struct column_range {
    uint64_t first, count;
};

struct row_band {
    uint64_t first_row, rows;
    uint64_t columns; /* of all its ranges */
    size_t first_range, ranges;
};

struct chip_room {
    struct row_band *bands; /* owned */
    struct column_range *ranges;
    size_t band_count, range_count;
    uint64_t places; /* 0: there is no room */
};

/* chips: the first pixels that a chip may have if nothing is to be avoided; avoid: those that it
 * may not have, count boxes, which may reach beyond. room: for chip_room_clear, also on failure.
 * Errors: MEMORY. */
sonject_status chip_room_init(struct chip_room *room, struct report *report,
                              const struct region *chips, const struct region *avoid, size_t count);
void chip_room_clear(struct chip_room *room);

/* The place that two deviates of [0, 1) choose: rows by the number of places that they have, and
 * all places of a row alike. The room must have places. */
void chip_room_choose(const struct chip_room *room, double along_track, double range, uint64_t *row,
                      uint64_t *column);

#endif
