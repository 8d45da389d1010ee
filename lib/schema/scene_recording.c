/* What a scene may leave to its input file, or to speed and ping rate. */
#include <string.h>

#include "base/text.h"
#include "schema/scene_fields.h"
#include "swath/recording.h"
#include "swath/xtf_file.h"

static bool is_word(const struct tree_node *node, const char *word)
{
    return node->kind == TREE_TEXT && node->text && strcmp(node->text, word) == 0;
}

sonject_status read_channel(struct reader *reader, const struct tree_node *node, void *structure)
{
    struct scene *scene = structure;
    char excerpt[40];
    uint64_t number = 0;
    if (is_word(node, "port"))
        scene->channel = SONJECT_CHANNEL_PORT;
    else if (is_word(node, "starboard"))
        scene->channel = SONJECT_CHANNEL_STARBOARD;
    else if (node->kind == TREE_TEXT && node->text && text_to_count(node->text, &number) &&
             number <= XTF_CHANNEL_MAX)
        scene->channel = (int32_t)number;
    else
        return refuse_value(reader, node,
                            "'%s' is neither port nor starboard nor a channel's "
                            "number, 0 to %d",
                            node->kind == TREE_TEXT && node->text
                                ? text_excerpt(excerpt, sizeof excerpt, node->text)
                                : "",
                            XTF_CHANNEL_MAX);
    return SONJECT_OK;
}

sonject_status read_geometry(struct reader *reader, const struct tree_node *node, void *structure)
{
    struct scene *scene = structure;
    reader->takes_geometry = is_word(node, "from_file");
    if (reader->takes_geometry)
        return SONJECT_OK;
    return read_section(reader, &geometry_section, node, &scene->geometry);
}

sonject_status read_altitude(struct reader *reader, const struct tree_node *node, void *structure)
{
    sonject_sonar_params *sonar = structure;
    reader->takes_altitude = is_word(node, "from_file");
    if (reader->takes_altitude)
        return SONJECT_OK;
    return read_quantity(reader, node, QUANTITY_LENGTH, &sonar->altitude_m);
}

sonject_status finish_recording(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    struct report report = {{0}, NULL, NULL};
    const sonject_status status = finish_sonar(reader, node, structure);
    if ((!reader->takes_geometry && !reader->takes_altitude) ||
        mistakes_concern(reader->tree->mistakes, reader->tree, "input") ||
        mistakes_concern(reader->tree->mistakes, reader->tree, "patch"))
        return status;
    const char *key;
    if (recording_describe(&report, reader->takes_geometry, reader->takes_altitude, reader->scene,
                           &key) == SONJECT_OK)
        return SONJECT_OK;
    key_path_shorten(&reader->path, 0);
    return refuse_key(reader, &reader->tree->root, key, "%s", report.message);
}

struct ping_spacing {
    double speed_mps;
    double ping_rate_hz;
};

static const struct field ping_spacing_fields[] = {
    {"speed", "of the sonar over the ground",
     QUANTITY(struct ping_spacing, speed_mps, QUANTITY_SPEED), REQUIRED},
    {"ping_rate", "pings, and so rows, a second",
     QUANTITY(struct ping_spacing, ping_rate_hz, QUANTITY_FREQUENCY), REQUIRED},
};
const struct section ping_spacing_section = {ping_spacing_fields, COUNT(ping_spacing_fields), NULL};

sonject_status read_row_spacing(struct reader *reader, const struct tree_node *node,
                                void *structure)
{
    sonject_geometry_params *geometry = structure;
    struct ping_spacing pings = {0.0, 0.0};
    if (node->kind != TREE_SECTION)
        return read_quantity(reader, node, QUANTITY_LENGTH, &geometry->row_spacing_m);
    CHECK(read_section(reader, &ping_spacing_section, node, &pings));
    if (!(pings.speed_mps > 0.0))
        return refuse_key(reader, node, "speed", "must be above 0 m/s, not %g", pings.speed_mps);
    if (!(pings.ping_rate_hz > 0.0))
        return refuse_key(reader, node, "ping_rate", "must be above 0 Hz, not %g",
                          pings.ping_rate_hz);
    geometry->row_spacing_m = pings.speed_mps / pings.ping_rate_hz;
    return SONJECT_OK;
}
