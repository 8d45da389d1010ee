/* Tests scene files made to break the reader: bombs, nesting, sizes, cut and mutated files. */
#include "claims.h"
#include "scene_folder.h"

#ifndef MUTATIONS
#define MUTATIONS                                                                                  \
    10000 /* number for each example; a slow checker may compile with fewer, and the variable      \
             SONJECT_MUTATIONS asks for another number */
#endif

static const char *const examples[] = {"demo",    "elements", "figure4", "figure5",
                                       "figure6", "figure7",  "layers",  "relief",
                                       "shapes",  "surface",  "targets"};

/* Returns the number of mutations to try of each example. */
static size_t mutations_wanted(void)
{
    const char *text = getenv("SONJECT_MUTATIONS");
    const long number = text ? strtol(text, NULL, 10) : 0;
    return number > 0 ? (size_t)number : MUTATIONS;
}

/* True where a file cannot be read: a mutated name may be that of a folder. */
static bool names_what_cannot_be_read(sonject_status status)
{
    return status == SONJECT_ERROR_STORAGE && strstr(folder->report.message, ": cannot ") != NULL;
}

/* Expects each line of the message to lead to a place in the text of the file at path, in order. */
static void expect_places(const char *message, const char *path, const char *text, size_t bytes)
{
    unsigned long last_line = 1, last_column = 1;
    for (const char *at = message, *end; *at; at = *end ? end + 1 : end) {
        unsigned long line = 0, column = 0;
        int length = 0;
        end = at + strcspn(at, "\n");
        if (at != message && *end == 0 && sscanf(at, "and %lu more%n", &line, &length) == 1)
            return;
        if (strncmp(at, path, strlen(path)) != 0 ||
            sscanf(at + strlen(path), ":%lu:%lu: %n", &line, &column, &length) != 2 ||
            length == 0 || at + strlen(path) + length >= end)
            fail_msg("no place or no text: %s", at);
        /* Next line (0x85) and its like also end a line for YAML, and take two bytes or more. The
         * end of the file is one more end. */
        if (line < 1 || line > lines_of(text, bytes) + bytes / 2 + 1 || column < 1 ||
            column > bytes + 1)
            fail_msg("a place that is not there: %s", at);
        if (line < last_line || (line == last_line && column < last_column))
            fail_msg("not in the order of the file: %s", message);
        last_line = line;
        last_column = column;
    }
}

/* Reads the text from memory of just its size, which finds reading beyond and is quicker than a
 * file. A text with a zero byte, which only a file can have, is read from a file. */
static sonject_status read_bytes(const char *text, size_t bytes)
{
    if (memchr(text, 0, bytes)) {
        write_scene(text, bytes);
        return read_scene(NULL, 0);
    }
    char *copy = zeroed(bytes + 1, 1);
    memcpy(copy, text, bytes);
    copy[bytes] = 0;
    const struct scene_source source = {.path = folder->file, .text = copy};
    scene_clear(&folder->scene);
    const sonject_status status = scene_source_read(&source, &folder->report, &folder->scene);
    free(copy);
    return status;
}

/* Expects any text to give a scene, or a message that leads to lines of the text. */
static sonject_status expect_taken_or_explained(const char *text, size_t bytes)
{
    const sonject_status status = read_bytes(text, bytes);
    if (status == SONJECT_OK || names_what_cannot_be_read(status))
        return status;
    if (status != SONJECT_ERROR_INPUT || !folder->report.message[0])
        fail_msg("status %d: %s", (int)status, folder->report.message);
    expect_places(folder->report.message, folder->file, text, bytes);
    assert_int_equal(folder->scene.object_count, 0);
    assert_null(folder->scene.input_path);
    return status;
}

static void expect_saying(const char *text, size_t bytes, const char *part)
{
    if (expect_taken_or_explained(text, bytes) == SONJECT_OK)
        fail_msg("taken instead of: %s", part);
    if (!strstr(folder->report.message, part))
        fail_msg("the message is not '%s': %s", part, folder->report.message);
}

/* Returns head, then middle count times, then tail. The caller frees the text. */
static char *repeated(const char *head, const char *middle, size_t count, const char *tail)
{
    char *text = zeroed(strlen(head) + count * strlen(middle) + strlen(tail) + 1, 1);
    char *end = text + sprintf(text, "%s", head);
    for (size_t i = 0; i < count; i++)
        end += sprintf(end, "%s", middle);
    sprintf(end, "%s", tail);
    return text;
}

static void expect_repeated_saying(const char *head, const char *middle, size_t count,
                                   const char *tail, const char *part)
{
    char *text = repeated(head, middle, count, tail);
    expect_saying(text, strlen(text), part);
    free(text);
}

TEST(test_alias_bomb)
{
    char text[2000] = "a: &a [x,x,x,x,x,x,x,x,x]\n";
    for (char name = 'b'; name <= 'j'; name++)
        sprintf(text + strlen(text), "%c: &%c [*%c,*%c,*%c,*%c,*%c,*%c,*%c,*%c]\n", name, name,
                name - 1, name - 1, name - 1, name - 1, name - 1, name - 1, name - 1, name - 1);
    expect_saying(text, strlen(text), ":1:4: a: anchors");
}

TEST(test_deep_nesting)
{
    expect_repeated_saying("a: ", "[", 33, "", "nested too deeply");
    expect_repeated_saying("a: ", "[", 500000, "", "nested too deeply");
    expect_repeated_saying("", "{a: ", 200000, "", "nested too deeply");
    expect_repeated_saying("", "- ", 500000, "x", "nested too deeply");
    expect_repeated_saying("", "? ", 500000, "x", "plain words");
}

TEST(test_too_many_values)
{
    expect_repeated_saying("a: [", "1,", 99998, "1]", "unknown key");
    expect_repeated_saying("a: [", "1,", 99999, "1]", "one value too many");
    expect_repeated_saying("sonject: 1\nobjects: [", "{},", 251, "]", "input: missing");
}

TEST(test_too_many_keys)
{
    char *text = zeroed(20000, 1);
    char *end = text;
    for (int i = 0; i < 257; i++)
        end += sprintf(end, "key_%d: 1\n", i);
    expect_saying(text, strlen(text), ":257:1: key_256: has more than 256 keys");
    free(text);
}

TEST(test_too_many_objects)
{
    static const char head[] = BASE "objects:\n";
    static const char object[] = "  - {shape: sphere, diameter: 1}\n";
    char *text = repeated(head, object, 250, "");
    assert_int_equal(expect_taken_or_explained(text, strlen(text)), SONJECT_OK);
    free(text);
    expect_repeated_saying(head, object, 251, "", "has 251 entries; at most 250");
}

TEST(test_too_large_a_file)
{
    char *text = repeated("# ", "x", 1024 * 1024, "");
    write_scene(text, strlen(text));
    free(text);
    assert_int_equal(read_scene(NULL, 0), SONJECT_ERROR_INPUT);
    assert_memory_equal(folder->report.message, folder->file, strlen(folder->file));
}

TEST(test_long_words)
{
    expect_repeated_saying("", "k", 1000, ": 1", ": unknown key");
    expect_repeated_saying("\"", "k", 500000, "\": 1", "not valid YAML");
    expect_repeated_saying("sonject: ", "1", 500000, "", "sonar: missing");
    expect_repeated_saying("? ", "\xC3\xA9", 100000, "\n: 1", ": unknown key");
    assert_true(strlen(folder->report.message) < REPORT_CAPACITY - 1);
}

/* A number of half a million digits is still a number. */
TEST(test_long_numbers)
{
    static const char head[] =
        START INPUT "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10.";
    char *text = repeated(head, "0", 500000, "1}\n");
    assert_int_equal(expect_taken_or_explained(text, strlen(text)), SONJECT_OK);
    assert_true(folder->scene.sonar.altitude_m == 10.0);
    free(text);
    expect_repeated_saying(head, "0", 1000, "e99999}\n", "too large");
    expect_repeated_saying(head, "k", 1000, "}\n", "kkk...' is not one of m, km, cm, mm");
}

TEST(test_other_encodings)
{
    static const char utf16[] = "\xFF\xFEs\0o\0n\0";
    static const char zero[] = "sonject: 1\n\0input: 1\n";
    expect_saying(utf16, sizeof utf16 - 1, ":1:1: not UTF-8");
    expect_saying(zero, sizeof zero - 1, ":2:1: not UTF-8 text (control characters");
    expect_saying("\xEF\xBB\xBF", 3, "there is nothing in it");
    expect_saying("\xEF\xBB", 2, "not UTF-8");
}

TEST(test_an_example_cut_at_every_length)
{
    size_t bytes;
    size_t taken = 0;
    char *text = example_scene("demo", &bytes);
    for (size_t length = 0; length <= bytes; length++)
        taken += expect_taken_or_explained(text, length) == SONJECT_OK;
    /* Most of the file is needed, but its end holds objects that may be missing. */
    assert_true(taken > 0 && taken < bytes / 2);
    free(text);
}

static size_t throw(uint64_t * dice, size_t sides)
{
    return (size_t)(next_random(dice) >> 32) % sides;
}

#define TEXT_CAPACITY 8192

/* Sets a byte or special character, or loses, doubles or moves a piece. Returns the new size. */
static size_t mutate(uint64_t *dice, char *text, size_t bytes)
{
    static const char special[] = "{}[]:,#&*!|>'\"%@`-?\n\t \\.0-9e~";
    const size_t at = throw(dice, bytes);
    const size_t most = bytes - at < 40 ? bytes - at : 40;
    const size_t length = 1 + throw(dice, most);
    const size_t from = throw(dice, bytes - length + 1);
    char piece[40];
    switch (throw(dice, 5)) {
    case 0:
        text[at] = (char) throw(dice, 256);
        return bytes;
    case 1:
        text[at] = special[throw(dice, sizeof special - 1)];
        return bytes;
    case 2:
        memmove(text + at, text + at + length, bytes - at - length);
        return bytes - length;
    case 3:
        memcpy(piece, text + from, length);
        if (bytes + length > TEXT_CAPACITY)
            return bytes;
        memmove(text + at + length, text + at, bytes - at);
        memcpy(text + at, piece, length);
        return bytes + length;
    default:
        memcpy(piece, text + from, length);
        memcpy(text + at, piece, length);
        return bytes;
    }
}

/* Makes one to four changes to a copy of the text. Returns the copy's size, bytes. */
static size_t mutate_some(uint64_t *dice, char mutated[TEXT_CAPACITY], const char *text,
                          size_t bytes)
{
    memcpy(mutated, text, bytes);
    for (size_t changes = 1 + throw(dice, 4); changes > 0 && bytes > 0; changes--)
        bytes = mutate(dice, mutated, bytes);
    return bytes;
}

/* Puts the folder of the examples' targets in place of "../targets/". */
static size_t lead_to_targets(char *text, size_t bytes)
{
    static const char from[] = "../targets/", to[] = SOURCE_ROOT "/tools/targets/";
    const size_t from_bytes = sizeof from - 1, to_bytes = sizeof to - 1;
    for (char *at = strstr(text, from); at; at = strstr(at + to_bytes, from)) {
        assert_true(bytes + to_bytes < TEXT_CAPACITY);
        memmove(at + to_bytes, at + from_bytes, bytes - (size_t)(at - text) - from_bytes + 1);
        memcpy(at, to, to_bytes);
        bytes += to_bytes - from_bytes;
    }
    return bytes;
}

TEST(test_mutated_examples)
{
    uint64_t dice = 1;
    const size_t wanted = mutations_wanted();
    for (size_t i = 0; i < COUNT(examples); i++) {
        size_t bytes;
        size_t refused = 0;
        char *text = example_scene(examples[i], &bytes);
        assert_true(bytes > 100 && bytes < TEXT_CAPACITY);
        bytes = lead_to_targets(text, bytes);
        for (size_t j = 0; j < wanted; j++) {
            char mutated[TEXT_CAPACITY];
            const size_t length = mutate_some(&dice, mutated, text, bytes);
            refused += expect_taken_or_explained(mutated, length) != SONJECT_OK;
        }
        /* Many changes fall into comments, but the mutations must hurt. */
        print_message("%s: %zu of %zu refused\n", examples[i], refused, wanted);
        assert_true(refused > wanted / 4 && refused < wanted);
        free(text);
    }
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
