/* The keys of scene files: one table a section, which the reader walks. Adding a key is adding a
 * line to a table. */
#ifndef SONJECT_SCHEMA_SCENE_SCHEMA_H
#define SONJECT_SCHEMA_SCENE_SCHEMA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/units.h"
#include "scene/scene.h"
#include "schema/number_table.h"
#include "schema/yaml_tree.h"

#define FIELD_WORDS_MAX 15

enum field_kind {
    FIELD_QUANTITY, /* double; or a section, if the field has one */
    FIELD_COUNT32,  /* uint32_t */
    FIELD_COUNT64,  /* uint64_t */
    FIELD_BOOL,     /* bool */
    FIELD_FLAG32,   /* uint32_t, 0 or 1 */
    FIELD_WORD,     /* uint32_t, the word's index; or a section, if the field has one */
    FIELD_LABEL,    /* char[SONJECT_NAME_CAPACITY] */
    FIELD_TEXT,     /* char *, owned by the structure */
    FIELD_PATH,     /* char *, owned by the scene */
    FIELD_FILE,     /* the same, of a file that is there */
    FIELD_SECTION,  /* a structure; the same one as its parent's where offset is 0 */
    FIELD_NAMED,    /* the same, or a single text that `read` takes into the structure */
    FIELD_ENTRIES,  /* an array of structures, which the section fills, and how many there are */
    FIELD_SPECIAL   /* no single member: read by a function of its own */
};

struct reader;
struct section;

struct field {
    const char *key;
    const char *meaning;
    enum field_kind kind;
    bool is_required;
    bool is_list; /* the section is that of each entry */
    enum quantity quantity;
    const char *member;                 /* of the section's structure, as C writes it */
    size_t offset;                      /* of the destination in the section's structure */
    uint64_t maximum;                   /* of a count, or entries */
    size_t count_offset, entry_bytes;   /* of entries: where a uint32_t counts them, size of one */
    const char *words[FIELD_WORDS_MAX]; /* ended by NULL, in the order of the enumeration; "" for
                                           values that no word stands for */
    const struct section *section;
    const char
        *unit; /* as told to users, where kind and quantity do not say it; what an entry is */
    /* Reads the key in a way of its own, into the section's structure; FIELD_NAMED: a text. */
    sonject_status (*read)(struct reader *reader, const struct tree_node *node, void *structure);
};

struct section {
    const struct field *fields;
    size_t count;
    /* Called when all keys are read, for what they must be to each other; NULL: nothing. */
    sonject_status (*check)(struct reader *reader, const struct tree_node *node, void *structure);
};

struct reader {
    struct check_listener listener;  /* first */
    const struct tree_node *checked; /* section that it hears of */
    struct report *report;
    const struct tree *tree;
    struct scene *scene;
    bool allows_user_shapes; /* code in files is wanted */
    bool takes_geometry;     /* of the input file, once all is read */
    bool takes_altitude;
    const char *moved_folder; /* as in struct scene_text */
    size_t moved_overrides;
    const struct number_array *arrays; /* in place of files */
    size_t array_count;
    bool takes_pixels;    /* the input may be pixels that a call is given */
    struct key_path path; /* of the section or key that is read */
};

/* The whole file, and its section `input`; their structure is struct scene. */
extern const struct section scene_section, input_section;

/* Sections and entries of lists of the structures of the same names. */
extern const struct section patch_section, sonar_section, seabed_section, surface_section,
    injection_section, layer_section;

/* Reads a section's keys into structure. What is wrong is refused and keeps the value that it has,
 * and the reading goes on, so that all mistakes are told; a check of values beside each other says
 * nothing where one of them is wrong. Errors: INPUT, and STORAGE and MEMORY, which end a reading.
 */
sonject_status read_section(struct reader *reader, const struct section *section,
                            const struct tree_node *node, void *structure);

/* Whether a status is one after which nothing more is read. */
bool reading_ends(sonject_status status);

/* Reads each entry of a list of at most so many. how: is said of what is no list. */
struct list {
    size_t most;
    const char *how; /* behind "must be a list" */
    sonject_status (*read)(struct reader *reader, const struct tree_node *node, void *structure);
};
sonject_status read_list(struct reader *reader, const struct tree_node *node,
                         const struct list *list, void *structure);

/* Reads a text as a quantity. */
sonject_status read_quantity(struct reader *reader, const struct tree_node *node,
                             enum quantity quantity, double *value);

/* Reads what one of a file's numbers stands for: a length, "2.54 cm", or a unit by itself, "mm". */
sonject_status read_length_unit(struct reader *reader, const struct tree_node *node,
                                double *unit_m);

/* The text of a single value; NULL after a message, whose status is INPUT. */
const char *read_text(struct reader *reader, const struct tree_node *node);

/* Reads a text as the name of a file: one in the file is meant from the file's folder, one of an
 * override from where the user is. On success *path is the caller's, for free(). */
sonject_status read_path(struct reader *reader, const struct tree_node *node, char **path);

/* The array that stands for a file; NULL: it is a file. */
const struct number_array *find_array(const struct reader *reader, const char *path);

/* The same for a file that must be there, or an array in its place. */
sonject_status read_existing_path(struct reader *reader, const struct tree_node *node, char **path);

/* Words in a message, "a, b, c". */
struct word_list {
    char text[300];
    size_t count;
};
void list_word(struct word_list *list, const char *word);

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

/* For the check_ functions: refuses every value of the section node that they find wrong. */
struct check_listener *listen_at(struct reader *reader, const struct tree_node *node);

/* Whether nothing is wrong about any of some keys, separated by blanks, of the section at the
 * reader's path. */
bool are_sound(struct reader *reader, const char *keys);

/* Makes a key wrong that another message is about; "": what is at the reader's path itself. */
void mark_wrong(struct reader *reader, const struct tree_node *node, const char *key);

/* Whether a section has a key, and how many it has of some, separated by blanks. */
bool is_given(const struct tree_node *node, const char *key);
size_t count_given(const struct tree_node *node, const char *keys);

/* That exactly one of some keys is there. choice: them in words, "shape and parts". */
sonject_status check_one_given(struct reader *reader, const struct tree_node *node,
                               const char *keys, const char *choice);

/* That a position is given in metres or in pixels, and in which: a sonject_position_kind. */
sonject_status check_position(struct reader *reader, const struct tree_node *node, uint32_t *kind);

/* The word of the list nearest to a mistyped one; NULL if none is near. */
const char *nearest_word(const char *typed, const char *const *words, size_t count);

/* The special readers and the checks, in scene_relations.c. */
sonject_status read_version(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status read_noise_floor(struct reader *reader, const struct tree_node *node,
                                void *structure);
sonject_status read_match_looks(struct reader *reader, const struct tree_node *node,
                                void *structure);
sonject_status read_objects(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status read_aperture(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_scene(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_input(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_uniform(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_synthetic(struct reader *reader, const struct tree_node *node,
                                void *structure);
sonject_status finish_geometry(struct reader *reader, const struct tree_node *node,
                               void *structure);
sonject_status finish_transfer(struct reader *reader, const struct tree_node *node,
                               void *structure);
sonject_status finish_patch(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_sonar(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_response(struct reader *reader, const struct tree_node *node,
                               void *structure);
sonject_status finish_seabed(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_surface(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_injection(struct reader *reader, const struct tree_node *node,
                                void *structure);
sonject_status finish_position(struct reader *reader, const struct tree_node *node,
                               void *structure);
sonject_status finish_object(struct reader *reader, const struct tree_node *node, void *structure);

/* The water, in scene_medium.c. Its table fills a struct of its own, so read_medium reads it, when
 * sonar and surface are known. */
extern const struct section medium_section;
sonject_status read_medium(struct reader *reader, const struct tree_node *node, void *structure);

/* What an XTF file may say of itself, in scene_recording.c: the channel or array that is meant,
 * geometry and altitude. They are taken when the sonar's keys, and so the input's and the patch's,
 * are read: finish_recording is the sonar's check. */
extern const struct section geometry_section;
extern const struct section ping_spacing_section;
sonject_status read_channel(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status read_geometry(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status read_row_spacing(struct reader *reader, const struct tree_node *node,
                                void *structure);
sonject_status read_altitude(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status finish_recording(struct reader *reader, const struct tree_node *node,
                                void *structure);

/* The seabed's relief, in scene_relief.c. */
extern const struct section relief_section;
sonject_status read_relief(struct reader *reader, const struct tree_node *node, void *structure);

/* Its heights from a file, into the scene, in scene_heights.c. */
extern const struct section heights_section;
sonject_status read_relief_heights(struct reader *reader, const struct tree_node *node,
                                   void *structure);

/* The array of the element level, in scene_elements.c. */
extern const struct section elements_section;
/* Pulse, measured cross-range response and residual motion, in scene_response.c. */
extern const struct section pulse_section;
extern const struct section motion_section;
sonject_status read_pulse(struct reader *reader, const struct tree_node *node, void *structure);
sonject_status read_cross_range(struct reader *reader, const struct tree_node *node,
                                void *structure);
sonject_status read_motion(struct reader *reader, const struct tree_node *node, void *structure);

/* The objects' table, for read_objects, in scene_object.c. */
extern const struct section object_section;

/* Materials, in scene_material.c. A sonject_material_params, and the same within a
 * sonject_seabed_params with what else is said about the seabed there. */
extern const struct section material_section;
extern const struct section forward_section;

/* Take the name of a material, of the seabed's sediment: the latter's backscatter stays the
 * seabed's own. structure: as above. */
sonject_status read_material_name(struct reader *reader, const struct tree_node *node,
                                  void *structure);
sonject_status read_sediment_name(struct reader *reader, const struct tree_node *node,
                                  void *structure);

#endif
