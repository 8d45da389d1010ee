#include "inject/impulse_seal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/memory.h"
#include "io/byte_file.h"

#define BEGINNING "sonject impulses, XXH3 "
#define PIECE     ((size_t)1 << 20)

/* The block that belongs to the open file's other bytes. */
static sonject_status make_seal(struct report *report, FILE *file, const char *path,
                                char seal[IMPULSE_SEAL_BYTES])
{
    char digits[HASH_TEXT_CAPACITY];
    size_t count = PIECE;
    char *piece = allocate_array(PIECE, 1);
    struct hash *hash = piece ? hash_begin() : NULL;
    if (!hash) {
        free(piece);
        return report_out_of_memory(report, "a hash");
    }
    errno = 0;
    const int sought = fseek(file, IMPULSE_SEAL_BYTES, SEEK_SET);
    while (sought == 0 && count == PIECE) {
        count = fread(piece, 1, PIECE, file);
        hash_add(hash, piece, count);
    }
    hash_end(hash, digits);
    free(piece);
    if (sought != 0 || ferror(file))
        return file_failure(report, path, "read", errno);
    memset(seal, 0, IMPULSE_SEAL_BYTES);
    snprintf(seal, IMPULSE_SEAL_BYTES, BEGINNING "%s\n", digits);
    return SONJECT_OK;
}

sonject_status impulse_seal_write(struct report *report, const char *file, const char *path)
{
    char seal[IMPULSE_SEAL_BYTES];
    FILE *opened = fopen(file, "r+b");
    if (!opened)
        return file_failure(report, path, "write", errno);
    sonject_status status = make_seal(report, opened, path, seal);
    errno = 0;
    bool is_done = status == SONJECT_OK && fseek(opened, 0, SEEK_SET) == 0 &&
                   fwrite(seal, 1, sizeof seal, opened) == sizeof seal;
    is_done = fclose(opened) == 0 && is_done;
    if (status == SONJECT_OK && !is_done)
        status = file_failure(report, path, "write", errno);
    return status;
}

sonject_status impulse_seal_check(struct report *report, const char *path)
{
    char seal[IMPULSE_SEAL_BYTES];
    char found[IMPULSE_SEAL_BYTES];
    uint64_t bytes = 0;
    FILE *file = byte_file_open(path, &bytes);
    if (!file)
        return file_refuse(report, path, errno);
    sonject_status status = SONJECT_OK;
    const bool is_one = fread(found, 1, sizeof found, file) == sizeof found &&
                        memcmp(found, BEGINNING, strlen(BEGINNING)) == 0;
    if (ferror(file))
        status = file_failure(report, path, "read", errno);
    else if (!is_one)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: not a file that sonject trace writes", path);
    if (status == SONJECT_OK)
        status = make_seal(report, file, path, seal);
    if (status == SONJECT_OK && memcmp(found, seal, sizeof seal) != 0)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: damaged, or cut short: trace again", path);
    fclose(file);
    return status;
}
