#include "swath/swath_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/text.h"

size_t stored_bytes(enum stored_type type)
{
    static const size_t bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return bytes[type];
}

static bool is_whole(enum stored_type type)
{
    return type < STORED_FLOAT32;
}

static bool is_signed(enum stored_type type)
{
    return type == STORED_INT8 || type == STORED_INT16 || type == STORED_INT32;
}

double float_from_bytes(const unsigned char *bytes, size_t count, bool is_big_endian)
{
    const uint64_t word = number_from_bytes(bytes, count, is_big_endian);
    const uint32_t half = (uint32_t)word;
    double number;
    float single;
    memcpy(&number, &word, sizeof number);
    memcpy(&single, &half, sizeof single);
    return count == sizeof single ? (double)single : number;
}

static double stored_number(bool is_big_endian, enum stored_type type, const unsigned char *bytes)
{
    const size_t size = stored_bytes(type);
    if (!is_whole(type))
        return float_from_bytes(bytes, size, is_big_endian);
    const uint64_t word = number_from_bytes(bytes, size, is_big_endian);
    const bool is_negative = is_signed(type) && word >> (8 * size - 1) != 0;
    return is_negative ? (double)word - (double)(UINT64_C(1) << (8 * size)) : (double)word;
}

/* Stores a number that the type can hold. */
static void put_number(double number, enum stored_type type, unsigned char *bytes,
                       bool is_big_endian)
{
    uint64_t word = is_whole(type) ? (uint64_t)(int64_t)number : 0;
    const float single = type == STORED_FLOAT32 ? (float)number : 0.0f;
    uint32_t half;
    memcpy(&half, &single, sizeof half);
    if (type == STORED_FLOAT64)
        memcpy(&word, &number, sizeof number);
    number_to_bytes(type == STORED_FLOAT32 ? half : word, bytes, stored_bytes(type), is_big_endian);
}

void samples_convert(enum stored_type from_type, const unsigned char *from, enum stored_type type,
                     unsigned char *to, bool is_big_endian)
{
    put_number(stored_number(is_big_endian, from_type, from), type, to, is_big_endian);
}

/* Returns the largest number of an integer type that a file may hold. */
static double largest_of(const struct stored_samples *stored, enum stored_type type)
{
    const double full = (double)(UINT64_C(1) << (8 * stored_bytes(type) - is_signed(type))) - 1.0;
    return stored->largest > 0 ? (double)stored->largest : full;
}

static double scale_of(const struct stored_samples *stored)
{
    return stored->scale > 0.0 ? stored->scale : 1.0;
}

/* Stores a number. A stored number that already reads as the new one keeps its bits. Returns false
 * if the file cannot hold the new number. */
static bool store(const struct stored_samples *stored, enum stored_type type, double number,
                  unsigned char *bytes)
{
    const double old = stored_number(stored->is_big_endian, type, bytes);
    const double most = is_whole(type) ? largest_of(stored, type) : 0.0;
    const double least = stored->are_amplitudes ? 0.0 : -most;
    float single;
    if ((pixel_store(PIXEL_FLOAT32, &single, 0, scale_of(stored) * old) &&
         (double)single == number) ||
        (isnan(old) && isnan(number)))
        return !is_whole(type) || old <= most;
    number /= scale_of(stored);
    if (is_whole(type) && stored->clips && !isnan(number)) {
        if (stored->clipped)
            *stored->clipped += number < least - 0.5 || number > most + 0.5; /* not just rounded */
        number = fmin(fmax(number, least), most);
    }
    if (is_whole(type) && !(number >= least && number <= (double)(float)most))
        return false;
    put_number(is_whole(type) ? fmin(floor(number + 0.5), most) : number, type, bytes,
               stored->is_big_endian);
    return true;
}

/* Copies a float32 bit by bit, NaN included; only the byte order may change. */
static void exchange_floats(const struct stored_samples *stored, bool writes, unsigned char *bytes,
                            unsigned char *shown)
{
    uint32_t word;
    if (writes) {
        memcpy(&word, shown, sizeof word);
        number_to_bytes(word, bytes, sizeof word, stored->is_big_endian);
    } else {
        word = (uint32_t)number_from_bytes(bytes, sizeof word, stored->is_big_endian);
        memcpy(shown, &word, sizeof word);
    }
}

/* Returns whether float32 would round a number that must stay exact. */
static bool is_rounded(const struct stored_samples *stored, enum stored_type type, double number)
{
    return stored->is_exact && is_whole(type) && (double)(float)number != number;
}

static bool exchange(const struct stored_samples *stored, uint32_t channel, enum pixel_type type,
                     bool writes, unsigned char *bytes, unsigned char *shown)
{
    const enum stored_type from = stored->types[channel];
    if (from == STORED_FLOAT32 && type == PIXEL_FLOAT32) {
        exchange_floats(stored, writes, bytes, shown);
        return true;
    }
    if (writes)
        return store(stored, from, pixel_number(type, shown, 0), bytes);
    const double number = scale_of(stored) * stored_number(stored->is_big_endian, from, bytes);
    return !(stored->are_amplitudes && is_whole(from) && number < 0.0) &&
           !is_rounded(stored, from, number) && pixel_store(type, shown, 0, number);
}

static sonject_status refuse_sample(struct report *report, const char *path,
                                    const struct stored_samples *stored, enum stored_type type,
                                    uint64_t row, uint64_t column, double number, bool writes)
{
    char why[80] = "beyond what float32 holds: scale the array";
    if (!writes && is_rounded(stored, type, number))
        snprintf(why, sizeof why, "%.0f, which float32 would round: scale the array", number);
    else if (!writes && is_whole(type))
        snprintf(why, sizeof why, "more than its array's type holds");
    if (writes && isnan(number))
        snprintf(why, sizeof why, "not a number, which the file cannot hold");
    else if (writes)
        snprintf(why, sizeof why, "%.9g, more than the file's largest number of %.10g", number,
                 largest_of(stored, type));
    else if (number < 0.0 && is_whole(type))
        snprintf(why, sizeof why, "negative: sonject reads magnitudes, so convert the file first");
    return input_failure(report, path, "the sample at row %llu, column %llu is %s",
                         (unsigned long long)row, (unsigned long long)column, why);
}

sonject_status samples_exchange(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct stored_samples *stored, const struct region *part,
                                const struct region *region, void *pixels, bool writes)
{
    const size_t size = pixel_bytes(layout->type);
    for (uint64_t i = 0; i < part->rows; i++) {
        const size_t first = (size_t)((part->first_row - region->first_row + i) * region->columns +
                                      (part->first_column - region->first_column));
        unsigned char *shown = (unsigned char *)pixels + first * layout->channels * size;
        ptrdiff_t step = (ptrdiff_t)i * stored->row_step;
        for (uint64_t j = 0; j < part->columns; j++, step += stored->column_step)
            for (uint32_t k = 0; k < layout->channels; k++, shown += size) {
                const enum stored_type type = stored->types[k];
                unsigned char *at = stored->bytes[k] + step * (ptrdiff_t)stored_bytes(type);
                if (!exchange(stored, k, layout->type, writes, at, shown))
                    return refuse_sample(report, path, stored, type, part->first_row + i,
                                         part->first_column + j,
                                         writes ? pixel_number(layout->type, shown, 0)
                                                : stored_number(stored->is_big_endian, type, at),
                                         writes);
            }
    }
    return SONJECT_OK;
}

bool array_list_add(struct array_list *list, const char *name, uint64_t rows, uint64_t columns,
                    bool may_be_image)
{
    char excerpt[80];
    char size[48] = "cannot be read";
    const size_t length = strlen(list->text);
    const bool is_wanted = list->wanted ? strcmp(list->wanted, name) == 0 : may_be_image;
    if (rows > 0)
        snprintf(size, sizeof size, "%llu x %llu", (unsigned long long)rows,
                 (unsigned long long)columns);
    if (may_be_image) {
        if (length < sizeof list->text - 140)
            snprintf(list->text + length, sizeof list->text - length, "%s%s (%s)",
                     list->count > 0 ? ", " : "", text_excerpt(excerpt, sizeof excerpt, name),
                     size);
        else if (list->text[length - 1] != '.')
            strcat(list->text, ", ...");
        list->count++;
    }
    list->matches += is_wanted;
    return is_wanted;
}

sonject_status array_list_check(struct report *report, const char *path,
                                const struct array_list *list)
{
    char excerpt[80];
    if (list->matches == 1)
        return SONJECT_OK;
    if (list->count == 0 && !list->wanted)
        return input_failure(report, path,
                             "holds no two-dimensional array of numbers of float64, float32, "
                             "uint8, uint16 or int16, or of complex ones of float64 or float32");
    if (list->wanted)
        return input_failure(report, path, "%s array '%s'; %s%s",
                             list->matches > 1 ? "holds more than one" : "holds no",
                             text_excerpt(excerpt, sizeof excerpt, list->wanted),
                             list->count > 0 ? "choose one of " : "nor another image", list->text);
    return input_failure(
        report, path,
        "holds several arrays: choose one by its key array (input.array) or --array: %s",
        list->text);
}
