/* Pairs of a highlight's and a shadow's box that are one contact. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "dataset/contact_files.h"
#include "measure/contacts.h"

#define PAIRING_ROUNDS 8 /* no labelling has a chain of boxes that needs more */

static int compare_contacts(const void *one, const void *other)
{
    const struct labelled_contact *a = one, *b = other;
    const uint64_t keys[][2] = {{a->image, b->image},
                                {a->side, b->side},
                                {a->seen_side, b->seen_side},
                                {a->box.first_row, b->box.first_row},
                                {a->box.first_column, b->box.first_column},
                                {a->box.rows, b->box.rows},
                                {a->box.columns, b->box.columns},
                                {a->part, b->part}};
    for (size_t i = 0; i < COUNT(keys); i++)
        if (keys[i][0] != keys[i][1])
            return keys[i][0] < keys[i][1] ? -1 : 1;
    return 0;
}

/* Returns where a contact's box begins in range, in columns counted as range grows. */
static double range_start(const struct labelled_contact *contact)
{
    const sonject_box *box = &contact->box;
    return contact->is_reversed ? -(double)(box->first_column + box->columns)
                                : (double)box->first_column;
}

static double range_end(const struct labelled_contact *contact)
{
    return range_start(contact) + (double)contact->box.columns;
}

/* Returns the distance, pixels, from the end of a highlight to the start of a shadow: 0 where the
 * shadow begins there, at the same rows. Infinite where the two cannot be of one object. */
static double distance_between(const struct labelled_contact *one,
                               const struct labelled_contact *other)
{
    const bool is_first = one->part == LABELLED_HIGHLIGHT;
    const struct labelled_contact *highlight = is_first ? one : other;
    const struct labelled_contact *shadow = is_first ? other : one;
    const sonject_box *bright = &highlight->box;
    const sonject_box *dark = &shadow->box;
    if (one->part + other->part != LABELLED_HIGHLIGHT + LABELLED_SHADOW ||
        bright->first_row >= dark->first_row + dark->rows ||
        dark->first_row >= bright->first_row + bright->rows ||
        range_start(highlight) >= range_end(shadow))
        return INFINITY;
    const double bright_row = (double)bright->first_row + 0.5 * (double)bright->rows;
    const double dark_row = (double)dark->first_row + 0.5 * (double)dark->rows;
    return hypot(range_start(shadow) - range_end(highlight), dark_row - bright_row);
}

/* Returns the number of the nearest contact that may be the other part of one; count: none.
 * contacts: of one side of an image, in the order of rows. */
static size_t find_nearest(const struct labelled_contact *contacts, size_t count, size_t of)
{
    const sonject_box *box = &contacts[of].box;
    double least = INFINITY;
    size_t nearest = count;
    for (size_t i = 0; i < count; i++) {
        if (contacts[i].box.first_row >= box->first_row + box->rows)
            break;
        const double distance = distance_between(&contacts[of], &contacts[i]);
        if (distance < least) {
            least = distance;
            nearest = i;
        }
    }
    return nearest;
}

/* Joins each highlight and shadow of one side of an image that are nearest to each other, until
 * none are left. A shadow's box that was joined into another gets 0 rows. */
static void pair_parts(struct labelled_contact *contacts, size_t count)
{
    bool goes_on = true;
    for (int round = 0; goes_on && round < PAIRING_ROUNDS; round++) {
        goes_on = false;
        for (size_t i = 0; i < count; i++) {
            struct labelled_contact *shadow = &contacts[i];
            const size_t other =
                shadow->part == LABELLED_SHADOW ? find_nearest(contacts, count, i) : count;
            if (other == count || find_nearest(contacts, count, other) != i)
                continue;
            contacts[other].box = box_around(&contacts[other].box, &shadow->box);
            contacts[other].part = shadow->part = LABELLED_BOTH;
            shadow->box.rows = 0;
            goes_on = true;
        }
    }
}

/* Keeps one of equal labels, which lie beside each other. */
static void leave_out_repeated(struct report *report, struct contact_set *set)
{
    struct labelled_contact *contacts = set->contacts;
    const size_t count = set->count;
    size_t kept = 1;
    for (size_t i = 1; i < count; i++)
        if (compare_contacts(&contacts[i], &contacts[kept - 1]) != 0)
            contacts[kept++] = contacts[i];
    set->count = kept;
    if (kept < count)
        report_note(report, "%zu of %zu labels repeat another one, box and part, and are left out",
                    count - kept, count);
}

void contact_set_pair(struct report *report, struct contact_set *set)
{
    struct labelled_contact *contacts = set->contacts;
    size_t kept = 0;
    if (set->count == 0)
        return;
    qsort(contacts, set->count, sizeof *contacts, compare_contacts);
    leave_out_repeated(report, set);
    for (size_t start = 0, end; start < set->count; start = end) {
        for (end = start; end < set->count && contacts[end].image == contacts[start].image &&
                          contacts[end].side == contacts[start].side &&
                          contacts[end].seen_side == contacts[start].seen_side;)
            end++;
        pair_parts(&contacts[start], end - start);
    }
    for (size_t i = 0; i < set->count; i++)
        if (contacts[i].box.rows > 0)
            contacts[kept++] = contacts[i];
    set->count = kept;
    qsort(contacts, kept, sizeof *contacts, compare_contacts);
}
