#include "swath/decoder.h"

#include <stdlib.h>

#include "base/file.h"

#ifdef BUILT_FOLDER
char *decoder_path(void)
{
    return path_join(BUILT_FOLDER, DECODER_PROGRAM);
}
#else
static const char here;

char *decoder_path(void)
{
    char *beside = folder_of_code(&here);
    char *within = beside ? path_join(beside, "sonject") : NULL;
    char *places[3] = {within ? path_join(within, DECODER_PROGRAM) : NULL,
                       within ? path_join(beside, DECODER_PROGRAM) : NULL,
                       path_join(INSTALLED_FOLDER, DECODER_PROGRAM)};
    const int first = beside && *beside ? 0 : 2;
    int chosen = first == 0 ? 1 : 2; /* the path for messages if no program is found */
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
