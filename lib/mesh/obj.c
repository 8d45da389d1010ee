#include "mesh/mesh_reader.h"
#include "mesh/words.h"

static sonject_status read_vertex(struct words *words, struct mesh_soup *soup)
{
    double position[3];
    for (int axis = 0; axis < 3; axis++) {
        CHECK(words_number(words, "a finite coordinate", &position[axis]));
    }
    /* a weight or a colour may follow */
    return mesh_soup_add_vertex(soup, position)
               ? SONJECT_OK
               : mesh_soup_failure(words->report, words->path, soup);
}

/* "7", "7/1", "7//3" or "7/1/3", of which the vertex counts; negative numbers count back from the
 * last vertex so far. */
static sonject_status read_corner(struct words *words, const struct mesh_soup *soup,
                                  uint32_t *corner)
{
    const char *start = words->at;
    int64_t number;
    CHECK(words_whole(words, "the number of a vertex", &number));
    while (words->at < words->end &&
           (*words->at == '/' || *words->at == '-' || (*words->at >= '0' && *words->at <= '9')))
        words->at++;
    const int64_t vertices = (int64_t)soup->vertices;
    if (number == 0 || number > vertices || number < -vertices) {
        words->at = start;
        return report_failure(words->report, SONJECT_ERROR_INPUT,
                              "%s, line %zu: a face has vertex %lld, but %lld are there so far",
                              words->path, words->line, (long long)number, (long long)vertices);
    }
    *corner = (uint32_t)(number > 0 ? number - 1 : vertices + number);
    return SONJECT_OK;
}

static sonject_status read_face(struct words *words, struct mesh_soup *soup)
{
    size_t corners = 0;
    uint32_t fan[2];
    while (words_on_line(words) && *words->at != '#') {
        uint32_t corner = 0;
        CHECK(read_corner(words, soup, &corner));
        if (!mesh_soup_add_polygon_corner(soup, corners++, corner, fan))
            return mesh_soup_failure(words->report, words->path, soup);
    }
    return corners >= 3 ? SONJECT_OK : words_failure(words, "three vertices or more of a face");
}

sonject_status obj_read(struct report *report, const char *path, const char *bytes, size_t count,
                        struct mesh_soup *soup)
{
    struct words words = {report, path, bytes, bytes + count, 1};
    while (words_left(&words, '#')) {
        sonject_status status = SONJECT_OK;
        if (words_accept(&words, "v"))
            status = read_vertex(&words, soup);
        else if (words_accept(&words, "f"))
            status = read_face(&words, soup);
        if (status != SONJECT_OK)
            return status;
        words_skip_line(&words);
    }
    return SONJECT_OK;
}
