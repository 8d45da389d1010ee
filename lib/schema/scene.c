/* The keys of the whole file, of its image and of the injection. */
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "scene/element_plan.h"
#include "schema/keys.h"
#include "schema/tables.h"
#include "swath/geometry_notes.h"
#include "swath/recording.h"

#define SIDE_MAX        (UINT32_C(1) << 20)
#define SWATH_INDEX_MAX (UINT64_C(1) << 40)
#define LENGTH_MAX_M    1e6
#define PINGS_BYTES_MAX ((size_t)64 << 20)

/* ---- The image. */

static void relate_sides(struct check *check, uint32_t rows, uint32_t columns)
{
    if ((uint64_t)rows * columns > SWATH_PIXELS_MAX)
        check_relation(check, "rows", "columns",
                       "times columns must be at most 2^31 pixels, not %lu x %lu",
                       (unsigned long)rows, (unsigned long)columns);
}

#define STRUCTURE struct scene
static void relate_uniform(struct check *check, const void *structure)
{
    const struct scene *scene = structure;
    relate_sides(check, scene->uniform_rows, scene->uniform_columns);
}

static const struct field uniform_fields[] = {
    {"rows", "number of rows (track positions)", COUNT32(uniform_rows, 1, SIDE_MAX),
     .per = " pixels", REQUIRED},
    {"columns", "number of columns (range cells)", COUNT32(uniform_columns, 1, SIDE_MAX),
     .per = " pixels", REQUIRED},
};
static const struct section uniform_section = {ROWS(uniform_fields), .relations = relate_uniform};
#undef STRUCTURE

#define STRUCTURE sonject_synthetic_params
static void relate_synthetic(struct check *check, const void *structure)
{
    const sonject_synthetic_params *synthetic = structure;
    relate_sides(check, synthetic->rows, synthetic->columns);
}

/* The mean level leaves 14 dB to full scale for the targets' highlights. */
static const struct field synthetic_fields[] = {
    {"rows", "number of rows (track positions)", COUNT32(rows, 1, SIDE_MAX), .per = " pixels",
     .preset = 400, REQUIRED},
    {"columns", "number of columns (range cells)", COUNT32(columns, 1, SIDE_MAX), .per = " pixels",
     .preset = 400, REQUIRED},
    {"seed", "seed of the random seabed", COUNT64(seed, 0, 0), .preset = 1},
    {"complex", "complex pixels instead of amplitudes", FLAG(complex_pixels)},
    {"speckle_shape", "shape of the speckle's K distribution; inf gives Rayleigh amplitudes",
     QUANTITY(speckle_shape, NUMBER), WITHIN(0.01, HUGE_VAL), .preset = 10.0,
     .range = "at least 0.01, or inf for Rayleigh amplitudes"},
    {"texture_length", "correlation length of the speckle's texture",
     QUANTITY(texture_length_m, LENGTH), POSITIVE, .preset = 0.1},
    {"ripple_wavelength", "wavelength of the sand ripples, from crest to crest",
     QUANTITY(ripple_wavelength_m, LENGTH), POSITIVE, .preset = 0.6},
    {"ripple_contrast", "contrast of the sand ripples, 0 (none) to 1",
     QUANTITY(ripple_contrast, NUMBER), WITHIN(0.0, 1.0), .preset = 0.6},
    {"ripple_heading", "direction across the ripples' crests, from along-track towards range",
     QUANTITY(ripple_heading_rad, ANGLE), .preset = 1.25},
    {"patch_contrast", "level step between sediment patches", QUANTITY(patch_contrast_db, DECIBEL),
     WITHIN(0.0, 100.0), .preset = 4.0},
    {"patch_length", "typical size of a sediment patch", QUANTITY(patch_length_m, LENGTH), POSITIVE,
     .preset = 5.0},
    {"mean_amplitude", "rms amplitude of the darker sediment", QUANTITY(mean_amplitude, NUMBER),
     WITHIN(1e-6, 1e6), .preset = 0.1},
};
static const struct section synthetic_section = {
    ROWS(synthetic_fields), .relations = relate_synthetic, .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

/* The speed and ping rate of a sonar, which give the row spacing. */
struct ping_spacing {
    double speed_mps;
    double ping_rate_hz;
};

#define STRUCTURE struct ping_spacing
static const struct field ping_spacing_fields[] = {
    {"speed", "speed of the sonar over the ground", QUANTITY(speed_mps, SPEED),
     WITHIN(0.0, HUGE_VAL), .bounds = ABOVE_LEAST, REQUIRED},
    {"ping_rate", "pings per second; each ping is one row", QUANTITY(ping_rate_hz, FREQUENCY),
     WITHIN(0.0, HUGE_VAL), .bounds = ABOVE_LEAST, REQUIRED},
};
static const struct section ping_spacing_section = {ROWS(ping_spacing_fields)};
#undef STRUCTURE

static sonject_status read_row_spacing(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    sonject_geometry_params *geometry = structure;
    struct ping_spacing pings = {0.0, 0.0};
    if (node->kind != TREE_SECTION)
        return read_quantity(reader, node, QUANTITY_LENGTH, &geometry->row_spacing_m);
    CHECK(read_section(reader, &ping_spacing_section, node, &pings));
    geometry->row_spacing_m = pings.speed_mps / pings.ping_rate_hz;
    return SONJECT_OK;
}

static sonject_status read_first_range(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    sonject_geometry_params *geometry = structure;
    reader->takes_first_range = is_word(node, "from_file");
    if (!reader->takes_first_range)
        return read_quantity(reader, node, QUANTITY_LENGTH, &geometry->first_slant_range_m);
    geometry->first_slant_range_m = 0.0; /* until the table of pings is read */
    return SONJECT_OK;
}

static sonject_status finish_geometry(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    sonject_geometry_params *geometry = structure;
    if (is_given(node, "nadir_column") && geometry->nadir_column == 0.0)
        return refuse_key(reader, node, "nadir_column", "must be above 0, not 0");
    if (is_given(node, "first_slant_range"))
        return SONJECT_OK;
    if (!is_given(node, "nadir_column"))
        return refuse_key(reader, node, "first_slant_range",
                          "missing; add it (slant range of column 0 of the whole swath), or "
                          "nadir_column");
    geometry->first_slant_range_m = 0.0;
    return SONJECT_OK;
}

/* first_slant_range has no default, because none is right for most images. */
#define STRUCTURE sonject_geometry_params
static const struct field geometry_fields[] = {
    {"row_spacing", "distance between track positions, or the speed and ping_rate that make it",
     QUANTITY(row_spacing_m, LENGTH), POSITIVE, .preset = 0.025, .read = read_row_spacing,
     .section = &ping_spacing_section, .unit = "m, km, cm, mm, or {speed, ping_rate}", REQUIRED},
    {"column_spacing", "distance between range cells, in slant range",
     QUANTITY(column_spacing_m, LENGTH), POSITIVE, .preset = 0.025, REQUIRED},
    {"first_slant_range",
     "slant range of the swath's column 0, or of nadir_column (by default 0 there); from_file "
     "takes it from input.pings",
     QUANTITY(first_slant_range_m, LENGTH), FROM_ZERO, .preset = NAN, .read = read_first_range,
     .unit = "m, km, cm, mm, or from_file"},
    {"nadir_column",
     "column where range begins, if the image has two sides or range grows to the left; port lies "
     "left of it, starboard right",
     QUANTITY(nadir_column, NUMBER), WITHIN(0.0, INDEX_MAX), .per = " columns", NONE_IF_ZERO},
    {"first_along_track", "track position of row 0", QUANTITY(first_along_track_m, LENGTH),
     COORDINATE},
    {"side", "side of the track that the image shows",
     WORD(side) = {[SONJECT_SIDE_PORT] = "port", [SONJECT_SIDE_STARBOARD] = "starboard"}},
};
static const struct section geometry_section = {ROWS(geometry_fields), .finish = finish_geometry,
                                                .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

static sonject_status read_geometry(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    struct scene *scene = structure;
    reader->takes_geometry = is_word(node, "from_file");
    return reader->takes_geometry ? SONJECT_OK
                                  : read_section(reader, &geometry_section, node, &scene->geometry);
}

#define STRUCTURE sonject_transfer_params
static void relate_transfer(struct check *check, const sonject_transfer_params *transfer)
{
    if (transfer->kind == SONJECT_TRANSFER_DECIBEL) {
        check_within(check, "parameter", transfer->parameter, 1e-6, 1e3, " dB per unit");
        check_within(check, "offset", transfer->offset, -1e3, 1e3, " dB");
    } else if (transfer->kind == SONJECT_TRANSFER_GAMMA) {
        check_within(check, "parameter", transfer->parameter, 0.01, 100.0, " (an exponent)");
    } else if (transfer->kind == SONJECT_TRANSFER_SCHLICK) {
        check_within(check, "parameter", transfer->parameter, 1.0, 1e6, "");
    }
}

static sonject_status finish_transfer(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    const sonject_transfer_params *transfer = structure;
    const bool has_parameter = transfer->kind >= SONJECT_TRANSFER_DECIBEL;
    struct check check = check_at(reader, node);
    if (has_parameter && !is_given(node, "parameter"))
        refuse_key(reader, node, "parameter", "missing; this kind of transfer needs it");
    if (!has_parameter && is_given(node, "parameter"))
        refuse_relation(reader, node, "parameter", "kind",
                        "this kind of transfer has none; remove it");
    if (transfer->kind != SONJECT_TRANSFER_DECIBEL && is_given(node, "offset"))
        refuse_relation(reader, node, "offset", "kind", "only the decibel kind has one; remove it");
    relate_transfer(&check, transfer);
    return check.status;
}

static const struct field transfer_fields[] = {
    {"kind", "kind of function that made the stored numbers from amplitudes",
     WORD(kind) = {[SONJECT_TRANSFER_AMPLITUDE] = "amplitude",
                   [SONJECT_TRANSFER_INTENSITY] = "intensity",
                   [SONJECT_TRANSFER_DECIBEL] = "decibel",
                   [SONJECT_TRANSFER_GAMMA] = "gamma",
                   [SONJECT_TRANSFER_SCHLICK] = "schlick"},
     REQUIRED},
    {"parameter",
     "dB per stored unit (decibel, 1e-6 to 1000), exponent (gamma, 0.01 to 100) or b (schlick, 1 "
     "to 1e6)",
     QUANTITY(parameter, NUMBER), .preset = 1.0},
    {"offset", "level of a stored 0 (kind decibel: -1000 to 1000 dB)", QUANTITY(offset, DECIBEL)},
    {"full_scale", "largest value that the recorder stores; by default the pixel type's",
     QUANTITY(full_scale, NUMBER), WITHIN(0.0, 1e30), NONE_IF_ZERO},
};
static const struct section transfer_section = {ROWS(transfer_fields), .finish = finish_transfer,
                                                .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

const char *transfer_word(uint32_t kind)
{
    return transfer_fields[0].words[kind];
}

static sonject_status read_channel(struct reader *reader, const struct tree_node *node,
                                   void *member)
{
    int32_t *channel = member;
    char excerpt[40];
    uint64_t number = 0;
    const char *text = node->kind == TREE_TEXT && node->text ? node->text : "";
    if (reader->has_no_channels)
        return SONJECT_OK;
    if (is_word(node, "port"))
        *channel = SONJECT_CHANNEL_PORT;
    else if (is_word(node, "starboard"))
        *channel = SONJECT_CHANNEL_STARBOARD;
    else if (text_to_count(text, &number) && number <= CHANNEL_NUMBER_MAX)
        *channel = (int32_t)number;
    else
        return refuse_value(reader, node,
                            "'%s' is neither port nor starboard nor a channel's "
                            "number, 0 to %d",
                            text_excerpt(excerpt, sizeof excerpt, text), CHANNEL_NUMBER_MAX);
    return SONJECT_OK;
}

enum {
    PING_ROW,
    PING_ALTITUDE = 2,
    PING_FIRST_RANGE
};

static sonject_status keep_pings(const struct number_table *table, struct report *report,
                                 struct ping_table *pings)
{
    const size_t bytes = table->count * sizeof(double);
    ping_table_clear(pings);
    pings->rows = allocate_array(table->count, 3 * sizeof *pings->rows);
    CHECK_MEMORY(report, pings->rows, "a table of pings");
    pings->altitudes_m = pings->rows + table->count;
    pings->count = table->count;
    memcpy(pings->rows, table->values[PING_ROW], bytes);
    memcpy(pings->altitudes_m, table->values[PING_ALTITUDE], bytes);
    if (!table->values[PING_FIRST_RANGE])
        return SONJECT_OK;
    pings->first_ranges_m = pings->altitudes_m + table->count;
    memcpy(pings->first_ranges_m, table->values[PING_FIRST_RANGE], bytes);
    return SONJECT_OK;
}

static sonject_status read_pings(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    static const struct table_format format = {
        .names = {"row", NULL, "altitude_m", "first_slant_range_m"},
        .samples_max = PING_ROWS_MAX,
        .bytes_max = PINGS_BYTES_MAX,
        .samples_min = 2,
        .most = {(double)SWATH_INDEX_MAX, 0.0, LENGTH_MAX_M, LENGTH_MAX_M},
        .rises = true};
    struct scene *scene = structure;
    struct number_table table;
    sonject_status status = SONJECT_OK;
    CHECK(read_number_table(reader, node, &format, &table));
    const double *ranges = table.values[PING_FIRST_RANGE];
    for (size_t i = 0; status == SONJECT_OK && i < table.count; i++)
        if (!(table.values[PING_ALTITUDE][i] > 0.0))
            status = number_table_refuse(&table, reader->report, i, PING_ALTITUDE,
                                         "must be above 0; leave rows out that have none");
        else if (ranges && !(ranges[i] >= 0.0))
            status = number_table_refuse(&table, reader->report, i, PING_FIRST_RANGE,
                                         "must not be below 0");
    THEN(status, keep_pings(&table, reader->report, &scene->pings));
    number_table_clear(&table);
    return status;
}

/* Checks that the key has a value. take_calibration has read the file already. */
static sonject_status read_calibration(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    (void)structure;
    return read_text(reader, node) ? SONJECT_OK : SONJECT_ERROR_INPUT;
}

static sonject_status finish_input(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    const struct scene *scene = structure;
    const char *file_keys = "channel array complex calibration transfer pings";
    char key[64];
    while (scene->input_kind != SONJECT_INPUT_FILE && next_key(&file_keys, key))
        if (is_given(node, key) && count_given(node, "path uniform synthetic") == 1)
            refuse_key(reader, node, key, "belongs to an image file (path), not to %s; remove it",
                       is_given(node, "uniform") ? "uniform" : "synthetic");
    return SONJECT_OK;
}

#define STRUCTURE struct scene
static const struct field input_fields[] = {
    {"kind", "input's kind", HIDDEN, WORD(input_kind) = {"memory", "file", "uniform", "synthetic"}},
    {"path", "image file", .kind = FIELD_PATH, MEMBER(input_path),
     SETS(input_kind, SONJECT_INPUT_FILE)},
    {"channel", "channel of an XTF or JSF file: port, starboard, or its number there",
     .kind = FIELD_SPECIAL, MEMBER(channel), .read = read_channel, .unit = "word or whole number"},
    {"array", "name of the array, in an HDF5 or MATLAB file that has several", TEXT(array)},
    {"complex", "true: the file's two channels are real and imaginary part",
     FLAG(input_is_complex)},
    {"uniform", "a swath of unit reflectivity", SAME(uniform_section),
     SETS(input_kind, SONJECT_INPUT_UNIFORM)},
    {"synthetic", "a swath that sonject makes", PART(synthetic, synthetic_section),
     SETS(input_kind, SONJECT_INPUT_SYNTHETIC)},
    {"geometry",
     "where the pixels lie: row_spacing, column_spacing and first_slant_range, or from_file",
     PART(geometry, geometry_section), .read = read_geometry, REQUIRED},
    {"transfer", "meaning of the file's numbers", PART(transfer, transfer_section)},
    {"calibration",
     "file of sonject calibrate, whose keys count where the scene has none of its own; or auto: "
     "run "
     "and campaign make it",
     SPECIAL(read_calibration, "file name, or auto")},
    {"pings",
     "table with columns row, altitude_m, and first_slant_range_m, where the file lacks these; "
     "linear between its rows",
     SPECIAL(read_pings, "file name")},
};
const struct section input_section = {ROWS(input_fields), .choice = "path uniform synthetic",
                                      .finish = finish_input};
#undef STRUCTURE

#define STRUCTURE sonject_patch_params
static const struct field patch_fields[] = {
    {"row", "first row of the patch in the swath", COUNT64(first_row, 0, SWATH_INDEX_MAX)},
    {"column", "first column of the patch in the swath", COUNT64(first_column, 0, SWATH_INDEX_MAX)},
    {"rows", "number of rows (track positions)", COUNT64(rows, 1, SWATH_INDEX_MAX), REQUIRED},
    {"columns", "number of columns (range cells)", COUNT64(columns, 1, SWATH_INDEX_MAX), REQUIRED},
};
static const struct section patch_section = {ROWS(patch_fields), .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

/* ---- The injection. */

#define STRUCTURE sonject_injection_params
static sonject_status read_noise_floor(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    sonject_injection_params *injection = structure;
    injection->estimate_noise = is_word(node, "estimate");
    return injection->estimate_noise
               ? SONJECT_OK
               : read_quantity(reader, node, QUANTITY_DECIBEL, &injection->noise_floor_db);
}

static void relate_injection(struct check *check, const void *structure)
{
    const sonject_injection_params *injection = structure;
    if (injection->estimator == SONJECT_ESTIMATOR_BRUTE_FORCE &&
        injection->mode != SONJECT_MODE_RESYNTHESISE)
        check_relation(check, "estimator", "mode",
                       "brute_force traces the whole patch and needs mode: resynthesise");
    if (injection->accuracy > 0.0 && injection->ray_scale != 1.0)
        check_relation(check, "rays", "accuracy",
                       "accuracy decides the number of rays: take one of them away");
}

static const struct field match_fields[] = {
    {"response",
     "widths of the point response: the image's around the targets (with a Gaussian pulse and a "
     "synthetic aperture alone), or the sonar's",
     WORD(match_response) = {[SONJECT_MATCH_NOMINAL] = "nominal", [SONJECT_MATCH_IMAGE] = "image"},
     .preset = SONJECT_MATCH_IMAGE},
    {"looks", "looks averaged in a magnitude pixel: image, or 1 to 64",
     QUANTITY(match_looks, NUMBER), WITHIN(1.0, 64.0), .words = {"image"}, .word_values = {0.0},
     .per = " looks", .unit = "number, or image"},
    {"saturation", "amplitude that cuts highlights: the image's own, or the file's full scale",
     WORD(match_saturation) =
         {[SONJECT_MATCH_NOMINAL] = "full_scale", [SONJECT_MATCH_IMAGE] = "image"},
     .preset = SONJECT_MATCH_IMAGE},
};
static const struct section match_section = {ROWS(match_fields)};

static const struct field injection_fields[] = {
    {"mode", "keep the measured pixels around the target, or trace the whole patch",
     WORD(mode) =
         {[SONJECT_MODE_COMPOSITE] = "composite", [SONJECT_MODE_RESYNTHESISE] = "resynthesise"}},
    {"columns",
     "track position (column, in the paper) of echoes of several interactions: mean of first and "
     "last hit, or first hit",
     WORD(
         column_rule) = {[SONJECT_COLUMNS_FOCUSED] = "focused", [SONJECT_COLUMNS_PAPER] = "paper"}},
    {"noise_floor", "estimated or not", HIDDEN, FLAG(estimate_noise), .preset = 1},
    {"noise_floor", "noise relative to the mean seabed, or estimate",
     QUANTITY(noise_floor_db, DECIBEL), WITHIN(-HUGE_VAL, 0.0), .bounds = ABOVE_LEAST | BELOW_MOST,
     .range = "below 0 dB (the seabed's own level)", .preset = -25.0, .words = {"estimate"},
     .word_values = {-25.0}, .read = read_noise_floor, .unit = "dB, or estimate"},
    {"noise_floor_over",
     "seabed level that noise_floor refers to everywhere: of a decibel curve, or over full scale "
     "(of floats over 1); by default the level about each pixel",
     QUANTITY(noise_floor_over_db, DECIBEL), WITHIN(-200.0, 200.0), NONE_IF_NAN},
    {"influence", "smallest change, relative to the seabed, that makes a pixel the target's",
     QUANTITY(influence_db, DECIBEL), WITHIN(-200.0, 0.0), .preset = -40.0},
    {"rays", "factor on the number of rays", QUANTITY(ray_scale, NUMBER),
     WITHIN(1.0 / 64.0, RAY_SCALE_MAX), .per = " times the usual number", .preset = 1.0},
    {"accuracy",
     "relative standard error of the energies that targets change; sets the number of rays in "
     "place of rays",
     QUANTITY(accuracy, FRACTION), WITHIN(0.001, 1.0), NONE_IF_ZERO},
    {"seed", "seed of all random numbers of the injection", COUNT64(seed, 0, 0), .preset = 1},
    {"interactions", "largest number of surfaces that a path may meet, 1 to 8",
     COUNT32(interactions, 1, SCENE_INTERACTIONS_MAX), .per = " surfaces", .preset = 1},
    {"estimator",
     "search for paths to the source: connect each hit to it, or wait for rays to hit it by chance",
     WORD(estimator) = {[SONJECT_ESTIMATOR_CONNECT] = "connect",
                        [SONJECT_ESTIMATOR_BRUTE_FORCE] = "brute_force"}},
    {"order_energies",
     "also keep the energy of each number of interactions; reflections at "
     "boundaries and between smooth faces do not count",
     FLAG(order_energies)},
    {"match", "properties that targets take from a measured magnitude image", SAME(match_section)},
};
const struct section injection_section = {ROWS(injection_fields), .relations = relate_injection,
                                          .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

/* ---- The whole file. */

sonject_status read_version(struct reader *reader, const struct tree_node *node, void *structure)
{
    (void)structure;
    return is_word(node, "1")
               ? SONJECT_OK
               : refuse_value(reader, node,
                              "must be 1, the version of the format that is read here");
}

/* Takes geometry and altitude from the input file, where the scene leaves them to the file. */
static void take_recording(struct reader *reader)
{
    struct report report = {.host = NULL};
    const char *key;
    struct scene *scene = reader->scene;
    scene->has_pings_range = reader->takes_first_range && scene->pings.first_ranges_m;
    scene->has_files_geometry =
        reader->takes_geometry || (reader->takes_first_range && !scene->has_pings_range);
    const struct recording_wish wish = {reader->takes_geometry, reader->altitude_by,
                                        reader->takes_first_range};
    if ((wish.geometry || wish.altitude_by != ALTITUDE_GIVEN || wish.first_range) &&
        are_valid(reader, "input patch") &&
        recording_describe(&report, &wish, scene, &key) != SONJECT_OK)
        refuse_key(reader, &reader->tree->root, key, "%s", report.message);
}

static sonject_status finish_scene(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    const struct scene *scene = structure;
    const sonject_sonar_params *sonar = &scene->sonar;
    const bool is_complex = scene->input_kind == SONJECT_INPUT_SYNTHETIC
                                ? scene->synthetic.complex_pixels
                                : scene->input_is_complex;
    take_recording(reader);
    if (scene->seabed.map == SONJECT_MAP_COHERENT && !is_complex &&
        scene->input_kind != SONJECT_INPUT_MEMORY)
        refuse_relation(reader, node, "seabed.map",
                        "input.complex input.synthetic input.uniform input.path",
                        "coherent needs complex pixels; set complex: true in input if they are");
    if (scene->surface.water_depth_m > 0.0 && scene->surface.water_depth_m <= sonar->altitude_m)
        refuse_relation(reader, node, "surface.depth", "sonar.altitude",
                        "must be above the sonar's altitude of %g m, not %g m", sonar->altitude_m,
                        scene->surface.water_depth_m);
    if (scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE &&
        !(sonar->transducer_side_m > 0.0))
        refuse_relation(reader, node, "injection.estimator", "sonar.transducer",
                        "brute_force needs a source that rays can hit; set transducer in sonar");
    const double least_rate =
        element_least_rate(&scene->elements, sonar->centre_frequency_hz, sonar->bandwidth_hz);
    if (scene->elements.sampling_rate_hz != 0.0 && scene->elements.sampling_rate_hz < least_rate)
        refuse_relation(reader, node, "elements.sampling_rate",
                        "elements.form sonar.frequency sonar.bandwidth",
                        "must be at least %g Hz for the sonar's band, not %g Hz", least_rate,
                        scene->elements.sampling_rate_hz);
    return SONJECT_OK;
}

/* Keys are read in this order, not the file's, because the water needs the sonar's frequency and
 * the surface's depth. */
#define STRUCTURE struct scene
static const struct field scene_fields[] = {
    {"sonject", "version of the format, 1", SPECIAL(read_version, "whole number"), REQUIRED},
    {"band", "name of the band, one of bands, that this scene is", SPECIAL(NULL, "a band's name")},
    {"bands",
     "sections by name, one per sonar, with the keys in which it differs from the rest of the file",
     SPECIAL(NULL, "sections of the scene's keys")},
    {"input", "where the image comes from: path, uniform or synthetic, and geometry",
     SAME(input_section), REQUIRED},
    {"patch", "part of the swath that is worked on; by default all of it",
     PART(patch, patch_section)},
    {"sonar", "the sonar: frequency, bandwidth and altitude", PART(sonar, sonar_section), REQUIRED},
    {"seabed", "the seabed", PART(seabed, seabed_section)},
    {"relief", "the file's heights", HIDDEN, PART(relief.grid, relief_grid_section)},
    {"surface", "the sea surface; by default none is heard", PART(surface, surface_section)},
    {"medium", "the water", PART(medium, medium_section)},
    {"injection", "how targets are put into the image", PART(injection, injection_section)},
    {"elements", "the array whose time series `sonject elements` writes",
     PART(elements, elements_section)},
    {"objects", "list of the targets", .kind = FIELD_SPECIAL, .read = read_objects,
     .section = &object_section, .is_list = true},
};
const struct section scene_section = {ROWS(scene_fields), .finish = finish_scene};
#undef STRUCTURE

void scene_init(struct scene *scene)
{
    memset(scene, 0, sizeof *scene);
    section_defaults(&scene_section, scene, scene);
    scene->channel = SONJECT_CHANNEL_ONLY;
}
