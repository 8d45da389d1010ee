#include "inject/reimaging.h"

#include <math.h>

#include "trace/smooth.h"

#define EDGE_LOSS       0.02   /* of an edge pixel's energy */
#define EDGE_DEVIATIONS 1.4522 /* erfc(x) / 2 = EDGE_LOSS, G^2 being exp(-(r / sigma)^2) */
#define ROUNDING        1e-6

/* The pulse's range resolution is inverse to the bandwidth. */
static double bandwidth_for(const struct tracer *tracer, double deviation_m)
{
    return tracer->scene->sonar.bandwidth_hz * tracer->response.range_deviation_m / deviation_m;
}

static sonject_status check_pulse(const struct traced_grids *grids, const struct tracer *tracer,
                                  const char *file)
{
    const double spacing = tracer->view.column_spacing_m;
    const double shortest = fmax(line_grid_shortest_deviation(&grids->patch, spacing),
                                 glint_shortest_deviation(&grids->glints, spacing));
    const double margin = -grids->patch.bins.first * spacing / grids->patch.bins_per_pixel;
    const double longest = margin / EDGE_DEVIATIONS;
    const double deviation = tracer->response.range_deviation_m;
    if (deviation >= shortest * (1.0 - ROUNDING) && deviation <= longest * (1.0 + ROUNDING))
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "sonar.bandwidth: %g kHz, but %s was traced for %.4g to %.4g kHz: trace "
                          "again with another bandwidth",
                          1e-3 * tracer->scene->sonar.bandwidth_hz, file,
                          1e-3 * bandwidth_for(tracer, longest),
                          1e-3 * bandwidth_for(tracer, shortest));
}

static sonject_status check_cross_range(const struct traced_grids *grids,
                                        const struct tracer *tracer, const char *file)
{
    const double strip = tracer->view.row_spacing_m / grids->patch.strips_per_row;
    const double margin = -grids->patch.strips.first * strip;
    if (tracer->response.resolution_m < strip * (1.0 - ROUNDING))
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "sonar.resolution: %g cm, but %s was traced in strips of %.4g cm: "
                              "trace again with a finer one",
                              1e2 * tracer->response.resolution_m, file, 1e2 * strip);
    /* half of what is not within the margin lies beyond it */
    const double reach = along_track_energy_reach(&tracer->response, 2.0 * EDGE_LOSS);
    if (reach <= margin)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "sonar.resolution: the response reaches %.4g m, but %s was traced to "
                          "%.4g m beyond the patch: trace again with a coarser resolution",
                          reach, file, margin);
}

sonject_status reimaging_check(struct traced_grids *grids, const struct tracer *tracer,
                               const struct scene *traced, const char *file)
{
    const double reference =
        tracer->view.range_ratio * tracer->view.water.water->straight_speed_mps;
    struct tracer before = *tracer;
    point_response_init(&before.response, &traced->sonar, reference, tracer->view.row_spacing_m);
    line_grid_for_patch(&grids->patch, &before.view, &before.response);
    glint_cells_lay(&grids->glints, &before);
    const sonject_status status = check_pulse(grids, tracer, file);
    return status == SONJECT_OK ? check_cross_range(grids, tracer, file) : status;
}
