/* Several sonars in one scene file: bands, each a name and the keys in which it differs. */
#ifndef SONJECT_SCHEMA_SCENE_BANDS_H
#define SONJECT_SCHEMA_SCENE_BANDS_H

#include "schema/scene_schema.h"

/* Puts the keys of the band that the file's key `band` names over those of the file, section by
 * section, and notes in the reader's scene which that is; messages name the places where they were
 * written. Nothing where the file has no bands.
 * Errors: INPUT (no band is chosen or it is not there, a name that is none for a folder), MEMORY.
 */
sonject_status choose_band(struct reader *reader, struct tree *tree);

/* Whether a band may have this name, which is a folder's. */
bool is_band_name(const char *text);

/* The lines of `band` and `bands`. */
sonject_status read_band(struct reader *reader, const struct tree_node *node, void *structure);

/* The names of a tree's bands that are still to be chosen from, in the order of the file, one a
 * line; for free(). Errors: INPUT, MEMORY. */
sonject_status list_bands(struct reader *reader, char **names);

#endif
