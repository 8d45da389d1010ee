/* Pictures of a data set's images, drawn to scale, with boxes around the objects. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "dataset/data_set.h"
#include "image/canvas.h"
#include "image/plot.h"
#include "measure/contacts.h"
#include "swath/geometry_notes.h"

#define CELLS_ACROSS 8
#define CELL_SIDE    144 /* pixels of a side that an image may take */
#define CELL_GAP     6
#define LINE         18 /* height of a caption's line, pixels */

/* An image as amplitudes or grey levels, in the pixels of the picture. */
struct thumbnail {
    uint32_t sides[2]; /* rows, columns */
    double scales[2];  /* picture's pixels in a pixel of the image: rows, columns */
    float *values;
};

/* Fills each pixel of the thumbnail with the mean of the image's pixels that it covers. */
static void resample(const struct raster_layout *layout, const void *pixels,
                     struct thumbnail *small)
{
    const double *scales = small->scales;
    for (uint32_t row = 0; row < small->sides[0]; row++)
        for (uint32_t column = 0; column < small->sides[1]; column++) {
            const size_t first_row = (size_t)(row / scales[0]);
            const size_t first_column = (size_t)(column / scales[1]);
            const size_t end_row = (size_t)fmin(ceil((row + 1) / scales[0]), (double)layout->rows);
            const size_t end_column =
                (size_t)fmin(ceil((column + 1) / scales[1]), (double)layout->columns);
            double sum = 0.0;
            for (size_t r = first_row; r < end_row; r++)
                for (size_t c = first_column; c < end_column; c++)
                    sum += pixel_magnitude(layout, pixels, r * (size_t)layout->columns + c);
            small->values[(size_t)row * small->sides[1] + column] =
                (float)(sum / (double)((end_row - first_row) * (end_column - first_column)));
        }
}

/* Scales values to 0...1: grey levels as they are, others in dB, 1st to 99.8th percentile. */
static sonject_status shade(struct report *report, enum pixel_type type, struct thumbnail *small)
{
    const size_t count = (size_t)small->sides[0] * small->sides[1];
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

/* Chooses the sides of a picture by the pixel spacings that the file gives. */
static void choose_sides(const struct swath_file *file, uint32_t sides[2])
{
    struct noted_geometry noted;
    struct raster_layout layout;
    swath_file_layout(file, &layout);
    geometry_notes_read(file, &noted);
    plot_small_sides(layout.rows, layout.columns, noted.row_spacing_m, noted.column_spacing_m,
                     CELL_SIDE, sides);
}

static sonject_status open_image(const struct data_set *set, size_t split, const json_t *record,
                                 struct swath_file **file)
{
    char path[PATH_CAPACITY];
    CHECK(path_in(set->report, path, set->folder, "%s/%s", set->split_names[split],
                  member_text(record, "image")));
    return swath_file_open_array(set->report, path, SONJECT_CHANNEL_ONLY, NULL, file);
}

sonject_status sheet_image_sides(const struct data_set *set, size_t split, const json_t *record,
                                 uint32_t sides[2])
{
    struct swath_file *file;
    CHECK(open_image(set, split, record, &file));
    choose_sides(file, sides);
    swath_file_close(&file);
    return SONJECT_OK;
}

static sonject_status load_thumbnail(const struct data_set *set, size_t split, const json_t *record,
                                     struct thumbnail *small)
{
    struct swath_file *file;
    struct raster_layout layout;
    void *pixels = NULL;
    CHECK(open_image(set, split, record, &file));
    choose_sides(file, small->sides);
    small->values =
        allocate_array((size_t)small->sides[0] * small->sides[1], sizeof *small->values);
    sonject_status status = small->values ? swath_file_read_all(set->report, file, &layout, &pixels)
                                          : report_out_of_memory(set->report, "the contact sheet");
    if (status == SONJECT_OK) {
        small->scales[0] = small->sides[0] / (double)layout.rows;
        small->scales[1] = small->sides[1] / (double)layout.columns;
        resample(&layout, pixels, small);
        status = shade(set->report, layout.type, small);
    }
    swath_file_close(&file);
    free(pixels);
    return status;
}

static void draw_thumbnail(struct canvas *canvas, const struct thumbnail *small, int64_t x,
                           int64_t y)
{
    for (uint32_t row = 0; row < small->sides[0]; row++)
        for (uint32_t column = 0; column < small->sides[1]; column++) {
            const float value = small->values[(size_t)row * small->sides[1] + column];
            const uint8_t grey = (uint8_t)(255.0f * value + 0.5f);
            canvas_fill(canvas, x + column, y + row, 1, 1, (struct colour){grey, grey, grey});
        }
}

/* Draws the boxes of COCO's annotations. Targets are the first objects. */
static void draw_boxes(struct canvas *canvas, const json_t *record, const double scales[2],
                       int64_t x, int64_t y)
{
    static const struct colour of_targets = {255, 160, 0};
    static const struct colour of_others = {80, 180, 255};
    const json_int_t targets = json_integer_value(json_object_get(record, "targets"));
    size_t i;
    const json_t *annotation;
    json_array_foreach(json_object_get(record, "annotations"), i, annotation)
    {
        int64_t sides[4]; /* column, row, columns, rows */
        for (size_t k = 0; k < 4; k++) {
            const json_t *box = json_object_get(annotation, "bbox");
            const double side =
                scales[k % 2 == 0] * (double)json_integer_value(json_array_get(box, k));
            sides[k] = (int64_t)fmin(fmax(k < 2 ? side : ceil(side), 0.0), CELL_SIDE);
        }
        const bool is_target =
            json_integer_value(json_object_get(annotation, "object_id")) <= targets;
        canvas_frame(canvas, x + sides[0], y + sides[1], sides[2], sides[3],
                     is_target ? of_targets : of_others);
    }
}

/* Returns how many characters stand in a line: up to the end of a word, unless it is too long. */
static size_t line_end(const char *text)
{
    const size_t most = text_fit(text, CELL_SIDE);
    size_t end = most;
    while (text[most] && end > 0 && !strchr(" _-", text[end - 1]))
        end--;
    return end > 0 ? end : most;
}

/* Draws a number and a name in as many lines as needed, and returns the number of lines. canvas:
 * NULL to only count the lines. */
static int64_t draw_caption(struct canvas *canvas, int64_t x, int64_t y, uint64_t id,
                            const char *name)
{
    char text[SONJECT_NAME_CAPACITY + 24];
    int64_t lines = 0;
    snprintf(text, sizeof text, "%llu %s", (unsigned long long)id, name);
    for (const char *from = text; *from; lines++) {
        const size_t length = line_end(from);
        if (canvas)
            draw_text(canvas, x, y + FONT_ASCENT + 2 + LINE * lines, from, length, TEXT_RIGHTWARDS,
                      (struct colour){0, 0, 0});
        from += length;
    }
    return lines;
}

/* Returns the distance from one row of cells to the next, pixels. */
static int64_t cell_pitch(const struct data_set *set, uint32_t cell_height)
{
    int64_t most = 1;
    size_t i;
    const json_t *name;
    json_array_foreach(json_object_get(set->head, "classes"), i, name)
    {
        const int64_t lines = draw_caption(NULL, 0, 0, set->images - 1, json_string_value(name));
        most = lines > most ? lines : most;
    }
    return cell_height + LINE * most + 4 + CELL_GAP;
}

/* Returns the class of the target or, in an image without one, of the first labelled clutter. */
static const char *name_of_image(const struct data_set *set, const json_t *record)
{
    const json_t *first = json_array_get(json_object_get(record, "annotations"), 0);
    const json_int_t category = json_integer_value(json_object_get(first, "category_id"));
    const json_t *classes = json_object_get(set->head, "classes");
    const char *target = member_text(record, "target");
    const char *clutter = json_string_value(json_array_get(classes, (size_t)category - 1));
    return *target || !clutter ? target : clutter;
}

static sonject_status draw_cell(const struct data_set *set, struct canvas *canvas, uint64_t id,
                                int64_t x, int64_t y)
{
    json_t *record;
    struct thumbnail small = {.values = NULL};
    size_t split = 0;
    while (id - set->split_first[split] >= set->split_images[split])
        split++;
    CHECK(data_set_record(set, split, id, &record));
    const sonject_status status = load_thumbnail(set, split, record, &small);
    if (status == SONJECT_OK) {
        draw_thumbnail(canvas, &small, x, y);
        draw_boxes(canvas, record, small.scales, x, y);
        draw_caption(canvas, x, y + small.sides[0], id, name_of_image(set, record));
    }
    free(small.values);
    json_decref(record);
    return status;
}

sonject_status write_sheet(const struct data_set *set, const char *name, const uint64_t *ids,
                           uint32_t count, uint32_t cell_height)
{
    static const struct colour white = {255, 255, 255};
    const uint32_t across = count < CELLS_ACROSS ? count : CELLS_ACROSS;
    const uint32_t down = (count + CELLS_ACROSS - 1) / CELLS_ACROSS;
    const int64_t pitch = cell_pitch(set, cell_height);
    struct canvas canvas;
    char path[PATH_CAPACITY];
    CHECK(path_in(set->report, path, set->folder, "%s", name));
    if (!canvas_create(&canvas, (uint32_t)(CELL_GAP + down * pitch),
                       CELL_GAP + across * (CELL_SIDE + CELL_GAP), white))
        return report_out_of_memory(set->report, "the contact sheet");
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < count; i++)
        status = draw_cell(set, &canvas, ids[i],
                           CELL_GAP + (int64_t)(i % CELLS_ACROSS) * (CELL_SIDE + CELL_GAP),
                           CELL_GAP + i / CELLS_ACROSS * pitch);
    return picture_write(set->report, status, &canvas, path);
}

static uint32_t cell_count(const struct data_set *set)
{
    return set->images < SHEET_CELLS ? (uint32_t)set->images : SHEET_CELLS;
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

sonject_status write_contact_sheet(const struct data_set *set, uint32_t cell_height,
                                   json_t **document)
{
    uint64_t ids[SHEET_CELLS];
    const uint32_t count = cell_count(set);
    for (uint32_t i = 0; i < count; i++)
        ids[i] = cell_image(set, i);
    CHECK(write_sheet(set, "contact_sheet.png", ids, count, cell_height));
    *document = JSON_OBJECT({"gap", json_integer(CELL_GAP)}, {"across", json_integer(CELLS_ACROSS)},
                            {"most", json_integer(SHEET_CELLS)},
                            {"width", json_integer(CELL_SIDE + CELL_GAP)},
                            {"height", json_integer(cell_pitch(set, cell_height))},
                            {"images", json_counts(ids, count)});
    return SONJECT_OK;
}
