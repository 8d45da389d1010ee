#include "swath/tiff_stream.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"

static int hear(TIFF *file, void *user, const char *module, const char *format, va_list values)
{
    struct library_fault *fault = user;
    (void)file;
    (void)module;
    if (!*fault->message) {
        fault->error = errno;
        vsnprintf(fault->message, sizeof fault->message, format, values);
    }
    return 1;
}

/* Ignores libtiff's warnings, except of data behind the end of a file that is cut short. */
static int hear_warning(TIFF *file, void *user, const char *module, const char *format,
                        va_list values)
{
    return strstr(format, "IO error") ? hear(file, user, module, format, values) : 1;
}

/* Reads bytes. C's streams need a seek between reading and writing. */
static tmsize_t read_bytes(thandle_t stream, void *bytes, tmsize_t count)
{
    return fseek(stream, 0, SEEK_CUR) == 0 ? (tmsize_t)fread(bytes, 1, (size_t)count, stream) : -1;
}

static tmsize_t write_bytes(thandle_t stream, void *bytes, tmsize_t count)
{
    return fseek(stream, 0, SEEK_CUR) == 0 ? (tmsize_t)fwrite(bytes, 1, (size_t)count, stream) : -1;
}

/* Seeks from the beginning or the end, which is all that libtiff needs. */
static toff_t seek_place(thandle_t stream, toff_t place, int from)
{
    const bool is_there =
        from == SEEK_SET ? byte_file_seek(stream, place) : fseek(stream, 0, from) == 0;
    return is_there ? byte_file_place(stream) : (toff_t)-1;
}

static toff_t file_size(thandle_t stream)
{
    const toff_t place = byte_file_place(stream);
    const toff_t size = seek_place(stream, 0, SEEK_END);
    return byte_file_seek(stream, place) ? size : 0;
}

static int close_stream(thandle_t stream)
{
    return fclose(stream);
}

TIFF *tiff_open(const char *path, const char *mode, struct library_fault *fault)
{
    memset(fault, 0, sizeof *fault);
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    if (!options)
        return NULL;
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, (tmsize_t)(2 * TIFF_BLOCK_BYTES_MAX));
    TIFFOpenOptionsSetErrorHandlerExtR(options, hear, fault);
    TIFFOpenOptionsSetWarningHandlerExtR(options, hear_warning, fault);
    errno = 0;
    TIFF *file = NULL;
    FILE *stream = file_open(path, *mode == 'w' ? "w+b" : strchr(mode, '+') ? "r+b" : "rb");
    if (stream) { /* no buffer: a full disk is found as bytes are written */
        setvbuf(stream, NULL, _IONBF, 0);
        file = TIFFClientOpenExt(path, mode, stream, read_bytes, write_bytes, seek_place,
                                 close_stream, file_size, NULL, NULL, options);
    } else {
        fault->error = errno;
        strcpy(fault->message, "cannot be opened");
    }
    if (stream && !file)
        fclose(stream);
    TIFFOpenOptionsFree(options);
    return file;
}
