#include "arguments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "console.h"

/* The names of values that have units. Other numbers have none. */
static const struct {
    const char *value;
    enum quantity quantity;
} quantities[] = {{"M", QUANTITY_LENGTH},
                  {"HZ", QUANTITY_FREQUENCY},
                  {"DEG", QUANTITY_ANGLE},
                  {"DB", QUANTITY_DECIBEL},
                  {"SECONDS", QUANTITY_TIME}};

bool number_parse(const char *text, double *value)
{
    const char *rest;
    return text_to_number(text, value, &rest) && !*rest && isfinite(*value);
}

static void *member(void *options, size_t offset)
{
    return (char *)options + offset;
}

/* Returns the option that text names, up to its end or a '='; NULL if there is none. */
static const struct argument *find_argument(const struct verb *verb, const char *text)
{
    size_t length = strcspn(text, "=");
    for (size_t i = 0; i < verb->argument_count; i++) {
        const struct argument *argument = &verb->arguments[i];
        if (strlen(argument->name) == length && strncmp(argument->name, text, length) == 0)
            return argument;
        if (argument->short_name && strcmp(argument->short_name, text) == 0)
            return argument;
    }
    return NULL;
}

static bool refuse_unknown(const struct verb *verb, const char *text)
{
    char name[64];
    snprintf(name, sizeof(name), "%.*s", (int)strcspn(text, "="), text);
    struct nearest nearest;
    nearest_begin(&nearest, name);
    for (size_t i = 0; i < verb->argument_count; i++)
        nearest_consider(&nearest, verb->arguments[i].name);
    if (nearest.best)
        message(verb->name, ": there is no option ", name, "; did you mean ", nearest.best, "?");
    else
        message(verb->name, ": there is no option ", name, "; see sonject help ", verb->name);
    return false;
}

static bool refuse_repeated(const struct verb *verb, const struct argument *argument)
{
    message(verb->name, ": ", argument->name, " is given twice");
    return false;
}

static bool add_text(struct text_list *list, const char *value)
{
    const char **grown = realloc(list->texts, (list->count + 1) * sizeof(*grown));
    if (!grown) {
        message("out of memory");
        return false;
    }
    list->texts = grown;
    list->texts[list->count++] = value;
    return true;
}

static bool set_number(const struct verb *verb, const struct argument *argument, const char *text,
                       struct number_argument *number)
{
    if (number->is_given)
        return refuse_repeated(verb, argument);
    enum quantity quantity = QUANTITY_NUMBER;
    for (size_t i = 0; i < sizeof(quantities) / sizeof(quantities[0]); i++)
        if (strcmp(quantities[i].value, argument->value) == 0)
            quantity = quantities[i].quantity;
    char problem[160] = "must be finite";
    if (!quantity_from_text(quantity, text, &number->value, problem, sizeof(problem)) ||
        !isfinite(number->value)) {
        message(verb->name, ": ", argument->name, " \"", text, "\": ", problem);
        return false;
    }
    number->is_given = true;
    return true;
}

static bool set_whole(const struct verb *verb, const struct argument *argument, const char *text,
                      struct whole_argument *number)
{
    if (number->is_given)
        return refuse_repeated(verb, argument);
    if (!text_to_count(text, &number->value)) {
        message(verb->name, ": ", argument->name,
                " takes a whole number from 0 to 2^64 - 1, not \"", text, "\"");
        return false;
    }
    number->is_given = true;
    return true;
}

static bool set_text(const struct verb *verb, const struct argument *argument, const char *text,
                     const char **value)
{
    if (*value)
        return refuse_repeated(verb, argument);
    if (text[0] == '\0') {
        message(verb->name, ": ", argument->name, " must not be empty");
        return false;
    }
    *value = text;
    return true;
}

static bool set_value(const struct verb *verb, const struct argument *argument, const char *text,
                      void *options)
{
    void *target = member(options, argument->offset);
    switch (argument->kind) {
    case ARGUMENT_FLAG:
        *(bool *)target = true;
        return true;
    case ARGUMENT_TEXT:
        return set_text(verb, argument, text, target);
    case ARGUMENT_TEXTS:
        return add_text(target, text);
    case ARGUMENT_NUMBER:
        return set_number(verb, argument, text, target);
    case ARGUMENT_WHOLE:
        return set_whole(verb, argument, text, target);
    }
    return false;
}

/* Reads the option at texts[*next] with its value, and moves *next behind them. */
static bool parse_option(const struct verb *verb, int count, char **texts, int *next, void *options)
{
    const char *text = texts[(*next)++];
    const struct argument *argument = find_argument(verb, text);
    if (!argument)
        return refuse_unknown(verb, text);
    const char *equals = strchr(text, '=');
    if (argument->kind == ARGUMENT_FLAG) {
        if (equals) {
            message(verb->name, ": ", argument->name, " takes no value");
            return false;
        }
        return set_value(verb, argument, "", options);
    }
    if (equals)
        return set_value(verb, argument, equals + 1, options);
    if (*next == count || strncmp(texts[*next], "--", 2) == 0) {
        message(verb->name, ": ", argument->name, " needs a value: ", argument->value);
        return false;
    }
    return set_value(verb, argument, texts[(*next)++], options);
}

static bool take_operand(const struct verb *verb, const char *text, void *options)
{
    if (!verb->operand) {
        message(verb->name, ": what is \"", text, "\"? This verb takes only options");
        return false;
    }
    const char **operand = member(options, verb->operand_offset);
    if (*operand && verb->second_operand && !*(const char **)member(options, verb->second_offset))
        operand = member(options, verb->second_offset);
    if (*operand && verb->second_operand) {
        message(verb->name, ": takes ", verb->operand, " and ", verb->second_operand,
                "; what is \"", text, "\"?");
        return false;
    }
    if (*operand) {
        message(verb->name, ": takes one ", verb->operand, ", not both \"", *operand, "\" and \"",
                text, "\"");
        return false;
    }
    if (text[0] == '\0') {
        message(verb->name, ": ", verb->operand, " must not be empty");
        return false;
    }
    *operand = text;
    return true;
}

static bool check_presence(const struct verb *verb, void *options)
{
    if (verb->operand && !*(const char **)member(options, verb->operand_offset)) {
        message(verb->name, ": ", verb->operand, " is missing; see sonject help ", verb->name);
        return false;
    }
    if (verb->second_operand && !*(const char **)member(options, verb->second_offset)) {
        message(verb->name, ": ", verb->second_operand, " is missing; see sonject help ",
                verb->name);
        return false;
    }
    for (size_t i = 0; i < verb->argument_count; i++) {
        const struct argument *argument = &verb->arguments[i];
        if (argument->is_required && !*(const char **)member(options, argument->offset)) {
            message(verb->name, ": ", argument->short_name ? argument->short_name : argument->name,
                    " ", argument->value, " is missing; see sonject help ", verb->name);
            return false;
        }
    }
    return true;
}

bool arguments_parse(const struct verb *verb, int count, char **texts, void *options)
{
    bool only_operands = false;
    for (int next = 0; next < count;) {
        const char *text = texts[next];
        if (!only_operands && strcmp(text, "--") == 0) {
            only_operands = true;
            next++;
        } else if (!only_operands && text[0] == '-' && text[1] != '\0') {
            if (!parse_option(verb, count, texts, &next, options))
                return false;
        } else {
            if (!take_operand(verb, text, options))
                return false;
            next++;
        }
    }
    return check_presence(verb, options);
}

void arguments_release(const struct verb *verb, void *options)
{
    for (size_t i = 0; i < verb->argument_count; i++) {
        if (verb->arguments[i].kind == ARGUMENT_TEXTS) {
            struct text_list *list = member(options, verb->arguments[i].offset);
            free(list->texts);
            list->texts = NULL;
            list->count = 0;
        }
    }
}

void arguments_help(const struct verb *verb, FILE *file)
{
    fprintf(file, "sonject %s", verb->name);
    if (verb->operand)
        fprintf(file, " %s", verb->operand);
    if (verb->second_operand)
        fprintf(file, " %s", verb->second_operand);
    bool has_optional = false;
    for (size_t i = 0; i < verb->argument_count; i++) {
        const struct argument *argument = &verb->arguments[i];
        if (argument->is_required)
            fprintf(file, " %s %s", argument->short_name ? argument->short_name : argument->name,
                    argument->value);
        has_optional |= !argument->is_required;
    }
    fprintf(file, "%s\n\n%s\n", has_optional ? " [OPTION ...]" : "", verb->summary);
    if (verb->argument_count > 0)
        fputc('\n', file);
    for (size_t i = 0; i < verb->argument_count; i++) {
        const struct argument *argument = &verb->arguments[i];
        char left[64];
        snprintf(left, sizeof(left), "%s%s%s%s%s", argument->short_name ? argument->short_name : "",
                 argument->short_name ? ", " : "", argument->name, argument->value ? " " : "",
                 argument->value ? argument->value : "");
        fprintf(file, "  %-28s %s\n", left, argument->help);
    }
    if (verb->notes[0])
        fprintf(file, "\n%s\n", verb->notes);
}
