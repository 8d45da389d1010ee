/* The arrays that a file holds, as a message lists them, and the one that is wanted. */
#ifndef SONJECT_IO_ARRAY_LIST_H
#define SONJECT_IO_ARRAY_LIST_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/report.h"
#include "base/text.h"

struct array_list {
    const char *wanted; /* NULL: the only one */
    unsigned matches;   /* arrays that are wanted */
    unsigned count;
    char text[600];
};

/* Notes an array; true if it is wanted. is_image: it has several rows and columns of numbers that
 * sonject reads; others are wanted by their names alone, and not listed. */
static inline bool array_list_add(struct array_list *list, const char *name, uint64_t rows,
                                  uint64_t columns, bool is_image)
{
    char excerpt[80];
    const size_t length = strlen(list->text);
    const bool is_wanted = list->wanted ? strcmp(list->wanted, name) == 0 : is_image;
    if (is_image) {
        if (length < sizeof list->text - 140)
            snprintf(list->text + length, sizeof list->text - length, "%s%s (%llu x %llu)",
                     list->count > 0 ? ", " : "", text_excerpt(excerpt, sizeof excerpt, name),
                     (unsigned long long)rows, (unsigned long long)columns);
        else if (list->text[length - 1] != '.')
            strcat(list->text, ", ...");
        list->count++;
    }
    list->matches += is_wanted;
    return is_wanted;
}

/* INPUT unless just one array is wanted. */
static inline sonject_status array_list_check(struct report *report, const char *path,
                                              const struct array_list *list)
{
    char excerpt[80];
    if (list->matches == 1)
        return SONJECT_OK;
    if (list->count == 0 && !list->wanted)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: holds no two-dimensional array of numbers of float64, float32, "
                              "uint8, uint16 or int16, or of complex ones of float64 or float32",
                              path);
    if (list->wanted)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s array '%s'; %s%s", path,
                              list->matches > 1 ? "holds more than one" : "holds no",
                              text_excerpt(excerpt, sizeof excerpt, list->wanted),
                              list->count > 0 ? "choose one of " : "nor another image", list->text);
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: holds several arrays: say which is the image (array): %s", path,
                          list->text);
}

/* False for a finite number that is too large. */
static inline bool float_of_double(double number, float *rounded)
{
    const bool is_held = !(fabs(number) > (double)FLT_MAX) || isinf(number);
    *rounded = is_held ? (float)number : 0.0f;
    return is_held;
}

/* The same number if that is what is asked for in single precision, else the new one. */
static inline double kept_or_new(double old, float fresh)
{
    float rounded;
    const bool is_kept = float_of_double(old, &rounded) && rounded == fresh;
    return is_kept || (isnan(old) && isnan(fresh)) ? old : (double)fresh;
}

#endif
