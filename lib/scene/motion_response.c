#include "scene/motion_response.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/aperture_motion.h"

#define PI          3.14159265358979323846
#define ASPECTS_MAX ((size_t)1 << 20)
#define SWAYS_MAX   ((size_t)1 << 21)
#define PINGS_MAX   ((size_t)1 << 22)
#define HEARD_STEPS 32 /* steps of an integral over the aspects */

#define SPREAD_ROWS  9
#define SPREAD_REACH 2048 /* resolutions to each side within which a spread is measured */

/* Shares of |W|^2 beyond a spread: at the patch's edges, beyond margins, beyond taps. */
static const double spread_shares[MOTION_SHARES] = {0.04, MARGIN_ENERGY_SHARE, 0.001};

/* Fills in exp(+2 pi i m / count) for m = 0...count / 2 - 1. */
static void fourier_roots(double *root_real, double *root_imaginary, size_t count)
{
    for (size_t m = 0; m < count / 2; m++) {
        root_real[m] = cos(2.0 * PI * (double)m / (double)count);
        root_imaginary[m] = sin(2.0 * PI * (double)m / (double)count);
    }
}

static void swap(double *values, size_t a, size_t b)
{
    const double value = values[a];
    values[a] = values[b];
    values[b] = value;
}

/* Moves each element to the index whose bits are those of its own index, reversed. */
static void reverse_bits(double *real_part, double *imaginary_part, size_t count)
{
    size_t reversed = 0;
    for (size_t i = 1; i < count; i++) {
        size_t bit = count / 2;
        for (; reversed & bit; bit /= 2)
            reversed ^= bit;
        reversed ^= bit;
        if (i < reversed) {
            swap(real_part, i, reversed);
            swap(imaginary_part, i, reversed);
        }
    }
}

/* Replaces a sequence by sum over m of a[m] exp(+2 pi i m n / count), in place. count: a power of
 * two. roots: as fourier_roots makes them. */
static void fourier_transform(double *real_part, double *imaginary_part, size_t count,
                              const double *root_real, const double *root_imaginary)
{
    reverse_bits(real_part, imaginary_part, count);
    for (size_t half = 1; half < count; half *= 2) {
        const size_t stride = count / (2 * half); /* stride in the roots */
        for (size_t start = 0; start < count; start += 2 * half)
            for (size_t i = 0; i < half; i++) {
                const size_t low = start + i;
                const size_t high = low + half;
                const double c = root_real[i * stride];
                const double s = root_imaginary[i * stride];
                const double a = real_part[high] * c - imaginary_part[high] * s;
                const double b = real_part[high] * s + imaginary_part[high] * c;
                real_part[high] = real_part[low] - a;
                imaginary_part[high] = imaginary_part[low] - b;
                real_part[low] += a;
                imaginary_part[low] += b;
            }
    }
}

/* Returns the shortest length over which the phase error changes, m. */
static double shortest_scale(const struct motion_response *motion)
{
    const double of_sway = 100.0 * aperture_motion_step(motion->response->motion);
    return motion->pings > 0 ? fmin(of_sway, 0.5 * motion->advance_m) : of_sway;
}

/* Chooses enough aspects to separate all distances four times over and to follow the motion. */
static sonject_status count_aspects(struct motion_response *motion, struct report *report)
{
    const double swing = motion->response->motion_range_m * motion->view->wavelength_m /
                         (2.0 * motion->strip_m * shortest_scale(motion));
    const double needed = 8.0 * fmax(motion->reach + 1.0, swing);
    if (!(needed <= (double)ASPECTS_MAX))
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "sonar.motion: at %.4g m it changes within %.3g m, which more than %zu aspects would "
            "have to follow: increase its wavelengths or correlation lengths",
            motion->response->motion_range_m, shortest_scale(motion), ASPECTS_MAX);
    motion->aspects = 64;
    while ((double)motion->aspects < needed)
        motion->aspects *= 2;
    return SONJECT_OK;
}

/* Returns the sign of the image's along-track axis in the view. */
static double side_of(const struct motion_response *motion)
{
    return motion->view->is_mirrored ? -1.0 : 1.0;
}

static sonject_status sample_sway(struct motion_response *motion, struct report *report)
{
    const struct patch_view *view = motion->view;
    const double side = side_of(motion);
    /* the sine of the steepest aspect that is integrated */
    const double sine = fmin(0.999, view->wavelength_m / (4.0 * motion->response->resolution_m));
    const double half_aperture =
        motion->response->motion_range_m * sine / sqrt(1.0 - sine * sine) + view->row_spacing_m;
    motion->first_m = view_x_of_row(view, 0.0) - half_aperture;
    motion->length_m = (double)view->rows * view->row_spacing_m + 2.0 * half_aperture;
    const double step = aperture_motion_step(motion->response->motion);
    const double rows = motion->length_m / view->row_spacing_m;
    double steps = fmax(1.0, ceil(motion->length_m / step));
    if (steps > (double)SWAYS_MAX - 2.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "sonar.motion: the patch's aperture of %.4g m holds more than %zu "
                              "steps of the sway: increase its wavelengths or correlation lengths",
                              motion->length_m, SWAYS_MAX);
    if (steps < rows) /* the steps follow the image's rows, unless these are too many */
        steps = fmin(ceil(rows), (double)SWAYS_MAX - 2.0);
    motion->sways = (size_t)steps + 2;
    motion->sway_step_m = motion->length_m / (double)(motion->sways - 2);
    motion->sway_m = allocate_array(motion->sways, sizeof *motion->sway_m);
    CHECK_MEMORY(report, motion->sway_m, "motion");
    aperture_motion_sway(motion->response->motion, side * motion->first_m,
                         side * motion->sway_step_m, motion->sways, motion->sway_m);
    return SONJECT_OK;
}

static sonject_status sample_yaw(struct motion_response *motion, struct report *report)
{
    const double side = side_of(motion);
    if (!aperture_motion_has_yaw(motion->response->motion))
        return SONJECT_OK;
    motion->advance_m = motion->response->motion->params.yaw_advance_m;
    motion->first_ping = floor(motion->first_m / motion->advance_m);
    const double pings = ceil(motion->length_m / motion->advance_m) + 2.0;
    if (pings > (double)PINGS_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "sonar.motion.yaw: the patch's aperture holds more than %zu pings: "
                              "give a longer advance",
                              PINGS_MAX);
    motion->pings = (size_t)pings;
    motion->yaw_rad = allocate_array(motion->pings, sizeof *motion->yaw_rad);
    CHECK_MEMORY(report, motion->yaw_rad, "motion");
    aperture_motion_yaw(motion->response->motion, side * motion->first_ping * motion->advance_m,
                        side * motion->advance_m, motion->pings, motion->yaw_rad);
    return SONJECT_OK;
}

static sonject_status allocate_aspects(struct motion_response *motion, struct report *report)
{
    CHECK(count_aspects(motion, report));
    motion->root_real = allocate_array(motion->aspects / 2, sizeof(double));
    motion->root_imaginary = allocate_array(motion->aspects / 2, sizeof(double));
    motion->real_part = allocate_array(motion->aspects, sizeof(double));
    motion->imaginary_part = allocate_array(motion->aspects, sizeof(double));
    CHECK_MEMORY(report,
                 motion->root_real && motion->root_imaginary && motion->real_part &&
                     motion->imaginary_part,
                 "motion");
    fourier_roots(motion->root_real, motion->root_imaginary, motion->aspects);
    return SONJECT_OK;
}

/* Returns the window's weight at v = -1/2...1/2, over its mean. */
static double weight_at(const struct point_response *response, double v)
{
    double sum = 1.0;
    for (int m = 1; m <= response->terms; m++)
        sum += 2.0 * response->weights[m - 1] * cos(2.0 * PI * m * v);
    return sum;
}

/* Returns an element's two-way beam, length 2 delta, at a sine of v wavelengths over 2 delta. */
static double two_way_beam(double v)
{
    const double one_way = v == 0.0 ? 1.0 : sin(PI * v) / (PI * v);
    return one_way * one_way;
}

/* A pixel's aspects see a point beside the pixel at other angles. */
static sonject_status find_heard(struct motion_response *motion, struct report *report)
{
    const double range = motion->response->motion_range_m;
    const double length = 2.0 * motion->response->resolution_m / motion->view->wavelength_m;
    motion->heard = allocate_array(2 * (size_t)motion->reach + 1, sizeof *motion->heard);
    CHECK_MEMORY(report, motion->heard, "motion");
    for (int j = -motion->reach; j <= motion->reach; j++) {
        const double distance = j * motion->strip_m + motion->offset_m;
        const double aside = length * distance / hypot(range, distance);
        double sum = 0.0;
        for (int i = 0; i < HEARD_STEPS; i++) {
            const double v = (i + 0.5) / HEARD_STEPS - 0.5;
            sum += weight_at(motion->response, v) * two_way_beam(v + aside) / two_way_beam(v);
        }
        motion->heard[j + motion->reach] = sum / HEARD_STEPS;
    }
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
    sonject_status status = sample_sway(motion, report);
    THEN(status, sample_yaw(motion, report));
    THEN(status, find_heard(motion, report));
    THEN(status, allocate_aspects(motion, report));
    if (status != SONJECT_OK)
        motion_response_end(motion);
    return status;
}

void motion_response_end(struct motion_response *motion)
{
    free(motion->root_real);
    free(motion->root_imaginary);
    free(motion->real_part);
    free(motion->imaginary_part);
    free(motion->heard);
    free(motion->sway_m);
    free(motion->yaw_rad);
    memset(motion, 0, sizeof *motion);
}

static double sway_at(const struct motion_response *motion, double x)
{
    const double last = (double)motion->sways - 2.0;
    const double at = fmin(fmax((x - motion->first_m) / motion->sway_step_m, 0.0), last);
    const size_t i = (size_t)at;
    const double share = at - (double)i;
    return motion->sway_m[i] + share * (motion->sway_m[i + 1] - motion->sway_m[i]);
}

/* Returns the number of the ping one of whose phase centres is at x. */
static double ping_at(const struct motion_response *motion, double x)
{
    return floor(x / motion->advance_m + 0.5);
}

/* Returns the sway at x of a ping's phase centres. Yaw towards the imaged side moves those ahead of
 * the ping's middle towards that side. */
static double sway_by_yaw(const struct motion_response *motion, double ping, double x)
{
    const double last = (double)motion->pings - 1.0;
    const size_t i = (size_t)fmin(fmax(ping - motion->first_ping, 0.0), last);
    return side_of(motion) * motion->yaw_rad[i] * (x - ping * motion->advance_m);
}

/* Returns an aspect cell's share within the band. Cells are 1 wide, the band 2 half_band. */
static double share_in_band(double aspect, double half_band)
{
    return fmax(0.0, fmin(1.0, half_band + 0.5 - fabs(aspect)));
}

/* A cell of aspects, and its place on the track. */
struct aspect_cell {
    size_t at;    /* index in the transform */
    double place; /* along-track position of its middle, m */
    double half;  /* half its width along-track, m */
    double per_m; /* phase error, rad per m of sway */
    double shift; /* phase of the offset, rad */
    double weight;
};

/* Adds a share of the cell, less its value on a straight track. The straight response is known
 * exactly and is added without the grid's error. */
static void add_aspect(struct motion_response *motion, const struct aspect_cell *cell, double share,
                       double sway)
{
    const double phase = cell->shift + cell->per_m * sway;
    motion->real_part[cell->at] += share * cell->weight * (cos(phase) - cos(cell->shift));
    motion->imaginary_part[cell->at] += share * cell->weight * (sin(phase) - sin(cell->shift));
}

/* The error jumps from one ping to the next. A cell with two pings takes its share of each. */
static void add_pings(struct motion_response *motion, const struct aspect_cell *cell, double sway)
{
    const double ping = ping_at(motion, cell->place + cell->half);
    const double begin = (ping - 0.5) * motion->advance_m;
    const double share = fmin((cell->place + cell->half - begin) / (2.0 * cell->half), 1.0);
    add_aspect(motion, cell, share, sway + sway_by_yaw(motion, ping, cell->place));
    if (share < 1.0)
        add_aspect(motion, cell, 1.0 - share, sway + sway_by_yaw(motion, ping - 1.0, cell->place));
}

static void fill_aspects(struct motion_response *motion, double x)
{
    const struct point_response *response = motion->response;
    const double count = (double)motion->aspects;
    const double step = motion->view->wavelength_m / (2.0 * count * motion->strip_m); /* sine */
    const double half_band = count * motion->strip_m / (2.0 * response->resolution_m);
    const int last = (int)ceil(fmin(half_band, 0.999 / step));
    memset(motion->real_part, 0, motion->aspects * sizeof(double));
    memset(motion->imaginary_part, 0, motion->aspects * sizeof(double));
    for (int m = -last; m <= last; m++) {
        const double sine = fmin(fmax(m * step, -0.999), 0.999);
        const double cosine = sqrt(1.0 - sine * sine);
        const double v = fmin(fmax(0.5 * m / half_band, -0.5), 0.5);
        const struct aspect_cell cell = {
            .at = (size_t)(m + (int)motion->aspects) % motion->aspects,
            .place = x + response->motion_range_m * sine / cosine,
            .half = 0.5 * response->motion_range_m * step / (cosine * cosine * cosine),
            .per_m = response->motion_phase_per_m * cosine,
            .shift = 2.0 * PI * m * motion->offset_m / (count * motion->strip_m),
            .weight = weight_at(response, v) * share_in_band(m, half_band) / (2.0 * half_band)};
        const double sway = sway_at(motion, cell.place);
        if (motion->pings > 0)
            add_pings(motion, &cell, sway);
        else
            add_aspect(motion, &cell, 1.0, sway);
    }
}

/* Finds a row's response at the distances: the error's effect plus the straight response. */
static void find_row(struct motion_response *motion, double row, bool is_all_around,
                     double *real_part, double *imaginary_part)
{
    fill_aspects(motion, view_x_of_row(motion->view, row));
    fourier_transform(motion->real_part, motion->imaginary_part, motion->aspects, motion->root_real,
                      motion->root_imaginary);
    for (int j = -motion->reach; j <= motion->reach; j++) {
        const size_t at = (size_t)(j + (int)motion->aspects) % motion->aspects;
        const int i = j + motion->reach;
        const double heard = is_all_around ? 1.0 : motion->heard[i];
        real_part[i] =
            motion->real_part[at] * heard +
            along_track_response(motion->response, j * motion->strip_m + motion->offset_m);
        imaginary_part[i] = motion->imaginary_part[at] * heard;
    }
}

void motion_response_row_all_around(struct motion_response *motion, double row, double *real_part,
                                    double *imaginary_part)
{
    find_row(motion, row, true, real_part, imaginary_part);
}

void motion_response_row(struct motion_response *motion, double row, double *real_part,
                         double *imaginary_part)
{
    find_row(motion, row, false, real_part, imaginary_part);
}

/* Returns the distance that all but `share` of a row's energy lies within, at most the reach. */
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

static sonject_status spread_row(const struct motion_response *motion, struct report *report,
                                 const double *real_part, const double *imaginary_part,
                                 double spread_m[MOTION_SHARES])
{
    for (int s = 0; s < MOTION_SHARES; s++) {
        const double reach = reach_of_row(motion, real_part, imaginary_part, spread_shares[s]);
        if (spread_shares[s] >= MARGIN_ENERGY_SHARE && reach >= motion->reach * motion->strip_m)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "sonar.motion spreads echoes farther than %.4g m along-track, %d "
                                  "times the resolution: reduce it",
                                  reach, motion->reach);
        spread_m[s] =
            fmax(spread_m[s], reach - along_track_energy_reach(motion->response, spread_shares[s]));
    }
    return SONJECT_OK;
}

/* Returns the share of a row's energy that comes from beyond the beam of the elements. */
static double lost_by_row(const struct motion_response *motion, const double *real_part,
                          const double *imaginary_part)
{
    double lost = 0.0;
    for (int i = 0; i <= 2 * motion->reach; i++) {
        const double straight = along_track_response(
            motion->response, (i - motion->reach) * motion->strip_m + motion->offset_m);
        const double a = straight + motion->heard[i] * (real_part[i] - straight);
        const double b = motion->heard[i] * imaginary_part[i];
        lost += real_part[i] * real_part[i] + imaginary_part[i] * imaginary_part[i] - a * a - b * b;
    }
    return lost * motion->strip_m / along_track_energy_width(motion->response);
}

sonject_status motion_response_spread(struct report *report, struct point_response *response,
                                      const struct patch_view *view)
{
    struct motion_response motion;
    memset(response->motion_spread_m, 0, sizeof response->motion_spread_m);
    CHECK(motion_response_begin(&motion, report, response, view, response->resolution_m, 0.0,
                                SPREAD_REACH));
    double *real_part = allocate_array(2 * (2 * (size_t)SPREAD_REACH + 1), sizeof *real_part);
    double *imaginary_part = real_part ? real_part + 2 * SPREAD_REACH + 1 : NULL;
    sonject_status status = real_part ? SONJECT_OK : report_out_of_memory(report, "motion");
    response->motion_energy_share = 1.0;
    for (int i = 0; status == SONJECT_OK && i < SPREAD_ROWS; i++) {
        motion_response_row_all_around(&motion, (double)(view->rows - 1) * i / (SPREAD_ROWS - 1),
                                       real_part, imaginary_part);
        status = spread_row(&motion, report, real_part, imaginary_part, response->motion_spread_m);
        response->motion_energy_share -=
            lost_by_row(&motion, real_part, imaginary_part) / SPREAD_ROWS;
    }
    free(real_part);
    motion_response_end(&motion);
    return status;
}

double motion_spread(const struct point_response *response, double share)
{
    int s = MOTION_SHARES - 1;
    while (s > 0 && spread_shares[s - 1] <= share)
        s--;
    return response->motion_spread_m[s];
}
