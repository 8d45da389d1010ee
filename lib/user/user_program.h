/* Kernels for scenes: the library's own programs where no shape is a user's, else with the code of
 * all its users' shapes linked to them; and what compilers say about users' code. */
#ifndef SONJECT_USER_USER_PROGRAM_H
#define SONJECT_USER_USER_PROGRAM_H

#include "device/device.h"
#include "kernels/user_records.h"
#include "scene/scene.h"
#include "user/snippet.h"

/* Makes "name:line: what" of the first error in the log of a snippet's unit. Known are the forms
 * "error: file:line:column: what" and "file:line:column: error: what"; else the error itself is
 * told. The log's lines go to report's log. Returns INPUT. */
sonject_status explain_build_log(struct report *report, const struct user_snippet *snippet,
                                 const char *device_name, const char *log);

/* What the kernels know of a shape. */
struct user_record user_record_of(const struct user_shape *shape);

/* A kernel of a program for the scene, to be given to kernel_release. variant: bits of enum
 * program_variant. The first error of a user's
 * code becomes the message "file:line: what"; the compiler's whole log goes to the report's log.
 * Errors: INPUT (code that does not compile), DEVICE, MEMORY. */
sonject_status scene_kernel_create(struct report *report, struct device *device,
                                   const struct scene *scene, uint32_t variant,
                                   enum device_program program, const char *name,
                                   device_kernel *kernel);

/* The same with these users' code. */
sonject_status user_kernel_create(struct report *report, struct device *device,
                                  const struct user_shapes *shapes, uint32_t variant,
                                  enum device_program program, const char *name,
                                  device_kernel *kernel);

#endif
