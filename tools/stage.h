/* What the verbs have in common that read a scene, trace it or form its image: options, progress,
 * stopping, and the last word. */
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

#define OVERWRITE_HELP "replaces a result of other inputs, which else is refused"

/* Lines of a verb's arguments, whose options are a structure with a struct stage_options `stage`.
 */
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

/* ---- A scene file with a command's overrides. */

struct scene_arguments {
    const char *path;
    struct text_list overrides;
    struct whole_argument seed; /* an override too, the last */
    const char *band; /* --set band=, of a verb that goes through all; NULL: as the scene says */
};

/* Lines of a verb's arguments, whose options are a structure with a struct scene_arguments `scene`.
 */
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

/* The bands that the scene leaves to be chosen; see sonject_scene_bands. */
sonject_status scene_arguments_bands(sonject_context *context,
                                     const struct scene_arguments *arguments, char **names);

/* Of a scene or campaign with these overrides. */
sonject_scene_read_params reading_of(const struct text_list *overrides);

/* As sonject_scene_read. */
sonject_status scene_arguments_read(sonject_context *context,
                                    const struct scene_arguments *arguments, sonject_scene **scene);

/* Prints the scene's geometry as sonject_check tells it, or what is wrong: then, or where status
 * says that the scene could not be read, the context's message. Gives the exit code. */
int scene_show(sonject_context *context, sonject_status status, const sonject_scene *scene);

/* ---- --shard I/K. */

/* "2/4": whole numbers, I from 1 to K; NULL leaves both as they are. A message where it is none of
 * that. */
bool shard_parse(const char *verb, const char *text, uint32_t *index, uint32_t *count);

/* ---- --labels: formats by name. */

#define LABELS_HELP "label files beside coco.json: yolo, voc, or both"

/* Reads names with commas between them into a sum of sonject_labels; text NULL: 0. On failure
 * prints a message. verb: for that. */
bool labels_parse(const char *verb, const char *text, uint32_t *labels);

#endif
