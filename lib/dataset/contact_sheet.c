/* A picture of images from all over a data set, with boxes around their objects. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/data_set.h"
#include "image/canvas.h"
#include "measure/contacts.h"
#include "swath/raster_file.h"

#define CELLS_ACROSS 8
#define CELLS_MAX    64
#define CELL_SIDE    144 /* pixels that an image may take */
#define CELL_GAP     6
#define CAPTION      22

/* A chip as amplitudes or grey levels, made smaller to fit a cell. */
struct thumbnail {
    uint32_t rows, columns;
    double scale; /* of its pixels to the chip's, at most 1 */
    float *values;
};

static float value_at(const struct raster_layout *layout, const void *pixels, size_t i)
{
    const size_t k = i * layout->channels;
    const float first = (float)pixel_number(layout->type, pixels, k);
    return layout->channels == 2 ? hypotf(first, (float)pixel_number(layout->type, pixels, k + 1))
                                 : first;
}

/* Means of the pixels that a smaller one stands for. */
static void reduce(const struct raster_layout *layout, const void *pixels, struct thumbnail *small)
{
    for (uint32_t row = 0; row < small->rows; row++)
        for (uint32_t column = 0; column < small->columns; column++) {
            const size_t first_row = (size_t)((double)row / small->scale);
            const size_t first_column = (size_t)((double)column / small->scale);
            const size_t end_row =
                (size_t)fmin(ceil((row + 1) / small->scale), (double)layout->rows);
            const size_t end_column =
                (size_t)fmin(ceil((column + 1) / small->scale), (double)layout->columns);
            double sum = 0.0;
            for (size_t r = first_row; r < end_row; r++)
                for (size_t c = first_column; c < end_column; c++)
                    sum += value_at(layout, pixels, r * (size_t)layout->columns + c);
            small->values[(size_t)row * small->columns + column] =
                (float)(sum / (double)((end_row - first_row) * (end_column - first_column)));
        }
}

/* Grey levels as they are; other pixels in dB, from the 1st to the 99.8th percentile. */
static sonject_status shade(struct report *report, enum pixel_type type, struct thumbnail *small)
{
    const size_t count = (size_t)small->rows * small->columns;
    float low = 0.0f;
    float high = 255.0f;
    if (type != PIXEL_UINT8) {
        float *sorted = allocate_array(count, sizeof *sorted);
        CHECK_MEMORY(report, sorted, "the contact sheet");
        for (size_t i = 0; i < count; i++)
            small->values[i] = 20.0f * log10f(fmaxf(small->values[i], 1e-20f));
        memcpy(sorted, small->values, count * sizeof *sorted);
        qsort(sorted, count, sizeof *sorted, compare_floats);
        low = sorted[count / 100];
        high = sorted[count - 1 - count / 500];
        free(sorted);
    }
    for (size_t i = 0; i < count; i++)
        small->values[i] =
            high > low ? fminf(fmaxf((small->values[i] - low) / (high - low), 0.0f), 1.0f) : 0.0f;
    return SONJECT_OK;
}

static double thumbnail_scale(double rows, double columns)
{
    return fmin(1.0, CELL_SIDE / fmax(rows, columns));
}

static sonject_status load_thumbnail(struct report *report, const char *path,
                                     struct thumbnail *small)
{
    struct decoded_image *file;
    struct raster_layout layout;
    size_t bytes;
    void *pixels = NULL;
    memset(small, 0, sizeof *small);
    CHECK(decoded_image_open(report, path, NULL, &file));
    layout = file->layout;
    const struct region all = {0, 0, layout.rows, layout.columns};
    small->scale = thumbnail_scale((double)layout.rows, (double)layout.columns);
    small->rows = (uint32_t)fmax(1.0, floor((double)layout.rows * small->scale));
    small->columns = (uint32_t)fmax(1.0, floor((double)layout.columns * small->scale));
    if (region_bytes(&layout, &all, &bytes))
        pixels = allocate_array(bytes, 1);
    small->values = allocate_array((size_t)small->rows * small->columns, sizeof *small->values);
    sonject_status status = pixels && small->values
                                ? decoded_image_read(report, file, &all, pixels)
                                : report_out_of_memory(report, "the contact sheet");
    if (status == SONJECT_OK) {
        reduce(&layout, pixels, small);
        status = shade(report, layout.type, small);
    }
    decoded_image_close(&file);
    free(pixels);
    return status;
}

static void draw_thumbnail(struct canvas *canvas, const struct thumbnail *small, int64_t x,
                           int64_t y)
{
    for (uint32_t row = 0; row < small->rows; row++)
        for (uint32_t column = 0; column < small->columns; column++) {
            const uint8_t grey =
                (uint8_t)(255.0f * small->values[(size_t)row * small->columns + column] + 0.5f);
            const struct colour colour = {grey, grey, grey};
            canvas_fill(canvas, x + column, y + row, 1, 1, colour);
        }
}

/* The boxes of COCO's annotations; targets are the first objects. */
static void draw_boxes(struct canvas *canvas, const json_t *annotations, double scale,
                       json_int_t targets, int64_t x, int64_t y)
{
    static const struct colour of_targets = {255, 160, 0};
    static const struct colour of_others = {80, 180, 255};
    size_t i;
    const json_t *annotation;
    json_array_foreach(annotations, i, annotation)
    {
        int64_t sides[4]; /* column, row, columns, rows */
        for (size_t k = 0; k < 4; k++) {
            const json_t *box = json_object_get(annotation, "bbox");
            const double side = scale * (double)json_integer_value(json_array_get(box, k));
            sides[k] = (int64_t)fmin(fmax(k < 2 ? side : ceil(side), 0.0), CELL_SIDE);
        }
        const bool is_target =
            json_integer_value(json_object_get(annotation, "object_id")) <= targets;
        canvas_frame(canvas, x + sides[0], y + sides[1], sides[2], sides[3],
                     is_target ? of_targets : of_others);
    }
}

static sonject_status draw_cell(const struct data_set *set, struct canvas *canvas, size_t split,
                                uint64_t id, int64_t x, int64_t y)
{
    static const struct colour black = {0, 0, 0};
    json_t *record;
    struct thumbnail small = {0, 0, 0.0, NULL};
    char caption[96];
    char path[PATH_CAPACITY];
    CHECK(data_set_record(set, split, id, &record));
    sonject_status status = path_in(set->report, path, set->folder, "%s/%s",
                                    set->split_names[split], member_text(record, "image"));
    THEN(status, load_thumbnail(set->report, path, &small));
    if (status == SONJECT_OK) {
        const char *target = member_text(record, "target");
        draw_thumbnail(canvas, &small, x, y);
        draw_boxes(canvas, json_object_get(record, "annotations"), small.scale,
                   json_integer_value(json_object_get(record, "targets")), x, y);
        snprintf(caption, sizeof caption, "%llu %s", (unsigned long long)id, target);
        size_t length = strlen(caption);
        while (length > 0 && text_length(caption, length) > CELL_SIDE)
            length--;
        draw_text(canvas, x, y + small.rows + FONT_ASCENT + 2, caption, length, TEXT_RIGHTWARDS,
                  black);
    }
    free(small.values);
    json_decref(record);
    return status;
}

static uint32_t cell_count(const struct data_set *set)
{
    return set->images < CELLS_MAX ? (uint32_t)set->images : CELLS_MAX;
}

static int64_t cell_x(uint32_t cell)
{
    return CELL_GAP + (int64_t)(cell % CELLS_ACROSS) * (CELL_SIDE + CELL_GAP);
}

/* The height of the highest image, as load_thumbnail reduces it; the most that it may be where
 * images have all rows or columns of swaths. */
static uint32_t cell_height(const struct data_set *set)
{
    const double rows = json_number_value(json_object_get(set->head, "rows"));
    const double columns = json_number_value(json_object_get(set->head, "columns"));
    if (rows < 1.0 || columns < 1.0)
        return CELL_SIDE;
    return (uint32_t)fmax(1.0, floor(rows * thumbnail_scale(rows, columns)));
}

static uint32_t cell_pitch(const struct data_set *set)
{
    return cell_height(set) + CAPTION + CELL_GAP;
}

static int64_t cell_y(const struct data_set *set, uint32_t cell)
{
    return CELL_GAP + (int64_t)(cell / CELLS_ACROSS) * cell_pitch(set);
}

static uint64_t cell_image(const struct data_set *set, uint64_t cell)
{
    return set->images * cell / cell_count(set);
}

bool contact_sheet_shows(const struct data_set *set, uint64_t id)
{
    const uint64_t cells = cell_count(set);
    const uint64_t cell = (id * cells + set->images - 1) / set->images;
    return cell < cells && cell_image(set, cell) == id;
}

json_t *contact_sheet_document(const struct data_set *set)
{
    json_t *cells = json_array();
    for (uint32_t i = 0; i < cell_count(set); i++)
        json_append(&cells, JSON_OBJECT({"image", json_count(cell_image(set, i))},
                                        {"x", json_integer(cell_x(i))},
                                        {"y", json_integer(cell_y(set, i))}));
    return JSON_OBJECT({"width", json_integer(CELL_SIDE)},
                       {"height", json_integer(cell_height(set))}, {"cells", cells});
}

static sonject_status draw_cells(const struct data_set *set, struct canvas *canvas)
{
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < cell_count(set); i++) {
        const uint64_t id = cell_image(set, i);
        size_t split = 0;
        while (id - set->split_first[split] >= set->split_images[split])
            split++;
        status = draw_cell(set, canvas, split, id, cell_x(i), cell_y(set, i));
    }
    return status;
}

sonject_status write_contact_sheet(const struct data_set *set)
{
    static const struct colour white = {255, 255, 255};
    const uint32_t cells = cell_count(set);
    const uint32_t across = cells < CELLS_ACROSS ? cells : CELLS_ACROSS;
    const uint32_t down = (cells + CELLS_ACROSS - 1) / CELLS_ACROSS;
    struct canvas canvas;
    char path[PATH_CAPACITY];
    CHECK(path_in(set->report, path, set->folder, "contact_sheet.png"));
    if (!canvas_create(&canvas, CELL_GAP + down * cell_pitch(set),
                       CELL_GAP + across * (CELL_SIDE + CELL_GAP), white))
        return report_out_of_memory(set->report, "the contact sheet");
    sonject_status status = draw_cells(set, &canvas);
    if (status == SONJECT_OK) {
        const struct raster_layout layout = {canvas.height, canvas.width, 3, PIXEL_UINT8};
        status = raster_file_write(set->report, path, &layout, NULL, NULL, 0, canvas.rgb);
    }
    free(canvas.rgb);
    return status;
}
