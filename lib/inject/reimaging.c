#include "inject/reimaging.h"

#include <math.h>

#include "scene/point_response.h"
#include "trace/glints.h"

#define EDGE_LOSS         0.02   /* of an edge pixel's energy */
#define EDGE_DEVIATIONS   1.4522 /* erfc(x) / 2 = EDGE_LOSS, G^2 being exp(-(r / sigma)^2) */
#define ROUNDING          1e-6
#define CELLS_A_PIXEL_MAX 4096

/* Half of what is not within the margin lies beyond it. */
static double pulse_reach(const struct point_response *response)
{
    return response->pulse_kind == SONJECT_PULSE_GAUSSIAN
               ? EDGE_DEVIATIONS * response->range_deviation_m
               : range_energy_reach(response, 2.0 * EDGE_LOSS);
}

/* The pulse's range resolution is inverse to the bandwidth. */
static double bandwidth_for(const struct tracer *tracer, double share)
{
    return 1e-3 * tracer->scene->sonar.bandwidth_hz * share;
}

static sonject_status check_bins(const struct line_grid *grid, const struct tracer *tracer,
                                 double shortest_deviation, const char *file)
{
    const struct point_response *response = &tracer->response;
    const double bin = tracer->view.column_spacing_m / grid->bins_per_pixel;
    const double margin = -grid->bins.first * bin;
    const double fine = response->range_deviation_m / shortest_deviation;
    /* a margin that ends at range 0 holds all that any pulse reaches */
    const double wide =
        tracer->view.first_range_m - margin < bin ? HUGE_VAL : margin / pulse_reach(response);
    if (fine >= 1.0 - ROUNDING && wide >= 1.0 - ROUNDING)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "sonar.bandwidth: %g kHz, but with that pulse %s was traced for %.4g to "
                          "%.4g kHz: trace again with another bandwidth",
                          bandwidth_for(tracer, 1.0), file, bandwidth_for(tracer, 1.0 / wide),
                          bandwidth_for(tracer, fine));
}

static sonject_status check_strips(const struct line_grid *grid, const struct tracer *tracer,
                                   const char *file)
{
    const double strip = tracer->view.row_spacing_m / grid->strips_per_row;
    const double margin = -grid->strips.first * strip;
    if (tracer->response.strip_m < strip * (1.0 - ROUNDING))
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "sonar.resolution: %g cm, but %s was traced in strips of %.4g cm: "
                              "trace again with a finer one",
                              1e2 * tracer->response.strip_m, file, 1e2 * strip);
    /* half of what is not within the margin lies beyond it */
    const double farthest = view_processor_range(&tracer->view, (double)tracer->view.columns - 1.0);
    const double reach = cross_range_energy_reach(&tracer->response, farthest, 2.0 * EDGE_LOSS);
    const bool is_moved = tracer->response.motion != NULL;
    if (reach <= margin)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "%s: the response reaches %.4g m, but %s was traced to %.4g m beyond the "
                          "patch: trace again with %s",
                          is_moved ? "sonar.motion" : "sonar.resolution", reach, file, margin,
                          is_moved ? "this motion" : "a coarser resolution");
}

/* A span that begins at or before the first of `count` and ends at or behind the last. */
static bool holds(struct span span, double count)
{
    return span.first <= 0 && (double)span.first + span.count >= count;
}

static sonject_status check_sizes(const struct line_grid *grid, const struct tracer *tracer,
                                  const char *file)
{
    if (grid->strips_per_row <= CELLS_A_PIXEL_MAX && grid->bins_per_pixel <= CELLS_A_PIXEL_MAX)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "%s: is damaged: its grids are finer than tracing lays them", file);
}

sonject_status reimaging_check_beam(const struct line_grid *grid, const struct tracer *tracer,
                                    const char *file)
{
    const struct patch_view *view = &tracer->view;
    const double rows = (double)view->rows * grid->strips_per_row;
    const double columns = (double)(view->columns - 1) * grid->bins_per_pixel + 1.0;
    const sonject_status status = check_sizes(grid, tracer, file);
    if (status != SONJECT_OK || (holds(grid->strips, rows) && holds(grid->bins, columns)))
        return status;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "%s: is damaged: its seabed is not that of the patch", file);
}

sonject_status reimaging_check_patch(const struct line_grid *grid, const struct tracer *tracer,
                                     const char *file)
{
    sonject_status status = reimaging_check_beam(grid, tracer, file);
    THEN(status,
         check_bins(grid, tracer, line_grid_shortest_deviation(grid, tracer->view.column_spacing_m),
                    file));
    return status == SONJECT_OK ? check_strips(grid, tracer, file) : status;
}

sonject_status reimaging_check_glints(const struct line_grid *grid, const struct tracer *tracer,
                                      const char *file)
{
    const double spacing = tracer->view.column_spacing_m;
    const double shortest = glint_shortest_deviation(grid, spacing);
    const sonject_status status = check_sizes(grid, tracer, file);
    if (status != SONJECT_OK || tracer->response.range_deviation_m >= shortest * (1.0 - ROUNDING))
        return status;
    return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                          "sonar.bandwidth: %g kHz, but the glints of %s were traced for at most "
                          "%.4g kHz: trace again with another bandwidth",
                          bandwidth_for(tracer, 1.0), file,
                          bandwidth_for(tracer, tracer->response.range_deviation_m / shortest));
}
