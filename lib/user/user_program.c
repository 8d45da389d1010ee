#include "user/user_program.h"

#include <stdlib.h>
#include <string.h>

#include "base/growing_text.h"
#include "cl/sources.h"
#include "user/build_log.h"

typedef char parameters_are_as_many[USER_PARAMETERS == SONJECT_USER_PARAMETERS_CAPACITY ? 1 : -1];
typedef char snippets_are_units[USER_SNIPPETS_MAX == PROGRAM_UNITS_MAX ? 1 : -1];
typedef char user_record_is_packed[sizeof(struct user_record) == 18 * 4 ? 1 : -1];

struct user_record user_record_of(const struct user_shape *shape)
{
    struct user_record record;
    memset(&record, 0, sizeof record);
    record.snippet = (int32_t)shape->snippet;
    record.is_open = shape->is_open;
    memcpy(record.parameters, shape->parameters, sizeof record.parameters);
    return record;
}

/* A snippet as a translation unit. All that it declares is its own: the two functions since they
 * are declared static before, the rest by clang's attribute, or where the user wrote static. */
static char *text_of_unit(const struct user_snippet *snippet, unsigned long number)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, SNIPPET_BEFORE "%s" SNIPPET_BEHIND, number, number, snippet->code);
    return growing_text_end(&text);
}

/* What the kernels call, which call the units by their numbers. */
static char *text_of_calls(unsigned long count)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, "#line 1 \"calls of user shapes\"\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text,
                         "float user_%lu_distance(float3, float3, float, const float *);\n"
                         "float3 user_%lu_normal(float3, const float *);\n",
                         i, i);
    growing_text_add(
        &text, "float user_distance(int n, float3 p, float3 d, float t, const float *a)\n{\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text, "    if (n == %lu) return user_%lu_distance(p, d, t, a);\n", i, i);
    growing_text_add(&text, "    return INFINITY;\n}\n"
                            "float3 user_normal(int n, float3 p, const float *a)\n{\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text, "    if (n == %lu) return user_%lu_normal(p, a);\n", i, i);
    growing_text_add(&text, "    return (float3)(0.0f);\n}\n");
    return growing_text_end(&text);
}

static sonject_status explain(struct report *report, const struct device *device,
                              const void *shapes, size_t unit, const char *log)
{
    const struct user_shapes *users = shapes;
    return explain_build_log(report, &users->snippets[unit], device->name, log);
}

sonject_status user_kernel_create(struct report *report, struct device *device,
                                  const struct user_shapes *shapes, uint32_t variant,
                                  enum device_program number, const char *name, cl_kernel *kernel)
{
    char *units[USER_SNIPPETS_MAX];
    char options[PROGRAM_OPTIONS_CAPACITY];
    char *calls = text_of_calls(shapes->snippet_count);
    bool is_complete = calls != NULL;
    *kernel = NULL;
    for (uint32_t i = 0; i < shapes->snippet_count; i++) {
        units[i] = text_of_unit(&shapes->snippets[i], i);
        is_complete = is_complete && units[i];
    }
    program_options(device, variant, " -DWITH_USER_SHAPES", options);
    const struct program_text text = {embedded_sources[number].name,
                                      embedded_sources[number].text,
                                      calls,
                                      options,
                                      units,
                                      shapes->snippet_count,
                                      explain,
                                      shapes};
    const sonject_status status = is_complete
                                      ? kernel_of_text(report, device, &text, name, kernel)
                                      : report_out_of_memory(report, "the user shapes' program");
    for (uint32_t i = 0; i < shapes->snippet_count; i++)
        free(units[i]);
    free(calls);
    return status;
}

sonject_status scene_kernel_create(struct report *report, struct device *device,
                                   const struct scene *scene, uint32_t variant,
                                   enum device_program program, const char *name, cl_kernel *kernel)
{
    if (scene->user_shapes.count == 0)
        return kernel_create(report, device, program, variant, name, kernel);
    return user_kernel_create(report, device, &scene->user_shapes, variant, program, name, kernel);
}
