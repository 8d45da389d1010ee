/* Files of sonject init: a first scene, and a first campaign. */
#ifndef SONJECT_TOOLS_INIT_FILES_H
#define SONJECT_TOOLS_INIT_FILES_H

#include "interview.h"

/* Writes a file whole or not at all, like the next two functions. Returns false after a message. */
bool write_calibration(const char *path, const char *text);
bool write_scene(const struct interview *interview);

/* Writes a campaign for the written scene. checked: the text of sonject_check about this scene; its
 * shadows set the sizes of chips. */
bool write_campaign(const struct interview *interview, const char *checked);

/* Returns the last part of a path, without its folder. */
const char *last_part(const char *path);

#endif
