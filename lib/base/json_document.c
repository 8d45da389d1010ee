#include "base/json_document.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/growing_text.h"
#include "base/memory.h"
#include "base/text.h"

#define DOCUMENT_BYTES_MAX ((size_t)64 << 20)

json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_count(uint64_t value)
{
    return json_integer((json_int_t)value);
}

json_t *json_seed(uint64_t seed)
{
    char text[24];
    if (seed <= (uint64_t)INT64_MAX)
        return json_count(seed);
    snprintf(text, sizeof text, "%llu", (unsigned long long)seed);
    return json_string(text);
}

json_t *json_text(const char *text)
{
    if (text_is_printable(text))
        return json_string(text);
    char *copy = copy_text(text);
    if (!copy)
        return NULL;
    for (char *c = copy; *c; c++)
        if ((unsigned char)*c < 0x20 || (unsigned char)*c > 0x7e)
            *c = '?';
    json_t *value = json_string(copy);
    free(copy);
    return value;
}

static void give_up(json_t **document)
{
    json_decref(*document);
    *document = NULL;
}

void json_add(json_t **object, const char *key, json_t *value)
{
    if (json_object_set_new(*object, key, value) != 0)
        give_up(object);
}

void json_append(json_t **array, json_t *value)
{
    if (json_array_append_new(*array, value) != 0)
        give_up(array);
}

json_t *json_object_of(const struct json_member *members)
{
    json_t *object = json_object();
    for (; members->key; members++)
        json_add(&object, members->key, members->value);
    return object;
}

json_t *json_counts(const uint64_t *values, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_append(&array, json_count(values[i]));
    return array;
}

static int add_piece(const char *piece, size_t length, void *text)
{
    struct growing_text *whole = text;
    growing_text_add(whole, "%.*s", (int)length, piece);
    return whole->failed ? -1 : 0;
}

static void add_document(struct growing_text *text, const json_t *document, size_t flags)
{
    if (json_dump_callback(document, add_piece, text, flags) != 0)
        text->failed = true;
}

char *json_document_text(const json_t *document, size_t flags)
{
    struct growing_text text = {NULL, 0, 0, false};
    add_document(&text, document, flags);
    return growing_text_end(&text);
}

sonject_status json_document_write(struct report *report, json_t *document, size_t digits,
                                   const char *path)
{
    struct growing_text text = {NULL, 0, 0, false};
    add_document(&text, document, JSON_INDENT(2) | JSON_REAL_PRECISION(digits));
    json_decref(document);
    return growing_text_write(report, &text, path);
}

/* Where memory is out jansson may find fault with the text: it is asked twice, and memory is. */
static json_t *load_json(const char *text, size_t bytes, bool *lacks_memory)
{
    json_t *document = json_loadb(text, bytes, 0, NULL);
    *lacks_memory = false;
    if (document)
        return document;
    document = json_loadb(text, bytes, 0, NULL);
    void *room = document ? NULL : allocate_array(bytes + 1, 2);
    *lacks_memory = !document && !room;
    free(room);
    return document;
}

sonject_status json_document_read(struct report *report, const char *path, json_t **document)
{
    char *text;
    size_t bytes;
    bool lacks_memory;
    *document = NULL;
    CHECK(file_read_whole(report, path, DOCUMENT_BYTES_MAX, &text, &bytes));
    *document = load_json(text, bytes, &lacks_memory);
    free(text);
    if (lacks_memory)
        return report_out_of_memory(report, path);
    if (!json_is_object(*document)) {
        json_decref(*document);
        *document = NULL;
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: damaged: no JSON object; remove it and run that again", path);
    }
    return SONJECT_OK;
}
