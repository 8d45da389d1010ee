/* Files that tests write again and again. */
#ifndef SONJECT_TESTS_NEW_FILE_H
#define SONJECT_TESTS_NEW_FILE_H

#include <stdio.h>

/* Opens a new file to be written, in place of one that may be there. On some file systems a file
 * that is cut to nothing goes to the disk at once, which takes a hundred times as long. */
static inline FILE *open_new_file(const char *path)
{
    (void)remove(path);
    return fopen(path, "wb");
}

#endif
