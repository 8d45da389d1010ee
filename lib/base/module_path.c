#define _GNU_SOURCE /* dladdr, readlink */
#include "base/file.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

#ifdef MODULE_FOLDER
char *module_path(const char *name)
{
    return path_join(MODULE_FOLDER, name);
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

char *module_path(const char *name)
{
    char *beside = folder_of_library();
    char *within = beside ? path_join(beside, "sonject") : NULL;
    char *places[3] = {within ? path_join(within, name) : NULL,
                       within ? path_join(beside, name) : NULL,
                       path_join(INSTALLED_MODULE_FOLDER, name)};
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
