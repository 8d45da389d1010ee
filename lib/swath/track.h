/* The track that a recording was made on: where the sonar was at each row of the image. */
#ifndef SONJECT_SWATH_TRACK_H
#define SONJECT_SWATH_TRACK_H

#include <stdbool.h>

#include "base/report.h"

struct xtf_file;

/* Where the recorder wrote a new position. */
struct track_fix {
    double row;
    double x, y; /* degrees of longitude and latitude, or m east and north */
};

/* All zeros: there is none. */
struct track {
    struct track_fix *fixes; /* owned; rows rise, each fix differs from the one before */
    size_t fix_count;
    float *headings_deg; /* owned; clockwise from north, of each row; NULL: the track's course */
    uint64_t rows;
    bool is_geographic; /* x and y are degrees */
};

struct place {
    double x, y;        /* as of the track; longitudes -180...180 */
    double heading_deg; /* of the sonar there, 0...360 */
};

/* Takes what a recording says. Rows without a position, and rows that repeat the one before, are
 * between fixes; headings count if all are angles and one of them is not 0, and a ping with neither
 * has the heading of the one before. Errors: MEMORY. On success to be given to track_clear; on
 * failure nothing is held. */
sonject_status track_of_recording(struct track *track, struct report *report,
                                  const struct xtf_file *file);
void track_clear(struct track *track);

/* Where something lies at a row, which may be fractional, so far abeam of the track: positions are
 * linear between fixes. On the WGS 84 ellipsoid where the track is geographic. False where the
 * track does not tell it. */
bool track_place(const struct track *track, double row, double ground_range_m, bool is_to_port,
                 struct place *place);

#endif
