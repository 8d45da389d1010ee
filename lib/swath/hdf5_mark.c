#include "swath/hdf5_mark.h"

#include <string.h>

#define FIRST_BLOCK 512

bool hdf5_mark_is_in(const char *path)
{
    static const unsigned char mark[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};
    unsigned char bytes[sizeof mark];
    uint64_t count = 0;
    bool is_there = false;
    FILE *file = byte_file_open(path, &count);
    for (uint64_t place = 0; file && !is_there && place < count;
         place = place == 0 ? FIRST_BLOCK : 2 * place)
        is_there = byte_file_read(file, place, bytes, sizeof bytes) &&
                   memcmp(bytes, mark, sizeof mark) == 0;
    if (file)
        fclose(file);
    return is_there;
}
