#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "measure/contacts.h"

#define CELL        64 /* pixels on a side; each cell has one level of the seabed */
#define CELL_MARGIN 32 /* pixels around a cell that count for its level, too */
#define LINE        8  /* columns from the first return on; areas that begin there belong to it */

/* Successive bright pixels of a row. */
struct run {
    size_t row, first, last; /* last: included */
    size_t area;             /* an earlier run of the same area; its own index: the first run */
    double contrast;         /* largest in the run; infinite: begins in the water or at its end */
};

/* A list that grows as runs are found. */
struct run_list {
    struct run *runs; /* owned */
    size_t count, capacity;
};

/* The seabed's level in each cell of the image. */
struct level_map {
    float *levels; /* one for each cell; owned */
    size_t across; /* number of cells in a row of cells */
};

static bool append(struct run_list *list, const struct run *run)
{
    if (list->count == list->capacity) {
        const size_t capacity = 2 * list->capacity + 64;
        struct run *grown = capacity <= (size_t)-1 / sizeof *grown
                                ? realloc(list->runs, capacity * sizeof *grown)
                                : NULL;
        if (!grown)
            return false;
        list->runs = grown;
        list->capacity = capacity;
    }
    list->runs[list->count++] = *run;
    return true;
}

static bool map_levels(struct level_map *map, const struct contact_image *image)
{
    const struct window_box largest = {0, 0, CELL + 2 * CELL_MARGIN, CELL + 2 * CELL_MARGIN};
    const size_t down = (image->rows + CELL - 1) / CELL;
    float *blocks = allocate_array(seabed_blocks(&largest), sizeof *blocks);
    map->across = (image->columns + CELL - 1) / CELL;
    map->levels = allocate_array(down, map->across * sizeof *map->levels);
    for (size_t i = 0; blocks && map->levels && i < down * map->across; i++) {
        const struct window_box cell = {i / map->across * CELL, i % map->across * CELL, CELL, CELL};
        const struct window_box wide =
            box_with_margin(&cell, CELL_MARGIN, image->rows, image->columns);
        map->levels[i] = (float)level_within(image, &wide, blocks);
    }
    free(blocks);
    return blocks && map->levels;
}

static double contrast_at(const struct contact_image *image, const struct level_map *map,
                          size_t row, size_t column)
{
    const double level = (double)map->levels[row / CELL * map->across + column / CELL];
    const double mean = (double)image->means[row * image->columns + column];
    return level > 0.0 ? mean / level : 0.0;
}

static bool list_runs(struct run_list *list, const struct contact_image *image,
                      const struct level_map *map)
{
    for (size_t row = 0; row < image->rows; row++) {
        struct run run = {row, 0, 0, 0, 0.0};
        for (size_t column = 0; column < image->columns; column++) {
            const double contrast = contrast_at(image, map, row, column);
            const bool is_bright = contrast > HIGHLIGHT_OVER_SEABED;
            if (is_bright && run.contrast == 0.0)
                run.first = column;
            if (is_bright) {
                run.last = column;
                run.contrast = fmax(run.contrast, contrast);
            }
            if (run.contrast > 0.0 && (!is_bright || column + 1 == image->columns)) {
                if (run.first < image->seabed_columns[row] + LINE && image->seabed_columns[row] > 0)
                    run.contrast = INFINITY;
                run.area = list->count;
                if (!append(list, &run))
                    return false;
                run.contrast = 0.0;
            }
        }
    }
    return true;
}

/* Returns the area's first run. Runs on the way there are made to point closer to it. */
static size_t area_of(struct run *runs, size_t run)
{
    while (runs[run].area != run) {
        runs[run].area = runs[runs[run].area].area;
        run = runs[run].area;
    }
    return run;
}

static void join(struct run *runs, size_t a, size_t b)
{
    const size_t first = area_of(runs, a);
    const size_t second = area_of(runs, b);
    if (first < second)
        runs[second].area = first;
    else
        runs[first].area = second;
}

/* Joins runs that touch in neighbouring rows to one area. */
static void join_runs(struct run_list *list)
{
    struct run *runs = list->runs;
    size_t above = 0; /* the first run of the row above that may touch */
    for (size_t i = 0; i < list->count; i++) {
        while (runs[above].row + 1 < runs[i].row ||
               (runs[above].row + 1 == runs[i].row && runs[above].last < runs[i].first))
            above++;
        for (size_t k = above; runs[k].row + 1 == runs[i].row && runs[k].first <= runs[i].last; k++)
            join(runs, k, i);
    }
}

static int by_contrast(const void *a, const void *b)
{
    const struct bright_area *x = a;
    const struct bright_area *y = b;
    const size_t places[2][2] = {{x->box.first_row, x->box.first_column},
                                 {y->box.first_row, y->box.first_column}};
    if (x->contrast > y->contrast || x->contrast < y->contrast)
        return x->contrast > y->contrast ? -1 : 1;
    for (int i = 0; i < 2; i++)
        if (places[0][i] != places[1][i])
            return places[0][i] < places[1][i] ? -1 : 1;
    return 0;
}

/* Sorts areas and removes those in the water column and the first return, however far it
 * reaches. */
static void leave_out_returns(struct bright_area *areas, size_t *count)
{
    size_t returns = 0;
    qsort(areas, *count, sizeof *areas, by_contrast);
    while (returns < *count && isinf(areas[returns].contrast))
        returns++;
    *count -= returns;
    memmove(areas, areas + returns, *count * sizeof *areas);
}

/* Lists the areas in the order of their first runs, which come before their other runs. */
static bool list_areas(struct run_list *list, struct bright_area **areas, size_t *count)
{
    struct run *runs = list->runs;
    size_t *numbers = allocate_array(list->count, sizeof *numbers);
    struct bright_area *found = allocate_array(list->count, sizeof *found);
    for (size_t i = 0; numbers && found && i < list->count; i++) {
        const size_t first = area_of(runs, i);
        const struct window_box box = {runs[i].row, runs[i].first, 1,
                                       runs[i].last - runs[i].first + 1};
        if (first == i) {
            const struct bright_area area = {box, runs[i].contrast};
            numbers[i] = *count;
            found[(*count)++] = area;
        } else {
            struct bright_area *area = &found[numbers[first]];
            area->box = box_around(&area->box, &box);
            area->contrast = fmax(area->contrast, runs[i].contrast);
        }
    }
    const bool has_memory = numbers && found;
    free(numbers);
    *areas = found;
    if (has_memory)
        leave_out_returns(found, count);
    return has_memory;
}

/* Lists the bright areas: the brightest first, then by row and column. Areas that begin before the
 * first return of a sidescan image, or at it, are left out. The caller frees *areas by free(), also
 * after failure. Errors: MEMORY. */
static sonject_status list_bright_areas(struct report *report, const struct contact_image *image,
                                        struct bright_area **areas, size_t *count)
{
    struct level_map map = {NULL, 0};
    struct run_list list = {NULL, 0, 0};
    *areas = NULL;
    *count = 0;
    bool has_memory = map_levels(&map, image) && list_runs(&list, image, &map);
    if (has_memory) {
        join_runs(&list);
        has_memory = list_areas(&list, areas, count);
    }
    free(map.levels);
    free(list.runs);
    return has_memory ? SONJECT_OK : report_out_of_memory(report, "the search for contacts");
}

#define SIDE_LOBE_ROWS 64 /* rows from a contact in which side lobes may look like contacts */

sonject_status contact_search_begin(struct contact_search *search, struct report *report,
                                    const struct contact_image *image)
{
    memset(search, 0, sizeof *search);
    return list_bright_areas(report, image, &search->areas, &search->count);
}

void contact_search_clear(struct contact_search *search)
{
    free(search->areas);
    free(search->found);
    memset(search, 0, sizeof *search);
}

static bool overlap_in_columns(const struct window_box *a, const struct window_box *b)
{
    return a->first_column < b->first_column + b->columns &&
           b->first_column < a->first_column + a->columns;
}

/* Returns whether an area touches a contact that was found, or is one of its side lobes. */
static bool belongs_to_found(const struct contact_search *search, const struct contact_image *image,
                             const struct bright_area *area)
{
    const struct window_box near =
        box_with_margin(&area->box, SIDE_LOBE_ROWS, image->rows, image->columns);
    for (size_t i = 0; i < search->found_count; i++) {
        const struct found_contact *found = &search->found[i];
        if (boxes_overlap(&area->box, &found->place.box) ||
            (area->contrast < HIGHLIGHT_UNDER_PEAK * found->contrast &&
             overlap_in_columns(&area->box, &found->place.bright) &&
             boxes_overlap(&near, &found->place.bright)))
            return true;
    }
    return false;
}

/* Returns a box widened by bright areas that are close enough to be pieces of it. */
static struct window_box box_of_pieces(const struct contact_search *search,
                                       const struct contact_image *image,
                                       const struct window_box *first)
{
    struct window_box box = *first;
    int pieces = -1;
    for (int joined = 0; pieces != joined;) {
        const struct window_box near =
            box_with_margin(&box, PIECE_GAP, image->rows, image->columns);
        pieces = joined;
        for (size_t i = 0; joined < PIECES_MAX && i < search->count; i++) {
            const struct window_box wider = box_around(&box, &search->areas[i].box);
            if (boxes_overlap(&search->areas[i].box, &near) &&
                (wider.rows > box.rows || wider.columns > box.columns)) {
                box = wider;
                joined++;
            }
        }
    }
    return box;
}

/* Returns the place that may hold the contact. Beyond the highlight it reaches the image's end. */
static struct contact_place place_of(const struct contact_image *image,
                                     const struct window_box *bright)
{
    struct contact_place place = {*bright, *bright, true};
    place.box =
        box_with_margin(bright, bright->rows / 2 + 2 * CONTACT_MARGIN, image->rows, image->columns);
    place.box.first_column = bright->first_column;
    place.box.columns = image->columns - bright->first_column;
    return place;
}

static bool add_found(struct contact_search *search, const struct contact_place *place,
                      double contrast)
{
    const struct found_contact contact = {*place, contrast};
    struct found_contact *grown = grow_doubling(search->found, search->found_count, sizeof *grown);
    if (!grown)
        return false;
    search->found = grown;
    search->found[search->found_count++] = contact;
    return true;
}

/* Finds the tight place of an area's contact, and the level of the seabed around it. */
static sonject_status find_place(struct contact_search *search, struct report *report,
                                 struct contact_image *image, const struct bright_area *area,
                                 struct contact_place *place, double *level)
{
    struct contact_area highlight, shadow;
    double seabed;
    const struct window_box bright = box_of_pieces(search, image, &area->box);
    *place = place_of(image, &bright);
    sonject_status status = find_seabed_level(image, report, &bright, &seabed);
    THEN(status, find_contact_parts(image, report, place, seabed, &highlight, &shadow));
    if (status != SONJECT_OK)
        return status;
    place->box = shadow.pixels > 0 ? box_around(&bright, &shadow.box) : bright;
    place->box = box_with_margin(&place->box, CONTACT_MARGIN, image->rows, image->columns);
    if (!add_found(search, place, area->contrast))
        return report_out_of_memory(report, "the search for contacts");
    return find_seabed_level(image, report, &place->box, level);
}

sonject_status contact_search_next(struct contact_search *search, struct report *report,
                                   struct contact_image *image, double contrast,
                                   struct contact_place *place)
{
    memset(place, 0, sizeof *place);
    while (search->next < search->count && search->areas[search->next].contrast >= contrast) {
        const struct bright_area *area = &search->areas[search->next++];
        double level;
        if (belongs_to_found(search, image, area))
            continue;
        const sonject_status status = find_place(search, report, image, area, place, &level);
        if (status != SONJECT_OK || level > 0.0)
            return status;
        memset(place, 0, sizeof *place); /* only black pixels are around it */
    }
    return SONJECT_OK;
}

size_t contact_search_left(const struct contact_search *search, const struct contact_image *image,
                           double contrast)
{
    size_t left = 0;
    for (size_t i = search->next; i < search->count && search->areas[i].contrast >= contrast; i++)
        left += !belongs_to_found(search, image, &search->areas[i]);
    return left;
}
