#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/memory.h"
#include "inject/echoes.h"

/* One direction of the fine grid. A pixel's value is spread over its cells, and the image takes the
 * response's value at each cell's distance. */
struct direction {
    struct complex_number (*response)(const struct point_response *, double);
    const struct point_response *of;
    double pixel_m;
    int per_pixel;  /* cells in a pixel */
    int reach;      /* reach of the response, pixels */
    bool is_linear; /* cells interpolate between pixels (columns), or copy their own pixel (rows) */
};

/* Returns the distance of a cell from the formed pixel, m: see struct line_grid. */
static double cell_distance(const struct direction *d, int cell)
{
    const double shift = d->is_linear ? 0.0 : 0.5 / d->per_pixel - 0.5;
    return ((double)cell / d->per_pixel + shift) * d->pixel_m;
}

/* Returns the weight in the formed pixel of the measured pixel `lag` pixels away. */
static struct complex_number pixel_weight(const struct direction *d, int lag)
{
    const int first = d->is_linear ? (lag - 1) * d->per_pixel : lag * d->per_pixel;
    const int count = d->is_linear ? 2 * d->per_pixel : d->per_pixel;
    struct complex_number sum = {0.0, 0.0};
    for (int cell = first; cell < first + count; cell++) {
        const double share =
            d->is_linear ? 1.0 - fabs((double)cell / d->per_pixel - (double)lag) : 1.0;
        const struct complex_number value = d->response(d->of, cell_distance(d, cell));
        sum.real_part += share * value.real_part;
        sum.imaginary_part += share * value.imaginary_part;
    }
    return sum;
}

/* Adds conj(a) b. */
static void add_product(struct complex_number *sum, struct complex_number a,
                        struct complex_number b)
{
    sum->real_part += a.real_part * b.real_part + a.imaginary_part * b.imaginary_part;
    sum->imaginary_part += a.real_part * b.imaginary_part - a.imaginary_part * b.real_part;
}

/* Returns the sum over the cells of conj(response) times the response `lag` pixels away. */
static struct complex_number autocorrelation(const struct direction *d, int lag)
{
    struct complex_number sum = {0.0, 0.0};
    for (int cell = -d->reach * d->per_pixel; cell <= d->reach * d->per_pixel; cell++)
        add_product(&sum, d->response(d->of, cell_distance(d, cell)),
                    d->response(d->of, cell_distance(d, cell + lag * d->per_pixel)));
    return sum;
}

/* Returns the mean energy of the formed image over that of speckle of the same energies. Measured
 * pixels passed the sonar's response once already, so its autocorrelation correlates them. */
static double energy_gain(const struct direction *d)
{
    const double white = autocorrelation(d, 0).real_part;
    double sum = 0.0;
    for (int lag = 0; lag <= 2 * d->reach; lag++) {
        const struct complex_number correlation = autocorrelation(d, lag);
        struct complex_number pairs = {0.0, 0.0};
        for (int i = -d->reach; i + lag <= d->reach; i++)
            add_product(&pairs, pixel_weight(d, i), pixel_weight(d, i + lag));
        sum += (lag == 0 ? 1.0 : 2.0) *
               (pairs.real_part * correlation.real_part +
                pairs.imaginary_part * correlation.imaginary_part) /
               white;
    }
    return sum / white;
}

static struct complex_number response_along_track(const struct point_response *response,
                                                  double distance_m)
{
    const struct complex_number w = {along_track_response(response, distance_m), 0.0};
    return w;
}

static double scale_of(const struct line_grid *grid, const struct tracer *tracer)
{
    const struct patch_view *view = &tracer->view;
    const struct direction columns = {
        range_response_complex,
        &tracer->response,
        view->column_spacing_m,
        (int)grid->bins_per_pixel,
        pulse_reach_bins(view, &tracer->response, 1),
        true,
    };
    const struct direction rows = {
        response_along_track,
        &tracer->response,
        view->row_spacing_m,
        (int)grid->strips_per_row,
        (int)ceil(24.0 * tracer->response.resolution_m / view->row_spacing_m),
        false,
    };
    return 1.0 / sqrt(energy_gain(&columns) * energy_gain(&rows));
}

#define EVEN_PIXELS 8 /* pixels to each side over which the energy of seabed in view is even */

/* Sums of a strip's energies from its first bin on: count + 1 each. */
struct strip_sums {
    double *all, *in_view;
    size_t count, bins_per_pixel;
};

static void sum_strip(struct strip_sums *sums, const float *all, const float *in_view)
{
    for (size_t bin = 0; bin < sums->count; bin++) {
        sums->all[bin + 1] = sums->all[bin] + (double)all[bin];
        sums->in_view[bin + 1] = sums->in_view[bin] + (double)in_view[bin];
    }
}

/* Returns the energy in view of a bin: the share in view of rays within half a pixel, of the mean
 * energy of the seabed around. A bin has few rays, and the root of their energy alone would be too
 * small in the mean. */
static double energy_in_view(const struct strip_sums *sums, size_t bin)
{
    const size_t reach = EVEN_PIXELS * sums->bins_per_pixel;
    const size_t low = bin > reach ? bin - reach : 0;
    const size_t high = bin + reach + 1 < sums->count ? bin + reach + 1 : sums->count;
    const size_t half = sums->bins_per_pixel / 2;
    const size_t near = bin > half ? bin - half : 0;
    const size_t far = bin + half + 1 < sums->count ? bin + half + 1 : sums->count;
    const double around = sums->all[high] - sums->all[low];
    const double here = sums->all[far] - sums->all[near];
    const double share = here > 0.0     ? (sums->in_view[far] - sums->in_view[near]) / here
                         : around > 0.0 ? (sums->in_view[high] - sums->in_view[low]) / around
                                        : 0.0;
    return share * around / (double)(high - low);
}

static double clamp_index(double index, size_t count)
{
    return fmin(fmax(index, 0.0), (double)(count - 1));
}

float *coherent_seabed_lines(const struct tracer *tracer, const struct echo_request *request,
                             const struct impulse_lines *lines)
{
    const struct patch_view *view = &tracer->view;
    const struct line_grid *grid = &lines->grid;
    const size_t width = (size_t)grid->bins.count;
    const size_t cells = (size_t)lines->strips.count * width;
    const double scale = scale_of(grid, tracer);
    float *parts = allocate_array(2 * cells, sizeof *parts);
    double *memory = allocate_array(2 * (width + 1), sizeof *memory);
    struct strip_sums sums = {memory, memory ? memory + width + 1 : NULL, width,
                              grid->bins_per_pixel};
    if (!parts || !memory) {
        free(parts);
        free(memory);
        return NULL;
    }
    for (size_t at = 0; at < cells; at++) {
        if (at % width == 0)
            sum_strip(&sums, lines->plane[0] + at, lines->plane[1] + at);
        const int32_t strip = lines->strips.first + (int32_t)(at / width);
        const double row = clamp_index(floor((double)strip / grid->strips_per_row), view->rows);
        const double column =
            clamp_index((double)(grid->bins.first + (int32_t)(at % width)) / grid->bins_per_pixel,
                        view->columns);
        const size_t left = (size_t)row * view->columns + (size_t)column;
        const size_t right = (size_t)column + 1 < view->columns ? left + 1 : left;
        const double part = column - floor(column);
        const double amplitude = scale * sqrt(energy_in_view(&sums, at % width));
        parts[at] = (float)(amplitude * ((1.0 - part) * request->reflectivity_real[left] +
                                         part * request->reflectivity_real[right]));
        parts[cells + at] =
            (float)(amplitude * ((1.0 - part) * request->reflectivity_imaginary[left] +
                                 part * request->reflectivity_imaginary[right]));
    }
    free(memory);
    return parts;
}
