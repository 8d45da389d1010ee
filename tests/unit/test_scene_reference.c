/* The reference of scene files, tools/scenes/KEYS.md, is what the reader does: its keys, meanings
 * and units are the tables', its defaults what a scene without the key holds, its ranges what the
 * reader says of numbers that are too large or too small. Run with a file's name it writes it. */
#define _POSIX_C_SOURCE 200809L

#include "claims.h"
#include "scene_keys.h"

#define REFERENCE SOURCE_ROOT "/tools/scenes/KEYS.md"
#define KEYS_MAX  400
#define WORDS_MAX 15

static const char introduction[] = "# Keys of scene files\n"
                                   "\n"
                                   "A scene is a YAML file; `tools/scenes/demo.yaml` is one that "
                                   "explains itself. Numbers take the units "
                                   "below, or none: then\n"
                                   "metres, hertz, seconds and so on are meant. `[]` stands for "
                                   "each entry of a list, counted from 0 in "
                                   "`--set 'objects[0].heading=90 deg'`. Keys\n"
                                   "marked * must be there if their section is. A default of – is "
                                   "none: the key then does nothing, "
                                   "or its meaning says what\n"
                                   "is done. Ranges are those that the reader tells, in SI units; "
                                   "sections may refuse combinations "
                                   "besides, with a message.\n";

struct page {
    FILE *file;
    struct scene_folder *folder;
    struct scene_file_key keys[KEYS_MAX];
    size_t count;
};

static void print_number(FILE *out, const struct scene_file_key *key, double number)
{
    const size_t length = strcspn(key->unit, ",");
    if (key->words)
        fprintf(out, "%s", key->words[(size_t)number]);
    else if (strcmp(key->unit, "true or false") == 0)
        fprintf(out, "%s", number != 0.0 ? "true" : "false");
    else if (strncmp(key->unit, "deg", 3) == 0)
        fprintf(out, "%.4g deg", number * 180.0 / PI);
    else if (strcmp(key->unit, "dB, or a linear number") == 0 && number > 0.0)
        fprintf(out, "%.4g dB", 10.0 * log10(number));
    else if (strstr(key->unit, "number"))
        fprintf(out, "%.6g", number);
    else
        fprintf(out, "%.6g %.*s", number, (int)length, key->unit);
}

static bool is_of_numbers(const struct scene_file_key *key)
{
    static const char *const others[] = {"word", "text", "name", "file name", "true or false"};
    for (size_t i = 0; i < COUNT(others); i++)
        if (strcmp(key->unit, others[i]) == 0)
            return false;
    return strncmp(key->unit, "list", 4) != 0 && !strstr(key->unit, "name");
}

/* Where a number stands for a word, and what only looks like a default: the case's own sphere. */
static const char *told_default(const struct scene_file_key *key)
{
    static const struct {
        const char *path, *text;
    } told[] = {{"input.channel", "the only one"},
                {"sonar.aperture", "auto"},
                {"injection.noise_floor", "estimate"},
                {"injection.match.looks", "image"},
                {"objects[].diameter", "–"}};
    for (size_t i = 0; i < COUNT(told); i++)
        if (strcmp(told[i].path, key->path) == 0)
            return told[i].text;
    return strstr(key->meaning, "by default") ? "–" : NULL;
}

static void print_default(struct page *page, const struct scene_file_key *key,
                          const struct key_case *place)
{
    struct scene defaults;
    const bool has_value = place->type != TYPE_NOTHING && (key->words || is_of_numbers(key) ||
                                                           strcmp(key->unit, "true or false") == 0);
    const char *told = told_default(key);
    double number = NAN;
    scene_init(&defaults);
    if (!key->is_required && has_value && structure_of(&defaults, place->path) == &defaults)
        number = number_at(&defaults, place);
    else if (!key->is_required && has_value && read_case(page->folder, place, NULL) == SONJECT_OK)
        number = number_at(structure_of(&page->folder->scene, place->path), place);
    if (told || isnan(number))
        fprintf(page->file, "%s", told ? told : "–");
    else
        print_number(page->file, key, number);
}

/* "..." of a message ": must be ..., not 7" or "...; do this"; false if it is of another kind. */
static bool find_range(const char *message, char *range, size_t capacity)
{
    const char *start = strstr(message, "must be ");
    if (!start)
        return false;
    snprintf(range, capacity, "%s", start + strlen("must be "));
    char *end = strstr(range, ", not ");
    if (!end)
        end = strstr(range, "; ");
    if (end)
        *end = 0;
    return strpbrk(range, "0123456789") != NULL;
}

static void print_range(struct page *page, const struct scene_file_key *key,
                        const struct key_case *place)
{
    static const char *const reals[] = {"-1e30", "1e30", "0"};
    static const char *const counts[] = {"18446744073709551615", "0", "0"};
    const bool counted = strcmp(key->unit, "whole number") == 0;
    char told[3][REPORT_CAPACITY];
    size_t tellings = 0;
    for (size_t i = 0; i < 3; i++) {
        char value[40];
        snprintf(value, sizeof value, "%s%s", counted ? counts[i] : reals[i],
                 strncmp(key->unit, "deg", 3) == 0 ? " rad" : "");
        bool is_new = read_case(page->folder, place, value) != SONJECT_OK &&
                      find_range(page->folder->report.message, told[tellings], sizeof *told);
        for (size_t j = 0; j < tellings; j++)
            is_new = is_new && strcmp(told[j], told[tellings]) != 0;
        tellings += is_new;
    }
    /* "at most" is what the reader alone knows, where the check of the value says more */
    for (size_t i = 0, printed = 0; i < tellings; i++)
        if (tellings == 1 || strncmp(told[i], "at most ", 8) != 0)
            fprintf(page->file, "%s%s", printed++ ? "; " : "", told[i]);
}

static void print_words(struct page *page, const struct scene_file_key *key)
{
    for (size_t i = 0, printed = 0; i < WORDS_MAX && key->words[i]; i++)
        if (*key->words[i])
            fprintf(page->file, "%s%s", printed++ ? ", " : "", key->words[i]);
}

/* A "|" would end the table's cell. */
static void print_meaning(struct page *page, const char *meaning)
{
    for (; *meaning; meaning++)
        fprintf(page->file, *meaning == '|' ? "\\%c" : "%c", *meaning);
}

/* Of a part, what stands in the object's table alike. */
static bool is_repeated(const struct page *page, const struct scene_file_key *key)
{
    static const char part[] = "objects[].parts[].";
    char alike[sizeof key->path];
    if (strncmp(key->path, part, strlen(part)) != 0)
        return false;
    snprintf(alike, sizeof alike, "objects[].%s", key->path + strlen(part));
    for (size_t i = 0; i < page->count; i++)
        if (strcmp(page->keys[i].path, alike) == 0)
            return strcmp(page->keys[i].meaning, key->meaning) == 0;
    return false;
}

/* A table a section: the top level's name of the path. */
static void print_heading(struct page *page, const char *path, const char *before)
{
    const size_t length = strcspn(path, ".[");
    if (before && strcspn(before, ".[") == length && strncmp(path, before, length) == 0)
        return;
    fprintf(page->file,
            "\n## %.*s\n\n| key | meaning | unit | default | range |\n|---|---|---|---|---|\n",
            (int)length, path);
}

static void print_reference(struct page *page)
{
    const char *before = NULL;
    fputs(introduction, page->file);
    for (size_t i = 0; i < page->count; i++) {
        const struct scene_file_key *key = &page->keys[i];
        const struct key_case *place = case_of(key->path);
        if (is_repeated(page, key))
            continue;
        print_heading(page, key->path, before);
        fprintf(page->file, "| `%s`%s | ", key->path, key->is_required ? " *" : "");
        print_meaning(page, key->meaning);
        fprintf(page->file, " | %s | ", key->unit);
        print_default(page, key, place);
        fprintf(page->file, " | ");
        if (key->words)
            print_words(page, key);
        else if (is_of_numbers(key))
            print_range(page, key, place);
        fprintf(page->file, " |\n");
        before = key->path;
    }
    fputs("\nParts, `objects[].parts[]`, also have these keys of objects, with the same meaning:",
          page->file);
    for (size_t i = 0, printed = 0; i < page->count; i++)
        if (is_repeated(page, &page->keys[i]))
            fprintf(page->file, "%s `%s`", printed++ ? "," : "",
                    page->keys[i].path + strlen("objects[].parts[]."));
    fputs(".\n", page->file);
}

/* The whole reference, for free(). */
static char *make_reference(struct scene_folder *folder)
{
    static struct page page;
    char *text = NULL;
    size_t bytes = 0;
    memset(&page, 0, sizeof page);
    page.folder = folder;
    page.count = scene_file_keys(page.keys, COUNT(page.keys));
    assert_true(page.count <= COUNT(page.keys));
    page.file = open_memstream(&text, &bytes);
    assert_non_null(page.file);
    print_reference(&page);
    assert_int_equal(fclose(page.file), 0);
    return text;
}

static void test_the_reference_is_up_to_date(void **state)
{
#if !defined(HAS_RASTER_FILES)
    print_message("heights cannot be read: nothing to compare\n");
    skip();
#endif
    char *expected = make_reference(*state);
    char *found = calloc(strlen(expected) + 2, 1);
    assert_non_null(found);
    FILE *stream = fopen(REFERENCE, "rb");
    if (!stream)
        fail_msg("%s is not there", REFERENCE);
    found[fread(found, 1, strlen(expected) + 1, stream)] = 0;
    fclose(stream);
    if (strcmp(found, expected) != 0)
        fail_msg("%s is not up to date: run this program with its name", REFERENCE);
    free(found);
    free(expected);
}

static int write_reference(const char *path)
{
    void *folder = NULL;
    FILE *stream = fopen(path, "wb");
    if (!stream || make_scene_folder(&folder) != 0)
        return 1;
    char *text = make_reference(folder);
    fputs(text, stream);
    free(text);
    remove_scene_folder(&folder);
    return fclose(stream);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_reference_is_up_to_date),
    };
    if (argc > 1)
        return write_reference(argv[1]);
    return cmocka_run_group_tests(tests, make_scene_folder, remove_scene_folder);
}
