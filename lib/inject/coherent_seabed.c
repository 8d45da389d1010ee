#include "inject/coherent_seabed.h"

#include <math.h>

/* Mean energy of sum(taps * c) over that of sum(taps * white noise), where c has itself passed the
 * taps once, as a measured image has passed the sonar: sum over lags of the taps' autocorrelation
 * squared, over its value at 0 squared. */
static double energy_gain(double (*response)(const struct point_response *, double),
                          const struct point_response *of, double step, int reach)
{
    double at_zero = 0.0;
    double sum = 0.0;
    for (int lag = 0; lag <= 2 * reach; lag++) {
        double correlation = 0.0;
        for (int i = -reach; i + lag <= reach; i++)
            correlation += response(of, i * step) * response(of, (i + lag) * step);
        if (lag == 0)
            at_zero = correlation;
        sum += (lag == 0 ? 1.0 : 2.0) * correlation * correlation;
    }
    return sum / (at_zero * at_zero);
}

static double clamp_index(double index, size_t count)
{
    return fmin(fmax(index, 0.0), (double)(count - 1));
}

void coherent_seabed_lines(const struct rough_trace *trace, const struct tracer *tracer,
                           struct span strips, const float *reflectivity_real,
                           const float *reflectivity_imaginary, float *energy,
                           float *imaginary_part)
{
    const struct patch_view *view = &tracer->view;
    const double strip = view->row_spacing_m / trace->grid.strips_per_row;
    const double bin = view->column_spacing_m / trace->grid.bins_per_pixel;
    const int bin_reach = pulse_reach_bins(view, &tracer->response, trace->grid.bins_per_pixel);
    const int strip_reach = (int)ceil(24.0 * tracer->response.resolution_m / strip);
    const double gain = energy_gain(range_response, &tracer->response, bin, bin_reach) *
                        energy_gain(along_track_response, &tracer->response, strip, strip_reach);
    const double scale = 1.0 / sqrt(gain);
    for (int32_t s = 0; s < strips.count; s++) {
        const double row =
            clamp_index(floor((double)(strips.first + s) / trace->grid.strips_per_row), view->rows);
        const size_t line = (size_t)row * view->columns;
        for (int32_t b = 0; b < trace->grid.bins.count; b++) {
            const double column = clamp_index(
                (double)(trace->grid.bins.first + b) / trace->grid.bins_per_pixel, view->columns);
            const size_t left = (size_t)column;
            const size_t right = left + 1 < view->columns ? left + 1 : left;
            const double part = column - (double)left;
            const size_t at = (size_t)s * (size_t)trace->grid.bins.count + (size_t)b;
            const double amplitude = scale * sqrt(energy[at]);
            energy[at] = (float)(amplitude * ((1.0 - part) * reflectivity_real[line + left] +
                                              part * reflectivity_real[line + right]));
            imaginary_part[at] =
                (float)(amplitude * ((1.0 - part) * reflectivity_imaginary[line + left] +
                                     part * reflectivity_imaginary[line + right]));
        }
    }
}
