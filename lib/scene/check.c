/* Ranges of the values of a scene. Beyond what the public headers state, magnitudes are kept to
 * what a sonar can meet, so that no later computation overflows. */
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "scene/check_material.h"
#include "scene/scene.h"
#include "scene/shapes/shape.h"
#include "scene/surface_material.h"

#define PI 3.14159265358979323846

#define FREQUENCY_MIN_HZ 1.0
#define FREQUENCY_MAX_HZ 1e9
#define SIDE_MAX         (UINT32_C(1) << 20)
#define SWATH_PIXELS_MAX (UINT64_C(1) << 31)
#define SWATH_INDEX_MAX  (UINT64_C(1) << 40)

/* 1/pi written in decimal digits must not be refused for its last bit. */
#define ENERGY_SLACK (1.0 + 1e-12)

static void side_length(struct check *check, const char *key, uint32_t pixels)
{
    if (pixels < 1 || pixels > SIDE_MAX)
        check_failure(check, key, "must be 1...%lu pixels, not %lu", (unsigned long)SIDE_MAX,
                      (unsigned long)pixels);
}

static void swath_size(struct check *check, uint32_t rows, uint32_t columns)
{
    side_length(check, "rows", rows);
    side_length(check, "columns", columns);
    if ((uint64_t)rows * columns > SWATH_PIXELS_MAX)
        check_relation(check, "rows", "columns",
                       "times columns must be at most 2^31 pixels, not %lu x %lu",
                       (unsigned long)rows, (unsigned long)columns);
}

/* Turns of the array: the beam stays on the imaged side. */
static void check_array(struct check *check, const sonject_sonar_params *sonar)
{
    check_choice(check, "kind", sonar->kind, SONJECT_SONAR_REAL + 1);
    check_length(check, "array.length", sonar->array_length_m);
    if (sonar->kind == SONJECT_SONAR_REAL)
        check_positive_length(check, "array.length", sonar->array_length_m);
    check_length(check, "array.height", sonar->array_height_m);
    check_within(check, "array.heading", sonar->array_heading_rad, -0.25 * PI, 0.25 * PI, " rad");
    check_within(check, "array.pitch", sonar->array_pitch_rad, -0.25 * PI, 0.25 * PI, " rad");
    check_within(check, "array.depression", sonar->array_depression_rad, 0.0, 0.5 * PI, " rad");
}

sonject_status check_sonar(const sonject_sonar_params *sonar, struct report *report,
                           struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_within(&check, "frequency", sonar->centre_frequency_hz, FREQUENCY_MIN_HZ,
                 FREQUENCY_MAX_HZ, " Hz");
    check_within(&check, "bandwidth", sonar->bandwidth_hz, FREQUENCY_MIN_HZ, FREQUENCY_MAX_HZ,
                 " Hz");
    if (sonar->bandwidth_hz >= 2.0 * sonar->centre_frequency_hz)
        check_relation(&check, "bandwidth", "frequency",
                       "must be below twice the frequency, %g Hz, not %g Hz",
                       2.0 * sonar->centre_frequency_hz, sonar->bandwidth_hz);
    check_positive_length(&check, "altitude", sonar->altitude_m);
    if (sonar->along_track_resolution_m != 0.0)
        check_positive_length(&check, "resolution", sonar->along_track_resolution_m);
    check_length(&check, "transducer", sonar->transducer_side_m);
    check_choice(&check, "response", sonar->response_window, SONJECT_WINDOW_TAYLOR + 1);
    check_finite(&check, "response.taylor.sidelobes", sonar->taylor_sidelobe_db);
    if (sonar->response_window == SONJECT_WINDOW_TAYLOR) {
        check_within(&check, "response.taylor.sidelobes", sonar->taylor_sidelobe_db, 1.0, 120.0,
                     " dB");
        check_within(&check, "response.taylor.terms", sonar->taylor_terms, 2.0, 16.0, "");
    }
    check_finite(&check, "aperture", sonar->aperture_rad);
    if (sonar->aperture_rad > 0.0)
        check_within(&check, "aperture", sonar->aperture_rad, 0.0, 0.5 * PI, " rad");
    check_array(&check, sonar);
    return check.status;
}

sonject_status check_medium(const sonject_medium_params *medium, struct report *report,
                            struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_within(&check, "sound_speed", medium->sound_speed_mps, 100.0, 10000.0, " m/s");
    if (medium->reference_sound_speed_mps != 0.0)
        check_within(&check, "reference_sound_speed", medium->reference_sound_speed_mps, 100.0,
                     10000.0, " m/s");
    check_within(&check, "absorption", medium->absorption_db_per_m, 0.0, 100.0, " dB/m");
    return check.status;
}

sonject_status check_seabed(const sonject_seabed_params *seabed, struct report *report,
                            struct check_listener *listener)
{
    static const struct material_keys forward_keys = MATERIAL_KEYS("forward.");
    struct check check = {report, listener, SONJECT_OK};
    check_choice(&check, "map", seabed->map, SONJECT_MAP_COHERENT + 1);
    if (!(seabed->lambert > 0.0 && PI * seabed->lambert <= ENERGY_SLACK))
        check_failure(
            &check, "lambert",
            "must be above 0 and at most 1/pi (-4.97 dB), or the seabed returns more than it "
            "receives; it is %g",
            seabed->lambert);
    check_positive_length(&check, "level_radius", seabed->level_radius_m);
    check_positive_length(&check, "despeckle_radius", seabed->despeckle_radius_m);
    check_choice(&check, "forward.rule", seabed->forward_rule, SONJECT_FORWARD_MAP + 1);
    check_material(&check, &forward_keys, &seabed->forward, seabed->lambert);
    return check.status;
}

sonject_status check_surface(const sonject_surface_params *surface, struct report *report,
                             struct check_listener *listener)
{
    static const struct material_keys keys = MATERIAL_KEYS("");
    struct check check = {report, listener, SONJECT_OK};
    check_length(&check, "depth", surface->water_depth_m);
    const sonject_material_params material = surface_material(surface);
    check_material(&check, &keys, &material, NAN);
    return check.status;
}

sonject_status check_geometry(const sonject_geometry_params *geometry, struct report *report,
                              struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_choice(&check, "side", geometry->side, SONJECT_SIDE_STARBOARD + 1);
    check_positive_length(&check, "row_spacing", geometry->row_spacing_m);
    check_positive_length(&check, "column_spacing", geometry->column_spacing_m);
    if (isnan(geometry->first_slant_range_m))
        check_failure(&check, "first_slant_range", "must be set: the slant range of column 0 in m");
    check_length(&check, "first_slant_range", geometry->first_slant_range_m);
    check_coordinate(&check, "first_along_track", geometry->first_along_track_m);
    return check.status;
}

sonject_status check_transfer(const sonject_transfer_params *transfer, struct report *report,
                              struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_choice(&check, "kind", transfer->kind, SONJECT_TRANSFER_SCHLICK + 1);
    check_finite(&check, "parameter", transfer->parameter);
    check_finite(&check, "offset", transfer->offset);
    check_within(&check, "full_scale", transfer->full_scale, 0.0, 1e30, "");
    if (transfer->kind == SONJECT_TRANSFER_DECIBEL) {
        check_within(&check, "parameter", transfer->parameter, 1e-6, 1e3, " dB per unit");
        check_within(&check, "offset", transfer->offset, -1e3, 1e3, " dB");
    } else if (transfer->kind == SONJECT_TRANSFER_GAMMA) {
        check_within(&check, "parameter", transfer->parameter, 0.01, 100.0, " (an exponent)");
    } else if (transfer->kind == SONJECT_TRANSFER_SCHLICK) {
        check_within(&check, "parameter", transfer->parameter, 1.0, 1e6, "");
    }
    return check.status;
}

sonject_status check_injection(const sonject_injection_params *injection, struct report *report,
                               struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_choice(&check, "mode", injection->mode, SONJECT_MODE_RESYNTHESISE + 1);
    check_choice(&check, "columns", injection->column_rule, SONJECT_COLUMNS_PAPER + 1);
    check_choice(&check, "noise_floor", injection->estimate_noise, 2);
    check_finite(&check, "noise_floor", injection->noise_floor_db);
    if (!injection->estimate_noise && !(injection->noise_floor_db < 0.0))
        check_failure(&check, "noise_floor",
                      "must be below 0 dB, the seabed's own level, not %g dB",
                      injection->noise_floor_db);
    check_within(&check, "influence", injection->influence_db, -200.0, 0.0, " dB");
    check_within(&check, "rays", injection->ray_scale, 1.0 / 64.0, 4096.0,
                 " times the usual number");
    check_within(&check, "interactions", injection->interactions, 1.0, SCENE_INTERACTIONS_MAX,
                 " surfaces");
    check_choice(&check, "estimator", injection->estimator, SONJECT_ESTIMATOR_BRUTE_FORCE + 1);
    check_choice(&check, "order_energies", injection->order_energies, 2);
    check_choice(&check, "match.response", injection->match_response, SONJECT_MATCH_IMAGE + 1);
    check_choice(&check, "match.saturation", injection->match_saturation, SONJECT_MATCH_IMAGE + 1);
    check_finite(&check, "match.looks", injection->match_looks);
    if (injection->match_looks != 0.0)
        check_within(&check, "match.looks", injection->match_looks, 1.0, 64.0, " looks");
    if (injection->estimator == SONJECT_ESTIMATOR_BRUTE_FORCE &&
        injection->mode != SONJECT_MODE_RESYNTHESISE)
        check_relation(&check, "estimator", "mode",
                       "brute_force traces the whole patch and needs mode: resynthesise");
    return check.status;
}

sonject_status check_patch(const sonject_patch_params *patch, struct report *report,
                           struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    const struct {
        const char *key;
        uint64_t value;
    } values[] = {{"row", patch->first_row},
                  {"column", patch->first_column},
                  {"rows", patch->rows},
                  {"columns", patch->columns}};
    if (!patch->first_row && !patch->first_column && !patch->rows && !patch->columns)
        return SONJECT_OK;
    for (int i = 0; i < 4; i++)
        if (values[i].value > SWATH_INDEX_MAX)
            check_failure(&check, values[i].key, "must be at most 2^40 pixels");
    for (int i = 2; i < 4; i++)
        if (values[i].value == 0)
            check_failure(&check, values[i].key, "must be at least 1 pixel");
    return check.status;
}

sonject_status check_uniform(uint32_t rows, uint32_t columns, struct report *report,
                             struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    swath_size(&check, rows, columns);
    return check.status;
}

sonject_status check_synthetic(const sonject_synthetic_params *synthetic, struct report *report,
                               struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    swath_size(&check, synthetic->rows, synthetic->columns);
    check_choice(&check, "complex", synthetic->complex_pixels, 2);
    if (!(synthetic->speckle_shape >= 0.01))
        check_failure(&check, "speckle_shape",
                      "must be at least 0.01, or inf for Rayleigh amplitudes, not %g",
                      synthetic->speckle_shape);
    check_positive_length(&check, "texture_length", synthetic->texture_length_m);
    check_positive_length(&check, "ripple_wavelength", synthetic->ripple_wavelength_m);
    check_within(&check, "ripple_contrast", synthetic->ripple_contrast, 0.0, 1.0, "");
    check_finite(&check, "ripple_heading", synthetic->ripple_heading_rad);
    check_within(&check, "patch_contrast", synthetic->patch_contrast_db, 0.0, 100.0, " dB");
    check_positive_length(&check, "patch_length", synthetic->patch_length_m);
    check_within(&check, "mean_amplitude", synthetic->mean_amplitude, 1e-6, 1e6, "");
    return check.status;
}

static void check_label(struct check *check, const char *key, const char *text)
{
    if (!memchr(text, 0, SONJECT_NAME_CAPACITY))
        check_failure(check, key, "must be at most %d bytes long", SONJECT_NAME_CAPACITY - 1);
    else if (!text_is_printable(text))
        check_failure(check, key, "must be UTF-8 text without control characters");
}

static void check_burial(struct check *check, const sonject_object_params *object)
{
    check_choice(check, "burial", object->burial_kind, SONJECT_BURIAL_PROUD + 1);
    check_coordinate(check, "burial", object->burial_m);
    check_within(check, "burial.fraction", object->burial_fraction, 0.0, 1.0, "");
    check_length(check, "burial.proud", object->proud_height_m);
}

static void check_position(struct check *check, const sonject_object_params *object)
{
    check_choice(check, "position", object->position_kind, SONJECT_POSITION_PIXELS + 1);
    if (object->position_kind == SONJECT_POSITION_PIXELS) {
        const double limit = (double)SWATH_INDEX_MAX;
        check_within(check, "position.row", object->position_along, -1.0, limit, "");
        check_within(check, "position.column", object->position_range, -1.0, limit, "");
    } else if (object->position_kind == SONJECT_POSITION_METRES) {
        check_coordinate(check, "position.along_track", object->position_along);
        check_length(check, "position.slant_range", object->position_range);
    }
    check_finite(check, "position", object->position_along);
    check_finite(check, "position", object->position_range);
}

sonject_status check_part(const sonject_part_params *part, struct report *report,
                          struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_coordinate(&check, "at.along", part->along_m);
    check_coordinate(&check, "at.across", part->across_m);
    check_coordinate(&check, "at.up", part->up_m);
    check_finite(&check, "heading", part->heading_rad);
    check_finite(&check, "pitch", part->pitch_rad);
    check_finite(&check, "roll", part->roll_rad);
    return check.status;
}

sonject_status check_object(const sonject_object_params *object, struct report *report,
                            struct check_listener *listener)
{
    static const struct material_keys material_keys = MATERIAL_KEYS("material.");
    struct check check = {report, listener, SONJECT_OK};
    check_label(&check, "name", object->name);
    check_label(&check, "class", object->class_name);
    check_shape(&check, object);
    check_position(&check, object);
    check_finite(&check, "heading", object->heading_rad);
    check_finite(&check, "pitch", object->pitch_rad);
    check_finite(&check, "roll", object->roll_rad);
    check_burial(&check, object);
    check_choice(&check, "level", object->level_kind, SONJECT_LEVEL_OVER_SEABED + 1);
    check_finite(&check, "level", object->level_db);
    check_within(&check, "level", object->level_db, -200.0, 200.0, " dB");
    check_material(&check, &material_keys, &object->material, NAN);
    return check.status;
}
