#include "scene/written.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/scene.h"

sonject_status written_keys_add(struct written_keys *written, struct report *report,
                                const char *path, const char *place)
{
    const size_t path_bytes = strlen(path) + 1;
    const size_t place_bytes = strlen(place) + 1;
    if ((written->count & (written->count - 1)) == 0) { /* full: room is a power of two */
        const size_t room = written->count ? 2 * written->count : 1;
        struct written_key *keys = realloc(written->keys, room * sizeof *keys);
        CHECK_MEMORY(report, keys, "a scene's keys");
        written->keys = keys;
    }
    struct written_key *key = &written->keys[written->count];
    key->path = malloc(path_bytes + place_bytes);
    CHECK_MEMORY(report, key->path, "a scene's keys");
    memcpy(key->path, path, path_bytes);
    key->place = memcpy(key->path + path_bytes, place, place_bytes);
    written->count++;
    return SONJECT_OK;
}

void written_keys_clear(struct written_keys *written)
{
    for (size_t i = 0; i < written->count; i++)
        free(written->keys[i].path);
    free(written->keys);
    memset(written, 0, sizeof *written);
}

/* Shortens path to the section that it lies in; to "" at last. */
static void go_out(char *path)
{
    char *dot = strrchr(path, '.');
    *(dot ? dot : path) = '\0';
}

sonject_status scene_locate(const struct scene *scene, struct report *report, sonject_status status,
                            const char *path, ...)
{
    char name[128], message[REPORT_LINE];
    va_list arguments;
    va_start(arguments, path);
    vsnprintf(name, sizeof name, path, arguments);
    va_end(arguments);
    if (status != SONJECT_ERROR_INPUT)
        return status;
    snprintf(message, sizeof message, "%.*s", REPORT_LINE - 1, report->message);
    for (; *name; go_out(name))
        for (size_t i = 0; i < scene->written.count; i++) {
            const struct written_key *key = &scene->written.keys[i];
            const size_t set = strlen("--set ");
            const bool is_told =
                strncmp(key->place, "--set ", set) == 0 && strcmp(key->place + set, name) == 0;
            if (strcmp(key->path, name) == 0)
                return report_failure(report, status, "%s%s%s: %s", key->place, is_told ? "" : ": ",
                                      is_told ? "" : name, message);
        }
    return status;
}
