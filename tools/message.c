#include "message.h"

#include <stdio.h>

void message_line(const char *const *texts)
{
    fputs("sonject: ", stderr);
    for (; *texts; texts++) {
        /* File names may hold newlines and the codes that steer terminals. */
        for (const char *c = *texts; *c; c++)
            fputc((unsigned char)*c < ' ' || *c == 127 ? ' ' : *c, stderr);
    }
    fputc('\n', stderr);
}
