/* The decoder reads and changes files with libraries of others, such as libtiff and HDF5. It runs
 * as a child process, the program sonject-decoder, within limits of memory and time. A file that
 * crashes the child fails one call, and the next call starts another child. A context has at most
 * one child, or none if it decodes in this process.
 *
 * Library and child exchange records over a channel: a request and its bytes, then a reply and its
 * bytes. Nothing in a reply is trusted. */
#ifndef SONJECT_SWATH_DECODER_H
#define SONJECT_SWATH_DECODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sonject/context.h>

#include "base/report.h"
#include "base/system/child.h"
#include "base/system/process.h"
#include "image/raster.h"

#define DECODER_PROGRAM      "sonject-decoder" PROGRAM_ENDING
#define DECODER_STRANGER     2                   /* exit status of another version's child */
#define DECODER_MEMORY_BYTES ((uint64_t)2 << 30) /* limit of the child's memory */
#define DECODER_CPU_S        60                  /* limit of processor time for a request */
#define DECODER_SILENCE_S    120                 /* silence after which the child counts as stuck */
#define DECODER_FILES_MAX    256                 /* files open at once */
#define DECODER_PIECE_BYTES  ((size_t)16 << 20)  /* samples in a request, or one longer line */

/* Requests. `in`: the request's bytes; `out`: the reply's bytes. An image is a raster file or an
 * array of an HDF5 file. */
enum decoder_function {
    DECODER_OPEN_IMAGE, /* in: name for messages, path, array ("": the only one), each with a 0; ->
                           handle, layout, largest, is_column_major; out: description with a 0, or
                           none */
    DECODER_OPEN_COPY,  /* DECODER_OPEN_IMAGE for a copy that is written to */
    DECODER_CLOSE,      /* handle: afterwards all that was written to a copy is in the file */
    DECODER_READ,       /* handle, region -> out: samples, row after row */
    DECODER_WRITE,      /* handle of a copy, region; in: samples */
    DECODER_FUNCTIONS
};

struct decoder_request {
    uint32_t function, handle;
    struct region region;
    uint64_t bytes; /* number of bytes that follow */
};

struct decoder_reply {
    int32_t status; /* a sonject_status; on failure the bytes are the message */
    uint32_t handle;
    struct raster_layout layout;
    uint32_t largest;         /* 0: the type's maximum */
    uint32_t is_column_major; /* the file stores column after column */
    int32_t jpeg_quality;
    uint64_t bytes; /* number of bytes that follow */
};

/* Returns the path of the program, for free(); NULL if out of memory. Looks in three places: the
 * folder sonject beside the library (or beside the host's program that contains the library), right
 * beside the library (Python's package, the build), and where sonject was installed. In tests the
 * folder is BUILT_FOLDER. */
char *decoder_path(void);

/* Makes the text that must be the child's first argument. */
void decoder_stamp(char stamp[64]);

/* Receives bytes from the other side. On failure returns false and sets errno: 0 if the other side
 * is gone, EAGAIN if it is silent for too long, ECANCELED if the caller has cancelled. */
bool decoder_receive(const struct report *report, const struct channel *channel, void *bytes,
                     size_t count);

/* The open files of a decoder, in the process that decodes. */
struct decoder_state;
struct decoder_state *decoder_state_make(void); /* NULL: out of memory */
void decoder_state_release(struct decoder_state **state);

/* Answers a request in this process. in: request->bytes bytes. *out: reply->bytes bytes, for
 * free(); NULL if there are none or the call failed. */
sonject_status decoder_answer(struct report *report, struct decoder_state *state,
                              const struct decoder_request *request, const void *in,
                              struct decoder_reply *reply, void **out);

/* A context's decoder. All 0: not started. */
struct decoder {
    bool is_in_process;
    struct decoder_state *state; /* for decoding in this process; NULL: not needed yet */
    struct child child;
    uint32_t starts; /* number of children started so far */
};

/* Ends the decoder if it runs. Its open files are lost. */
void decoder_stop(struct decoder *decoder);

/* Starts the child if one is needed and none of this process runs; after a fork the parent's child
 * does not count. path: the file that needs the child, for messages. Errors: UNSUPPORTED (no
 * program), STORAGE, MEMORY. */
sonject_status decoder_start(struct report *report, struct decoder *decoder, const char *path);

/* Sends a request and waits for the reply. out: room for capacity bytes; a longer reply is refused.
 * *count: bytes received. reply: all but the bytes. Errors: those of decoder_answer; INPUT (the
 * file ended the decoder), STORAGE, MEMORY, CANCELLED. */
sonject_status decoder_ask(struct report *report, struct decoder *decoder, const char *path,
                           const struct decoder_request *request, const void *in,
                           struct decoder_reply *reply, void *out, size_t capacity, size_t *count);

/* An image that a decoder has open. */
struct decoded_image {
    char *path;     /* owned; the name that the caller gave */
    char *array;    /* owned; the array's name; NULL: the only one */
    uint64_t bytes; /* size of the file */
    struct decoder *decoder;
    struct decoder own; /* used if the report has no host */
    uint32_t handle, start;
    struct raster_layout layout;
    uint32_t largest;     /* the largest number allowed; 0: the type's */
    bool is_column_major; /* the file stores column after column */
    int jpeg_quality;     /* see swath_file_jpeg_quality */
    char *description;    /* owned; texts in the image, each a line "name=value"; NULL: none */
};

/* Opens an image. path: the file, and its name in messages. array: see swath_file_open_array.
 * Errors: INPUT (not a regular file, damaged, more samples than the file can hold, other files that
 * opening refuses), STORAGE (errors of the system), MEMORY, UNSUPPORTED (no decoder). On success
 * *image is the caller's, for decoded_image_close; on failure *image is NULL. */
sonject_status decoded_image_open(struct report *report, const char *path, const char *array,
                                  struct decoded_image **image);
void decoded_image_close(struct decoded_image **image);

/* Reads the samples of a region, row after row. Errors: INPUT, STORAGE, MEMORY. */
sonject_status decoded_image_read(struct report *report, struct decoded_image *image,
                                  const struct region *region, void *pixels);

#endif
