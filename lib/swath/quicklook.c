#include "swath/quicklook.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "image/canvas.h"
#include "image/plot.h"
#include "image/raster.h"
#include "swath/conversion.h"
#include "swath/geometry_notes.h"
#include "swath/raster_file.h"
#include "swath/swath_file.h"

#define SIDE_LIMIT 4096 /* pixels per side of a picture; larger images are averaged */

/* The image to draw: amplitudes of blocks of pixels. */
struct view_image {
    size_t rows, columns;
    uint64_t block; /* side of a block, pixels */
    float *amplitude;
};

/* Adds one row of pixels to the energies of its block row. */
static sonject_status add_row(struct report *report, const char *path, struct view_image *image,
                              const sonject_transfer_params *transfer,
                              const struct raster_layout *layout, uint64_t row, const void *stored,
                              float *linear)
{
    const size_t parts = layout->channels;
    size_t bad = 0;
    uint64_t clipped = 0;
    if (transfer_to_amplitude(transfer, layout->type, stored, (size_t)layout->columns * parts,
                              linear, &bad, &clipped) != SONJECT_OK)
        return input_failure(report, path,
                             "the pixel at row %llu, column %zu is not a finite number",
                             (unsigned long long)row, bad / parts);
    float *out = image->amplitude + (size_t)(row / image->block) * image->columns;
    for (size_t i = 0; i < (size_t)layout->columns * parts; i++)
        out[i / parts / (size_t)image->block] += linear[i] * linear[i];
    return SONJECT_OK;
}

static void energies_to_amplitudes(struct view_image *image, const struct raster_layout *layout)
{
    for (size_t i = 0; i < image->rows * image->columns; i++) {
        const uint64_t row = i / image->columns * image->block;
        const uint64_t column = i % image->columns * image->block;
        const uint64_t high = layout->rows - row < image->block ? layout->rows - row : image->block;
        const uint64_t wide =
            layout->columns - column < image->block ? layout->columns - column : image->block;
        image->amplitude[i] = sqrtf(image->amplitude[i] / (float)(high * wide));
    }
}

static sonject_status read_reduced(struct report *report, const char *path, struct swath_file *file,
                                   const sonject_transfer_params *transfer,
                                   struct view_image *image)
{
    struct raster_layout layout;
    sonject_transfer_params limited = *transfer;
    swath_file_layout(file, &layout);
    swath_file_limit(file, &limited);
    const uint64_t longest = layout.rows > layout.columns ? layout.rows : layout.columns;
    image->block = (longest + SIDE_LIMIT - 1) / SIDE_LIMIT;
    image->rows = (size_t)((layout.rows + image->block - 1) / image->block);
    image->columns = (size_t)((layout.columns + image->block - 1) / image->block);
    image->amplitude = allocate_array(image->rows * image->columns, sizeof(float));
    struct region strip = {0, 0, layout.rows < 256 ? layout.rows : 256, layout.columns};
    size_t bytes = 0;
    size_t row_bytes = 0;
    const struct region one_row = {0, 0, 1, layout.columns};
    if (!region_bytes(&layout, &strip, &bytes) || !region_bytes(&layout, &one_row, &row_bytes))
        return report_out_of_memory(report, path);
    unsigned char *stored = allocate_array(bytes, 1);
    float *linear = allocate_array((size_t)layout.columns, layout.channels * sizeof *linear);
    sonject_status status =
        stored && linear && image->amplitude ? SONJECT_OK : report_out_of_memory(report, path);
    for (; status == SONJECT_OK && strip.first_row < layout.rows; strip.first_row += strip.rows) {
        if (strip.rows > layout.rows - strip.first_row)
            strip.rows = layout.rows - strip.first_row;
        status = swath_file_read(report, file, &strip, stored);
        for (uint64_t row = 0; status == SONJECT_OK && row < strip.rows; row++)
            status = add_row(report, path, image, &limited, &layout, strip.first_row + row,
                             stored + row * row_bytes, linear);
    }
    if (status == SONJECT_OK)
        energies_to_amplitudes(image, &layout);
    free(stored);
    free(linear);
    return status;
}

/* Resamples to ground range. Steps are a column wide, or wider if the picture would be too wide. */
static sonject_status to_ground_range(struct report *report, const char *path, enum range_axis axis,
                                      double altitude, struct view_image *image,
                                      struct plot_frame *frame)
{
    const double spacing = frame->column_spacing_m;
    const double last = frame->first_range_m + spacing * (double)(image->columns - 1);
    struct range_columns columns = {axis, frame->first_range_m, spacing,
                                    spacing < 0.0 || frame->first_range_m < 0.0, image->columns};
    void *pixels = image->amplitude;
    CHECK(range_axis_change(report, path, RANGE_GROUND, altitude,
                            fmax(spacing, last / (4.0 * SIDE_LIMIT)), image->rows, sizeof(float),
                            &columns, &pixels));
    image->amplitude = pixels;
    image->columns = columns.count;
    frame->columns = columns.count;
    frame->first_range_m = columns.first_m;
    frame->column_spacing_m = columns.spacing_m;
    frame->range_label = "ground range, m";
    return SONJECT_OK;
}

static void draw_box(struct canvas *canvas, const struct plot_place *place,
                     const struct view_image *image, const struct region *box)
{
    static const struct colour orange = {255, 160, 0};
    const double down = place->height / (double)(image->rows * image->block);
    const double across = place->width / (double)(image->columns * image->block);
    canvas_frame(canvas, place->left + (int64_t)(across * (double)box->first_column),
                 place->top + (int64_t)(down * (double)box->first_row),
                 (int64_t)ceil(across * (double)box->columns),
                 (int64_t)ceil(down * (double)box->rows), orange);
}

static sonject_status draw(struct report *report, const struct plot_frame *frame,
                           const struct view_image *image, const struct region *boxes,
                           size_t box_count, const char *path)
{
    const struct plot_panel panel = {"", image->amplitude, false};
    struct canvas picture;
    struct plot_place place;
    CHECK(plot_panels(report, frame, &panel, 1, &picture.rgb, &picture.height, &picture.width,
                      &place));
    for (size_t i = 0; i < box_count; i++)
        draw_box(&picture, &place, image, &boxes[i]);
    return picture_write(report, SONJECT_OK, &picture, path);
}

/* Fills in the axes: the caller's, else the file's, else pixels. Returns the range axis. */
static enum range_axis fill_frame(struct plot_frame *frame, const sonject_quicklook_params *params,
                                  const struct image_options *options,
                                  const struct swath_file *file, const struct view_image *image,
                                  double *altitude)
{
    sonject_geometry_params geometry = options->geometry;
    struct noted_geometry noted;
    geometry_notes_read(file, &noted);
    const bool is_ground = noted.axis == RANGE_GROUND && !options->has_geometry;
    if (is_ground) /* the numbers are checked as slant ranges are */
        noted.axis = RANGE_SLANT;
    const bool has_metres = options->has_geometry || geometry_notes_to_params(&noted, &geometry);
    *altitude = params->altitude_m > 0.0 ? params->altitude_m
                : noted.altitude_m > 0.0 ? noted.altitude_m
                                         : 0.0;
    const double block = (double)image->block;
    memset(frame, 0, sizeof *frame);
    frame->rows = image->rows;
    frame->columns = image->columns;
    frame->row_spacing_m = (has_metres ? geometry.row_spacing_m : 1.0) * block;
    frame->column_spacing_m =
        (has_metres ? geometry_range(&geometry, 1.0) - geometry_range(&geometry, 0.0) : 1.0) *
        block;
    frame->first_along_track_m = has_metres ? geometry.first_along_track_m : 0.0;
    frame->first_range_m = has_metres ? geometry_range(&geometry, 0.0) : 0.0;
    frame->range_label = !has_metres ? "column" : is_ground ? "ground range, m" : "slant range, m";
    frame->minimum_db = params->minimum_db;
    frame->maximum_db = params->maximum_db;
    frame->difference_db = 20.0;
    return is_ground ? RANGE_GROUND : has_metres ? RANGE_SLANT : RANGE_UNKNOWN;
}

sonject_status draw_quicklook(struct report *report, const sonject_quicklook_params *params,
                              const struct image_options *options, const struct region *boxes,
                              size_t box_count)
{
    struct swath_file *file = NULL;
    struct view_image image = {0, 0, 1, NULL};
    struct plot_frame frame;
    double altitude = 0.0;
    file_protect(report, params->image);
    CHECK(swath_file_open_array(report, params->image, options->channel, options->array, &file));
    sonject_status status = read_reduced(report, params->image, file, &options->transfer, &image);
    if (status == SONJECT_OK) {
        const enum range_axis axis = fill_frame(&frame, params, options, file, &image, &altitude);
        if (params->range_axis == SONJECT_AXIS_GROUND)
            status = to_ground_range(report, params->image, axis, altitude, &image, &frame);
    }
    THEN(status, draw(report, &frame, &image, boxes, box_count, params->picture));
    swath_file_close(&file);
    free(image.amplitude);
    return status;
}
