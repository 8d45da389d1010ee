#include "image/contact_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define ROWS_BESIDE   8 /* of a highlight, beyond half of its own, that may hold its shadow */
#define SHADOW_PIXELS 9 /* at least: in fewer, one mean of 3 x 3 speckled pixels may be dark */
#define COLUMNS_LEAST                                                                              \
    32 /* behind a highlight, in which its shadow begins; twice its own if more                    \
        */

/* The brightest area, and those near it that speckle has cut off. */
static struct contact_area mark_highlight(const struct contact_image *image,
                                          const struct area_search *search)
{
    struct contact_area highlight = mark_largest_area(search);
    for (int piece = 0; highlight.pixels > 0 && piece < PIECES_MAX; piece++) {
        const struct window_box wide =
            box_with_margin(&highlight.box, PIECE_GAP, image->rows, image->columns);
        struct area_search near = *search;
        near.box = box_within(&wide, &search->box);
        const struct contact_area area = mark_largest_area(&near);
        if (area.pixels == 0)
            break;
        highlight.box = box_around(&highlight.box, &area.box);
        highlight.pixels += area.pixels;
        highlight.energy += area.energy;
    }
    return highlight;
}

static double brightest_mean(const struct contact_image *image, const struct window_box *box)
{
    float brightest = 0.0f;
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t k = 0; k < box->columns; k++)
            brightest =
                fmaxf(brightest, image->means[row * image->columns + box->first_column + k]);
    return (double)brightest;
}

static struct window_box beside(const struct contact_image *image, const struct window_box *bright,
                                const struct window_box *box)
{
    const struct window_box wide =
        box_with_margin(bright, bright->rows / 2 + ROWS_BESIDE, image->rows, image->columns);
    struct window_box beyond = box_within(&wide, box);
    beyond.first_column = bright->first_column;
    beyond.columns = box->first_column + box->columns - bright->first_column;
    return beyond;
}

/* What the last contact left is cleared. */
static void begin_marks(struct contact_image *image, const struct window_box *box)
{
    const struct window_box *last = &image->marked;
    for (size_t row = last->first_row; row < last->first_row + last->rows; row++)
        memset(image->marks + row * image->columns + last->first_column, PART_NONE, last->columns);
    image->marked = *box;
}

static void keep_marks(struct contact_image *image, const struct window_box *box)
{
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++)
        for (size_t k = 0; k < box->columns; k++) {
            const size_t i = row * image->columns + box->first_column + k;
            image->taken[i] |= image->marks[i];
        }
}

sonject_status find_contact_parts(struct contact_image *image, struct report *report,
                                  const struct contact_place *place, double seabed,
                                  struct contact_area *highlight, struct contact_area *shadow)
{
    struct area_search search = {image->means,  image->intensity, image->columns,
                                 place->bright, image->columns,   PART_HIGHLIGHT,
                                 0.0,           image->marks,     NULL};
    search.stack = allocate_array(place->box.rows, place->box.columns * sizeof *search.stack);
    CHECK_MEMORY(report, search.stack, "a contact's measures");
    begin_marks(image, &place->box);
    search.threshold = fmax(HIGHLIGHT_OVER_SEABED * seabed,
                            HIGHLIGHT_UNDER_PEAK * brightest_mean(image, &place->bright));
    *highlight = mark_highlight(image, &search);
    search.box = place->box;
    search.part = PART_SHADOW;
    search.threshold = SHADOW_UNDER_SEABED * seabed;
    if (highlight->pixels > 0) {
        const size_t columns = 2 * highlight->box.columns;
        search.box = beside(image, &highlight->box, &place->box);
        if (place->is_near)
            search.start_columns =
                highlight->box.columns + (columns > COLUMNS_LEAST ? columns : COLUMNS_LEAST);
    }
    *shadow = mark_largest_area(&search);
    if (shadow->pixels < SHADOW_PIXELS)
        memset(shadow, 0, sizeof *shadow);
    keep_marks(image, &place->box);
    free(search.stack);
    return SONJECT_OK;
}
