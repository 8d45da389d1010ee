/* The page of statistics: counts, and histograms of what was drawn and what came of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/growing_text.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/campaign_documents.h"

#define BINS   24
#define WIDTH  320
#define HEIGHT 200
#define LEFT   12
#define BOTTOM 160
#define TOP    34

static void add_base64(struct growing_text *text, const char *bytes)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const size_t count = strlen(bytes);
    for (size_t i = 0; i < count; i += 3) {
        unsigned long bits = 0;
        for (size_t j = 0; j < 3; j++)
            bits = bits << 8 | (i + j < count ? (unsigned char)bytes[i + j] : 0u);
        for (size_t j = 0; j < 4; j++)
            if (i + j <= count)
                growing_text_add(text, "%c", digits[bits >> (18 - 6 * j) & 63]);
            else
                growing_text_add(text, "=");
    }
}

/* Keys are plain words; what is not is left out. */
static void add_plain(struct growing_text *svg, const char *words)
{
    for (; *words; words++)
        if (!strchr("<>&\"'", *words))
            growing_text_add(svg, "%c", *words);
}

static void add_label(struct growing_text *svg, int x, const char *anchor, double value)
{
    char number[40];
    growing_text_add(svg, "<text x=\"%d\" y=\"%d\" text-anchor=\"%s\">%s</text>", x, BOTTOM + 16,
                     anchor, text_of_number(number, sizeof number, value, 4));
}

static void draw(struct growing_text *svg, const char *name, const char *unit, const size_t *bins,
                 double low, double high, size_t count)
{
    size_t most = 1;
    const int bar = (WIDTH - 2 * LEFT) / BINS;
    for (int i = 0; i < BINS; i++)
        most = bins[i] > most ? bins[i] : most;
    growing_text_add(svg,
                     "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
                     "font-family=\"sans-serif\" font-size=\"12\"><text x=\"%d\" y=\"16\">",
                     WIDTH, HEIGHT, LEFT);
    add_plain(svg, name);
    growing_text_add(svg, "%s", *unit ? ", " : "");
    add_plain(svg, unit);
    growing_text_add(svg, "</text>");
    for (int i = 0; i < BINS; i++) {
        const int height = (int)lround((double)(BOTTOM - TOP) * (double)bins[i] / (double)most);
        growing_text_add(svg,
                         "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#4878a8\"/>",
                         LEFT + i * bar, BOTTOM - height, bar - 1, height);
    }
    growing_text_add(svg, "<path d=\"M%d %dH%d\" stroke=\"#000\"/>", LEFT, BOTTOM,
                     LEFT + BINS * bar);
    add_label(svg, LEFT, "start", low);
    add_label(svg, LEFT + BINS * bar, "end", high);
    growing_text_add(svg, "<text x=\"%d\" y=\"%d\">%lu values, at most %lu in a bin</text></svg>",
                     LEFT, BOTTOM + 34, (unsigned long)count, (unsigned long)most);
}

static void histogram_write(struct growing_text *text, const char *name, const char *unit,
                            const double *values, size_t count)
{
    size_t bins[BINS] = {0};
    struct growing_text svg = {NULL, 0, 0, false};
    if (count == 0)
        return;
    double low = values[0];
    double high = values[0];
    for (size_t i = 1; i < count; i++) {
        low = fmin(low, values[i]);
        high = fmax(high, values[i]);
    }
    for (size_t i = 0; i < count; i++) {
        const double place = high > low ? (values[i] - low) / (high - low) * BINS : 0.0;
        bins[place < BINS ? (int)place : BINS - 1]++;
    }
    draw(&svg, name, unit, bins, low, high, count);
    char *picture = growing_text_end(&svg);
    growing_text_add(text, "<img width=\"%d\" height=\"%d\" alt=\"", WIDTH, HEIGHT);
    add_plain(text, name);
    growing_text_add(text, "\" src=\"data:image/svg+xml;base64,");
    if (picture)
        add_base64(text, picture);
    else
        text->failed = true;
    growing_text_add(text, "\">\n");
    free(picture);
}

#define SERIES_MAX 64
#define IMAGES_MAX 20000 /* whose values are kept; of more, every second, third, ... is taken */

/* Values under one name, in one unit. */
struct series {
    char name[80], unit[16];
    double *values; /* owned */
    size_t count, capacity;
};

struct statistics_page {
    const struct data_set *set;
    struct series series[SERIES_MAX];
    size_t series_count;
    uint64_t *counts; /* of objects: splits x classes */
    uint64_t empty[CAMPAIGN_SPLITS_MAX];
    size_t class_count;
    uint64_t every; /* image that is taken */
    bool lacks_memory;
};

static struct series *series_named(struct statistics_page *page, const char *name, const char *unit)
{
    for (size_t i = 0; i < page->series_count; i++)
        if (strcmp(page->series[i].name, name) == 0 && strcmp(page->series[i].unit, unit) == 0)
            return &page->series[i];
    if (page->series_count == SERIES_MAX || strlen(name) >= sizeof page->series[0].name ||
        strlen(unit) >= sizeof page->series[0].unit)
        return NULL;
    struct series *series = &page->series[page->series_count++];
    strcpy(series->name, name);
    strcpy(series->unit, unit);
    return series;
}

/* Of more names than there is room for, the later ones are left out of the page. */
static void add_value(struct statistics_page *page, const char *name, const char *unit,
                      double value)
{
    struct series *series = isfinite(value) ? series_named(page, name, unit) : NULL;
    if (!series)
        return;
    if (series->count == series->capacity) {
        const size_t capacity = series->capacity ? 2 * series->capacity : 256;
        double *grown = realloc(series->values, capacity * sizeof *grown);
        if (!grown) {
            page->lacks_memory = true;
            return;
        }
        series->values = grown;
        series->capacity = capacity;
    }
    series->values[series->count++] = value;
}

static bool is_placed(const char *key)
{
    return strcmp(key, "patch") == 0 || strcmp(key, "injection.seed") == 0 ||
           strcmp(key, "objects") == 0;
}

/* A value that was set, if it is a number with a unit: "objects[0].heading=35 deg". */
static void add_set_value(struct statistics_page *page, const char *text)
{
    char key[80];
    double value;
    const char *rest;
    const size_t length = strcspn(text, "=");
    if (length >= sizeof key || !text[length])
        return;
    memcpy(key, text, length);
    key[length] = 0;
    char *bracket = strncmp(key, "objects[", 8) == 0 ? strchr(key, ']') : NULL;
    if (bracket)
        memmove(key + 8, bracket, strlen(bracket) + 1); /* of all objects together */
    if (is_placed(key) || !text_to_number(text + length + 1, &value, &rest))
        return;
    while (*rest == ' ')
        rest++;
    add_value(page, key, rest, value);
}

/* A number, NAN if there is none. */
static double member_number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

static void count_object(struct statistics_page *page, size_t split, const json_t *object)
{
    size_t i;
    const json_t *name;
    json_array_foreach(json_object_get(page->set->head, "classes"), i, name)
    {
        if (strcmp(json_string_value(name), member_text(object, "class")) == 0)
            page->counts[split * page->class_count + i]++;
    }
}

static void add_object(struct statistics_page *page, const json_t *object)
{
    add_value(page, "slant range of objects", "m", member_number(object, "slant_range_m"));
    add_value(page, "grazing angle of objects", "deg", member_number(object, "grazing_deg"));
    add_value(page, "burial of objects", "m", member_number(object, "burial_m"));
    add_value(page, "target strength of objects", "dB",
              member_number(object, "target_strength_db"));
    add_value(page, "contrast of highlights", "dB", member_number(object, "highlight_contrast_db"));
    add_value(page, "contrast of shadows", "dB", member_number(object, "shadow_contrast_db"));
    add_value(page, "pixels of highlights", "", member_number(object, "highlight_pixels"));
    add_value(page, "pixels of shadows", "", member_number(object, "shadow_pixels"));
}

static sonject_status add_image(struct statistics_page *page, size_t split, uint64_t id)
{
    json_t *record, *truth;
    size_t i;
    const json_t *entry;
    const bool is_taken = id % page->every == 0;
    CHECK(data_set_image(page->set, split, id, &record, &truth, NULL));
    json_array_foreach(json_object_get(record, "set"), i, entry)
    {
        if (is_taken)
            add_set_value(page, json_string_value(entry));
    }
    const json_t *objects = json_object_get(truth, "objects");
    page->empty[split] += json_array_size(objects) == 0;
    json_array_foreach(objects, i, entry)
    {
        count_object(page, split, entry);
        if (is_taken)
            add_object(page, entry);
    }
    json_decref(record);
    json_decref(truth);
    return SONJECT_OK;
}

static void add_escaped(struct growing_text *text, const char *raw)
{
    for (; *raw; raw++)
        if (strchr("<>&\"'", *raw))
            growing_text_add(text, "&#%d;", *raw);
        else
            growing_text_add(text, "%c", *raw);
}

static void write_counts(const struct statistics_page *page, struct growing_text *text)
{
    const struct data_set *set = page->set;
    const json_t *classes = json_object_get(set->head, "classes");
    growing_text_add(text, "<table><tr><th>split</th><th>images</th><th>without objects</th>");
    for (size_t j = 0; j < page->class_count; j++) {
        growing_text_add(text, "<th>");
        add_escaped(text, json_string_value(json_array_get(classes, j)));
        growing_text_add(text, "</th>");
    }
    growing_text_add(text, "</tr>\n");
    for (size_t i = 0; i < set->split_count; i++) {
        growing_text_add(text, "<tr><td>%s</td><td>%llu</td><td>%llu</td>", set->split_names[i],
                         (unsigned long long)set->split_images[i],
                         (unsigned long long)page->empty[i]);
        for (size_t j = 0; j < page->class_count; j++)
            growing_text_add(text, "<td>%llu</td>",
                             (unsigned long long)page->counts[i * page->class_count + j]);
        growing_text_add(text, "</tr>\n");
    }
    growing_text_add(text, "</table>\n");
}

static void write_swaths(const struct statistics_page *page, struct growing_text *text)
{
    size_t i;
    const json_t *swath;
    growing_text_add(text, "<table><tr><th>swath</th><th>split</th></tr>\n");
    json_array_foreach(json_object_get(page->set->head, "swaths"), i, swath)
    {
        growing_text_add(text, "<tr><td>");
        add_escaped(text, member_text(swath, "path"));
        growing_text_add(text, "</td><td>");
        add_escaped(text, member_text(swath, "split"));
        growing_text_add(text, "</td></tr>\n");
    }
    growing_text_add(text, "</table>\n");
}

static void write_page(const struct statistics_page *page, struct growing_text *text)
{
    growing_text_add(text,
                     "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                     "<title>Data set</title><style>body{font-family:sans-serif;margin:2em}"
                     "table{border-collapse:collapse;margin:1em 0}"
                     "td,th{border:1px solid #999;padding:.2em .6em;text-align:right}"
                     "img{margin:.5em}</style></head><body>\n<h1>Data set of %llu images</h1>\n",
                     (unsigned long long)page->set->images);
    growing_text_add(text, "<p>campaign ");
    add_escaped(text, member_text(page->set->head, "hash"));
    growing_text_add(text, ", sonject ");
    add_escaped(text, member_text(page->set->head, "sonject"));
    growing_text_add(text, "</p>\n<h2>Objects by class</h2>\n");
    write_counts(page, text);
    growing_text_add(text, "<h2>Swaths</h2>\n");
    write_swaths(page, text);
    growing_text_add(text, "<h2>Distributions</h2>\n<div>\n");
    for (size_t i = 0; i < page->series_count; i++) {
        const struct series *series = &page->series[i];
        histogram_write(text, series->name, series->unit, series->values, series->count);
    }
    growing_text_add(text, "</div>\n<h2>Images</h2>\n<p><img src=\"contact_sheet.png\" "
                           "alt=\"images from all over the data set\"></p>\n</body></html>\n");
}

static sonject_status gather(struct statistics_page *page)
{
    const struct data_set *set = page->set;
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < set->split_count; i++)
        for (uint64_t k = 0; status == SONJECT_OK && k < set->split_images[i]; k++)
            status = add_image(page, i, set->split_first[i] + k);
    return status == SONJECT_OK && page->lacks_memory
               ? report_out_of_memory(set->report, "the report")
               : status;
}

sonject_status write_report_page(const struct data_set *set)
{
    struct growing_text text = {NULL, 0, 0, false};
    char *path = path_join(set->folder, "report.html");
    struct statistics_page *page = allocate_array(1, sizeof *page);
    sonject_status status = SONJECT_OK;
    if (page) {
        page->set = set;
        page->every = (set->images + IMAGES_MAX - 1) / IMAGES_MAX;
        page->class_count = json_array_size(json_object_get(set->head, "classes"));
        page->counts = allocate_array(set->split_count, page->class_count * sizeof *page->counts);
    }
    if (!path || !page || !page->counts)
        status = report_out_of_memory(set->report, "the report");
    THEN(status, gather(page));
    if (status == SONJECT_OK) {
        write_page(page, &text);
        status = growing_text_write(set->report, &text, path);
    }
    for (size_t i = 0; page && i < page->series_count; i++)
        free(page->series[i].values);
    if (page)
        free(page->counts);
    free(page);
    free(path);
    return status;
}
