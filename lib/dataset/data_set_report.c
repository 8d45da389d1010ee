/* The page of statistics: counts, and histograms of what was drawn and what came of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/data_set.h"
#include "dataset/run.h"

#define BINS   24
#define BAR    12 /* pixels of the picture, as all below */
#define LEFT   12
#define WIDTH  (2 * LEFT + BINS * BAR)
#define HEIGHT 200
#define BOTTOM 160
#define TOP    34

#define SERIES_MAX  64    /* of more names, the later ones are left out of the page */
#define REASONS_MAX 10    /* that are shown */
#define IMAGES_MAX  20000 /* whose values are kept; of more, every second, third, ... is taken */

/* Values under one name, in one unit. */
struct series {
    char name[80], unit[16];
    double *values; /* owned */
    size_t count;
};

/* Numbers that images were made with, and where they may come from; as truth names both. */
static const char *const number_names[] = {"transfer", "noise_floor_db", "looks", "altitude_m",
                                           "seabed_lambert_db"};
static const uint32_t sources[] = {SONJECT_SOURCE_SCENE, SONJECT_SOURCE_CALIBRATION,
                                   SONJECT_SOURCE_PATCH, SONJECT_SOURCE_DEFAULT,
                                   SONJECT_SOURCE_FALLBACK};

struct statistics_page {
    const struct data_set *set;
    struct series series[SERIES_MAX];
    size_t series_count;
    uint64_t *counts; /* of objects: splits x classes */
    uint64_t empty[CAMPAIGN_SPLITS_MAX], clutter_alone[CAMPAIGN_SPLITS_MAX];
    const json_t *classes;
    uint64_t every; /* image that is taken */
    uint64_t drawn_anew, difficult, clipped, unseen;
    uint64_t sources[COUNT(number_names)][COUNT(sources)]; /* images */
    struct growing_text reasons; /* of the first of these, as items of a list; owned */
};

void add_escaped(struct growing_text *text, const char *raw)
{
    for (; *raw; raw++)
        if (strchr("<>&\"'", *raw))
            growing_text_add(text, "&#%d;", *raw);
        else
            growing_text_add(text, "%c", *raw);
}

static void write_histogram(struct growing_text *text, const struct series *series)
{
    size_t bins[BINS] = {0};
    size_t most = 1;
    char ends[2][40];
    double low = series->values[0];
    double high = series->values[0];
    for (size_t i = 1; i < series->count; i++) {
        low = fmin(low, series->values[i]);
        high = fmax(high, series->values[i]);
    }
    for (size_t i = 0; i < series->count; i++) {
        const double place = high > low ? (series->values[i] - low) / (high - low) * BINS : 0.0;
        const size_t bin = place < BINS ? (size_t)place : BINS - 1;
        most = ++bins[bin] > most ? bins[bin] : most;
    }
    growing_text_add(text,
                     "<svg width=\"%d\" height=\"%d\" font-size=\"12\"><text x=\"%d\" y=\"16\">",
                     WIDTH, HEIGHT, LEFT);
    add_escaped(text, series->name);
    growing_text_add(text, "%s", *series->unit ? ", " : "");
    add_escaped(text, series->unit);
    growing_text_add(text, "</text>");
    for (int i = 0; i < BINS; i++) {
        const int height = (int)lround((double)(BOTTOM - TOP) * (double)bins[i] / (double)most);
        growing_text_add(text,
                         "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#4878a8\"/>",
                         LEFT + i * BAR, BOTTOM - height, BAR - 1, height);
    }
    growing_text_add(text,
                     "<path d=\"M%d %dH%d\" stroke=\"#000\"/><text x=\"%d\" y=\"%d\">%s</text>"
                     "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%s</text>"
                     "<text x=\"%d\" y=\"%d\">%lu values, at most %lu in a bin</text></svg>\n",
                     LEFT, BOTTOM, WIDTH - LEFT, LEFT, BOTTOM + 16,
                     text_of_number(ends[0], sizeof ends[0], low, 4), WIDTH - LEFT, BOTTOM + 16,
                     text_of_number(ends[1], sizeof ends[1], high, 4), LEFT, BOTTOM + 34,
                     (unsigned long)series->count, (unsigned long)most);
}

static sonject_status add_value(struct statistics_page *page, const char *name, const char *unit,
                                double value)
{
    struct series *series = page->series;
    struct series *end = series + page->series_count;
    while (series < end && (strcmp(series->name, name) != 0 || strcmp(series->unit, unit) != 0))
        series++;
    if (series == end) {
        if (page->series_count == SERIES_MAX || strlen(name) >= sizeof series->name ||
            strlen(unit) >= sizeof series->unit)
            return SONJECT_OK;
        strcpy(series->name, name);
        strcpy(series->unit, unit);
        page->series_count++;
    }
    double *grown = grow_doubling(series->values, series->count, sizeof *grown);
    CHECK_MEMORY(page->set->report, grown, "the report");
    series->values = grown;
    series->values[series->count++] = value;
    return SONJECT_OK;
}

/* A value that was set, if it is a number with a unit: "objects[0].heading=35 deg". Those of all
 * objects count together; where a chip lies and its seed say nothing of what it shows. */
static sonject_status add_set_value(struct statistics_page *page, const char *text)
{
    char key[80];
    double value;
    const char *rest;
    const size_t length = strcspn(text, "=");
    if (length >= sizeof key || !text[length])
        return SONJECT_OK;
    memcpy(key, text, length);
    key[length] = 0;
    char *bracket = strncmp(key, "objects[", 8) == 0 ? strchr(key, ']') : NULL;
    if (bracket)
        memmove(key + 8, bracket, strlen(bracket) + 1);
    if (strncmp(key, "patch", 5) == 0 || strcmp(key, "injection.seed") == 0 ||
        !text_to_number(text + length + 1, &value, &rest))
        return SONJECT_OK;
    return add_value(page, key, rest + strspn(rest, " "), value);
}

static sonject_status add_object(struct statistics_page *page, size_t split, const json_t *object,
                                 bool is_taken)
{
    static const struct {
        const char *name, *unit, *key;
    } values[] = {{"slant range of objects", "m", "slant_range_m"},
                  {"grazing angle of objects", "deg", "grazing_deg"},
                  {"burial of objects", "m", "burial_m"},
                  {"target strength of objects", "dB", "target_strength_db"},
                  {"contrast of highlights", "dB", "highlight_contrast_db"},
                  {"contrast of shadows", "dB", "shadow_contrast_db"},
                  {"visibility of highlights", "dB", "highlight_visibility_db"},
                  {"visibility of shadows", "dB", "shadow_visibility_db"},
                  {"clipped share of highlights", "", "highlight_clipped"},
                  {"pixels of highlights", "", "highlight_pixels"},
                  {"pixels of shadows", "", "shadow_pixels"}};
    size_t i;
    const json_t *name;
    json_array_foreach(page->classes, i, name)
    {
        if (strcmp(json_string_value(name), member_text(object, "class")) == 0)
            page->counts[split * json_array_size(page->classes) + i]++;
    }
    page->unseen += json_is_false(json_object_get(object, "visible"));
    page->clipped += json_number_value(json_object_get(object, "highlight_clipped")) > CLIPPED_MUCH;
    for (i = 0; is_taken && i < COUNT(values); i++) {
        const json_t *value = json_object_get(object, values[i].key);
        if (json_is_number(value))
            CHECK(add_value(page, values[i].name, values[i].unit, json_number_value(value)));
    }
    return SONJECT_OK;
}

/* Why the image's first draw was given up, if it was. */
static void add_reason(struct statistics_page *page, uint64_t id, const json_t *record)
{
    const json_t *anew = json_object_get(record, "drawn_anew");
    if (!anew || page->drawn_anew++ >= REASONS_MAX)
        return;
    growing_text_add(&page->reasons, "<li>image %llu: ", (unsigned long long)id);
    add_escaped(&page->reasons, member_text(anew, "because"));
    growing_text_add(&page->reasons, "</li>\n");
}

static void add_sources(struct statistics_page *page, const json_t *numbers)
{
    for (size_t i = 0; i < COUNT(number_names); i++)
        for (size_t k = 0; k < COUNT(sources); k++)
            page->sources[i][k] +=
                strcmp(member_text(json_object_get(numbers, number_names[i]), "from"),
                       source_word(sources[k])) == 0;
}

static void write_sources(const struct statistics_page *page, struct growing_text *text)
{
    growing_text_add(text, "<h2>Numbers, and where they came from</h2>\n<p>Images whose number "
                           "came from the scene or campaign, from a calibration, from their part "
                           "of the swath, from nowhere (the key's default), or was taken since "
                           "that part did not tell it. A swath's own come by "
                           "input.calibration.</p>\n<table><tr><th>number</th>");
    for (size_t k = 0; k < COUNT(sources); k++)
        growing_text_add(text, "<th>%s</th>", source_word(sources[k]));
    for (size_t i = 0; i < COUNT(number_names); i++) {
        growing_text_add(text, "</tr>\n<tr><td>%s</td>", number_names[i]);
        for (size_t k = 0; k < COUNT(sources); k++)
            growing_text_add(text, "<td>%llu</td>", (unsigned long long)page->sources[i][k]);
    }
    growing_text_add(text, "</tr>\n</table>\n");
}

static sonject_status add_image(struct statistics_page *page, size_t split, uint64_t id)
{
    const struct data_set *set = page->set;
    char path[PATH_CAPACITY], name[IMAGE_NAME_CAPACITY];
    json_t *record = NULL;
    json_t *truth = NULL;
    const bool is_taken = id % page->every == 0;
    size_t i;
    const json_t *entry;
    CHECK(path_in(set->report, path, set->folder, "%s/%s", set->split_names[split],
                  image_file_name(id, OUTPUT_TRUTH, NULL, name)));
    sonject_status status = data_set_record(set, split, id, &record);
    THEN(status, json_document_read(set->report, path, &truth));
    json_array_foreach(json_object_get(record, "set"), i, entry)
    {
        if (is_taken && json_is_string(entry))
            THEN(status, add_set_value(page, json_string_value(entry)));
    }
    add_reason(page, id, record);
    json_array_foreach(json_object_get(record, "annotations"), i, entry)
    {
        page->difficult += json_is_true(json_object_get(entry, "difficult"));
    }
    add_sources(page, json_object_get(truth, "numbers"));
    const json_t *objects = json_object_get(truth, "objects");
    if (json_array_size(objects) == 0)
        page->empty[split]++;
    else if (json_is_null(json_object_get(record, "target")))
        page->clutter_alone[split]++;
    json_array_foreach(objects, i, entry)
    {
        THEN(status, add_object(page, split, entry, is_taken));
    }
    json_decref(record);
    json_decref(truth);
    return status;
}

/* ": 12 of 100 images, 0.12; asked 0.1" */
static void write_share(const struct statistics_page *page, struct growing_text *text,
                        const char *what, const uint64_t *counts, const char *asked)
{
    const struct data_set *set = page->set;
    uint64_t made = 0;
    for (size_t i = 0; i < set->split_count; i++)
        made += counts[i];
    growing_text_add(text, "<p>%s: %llu of %llu images, a share of %.4g; asked for: %.4g</p>\n",
                     what, (unsigned long long)made, (unsigned long long)set->images,
                     (double)made / (double)set->images,
                     json_number_value(json_object_get(set->head, asked)));
}

static void write_counts(const struct statistics_page *page, struct growing_text *text)
{
    const struct data_set *set = page->set;
    const size_t class_count = json_array_size(page->classes);
    write_share(page, text, "Without objects", page->empty, "empty");
    write_share(page, text, "Clutter without a target", page->clutter_alone, "clutter_alone");
    growing_text_add(text, "<table><tr><th>split</th><th>images</th><th>without objects</th>"
                           "<th>clutter alone</th>");
    for (size_t j = 0; j < class_count; j++) {
        growing_text_add(text, "<th>");
        add_escaped(text, json_string_value(json_array_get(page->classes, j)));
        growing_text_add(text, "</th>");
    }
    growing_text_add(text, "</tr>\n");
    for (size_t i = 0; i < set->split_count; i++) {
        growing_text_add(text, "<tr><td>%s</td><td>%llu</td><td>%llu</td><td>%llu</td>",
                         set->split_names[i], (unsigned long long)set->split_images[i],
                         (unsigned long long)page->empty[i],
                         (unsigned long long)page->clutter_alone[i]);
        for (size_t j = 0; j < class_count; j++)
            growing_text_add(text, "<td>%llu</td>",
                             (unsigned long long)page->counts[i * class_count + j]);
        growing_text_add(text, "</tr>\n");
    }
    growing_text_add(text, "</table>\n");
}

static void write_page(const struct statistics_page *page, struct growing_text *text)
{
    const struct data_set *set = page->set;
    size_t i;
    const json_t *swath;
    growing_text_add(text,
                     "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                     "<title>Data set</title><style>body{font-family:sans-serif;margin:2em}"
                     "table{border-collapse:collapse;margin:1em 0}svg{margin:.5em}"
                     "td,th{border:1px solid #999;padding:.2em .6em;text-align:right}"
                     "</style></head><body>\n<h1>Data set of %llu images</h1>\n<p>campaign ",
                     (unsigned long long)set->images);
    add_escaped(text, member_text(set->head, "hash"));
    growing_text_add(text, ", sonject ");
    add_escaped(text, member_text(set->head, "sonject"));
    growing_text_add(text, "</p>\n<h2>Objects by class</h2>\n");
    write_counts(page, text);
    growing_text_add(text, "<h2>Swaths</h2>\n<table><tr><th>swath</th><th>split</th></tr>\n");
    json_array_foreach(json_object_get(set->head, "swaths"), i, swath)
    {
        growing_text_add(text, "<tr><td>");
        add_escaped(text, member_text(swath, "path"));
        growing_text_add(text, "</td><td>");
        add_escaped(text, member_text(swath, "split"));
        growing_text_add(text, "</td></tr>\n");
    }
    growing_text_add(text, "</table>\n");
    write_sources(page, text);
    if (page->drawn_anew > 0)
        growing_text_add(text,
                         "<h2>Drawn anew</h2>\n<p>Of %llu images values were drawn anew, since "
                         "they did not go with each other, or an object did not fit or was not "
                         "seen.</p>\n<ul>%s"
                         "</ul>\n",
                         (unsigned long long)page->drawn_anew, page->reasons.characters);
    if (page->difficult > 0)
        growing_text_add(text,
                         "<p>%llu targets are seen less than they are to be, and marked "
                         "difficult.</p>\n",
                         (unsigned long long)page->difficult);
    if (page->unseen > 0)
        growing_text_add(text,
                         "<p>%llu objects are not seen at all: seabed, noise or others hide "
                         "them.</p>\n",
                         (unsigned long long)page->unseen);
    if (page->clipped > 0)
        growing_text_add(
            text,
            "<p>%llu objects have more than a tenth of their highlights' pixels at the "
            "image's ceiling.</p>\n",
            (unsigned long long)page->clipped);
    growing_text_add(text, "<h2>Distributions</h2>\n<div>\n");
    for (i = 0; i < page->series_count; i++)
        write_histogram(text, &page->series[i]);
    growing_text_add(text, "</div>\n<h2>Images</h2>\n<p><img src=\"contact_sheet.png\" "
                           "alt=\"images from all over the data set\"></p>\n</body></html>\n");
}

sonject_status write_report_page(const struct data_set *set)
{
    struct growing_text text = {NULL, 0, 0, false};
    char path[PATH_CAPACITY];
    struct statistics_page *page = allocate_array(1, sizeof *page);
    CHECK_MEMORY(set->report, page, "the report");
    page->set = set;
    page->every = (set->images + IMAGES_MAX - 1) / IMAGES_MAX;
    page->classes = json_object_get(set->head, "classes");
    page->counts =
        allocate_array(set->split_count, json_array_size(page->classes) * sizeof *page->counts);
    sonject_status status =
        page->counts ? SONJECT_OK : report_out_of_memory(set->report, "the report");
    for (size_t i = 0; status == SONJECT_OK && i < set->split_count; i++)
        for (uint64_t k = 0; status == SONJECT_OK && k < set->split_images[i]; k++)
            status = add_image(page, i, set->split_first[i] + k);
    if (status == SONJECT_OK && page->reasons.failed)
        status = report_out_of_memory(set->report, "the report");
    THEN(status, path_in(set->report, path, set->folder, "report.html"));
    if (status == SONJECT_OK) {
        write_page(page, &text);
        status = growing_text_write(set->report, &text, path);
    }
    for (size_t i = 0; i < page->series_count; i++)
        free(page->series[i].values);
    free(growing_text_end(&page->reasons));
    free(page->counts);
    free(page);
    return status;
}
