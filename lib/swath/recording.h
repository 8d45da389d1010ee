/* Recordings of a sidescan, XTF and JSF files: what their pings say, and the track that they were
 * made on. Rows of the image are the pings of a channel, columns range cells from the track
 * outwards. */
#ifndef SONJECT_SWATH_RECORDING_H
#define SONJECT_SWATH_RECORDING_H

#include "scene/params.h"

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"

#define CHANNEL_NUMBER_MAX 63 /* highest number */

enum recorded_side {
    RECORDED_PORT = 1, /* as XTF numbers them */
    RECORDED_STARBOARD = 2
};

/* What the file says of a ping. 0 where it says nothing. */
struct recorded_ping {
    double easting, northing; /* of the sonar, else of the ship, in the file's units */
    float altitude_m;
    float heading_deg;   /* of the sonar, else of the ship; clockwise from north */
    float slant_range_m; /* to the far edge of the last cell */
    float delay_s;       /* until the first cell's near edge */
    float duration_s;    /* of all cells */
    int32_t weight;      /* its samples stand for so many halvings of their numbers */
};

/* Pings, counted from 0 among those of the channel in the file. */
struct ping_list {
    uint64_t *numbers; /* owned */
    uint64_t count;
};

/* What the file says of a channel. */
struct recording {
    struct recorded_ping *pings; /* owned; rows of them */
    uint64_t rows, columns;
    struct ping_list empty; /* those without samples, which make no row */
    uint32_t side;          /* enum recorded_side */
    uint32_t channel;       /* its number */
    bool is_ground_range;   /* samples are equally spaced on the seabed, as the file says */
    bool is_geographic;     /* positions are degrees of longitude and latitude, else m */
};

/* Where a channel's pixels lie. */
struct recording_geometry {
    double row_spacing_m; /* mean; NaN where the file has no positions, 0 where the sonar stood */
    double column_spacing_m;
    double first_slant_range_m; /* of the middle of column 0 */
    double altitude_m;          /* mean; 0 where the file has none */
    double lowest_altitude_m, highest_altitude_m;
};

/* Whether one altitude cannot stand for all of the rows: it changes by more than a tenth. */
bool recording_altitude_varies(const struct recording_geometry *geometry);

/* Geometry of the rows first_row... first_row + count - 1 (within the layout): spacing from the
 * straight line between the first and the last position. Pings without a position, or an altitude,
 * are passed over; where too few have one, the pings around the rows stand in. */
struct recording_geometry recording_geometry_of(const struct recording *file, uint64_t first_row,
                                                uint64_t count);

/* The track that a recording was made on: where the sonar was at each row of the image. */

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
                                  const struct recording *file);
void track_clear(struct track *track);

/* Where something lies at a row, which may be fractional, so far abeam of the track: positions are
 * linear between fixes. On the WGS 84 ellipsoid where the track is geographic. False where the
 * track does not tell it. */
bool track_place(const struct track *track, double row, double ground_range_m, bool is_to_port,
                 struct place *place);

#endif
