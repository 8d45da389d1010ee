/* YAML as a tree of sections, lists and texts that know their places in the file. It reads files
 * that people write as strictly as if an enemy had written them: no aliases, no tags, no repeated
 * keys, limits on everything. */
#ifndef SONJECT_SCHEMA_YAML_TREE_H
#define SONJECT_SCHEMA_YAML_TREE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/memory.h"
#include "base/report.h"

#define TREE_BYTES_MAX (1024 * 1024)
#define TREE_DEPTH_MAX 32
#define TREE_NODES_MAX 100000
#define TREE_KEYS_MAX  256 /* in one section */

#define TREE_PLACE_TEXT 320 /* bytes of a place in words */

enum tree_kind {
    TREE_TEXT,
    TREE_LIST,
    TREE_SECTION
};

/* The place of a text: line and column from 1, in the file or in an override's value. */
struct tree_place {
    const char *override; /* key path of the override, owned by the tree; NULL: the file */
    size_t line, column;
};

struct tree_node {
    enum tree_kind kind;
    bool is_quoted; /* a text in quotes or in a block */
    struct tree_place place;
    char *text;                 /* text of a TREE_TEXT; NULL: no value at all */
    struct tree_entry *entries; /* entries of a TREE_LIST or TREE_SECTION */
    size_t count;
};

struct tree_entry {
    char *key;               /* NULL in a list */
    struct tree_place place; /* place of the key */
    struct tree_node value;
};

struct mistakes;

struct tree {
    struct report *report;
    struct mistakes *mistakes;  /* the caller's collection; NULL: the report gets mistakes */
    const char *file;           /* name for messages, the caller's */
    struct tree_place named_at; /* place of the key that names this file; all 0: no key does */
    struct tree_node root;
    size_t node_count;
    char **override_paths;
    size_t override_count;
    size_t given_overrides; /* number that come with the text; the others come from calls */
};

/* The path of a key, such as "objects[0].heading", built on the way down. */
struct key_path {
    char text[256];
    size_t length;
};

/* Makes an empty tree without a collection of mistakes. report and file must outlive the tree. */
void tree_init(struct tree *tree, struct report *report, const char *file);
void tree_clear(struct tree *tree);

/* Builds the tree from the text of a file. Errors: INPUT, MEMORY. */
sonject_status tree_parse(struct tree *tree, const char *text, size_t bytes);

/* Replaces or adds the value of an override "key.path=value". A value that starts with one of {["'
 * is YAML; any other is taken as it stands. *node is the node of the value; node: may be NULL.
 * Errors: INPUT, MEMORY. */
sonject_status tree_override(struct tree *tree, const char *override,
                             const struct tree_node **node);

/* Parses text into an empty node at the override's path. For tree_override. */
sonject_status tree_parse_value(struct tree *tree, const char *override, const char *text,
                                int depth, struct tree_node *node);

/* Adds an entry without a value to a section (key is copied) or to a list (key NULL).
 * Errors: INPUT (too many), MEMORY. */
sonject_status tree_append(struct tree *tree, struct tree_node *node, const struct key_path *path,
                           const char *key, struct tree_place place, struct tree_entry **entry);

/* Returns the entry of a section's key; NULL if there is none, or if node is not a section. */
struct tree_entry *tree_find(const struct tree_node *node, const char *key);

/* Returns the value of a section's key; NULL if there is none, or if node is NULL or no section. */
struct tree_node *tree_value(const struct tree_node *node, const char *key);

/* Returns true for no value: nothing at all, ~ or null. */
bool tree_is_null(const struct tree_node *node);

void tree_node_clear(struct tree_node *node);

/* Writes "file:line:column", "--set path", or "set path" where a call has set the value. */
void tree_place_text(const struct tree *tree, struct tree_place place, char text[TREE_PLACE_TEXT]);

/* Reports "file:line:column: path: ..." or "--set path: ..." to the tree's mistakes or, where they
 * are not collected, to the tree's report. Returns INPUT. */
sonject_status tree_failure(const struct tree *tree, struct tree_place place, const char *path,
                            const char *format, ...) REPORT_FORMAT(4);

/* Extend a path. Each returns the length to go back to with key_path_shorten. */
size_t key_path_add(struct key_path *path, const char *key);
size_t key_path_add_index(struct key_path *path, size_t index);
void key_path_shorten(struct key_path *path, size_t length);

/* Adds the node in YAML's flow style, on one line. Reading that line gives the same tree. */
void tree_write_flow(const struct tree_node *node, struct growing_text *text);

/* Adds a text as a value in that style, in quotes where it would be read as another kind of value.
 */
void tree_write_text(const char *text, struct growing_text *out);

/* Writes the node as the value of an override. *text is for free(). Errors: MEMORY. */
sonject_status tree_override_text(struct report *report, const struct tree_node *node, char **text);

/* ---- The mistakes of a file that is read to its end, in the order of their places. */

#define MISTAKES_TOLD 50 /* most lines of a message; further mistakes are only counted */

struct mistake;

/* A collection of mistakes; all zero: none. mistakes_tell frees the memory that it owns. */
struct mistakes {
    struct mistake *list;
    size_t count;
    size_t uncounted; /* mistakes that there was no room for */
    size_t relations; /* reported mistakes about values of which each would do by itself */
};

/* Keeps a mistake about the key at path. Only the first one about a key is reported, because later
 * ones follow from it. line: the whole message; NULL only marks the key as wrong, where another
 * message gives the reason. */
void mistakes_add(struct mistakes *mistakes, const struct tree *tree,
                  const struct tree_place *place, const char *path, const char *line);

/* Returns whether the key at path, one below it, or a section around it is wrong. */
bool mistakes_concern(const struct mistakes *mistakes, const struct tree *tree, const char *path);

/* Returns whether there are mistakes, and all are about values that do not fit each other. */
bool mistakes_are_relations(const struct mistakes *mistakes);

/* Ends a reading of this status. Mistakes become the report's message, one per line, and the status
 * becomes INPUT unless a failure other than INPUT ended the reading. */
sonject_status mistakes_tell(struct mistakes *mistakes, struct report *report,
                             sonject_status status);

#endif
