#include "trace/sums_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

/* A record of more sums than these is none that was written. */
#define ANNOUNCED_MAX    ((uint64_t)1 << 27)
#define ZEROS_A_BYTE_MAX 256

bool block_digest(struct block_head *head, const void *content)
{
    char digest[HASH_TEXT_CAPACITY];
    struct hash *hash = hash_begin();
    if (!hash)
        return false;
    hash_add(hash, &head->kind, sizeof head->kind);
    hash_add(hash, &head->bytes, sizeof head->bytes);
    hash_add(hash, content, (size_t)head->bytes);
    hash_end(hash, digest);
    memset(head->digest, 0, sizeof head->digest);
    memcpy(head->digest, digest, sizeof digest);
    return true;
}

static sonject_status refuse(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: damaged, or cut short: delete it and trace again", path);
}

/* So many bytes. A file that cannot be read is not damaged: STORAGE. */
static sonject_status read_bytes(struct report *report, const char *path, FILE *file, void *bytes,
                                 size_t count)
{
    errno = 0;
    if (fread(bytes, 1, count, file) == count)
        return SONJECT_OK;
    return ferror(file) ? file_failure(report, path, "read", errno) : refuse(report, path);
}

/* Reads a block of at most `left` bytes with its head; content is for free(). */
static sonject_status read_block(struct report *report, const char *path, FILE *file, uint64_t left,
                                 struct block_head *head, unsigned char **content)
{
    struct block_head found;
    *content = NULL;
    if (left < sizeof *head)
        return refuse(report, path);
    CHECK(read_bytes(report, path, file, head, sizeof *head));
    if (head->bytes > left - sizeof *head || head->bytes > SIZE_MAX / 2)
        return refuse(report, path);
    *content = malloc((size_t)head->bytes + 1);
    if (!*content)
        return report_out_of_memory(report, path);
    CHECK(read_bytes(report, path, file, *content, (size_t)head->bytes));
    found = *head;
    if (!block_digest(&found, *content))
        return report_out_of_memory(report, "a hash");
    return memcmp(found.digest, head->digest, sizeof found.digest) == 0 ? SONJECT_OK
                                                                        : refuse(report, path);
}

static bool is_terminated(const char *text, size_t capacity)
{
    return memchr(text, 0, capacity) != NULL;
}

static bool read_head(struct sums_file *file, const struct block_head *block,
                      unsigned char *content)
{
    struct sums_head *head = &file->head;
    const struct sums_identity *identity = &head->identity;
    if (block->bytes < sizeof *head || file->source.texts)
        return false;
    memcpy(head, content, sizeof *head);
    memmove(content, content + sizeof *head, (size_t)block->bytes - sizeof *head);
    file->source.texts = (char *)content;
    file->source.bytes = (size_t)block->bytes - sizeof *head;
    return is_terminated(identity->version, sizeof identity->version) &&
           is_terminated(identity->code, sizeof identity->code) &&
           is_terminated(identity->scene, sizeof identity->scene) &&
           is_terminated(identity->device, sizeof identity->device) && head->shard >= 1 &&
           head->shard <= head->shards &&
           (file->source.bytes == 0 || file->source.texts[file->source.bytes - 1] == '\0');
}

static bool read_end(struct sums_file *file, const struct block_head *block,
                     const unsigned char *content, uint64_t records)
{
    struct sums_end *end = &file->end;
    if (block->bytes != sizeof *end)
        return false;
    memcpy(end, content, sizeof *end);
    return end->records == records && end->first <= end->last && end->is_last <= 1 &&
           is_terminated(end->launches, sizeof end->launches);
}

/* False where memory lacks. */
static bool note_sums(struct sums_file *file, uint64_t records, uint64_t at, uint64_t bytes,
                      const unsigned char *content)
{
    if ((records & (records + 1)) == 0) { /* 0, 1, 3, 7...: room for twice as many */
        struct sums_block *more =
            records < SIZE_MAX / sizeof *more / 4
                ? realloc(file->sums, (size_t)(2 * records + 1) * sizeof *more)
                : NULL;
        if (!more)
            return false;
        file->sums = more;
    }
    file->sums[records].at = at;
    file->sums[records].bytes = bytes;
    file->sums[records].count = 0;
    if (bytes >= sizeof(uint64_t))
        memcpy(&file->sums[records].count, content, sizeof(uint64_t));
    return true;
}

/* Blocks up to the end, `left` bytes of them. */
static sonject_status read_blocks(struct sums_file *file, struct report *report, FILE *opened,
                                  uint64_t left)
{
    const uint64_t size = left + SUMS_MAGIC_BYTES;
    uint64_t records = 0;
    bool is_ended = false;
    while (left > 0 && !is_ended) {
        struct block_head block;
        unsigned char *content;
        sonject_status status = read_block(report, file->path, opened, left, &block, &content);
        bool is_sound = status == SONJECT_OK;
        if (is_sound && block.kind == BLOCK_HEAD) {
            is_sound = read_head(file, &block, content);
            if ((unsigned char *)file->source.texts == content)
                content = NULL; /* handed over */
        } else if (is_sound && block.kind == BLOCK_SUMS && file->source.texts) {
            if (!note_sums(file, records++, size - left + sizeof block, block.bytes, content))
                status = report_out_of_memory(report, file->path);
        } else if (is_sound && block.kind == BLOCK_END && file->source.texts) {
            is_sound = read_end(file, &block, content, records);
            is_ended = true;
        } else {
            is_sound = false;
        }
        free(content);
        if (status != SONJECT_OK)
            return status;
        if (!is_sound)
            return refuse(report, file->path);
        left -= sizeof block + block.bytes;
    }
    return is_ended && left == 0 ? SONJECT_OK : refuse(report, file->path);
}

/* The whole file, of so many bytes. */
static sonject_status read_all(struct sums_file *file, struct report *report, FILE *opened,
                               uint64_t bytes)
{
    char magic[SUMS_MAGIC_BYTES];
    if (bytes < sizeof magic)
        return refuse(report, file->path);
    const sonject_status status = read_bytes(report, file->path, opened, magic, sizeof magic);
    if (status == SONJECT_OK && memcmp(magic, SUMS_MAGIC, sizeof magic) != 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: not sums as this version of sonject writes them: trace again",
                              file->path);
    return status == SONJECT_OK ? read_blocks(file, report, opened, bytes - sizeof magic) : status;
}

sonject_status sums_file_open(struct sums_file *file, struct report *report, const char *path)
{
    struct file_identity identity;
    memset(file, 0, sizeof *file);
    sonject_status status = file_identify(report, path, &identity);
    if (status != SONJECT_OK)
        return status;
    file->path = copy_text(path);
    FILE *opened = file->path ? fopen(path, "rb") : NULL;
    if (!file->path)
        status = report_out_of_memory(report, "a file name");
    else if (!opened)
        status = file_failure(report, path, "read", errno);
    else
        status = read_all(file, report, opened, identity.bytes);
    if (opened)
        fclose(opened);
    if (status != SONJECT_OK)
        sums_file_close(file);
    return status;
}

void sums_file_close(struct sums_file *file)
{
    free(file->path);
    free((void *)file->source.texts);
    free(file->sums);
    memset(file, 0, sizeof *file);
}

/* Hands out what a block holds; false where that is not runs of `count` sums. */
static bool emit(const unsigned char *content, uint64_t bytes, uint64_t count,
                 sums_run_function *take, void *user)
{
    uint64_t numbers[2];
    uint64_t at = sizeof count;
    if (bytes < at || memcmp(content, &count, sizeof count) != 0)
        return false;
    while (at < bytes) {
        if (bytes - at < sizeof numbers)
            return false;
        memcpy(numbers, content + at, sizeof numbers);
        at += sizeof numbers;
        /* all that comes before is whole numbers of 8 bytes, so that values are aligned */
        if (numbers[1] > (bytes - at) / sizeof(int64_t) || numbers[0] > count ||
            numbers[1] > count - numbers[0] ||
            !take(user, numbers[0], (const int64_t *)(const void *)(content + at),
                  (size_t)numbers[1]))
            return false;
        at += numbers[1] * sizeof(int64_t);
    }
    return true;
}

sonject_status sums_file_runs(const struct sums_file *file, struct report *report, uint64_t record,
                              uint64_t count, sums_run_function *take, void *user)
{
    struct block_head block;
    unsigned char *content = NULL;
    if (record >= file->end.records)
        return refuse(report, file->path);
    const struct sums_block *sums = &file->sums[record];
    FILE *opened = fopen(file->path, "rb");
    if (!opened)
        return file_failure(report, file->path, "read", errno);
    sonject_status status =
        fseek(opened, (long)(sums->at - sizeof block), SEEK_SET) == 0
            ? read_block(report, file->path, opened, sizeof block + sums->bytes, &block, &content)
            : file_failure(report, file->path, "read", errno);
    if (status == SONJECT_OK &&
        (block.kind != BLOCK_SUMS || !emit(content, block.bytes, count, take, user)))
        status = refuse(report, file->path);
    free(content);
    fclose(opened);
    return status;
}

static bool copy_run(void *user, uint64_t first, const int64_t *values, size_t count)
{
    memcpy((int64_t *)user + first, values, count * sizeof *values);
    return true;
}

sonject_status sums_file_record(const struct sums_file *file, struct report *report,
                                uint64_t record, int64_t **values, uint64_t *count)
{
    *values = NULL;
    if (record >= file->end.records)
        return refuse(report, file->path);
    const struct sums_block *sums = &file->sums[record];
    *count = sums->count;
    if (*count > ZEROS_A_BYTE_MAX * sums->bytes + ANNOUNCED_MAX)
        return refuse(report, file->path);
    *values = allocate_array((size_t)*count, sizeof **values);
    if (!*values)
        return report_out_of_memory(report, file->path);
    const sonject_status status = sums_file_runs(file, report, record, *count, copy_run, *values);
    if (status != SONJECT_OK) {
        free(*values);
        *values = NULL;
    }
    return status;
}
