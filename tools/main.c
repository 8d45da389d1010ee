/* The command: finds the verb and hands it its options. */
#include <stdlib.h>
#include <string.h>

#include <sonject/sonject.h>

#include "base/system/process.h"
#include "console.h"
#include "verbs.h"

#define VERB_ADDRESS(name) &name##_verb,
static const struct verb *const verbs[] = {VERBS(VERB_ADDRESS)};
static const size_t verb_count = sizeof(verbs) / sizeof(verbs[0]);

static void print_help(FILE *file)
{
    fputs("sonject puts ray-traced targets into measured sonar images.\n\n", file);
    for (size_t i = 0; i < verb_count; i++)
        fprintf(file, "  sonject %-10s %s\n", verbs[i]->name, verbs[i]->summary);
    fputs("\n"
          "  sonject help VERB   the verb's options\n"
          "  sonject help KEY    what a key means: sonar.altitude, altitude in any section, or "
          "sonar. for all its keys\n"
          "  sonject --version   the version\n"
          "\n"
          "Exit status: 0 done, 2 wrong usage, 3 unusable scene or image, 4 device,\n"
          "5 files or memory, 85 stopped by SIGTERM, 130 by Ctrl-C (run the same command again).\n",
          file);
}

/* Returns the verb of that name; NULL if there is none, and `nearest` then knows similar names. */
static const struct verb *find_verb(const char *name, struct nearest *nearest)
{
    nearest_begin(nearest, name);
    for (size_t i = 0; i < verb_count; i++) {
        if (strcmp(verbs[i]->name, name) == 0)
            return verbs[i];
        nearest_consider(nearest, verbs[i]->name);
    }
    return NULL;
}

static int help(const char *name)
{
    struct nearest nearest;
    const struct verb *verb = name ? find_verb(name, &nearest) : NULL;
    if (name && !verb)
        return key_help(name, &nearest);
    if (verb)
        arguments_help(verb, stdout);
    else
        print_help(stdout);
    return finish_output();
}

static int version(void)
{
    printf("sonject %s\n", sonject_version());
    return finish_output();
}

static bool asks_for_help(int count, char **texts)
{
    for (int i = 0; i < count && strcmp(texts[i], "--") != 0; i++) {
        if (strcmp(texts[i], "--help") == 0 || strcmp(texts[i], "-h") == 0)
            return true;
    }
    return false;
}

static int work(const struct verb *verb, int count, char **texts)
{
    void *options = calloc(1, verb->options_size);
    if (!options) {
        message("out of memory");
        return EXIT_CODE_STORAGE;
    }
    int code = EXIT_CODE_USAGE;
    if (arguments_parse(verb, count, texts, options))
        code = verb->work(options);
    arguments_release(verb, options);
    free(options);
    return code;
}

int main(int argc, char **argv)
{
    program_begin(&argc, &argv);
    if (argc < 2) {
        print_help(stderr);
        return EXIT_CODE_USAGE;
    }
    const char *first = argv[1];
    if (strcmp(first, "--version") == 0)
        return version();
    if (strcmp(first, "--help") == 0 || strcmp(first, "-h") == 0)
        return help(NULL);
    if (strcmp(first, "help") == 0)
        return help(argc > 2 ? argv[2] : NULL);
    struct nearest nearest;
    const struct verb *verb = find_verb(first, &nearest);
    if (!verb && nearest.best)
        message("there is no verb \"", first, "\"; did you mean ", nearest.best, "?");
    else if (!verb)
        message("there is no verb \"", first, "\"; see sonject --help");
    if (!verb)
        return EXIT_CODE_USAGE;
    if (asks_for_help(argc - 2, argv + 2))
        return help(verb->name);
    return work(verb, argc - 2, argv + 2);
}
