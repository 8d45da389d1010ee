/* Interface to libtiff, libpng, libjpeg and HDF5. The decoder (swath/decoder.h) reads and changes
 * images by them, and new images are written by them. */
#ifndef SONJECT_SWATH_IMAGE_LIBRARY_H
#define SONJECT_SWATH_IMAGE_LIBRARY_H

#include <stdio.h>

#include "image/raster.h"
#include "swath/image_head.h"

#define DESCRIPTION_MAX ((size_t)1 << 16) /* bytes of a kept description, its 0 included */

/* The fault that a library reported; all 0: none yet. */
struct library_fault {
    char message[256];
    int error; /* errno at the fault; 0: not the system's fault */
};

struct image_facts {
    struct raster_layout layout;
    uint32_t largest;     /* the largest number allowed; 0: the type's */
    bool is_column_major; /* the file stores column after column */
    int jpeg_quality;     /* see swath_file_jpeg_quality */
    /* texts in the image, each a line "name=value"; for free(); NULL: none */
    char *description;
};

struct image_library {
    /* path: the file; name: its name in messages; both stay until close. array: NULL for the only
     * one. writes: the file is a copy to be changed. *image (NULL: none) and facts->description are
     * the caller's, on failure too. */
    sonject_status (*open)(struct report *report, const char *name, const char *path,
                           const char *array, bool writes, void **image, struct image_facts *facts);
    /* completes the changes to the file and frees image, whatever is returned */
    sonject_status (*close)(struct report *report, void *image);
    /* reads the samples of a region, row after row */
    sonject_status (*read)(struct report *report, void *image, const struct region *region,
                           void *pixels);
    /* changes samples; float64 numbers keep their bits if they read as the same float32. NULL:
     * copies are new images */
    sonject_status (*change)(struct report *report, void *image, const struct region *region,
                             const void *pixels);
};

/* Data sets of HDF5 files (swath/hdf5_array.c). Calls must be between hdf5_enter and hdf5_leave. */
extern const struct image_library hdf5_library;

/* TIFF, PNG and JPEG images (swath/<name>_file.c). Only TIFF files are changed; copies of others
 * are new images. Opening refuses (INPUT) what cannot be read, files that are cut short, palettes
 * other than of numbers, more than one channel (TIFF: two), and in PNG and JPEG all but 8 or 16
 * bits. Opening a TIFF does not decode pixels. Changed tiles or strips that no longer fit in their
 * place go to the end of the file. All tags, other pages and untouched blocks stay. */
extern const struct image_library tiff_library, png_library, jpeg_library;

/* An image file to be written. */
struct image_encoding {
    const char *path;
    const char *name; /* name of the finished file, for messages */
    enum image_kind kind;
    struct raster_layout layout;
    const char *description; /* a text that the file keeps; "": none */
    bool is_drawn;           /* a mask or a picture, not an image of measured pixels */
    const uint8_t *palette;  /* PNG: PNG_PALETTE_BYTES of colours for 8 bit numbers; NULL: grey */
    /* gives the pixels of rows first...end - 1 */
    sonject_status (*give_rows)(void *user, uint64_t first, uint64_t end, void *pixels);
    void *user;
    int quality; /* JPEG's, 1...100; 0: that for a whole swath */
};

/* Gives an image's rows to a library's `put`, in strips of at most about 64 MB. *are_put is false
 * if `put` failed. Errors: MEMORY, those of give_rows. */
sonject_status encode_rows(struct report *report, const struct image_encoding *encoding,
                           bool (*put)(void *output, const unsigned char *rows, uint64_t count),
                           void *output, bool *are_put);

/* Reports a library's fault. Returns STORAGE or MEMORY. */
sonject_status encoding_failure(struct report *report, const struct image_encoding *encoding,
                                const struct library_fault *fault);

/* Closes a file that a library wrote (NULL: it could not be opened) and reports what failed.
 * status: the outcome of encode_rows. */
sonject_status encoding_end(struct report *report, const struct image_encoding *encoding,
                            FILE *file, struct library_fault *fault, bool is_written,
                            sonject_status status);

/* Writes an image in strips of at most about 64 MB. On failure the caller removes the file. Errors:
 * STORAGE, MEMORY, UNSUPPORTED (a description that is too long), those of give_rows. */
sonject_status tiff_encode(struct report *report, const struct image_encoding *encoding);
sonject_status png_encode(struct report *report, const struct image_encoding *encoding);
sonject_status jpeg_encode(struct report *report, const struct image_encoding *encoding);

#endif
