#include "inject/compose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "measure/contacts.h"

/* Grows a box by a pixel. A box without rows holds nothing. */
static void box_include(sonject_box *box, size_t row, size_t column)
{
    const bool is_empty = box->rows == 0;
    const uint64_t end_row = is_empty ? 0 : box->first_row + box->rows;
    const uint64_t end_column = is_empty ? 0 : box->first_column + box->columns;
    box->first_row = is_empty || row < box->first_row ? row : box->first_row;
    box->first_column = is_empty || column < box->first_column ? column : box->first_column;
    box->rows = (row + 1 > end_row ? row + 1 : end_row) - box->first_row;
    box->columns = (column + 1 > end_column ? column + 1 : end_column) - box->first_column;
}

static bool box_is_cut(const sonject_box *box, const struct echoes *echoes)
{
    return box->rows > 0 && (box->first_row == 0 || box->first_column == 0 ||
                             box->first_row + box->rows == echoes->rows ||
                             box->first_column + box->columns == echoes->columns);
}

/* Returns whether some ray met the object so near that the pixel is of its echo's main lobe. Side
 * lobes do not count. */
static bool is_of_lobe(const struct object_echo *echo, size_t rows, size_t row, size_t column)
{
    const size_t local = column - echo->first_column;
    const size_t low_row = row > echo->lobe_rows ? row - echo->lobe_rows : 0;
    const size_t low = local > echo->lobe_columns ? local - echo->lobe_columns : 0;
    for (size_t r = low_row; r <= row + echo->lobe_rows && r < rows; r++)
        for (size_t c = low; c <= local + echo->lobe_columns && c < echo->columns; c++)
            if (echo->covered[r * echo->columns + c])
                return true;
    return false;
}

/* The expected energies of a pixel, m^2. */
struct pixel_levels {
    double own, others, background, hidden_share;
};

static struct pixel_levels levels_at(const struct patch_level *level, const struct echoes *echoes,
                                     const struct object_echo *echo, size_t row, size_t column)
{
    const size_t i = row * echoes->columns + column;
    const size_t local = row * echo->columns + column - echo->first_column;
    const double without = echoes->seabed_energy[i];
    struct pixel_levels levels;
    levels.own = echo->energy[local];
    levels.others = fmax(0.0, (double)echoes->target_energy[i] - levels.own);
    levels.background = fmax(0.0, without - echoes->lost_energy[i]) +
                        noise_over_level(level, i) * level->cell_energy[column];
    levels.hidden_share = without > 0.0 ? echo->lost[local] / without : 0.0;
    return levels;
}

static float intensity_at(const struct injected_window *result, size_t i)
{
    const float *image = result->image;
    if (!result->is_complex)
        return image[i] * image[i];
    return image[2 * i] * image[2 * i] + image[2 * i + 1] * image[2 * i + 1];
}

static void find_object(const struct patch_level *level, double ceiling,
                        const struct echoes *echoes, const bool *is_empty, uint32_t number,
                        struct injected_window *result)
{
    const struct object_echo *echo = &echoes->objects[number];
    sonject_object_truth *truth = &result->objects[number];
    const uint8_t label = (uint8_t)(number + 1);
    const float most = (float)ceiling * (float)ceiling;
    uint64_t clipped = 0;
    double energy = 0.0;
    double dominant = 0.0;
    double strongest = 0.0;
    truth->ceiling_over_seabed_db = NAN;
    for (size_t row = 0; echo->energy && row < echoes->rows; row++)
        for (size_t column = echo->first_column;
             !is_empty[row] && column < echo->first_column + echo->columns; column++) {
            const size_t i = row * echoes->columns + column;
            const struct pixel_levels levels = levels_at(level, echoes, echo, row, column);
            energy += levels.own;
            if (levels.own > levels.background && levels.own > levels.others)
                dominant += levels.own;
            if (levels.own > levels.background && is_of_lobe(echo, echoes->rows, row, column)) {
                result->highlight[i] = 255;
                result->labels[i] = label;
                box_include(&truth->highlight, row, column);
                truth->highlight_pixels++;
                clipped += intensity_at(result, i) >= most;
                if (levels.own > strongest) {
                    strongest = levels.own;
                    truth->ceiling_over_seabed_db = decibels(ceiling * ceiling / level->level[i]);
                }
            } else if (levels.hidden_share > 0.5) {
                result->labels[i] = result->labels[i] ? result->labels[i] : label;
                result->shadow[i] = 255;
                box_include(&truth->shadow, row, column);
                truth->shadow_pixels++;
            } else {
                continue;
            }
            box_include(&truth->both, row, column);
        }
    truth->is_visible = truth->both.rows > 0;
    truth->highlight_is_cut = box_is_cut(&truth->highlight, echoes);
    truth->shadow_is_cut = box_is_cut(&truth->shadow, echoes);
    truth->highlight_visible = energy > 0.0 ? dominant / energy : NAN;
    truth->highlight_clipped =
        truth->highlight_pixels > 0 ? (double)clipped / (double)truth->highlight_pixels : NAN;
    truth->target_strength_db = decibels(echo->peak_energy);
}

/* Finds the visible share of an object's shadow, once the masks of all objects are known. */
static void find_visible_shadow(const struct patch_level *level, const struct echoes *echoes,
                                uint32_t number, struct injected_window *result)
{
    const struct object_echo *echo = &echoes->objects[number];
    sonject_object_truth *truth = &result->objects[number];
    uint64_t pixels = 0;
    for (size_t row = 0; echo->energy && row < echoes->rows; row++)
        for (size_t local = 0; local < echo->columns; local++) {
            const size_t column = echo->first_column + local;
            const size_t i = row * echoes->columns + column;
            if (result->shadow[i] && levels_at(level, echoes, echo, row, column).hidden_share > 0.5)
                pixels++;
        }
    truth->shadow_visible =
        truth->shadow_pixels > 0 ? (double)pixels / (double)truth->shadow_pixels : NAN;
}

static double transmission_loss(const struct tracer *tracer, const double point[3], double grazing)
{
    const struct arrival ray = ray_path_arrival(&tracer->view.water, grazing, point[2]);
    return 10.0 * log10(ray.ground_range_m * ray.wavefront_m / ray.spreading) +
           tracer->scene->medium.absorption_db_per_m * ray.length_m;
}

/* Returns the size from one side of an object to the other. Moves the centre, in which one part has
 * its own centre, to the middle between both sides of several. */
static double overall_size(const struct tracer *tracer, const struct placed_object *object,
                           const double direction[3], double centre[3])
{
    const double back[3] = {-direction[0], -direction[1], -direction[2]};
    double low = INFINITY;
    double high = -INFINITY;
    for (uint32_t i = 0; i < object->part_count; i++) {
        const struct placement *part = &tracer->placements[object->first_part + i];
        double at = 0.0;
        for (int axis = 0; axis < 3; axis++)
            at += (part->centre[axis] - centre[axis]) * direction[axis];
        high = fmax(high, at + placement_extent(part, direction));
        low = fmin(low, at - placement_extent(part, back));
    }
    for (int axis = 0; axis < 3 && object->part_count > 1; axis++)
        centre[axis] += 0.5 * (low + high) * direction[axis];
    return high > low ? high - low : 0.0;
}

static void locate(const struct tracer *tracer, uint32_t number, sonject_object_truth *truth)
{
    const struct placed_object *object = &tracer->objects[number];
    const struct patch_view *view = &tracer->view;
    double axes[3][3], centre[3];
    memcpy(centre, tracer->placements[object->first_part].centre, sizeof centre);
    object_axes(axes, &tracer->scene->objects[number], view->is_mirrored);
    truth->struct_size = sizeof *truth;
    truth->overall_length_m = overall_size(tracer, object, axes[0], centre);
    truth->overall_width_m = overall_size(tracer, object, axes[1], centre);
    truth->overall_height_m = overall_size(tracer, object, axes[2], centre);
    truth->along_track_m = centre[0];
    truth->ground_range_m = centre[1];
    truth->height_m = centre[2];
    truth->burial_m = -(object->bottom_m - object->seabed_m);
    truth->slant_range_m = ray_path_range(&view->water, centre[1], centre[2]) * view->range_ratio;
    truth->row = view_row_of_x(view, centre[0]);
    truth->column = view_column_of_range(view, truth->slant_range_m);
    const double ray = ray_path_grazing(&view->water, centre[1], centre[2]);
    truth->grazing_rad = ray_path_direction(&view->water, centre[1], centre[2]);
    truth->transmission_loss_db = transmission_loss(tracer, centre, ray);
}

/* Returns the expected energy of a pixel with one object alone, over plain seabed: the echo, echoes
 * by way of the seabed or other objects, the seabed that is left, and noise for the rest. */
static double expected_over_seabed(const struct patch_level *level, const struct echoes *echoes,
                                   const struct object_echo *echo, size_t row, size_t column)
{
    const size_t i = row * echoes->columns + column;
    const double without = echoes->seabed_energy[i];
    double indirect = echoes->target_energy[i];
    double own = 0.0;
    double hidden = 0.0;
    for (uint32_t k = 0; k < echoes->object_count; k++) {
        const struct object_echo *other = &echoes->objects[k];
        if (!other->energy || column - other->first_column >= other->columns)
            continue;
        const size_t local = row * other->columns + column - other->first_column;
        indirect -= (double)other->energy[local];
        if (other == echo) {
            own = other->energy[local];
            hidden = without > 0.0 ? fmin(1.0, other->lost[local] / without) : 0.0;
        }
    }
    return (own + fmax(0.0, indirect)) / (double)level->cell_energy[column] + 1.0 - hidden +
           hidden * noise_over_level(level, i);
}

/* Measures an object, as it is expected to show, like a contact: in its box with a margin. */
static sonject_status measure_object(const struct tracer *tracer, const struct patch_level *level,
                                     const struct speckle_statistics *speckle,
                                     const struct echoes *echoes, uint32_t number,
                                     sonject_object_truth *truth)
{
    const sonject_box wide = box_with_margin(&truth->both, CONTACT_MARGIN + SEABED_MARGIN,
                                             echoes->rows, echoes->columns);
    struct contact_place place;
    struct contact_image image;
    struct contact_sizes sizes;
    float *expected = allocate_array(wide.rows, wide.columns * sizeof *expected);
    CHECK_MEMORY(tracer->report, expected, "an object's measures");
    for (size_t i = 0; i < wide.rows * wide.columns; i++)
        expected[i] = (float)expected_over_seabed(level, echoes, &echoes->objects[number],
                                                  wide.first_row + i / wide.columns,
                                                  wide.first_column + i % wide.columns);
    memset(&place, 0, sizeof place);
    place.box = box_with_margin(&truth->both, CONTACT_MARGIN, echoes->rows, echoes->columns);
    place.box.first_row -= wide.first_row;
    place.box.first_column -= wide.first_column;
    place.bright = place.box;
    sonject_status status =
        contact_image_create(&image, tracer->report, expected, wide.rows, wide.columns);
    image.speckle = *speckle;
    THEN(status, measure_contact_sizes(&image, tracer->report, &place, &sizes));
    if (status == SONJECT_OK) {
        const struct patch_view *view = &tracer->view;
        truth->highlight_contrast_db = decibels(sizes.highlight_intensity / sizes.seabed);
        truth->shadow_contrast_db = decibels(sizes.shadow_intensity / sizes.seabed);
        truth->highlight_along_m = sizes.highlight_rows.pixels * view->row_spacing_m;
        truth->highlight_range_m = sizes.highlight_columns.pixels * view->column_spacing_m;
        truth->shadow_along_m = sizes.shadow_rows.pixels * view->row_spacing_m;
        truth->shadow_range_m = sizes.shadow_columns.pixels * view->column_spacing_m;
        truth->gap_range_m = sizes.gap_columns.pixels * view->column_spacing_m;
        truth->dim_range_m = sizes.dim_columns.pixels * view->column_spacing_m;
    }
    contact_image_clear(&image);
    free(expected);
    return status;
}

/* Returns a box counted from the corner of another that holds it. */
static sonject_box box_within(const sonject_box *box, const sonject_box *wide)
{
    sonject_box inner = *box;
    inner.first_row -= wide->first_row;
    inner.first_column -= wide->first_column;
    return inner;
}

/* Measures how the object shows amid the image's own speckle, in pixels of at most the ceiling. The
 * first water_columns and empty rows are no seabed. */
static sonject_status see_object(struct report *report, const struct injected_window *result,
                                 double ceiling, size_t water_columns, const bool *is_empty,
                                 sonject_object_truth *truth)
{
    const sonject_box wide =
        box_with_margin(&truth->both, SEABED_MARGIN, result->at.rows, result->at.columns);
    const sonject_box highlight = box_within(&truth->highlight, &wide);
    const sonject_box shadow = box_within(&truth->shadow, &wide);
    const float most = (float)ceiling * (float)ceiling;
    struct contact_visibility visibility = {NAN, NAN};
    float *intensity = allocate_array(wide.rows, wide.columns * sizeof *intensity);
    struct contact_image image = {.intensity = intensity,
                                  .rows = wide.rows,
                                  .columns = wide.columns,
                                  .taken = allocate_array(wide.rows, wide.columns),
                                  .seabed_columns =
                                      allocate_array(wide.rows, sizeof *image.seabed_columns)};
    sonject_status status = intensity && image.taken && image.seabed_columns
                                ? SONJECT_OK
                                : report_out_of_memory(report, "an object's measures");
    for (size_t row = 0; status == SONJECT_OK && row < wide.rows; row++) {
        const size_t first = (wide.first_row + row) * result->at.columns + wide.first_column;
        if (water_columns > wide.first_column)
            image.seabed_columns[row] = water_columns - wide.first_column;
        memcpy(image.taken + row * wide.columns, result->labels + first, wide.columns);
        if (is_empty[wide.first_row + row])
            memset(image.taken + row * wide.columns, 1, wide.columns);
        for (size_t column = 0; column < wide.columns; column++)
            intensity[row * wide.columns + column] =
                fminf(intensity_at(result, first + column), most);
    }
    THEN(status, measure_visibility(&image, report, &highlight, &shadow, &visibility));
    truth->highlight_visibility_db = visibility.highlight_db;
    truth->shadow_visibility_db = visibility.shadow_db;
    contact_image_clear(&image);
    free(intensity);
    return status;
}

static sonject_status measure_objects(const struct tracer *tracer, const struct patch_level *level,
                                      const struct image_match *match, const struct echoes *echoes,
                                      const bool *is_empty, struct injected_window *result)
{
    sonject_status status = SONJECT_OK;
    for (uint32_t i = 0; status == SONJECT_OK && i < echoes->object_count; i++) {
        sonject_object_truth *truth = &result->objects[i];
        if (!tracer_follows(tracer, i))
            continue;
        truth->highlight_contrast_db = truth->shadow_contrast_db = NAN;
        truth->highlight_along_m = truth->highlight_range_m = NAN;
        truth->shadow_along_m = truth->shadow_range_m = NAN;
        truth->gap_range_m = truth->dim_range_m = NAN;
        truth->highlight_visibility_db = truth->shadow_visibility_db = NAN;
        if (!truth->is_visible)
            continue;
        status = measure_object(tracer, level, &match->seabed, echoes, i, truth);
        THEN(status, see_object(tracer->report, result, match->ceiling,
                                view_water_columns(&tracer->view), is_empty, truth));
    }
    return status;
}

sonject_status find_truth(const struct tracer *tracer, const struct patch_level *level,
                          const struct image_match *match, const bool *is_empty,
                          const struct echoes *echoes, struct injected_window *result)
{
    for (uint32_t i = 0; i < echoes->object_count; i++)
        if (tracer_follows(tracer, i)) {
            locate(tracer, i, &result->objects[i]);
            find_object(level, match->ceiling, echoes, is_empty, i, result);
        }
    /* Another object's echo in a shadow is a highlight. */
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++)
        if (result->highlight[i])
            result->shadow[i] = 0;
    for (uint32_t i = 0; i < echoes->object_count; i++)
        if (tracer_follows(tracer, i))
            find_visible_shadow(level, echoes, i, result);
    return measure_objects(tracer, level, match, echoes, is_empty, result);
}
