#include "label/class_names.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/growing_text.h"
#include "base/memory.h"

static bool make_room(struct class_names *classes)
{
    if (classes->count < classes->capacity)
        return true;
    const uint32_t capacity = 2 * classes->capacity + 8;
    char **names = realloc(classes->names, capacity * sizeof *names);
    if (!names)
        return false;
    classes->names = names;
    classes->capacity = capacity;
    return true;
}

sonject_status class_names_take(struct class_names *classes, struct report *report,
                                const char *name, uint32_t *number)
{
    for (*number = 0; *number < classes->count; ++*number)
        if (strcmp(classes->names[*number], name) == 0)
            return SONJECT_OK;
    char *copy = make_room(classes) ? copy_text(name) : NULL;
    CHECK_MEMORY(report, copy, "the classes");
    classes->names[classes->count++] = copy;
    return SONJECT_OK;
}

sonject_status class_names_write(const struct class_names *classes, struct report *report,
                                 const char *path)
{
    struct growing_text lines = {NULL, 0, 0, false};
    for (uint32_t i = 0; i < classes->count; i++)
        growing_text_add(&lines, "%s\n", classes->names[i]);
    char *text = growing_text_end(&lines);
    CHECK_MEMORY(report, text, path);
    const sonject_status status = file_write_whole(report, path, text, strlen(text));
    free(text);
    return status;
}

void class_names_clear(struct class_names *classes)
{
    for (uint32_t i = 0; i < classes->count; i++)
        free(classes->names[i]);
    free(classes->names);
    memset(classes, 0, sizeof *classes);
}
