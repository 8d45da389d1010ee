#include <math.h>
#include <string.h>

#include "base/byte_order.h"
#include "mesh/mesh_reader.h"
#include "mesh/words.h"

#define HEADER_BYTES   84 /* 80 of any kind, then the number of triangles */
#define TRIANGLE_BYTES 50 /* normal, three vertices, two bytes more */

static double float_at(const char *bytes)
{
    const uint32_t bits = (uint32_t)number_from_bytes((const unsigned char *)bytes, 4, false);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static sonject_status read_binary_triangle(struct report *report, const char *path,
                                           const char *bytes, size_t number, struct weld *weld,
                                           struct mesh_soup *soup)
{
    uint32_t corners[3];
    for (size_t corner = 0; corner < 3; corner++) {
        double position[3];
        for (size_t axis = 0; axis < 3; axis++) {
            position[axis] = float_at(bytes + 12 + 12 * corner + 4 * axis);
            if (!isfinite(position[axis]))
                return report_failure(report, SONJECT_ERROR_INPUT,
                                      "%s, triangle %zu: a coordinate is not a finite number; "
                                      "export the mesh again",
                                      path, number + 1);
        }
        if (!weld_vertex(weld, soup, position, &corners[corner]))
            return mesh_soup_failure(report, path, soup);
    }
    return mesh_soup_add_triangle(soup, corners[0], corners[1], corners[2])
               ? SONJECT_OK
               : mesh_soup_failure(report, path, soup);
}

static sonject_status read_binary(struct report *report, const char *path, const char *bytes,
                                  size_t count, struct weld *weld, struct mesh_soup *soup)
{
    if (count < HEADER_BYTES)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: %zu bytes are too few for an STL file, whose header takes %d",
                              path, count, HEADER_BYTES);
    const uint64_t promised = number_from_bytes((const unsigned char *)bytes + 80, 4, false);
    const uint64_t held = (count - HEADER_BYTES) / TRIANGLE_BYTES;
    if (promised * TRIANGLE_BYTES + HEADER_BYTES != count)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "%s: the header says %llu triangles, the file holds %llu%s: %s", path,
            (unsigned long long)promised, (unsigned long long)held,
            held * TRIANGLE_BYTES + HEADER_BYTES == count ? "" : " and a part of one",
            promised > held ? "it is cut short, copy or export it again" : "export it again");
    for (size_t i = 0; i < (size_t)promised; i++) {
        CHECK(read_binary_triangle(report, path, bytes + HEADER_BYTES + i * TRIANGLE_BYTES, i, weld,
                                   soup));
    }
    return SONJECT_OK;
}

/* Takes the words in turn, which may stand on several lines. */
static sonject_status accept_all(struct words *words, const char *const *expected)
{
    for (; *expected; expected++)
        if (!words_left(words, '\0') || !words_accept(words, *expected))
            return words_failure(words, *expected);
    return SONJECT_OK;
}

static sonject_status read_vertex(struct words *words, struct weld *weld, struct mesh_soup *soup,
                                  uint32_t *corner)
{
    static const char *const vertex[] = {"vertex", NULL};
    double position[3];
    sonject_status status = accept_all(words, vertex);
    for (int axis = 0; axis < 3 && status == SONJECT_OK; axis++)
        status = words_number(words, "a finite coordinate", &position[axis]);
    if (status == SONJECT_OK && !weld_vertex(weld, soup, position, corner))
        status = mesh_soup_failure(words->report, words->path, soup);
    return status;
}

/* What follows "facet". The normal is not used: many programs write 0 0 0, some write nan. */
static sonject_status read_facet(struct words *words, struct weld *weld, struct mesh_soup *soup)
{
    static const char *const begin[] = {"outer", "loop", NULL};
    static const char *const end[] = {"endloop", "endfacet", NULL};
    uint32_t corners[3];
    words_skip_line(words);
    sonject_status status = accept_all(words, begin);
    for (int corner = 0; corner < 3 && status == SONJECT_OK; corner++)
        status = read_vertex(words, weld, soup, &corners[corner]);
    THEN(status, accept_all(words, end));
    if (status == SONJECT_OK && !mesh_soup_add_triangle(soup, corners[0], corners[1], corners[2]))
        status = mesh_soup_failure(words->report, words->path, soup);
    return status;
}

static sonject_status read_text(struct words *words, struct weld *weld, struct mesh_soup *soup)
{
    while (words_left(words, '\0')) {
        if (!words_accept(words, "solid"))
            return words_failure(words, "'solid'");
        words_skip_line(words); /* its name */
        for (;;) {
            if (!words_left(words, '\0'))
                return words_failure(words, "'facet' or 'endsolid'");
            if (words_accept(words, "endsolid"))
                break;
            if (!words_accept(words, "facet"))
                return words_failure(words, "'facet' or 'endsolid'");
            CHECK(read_facet(words, weld, soup));
        }
        words_skip_line(words);
    }
    return SONJECT_OK;
}

/* Binary files may begin with "solid" too; their size tells. */
static bool is_text(const char *bytes, size_t count)
{
    if (count < 6 || memcmp(bytes, "solid", 5) != 0)
        return false;
    if (count >= HEADER_BYTES &&
        number_from_bytes((const unsigned char *)bytes + 80, 4, false) * TRIANGLE_BYTES +
                HEADER_BYTES ==
            count)
        return false;
    return memchr(bytes, '\0', count < HEADER_BYTES ? count : HEADER_BYTES) == NULL;
}

sonject_status stl_read(struct report *report, const char *path, const char *bytes, size_t count,
                        struct mesh_soup *soup)
{
    struct weld weld = {NULL, 0, 0.0};
    struct words words = {report, path, bytes, bytes + count, 1};
    const sonject_status status = is_text(bytes, count)
                                      ? read_text(&words, &weld, soup)
                                      : read_binary(report, path, bytes, count, &weld, soup);
    weld_clear(&weld);
    return status;
}
