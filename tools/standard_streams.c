#define _POSIX_C_SOURCE 200809L

#include "standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

void standard_streams_secure(void)
{
    /* Opened the wrong way round: reading the input, writing the output fails as it should. */
    const int flags[] = {O_WRONLY, O_RDONLY, O_RDONLY};
    for (int descriptor = 0; descriptor <= 2; descriptor++) {
        if (fcntl(descriptor, F_GETFD) != -1)
            continue;
        int opened = open("/dev/null", flags[descriptor]);
        if (opened != -1 && opened != descriptor) {
            dup2(opened, descriptor);
            close(opened);
        }
    }
}
