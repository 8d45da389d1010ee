#include "image_arguments.h"

#include <stdio.h>
#include <string.h>

#include "arguments.h"
#include "console.h"

static bool parse_range_axis(const char *verb, const char *text, uint32_t *is_ground)
{
    *is_ground = strcmp(text, "ground") == 0;
    if (*is_ground || strcmp(text, "slant") == 0)
        return true;
    message(verb, ": --range-axis takes slant or ground, not \"", text, "\"");
    return false;
}

bool geometry_parse(const char *verb, const struct geometry_arguments *arguments,
                    uint32_t *is_ground, double *altitude_m, char text[IMAGE_TEXT],
                    const char **geometry)
{
    const int given = arguments->row_spacing.is_given + arguments->column_spacing.is_given +
                      arguments->first_range.is_given;
    if (arguments->range_axis && !parse_range_axis(verb, arguments->range_axis, is_ground))
        return false;
    if (arguments->altitude.is_given && !(arguments->altitude.value > 0)) {
        message(verb, ": --altitude must be above 0");
        return false;
    }
    if (given != 0 && given < 3) {
        message(verb, ": --row-spacing, --column-spacing and --first-range belong together");
        return false;
    }
    if (arguments->altitude.is_given)
        *altitude_m = arguments->altitude.value;
    if (given == 0)
        return true;
    snprintf(text, IMAGE_TEXT,
             "{row_spacing: %.17g, column_spacing: %.17g, first_slant_range: %.17g}",
             arguments->row_spacing.value, arguments->column_spacing.value,
             arguments->first_range.value);
    *geometry = text;
    return true;
}

/* Copies the piece of text up to the colon. Returns the text behind the colon, NULL at the end. */
static const char *next_piece(const char *text, char *piece, size_t capacity)
{
    size_t length = strcspn(text, ":");
    snprintf(piece, capacity, "%.*s", (int)(length < capacity ? length : capacity - 1), text);
    return text[length] == ':' ? text + length + 1 : NULL;
}

static bool is_one_of(const char *word, const char *const *words)
{
    while (*words && strcmp(word, *words) != 0)
        words++;
    return *words != NULL;
}

bool transfer_parse(const char *verb, const char *argument, char text[IMAGE_TEXT],
                    const char **transfer)
{
    static const char *const kinds[] = {"amplitude", "intensity", "decibel",
                                        "gamma",     "schlick",   NULL};
    static const char *const keys[] = {"parameter", "offset"};
    char kind[64], number[64];
    double value;
    if (!argument)
        return true;
    const char *rest = next_piece(argument, kind, sizeof(kind));
    bool is_good = is_one_of(kind, kinds);
    size_t length = (size_t)snprintf(text, IMAGE_TEXT, "{kind: %s", kind);
    for (int i = 0; i < 2 && is_good && rest; i++) {
        rest = next_piece(rest, number, sizeof(number));
        is_good = number_parse(number, &value);
        length += (size_t)snprintf(text + length, IMAGE_TEXT - length, ", %s: %.17g", keys[i],
                                   is_good ? value : 0.0);
    }
    snprintf(text + length, IMAGE_TEXT - length, "}");
    *transfer = text;
    if (is_good && !rest)
        return true;
    message(verb,
            ": --transfer takes amplitude, intensity, decibel:DB[:OFFSET], gamma:EXPONENT or "
            "schlick:B, not \"",
            argument, "\"");
    return false;
}

bool channel_check(const char *verb, const char *argument)
{
    static const char *const sides[] = {"port", "starboard", NULL};
    double number = 0.0;
    if (!argument || is_one_of(argument, sides) ||
        (number_parse(argument, &number) && number >= 0.0 && number < 64.0 &&
         number == (double)(int32_t)number))
        return true;
    message(verb, ": --channel takes port, starboard or a channel's number, not \"", argument,
            "\"");
    return false;
}

bool decibels_parse(const char *verb, const char *argument, double *minimum_db, double *maximum_db)
{
    char minimum[64];
    const char *maximum = argument ? next_piece(argument, minimum, sizeof(minimum)) : NULL;
    if (!argument || (maximum && number_parse(minimum, minimum_db) &&
                      number_parse(maximum, maximum_db) && *minimum_db < *maximum_db))
        return true;
    message(verb, ": --db takes MIN:MAX in dB, MIN below MAX, not \"", argument, "\"");
    return false;
}
