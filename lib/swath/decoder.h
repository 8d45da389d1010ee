/* Files that libraries of others decode, and change. A child process does it, the program
 * sonject-decoder, within limits of memory and time: a file that ends it ends one call, and the
 * next one starts another child. A context has one at most (or none: it decodes in this process).
 *
 * The two pass records over a channel: a request and its bytes there, a reply and its bytes back,
 * one after the other. Nothing that comes back is believed. */
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
#define DECODER_STRANGER     2                   /* its exit status if it is not this library's */
#define DECODER_MEMORY_BYTES ((uint64_t)2 << 30) /* of the child, all told */
#define DECODER_CPU_S        60                  /* for a request */
#define DECODER_SILENCE_S    120                 /* after which it is taken for stuck */
#define DECODER_FILES_MAX    256                 /* open at once */
#define DECODER_PIECE_BYTES  ((size_t)16 << 20)  /* of samples in a request, or one line */

/* What is asked. `in`: the request's bytes, `out`: the reply's. An image is a raster file,
 * or an array of an HDF5 file. */
enum decoder_function {
    DECODER_OPEN_IMAGE, /* in: its name, where it lies, the array ("": the only one), each text with
                           its 0; -> handle, layout, largest, is_turned; out: description, with its
                           0; none: it has none */
    DECODER_OPEN_COPY,  /* the same, to be written to */
    DECODER_CLOSE,      /* handle: all that was written to a copy is to be in the file */
    DECODER_READ,       /* handle, region -> out: its samples, row after row */
    DECODER_WRITE,      /* handle of a copy, region; in: samples */
    DECODER_FUNCTIONS
};

struct decoder_request {
    uint32_t function, handle;
    struct region region;
    uint64_t bytes; /* that follow */
};

struct decoder_reply {
    int32_t status; /* a sonject_status; unless it is OK, the bytes are its message */
    uint32_t handle;
    struct raster_layout layout;
    uint32_t largest;   /* 0: of its type */
    uint32_t is_turned; /* columns lie together in the file */
    int32_t jpeg_quality;
    uint64_t bytes; /* that follow */
};

/* The path of the program: in the folder sonject beside the library (beside the host's program,
 * where the library is part of it); right beside it, as in Python's package and where it was built;
 * or where sonject was installed. Tests are told where (BUILT_FOLDER). To be given to free(); NULL
 * when memory is out. */
char *decoder_path(void);

/* What the child's first argument must be. */
void decoder_stamp(char stamp[64]);

/* Bytes from the other; false with errno where it is gone (0) or silent for too long, or the caller
 * has cancelled (ECANCELED). */
bool decoder_receive(const struct report *report, const struct channel *channel, void *bytes,
                     size_t count);

/* The files that one decoder has open, in the process that decodes. */
struct decoder_state;
struct decoder_state *decoder_state_make(void); /* NULL: memory is out */
void decoder_state_release(struct decoder_state **state);

/* Does what is asked, here. in: of request->bytes. *out: reply->bytes of it, to be given to free();
 * NULL: none, or the call failed. */
sonject_status decoder_answer(struct report *report, struct decoder_state *state,
                              const struct decoder_request *request, const void *in,
                              struct decoder_reply *reply, void **out);

/* All 0: none is started. */
struct decoder {
    bool is_in_process;
    struct decoder_state *state; /* in this process; NULL: none is needed yet */
    struct child child;
    uint32_t starts; /* how often */
};

/* Ends it, if there is one. What it had open is lost. */
void decoder_stop(struct decoder *decoder);

/* Starts the child if it is needed and does not run, as one of another process does not. path: the
 * file that needs it, for messages. Errors: UNSUPPORTED (no program), STORAGE, MEMORY. */
sonject_status decoder_start(struct report *report, struct decoder *decoder, const char *path);

/* Asks. out: room for capacity bytes, of which *count came; more are refused. reply: all but the
 * bytes. Errors: as decoder_answer's; INPUT (the file ended the decoder), STORAGE, MEMORY,
 * CANCELLED. */
sonject_status decoder_ask(struct report *report, struct decoder *decoder, const char *path,
                           const struct decoder_request *request, const void *in,
                           struct decoder_reply *reply, void *out, size_t capacity, size_t *count);

/* An image that a decoder has open. */
struct decoded_image {
    char *path;     /* as the caller named it; owned */
    char *array;    /* which of the file; NULL: the only one */
    uint64_t bytes; /* how long the file is */
    struct decoder *decoder;
    struct decoder own; /* where the report has no host */
    uint32_t handle, start;
    struct raster_layout layout;
    uint32_t largest;  /* that it may hold; 0: its type's */
    bool is_turned;    /* columns lie together in the file */
    int jpeg_quality;  /* as of swath_file_jpeg_quality */
    char *description; /* texts that are stored with it, each a line "name=value"; NULL: none */
};

/* path: its name in messages, and the file. array: as of swath_file_open_array. Errors: INPUT (not
 * a regular file, damaged, more samples than the file can hold, what opening refuses), STORAGE (the
 * system's), MEMORY, UNSUPPORTED (no decoder). On success *image is the caller's, for
 * decoded_image_close; on failure NULL. */
sonject_status decoded_image_open(struct report *report, const char *path, const char *array,
                                  struct decoded_image **image);
void decoded_image_close(struct decoded_image **image);

/* Samples of a region of the image, row after row. Errors: INPUT, STORAGE, MEMORY. */
sonject_status decoded_image_read(struct report *report, struct decoded_image *image,
                                  const struct region *region, void *pixels);

#endif
