/* A calibration as a document: the keys that a scene takes, and what was measured. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "measure/calibration.h"
#include "scene/geometry.h"
#include "schema/keys.h"

#define DIGITS        4
#define WHOLE_MOST    1e6 /* whole numbers below, such as a ceiling, keep all digits */
#define LINE_WIDTH    96
#define MISFIT_UNSEEN 0.005 /* share of pixels off that levels within plain tiles explain */
#define LOOKS_KEPT    64.0  /* most looks that injection.match.looks takes */
#define RETURNS_MOST                                                                               \
    20000 /* most first returns that are listed; a scene's reader takes TREE_NODES_MAX values */

static const uint32_t family_kinds[] = {[CURVE_POWER] = SONJECT_TRANSFER_GAMMA,
                                        [CURVE_DECIBEL] = SONJECT_TRANSFER_DECIBEL,
                                        [CURVE_SCHLICK] = SONJECT_TRANSFER_SCHLICK};
static const char *const side_words[] = {
    [WATER_AT_LEFT] = "one, range grows to the right",
    [WATER_AT_RIGHT] = LEFTWARD_SIDES,
    [WATER_BETWEEN] = "two",
};

/* Returns a number of four digits, so that no last bit of a logarithm decides a pixel. */
static double rounded(double value)
{
    char text[DIGITS + 16];
    double number = value;
    const char *rest;
    if (isfinite(value))
        text_to_number(text_of_number(text, sizeof text, value, DIGITS), &number, &rest);
    return number;
}

static json_t *number_of(double value)
{
    return fabs(value) < WHOLE_MOST && value == floor(value) ? json_integer((json_int_t)value)
                                                             : json_number(rounded(value));
}

/* Returns a column of the swath, to halves: four digits would not resolve those of wide swaths. */
static json_t *column_of(double column)
{
    return json_number(0.5 * round(2.0 * column));
}

static json_t *quantity(double value, const char *unit)
{
    char number[DIGITS + 16], text[DIGITS + 24];
    snprintf(text, sizeof text, "%s %s", text_of_number(number, sizeof number, value, DIGITS),
             unit);
    return json_text(text);
}

static json_t *seen(const struct estimate *estimate, const char *unit)
{
    json_t *object = json_object();
    if (estimate->unseen) {
        json_add(&object, "not_seen", json_text(estimate->unseen));
        return object;
    }
    json_add(&object, "value", number_of(estimate->value));
    json_add(&object, "standard_error", number_of(estimate->error));
    if (unit)
        json_add(&object, "unit", json_text(unit));
    if (estimate->how)
        json_add(&object, "how", json_text(estimate->how));
    return object;
}

/* Returns a length, m, that the file or the caller gave. */
static json_t *told(double value)
{
    return JSON_OBJECT({"value", number_of(value)}, {"unit", json_text("m")});
}

static json_t *transfer_keys(const struct calibration *found)
{
    json_t *transfer = json_object();
    const bool has_parameter = found->transfer.kind >= SONJECT_TRANSFER_DECIBEL;
    if (!found->transfer_kind.unseen && !(has_parameter && found->parameter.unseen)) {
        json_add(&transfer, "kind", json_text(transfer_word(found->transfer.kind)));
        if (has_parameter)
            json_add(&transfer, "parameter", number_of(found->transfer.parameter));
    }
    if (!found->full_scale.unseen)
        json_add(&transfer, "full_scale", number_of(found->full_scale.value));
    return transfer;
}

/* Adds a section if it has keys, or else releases it. */
static void add_section(json_t **document, const char *key, json_t *section)
{
    if (section && json_object_size(section) == 0)
        json_decref(section);
    else
        json_add(document, key, section);
}

static void add_scene_keys(json_t **document, const struct calibration *found)
{
    json_t *input = json_object(), *sonar = json_object(), *injection = json_object();
    add_section(&input, "transfer", transfer_keys(found));
    if (found->returns.sides == WATER_BETWEEN || found->returns.sides == WATER_AT_RIGHT)
        json_add(&input, "geometry",
                 JSON_OBJECT({"nadir_column", column_of(found->returns.nadir_column)}));
    add_section(document, "input", input);
    if (!found->altitude_m.unseen)
        json_add(&sonar, "altitude", quantity(found->altitude_m.value, "m"));
    add_section(document, "sonar", sonar);
    if (!found->noise_floor_db.unseen)
        json_add(&injection, "noise_floor", quantity(found->noise_floor_db.value, "dB"));
    if (!found->looks.unseen && found->looks.value <= LOOKS_KEPT)
        json_add(&injection, "match", JSON_OBJECT({"looks", number_of(found->looks.value)}));
    add_section(document, "injection", injection);
}

/* Lists the numbers at multiples of every. */
static json_t *numbers(const double *values, size_t count, size_t every)
{
    json_t *list = json_array();
    for (size_t i = 0; i < count; i += every)
        json_append(&list, number_of(values[i]));
    return list;
}

const char *curve_text(const struct calibration *found, enum curve_family family,
                       char text[CURVE_TEXT_CAPACITY])
{
    char number[DIGITS + 16];
    const bool is_other_power =
        family == CURVE_POWER && found->family == CURVE_POWER && found->alike[CURVE_POWER];
    const double parameter = is_other_power ? found->alike_exponent : found->fits[family].parameter;
    snprintf(text, CURVE_TEXT_CAPACITY, "%s %s", transfer_word(family_kinds[family]),
             text_of_number(number, sizeof number, parameter, DIGITS));
    return text;
}

bool curve_fits(const struct curve_fit *fit)
{
    return fit->misfit <= CLEARLY * fit->misfit_error + MISFIT_UNSEEN;
}

static json_t *measured_curve(const struct calibration *found)
{
    json_t *curve = json_object();
    json_t *alike = json_array();
    if (found->transfer_kind.unseen) {
        json_decref(alike);
        json_add(&curve, "not_seen", json_text(found->transfer_kind.unseen));
        return curve;
    }
    json_add(&curve, "kind", json_text(transfer_word(found->transfer.kind)));
    for (int family = 0; family < CURVE_FAMILIES; family++)
        if (found->alike[family]) {
            char text[CURVE_TEXT_CAPACITY];
            json_append(&alike, json_text(curve_text(found, (enum curve_family)family, text)));
        }
    json_add(&curve, "cannot_be_told_from", alike);
    if (found->transfer.kind >= SONJECT_TRANSFER_DECIBEL)
        json_add(&curve, "parameter", seen(&found->parameter, NULL));
    const struct curve_fit *fit = &found->fits[found->family];
    json_add(
        &curve, "misfit",
        JSON_OBJECT({"value", number_of(fit->misfit)},
                    {"standard_error", number_of(fit->misfit_error)},
                    {"fits", json_boolean(curve_fits(fit))},
                    {"how", json_text("largest distance between the shares of pixels below a level "
                                      "and the law's; fits to 3 errors and 0.005")}));
    json_add(&curve, "tiles", json_count(found->tiles.count));
    json_add(&curve, "tile_side", json_count(found->tiles.side));
    return curve;
}

static json_t *measured_response(const struct estimate *width, const double *correlation,
                                 const char *unit, double spacing_m)
{
    json_t *object = seen(width, unit);
    if (!width->unseen && spacing_m > 0.0)
        json_add(&object, "metres", number_of(width->value * spacing_m));
    if (correlation[0] > 0.0)
        json_add(&object, "correlation", numbers(correlation, CALIBRATION_LAGS, 1));
    return object;
}

static json_t *measured_gain(const struct calibration *found)
{
    double middles[GAIN_BANDS];
    const size_t bands = found->gain_bands;
    for (size_t band = 0; band < bands; band++)
        middles[band] = ((double)band + 0.5) * (double)found->columns / (double)bands - 0.5;
    return JSON_OBJECT({"columns", numbers(middles, bands, 1)},
                       {"decibels", numbers(found->gain_db, bands, 1)},
                       {"standard_error", numbers(found->gain_error_db, bands, 1)});
}

json_t *calibration_document(const struct calibration *found, const char *path, const char *hash,
                             const char *channel)
{
    json_t *document = JSON_OBJECT({"sonject_calibration", json_integer(1)});
    json_t *measured = json_object();
    add_scene_keys(&document, found);
    if (path)
        json_add(&measured, "swath", json_text(path));
    if (hash)
        json_add(&measured, "swath_xxh3", json_text(hash));
    if (channel)
        json_add(&measured, "channel", json_text(channel));
    if (found->side != SIDE_UNKNOWN)
        json_add(&measured, "side",
                 json_text(found->side == SONJECT_SIDE_PORT ? "port" : "starboard"));
    json_add(&measured, "rows", json_count(found->rows));
    json_add(&measured, "columns", json_count(found->columns));
    if (found->column_spacing_m > 0.0)
        json_add(&measured, "column_spacing", told(found->column_spacing_m));
    json_add(&measured, "transfer", measured_curve(found));
    json_add(&measured, "largest_number", JSON_OBJECT({"value", number_of(found->largest_number)}));
    json_add(&measured, "full_scale", seen(&found->full_scale, NULL));
    json_add(&measured, "clipped", seen(&found->clipped, NULL));
    json_t *seabed = seen(&found->seabed_db, "dB");
    if (!found->seabed_db.unseen) {
        json_add(&seabed, "row", json_count(found->plain_row));
        json_add(&seabed, "column", json_count(found->plain_column));
    }
    json_add(&measured, "seabed_level", seabed);
    json_add(&measured, "ceiling_over_seabed", seen(&found->room_db, "dB"));
    json_add(&measured, "looks", seen(&found->looks, NULL));
    json_add(&measured, "k_shape", seen(&found->shape, NULL));
    json_add(
        &measured, "response_along_track",
        measured_response(&found->along_rows, found->correlation[0], "rows", found->row_spacing_m));
    json_add(&measured, "response_range",
             measured_response(&found->range_columns, found->correlation[1], "columns",
                               found->column_spacing_m));
    json_t *floor = seen(&found->noise_floor_db, "dB");
    if (!found->noise_floor_db.unseen)
        json_add(&floor, "shadows", json_count(found->shadows));
    json_add(&measured, "noise_floor", floor);
    if (found->returns.sides != WATER_UNSEEN)
        json_add(&measured, "sides", json_text(side_words[found->returns.sides]));
    json_t *nadir = seen(&found->nadir_column, NULL);
    if (!found->nadir_column.unseen)
        json_add(&nadir, "value", column_of(found->nadir_column.value));
    json_add(&measured, "nadir_column", nadir);
    json_add(&measured, "altitude", seen(&found->altitude_m, "m"));
    if (found->recorded_altitude_m > 0.0) {
        json_t *recorded = told(found->recorded_altitude_m);
        if (found->recorded_share > 0.0)
            json_add(&recorded, "over_first_return", number_of(found->recorded_share));
        json_add(&measured, "recorded_altitude", recorded);
    }
    if (found->returns.columns) {
        const size_t every = (found->rows - 1) / RETURNS_MOST + 1;
        json_add(&measured, "first_return_every", json_count(every));
        json_add(&measured, "first_return", numbers(found->returns.columns, found->rows, every));
    }
    if (!found->transfer_kind.unseen)
        json_add(&measured, "gain", measured_gain(found));
    json_add(&document, "measured", measured);
    return document;
}

/* ---- YAML. */

static void add_value(struct growing_text *text, const json_t *value)
{
    char number[DIGITS + 24];
    if (json_is_string(value))
        tree_write_text(json_string_value(value), text);
    else if (json_is_integer(value))
        growing_text_add(text, "%lld", (long long)json_integer_value(value));
    else if (json_is_real(value))
        growing_text_add(text, "%s",
                         text_of_number(number, sizeof number, json_real_value(value), 10));
    else if (json_is_boolean(value))
        growing_text_add(text, "%s", json_is_true(value) ? "true" : "false");
    else
        growing_text_add(text, "null");
}

static void add_list(struct growing_text *text, const json_t *list, int depth)
{
    size_t start = text->length;
    growing_text_add(text, " [");
    for (size_t i = 0; i < json_array_size(list); i++) {
        if (i > 0)
            growing_text_add(text, ",");
        if (text->length - start > LINE_WIDTH) {
            growing_text_add(text, "\n%*s", 2 * depth + 1, "");
            start = text->length;
        }
        growing_text_add(text, i > 0 ? " " : "");
        add_value(text, json_array_get(list, i));
    }
    growing_text_add(text, "]\n");
}

static void add_object(struct growing_text *text, const json_t *object, int depth)
{
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value)
    {
        growing_text_add(text, "%*s%s:", 2 * depth, "", key);
        if (json_is_object(value)) {
            growing_text_add(text, "\n");
            add_object(text, value, depth + 1);
        } else if (json_is_array(value)) {
            add_list(text, value, depth);
        } else {
            growing_text_add(text, " ");
            add_value(text, value);
            growing_text_add(text, "\n");
        }
    }
}

sonject_status document_as_yaml(struct report *report, const json_t *document, char **text)
{
    struct growing_text lines = {NULL, 0, 0, false};
    *text = NULL;
    CHECK_MEMORY(report, document, "a calibration");
    growing_text_add(
        &lines,
        "# A swath's calibration. A scene with input.calibration takes the keys above `measured`;\n"
        "# the scene's own keys take precedence.\n");
    add_object(&lines, document, 0);
    *text = growing_text_end(&lines);
    CHECK_MEMORY(report, *text, "a calibration");
    return SONJECT_OK;
}
