#include "label/yolo.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "label/label_text.h"

static void add_line(struct growing_text *lines, const struct image_labels *labels,
                     const struct contact *contact, uint32_t class_number)
{
    const sonject_box *box = &contact->box;
    const double columns = (double)labels->columns;
    const double rows = (double)labels->rows;
    const double fractions[4] = {((double)box->first_column + 0.5 * (double)box->columns) / columns,
                                 ((double)box->first_row + 0.5 * (double)box->rows) / rows,
                                 (double)box->columns / columns, (double)box->rows / rows};
    growing_text_add(lines, "%u", (unsigned)class_number);
    for (int i = 0; i < 4; i++) {
        growing_text_add(lines, " ");
        label_text_number(lines, fractions[i]);
    }
    growing_text_add(lines, "\n");
}

sonject_status yolo_write(struct report *report, const struct image_labels *labels,
                          struct class_names *classes, const char *path)
{
    struct growing_text lines = {NULL, 0, 0, false};
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < labels->count; i++) {
        uint32_t class_number;
        status = class_names_take(classes, report, labels->contacts[i].class_name, &class_number);
        if (status == SONJECT_OK && labels->contacts[i].pixels > 0)
            add_line(&lines, labels, &labels->contacts[i], class_number);
    }
    char *text = growing_text_end(&lines);
    CHECK_MEMORY(report, text, path);
    THEN(status, file_write_whole(report, path, text, strlen(text)));
    free(text);
    return status;
}
