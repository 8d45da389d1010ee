/* A fresh folder for each test, and one report and decoder for all, as a context has them. Include
 * this header after claims.h. */
#ifndef SONJECT_TESTS_CLEAN_FOLDER_H
#define SONJECT_TESTS_CLEAN_FOLDER_H

#include "swath/decoder.h"
#include "temporary_folder.h"

static struct temporary_folder *folder;
static struct decoder decoder;
static const struct report_host host = {.decoder = &decoder};
static struct report report = {.host = &host};

/* Returns the path of a file in the folder, valid while eight others are asked for. */
static inline const char *file_in(const char *name)
{
    static char paths[9][TEMPORARY_CAPACITY + 300];
    static unsigned turn;
    return strcpy(paths[turn++ % COUNT(paths)], temporary_file(folder, name));
}

static inline int begin(void **state)
{
    const int result = make_temporary_folder(state);
    folder = *state;
    return result;
}

#define CLEAN(name) TEST_WITH(name, begin, remove_temporary_folder)

#endif
