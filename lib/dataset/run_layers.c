/* The images, masks and label files of a run. */
#include "dataset/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/run.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/labels.h"
#include "image/plot.h"
#include "swath/geometry_notes.h"
#include "swath/raster_file.h"

#define QUICKLOOK        "quicklook.png"
#define QUICKLOOK_PANELS 3

static sonject_status write_mask(struct report *report, const struct swath *swath,
                                 const uint8_t *mask, const uint8_t *palette, const char *path)
{
    const struct raster_layout layout = {swath->layout.rows, swath->layout.columns, 1, PIXEL_UINT8};
    return raster_file_write_placed(report, path, &layout, &swath->patch, mask, palette);
}

/* Writes the numbers of objects, each in a colour of its own. 0 is black. Neighbouring numbers are
 * a golden angle apart on a colour wheel of six sectors. */
static sonject_status write_label_mask(struct report *report, const struct swath *swath,
                                       const uint8_t *labels, const char *path)
{
    static const uint8_t order[6][3] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1},
                                        {2, 1, 0}, {1, 2, 0}, {0, 2, 1}};
    uint8_t palette[PNG_PALETTE_BYTES] = {0, 0, 0};
    for (unsigned number = 1; number < 256; number++) {
        const unsigned hue = number * 949 % 1536;
        const uint8_t rising = (uint8_t)(hue % 256);
        const uint8_t parts[3] = {255, (uint8_t)(hue / 256 % 2 ? 255 - rising : rising), 64};
        for (int i = 0; i < 3; i++)
            palette[3 * number + (unsigned)i] = parts[order[hue / 256][i]];
    }
    return write_mask(report, swath, labels, palette, path);
}

static sonject_status write_float_layer(struct report *report, const struct run_facts *facts,
                                        uint32_t channels, const float *pixels, const char *path)
{
    static const char *const complex_names[] = {"real", "imag"};
    const struct region *patch = &facts->swath->patch;
    const struct raster_layout layout = {patch->rows, patch->columns, channels, PIXEL_FLOAT32};
    struct geometry_notes notes;
    struct raster_attribute attributes[GEOMETRY_NOTES_MAX + 2];
    const sonject_geometry_params geometry =
        geometry_crop(&facts->scene->geometry, (double)patch->first_row,
                      (double)patch->first_column, (double)patch->columns);
    geometry_notes_init(&notes, &facts->scene->sonar, &geometry);
    memcpy(attributes, notes.attributes, sizeof notes.attributes);
    attributes[notes.count] = (struct raster_attribute){"sonject:phase_sign", "exp(+i 2 pi f t)"};
    attributes[notes.count + 1] = (struct raster_attribute){
        "sonject:normalisation",
        channels == 2 ? "target_strength, |pixel|^2 in m^2" : "target_strength, pixel in m^2"};
    return raster_file_write(report, path, &layout, channels == 2 ? complex_names : NULL,
                             attributes, notes.count + 2, pixels);
}

static sonject_status write_plane(struct report *report, const struct run_facts *facts,
                                  enum injected_plane plane, const char *path)
{
    const struct injection_result *result = facts->result;
    const uint32_t channels = plane == INJECTED_FIELD ? 2 : 1;
    float *pixels = allocate_array(result->rows, result->columns * channels * sizeof *pixels);
    CHECK_MEMORY(report, pixels, "a layer");
    injection_result_plane(result, plane, pixels);
    const sonject_status status = write_float_layer(report, facts, channels, pixels, path);
    free(pixels);
    return status;
}

static void amplitude_of(const float *pixels, size_t count, bool is_complex, float *amplitude)
{
    for (size_t i = 0; i < count; i++)
        amplitude[i] = is_complex ? hypotf(pixels[2 * i], pixels[2 * i + 1]) : pixels[i];
}

/* Returns what the page needs to show each panel by itself, and to locate a pixel of it. */
static json_t *quicklook_document(const struct plot_frame *frame, const struct region *window,
                                  const struct plot_place *places, const struct canvas *picture)
{
    json_t *panels = json_array();
    for (int i = 0; i < QUICKLOOK_PANELS; i++)
        json_append(&panels,
                    JSON_OBJECT(JSON_COUNT(places + i, left), JSON_COUNT(places + i, top),
                                JSON_COUNT(places + i, width), JSON_COUNT(places + i, height)));
    return JSON_OBJECT(JSON_COUNT(picture, height), JSON_COUNT(picture, width), {"panels", panels},
                       {"row", json_count(window->first_row)},
                       {"column", json_count(window->first_column)}, JSON_COUNT(window, rows),
                       JSON_COUNT(window, columns), JSON_NUMBER(frame, first_along_track_m),
                       JSON_NUMBER(frame, row_spacing_m), JSON_NUMBER(frame, first_range_m),
                       JSON_NUMBER(frame, column_spacing_m));
}

/* Widens an interval of pixels by a margin, within the patch. */
static void widen(uint64_t *first, uint64_t *count, double margin, uint64_t all)
{
    const double end = fmin((double)all, ceil((double)(*first + *count) + margin));
    *first = (uint64_t)fmax(0.0, floor((double)*first - margin));
    *count = (uint64_t)end - *first;
}

/* Returns the changed part of the patch, with as much around it, since the targets of a whole line
 * would be specks. Returns all of the patch where that is not much more, or nothing changed. */
static struct region changed_part(const struct injection_result *result,
                                  const sonject_geometry_params *geometry)
{
    const struct region all = {.rows = result->rows, .columns = result->columns};
    size_t top = result->rows, bottom = 0, left = result->columns, right = 0;
    for (size_t row = 0; row < result->rows; row++)
        for (size_t column = 0; column < result->columns; column++)
            if (result->influence[row * result->columns + column]) {
                top = row < top ? row : top;
                bottom = row + 1;
                left = column < left ? column : left;
                right = column + 1 > right ? column + 1 : right;
            }
    if (bottom == 0)
        return all;
    struct region part = {top, left, bottom - top, right - left};
    const double margin_m = fmax((double)part.rows * geometry->row_spacing_m,
                                 (double)part.columns * geometry->column_spacing_m);
    widen(&part.first_row, &part.rows, margin_m / geometry->row_spacing_m, result->rows);
    widen(&part.first_column, &part.columns, margin_m / geometry->column_spacing_m,
          result->columns);
    return 2 * part.rows * part.columns < all.rows * all.columns ? part : all;
}

/* Draws amplitudes before and after, and 20 log10 of their ratio, 0 where nothing changed. */
static sonject_status write_quicklook(struct report *report, struct run_facts *facts,
                                      const char *path)
{
    const struct injection_result *result = facts->result;
    const sonject_geometry_params *geometry = &facts->scene->geometry;
    const struct region part = changed_part(result, geometry);
    const size_t count = (size_t)(part.rows * part.columns);
    const size_t channels = result->is_complex ? 2 : 1;
    float *before = allocate_array(count, 3 * sizeof *before);
    CHECK_MEMORY(report, before, "the quicklook");
    float *after = before + count;
    float *difference = after + count;
    for (uint64_t row = 0; row < part.rows; row++) {
        const size_t from = (size_t)((part.first_row + row) * result->columns + part.first_column);
        const size_t to = (size_t)(row * part.columns);
        const size_t columns = (size_t)part.columns;
        amplitude_of(facts->swath->pixels + channels * from, columns, result->is_complex,
                     before + to);
        amplitude_of(result->image + channels * from, columns, result->is_complex, after + to);
        for (size_t i = 0; i < columns; i++)
            difference[to + i] =
                result->influence[from + i] && before[to + i] > 0.0f && after[to + i] > 0.0f
                    ? 20.0f * log10f(after[to + i] / before[to + i])
                    : 0.0f;
    }
    const struct plot_panel panels[QUICKLOOK_PANELS] = {
        {"before", before, false}, {"after", after, false}, {"difference, dB", difference, true}};
    const struct region window = {facts->swath->patch.first_row + part.first_row,
                                  facts->swath->patch.first_column + part.first_column, part.rows,
                                  part.columns};
    const struct plot_frame frame = {
        .rows = window.rows,
        .columns = window.columns,
        .first_along_track_m =
            geometry->first_along_track_m + (double)window.first_row * geometry->row_spacing_m,
        .row_spacing_m = geometry->row_spacing_m,
        .first_range_m = geometry_range(geometry, (double)window.first_column),
        .column_spacing_m = geometry_is_reversed(geometry) ? -geometry->column_spacing_m
                                                           : geometry->column_spacing_m,
        .range_label = "slant range, m",
        .difference_db = 20.0};
    struct canvas picture = {0};
    struct plot_place places[QUICKLOOK_PANELS];
    const sonject_status status =
        plot_panels(report, &frame, panels, QUICKLOOK_PANELS, &picture.rgb, &picture.height,
                    &picture.width, places);
    if (status == SONJECT_OK)
        json_add(&facts->page, "quicklook", quicklook_document(&frame, &window, places, &picture));
    free(before);
    return picture_write(report, status, &picture, path);
}

sonject_status write_layer(struct report *report, const struct run_facts *facts, enum layer layer,
                           const char *path)
{
    const struct injection_result *result = facts->result;
    switch (layer) {
    case LAYER_FIELD:
        return write_plane(report, facts, INJECTED_FIELD, path);
    case LAYER_ENERGY:
        return write_plane(report, facts, INJECTED_ENERGY, path);
    case LAYER_HIGHLIGHT:
        return write_mask(report, facts->swath, result->highlight, NULL, path);
    case LAYER_SHADOW:
        return write_mask(report, facts->swath, result->shadow, NULL, path);
    case LAYER_LABELS:
        return write_label_mask(report, facts->swath, result->labels, path);
    default:
        return write_mask(report, facts->swath, result->influence, NULL, path);
    }
}

/* Returns an order's energy summed over the patch, and the energy of its brightest pixel. */
static json_t *order_document(const struct injection_result *result, uint32_t order)
{
    const size_t count = result->rows * result->columns;
    float *pixels = allocate_array(count, sizeof *pixels);
    double sum = 0.0, most = 0.0;
    if (!pixels)
        return NULL;
    injection_result_plane(result, INJECTED_ORDER + order - 1, pixels);
    for (size_t i = 0; i < count; i++) {
        sum += (double)pixels[i];
        most = fmax(most, (double)pixels[i]);
    }
    free(pixels);
    return JSON_OBJECT({"sum_m2", json_number(sum)}, {"brightest_m2", json_number(most)});
}

static const char *const layer_files[LAYERS] = {"patch.tif",  "energy.tif", "highlight.png",
                                                "shadow.png", "labels.png", "influence.png"};

static const char *const order_files[SCENE_INTERACTIONS_MAX] = {
    "energy_order_1.tif", "energy_order_2.tif", "energy_order_3.tif", "energy_order_4.tif",
    "energy_order_5.tif", "energy_order_6.tif", "energy_order_7.tif", "energy_order_8.tif"};

/* Energies of further orders may be left from a run before, and are removed. */
sonject_status write_layers(struct report *report, struct run_facts *facts, const char *folder)
{
    char path[PATH_CAPACITY];
    for (int layer = 0; layer < LAYERS; layer++) {
        CHECK(path_in(report, path, folder, "%s", layer_files[layer]));
        CHECK(write_layer(report, facts, (enum layer)layer, path));
        CHECK(file_list_add(&facts->files, report, folder, layer_files[layer], true));
    }
    CHECK(path_in(report, path, folder, QUICKLOOK));
    CHECK(write_quicklook(report, facts, path));
    CHECK(file_list_add(&facts->files, report, folder, QUICKLOOK, true));
    for (uint32_t order = 1; order <= SCENE_INTERACTIONS_MAX; order++) {
        const char *name = order_files[order - 1];
        CHECK(path_in(report, path, folder, "%s", name));
        if (order > facts->result->orders) {
            file_discard(path);
            continue;
        }
        CHECK(write_plane(report, facts, INJECTED_ORDER + order - 1, path));
        json_add(&facts->page, name, order_document(facts->result, order));
        CHECK(file_list_add(&facts->files, report, folder, name, true));
    }
    return SONJECT_OK;
}

static const struct {
    const char *name;
    uint32_t format; /* format that the file belongs to; 0: always written */
} label_files[LABEL_FILES] = {
    {"coco.json", 0},
    {"contacts.csv", 0},
    {"image.txt", SONJECT_LABELS_YOLO},
    {"classes.txt", SONJECT_LABELS_YOLO},
    {"image.xml", SONJECT_LABELS_VOC},
};

sonject_status write_labels(struct report *report, struct run_facts *facts, const char *folder)
{
    const struct swath *swath = facts->swath;
    const struct label_request request = {
        facts->scene,          facts->result, facts->image_name, swath->layout.rows,
        swath->layout.columns, swath->patch,  &swath->track,     facts->result->object_count};
    struct image_labels labels;
    struct class_names classes = {NULL, 0};
    char path[PATH_CAPACITY];
    sonject_status status = image_labels_find(&labels, report, &request, &classes);
    for (int file = 0; status == SONJECT_OK && file < LABEL_FILES; file++) {
        const uint32_t format = label_files[file].format;
        status = path_in(report, path, folder, "%s", label_files[file].name);
        if (status == SONJECT_OK && format && !(format & facts->label_formats)) {
            file_discard(path);
            continue;
        }
        THEN(status, labels_write(report, &labels, &classes, (enum label_file)file, path));
        THEN(status, file_list_add(&facts->files, report, folder, label_files[file].name, true));
    }
    class_names_clear(&classes);
    image_labels_clear(&labels);
    return status;
}

void run_file_names(const char *names[RUN_FILES + 1])
{
    static const char *const others[] = {QUICKLOOK, TRUTH_DOCUMENT, REPORT_PAGE};
    size_t count = 0;
    for (size_t i = 0; i < COUNT(others); i++)
        names[count++] = others[i];
    for (int i = 0; i < LAYERS; i++)
        names[count++] = layer_files[i];
    for (int i = 0; i < LABEL_FILES; i++)
        names[count++] = label_files[i].name;
    for (int i = 0; i < SCENE_INTERACTIONS_MAX; i++)
        names[count++] = order_files[i];
    names[count] = NULL;
}
