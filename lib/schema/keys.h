/* The keys of scene files: tables of rows, one table a section. All that is known of a key stands
 * in its row, and everything else is made from it: reading, checking, defaults, the scene's hash,
 * the list of all keys. Adding a key is adding a row. Below the tables: how they are read. */
#ifndef SONJECT_SCHEMA_KEYS_H
#define SONJECT_SCHEMA_KEYS_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/units.h"
#include "scene/scene.h"
#include "schema/tables.h"
#include "schema/yaml_tree.h"

#define FIELD_WORDS_MAX 20
#define HINT_CAPACITY   80

enum field_kind {
    FIELD_QUANTITY, /* double; or a section, if the row has one */
    FIELD_UNIT,     /* double: what one of a file's numbers stands for, "2.54 cm" or "mm" */
    FIELD_COUNT32,  /* uint32_t */
    FIELD_COUNT64,  /* uint64_t */
    FIELD_BOOL,     /* bool */
    FIELD_WORD,     /* uint32_t, the word's index; or a section, if the row has one */
    FIELD_LABEL,    /* char[SONJECT_NAME_CAPACITY] */
    FIELD_TEXT,     /* char *, owned by the structure */
    FIELD_PATH,     /* char *, owned by the scene */
    FIELD_FILE,     /* the same, of a file that is there */
    FIELD_SECTION,  /* a structure; the same one as its parent's where offset is 0 */
    FIELD_NAMED,    /* the same, or a single text that `read` takes into the structure */
    FIELD_ENTRIES,  /* an array of structures, which the section fills, and how many there are */
    FIELD_SPECIAL   /* no single member: read by a function of its own; NULL: before the table is */
};

/* What bounds of a number mean. */
enum bounds {
    ABOVE_LEAST = 1, /* `least` itself is too little */
    BELOW_MOST = 2,  /* `most` itself is too much */
    ZERO_IS_NONE = 4 /* 0 stands for no value */
};

struct reader;
struct section;

/* Members that a row does not name are 0. */
struct field {
    const char *key;
    const char *meaning;
    enum field_kind kind;
    bool is_required;
    bool is_list;     /* the section is that of each entry */
    bool is_hidden;   /* no key: a member that the way in which others are written tells */
    bool is_in_scene; /* offset is that in struct scene, wherever the section is */
    enum quantity quantity;
    size_t offset;
    double preset;      /* the value that is there without the key; of a word its number */
    double least, most; /* both 0: any finite number, all that a count's type holds */
    uint32_t bounds;    /* enum bounds */
    const char *range;  /* told behind "must be" where the bounds alone say too little */
    const char *per;    /* told behind the bounds' numbers, where that is not the unit */
    /* Ended by NULL. FIELD_WORD: in the order of the enumeration, "" for values that no word stands
     * for. FIELD_QUANTITY: instead of a number, for the values of word_values. */
    const char *words[FIELD_WORDS_MAX];
    double word_values[2];
    /* A uint32_t of the structure that the key, where it is given, sets to `kind_value`; else the
     * row says nothing. */
    bool has_kind;
    size_t kind_offset;
    uint32_t kind_value;
    uint32_t maximum;                 /* entries */
    size_t count_offset, entry_bytes; /* of entries: where a uint32_t counts them, size of one */
    const struct section *section;
    const char
        *unit; /* as told to users, where kind and quantity do not say it; what an entry is */
    /* Reads the key in a way of its own, into the section's structure; FIELD_NAMED: a text. NULL of
     * FIELD_SPECIAL: it is read elsewhere. */
    sonject_status (*read)(struct reader *reader, const struct tree_node *node, void *structure);
};

struct section {
    const struct field *fields;
    size_t count;
    /* Keys of which exactly one is to be there, separated by blanks, "a b"; or sets of which one
     * is, "a+b c+d". NULL: any. */
    const char *choice;
    /* Whether values fit each other; NULL: they do. */
    void (*relations)(struct check *check, const void *structure);
    /* Called in its place once a section was read, if there is one. */
    sonject_status (*finish)(struct reader *reader, const struct tree_node *node, void *structure);
    size_t bytes;  /* of the structure, where the section is all of it */
    bool may_lack; /* the choice */
};

/* ---- How rows are written; STRUCTURE is the type of their section's structure. */

#define ROWS(table) .fields = (table), .count = COUNT(table) /* of a section */

#define MEMBER(its)             .offset = offsetof(STRUCTURE, its)
#define QUANTITY(its, of)       .kind = FIELD_QUANTITY, .quantity = QUANTITY_##of, MEMBER(its)
#define COUNT32(its, low, high) .kind = FIELD_COUNT32, MEMBER(its), WITHIN(low, high)
#define COUNT64(its, low, high) .kind = FIELD_COUNT64, MEMBER(its), WITHIN(low, high)
#define FLAG(its)               .kind = FIELD_BOOL, MEMBER(its)
#define WORD(its)               .kind = FIELD_WORD, MEMBER(its), .words
#define LABEL(its)              .kind = FIELD_LABEL, MEMBER(its)
#define TEXT(its)               .kind = FIELD_TEXT, MEMBER(its)
#define SPECIAL(reads, told)    .kind = FIELD_SPECIAL, .read = (reads), .unit = (told)
#define LENGTH_UNIT(its)        .kind = FIELD_UNIT, .unit = "m, km, cm, mm", MEMBER(its)
#define REQUIRED                .is_required = true
#define HIDDEN                  .is_hidden = true
#define SETS(its, value)                                                                           \
    .has_kind = true, .kind_offset = offsetof(STRUCTURE, its), .kind_value = (value)

/* A section that fills a structure of its own, one that fills its parent's, and one of the scene.
 */
#define PART(its, table) .kind = FIELD_SECTION, .section = &(table), MEMBER(its)
#define SAME(table)      .kind = FIELD_SECTION, .section = &(table)
#define OF_SCENE(its, table)                                                                       \
    .kind = FIELD_SECTION, .section = &(table), .is_in_scene = true,                               \
    .offset = offsetof(struct scene, its)

/* A list of at most as many entries as the array holds. word: what one is. */
#define ENTRIES(its, number, word, table)                                                          \
    .kind = FIELD_ENTRIES, .is_list = true, .unit = word, .section = &(table), MEMBER(its),        \
    .count_offset = offsetof(STRUCTURE, number), .entry_bytes = sizeof((STRUCTURE *)0)->its[0],    \
    .maximum = sizeof((STRUCTURE *)0)->its / sizeof((STRUCTURE *)0)->its[0]

/* Bounds. Lengths are kept to what a sonar can meet, so that no later computation overflows. */
#define WITHIN(low, high) .least = (low), .most = (high)
#define POSITIVE          WITHIN(LENGTH_MIN_M, LENGTH_MAX_M)
#define FROM_ZERO         WITHIN(0.0, LENGTH_MAX_M)
#define COORDINATE        WITHIN(-LENGTH_MAX_M, LENGTH_MAX_M)
#define NONE_IF_ZERO      .bounds = ZERO_IS_NONE
#define NONE_IF_NAN       .preset = NAN

#define PI 3.14159265358979323846

/* A place of the image, in metres or pixels; range_meant: of slant_range. */
#define INDEX_MAX 1099511627776.0 /* 2^40 pixels */
#define PLACE_FIELDS(range_meant, least_index)                                                     \
    {"along_track", "track position", QUANTITY(position_along, LENGTH), COORDINATE,                \
     SETS(position_kind, SONJECT_POSITION_METRES)},                                                \
        {"slant_range", range_meant, QUANTITY(position_range, LENGTH), FROM_ZERO,                  \
         SETS(position_kind, SONJECT_POSITION_METRES)},                                            \
        {"row", "of the swath, may be a fraction", QUANTITY(position_along, NUMBER),               \
         WITHIN(least_index, INDEX_MAX), SETS(position_kind, SONJECT_POSITION_PIXELS)},            \
    {                                                                                              \
        "column", "of the swath, may be a fraction", QUANTITY(position_range, NUMBER),             \
            WITHIN(least_index, INDEX_MAX), SETS(position_kind, SONJECT_POSITION_PIXELS)           \
    }
#define CENTRE_WORD                                                                                \
    WORD(position_kind) = {[SONJECT_POSITION_PATCH_CENTRE] = "centre",                             \
                           [SONJECT_POSITION_METRES] = "",                                         \
                           [SONJECT_POSITION_PIXELS] = ""}

/* ---- What is made from the tables, in keys.c. */

/* The values that are there without any key, in all of a section's structure. scene: whose members
 * it sets, too; NULL: none. */
void section_defaults(const struct section *section, void *structure, struct scene *scene);

/* A section's keys, and those below, as a JSON array, in the tables' order, for free(): objects
 * with path
 * ("objects[].heading"), section (the path of the section that it is in, "" at the top), meaning,
 * kind (quantity, count, flag, word, name, text, file, section, list or special), unit (as users
 * are told it), has_value (it may be written as one value; else as a section or list alone),
 * is_list, is_required (in its section), words (an array, or null), default and range (in words, as
 * users are told), preset, least and most (the same as numbers in the SI unit; least and most may
 * be open). What there is none of is null. Errors: MEMORY. */
sonject_status section_keys_json(struct report *report, const struct section *section, char **text);

/* Whether a key's value in the structure is within its bounds; else what gets "must be 1...8, not
 * 9". */
bool field_is_sound(const struct field *field, const void *structure, char what[300]);

/* The section that a structure's values continue in, and its structure; NULL: none. index: of the
 * entry of a list. scene: as of section_defaults. */
const struct section *field_below(const struct field *field, const void *structure,
                                  const struct scene *scene, uint32_t index, const void **below);

/* How many structures lie below a row: 1, or a list's entries. */
uint32_t field_entry_count(const struct field *field, const void *structure);

/* Whether texts of the key name files. */
bool field_is_file(const struct field *field);

/* Whether texts of the key, or of its list's entries, are or may be numbers without a unit. */
bool field_is_number(const struct field *field);

/* Whether texts of the key are quantities, or those of its list's entries are, and of which kind.
 */
bool field_quantity(const struct field *field, enum quantity *quantity);

/* Finds a key path such as "sonar.frequency" or "seabed.relief[0].height" below a section. False
 * where the section has none, and *near is the word most like the part that is unknown, NULL if
 * none is; *section is the one that lacks it. */
bool scene_key_find(const struct section *top, const char *path, const char **near,
                    const struct section **section);

/* The same of scenes: else hint gets "; did you mean 'x'?", "" where nothing is near. */
bool scene_key_is_known(const char *path, char hint[HINT_CAPACITY]);

/* That scenes have all keys of a node, which lies at the path. what: is said of others, before the
 * hint; behind: after it. Errors: INPUT. */
sonject_status check_scene_keys(const struct tree *tree, const struct tree_node *node,
                                struct key_path *path, const char *what, const char *behind);

/* ---- The sections. The whole file's structure is struct scene. */

extern const struct section scene_section, input_section, sonar_section, pulse_section,
    seabed_section, forward_section, relief_section, relief_grid_section, surface_section,
    material_section, medium_section, layer_section, injection_section, elements_section,
    object_section, part_section, mesh_section;

/* ---- Reading. */

struct reader {
    struct check_listener listener;  /* first */
    const struct tree_node *checked; /* section that it hears of */
    struct report *report;
    const struct tree *tree;
    struct scene *scene;
    bool takes_geometry; /* of the input file, once all is read */
    enum altitude_source altitude_by;
    bool takes_first_range;
    const char *moved_folder; /* as in struct scene_source */
    size_t moved_overrides;
    const struct number_array *arrays; /* in place of files */
    size_t array_count;
    const char *made_calibration; /* file that stands for input.calibration: auto; NULL: none */
    bool has_no_channels;         /* the input is an image: input.channel does not count */
    bool takes_pixels;            /* the input may be pixels that a call is given */
    struct key_path path;         /* of the section or key that is read */
};

/* Reads a section's keys into structure. What is wrong is refused and keeps the value that it has,
 * and the reading goes on, so that all mistakes are told; a check of values beside each other says
 * nothing where one of them is wrong. Errors: INPUT, and STORAGE and MEMORY, which end a reading.
 */
sonject_status read_section(struct reader *reader, const struct section *section,
                            const struct tree_node *node, void *structure);

/* Takes the keys of the file that input.calibration names under those of the scene. Errors: INPUT,
 * STORAGE, MEMORY. */
sonject_status take_calibration(struct reader *reader, struct tree *tree);

/* Whether a status is one after which nothing more is read. */
bool reading_ends(sonject_status status);

/* Reads each entry of a list of at least and at most so many. how: is said of what is no list, or
 * has fewer. */
struct list {
    size_t least, most;
    const char *how; /* behind "must be a list" */
    sonject_status (*read)(struct reader *reader, const struct tree_node *node, void *structure);
};
sonject_status read_list(struct reader *reader, const struct tree_node *node,
                         const struct list *list, void *structure);

/* The text of a single value; NULL after a message, whose status is INPUT. */
const char *read_text(struct reader *reader, const struct tree_node *node);

/* Whether a node is one word. */
bool is_word(const struct tree_node *node, const char *word);

/* Reads a text as a quantity, of any value. */
sonject_status read_quantity(struct reader *reader, const struct tree_node *node,
                             enum quantity quantity, double *value);

/* Reads a text as the name of a file: one in the file is meant from the file's folder, one of an
 * override from where the user is. On success *path is the caller's, for free(). */
sonject_status read_path(struct reader *reader, const struct tree_node *node, char **path);

/* The array that stands for a file; NULL: it is a file. */
const struct number_array *find_array(const struct reader *reader, const char *path);

/* The same as read_path for a file that must be there, or an array in its place. */
sonject_status read_existing_path(struct reader *reader, const struct tree_node *node, char **path);

/* Reads the table whose file, or array in its place, a text names. */
sonject_status read_number_table(struct reader *reader, const struct tree_node *node,
                                 const struct table_format *format, struct number_table *table);

/* Reads the version of a format, which is 1. */
sonject_status read_version(struct reader *reader, const struct tree_node *node, void *structure);

/* Reads the list of objects into the reader's scene. */
sonject_status read_objects(struct reader *reader, const struct tree_node *node, void *structure);

/* Reads a mesh into the scene; structure: the sonject_object_params that has it. */
sonject_status read_mesh(struct reader *reader, const struct tree_node *node, void *structure);

/* Finds the number of a material by its name, or of a sediment whose grains are known. */
sonject_status find_material(struct reader *reader, const struct tree_node *node, bool of_sediments,
                             uint32_t *index);

/* Take the name of a material, and of the seabed's, whose backscatter stays the seabed's own.
 * structure: a sonject_material_params. */
sonject_status read_material_name(struct reader *reader, const struct tree_node *node,
                                  void *structure);
sonject_status read_sediment_name(struct reader *reader, const struct tree_node *node,
                                  void *structure);

/* That a material returns no more than it receives. prefix: of its keys. own_lambert: of one whose
 * lambert is NaN; NaN: it must have one. */
void relate_energy(struct check *check, const char *prefix, const sonject_material_params *material,
                   double own_lambert);

/* The field of a key, length bytes long, that is not hidden; NULL: there is none. */
const struct field *field_of(const struct section *section, const char *key, size_t length);

/* ---- Refusing, in mistakes.c. */

/* Words in a message, "a, b, c". */
struct word_list {
    char text[300];
    size_t count;
};
void list_word(struct word_list *list, const char *word);

/* Lists a section's keys, and finds the one nearest to a mistyped one; NULL if none is near. */
const char *nearest_key(const struct section *section, const char *key, size_t length,
                        struct word_list *list);

/* "'steal' is not one of a, b, c; did you mean 'b'?" Returns INPUT. near: NULL for no hint. */
sonject_status refuse_word(const struct reader *reader, const struct tree_node *node,
                           const char *word, const struct word_list *known, const char *near);

/* The message about the value at the reader's path. Returns INPUT. */
sonject_status refuse_value(const struct reader *reader, const struct tree_node *node,
                            const char *format, ...) REPORT_FORMAT(3);

/* The same about a key of the section node at the reader's path, "material.lambert" for instance:
 * the message points at the key, or at the section where that is not there. Nothing is said where
 * something else is wrong about the key already. */
sonject_status refuse_key(struct reader *reader, const struct tree_node *node, const char *key,
                          const char *format, ...) REPORT_FORMAT(4);

/* The same, unless one of some other keys, separated by blanks, is wrong. */
sonject_status refuse_relation(struct reader *reader, const struct tree_node *node, const char *key,
                               const char *others, const char *format, ...) REPORT_FORMAT(5);

/* A check that refuses every value of the section node that it finds wrong. */
struct check check_at(struct reader *reader, const struct tree_node *node);

/* Whether nothing is wrong about any of some keys, separated by blanks, of the section at the
 * reader's path. */
bool are_sound(struct reader *reader, const char *keys);

/* The same of one key of the whole file. */
bool is_sound_in_file(const struct reader *reader, const char *path);

/* Makes a key wrong that another message is about; "": what is at the reader's path itself. */
void mark_wrong(struct reader *reader, const struct tree_node *node, const char *key);

/* Whether a section has a key, and how many it has of some, separated by blanks. */
bool is_given(const struct tree_node *node, const char *key);
size_t count_given(const struct tree_node *node, const char *keys);

/* Takes the first of some keys, which blanks separate. False where there is none. */
bool next_key(const char **keys, char key[64]);

/* The word of a sonject_transfer_kind. */
const char *transfer_word(uint32_t kind);

/* The word of the list nearest to a mistyped one; NULL if none is near. */
const char *nearest_word(const char *typed, const char *const *words, size_t count);

#endif
