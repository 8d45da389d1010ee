/* Positions in a recording: the geometry of its rows, and its track. */
#include "swath/recording.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"

#define PI               3.14159265358979323846
#define EQUATOR_RADIUS_M 6378137.0
#define ECCENTRICITY_2   6.69437999014e-3 /* squared eccentricity of WGS 84 */
#define HIGHEST_LATITUDE 89.9 /* degrees; nearer to a pole, east and west mean nothing */
#define COURSE_ROWS      25.0 /* least rows on either side over which a course is measured */
#define COURSE_M         20.0 /* least way over which a course is measured */

/* Returns false for a ping that the recorder left empty or had no navigation for. */
static bool ping_has_position(const struct recorded_ping *ping)
{
    return ping->easting != 0.0 || ping->northing != 0.0;
}

/* Finds the length of a unit of x and of y, m. */
static void unit_sizes(bool is_geographic, double y, double *x_m, double *y_m)
{
    *x_m = *y_m = 1.0;
    if (is_geographic) {
        const double latitude = y / DEGREES_PER_RADIAN;
        const double w = 1.0 - ECCENTRICITY_2 * sin(latitude) * sin(latitude);
        *x_m = EQUATOR_RADIUS_M / sqrt(w) * cos(latitude) / DEGREES_PER_RADIAN;
        *y_m = EQUATOR_RADIUS_M * (1.0 - ECCENTRICITY_2) / (w * sqrt(w)) / DEGREES_PER_RADIAN;
    }
}

/* Returns the straight distance between two pings with positions, m. */
static double distance_between(const struct recording *file, const struct recorded_ping *a,
                               const struct recorded_ping *b)
{
    const double across = b->easting - a->easting;
    double x_m, y_m;
    unit_sizes(file->is_geographic, 0.5 * (a->northing + b->northing), &x_m, &y_m);
    return hypot((file->is_geographic ? remainder(across, 360.0) : across) * x_m,
                 (b->northing - a->northing) * y_m);
}

/* Extends a range of rows by its length on either side. Returns false if the range already held all
 * rows of the file. */
static bool widen(const struct recording *file, uint64_t *first, uint64_t *end)
{
    const uint64_t rows = file->rows;
    const uint64_t more = *end - *first;
    const bool is_more = *first > 0 || *end < rows;
    *first -= more < *first ? more : *first;
    *end += more < rows - *end ? more : rows - *end;
    return is_more;
}

/* Returns the mean row spacing between the first and last position of the rows, m. Takes in rows
 * around them until there are two positions; NaN if there are none. */
static double mean_spacing(const struct recording *file, uint64_t first, uint64_t end)
{
    do {
        uint64_t from = first;
        uint64_t to = end - 1;
        while (from < to && !ping_has_position(&file->pings[from]))
            from++;
        while (from < to && !ping_has_position(&file->pings[to]))
            to--;
        if (from < to)
            return distance_between(file, &file->pings[from], &file->pings[to]) /
                   (double)(to - from);
    } while (widen(file, &first, &end));
    return NAN;
}

/* Reads the altitudes of the rows' pings, or of pings around the rows if none of these has one. All
 * altitudes are 0 if the file has none. */
static void read_altitudes(const struct recording *file, uint64_t first, uint64_t end,
                           struct recording_geometry *geometry)
{
    uint64_t sounded = 0;
    geometry->altitude_m = geometry->lowest_altitude_m = geometry->highest_altitude_m = 0.0;
    do {
        double sum = 0.0;
        for (uint64_t row = first; row < end; row++) {
            const double altitude = (double)file->pings[row].altitude_m;
            if (!(altitude > 0.0))
                continue;
            geometry->lowest_altitude_m =
                sounded > 0 ? fmin(geometry->lowest_altitude_m, altitude) : altitude;
            geometry->highest_altitude_m = fmax(geometry->highest_altitude_m, altitude);
            sum += altitude;
            sounded++;
        }
        if (sounded > 0)
            geometry->altitude_m = sum / (double)sounded;
    } while (sounded == 0 && widen(file, &first, &end));
}

bool recording_altitude_varies(const struct recording_geometry *geometry)
{
    return geometry->highest_altitude_m - geometry->lowest_altitude_m > 0.1 * geometry->altitude_m;
}

struct recording_geometry recording_geometry_of(const struct recording *file, uint64_t first_row,
                                                uint64_t count)
{
    const struct recorded_ping *first = &file->pings[first_row];
    struct recording_geometry geometry;
    geometry.row_spacing_m = mean_spacing(file, first_row, first_row + count);
    read_altitudes(file, first_row, first_row + count, &geometry);
    const double near_edge = recorded_near_edge_m(first);
    geometry.column_spacing_m = ((double)first->slant_range_m - near_edge) / (double)file->columns;
    geometry.first_slant_range_m = near_edge + 0.5 * geometry.column_spacing_m;
    return geometry;
}

void track_clear(struct track *track)
{
    free(track->fixes);
    free(track->headings_deg);
    memset(track, 0, sizeof *track);
}

/* Returns whether a ping has a valid position that differs from the last fix. */
static bool is_new_fix(const struct track *track, const struct recorded_ping *ping)
{
    const struct track_fix *last =
        track->fix_count > 0 ? &track->fixes[track->fix_count - 1] : NULL;
    if (!ping_has_position(ping))
        return false;
    if (track->is_geographic &&
        (fabs(ping->northing) > HIGHEST_LATITUDE || fabs(ping->easting) > 360.0))
        return false;
    return !last || last->x < ping->easting || last->x > ping->easting ||
           last->y < ping->northing || last->y > ping->northing;
}

sonject_status track_of_recording(struct track *track, struct report *report,
                                  const struct recording *file)
{
    const size_t rows = (size_t)file->rows;
    bool has_headings = false;
    bool are_angles = true;
    size_t told = rows; /* the last row so far whose ping has data; `rows`: none yet */
    memset(track, 0, sizeof *track);
    track->rows = rows;
    track->is_geographic = file->is_geographic;
    track->fixes = allocate_array(rows, sizeof *track->fixes);
    track->headings_deg = allocate_array(rows, sizeof *track->headings_deg);
    if (!track->fixes || !track->headings_deg) {
        track_clear(track);
        return report_out_of_memory(report, "the track");
    }
    for (size_t row = 0; row < rows; row++) {
        const struct recorded_ping *ping = &file->pings[row];
        const bool is_empty = ping->heading_deg == 0.0f && !ping_has_position(ping);
        track->headings_deg[row] =
            is_empty && told < rows ? track->headings_deg[told] : ping->heading_deg;
        for (size_t before = 0; !is_empty && told == rows && before < row; before++)
            track->headings_deg[before] = ping->heading_deg;
        told = is_empty ? told : row;
        has_headings = has_headings || ping->heading_deg != 0.0f;
        are_angles = are_angles && fabsf(ping->heading_deg) <= 360.0f;
        if (is_new_fix(track, ping)) {
            const struct track_fix fix = {(double)row, ping->easting, ping->northing};
            track->fixes[track->fix_count++] = fix;
        }
    }
    if (!has_headings || !are_angles) {
        free(track->headings_deg);
        track->headings_deg = NULL;
    }
    return SONJECT_OK;
}

/* Returns the way from one x to another, for longitudes the short way round. */
static double step_in_x(const struct track *track, double from, double to)
{
    return track->is_geographic ? remainder(to - from, 360.0) : to - from;
}

/* Interpolates the position at a row between the two fixes around the row. Beyond the first or last
 * fix, extrapolates from the two nearest. */
static void position_at(const struct track *track, double row, double *x, double *y)
{
    const struct track_fix *fixes = track->fixes;
    size_t low = 0;
    size_t high = track->fix_count - 1; /* no lower than the first fix beyond the row */
    *x = fixes[0].x;
    *y = fixes[0].y;
    if (high == 0)
        return;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (fixes[middle].row <= row)
            low = middle;
        else
            high = middle;
    }
    const double share = (row - fixes[low].row) / (fixes[high].row - fixes[low].row);
    *x = fixes[low].x + share * step_in_x(track, fixes[low].x, fixes[high].x);
    *y = fixes[low].y + share * (fixes[high].y - fixes[low].y);
}

/* Finds the course about a row. Returns false if the fixes tell none. Positions are rounded, some
 * to 0.2 m, so the way that is measured must be long enough for its direction. It lies between the
 * first and the last fix. */
static bool course_at(const struct track *track, double row, double *heading)
{
    const double first = track->fixes[0].row;
    const double last = track->fixes[track->fix_count - 1].row;
    for (double reach = COURSE_ROWS;; reach *= 2.0) {
        double x0, y0, x1, y1, x_m, y_m;
        const double from = fmax(first, fmin(row - reach, last - 2.0 * reach));
        const double to = fmin(last, from + 2.0 * reach);
        position_at(track, from, &x0, &y0);
        position_at(track, to, &x1, &y1);
        unit_sizes(track->is_geographic, 0.5 * (y0 + y1), &x_m, &y_m);
        const double east = step_in_x(track, x0, x1) * x_m;
        const double north = (y1 - y0) * y_m;
        *heading = atan2(east, north);
        if (hypot(east, north) >= COURSE_M || to - from >= last - first)
            return east != 0.0 || north != 0.0;
    }
}

/* Interpolates the headings of the rows on both sides, the short way round; rad. */
static double recorded_heading(const struct track *track, double row)
{
    const size_t low = (size_t)row;
    const size_t high = low + 1 < track->rows ? low + 1 : low;
    const double from = (double)track->headings_deg[low];
    const double turn = remainder((double)track->headings_deg[high] - from, 360.0);
    return (from + (row - (double)low) * turn) / DEGREES_PER_RADIAN;
}

bool track_place(const struct track *track, double row, double ground_range_m, bool is_to_port,
                 struct place *place)
{
    double heading, x, y, x_m, y_m;
    if (track->fix_count == 0 || !isfinite(row) || !isfinite(ground_range_m))
        return false;
    row = fmin(fmax(row, 0.0), (double)track->rows - 1.0);
    if (track->headings_deg)
        heading = recorded_heading(track, row);
    else if (!course_at(track, row, &heading))
        return false;
    position_at(track, row, &x, &y);
    unit_sizes(track->is_geographic, y, &x_m, &y_m);
    const double bearing = heading + (is_to_port ? -0.5 : 0.5) * PI;
    place->x = x + ground_range_m * sin(bearing) / x_m;
    place->y = y + ground_range_m * cos(bearing) / y_m;
    if (track->is_geographic)
        place->x = remainder(place->x, 360.0);
    place->heading_deg = fmod(heading * DEGREES_PER_RADIAN + 720.0, 360.0);
    return fabs(place->y) <= 90.0 || !track->is_geographic;
}
