/* What sonject init writes: a scene and a campaign to begin with. */
#ifndef SONJECT_TOOLS_INIT_FILES_H
#define SONJECT_TOOLS_INIT_FILES_H

#include "interview.h"

/* Writes each file whole or not at all. False after a message. */
bool write_calibration(const char *path, const char *text);
bool write_scene(const struct interview *interview);

/* The scene must be written, and its text be what sonject_check tells of it: the sizes of chips
 * follow from its shadows. */
bool write_campaign(const struct interview *interview, const char *checked);

/* Of a path: what follows its folder. */
const char *last_part(const char *path);

#endif
