#include "exit_code.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "message.h"

int exit_code_of(sonject_status status)
{
    switch (status) {
    case SONJECT_OK:
        return EXIT_CODE_DONE;
    case SONJECT_ERROR_ARGUMENT:
        return EXIT_CODE_USAGE;
    case SONJECT_ERROR_INPUT:
    case SONJECT_ERROR_UNSUPPORTED:
        return EXIT_CODE_INPUT;
    case SONJECT_ERROR_DEVICE:
        return EXIT_CODE_DEVICE;
    case SONJECT_ERROR_STORAGE:
    case SONJECT_ERROR_MEMORY:
        return EXIT_CODE_STORAGE;
    case SONJECT_CANCELLED:
        return EXIT_CODE_STOPPED;
    }
    return EXIT_CODE_STORAGE;
}

int fail_with(const sonject_context *context, sonject_status status)
{
    const char *text = context ? sonject_context_message(context) : "";
    if (!text[0])
        message(sonject_status_name(status));
    while (*text) { /* a line for each mistake of a scene */
        char line[2048];
        const size_t length = strcspn(text, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, text);
        message(line);
        text += length + (text[length] == '\n');
    }
    return exit_code_of(status);
}

int finish_output(void)
{
    int had_failed = ferror(stdout);
    errno = 0;
    if (fflush(stdout) == 0 && !had_failed)
        return EXIT_CODE_DONE;
    message("cannot write to the standard output: ", errno ? strerror(errno) : "write error");
    return EXIT_CODE_STORAGE;
}
