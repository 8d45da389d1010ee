/* Contacts that somebody has labelled, as their files tell them: COCO, YOLO, VOC, contacts.csv, or
 * published quantiles without any image. */
#ifndef SONJECT_DATASET_CONTACT_FILES_H
#define SONJECT_DATASET_CONTACT_FILES_H

#include <sonject/result.h>

#include "base/report.h"

/* What a label's box is around. */
enum labelled_part {
    LABELLED_BOTH, /* highlight and shadow in one box */
    LABELLED_HIGHLIGHT,
    LABELLED_SHADOW
};

/* Rows and columns are the image file's. A highlight and its shadow that have a box each are one
 * contact. */
struct labelled_contact {
    uint32_t image;  /* number in the set's list */
    uint32_t part;   /* enum labelled_part: of which box is */
    uint32_t side;   /* enum recorded_side, of a recording; 0: not told */
    sonject_box box; /* around the part, or around both */
};

/* Extents of highlights and shadows at which a share of all contacts lies below. */
struct extent_quantiles {
    double levels[32];       /* ascending, in 0...1 */
    size_t count;            /* of levels; 0: none are told */
    double contacts;         /* that they were read off */
    double extents_m[4][32]; /* highlight along, highlight range, shadow along, shadow range
                                (slant); NaN: not told */
};

struct contact_set {
    char **images; /* paths to open, each once; owned */
    size_t image_count;
    struct labelled_contact *contacts; /* owned */
    size_t count;
    struct extent_quantiles quantiles; /* instead of contacts */
};

/* What is read of labels. */
struct contact_choice {
    uint32_t part;              /* enum labelled_part: of classes whose names do not tell it */
    const char *const *classes; /* of these alone; NULL: of all */
    size_t class_count;
};

/* Reads labels: a COCO file (.json), a .csv file as sonject writes it or with the columns image,
 * row, column, rows, columns (and part, class or side), a folder of YOLO's texts (classes' names
 * from classes.txt or data.yaml beside or above them, if there is one) or of VOC's XML, which is
 * read where both are there, or a .yaml file of quantiles. Classes with "shadow", "highlight" or
 * "echo" in their names tell the part; any other class's boxes are around the choice's. A class
 * that YOLO does not name is its number. Where several others are read together, a note tells. A
 * shadow's box and the highlight's box nearest to it are one contact where both are of the same
 * rows of an image and the highlight does not begin behind the shadow, columns counting slant
 * range; what finds no other part stays as it is. Contacts are in the order of image, row and
 * column; images without contacts are not listed. They are looked for beside the labels, in
 * "images" below or beside them, and as data sets lie. set: for contact_set_clear, also on failure.
 * Errors: INPUT (file, line or member, what is wrong), UNSUPPORTED, STORAGE, MEMORY. */
sonject_status contact_set_read(struct report *report, const char *path,
                                const struct contact_choice *choice, struct contact_set *set);
void contact_set_clear(struct contact_set *set);

#endif
