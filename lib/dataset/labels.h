/* What labels say of the objects in an image file, and the formats that say it. */
#ifndef SONJECT_DATASET_LABELS_H
#define SONJECT_DATASET_LABELS_H

#include <jansson.h>

#include "base/report.h"
#include "image/raster.h"
#include "inject/injection.h"
#include "swath/recording.h"

/* The classes of a data set, numbered from 0 in the order in which they are first taken. Starts as
 * all zeros. */
struct class_names {
    char **names; /* owned */
    uint32_t count;
};

/* The number of the class of that name, which is new if there was none. Errors: MEMORY. */
sonject_status class_names_take(struct class_names *classes, struct report *report,
                                const char *name, uint32_t *number);
void class_names_clear(struct class_names *classes);

/* An object of the scene in the image. Rows and columns are the image file's. */
struct contact {
    uint32_t number; /* among the scene's objects, from 1: its value in the labels */
    const sonject_object_params *object; /* the scene's */
    const sonject_object_truth *truth;   /* the result's */
    uint32_t class_number;
    double row, column; /* of its centre */
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
    bool is_difficult; /* it is seen less than a campaign's targets are to be */
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
    const char *file_name;  /* of the image, as labels are to name it */
    uint64_t rows, columns; /* of the image, which track and geometry describe */
    struct region patch;    /* where the result lies in the image */
    const struct track *track;
    uint32_t count; /* of the scene's objects, the first, that are labelled */
};

/* Finds the labels and takes their classes; scene, result and names must outlive them. Errors:
 * MEMORY. On success to be given to image_labels_clear; on failure nothing is held. */
sonject_status image_labels_find(struct image_labels *labels, struct report *report,
                                 const struct label_request *request, struct class_names *classes);
void image_labels_clear(struct image_labels *labels);

enum label_file {
    LABEL_COCO,     /* boxes, and masks as runs */
    LABEL_CONTACTS, /* CSV: where each object lies and how large it is */
    LABEL_YOLO,     /* "class centre_x centre_y width height", fractions of the image's sides */
    LABEL_CLASSES,  /* names, one a line */
    LABEL_VOC       /* Pascal VOC's XML, whole pixels counted from 1 */
};
#define LABEL_FILES (LABEL_VOC + 1)

/* Writes the labels as such a file. COCO, YOLO and VOC have the contacts of which something is
 * seen. Errors: STORAGE, MEMORY. */
sonject_status labels_write(struct report *report, const struct image_labels *labels,
                            const struct class_names *classes, enum label_file file,
                            const char *path);

/* COCO's annotations of the image, numbered from 1, as those of image 1; NULL: memory is out. */
json_t *coco_annotations(const struct image_labels *labels);

/* COCO's entry of an image, and of a class. */
json_t *coco_image(uint64_t id, const char *name, uint64_t rows, uint64_t columns);
json_t *coco_category(uint64_t id, const char *name);

#endif
