#include "image/contact_search.h"

#include <stdlib.h>
#include <string.h>

#define SIDE_LOBE_ROWS 64 /* from a contact in which its side lobes may be taken for others */

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

/* Whether an area touches a contact that was found, or is a side lobe of it. */
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

/* A box with bright areas that are so near to it, or to those, that they are pieces of it. */
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

/* What may hold the contact: beyond the highlight as far as the image goes. */
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
    struct found_contact *grown = search->found;
    if ((search->found_count & (search->found_count + 1)) == 0) /* room for 2^k - 1 is full */
        grown = realloc(search->found, (2 * search->found_count + 1) * sizeof *grown);
    if (!grown)
        return false;
    search->found = grown;
    search->found[search->found_count++] = contact;
    return true;
}

/* The place of an area's contact, no larger than it must be, and the seabed's level around it. */
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
        memset(place, 0, sizeof *place); /* nothing but black is around it */
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
