#include "image/bright_areas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define CELL        64 /* pixels on a side, for each of which the seabed's level is found */
#define CELL_MARGIN 32 /* around a cell, that counts too */
#define LINE        8  /* columns from the first return on: what begins there is its line */

/* Pixels of a row one after the other that are bright. */
struct run {
    size_t row, first, last; /* last: included */
    size_t area;             /* a run of the same area that comes no later; itself: the first */
    double contrast;         /* the largest in it; infinite: it begins in water, or with its end */
};

/* Grows as runs are found. */
struct run_list {
    struct run *runs; /* owned */
    size_t count, capacity;
};

/* What does not change while runs are looked for. */
struct level_map {
    float *levels; /* of cells; owned */
    size_t across; /* cells in a row of them */
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

/* The area's first run, to which what lies on the way is made to point. */
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

/* Runs that touch in neighbouring rows become one area. */
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

/* Sorts areas, without what is in the water column and the first return, however far that goes. */
static void leave_out_returns(struct bright_area *areas, size_t *count)
{
    size_t returns = 0;
    qsort(areas, *count, sizeof *areas, by_contrast);
    while (returns < *count && isinf(areas[returns].contrast))
        returns++;
    *count -= returns;
    memmove(areas, areas + returns, *count * sizeof *areas);
}

/* The first run of an area comes before its others: areas are counted in the runs' order. */
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

sonject_status list_bright_areas(struct report *report, const struct contact_image *image,
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
