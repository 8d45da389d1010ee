#include "trace/ray_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define PIECES_FEWEST  64
#define PIECES_MOST    16384
#define OFFSET_ERROR_M 1.0e-6 /* of a cubic in the middle of its piece; a phase wants no more */
#define NEAREST_M      1.0e-3 /* ground range of a point that is straight under the sonar, or behind */

void ray_table_clear(struct ray_table *table)
{
    free(table->pieces);
    memset(table, 0, sizeof *table);
}

/* The height where the last stretch of straight water begins. */
static double edge_height(const struct water_way *way)
{
    return way->comes_from_seabed ? 0.0 : way->water->layers[1].bottom_m;
}

struct elevations elevations_of_points(const struct water_way *way, double origin_grazing_rad,
                                       const double (*points)[2], size_t count)
{
    struct elevations elevations = {INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        double height = points[i][1];
        if (!way->is_straight)
            height = way->comes_from_seabed ? fmax(height, 0.0) : fmin(height, edge_height(way));
        const double elevation =
            origin_grazing_rad - water_way_grazing(way, fmax(points[i][0], NEAREST_M), height);
        elevations.lowest = fmin(elevations.lowest, elevation);
        elevations.highest = fmax(elevations.highest, elevation);
    }
    return elevations;
}

/* A frame's origin as seen on a way. */
struct aim {
    const struct water_way *way;
    double ground_range, height, grazing, range;
};

/* The ray of an elevation where it passes closest to the origin. */
struct passing_ray {
    double offset, offset_growth, range, spreading;
};

static struct passing_ray pass(const struct aim *aim, double elevation)
{
    const double grazing = aim->grazing - elevation;
    const double edge = edge_height(aim->way);
    const struct water_ray ray = water_way_ray(aim->way, grazing, edge);
    const double beyond = ray.ground_range_m - aim->ground_range;
    const double above = edge - aim->height;
    const double along = beyond * cos(grazing) - above * sin(grazing);
    struct passing_ray passing;
    passing.offset = beyond * sin(grazing) + above * cos(grazing);
    passing.offset_growth = ray.wavefront_m - along;
    passing.range = ray.straight_range_m - along - aim->range;
    passing.spreading = ray.spreading;
    return passing;
}

/* The cubic between two rays `step` rad apart. */
static struct ray_piece_record piece_between(const struct passing_ray *lower,
                                             const struct passing_ray *upper, double step)
{
    const double rise = upper->offset - lower->offset;
    const double first = step * lower->offset_growth;
    const double last = step * upper->offset_growth;
    struct ray_piece_record piece;
    piece.offset[0] = (float)lower->offset;
    piece.offset[1] = (float)first;
    piece.offset[2] = (float)(3.0 * rise - 2.0 * first - last);
    piece.offset[3] = (float)(first + last - 2.0 * rise);
    piece.range = (float)lower->range;
    piece.spreading = (float)lower->spreading;
    piece.spreading_growth = (float)(upper->spreading - lower->spreading);
    return piece;
}

/* How far the cubic's middle is off the ray there. */
static double error_between(const struct aim *aim, const struct passing_ray *lower,
                            const struct passing_ray *upper, double middle, double step)
{
    const double cubic = 0.5 * (lower->offset + upper->offset) +
                         0.125 * step * (lower->offset_growth - upper->offset_growth);
    return fabs(cubic - pass(aim, middle).offset);
}

static double fill_pieces(const struct aim *aim, const struct ray_table_record *record,
                          struct ray_piece_record *pieces)
{
    const double step = record->radians_per_piece;
    double worst = 0.0;
    double elevation = record->first_elevation;
    struct passing_ray lower = pass(aim, elevation);
    for (int32_t i = 0; i < record->pieces; i++) {
        const double middle = record->first_elevation + (i + 0.5) * step;
        elevation = record->first_elevation + (i + 1.0) * step;
        const struct passing_ray upper = pass(aim, elevation);
        const double error = error_between(aim, &lower, &upper, middle, step);
        worst = isfinite(error) ? fmax(worst, error) : INFINITY;
        pieces[i] = piece_between(&lower, &upper, step);
        lower = upper;
    }
    return worst;
}

sonject_status ray_table_add(struct ray_table *table, struct report *report,
                             const struct water_way *way, double ground_range_m, double height_m,
                             struct elevations elevations, struct ray_table_record *record)
{
    memset(record, 0, sizeof *record);
    record->ground_range = (float)ground_range_m;
    if (way->is_straight)
        return SONJECT_OK;
    const struct aim aim = {way, ground_range_m, height_m,
                            water_way_grazing(way, ground_range_m, height_m),
                            water_way_range(way, ground_range_m, height_m)};
    record->first_piece = (int32_t)table->count;
    record->first_elevation = (float)elevations.lowest;
    double error = INFINITY;
    for (int32_t count = PIECES_FEWEST; count <= PIECES_MOST && error > OFFSET_ERROR_M;
         count *= 4) {
        const size_t total = table->count + (size_t)count;
        struct ray_piece_record *pieces = realloc(table->pieces, total * sizeof *pieces);
        CHECK_MEMORY(report, pieces, "the rays through the layers");
        table->pieces = pieces;
        record->pieces = count;
        record->radians_per_piece = (float)((elevations.highest - elevations.lowest) / count);
        record->pieces_per_radian = 1.0f / record->radians_per_piece;
        error = fill_pieces(&aim, record, pieces + table->count);
    }
    table->count += (size_t)record->pieces;
    if (error > OFFSET_ERROR_M)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "sound reaches %.1f m ground range so near to total reflection by a "
                              "layer of water that its rays cannot be told apart: move the patch "
                              "inwards",
                              ground_range_m);
    return SONJECT_OK;
}
