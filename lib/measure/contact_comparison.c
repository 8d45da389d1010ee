/* Two sets of contacts, measure by measure: whether both come from one distribution. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "image/canvas.h"
#include "measure/measures.h"
#include "swath/raster_file.h"

#define MEASURES_BYTES_MAX ((size_t)1 << 28)
#define PANELS_ACROSS      4
#define PANEL_WIDTH        280 /* pixels, frame and text included */
#define PANEL_HEIGHT       190
#define PLOT_WIDTH         230 /* within the frame */
#define PLOT_HEIGHT        110

static const struct colour paper = {255, 255, 255};
static const struct colour ink = {0, 0, 0};
static const struct colour blue = {0, 90, 200}; /* the first set */
static const struct colour red = {210, 40, 20}; /* the second */

struct sample_summary {
    size_t count;
    double mean, error; /* standard error of the mean; NaN where there are too few */
};

/* Whether two sets of numbers, such as a measure of contacts, come from one distribution. */
struct sample_comparison {
    struct sample_summary first, second;
    double distance;    /* Kolmogorov-Smirnov, 0...1; NaN where a set is empty */
    double probability; /* that two sets of one distribution are at least that far apart:
                           asymptotic, with Stephens's correction for small sets */
};

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct sample_summary summarise(const double *values, size_t count)
{
    struct sample_summary summary = {count, NAN, NAN};
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    if (count > 0)
        summary.mean = sum / (double)count;
    for (size_t i = 0; i < count; i++)
        squares += (values[i] - summary.mean) * (values[i] - summary.mean);
    if (count > 1)
        summary.error = sqrt(squares / ((double)count - 1.0) / (double)count);
    return summary;
}

static double largest_distance(const double *a, size_t a_count, const double *b, size_t b_count)
{
    size_t in_a = 0;
    size_t in_b = 0;
    double largest = 0.0;
    while (in_a < a_count && in_b < b_count) {
        const double value = fmin(a[in_a], b[in_b]);
        while (in_a < a_count && a[in_a] <= value)
            in_a++;
        while (in_b < b_count && b[in_b] <= value)
            in_b++;
        largest =
            fmax(largest, fabs((double)in_a / (double)a_count - (double)in_b / (double)b_count));
    }
    return largest;
}

/* Kolmogorov's distribution, beyond an argument. */
static double kolmogorov_tail(double argument)
{
    double sum = 0.0;
    double sign = 1.0;
    if (argument < 0.2) /* 1 - 5e-13 there, and the series does not converge */
        return 1.0;
    for (int k = 1; k <= 100; k++) {
        sum += sign * exp(-2.0 * k * k * argument * argument);
        sign = -sign;
    }
    return fmin(1.0, fmax(0.0, 2.0 * sum));
}

/* Sorts both. */
static struct sample_comparison compare_samples(double *first, size_t first_count, double *second,
                                                size_t second_count)
{
    struct sample_comparison comparison;
    comparison.first = summarise(first, first_count);
    comparison.second = summarise(second, second_count);
    comparison.distance = NAN;
    comparison.probability = NAN;
    if (first_count > 0)
        qsort(first, first_count, sizeof *first, by_size);
    if (second_count > 0)
        qsort(second, second_count, sizeof *second, by_size);
    if (first_count > 0 && second_count > 0) {
        const double n = sqrt((double)first_count * (double)second_count /
                              ((double)first_count + (double)second_count));
        comparison.distance = largest_distance(first, first_count, second, second_count);
        comparison.probability = kolmogorov_tail((n + 0.12 + 0.11 / n) * comparison.distance);
    }
    return comparison;
}

/* The values of one measure in a set. */
struct sample {
    double *values; /* owned */
    size_t count;
};

struct contact_set {
    struct sample samples[COMPARED_NUMBERS];
};

static void contact_set_clear(struct contact_set *set)
{
    for (size_t i = 0; i < COMPARED_NUMBERS; i++)
        free(set->samples[i].values);
}

static bool append(struct sample *sample, double value)
{
    /* capacities are powers of 2 */
    if ((sample->count & (sample->count - 1)) == 0) {
        double *grown =
            realloc(sample->values, (sample->count > 0 ? 2 * sample->count : 1) * sizeof *grown);
        if (!grown)
            return false;
        sample->values = grown;
    }
    sample->values[sample->count++] = value;
    return true;
}

static bool take_contact(struct contact_set *set, const json_t *contact)
{
    for (size_t i = 0; i < COMPARED_NUMBERS; i++) {
        const json_t *value = json_object_get(contact, contact_numbers[i].name);
        if (json_is_number(value) && !append(&set->samples[i], json_number_value(value)))
            return false;
    }
    return true;
}

/* One text after the other. */
static sonject_status read_set(struct contact_set *set, struct report *report, const char *path)
{
    char *text = NULL;
    size_t bytes;
    size_t place = 0;
    size_t contacts_read = 0;
    sonject_status status = file_read_whole(report, path, MEASURES_BYTES_MAX, &text, &bytes);
    if (status != SONJECT_OK)
        return status == SONJECT_ERROR_STORAGE ? SONJECT_ERROR_INPUT : status;
    while (status == SONJECT_OK && place + strspn(text + place, " \t\r\n") < bytes) {
        json_error_t error;
        json_t *document = json_loadb(text + place, bytes - place, JSON_DISABLE_EOF_CHECK, &error);
        const json_t *contacts = json_object_get(document, "contacts");
        if (!json_is_array(contacts))
            status = report_failure(report, SONJECT_ERROR_INPUT,
                                    "%s: not what sonject measure prints of contacts: give its "
                                    "output",
                                    path);
        for (size_t i = 0; status == SONJECT_OK && i < json_array_size(contacts); i++) {
            contacts_read++;
            if (!take_contact(set, json_array_get(contacts, i)))
                status = report_out_of_memory(report, path);
        }
        place += document && error.position > 0 ? (size_t)error.position : bytes - place;
        json_decref(document);
    }
    free(text);
    if (status == SONJECT_OK && contacts_read == 0)
        status = report_failure(report, SONJECT_ERROR_INPUT, "%s: holds no contacts", path);
    return status;
}

static json_t *summary_document(const struct sample_summary *summary)
{
    return JSON_OBJECT({"count", json_count(summary->count)}, {"mean", json_number(summary->mean)},
                       {"standard_error", json_number(summary->error)});
}

static char *comparison_text(const struct sample_comparison *comparisons)
{
    json_t *document = json_object();
    for (size_t i = 0; i < COMPARED_NUMBERS; i++) {
        json_t *entry = JSON_OBJECT({"first", summary_document(&comparisons[i].first)},
                                    {"second", summary_document(&comparisons[i].second)},
                                    {"ks_distance", json_number(comparisons[i].distance)},
                                    {"p_value", json_number(comparisons[i].probability)});
        json_add(&document, contact_numbers[i].name, entry);
    }
    char *text = json_document_text(document, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    json_decref(document);
    return text;
}

/* The share of a sorted sample up to each column of the plot, as a curve. */
static void draw_curve(struct canvas *canvas, int64_t left, int64_t top,
                       const struct sample *sample, double low, double high, struct colour colour)
{
    size_t below = 0;
    int64_t last = top + PLOT_HEIGHT;
    for (int64_t x = 0; x < PLOT_WIDTH; x++) {
        const double value = low + (high - low) * ((double)x + 0.5) / PLOT_WIDTH;
        while (below < sample->count && sample->values[below] <= value)
            below++;
        const double share = (double)below / (double)sample->count;
        const int64_t y = top + PLOT_HEIGHT - 1 - (int64_t)(share * (PLOT_HEIGHT - 1) + 0.5);
        canvas_fill(canvas, left + x, y, 1, last > y ? last - y : 1, colour);
        last = y + 1;
    }
}

static void draw_panel(struct canvas *canvas, int64_t left, int64_t top, const char *name,
                       const struct sample *first, const struct sample *second,
                       const struct sample_comparison *comparison)
{
    char line[96];
    const double low = fmin(first->values[0], second->values[0]);
    const double high = fmax(first->values[first->count - 1], second->values[second->count - 1]);
    const double margin = high > low ? 0.03 * (high - low) : 1.0;
    draw_text(canvas, left, top + FONT_ASCENT, name, sizeof line, TEXT_RIGHTWARDS, ink);
    const int64_t plot_top = top + FONT_ASCENT + FONT_DESCENT + 4;
    canvas_frame(canvas, left, plot_top, PLOT_WIDTH, PLOT_HEIGHT, ink);
    draw_curve(canvas, left, plot_top, first, low - margin, high + margin, blue);
    draw_curve(canvas, left, plot_top, second, low - margin, high + margin, red);
    char numbers[3][20];
    snprintf(line, sizeof line, "%s...%s, p %s",
             text_of_number(numbers[0], sizeof numbers[0], low, 3),
             text_of_number(numbers[1], sizeof numbers[1], high, 3),
             text_of_number(numbers[2], sizeof numbers[2], comparison->probability, 2));
    draw_text(canvas, left, plot_top + PLOT_HEIGHT + FONT_ASCENT + 5, line, sizeof line,
              TEXT_RIGHTWARDS, ink);
}

/* Cumulative distributions of the measures that both sets have. */
static sonject_status draw(struct report *report, const struct contact_set sets[2],
                           const struct sample_comparison *comparisons, const char *path)
{
    struct canvas canvas;
    uint32_t panels = 0;
    const uint32_t lines = (COMPARED_NUMBERS + PANELS_ACROSS - 1) / PANELS_ACROSS;
    if (!canvas_create(&canvas, lines * PANEL_HEIGHT + 40, PANELS_ACROSS * PANEL_WIDTH + 20, paper))
        return report_out_of_memory(report, path);
    draw_text(&canvas, 20, 26, "first set", 96, TEXT_RIGHTWARDS, blue);
    draw_text(&canvas, 180, 26, "second set", 96, TEXT_RIGHTWARDS, red);
    for (size_t i = 0; i < COMPARED_NUMBERS; i++) {
        const struct sample *first = &sets[0].samples[i];
        const struct sample *second = &sets[1].samples[i];
        if (first->count == 0 || second->count == 0)
            continue;
        draw_panel(&canvas, 20 + (int64_t)(panels % PANELS_ACROSS) * PANEL_WIDTH,
                   40 + (int64_t)(panels / PANELS_ACROSS) * PANEL_HEIGHT, contact_numbers[i].name,
                   first, second, &comparisons[i]);
        panels++;
    }
    const struct raster_layout layout = {canvas.height, canvas.width, 3, PIXEL_UINT8};
    const sonject_status status =
        raster_file_write(report, path, &layout, NULL, NULL, 0, canvas.rgb);
    free(canvas.rgb);
    return status;
}

sonject_status compare_contact_files(struct report *report, const char *first, const char *second,
                                     const char *picture, char **text)
{
    struct contact_set sets[2];
    struct sample_comparison comparisons[COMPARED_NUMBERS];
    memset(sets, 0, sizeof sets);
    sonject_status status = read_set(&sets[0], report, first);
    THEN(status, read_set(&sets[1], report, second));
    for (size_t i = 0; status == SONJECT_OK && i < COMPARED_NUMBERS; i++)
        comparisons[i] = compare_samples(sets[0].samples[i].values, sets[0].samples[i].count,
                                         sets[1].samples[i].values, sets[1].samples[i].count);
    if (status == SONJECT_OK && picture)
        status = draw(report, sets, comparisons, picture);
    if (status == SONJECT_OK) {
        *text = comparison_text(comparisons);
        status = *text ? SONJECT_OK : report_out_of_memory(report, "the comparison");
    }
    contact_set_clear(&sets[0]);
    contact_set_clear(&sets[1]);
    return status;
}
