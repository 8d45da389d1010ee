#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/shadow_floor.h"
#include "inject/compose.h"

#define NOISE_LOWEST  1e-3         /* -30 dB */
#define NOISE_UNKNOWN 5.6234133e-3 /* -22.5 dB, among measured shadow levels */
#define PART_SIDE     1024         /* side of the parts searched for shadows, pixels, about */
#define PARTS_MOST    16           /* most parts; they tell as much as a larger patch would */

#define INTENSITY_MOST 1e30
#define LANES          8

/* Checks the pixels of one row. */
static sonject_status check_row(struct report *report, const struct patch_view *view,
                                const float *pixels, size_t row, bool is_complex)
{
    for (size_t i = 0; i < view->columns; i++) {
        const double a = is_complex ? pixels[2 * i] : pixels[i];
        const double b = is_complex ? pixels[2 * i + 1] : 0.0;
        const double intensity = a * a + b * b;
        if (!(intensity <= INTENSITY_MOST) || (!is_complex && a < 0.0))
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "the patch's pixel at row %zu, column %zu is %s: mend the image",
                                  view->is_mirrored ? view->rows - 1 - row : row,
                                  (size_t)view_patch_column(view, (double)i),
                                  isnan(a) || isnan(b)         ? "not a number (NaN)"
                                  : intensity > INTENSITY_MOST ? "too large or infinite"
                                                               : "a negative amplitude");
    }
    return SONJECT_OK;
}

/* Returns the sum of squares, in as many parts as the compiler may add at once. *least gets the
 * smallest value. */
static double sum_of_squares(const float *values, size_t count, float *least)
{
    double sums[LANES] = {0.0}, sum = 0.0;
    float lows[LANES] = {0.0f};
    const size_t whole = count / LANES * LANES;
    *least = 0.0f;
    for (size_t i = 0; i < whole; i += LANES)
        for (size_t k = 0; k < LANES; k++) {
            const float value = values[i + k];
            sums[k] += (double)value * value;
            lows[k] = value < lows[k] ? value : lows[k];
        }
    for (size_t i = whole; i < count; i++) {
        sum += (double)values[i] * values[i];
        *least = fminf(*least, values[i]);
    }
    for (size_t k = 0; k < LANES; k++) {
        sum += sums[k];
        *least = fminf(*least, lows[k]);
    }
    return sum;
}

static sonject_status check_pixels(struct patch_facts *facts, struct report *report,
                                   const struct patch_view *view, const float *pixels,
                                   bool is_complex)
{
    const size_t parts = is_complex ? 2 : 1, numbers = view->columns * parts;
    size_t first = numbers, end = 0; /* numbers before and after which all rows are 0 */
    double sum = 0.0;
    for (size_t row = 0; row < view->rows; row++) {
        const float *values = pixels + row * numbers;
        float least;
        const double of_row = sum_of_squares(values, numbers, &least);
        if (!(of_row <= INTENSITY_MOST) || (least < 0.0f && !is_complex))
            CHECK(check_row(report, view, values, row, is_complex));
        for (size_t i = 0; i < first; i++)
            first = values[i] != 0.0f ? i : first;
        for (size_t i = numbers; i > end; i--)
            end = values[i - 1] != 0.0f ? i : end;
        sum += of_row;
    }
    facts->first_heard = first / parts;
    facts->end_heard = (end + parts - 1) / parts;
    facts->mean_intensity = sum / (double)(view->rows * view->columns);
    if (!(facts->mean_intensity > 1e-30))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              facts->mean_intensity > 0.0
                                  ? "the patch's amplitudes are below 1e-15: scale them"
                                  : "the patch has no pixel above 0: choose another patch");
    return SONJECT_OK;
}

/* Adds the shadows of a part of the patch. */
static sonject_status add_shadows(struct report *report, const struct patch_view *view,
                                  const float *pixels, bool is_complex, const struct window *at,
                                  struct shadow_floor *shadows)
{
    const size_t count = at->rows * at->columns, water = view_water_columns(view);
    float *intensity = window_intensities(at, view, pixels, is_complex);
    uint8_t *states = allocate_array(count, 1);
    sonject_status status =
        intensity && states ? SONJECT_OK : report_out_of_memory(report, "the patch");
    for (size_t i = 0; status == SONJECT_OK && i < count; i++)
        states[i] = at->first_column + i % at->columns < water;
    THEN(status, shadow_floor_find(report, intensity, states, at->rows, at->columns, shadows));
    free(intensity);
    free(states);
    return status;
}

static size_t parts_of(size_t pixels)
{
    return pixels < PART_SIDE ? 1 : (pixels + PART_SIDE / 2) / PART_SIDE;
}

/* Estimates the noise floor from shadows of the patch. It is ambient and receiver noise, and the
 * side lobes and echoes by other paths that fill real shadows. NOISE_LOWEST is for clipped
 * pictures, which show too little. A large patch is searched in parts all over it. */
static sonject_status estimate_noise(struct patch_facts *facts, struct report *report,
                                     const struct patch_view *view, const float *pixels,
                                     bool is_complex)
{
    static const char stage[] = "looking for shadows";
    const size_t rows = parts_of(view->rows), columns = parts_of(view->columns);
    const size_t count = rows * columns < PARTS_MOST ? rows * columns : PARTS_MOST;
    struct shadow_floor shadows = {.side = view->rows < view->columns ? view->rows : view->columns};
    sonject_status status = SONJECT_OK;
    for (size_t k = 0; status == SONJECT_OK && k < count; k++) {
        const size_t part = k * (rows * columns) / count, row = part / columns;
        const size_t column = (part + row) % columns;
        struct window at = {.first_row = row * view->rows / rows,
                            .first_column = column * view->columns / columns};
        at.rows = (row + 1) * view->rows / rows - at.first_row;
        at.columns = (column + 1) * view->columns / columns - at.first_column;
        if (report_is_cancelled(report, stage))
            status = report_failure(report, SONJECT_CANCELLED, "cancelled while %s", stage);
        THEN(status, add_shadows(report, view, pixels, is_complex, &at, &shadows));
    }
    if (status == SONJECT_OK && shadows.shadows > 0) {
        facts->measures_noise = true;
        facts->noise_ratio = fmax(NOISE_LOWEST, exp(shadows.log_ratio));
    }
    free(shadows.list);
    return status;
}

sonject_status patch_facts_init(struct patch_facts *facts, struct report *report,
                                const struct scene *scene, const struct patch_view *view,
                                const float *pixels, bool is_complex)
{
    memset(facts, 0, sizeof *facts);
    CHECK(check_pixels(facts, report, view, pixels, is_complex));
    if (!scene->injection.estimate_noise) {
        facts->noise_ratio = pow(10.0, scene->injection.noise_floor_db / 10.0);
        return SONJECT_OK;
    }
    facts->noise_ratio = NOISE_UNKNOWN;
    return estimate_noise(facts, report, view, pixels, is_complex);
}

/* Keeps of a line's ones those that end a run of so many. */
static void erode(uint8_t *line, size_t count, size_t step, size_t length)
{
    size_t run = 0;
    for (size_t i = 0; i < count; i++) {
        run = line[i * step] ? run + 1 : 0;
        line[i * step] = run >= length;
    }
}

/* Makes each of a line's ones the end of a run of so many. */
static void dilate(uint8_t *line, size_t count, size_t step, size_t length)
{
    size_t left = 0;
    for (size_t i = count; i-- > 0;) {
        left = line[i * step] ? length : left - (left > 0);
        line[i * step] = left > 0;
    }
}

static bool is_zero(const float *pixels, size_t pixel, bool is_complex)
{
    return is_complex ? pixels[2 * pixel] == 0.0f && pixels[2 * pixel + 1] == 0.0f
                      : pixels[pixel] == 0.0f;
}

size_t widened_span(size_t first, size_t count, size_t reach, size_t all, size_t *start)
{
    const size_t end = first + count + reach;
    *start = first > reach ? first - reach : 0;
    return (end < all ? end : all) - *start;
}

sonject_status find_holes(struct report *report, const struct patch_view *view,
                          const struct window *at, double side_m, const float *pixels,
                          bool is_complex, uint8_t **holes)
{
    const size_t rows = (size_t)fmin(ceil(side_m / view->row_spacing_m), 1e9);
    const size_t columns = (size_t)fmin(ceil(side_m / view->column_spacing_m), 1e9);
    struct window wide;
    wide.rows = widened_span(at->first_row, at->rows, rows, view->rows, &wide.first_row);
    wide.columns =
        widened_span(at->first_column, at->columns, columns, view->columns, &wide.first_column);
    uint8_t *zeros = allocate_array(wide.rows, wide.columns);
    CHECK_MEMORY(report, zeros, "the patch");
    for (size_t row = 0; row < wide.rows; row++) {
        const size_t first = (wide.first_row + row) * view->columns + wide.first_column;
        for (size_t i = 0; i < wide.columns; i++)
            zeros[row * wide.columns + i] = is_zero(pixels, first + i, is_complex);
        erode(zeros + row * wide.columns, wide.columns, 1, columns);
    }
    const bool has_runs = memchr(zeros, 1, wide.rows * wide.columns) != NULL;
    for (size_t column = 0; has_runs && column < wide.columns; column++) {
        erode(zeros + column, wide.rows, wide.columns, rows);
        dilate(zeros + column, wide.rows, wide.columns, rows);
    }
    for (size_t row = 0; has_runs && row < at->rows; row++) {
        uint8_t *line = zeros + (at->first_row - wide.first_row + row) * wide.columns;
        dilate(line, wide.columns, 1, columns);
        memmove(zeros + row * at->columns, line + at->first_column - wide.first_column,
                at->columns);
    }
    *holes = has_runs && memchr(zeros, 1, at->rows * at->columns) ? zeros : NULL;
    if (!*holes)
        free(zeros);
    return SONJECT_OK;
}
