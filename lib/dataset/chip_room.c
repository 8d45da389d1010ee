/* The room that a swath has for images. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/campaign.h"

static int compare_numbers(const void *a, const void *b)
{
    const uint64_t first = *(const uint64_t *)a;
    const uint64_t second = *(const uint64_t *)b;
    return first < second ? -1 : first > second;
}

static int compare_starts(const void *a, const void *b)
{
    const struct region *first = a;
    const struct region *second = b;
    return first->first_column < second->first_column ? -1
                                                      : first->first_column > second->first_column;
}

static uint64_t clip(uint64_t value, uint64_t low, uint64_t high)
{
    return value < low ? low : value > high ? high : value;
}

/* Adds the columns of a band of rows that no box takes; boxes are sorted by their first column. */
static void add_band(struct chip_room *room, const struct region *chips, const struct region *avoid,
                     size_t count, uint64_t row, uint64_t end_row)
{
    const uint64_t end = chips->first_column + chips->columns;
    uint64_t next = chips->first_column; /* that may be free */
    struct row_band band = {row, end_row - row, 0, room->range_count, 0};
    for (size_t i = 0; i <= count; i++) {
        if (i < count && (avoid[i].first_row > row || avoid[i].first_row + avoid[i].rows <= row))
            continue;
        const uint64_t taken = i < count ? clip(avoid[i].first_column, next, end) : end;
        if (taken > next) {
            const struct column_range range = {next, taken - next};
            room->ranges[room->range_count++] = range;
            band.columns += range.count;
            band.ranges++;
        }
        if (i < count && avoid[i].first_column + avoid[i].columns > next)
            next = clip(avoid[i].first_column + avoid[i].columns, next, end);
    }
    if (band.columns > 0)
        room->bands[room->band_count++] = band;
    room->places += band.rows * band.columns;
}

sonject_status chip_room_init(struct chip_room *room, struct report *report,
                              const struct region *chips, const struct region *avoid, size_t count)
{
    const uint64_t end = chips->first_row + chips->rows;
    size_t ranges;
    memset(room, 0, sizeof *room);
    uint64_t *edges = allocate_array(2 * count + 2, sizeof *edges);
    struct region *sorted = allocate_array(count, sizeof *sorted);
    room->bands = allocate_array(2 * count + 1, sizeof *room->bands);
    room->ranges = size_multiply(2 * count + 1, count + 1, &ranges)
                       ? allocate_array(ranges, sizeof *room->ranges)
                       : NULL;
    sonject_status status = edges && sorted && room->bands && room->ranges
                                ? SONJECT_OK
                                : report_out_of_memory(report, "the places for images");
    if (status == SONJECT_OK) {
        size_t edge_count = 0;
        memcpy(sorted, avoid, count * sizeof *sorted);
        qsort(sorted, count, sizeof *sorted, compare_starts);
        for (size_t i = 0; i < count; i++) {
            edges[edge_count++] = clip(avoid[i].first_row, chips->first_row, end);
            edges[edge_count++] = clip(avoid[i].first_row + avoid[i].rows, chips->first_row, end);
        }
        edges[edge_count++] = chips->first_row;
        edges[edge_count++] = end;
        qsort(edges, edge_count, sizeof *edges, compare_numbers);
        for (size_t i = 0; i + 1 < edge_count; i++)
            if (edges[i + 1] > edges[i])
                add_band(room, chips, sorted, count, edges[i], edges[i + 1]);
    }
    struct column_range *fitting =
        realloc(room->ranges, (room->range_count + 1) * sizeof *room->ranges);
    if (fitting)
        room->ranges = fitting;
    free(edges);
    free(sorted);
    return status;
}

void chip_room_clear(struct chip_room *room)
{
    free(room->bands);
    free(room->ranges);
    memset(room, 0, sizeof *room);
}

static uint64_t part_of(uint64_t count, double u)
{
    const uint64_t part = (uint64_t)floor((double)count * u);
    return part < count ? part : count - 1;
}

void chip_room_choose(const struct chip_room *room, double along_track, double range, uint64_t *row,
                      uint64_t *column)
{
    uint64_t place = part_of(room->places, along_track);
    const struct row_band *band = room->bands;
    for (; place >= band->rows * band->columns; band++)
        place -= band->rows * band->columns;
    *row = band->first_row + place / band->columns;
    uint64_t left = part_of(band->columns, range);
    const struct column_range *free_columns = room->ranges + band->first_range;
    for (; left >= free_columns->count; free_columns++)
        left -= free_columns->count;
    *column = free_columns->first + left;
}

static double column_at(const sonject_geometry_params *geometry, double range_m)
{
    return (range_m - geometry->first_slant_range_m) / geometry->column_spacing_m;
}

/* First columns beyond the first return whose chip's middle has a slant range within the limits. */
static void limit_ranges(const struct campaign *campaign, const sonject_geometry_params *geometry,
                         double altitude_m, struct region *chips)
{
    const double half = 0.5 * (double)(campaign->chip_columns - 1);
    double low = fmax((double)chips->first_column, floor(column_at(geometry, altitude_m)) + 1.0);
    double high = (double)chips->first_column + (double)chips->columns - 1.0;
    if (campaign->has_range) {
        low = fmax(low, ceil(column_at(geometry, campaign->nearest_range_m) - half - 1e-9));
        high = fmin(high, floor(column_at(geometry, campaign->farthest_range_m) - half + 1e-9));
    }
    if (!(low <= high)) {
        chips->columns = 0;
        return;
    }
    chips->first_column = (uint64_t)low;
    chips->columns = (uint64_t)(high - low) + 1;
}

/* First pixels of chips that would touch a box. */
static void forbid(const struct campaign *campaign, const struct region *box,
                   struct region *forbidden)
{
    const uint64_t above = (uint64_t)campaign->clearance + campaign->chip_rows - 1;
    const uint64_t before = (uint64_t)campaign->clearance + campaign->chip_columns - 1;
    forbidden->first_row = box->first_row > above ? box->first_row - above : 0;
    forbidden->rows = box->first_row + box->rows + campaign->clearance - forbidden->first_row;
    forbidden->first_column = box->first_column > before ? box->first_column - before : 0;
    forbidden->columns =
        box->first_column + box->columns + campaign->clearance - forbidden->first_column;
}

static sonject_status refuse_size(const struct campaign *campaign, const struct swath_plan *swath)
{
    return tree_failure(&campaign->tree, swath->place, "swaths",
                        "%s has %llu x %llu pixels, too few for images of %u x %u that stay %u "
                        "pixels away from its edges",
                        swath->written, (unsigned long long)swath->layout.rows,
                        (unsigned long long)swath->layout.columns, (unsigned)campaign->chip_rows,
                        (unsigned)campaign->chip_columns, (unsigned)campaign->edge);
}

sonject_status campaign_measure(struct report *report, struct campaign *campaign, size_t swath,
                                const sonject_geometry_params *geometry, double altitude_m)
{
    struct swath_plan *plan = &campaign->swaths[swath];
    const uint64_t rows = (uint64_t)campaign->chip_rows + 2 * (uint64_t)campaign->edge;
    const uint64_t columns = (uint64_t)campaign->chip_columns + 2 * (uint64_t)campaign->edge;
    if (plan->layout.rows < rows || plan->layout.columns < columns)
        return refuse_size(campaign, plan);
    struct region chips = {campaign->edge, campaign->edge, plan->layout.rows - rows + 1,
                           plan->layout.columns - columns + 1};
    limit_ranges(campaign, geometry, altitude_m, &chips);
    if (chips.columns == 0 && !campaign->has_range)
        return tree_failure(&campaign->tree, plan->place, "swaths",
                            "no image within %s begins beyond the sonar's altitude, up to %g m",
                            plan->written, altitude_m);
    if (chips.columns == 0)
        return tree_failure(&campaign->tree, plan->place, "swaths",
                            "no image within %s has its middle at slant ranges of %g to %g m and "
                            "begins beyond the sonar's altitude, up to %g m",
                            plan->written, campaign->nearest_range_m, campaign->farthest_range_m,
                            altitude_m);
    struct region *forbidden = allocate_array(plan->avoid_count, sizeof *forbidden);
    CHECK_MEMORY(report, forbidden, "the places for images");
    for (size_t i = 0; i < plan->avoid_count; i++)
        forbid(campaign, &plan->avoid[i], &forbidden[i]);
    chip_room_clear(&plan->room);
    sonject_status status =
        chip_room_init(&plan->room, report, &chips, forbidden, plan->avoid_count);
    free(forbidden);
    if (status == SONJECT_OK && plan->room.places == 0)
        status = tree_failure(&campaign->tree, plan->place, "swaths",
                              "the %zu contacts to avoid in %s leave no room for images of %u x %u "
                              "that stay %u pixels away from them",
                              plan->avoid_count, plan->written, (unsigned)campaign->chip_rows,
                              (unsigned)campaign->chip_columns, (unsigned)campaign->clearance);
    return status;
}
