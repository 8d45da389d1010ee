#include "scene/motion_response.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/fourier.h"
#include "base/memory.h"
#include "scene/aperture_motion.h"

#define PI          3.14159265358979323846
#define ASPECTS_MAX ((size_t)1 << 18)
#define SWAYS_MAX   ((size_t)1 << 21)
#define SPREAD_ROWS 9
#define TAP_SHARE   0.001 /* of |W|^2 that taps leave out */

/* The steepest aspect that is integrated, as the sine of its angle. */
static double steepest(const struct motion_response *motion)
{
    return fmin(0.999, motion->view->wavelength_m / (4.0 * motion->response->resolution_m));
}

/* As many as separate all distances four times over, and as follow the sway. */
static size_t aspects_needed(const struct motion_response *motion)
{
    const double wavelength = motion->view->wavelength_m;
    const double swing =
        motion->response->motion_range_m * wavelength /
        (2.0 * motion->strip_m * aperture_motion_step(motion->response->motion) * 100.0);
    size_t count = 64;
    while (count < ASPECTS_MAX &&
           ((double)count < 8.0 * (motion->reach + 1.0) || (double)count < 8.0 * swing))
        count *= 2;
    return count;
}

static sonject_status sample_sway(struct motion_response *motion, struct report *report)
{
    const struct patch_view *view = motion->view;
    const double sine = steepest(motion);
    const double half_aperture =
        motion->response->motion_range_m * sine / sqrt(1.0 - sine * sine) + view->row_spacing_m;
    const double length = (double)view->rows * view->row_spacing_m + 2.0 * half_aperture;
    const double step = fmin(aperture_motion_step(motion->response->motion), view->row_spacing_m);
    const double wanted = ceil(length / step) + 2.0;
    motion->sways = wanted < (double)SWAYS_MAX ? (size_t)wanted : SWAYS_MAX;
    motion->sway_step_m = length / (double)(motion->sways - 2);
    motion->first_sway_m = view_x_of_row(view, 0.0) - half_aperture;
    motion->sway_m = allocate_array(motion->sways, sizeof *motion->sway_m);
    if (!motion->sway_m)
        return report_out_of_memory(report, "motion");
    const double side = view->is_mirrored ? -1.0 : 1.0; /* of the image's along-track axis */
    aperture_motion_sway(motion->response->motion, side * motion->first_sway_m,
                         side * motion->sway_step_m, motion->sways, motion->sway_m);
    return SONJECT_OK;
}

sonject_status motion_response_begin(struct motion_response *motion, struct report *report,
                                     const struct point_response *response,
                                     const struct patch_view *view, double strip_m, double offset_m,
                                     int reach)
{
    memset(motion, 0, sizeof *motion);
    motion->response = response;
    motion->view = view;
    motion->strip_m = strip_m;
    motion->offset_m = offset_m;
    motion->reach = reach;
    motion->aspects = aspects_needed(motion);
    motion->root_real = allocate_array(motion->aspects / 2, sizeof(double));
    motion->root_imaginary = allocate_array(motion->aspects / 2, sizeof(double));
    motion->real_part = allocate_array(motion->aspects, sizeof(double));
    motion->imaginary_part = allocate_array(motion->aspects, sizeof(double));
    sonject_status status =
        motion->root_real && motion->root_imaginary && motion->real_part && motion->imaginary_part
            ? sample_sway(motion, report)
            : report_out_of_memory(report, "motion");
    if (status == SONJECT_OK)
        fourier_roots(motion->root_real, motion->root_imaginary, motion->aspects);
    else
        motion_response_end(motion);
    return status;
}

void motion_response_end(struct motion_response *motion)
{
    free(motion->root_real);
    free(motion->root_imaginary);
    free(motion->real_part);
    free(motion->imaginary_part);
    free(motion->sway_m);
    memset(motion, 0, sizeof *motion);
}

static double sway_at(const struct motion_response *motion, double x)
{
    const double last = (double)motion->sways - 2.0;
    const double at = fmin(fmax((x - motion->first_sway_m) / motion->sway_step_m, 0.0), last);
    const size_t i = (size_t)at;
    const double share = at - (double)i;
    return motion->sway_m[i] + share * (motion->sway_m[i + 1] - motion->sway_m[i]);
}

/* The window's weight at v = -1/2...1/2, over its mean. */
static double weight_at(const struct point_response *response, double v)
{
    double sum = 1.0;
    for (int m = 1; m <= response->terms; m++)
        sum += 2.0 * response->weights[m - 1] * cos(2.0 * PI * m * v);
    return sum;
}

/* How much of an aspect's cell lies within the band; cells are 1 wide, the band 2 half_band. */
static double share_in_band(double aspect, double half_band)
{
    return fmax(0.0, fmin(1.0, half_band + 0.5 - fabs(aspect)));
}

void motion_response_row(struct motion_response *motion, double row, double *real_part,
                         double *imaginary_part)
{
    const struct point_response *response = motion->response;
    const double wavelength = motion->view->wavelength_m;
    const double count = (double)motion->aspects;
    const double step = wavelength / (2.0 * count * motion->strip_m); /* of the sine */
    const double half_band = count * motion->strip_m / (2.0 * response->resolution_m);
    const double x = view_x_of_row(motion->view, row);
    const int last = (int)ceil(fmin(half_band, 0.999 / step));
    memset(motion->real_part, 0, motion->aspects * sizeof(double));
    memset(motion->imaginary_part, 0, motion->aspects * sizeof(double));
    for (int m = -last; m <= last; m++) {
        const double sine = fmin(fmax(m * step, -0.999), 0.999);
        const double v = fmin(fmax(0.5 * m / half_band, -0.5), 0.5);
        const double weight =
            weight_at(response, v) * share_in_band(m, half_band) / (2.0 * half_band);
        const double place = x + response->motion_range_m * sine / sqrt(1.0 - sine * sine);
        const double error = response->motion_phase_per_m * sway_at(motion, place);
        const double shift = 2.0 * PI * m * motion->offset_m / (count * motion->strip_m);
        const size_t at = (size_t)(m + (int)motion->aspects) % motion->aspects;
        /* the straight track's response is added as it is known, without the grid's own error */
        motion->real_part[at] += weight * (cos(shift + error) - cos(shift));
        motion->imaginary_part[at] += weight * (sin(shift + error) - sin(shift));
    }
    fourier_transform(motion->real_part, motion->imaginary_part, motion->aspects, motion->root_real,
                      motion->root_imaginary);
    for (int j = -motion->reach; j <= motion->reach; j++) {
        const size_t at = (size_t)(j + (int)motion->aspects) % motion->aspects;
        const double distance = j * motion->strip_m + motion->offset_m;
        real_part[j + motion->reach] =
            motion->real_part[at] + along_track_response(response, distance);
        imaginary_part[j + motion->reach] = motion->imaginary_part[at];
    }
}

/* Distances within which all but `share` of a row's energy lies. */
static double reach_of_row(const struct motion_response *motion, const double *real_part,
                           const double *imaginary_part, double share)
{
    const double total = along_track_energy_width(motion->response) / motion->strip_m;
    double inside = 0.0;
    for (int j = 0; j <= motion->reach; j++)
        for (int side = -1; side <= (j > 0 ? 1 : -1); side += 2) {
            const int at = motion->reach + side * j;
            inside += real_part[at] * real_part[at] + imaginary_part[at] * imaginary_part[at];
            if (inside >= (1.0 - share) * total)
                return j * motion->strip_m;
        }
    return motion->reach * motion->strip_m;
}

sonject_status motion_response_spread(struct report *report, const struct point_response *response,
                                      const struct patch_view *view, double *spread_m)
{
    static const double shares[2] = {MARGIN_ENERGY_SHARE, TAP_SHARE};
    struct motion_response motion;
    const int reach = 2048;
    *spread_m = 0.0;
    sonject_status status =
        motion_response_begin(&motion, report, response, view, response->resolution_m, 0.0, reach);
    if (status != SONJECT_OK)
        return status;
    double *real_part = allocate_array(2 * (size_t)reach + 1, sizeof *real_part);
    double *imaginary_part = allocate_array(2 * (size_t)reach + 1, sizeof *imaginary_part);
    if (!real_part || !imaginary_part)
        status = report_out_of_memory(report, "motion");
    for (int i = 0; status == SONJECT_OK && i < SPREAD_ROWS; i++) {
        motion_response_row(&motion, (double)(view->rows - 1) * i / (SPREAD_ROWS - 1), real_part,
                            imaginary_part);
        for (int s = 0; s < 2; s++)
            *spread_m =
                fmax(*spread_m, reach_of_row(&motion, real_part, imaginary_part, shares[s]) -
                                    along_track_energy_reach(response, shares[s]));
    }
    free(real_part);
    free(imaginary_part);
    motion_response_end(&motion);
    return status;
}
