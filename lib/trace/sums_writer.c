/* A file of tallies in the making. */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "trace/sums_file.h"

#define MEMORY_MOST ((size_t)32 << 20) /* short runs touch no file */
#define ZEROS_MOST  4                  /* within a run: a new one takes two numbers */

/* Room for so many more bytes, which are the caller's to fill; NULL where memory lacks. */
static unsigned char *make_room(struct sums_writer *writer, size_t count)
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

static sonject_status add(struct sums_writer *writer, const void *bytes, size_t count)
{
    unsigned char *room = make_room(writer, count);
    CHECK_MEMORY(writer->report, room, "tallies");
    if (count > 0)
        memcpy(room, bytes, count);
    return SONJECT_OK;
}

static char *name_in(const struct sums_writer *writer, const char *rest)
{
    char name[128];
    snprintf(name, sizeof name, "shard-%" PRIu64 "-of-%" PRIu64 "%s.sums", writer->head.shard,
             writer->head.shards, rest);
    return path_join(writer->folder, name);
}

static sonject_status open_part(struct sums_writer *writer, const char *name)
{
    if (!name || !(writer->private_name = file_part_name(name)))
        return report_out_of_memory(writer->report, "a file name");
    writer->file = fopen(writer->private_name, "wb");
    if (writer->file)
        return SONJECT_OK;
    const int error = errno;
    free(writer->private_name);
    writer->private_name = NULL;
    return file_failure(writer->report, writer->folder ? writer->folder : name, "write to", error);
}

/* Moves what is in memory to the file. */
static sonject_status spill(struct sums_writer *writer)
{
    if (!writer->file) {
        sonject_status status = folder_make(writer->report, writer->folder);
        char *name = name_in(writer, "");
        THEN(status, open_part(writer, name));
        free(name);
        if (status != SONJECT_OK)
            return status;
    }
    errno = 0;
    if (fwrite(writer->bytes, 1, writer->count, writer->file) != writer->count)
        return file_failure(writer->report, writer->private_name, "write", errno);
    writer->count = 0;
    return SONJECT_OK;
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
    memset(&head, 0, sizeof head);
    head.kind = kind;
    head.bytes = writer->count - content;
    if (!block_digest(&head, writer->bytes + content))
        return report_out_of_memory(writer->report, "a hash");
    memcpy(writer->bytes + writer->block, &head, sizeof head);
    return writer->count > MEMORY_MOST ? spill(writer) : SONJECT_OK;
}

static sonject_status begin(struct sums_writer *writer, const struct sums_head *head,
                            struct sums_source source)
{
    writer->head = *head;
    sonject_status status = add(writer, SUMS_MAGIC, SUMS_MAGIC_BYTES);
    THEN(status, begin_block(writer));
    THEN(status, add(writer, head, sizeof *head));
    THEN(status, add(writer, source.texts, source.bytes));
    THEN(status, end_block(writer, BLOCK_HEAD));
    if (status != SONJECT_OK)
        sums_writer_clear(writer);
    return status;
}

sonject_status sums_writer_begin(struct sums_writer *writer, struct report *report,
                                 const char *folder, const struct sums_head *head,
                                 struct sums_source source)
{
    memset(writer, 0, sizeof *writer);
    writer->report = report;
    writer->folder = copy_text(folder);
    return writer->folder ? begin(writer, head, source)
                          : report_out_of_memory(report, "a file name");
}

sonject_status sums_writer_begin_file(struct sums_writer *writer, struct report *report,
                                      const char *path, const struct sums_head *head,
                                      struct sums_source source)
{
    memset(writer, 0, sizeof *writer);
    writer->report = report;
    writer->path = path;
    CHECK(open_part(writer, path));
    return begin(writer, head, source);
}

void sums_writer_clear(struct sums_writer *writer)
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

sonject_status sums_writer_begin_sums(struct sums_writer *writer, uint64_t count)
{
    CHECK(begin_block(writer));
    return add(writer, &count, sizeof count);
}

sonject_status sums_writer_run(struct sums_writer *writer, uint64_t first, const int64_t *values,
                               size_t count)
{
    const uint64_t head[2] = {first, count};
    CHECK(add(writer, head, sizeof head));
    return add(writer, values, count * sizeof *values);
}

sonject_status sums_writer_end_sums(struct sums_writer *writer)
{
    writer->records++;
    return end_block(writer, BLOCK_SUMS);
}

sonject_status sums_writer_sums(struct sums_writer *writer, const int64_t *values, size_t count)
{
    sonject_status status = sums_writer_begin_sums(writer, count);
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
        status = sums_writer_run(writer, first, values + first, last + 1 - first);
    }
    return status == SONJECT_OK ? sums_writer_end_sums(writer) : status;
}

sonject_status sums_writer_publish(struct sums_writer *writer, struct sums_end *end)
{
    char rest[64];
    end->records = writer->records;
    snprintf(rest, sizeof rest, "-%" PRIu64 "-%" PRIu64, end->first, end->last);
    char *path = writer->path ? copy_text(writer->path) : name_in(writer, rest);
    sonject_status status = path ? SONJECT_OK : report_out_of_memory(writer->report, "a file name");
    THEN(status, begin_block(writer));
    THEN(status, add(writer, end, sizeof *end));
    THEN(status, end_block(writer, BLOCK_END));
    THEN(status, spill(writer));
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
