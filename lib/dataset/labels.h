/* Labels of the objects in an image file, and the formats of label files. */
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

/* Finds the number of the class of that name, and adds the class if it is new. Errors: MEMORY. */
sonject_status class_names_take(struct class_names *classes, struct report *report,
                                const char *name, uint32_t *number);
void class_names_clear(struct class_names *classes);

/* An object of the scene in the image. Rows and columns count the image file's pixels. */
struct contact {
    uint32_t number; /* number among the scene's objects, from 1, and in the labels */
    const sonject_object_params *object; /* the scene's */
    const sonject_object_truth *truth;   /* the result's */
    uint32_t class_number;
    double row, column; /* place of its centre */
    bool has_place;
    struct place place; /* place of its centre on the map, with the sonar's heading */
    /* Pixels in the labels: highlight and shadow, less the pixels that other objects take. */
    uint64_t pixels; /* number; 0: none, and the members below are empty */
    sonject_box box; /* box around the pixels */
    uint64_t *runs; /* numbers of pixels outside and inside the object by turns, column after column
                       of the whole image, the first outside; owned */
    size_t run_count;
    bool is_truncated; /* highlight or shadow reaches the edge of the patch, or lies outside */
    bool is_occluded;  /* other objects hide some of its pixels */
    bool is_difficult; /* less visible than a campaign asks */
};

struct image_labels {
    const char *file_name; /* borrowed */
    uint64_t rows, columns;
    bool is_geographic; /* places are in degrees */
    struct contact *contacts;
    uint32_t count;
};

/* A result and its place in an image. All pointers are borrowed. */
struct label_request {
    const struct scene *scene;
    const struct injection_result *result;
    const char *file_name;  /* the image's name in labels */
    uint64_t rows, columns; /* size of the image that track and geometry describe */
    struct region patch;    /* place of the result in the image */
    const struct track *track;
    uint32_t count; /* number of the scene's first objects that are labelled */
};

/* Finds the labels and takes their classes. Scene, result and class names must outlive the labels.
 * On success for image_labels_clear; on failure nothing is held. Errors: MEMORY. */
sonject_status image_labels_find(struct image_labels *labels, struct report *report,
                                 const struct label_request *request, struct class_names *classes);
void image_labels_clear(struct image_labels *labels);

enum label_file {
    LABEL_COCO,     /* boxes, and masks as runs */
    LABEL_CONTACTS, /* CSV with place and size of each object */
    LABEL_YOLO,     /* "class centre_x centre_y width height", fractions of the image's sides */
    LABEL_CLASSES,  /* names, one a line */
    LABEL_VOC       /* Pascal VOC's XML, whole pixels counted from 1 */
};
#define LABEL_FILES (LABEL_VOC + 1)

/* Writes the labels as a file of that kind. COCO, YOLO and VOC have only contacts with pixels that
 * are seen. Errors: STORAGE, MEMORY. */
sonject_status labels_write(struct report *report, const struct image_labels *labels,
                            const struct class_names *classes, enum label_file file,
                            const char *path);

/* Returns COCO's annotations, numbered from 1, for image 1; NULL where memory is out. */
json_t *coco_annotations(const struct image_labels *labels);

/* Return COCO's entry of an image, and of a class. */
json_t *coco_image(uint64_t id, const char *name, uint64_t rows, uint64_t columns);
json_t *coco_category(uint64_t id, const char *name);

#endif
