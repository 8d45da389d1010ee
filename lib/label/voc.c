#include "label/voc.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "label/label_text.h"

static void add_object(struct growing_text *xml, const struct contact *contact)
{
    const sonject_box *box = &contact->box;
    growing_text_add(xml, "  <object>\n    <name>");
    label_text_xml(xml, contact->class_name);
    growing_text_add(xml,
                     "</name>\n"
                     "    <pose>Unspecified</pose>\n"
                     "    <truncated>%d</truncated>\n"
                     "    <occluded>%d</occluded>\n"
                     "    <difficult>0</difficult>\n",
                     contact->is_truncated, contact->is_occluded);
    growing_text_add(xml,
                     "    <bndbox>\n"
                     "      <xmin>%" PRIu64 "</xmin>\n"
                     "      <ymin>%" PRIu64 "</ymin>\n"
                     "      <xmax>%" PRIu64 "</xmax>\n"
                     "      <ymax>%" PRIu64 "</ymax>\n"
                     "    </bndbox>\n"
                     "  </object>\n",
                     box->first_column + 1, box->first_row + 1, box->first_column + box->columns,
                     box->first_row + box->rows);
}

sonject_status voc_write(struct report *report, const struct image_labels *labels, const char *path)
{
    struct growing_text xml = {NULL, 0, 0, false};
    growing_text_add(&xml, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<annotation>\n"
                           "  <filename>");
    label_text_xml(&xml, labels->file_name);
    growing_text_add(&xml,
                     "</filename>\n"
                     "  <source><database>sonject</database></source>\n"
                     "  <size>\n"
                     "    <width>%" PRIu64 "</width>\n"
                     "    <height>%" PRIu64 "</height>\n"
                     "    <depth>1</depth>\n"
                     "  </size>\n"
                     "  <segmented>0</segmented>\n",
                     labels->columns, labels->rows);
    for (uint32_t i = 0; i < labels->count; i++)
        if (labels->contacts[i].pixels > 0)
            add_object(&xml, &labels->contacts[i]);
    growing_text_add(&xml, "</annotation>\n");
    char *text = growing_text_end(&xml);
    CHECK_MEMORY(report, text, path);
    const sonject_status status = file_write_whole(report, path, text, strlen(text));
    free(text);
    return status;
}
