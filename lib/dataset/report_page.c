/* report.html, the page of a run or of a data set. The page is one file, which needs no server. A
 * JSON document in the page has the data, and a script makes tables and pictures of the data. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/run.h"

sonject_status report_page_write(struct report *report, json_t *data, size_t digits,
                                 const char *path)
{
    static const char mark[] = "@DATA@";
    const char *place = strstr(report_page, mark);
    struct growing_text text = {NULL, 0, 0, false};
    char *json = json_document_text(data, JSON_COMPACT | JSON_REAL_PRECISION(digits));
    json_decref(data);
    CHECK_MEMORY(report, json, path);
    growing_text_add(&text, "%.*s", (int)(place - report_page), report_page);
    for (const char *from = json; *from;) { /* "<" in a name must not end the script element */
        const size_t length = strcspn(from, "<");
        growing_text_add(&text, "%.*s%s", (int)length, from, from[length] ? "\\u003c" : "");
        from += length + (from[length] != '\0');
    }
    growing_text_add(&text, "%s", place + strlen(mark));
    free(json);
    return growing_text_write(report, &text, path);
}

json_t *histogram_counts(const double *values, size_t count, double low, double high)
{
    uint64_t bins[HISTOGRAM_BINS] = {0};
    for (size_t i = 0; i < count; i++) {
        const double place = high > low ? (values[i] - low) / (high - low) * HISTOGRAM_BINS : 0.0;
        bins[(size_t)fmin(fmax(place, 0.0), HISTOGRAM_BINS - 1)]++;
    }
    return json_counts(bins, HISTOGRAM_BINS);
}

/* Returns the name of a material, or null for one with numbers of its own. */
static json_t *material_document(const sonject_material_params *material)
{
    const size_t first = offsetof(sonject_material_params, reflection);
    const char *name;
    for (uint32_t i = 0; (name = material_name(i)) != NULL; i++) {
        sonject_material_params named = *material;
        if (material_named(name, &named) && named.reflection_kind == material->reflection_kind &&
            memcmp((const char *)&named + first, (const char *)material + first,
                   sizeof named - first) == 0)
            return json_string(name);
    }
    return json_null();
}

sonject_status write_run_page(struct report *report, struct run_facts *facts, const char *path)
{
    size_t i;
    const json_t *file;
    json_t *materials = json_array();
    json_t *files = json_array();
    for (uint32_t k = 0; k < facts->result->object_count; k++)
        json_append(&materials, material_document(&facts->scene->objects[k].material));
    json_array_foreach(facts->files, i, file)
    {
        json_append(&files, json_incref(json_object_get(file, "name")));
    }
    json_t *data = facts->page;
    facts->page = NULL;
    json_add(&data, "sonject", json_string(sonject_version()));
    json_add(&data, "swath",
             json_counts(
                 (const uint64_t[]){facts->swath->layout.rows, facts->swath->layout.columns}, 2));
    json_add(&data, "materials", materials);
    json_add(&data, "files", files);
    json_add(&data, "truth", truth_document(facts));
    return report_page_write(report, data, TRUTH_DIGITS, path);
}
