#include "dataset/label_files.h"

#include <stdlib.h>
#include <string.h>

#include <sonject/run.h>

#include "base/file.h"
#include "base/file_list.h"
#include "base/json_document.h"
#include "dataset/labels.h"
#include "swath/png_palette.h"
#include "swath/raster_file.h"

static const struct {
    const char *name;
    uint32_t format; /* that it belongs to; 0: always written */
} files[LABEL_FILES] = {
    {"coco.json", 0},
    {"contacts.json", 0},
    {"contacts.csv", 0},
    {"image.txt", SONJECT_LABELS_YOLO},
    {"classes.txt", SONJECT_LABELS_YOLO},
    {"image.xml", SONJECT_LABELS_VOC},
};

static const struct {
    const char *name;
    uint32_t format;
} label_names[] = {{"yolo", SONJECT_LABELS_YOLO}, {"voc", SONJECT_LABELS_VOC}};

json_t *labels_document(uint32_t formats)
{
    json_t *names = json_array();
    for (size_t i = 0; i < sizeof label_names / sizeof *label_names; i++)
        if (formats & label_names[i].format)
            json_append(&names, json_string(label_names[i].name));
    return names;
}

uint32_t labels_of_document(const json_t *run)
{
    const json_t *names = json_object_get(run, "labels");
    uint32_t formats = 0;
    for (size_t i = 0; i < json_array_size(names); i++) {
        const char *name = json_string_value(json_array_get(names, i));
        for (size_t k = 0; name && k < sizeof label_names / sizeof *label_names; k++)
            if (strcmp(name, label_names[k].name) == 0)
                formats |= label_names[k].format;
    }
    return formats;
}

sonject_status write_labels(struct report *report, struct run_facts *facts, const char *folder)
{
    const struct swath *swath = facts->swath;
    const struct label_request request = {
        facts->scene,          facts->result, facts->image_name, swath->layout.rows,
        swath->layout.columns, swath->patch,  &swath->track};
    struct image_labels labels;
    struct class_names classes = {NULL, 0};
    sonject_status status = image_labels_find(&labels, report, &request, &classes);
    for (int file = 0; status == SONJECT_OK && file < LABEL_FILES; file++) {
        char *path = path_join(folder, files[file].name);
        if (!path)
            status = report_out_of_memory(report, "a path");
        else if (files[file].format && !(files[file].format & facts->label_formats))
            file_discard(path);
        else {
            status = labels_write(report, &labels, &classes, (enum label_file)file, path);
            THEN(status, file_list_add(&facts->files, report, folder, files[file].name, true));
        }
        free(path);
    }
    class_names_clear(&classes);
    image_labels_clear(&labels);
    return status;
}

/* 0 is black; neighbours lie a golden angle apart on the wheel of six sectors of colours. */
static void colour_of(unsigned number, uint8_t *colour)
{
    const unsigned hue = number * 949 % 1536;
    const uint8_t rising = (uint8_t)(hue % 256);
    const uint8_t parts[3] = {255, (uint8_t)(hue / 256 % 2 ? 255 - rising : rising), 64};
    static const uint8_t order[6][3] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1},
                                        {2, 1, 0}, {1, 2, 0}, {0, 2, 1}};
    for (int i = 0; i < 3; i++)
        colour[i] = parts[order[hue / 256][i]];
}

sonject_status write_label_mask(struct report *report, const struct swath *swath,
                                const struct region *region, const uint8_t *labels,
                                const char *path)
{
    const struct raster_layout layout = {swath->layout.rows, swath->layout.columns, 1, PIXEL_UINT8};
    uint8_t palette[PNG_PALETTE_BYTES] = {0, 0, 0};
    for (unsigned number = 1; number < 256; number++)
        colour_of(number, palette + 3 * number);
    return raster_file_write_placed(report, path, &layout, region, labels, palette);
}
