/* Code of a shape that a user wrote in OpenCL C, a translation unit of its own: what it must be
 * before a compiler sees it, the kernels that it is linked to, and what compilers say about it. */
#ifndef SONJECT_USER_SNIPPET_H
#define SONJECT_USER_SNIPPET_H

#include <stddef.h>
#include <stdint.h>

#include "base/report.h"
#include "device/device.h"
#include "kernels/layout.h"

struct scene;
struct user_shape;
struct user_shapes;

#define SNIPPET_BYTES_MAX ((size_t)64 * 1024)
#define SNIPPET_NAME_MAX  255 /* bytes */

struct user_snippet {
    char *name;          /* of its file, for messages */
    char *code;          /* as the user wrote it */
    uint32_t first_line; /* number of the code's first line in that file */
};

/* Pragmas that hold for a snippet. clang keeps its names out of the linker's sight; NVIDIA's knows
 * this of all variables alone, and leaves local ones as they are. */
#define SNIPPET_OWN_NAMES                                                                          \
    "#pragma clang attribute push(__attribute__((internal_linkage)), apply_to = function)\n"       \
    "#ifdef __NV_CL_C_VERSION\n"                                                                   \
    "#pragma clang attribute push(__attribute__((internal_linkage)), apply_to = variable)\n"       \
    "#else\n"                                                                                      \
    "#pragma clang attribute push(__attribute__((internal_linkage)), "                             \
    "apply_to = variable(is_global))\n"                                                            \
    "#endif\n"
#define SNIPPET_NAMES_END "#pragma clang attribute pop\n#pragma clang attribute pop\n"

/* What stands before and behind a snippet: the functions that it must hold, which are missed at its
 * first line; with its number, twice, as %lu, those that a kernel calls, which are written before
 * any macro of the snippet's. */
#define SNIPPET_BEFORE                                                                             \
    "#pragma OPENCL FP_CONTRACT OFF\n"                                                             \
    "#ifdef __clang__\n"                                                                           \
    "#pragma clang diagnostic ignored \"-Wpragma-clang-attribute\"\n"                              \
    "#pragma clang diagnostic error \"-Wundefined-internal\"\n" SNIPPET_OWN_NAMES "#endif\n"
#define SNIPPET_FUNCTIONS                                                                          \
    "static float shape_distance(float3, float3, float, const float *); "                          \
    "static float3 shape_normal(float3, const float *);\n"                                         \
    "#ifdef __clang__\n" SNIPPET_NAMES_END "#endif\n"                                              \
    "float user_%lu_distance(float3 p, float3 d, float t, const float *a)\n"                       \
    "{ return shape_distance(p, d, t, a); }\n"                                                     \
    "float3 user_%lu_normal(float3 p, const float *a) { return shape_normal(p, a); }\n"            \
    "#ifdef __clang__\n" SNIPPET_OWN_NAMES "#endif\n"
#define SNIPPET_BEHIND "\n\n#ifdef __clang__\n" SNIPPET_NAMES_END "#endif\n"

/* Copies name and code. Refuses an #include at a line's beginning, and code without a word
 * shape_distance or shape_normal; what else is wrong the compiler says. On failure nothing is held.
 * Errors: INPUT ("name:line: what"), MEMORY. */
sonject_status snippet_make(struct report *report, const char *name, uint32_t first_line,
                            const char *code, struct user_snippet *snippet);
void snippet_clear(struct user_snippet *snippet);

/* What the kernels know of a shape. */
struct user_record user_record_of(const struct user_shape *shape);

/* A kernel of a program for the scene, to be given to kernel_release: the library's own programs
 * where no shape is a user's, else with the code of all its users' shapes linked to them. The first
 * error of a user's code becomes the message "file:line: what"; the compiler's whole log goes to
 * the report's log. Errors: INPUT (code that does not compile), DEVICE, MEMORY. */
sonject_status scene_kernel_create(struct report *report, struct device *device,
                                   const struct scene *scene, enum program_variant variant,
                                   enum device_program program, const char *name,
                                   device_kernel *kernel);

/* The same with these users' code. */
sonject_status user_kernel_create(struct report *report, struct device *device,
                                  const struct user_shapes *shapes, enum program_variant variant,
                                  enum device_program program, const char *name,
                                  device_kernel *kernel);

#endif
