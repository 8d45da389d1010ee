/* Libraries of others that read, change and write images, as the decoder (swath/decoder.h) and
 * those that write new images use them: libtiff, libpng, libjpeg and HDF5. */
#ifndef SONJECT_SWATH_IMAGE_LIBRARY_H
#define SONJECT_SWATH_IMAGE_LIBRARY_H

#include <stdio.h>

#include "image/raster.h"
#include "swath/image_head.h"

#define DESCRIPTION_MAX ((size_t)1 << 16) /* bytes of one that is kept, its final 0 among them */

/* What a library said of what went wrong; all 0 before. */
struct library_fault {
    char message[256];
    int error; /* errno then; 0: not the system's fault */
};

struct image_facts {
    struct raster_layout layout;
    uint32_t largest; /* that it may hold; 0: its type's */
    bool is_turned;   /* columns lie together in the file */
    int jpeg_quality; /* as of swath_file_jpeg_quality */
    /* what is stored with the image: texts, each a line "name=value"; for free(); NULL: none */
    char *description;
};

struct image_library {
    /* path: the file; name: of it in messages; both stay until it is closed; array: NULL for the
     * only one; writes: it is a copy to be changed. *image, unless it stays NULL, and
     * facts->description are the caller's, on failure too. */
    sonject_status (*open)(struct report *report, const char *name, const char *path,
                           const char *array, bool writes, void **image, struct image_facts *facts);
    /* brings what was changed to the file; *image is gone, whatever is returned */
    sonject_status (*close)(struct report *report, void *image);
    /* samples of a region, row after row; a float64 that stays the same as float32 keeps its bits
     */
    sonject_status (*read)(struct report *report, void *image, const struct region *region,
                           void *pixels);
    /* NULL: copies are new images */
    sonject_status (*change)(struct report *report, void *image, const struct region *region,
                             const void *pixels);
};

/* Data sets of HDF5 files (swath/hdf5_array.c). Calls come between hdf5_enter and hdf5_leave. */
extern const struct image_library hdf5_library;

/* Images by the files swath/<name>_file.c. TIFF alone is changed; copies of
 * others are new images. All refuse (INPUT) what they cannot read, files that are cut short,
 * palettes but for those of numbers, more than one channel (TIFF: two), and of others than TIFF
 * what is not of 8 or 16 bits. Of TIFF, pixels are not decoded then; changed tiles or strips that
 * no longer fit in their place go behind the end of the file, and all tags, other pages and
 * untouched blocks stay. */
extern const struct image_library tiff_library, png_library, jpeg_library;

/* A file that is to be written. */
struct image_encoding {
    const char *path;
    const char *name; /* of the finished file, for messages */
    enum image_kind kind;
    struct raster_layout layout;
    const char *description; /* a text that the file keeps; "": none */
    bool is_drawn;           /* a mask or a picture, not an image of measured pixels */
    const uint8_t *palette;  /* of PNG: PNG_PALETTE_BYTES, colours of 8 bit numbers; NULL: grey */
    /* gives the pixels of rows first...end */
    sonject_status (*give_rows)(void *user, uint64_t first, uint64_t end, void *pixels);
    void *user;
    int quality; /* of JPEG, 1...100; 0: as a whole swath's should be */
};

/* Gives an image's rows to a library's `put`, in strips of at most about 64 MB. *are_put: false
 * where `put` answered that it failed. Errors: MEMORY, those of give_rows. */
sonject_status encode_rows(struct report *report, const struct image_encoding *encoding,
                           bool (*put)(void *output, const unsigned char *rows, uint64_t count),
                           void *output, bool *are_put);

/* The status of a library's fault: STORAGE or MEMORY. */
sonject_status encoding_failure(struct report *report, const struct image_encoding *encoding,
                                const struct library_fault *fault);

/* Closes a file that a library wrote, NULL where it could not be opened, and tells what failed.
 * status: of the rows. */
sonject_status encoding_end(struct report *report, const struct image_encoding *encoding,
                            FILE *file, struct library_fault *fault, bool is_written,
                            sonject_status status);

/* Stream in strips of at most about 64 MB. What failed is left to the caller to remove. Errors:
 * STORAGE, MEMORY, UNSUPPORTED (a description that is too long), those of give_rows. */
sonject_status tiff_encode(struct report *report, const struct image_encoding *encoding);
sonject_status png_encode(struct report *report, const struct image_encoding *encoding);
sonject_status jpeg_encode(struct report *report, const struct image_encoding *encoding);

#endif
