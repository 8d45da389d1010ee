/* A campaign: many scenes drawn from distributions around one that is written out, and one image of
 * it. What an image is depends on the campaign and its number alone, so that any can be made by
 * itself. */
#ifndef SONJECT_DATASET_CAMPAIGN_H
#define SONJECT_DATASET_CAMPAIGN_H

#include <jansson.h>
#include <pthread.h>

#include <sonject/campaign.h>

#include "base/hash.h"
#include "dataset/labels.h"
#include "image/raster.h"
#include "inject/injection.h"
#include "inject/swath.h"
#include "schema/keys.h"
#include "schema/scene_file.h"
#include "schema/tables.h"

#define CAMPAIGN_IMAGES_MAX  10000000 /* ids have eight digits */
#define CAMPAIGN_ITEMS_MAX   250      /* targets and clutter, of each */
#define CAMPAIGN_CLUTTER_MAX 50       /* in an image */
#define CAMPAIGN_TARGETS_MAX 12       /* likewise */
#define CAMPAIGN_SPLITS_MAX  16
#define CAMPAIGN_CHIP_MIN    16   /* rows, columns */
#define CAMPAIGN_CHIP_MAX    8192 /* of those that are not all of a swath */
#define SPLIT_NAME_CAPACITY  33

/* Counted random numbers: a deviate of (0, 1), the middle of one of 2^52 equal parts; streams are
 * independent. */
double uniform_number(uint64_t seed, uint32_t stream, uint64_t index);

/* Where a random permutation of 0...count - 1 takes index, which is below count. */
uint64_t permuted_index(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count);

/* The index-th of count deviates of (0, 1) of which each of count equal parts holds one, in random
 * order: an axis of a Latin hypercube. */
double stratified_number(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count);

/* Splits total by weights (finite, >= 0, their sum above 0) into whole shares that add up to it and
 * miss their exact values by less than 1, after Hamilton: of equal remainders the first is rounded
 * up. */
void share_out(uint64_t total, const double *weights, size_t count, uint64_t *shares);

enum distribution_kind {
    DISTRIBUTION_UNIFORM,     /* between low and high */
    DISTRIBUTION_LOG_UNIFORM, /* its logarithm is */
    DISTRIBUTION_NORMAL,      /* cut off at low and high */
    DISTRIBUTION_CHOICE,      /* one of the texts */
    DISTRIBUTION_FIXED        /* the only text */
};

/* A value of a row, as --set takes it, and where it is written. */
struct body_cell {
    char *text; /* owned; NULL: the row does not say it */
    struct tree_place place;
};

/* Bodies that were measured, one a row. */
struct body_table {
    char *path;                   /* to open; owned */
    char *keys[TABLE_FIELDS_MAX]; /* of objects; owned */
    size_t key_count;
    struct body_cell **cells;      /* of each row, one a key; owned */
    char hash[HASH_TEXT_CAPACITY]; /* of the file */
};

/* What a value of a scene is drawn from. */
struct distribution {
    enum distribution_kind kind;
    char *key; /* of the scene or of an object; owned */
    char *of;  /* key whose value, drawn before, this one is a ratio of; NULL: of none; owned */
    struct tree_place place;
    double low, high; /* in the unit as it is written */
    double mean, deviation;
    char unit[16];            /* " kHz", "" for none */
    char **texts;             /* values as --set takes them; owned */
    double *cumulative;       /* weights of the texts, added up, the last 1; owned */
    size_t count;             /* of texts */
    uint32_t steps;           /* of a grid's axis; 0: none */
    uint32_t stream;          /* of random numbers */
    struct body_table *table; /* whose rows' numbers the texts are; NULL: none; owned */
};

#define DISTRIBUTION_TEXT_CAPACITY 48

/* Reads what the node says: a single value, a list, or a section {uniform: [low, high]},
 * {log_uniform: [low, high]}, {normal: {mean, deviation, minimum, maximum}}, {choice: [...],
 * weights: [...]}, {fixed: value}; the first two also with steps, the first three with of: KEY. The
 * reader's path is the value's. distribution: all zeros; on failure as well it is for
 * distribution_clear. Errors: INPUT, MEMORY. */
sonject_status distribution_read(struct reader *reader, const struct tree_node *node,
                                 const char *key, struct distribution *distribution);
void distribution_clear(struct distribution *distribution);

/* Reads what `table` says: a file's name, or {file: name, weight: column}. distribution: as of
 * distribution_read; a choice of rows. Errors: INPUT, STORAGE, MEMORY. */
sonject_status body_table_read(struct reader *reader, const struct tree_node *node,
                               struct distribution *distribution);
void body_table_clear(struct body_table *table, size_t rows);

/* The cells of the row that a drawn text stands for. */
const struct body_cell *body_table_row(const struct distribution *distribution, const char *text);

/* The value that a share of u, 0...1, lies below, as a text for --set; text: where numbers are
 * written, to nine digits. */
const char *distribution_value(const struct distribution *distribution, double u,
                               char text[DISTRIBUTION_TEXT_CAPACITY]);

/* The same as a number in the written unit; only of kinds with low and high. */
double distribution_number(const struct distribution *distribution, double u);

/* Number of values on a grid's axis: its steps, or the texts of a choice whose weights are equal;
 * 0: it is none. distribution_step gives each, counted from 0. */
uint32_t distribution_steps(const struct distribution *distribution);
const char *distribution_step(const struct distribution *distribution, uint32_t step,
                              char text[DISTRIBUTION_TEXT_CAPACITY]);

/* Where in a swath chips may lie: inside, and touching no box that is to be avoided. */
struct crop_places {
    struct region chips;  /* the first pixels that a chip may have if nothing is to be avoided */
    struct region *boxes; /* those that it may not have, which may reach beyond, sorted by their
                             first column; owned */
    size_t box_count;
    uint64_t places;                    /* 0: there is no room */
    uint64_t block_rows, block_columns; /* of which chips begin at a multiple */
};

void crop_places_clear(struct crop_places *room);

/* The share of the places that chips have if nothing is to be avoided. */
double crop_places_left(const struct crop_places *room);

/* The place that two deviates of [0, 1) choose: rows by the number of places that they have, and
 * all places of a row alike, set back to a block's first pixel. The room must have places. */
void crop_sample(const struct crop_places *room, double along_track, double range, uint64_t *row,
                 uint64_t *column);

struct draws {
    struct distribution *list; /* owned */
    size_t count;
};

/* Whether a key is drawn, by itself or with a table's row. */
bool draws_have_key(const struct draws *draws, const char *key);

/* Something that is put into images: a target or clutter. */
struct item {
    struct campaign *campaign; /* that it is of */
    char class_name[SONJECT_NAME_CAPACITY];
    double weight;
    char *object; /* its section of a scene, in flow style; owned */
    struct draws draws;
    struct tree_place place;
};

struct object_columns {
    double first, last; /* there are none where first is above */
};

/* Where contacts are that images are not to show. Where it is told in metres the pixels are known
 * once the swath is measured. */
struct avoided_box {
    struct region pixels;
    double along_track_m[2], slant_range_m[2]; /* both ends; NAN: told in pixels */
};

#define RATIO_MAX 1000

/* Of range over altitude; 0: any. */
struct ratio_limits {
    double least, most;
};

struct swath_plan {
    char *path;          /* to open; owned */
    const char *written; /* as the campaign file has it; its tree's */
    char *split;         /* that it must be in; NULL: any; owned */
    char **keys;         /* of the scene, for this swath, "key=value"; owned */
    size_t key_count;
    struct avoided_box *avoid; /* owned */
    size_t avoid_count;
    struct ratio_limits ratio; /* instead of the campaign's */
    struct tree_place place;
    struct raster_layout layout; /* once it is opened */
    uint32_t side; /* likewise: enum recorded_side, also of a picture of both; 0: it has one */
    struct crop_places room; /* once it is measured, as all below */
    uint64_t chip_rows, chip_columns;
    struct object_columns objects;        /* where these may lie in any image */
    struct object_columns *block_objects; /* and in images of all columns that begin in a block of
                                             rows; owned; NULL: images have fewer columns */
    int jpeg_quality;                     /* that images are coded with; 0: without loss */
    uint32_t split_number;
};

/* "port", "starboard", or "". */
const char *swath_side_word(const struct swath_plan *swath);

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

/* Files of images. */
enum image_format {
    FORMAT_LOSSLESS, /* PNG or TIFF */
    FORMAT_AS_INPUT  /* JPEG where the swath is one */
};

/* What becomes of a target that is seen less than it is to be. */
enum faint {
    FAINT_REDRAW, /* its values are drawn anew; if that does not help it is difficult */
    FAINT_DIFFICULT
};

/* The files of an image, each kind in a folder of its own; all images have the first two and the
 * last. */
enum output {
    OUTPUT_IMAGE,
    OUTPUT_TRUTH,
    OUTPUT_HIGHLIGHT,
    OUTPUT_SHADOW,
    OUTPUT_MASKS,
    OUTPUT_INFLUENCE,
    OUTPUT_ENERGY,
    OUTPUT_FIELD,
    OUTPUT_YOLO,
    OUTPUT_VOC,
    OUTPUT_RECORD,
    OUTPUT_KINDS
};
#define OUTPUT_BIT(output) (UINT32_C(1) << (output))
#define OUTPUT_ALWAYS                                                                              \
    (OUTPUT_BIT(OUTPUT_IMAGE) | OUTPUT_BIT(OUTPUT_TRUTH) | OUTPUT_BIT(OUTPUT_RECORD))

struct campaign {
    char *path;                /* of its file */
    char *folder;              /* that its names of files are meant from */
    char *scene_path;          /* owned, as the two above */
    const char *scene_written; /* the tree's */
    uint64_t images, seed;
    uint32_t design;   /* enum design */
    uint32_t format;   /* enum image_format */
    double grey_db[2]; /* black and white of 8 bit images; NaN: these are as stored */
    uint32_t chip_rows, chip_columns; /* 0: all of each swath */
    uint32_t edge, clearance;         /* pixels kept free at swaths' edges, around contacts */
    double spread;                    /* of the chip's sides, where objects may lie */
    double slant_range_m[2];          /* of images' middles */
    struct ratio_limits ratio;        /* of swaths that have none */
    double empty, clutter_alone;
    bool clutter_labelled;
    bool has_one_target; /* in each image, and nothing else, whatever the file says */
    double visible_highlight_db, visible_shadow_db; /* of targets: at least, at most; NaN: any */
    uint32_t faint;                                 /* enum faint */
    uint32_t outputs;                               /* bits of enum output */
    struct draws draws, object_draws;
    struct item targets[CAMPAIGN_ITEMS_MAX], clutter[CAMPAIGN_ITEMS_MAX];
    uint32_t target_count, clutter_count;
    struct distribution clutter_number, target_number; /* in an image; count 0: 1 */
    struct swath_plan *swaths;
    size_t swath_count;
    struct split splits[CAMPAIGN_SPLITS_MAX];
    size_t split_count;
    bool has_range;
    uint32_t streams; /* of random numbers that distributions take */
    struct tree tree; /* of the file, overrides included: places point into it */
};

/* Reads a campaign file with overrides "key.path=value" of it. text: what stands for the file's own
 * text, or NULL. campaign: for campaign_clear, also on failure. Errors: INPUT, STORAGE, MEMORY. */
sonject_status campaign_read(struct report *report, const char *path, const char *text,
                             const char *const *overrides, size_t count, struct campaign *campaign);
void campaign_clear(struct campaign *campaign);

/* What campaign files may say. */
extern const struct section campaign_section, campaign_swath_section;

/* Whether key, which is at place and path, is one of the scene (or of an object) that a campaign
 * may set. Errors: INPUT. */
sonject_status campaign_check_key(const struct tree *tree, struct tree_place place,
                                  const char *path, const char *key, bool is_object);

/* The same of an entry's key, which its text is or ends with. */
sonject_status campaign_check_entry(struct reader *reader, const struct tree_entry *entry,
                                    const char *key, bool is_object);

/* Reads a list of two lengths that grow. */
sonject_status campaign_read_lengths(struct reader *reader, const struct tree_node *node,
                                     double ends_m[2]);

/* Reads "[least, most]". */
sonject_status campaign_read_ratio(struct reader *reader, const struct tree_node *node,
                                   struct ratio_limits *ratio);

/* Read `swaths` and `splits` into a campaign. */
sonject_status campaign_read_swaths(struct reader *reader, const struct tree_node *node,
                                    void *structure);
sonject_status campaign_read_splits(struct reader *reader, const struct tree_node *node,
                                    void *structure);

/* Gives *list, of count elements of size bytes, room for one more, which becomes all zeros. Errors:
 * MEMORY. */
sonject_status grow_list(struct report *report, void *list, size_t count, size_t size);

/* Whether a split may have this name, which is a folder's and stands in documents. */
bool is_split_name(const char *name);

/* Gives each swath to a split and each split its images, so that no swath is in two: swaths that
 * are the same side of files with equal hashes count as one. Errors: INPUT, MEMORY. */
sonject_status campaign_split(struct report *report, struct campaign *campaign,
                              char (*hashes)[HASH_TEXT_CAPACITY]);

/* Finds where images may lie in a swath whose layout is known. geometry: of the scene with that
 * swath. altitudes_m: the sonar's at each row; images begin beyond the highest at their rows, so
 * that no target lies in the water column, unless they may show it and are limited in range over
 * altitude. Errors:
 * INPUT (no room), MEMORY. */
sonject_status campaign_measure(struct report *report, struct campaign *campaign, size_t swath,
                                const sonject_geometry_params *geometry, const double *altitudes_m,
                                bool may_show_water);

/* Where objects may lie in a chip that begins at that row. */
struct object_columns objects_of_chip(const struct swath_plan *plan, uint64_t first_row);

/* Whether images have all rows or columns of swaths, so that contacts to avoid are in them: then
 * objects keep away from them instead. */
bool images_show_contacts(const struct campaign *campaign);

/* "key=value" for the scene, and where the campaign file says so, or a table that it names. */
struct plan_key {
    char *text;
    struct tree_place place; /* line 0: nowhere */
    const char *table;       /* the campaign's; NULL: none */
};

#define OBJECTS_OF_IMAGE 64 /* more than there are */

/* Where objects lie in a chip. */
struct object_places {
    double rows[OBJECTS_OF_IMAGE], columns[OBJECTS_OF_IMAGE];
    bool are_kept[OBJECTS_OF_IMAGE]; /* of the attempt before */
};

/* One image: which swath, where, and what of the scene is drawn how. */
struct image_plan {
    uint64_t id;
    uint32_t split, swath;
    uint32_t category; /* enum category; targets from CATEGORY_TARGET on */
    struct region chip;
    uint64_t seed;
    uint32_t object_count;
    uint32_t target_count; /* of these, the first */
    struct object_places places;
    struct plan_key *keys; /* owned; names of files in them are meant from the campaign's folder */
    size_t key_count;
};

#define ATTEMPTS_MAX     64 /* to draw what goes together */
#define ATTEMPTS_OF_CHIP 8  /* in one place: what is dark itself shows no shadow */

/* Draws that were given up: of all values and places, and of single targets besides. */
struct attempts {
    uint32_t of_all;
    uint32_t of_targets[CAMPAIGN_TARGETS_MAX];
    struct object_places places; /* that objects have where single targets are drawn anew */
};

/* All values and places are to be drawn anew. */
void attempts_next(struct attempts *attempts);

/* The plan of image id, below campaign->images. Where draws were given up values and places of
 * objects are others, and after ATTEMPTS_OF_CHIP the chip's; all else of it stays. plan: for
 * image_plan_clear, also on failure. Errors: INPUT (no place is left for an object), MEMORY. */
sonject_status image_plan_make(struct report *report, const struct campaign *campaign, uint64_t id,
                               const struct attempts *attempts, struct image_plan *plan);

/* A plan that tries the ends of all distributions: one with an object of a category (and of
 * clutter number item), in the first place of a swath. step 0: low ends, 1: high ends, and of
 * choices the step-th. attempt above 0: anything between the ends. */
sonject_status image_plan_try(struct report *report, const struct campaign *campaign,
                              uint32_t swath, uint32_t category, uint32_t item, uint32_t step,
                              uint32_t attempt, struct image_plan *plan);
void image_plan_clear(struct image_plan *plan);

/* How many steps image_plan_try has use for: two, or as many as the longest choice has entries,
 * among what is drawn of an item, or, for NULL, of the scene itself. */
uint32_t image_plan_steps(const struct campaign *campaign, const struct item *item);

/* Whether each target comes often enough for all cells of a grid. Errors: INPUT. */
sonject_status image_plan_check_grid(const struct campaign *campaign);

/* The split that an image is in. */
uint32_t image_split(const struct campaign *campaign, uint64_t id);

/* A campaign as the library keeps it. */
struct sonject_campaign {
    struct report *report; /* the context's */
    struct campaign campaign;
    char *scene_text; /* of the base scene's file; owned */
    size_t scene_bytes;
    char (*swath_hashes)[HASH_TEXT_CAPACITY]; /* of the swaths' files; owned */
    json_t *inputs;                           /* all that images depend on, by name; owned */
    char hash[HASH_TEXT_CAPACITY];            /* of inputs */
    struct class_names classes; /* of all that may be drawn: images number them alike */
    const char *folder;         /* of a run, where calibrations go; NULL: no run is under way */
    char **calibrations; /* of each swath whose scene asks for one, the file; owned; NULL: none */
    pthread_mutex_t *calibrating; /* held by the one thread that does; NULL: there is but one */
    struct swath_store store;
    struct mesh_store meshes; /* of scenes whose mesh_store it is */
};

/* How a campaign is opened. */
struct campaign_source {
    const char *path, *text; /* as of campaign_read */
    const char *const *overrides;
    size_t override_count;
    bool has_one_target; /* in each image, and nothing else */
};

/* Reads and checks a campaign. On success *campaign is for campaign_close; on failure NULL. Errors:
 * INPUT, STORAGE, UNSUPPORTED, MEMORY. */
sonject_status campaign_open(struct report *report, const struct campaign_source *source,
                             struct sonject_campaign **campaign);
void campaign_close(struct sonject_campaign **campaign);

/* Reads the campaign's base scene for an image file. source: overrides, with room for one more, and
 * what else is asked for; the rest is filled in. scene: as of campaign_read_scene. Errors: as
 * sonject_scene_read. */
sonject_status campaign_read_base(struct sonject_campaign *campaign, const char *image,
                                  struct scene_source *source, struct scene *scene);

/* Reads the scene that a plan describes. scene: initialised and empty; on failure it is left empty.
 * are_relations: as in struct scene_source. Errors: as sonject_scene_read, with the place in the
 * campaign file where that says it. */
sonject_status campaign_read_scene(struct sonject_campaign *campaign, const struct image_plan *plan,
                                   struct scene *scene, bool *are_relations);

/* Plans image id and reads its scene, until its values go together: attempts grow by what did not.
 * reason: why the first that did not was given up, where there is one; a
 * line. plan, scene: as of image_plan_make and campaign_read_scene. Errors: as
 * campaign_read_scene. */
#define REASON_CAPACITY 240
sonject_status campaign_draw_scene(struct sonject_campaign *campaign, uint64_t id,
                                   struct attempts *attempts, char reason[REASON_CAPACITY],
                                   struct image_plan *plan, struct scene *scene);

/* Draws a measured swath with the boxes to avoid; not one with pixels that are no numbers. Errors:
 * as of sonject_quicklook, without INPUT. */
sonject_status campaign_draw_swath(struct sonject_campaign *campaign, uint32_t number,
                                   const char *picture);

/* Whether the campaign has an image of that id. Errors: ARGUMENT. */
sonject_status campaign_check_id(const struct sonject_campaign *campaign, uint64_t id);

/* An image as it is made. Starts as all zeros, is for campaign_image_clear. */
struct campaign_image {
    struct image_plan plan;
    struct scene scene;
    struct swath swath;
    struct injection_result result;
    uint32_t attempts;                   /* that were given up */
    char reason[REASON_CAPACITY];        /* of the first */
    bool is_faint[CAMPAIGN_TARGETS_MAX]; /* targets that are seen less than they are to be */
};

/* Plans the image, reads its scene and its part of the swath, and injects; draws anew, up to
 * ATTEMPTS_MAX times, what does not go together, does not fit, or is not seen as it is to be.
 * Errors: as sonject_campaign_inject; the message names the image. */
sonject_status campaign_image_make(struct device *device, struct sonject_campaign *campaign,
                                   uint64_t id, sonject_progress_function progress, void *user,
                                   struct campaign_image *image);
void campaign_image_clear(struct campaign_image *image);

/* The image becomes the amplitudes of what its file would store, so that those who learn from it in
 * memory see no step, and nothing over full scale, that the file would not show. Errors: MEMORY. */
sonject_status campaign_image_round(struct report *report, struct campaign_image *image);

#define CALIBRATIONS_FOLDER "calibrations" /* in the folder of a run */

/* Makes the calibration that a scene asks for in the run's folder; the scene is left initialised.
 * name: without extension. Errors: as of scene_calibrate. */
sonject_status campaign_calibrate(struct sonject_campaign *campaign, const char *name,
                                  struct scene *scene, char path[PATH_CAPACITY]);

/* That of a swath, which its later scenes are to have from the start: campaign->calibrations. */
sonject_status campaign_calibrate_swath(struct sonject_campaign *campaign, size_t swath,
                                        struct scene *scene);

/* Of a run that has ended. */
void campaign_forget_calibrations(struct sonject_campaign *campaign);

/* Writes the image's files below the folder, its record last. Errors: STORAGE, MEMORY,
 * UNSUPPORTED. */
sonject_status campaign_image_write(struct sonject_campaign *campaign, struct campaign_image *image,
                                    const char *folder);

/* What a thread makes images with: all of it is its own. */
struct image_maker {
    struct device *device;
    struct sonject_campaign *campaign;
    sonject_progress_function progress; /* for campaign_image_make, with user */
    void *user;
};

/* Images to be made, side by side. */
struct image_work {
    uint64_t count;
    /* Makes one of them, 0...count - 1; called once for each by any thread, in rising order. */
    sonject_status (*make)(void *user, const struct image_maker *maker, uint64_t index);
    /* Told by the calling thread how many are done, parts of some included, and the stage of one;
     * not 0: cancels. */
    int (*tell)(void *user, double done, const char *stage);
    void *user;
};

/* Makes the images by two threads for each processor, 16 at most, fewer where images are large.
 * After a failure those that are under way are finished, and no other is begun; the message is of
 * the first image that failed. slot: how each thread opens the device. Errors: those of make,
 * CANCELLED, MEMORY. */
sonject_status campaign_work(struct sonject_campaign *campaign, const struct device_slot *slot,
                             const struct image_work *work);

/* The images that the folder lacks, of those that params asks for, and the documents of the whole:
 * sonject_campaign_run. */
sonject_status campaign_run(struct sonject_campaign *campaign, struct device_slot *slot,
                            const sonject_campaign_run_params *params,
                            sonject_progress_function progress, void *user, int *was_finished);

/* Those documents, once all images are there: sonject_campaign_merge. */
sonject_status campaign_merge(struct report *report, const char *folder,
                              sonject_progress_function progress, void *user);

#endif
