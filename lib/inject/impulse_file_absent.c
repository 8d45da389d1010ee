/* Stands in for impulse_writer.c, impulse_reader.c and impulse_delivery.c in builds without HDF5:
 * everything answers UNSUPPORTED. */
#include "inject/impulse_file.h"

static sonject_status refuse(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no files of impulses: build it with HDF5",
                          path);
}

sonject_status impulse_writer_begin(struct report *report, const char *path,
                                    struct impulse_writer **writer)
{
    *writer = NULL;
    return refuse(report, path);
}

struct impulse_sink impulse_writer_sink(struct impulse_writer *writer)
{
    const struct impulse_sink none = {NULL, writer};
    return none;
}

sonject_status impulse_writer_publish(struct impulse_writer *writer,
                                      const struct impulse_head *head)
{
    (void)writer;
    (void)head;
    return SONJECT_ERROR_UNSUPPORTED;
}

void impulse_writer_release(struct impulse_writer **writer)
{
    *writer = NULL;
}

sonject_status impulse_file_open(struct report *report, const char *path,
                                 struct impulse_file **file)
{
    *file = NULL;
    return refuse(report, path);
}

const struct impulse_head *impulse_file_head(const struct impulse_file *file)
{
    (void)file;
    return NULL;
}

void impulse_file_close(struct impulse_file **file)
{
    *file = NULL;
}

struct impulse_source impulse_file_source(struct impulse_file *file)
{
    const struct impulse_source none = {NULL, file};
    return none;
}
