/* What shapes the point response beside the sonar's own numbers: pulse and measured cross-range
 * response. Their tables are files of text with named columns. */
#include <stdlib.h>
#include <string.h>

#include "io/number_table.h"
#include "io/scene_fields.h"

#define TABLE_BYTES_MAX (16 * 1024 * 1024)

enum {
    POSITION,
    TIME,
    REAL_PART,
    IMAGINARY_PART
};

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
    sonject_status status = number_table_read(reader->report, path, format, &table);
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
    if (status == SONJECT_OK)
        status = read_response_file(reader, path, &format, &reader->scene->cross_range_table);
    free(path);
    return status;
}
