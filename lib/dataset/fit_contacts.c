/* The contacts cut out of their images and measured: real ones where they are labelled, and
 * injected ones as they would be labelled. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/fit.h"
#include "measure/measures.h"
#include "scene/geometry.h"
#include "schema/scene_file.h"
#include "swath/geometry_notes.h"
#include "swath/recording.h"

#define CHIP_MARGIN  64  /* pixels around a label, for the seabed's level */
#define LABEL_MARGIN 2   /* pixels around a label that are also searched */
#define SHADOW_REACH 256 /* columns behind a highlight's label where its shadow is looked for */
#define SHADOW_ROWS  6   /* rows by which the shadow may be wider */
#define EDGE_REACH   2  /* columns before the image's edge at which a shadow may end that it cuts */
#define ECHO_REACH   24 /* columns before a shadow's label that may have its highlight */

void contact_chip_clear(struct contact_chip *chip)
{
    free(chip->intensity);
    memset(chip, 0, sizeof *chip);
}

/* Returns the part around a label of an image of rows x columns. A highlight's shadow lies outside
 * of its label, on either side. */
static sonject_box chip_window(const sonject_box *label, uint32_t part, size_t rows, size_t columns)
{
    const sonject_box near = box_with_margin(label, CHIP_MARGIN, rows, columns);
    sonject_box window = near;
    if (part == LABELLED_HIGHLIGHT) {
        window = box_with_margin(label, SHADOW_REACH + CHIP_MARGIN, rows, columns);
        window.first_row = near.first_row;
        window.rows = near.rows;
    }
    return window;
}

/* Cuts the intensities of a window out of pixels with `columns` columns a row, so that range grows
 * to the right. first_column: column of the first pixel in the geometry's image. ceiling: amplitude
 * at which files cut the pixels. */
static sonject_status cut_chip(struct report *report, const float *pixels, bool is_complex,
                               size_t columns, const sonject_box *window, const sonject_box *label,
                               const sonject_geometry_params *geometry, size_t first_column,
                               double ceiling, struct contact_chip *chip)
{
    const float most = (float)(ceiling * ceiling);
    const bool is_reversed = geometry_is_reversed(geometry);
    const size_t last = window->columns - 1;
    const size_t nearest = first_column + window->first_column + (is_reversed ? last : 0);
    chip->rows = window->rows;
    chip->columns = window->columns;
    chip->label = *label;
    chip->label.first_row -= window->first_row;
    chip->label.first_column -= window->first_column;
    if (is_reversed)
        chip->label.first_column = last + 1 - chip->label.first_column - label->columns;
    chip->row_spacing_m = geometry->row_spacing_m;
    chip->column_spacing_m = geometry->column_spacing_m;
    chip->first_slant_range_m = geometry_range(geometry, (double)nearest);
    chip->intensity = allocate_array(window->rows, window->columns * sizeof *chip->intensity);
    CHECK_MEMORY(report, chip->intensity, "a contact");
    for (size_t i = 0; i < window->rows * window->columns; i++) {
        const size_t column = is_reversed ? last - i % window->columns : i % window->columns;
        const size_t k =
            (window->first_row + i / window->columns) * columns + window->first_column + column;
        chip->intensity[i] = fminf(most, is_complex ? pixels[2 * k] * pixels[2 * k] +
                                                          pixels[2 * k + 1] * pixels[2 * k + 1]
                                                    : pixels[k] * pixels[k]);
    }
    return SONJECT_OK;
}

/* Returns the campaign's swath of an image's file, whose keys the image takes. A swath of the
 * wanted side goes first. Where no path is equal, the file's name alone counts. */
static const struct swath_plan *swath_of_image(const struct campaign *campaign, const char *image,
                                               uint32_t side)
{
    const struct swath_plan *found = NULL;
    int best = 0;
    for (size_t i = 0; i < campaign->swath_count; i++) {
        const struct swath_plan *swath = &campaign->swaths[i];
        const bool has_name = strcmp(path_name(swath->path), path_name(image)) == 0;
        const int fits = has_name * (1 + 2 * (strcmp(swath->path, image) == 0)) +
                         (has_name && swath->side == side);
        if (fits > best) {
            best = fits;
            found = swath;
        }
    }
    return found;
}

/* Returns the value of input.array that the campaign sets for a swath, or "". */
static const char *array_of(const struct swath_plan *swath)
{
    static const char key[] = "input.array=";
    for (size_t i = 0; i < swath->key_count; i++)
        if (strncmp(swath->keys[i], key, sizeof key - 1) == 0)
            return swath->keys[i] + sizeof key - 1;
    return "";
}

/* Returns whether another array of the swath's file is a swath, too. */
static bool has_other_array(const struct campaign *campaign, const struct swath_plan *swath)
{
    for (size_t i = 0; i < campaign->swath_count; i++)
        if (strcmp(campaign->swaths[i].path, swath->path) == 0 &&
            strcmp(array_of(&campaign->swaths[i]), array_of(swath)) != 0)
            return true;
    return false;
}

/* Reads the campaign's scene for an image without injected objects. swath: the campaign's swath of
 * the image, or NULL. side: wanted side of a recording; 0: as swath or scene say. patch: NULL for
 * the whole image, where the altitude does not count. */
static sonject_status read_image_scene(struct sonject_campaign *campaign, const char *image,
                                       const struct swath_plan *swath, uint32_t side,
                                       const sonject_box *patch, bool tells_geometry,
                                       bool tells_altitude, struct scene *scene)
{
    const size_t keys = swath ? swath->key_count : 0;
    const size_t number = swath ? (size_t)(swath - campaign->campaign.swaths) : 0;
    char patch_text[160], path[PATH_CAPACITY], name[HASH_TEXT_CAPACITY];
    struct scene_source source = {.overrides = allocate_array(keys + 6, sizeof *source.overrides),
                                  .moved_overrides = keys,
                                  .has_no_channels = !swath_file_has_channels(image)};
    CHECK_MEMORY(campaign->report, source.overrides, "a contact's scene");
    if (swath && campaign->calibrations)
        source.made_calibration = campaign->calibrations[number];
    for (size_t i = 0; i < keys; i++)
        source.overrides[source.override_count++] = swath->keys[i];
    source.overrides[source.override_count++] = "objects=[]";
    if (tells_geometry && !swath) /* a swath's geometry is the scene's, as for injected ones */
        source.overrides[source.override_count++] = "input.geometry=from_file";
    if (side != 0 && !(swath && swath->side == side))
        source.overrides[source.override_count++] =
            side == RECORDED_PORT ? "input.channel=port" : "input.channel=starboard";
    if (!patch)
        source.overrides[source.override_count++] = "sonar.altitude=1 m";
    else if (tells_altitude && !swath) /* likewise */
        source.overrides[source.override_count++] = "sonar.altitude=from_file";
    if (patch) {
        snprintf(patch_text, sizeof patch_text,
                 "patch={row: %llu, column: %llu, rows: %llu, columns: %llu}",
                 (unsigned long long)patch->first_row, (unsigned long long)patch->first_column,
                 (unsigned long long)patch->rows, (unsigned long long)patch->columns);
        source.overrides[source.override_count++] = patch_text;
    }
    scene_init(scene);
    const size_t count = source.override_count;
    sonject_status status = campaign_read_base(campaign, image, &source, scene);
    if (status == SONJECT_OK && patch && scene->calibrates_itself) {
        if (swath) {
            status = campaign_calibrate_swath(campaign, number, scene);
            source.made_calibration = status == SONJECT_OK ? campaign->calibrations[number] : NULL;
        } else {
            status = file_hash(campaign->report, image, name);
            THEN(status, campaign_calibrate(campaign, name, scene, path));
            source.made_calibration = path;
        }
        source.override_count = count;
        THEN(status, campaign_read_base(campaign, image, &source, scene));
        if (status != SONJECT_OK)
            scene_clear(scene);
    }
    free(source.overrides);
    return status;
}

/* Returns the side on which a label lies in a picture of both sides; 0 for a picture of one. */
static uint32_t side_of_label(const sonject_box *label, double nadir_column)
{
    const double middle = (double)label->first_column + 0.5 * (double)(label->columns - 1);
    return !(nadir_column > 0.0) ? 0 : middle < nadir_column ? RECORDED_PORT : RECORDED_STARBOARD;
}

/* What an image says of itself. */
struct image_facts {
    struct raster_layout layout;
    bool tells_geometry, tells_altitude;
    bool is_swath;       /* the campaign has it as a swath */
    double nadir_column; /* 0 where the image shows one side */
    double first_slant_range_m;
};

static sonject_status describe_image(struct sonject_campaign *campaign, const char *image,
                                     uint32_t side, struct image_facts *facts)
{
    struct scene scene;
    struct swath_file *file = NULL;
    char ends[GREY_TEXT];
    memset(facts, 0, sizeof *facts);
    const struct swath_plan *swath = swath_of_image(&campaign->campaign, image, side);
    if (swath && has_other_array(&campaign->campaign, swath))
        return input_failure(campaign->report, image,
                             "has several arrays that are swaths of the campaign, and contacts do "
                             "not say which: save each array as a file of its own");
    CHECK(read_image_scene(campaign, image, swath, side, NULL, false, false, &scene));
    sonject_status status =
        swath_file_open_array(campaign->report, image, scene.channel, scene.array, &file);
    if (status == SONJECT_OK && swath_file_attribute(file, GREY_ATTRIBUTE, ends, sizeof ends) &&
        scene.transfer.kind != SONJECT_TRANSFER_DECIBEL)
        status = input_failure(campaign->report, image,
                               "was made with grey: [%s] and lacks the swath's numbers: label the "
                               "swath, or images made without grey",
                               ends);
    if (status == SONJECT_OK) {
        struct noted_geometry noted;
        sonject_geometry_params told = scene.geometry;
        swath_file_layout(file, &facts->layout);
        geometry_notes_read(file, &noted);
        facts->tells_geometry = geometry_notes_to_params(&noted, &told);
        facts->tells_altitude = isfinite(noted.altitude_m);
        facts->is_swath = swath;
        facts->nadir_column = swath ? scene.geometry.nadir_column : told.nadir_column;
        facts->first_slant_range_m = scene.geometry.first_slant_range_m;
    }
    swath_file_close(&file);
    scene_clear(&scene);
    return status;
}

/* Refuses labels of a picture of another size, whose boxes lie elsewhere in the image. */
static sonject_status check_size(struct report *report, const char *image,
                                 const struct labelled_contact *contact,
                                 const struct raster_layout *layout)
{
    if ((contact->image_rows == 0 || contact->image_rows == layout->rows) &&
        (contact->image_columns == 0 || contact->image_columns == layout->columns))
        return SONJECT_OK;
    return input_failure(report, image,
                         "the labels say %llu x %llu pixels, the image has %llu x %llu: label this "
                         "image, or scale boxes and size to it",
                         (unsigned long long)contact->image_columns,
                         (unsigned long long)contact->image_rows,
                         (unsigned long long)layout->columns, (unsigned long long)layout->rows);
}

sonject_status contact_set_place(struct sonject_campaign *campaign, struct contact_set *set)
{
    struct image_facts facts;
    bool is_told = false;
    for (size_t i = 0; i < set->count; i++) {
        struct labelled_contact *contact = &set->contacts[i];
        const struct labelled_contact *before = i > 0 ? contact - 1 : NULL;
        if (!before || before->image != contact->image || before->side != contact->side)
            CHECK(describe_image(campaign, set->images[contact->image], contact->side, &facts));
        if (!is_told && !facts.is_swath && !facts.tells_geometry) {
            is_told = true; /* once: the others are most likely alike */
            report_note(campaign->report,
                        "%s is no swath of the campaign and tells no ranges: the scene's count, "
                        "from %.4g m on; if images were cut out of a line, list the contacts in a "
                        ".csv file with the line's rows and columns",
                        set->images[contact->image], facts.first_slant_range_m);
        }
        CHECK(check_size(campaign->report, set->images[contact->image], contact, &facts.layout));
        contact->seen_side =
            contact->side ? contact->side : side_of_label(&contact->box, facts.nadir_column);
        contact->is_reversed = facts.nadir_column > 0.0 && contact->seen_side == RECORDED_PORT;
    }
    return SONJECT_OK;
}

sonject_status contact_chip_read(struct sonject_campaign *campaign, const char *image,
                                 const struct labelled_contact *contact, struct contact_chip *chip)
{
    const sonject_box *label = &contact->box;
    const uint32_t side = contact->seen_side;
    struct image_facts facts;
    const struct raster_layout *layout = &facts.layout;
    struct scene scene;
    struct swath swath;
    memset(chip, 0, sizeof *chip);
    CHECK(describe_image(campaign, image, contact->side, &facts));
    if (label->first_row >= layout->rows || label->rows > layout->rows - label->first_row ||
        label->first_column >= layout->columns ||
        label->columns > layout->columns - label->first_column)
        return input_failure(campaign->report, image,
                             "has %llu x %llu pixels, and a label's box at row %llu, column %llu "
                             "is not inside: correct the label",
                             (unsigned long long)layout->rows, (unsigned long long)layout->columns,
                             (unsigned long long)label->first_row,
                             (unsigned long long)label->first_column);
    const sonject_box window =
        chip_window(label, contact->part, (size_t)layout->rows, (size_t)layout->columns);
    const sonject_box all = {0, 0, window.rows, window.columns};
    sonject_box inner = *label;
    inner.first_row -= window.first_row;
    inner.first_column -= window.first_column;
    const struct swath_plan *plan = swath_of_image(&campaign->campaign, image, side);
    if (side == 0 && swath_of_image(&campaign->campaign, image, RECORDED_PORT) !=
                         swath_of_image(&campaign->campaign, image, RECORDED_STARBOARD))
        return input_failure(campaign->report, image,
                             "shows two sides, which are two swaths of the campaign: list its "
                             "contacts in a .csv table with a column side, port or starboard");
    CHECK(read_image_scene(campaign, image, plan, contact->side, &window, facts.tells_geometry,
                           facts.tells_altitude, &scene));
    if (side != 0)
        scene.geometry.side = side == RECORDED_PORT ? SONJECT_SIDE_PORT : SONJECT_SIDE_STARBOARD;
    sonject_status status = swath_open_stored(campaign->report, &scene, &campaign->store, &swath);
    if (status == SONJECT_OK) {
        status = cut_chip(campaign->report, swath.pixels, swath.is_complex, all.columns, &all,
                          &inner, &scene.geometry, window.first_column, INFINITY, chip);
        chip->swath = plan && (side == 0 || plan->side == side)
                          ? (size_t)(plan - campaign->campaign.swaths)
                          : SIZE_MAX;
        chip->altitude_m = scene.sonar.altitude_m;
        swath_close(&swath);
    }
    scene_clear(&scene);
    return status;
}

sonject_status contact_chip_of_image(struct report *report, const struct campaign_image *image,
                                     uint32_t part, uint64_t pad, struct contact_chip *chip,
                                     bool *is_seen)
{
    const struct injection_result *result = &image->result;
    const sonject_object_truth *truth = result->objects;
    const sonject_box *box = part == LABELLED_HIGHLIGHT ? &truth->highlight
                             : part == LABELLED_SHADOW  ? &truth->shadow
                                                        : &truth->both;
    memset(chip, 0, sizeof *chip);
    *is_seen = box->rows > 0;
    if (!*is_seen)
        return SONJECT_OK;
    const sonject_box label = box_with_margin(box, (size_t)pad, result->rows, result->columns);
    const sonject_box window = chip_window(&label, part, result->rows, result->columns);
    CHECK(cut_chip(report, result->image, result->is_complex, result->columns, &window, &label,
                   &image->scene.geometry, (size_t)image->plan.chip.first_column, result->ceiling,
                   chip));
    chip->altitude_m = image->scene.sonar.altitude_m;
    return SONJECT_OK;
}

/* Returns where the contact of a label is searched for. */
static struct contact_place place_of_label(const struct contact_chip *chip, uint32_t part)
{
    struct contact_place place = {0};
    place.box = box_with_margin(&chip->label, LABEL_MARGIN, chip->rows, chip->columns);
    place.bright = place.box;
    if (part == LABELLED_HIGHLIGHT) {
        const size_t end = place.box.first_column + place.box.columns + SHADOW_REACH;
        place.box = box_with_margin(&chip->label, SHADOW_ROWS, chip->rows, chip->columns);
        place.box.columns = (end < chip->columns ? end : chip->columns) - place.box.first_column;
        place.is_near = true;
    } else if (part == LABELLED_SHADOW) {
        const size_t before =
            place.box.first_column < ECHO_REACH ? place.box.first_column : ECHO_REACH;
        place.box.first_column -= before;
        place.box.columns += before;
        place.bright = place.box;
    }
    return place;
}

/* Returns the height over a level seabed that hides the seabed between these slant ranges, m. */
static double height_of_shadow(double altitude_m, double first_m, double end_m)
{
    const double near = sqrt(first_m * first_m - altitude_m * altitude_m);
    const double far = sqrt(end_m * end_m - altitude_m * altitude_m);
    return altitude_m * (far - near) / far;
}

static void fill_extents(const struct contact_chip *chip, const sonject_contact_measures *measures,
                         struct contact_extents *extents)
{
    const double row = chip->row_spacing_m;
    const double column = chip->column_spacing_m;
    const double middle =
        chip->first_slant_range_m + column * ((double)measures->highlight.first_column +
                                              0.5 * (double)measures->highlight.columns);
    const double end = chip->first_slant_range_m +
                       column * (double)(measures->shadow.first_column + measures->shadow.columns);
    const double ground =
        middle > chip->altitude_m ? 1.0 / sqrt(1.0 - pow(chip->altitude_m / middle, 2.0)) : NAN;
    double *of = extents->of;
    of[EXTENT_HIGHLIGHT_ALONG] = measures->highlight_along_m;
    of[EXTENT_HIGHLIGHT_RANGE] = measures->highlight_range_m * ground;
    of[EXTENT_SHADOW_ALONG] = measures->shadow_along_m;
    of[EXTENT_SHADOW_HEIGHT] =
        height_of_shadow(chip->altitude_m, end - measures->shadow_range_m, end);
    of[EXTENT_AXIS_LENGTH] = measures->axis_length_m;
    of[EXTENT_AXIS_WIDTH] = measures->axis_width_m;
    of[EXTENT_HIGHLIGHT_ROWS] = (double)measures->highlight.rows * row;
    of[EXTENT_HIGHLIGHT_COLUMNS] = (double)measures->highlight.columns * column * ground;
    of[EXTENT_SHADOW_ROWS] = (double)measures->shadow.rows * row;
    of[EXTENT_HIGHLIGHT_SLANT] = measures->highlight_range_m;
    of[EXTENT_SHADOW_SLANT] = measures->shadow_range_m;
    for (int i = 0; i < EXTENT_LENGTHS; i++)
        of[i] = of[i] > 1e-3 ? log(of[i]) : NAN;
    of[EXTENT_HIGHLIGHT_LEVEL] = measures->highlight_contrast_db;
    of[EXTENT_SHADOW_LEVEL] = measures->shadow_contrast_db;
    extents->is_shadow_cut =
        measures->shadow.rows > 0 &&
        measures->shadow.first_column + measures->shadow.columns + EDGE_REACH >= chip->columns;
    extents->highlight_visibility_db = measures->highlight_visibility_db;
    extents->shadow_visibility_db = measures->shadow_visibility_db;
}

sonject_status contact_chip_measure(struct report *report, const struct contact_chip *chip,
                                    uint32_t part, struct contact_extents *extents)
{
    const struct contact_place place = place_of_label(chip, part);
    sonject_contact_measures measures;
    for (int i = 0; i < EXTENT_KINDS; i++)
        extents->of[i] = NAN;
    extents->is_shadow_cut = false;
    extents->highlight_visibility_db = extents->shadow_visibility_db = extents->pad_pixels = NAN;
    const double range_m =
        chip->first_slant_range_m + chip->column_spacing_m * ((double)chip->label.first_column +
                                                              0.5 * (double)chip->label.columns);
    extents->range_over_altitude = range_m / chip->altitude_m;
    const sonject_status status =
        measure_placed_contact(report, chip->intensity, chip->rows, chip->columns, &place,
                               chip->row_spacing_m, chip->column_spacing_m, &measures);
    if (status == SONJECT_ERROR_INPUT) {
        report->message[0] = '\0';
        return SONJECT_OK; /* the seabed about the contact is black */
    }
    if (status != SONJECT_OK)
        return status;
    fill_extents(chip, &measures, extents);
    const sonject_box both = box_around_parts(&measures.highlight, &measures.shadow);
    const uint64_t rows = part == LABELLED_HIGHLIGHT ? measures.highlight.rows
                          : part == LABELLED_SHADOW  ? measures.shadow.rows
                                                     : both.rows;
    if (rows > 0)
        extents->pad_pixels = 0.5 * ((double)chip->label.rows - (double)rows);
    return SONJECT_OK;
}
