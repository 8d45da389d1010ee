#include "swath/numpy_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

#define HEADER_BYTES  128 /* a multiple of 64, as the format wants */
#define PREAMBLE      10  /* magic, version, and length of the header */
#define NUMBERS_A_RUN 16384

static void make_header(char header[HEADER_BYTES], const uint64_t shape[3], bool is_complex)
{
    static const char magic[] = "\x93NUMPY\x01";
    const unsigned length = HEADER_BYTES - PREAMBLE;
    char text[HEADER_BYTES];
    snprintf(text, sizeof text,
             "{'descr': '%s', 'fortran_order': False, 'shape': (%llu, %llu, %llu), }",
             is_complex ? "<c8" : "<f4", (unsigned long long)shape[0], (unsigned long long)shape[1],
             (unsigned long long)shape[2]);
    memset(header, ' ', HEADER_BYTES);
    memcpy(header, magic, sizeof magic); /* its final 0 is the minor version */
    header[8] = (char)(length & 0xffu);
    header[9] = (char)(length >> 8);
    memcpy(header + PREAMBLE, text, strlen(text));
    header[HEADER_BYTES - 1] = '\n';
}

static bool write_numbers(FILE *file, const float *numbers, size_t count)
{
    unsigned char *run = malloc(4 * NUMBERS_A_RUN);
    bool is_written = run != NULL;
    for (size_t done = 0; is_written && done < count; done += NUMBERS_A_RUN) {
        const size_t some = count - done < NUMBERS_A_RUN ? count - done : NUMBERS_A_RUN;
        for (size_t i = 0; i < some; i++) {
            uint32_t bits;
            memcpy(&bits, &numbers[done + i], sizeof bits);
            for (size_t byte = 0; byte < 4; byte++)
                run[4 * i + byte] = (unsigned char)(bits >> (8 * byte) & 0xffu);
        }
        is_written = fwrite(run, 4, some, file) == some;
    }
    free(run);
    return is_written;
}

static sonject_status write_part(struct report *report, const char *part, const char *path,
                                 const uint64_t shape[3], bool is_complex, const float *numbers)
{
    char header[HEADER_BYTES];
    const size_t count = (size_t)(shape[0] * shape[1] * shape[2]) * (is_complex ? 2 : 1);
    FILE *file = fopen(part, "wb");
    if (!file)
        return file_failure(report, path, "write", errno);
    make_header(header, shape, is_complex);
    errno = 0;
    bool is_written = fwrite(header, 1, sizeof header, file) == sizeof header &&
                      write_numbers(file, numbers, count);
    int error = errno;
    if (fclose(file) != 0 && is_written) {
        is_written = false;
        error = errno;
    }
    if (is_written)
        return file_publish(report, part, path);
    file_discard(part);
    return file_failure(report, path, "write", error ? error : EIO);
}

sonject_status numpy_file_write(struct report *report, const char *path, const uint64_t shape[3],
                                bool is_complex, const float *numbers)
{
    char *part = file_part_name(path);
    if (!part)
        return report_out_of_memory(report, "a path");
    const sonject_status status = write_part(report, part, path, shape, is_complex, numbers);
    free(part);
    return status;
}
