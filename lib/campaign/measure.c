/* The room that a swath has for images. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "campaign/campaign.h"

static double column_at(const sonject_geometry_params *geometry, double range_m)
{
    return (range_m - geometry->first_slant_range_m) / geometry->column_spacing_m;
}

/* First columns beyond the first return whose chip's middle has a slant range within the limits. */
static void limit_ranges(const struct campaign *campaign, const sonject_geometry_params *geometry,
                         double altitude_m, struct region *chips)
{
    const double half = 0.5 * (double)(campaign->chip_columns - 1);
    double low = fmax((double)chips->first_column, floor(column_at(geometry, altitude_m)) + 1.0);
    double high = (double)chips->first_column + (double)chips->columns - 1.0;
    if (campaign->has_range) {
        low = fmax(low, ceil(column_at(geometry, campaign->nearest_range_m) - half - 1e-9));
        high = fmin(high, floor(column_at(geometry, campaign->farthest_range_m) - half + 1e-9));
    }
    if (!(low <= high)) {
        chips->columns = 0;
        return;
    }
    chips->first_column = (uint64_t)low;
    chips->columns = (uint64_t)(high - low) + 1;
}

/* First pixels of chips that would touch a box. */
static void forbid(const struct campaign *campaign, const struct region *box,
                   struct region *forbidden)
{
    const uint64_t above = (uint64_t)campaign->clearance + campaign->chip_rows - 1;
    const uint64_t before = (uint64_t)campaign->clearance + campaign->chip_columns - 1;
    forbidden->first_row = box->first_row > above ? box->first_row - above : 0;
    forbidden->rows = box->first_row + box->rows + campaign->clearance - forbidden->first_row;
    forbidden->first_column = box->first_column > before ? box->first_column - before : 0;
    forbidden->columns =
        box->first_column + box->columns + campaign->clearance - forbidden->first_column;
}

static sonject_status refuse_size(const struct campaign *campaign, const struct swath_plan *swath)
{
    return tree_failure(&campaign->tree, swath->place, "swaths",
                        "%s has %llu x %llu pixels, too few for images of %u x %u that stay %u "
                        "pixels away from its edges",
                        swath->written, (unsigned long long)swath->layout.rows,
                        (unsigned long long)swath->layout.columns, (unsigned)campaign->chip_rows,
                        (unsigned)campaign->chip_columns, (unsigned)campaign->edge);
}

sonject_status campaign_measure(struct report *report, struct campaign *campaign, size_t swath,
                                const sonject_geometry_params *geometry, double altitude_m)
{
    struct swath_plan *plan = &campaign->swaths[swath];
    const uint64_t rows = (uint64_t)campaign->chip_rows + 2 * (uint64_t)campaign->edge;
    const uint64_t columns = (uint64_t)campaign->chip_columns + 2 * (uint64_t)campaign->edge;
    if (plan->layout.rows < rows || plan->layout.columns < columns)
        return refuse_size(campaign, plan);
    struct region chips = {campaign->edge, campaign->edge, plan->layout.rows - rows + 1,
                           plan->layout.columns - columns + 1};
    limit_ranges(campaign, geometry, altitude_m, &chips);
    if (chips.columns == 0 && !campaign->has_range)
        return tree_failure(&campaign->tree, plan->place, "swaths",
                            "no image within %s begins beyond the sonar's altitude, up to %g m",
                            plan->written, altitude_m);
    if (chips.columns == 0)
        return tree_failure(&campaign->tree, plan->place, "swaths",
                            "no image within %s has its middle at slant ranges of %g to %g m and "
                            "begins beyond the sonar's altitude, up to %g m",
                            plan->written, campaign->nearest_range_m, campaign->farthest_range_m,
                            altitude_m);
    struct region *forbidden = allocate_array(plan->avoid_count, sizeof *forbidden);
    CHECK_MEMORY(report, forbidden, "the places for images");
    for (size_t i = 0; i < plan->avoid_count; i++)
        forbid(campaign, &plan->avoid[i], &forbidden[i]);
    chip_room_clear(&plan->room);
    sonject_status status =
        chip_room_init(&plan->room, report, &chips, forbidden, plan->avoid_count);
    free(forbidden);
    if (status == SONJECT_OK && plan->room.places == 0)
        status = tree_failure(&campaign->tree, plan->place, "swaths",
                              "the %zu contacts to avoid in %s leave no room for images of %u x %u "
                              "that stay %u pixels away from them",
                              plan->avoid_count, plan->written, (unsigned)campaign->chip_rows,
                              (unsigned)campaign->chip_columns, (unsigned)campaign->clearance);
    return status;
}
