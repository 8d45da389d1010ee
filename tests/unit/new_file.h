/* Files that tests write again and again. */
#ifndef SONJECT_TESTS_NEW_FILE_H
#define SONJECT_TESTS_NEW_FILE_H

#include <stdio.h>

/* Opens a file to be written that is not the one that was there: a file cut to nothing and written
 * again goes to the disk at once on some file systems, which takes a hundred times as long. */
static inline FILE *open_new_file(const char *path)
{
    (void)remove(path);
    return fopen(path, "wb");
}

#endif
