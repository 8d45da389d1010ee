/* Stands in for impulse_writer.c in builds without HDF5. */
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
