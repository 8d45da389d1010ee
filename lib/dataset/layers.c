#include "dataset/layers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/file_list.h"
#include "base/memory.h"
#include "dataset/label_files.h"
#include "image/plot.h"
#include "swath/geometry_notes.h"
#include "swath/raster_file.h"

static sonject_status write_float_layer(struct report *report, const struct geometry_notes *notes,
                                        const struct swath *swath, uint32_t channels,
                                        const float *pixels, const char *path)
{
    const struct raster_layout layout = {swath->patch.rows, swath->patch.columns, channels,
                                         PIXEL_FLOAT32};
    struct raster_attribute attributes[GEOMETRY_NOTES_MAX + 2];
    memcpy(attributes, notes->attributes, sizeof notes->attributes);
    attributes[notes->count] = (struct raster_attribute){"sonject:phase_sign", "exp(+i 2 pi f t)"};
    attributes[notes->count + 1] = (struct raster_attribute){
        "sonject:normalisation",
        channels == 2 ? "target_strength, |pixel|^2 in m^2" : "target_strength, pixel in m^2"};
    static const char *const complex_names[] = {"real", "imag"};
    return raster_file_write(report, path, &layout, channels == 2 ? complex_names : NULL,
                             attributes, notes->count + 2, pixels);
}

static sonject_status write_mask(struct report *report, const struct swath *swath,
                                 const uint8_t *mask, const char *path)
{
    const struct raster_layout layout = {swath->layout.rows, swath->layout.columns, 1, PIXEL_UINT8};
    return raster_file_write_placed(report, path, &layout, &swath->patch, mask, NULL);
}

static void amplitude_of(const float *pixels, size_t count, bool is_complex, float *amplitude)
{
    for (size_t i = 0; i < count; i++)
        amplitude[i] = is_complex ? hypotf(pixels[2 * i], pixels[2 * i + 1]) : pixels[i];
}

/* 20 log10(after / before), 0 where nothing changed. */
static void difference_of(const float *before, const float *after, const uint8_t *influence,
                          size_t count, float *difference)
{
    for (size_t i = 0; i < count; i++)
        difference[i] = influence[i] && before[i] > 0.0f && after[i] > 0.0f
                            ? 20.0f * log10f(after[i] / before[i])
                            : 0.0f;
}

static sonject_status draw_panels(struct report *report, const struct scene *scene,
                                  const struct swath *swath, const float *planes, const char *path)
{
    const size_t count = (size_t)swath->patch.rows * (size_t)swath->patch.columns;
    const sonject_geometry_params *geometry = &scene->geometry;
    const struct plot_panel panels[] = {{"before", planes, false},
                                        {"after", planes + count, false},
                                        {"difference, dB", planes + 2 * count, true}};
    struct plot_frame frame;
    frame.rows = swath->patch.rows;
    frame.columns = swath->patch.columns;
    frame.first_along_track_m =
        geometry->first_along_track_m + (double)swath->patch.first_row * geometry->row_spacing_m;
    frame.row_spacing_m = geometry->row_spacing_m;
    frame.first_range_m = geometry->first_slant_range_m +
                          (double)swath->patch.first_column * geometry->column_spacing_m;
    frame.column_spacing_m = geometry->column_spacing_m;
    frame.range_label = "slant range, m";
    frame.minimum_db = 0.0;
    frame.maximum_db = 0.0;
    frame.difference_db = 20.0;
    uint8_t *picture = NULL;
    uint32_t height, width;
    CHECK(plot_panels(report, &frame, panels, 3, &picture, &height, &width));
    const struct raster_layout layout = {height, width, 3, PIXEL_UINT8};
    sonject_status status = raster_file_write(report, path, &layout, NULL, NULL, 0, picture);
    free(picture);
    return status;
}

static sonject_status write_quicklook(struct report *report, const struct scene *scene,
                                      const struct swath *swath,
                                      const struct injection_result *result, const char *path)
{
    const size_t count = result->rows * result->columns;
    float *planes = allocate_array(count, 3 * sizeof *planes);
    CHECK_MEMORY(report, planes, "the quicklook");
    amplitude_of(swath->pixels, count, result->is_complex, planes);
    amplitude_of(result->image, count, result->is_complex, planes + count);
    difference_of(planes, planes + count, result->influence, count, planes + 2 * count);
    const sonject_status status = draw_panels(report, scene, swath, planes, path);
    free(planes);
    return status;
}

/* Orders that this result has not may be there from a run before. */
static sonject_status write_order_energies(struct report *report,
                                           const struct geometry_notes *notes,
                                           struct run_facts *facts, const char *folder)
{
    const struct injection_result *result = facts->result;
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < SCENE_INTERACTIONS_MAX; i++) {
        char name[32];
        snprintf(name, sizeof name, "energy_order_%u.tif", (unsigned)i + 1);
        char *path = path_join(folder, name);
        CHECK_MEMORY(report, path, "a path");
        if (i >= result->orders)
            file_discard(path);
        else
            status =
                write_float_layer(report, notes, facts->swath, 1, result->order_energy[i], path);
        free(path);
        if (status == SONJECT_OK && i < result->orders)
            status = file_list_add(&facts->files, report, folder, name, true);
    }
    return status;
}

sonject_status write_layers(struct report *report, struct run_facts *facts, const char *folder)
{
    static const char *const names[] = {"patch.tif",    "energy.tif", "highlight.png",
                                        "shadow.png",   "labels.png", "influence.png",
                                        "quicklook.png"};
    const struct scene *scene = facts->scene;
    const struct swath *swath = facts->swath;
    const struct injection_result *result = facts->result;
    struct geometry_notes notes;
    geometry_notes_init(&notes, &scene->sonar, &scene->geometry, (double)swath->patch.first_row,
                        (double)swath->patch.first_column);
    sonject_status status = SONJECT_OK;
    for (size_t i = 0; status == SONJECT_OK && i < sizeof names / sizeof *names; i++) {
        char *path = path_join(folder, names[i]);
        CHECK_MEMORY(report, path, "a path");
        if (i == 0)
            status = write_float_layer(report, &notes, swath, 2, result->field, path);
        else if (i == 1)
            status = write_float_layer(report, &notes, swath, 1, result->energy, path);
        else if (i == 6)
            status = write_quicklook(report, scene, swath, result, path);
        else if (i == 4)
            status = write_label_mask(report, swath, &swath->patch, result->labels, path);
        else
            status = write_mask(report, swath,
                                i == 2   ? result->highlight
                                : i == 3 ? result->shadow
                                         : result->influence,
                                path);
        free(path);
        THEN(status, file_list_add(&facts->files, report, folder, names[i], true));
    }
    THEN(status, write_order_energies(report, &notes, facts, folder));
    return status;
}
