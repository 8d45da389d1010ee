/* The keys of the sonar: its array, pulse, measured response and motion; and the keys of the array
 * whose hydrophones are computed one by one. */
#include <stdlib.h>

#include "scene/point_response.h"
#include "schema/keys.h"
#include "schema/tables.h"

#define FREQUENCY_MIN_HZ 1.0
#define FREQUENCY_MAX_HZ 1e9
#define TABLE_BYTES_MAX  (16 * 1024 * 1024)

/* ---- Tables of samples: text files with named columns. */

enum {
    POSITION,
    TIME,
    REAL_PART,
    IMAGINARY_PART
};

sonject_status read_number_table(struct reader *reader, const struct tree_node *node,
                                 const struct table_format *format, struct number_table *table)
{
    char *path = NULL;
    CHECK(read_existing_path(reader, node, &path));
    const sonject_status status =
        number_table_read(reader->report, path, find_array(reader, path), format, table);
    free(path);
    return status;
}

/* Reads a response along the track (time_s NULL), or in range or time. */
static sonject_status read_response_file(struct reader *reader, const struct tree_node *node,
                                         const char *position_m, const char *time_s,
                                         struct response_table *response)
{
    const struct table_format format = {.names = {position_m, time_s, "real", "imaginary"},
                                        .samples_max = RESPONSE_SAMPLES_MAX,
                                        .bytes_max = TABLE_BYTES_MAX,
                                        .samples_min = 4,
                                        .most = {RESPONSE_POSITION_MAX, RESPONSE_POSITION_MAX,
                                                 RESPONSE_VALUE_MAX, RESPONSE_VALUE_MAX},
                                        .rises = true};
    struct number_table table;
    const char *what = NULL;
    double largest = 0.0;
    CHECK(read_number_table(reader, node, &format, &table));
    const int position = table.values[TIME] ? TIME : POSITION;
    const double *positions = table.values[position];
    for (int part = REAL_PART; part <= IMAGINARY_PART; part++)
        for (size_t i = 0; table.values[part] && i < table.count; i++)
            largest = fmax(largest, fabs(table.values[part][i]));
    if (!(largest > 1.0 / RESPONSE_VALUE_MAX))
        what = "must have a sample whose value is not 0";
    else if (!(positions[0] < 0.0 && positions[table.count - 1] > 0.0))
        what = "must reach from below position 0, the target's, to above it";
    const sonject_status status =
        what ? number_table_refuse(&table, reader->report, table.count, (size_t)position, what)
             : response_table_set(response, reader->report, positions, table.values[REAL_PART],
                                  table.values[IMAGINARY_PART], table.count, position == TIME);
    number_table_clear(&table);
    return status;
}

static sonject_status read_motion_file(struct reader *reader, const struct tree_node *node,
                                       const char *column, double most, struct motion_table *motion)
{
    const struct table_format format = {.names = {"along_track_m", NULL, column},
                                        .samples_max = MOTION_SAMPLES_MAX,
                                        .bytes_max = TABLE_BYTES_MAX,
                                        .samples_min = 2,
                                        .most = {SCALE_MAX_M, 0.0, most},
                                        .rises = true};
    struct number_table table;
    CHECK(read_number_table(reader, node, &format, &table));
    const sonject_status status =
        motion_table_set(motion, reader->report, table.values[0], table.values[2], table.count);
    number_table_clear(&table);
    return status;
}

/* ---- The pulse. */

static sonject_status read_pulse_file(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    const sonject_pulse_params *pulse = structure;
    return pulse->kind == SONJECT_PULSE_TABLE
               ? read_response_file(reader, node, "range_m", "time_s", &reader->scene->pulse_table)
               : SONJECT_OK;
}

static sonject_status finish_pulse(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    const sonject_pulse_params *pulse = structure;
    const bool is_table = pulse->kind == SONJECT_PULSE_TABLE;
    if (is_given(node, "window") && pulse->kind != SONJECT_PULSE_CHIRP)
        refuse_relation(reader, node, "window", "kind", "only a chirp has one; set kind: chirp");
    if (is_table != is_given(node, "file"))
        refuse_relation(reader, node, "file", "kind",
                        is_table ? "missing; the table is read from it"
                                 : "belongs to kind: table; remove it");
    return SONJECT_OK;
}

#define TAYLOR_FIELDS                                                                              \
    {"sidelobes",                                                                                  \
     "depth of the side lobes below the main lobe",                                                \
     QUANTITY(taylor_sidelobe_db, DECIBEL),                                                        \
     WITHIN(1.0, 120.0),                                                                           \
     .preset = 35.0,                                                                               \
     REQUIRED},                                                                                    \
    {                                                                                              \
        "terms", "side lobes of equal height", COUNT32(taylor_terms, 2, 16), .preset = 5, REQUIRED \
    }

#define STRUCTURE sonject_pulse_params
static const struct field pulse_taylor_fields[] = {
    TAYLOR_FIELDS,
};
static const struct section pulse_taylor_section = {ROWS(pulse_taylor_fields)};

static const struct field pulse_window_fields[] = {
    {"taylor", "sidelobes and terms of a Taylor window", SAME(pulse_taylor_section),
     SETS(window, SONJECT_PULSE_TAYLOR), REQUIRED},
};
static const struct section pulse_window_section = {ROWS(pulse_window_fields)};

#define PULSE_WORD(NUMBER, word) #word,
/* The kind is read first, because only a table has a file to read. */
static const struct field pulse_fields[] = {
    {"kind", "response of a point in range; a chirp is a compressed linear sweep",
     WORD(kind) = {PULSES(PULSE_WORD)}, REQUIRED},
    {"window", "chirp's spectral window: rectangular, hann or {taylor: {sidelobes: , terms: }}",
     WORD(window) = {[SONJECT_PULSE_RECTANGULAR] = "rectangular",
                     [SONJECT_PULSE_HANN] = "hann",
                     [SONJECT_PULSE_TAYLOR] = ""},
     .section = &pulse_window_section},
    {"file", "table with columns range_m (beyond the target) or time_s, real, and imaginary",
     SPECIAL(read_pulse_file, "file name")},
};
const struct section pulse_section = {ROWS(pulse_fields), .finish = finish_pulse,
                                      .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

/* ---- Residual motion. */

#define SINE_FIELDS                                                                                \
    {"wavelength",                                                                                 \
     "wavelength of the sine, along-track",                                                        \
     QUANTITY(wavelength_m, LENGTH),                                                               \
     WITHIN(SCALE_MIN_M, SCALE_MAX_M),                                                             \
     .preset = 1.0,                                                                                \
     REQUIRED},                                                                                    \
    {                                                                                              \
        "phase", "sine's phase at along-track 0", QUANTITY(phase_rad, ANGLE), WITHIN(-1e3, 1e3)    \
    }

#define STRUCTURE sonject_wave
static const struct field sway_fields[] = {
    {"amplitude", "amplitude of the sine of sway", QUANTITY(amplitude, LENGTH),
     WITHIN(-SWAY_MAX_M, SWAY_MAX_M), REQUIRED},
    SINE_FIELDS,
};
static const struct section sway_section = {ROWS(sway_fields)};

static const struct field yaw_sine_fields[] = {
    {"amplitude", "amplitude of the sine of yaw", QUANTITY(amplitude, ANGLE),
     WITHIN(-YAW_MAX_RAD, YAW_MAX_RAD), REQUIRED},
    SINE_FIELDS,
};
static const struct section yaw_sine_section = {ROWS(yaw_sine_fields)};
#undef STRUCTURE

static sonject_status read_sway_file(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    (void)structure;
    return read_motion_file(reader, node, "sway_m", SWAY_MAX_M, &reader->scene->motion.sway_table);
}

static sonject_status read_yaw_file(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    (void)structure;
    return read_motion_file(reader, node, "yaw_rad", YAW_MAX_RAD, &reader->scene->motion.yaw_table);
}

#define STRUCTURE sonject_motion_params
static const struct field random_fields[] = {
    {"rms", "rms of the sway", QUANTITY(random_rms_m, LENGTH), WITHIN(0.0, SWAY_MAX_M), REQUIRED},
    {"correlation", "along-track correlation length", QUANTITY(random_correlation_m, LENGTH),
     WITHIN(SCALE_MIN_M, SCALE_MAX_M), .preset = 1.0, REQUIRED},
    {"seed", "seed of the random sway", COUNT64(seed, 0, 0)},
};
static const struct section random_section = {ROWS(random_fields)};

static const struct field random_yaw_fields[] = {
    {"rms", "rms of the yaw", QUANTITY(yaw_random_rms_rad, ANGLE), WITHIN(0.0, YAW_MAX_RAD),
     REQUIRED},
    {"correlation", "along-track correlation length", QUANTITY(yaw_random_correlation_m, LENGTH),
     WITHIN(SCALE_MIN_M, SCALE_MAX_M), .preset = 1.0, REQUIRED},
    {"seed", "seed of the random yaw", COUNT64(yaw_seed, 0, 0)},
};
static const struct section random_yaw_section = {ROWS(random_yaw_fields)};

static const struct field yaw_fields[] = {
    {"advance", "distance from ping to ping, which a ping's phase centres fill: half the array",
     QUANTITY(yaw_advance_m, LENGTH), WITHIN(SCALE_MIN_M, SWAY_MAX_M), REQUIRED},
    {"bias", "yaw of all pings; positive turns the bow towards the imaged side",
     QUANTITY(yaw_bias_rad, ANGLE), WITHIN(-YAW_MAX_RAD, YAW_MAX_RAD)},
    {"sines", "list of sines of yaw", ENTRIES(yaws, yaw_count, "sine", yaw_sine_section)},
    {"random", "random yaw with a Gaussian autocorrelation", SAME(random_yaw_section)},
    {"file", "table with columns along_track_m and yaw_rad", SPECIAL(read_yaw_file, "file name")},
};
static const struct section yaw_section = {ROWS(yaw_fields)};

static const struct field motion_fields[] = {
    {"sway", "list of sines of sway, across track",
     ENTRIES(sways, sway_count, "sine", sway_section)},
    {"random", "random sway with a Gaussian autocorrelation", SAME(random_section)},
    {"file", "table with columns along_track_m and sway_m", SPECIAL(read_sway_file, "file name")},
    {"yaw", "yaw of an array of hydrophones, which the processor does not know", SAME(yaw_section)},
};
static const struct section motion_section = {ROWS(motion_fields), .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

/* ---- The sonar. */

static sonject_status read_cross_range(struct reader *reader, const struct tree_node *node,
                                       void *structure)
{
    (void)structure;
    return read_response_file(reader, node, "along_track_m", NULL,
                              &reader->scene->cross_range_table);
}

static sonject_status read_altitude(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    sonject_sonar_params *sonar = structure;
    reader->altitude_by = is_word(node, "from_file")      ? ALTITUDE_RECORDED
                          : is_word(node, "first_return") ? ALTITUDE_OF_RETURNS
                                                          : ALTITUDE_GIVEN;
    return reader->altitude_by != ALTITUDE_GIVEN
               ? SONJECT_OK
               : read_quantity(reader, node, QUANTITY_LENGTH, &sonar->altitude_m);
}

static sonject_status finish_sonar(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    const sonject_sonar_params *sonar = structure;
    const bool is_real = sonar->kind == SONJECT_SONAR_REAL;
    if (is_real && !is_given(node, "array"))
        refuse_key(reader, node, "array", "missing; a real aperture needs its length");
    if (!is_real && is_given(node, "array"))
        refuse_relation(reader, node, "array", "kind",
                        "belongs to a real aperture; set kind: real");
    if (is_real && is_given(node, "aperture"))
        refuse_key(reader, node, "aperture",
                   "belongs to a synthetic aperture; a real one has that of its array");
    if (sonar->bandwidth_hz >= 2.0 * sonar->centre_frequency_hz)
        refuse_relation(reader, node, "bandwidth", "frequency",
                        "must be below twice the frequency, %g Hz, not %g Hz",
                        2.0 * sonar->centre_frequency_hz, sonar->bandwidth_hz);
    return SONJECT_OK;
}

#define STRUCTURE sonject_sonar_params
static const struct field taylor_fields[] = {
    TAYLOR_FIELDS,
};
static const struct section taylor_section = {ROWS(taylor_fields)};

static const struct field response_fields[] = {
    {"taylor", "sidelobes and terms of a Taylor window", SAME(taylor_section),
     SETS(response_window, SONJECT_WINDOW_TAYLOR), REQUIRED},
};
static const struct section response_section = {ROWS(response_fields)};

/* The angles keep the beam on the imaged side. */
static const struct field array_fields[] = {
    {"length", "length of the array along the track, which sets the beam",
     QUANTITY(array_length_m, LENGTH), POSITIVE, REQUIRED},
    {"height", "height of the array across its length; 0 hears all elevations alike",
     QUANTITY(array_height_m, LENGTH), FROM_ZERO},
    {"heading", "heading of the array's long side, from along-track towards range",
     QUANTITY(array_heading_rad, ANGLE), WITHIN(-0.25 * PI, 0.25 * PI)},
    {"pitch", "pitch of the array's long side over the horizontal",
     QUANTITY(array_pitch_rad, ANGLE), WITHIN(-0.25 * PI, 0.25 * PI)},
    {"depression", "depression of the beam below the horizontal",
     QUANTITY(array_depression_rad, ANGLE), WITHIN(0.0, 0.5 * PI)},
};
static const struct section array_section = {ROWS(array_fields)};

static const struct field sonar_fields[] = {
    {"frequency", "centre frequency", QUANTITY(centre_frequency_hz, FREQUENCY),
     WITHIN(FREQUENCY_MIN_HZ, FREQUENCY_MAX_HZ), .preset = 100e3, REQUIRED},
    {"bandwidth", "sets the range resolution, c / (2 bandwidth)", QUANTITY(bandwidth_hz, FREQUENCY),
     WITHIN(FREQUENCY_MIN_HZ, FREQUENCY_MAX_HZ), .preset = 30e3, REQUIRED},
    {"altitude",
     "height of the track over the mean seabed; from_file, or first_return of the calibration",
     QUANTITY(altitude_m, LENGTH), POSITIVE, .preset = 10.0, .read = read_altitude,
     .unit = "m, km, cm, mm, from_file or first_return", REQUIRED},
    {"resolution", "along-track resolution; by default the row spacing",
     QUANTITY(along_track_resolution_m, LENGTH), POSITIVE, NONE_IF_ZERO},
    {"transducer", "side length of the source; 0 for a point", QUANTITY(transducer_side_m, LENGTH),
     FROM_ZERO},
    {"response",
     "aspect weighting of a synthetic aperture: rectangular, hamming, taylor (-35 dB, 5 terms) or "
     "{taylor: {sidelobes: , terms: }}; a real aperture has its array's beam",
     WORD(response_window) = {[SONJECT_WINDOW_RECTANGULAR] = "rectangular",
                              [SONJECT_WINDOW_HAMMING] = "hamming",
                              [SONJECT_WINDOW_TAYLOR] = "taylor"},
     .preset = SONJECT_WINDOW_TAYLOR, .section = &response_section},
    {"kind", "aperture: synthetic, or the real one of a sidescan",
     WORD(kind) = {[SONJECT_SONAR_SYNTHETIC] = "synthetic", [SONJECT_SONAR_REAL] = "real"}},
    {"aperture",
     "full angle of aspects for shadows and rough highlights; auto: the response's, none: "
     "broadside",
     QUANTITY(aperture_rad, ANGLE), WITHIN(0.0, 0.5 * PI), .preset = -1.0,
     .words = {"auto", "none"}, .word_values = {-1.0, 0.0}, .unit = "deg, auto or none"},
    {"array", "array of a real aperture", SAME(array_section)},
    {"pulse", "response of a point in range; by default Gaussian", OF_SCENE(pulse, pulse_section)},
    {"measured_response", "along-track response, a table of along_track_m, real, and imaginary",
     SPECIAL(read_cross_range, "file name")},
    {"motion", "residual motion of a synthetic aperture's sonar",
     OF_SCENE(motion.params, motion_section)},
};
const struct section sonar_section = {ROWS(sonar_fields), .finish = finish_sonar,
                                      .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE

/* ---- The array of the element level. */

static void relate_elements(struct check *check, const void *structure)
{
    const sonject_elements_params *elements = structure;
    if (elements->last_time_s < elements->first_time_s)
        check_relation(check, "last_time", "first_time",
                       "must not be before first_time, %g s, but is %g s", elements->first_time_s,
                       elements->last_time_s);
}

#define STRUCTURE sonject_elements_params
static const struct field pings_fields[] = {
    {"count", "number of pings; by default as many as see the patch's whole aperture",
     COUNT32(pings, 1, UINT32_C(1) << 24), NONE_IF_ZERO},
    {"first",
     "track position of the array's origin at ping 0; by default pings are centred on the patch",
     QUANTITY(first_ping_m, LENGTH), COORDINATE, NONE_IF_NAN},
    {"spacing", "distance from ping to ping; by default half the array's length",
     QUANTITY(ping_spacing_m, LENGTH), POSITIVE, NONE_IF_ZERO},
};
static const struct section pings_section = {ROWS(pings_fields)};

static const struct field transmitter_fields[] = {
    {"offset", "offset of the transmitter's middle from the array's origin, along-track",
     QUANTITY(transmitter_offset_m, LENGTH), COORDINATE},
    {"length", "transmitter's along-track length, 0 for a point; by default twice the resolution",
     QUANTITY(transmitter_length_m, LENGTH), FROM_ZERO, NONE_IF_NAN},
};
static const struct section transmitter_section = {ROWS(transmitter_fields)};

static const struct field hydrophones_fields[] = {
    {"count", "number of hydrophones", COUNT32(hydrophones, 1, 65536), .preset = 1},
    {"first",
     "offset of the first hydrophone's middle from the array's origin; by default centred on it",
     QUANTITY(first_hydrophone_m, LENGTH), COORDINATE, NONE_IF_NAN},
    {"spacing", "distance between the hydrophones' middles; by default the hydrophones' length",
     QUANTITY(hydrophone_spacing_m, LENGTH), POSITIVE, NONE_IF_ZERO},
    {"length", "length of a hydrophone along-track, 0 for a point; by default twice the resolution",
     QUANTITY(hydrophone_length_m, LENGTH), FROM_ZERO, NONE_IF_NAN},
};
static const struct section hydrophones_section = {ROWS(hydrophones_fields)};

static const struct field elements_fields[] = {
    {"pings", "positions of the array, ping by ping", SAME(pings_section)},
    {"transmitter", "transmitter of the array", SAME(transmitter_section)},
    {"hydrophones", "hydrophones of the array", SAME(hydrophones_section)},
    {"form", "form of the series: complex baseband, or real passband",
     WORD(form) = {[SONJECT_SERIES_BASEBAND] = "baseband", [SONJECT_SERIES_PASSBAND] = "passband"}},
    {"pulse", "pulse of the series: compressed, or the chirp that was sent",
     WORD(pulse) = {[SONJECT_SERIES_COMPRESSED] = "compressed", [SONJECT_SERIES_CHIRP] = "chirp"}},
    {"chirp", "duration of the chirp", QUANTITY(chirp_duration_s, TIME), WITHIN(1e-9, 100.0),
     .preset = 0.01},
    {"sampling_rate",
     "sampling rate; by default twice the bandwidth, in passband with twice the frequency added",
     QUANTITY(sampling_rate_hz, FREQUENCY), WITHIN(1.0, 1e10), NONE_IF_ZERO},
    {"first_time", "time of the first sample after transmission; by default as the patch needs",
     QUANTITY(first_time_s, TIME), WITHIN(0.0, 3600.0), NONE_IF_NAN},
    {"last_time",
     "latest time of the last sample after transmission; by default as the patch needs",
     QUANTITY(last_time_s, TIME), WITHIN(0.0, 3600.0), NONE_IF_NAN},
    {"source_level",
     "rms source level re 1 uPa at 1 m; the series are then pressures in Pa, less absorption, by "
     "default ratios",
     QUANTITY(source_level_db, DECIBEL), WITHIN(0.0, 300.0), NONE_IF_NAN},
    {"aspect_limit", "largest angle off abeam of echoes that are kept; by default all are kept",
     QUANTITY(aspect_limit_rad, ANGLE), WITHIN(0.0, 0.5 * PI), NONE_IF_ZERO},
};
const struct section elements_section = {ROWS(elements_fields), .relations = relate_elements,
                                         .bytes = sizeof(STRUCTURE)};
#undef STRUCTURE
