/* Command line options in tables, with one parser and one help text for all verbs. */
#ifndef SONJECT_TOOLS_ARGUMENTS_H
#define SONJECT_TOOLS_ARGUMENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* The kinds of an option's value, and the type of the member that takes it. */
enum argument_kind {
    ARGUMENT_FLAG,   /* no value; bool */
    ARGUMENT_TEXT,   /* const char *, NULL: not given */
    ARGUMENT_TEXTS,  /* may be repeated; struct text_list */
    ARGUMENT_NUMBER, /* finite, in SI units and radians; struct number_argument */
    ARGUMENT_WHOLE   /* digits; struct whole_argument */
};

struct text_list {
    const char **texts; /* for free() */
    size_t count;
};

struct number_argument {
    bool is_given;
    double value;
};

struct whole_argument {
    bool is_given;
    uint64_t value;
};

struct argument {
    const char *name;       /* "--seed" */
    const char *short_name; /* "-o" or NULL */
    const char *value;      /* the value's name in the help, which tells its unit: M, HZ, DEG, DB,
                               SECONDS; NULL for flags */
    const char *help;
    enum argument_kind kind;
    bool is_required;
    size_t offset; /* offset of the member in the verb's options */
};

struct verb {
    const char *name;
    const char *summary; /* one line for the list of verbs */
    const char *operand; /* "SCENE.yaml", NULL if the verb has none */
    size_t operand_offset;
    const char *second_operand; /* second operand; NULL if the verb has none */
    size_t second_offset;
    const struct argument *arguments;
    size_t argument_count;
    const char *notes; /* text below the options in the help; "" for none */
    size_t options_size;
    int (*work)(const void *options); /* returns the exit code */
};

/* Reads the words behind the verb into zeroed options. Returns false after a message. Give the
 * options to arguments_release either way. */
bool arguments_parse(const struct verb *verb, int count, char **texts, void *options);

void arguments_release(const struct verb *verb, void *options);

void arguments_help(const struct verb *verb, FILE *file);

/* Parses a whole text that is a finite decimal number, such as "-2.5e3", in every locale. */
bool number_parse(const char *text, double *value);

#endif
