#define _GNU_SOURCE /* dladdr, readlink */
#include "swath/decoder.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"

#ifdef BUILT_FOLDER
char *decoder_path(void)
{
    return path_join(BUILT_FOLDER, DECODER_PROGRAM);
}
#else
static const char here;

/* Of the library, or the program that it is part of, which may have been found by its name alone;
 * for free(), NULL when memory is out. */
static char *folder_of_library(void)
{
    Dl_info library;
    char program[4096] = "";
    const bool is_named =
        dladdr(&here, &library) != 0 && library.dli_fname && strchr(library.dli_fname, '/');
    if (!is_named && readlink("/proc/self/exe", program, sizeof program - 1) < 0)
        program[0] = '\0';
    return path_folder(is_named ? library.dli_fname : program);
}

char *decoder_path(void)
{
    char *beside = folder_of_library();
    char *within = beside ? path_join(beside, "sonject") : NULL;
    char *places[3] = {within ? path_join(within, DECODER_PROGRAM) : NULL,
                       within ? path_join(beside, DECODER_PROGRAM) : NULL,
                       path_join(INSTALLED_FOLDER, DECODER_PROGRAM)};
    const int first = beside && *beside ? 0 : 2;
    int chosen = first == 0 ? 1 : 2; /* what a message names where there is none */
    for (int i = 2; i >= first; i--)
        if (places[i] && file_exists(places[i]))
            chosen = i;
    for (int i = 0; i < 3; i++)
        if (i != chosen)
            free(places[i]);
    free(within);
    free(beside);
    return places[chosen];
}
#endif
