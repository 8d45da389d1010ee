#include "label/coco.h"

#include <string.h>

#include <sonject/version.h>

#include "base/json_document.h"

static json_t *segmentation_document(const struct image_labels *labels,
                                     const struct contact *contact)
{
    json_t *size = json_array();
    json_append(&size, json_count(labels->rows));
    json_append(&size, json_count(labels->columns));
    json_t *counts = json_array();
    for (size_t i = 0; i < contact->run_count; i++)
        json_append(&counts, json_count(contact->runs[i]));
    json_t *document = json_object();
    json_add(&document, "size", size);
    json_add(&document, "counts", counts);
    return document;
}

static json_t *annotation_document(const struct coco *coco, const struct image_labels *labels,
                                   const struct contact *contact, uint32_t class_number)
{
    json_t *box = json_array();
    json_append(&box, json_count(contact->box.first_column));
    json_append(&box, json_count(contact->box.first_row));
    json_append(&box, json_count(contact->box.columns));
    json_append(&box, json_count(contact->box.rows));
    json_t *document = json_object();
    json_add(&document, "id", json_count(coco->annotation_count + 1));
    json_add(&document, "image_id", json_count(coco->image_count + 1));
    json_add(&document, "category_id", json_count((uint64_t)class_number + 1));
    json_add(&document, "bbox", box);
    json_add(&document, "area", json_count(contact->pixels));
    json_add(&document, "segmentation", segmentation_document(labels, contact));
    json_add(&document, "iscrowd", json_count(0));
    json_add(&document, "object_id", json_count(contact->number));
    json_add(&document, "truncated", json_boolean(contact->is_truncated));
    json_add(&document, "occluded", json_boolean(contact->is_occluded));
    return document;
}

static bool begin(struct coco *coco)
{
    if (!coco->images)
        coco->images = json_array();
    if (!coco->annotations)
        coco->annotations = json_array();
    return coco->images && coco->annotations;
}

sonject_status coco_add(struct coco *coco, struct report *report, const struct image_labels *labels,
                        struct class_names *classes)
{
    CHECK_MEMORY(report, begin(coco), "annotations");
    for (uint32_t i = 0; i < labels->count; i++) {
        const struct contact *contact = &labels->contacts[i];
        uint32_t class_number;
        CHECK(class_names_take(classes, report, contact->class_name, &class_number));
        if (contact->pixels == 0)
            continue;
        json_append(&coco->annotations, annotation_document(coco, labels, contact, class_number));
        coco->annotation_count++;
    }
    json_t *image = json_object();
    json_add(&image, "id", json_count(coco->image_count + 1));
    json_add(&image, "file_name", json_text(labels->file_name));
    json_add(&image, "width", json_count(labels->columns));
    json_add(&image, "height", json_count(labels->rows));
    json_append(&coco->images, image);
    coco->image_count++;
    return coco->images && coco->annotations ? SONJECT_OK
                                             : report_out_of_memory(report, "annotations");
}

sonject_status coco_write(struct coco *coco, struct report *report,
                          const struct class_names *classes, const char *path)
{
    CHECK_MEMORY(report, begin(coco), path);
    json_t *categories = json_array();
    for (uint32_t i = 0; i < classes->count; i++) {
        json_t *category = json_object();
        json_add(&category, "id", json_count((uint64_t)i + 1));
        json_add(&category, "name", json_text(classes->names[i]));
        json_add(&category, "supercategory", json_string("object"));
        json_append(&categories, category);
    }
    json_t *info = json_object();
    json_add(&info, "description", json_string("targets injected by sonject"));
    json_add(&info, "version", json_string(sonject_version()));
    json_t *document = json_object();
    json_add(&document, "info", info);
    json_add(&document, "licenses", json_array());
    json_add(&document, "images", coco->images);
    json_add(&document, "annotations", coco->annotations);
    json_add(&document, "categories", categories);
    memset(coco, 0, sizeof *coco);
    return json_document_write(report, document, path);
}

void coco_clear(struct coco *coco)
{
    json_decref(coco->images);
    json_decref(coco->annotations);
    memset(coco, 0, sizeof *coco);
}
