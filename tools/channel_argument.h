/* The channel of an XTF file on the command line. */
#ifndef SONJECT_TOOLS_CHANNEL_ARGUMENT_H
#define SONJECT_TOOLS_CHANNEL_ARGUMENT_H

#include <stdbool.h>
#include <stdint.h>

/* Reads port, starboard or a number; prints a message where it is none of them. */
bool channel_parse(const char *verb, const char *text, int32_t *channel);

#endif
