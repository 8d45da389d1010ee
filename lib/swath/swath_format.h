/* What a file format is made of: a row of the table in swath_file.c. */
#ifndef SONJECT_SWATH_SWATH_FORMAT_H
#define SONJECT_SWATH_SWATH_FORMAT_H

#include <stdio.h>

#include <sonject/context.h>

#include "swath/decoded_image.h"
#include "swath/image_kind.h"
#include "swath/samples.h"
#include "swath/swath_file.h"

/* Lines of samples in a file, XTF's and NumPy's: an image's rows, or its columns. */
struct sample_lines {
    uint64_t *places; /* owned: of each line's first sample; NULL: line_bytes apart */
    uint64_t first_place, line_bytes;
    enum stored_type type;
    bool is_transposed; /* they are columns */
    bool is_reversed;   /* column 0 is the last of its line */
    bool is_big_endian;
};

/* A file that is open. What a format needs is 0 in files of others. */
struct swath_file {
    const struct swath_format *format;
    char *path;
    FILE *stream; /* for reading */
    uint64_t bytes;
    struct raster_layout layout;
    uint32_t largest; /* that it may hold, where that is less than its type's; else 0 */
    struct sample_lines lines;
    struct xtf_file xtf;
    struct mat_array *mat;
    enum image_kind image;
    struct decoded_image *decoded;
};

/* A copy in the making: a part that becomes path. */
struct swath_copy {
    const char *path, *part;
    const struct region *region; /* whose samples are replaced; inside the image */
    const void *pixels;
    sonject_progress_function progress; /* may be NULL */
    void *user;
};

struct swath_format {
    bool has_channels, has_names;
    /* by the file's first bytes, of which there are count */
    bool (*is_of)(struct swath_file *file, const unsigned char *head, size_t count);
    /* sets layout, largest and what the format needs; who calls closes what failed */
    sonject_status (*open)(struct report *report, struct swath_file *file, int32_t channel,
                           const char *array);
    sonject_status (*read)(struct report *report, struct swath_file *file,
                           const struct region *region, void *pixels);
    sonject_status (*copy)(struct report *report, const struct swath_file *file,
                           const struct swath_copy *copy);
};

extern const struct swath_format xtf_format, npy_format, mat_format, image_format, hdf5_format;

/* "path: what" */
sonject_status swath_refuse(struct report *report, const struct swath_file *file, const char *what);

/* Reading and copying of files of sample_lines. */
sonject_status sample_lines_read(struct report *report, struct swath_file *file,
                                 const struct region *region, void *pixels);
sonject_status sample_lines_copy(struct report *report, const struct swath_file *file,
                                 const struct swath_copy *copy);

/* Copies bytes first...end of the file to where out stands. */
sonject_status swath_copy_bytes(struct report *report, const struct swath_file *file,
                                const struct swath_copy *copy, uint64_t first, uint64_t end,
                                FILE *out);

/* Closes a file that was written; status: of what was done with it. */
sonject_status swath_close_copy(struct report *report, const struct swath_copy *copy, FILE *out,
                                sonject_status status);

void mat_array_release(struct mat_array **array);

#endif
