/* What shapes the point response beside the sonar's own numbers: pulse, measured cross-range
 * response, and residual motion. Their tables are files of text with named columns. */
#include <stdlib.h>
#include <string.h>

#include "schema/number_table.h"
#include "schema/scene_fields.h"

#define TABLE_BYTES_MAX (16 * 1024 * 1024)

enum {
    POSITION,
    TIME,
    REAL_PART,
    IMAGINARY_PART
};

static sonject_status read_table(const struct reader *reader, const char *path,
                                 const struct table_format *format, struct number_table *table)
{
    const struct number_array *array = find_array(reader, path);
    return array ? number_table_take(reader->report, array, format, table)
                 : number_table_read(reader->report, path, format, table);
}

/* Samples of a response, checked, into the scene. */
static sonject_status take_response(struct reader *reader, struct number_table *table,
                                    struct response_table *response)
{
    const int position = table->values[TIME] ? TIME : POSITION;
    struct response_fault fault;
    if (!response_samples_are_good(table->values[position], table->values[REAL_PART],
                                   table->values[IMAGINARY_PART], table->count, &fault))
        return number_table_refuse(table, reader->report, fault.sample, (size_t)position,
                                   fault.what);
    return response_table_set(response, reader->report, table->values[position],
                              table->values[REAL_PART], table->values[IMAGINARY_PART], table->count,
                              position == TIME);
}

static sonject_status read_response_file(struct reader *reader, const char *path,
                                         const struct table_format *format,
                                         struct response_table *response)
{
    struct number_table table;
    sonject_status status = read_table(reader, path, format, &table);
    if (status != SONJECT_OK)
        return status;
    status = take_response(reader, &table, response);
    number_table_clear(&table);
    return status;
}

/* A pulse as its section is read. */
struct pulse_text {
    sonject_pulse_params params;
    char *file; /* owned */
};

static sonject_status finish_pulse_taylor(struct reader *reader, const struct tree_node *node,
                                          void *structure)
{
    struct pulse_text *text = structure;
    (void)reader;
    (void)node;
    text->params.window = SONJECT_PULSE_TAYLOR;
    return SONJECT_OK;
}

static sonject_status finish_pulse(struct reader *reader, const struct tree_node *node,
                                   void *structure)
{
    static const struct table_format format = {
        {"range_m", "time_s", "real", "imaginary"}, 1, RESPONSE_SAMPLES_MAX, TABLE_BYTES_MAX};
    struct pulse_text *text = structure;
    const bool is_table = text->params.kind == SONJECT_PULSE_TABLE;
    if (is_given(node, "window") && text->params.kind != SONJECT_PULSE_CHIRP)
        refuse_relation(reader, node, "window", "kind", "only a chirp has one; set kind: chirp");
    if (is_table != is_given(node, "file"))
        refuse_relation(reader, node, "file", "kind",
                        is_table ? "missing; the table is read from it"
                                 : "belongs to kind: table; remove it");
    const sonject_status status = check_pulse(&text->params, NULL, listen_at(reader, node));
    if (!is_table || !are_sound(reader, "file"))
        return status;
    return read_response_file(reader, text->file, &format, &reader->scene->pulse_table);
}

#define STRUCTURE struct pulse_text
static const struct field pulse_taylor_fields[] = {
    {"sidelobes", "depth of the side lobes",
     QUANTITY(STRUCTURE, params.taylor_sidelobe_db, QUANTITY_DECIBEL), REQUIRED},
    {"terms", "side lobes of equal height", COUNT32(STRUCTURE, params.taylor_terms, UINT32_MAX),
     REQUIRED},
};
static const struct section pulse_taylor_section = {pulse_taylor_fields, COUNT(pulse_taylor_fields),
                                                    finish_pulse_taylor};

static const struct field pulse_window_fields[] = {
    {"taylor", "sidelobes and terms of a Taylor window", SAME(pulse_taylor_section), REQUIRED},
};
static const struct section pulse_window_section = {pulse_window_fields, COUNT(pulse_window_fields),
                                                    NULL};

static const struct field pulse_fields[] = {
    {"kind", "gaussian, a compressed linear sweep, or a table",
     WORD(STRUCTURE, params.kind) = {[SONJECT_PULSE_GAUSSIAN] = "gaussian",
                                     [SONJECT_PULSE_CHIRP] = "chirp",
                                     [SONJECT_PULSE_TABLE] = "table"},
     REQUIRED},
    {"window", "of a chirp's spectrum: rectangular, hann or {taylor: {sidelobes: , terms: }}",
     WORD(STRUCTURE, params.window) =
         {[SONJECT_PULSE_RECTANGULAR] = "rectangular", [SONJECT_PULSE_HANN] = "hann"},
     .section = &pulse_window_section},
    {"file", "table with columns range_m (beyond the target) or time_s, real, and imaginary",
     .kind = FIELD_FILE, .offset = offsetof(STRUCTURE, file)},
};
const struct section pulse_section = {pulse_fields, COUNT(pulse_fields), finish_pulse};
#undef STRUCTURE

sonject_status read_pulse(struct reader *reader, const struct tree_node *node, void *structure)
{
    struct pulse_text text;
    (void)structure;
    memset(&text, 0, sizeof text);
    sonject_pulse_params_init(&text.params);
    const sonject_status status = read_section(reader, &pulse_section, node, &text);
    free(text.file);
    if (status == SONJECT_OK)
        reader->scene->pulse = text.params;
    return status;
}

sonject_status read_cross_range(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    static const struct table_format format = {
        {"along_track_m", NULL, "real", "imaginary"}, 1, RESPONSE_SAMPLES_MAX, TABLE_BYTES_MAX};
    char *path = NULL;
    (void)structure;
    sonject_status status = read_existing_path(reader, node, &path);
    THEN(status, read_response_file(reader, path, &format, &reader->scene->cross_range_table));
    free(path);
    return status;
}

static sonject_status finish_sway(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    sonject_motion_params motion;
    sonject_motion_params_init(&motion);
    motion.sways[0] = *(const sonject_sway *)structure;
    motion.sway_count = 1;
    return check_motion(&motion, NULL, listen_at(reader, node));
}

static sonject_status finish_yaw(struct reader *reader, const struct tree_node *node,
                                 void *structure)
{
    sonject_motion_params motion;
    sonject_motion_params_init(&motion);
    motion.yaws[0] = *(const sonject_yaw *)structure;
    motion.yaw_count = 1;
    motion.yaw_advance_m = 1.0;
    return check_motion(&motion, NULL, listen_at(reader, node));
}

#define STRUCTURE sonject_sway
static const struct field sway_fields[] = {
    {"amplitude", "of the sine", QUANTITY(STRUCTURE, amplitude_m, QUANTITY_LENGTH), REQUIRED},
    {"wavelength", "of the sine, along-track", QUANTITY(STRUCTURE, wavelength_m, QUANTITY_LENGTH),
     REQUIRED},
    {"phase", "of the sine at along-track 0", QUANTITY(STRUCTURE, phase_rad, QUANTITY_ANGLE)},
};
static const struct section sway_section = {sway_fields, COUNT(sway_fields), finish_sway};
#undef STRUCTURE

#define STRUCTURE sonject_yaw
static const struct field yaw_sine_fields[] = {
    {"amplitude", "of the sine", QUANTITY(STRUCTURE, amplitude_rad, QUANTITY_ANGLE), REQUIRED},
    {"wavelength", "of the sine, along-track", QUANTITY(STRUCTURE, wavelength_m, QUANTITY_LENGTH),
     REQUIRED},
    {"phase", "of the sine at along-track 0", QUANTITY(STRUCTURE, phase_rad, QUANTITY_ANGLE)},
};
static const struct section yaw_sine_section = {yaw_sine_fields, COUNT(yaw_sine_fields),
                                                finish_yaw};
#undef STRUCTURE

static sonject_status read_motion_table(struct reader *reader, const struct tree_node *node,
                                        enum motion_kind kind, const struct table_format *format,
                                        struct motion_table *motion)
{
    struct number_table table;
    char *path = NULL;
    size_t sample;
    const char *what;
    sonject_status status = read_existing_path(reader, node, &path);
    THEN(status, read_table(reader, path, format, &table));
    free(path);
    if (status != SONJECT_OK)
        return status;
    if (!motion_samples_are_good(kind, table.values[0], table.values[2], table.count, &sample,
                                 &what))
        status = number_table_refuse(&table, reader->report, sample, 0, what);
    else
        status =
            motion_table_set(motion, reader->report, table.values[0], table.values[2], table.count);
    number_table_clear(&table);
    return status;
}

static sonject_status read_sway_file(struct reader *reader, const struct tree_node *node,
                                     void *structure)
{
    static const struct table_format format = {
        {"along_track_m", NULL, "sway_m", NULL}, 1, MOTION_SAMPLES_MAX, TABLE_BYTES_MAX};
    (void)structure;
    return read_motion_table(reader, node, MOTION_SWAY, &format, &reader->scene->motion.sway_table);
}

static sonject_status read_yaw_file(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    static const struct table_format format = {
        {"along_track_m", NULL, "yaw_rad", NULL}, 1, MOTION_SAMPLES_MAX, TABLE_BYTES_MAX};
    (void)structure;
    return read_motion_table(reader, node, MOTION_YAW, &format, &reader->scene->motion.yaw_table);
}

static sonject_status finish_motion(struct reader *reader, const struct tree_node *node,
                                    void *structure)
{
    sonject_motion_params motion = *(const sonject_motion_params *)structure;
    motion.sway_count = motion.yaw_count = 0; /* each sine was checked */
    return check_motion(&motion, NULL, listen_at(reader, node));
}

/* An advance of 0, which would mean that there is no yaw. */
static sonject_status finish_yaws(struct reader *reader, const struct tree_node *node,
                                  void *structure)
{
    const sonject_motion_params *motion = structure;
    if (motion->yaw_advance_m == 0.0)
        return refuse_key(reader, node, "advance", "must be 0.1...1000 m, not 0");
    return SONJECT_OK;
}

#define STRUCTURE sonject_motion_params
static const struct field random_fields[] = {
    {"rms", "of the sway", QUANTITY(STRUCTURE, random_rms_m, QUANTITY_LENGTH), REQUIRED},
    {"correlation", "length, along-track",
     QUANTITY(STRUCTURE, random_correlation_m, QUANTITY_LENGTH), REQUIRED},
    {"seed", "of the random sway", COUNT64(STRUCTURE, seed, UINT64_MAX)},
};
static const struct section random_section = {random_fields, COUNT(random_fields), NULL};

static const struct field random_yaw_fields[] = {
    {"rms", "of the yaw", QUANTITY(STRUCTURE, yaw_random_rms_rad, QUANTITY_ANGLE), REQUIRED},
    {"correlation", "length, along-track",
     QUANTITY(STRUCTURE, yaw_random_correlation_m, QUANTITY_LENGTH), REQUIRED},
    {"seed", "of the random yaw", COUNT64(STRUCTURE, yaw_seed, UINT64_MAX)},
};
static const struct section random_yaw_section = {random_yaw_fields, COUNT(random_yaw_fields),
                                                  NULL};

static const struct field yaw_fields[] = {
    {"advance", "from ping to ping: what a ping's phase centres fill, half the array",
     QUANTITY(STRUCTURE, yaw_advance_m, QUANTITY_LENGTH), REQUIRED},
    {"bias", "of all pings, bow towards the imaged side",
     QUANTITY(STRUCTURE, yaw_bias_rad, QUANTITY_ANGLE)},
    {"sines", "list of them", ENTRIES(STRUCTURE, yaws, yaw_count, "sine", yaw_sine_section)},
    {"random", "yaw of Gaussian autocorrelation", SAME(random_yaw_section)},
    {"file", "table with columns along_track_m and yaw_rad", .kind = FIELD_SPECIAL,
     .read = read_yaw_file, .unit = "file name"},
};
static const struct section yaw_section = {yaw_fields, COUNT(yaw_fields), finish_yaws};

static const struct field motion_fields[] = {
    {"sway", "list of sines, across the track",
     ENTRIES(STRUCTURE, sways, sway_count, "sine", sway_section)},
    {"random", "sway of Gaussian autocorrelation", SAME(random_section)},
    {"file", "table with columns along_track_m and sway_m", .kind = FIELD_SPECIAL,
     .read = read_sway_file, .unit = "file name"},
    {"yaw", "of an array of hydrophones, whose heading the processor does not know",
     SAME(yaw_section)},
};
const struct section motion_section = {motion_fields, COUNT(motion_fields), finish_motion};
#undef STRUCTURE

sonject_status read_motion(struct reader *reader, const struct tree_node *node, void *structure)
{
    (void)structure;
    return read_section(reader, &motion_section, node, &reader->scene->motion.params);
}
