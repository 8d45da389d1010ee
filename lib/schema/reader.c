/* The reader of sections: walks a section's table and fills its structure from the tree. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "schema/keys.h"

const char *read_text(struct reader *reader, const struct tree_node *node)
{
    if (tree_is_null(node)) {
        refuse_value(reader, node, "has no value; write one or remove the key");
        return NULL;
    }
    if (node->kind != TREE_TEXT) {
        refuse_value(reader, node, "must be a single value, not a %s",
                     node->kind == TREE_LIST ? "list" : "section");
        return NULL;
    }
    return node->text;
}

bool is_word(const struct tree_node *node, const char *word)
{
    return node->kind == TREE_TEXT && node->text && strcmp(node->text, word) == 0;
}

sonject_status read_quantity(struct reader *reader, const struct tree_node *node,
                             enum quantity quantity, double *value)
{
    char problem[200];
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (!quantity_from_text(quantity, text, value, problem, sizeof problem))
        return refuse_value(reader, node, "%s", problem);
    return SONJECT_OK;
}

static sonject_status read_unit(struct reader *reader, const struct tree_node *node, double *unit_m)
{
    char problem[200];
    char one[40] = "1 ";
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    const bool is_unit = (*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z');
    if (is_unit && strlen(text) < sizeof one - 2)
        text = strcat(one, text);
    if (!quantity_from_text(QUANTITY_LENGTH, text, unit_m, problem, sizeof problem))
        return refuse_value(reader, node, "%s", problem);
    if (!(*unit_m >= 1e-9 && *unit_m <= 1e9))
        return refuse_value(reader, node, "must be a length of 1e-9 to 1e9 m, not %g m", *unit_m);
    return SONJECT_OK;
}

/* Reads a count. Counts that the type holds but are out of bounds are refused later. */
static sonject_status read_count(struct reader *reader, const struct field *field,
                                 const struct tree_node *node, uint64_t *count)
{
    char excerpt[40];
    const uint64_t limit = field->kind == FIELD_COUNT32 ? UINT32_MAX : UINT64_MAX;
    const uint64_t most = field->most > 0.0 ? (uint64_t)field->most : limit;
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (text_to_count(text, count) && *count <= limit)
        return SONJECT_OK;
    return refuse_value(reader, node, "'%s' is not a whole number from %llu to %llu",
                        text_excerpt(excerpt, sizeof excerpt, text),
                        (unsigned long long)field->least, (unsigned long long)most);
}

static sonject_status read_bool(struct reader *reader, const struct tree_node *node, bool *value)
{
    char excerpt[40];
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    *value = strcmp(text, "true") == 0;
    if (!*value && strcmp(text, "false") != 0)
        return refuse_value(reader, node, "'%s' is neither true nor false",
                            text_excerpt(excerpt, sizeof excerpt, text));
    return SONJECT_OK;
}

static sonject_status read_word(struct reader *reader, const struct field *field,
                                const struct tree_node *node, uint32_t *value)
{
    const char *words[FIELD_WORDS_MAX];
    struct word_list list = {{0}, 0};
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    for (uint32_t i = 0; i < FIELD_WORDS_MAX && field->words[i]; i++) {
        if (*field->words[i] == 0)
            continue;
        if (strcmp(field->words[i], text) == 0) {
            *value = i;
            return SONJECT_OK;
        }
        words[list.count] = field->words[i];
        list_word(&list, field->words[i]);
    }
    const char *near = nearest_word(text, words, list.count);
    for (size_t i = 0; field->section && i < field->section->count; i++) {
        char key[32];
        snprintf(key, sizeof key, "{%s: ...}", field->section->fields[i].key);
        list_word(&list, key);
    }
    return refuse_word(reader, node, text, &list, near);
}

/* Reads a number, or a word for one. */
static sonject_status read_number(struct reader *reader, const struct field *field,
                                  const struct tree_node *node, double *value)
{
    for (size_t i = 0; field->words[i]; i++)
        if (is_word(node, field->words[i])) {
            *value = field->word_values[i];
            return SONJECT_OK;
        }
    return read_quantity(reader, node, field->quantity, value);
}

static sonject_status read_label(struct reader *reader, const struct tree_node *node, char *label)
{
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (strlen(text) >= SONJECT_NAME_CAPACITY)
        return refuse_value(reader, node, "longer than %d bytes; shorten it",
                            SONJECT_NAME_CAPACITY - 1);
    memset(label, 0, SONJECT_NAME_CAPACITY);
    memcpy(label, text, strlen(text));
    return SONJECT_OK;
}

/* Returns the folder for file names of an override; "": the user's working folder. */
static const char *folder_of_override(const struct reader *reader, const char *override)
{
    const struct tree *tree = reader->tree;
    for (size_t i = 0; i < reader->moved_overrides && i < tree->override_count; i++)
        if (reader->moved_folder && tree->override_paths[i] == override)
            return reader->moved_folder;
    return "";
}

sonject_status read_path(struct reader *reader, const struct tree_node *node, char **path)
{
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (*text == 0 || !text_is_printable(text))
        return refuse_value(reader, node, "must be a file name without control characters");
    char *folder = node->place.override
                       ? copy_text(folder_of_override(reader, node->place.override))
                       : path_folder(reader->tree->file);
    *path = folder ? path_join(folder, text) : NULL;
    free(folder);
    return *path ? SONJECT_OK : report_out_of_memory(reader->report, "a file name");
}

const struct number_array *find_array(const struct reader *reader, const char *path)
{
    for (size_t i = 0; i < reader->array_count; i++)
        if (strcmp(reader->arrays[i].name, path) == 0)
            return &reader->arrays[i];
    return NULL;
}

sonject_status read_existing_path(struct reader *reader, const struct tree_node *node, char **path)
{
    char excerpt[400];
    if (node->kind == TREE_TEXT && node->text && find_array(reader, node->text)) {
        *path = copy_text(node->text);
        return *path ? SONJECT_OK : report_out_of_memory(reader->report, "a file name");
    }
    const sonject_status status = read_path(reader, node, path);
    if (status != SONJECT_OK || file_exists(*path))
        return status;
    text_excerpt(excerpt, sizeof excerpt, *path);
    free(*path);
    *path = NULL;
    return refuse_value(reader, node, "there is no file %s; check its name", excerpt);
}

static sonject_status read_owned_text(struct reader *reader, const struct tree_node *node,
                                      char **owned)
{
    const char *text = read_text(reader, node);
    if (!text)
        return SONJECT_ERROR_INPUT;
    if (*text == '\0' || !text_is_printable(text))
        return refuse_value(reader, node, "must be a text without control characters");
    *owned = copy_text(text);
    return *owned ? SONJECT_OK : report_out_of_memory(reader->report, "a text");
}

/* Reads a section. An empty value is a section without keys. */
static sonject_status read_subsection(struct reader *reader, const struct section *section,
                                      const struct tree_node *node, void *structure)
{
    struct tree_node empty = {.kind = TREE_SECTION, .place = node->place};
    return read_section(reader, section, tree_is_null(node) ? &empty : node, structure);
}

/* The place of a list's next entry. */
struct entries {
    const struct field *field;
    char *first;
    uint32_t *count;
};

static sonject_status read_entry(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    const struct entries *entries = structure;
    char *entry = entries->first + entries->field->entry_bytes * (*entries->count)++;
    return read_section(reader, entries->field->section, node, entry);
}

static sonject_status read_entries(struct reader *reader, const struct field *field,
                                   const struct tree_node *node, void *structure)
{
    char how[60];
    const struct list list = {0, field->maximum, how, read_entry};
    struct entries entries = {field, (char *)structure + field->offset,
                              (uint32_t *)(void *)((char *)structure + field->count_offset)};
    snprintf(how, sizeof how, "; start each %s with '- '", field->unit);
    return tree_is_null(node) ? SONJECT_OK : read_list(reader, node, &list, &entries);
}

static sonject_status read_value(struct reader *reader, const struct field *field,
                                 const struct tree_node *node, void *structure)
{
    void *destination = (char *)structure + field->offset;
    uint64_t count = 0;
    sonject_status status = SONJECT_OK;
    if (field->read && field->kind != FIELD_NAMED)
        return field->read(reader, node, field->kind == FIELD_SPECIAL ? destination : structure);
    switch (field->kind) {
    case FIELD_QUANTITY:
        if (field->section && node->kind != TREE_TEXT)
            return read_section(reader, field->section, node, structure);
        return read_number(reader, field, node, destination);
    case FIELD_UNIT:
        return read_unit(reader, node, destination);
    case FIELD_COUNT32:
        status = read_count(reader, field, node, &count);
        if (status == SONJECT_OK)
            *(uint32_t *)destination = (uint32_t)count;
        return status;
    case FIELD_COUNT64:
        return read_count(reader, field, node, destination);
    case FIELD_BOOL:
        return read_bool(reader, node, destination);
    case FIELD_WORD:
        if (field->section && node->kind == TREE_SECTION)
            return read_section(reader, field->section, node, structure);
        return read_word(reader, field, node, destination);
    case FIELD_LABEL:
        return read_label(reader, node, destination);
    case FIELD_TEXT:
        return read_owned_text(reader, node, destination);
    case FIELD_PATH:
        return read_path(reader, node, destination);
    case FIELD_FILE:
        return read_existing_path(reader, node, destination);
    case FIELD_SECTION:
        return read_subsection(reader, field->section, node, destination);
    case FIELD_NAMED:
        if (node->kind == TREE_TEXT && !tree_is_null(node))
            return field->read(reader, node, destination);
        return read_subsection(reader, field->section, node, destination);
    case FIELD_ENTRIES:
        return read_entries(reader, field, node, structure);
    case FIELD_SPECIAL:
        break;
    }
    return SONJECT_OK; /* read elsewhere */
}

/* Returns whether a node is a word that stands for a number. */
static bool is_word_of(const struct field *field, const struct tree_node *node)
{
    for (size_t i = 0; field->kind == FIELD_QUANTITY && field->words[i]; i++)
        if (is_word(node, field->words[i]))
            return true;
    return false;
}

static sonject_status read_field(struct reader *reader, const struct field *field,
                                 const struct tree_node *node, void *structure)
{
    char what[300];
    void *of = field->is_in_scene ? (void *)reader->scene : structure;
    CHECK(read_value(reader, field, node, of));
    if (field->has_kind)
        memcpy((char *)structure + field->kind_offset, &field->kind_value,
               sizeof field->kind_value);
    if (!is_word_of(field, node) && !field_is_valid(field, of, what))
        return refuse_value(reader, node, "%s", what);
    return SONJECT_OK;
}

/* Refuses an unknown key and marks the key that was meant, so that nothing calls it missing. */
static sonject_status refuse_unknown(struct reader *reader, const struct section *section,
                                     const struct tree_entry *entry)
{
    struct word_list list = {{0}, 0};
    if (!are_valid(reader, entry->key))
        return SONJECT_ERROR_INPUT;
    const char *near = nearest_key(section, entry->key, strlen(entry->key), &list);
    const size_t before = key_path_add(&reader->path, entry->key);
    if (near)
        tree_failure(reader->tree, entry->place, reader->path.text,
                     "unknown key; did you mean '%s'?", near);
    else
        tree_failure(reader->tree, entry->place, reader->path.text,
                     "unknown key; known here are %s", list.text);
    key_path_shorten(&reader->path, before);
    if (near)
        mark_wrong(reader, &entry->value, near);
    return SONJECT_ERROR_INPUT;
}

static sonject_status find_unknown(struct reader *reader, const struct section *section,
                                   const struct tree_node *node)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; i < node->count; i++)
        if (!field_of(section, node->entries[i].key, strlen(node->entries[i].key)))
            status = refuse_unknown(reader, section, &node->entries[i]);
    return status;
}

static sonject_status find_missing(struct reader *reader, const struct section *section,
                                   const struct tree_node *node)
{
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; i < section->count; i++) {
        const struct field *field = &section->fields[i];
        if (field->is_required && !is_given(node, field->key))
            status = refuse_key(reader, node, field->key, "missing; add it (%s)", field->meaning);
    }
    return status;
}

/* Writes "a, b and c" for "a b c", and "a and b, or c and d" for "a+b c+d". */
static void tell_choice(const char *choice, char text[200])
{
    const bool is_of_sets = strchr(choice, '+') != NULL;
    size_t length = 0;
    for (; *choice && length < 190; choice++) {
        const char *joint = *choice == '+'            ? " and "
                            : is_of_sets              ? ", or "
                            : strchr(choice + 1, ' ') ? ", "
                                                      : " and ";
        if (*choice == ' ' || *choice == '+')
            length += (size_t)snprintf(text + length, 200 - length, "%s", joint);
        else
            text[length++] = *choice;
    }
    text[length] = 0;
}

/* Checks that exactly one of the section's choice is there. */
static sonject_status check_choice_given(struct reader *reader, const struct section *section,
                                         const struct tree_node *node)
{
    const char *rest = section->choice;
    const bool is_of_sets = strchr(rest, '+') != NULL;
    size_t whole = 0, begun = 0;
    bool are_right = true;
    char key[64], told[200];
    while (next_key(&rest, key)) {
        size_t keys = 1;
        for (char *plus; (plus = strchr(key, '+')) != NULL; keys++)
            *plus = ' '; /* blanks separate keys */
        begun += count_given(node, key) > 0;
        whole += count_given(node, key) == keys;
        are_right = are_right && are_valid(reader, key);
    }
    const bool may_lack = section->may_lack || (section == &input_section && reader->takes_pixels);
    if (begun == 1 ? whole == 1 : begun == 0 && may_lack)
        return SONJECT_OK;
    if (!are_right && (begun == 0 || is_of_sets))
        return SONJECT_ERROR_INPUT; /* one is there, but misspelt or wrong */
    tell_choice(section->choice, told);
    if (is_of_sets)
        return refuse_value(reader, node, "needs %s; give one of these", told);
    return refuse_value(reader, node, "%s of %s is there; give one",
                        begun == 0 ? "none" : "more than one", told);
}

bool reading_ends(sonject_status status)
{
    return status != SONJECT_OK && status != SONJECT_ERROR_INPUT;
}

/* Returns the status after a step. A message that the reader did not make, such as one about a line
 * of a table, becomes a mistake at the node. */
static sonject_status settle(const struct reader *reader, const struct tree_node *node,
                             sonject_status before, sonject_status status)
{
    char *message = reader->report->message;
    if (status == SONJECT_ERROR_INPUT && *message && reader->tree->mistakes) {
        mistakes_add(reader->tree->mistakes, reader->tree, &node->place, reader->path.text,
                     message);
        *message = 0;
    }
    return status == SONJECT_OK || reading_ends(before) ? before : status;
}

sonject_status read_list(struct reader *reader, const struct tree_node *node,
                         const struct list *list, void *structure)
{
    sonject_status status = SONJECT_OK;
    if (node->kind != TREE_LIST || node->count < list->least)
        return refuse_value(reader, node, "must be a list%s", list->how);
    if (node->count > list->most)
        return refuse_value(reader, node, "has %zu entries; at most %zu are possible", node->count,
                            list->most);
    for (size_t i = 0; !reading_ends(status) && i < node->count; i++) {
        const struct tree_node *entry = &node->entries[i].value;
        const size_t before = key_path_add_index(&reader->path, i);
        status = settle(reader, entry, status, list->read(reader, entry, structure));
        key_path_shorten(&reader->path, before);
    }
    return status;
}

static size_t count_mistakes(const struct reader *reader)
{
    const struct mistakes *mistakes = reader->tree->mistakes;
    return mistakes ? mistakes->count + mistakes->uncounted : 0;
}

sonject_status read_section(struct reader *reader, const struct section *section,
                            const struct tree_node *node, void *structure)
{
    if (node->kind != TREE_SECTION)
        return refuse_value(reader, node, "must be a section of 'key: value' lines, not a %s",
                            node->kind == TREE_LIST ? "list" : "single value");
    const size_t wrong_before = count_mistakes(reader);
    sonject_status status = find_unknown(reader, section, node);
    status = settle(reader, node, status, find_missing(reader, section, node));
    for (size_t i = 0; !reading_ends(status) && i < section->count; i++) {
        const struct field *field = &section->fields[i];
        const struct tree_entry *entry = field->is_hidden ? NULL : tree_find(node, field->key);
        if (!entry)
            continue;
        const size_t before = key_path_add(&reader->path, entry->key);
        status = settle(reader, &entry->value, status,
                        read_field(reader, field, &entry->value, structure));
        key_path_shorten(&reader->path, before);
    }
    if (!reading_ends(status) && section->choice)
        status = settle(reader, node, status, check_choice_given(reader, section, node));
    if (!reading_ends(status) && section->finish)
        status = settle(reader, node, status, section->finish(reader, node, structure));
    if (!reading_ends(status) && section->relations) {
        struct check check = check_at(reader, node);
        section->relations(&check, structure);
    }
    const bool is_wrong = count_mistakes(reader) > wrong_before;
    return status == SONJECT_OK && is_wrong ? SONJECT_ERROR_INPUT : status;
}
