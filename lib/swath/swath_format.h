/* What a file format is made of: a row of the table SWATH_FORMATS; and what formats share:
 * samples in a file's types and order, and the arrays that a file holds, of which one is wanted. */
#ifndef SONJECT_SWATH_SWATH_FORMAT_H
#define SONJECT_SWATH_SWATH_FORMAT_H

#include <stdio.h>

#include <sonject/context.h>

#include "swath/decoder.h"
#include "swath/image_head.h"
#include "swath/swath_file.h"

enum stored_type {
    STORED_INT8,
    STORED_UINT8,
    STORED_INT16,
    STORED_UINT16,
    STORED_INT32,
    STORED_UINT32,
    STORED_FLOAT32,
    STORED_FLOAT64
};

size_t stored_bytes(enum stored_type type);

/* Bytes of a float or double, whose bits stay as they are. */
double float_from_bytes(const unsigned char *bytes, size_t count, bool is_big_endian);

/* Where the samples of a part of an image are in memory, in the file's types and order. */
struct stored_samples {
    unsigned char *bytes[2];         /* the first sample of each channel */
    enum stored_type types[2];       /* of each channel */
    ptrdiff_t row_step, column_step; /* in samples */
    bool is_big_endian;
    bool are_amplitudes; /* numbers of whole types must not be negative */
    bool clips;          /* what a whole type cannot hold is cut; else it is refused */
    double scale;        /* an image's number over the file's; 0: 1 */
    uint32_t largest;    /* more than this is not written; 0: the type's own */
};

/* Moves samples between a file's order and an image's: those of a part of region, whose pixels are
 * given row after row. writes: from the image to the file, where a number that is shown as the
 * float32 that is to be written keeps its bits; others of whole types are rounded. path: in
 * messages. Errors: INPUT (a sample that the other side cannot hold: says where). */
sonject_status samples_exchange(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct stored_samples *stored, const struct region *part,
                                const struct region *region, void *pixels, bool writes);

/* A number in another type, which holds it. */
void samples_convert(enum stored_type from_type, const unsigned char *from, enum stored_type type,
                     unsigned char *to, bool is_big_endian);

struct array_list {
    const char *wanted; /* NULL: the only one */
    unsigned matches;   /* arrays that are wanted */
    unsigned count;
    char text[600]; /* as messages list them */
};

/* Notes an array; true if it is wanted. is_image: it has several rows and columns of numbers that
 * sonject reads; others are wanted by their names alone, and not listed. */
bool array_list_add(struct array_list *list, const char *name, uint64_t rows, uint64_t columns,
                    bool is_image);

/* INPUT unless just one array is wanted. */
sonject_status array_list_check(struct report *report, const char *path,
                                const struct array_list *list);

/* Lines of samples in a file, recordings' and NumPy's: an image's rows, or its columns. */
struct sample_lines {
    uint64_t *places; /* owned: of each line's first sample; NULL: line_bytes apart */
    double *scales;   /* owned: of each line, as of stored_samples; NULL: 1 */
    uint64_t first_place, line_bytes;
    enum stored_type type;
    bool is_transposed; /* they are columns */
    bool is_reversed;   /* column 0 is the last of its line */
    bool clips;         /* as of stored_samples */
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
    struct recording recording;
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

/* ROW(name, files of it): NAME_format is what there is of it, in a file that may have its name.
 * They are recognised in this order. */
#define SWATH_FORMATS(ROW)                                                                         \
    ROW(xtf, "XTF")                                                                                \
    ROW(jsf, "JSF")                                                                                \
    ROW(npy, "NumPy (.npy)")                                                                       \
    ROW(mat, "MATLAB (.mat)")                                                                      \
    ROW(image, "TIFF, PNG, JPEG")                                                                  \
    ROW(hdf5, "HDF5")

#define FORMAT_DECLARATION(name, files) extern const struct swath_format name##_format;
SWATH_FORMATS(FORMAT_DECLARATION)

/* Reading and copying of files of sample_lines. */
sonject_status sample_lines_read(struct report *report, struct swath_file *file,
                                 const struct region *region, void *pixels);
sonject_status sample_lines_copy(struct report *report, const struct swath_file *file,
                                 const struct swath_copy *copy);

/* Channels that a recording has, of which one is wanted. */
struct channel_list {
    int32_t wanted; /* SONJECT_CHANNEL_... or a number */
    uint32_t matches, found;
    char text[400]; /* as messages list them */
};

/* of: what else tells the channel from others; NULL: nothing. */
void channel_list_add(struct channel_list *list, uint32_t number, uint32_t side, const char *of);

/* INPUT unless just one channel is wanted: the one found. */
sonject_status channel_list_check(struct report *report, const char *path,
                                  const struct channel_list *list);

/* Makes a ping, whose samples begin at place, the image's next row. One without samples is noted
 * as empty and makes none. Errors: INPUT (other cells than the rows before), MEMORY. */
sonject_status recording_add(struct report *report, struct swath_file *file,
                             const struct recorded_ping *ping, uint64_t place, uint64_t samples);

/* Little-endian numbers of a recording: of 1 to 4 bytes, and floats of 4 or 8, 0 where they are not
 * finite. */
uint32_t word_at(const unsigned char *bytes, size_t place, size_t size);
double finite_at(const unsigned char *bytes, size_t place, size_t size);

/* INPUT: what is wrong at a place of the file. */
sonject_status recording_damaged(struct report *report, const struct swath_file *file,
                                 uint64_t place, const char *what);

/* Copies bytes first...end of the file to where out stands. */
sonject_status swath_copy_bytes(struct report *report, const struct swath_file *file,
                                const struct swath_copy *copy, uint64_t first, uint64_t end,
                                FILE *out);

/* Closes a file that was written; status: of what was done with it. */
sonject_status swath_close_copy(struct report *report, const struct swath_copy *copy, FILE *out,
                                sonject_status status);

void mat_array_release(struct mat_array **array);

#endif
