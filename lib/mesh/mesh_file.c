/* The choice of a mesh file's reader, the words of text files, and OBJ. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/text.h"
#include "mesh/mesh_reader.h"

/* 10^7 triangles take some 0.5 GB as binary STL and up to five times that as text. */
#define FILE_BYTES_MAX ((size_t)4 << 30)

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static bool ends_word(char c)
{
    return c == '\0' || c == '\n' || is_blank(c);
}

bool words_on_line(struct words *words)
{
    for (; words->at < words->end; words->at++) {
        const char *next = words->at + 1;
        if (*words->at == '\\') {
            next += *next == '\r';
            if (*next != '\n')
                return true;
            words->at = next;
            words->line++;
        } else if (!is_blank(*words->at)) {
            return *words->at != '\n';
        }
    }
    return false;
}

void words_skip_line(struct words *words)
{
    const char *end = memchr(words->at, '\n', (size_t)(words->end - words->at));
    words->at = end ? end + 1 : words->end;
    words->line += end != NULL;
}

bool words_left(struct words *words, char comment)
{
    while (!words_on_line(words) || (comment != '\0' && *words->at == comment)) {
        if (words->at >= words->end)
            return false;
        words_skip_line(words);
    }
    return true;
}

/* Returns the length of the word if the text begins with it, in any case of letters; else 0. */
static size_t match(const char *text, const char *word)
{
    size_t i = 0;
    for (; word[i]; i++)
        if ((text[i] >= 'A' && text[i] <= 'Z' ? (char)(text[i] - 'A' + 'a') : text[i]) != word[i])
            return 0;
    return i;
}

bool words_accept(struct words *words, const char *word)
{
    if (!words_on_line(words))
        return false;
    const size_t length = match(words->at, word);
    if (length == 0 || !ends_word(words->at[length]))
        return false;
    words->at += length;
    return true;
}

sonject_status words_failure(const struct words *words, const char *what)
{
    const struct mesh_soup *soup = words->soup;
    char word[40];
    size_t length = 0;
    const size_t left = (size_t)(words->end - words->at);
    while (length < left && length < sizeof word - 1 && !ends_word(words->at[length])) {
        const char c = words->at[length];
        word[length++] = c > 0x20 && c < 0x7f ? c : '?';
    }
    word[length] = '\0';
    if (left == 0)
        return report_failure(soup->report, SONJECT_ERROR_INPUT,
                              "%s, line %zu: expected %s, but the file ends here: it is cut short",
                              soup->path, words->line, what);
    return report_failure(soup->report, SONJECT_ERROR_INPUT,
                          "%s, line %zu: expected %s, found '%s'", soup->path, words->line, what,
                          length > 0 ? word : "end of line");
}

/* Reads a number of few digits exactly, several times faster than text_to_number. It rounds once: a
 * whole number times or over a power of ten, both exact. Returns false for longer numbers. */
static bool read_short_number(const char *at, const char **rest, double *number)
{
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const bool is_negative = *at == '-';
    uint64_t digits = 0;
    int count = 0;
    int shift = 0;
    int exponent = 0;
    bool is_fraction = false;
    at += *at == '-' || *at == '+';
    for (; (*at >= '0' && *at <= '9') || (*at == '.' && !is_fraction); at++) {
        if (*at == '.') {
            is_fraction = true;
            continue;
        }
        if (++count > 18)
            return false;
        digits = 10 * digits + (uint64_t)(*at - '0');
        shift -= is_fraction;
    }
    if (*at == 'e' || *at == 'E') {
        const bool is_down = at[1] == '-';
        at += at[1] == '-' || at[1] == '+' ? 2 : 1;
        if (*at < '0' || *at > '9')
            return false;
        for (; *at >= '0' && *at <= '9' && exponent <= 40; at++)
            exponent = 10 * exponent + (*at - '0');
        shift += is_down ? -exponent : exponent;
    }
    if (count == 0 || digits > UINT64_C(1) << 53 || shift < -22 || shift > 22)
        return false;
    const double value =
        shift < 0 ? (double)digits / powers[-shift] : (double)digits * powers[shift];
    *number = is_negative ? -value : value;
    *rest = at;
    return true;
}

sonject_status words_number(struct words *words, const char *what, double *number)
{
    const char *rest;
    if (!words_on_line(words) ||
        !(read_short_number(words->at, &rest, number) ||
          text_to_number(words->at, number, &rest)) ||
        !ends_word(*rest) || !isfinite(*number))
        return words_failure(words, what);
    words->at = rest;
    return SONJECT_OK;
}

sonject_status words_position(struct words *words, double position[3])
{
    for (int axis = 0; axis < 3; axis++)
        CHECK(words_number(words, "a finite coordinate", &position[axis]));
    return SONJECT_OK;
}

sonject_status words_whole(struct words *words, const char *what, int64_t *number)
{
    if (!words_on_line(words))
        return words_failure(words, what);
    const char *at = words->at + (*words->at == '-' || *words->at == '+');
    int64_t value = 0;
    int digits = 0;
    for (; *at >= '0' && *at <= '9' && digits < 18; at++, digits++)
        value = 10 * value + (*at - '0');
    if (digits == 0 || !(ends_word(*at) || *at == '/'))
        return words_failure(words, what);
    *number = *words->at == '-' ? -value : value;
    words->at = at;
    return SONJECT_OK;
}

double single_from_bytes(const char *bytes, bool is_big_endian)
{
    const uint32_t bits =
        (uint32_t)number_from_bytes((const unsigned char *)bytes, 4, is_big_endian);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Reads "7", "7/1", "7//3" or "7/1/3", of which only the vertex counts. Negative numbers count back
 * from the last vertex so far. */
static sonject_status read_corner(struct words *words, uint32_t *corner)
{
    const struct mesh_soup *soup = words->soup;
    int64_t number;
    CHECK(words_whole(words, "the number of a vertex", &number));
    while (words->at < words->end &&
           (*words->at == '/' || *words->at == '-' || (*words->at >= '0' && *words->at <= '9')))
        words->at++;
    const int64_t vertices = (int64_t)soup->vertices;
    if (number == 0 || number > vertices || number < -vertices)
        return report_failure(soup->report, SONJECT_ERROR_INPUT,
                              "%s, line %zu: a face has vertex %lld, but %lld are there so far",
                              soup->path, words->line, (long long)number, (long long)vertices);
    *corner = (uint32_t)(number > 0 ? number - 1 : vertices + number);
    return SONJECT_OK;
}

static sonject_status read_face(struct words *words)
{
    size_t corners = 0;
    uint32_t fan[2];
    while (words_on_line(words) && *words->at != '#') {
        uint32_t corner = 0;
        CHECK(read_corner(words, &corner));
        CHECK(mesh_soup_add_polygon_corner(words->soup, corners++, corner, fan));
    }
    return corners >= 3 ? SONJECT_OK : words_failure(words, "three vertices or more of a face");
}

sonject_status obj_read(struct mesh_soup *soup, const char *bytes, size_t count)
{
    struct words words = {soup, bytes, bytes + count, 1};
    for (; words_left(&words, '#'); words_skip_line(&words)) {
        if (words_accept(&words, "v")) {
            double position[3];
            CHECK(words_position(&words, position)); /* a weight or a colour may follow */
            CHECK(mesh_soup_add_vertex(soup, position));
        } else if (words_accept(&words, "f")) {
            CHECK(read_face(&words));
        }
    }
    return SONJECT_OK;
}

sonject_status mesh_file_read(struct mesh_soup *soup)
{
    static const struct {
        const char *extension;
        sonject_status (*read)(struct mesh_soup *soup, const char *bytes, size_t count);
    } formats[] = {{".stl", stl_read}, {".obj", obj_read}, {".ply", ply_read}};
    const size_t length = strlen(soup->path);
    for (size_t i = 0; i < sizeof formats / sizeof *formats && length >= 4; i++) {
        char *bytes;
        size_t count;
        if (match(soup->path + length - 4, formats[i].extension) == 0)
            continue;
        CHECK(file_read_whole(soup->report, soup->path, FILE_BYTES_MAX, &bytes, &count));
        const sonject_status status = formats[i].read(soup, bytes, count);
        free(bytes);
        return status == SONJECT_OK ? mesh_soup_cut_polygons(soup) : status;
    }
    return report_failure(soup->report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: meshes are read from STL, OBJ and PLY files; convert it to PLY",
                          soup->path);
}
