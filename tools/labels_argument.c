#include "labels_argument.h"

#include <string.h>

#include <sonject/sonject.h>

#include "message.h"

static const struct {
    const char *name;
    uint32_t format;
} formats[] = {{"yolo", SONJECT_LABELS_YOLO}, {"voc", SONJECT_LABELS_VOC}};

static uint32_t format_named(const char *name, size_t length)
{
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (strlen(formats[i].name) == length && strncmp(formats[i].name, name, length) == 0)
            return formats[i].format;
    return 0;
}

bool labels_parse(const char *verb, const char *text, uint32_t *labels)
{
    *labels = 0;
    for (const char *name = text; name;) {
        const size_t length = strcspn(name, ",");
        const uint32_t format = format_named(name, length);
        if (format == 0) {
            message(verb, ": --labels takes yolo, voc, or yolo,voc, not \"", text, "\"");
            return false;
        }
        *labels |= format;
        name = name[length] == ',' ? name + length + 1 : NULL;
    }
    return true;
}
