#include "trace/sums_file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

#define MEMORY_MOST ((size_t)32 << 20) /* short runs need no file */
#define ZEROS_MOST  4                  /* zeros within a run: a new run takes two numbers */

typedef char block_head_is_packed[sizeof(struct block_head) == 56 ? 1 : -1];
typedef char sums_head_is_packed[sizeof(struct sums_head) == 272 ? 1 : -1];

bool block_digest(struct block_head *head, const void *content)
{
    struct hash *hash = hash_begin();
    if (!hash)
        return false;
    hash_add(hash, &head->kind, sizeof head->kind);
    hash_add(hash, &head->bytes, sizeof head->bytes);
    hash_add(hash, content, (size_t)head->bytes);
    memset(head->digest, 0, sizeof head->digest);
    hash_end(hash, head->digest);
    return true;
}

static sonject_status add(struct sums_writer *writer, const void *bytes, size_t count)
{
    if (count > writer->capacity - writer->count) {
        const size_t capacity = count < SIZE_MAX / 4 - writer->count
                                    ? (writer->count + count) / 2 * 3 + 4096
                                    : SIZE_MAX;
        unsigned char *larger = capacity < SIZE_MAX ? realloc(writer->bytes, capacity) : NULL;
        CHECK_MEMORY(writer->report, larger, "tallies");
        writer->bytes = larger;
        writer->capacity = capacity;
    }
    if (count > 0)
        memcpy(writer->bytes + writer->count, bytes, count);
    writer->count += count;
    return SONJECT_OK;
}

static sonject_status open_part(struct sums_writer *writer, const char *path)
{
    writer->private_name = file_part_name(path);
    CHECK_MEMORY(writer->report, writer->private_name, "a file name");
    writer->file = file_open(writer->private_name, "wb");
    if (writer->file)
        return SONJECT_OK;
    const int error = errno;
    free(writer->private_name);
    writer->private_name = NULL;
    return file_failure(writer->report, writer->folder ? writer->folder : path, "write to", error);
}

/* Moves the bytes in memory to the file. */
static sonject_status spill(struct sums_writer *writer)
{
    if (!writer->file) {
        sonject_status status = folder_make(writer->report, writer->folder);
        char *path = path_join(writer->folder, "shard.sums");
        THEN(status,
             path ? open_part(writer, path) : report_out_of_memory(writer->report, "a file name"));
        free(path);
        CHECK(status);
    }
    errno = 0;
    if (fwrite(writer->bytes, 1, writer->count, writer->file) != writer->count)
        return file_failure(writer->report, writer->private_name, "write", errno);
    writer->count = 0;
    return SONJECT_OK;
}

sonject_status sums_writer_begin(struct sums_writer *writer, struct report *report,
                                 const char *path, const char *folder)
{
    memset(writer, 0, sizeof *writer);
    writer->report = report;
    writer->path = path;
    writer->folder = folder;
    sonject_status status = add(writer, SUMS_MAGIC, SUMS_MAGIC_BYTES);
    if (status == SONJECT_OK && path)
        status = open_part(writer, path);
    if (status != SONJECT_OK)
        sums_writer_clear(writer);
    return status;
}

void sums_writer_clear(struct sums_writer *writer)
{
    if (writer->file)
        fclose(writer->file);
    if (writer->private_name)
        file_discard(writer->private_name);
    free(writer->private_name);
    free(writer->bytes);
    memset(writer, 0, sizeof *writer);
}

static sonject_status begin_block(struct sums_writer *writer)
{
    static const struct block_head none;
    writer->block = writer->count;
    return add(writer, &none, sizeof none);
}

static sonject_status end_block(struct sums_writer *writer, enum block_kind kind)
{
    struct block_head head;
    const size_t content = writer->block + sizeof head;
    head.kind = kind;
    head.bytes = writer->count - content;
    CHECK_MEMORY(writer->report, block_digest(&head, writer->bytes + content), "a hash");
    memcpy(writer->bytes + writer->block, &head, sizeof head);
    return writer->count > MEMORY_MOST || kind == BLOCK_HEAD ? spill(writer) : SONJECT_OK;
}

sonject_status sums_writer_begin_sums(struct sums_writer *writer, uint64_t count)
{
    CHECK(begin_block(writer));
    return add(writer, &count, sizeof count);
}

static sonject_status add_run(struct sums_writer *writer, uint64_t first, const int64_t *values,
                              size_t count)
{
    const uint64_t head[2] = {first, count};
    CHECK(add(writer, head, sizeof head));
    return add(writer, values, count * sizeof *values);
}

sonject_status sums_writer_add(struct sums_writer *writer, uint64_t first, const int64_t *values,
                               size_t count)
{
    for (size_t i = 0; i < count;) {
        if (values[i] == 0) {
            i++;
            continue;
        }
        const size_t start = i;
        size_t last = i;
        for (; i < count && i - last <= ZEROS_MOST; i++)
            if (values[i] != 0)
                last = i;
        CHECK(add_run(writer, first + start, values + start, last + 1 - start));
    }
    return SONJECT_OK;
}

sonject_status sums_writer_end_sums(struct sums_writer *writer)
{
    writer->records++;
    return end_block(writer, BLOCK_SUMS);
}

sonject_status sums_writer_add_all(struct sums_writer *writer, const int64_t *values, size_t count)
{
    sonject_status status = sums_writer_begin_sums(writer, count);
    THEN(status, sums_writer_add(writer, 0, values, count));
    return status == SONJECT_OK ? sums_writer_end_sums(writer) : status;
}

static sonject_status add_text(struct sums_writer *writer, const char *text)
{
    CHECK_MEMORY(writer->report, text, "the scene's text");
    return add(writer, text, strlen(text) + 1);
}

static sonject_status add_source(struct sums_writer *writer, const struct scene_source *source)
{
    char *folder = working_folder();
    sonject_status status = add_text(writer, source->path);
    THEN(status, add_text(writer, folder));
    THEN(status, add_text(writer, source->text));
    for (size_t i = 0; status == SONJECT_OK && i < source->override_count; i++)
        status = add_text(writer, source->overrides[i]);
    free(folder);
    return status;
}

/* Closes the unfinished file and renames it. */
static sonject_status publish_part(struct sums_writer *writer, const char *path)
{
    FILE *file = writer->file;
    writer->file = NULL;
    errno = 0;
    if (fclose(file) != 0)
        return file_failure(writer->report, path, "write", errno);
    const sonject_status status = file_publish(writer->report, writer->private_name, path);
    free(writer->private_name);
    writer->private_name = NULL;
    return status;
}

sonject_status sums_writer_publish(struct sums_writer *writer, const struct sums_head *head,
                                   const struct scene_source *source)
{
    char name[128];
    struct sums_head counted = *head;
    counted.records = writer->records;
    snprintf(name, sizeof name, "shard-%" PRIu64 "-of-%" PRIu64 "-%" PRIu64 "-%" PRIu64 ".sums",
             head->shard, head->shards, head->first, head->last);
    char *path = writer->path ? copy_text(writer->path) : path_join(writer->folder, name);
    sonject_status status = path ? SONJECT_OK : report_out_of_memory(writer->report, "a file name");
    THEN(status, begin_block(writer));
    THEN(status, add(writer, &counted, sizeof counted));
    if (status == SONJECT_OK && source && source->text && source->array_count == 0)
        status = add_source(writer, source);
    THEN(status, end_block(writer, BLOCK_HEAD));
    THEN(status, publish_part(writer, path));
    free(path);
    return status;
}

static sonject_status refuse(struct report *report, const char *path)
{
    return input_failure(report, path, "damaged, or cut short: delete it and trace again");
}

/* Reads `count` bytes. A file that cannot be read is not damaged, but gives STORAGE. */
static sonject_status read_bytes(struct report *report, const char *path, FILE *file, void *bytes,
                                 size_t count)
{
    errno = 0;
    if (fread(bytes, 1, count, file) == count)
        return SONJECT_OK;
    return ferror(file) ? file_failure(report, path, "read", errno) : refuse(report, path);
}

/* Reads a block of at most `left` bytes with its head. *content is for free(), also on failure. */
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
    CHECK_MEMORY(report, *content, path);
    CHECK(read_bytes(report, path, file, *content, (size_t)head->bytes));
    found = *head;
    CHECK_MEMORY(report, block_digest(&found, *content), "a hash");
    return memcmp(&found, head, sizeof found) == 0 ? SONJECT_OK : refuse(report, path);
}

static bool is_terminated(const char *text, size_t capacity)
{
    return memchr(text, 0, capacity) != NULL;
}

/* Finds the texts of the scene's source. Returns false if memory or a text lacks. */
static bool read_source(struct sums_file *file, const char *at, const char *end)
{
    struct kept_scene *scene = &file->scene;
    const char **own[] = {&scene->path, &scene->folder, &scene->text};
    size_t count = 0;
    for (const char *text = at; text < end; text += strlen(text) + 1)
        count++;
    if (count == 0)
        return true;
    if (count < 3 || !(scene->overrides = allocate_array(count, sizeof *scene->overrides)))
        return false;
    for (size_t i = 0; i < count; i++, at += strlen(at) + 1)
        *(i < 3 ? own[i] : &scene->overrides[scene->override_count++]) = at;
    return true;
}

/* Reads the head of a file of so many records. Returns false if the block is no such head. */
static bool read_head(struct sums_file *file, char *content, size_t bytes, uint64_t records)
{
    struct sums_head *head = &file->head;
    const struct sums_identity *identity = &head->identity;
    if (bytes < sizeof *head || (bytes > sizeof *head && content[bytes - 1] != '\0'))
        return false;
    memcpy(head, content, sizeof *head);
    return is_terminated(identity->version, sizeof identity->version) &&
           is_terminated(identity->code, sizeof identity->code) &&
           is_terminated(identity->scene, sizeof identity->scene) &&
           is_terminated(identity->image, sizeof identity->image) &&
           is_terminated(head->launches, sizeof head->launches) && head->shard >= 1 &&
           head->shard <= head->shards && head->first <= head->last && head->is_last <= 1 &&
           head->records == records && read_source(file, content + sizeof *head, content + bytes);
}

/* Notes a block of sums. Returns false if memory lacks. */
static bool note_sums(struct sums_file *file, uint64_t records, uint64_t at, uint64_t bytes)
{
    struct sums_block *more = grow_doubling(file->sums, (size_t)records, sizeof *more);
    if (!more)
        return false;
    file->sums = more;
    file->sums[records] = (struct sums_block){at, bytes};
    return true;
}

/* Reads the whole file, of so many bytes: blocks up to the head. */
static sonject_status read_all(struct sums_file *file, struct report *report, FILE *opened,
                               uint64_t bytes)
{
    char magic[SUMS_MAGIC_BYTES];
    uint64_t at = sizeof magic;
    uint64_t records = 0;
    if (bytes < sizeof magic)
        return refuse(report, file->path);
    CHECK(read_bytes(report, file->path, opened, magic, sizeof magic));
    if (memcmp(magic, SUMS_MAGIC, sizeof magic) != 0)
        return input_failure(report, file->path,
                             "not sums as this version of sonject writes them: trace again");
    while (!file->content) {
        struct block_head block;
        unsigned char *content;
        sonject_status status =
            read_block(report, file->path, opened, bytes - at, &block, &content);
        at += sizeof block;
        if (status == SONJECT_OK && block.kind == BLOCK_SUMS &&
            !note_sums(file, records++, at, block.bytes))
            status = report_out_of_memory(report, file->path);
        at += block.bytes;
        if (status == SONJECT_OK && block.kind == BLOCK_HEAD)
            file->content = (char *)content;
        else
            free(content);
        CHECK(status);
        if (block.kind != BLOCK_SUMS &&
            (block.kind != BLOCK_HEAD || at != bytes ||
             !read_head(file, file->content, (size_t)block.bytes, records)))
            return refuse(report, file->path);
    }
    return SONJECT_OK;
}

sonject_status sums_file_open(struct sums_file *file, struct report *report, const char *path)
{
    struct path_facts identity;
    memset(file, 0, sizeof *file);
    CHECK(file_identify(report, path, &identity));
    file->path = copy_text(path);
    CHECK_MEMORY(report, file->path, "a file name");
    FILE *opened = file_open(path, "rb");
    const sonject_status status = opened ? read_all(file, report, opened, identity.bytes)
                                         : file_failure(report, path, "read", errno);
    if (opened)
        fclose(opened);
    if (status != SONJECT_OK)
        sums_file_close(file);
    return status;
}

void sums_file_close(struct sums_file *file)
{
    free(file->path);
    free(file->scene.overrides);
    free(file->content);
    free(file->sums);
    memset(file, 0, sizeof *file);
}

/* Hands out what a block holds. Returns false where that is not runs of `count` sums. */
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
        /* all before is whole numbers of 8 bytes, so that values are aligned */
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
    if (record >= file->head.records)
        return refuse(report, file->path);
    const struct sums_block *sums = &file->sums[record];
    FILE *opened = file_open(file->path, "rb");
    sonject_status status =
        opened && byte_file_seek(opened, sums->at - sizeof block)
            ? read_block(report, file->path, opened, sizeof block + sums->bytes, &block, &content)
            : file_failure(report, file->path, "read", errno);
    if (status == SONJECT_OK &&
        (block.kind != BLOCK_SUMS || !emit(content, block.bytes, count, take, user)))
        status = refuse(report, file->path);
    free(content);
    if (opened)
        fclose(opened);
    return status;
}
