/* What keys of scene files mean, for sonject help. */
#include <string.h>

#include <jansson.h>

#include <sonject/sonject.h>

#include "console.h"
#include "verbs.h"

#define PATH_BYTES 128

static const char *text_of(const json_t *key, const char *what)
{
    const char *text = json_string_value(json_object_get(key, what));
    return text ? text : "";
}

/* "objects[0].parts[].shape" as "objects.parts.shape": entries of lists are all alike. */
static void strip_entries(const char *path, char stripped[PATH_BYTES])
{
    size_t length = 0;
    for (; *path && length + 1 < PATH_BYTES; path++) {
        if (*path == '[')
            path += strcspn(path, "]");
        if (*path && *path != ']')
            stripped[length++] = *path;
    }
    stripped[length] = '\0';
}

static void print_key(const json_t *key)
{
    static const char *const facts[] = {"unit", "default", "range"};
    size_t i;
    json_t *word;
    printf("%s%s\n    %s\n", text_of(key, "path"),
           json_is_true(json_object_get(key, "is_required")) ? " (must be there)" : "",
           text_of(key, "meaning"));
    for (i = 0; i < sizeof(facts) / sizeof(facts[0]); i++)
        if (*text_of(key, facts[i]))
            printf("    %s: %s\n", facts[i], text_of(key, facts[i]));
    json_array_foreach(json_object_get(key, "words"), i, word)
        printf(i ? ", %s" : "    words: %s", json_string_value(word));
    puts(json_array_size(json_object_get(key, "words")) ? "\n" : "");
}

/* Whether one was printed. */
static bool print_keys(const json_t *keys, const char *name, struct nearest *nearest)
{
    char wanted[PATH_BYTES], path[PATH_BYTES];
    bool is_found = false;
    size_t i;
    json_t *key;
    strip_entries(name, wanted);
    const size_t length = strlen(wanted) - (wanted[0] && wanted[strlen(wanted) - 1] == '.');
    json_array_foreach(keys, i, key)
    {
        strip_entries(text_of(key, "path"), path);
        nearest_consider(nearest, text_of(key, "path"));
        if (strncmp(path, wanted, length) != 0 || (path[length] && path[length] != '.'))
            continue;
        print_key(key);
        is_found = true;
    }
    return is_found;
}

int key_help(const char *name, struct nearest *nearest)
{
    sonject_context *context = NULL;
    char *text = NULL;
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = sonject_keys(context, &text);
    int code = status == SONJECT_OK ? EXIT_CODE_DONE : fail_with(context, status);
    json_t *keys = text ? json_loads(text, 0, NULL) : NULL;
    if (keys && print_keys(keys, name, nearest)) {
        code = finish_output();
    } else if (keys) {
        message("there is no verb or key \"", name,
                nearest->best ? "\"; did you mean " : "\"; see ",
                nearest->best ? nearest->best : "sonject --help", nearest->best ? "?" : "");
        code = EXIT_CODE_USAGE;
    }
    json_decref(keys);
    sonject_text_release(&text);
    sonject_context_release(&context);
    return code;
}
