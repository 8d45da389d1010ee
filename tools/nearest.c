#include "nearest.h"

#include <string.h>

enum {
    LONGEST_WORD = 64
};

size_t edit_distance(const char *first, const char *second)
{
    size_t
        row[LONGEST_WORD + 1]; /* distances of the letters so far of first to prefixes of second */
    size_t length = strlen(second) < LONGEST_WORD ? strlen(second) : LONGEST_WORD;
    for (size_t j = 0; j <= length; j++)
        row[j] = j;
    for (size_t i = 0; i < LONGEST_WORD && first[i]; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < length; j++) {
            size_t best = diagonal + (first[i] != second[j]);
            diagonal = row[j + 1];
            if (row[j] + 1 < best)
                best = row[j] + 1;
            if (diagonal + 1 < best)
                best = diagonal + 1;
            row[j + 1] = best;
        }
    }
    return row[length];
}

void nearest_begin(struct nearest *nearest, const char *word)
{
    nearest->word = word;
    nearest->best = NULL;
    /* A third of the letters may be wrong. */
    nearest->distance = strlen(word) / 3 + 1;
}

void nearest_consider(struct nearest *nearest, const char *candidate)
{
    size_t distance = edit_distance(nearest->word, candidate);
    if (distance < nearest->distance || (!nearest->best && distance == nearest->distance)) {
        nearest->best = candidate;
        nearest->distance = distance;
    }
}
