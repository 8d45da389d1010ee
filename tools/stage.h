/* Common parts of verbs that read a scene, trace it or form its image: options, progress, stopping,
 * and the last message. */
#ifndef SONJECT_TOOLS_STAGE_H
#define SONJECT_TOOLS_STAGE_H

#include <stdbool.h>

#include <sonject/sonject.h>

#include "arguments.h"
#include "console.h"

struct stage_options {
    const char *output;
    const char *device;
    bool is_verbose;
    bool is_quiet;
};

#define OVERWRITE_HELP "allows replacing a result of other inputs"

/* Rows of a verb's arguments; the structure of its options has a struct stage_options `stage`. */
#define STAGE_ARGUMENTS(structure)                                                                 \
    {"--device",                                                                                   \
     NULL,                                                                                         \
     "NAME",                                                                                       \
     "part of a device's name, see sonject devices",                                               \
     ARGUMENT_TEXT,                                                                                \
     false,                                                                                        \
     offsetof(structure, stage.device)},                                                           \
        {"--verbose",                                                                              \
         NULL,                                                                                     \
         NULL,                                                                                     \
         "also prints the device, compiled kernels, the noise floor and more",                     \
         ARGUMENT_FLAG,                                                                            \
         false,                                                                                    \
         offsetof(structure, stage.is_verbose)},                                                   \
    {                                                                                              \
        "--quiet", NULL, NULL, "prints errors only: no progress bar, no notes", ARGUMENT_FLAG,     \
            false, offsetof(structure, stage.is_quiet)                                             \
    }

/* Does the work in a context; sets *was_finished to 1 if there was nothing to do. */
typedef sonject_status (*stage_function)(sonject_context *context, const void *verb_options,
                                         struct progress *progress, int *was_finished);

/* Calls the function and returns the exit code. done: the last message before the output's name,
 * such as "the result is in ". */
int stage_work(const struct stage_options *stage, stage_function function, const void *verb_options,
               const char *done);

/* ---- A scene file with a command's overrides. */

struct scene_arguments {
    const char *path;
    struct text_list overrides;
    struct whole_argument seed; /* the last of the overrides */
    const char *band; /* --set band= of a verb that goes through all bands; NULL: the scene's own
                         choice */
};

/* Rows of a verb's arguments; the structure of its options has a struct scene_arguments `scene`. */
#define SCENE_ARGUMENTS(structure)                                                                 \
    {"--seed",                                                                                     \
     NULL,                                                                                         \
     "N",                                                                                          \
     "seed of the random numbers: --set injection.seed=N",                                         \
     ARGUMENT_WHOLE,                                                                               \
     false,                                                                                        \
     offsetof(structure, scene.seed)},                                                             \
    {                                                                                              \
        "--set", NULL, "KEY.PATH=VALUE", "replaces or adds a key of the scene; may be repeated",   \
            ARGUMENT_TEXTS, false, offsetof(structure, scene.overrides)                            \
    }

/* Gets the bands that must be chosen from; see sonject_scene_bands. */
sonject_status scene_arguments_bands(sonject_context *context,
                                     const struct scene_arguments *arguments, char **names);

/* Returns parameters for reading a scene or campaign with these overrides. */
sonject_scene_read_params reading_of(const struct text_list *overrides);

/* Reads the scene; see sonject_scene_read. */
sonject_status scene_arguments_read(sonject_context *context,
                                    const struct scene_arguments *arguments, sonject_scene **scene);

/* Prints the scene's geometry by sonject_check. If that fails, or status is a failure to read the
 * scene, prints the context's message. Returns the exit code. */
int scene_show(sonject_context *context, sonject_status status, const sonject_scene *scene);

/* ---- --shard I/K. */

/* Parses "2/4", whole numbers I from 1 to K. NULL leaves both as they are. Returns false after a
 * message. */
bool shard_parse(const char *verb, const char *text, uint32_t *index, uint32_t *count);

/* ---- --labels: formats by name. */

#define LABELS_HELP "label files beside coco.json: yolo, voc, or both"

/* Parses names, separated by commas, into a sum of sonject_labels; text NULL: 0. Returns false
 * after a message with the verb. */
bool labels_parse(const char *verb, const char *text, uint32_t *labels);

#endif
