/* What the opaque handles of the public interface hold. */
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
    struct report report; /* its host is the next member */
    struct report_host host;
    struct decoder decoder;
    struct device_slot device; /* the strings of its parameters are owned */
};

struct sonject_scene {
    struct report *report; /* the context's */
    struct scene_source source;
    struct scene scene; /* what the source says, while is_read */
    bool is_read;
    struct mesh_store meshes; /* of the scene before, while the source is read again */
};

struct sonject_result {
    struct report *report;
    struct injection_result result;
    void *stored; /* the image as a file would store it; owned; NULL: it is the result's, linear */
    enum pixel_type stored_type;
};

/* Forgets the last message: every public call that can fail begins with it. Errors: ARGUMENT
 * (NULL).
 */
sonject_status context_begin_call(struct sonject_context *context);

/* Has the caller's progress function asked while the call waits for a child process, too: it and
 * its user become ones that pass on what they are told. */
void context_watch(struct sonject_context *context, sonject_progress_function *progress,
                   void **user);

/* At the end of such a call: tells that all is done, where it is. Returns status. */
sonject_status context_finish(struct sonject_context *context, sonject_status status);

/* What a scene's text says, read if something was set since. NULL is refused. Errors: as
 * sonject_scene_read. */
sonject_status scene_use(struct report *report, const sonject_scene *handle,
                         const struct scene **scene);

/* What a caller says of reading; all 0 where it says nothing. path: of the file, NULL where there
 * is a text. Errors: ARGUMENT. */
sonject_status scene_read_params_take(struct report *report, const char *path,
                                      const sonject_scene_read_params *params,
                                      sonject_scene_read_params *taken);

/* That neither the path nor one of count overrides is NULL. Errors: ARGUMENT. */
sonject_status check_overrides(struct report *report, const char *path,
                               const char *const *overrides, size_t count);

/* What is said of an image file, in the values of a scene's input.channel, transfer and geometry;
 * each may be NULL. array: borrowed. Errors: INPUT, MEMORY. */
sonject_status image_options_take(struct report *report, const char *channel, const char *array,
                                  const char *transfer, const char *geometry,
                                  struct image_options *options);

/* Copies a caller's parameter structure (which starts with its size) to `to`, the rest of which
 * becomes 0, so that programs built against older headers go on working, a longer one must be 0
 * beyond what this library knows. smallest: the size of the first released version. name: for the
 * message. Errors: ARGUMENT. */
sonject_status params_take(struct report *report, void *to, size_t to_size, const void *from,
                           size_t smallest, const char *name);

/* The same in the other direction, for structures that the library fills. */
sonject_status params_give(struct report *report, void *to, const void *from, size_t from_size,
                           size_t smallest, const char *name);

/* A caller's patch; pixels NULL: the uniform or synthetic patch that the scene makes. To be given
 * to swath_close, also on failure. Errors: ARGUMENT, INPUT, MEMORY. */
sonject_status find_input(struct report *report, const struct scene *scene,
                          const sonject_pixels *pixels, struct swath *swath);

/* A caller's pixels, linear; those of a transfer function as they are stored, too. To be given to
 * swath_close, also on failure. Errors: ARGUMENT, INPUT, MEMORY. */
sonject_status take_pixels(struct report *report, const sonject_pixels *pixels,
                           struct swath *swath);

/* A caller's pixels as they are stored, of no transfer function; for swath_close, also on failure.
 * Errors: ARGUMENT, INPUT, MEMORY. */
sonject_status take_stored(struct report *report, const sonject_pixels *pixels,
                           struct swath *swath);

/* report_failure(ARGUMENT, "... must not be NULL") */
sonject_status null_argument(struct report *report, const char *name);

/* Begins a call that makes *made, which is NULL where the call fails, also without a context. */
#define BEGIN_MAKING(context, made)                                                                \
    do {                                                                                           \
        if (made)                                                                                  \
            *(made) = NULL;                                                                        \
        CHECK(context_begin_call(context));                                                        \
        if (!(made))                                                                               \
            return null_argument(&(context)->report, #made);                                       \
    } while (0)

#endif
