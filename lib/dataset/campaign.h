/* A campaign: many scenes drawn from distributions around one that is written out. Pure data. */
#ifndef SONJECT_DATASET_CAMPAIGN_H
#define SONJECT_DATASET_CAMPAIGN_H

#include "dataset/distribution.h"
#include "image/raster.h"
#include "schema/yaml_tree.h"

#define CAMPAIGN_IMAGES_MAX  10000000 /* ids have eight digits */
#define CAMPAIGN_SWATHS_MAX  10000
#define CAMPAIGN_ITEMS_MAX   250 /* targets and clutter, of each */
#define CAMPAIGN_CLUTTER_MAX 50  /* in an image */
#define CAMPAIGN_SPLITS_MAX  16
#define CAMPAIGN_CHIP_MAX    8192 /* rows, columns */
#define SPLIT_NAME_CAPACITY  33

/* Where in a swath chips may lie: inside, and touching no box that is to be avoided. */
/* First pixels of chips, in bands of rows that have the same columns. */
struct column_range {
    uint64_t first, count;
};

struct row_band {
    uint64_t first_row, rows;
    uint64_t columns; /* of all its ranges */
    size_t first_range, ranges;
};

struct chip_room {
    struct row_band *bands; /* owned */
    struct column_range *ranges;
    size_t band_count, range_count;
    uint64_t places; /* 0: there is no room */
};

/* chips: the first pixels that a chip may have if nothing is to be avoided; avoid: those that it
 * may not have, count boxes, which may reach beyond. room: for chip_room_clear, also on failure.
 * Errors: MEMORY. */
sonject_status chip_room_init(struct chip_room *room, struct report *report,
                              const struct region *chips, const struct region *avoid, size_t count);
void chip_room_clear(struct chip_room *room);

/* The place that two deviates of [0, 1) choose: rows by the number of places that they have, and
 * all places of a row alike. The room must have places. */
void chip_room_choose(const struct chip_room *room, double along_track, double range, uint64_t *row,
                      uint64_t *column);

struct draws {
    struct distribution *list; /* owned */
    size_t count;
};

/* Something that is put into images: a target or clutter. */
struct item {
    char class_name[SONJECT_NAME_CAPACITY];
    double weight;
    char *object; /* its section of a scene, in flow style; owned */
    struct draws draws;
    struct tree_place place;
};

struct swath_plan {
    char *path;    /* to open; owned */
    char *written; /* as the campaign file has it; owned */
    char *split;   /* that it must be in; NULL: any; owned */
    char **keys;   /* of the scene, for this swath, "key=value"; owned */
    size_t key_count;
    struct region *avoid; /* owned */
    size_t avoid_count;
    struct tree_place place;
    struct raster_layout layout; /* once it is opened */
    struct chip_room room;       /* once it is measured */
    uint32_t split_number;
};

struct split {
    char name[SPLIT_NAME_CAPACITY];
    double fraction;
    uint64_t first_image, images;
    uint32_t *swaths; /* numbers; owned */
    uint32_t swath_count;
    uint64_t *shares; /* of its images: empty, clutter alone, each target; owned */
};

/* Kinds of images; targets follow. */
enum category {
    CATEGORY_EMPTY,
    CATEGORY_CLUTTER,
    CATEGORY_TARGET
};

enum design {
    DESIGN_RANDOM,
    DESIGN_STRATIFIED,
    DESIGN_GRID
};

/* What is written of each image beside image, truth and COCO. */
enum output {
    OUTPUT_HIGHLIGHT = 1,
    OUTPUT_SHADOW = 2,
    OUTPUT_MASKS = 4,
    OUTPUT_ENERGY = 8,
    OUTPUT_FIELD = 16,
    OUTPUT_YOLO = 32,
    OUTPUT_VOC = 64
};

struct campaign {
    char *path;   /* of its file */
    char *folder; /* that its names of files are meant from */
    char *scene_path, *scene_written;
    uint64_t images, seed;
    uint32_t design; /* enum design */
    uint32_t chip_rows, chip_columns;
    uint32_t edge, clearance; /* pixels kept free at swaths' edges, around contacts */
    double spread;            /* of the chip's sides, where objects may lie */
    double nearest_range_m, farthest_range_m;
    double empty, clutter_alone;
    uint32_t outputs; /* of enum output */
    struct draws draws, object_draws;
    struct item *targets, *clutter;
    size_t target_count, clutter_count;
    struct distribution clutter_number;
    struct swath_plan *swaths;
    size_t swath_count;
    struct split splits[CAMPAIGN_SPLITS_MAX];
    size_t split_count;
    bool has_range;
    uint32_t streams; /* of random numbers that distributions take */
    struct tree tree; /* of the file, overrides included: places point into it */
};

/* Reads a campaign file with overrides "key.path=value" of it. campaign: for campaign_clear, also
 * on failure. Errors: INPUT, STORAGE, MEMORY. */
sonject_status campaign_read(struct report *report, const char *path, const char *const *overrides,
                             size_t count, struct campaign *campaign);
void campaign_clear(struct campaign *campaign);

/* Whether a split may have this name, which is a folder's and stands in documents. */
bool is_split_name(const char *name);

/* Gives each swath to a split and each split its images, so that no swath is in two: swaths whose
 * identities (one text each, such as a hash) are equal count as one. Errors: INPUT, MEMORY. */
sonject_status campaign_split(struct report *report, struct campaign *campaign,
                              const char *const *identities);

/* Finds where images may lie in a swath whose layout is known. geometry: of the scene with that
 * swath. altitude_m: the sonar's highest, which images begin beyond, so that no target lies in the
 * water column. Errors: INPUT (no room), MEMORY. */
sonject_status campaign_measure(struct report *report, struct campaign *campaign, size_t swath,
                                const sonject_geometry_params *geometry, double altitude_m);

#endif
