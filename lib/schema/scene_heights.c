/* Heights of the seabed from an image file: where its pixels lie, and what its numbers mean. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/ranges.h"
#include "schema/scene_fields.h"
#include "swath/swath_file.h"

enum positive_way {
    POSITIVE_UP,
    POSITIVE_DOWN
};

/* What is said about the file: a height is offset_m, and unit_m times the pixel up or down. */
struct heights_text {
    char *path;              /* owned */
    char *array;             /* owned; in a file of several, its name */
    double unit_m, offset_m; /* m a number of the file; height where that is 0 */
    uint32_t positive;       /* enum positive_way: where larger numbers lie */
    sonject_relief_params grid;
};

static sonject_status read_heights_unit(struct reader *reader, const struct tree_node *node,
                                        void *structure)
{
    return read_length_unit(reader, node, &((struct heights_text *)structure)->unit_m);
}

static sonject_status finish_heights(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    const struct heights_text *text = structure;
    struct check check = {NULL, listen_at(reader, node), SONJECT_OK};
    check_coordinate(&check, "offset", text->offset_m);
    check_positive_length(&check, "row_spacing", text->grid.row_spacing_m);
    check_positive_length(&check, "column_spacing", text->grid.column_spacing_m);
    check_coordinate(&check, "first_along_track", text->grid.first_along_track_m);
    check_coordinate(&check, "first_ground_range", text->grid.first_ground_range_m);
    return check.status;
}

#define STRUCTURE struct heights_text
static const struct field heights_fields[] = {
    {"file", "image or array of one channel: rows along-track, columns in ground range",
     .kind = FIELD_FILE, .offset = offsetof(STRUCTURE, path), REQUIRED},
    {"array", "in an HDF5 or MATLAB file of several: its name", TEXT(STRUCTURE, array)},
    {"unit", "of the file's numbers", .kind = FIELD_SPECIAL, .unit = "m, km, cm, mm",
     .read = read_heights_unit, REQUIRED},
    {"positive", "where larger numbers lie: up (heights, by default) or down (depths)",
     WORD(STRUCTURE, positive) = {[POSITIVE_UP] = "up", [POSITIVE_DOWN] = "down"}},
    {"offset", "height over the mean seabed where the file has 0, by default 0",
     QUANTITY(STRUCTURE, offset_m, QUANTITY_LENGTH)},
    {"row_spacing", "distance between rows",
     QUANTITY(STRUCTURE, grid.row_spacing_m, QUANTITY_LENGTH), REQUIRED},
    {"column_spacing", "distance between columns, horizontal",
     QUANTITY(STRUCTURE, grid.column_spacing_m, QUANTITY_LENGTH), REQUIRED},
    {"first_ground_range", "of column 0, horizontal from the track",
     QUANTITY(STRUCTURE, grid.first_ground_range_m, QUANTITY_LENGTH), REQUIRED},
    {"first_along_track", "track position of row 0",
     QUANTITY(STRUCTURE, grid.first_along_track_m, QUANTITY_LENGTH)},
};
const struct section heights_section = {heights_fields, COUNT(heights_fields), finish_heights};
#undef STRUCTURE

static double number_at(const void *pixels, enum pixel_type type, size_t i)
{
    return type == PIXEL_UINT8    ? (double)((const uint8_t *)pixels)[i]
           : type == PIXEL_UINT16 ? (double)((const uint16_t *)pixels)[i]
                                  : (double)((const float *)pixels)[i];
}

static float height_of(const struct heights_text *text, double number)
{
    const double unit_m = text->positive == POSITIVE_DOWN ? -text->unit_m : text->unit_m;
    const double height = text->offset_m + unit_m * number;
    return (float)(fabs(height) > (double)FLT_MAX ? copysign(INFINITY, height) : height);
}

/* What is not a number stays so, and is refused with the place where it stands. */
static void heights_of_pixels(const struct heights_text *text, const void *pixels,
                              enum pixel_type type, float *heights, size_t count)
{
    for (size_t i = 0; i < count; i++)
        heights[i] = height_of(text, number_at(pixels, type, i));
}

static sonject_status set_heights(struct scene *scene, struct report *report,
                                  const struct heights_text *text, const float *heights)
{
    struct report check = {{0}, NULL, NULL};
    const sonject_status status =
        relief_features_set_grid(&scene->relief, &check, &text->grid, heights);
    return status == SONJECT_OK
               ? SONJECT_OK
               : report_failure(report, status, "%s: %s", text->path, check.message);
}

static sonject_status refuse_sides(struct report *report, const struct heights_text *text,
                                   uint64_t rows, uint64_t columns)
{
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "%s: has %llu rows and %llu columns; heights need 2...%u each, at "
                          "most 2^24 points: cut out or thin out",
                          text->path, (unsigned long long)rows, (unsigned long long)columns,
                          RELIEF_GRID_SIDE_MAX);
}

static sonject_status take_array(struct reader *reader, struct report *report,
                                 struct heights_text *text, const struct number_array *array)
{
    if (!relief_grid_fits(array->rows, array->column_count))
        return refuse_sides(report, text, array->rows, array->column_count);
    const size_t count = array->rows * array->column_count;
    float *heights = allocate_array(count, sizeof *heights);
    CHECK_MEMORY(report, heights, text->path);
    for (size_t i = 0; i < count; i++)
        heights[i] = height_of(text, array->values[i]);
    text->grid.rows = (uint32_t)array->rows;
    text->grid.columns = (uint32_t)array->column_count;
    const sonject_status status = set_heights(reader->scene, report, text, heights);
    free(heights);
    return status;
}

/* Sizes that no relief may have are refused before anything is held in memory. */
static sonject_status take_pixels(struct reader *reader, struct report *report,
                                  struct heights_text *text, struct swath_file *file)
{
    struct raster_layout layout;
    swath_file_layout(file, &layout);
    if (layout.channels != 1)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: has %lu channels; heights need one",
                              text->path, (unsigned long)layout.channels);
    if (!relief_grid_fits(layout.rows, layout.columns))
        return refuse_sides(report, text, layout.rows, layout.columns);
    const struct region all = {0, 0, layout.rows, layout.columns};
    const size_t count = (size_t)(layout.rows * layout.columns);
    void *pixels = allocate_array(count, pixel_bytes(layout.type));
    float *heights = allocate_array(count, sizeof *heights);
    text->grid.rows = (uint32_t)layout.rows;
    text->grid.columns = (uint32_t)layout.columns;
    sonject_status status = pixels && heights ? swath_file_read(report, file, &all, pixels)
                                              : report_out_of_memory(report, text->path);
    if (status == SONJECT_OK) {
        heights_of_pixels(text, pixels, layout.type, heights, count);
        status = set_heights(reader->scene, report, text, heights);
    }
    free(pixels);
    free(heights);
    return status;
}

/* Into the scene; the message about a file that cannot be read gets its place in the scene file. */
static sonject_status load(struct reader *reader, const struct tree_node *node,
                           struct heights_text *text)
{
    struct report report = {{0}, NULL, reader->report->host};
    struct swath_file *file;
    const struct number_array *array = find_array(reader, text->path);
    sonject_status status = array ? take_array(reader, &report, text, array)
                                  : swath_file_open_array(&report, text->path, SONJECT_CHANNEL_ONLY,
                                                          text->array, &file);
    if (status == SONJECT_OK && !array) {
        status = take_pixels(reader, &report, text, file);
        swath_file_close(&file);
    }
    if (status != SONJECT_OK)
        refuse_key(reader, node, "file", "%s", report.message);
    return status;
}

sonject_status read_relief_heights(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    struct heights_text text = {.path = NULL};
    (void)structure;
    sonject_relief_params_init(&text.grid);
    if (reader->scene->relief.heights_m)
        return refuse_value(reader, node, "only one file of heights is possible; join them");
    sonject_status status = read_section(reader, &heights_section, node, &text);
    THEN(status, load(reader, node, &text));
    free(text.path);
    free(text.array);
    return status;
}
