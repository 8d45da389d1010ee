/* The structures behind the opaque handles of the public interface. */
#ifndef SONJECT_API_HANDLES_H
#define SONJECT_API_HANDLES_H

#include <stddef.h>

#include <sonject/context.h>
#include <sonject/result.h>
#include <sonject/scene.h>

#include "base/report.h"
#include "device/device.h"
#include "inject/injection.h"
#include "inject/swath.h"
#include "scene/scene.h"
#include "schema/scene_file.h"
#include "swath/decoder.h"

struct sonject_context {
    struct report report; /* report.host is the next member */
    struct report_host host;
    struct decoder decoder;
    struct device_slot device; /* owns the strings of its parameters */
};

struct sonject_scene {
    struct report *report; /* the context's */
    struct scene_source source;
    struct scene scene; /* read from the source, valid while is_read */
    bool is_read;
    struct mesh_store meshes; /* meshes of the scene before, while the source is read again */
};

struct sonject_result {
    struct report *report;
    struct injection_result result;
    void *stored; /* owned; the image as a file would store it; NULL: the result's, linear */
    enum pixel_type stored_type;
};

/* Forgets the last message; begins every public call that can fail. Errors: ARGUMENT (NULL). */
sonject_status context_begin_call(struct sonject_context *context);

/* Replaces *progress and *user by a function that passes progress on and keeps it. The caller's
 * function can then be asked during waits for a child process, too. */
void context_watch(struct sonject_context *context, sonject_progress_function *progress,
                   void **user);

/* Ends such a call: on success tells that all is done, unless that was told. Returns status. */
sonject_status context_finish(struct sonject_context *context, sonject_status status);

/* Gives a handle's scene, and reads its text if something was set since. NULL is refused. Errors:
 * those of sonject_scene_read. */
sonject_status scene_use(struct report *report, const sonject_scene *handle,
                         const struct scene **scene);

/* Takes a caller's parameters for reading; all 0 if params is NULL. path: the file, NULL if there
 * is a text. Errors: ARGUMENT. */
sonject_status scene_read_params_take(struct report *report, const char *path,
                                      const sonject_scene_read_params *params,
                                      sonject_scene_read_params *taken);

/* Checks that neither path nor any of count overrides is NULL. Errors: ARGUMENT. */
sonject_status check_overrides(struct report *report, const char *path,
                               const char *const *overrides, size_t count);

/* Takes a caller's options for an image file, as values of a scene's input.channel, transfer and
 * geometry; each may be NULL. array: borrowed. Errors: INPUT, MEMORY. */
sonject_status image_options_take(struct report *report, const char *channel, const char *array,
                                  const char *transfer, const char *geometry,
                                  struct image_options *options);

/* Copies a caller's parameter structure, which starts with its size, to `to`. The rest of `to`
 * becomes 0, so that programs built against older headers go on working. A longer structure must be
 * 0 beyond what this library knows. smallest: the size of the first released version. name: for the
 * message. Errors: ARGUMENT. */
sonject_status params_take(struct report *report, void *to, size_t to_size, const void *from,
                           size_t smallest, const char *name);

/* Copies from a structure that the library fills to a caller's, in the same way. */
sonject_status params_give(struct report *report, void *to, const void *from, size_t from_size,
                           size_t smallest, const char *name);

/* Takes a caller's patch; pixels NULL: the uniform or synthetic patch that the scene makes. For
 * swath_close, also on failure. Errors: ARGUMENT, INPUT, MEMORY. */
sonject_status find_input(struct report *report, const struct scene *scene,
                          const sonject_pixels *pixels, struct swath *swath);

/* Takes a caller's pixels, linear; those with a transfer function also as stored. Linear pixels may
 * stay the caller's. For swath_close, also on failure. Errors: ARGUMENT, INPUT, MEMORY. */
sonject_status take_pixels(struct report *report, const sonject_pixels *pixels,
                           struct swath *swath);

/* Takes a caller's pixels as stored, without a transfer function. For swath_close, also on failure.
 * Errors: ARGUMENT, INPUT, MEMORY. */
sonject_status take_stored(struct report *report, const sonject_pixels *pixels,
                           struct swath *swath);

/* Reports "... must not be NULL". Returns ARGUMENT. */
sonject_status null_argument(struct report *report, const char *name);

/* Begins a call that makes *made, which is NULL if the call fails, also without a context. */
#define BEGIN_MAKING(context, made)                                                                \
    do {                                                                                           \
        if (made)                                                                                  \
            *(made) = NULL;                                                                        \
        CHECK(context_begin_call(context));                                                        \
        if (!(made))                                                                               \
            return null_argument(&(context)->report, #made);                                       \
    } while (0)

#endif
