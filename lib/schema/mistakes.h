/* The mistakes of a file that is read to its end, in the order of their places. */
#ifndef SONJECT_SCHEMA_MISTAKES_H
#define SONJECT_SCHEMA_MISTAKES_H

#include <stdbool.h>
#include <stddef.h>

#include "base/report.h"

#define MISTAKES_TOLD 50 /* lines of a message at most; the rest is counted */

struct tree;
struct tree_place;
struct mistake;

/* All zero: none. mistakes_tell frees what it owns. */
struct mistakes {
    struct mistake *list;
    size_t count, capacity;
    size_t uncounted; /* that there was no room for */
};

/* Keeps a mistake about the key at path. The first about a key is the one that is told: what comes
 * after it follows from it. line: the whole message; NULL only marks the key as wrong, where
 * another message has told why. */
void mistakes_add(struct mistakes *mistakes, const struct tree *tree,
                  const struct tree_place *place, const char *path, const char *line);

/* Whether the key at path, one below it, or a section that it is in is wrong. */
bool mistakes_concern(const struct mistakes *mistakes, const struct tree *tree, const char *path);

/* Ends the reading that had this status. Where there are mistakes they become the report's message,
 * one a line, and the status INPUT unless a failure other than INPUT ended the reading. */
sonject_status mistakes_tell(struct mistakes *mistakes, struct report *report,
                             sonject_status status);

#endif
