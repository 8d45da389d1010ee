/* The readers of labels, one for each format, and the functions that all of them share to fill a
 * set of contacts. */
#ifndef SONJECT_DATASET_CONTACT_READER_H
#define SONJECT_DATASET_CONTACT_READER_H

#include <jansson.h>

#include "base/file.h"
#include "dataset/contact_files.h"
#include "schema/tables.h"

#define LABEL_BYTES_MAX  ((size_t)64 << 20)          /* bytes of a file */
#define LABEL_PLACE      (TABLE_FILE_CAPACITY + 100) /* bytes of a place in words */
#define IMAGE_FOLDERS    6                           /* folders in which images are looked for */
#define IMAGE_PIXELS_MAX ((uint64_t)1 << 40)         /* pixels in a row or a column */

struct contact_reader {
    struct report *report;
    struct contact_set *set;
    const struct contact_choice *choice;
    char *folders[IMAGE_FOLDERS]; /* folders where images are looked for; NULL: there are fewer */
    json_t *images;               /* numbers in the set, by the names that labels use */
    json_t *classes;              /* number of labels of each class */
};

/* A label's box in pixels from the image's corner, with fractions. */
struct labelled_box {
    double column, row, columns, rows;
};

/* An image that has labels. */
struct labelled_image {
    uint32_t number;        /* number in the set's list */
    uint64_t rows, columns; /* 0: not known */
    uint32_t side;          /* enum recorded_side; 0: not known */
};

/* Returns the part (enum labelled_part) that a class's name tells, or else `part`. */
uint32_t part_of_class(const char *name, uint32_t part);

/* Counts a label of a class. *is_chosen: set if the class is to be read. Errors: MEMORY. */
sonject_status contact_reader_count(struct contact_reader *reader, const char *class_name,
                                    bool *is_chosen);

/* Finds the number of the image of that name, whose file must be in one of the folders. place:
 * "labels.csv:3", for messages. Errors: INPUT, MEMORY. */
sonject_status contact_reader_find_image(struct contact_reader *reader, const char *place,
                                         const char *name, uint32_t *number);

/* Adds a contact. The box is rounded to whole pixels, one at least. A part that reaches at most one
 * pixel out of the image is cut off. Errors: INPUT, MEMORY. */
sonject_status contact_reader_add(struct contact_reader *reader, const char *place,
                                  const struct labelled_image *image, uint32_t part,
                                  const struct labelled_box *box);

/* Returns whether the name has this ending, in small letters or capitals. */
bool name_ends(const char *name, const char *ending);

/* Each reads one format. folder, names: of a format that is a folder of files. Errors: those of
 * contact_set_read. */
sonject_status contacts_of_coco(struct contact_reader *reader, const char *path);
sonject_status contacts_of_table(struct contact_reader *reader, const char *path);
sonject_status contacts_of_yolo(struct contact_reader *reader, const char *folder,
                                const struct folder_names *names);
sonject_status contacts_of_voc(struct contact_reader *reader, const char *folder,
                               const struct folder_names *names);
sonject_status quantiles_of_file(struct contact_reader *reader, const char *path);

#endif
