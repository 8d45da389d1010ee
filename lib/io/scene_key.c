#include "io/scene_key.h"

#include <string.h>

#define KEYS_COMPARED 32

static const struct field *field_of(const struct section *section, const char *key, size_t length)
{
    for (size_t i = 0; i < section->count; i++)
        if (strlen(section->fields[i].key) == length &&
            memcmp(section->fields[i].key, key, length) == 0)
            return &section->fields[i];
    return NULL;
}

static const char *nearest_key(const struct section *section, const char *key, size_t length)
{
    const char *keys[KEYS_COMPARED];
    char typed[32] = "";
    size_t count = 0;
    if (length >= sizeof typed)
        return NULL;
    memcpy(typed, key, length);
    for (size_t i = 0; i < section->count && count < KEYS_COMPARED; i++)
        keys[count++] = section->fields[i].key;
    return nearest_word(typed, keys, count);
}

bool scene_key_find(const struct section *top, const char *path, const char **near,
                    const struct section **section)
{
    *section = top;
    *near = NULL;
    for (;;) {
        const size_t length = strcspn(path, ".[");
        const struct field *field = field_of(*section, path, length);
        if (!field) {
            *near = nearest_key(*section, path, length);
            return false;
        }
        path += length;
        while (*path == '[')
            path += strcspn(path, "]") + (path[strcspn(path, "]")] == ']');
        if (!*path)
            return true;
        if (*path++ != '.')
            return false;
        if (!field->section)
            return field->kind == FIELD_SPECIAL && *path;
        *section = field->section;
    }
}
