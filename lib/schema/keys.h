/* The keys of scene files: tables of rows, one table per section. A row holds all that is known of
 * a key. Reading, checking, defaults, the scene's hash and the list of all keys are made from the
 * rows. Adding a key is adding a row. */
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
    FIELD_QUANTITY, /* double, or a section if the row has one */
    FIELD_UNIT,     /* double: length of one unit of a file's numbers, "2.54 cm" or "mm" */
    FIELD_COUNT32,  /* uint32_t */
    FIELD_COUNT64,  /* uint64_t */
    FIELD_BOOL,     /* bool */
    FIELD_WORD,     /* uint32_t: index of the word, or a section if the row has one */
    FIELD_LABEL,    /* char[SONJECT_NAME_CAPACITY] */
    FIELD_TEXT,     /* char *, owned by the structure */
    FIELD_PATH,     /* char *, owned by the scene */
    FIELD_FILE,     /* char *, owned by the structure: a file that exists */
    FIELD_SECTION,  /* a structure, which is the parent's own where offset is 0 */
    FIELD_NAMED,    /* a structure, or a single text that `read` takes into it */
    FIELD_ENTRIES,  /* an array of structures that the section fills, and their number */
    FIELD_SPECIAL   /* `read` reads it into the member, or the structure; NULL: read elsewhere */
};

/* Details of a number's bounds. */
enum bounds {
    ABOVE_LEAST = 1, /* `least` itself is too small */
    BELOW_MOST = 2,  /* `most` itself is too large */
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
    bool is_list;     /* `section` describes each entry */
    bool is_hidden;   /* no key: other keys set the member */
    bool is_in_scene; /* offset counts in struct scene, wherever the section is */
    enum quantity quantity;
    size_t offset;
    double preset;      /* the value without the key; for a word, its number */
    bool hides_preset;  /* no default is told, since the section asks for the key */
    double least, most; /* both 0: any finite number, or any count that the type holds */
    uint32_t bounds;    /* enum bounds */
    const char *range;  /* text after "must be" where the bounds alone say too little */
    const char *per;    /* unit after the bounds' numbers, where it is not the quantity's */
    /* The words, ended by NULL. FIELD_WORD: in the order of the enumeration, "" for a value without
     * a word. FIELD_QUANTITY: words instead of a number, with the values in word_values. */
    const char *words[FIELD_WORDS_MAX];
    double word_values[2];
    /* If has_kind, the key sets the uint32_t at kind_offset in the structure to kind_value. */
    bool has_kind;
    size_t kind_offset;
    uint32_t kind_value;
    uint32_t maximum;                 /* largest number of entries */
    size_t count_offset, entry_bytes; /* entries: offset of their uint32_t count; size of one */
    const struct section *section;
    const char *unit; /* for users where kind and quantity tell none; the word for an entry */
    /* Reads the key into the section's structure in its own way; FIELD_SPECIAL: into the member at
     * offset; FIELD_NAMED: reads only a single text, into the member. */
    sonject_status (*read)(struct reader *reader, const struct tree_node *node, void *structure);
};

struct section {
    const struct field *fields;
    size_t count;
    /* Keys separated by blanks, "a b", exactly one of which must be there; or sets of keys, "a+b
     * c+d", exactly one of which must. NULL: no such rule. */
    const char *choice;
    /* Checks whether values fit each other; NULL: no check. */
    void (*relations)(struct check *check, const void *structure);
    /* Finishes a section after all its keys were read; NULL: nothing to do. */
    sonject_status (*finish)(struct reader *reader, const struct tree_node *node, void *structure);
    size_t bytes;  /* size of the structure, where the section fills all of it */
    bool may_lack; /* none of the choice need be there */
};

/* ---- Macros that write rows. STRUCTURE is the type of their section's structure. */

#define ROWS(table) .fields = (table), .count = COUNT(table) /* for a struct section */

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

/* Sections that fill a structure of their own, their parent's, or one of the scene. */
#define PART(its, table) .kind = FIELD_SECTION, .section = &(table), MEMBER(its)
#define SAME(table)      .kind = FIELD_SECTION, .section = &(table)
#define OF_SCENE(its, table)                                                                       \
    .kind = FIELD_SECTION, .section = &(table), .is_in_scene = true,                               \
    .offset = offsetof(struct scene, its)

/* A list of at most as many entries as the array holds. word: the word for an entry. */
#define ENTRIES(its, number, word, table)                                                          \
    .kind = FIELD_ENTRIES, .is_list = true, .unit = word, .section = &(table), MEMBER(its),        \
    .count_offset = offsetof(STRUCTURE, number), .entry_bytes = sizeof((STRUCTURE *)0)->its[0],    \
    .maximum = sizeof((STRUCTURE *)0)->its / sizeof((STRUCTURE *)0)->its[0]

/* Bounds. Lengths are limited to what a sonar can meet, so that no later computation overflows. */
#define WITHIN(low, high) .least = (low), .most = (high)
#define POSITIVE          WITHIN(LENGTH_MIN_M, LENGTH_MAX_M)
#define FROM_ZERO         WITHIN(0.0, LENGTH_MAX_M)
#define COORDINATE        WITHIN(-LENGTH_MAX_M, LENGTH_MAX_M)
#define NONE_IF_ZERO      .bounds = ZERO_IS_NONE
#define NONE_IF_NAN       .preset = NAN

#define PI 3.14159265358979323846

/* The keys of a place in the image, in metres or pixels. range_meant: meaning of slant_range. */
#define INDEX_MAX 1099511627776.0 /* 2^40 pixels */
#define PLACE_FIELDS(range_meant, least_index)                                                     \
    {"along_track", "along-track position", QUANTITY(position_along, LENGTH), COORDINATE,          \
     SETS(position_kind, SONJECT_POSITION_METRES)},                                                \
        {"slant_range", range_meant, QUANTITY(position_range, LENGTH), FROM_ZERO,                  \
         SETS(position_kind, SONJECT_POSITION_METRES)},                                            \
        {"row", "row of the swath; may be a fraction", QUANTITY(position_along, NUMBER),           \
         WITHIN(least_index, INDEX_MAX), SETS(position_kind, SONJECT_POSITION_PIXELS)},            \
    {                                                                                              \
        "column", "column of the swath; may be a fraction", QUANTITY(position_range, NUMBER),      \
            WITHIN(least_index, INDEX_MAX), SETS(position_kind, SONJECT_POSITION_PIXELS)           \
    }
#define CENTRE_WORD                                                                                \
    WORD(position_kind) = {[SONJECT_POSITION_PATCH_CENTRE] = "centre",                             \
                           [SONJECT_POSITION_METRES] = "",                                         \
                           [SONJECT_POSITION_PIXELS] = ""}

/* ---- Functions made from the tables, in keys.c. */

/* Sets all of a section's structure to the defaults, and the members of scene that the section
 * sets. scene: NULL leaves these out. */
void section_defaults(const struct section *section, void *structure, struct scene *scene);

/* Writes a section's keys, and those below, as a JSON array in the tables' order, for free(). Each
 * key is an object with the members path ("objects[].heading"), section (the path of its section,
 * "" at the top), meaning, kind (quantity, count, flag, word, name, text, file, section, list or
 * special), unit (as users read it), has_value (the key may be written as one value; otherwise only
 * as a section or list), is_list, is_required (in its section), words (an array, or null), default
 * and range (in words, for users), preset, least and most (numbers in the SI unit; least and most
 * may be open). A missing item is null. Errors: MEMORY. */
sonject_status section_keys_json(struct report *report, const struct section *section, char **text);

/* Returns whether a key's value is within its bounds. If not, what gets "must be 1...8, not 9". */
bool field_is_valid(const struct field *field, const void *structure, char what[300]);

/* Returns the section that describes the values below a field, and its structure in *below; NULL:
 * there is none. index: of the entry of a list. scene: as for section_defaults. */
const struct section *field_below(const struct field *field, const void *structure,
                                  const struct scene *scene, uint32_t index, const void **below);

/* Returns how many structures lie below a row: 1, or the number of a list's entries. */
uint32_t field_entry_count(const struct field *field, const void *structure);

/* Returns whether texts of the key name files. */
bool field_is_file(const struct field *field);

/* Returns whether texts of the key, or of its list's entries, may be numbers without a unit. */
bool field_is_number(const struct field *field);

/* Returns whether texts of the key, or of its list's entries, are quantities of kind *quantity. */
bool field_quantity(const struct field *field, enum quantity *quantity);

/* Finds a key path such as "sonar.frequency" or "seabed.relief[0].height" below a section. Returns
 * false if there is no such key: *near is then the word nearest to the unknown part (NULL: none is
 * near), and *section the section that lacks it. */
bool scene_key_find(const struct section *top, const char *path, const char **near,
                    const struct section **section);

/* Returns whether scenes have a key path. If not, hint gets "; did you mean 'x'?", or "" if nothing
 * is near. */
bool scene_key_is_known(const char *path, char hint[HINT_CAPACITY]);

/* Checks that scenes have all keys of a node, which lies at the path. The message about an unknown
 * key is what, the hint, and behind. Errors: INPUT. */
sonject_status check_scene_keys(const struct tree *tree, const struct tree_node *node,
                                struct key_path *path, const char *what, const char *behind);

/* ---- The sections. The whole file's structure is struct scene. */

extern const struct section scene_section, input_section, sonar_section, pulse_section,
    seabed_section, forward_section, relief_section, relief_grid_section, surface_section,
    material_section, medium_section, layer_section, injection_section, elements_section,
    object_section, part_section, mesh_section;

/* ---- Reading. */

struct reader {
    struct check_listener listener;  /* first member: hear casts it to the reader */
    const struct tree_node *checked; /* section that the listener hears of */
    struct report *report;
    const struct tree *tree;
    struct scene *scene;
    bool takes_geometry; /* the input file gives the geometry, taken when all keys are read */
    enum altitude_source altitude_by;
    bool takes_first_range;
    const char *moved_folder; /* this and the next: as in struct scene_source */
    size_t moved_overrides;
    const struct number_array *arrays; /* arrays that stand in for files */
    size_t array_count;
    const char *made_calibration; /* file that stands for input.calibration: auto; NULL: none */
    bool has_no_channels;         /* the input is an image, so input.channel is ignored */
    bool takes_pixels;            /* the input may be pixels that a call is given */
    struct key_path path;         /* path of the section or key being read */
};

/* Reads a section's keys into structure. A wrong value is refused, and the member keeps its old
 * value. The reading goes on, so that all mistakes are reported. Values are not checked against a
 * wrong one. Errors: INPUT; STORAGE and MEMORY, which end the reading. */
sonject_status read_section(struct reader *reader, const struct section *section,
                            const struct tree_node *node, void *structure);

/* Takes the keys of the file that input.calibration names, where the scene has none of its own.
 * Errors: INPUT, STORAGE, MEMORY. */
sonject_status take_calibration(struct reader *reader, struct tree *tree);

/* Returns whether nothing more is read after a status. */
bool reading_ends(sonject_status status);

/* A list with bounds on the number of its entries, and the function that reads one. read_list
 * refuses with `how` what is no list or has too few entries. */
struct list {
    size_t least, most;
    const char *how; /* text after "must be a list" */
    sonject_status (*read)(struct reader *reader, const struct tree_node *node, void *structure);
};
sonject_status read_list(struct reader *reader, const struct tree_node *node,
                         const struct list *list, void *structure);

/* Returns the text of a single value, or NULL after a message, whose status is INPUT. */
const char *read_text(struct reader *reader, const struct tree_node *node);

/* Returns whether a node is this word. */
bool is_word(const struct tree_node *node, const char *word);

/* Reads a text as a quantity, without bounds. */
sonject_status read_quantity(struct reader *reader, const struct tree_node *node,
                             enum quantity quantity, double *value);

/* Reads a text as the name of a file, relative to the scene file's folder, or for an override to
 * the user's working folder. On success *path is the caller's, for free(). */
sonject_status read_path(struct reader *reader, const struct tree_node *node, char **path);

/* Returns the array that stands in for a file, or NULL if it is a file. */
const struct number_array *find_array(const struct reader *reader, const char *path);

/* Works like read_path, for a file that must exist or an array in its place. */
sonject_status read_existing_path(struct reader *reader, const struct tree_node *node, char **path);

/* Reads a table from the file that a text names, or from the array in its place. */
sonject_status read_number_table(struct reader *reader, const struct tree_node *node,
                                 const struct table_format *format, struct number_table *table);

/* Reads the version of a format, which must be 1. */
sonject_status read_version(struct reader *reader, const struct tree_node *node, void *structure);

/* Reads the list of objects into the reader's scene. */
sonject_status read_objects(struct reader *reader, const struct tree_node *node, void *structure);

/* Reads a mesh into the scene; structure: the sonject_object_params that has it. */
sonject_status read_mesh(struct reader *reader, const struct tree_node *node, void *structure);

/* Finds the number of a material by its name. of_sediments: only sediments of known grain size. */
sonject_status find_material(struct reader *reader, const struct tree_node *node, bool of_sediments,
                             uint32_t *index);

/* Take the name of a material. read_sediment_name leaves the Lambert coefficient to the seabed.
 * structure: a sonject_material_params. */
sonject_status read_material_name(struct reader *reader, const struct tree_node *node,
                                  void *structure);
sonject_status read_sediment_name(struct reader *reader, const struct tree_node *node,
                                  void *structure);

/* Checks that a material returns no more than it receives. prefix: of the material's keys.
 * own_lambert: replaces a lambert that is NaN; NaN: the material must have one. */
void relate_energy(struct check *check, const char *prefix, const sonject_material_params *material,
                   double own_lambert);

/* Returns the visible field of a key that is length bytes long, or NULL if there is none. */
const struct field *field_of(const struct section *section, const char *key, size_t length);

/* ---- Error messages, in mistakes.c. */

/* The words of a message, "a, b, c". */
struct word_list {
    char text[300];
    size_t count;
};
void list_word(struct word_list *list, const char *word);

/* Lists a section's keys. Returns the one nearest to a mistyped key, or NULL if none is near. */
const char *nearest_key(const struct section *section, const char *key, size_t length,
                        struct word_list *list);

/* Reports "'steal' is not one of a, b, c; did you mean 'b'?", returns INPUT. near: may be NULL. */
sonject_status refuse_word(const struct reader *reader, const struct tree_node *node,
                           const char *word, const struct word_list *known, const char *near);

/* Reports a message about the value at the reader's path and returns INPUT. */
sonject_status refuse_value(const struct reader *reader, const struct tree_node *node,
                            const char *format, ...) REPORT_FORMAT(3);

/* Reports a message about a key of the section node at the reader's path, "material.lambert" for
 * instance. The message points at the key, or at the section if the key is not there. Says nothing
 * if the key, or one of others, separated by blanks, is already known to be wrong. Returns INPUT.
 */
sonject_status refuse_relation(struct reader *reader, const struct tree_node *node, const char *key,
                               const char *others, const char *format, ...) REPORT_FORMAT(5);
#define refuse_key(reader, node, key, ...) refuse_relation(reader, node, key, "", __VA_ARGS__)

/* Returns a check that refuses every wrong value of the section node. */
struct check check_at(struct reader *reader, const struct tree_node *node);

/* Returns whether no key of a list, separated by blanks, is wrong in the section at the path. */
bool are_valid(struct reader *reader, const char *keys);

/* Returns whether a key path of the whole file is not wrong. */
bool is_valid_in_file(const struct reader *reader, const char *path);

/* Marks a key as wrong that another message is about. "": the value at the reader's path. */
void mark_wrong(struct reader *reader, const struct tree_node *node, const char *key);

/* Return whether a section has a key, and how many of some keys, separated by blanks, it has. */
bool is_given(const struct tree_node *node, const char *key);
size_t count_given(const struct tree_node *node, const char *keys);

/* Takes the first of some keys, separated by blanks. Returns false if none is left. */
bool next_key(const char **keys, char key[64]);

/* Returns the word of a sonject_transfer_kind. */
const char *transfer_word(uint32_t kind);

/* Returns the word of the list nearest to a mistyped one, or NULL if none is near. */
const char *nearest_word(const char *typed, const char *const *words, size_t count);

#endif
