/* What the verbs have in common that trace a scene or form its image: options, progress, stopping,
 * and the last word. */
#ifndef SONJECT_TOOLS_STAGE_H
#define SONJECT_TOOLS_STAGE_H

#include <stdbool.h>

#include <sonject/sonject.h>

#include "arguments.h"
#include "progress.h"

struct stage_options {
    const char *output;
    const char *device;
    bool is_verbose;
    bool is_quiet;
};

#define OVERWRITE_HELP "replaces a result of other inputs, which else is refused"

/* Lines of a verb's arguments, whose options are a structure with a struct stage_options `stage`.
 */
#define STAGE_ARGUMENTS(structure)                                                                 \
    {"--device",                                                                                   \
     NULL,                                                                                         \
     "NAME",                                                                                       \
     "part of an OpenCL device's name, see sonject devices",                                       \
     ARGUMENT_TEXT,                                                                                \
     false,                                                                                        \
     offsetof(structure, stage.device)},                                                           \
        {"--verbose",                                                                              \
         NULL,                                                                                     \
         NULL,                                                                                     \
         "also tells the device, what was built for it, the noise floor, ...",                     \
         ARGUMENT_FLAG,                                                                            \
         false,                                                                                    \
         offsetof(structure, stage.is_verbose)},                                                   \
    {                                                                                              \
        "--quiet", NULL, NULL, "no progress bar, no news; only what is wrong", ARGUMENT_FLAG,      \
            false, offsetof(structure, stage.is_quiet)                                             \
    }

/* Does the work in a context; *was_finished stays 0 unless there was nothing to do. */
typedef sonject_status (*stage_function)(sonject_context *context, const void *verb_options,
                                         struct progress *progress, int *was_finished);

/* Calls it and answers the exit code. done: "the result is in ", before the output's name. */
int stage_work(const struct stage_options *stage, stage_function function, const void *verb_options,
               const char *done);

#endif
