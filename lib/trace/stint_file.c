#include "trace/stint_file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

#define MAGIC       "sonject stint 1\n"
#define MAGIC_BYTES 16
#define MEMORY_MOST ((size_t)32 << 20) /* short runs touch no file */
#define ZEROS_MOST  4                  /* within a run: a new one takes two numbers */

enum block_kind {
    BLOCK_HEAD = 1,
    BLOCK_SUMS = 2,
    BLOCK_END = 3
};

struct block_head {
    uint64_t kind, bytes;
    char digest[STINT_DIGEST_CAPACITY];
};

typedef char block_head_is_packed[sizeof(struct block_head) == 56 ? 1 : -1];
typedef char stint_head_is_packed[sizeof(struct stint_head) == 216 ? 1 : -1];
typedef char stint_end_is_packed[sizeof(struct stint_end) == 96 ? 1 : -1];

static bool make_digest(struct block_head *head, const void *content)
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

/* Room for so many more bytes, which are the caller's to fill; NULL where memory lacks. */
static unsigned char *make_room(struct stint_writer *writer, size_t count)
{
    if (count > SIZE_MAX / 4 - writer->count)
        return NULL;
    const size_t needed = writer->count + count;
    if (needed > writer->capacity) {
        const size_t capacity = needed + needed / 2 + 4096;
        unsigned char *larger = realloc(writer->bytes, capacity);
        if (!larger)
            return NULL;
        writer->bytes = larger;
        writer->capacity = capacity;
    }
    unsigned char *room = writer->bytes + writer->count;
    writer->count = needed;
    return room;
}

static sonject_status add(struct stint_writer *writer, const void *bytes, size_t count)
{
    unsigned char *room = make_room(writer, count);
    if (!room)
        return report_out_of_memory(writer->report, "tallies");
    if (count > 0)
        memcpy(room, bytes, count);
    return SONJECT_OK;
}

static char *name_in(const struct stint_writer *writer, const char *rest)
{
    char name[128];
    snprintf(name, sizeof name, "shard-%" PRIu64 "-of-%" PRIu64 "%s.stint", writer->head.shard,
             writer->head.shards, rest);
    return path_join(writer->folder, name);
}

/* Moves what is in memory to the file. */
static sonject_status spill(struct stint_writer *writer)
{
    if (!writer->file) {
        char *name = name_in(writer, "");
        writer->private_name = name ? file_part_name(name) : NULL;
        free(name);
        if (!writer->private_name)
            return report_out_of_memory(writer->report, "a file name");
        writer->file = fopen(writer->private_name, "wb");
        if (!writer->file) {
            const int error = errno;
            free(writer->private_name);
            writer->private_name = NULL;
            return file_failure(writer->report, writer->folder, "write to", error);
        }
    }
    errno = 0;
    if (fwrite(writer->bytes, 1, writer->count, writer->file) != writer->count)
        return file_failure(writer->report, writer->private_name, "write", errno);
    writer->count = 0;
    return SONJECT_OK;
}

static sonject_status begin_block(struct stint_writer *writer)
{
    static const struct block_head none;
    writer->block = writer->count;
    return add(writer, &none, sizeof none);
}

static sonject_status end_block(struct stint_writer *writer, enum block_kind kind)
{
    struct block_head head;
    const size_t content = writer->block + sizeof head;
    memset(&head, 0, sizeof head);
    head.kind = kind;
    head.bytes = writer->count - content;
    if (!make_digest(&head, writer->bytes + content))
        return report_out_of_memory(writer->report, "a hash");
    memcpy(writer->bytes + writer->block, &head, sizeof head);
    return writer->count > MEMORY_MOST ? spill(writer) : SONJECT_OK;
}

sonject_status stint_writer_begin(struct stint_writer *writer, struct report *report,
                                  const char *folder, const struct stint_head *head,
                                  struct stint_source source)
{
    memset(writer, 0, sizeof *writer);
    writer->report = report;
    writer->head = *head;
    writer->folder = copy_text(folder);
    sonject_status status =
        writer->folder ? SONJECT_OK : report_out_of_memory(report, "a file name");
    if (status == SONJECT_OK)
        status = add(writer, MAGIC, MAGIC_BYTES);
    if (status == SONJECT_OK)
        status = begin_block(writer);
    if (status == SONJECT_OK)
        status = add(writer, head, sizeof *head);
    if (status == SONJECT_OK)
        status = add(writer, source.texts, source.bytes);
    if (status == SONJECT_OK)
        status = end_block(writer, BLOCK_HEAD);
    if (status != SONJECT_OK)
        stint_writer_clear(writer);
    return status;
}

void stint_writer_clear(struct stint_writer *writer)
{
    if (writer->file)
        fclose(writer->file);
    if (writer->private_name)
        file_discard(writer->private_name);
    free(writer->private_name);
    free(writer->folder);
    free(writer->bytes);
    memset(writer, 0, sizeof *writer);
}

sonject_status stint_writer_begin_sums(struct stint_writer *writer, uint64_t count)
{
    const sonject_status status = begin_block(writer);
    return status == SONJECT_OK ? add(writer, &count, sizeof count) : status;
}

sonject_status stint_writer_run(struct stint_writer *writer, uint64_t first, const int64_t *values,
                                size_t count)
{
    const uint64_t head[2] = {first, count};
    const sonject_status status = add(writer, head, sizeof head);
    return status == SONJECT_OK ? add(writer, values, count * sizeof *values) : status;
}

sonject_status stint_writer_end_sums(struct stint_writer *writer)
{
    writer->records++;
    return end_block(writer, BLOCK_SUMS);
}

sonject_status stint_writer_sums(struct stint_writer *writer, const int64_t *values, size_t count)
{
    sonject_status status = stint_writer_begin_sums(writer, count);
    for (size_t i = 0; status == SONJECT_OK && i < count;) {
        if (values[i] == 0) {
            i++;
            continue;
        }
        const size_t first = i;
        size_t last = i;
        for (; i < count && i - last <= ZEROS_MOST; i++)
            if (values[i] != 0)
                last = i;
        status = stint_writer_run(writer, first, values + first, last + 1 - first);
    }
    return status == SONJECT_OK ? stint_writer_end_sums(writer) : status;
}

sonject_status stint_writer_publish(struct stint_writer *writer, struct stint_end *end)
{
    char rest[64];
    end->records = writer->records;
    snprintf(rest, sizeof rest, "-%" PRIu64 "-%" PRIu64, end->first, end->last);
    char *path = name_in(writer, rest);
    sonject_status status = path ? SONJECT_OK : report_out_of_memory(writer->report, "a file name");
    if (status == SONJECT_OK)
        status = begin_block(writer);
    if (status == SONJECT_OK)
        status = add(writer, end, sizeof *end);
    if (status == SONJECT_OK)
        status = end_block(writer, BLOCK_END);
    if (status == SONJECT_OK)
        status = spill(writer);
    if (status == SONJECT_OK) {
        FILE *file = writer->file;
        writer->file = NULL;
        errno = 0;
        if (fclose(file) != 0)
            status = file_failure(writer->report, path, "write", errno);
    }
    if (status == SONJECT_OK) {
        status = file_publish(writer->report, writer->private_name, path);
        free(writer->private_name);
        writer->private_name = NULL;
    }
    free(path);
    return status;
}

static sonject_status refuse(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: damaged, or cut short: delete it and run its shard again", path);
}

/* Reads a block of at most `left` bytes with its head; content is for free(). */
static sonject_status read_block(struct report *report, const char *path, FILE *file, uint64_t left,
                                 struct block_head *head, unsigned char **content)
{
    struct block_head found;
    *content = NULL;
    if (left < sizeof *head || fread(head, sizeof *head, 1, file) != 1 ||
        head->bytes > left - sizeof *head || head->bytes > SIZE_MAX / 2)
        return refuse(report, path);
    *content = malloc((size_t)head->bytes + 1);
    if (!*content)
        return report_out_of_memory(report, path);
    found = *head;
    if (fread(*content, 1, (size_t)head->bytes, file) != head->bytes)
        return refuse(report, path);
    if (!make_digest(&found, *content))
        return report_out_of_memory(report, "a hash");
    return memcmp(found.digest, head->digest, sizeof found.digest) == 0 ? SONJECT_OK
                                                                        : refuse(report, path);
}

static bool is_terminated(const char *text, size_t capacity)
{
    return memchr(text, 0, capacity) != NULL;
}

static bool take_head(struct stint_file *file, const struct block_head *block,
                      unsigned char *content)
{
    struct stint_head *head = &file->head;
    const struct stint_identity *identity = &head->identity;
    if (block->bytes < sizeof *head || file->source.texts)
        return false;
    memcpy(head, content, sizeof *head);
    memmove(content, content + sizeof *head, (size_t)block->bytes - sizeof *head);
    file->source.texts = (char *)content;
    file->source.bytes = (size_t)block->bytes - sizeof *head;
    return is_terminated(identity->version, sizeof identity->version) &&
           is_terminated(identity->code, sizeof identity->code) &&
           is_terminated(identity->scene, sizeof identity->scene) &&
           is_terminated(identity->device, sizeof identity->device) &&
           is_terminated(head->result, sizeof head->result) && head->shard >= 1 &&
           head->shard <= head->shards &&
           (file->source.bytes == 0 || file->source.texts[file->source.bytes - 1] == '\0');
}

static bool take_end(struct stint_file *file, const struct block_head *block,
                     const unsigned char *content, uint64_t records)
{
    struct stint_end *end = &file->end;
    if (block->bytes != sizeof *end)
        return false;
    memcpy(end, content, sizeof *end);
    return end->records == records && end->first <= end->last && end->is_last <= 1 &&
           is_terminated(end->course, sizeof end->course);
}

static bool note_sums(struct stint_file *file, struct report *report, uint64_t records, uint64_t at,
                      uint64_t bytes)
{
    (void)report;
    if ((records & (records + 1)) == 0) { /* 0, 1, 3, 7...: room for twice as many */
        struct stint_block *more =
            records < SIZE_MAX / sizeof *more / 4
                ? realloc(file->sums, (size_t)(2 * records + 1) * sizeof *more)
                : NULL;
        if (!more)
            return false;
        file->sums = more;
    }
    file->sums[records].at = at;
    file->sums[records].bytes = bytes;
    return true;
}

/* Blocks up to the end, `left` bytes of them. */
static sonject_status read_blocks(struct stint_file *file, struct report *report, FILE *opened,
                                  uint64_t left)
{
    const uint64_t size = left + MAGIC_BYTES;
    uint64_t records = 0;
    bool is_ended = false;
    while (left > 0 && !is_ended) {
        struct block_head block;
        unsigned char *content;
        sonject_status status = read_block(report, file->path, opened, left, &block, &content);
        bool is_sound = status == SONJECT_OK;
        if (is_sound && block.kind == BLOCK_HEAD) {
            is_sound = take_head(file, &block, content);
            if ((unsigned char *)file->source.texts == content)
                content = NULL; /* handed over */
        } else if (is_sound && block.kind == BLOCK_SUMS && file->source.texts) {
            if (!note_sums(file, report, records++, size - left + sizeof block, block.bytes))
                status = report_out_of_memory(report, file->path);
        } else if (is_sound && block.kind == BLOCK_END && file->source.texts) {
            is_sound = take_end(file, &block, content, records);
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

sonject_status stint_file_open(struct stint_file *file, struct report *report, const char *path)
{
    char magic[MAGIC_BYTES];
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
    else if (identity.bytes < MAGIC_BYTES || fread(magic, 1, MAGIC_BYTES, opened) != MAGIC_BYTES ||
             memcmp(magic, MAGIC, MAGIC_BYTES) != 0)
        status = refuse(report, path);
    else
        status = read_blocks(file, report, opened, identity.bytes - MAGIC_BYTES);
    if (opened)
        fclose(opened);
    if (status != SONJECT_OK)
        stint_file_close(file);
    return status;
}

void stint_file_close(struct stint_file *file)
{
    free(file->path);
    free((void *)file->source.texts);
    free(file->sums);
    memset(file, 0, sizeof *file);
}

/* Hands out what a block holds; false where that is not runs of `count` sums. */
static bool hand_out(const unsigned char *content, uint64_t bytes, uint64_t count,
                     stint_run_function *take, void *user)
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

sonject_status stint_file_runs(const struct stint_file *file, struct report *report,
                               uint64_t record, uint64_t count, stint_run_function *take,
                               void *user)
{
    struct block_head block;
    unsigned char *content = NULL;
    if (record >= file->end.records)
        return refuse(report, file->path);
    const struct stint_block *sums = &file->sums[record];
    FILE *opened = fopen(file->path, "rb");
    if (!opened)
        return file_failure(report, file->path, "read", errno);
    sonject_status status =
        fseek(opened, (long)(sums->at - sizeof block), SEEK_SET) == 0
            ? read_block(report, file->path, opened, sizeof block + sums->bytes, &block, &content)
            : file_failure(report, file->path, "read", errno);
    if (status == SONJECT_OK &&
        (block.kind != BLOCK_SUMS || !hand_out(content, block.bytes, count, take, user)))
        status = refuse(report, file->path);
    free(content);
    fclose(opened);
    return status;
}
