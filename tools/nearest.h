/* What a mistyped word was perhaps meant to be. */
#ifndef SONJECT_TOOLS_NEAREST_H
#define SONJECT_TOOLS_NEAREST_H

#include <stddef.h>

/* Number of single-letter changes from one word to the other; words are compared up to 64 letters.
 */
size_t edit_distance(const char *first, const char *second);

struct nearest {
    const char *word;
    const char *best; /* NULL: nothing is near */
    size_t distance;
};

void nearest_begin(struct nearest *nearest, const char *word);
void nearest_consider(struct nearest *nearest, const char *candidate);

#endif
