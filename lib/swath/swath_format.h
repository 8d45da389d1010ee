/* File formats, each a row of the table SWATH_FORMATS, and what they share: samples in a file's
 * types and byte order, and lists of a file's arrays or channels. */
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

/* Returns the number whose bits these are: a float (count 4) or a double (count 8). */
double float_from_bytes(const unsigned char *bytes, size_t count, bool is_big_endian);

/* The samples of a part of an image in memory, in the file's types and byte order. */
struct stored_samples {
    unsigned char *bytes[2];         /* the first sample of each channel */
    enum stored_type types[2];       /* the type of each channel */
    ptrdiff_t row_step, column_step; /* distances of neighbours, in samples */
    bool is_big_endian;
    bool are_amplitudes; /* integer samples must not be negative */
    bool clips;          /* numbers beyond an integer type are clipped, else refused */
    bool is_exact;       /* integers that float32 would round are refused when they are read */
    uint64_t *clipped;   /* counts clipped numbers; NULL: nobody asks */
    double scale;        /* an image's number over the file's; 0 stands for 1 */
    uint32_t largest;    /* the largest number that may be written; 0: the type's */
};

/* Moves the samples of part between a file and an image, whose pixels are the region's, row after
 * row. writes: from the image to the file. A stored number that already reads as the given float32
 * keeps its bits; others are rounded if the type is an integer. path: for messages. Errors: INPUT
 * (a sample that the other side cannot hold; says where). */
sonject_status samples_exchange(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct stored_samples *stored, const struct region *part,
                                const struct region *region, void *pixels, bool writes);

/* Converts a number to another type, which must be able to hold the number. */
void samples_convert(enum stored_type from_type, const unsigned char *from, enum stored_type type,
                     unsigned char *to, bool is_big_endian);

struct array_list {
    const char *wanted; /* a name; NULL: the only array that may be an image */
    unsigned matches;   /* number of arrays that are wanted */
    unsigned count;
    char text[600]; /* the list of arrays for messages */
};

/* Notes an array; returns true if it is wanted. may_be_image: the array has numbers in several rows
 * and columns, or cannot be opened, so that nobody knows. Other arrays are wanted only by name, and
 * not listed. rows: 0 for an array that sonject does not read. */
bool array_list_add(struct array_list *list, const char *name, uint64_t rows, uint64_t columns,
                    bool may_be_image);

/* Returns INPUT unless exactly one array is wanted. */
sonject_status array_list_check(struct report *report, const char *path,
                                const struct array_list *list);

/* Lines of samples in a recording or NumPy file: an image's rows, or its columns. */
struct sample_lines {
    uint64_t *places; /* owned; file offset of each line's first sample; NULL: line_bytes apart */
    double *scales;   /* owned; scale of each line, see stored_samples; NULL: 1 */
    uint64_t first_place, line_bytes;
    enum stored_type type;
    bool is_transposed; /* lines are columns */
    bool is_reversed;   /* column 0 is the last of its line */
    bool clips;         /* see stored_samples */
    bool is_exact;      /* see stored_samples */
    bool is_big_endian;
};

/* An open file. Members that only other formats need are 0. */
struct swath_file {
    const struct swath_format *format;
    char *path;
    FILE *stream; /* open for reading */
    uint64_t bytes;
    struct raster_layout layout;
    uint32_t largest; /* the largest number allowed, if less than the type's; else 0 */
    struct sample_lines lines;
    struct recording recording;
    struct mat_array *mat;
    enum image_kind image;
    struct decoded_image *decoded;
};

/* A copy that is being written. It is called part until it is complete, then path. */
struct swath_copy {
    const char *path, *part;
    const struct region *region; /* the region, inside the image, whose samples are replaced */
    const void *pixels;
    sonject_progress_function progress; /* may be NULL */
    void *user;
};

struct swath_format {
    bool has_channels, has_names;
    /* returns whether the file has this format, by head, its first count bytes */
    bool (*is_of)(struct swath_file *file, const unsigned char *head, size_t count);
    /* sets layout, largest and what the format needs; on failure the caller closes the file */
    sonject_status (*open)(struct report *report, struct swath_file *file, int32_t channel,
                           const char *array);
    sonject_status (*read)(struct report *report, struct swath_file *file,
                           const struct region *region, void *pixels);
    sonject_status (*copy)(struct report *report, const struct swath_file *file,
                           const struct swath_copy *copy);
};

/* ROW(name, files): the format NAME_format, and its files as messages call them. Formats are tried
 * in this order. */
#define SWATH_FORMATS(ROW)                                                                         \
    ROW(xtf, "XTF")                                                                                \
    ROW(jsf, "JSF")                                                                                \
    ROW(npy, "NumPy (.npy)")                                                                       \
    ROW(mat, "MATLAB (.mat)")                                                                      \
    ROW(image, "TIFF, PNG, JPEG")                                                                  \
    ROW(hdf5, "HDF5")

#define FORMAT_DECLARATION(name, files) extern const struct swath_format name##_format;
SWATH_FORMATS(FORMAT_DECLARATION)

/* Reads or copies a file of sample_lines. */
sonject_status sample_lines_read(struct report *report, struct swath_file *file,
                                 const struct region *region, void *pixels);
sonject_status sample_lines_copy(struct report *report, const struct swath_file *file,
                                 const struct swath_copy *copy);

/* The channels of a recording, from which one is chosen. */
struct channel_list {
    int32_t wanted; /* SONJECT_CHANNEL_... or a number */
    uint32_t matches, found;
    char text[400]; /* the list of channels for messages */
};

/* Notes a channel. of: a further text that tells the channel from others; NULL: none. */
void channel_list_add(struct channel_list *list, uint32_t number, uint32_t side, const char *of);

/* Returns INPUT unless exactly one channel is wanted. list->found is the channel's number. */
sonject_status channel_list_check(struct report *report, const char *path,
                                  const struct channel_list *list);

/* Appends a ping, whose samples begin at place, as the image's next row. A ping without samples is
 * noted as empty and makes no row. Errors: INPUT (range cells unlike earlier rows), MEMORY. */
sonject_status recording_add(struct report *report, struct swath_file *file,
                             const struct recorded_ping *ping, uint64_t place, uint64_t samples);

/* Shows samples as they are if the pings' weights are all the same. Else shows them as floats in
 * steps of the finest ping, and writing clips what is beyond a ping's samples. To be called when
 * all pings are known, with the layout of samples as they are. Errors: INPUT, MEMORY. */
sonject_status recording_set_scales(struct report *report, struct swath_file *file);

/* Reads little-endian numbers of a recording: unsigned integers of 1 to 4 bytes; floats of 4 or 8
 * bytes, 0 if not finite. */
uint32_t word_at(const unsigned char *bytes, size_t place, size_t size);
double finite_at(const unsigned char *bytes, size_t place, size_t size);

/* Reports what is wrong at a byte of the file. Returns INPUT. */
sonject_status recording_damaged(struct report *report, const struct swath_file *file,
                                 uint64_t place, const char *what);

/* Copies bytes first...end - 1 of the file to the current position of out. */
sonject_status swath_copy_bytes(struct report *report, const struct swath_file *file,
                                const struct swath_copy *copy, uint64_t first, uint64_t end,
                                FILE *out);

/* Closes a written file. Returns status (that of the writing) or the failure to close. */
sonject_status swath_close_copy(struct report *report, const struct swath_copy *copy, FILE *out,
                                sonject_status status);

void mat_array_release(struct mat_array **array);

#endif
