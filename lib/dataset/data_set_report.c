/* The page of statistics: counts, and histograms of what was drawn and what came of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/data_set.h"

#define BINS   24
#define WIDTH  320
#define HEIGHT 200
#define LEFT   12
#define BOTTOM 160
#define TOP    34

#define SERIES_MAX 64
#define IMAGES_MAX 20000 /* whose values are kept; of more, every second, third, ... is taken */

/* Values under one name, in one unit. */
struct series {
    char name[80], unit[16];
    double *values; /* owned */
    size_t count, capacity;
};

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

static void add_escaped(struct growing_text *text, const char *raw)
{
    for (; *raw; raw++)
        if (strchr("<>&\"'", *raw))
            growing_text_add(text, "&#%d;", *raw);
        else
            growing_text_add(text, "%c", *raw);
}

static void draw(struct growing_text *svg, const char *name, const char *unit, const size_t *bins,
                 double low, double high, size_t count)
{
    size_t most = 1;
    const int bar = (WIDTH - 2 * LEFT) / BINS;
    const int right = LEFT + BINS * bar;
    char ends[2][40];
    for (int i = 0; i < BINS; i++)
        most = bins[i] > most ? bins[i] : most;
    growing_text_add(svg,
                     "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
                     "font-family=\"sans-serif\" font-size=\"12\"><text x=\"%d\" y=\"16\">",
                     WIDTH, HEIGHT, LEFT);
    add_escaped(svg, name);
    growing_text_add(svg, "%s", *unit ? ", " : "");
    add_escaped(svg, unit);
    growing_text_add(svg, "</text>");
    for (int i = 0; i < BINS; i++) {
        const int height = (int)lround((double)(BOTTOM - TOP) * (double)bins[i] / (double)most);
        growing_text_add(svg,
                         "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#4878a8\"/>",
                         LEFT + i * bar, BOTTOM - height, bar - 1, height);
    }
    growing_text_add(svg,
                     "<path d=\"M%d %dH%d\" stroke=\"#000\"/>"
                     "<text x=\"%d\" y=\"%d\" text-anchor=\"start\">%s</text>"
                     "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%s</text>"
                     "<text x=\"%d\" y=\"%d\">%lu values, at most %lu in a bin</text></svg>",
                     LEFT, BOTTOM, right, LEFT, BOTTOM + 16,
                     text_of_number(ends[0], sizeof ends[0], low, 4), right, BOTTOM + 16,
                     text_of_number(ends[1], sizeof ends[1], high, 4), LEFT, BOTTOM + 34,
                     (unsigned long)count, (unsigned long)most);
}

static void write_histogram(struct growing_text *text, const struct series *series)
{
    size_t bins[BINS] = {0};
    struct growing_text svg = {NULL, 0, 0, false};
    double low = series->values[0];
    double high = series->values[0];
    for (size_t i = 1; i < series->count; i++) {
        low = fmin(low, series->values[i]);
        high = fmax(high, series->values[i]);
    }
    for (size_t i = 0; i < series->count; i++) {
        const double place = high > low ? (series->values[i] - low) / (high - low) * BINS : 0.0;
        bins[place < BINS ? (int)place : BINS - 1]++;
    }
    draw(&svg, series->name, series->unit, bins, low, high, series->count);
    char *picture = growing_text_end(&svg);
    growing_text_add(text, "<img width=\"%d\" height=\"%d\" alt=\"", WIDTH, HEIGHT);
    add_escaped(text, series->name);
    growing_text_add(text, "\" src=\"data:image/svg+xml;base64,");
    if (picture)
        add_base64(text, picture);
    else
        text->failed = true;
    growing_text_add(text, "\">\n");
    free(picture);
}

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
    static const struct {
        const char *name, *unit, *key;
    } values[] = {{"slant range of objects", "m", "slant_range_m"},
                  {"grazing angle of objects", "deg", "grazing_deg"},
                  {"burial of objects", "m", "burial_m"},
                  {"target strength of objects", "dB", "target_strength_db"},
                  {"contrast of highlights", "dB", "highlight_contrast_db"},
                  {"contrast of shadows", "dB", "shadow_contrast_db"},
                  {"pixels of highlights", "", "highlight_pixels"},
                  {"pixels of shadows", "", "shadow_pixels"}};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        const json_t *value = json_object_get(object, values[i].key);
        if (json_is_number(value))
            add_value(page, values[i].name, values[i].unit, json_number_value(value));
    }
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

static void write_counts(const struct statistics_page *page, struct growing_text *text)
{
    const struct data_set *set = page->set;
    size_t j;
    const json_t *name;
    growing_text_add(text, "<table><tr><th>split</th><th>images</th><th>without objects</th>");
    json_array_foreach(json_object_get(set->head, "classes"), j, name)
    {
        growing_text_add(text, "<th>");
        add_escaped(text, json_string_value(name));
        growing_text_add(text, "</th>");
    }
    growing_text_add(text, "</tr>\n");
    for (size_t i = 0; i < set->split_count; i++) {
        growing_text_add(text, "<tr><td>%s</td><td>%llu</td><td>%llu</td>", set->split_names[i],
                         (unsigned long long)set->split_images[i],
                         (unsigned long long)page->empty[i]);
        for (j = 0; j < page->class_count; j++)
            growing_text_add(text, "<td>%llu</td>",
                             (unsigned long long)page->counts[i * page->class_count + j]);
        growing_text_add(text, "</tr>\n");
    }
    growing_text_add(text, "</table>\n");
}

static void write_page(const struct statistics_page *page, struct growing_text *text)
{
    size_t i;
    const json_t *swath;
    growing_text_add(text,
                     "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                     "<title>Data set</title><style>body{font-family:sans-serif;margin:2em}"
                     "table{border-collapse:collapse;margin:1em 0}"
                     "td,th{border:1px solid #999;padding:.2em .6em;text-align:right}"
                     "img{margin:.5em}</style></head><body>\n<h1>Data set of %llu images</h1>\n"
                     "<p>campaign ",
                     (unsigned long long)page->set->images);
    add_escaped(text, member_text(page->set->head, "hash"));
    growing_text_add(text, ", sonject ");
    add_escaped(text, member_text(page->set->head, "sonject"));
    growing_text_add(text, "</p>\n<h2>Objects by class</h2>\n");
    write_counts(page, text);
    growing_text_add(text, "<h2>Swaths</h2>\n<table><tr><th>swath</th><th>split</th></tr>\n");
    json_array_foreach(json_object_get(page->set->head, "swaths"), i, swath)
    {
        growing_text_add(text, "<tr><td>");
        add_escaped(text, member_text(swath, "path"));
        growing_text_add(text, "</td><td>");
        add_escaped(text, member_text(swath, "split"));
        growing_text_add(text, "</td></tr>\n");
    }
    growing_text_add(text, "</table>\n<h2>Distributions</h2>\n<div>\n");
    for (i = 0; i < page->series_count; i++)
        write_histogram(text, &page->series[i]);
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
