/* What labels say of the objects in an image file, whatever the label's format. */
#ifndef SONJECT_LABEL_IMAGE_LABELS_H
#define SONJECT_LABEL_IMAGE_LABELS_H

#include "image/raster.h"
#include "inject/injection.h"
#include "io/track.h"

/* An object of the scene in the image. Rows and columns are the image file's. */
struct contact {
    uint32_t number;               /* among the scene's objects, from 1: its value in the labels */
    const char *name, *class_name; /* the scene's */
    double confidence;             /* 1: it is known */
    double row, column;            /* of its centre */
    double along_track_m, slant_range_m, ground_range_m, height_m;
    double length_m, width_m, body_height_m; /* overall, its own axes */
    double heading_deg;                      /* from along-track towards range */
    bool has_place;
    struct place place; /* of its centre; the heading is the sonar's */
    /* What the labels show of it: highlight and shadow, less what other objects take. */
    uint64_t pixels; /* 0: nothing, and the rest is empty */
    sonject_box box; /* around them */
    uint64_t *runs;  /* pixels outside and inside of it by turns, column after column of the whole
                        image, the first outside; owned */
    size_t run_count;
    bool is_truncated; /* highlight or shadow reaches the edge of what was injected into */
    bool is_occluded;  /* other objects take some of its pixels */
};

struct image_labels {
    const char *file_name; /* borrowed */
    uint64_t rows, columns;
    bool is_geographic; /* what places are */
    struct contact *contacts;
    uint32_t count;
};

/* Where a result lies. All is borrowed. */
struct label_request {
    const struct scene *scene;
    const struct injection_result *result;
    const char *file_name;            /* of the image, as labels are to name it */
    uint64_t rows, columns;           /* of the image */
    struct region patch;              /* where the result lies in the image */
    uint64_t first_row, first_column; /* of the image in the swath that track and geometry describe
                                       */
    const struct track *track;        /* NULL or empty: none is known */
};

/* Finds the labels; scene and names must outlive them. Errors: MEMORY. On success to be given to
 * image_labels_clear; on failure nothing is held. */
sonject_status image_labels_find(struct image_labels *labels, struct report *report,
                                 const struct label_request *request);
void image_labels_clear(struct image_labels *labels);

#endif
