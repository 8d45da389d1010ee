/* The distance between pings: given, or what speed and ping rate make it. */
#include "io/scene_fields.h"

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
    const sonject_status status = read_section(reader, &ping_spacing_section, node, &pings);
    if (status != SONJECT_OK)
        return status;
    if (!(pings.speed_mps > 0.0))
        return refuse_key(reader, node, "speed", "must be above 0 m/s, not %g", pings.speed_mps);
    if (!(pings.ping_rate_hz > 0.0))
        return refuse_key(reader, node, "ping_rate", "must be above 0 Hz, not %g",
                          pings.ping_rate_hz);
    geometry->row_spacing_m = pings.speed_mps / pings.ping_rate_hz;
    return SONJECT_OK;
}
