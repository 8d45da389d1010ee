/* Two sets of contacts, measure by measure: whether both come from one distribution. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/file.h"
#include "base/json_document.h"
#include "measure/measures.h"

#define MEASURES_BYTES_MAX ((size_t)1 << 28)

/* The values of one measure in a set. */
struct sample {
    double *values; /* owned */
    size_t count;
};

struct contact_set {
    struct sample samples[COMPARED_NUMBERS];
};

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Mean and its standard error, null where there are too few values; sorts them. */
static json_t *summarise(const struct sample *sample)
{
    double sum = 0.0;
    double squares = 0.0;
    const double count = (double)sample->count;
    for (size_t i = 0; i < sample->count; i++)
        sum += sample->values[i];
    const double mean = sum / count;
    for (size_t i = 0; i < sample->count; i++)
        squares += (sample->values[i] - mean) * (sample->values[i] - mean);
    const double error = sample->count > 1 ? sqrt(squares / (count - 1.0) / count) : NAN;
    if (sample->count > 0)
        qsort(sample->values, sample->count, sizeof *sample->values, by_size);
    return JSON_OBJECT({"count", json_count(sample->count)}, {"mean", json_number(mean)},
                       {"standard_error", json_number(error)});
}

/* Kolmogorov-Smirnov's, of sorted values: 0...1. */
static double largest_distance(const struct sample *a, const struct sample *b)
{
    size_t in_a = 0;
    size_t in_b = 0;
    double largest = 0.0;
    while (in_a < a->count && in_b < b->count) {
        const double value = fmin(a->values[in_a], b->values[in_b]);
        while (in_a < a->count && a->values[in_a] <= value)
            in_a++;
        while (in_b < b->count && b->values[in_b] <= value)
            in_b++;
        largest =
            fmax(largest, fabs((double)in_a / (double)a->count - (double)in_b / (double)b->count));
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

/* The probability that two sets of one distribution are at least that far apart is asymptotic, with
 * Stephens's correction for small sets; null where one is empty. */
static json_t *compare_samples(const struct sample *first, const struct sample *second)
{
    json_t *of_first = summarise(first);
    json_t *of_second = summarise(second);
    double distance = NAN;
    double probability = NAN;
    if (first->count > 0 && second->count > 0) {
        const double n = sqrt((double)first->count * (double)second->count /
                              ((double)first->count + (double)second->count));
        distance = largest_distance(first, second);
        probability = kolmogorov_tail((n + 0.12 + 0.11 / n) * distance);
    }
    return JSON_OBJECT({"first", of_first}, {"second", of_second},
                       {"ks_distance", json_number(distance)},
                       {"p_value", json_number(probability)});
}

static bool append(struct sample *sample, double value)
{
    double *grown = grow_doubling(sample->values, sample->count, sizeof *grown);
    if (!grown)
        return false;
    sample->values = grown;
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
            status = input_failure(report, path,
                                   "not what sonject measure prints of contacts: give its output");
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
        status = input_failure(report, path, "holds no contacts");
    return status;
}

sonject_status compare_contact_files(struct report *report, const char *first, const char *second,
                                     char **text)
{
    struct contact_set sets[2];
    memset(sets, 0, sizeof sets);
    sonject_status status = read_set(&sets[0], report, first);
    THEN(status, read_set(&sets[1], report, second));
    if (status == SONJECT_OK) {
        json_t *document = json_object();
        for (size_t i = 0; i < COMPARED_NUMBERS; i++)
            json_add(&document, contact_numbers[i].name,
                     compare_samples(&sets[0].samples[i], &sets[1].samples[i]));
        *text = json_document_text(document, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
        status = *text ? SONJECT_OK : report_out_of_memory(report, "the comparison");
        json_decref(document);
    }
    for (size_t i = 0; i < COMPARED_NUMBERS; i++) {
        free(sets[0].samples[i].values);
        free(sets[1].samples[i].values);
    }
    return status;
}
