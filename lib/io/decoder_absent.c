/* Stands in for the decoder and for what writes arrays in builds without HDF5. */
#include "io/decoder.h"
#include "io/hdf5_array.h"

static sonject_status refuse(struct report *report, const char *path)
{
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no HDF5 files: build it with HDF5", path);
}

void decoder_stop(struct decoder *decoder)
{
    (void)decoder;
}

sonject_status decoder_open(struct report *report, enum decoder_function function, const char *path,
                            const char *place, const char *array, struct decoder_file *file,
                            struct decoder_reply *reply)
{
    (void)function;
    (void)place;
    (void)array;
    (void)file;
    (void)reply;
    return refuse(report, path);
}

void decoder_close(struct decoder_file *file)
{
    (void)file;
}

sonject_status decoder_ask(struct report *report, struct decoder_file *file,
                           struct decoder_request *request, const void *in,
                           struct decoder_reply *reply, struct decoder_bytes *out)
{
    (void)request;
    (void)in;
    (void)reply;
    (void)out;
    return refuse(report, file->path);
}

sonject_status decoder_check_announced(struct report *report, const struct decoder_file *file,
                                       uint64_t rows, uint64_t columns, size_t sample_bytes)
{
    (void)rows;
    (void)columns;
    (void)sample_bytes;
    return refuse(report, file->path);
}

sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels)
{
    (void)layout;
    (void)notes;
    (void)note_count;
    (void)pixels;
    return refuse(report, path);
}
