#include "user/user_program.h"

#include <stdlib.h>
#include <string.h>

#include "base/growing_text.h"
#include "base/text.h"
#include "cl/sources.h"
#include "user/build_log.h"

#define OWN_PIECES 3 /* before the users': kernels, what takes their macros away, calls */

typedef char parameters_are_as_many[USER_PARAMETERS == SONJECT_USER_PARAMETERS_CAPACITY ? 1 : -1];
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

/* Takes the macros of our own source away, that the users' code has none but the language's. */
static char *text_without_macros(const char *source)
{
    static const char define[] = "#define ";
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, "#undef WIDTH\n#undef WITH_MESHES\n#undef WITH_USER_SHAPES\n"
                            "#undef TALLY_IS_SHARED\n");
    for (const char *line = source; *line != '\0';) {
        const size_t length = strcspn(line, "\n");
        if (strncmp(line, define, sizeof define - 1) == 0) {
            const char *name = line + sizeof define - 1;
            growing_text_add(&text, "#undef %.*s\n", (int)strcspn(name, " (\n"), name);
        }
        line += length + (line[length] == '\n');
    }
    return growing_text_end(&text);
}

/* What the kernels call, which call the snippets by their numbers. */
static char *text_of_calls(unsigned long count)
{
    struct growing_text text = {NULL, 0, 0, false};
    growing_text_add(&text, "#line 1 \"calls of user shapes\"\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text,
                         "float user_%lu_shape_distance(float3, float3, float, const float *);\n"
                         "float3 user_%lu_shape_normal(float3, const float *);\n",
                         i, i);
    growing_text_add(
        &text, "float user_distance(int n, float3 p, float3 d, float t, const float *a)\n{\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text, "    if (n == %lu) return user_%lu_shape_distance(p, d, t, a);\n",
                         i, i);
    growing_text_add(&text, "    return INFINITY;\n}\n"
                            "float3 user_normal(int n, float3 p, const float *a)\n{\n");
    for (unsigned long i = 0; i < count; i++)
        growing_text_add(&text, "    if (n == %lu) return user_%lu_shape_normal(p, a);\n", i, i);
    growing_text_add(&text, "    return (float3)(0.0f);\n}\n");
    return growing_text_end(&text);
}

static sonject_status explain(struct report *report, const struct device *device,
                              const struct program_text *text, const char *log)
{
    struct user_text users = {text->user, 0};
    for (size_t i = 0; i < OWN_PIECES; i++)
        users.lines_before += text_count_lines(text->pieces[i]);
    return explain_build_log(report, &users, device->name, log);
}

sonject_status user_kernel_create(struct report *report, struct device *device,
                                  const struct user_shapes *shapes, uint32_t variant,
                                  enum device_program number, const char *name, cl_kernel *kernel)
{
    const char *pieces[OWN_PIECES + 3 * USER_SNIPPETS_MAX];
    char options[PROGRAM_OPTIONS_CAPACITY];
    size_t count = 0;
    char *without_macros = text_without_macros(embedded_sources[number].text);
    char *calls = text_of_calls(shapes->snippet_count);
    *kernel = NULL;
    pieces[count++] = embedded_sources[number].text;
    pieces[count++] = without_macros;
    pieces[count++] = calls;
    for (uint32_t i = 0; i < shapes->snippet_count; i++) {
        pieces[count++] = shapes->snippets[i].before;
        pieces[count++] = shapes->snippets[i].code;
        pieces[count++] = shapes->snippets[i].behind;
    }
    program_options(device, variant, " -DWITH_USER_SHAPES", options);
    const struct program_text text = {
        embedded_sources[number].name, pieces, count, options, explain, shapes};
    const sonject_status status = without_macros && calls
                                      ? kernel_of_text(report, device, &text, name, kernel)
                                      : report_out_of_memory(report, "the user shapes' program");
    free(without_macros);
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
