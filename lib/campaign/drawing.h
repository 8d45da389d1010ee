/* How an image's plan comes about: values drawn one after the other, as "key=value" of its scene.
 */
#ifndef SONJECT_CAMPAIGN_DRAWING_H
#define SONJECT_CAMPAIGN_DRAWING_H

#include "campaign/image_plan.h"

/* Streams of random numbers beyond those of distributions. */
enum {
    STREAM_KIND = 0x31000000,
    STREAM_GRID = 0x31000001,
    STREAM_SEED = 0x31000002,
    STREAM_ITEM = 0x31000003,
    STREAM_OBJECT_ROW = 0x31000004,
    STREAM_OBJECT_COLUMN = 0x31000005,
    STREAM_CHIP_ROW = 0x32000000,   /* and a swath's number */
    STREAM_CHIP_COLUMN = 0x33000000 /* likewise */
};

#define OBJECTS_OF_IMAGE 64 /* more than there are */
#define NO_TRIAL         UINT32_MAX

/* What a plan is drawn with. */
struct drawing {
    struct report *report;
    const struct campaign *campaign;
    struct image_plan *plan;
    uint32_t trial;        /* step of a trial */
    uint64_t index, count; /* of the image among those of its category */
    uint64_t cell;         /* of the grid, what is left of it */
    double rows[OBJECTS_OF_IMAGE], columns[OBJECTS_OF_IMAGE]; /* where objects lie */
    uint32_t objects;
};

/* Begins an empty plan, for image_plan_clear. trial: its step, or NO_TRIAL. */
void drawing_init(struct drawing *drawing, struct report *report, const struct campaign *campaign,
                  uint32_t trial, struct image_plan *plan);

/* A seed for each category, so that they do not draw alike. */
uint64_t category_seed(const struct campaign *campaign, uint32_t category);

/* Adds a key to the plan; text is given up, and NULL counts as memory that was out. Errors: MEMORY.
 */
sonject_status add_key(struct drawing *drawing, struct tree_place place, char *text);
sonject_status add_value(struct drawing *drawing, struct tree_place place, const char *prefix,
                         const char *key, const char *value);

/* The index-th of count values; random designs count by image instead. */
const char *draw_value(struct drawing *drawing, const struct distribution *distribution,
                       uint64_t seed, uint64_t index, uint64_t count,
                       char text[DISTRIBUTION_TEXT_CAPACITY]);

bool draws_have_key(const struct draws *draws, const char *key);

/* The image's swath, its place there, and its category: all that its id alone says. */
void choose_place(struct drawing *drawing);

/* The objects of the plan's category in the chip. trial_clutter: the clutter of a trial, or NULL.
 * Errors: MEMORY. */
sonject_status draw_objects(struct drawing *drawing, const struct item *trial_clutter);

#endif
