/* Campaigns: many scenes drawn from distributions around one base scene, and one image of each. A
 * chip is the part of a swath that becomes an image. An image depends only on the campaign and the
 * image's number, so any image can be made by itself. */
#ifndef SONJECT_DATASET_CAMPAIGN_H
#define SONJECT_DATASET_CAMPAIGN_H

#include <jansson.h>
#include <pthread.h>

#include <sonject/campaign.h>

#include "base/file.h"
#include "base/hash.h"
#include "dataset/labels.h"
#include "image/raster.h"
#include "inject/injection.h"
#include "inject/swath.h"
#include "schema/keys.h"
#include "schema/scene_file.h"
#include "schema/tables.h"

#define CAMPAIGN_IMAGES_MAX  10000000 /* ids have eight digits */
#define CAMPAIGN_ITEMS_MAX   250      /* targets, and as many clutter items */
#define CAMPAIGN_CLUTTER_MAX 50       /* clutter objects in an image */
#define CAMPAIGN_TARGETS_MAX 12       /* targets in an image */
#define CAMPAIGN_SPLITS_MAX  16
#define CAMPAIGN_CHIP_MIN    16   /* rows or columns */
#define CAMPAIGN_CHIP_MAX    8192 /* rows or columns, if they are not all of a swath's */
#define SPLIT_NAME_CAPACITY  33

/* Returns a counter-based random number: the middle of one of 2^52 equal parts of (0, 1). Streams
 * are independent. */
double uniform_number(uint64_t seed, uint32_t stream, uint64_t index);

/* Returns the value to which a random permutation of 0...count - 1 maps index, below count. */
uint64_t permuted_index(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count);

/* Returns the index-th of count deviates in (0, 1), one from each of count equal parts, in random
 * order: an axis of a Latin hypercube. */
double stratified_number(uint64_t seed, uint32_t stream, uint64_t index, uint64_t count);

/* Splits total by weights into whole shares that add up to total, by Hamilton's method. Each share
 * misses its exact value by less than 1; of equal remainders, the first is rounded up. weights:
 * finite, >= 0, with a sum above 0. */
void share_out(uint64_t total, const double *weights, size_t count, uint64_t *shares);

enum distribution_kind {
    DISTRIBUTION_UNIFORM,     /* between low and high */
    DISTRIBUTION_LOG_UNIFORM, /* uniform in the logarithm */
    DISTRIBUTION_NORMAL,      /* cut off at low and high */
    DISTRIBUTION_CHOICE,      /* one of the texts */
    DISTRIBUTION_FIXED        /* the only text */
};

/* A value in a table's row, as --set takes it, and its place in the file. */
struct body_cell {
    char *text; /* owned; NULL: the field is empty */
    struct tree_place place;
};

/* A table of measured bodies, one in each row. */
struct body_table {
    char *path;                   /* path to open; owned */
    char *keys[TABLE_FIELDS_MAX]; /* keys of objects that the columns give; owned */
    size_t key_count;
    struct body_cell **cells;      /* an array for each row, with a cell for each key; owned */
    char hash[HASH_TEXT_CAPACITY]; /* hash of the file */
};

/* The distribution that a value of a scene is drawn from. */
struct distribution {
    enum distribution_kind kind;
    char *key; /* key of the scene or of an object; owned */
    char *of;  /* key drawn earlier, of whose value this is a ratio; NULL: none; owned */
    struct tree_place place;
    double low, high; /* limits, in the unit as it is written */
    double mean, deviation;
    char unit[16];            /* " kHz"; "": none */
    char **texts;             /* values as --set takes them; owned */
    double *cumulative;       /* running sums of the texts' weights, the last one 1; owned */
    size_t count;             /* number of texts */
    uint32_t steps;           /* steps of a grid's axis; 0: not an axis */
    uint32_t stream;          /* stream of random numbers */
    struct body_table *table; /* table whose row numbers the texts are; NULL: none; owned */
};

#define DISTRIBUTION_TEXT_CAPACITY 48

/* Reads a distribution from node: a single value, a list, or a section {uniform: [low, high]},
 * {log_uniform: [low, high]}, {normal: {mean, deviation, minimum, maximum}}, {choice: [...],
 * weights: [...]}, {fixed: value}. uniform and log_uniform also take steps; uniform, log_uniform
 * and normal also take of: KEY. The reader's path is that of the value. distribution: all zeros; to
 * be given to distribution_clear, also on failure. Errors: INPUT, MEMORY. */
sonject_status distribution_read(struct reader *reader, const struct tree_node *node,
                                 const char *key, struct distribution *distribution);
void distribution_clear(struct distribution *distribution);

/* Reads the table that `table` names: a file's name, or {file: name, weight: column}. distribution:
 * see distribution_read; it becomes a choice of rows. Errors: INPUT, STORAGE, MEMORY. */
sonject_status body_table_read(struct reader *reader, const struct tree_node *node,
                               struct distribution *distribution);
void body_table_clear(struct body_table *table, size_t rows);

/* Returns the cells of the row that a drawn text stands for. */
const struct body_cell *body_table_row(const struct distribution *distribution, const char *text);

/* Returns the distribution's quantile at u, 0...1, as a text for --set. text: room for numbers,
 * which are written to nine digits. */
const char *distribution_value(const struct distribution *distribution, double u,
                               char text[DISTRIBUTION_TEXT_CAPACITY]);

/* Returns the quantile at u as a number in the written unit. Only for kinds with low and high. */
double distribution_number(const struct distribution *distribution, double u);

/* Returns the number of values on a grid's axis: the steps, or the texts of a choice with equal
 * weights; 0: no axis. distribution_step returns one of these values, counted from 0. */
uint32_t distribution_steps(const struct distribution *distribution);
const char *distribution_step(const struct distribution *distribution, uint32_t step,
                              char text[DISTRIBUTION_TEXT_CAPACITY]);

/* Places of chips in a swath: first pixels of chips that are inside and touch no box to avoid. */
struct crop_places {
    struct region chips;  /* all places, if there were no boxes */
    struct region *boxes; /* boxes of forbidden places, some beyond chips, by first column; owned */
    size_t box_count;
    uint64_t places;                    /* number of places; 0: there is no room */
    uint64_t block_rows, block_columns; /* chips begin at multiples of these sides */
};

void crop_places_clear(struct crop_places *room);

/* Returns the share of places that the boxes leave, 0...1. */
double crop_places_left(const struct crop_places *room);

/* Chooses a place by two deviates in [0, 1). Rows count by their number of places, all places of a
 * row alike. The place is then set back to its block's first pixel. The room must have places. */
void crop_sample(const struct crop_places *room, double along_track, double range, uint64_t *row,
                 uint64_t *column);

struct draws {
    struct distribution *list; /* owned */
    size_t count;
};

/* Returns whether a key is drawn, by itself or as a table's column. */
bool draws_have_key(const struct draws *draws, const char *key);

/* A target, or a kind of clutter, that is put into images. */
struct item {
    struct campaign *campaign; /* campaign that has this item */
    char class_name[SONJECT_NAME_CAPACITY];
    double weight;
    char *object;                  /* the object's section of a scene, in flow style; owned */
    const struct tree_node *fixed; /* the same section, in the campaign's tree */
    struct draws draws;
    struct tree_place place;
};

/* Returns whether an item states a key, or a value for all of the key's section. The campaign's
 * draws of all objects leave such a key out. */
bool item_fixes(const struct item *item, const char *key);

struct object_columns {
    double first, last; /* none where first is above last */
};

/* A box around contacts that images must not show. If the box is given in metres, its pixels are
 * known once the swath is measured. */
struct avoided_box {
    struct region pixels;
    double along_track_m[2], slant_range_m[2]; /* both ends; NAN: the box is given in pixels */
};

#define RATIO_MAX 1000

/* The limits of slant range over altitude; 0: no limits. */
struct ratio_limits {
    double least, most;
};

struct swath_plan {
    char *path;          /* path to open; owned */
    const char *written; /* path as the campaign file has it; owned by the file's tree */
    char *split;         /* split that the swath is in; NULL: any; owned */
    char **keys;         /* keys of the scene for this swath, "key=value"; owned */
    size_t key_count;
    struct avoided_box *avoid; /* owned */
    size_t avoid_count;
    struct ratio_limits ratio; /* used instead of the campaign's; 0: none */
    struct tree_place place;
    struct raster_layout layout; /* known once the swath is opened, as is side */
    uint32_t side; /* enum recorded_side, also where a picture has both; 0: one side only */
    struct crop_places room; /* known once the swath is measured, as is all below */
    uint64_t chip_rows, chip_columns;
    struct object_columns objects;        /* columns where objects may lie in any image */
    struct object_columns *block_objects; /* the columns for each block of first rows; owned; NULL:
                                             images do not have all columns */
    int jpeg_quality;                     /* JPEG quality of the images; 0: without loss */
    uint32_t split_number;
};

/* Returns "port", "starboard", or "". */
const char *swath_side_word(const struct swath_plan *swath);

struct split {
    char name[SPLIT_NAME_CAPACITY];
    double fraction;
    uint64_t first_image, images;
    uint32_t *swaths; /* numbers of swaths; owned */
    uint32_t swath_count;
    uint64_t *shares; /* numbers of images: empty, clutter alone, each target; owned */
};

/* The kinds of images. Each target has a kind of its own, from CATEGORY_TARGET on. */
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

/* The formats of image files. */
enum image_format {
    FORMAT_LOSSLESS, /* PNG or TIFF */
    FORMAT_AS_INPUT  /* JPEG where the swath is one */
};

/* The treatment of a target that is less visible than the campaign asks. */
enum faint {
    FAINT_REDRAW, /* the target is drawn again; if no draw helps, the target is difficult */
    FAINT_DIFFICULT
};

/* The files of an image, each kind in a folder. All images have the first two and the last. */
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
    char *path;                /* path of the campaign's file */
    char *folder;              /* folder that file names in the campaign are relative to */
    char *scene_path;          /* owned, as the two above */
    const char *scene_written; /* the file's name as written; owned by the tree */
    uint64_t images, seed;
    uint32_t design;   /* enum design */
    uint32_t format;   /* enum image_format */
    double grey_db[2]; /* levels of black and white in 8 bit images; NaN: pixels as stored */
    uint32_t chip_rows, chip_columns; /* 0: all of each swath */
    uint32_t edge, clearance;         /* pixels kept free at swaths' edges, around contacts */
    double spread;                    /* share of a chip's sides in which objects may lie */
    double slant_range_m[2];          /* limits for the middles of images; both 0: none */
    struct ratio_limits ratio;        /* limits for swaths without their own */
    double empty, clutter_alone;
    bool clutter_labelled;
    bool has_one_target; /* each image has one target and nothing else, whatever the file says */
    double visible_highlight_db, visible_shadow_db; /* least and most for targets; NaN: any */
    uint32_t faint;                                 /* enum faint */
    uint32_t outputs;                               /* bits of enum output */
    struct draws draws, object_draws;
    struct item targets[CAMPAIGN_ITEMS_MAX], clutter[CAMPAIGN_ITEMS_MAX];
    uint32_t target_count, clutter_count;
    struct distribution clutter_number, target_number; /* objects in an image; count 0: one */
    struct swath_plan *swaths;
    size_t swath_count;
    struct split splits[CAMPAIGN_SPLITS_MAX];
    size_t split_count;
    uint32_t streams; /* number of random streams that distributions take */
    struct tree tree; /* the file's tree, overrides included; places point into it */
};

/* Reads a campaign file with overrides, "key.path=value". text: used instead of the file's; may be
 * NULL. campaign: for campaign_clear, also on failure. Errors: INPUT, STORAGE, MEMORY. */
sonject_status campaign_read(struct report *report, const char *path, const char *text,
                             const char *const *overrides, size_t count, struct campaign *campaign);
void campaign_clear(struct campaign *campaign);

/* The keys of campaign files, and those of their swaths. */
extern const struct section campaign_section, campaign_swath_section;

/* Checks that a campaign may set a key of the scene, or of an object. place, path: of the key, for
 * messages. Errors: INPUT. */
sonject_status campaign_check_key(const struct tree *tree, struct tree_place place,
                                  const char *path, const char *key, bool is_object);

/* Checks an entry's key (its text: key, or ending with key) as campaign_check_key. Errors: INPUT.
 */
sonject_status campaign_check_entry(struct reader *reader, const struct tree_entry *entry,
                                    const char *key, bool is_object);

/* Read a list of two lengths, m, of which the first is smaller, into double[2]; and "[least, most]"
 * into a struct ratio_limits. */
sonject_status campaign_read_lengths(struct reader *reader, const struct tree_node *node,
                                     void *member);
sonject_status campaign_read_ratio(struct reader *reader, const struct tree_node *node,
                                   void *member);

/* Read `swaths` and `splits` into a campaign. */
sonject_status campaign_read_swaths(struct reader *reader, const struct tree_node *node,
                                    void *structure);
sonject_status campaign_read_splits(struct reader *reader, const struct tree_node *node,
                                    void *structure);

/* Returns whether a split may have this name. Folders and documents use the name. */
bool is_split_name(const char *name);

/* Gives each swath to one split, and each split its images. Swaths that are the same side of files
 * with equal hashes count as one, and both sides do if a swath is the whole file. Errors: INPUT,
 * MEMORY. */
sonject_status campaign_split(struct report *report, struct campaign *campaign,
                              char (*hashes)[HASH_TEXT_CAPACITY]);

/* Finds the places of images in a swath whose layout is known. geometry: of the scene with that
 * swath. altitudes_m: the sonar's altitude at each row. Images begin beyond the highest altitude at
 * their rows, so that no target lies in the water column. may_show_water: images may begin in the
 * water column if they are limited in range over altitude. Errors: INPUT (no room), MEMORY. */
sonject_status campaign_measure(struct report *report, struct campaign *campaign, size_t swath,
                                const sonject_geometry_params *geometry, const double *altitudes_m,
                                bool may_show_water);

/* Returns the columns where objects may lie in a chip that begins at that row. */
struct object_columns objects_of_chip(const struct swath_plan *plan, uint64_t first_row);

/* Returns whether images have all rows or all columns of swaths. Such images show the contacts to
 * avoid, and objects keep away from these contacts instead. */
bool images_show_contacts(const struct campaign *campaign);

/* A "key=value" for the scene, and its place in the campaign's file or in a table. */
struct plan_key {
    char *text;
    struct tree_place place; /* line 0: no place */
    const char *table;       /* path of the table, owned by the campaign; NULL: none */
};

#define OBJECTS_OF_IMAGE 64 /* above the most that an image has, 62 */

/* The places of objects in a chip, pixels. */
struct object_places {
    double rows[OBJECTS_OF_IMAGE], columns[OBJECTS_OF_IMAGE];
    bool are_kept[OBJECTS_OF_IMAGE]; /* places kept from the attempt before */
};

/* The plan of one image: its swath, its place there, and the values drawn for its scene. */
struct image_plan {
    uint64_t id;
    uint32_t split, swath;
    uint32_t category; /* enum category; targets from CATEGORY_TARGET on */
    struct region chip;
    uint64_t seed;
    uint32_t object_count;
    uint32_t target_count; /* targets are the first objects */
    struct object_places places;
    struct plan_key *keys; /* owned; file names in them are relative to the campaign's folder */
    size_t key_count;
};

#define ATTEMPTS_MAX     64 /* draws until values fit each other */
#define ATTEMPTS_OF_CHIP 8  /* draws in one place; a dark place shows no shadow */

/* The numbers of draws given up: of all values and places, and besides of single targets. */
struct attempts {
    uint32_t of_all;
    uint32_t of_targets[CAMPAIGN_TARGETS_MAX];
    struct object_places places; /* places of all objects, while single targets are drawn again */
};

/* Counts a draw as given up, so that all values and places are drawn again. */
void attempts_next(struct attempts *attempts);

/* Makes the plan of image id, below campaign->images. Each draw given up changes the values and
 * places of objects, and every ATTEMPTS_OF_CHIP of them move the chip; all else stays. plan: for
 * image_plan_clear, also on failure. Errors: INPUT (no place is left for an object), MEMORY. */
sonject_status image_plan_make(struct report *report, const struct campaign *campaign, uint64_t id,
                               const struct attempts *attempts, struct image_plan *plan);

/* Makes a plan that tries the ends of all distributions, with one object of a category, in the
 * first place of a swath. item: number of the clutter item in a clutter image. step: even steps
 * take the low ends, odd steps the high ends, and choices take their step-th text. attempt: above
 * 0, values between the ends are taken. */
sonject_status image_plan_try(struct report *report, const struct campaign *campaign,
                              uint32_t swath, uint32_t category, uint32_t item, uint32_t step,
                              uint32_t attempt, struct image_plan *plan);
void image_plan_clear(struct image_plan *plan);

/* Returns the number of useful steps for image_plan_try: two, or the number of texts in the longest
 * choice. item: the item that is drawn; NULL: the scene itself. */
uint32_t image_plan_steps(const struct campaign *campaign, const struct item *item);

/* Checks that each target comes often enough for all cells of a grid. Errors: INPUT. */
sonject_status image_plan_check_grid(const struct campaign *campaign);

/* Returns the number of the split that an image is in. */
uint32_t image_split(const struct campaign *campaign, uint64_t id);

/* A campaign as the library keeps it. */
struct sonject_campaign {
    struct report *report; /* the context's */
    struct campaign campaign;
    char *scene_text; /* text of the base scene's file; owned */
    size_t scene_bytes;
    char (*swath_hashes)[HASH_TEXT_CAPACITY]; /* hashes of the swaths' files; owned */
    struct path_facts *swath_facts;           /* the swaths' files when they were hashed; owned */
    struct read_files reads;       /* other files that scenes name, which each image reads again */
    json_t *inputs;                /* all that images depend on, by name; owned */
    char hash[HASH_TEXT_CAPACITY]; /* hash of inputs */
    struct class_names classes;    /* classes of all items, so that images number them alike */
    const char *folder;            /* a run's folder, for calibrations; NULL: no run is under way */
    char **calibrations; /* calibration file of each swath that asks for one; owned; NULL: none */
    pthread_mutex_t *calibrating; /* held by the thread that calibrates; NULL: only one thread */
    struct swath_store store;
    struct mesh_store meshes; /* shared by the scenes of images */
};

/* The source of a campaign for campaign_open. */
struct campaign_source {
    const char *path, *text; /* see campaign_read */
    const char *const *overrides;
    size_t override_count;
    bool has_one_target; /* each image has one target and nothing else */
};

/* Reads and checks a campaign. On success *campaign is for campaign_close; on failure NULL. Errors:
 * INPUT, STORAGE, UNSUPPORTED, MEMORY. */
sonject_status campaign_open(struct report *report, const struct campaign_source *source,
                             struct sonject_campaign **campaign);
void campaign_close(struct sonject_campaign **campaign);

/* Returns the override that makes a scene read this image, for free(); NULL where memory is out. */
char *input_override(const char *image);

/* Reads the campaign's base scene for an image file. source: overrides, with room for one more, and
 * any other choices; the rest is filled in. scene: see campaign_read_scene. Errors: those of
 * sonject_scene_read. */
sonject_status campaign_read_base(struct sonject_campaign *campaign, const char *image,
                                  struct scene_source *source, struct scene *scene);

/* Reads the scene that a plan describes. scene: initialised and empty; on failure it is left empty.
 * are_relations: see struct scene_source. Errors: those of sonject_scene_read, with the place in
 * the campaign file of a key that the file gives. */
sonject_status campaign_read_scene(struct sonject_campaign *campaign, const struct image_plan *plan,
                                   struct scene *scene, bool *are_relations);

/* Plans image id and reads its scene, again until the values fit each other. attempts: counts the
 * draws given up. reason: gets a line on why the first of these was given up. plan, scene: see
 * image_plan_make and campaign_read_scene. Errors: those of campaign_read_scene. */
#define REASON_CAPACITY 240
sonject_status campaign_draw_scene(struct sonject_campaign *campaign, uint64_t id,
                                   struct attempts *attempts, char reason[REASON_CAPACITY],
                                   struct image_plan *plan, struct scene *scene);

/* Draws a picture of a measured swath with the boxes to avoid. A swath with pixels that are not
 * numbers gets no picture. Errors: those of sonject_quicklook, except INPUT. */
sonject_status campaign_draw_swath(struct sonject_campaign *campaign, uint32_t number,
                                   const char *picture);

/* Checks that a swath and all files that scenes name are as they were when the campaign was read
 * and hashed. Errors: INPUT. */
sonject_status campaign_check_unchanged(const struct sonject_campaign *campaign, uint32_t swath);

/* Checks that the campaign has an image of that id. Errors: ARGUMENT. */
sonject_status campaign_check_id(const struct sonject_campaign *campaign, uint64_t id);

/* An image while it is made. Starts as all zeros; to be given to campaign_image_clear. */
struct campaign_image {
    struct image_plan plan;
    struct scene scene;
    struct swath swath;
    struct injection_result result;
    uint32_t attempts;                   /* number of draws given up */
    char reason[REASON_CAPACITY];        /* why the first was given up */
    bool is_faint[CAMPAIGN_TARGETS_MAX]; /* targets that are less visible than the campaign asks */
};

/* Plans the image, reads its scene and its part of the swath, and injects. Draws again, up to
 * ATTEMPTS_MAX times, where values do not fit each other, objects do not fit, or targets are not
 * visible enough. Refuses files that were changed since the campaign was read. Errors: those of
 * sonject_campaign_inject; the message names the image. */
sonject_status campaign_image_make(struct device *device, struct sonject_campaign *campaign,
                                   uint64_t id, sonject_progress_function progress, void *user,
                                   struct campaign_image *image);
void campaign_image_clear(struct campaign_image *image);

/* Replaces the image by the amplitudes of the numbers that its file would store. A detector trained
 * in memory then sees the same rounding and full scale as in the file. Errors: MEMORY. */
sonject_status campaign_image_round(struct report *report, struct campaign_image *image);

#define CALIBRATIONS_FOLDER "calibrations" /* below a run's folder */

/* Makes the calibration that a scene asks for, in the run's folder, and leaves the scene
 * initialised and empty. name: of the file, without extension. Errors: those of scene_calibrate. */
sonject_status campaign_calibrate(struct sonject_campaign *campaign, const char *name,
                                  struct scene *scene, char path[PATH_CAPACITY]);

/* Makes a swath's calibration and keeps its path in campaign->calibrations, so that later scenes of
 * the swath have it from the start. */
sonject_status campaign_calibrate_swath(struct sonject_campaign *campaign, size_t swath,
                                        struct scene *scene);

/* Releases campaign->calibrations when a run has ended. */
void campaign_forget_calibrations(struct sonject_campaign *campaign);

/* Writes the image's files below the folder, its record last. Errors: STORAGE, MEMORY,
 * UNSUPPORTED. */
sonject_status campaign_image_write(struct sonject_campaign *campaign, struct campaign_image *image,
                                    const char *folder);

/* The tools with which a thread makes images. All of them are the thread's own. */
struct image_maker {
    struct device *device;
    struct sonject_campaign *campaign;
    sonject_progress_function progress; /* for campaign_image_make, with user */
    void *user;
};

/* A number of images to make in parallel. */
struct image_work {
    uint64_t count;
    /* Makes image 0...count - 1. Called once for each image, by any thread, in rising order. */
    sonject_status (*make)(void *user, const struct image_maker *maker, uint64_t index);
    /* Called by the calling thread. done: images, fractions of unfinished ones included. stage: of
     * one of them. Not 0 cancels. */
    int (*tell)(void *user, double done, const char *stage);
    void *user;
};

/* Makes the images with two threads for each processor, 16 at most, fewer where images are large.
 * After a failure, images under way are finished; the message is of the first image that failed.
 * slot: how each thread opens the device. Errors: those of make, CANCELLED, MEMORY. */
sonject_status campaign_work(struct sonject_campaign *campaign, const struct device_slot *slot,
                             const struct image_work *work);

/* Makes the images that params asks for and the folder lacks, and the documents of the whole; see
 * sonject_campaign_run. */
sonject_status campaign_run(struct sonject_campaign *campaign, struct device_slot *slot,
                            const sonject_campaign_run_params *params,
                            sonject_progress_function progress, void *user, int *was_finished);

/* Writes the documents of the whole once all images are there; see sonject_campaign_merge. */
sonject_status campaign_merge(struct report *report, const char *folder,
                              sonject_progress_function progress, void *user);

#endif
