/* Whether scenes have a key. */
#ifndef SONJECT_SCHEMA_SCENE_KEY_H
#define SONJECT_SCHEMA_SCENE_KEY_H

#include "schema/scene_schema.h"

/* Finds a key path such as "sonar.frequency" or "seabed.relief[0].height" below a section. False
 * where the section has none, and *near is the word most like the part that is unknown, NULL if
 * none is; *section is the one that lacks it. */
bool scene_key_find(const struct section *top, const char *path, const char **near,
                    const struct section **section);

#endif
