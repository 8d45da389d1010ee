#include "message.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

void message_line(const char *const *texts)
{
    fputs("sonject: ", stderr);
    for (; *texts; texts++) {
        char *shown = malloc(strlen(*texts) + 1);
        if (!shown)
            continue;
        text_make_printable(strcpy(shown, *texts));
        fputs(shown, stderr);
        free(shown);
    }
    fputc('\n', stderr);
}
