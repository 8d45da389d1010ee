/* Recordings of a sidescan sonar (XTF and JSF files): the data of their pings, and the track. Image
 * rows are the pings of one channel; columns are range cells, outwards from the track. */
#ifndef SONJECT_SWATH_RECORDING_H
#define SONJECT_SWATH_RECORDING_H

#include "scene/params.h"

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"

#define CHANNEL_NUMBER_MAX 63

enum recorded_side {
    RECORDED_PORT = 1, /* the numbers are XTF's */
    RECORDED_STARBOARD = 2
};

/* A ping's data in the file; 0 where the file has none. */
struct recorded_ping {
    double easting, northing; /* position of the sonar, else of the ship, in the file's units */
    float altitude_m;
    float heading_deg;   /* heading of the sonar, else of the ship, clockwise from north */
    float slant_range_m; /* range of the last cell's far edge */
    float delay_s;       /* time from the ping to the first cell's near edge */
    float duration_s;    /* duration of all cells */
    int32_t weight;      /* amplitude = sample * 2^-weight */
};

/* Numbers of pings, counted from 0 among the channel's pings in the file. */
struct ping_list {
    uint64_t *numbers; /* owned */
    uint64_t count;
};

/* A channel's data in the file. */
struct recording {
    struct recorded_ping *pings; /* owned; `rows` of them */
    uint64_t rows, columns;
    struct ping_list empty; /* pings without samples, which make no row */
    uint32_t side;          /* enum recorded_side */
    uint32_t channel;       /* the channel's number */
    bool is_ground_range;   /* the file says that samples are equally spaced on the seabed */
    bool is_geographic;     /* positions are degrees of longitude and latitude, else m */
};

/* Returns the range of the first cell's near edge, m. */
double recorded_near_edge_m(const struct recorded_ping *ping);

/* The geometry of a channel's pixels. */
struct recording_geometry {
    double row_spacing_m; /* mean; NaN if the file has no positions, 0 if the sonar stood still */
    double column_spacing_m;
    double first_slant_range_m; /* range of the middle of column 0 */
    double altitude_m;          /* mean; 0 if the file has none */
    double lowest_altitude_m, highest_altitude_m;
};

/* Returns whether one altitude cannot stand for all rows, as it changes by more than a tenth. */
bool recording_altitude_varies(const struct recording_geometry *geometry);

/* Returns the geometry of the rows first_row...first_row + count - 1, which must be within the
 * layout. Row spacing is the straight line between the first and the last position over their
 * distance in rows. Pings without a position or altitude are skipped. If too few pings have one,
 * pings around the rows are used as well. */
struct recording_geometry recording_geometry_of(const struct recording *file, uint64_t first_row,
                                                uint64_t count);

/* A row at which the recorder wrote a new position. */
struct track_fix {
    double row;
    double x, y; /* degrees of longitude and latitude, or m east and north */
};

/* The track of a recording: the sonar's position and heading at each row. All zeros: no track. */
struct track {
    struct track_fix *fixes; /* owned; rows increase, and each fix differs from the one before */
    size_t fix_count;
    float *headings_deg; /* owned; one per row, clockwise from north; NULL: the track's course */
    uint64_t rows;
    bool is_geographic; /* x and y are degrees */
};

struct place {
    double x, y;        /* in the track's units; longitudes -180...180 */
    double heading_deg; /* the sonar's heading there, 0...360 */
};

/* Takes the track from a recording. Rows without a position, and rows that repeat the position
 * before, lie between fixes. Headings count if all are angles and at least one is not 0. A ping
 * with neither position nor heading takes the heading of the ping before. Errors: MEMORY. On
 * success the track is for track_clear; on failure nothing is held. */
sonject_status track_of_recording(struct track *track, struct report *report,
                                  const struct recording *file);
void track_clear(struct track *track);

/* Finds the point abeam of the track at a row, which may be fractional, and a ground range.
 * Positions are linear between fixes. Geographic tracks are on the WGS 84 ellipsoid. Returns false
 * if the track does not tell the point. */
bool track_place(const struct track *track, double row, double ground_range_m, bool is_to_port,
                 struct place *place);

#endif
