/* The array of the element level. */
#include "schema/scene_fields.h"

#define STRUCTURE sonject_elements_params
static const struct field pings_fields[] = {
    {"count", "number of pings; by default as many as see the patch's whole aperture",
     COUNT32(STRUCTURE, pings, UINT32_MAX)},
    {"first",
     "track position of the array's origin at ping 0; by default the pings are about the "
     "patch",
     QUANTITY(STRUCTURE, first_ping_m, QUANTITY_LENGTH)},
    {"spacing", "way from ping to ping; by default half the array's length",
     QUANTITY(STRUCTURE, ping_spacing_m, QUANTITY_LENGTH)},
};
static const struct section pings_section = {pings_fields, COUNT(pings_fields), NULL};

static const struct field transmitter_fields[] = {
    {"offset", "of its middle from the array's origin, along-track",
     QUANTITY(STRUCTURE, transmitter_offset_m, QUANTITY_LENGTH)},
    {"length", "along-track, 0 for a point; by default twice the resolution",
     QUANTITY(STRUCTURE, transmitter_length_m, QUANTITY_LENGTH)},
};
static const struct section transmitter_section = {transmitter_fields, COUNT(transmitter_fields),
                                                   NULL};

static const struct field hydrophones_fields[] = {
    {"count", "number of hydrophones, by default 1", COUNT32(STRUCTURE, hydrophones, UINT32_MAX)},
    {"first",
     "offset of the first one's middle from the array's origin; by default the array is "
     "about it",
     QUANTITY(STRUCTURE, first_hydrophone_m, QUANTITY_LENGTH)},
    {"spacing", "from middle to middle; by default the length",
     QUANTITY(STRUCTURE, hydrophone_spacing_m, QUANTITY_LENGTH)},
    {"length", "along-track, 0 for points; by default twice the resolution",
     QUANTITY(STRUCTURE, hydrophone_length_m, QUANTITY_LENGTH)},
};
static const struct section hydrophones_section = {hydrophones_fields, COUNT(hydrophones_fields),
                                                   NULL};

static sonject_status finish_elements(struct reader *reader, const struct tree_node *node,
                                      void *structure)
{
    return check_elements(structure, NULL, listen_at(reader, node));
}

static const struct field elements_fields[] = {
    {"pings", "where the array is", SAME(pings_section)},
    {"transmitter", "what sends", SAME(transmitter_section)},
    {"hydrophones", "what hears", SAME(hydrophones_section)},
    {"form", "of the series: complex baseband, or real passband",
     WORD(STRUCTURE,
          form) = {[SONJECT_SERIES_BASEBAND] = "baseband", [SONJECT_SERIES_PASSBAND] = "passband"}},
    {"pulse", "compressed, or the chirp that was sent",
     WORD(STRUCTURE,
          pulse) = {[SONJECT_SERIES_COMPRESSED] = "compressed", [SONJECT_SERIES_CHIRP] = "chirp"}},
    {"chirp", "its duration, 10 ms by default",
     QUANTITY(STRUCTURE, chirp_duration_s, QUANTITY_TIME)},
    {"sampling_rate", "by default twice the highest frequency in passband, else the bandwidth",
     QUANTITY(STRUCTURE, sampling_rate_hz, QUANTITY_FREQUENCY)},
    {"first_time", "of the first sample, after transmission; by default what the patch needs",
     QUANTITY(STRUCTURE, first_time_s, QUANTITY_TIME)},
    {"last_time", "of the last sample at most; by default what the patch needs",
     QUANTITY(STRUCTURE, last_time_s, QUANTITY_TIME)},
    {"source_level",
     "rms, over 1 uPa at 1 m: series are pressures in Pa, less absorption; by default they are "
     "ratios",
     QUANTITY(STRUCTURE, source_level_db, QUANTITY_DECIBEL)},
    {"aspect_limit", "echoes further off abeam are left out; by default none",
     QUANTITY(STRUCTURE, aspect_limit_rad, QUANTITY_ANGLE)},
};
const struct section elements_section = {elements_fields, COUNT(elements_fields), finish_elements};
#undef STRUCTURE
