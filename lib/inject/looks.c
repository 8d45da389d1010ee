/* The statistics of a measured magnitude image that targets in it take on: widths of the response,
 * looks and saturation. Also coloured noise, and pixels of several looks, for images that were
 * averaged before they were stored. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "form/form.h"
#include "inject/compose.h"
#include "scene/point_response.h"

#define PI            3.14159265358979323846
#define REACH         160  /* pixels around the objects; ten blocks across */
#define ASPECTS       256  /* points of the numerical integral over aspects */
#define CLEARLY       4.0  /* standard errors that make a difference clear */
#define DIFFERENCE    0.05 /* correlations closer than this count as equal */
#define LOOKS_CLEARLY 1.15
#define LOOKS_MOST    64.0
#define WIDEST        8.0  /* widest response, pixels */
#define FAINTEST      0.02 /* least correlation; a response much narrower than a pixel has none */
#define HALVINGS      60
#define CHUNK         256 /* strips drawn at a time */

/* Transforms the aspects' energy (Wiener and Khinchin). */
double along_track_speckle_correlation(const struct point_response *response, double distance_m)
{
    double sum = 0.0;
    double total = 0.0;
    for (int i = 0; i < ASPECTS; i++) {
        const double aspect = (i + 0.5) / ASPECTS - 0.5;
        double amplitude = 1.0;
        for (int m = 1; m <= response->terms; m++)
            amplitude += 2.0 * response->weights[m - 1] * cos(2.0 * PI * m * aspect);
        sum += amplitude * amplitude * cos(2.0 * PI * aspect * distance_m / response->resolution_m);
        total += amplitude * amplitude;
    }
    return (sum / total) * (sum / total);
}

static double range_speckle_correlation(const struct point_response *response, double distance_m)
{
    const double x = distance_m / response->range_deviation_m;
    return exp(-0.5 * x * x);
}

static bool clearly_differs(double measured, double error, double nominal)
{
    return fabs(measured - nominal) > fmax(DIFFERENCE, CLEARLY * error);
}

/* Finds the resolution that gives neighbouring rows the measured correlation. It is at least the
 * row spacing, which gives nearly none. */
static void match_along_track(struct point_response *response, const struct speckle_axis *axis,
                              double spacing_m)
{
    struct point_response trial = *response;
    if (!clearly_differs(axis->correlation[1], axis->lag_one_error,
                         along_track_speckle_correlation(response, spacing_m)))
        return;
    double low = spacing_m;
    double high = WIDEST * spacing_m;
    for (int i = 0; i < HALVINGS; i++) {
        trial.resolution_m = 0.5 * (low + high);
        if (along_track_speckle_correlation(&trial, spacing_m) < axis->correlation[1])
            low = trial.resolution_m;
        else
            high = trial.resolution_m;
    }
    point_response_set_widths(response, trial.resolution_m, response->range_resolution_m);
}

static void match_range(struct point_response *response, const struct speckle_axis *axis,
                        double spacing_m)
{
    if (!clearly_differs(axis->correlation[1], axis->lag_one_error,
                         range_speckle_correlation(response, spacing_m)))
        return;
    const double widest = exp(-0.5 / (WIDEST * WIDEST));
    const double correlation = fmin(widest, fmax(FAINTEST, axis->correlation[1]));
    point_response_set_widths(response, response->resolution_m,
                              2.0 * sqrt(log(2.0)) * spacing_m / sqrt(-2.0 * log(correlation)));
}

/* Returns whether widths can be matched: the scene must have the plain pulse and response. */
static bool has_widths(const struct point_response *response)
{
    return response->pulse_kind == SONJECT_PULSE_GAUSSIAN && cross_range_is_plain(response);
}

/* Returns the number of pixels from REACH before low to REACH behind high, within 0...count. *first
 * gets the first of them. */
static size_t around(double low, double high, size_t count, size_t *first)
{
    const double last = (double)count;
    const double start = fmin(last, fmax(0.0, floor(low) - REACH));
    *first = (size_t)start;
    return (size_t)(fmin(last, fmax(start, ceil(high) + REACH + 1.0)) - start);
}

/* Returns the window of pixels around the objects, or all pixels if there are no objects. */
static struct window find_region(const struct tracer *tracer)
{
    const struct patch_view *view = &tracer->view;
    const bool is_all = tracer->part_count == 0;
    const double rows = (double)view->rows;
    const double columns = (double)view->columns;
    double low[2] = {is_all ? 0.0 : rows, is_all ? 0.0 : columns};
    double high[2] = {is_all ? rows : 0.0, is_all ? columns : 0.0};
    struct window region;
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const struct placement *part = &tracer->placements[i];
        const double range = ray_path_range(&view->water, part->centre[1], part->centre[2]);
        const double at[2] = {view_row_of_x(view, part->centre[0]),
                              view_column_of_range(view, range * view->range_ratio)};
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fmin(low[axis], at[axis]);
            high[axis] = fmax(high[axis], at[axis]);
        }
    }
    region.rows = around(low[0], high[0], view->rows, &region.first_row);
    region.columns = around(low[1], high[1], view->columns, &region.first_column);
    return region;
}

static sonject_status measure_around(const struct tracer *tracer, const float *pixels,
                                     bool is_complex, struct speckle_statistics *seabed)
{
    const struct window region = find_region(tracer);
    const size_t count = region.rows * region.columns;
    float *intensity = allocate_array(count, sizeof *intensity);
    CHECK_MEMORY(tracer->report, intensity, "the seabed's statistics");
    for (size_t k = 0; k < count; k++) {
        const size_t i = (region.first_row + k / region.columns) * tracer->view.columns +
                         region.first_column + k % region.columns;
        const float a = is_complex ? pixels[2 * i] : pixels[i];
        const float b = is_complex ? pixels[2 * i + 1] : 0.0f;
        intensity[k] = a * a + b * b;
    }
    const sonject_status status = measure_speckle(tracer->report, intensity, NULL, region.rows,
                                                  region.columns, region.columns, seabed);
    free(intensity);
    return status;
}

sonject_status match_image(struct tracer *tracer, const float *pixels,
                           const struct injection_input *input, struct image_match *match)
{
    const sonject_injection_params *asked = &tracer->scene->injection;
    const struct speckle_statistics *seabed = &match->seabed;
    memset(match, 0, sizeof *match);
    match->looks = 1.0;
    match->saturation = INFINITY;
    match->ceiling = input->ceiling > 0.0 ? input->ceiling : INFINITY;
    const sonject_status status = measure_around(tracer, pixels, input->is_complex, &match->seabed);
    if (status != SONJECT_OK || input->is_complex || input->is_made ||
        asked->mode != SONJECT_MODE_COMPOSITE)
        return status;
    match->looks_source = seabed->blocks > 0 ? SONJECT_SOURCE_PATCH : SONJECT_SOURCE_FALLBACK;
    if (asked->match_looks >= 1.0)
        match->looks_source = scene_key_source(tracer->scene, "injection.match.looks");
    if (asked->match_looks >= 1.0)
        match->looks = asked->match_looks;
    else if (seabed->blocks > 0 && seabed->looks > LOOKS_CLEARLY &&
             seabed->looks - 1.0 > CLEARLY * seabed->looks_error)
        match->looks = fmin(LOOKS_MOST, seabed->looks);
    if (asked->match_response == SONJECT_MATCH_IMAGE && seabed->blocks > 0 &&
        has_widths(&tracer->response)) {
        match_along_track(&tracer->response, &seabed->along_track, tracer->view.row_spacing_m);
        match_range(&tracer->response, &seabed->range, tracer->view.column_spacing_m);
    }
    if (asked->match_saturation == SONJECT_MATCH_IMAGE)
        match->saturation = find_saturation(pixels, tracer->view.rows * tracer->view.columns);
    match->ceiling = fmin(match->ceiling, match->saturation);
    return SONJECT_OK;
}

void tell_match(const struct image_match *match, const struct tracer *tracer,
                sonject_statistics *statistics)
{
    const struct point_response *response = &tracer->response;
    const double middle = view_processor_range(&tracer->view, 0.5 * (double)tracer->view.columns);
    const struct speckle_statistics *seabed = &match->seabed;
    const bool is_known = seabed->blocks > 0;
    statistics->seabed_amplitude_contrast = is_known ? seabed->amplitude_contrast : NAN;
    statistics->seabed_shape = is_known ? seabed->shape : NAN;
    statistics->seabed_looks = is_known ? seabed->looks : NAN;
    statistics->seabed_row_correlation = is_known ? seabed->along_track.correlation[1] : NAN;
    statistics->seabed_column_correlation = is_known ? seabed->range.correlation[1] : NAN;
    statistics->along_track_resolution_m = response->array_length_m > 0.0
                                               ? cross_range_energy_width(response, middle)
                                               : response->resolution_m;
    statistics->range_resolution_m = response->range_resolution_m;
    statistics->looks = match->looks;
    statistics->looks_source = match->looks_source;
    statistics->saturation_amplitude = match->saturation;
}

static int32_t limit(double value, struct span span)
{
    const double last = span.first + span.count;
    return (int32_t)(value < span.first ? span.first : value > last ? last : value);
}

/* Cuts the patch's grid to the part that the window's pixels are formed from. */
static void cut_grid(struct line_grid *grid, const struct tracer *tracer,
                     const struct window *window)
{
    const double per_row = grid->strips_per_row;
    const double per_pixel = grid->bins_per_pixel;
    const double reach =
        form_reach(&tracer->view, &tracer->response, FORM_FIELD, grid->strips_per_row) + per_row;
    const double pulse = pulse_reach_bins(&tracer->view, &tracer->response, grid->bins_per_pixel);
    const struct span strips = grid->strips;
    const struct span bins = grid->bins;
    grid->strips.first = limit((double)window->first_row * per_row - reach, strips);
    grid->strips.count =
        limit((double)(window->first_row + window->rows) * per_row + reach, strips) -
        grid->strips.first;
    grid->bins.first = limit((double)window->first_column * per_pixel - pulse, bins);
    grid->bins.count =
        limit((double)(window->first_column + window->columns - 1) * per_pixel + pulse + 1.0,
              bins) -
        grid->bins.first;
}

/* Fills the energies of cells that give the formed noise unit mean energy at every range. */
static void fill_energies(const struct line_grid *grid, const struct tracer *tracer,
                          float *energies)
{
    const struct patch_view *view = &tracer->view;
    const double cell =
        view->row_spacing_m / grid->strips_per_row * view->column_spacing_m / grid->bins_per_pixel;
    const size_t bins = (size_t)grid->bins.count;
    for (size_t bin = 0; bin < bins; bin++) {
        /* The range is half a bin at least, since a beam has no width at range 0. */
        const double range =
            fmax(view_processor_range(view, ((double)grid->bins.first + (double)bin) /
                                                grid->bins_per_pixel),
                 0.5 * view->column_spacing_m / grid->bins_per_pixel);
        energies[bin] = (float)(cell / (cross_range_energy_width(&tracer->response, range) *
                                        range_energy_width(&tracer->response)));
    }
    for (size_t i = bins; i < CHUNK * bins; i++)
        energies[i] = energies[i - bins];
}

static sonject_status draw_noise(struct form_lines *lines, const struct tracer *tracer,
                                 uint32_t stream)
{
    const struct line_grid *grid = &lines->grid;
    float *energies = allocate_array((size_t)CHUNK * (size_t)grid->bins.count, sizeof *energies);
    CHECK_MEMORY(tracer->report, energies, "noise");
    fill_energies(grid, tracer, energies);
    sonject_status status = SONJECT_OK;
    for (int32_t done = 0; status == SONJECT_OK && done < grid->strips.count; done += CHUNK) {
        const int32_t left = grid->strips.count - done;
        status =
            form_lines_add_speckle(lines, grid->strips.first + done, left < CHUNK ? left : CHUNK,
                                   energies, tracer->scene->injection.seed, stream);
    }
    free(energies);
    return status;
}

sonject_status coloured_noise(struct tracer *tracer, uint32_t stream, const struct window *window,
                              float *real_part, float *imaginary_part)
{
    struct line_grid grid;
    struct form_lines lines;
    struct formed formed = {.planes = NULL};
    if (window->rows == 0 || window->columns == 0)
        return SONJECT_OK;
    line_grid_for_patch(&grid, &tracer->view, &tracer->response);
    cut_grid(&grid, tracer, window);
    CHECK(form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view, &tracer->response,
                           FORM_FIELD, &grid));
    sonject_status status = draw_noise(&lines, tracer, stream);
    THEN(status, form_end(&lines, &formed));
    for (size_t k = 0; status == SONJECT_OK && k < window->rows; k++) {
        const size_t to = (window->first_row + k) * tracer->view.columns + window->first_column;
        const size_t from = (window->first_row + k - formed.at.first_row) * formed.at.columns +
                            window->first_column - formed.at.first_column;
        const size_t bytes = window->columns * sizeof(float);
        memcpy(real_part + to, formed.planes + from, bytes);
        memcpy(imaginary_part + to, formed.planes + formed.count + from, bytes);
    }
    free(formed.planes);
    form_lines_end(&lines);
    return status;
}

uint32_t look_weights(double looks, double *weight, double *last)
{
    const double count = ceil(looks);
    const double others = count - 1.0;
    *weight = 1.0;
    *last = 1.0;
    if (others < 1.0)
        return 1;
    /* Solve others a + b = 1 and others a^2 + b^2 = 1 / looks. */
    const double root = others * others - others * count * (1.0 - 1.0 / looks);
    *weight = (others + sqrt(fmax(0.0, root))) / (others * count);
    *last = 1.0 - others * *weight;
    return (uint32_t)count;
}

/* Planes of the patch, in pairs of real and imaginary parts. */
enum look_plane {
    PHASE_REAL,
    PHASE_IMAGINARY,
    NOISE_REAL,
    NOISE_IMAGINARY,
    TARGET_REAL,
    TARGET_IMAGINARY,
    PHASE_ENERGY, /* weighted mean over looks */
    INTENSITY,
    LOOK_PLANES
};

struct look_work {
    struct tracer *tracer;
    const struct patch_level *level;
    const struct echoes *echoes;
    const float *pixels;
    const struct window *window;
    struct injected_window *result;
    float *planes[LOOK_PLANES];
};

static sonject_status draw(const struct look_work *work, uint32_t stream, enum look_plane plane)
{
    return coloured_noise(work->tracer, stream, work->window, work->planes[plane],
                          work->planes[plane + 1]);
}

static uint32_t stream_of(uint32_t look, uint32_t first_look, uint32_t which)
{
    return look == 0 ? first_look : STREAM_LOOKS + 3 * (look - 1) + which;
}

/* Finds the target's echo in a look. The first look has the traced realisation. The others have
 * the glints, and the rough part's energy drawn again. */
static void target_in_look(const struct look_work *work, uint32_t look, size_t i, double *real_part,
                           double *imaginary_part)
{
    const struct echoes *echoes = work->echoes;
    *real_part = (double)echoes->target_real[i];
    *imaginary_part = (double)echoes->target_imaginary[i];
    if (look == 0)
        return;
    const double a = (double)echoes->coherent_real[i];
    const double b = (double)echoes->coherent_imaginary[i];
    const double rough = sqrt(fmax(0.0, (double)echoes->target_energy[i] - a * a - b * b));
    *real_part = a + rough * (double)work->planes[TARGET_REAL][i];
    *imaginary_part = b + rough * (double)work->planes[TARGET_IMAGINARY][i];
}

static void add_look(const struct look_work *work, uint32_t look, double weight, size_t i)
{
    const struct patch_level *level = work->level;
    const double gain =
        sqrt((double)level->level[i] / (double)level->cell_energy[i % work->echoes->columns]);
    const double visibility = (double)work->result->visibility[i];
    const double phase_energy = (double)work->planes[PHASE_ENERGY][i];
    const double seabed =
        phase_energy > 0.0 ? sqrt(visibility / phase_energy) * (double)work->pixels[i] : 0.0;
    const double noise =
        sqrt(fmax(0.0, 1.0 - visibility) * noise_over_level(level, i) * (double)level->level[i]);
    double target_real, target_imaginary;
    target_in_look(work, look, i, &target_real, &target_imaginary);
    const double a = seabed * (double)work->planes[PHASE_REAL][i] + gain * target_real +
                     noise * (double)work->planes[NOISE_REAL][i];
    const double b = seabed * (double)work->planes[PHASE_IMAGINARY][i] + gain * target_imaginary +
                     noise * (double)work->planes[NOISE_IMAGINARY][i];
    work->planes[INTENSITY][i] += (float)(weight * (a * a + b * b));
}

/* touched: the indices of count pixels. */
static sonject_status add_looks(const struct look_work *work, double looks, const size_t *touched,
                                size_t count)
{
    double weight, last;
    const uint32_t look_count = look_weights(looks, &weight, &last);
    for (uint32_t look = 0; look < look_count; look++) {
        CHECK(draw(work, stream_of(look, STREAM_INPUT_PHASE, 0), PHASE_REAL));
        for (size_t k = 0; k < count; k++) {
            const float a = work->planes[PHASE_REAL][touched[k]];
            const float b = work->planes[PHASE_IMAGINARY][touched[k]];
            work->planes[PHASE_ENERGY][touched[k]] +=
                (float)((look + 1 == look_count ? last : weight) * (double)(a * a + b * b));
        }
    }
    for (uint32_t look = 0; look < look_count; look++) {
        CHECK(draw(work, stream_of(look, STREAM_INPUT_PHASE, 0), PHASE_REAL));
        CHECK(draw(work, stream_of(look, STREAM_NOISE, 1), NOISE_REAL));
        if (look > 0)
            CHECK(draw(work, stream_of(look, 0, 2), TARGET_REAL));
        for (size_t k = 0; k < count; k++)
            add_look(work, look, look + 1 == look_count ? last : weight, touched[k]);
    }
    return SONJECT_OK;
}

sonject_status compose_looks(struct tracer *tracer, double looks, const struct patch_level *level,
                             const struct echoes *echoes, const float *pixels,
                             const struct window *window, struct injected_window *result)
{
    const size_t pixel_count = echoes->rows * echoes->columns;
    size_t count = 0;
    struct look_work work = {tracer, level, echoes, pixels, window, result, {NULL}};
    float *planes = allocate_array(pixel_count, LOOK_PLANES * sizeof *planes);
    size_t *touched = allocate_array(pixel_count, sizeof *touched);
    for (size_t i = 0; i < LOOK_PLANES && planes; i++)
        work.planes[i] = planes + i * pixel_count;
    for (size_t i = 0; i < pixel_count && touched; i++)
        if (result->influence[i])
            touched[count++] = i;
    const sonject_status status = planes && touched ? add_looks(&work, looks, touched, count)
                                                    : report_out_of_memory(tracer->report, "looks");
    for (size_t k = 0; status == SONJECT_OK && k < count; k++) {
        float *field = result->field + 2 * touched[k];
        const float before = result->image[touched[k]];
        const float after = sqrtf(work.planes[INTENSITY][touched[k]]);
        result->image[touched[k]] = after;
        if (before > 0.0f) { /* the field keeps the first look's phase */
            field[0] *= after / before;
            field[1] *= after / before;
        }
    }
    free(planes);
    free(touched);
    return status;
}
