/* STL files: triangles of three vertices each, as text or binary. */
#include <math.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "mesh/mesh_reader.h"

#define HEADER_BYTES   84 /* 80 bytes of any kind, then the number of triangles */
#define TRIANGLE_BYTES 50 /* a normal, three vertices and two bytes */

static uint64_t promised_triangles(const char *bytes)
{
    return number_from_bytes((const unsigned char *)bytes + 80, 4, false);
}

static sonject_status read_binary_triangle(struct weld *weld, const char *bytes, size_t number)
{
    uint32_t corners[3];
    for (size_t corner = 0; corner < 3; corner++) {
        double position[3];
        for (size_t axis = 0; axis < 3; axis++) {
            position[axis] = single_from_bytes(bytes + 12 + 12 * corner + 4 * axis, false);
            if (!isfinite(position[axis]))
                return report_failure(weld->soup->report, SONJECT_ERROR_INPUT,
                                      "%s, triangle %zu: a coordinate is not a finite number; "
                                      "export the mesh again",
                                      weld->soup->path, number + 1);
        }
        CHECK(weld_vertex(weld, position, &corners[corner]));
    }
    return mesh_soup_add_triangle(weld->soup, corners[0], corners[1], corners[2]);
}

static sonject_status read_binary(struct weld *weld, const char *bytes, size_t count)
{
    const struct mesh_soup *soup = weld->soup;
    if (count < HEADER_BYTES)
        return input_failure(soup->report, soup->path,
                             "%zu bytes are too few for an STL file, whose header takes %d", count,
                             HEADER_BYTES);
    const uint64_t promised = promised_triangles(bytes);
    const uint64_t held = (count - HEADER_BYTES) / TRIANGLE_BYTES;
    if (promised * TRIANGLE_BYTES + HEADER_BYTES != count)
        return input_failure(
            soup->report, soup->path, "the header says %llu triangles, the file holds %llu%s: %s",
            (unsigned long long)promised, (unsigned long long)held,
            held * TRIANGLE_BYTES + HEADER_BYTES == count ? "" : " and a part of one",
            promised > held ? "it is cut short, copy or export it again" : "export it again");
    for (size_t i = 0; i < (size_t)promised; i++)
        CHECK(read_binary_triangle(weld, bytes + HEADER_BYTES + i * TRIANGLE_BYTES, i));
    return SONJECT_OK;
}

/* Takes a word that may stand on a later line. */
static sonject_status expect(struct words *words, const char *word)
{
    return words_left(words, '\0') && words_accept(words, word) ? SONJECT_OK
                                                                : words_failure(words, word);
}

/* Reads what follows "facet". The normal is ignored: many programs write 0 0 0, some write nan. */
static sonject_status read_facet(struct words *words, struct weld *weld)
{
    uint32_t corners[3];
    words_skip_line(words);
    CHECK(expect(words, "outer"));
    CHECK(expect(words, "loop"));
    for (int corner = 0; corner < 3; corner++) {
        double position[3];
        CHECK(expect(words, "vertex"));
        CHECK(words_position(words, position));
        CHECK(weld_vertex(weld, position, &corners[corner]));
    }
    CHECK(expect(words, "endloop"));
    CHECK(expect(words, "endfacet"));
    return mesh_soup_add_triangle(weld->soup, corners[0], corners[1], corners[2]);
}

static sonject_status read_text(struct words *words, struct weld *weld)
{
    while (words_left(words, '\0')) {
        if (!words_accept(words, "solid"))
            return words_failure(words, "'solid'");
        words_skip_line(words); /* the solid's name */
        while (!words_left(words, '\0') || !words_accept(words, "endsolid")) {
            if (!words_accept(words, "facet"))
                return words_failure(words, "'facet' or 'endsolid'");
            CHECK(read_facet(words, weld));
        }
        words_skip_line(words);
    }
    return SONJECT_OK;
}

/* Returns whether a file is text. Binary files may begin with "solid" too; their size tells. */
static bool is_text(const char *bytes, size_t count)
{
    if (count < 6 || memcmp(bytes, "solid", 5) != 0)
        return false;
    if (count >= HEADER_BYTES && promised_triangles(bytes) * TRIANGLE_BYTES + HEADER_BYTES == count)
        return false;
    return memchr(bytes, '\0', count < HEADER_BYTES ? count : HEADER_BYTES) == NULL;
}

sonject_status stl_read(struct mesh_soup *soup, const char *bytes, size_t count)
{
    struct weld weld = {.soup = soup};
    struct words words = {soup, bytes, bytes + count, 1};
    const sonject_status status =
        is_text(bytes, count) ? read_text(&words, &weld) : read_binary(&weld, bytes, count);
    weld_clear(&weld);
    return status;
}
