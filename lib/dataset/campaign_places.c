/* The room that a campaign's swaths have for images and their objects. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "dataset/campaign.h"

#define JPEG_BLOCK 8 /* rows and columns of a block that is coded as one */

static int compare_starts(const void *a, const void *b)
{
    const uint64_t first = ((const struct region *)a)->first_column;
    const uint64_t second = ((const struct region *)b)->first_column;
    return (first > second) - (first < second);
}

static uint64_t clip(uint64_t value, uint64_t low, uint64_t high)
{
    return value < low ? low : value > high ? high : value;
}

/* Returns the number of first columns that a chip may have in a row. *column: gets the wanted-th of
 * these columns, if there is one. */
static uint64_t free_columns(const struct crop_places *room, uint64_t row, uint64_t wanted,
                             uint64_t *column)
{
    const uint64_t end = room->chips.first_column + room->chips.columns;
    uint64_t next = room->chips.first_column; /* next column that may be free */
    uint64_t count = 0;
    for (size_t i = 0; i <= room->box_count; i++) {
        const struct region *box = &room->boxes[i];
        const bool is_last = i == room->box_count;
        if (!is_last && (box->first_row > row || box->first_row + box->rows <= row))
            continue;
        const uint64_t taken = is_last ? end : clip(box->first_column, next, end);
        if (wanted >= count && wanted - count < taken - next)
            *column = next + (wanted - count);
        count += taken - next;
        next = is_last ? end : clip(box->first_column + box->columns, next, end);
    }
    return count;
}

/* Returns the first row behind `row` in which the set of boxes changes, or that no chip has. */
static uint64_t band_end(const struct crop_places *room, uint64_t row)
{
    uint64_t end = room->chips.first_row + room->chips.rows;
    for (size_t i = 0; i < room->box_count; i++) {
        const uint64_t edges[] = {room->boxes[i].first_row,
                                  room->boxes[i].first_row + room->boxes[i].rows};
        for (int k = 0; k < 2; k++)
            end = edges[k] > row && edges[k] < end ? edges[k] : end;
    }
    return end;
}

void crop_places_clear(struct crop_places *room)
{
    free(room->boxes);
    memset(room, 0, sizeof *room);
}

double crop_places_left(const struct crop_places *room)
{
    return (double)room->places / ((double)room->chips.rows * (double)room->chips.columns);
}

static uint64_t part_of(uint64_t count, double u)
{
    const uint64_t part = (uint64_t)floor((double)count * u);
    return part < count ? part : count - 1;
}

void crop_sample(const struct crop_places *room, double along_track, double range, uint64_t *row,
                 uint64_t *column)
{
    uint64_t place = part_of(room->places, along_track);
    uint64_t columns;
    *row = room->chips.first_row;
    while (true) {
        const uint64_t rows = band_end(room, *row) - *row;
        columns = free_columns(room, *row, 0, column);
        if (place < rows * columns)
            break;
        place -= rows * columns;
        *row += rows;
    }
    *row += place / columns;
    free_columns(room, *row, part_of(columns, range), column);
    *row -= *row % room->block_rows;
    *column -= *column % room->block_columns;
}

/* The limits on places of images: the swath's geometry, and the sonar's altitude over the swath. */
struct limits {
    const struct campaign *campaign;
    const sonject_geometry_params *geometry;
    const double *altitudes_m; /* altitude at each row */
    double lowest_m, highest_m;
    struct ratio_limits ratio;
    bool shows_water; /* images may begin in the water column */
};

/* Narrows low...high to first columns of chips whose middle is at slant ranges from near to far.
 * half: from a chip's first column to its middle; 0: objects instead of chips. */
static void limit_columns(const struct limits *limits, double half, double near_m, double far_m,
                          double *low, double *high)
{
    const double near = geometry_column(limits->geometry, near_m) - half;
    const double far = geometry_column(limits->geometry, far_m) - half;
    *low = fmax(*low, ceil(fmin(near, far) - 1e-9));
    *high = near_m <= far_m ? fmin(*high, floor(fmax(near, far) + 1e-9)) : -1.0;
}

/* Narrows low...high to first columns of chips or objects beyond an altitude's first return. */
static void leave_out_water(const struct limits *limits, double half, double altitude_m,
                            double *low, double *high)
{
    const double bottom = geometry_column(limits->geometry, altitude_m);
    if (limits->shows_water)
        return;
    if (geometry_is_reversed(limits->geometry))
        *high = fmin(*high, ceil(bottom) - 1.0 - 2.0 * half);
    else
        *low = fmax(*low, floor(bottom) + 1.0);
}

/* Limits the first columns of chips at the lowest altitude. An image of all columns begins where
 * the swath does, so its objects are limited instead. Returns false where none is left. */
static bool limit_ranges(const struct limits *limits, struct swath_plan *plan, struct region *chips)
{
    const struct campaign *campaign = limits->campaign;
    const sonject_geometry_params *geometry = limits->geometry;
    const bool is_reversed = geometry_is_reversed(geometry);
    const bool has_all = campaign->chip_columns == 0;
    const double half = has_all ? 0.0 : 0.5 * (double)(campaign->chip_columns - 1);
    const double end =
        (double)chips->first_column + (double)(has_all ? plan->chip_columns : chips->columns) - 1.0;
    const double bottom = geometry_column(geometry, limits->lowest_m);
    double low = (double)chips->first_column;
    double high = end;
    leave_out_water(limits, half, limits->lowest_m, &low, &high);
    if (campaign->slant_range_m[0] < campaign->slant_range_m[1])
        limit_columns(limits, half, campaign->slant_range_m[0], campaign->slant_range_m[1], &low,
                      &high);
    plan->objects.first = has_all ? low : is_reversed ? 0.0 : floor(bottom) + 1.0;
    plan->objects.last = has_all       ? high
                         : is_reversed ? ceil(bottom) - 1.0
                                       : (double)plan->layout.columns;
    if (!has_all && low <= high) {
        chips->columns = (uint64_t)(high - low) + 1;
        chips->first_column = (uint64_t)low;
    }
    return low <= high;
}

#define ALTITUDE_BLOCKS 64 /* blocks of rows, each with one range of altitudes */

/* Returns the number of JPEG blocks, of which altitude blocks are made, over chips' first rows. */
static uint64_t jpeg_blocks(const struct crop_places *room)
{
    return (room->chips.rows + room->block_rows - 1) / room->block_rows;
}

static uint64_t altitude_blocks(const struct crop_places *room)
{
    const uint64_t units = jpeg_blocks(room);
    return units < ALTITUDE_BLOCKS ? units : ALTITUDE_BLOCKS;
}

static uint64_t first_row_of(const struct crop_places *room, uint64_t block)
{
    const uint64_t units = block * jpeg_blocks(room) / altitude_blocks(room);
    const uint64_t rows = units * room->block_rows;
    return room->chips.first_row + (rows < room->chips.rows ? rows : room->chips.rows);
}

struct object_columns objects_of_chip(const struct swath_plan *plan, uint64_t first_row)
{
    const struct crop_places *room = &plan->room;
    if (!plan->block_objects)
        return plan->objects;
    const uint64_t unit = (first_row - room->chips.first_row) / room->block_rows;
    return plan->block_objects[((unit + 1) * altitude_blocks(room) - 1) / jpeg_blocks(room)];
}

/* Narrows columns, of objects or of chips' first pixels, to those that the altitudes allow. The
 * altitudes are at the rows of chips that begin in a block of rows. */
static void limit_block(const struct limits *limits, const struct swath_plan *plan, uint64_t block,
                        double half, struct object_columns *columns)
{
    const uint64_t end = first_row_of(&plan->room, block + 1) + plan->chip_rows - 1;
    double lowest = HUGE_VAL, highest = 0.0;
    for (uint64_t row = first_row_of(&plan->room, block); row < end; row++) {
        lowest = fmin(lowest, limits->altitudes_m[row]);
        highest = fmax(highest, limits->altitudes_m[row]);
    }
    leave_out_water(limits, half, highest, &columns->first, &columns->last);
    if (limits->ratio.least > 0.0)
        limit_columns(limits, half, limits->ratio.least * highest, limits->ratio.most * lowest,
                      &columns->first, &columns->last);
}

static void forbid_block(struct crop_places *room, uint64_t block, uint64_t column,
                         uint64_t columns)
{
    const uint64_t first = first_row_of(room, block);
    room->boxes[room->box_count++] =
        (struct region){first, column, first_row_of(room, block + 1) - first, columns};
}

/* Forbids first pixels of chips that the altitudes do not allow: two boxes for each block of rows,
 * behind the room's other boxes. */
static void limit_chips(const struct limits *limits, struct swath_plan *plan)
{
    struct crop_places *room = &plan->room;
    const struct region *chips = &room->chips;
    const double half = 0.5 * (double)(plan->chip_columns - 1);
    const uint64_t end = chips->first_column + chips->columns;
    for (uint64_t i = 0; i < altitude_blocks(room); i++) {
        struct object_columns columns = {(double)chips->first_column, (double)end - 1.0};
        limit_block(limits, plan, i, half, &columns);
        const bool is_empty = columns.first > columns.last;
        const uint64_t from = is_empty ? end : (uint64_t)columns.first;
        const uint64_t to = is_empty ? end : (uint64_t)columns.last + 1;
        forbid_block(
            room, i, chips->first_column,
            from > chips->first_column ? from - chips->first_column + room->block_columns - 1 : 0);
        forbid_block(room, i, to, end - to);
    }
}

/* Limits objects in images of all columns by altitude. Forbids chips that leave them no column. */
static sonject_status limit_objects(struct report *report, const struct limits *limits,
                                    struct swath_plan *plan)
{
    struct object_columns any = {HUGE_VAL, -1.0};
    free(plan->block_objects);
    plan->block_objects = allocate_array(ALTITUDE_BLOCKS, sizeof *plan->block_objects);
    CHECK_MEMORY(report, plan->block_objects, "the places for objects");
    for (uint64_t i = 0; i < altitude_blocks(&plan->room); i++) {
        struct object_columns *columns = &plan->block_objects[i];
        *columns = plan->objects;
        limit_block(limits, plan, i, 0.0, columns);
        if (columns->first > columns->last) {
            forbid_block(&plan->room, i, plan->room.chips.first_column, plan->room.chips.columns);
            continue;
        }
        any.first = fmin(any.first, columns->first);
        any.last = fmax(any.last, columns->last);
    }
    if (any.first <= any.last)
        plan->objects = any;
    return SONJECT_OK;
}

/* Finds the first pixels, along one axis, of chips that would touch a box, or would do so once they
 * are set back to a block's first pixel. */
static void forbid(const struct campaign *campaign, uint64_t block, uint64_t chip, uint64_t first,
                   uint64_t count, uint64_t *first_forbidden, uint64_t *forbidden)
{
    const uint64_t before = (uint64_t)campaign->clearance + chip - 1;
    *first_forbidden = first > before ? first - before : 0;
    *forbidden = first + count + campaign->clearance + block - 1 - *first_forbidden;
}

/* Shortens an interval at its start, so that the first pixel beyond the edge begins a block. */
static void begin_at_block(uint64_t block, uint32_t edge, uint64_t *first, uint64_t *count)
{
    const uint64_t left_out = (block - (*first + edge) % block) % block;
    *first += left_out;
    *count -= left_out < *count ? left_out : *count;
}

/* Finds the first pixels, along one axis, of chips in which a box takes all places of objects. In
 * other chips, objects keep away from the box by themselves. low, high: where objects lie in a
 * chip. */
static void forbid_covered(const struct campaign *campaign, uint64_t block, double low, double high,
                           uint64_t first, uint64_t count, uint64_t *first_forbidden,
                           uint64_t *forbidden)
{
    const double middle = 0.5 * (low + high), half = 0.5 * campaign->spread * (high - low);
    const double box = (double)first, clearance = (double)campaign->clearance;
    const double from = fmax(0.0, floor(box - clearance - (middle - half)) + 1.0);
    const double end = ceil(box + (double)count + clearance - (middle + half));
    *first_forbidden = (uint64_t)from;
    *forbidden = end > from ? (uint64_t)(end - from) + block - 1 : 0;
}

/* Finds the pixels of an interval that are in the image. Returns false if there are none. */
static bool pixels_of(double from, double to, uint64_t image, uint64_t *first, uint64_t *count)
{
    const double low = fmax(0.0, floor(fmin(from, to)));
    const double high = fmin((double)image, ceil(fmax(from, to)) + 1.0);
    *first = (uint64_t)fmin(low, (double)image);
    *count = high > low ? (uint64_t)(high - low) : 0;
    return *count > 0;
}

/* Finds the pixels of a box that is given in metres, and checks a box that is given in pixels. */
static sonject_status find_box(const struct campaign *campaign, const struct swath_plan *plan,
                               const sonject_geometry_params *geometry, struct avoided_box *box)
{
    const double *along_m = box->along_track_m, *range_m = box->slant_range_m;
    const double first_m = geometry->first_along_track_m, row_m = geometry->row_spacing_m;
    if (isnan(along_m[0])) {
        if (box->pixels.first_row < plan->layout.rows &&
            box->pixels.first_column < plan->layout.columns)
            return SONJECT_OK;
        return tree_failure(&campaign->tree, plan->place, "swaths",
                            "avoid: %s has %llu x %llu pixels, but none at row %llu, column %llu",
                            plan->written, (unsigned long long)plan->layout.rows,
                            (unsigned long long)plan->layout.columns,
                            (unsigned long long)box->pixels.first_row,
                            (unsigned long long)box->pixels.first_column);
    }
    if (pixels_of((along_m[0] - first_m) / row_m, (along_m[1] - first_m) / row_m, plan->layout.rows,
                  &box->pixels.first_row, &box->pixels.rows) &&
        pixels_of(geometry_column(geometry, range_m[0]), geometry_column(geometry, range_m[1]),
                  plan->layout.columns, &box->pixels.first_column, &box->pixels.columns))
        return SONJECT_OK;
    return tree_failure(
        &campaign->tree, plan->place, "swaths",
        "avoid: %s does not reach %g to %g m along the track and slant ranges of %g to %g m",
        plan->written, along_m[0], along_m[1], range_m[0], range_m[1]);
}

/* Returns the first pixels that a box to avoid forbids to chips. */
static struct region forbid_box(const struct campaign *campaign, const struct swath_plan *plan,
                                const struct region *box)
{
    const struct crop_places *room = &plan->room;
    struct region forbidden;
    if (!images_show_contacts(campaign)) {
        forbid(campaign, room->block_rows, plan->chip_rows, box->first_row, box->rows,
               &forbidden.first_row, &forbidden.rows);
        forbid(campaign, room->block_columns, plan->chip_columns, box->first_column, box->columns,
               &forbidden.first_column, &forbidden.columns);
        return forbidden;
    }
    double low = 0.0, high = (double)(plan->chip_columns - 1);
    if (campaign->chip_columns == 0) {
        low = fmax(low, plan->objects.first - (double)room->chips.first_column);
        high = fmin(high, plan->objects.last - (double)room->chips.first_column);
    }
    forbid_covered(campaign, room->block_rows, 0.0, (double)(plan->chip_rows - 1), box->first_row,
                   box->rows, &forbidden.first_row, &forbidden.rows);
    forbid_covered(campaign, room->block_columns, low, high, box->first_column, box->columns,
                   &forbidden.first_column, &forbidden.columns);
    return forbidden;
}

bool images_show_contacts(const struct campaign *campaign)
{
    return campaign->chip_rows == 0 || campaign->chip_columns == 0;
}

static uint64_t side_of(uint32_t asked, uint64_t pixels, uint32_t edge)
{
    const uint64_t taken = 2 * (uint64_t)edge + CAMPAIGN_CHIP_MIN;
    return asked > 0 ? asked : CAMPAIGN_CHIP_MIN + (pixels > taken ? pixels - taken : 0);
}

/* Fails and tells all that is asked of images, or of objects in images, as no place is left. */
static sonject_status refuse_swath(const struct limits *limits, const struct swath_plan *plan)
{
    const struct campaign *campaign = limits->campaign;
    char asked[400] = "";
    size_t length = 0;
#define ASK(...) length += (size_t)snprintf(asked + length, sizeof asked - length, __VA_ARGS__)
    if (!limits->shows_water)
        ASK(", beyond the sonar's altitude, up to %g m", limits->highest_m);
    if (campaign->slant_range_m[0] < campaign->slant_range_m[1])
        ASK(", at slant ranges of %g to %g m", campaign->slant_range_m[0],
            campaign->slant_range_m[1]);
    if (limits->ratio.least > 0.0)
        ASK(", at %g to %g times the sonar's altitude, %g to %g m", limits->ratio.least,
            limits->ratio.most, limits->lowest_m, limits->highest_m);
    if (plan->avoid_count > 0)
        ASK(", %u pixels away from %zu %s to avoid", (unsigned)campaign->clearance,
            plan->avoid_count, plan->avoid_count > 1 ? "boxes" : "box");
#undef ASK
    return tree_failure(
        &campaign->tree, plan->place, "swaths", "%s has no place for %s of %llu x %llu pixels%s",
        plan->written, campaign->chip_columns > 0 ? "images" : "objects in images",
        (unsigned long long)plan->chip_rows, (unsigned long long)plan->chip_columns, asked);
}

sonject_status campaign_measure(struct report *report, struct campaign *campaign, size_t swath,
                                const sonject_geometry_params *geometry, const double *altitudes_m,
                                bool may_show_water)
{
    struct swath_plan *plan = &campaign->swaths[swath];
    struct limits limits = {.campaign = campaign,
                            .geometry = geometry,
                            .altitudes_m = altitudes_m,
                            .lowest_m = HUGE_VAL,
                            .ratio = plan->ratio.least > 0.0 ? plan->ratio : campaign->ratio};
    /* an image of all columns may show water: the ratio limits its objects alone */
    limits.shows_water =
        limits.ratio.least > 0.0 && (may_show_water || campaign->chip_columns == 0);
    for (uint64_t row = 0; row < plan->layout.rows; row++) {
        limits.lowest_m = fmin(limits.lowest_m, altitudes_m[row]);
        limits.highest_m = fmax(limits.highest_m, altitudes_m[row]);
    }
    uint64_t top = 0, height = plan->layout.rows, first, width;
    if (!geometry_side(geometry, plan->layout.columns, &first, &width))
        return tree_failure(&campaign->tree, plan->place, "swaths",
                            "nadir_column %g does not lie among the %llu columns of %s with some "
                            "to its side: correct it, or the side",
                            geometry->nadir_column, (unsigned long long)plan->layout.columns,
                            plan->written);
    /* chips of a JPEG begin where a block does, so that blocks coded once are coded alike again */
    const uint64_t block = plan->jpeg_quality > 0 ? JPEG_BLOCK : 1;
    const uint64_t block_rows = campaign->chip_rows > 0 ? block : 1;
    const uint64_t block_columns = campaign->chip_columns > 0 ? block : 1;
    if (campaign->chip_rows == 0)
        begin_at_block(block, campaign->edge, &top, &height);
    if (campaign->chip_columns == 0)
        begin_at_block(block, campaign->edge, &first, &width);
    plan->chip_rows = side_of(campaign->chip_rows, height, campaign->edge);
    plan->chip_columns = side_of(campaign->chip_columns, width, campaign->edge);
    const uint64_t rows = plan->chip_rows + 2 * (uint64_t)campaign->edge;
    const uint64_t columns = plan->chip_columns + 2 * (uint64_t)campaign->edge;
    if (height < rows || width < columns)
        return tree_failure(
            &campaign->tree, plan->place, "swaths",
            "%s has %llu x %llu pixels, too few for images of %llu x %llu that stay %u "
            "pixels away from its edges",
            plan->written, (unsigned long long)plan->layout.rows, (unsigned long long)width,
            (unsigned long long)plan->chip_rows, (unsigned long long)plan->chip_columns,
            (unsigned)campaign->edge);
    struct region chips = {top + campaign->edge, first + campaign->edge, height - rows + 1,
                           width - columns + 1};
    bool has_room = limit_ranges(&limits, plan, &chips);
    begin_at_block(block_rows, 0, &chips.first_row, &chips.rows);
    begin_at_block(block_columns, 0, &chips.first_column, &chips.columns);
    has_room = has_room && chips.rows > 0 && chips.columns > 0;
    if (!has_room)
        return refuse_swath(&limits, plan);
    struct crop_places *room = &plan->room;
    crop_places_clear(room);
    room->chips = chips;
    room->block_rows = block_rows;
    room->block_columns = block_columns;
    room->boxes = allocate_array(plan->avoid_count + 2 * ALTITUDE_BLOCKS + 1, sizeof *room->boxes);
    CHECK_MEMORY(report, room->boxes, "the places for images");
    if (images_show_contacts(campaign) && plan->avoid_count > 0 && campaign->clearance == 0)
        report_note(report,
                    "chip.clearance is 0: in %s only the middles of objects keep away from "
                    "contacts to avoid, so objects may overlap these",
                    plan->written);
    if (campaign->chip_columns > 0)
        limit_chips(&limits, plan);
    else
        CHECK(limit_objects(report, &limits, plan));
    for (size_t i = 0; i < plan->avoid_count; i++) {
        CHECK(find_box(campaign, plan, geometry, &plan->avoid[i]));
        room->boxes[room->box_count++] = forbid_box(campaign, plan, &plan->avoid[i].pixels);
    }
    qsort(room->boxes, room->box_count, sizeof *room->boxes, compare_starts);
    uint64_t column;
    for (uint64_t row = chips.first_row, end; row < chips.first_row + chips.rows; row = end) {
        end = band_end(room, row);
        room->places += (end - row) * free_columns(room, row, 0, &column);
    }
    return room->places > 0 ? SONJECT_OK : refuse_swath(&limits, plan);
}
