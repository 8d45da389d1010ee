/* sonject help KEY: explains keys of scene and campaign files. */
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

/* Strips indices of lists: "objects[0].parts[].shape" becomes "objects.parts.shape". */
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
           json_is_true(json_object_get(key, "is_required")) ? " (required)" : "",
           text_of(key, "meaning"));
    for (i = 0; i < sizeof(facts) / sizeof(facts[0]); i++)
        if (*text_of(key, facts[i]))
            printf("    %s: %s\n", facts[i], text_of(key, facts[i]));
    json_array_foreach(json_object_get(key, "words"), i, word)
        printf(i ? ", %s" : "    words: %s", json_string_value(word));
    puts(json_array_size(json_object_get(key, "words")) ? "\n" : "");
}

/* Returns whether a key is the wanted one, in that section, or has that name in any section. */
static bool is_wanted(const char *path, const char *wanted)
{
    const size_t length = strlen(wanted), section = length - (wanted[length - 1] == '.');
    const size_t before = strlen(path) > length ? strlen(path) - length : 0;
    return (strncmp(path, wanted, section) == 0 && (!path[section] || path[section] == '.')) ||
           (before > 0 && path[before - 1] == '.' && strcmp(path + before, wanted) == 0);
}

/* Prints the keys of that name. Returns whether there was one. */
static bool print_keys(const json_t *keys, const char *name, struct nearest *nearest)
{
    char wanted[PATH_BYTES], path[PATH_BYTES];
    bool is_found = false;
    size_t i;
    json_t *key;
    strip_entries(name, wanted);
    if (!*wanted)
        return false;
    json_array_foreach(keys, i, key)
    {
        const char *name_in_section = strrchr(text_of(key, "path"), '.');
        strip_entries(text_of(key, "path"), path);
        nearest_consider(nearest, text_of(key, "path"));
        if (name_in_section)
            nearest_consider(nearest, name_in_section + 1);
        if (!is_wanted(path, wanted))
            continue;
        print_key(key);
        is_found = true;
    }
    return is_found;
}

static sonject_status add_keys(sonject_context *context, json_t *keys, sonject_keys_of of)
{
    char *text = NULL;
    const sonject_status status = sonject_keys(context, of, &text);
    json_t *listed = text ? json_loads(text, 0, NULL) : NULL;
    json_array_extend(keys, listed);
    json_decref(listed);
    sonject_text_release(&text);
    return status;
}

int key_help(const char *name, struct nearest *nearest)
{
    sonject_context *context = NULL;
    json_t *keys = json_array();
    sonject_status status = sonject_context_create(NULL, &context);
    if (status == SONJECT_OK)
        status = add_keys(context, keys, SONJECT_KEYS_OF_SCENES);
    if (status == SONJECT_OK)
        status = add_keys(context, keys, SONJECT_KEYS_OF_CAMPAIGNS);
    int code = status == SONJECT_OK ? EXIT_CODE_DONE : fail_with(context, status);
    if (status == SONJECT_OK && print_keys(keys, name, nearest)) {
        code = finish_output();
    } else if (status == SONJECT_OK) {
        message("there is no verb or key \"", name,
                nearest->best ? "\"; did you mean " : "\"; see ",
                nearest->best ? nearest->best : "sonject --help", nearest->best ? "?" : "");
        code = EXIT_CODE_USAGE;
    }
    json_decref(keys);
    sonject_context_release(&context);
    return code;
}
