/* Labels on their way from their files into a set of contacts: what all formats share, and one
 * reader a format. */
#ifndef SONJECT_DATASET_CONTACT_READER_H
#define SONJECT_DATASET_CONTACT_READER_H

#include <jansson.h>

#include "base/file.h"
#include "dataset/contact_files.h"
#include "schema/tables.h"

#define LABEL_BYTES_MAX  ((size_t)64 << 20)          /* of a file */
#define LABEL_PLACE      (TABLE_FILE_CAPACITY + 100) /* bytes of a place in words */
#define IMAGE_FOLDERS    6                           /* in which images are looked for */
#define IMAGE_PIXELS_MAX ((uint64_t)1 << 40)         /* in a row or a column */

struct contact_reader {
    struct report *report;
    struct contact_set *set;
    const struct contact_choice *choice;
    char *folders[IMAGE_FOLDERS]; /* where images are looked for; NULL: there are fewer */
    json_t *images;               /* numbers in the set by the names that labels have */
    json_t *classes;              /* how many labels each class has */
};

/* A box as labels tell it, in pixels from the image's corner, with fractions. */
struct labelled_box {
    double column, row, columns, rows;
};

/* An image that labels are of. */
struct labelled_image {
    uint32_t number;        /* in the set's list */
    uint64_t rows, columns; /* 0: not known */
    uint32_t side;          /* likewise */
};

/* What a class is of: its name tells, or it is `part`. */
uint32_t part_of_class(const char *name, uint32_t part);

/* Counts a label of a class. *is_chosen: whether it is to be read. Errors: MEMORY. */
sonject_status contact_reader_count(struct contact_reader *reader, const char *class_name,
                                    bool *is_chosen);

/* The number of the image of that name, whose file must be there, in one of the folders. place:
 * "labels.csv:3", for messages. Errors: INPUT, MEMORY. */
sonject_status contact_reader_find_image(struct contact_reader *reader, const char *place,
                                         const char *name, uint32_t *number);

/* Adds a contact. Its box is taken to the nearest whole pixels, one at least; what reaches at most
 * one pixel out of the image is cut off. Errors: INPUT, MEMORY. */
sonject_status contact_reader_add(struct contact_reader *reader, const char *place,
                                  const struct labelled_image *image, uint32_t part,
                                  const struct labelled_box *box);

/* Whether the name ends so, in small letters or capitals. */
bool name_ends(const char *name, const char *ending);

/* Each reads a format; folder, and names in it, of one that is a folder of files. Errors: as of
 * contact_set_read. */
sonject_status contacts_of_coco(struct contact_reader *reader, const char *path);
sonject_status contacts_of_table(struct contact_reader *reader, const char *path);
sonject_status contacts_of_yolo(struct contact_reader *reader, const char *folder,
                                const struct folder_names *names);
sonject_status contacts_of_voc(struct contact_reader *reader, const char *folder,
                               const struct folder_names *names);
sonject_status quantiles_of_file(struct contact_reader *reader, const char *path);

#endif
