/* What a scene may leave to its input file. */
#include <string.h>

#include "base/text.h"
#include "io/recording.h"
#include "io/scene_schema.h"
#include "io/xtf_file.h"

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
