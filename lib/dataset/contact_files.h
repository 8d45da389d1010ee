/* Labelled contacts from files: COCO, YOLO, VOC, contacts.csv, or quantiles without any image. */
#ifndef SONJECT_DATASET_CONTACT_FILES_H
#define SONJECT_DATASET_CONTACT_FILES_H

#include <sonject/result.h>

#include "base/report.h"

/* The part of a contact that a label's box is around. */
enum labelled_part {
    LABELLED_BOTH, /* highlight and shadow in one box */
    LABELLED_HIGHLIGHT,
    LABELLED_SHADOW
};

/* A labelled contact, in rows and columns of the image file. A highlight and its shadow that have a
 * box each are one contact. */
struct labelled_contact {
    uint32_t image; /* number in the set's list */
    uint32_t part;  /* enum labelled_part that the box is around */
    uint32_t side;  /* enum recorded_side of a recording; 0: not given */
    sonject_box box;
    uint64_t image_rows, image_columns; /* size of the image as its labels tell it; 0: not told */
    uint32_t seen_side; /* side that the image shows there; 0: unknown, or the image shows one */
    bool is_reversed;   /* range grows to the left there */
};

/* Quantiles of the extents of highlights and shadows. */
struct extent_quantiles {
    double levels[32];       /* shares of all contacts, 0...1, ascending */
    size_t count;            /* number of levels; 0: no quantiles */
    double contacts;         /* number of contacts behind the quantiles */
    double extents_m[4][32]; /* highlight along, highlight range, shadow along, shadow range
                                (slant); NaN: not given */
};

struct contact_set {
    char **images; /* paths to open, each once; owned */
    size_t image_count;
    struct labelled_contact *contacts; /* owned */
    size_t count;
    struct extent_quantiles quantiles; /* given instead of contacts */
};

/* The choice of the labels to read. */
struct contact_choice {
    uint32_t part;              /* enum labelled_part of classes whose names do not tell it */
    const char *const *classes; /* the classes to read; NULL: all */
    size_t class_count;
};

/* Reads labels: a COCO file (.json), a .csv file as sonject writes it or with the columns image,
 * row, column, rows, columns (and part, class or side), a folder of YOLO's texts or of VOC's XML,
 * or a .yaml file of quantiles. Where a folder has both, XML is read. YOLO's class names come from
 * classes.txt or data.yaml beside or above the texts; a class without a name is its number. A class
 * with "shadow", "highlight" or "echo" in its name tells the part; boxes of other classes are
 * around the choice's part. A note tells where several of these other classes are read together.
 * Each box is a contact so far. Images without contacts are not listed. Images are looked for
 * beside the labels, in "images" below or beside the labels, and where data sets keep them. set:
 * for contact_set_clear, also on failure. Errors: INPUT (file, line or member, what is wrong),
 * UNSUPPORTED, STORAGE, MEMORY. */
sonject_status contact_set_read(struct report *report, const char *path,
                                const struct contact_choice *choice, struct contact_set *set);

/* Makes a shadow's box and the nearest highlight's box one contact, if both share rows of an image
 * and its side, and the highlight does not begin behind the shadow, columns counting slant range.
 * A box without a partner stays as it is. Of equal labels one counts, and a note tells how many do
 * not. Needs seen_side and is_reversed. Contacts are then in the order of image, side, row and
 * column. */
void contact_set_pair(struct report *report, struct contact_set *set);

void contact_set_clear(struct contact_set *set);

#endif
