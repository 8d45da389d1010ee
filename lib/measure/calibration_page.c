/* The page that shows why to believe a calibration: six charts. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/canvas.h"
#include "image/plot.h"
#include "measure/calibration_parts.h"
#include "measure/contacts.h"
#include "measure/speckle_law.h"
#include "swath/raster_file.h"

#define CHARTS_ACROSS 3
#define CHART_WIDTH   400
#define CHART_HEIGHT  290
#define LEFT          76 /* room beside a chart for the numbers and the name of its axis */
#define RIGHT         18
#define ABOVE         34
#define BELOW         58
#define HEAD          66
#define TICK          5
#define LABEL_GAP     6
#define TEXT_BYTES    160
#define CURVE_POINTS  160
#define LAW_LOWEST    (-4.5)
#define LAW_HIGHEST   2.7
#define LAW_BINS      48
#define MARGIN        0.05 /* share of an axis that is left free beyond what is drawn */

static const struct colour white = {250, 250, 250};
static const struct colour ink = {40, 40, 40};
static const struct colour grey = {150, 150, 150};
static const struct colour pale = {222, 222, 222};
static const struct colour blue = {33, 84, 160};
static const struct colour red = {172, 28, 36};
static const struct colour family_colours[] = {{172, 28, 36}, {224, 130, 20}, {36, 130, 60}};

struct chart {
    struct canvas *canvas;
    int64_t left, top; /* upper left pixel of the inside of the frame */
    double low[2], high[2];
};

static double chart_x(const struct chart *chart, double value)
{
    return (double)chart->left +
           (value - chart->low[0]) / (chart->high[0] - chart->low[0]) * CHART_WIDTH;
}

static double chart_y(const struct chart *chart, double value)
{
    return (double)chart->top + CHART_HEIGHT -
           (value - chart->low[1]) / (chart->high[1] - chart->low[1]) * CHART_HEIGHT;
}

static bool is_inside(const struct chart *chart, double x, double y)
{
    return x >= chart->low[0] && x <= chart->high[0] && y >= chart->low[1] && y <= chart->high[1];
}

static void text_at(const struct chart *chart, int64_t x, int64_t y, const char *text,
                    struct colour colour)
{
    draw_text(chart->canvas, x, y, text, SIZE_MAX, TEXT_RIGHTWARDS, colour);
}

/* Draws the ticks and names of both axes, and the title. */
static void draw_frame(const struct chart *chart, const char *title, const char *across,
                       const char *up)
{
    char label[TICK_LABEL_CAPACITY];
    const int64_t bottom = chart->top + CHART_HEIGHT;
    for (int axis = 0; axis < 2; axis++) {
        const struct plot_ticks ticks =
            plot_ticks_between(chart->low[axis], chart->high[axis], 5.0);
        for (int64_t i = ticks.first; i <= ticks.last; i++) {
            const double value = plot_tick_value(&ticks, i);
            const char *number = plot_tick_label(&ticks, i, label);
            const int64_t length = text_length(number, SIZE_MAX);
            if (axis == 0) {
                const int64_t x = (int64_t)chart_x(chart, value);
                canvas_fill(chart->canvas, x, chart->top, 1, CHART_HEIGHT, pale);
                canvas_fill(chart->canvas, x, bottom + 1, 1, TICK, grey);
                text_at(chart, x - length / 2, bottom + TICK + LABEL_GAP + FONT_CAPITAL_HEIGHT,
                        number, ink);
            } else {
                const int64_t y = (int64_t)chart_y(chart, value);
                canvas_fill(chart->canvas, chart->left, y, CHART_WIDTH, 1, pale);
                canvas_fill(chart->canvas, chart->left - 1 - TICK, y, TICK, 1, grey);
                text_at(chart, chart->left - TICK - LABEL_GAP - length, y + FONT_CAPITAL_HEIGHT / 2,
                        number, ink);
            }
        }
    }
    canvas_frame(chart->canvas, chart->left, chart->top, CHART_WIDTH, CHART_HEIGHT, grey);
    text_at(chart, chart->left, chart->top - 2 * LABEL_GAP, title, ink);
    text_at(chart, chart->left + (CHART_WIDTH - text_length(across, SIZE_MAX)) / 2,
            bottom + TICK + 3 * LABEL_GAP + 2 * FONT_CAPITAL_HEIGHT, across, ink);
    draw_text(chart->canvas, chart->left - LEFT + FONT_ASCENT + 2,
              chart->top + (CHART_HEIGHT + text_length(up, SIZE_MAX)) / 2, up, SIZE_MAX,
              TEXT_UPWARDS, ink);
}

static void draw_dot(const struct chart *chart, double x, double y, double thickness,
                     struct colour colour)
{
    if (is_inside(chart, x, y))
        canvas_line(chart->canvas, chart_x(chart, x), chart_y(chart, y), chart_x(chart, x),
                    chart_y(chart, y), thickness, colour);
}

/* Draws a line between two points, unless one of them is outside the chart. */
static void draw_piece(const struct chart *chart, const double from[2], const double to[2],
                       double thickness, struct colour colour)
{
    if (is_inside(chart, from[0], from[1]) && is_inside(chart, to[0], to[1]))
        canvas_line(chart->canvas, chart_x(chart, from[0]), chart_y(chart, from[1]),
                    chart_x(chart, to[0]), chart_y(chart, to[1]), thickness, colour);
}

/* Draws a curve's next piece, from the pen to a point, and moves the pen. It starts as NAN. */
static void draw_to(const struct chart *chart, double pen[2], double x, double y, double thickness,
                    struct colour colour)
{
    const double to[2] = {x, y};
    draw_piece(chart, pen, to, thickness, colour);
    memcpy(pen, to, sizeof to);
}

static void set_axes(struct chart *chart, double left, double right, double bottom, double top)
{
    chart->low[0] = left;
    chart->high[0] = right;
    chart->low[1] = bottom;
    chart->high[1] = top;
}

/* Draws a line of the legend, counted from the upper left or upper right corner of the chart. */
static REPORT_FORMAT(5) void draw_legend(const struct chart *chart, int line, bool is_right,
                                         struct colour colour, const char *format, ...)
{
    char text[TEXT_BYTES];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const int64_t length = text_length(text, SIZE_MAX);
    text_at(chart, is_right ? chart->left + CHART_WIDTH - 10 - length : chart->left + 10,
            chart->top + 22 + 20 * line, text, colour);
}

static void draw_reason(const struct chart *chart, const char *title, const char *reason)
{
    char line[64];
    int64_t y = chart->top + CHART_HEIGHT / 2 - 20;
    text_at(chart, chart->left, chart->top - 2 * LABEL_GAP, title, ink);
    canvas_frame(chart->canvas, chart->left, chart->top, CHART_WIDTH, CHART_HEIGHT, pale);
    text_at(chart, chart->left + 12, y, "not seen:", red);
    while (*reason) { /* fills line after line with words */
        size_t length = 0, end = 0;
        while (reason[end] && end < sizeof line - 1 &&
               text_length(reason, end + 1) < CHART_WIDTH - 24) {
            end++;
            if (reason[end] == ' ' || reason[end] == '\0')
                length = end;
        }
        length = length > 0 ? length : end > 0 ? end : 1;
        snprintf(line, sizeof line, "%.*s", (int)length, reason);
        y += 22;
        text_at(chart, chart->left + 12, y, line, ink);
        reason += length + (reason[length] == ' ');
    }
}

static const char *family_text(const struct calibration *found, enum curve_family family,
                               char text[CURVE_TEXT_CAPACITY])
{
    if (family == found->family && found->transfer.kind == SONJECT_TRANSFER_AMPLITUDE)
        return strcpy(text, "amplitude");
    if (family == found->family && found->transfer.kind == SONJECT_TRANSFER_INTENSITY)
        return strcpy(text, "intensity");
    return curve_text(found, family, text);
}

/* Draws median and interquartile distance of each tile, and the curves of the families. */
static void draw_spread(struct chart *chart, const struct calibration *found,
                        const struct stored_swath *swath, const double *medians,
                        const double *spreads, struct speckle_law *law)
{
    const size_t count = found->tiles.count;
    char text[TEXT_BYTES];
    double top = 0.0, right = 0.0, left = INFINITY;
    for (size_t i = 0; i < count; i++) {
        top = fmax(top, spreads[i]);
        right = fmax(right, medians[i]);
        left = fmin(left, medians[i]);
    }
    const double across = fmax(right - left, 1e-3 * right);
    set_axes(chart, left - MARGIN * across, right + MARGIN * across, 0.0, 1.25 * top);
    draw_frame(chart, "Spread against level, and curves", "median stored number of a tile",
               "between its quartiles");
    for (size_t i = 0; i < count; i++)
        draw_dot(chart, medians[i], spreads[i], 3.5, grey);
    int line = 1;
    for (int pass = 0; pass < 2; pass++)
        for (int family = 0; family < CURVE_FAMILIES; family++) {
            const struct curve_fit *fit = &found->fits[family];
            const bool is_chosen = family == (int)found->family;
            if (!fit->levels || is_chosen != (pass == 1))
                continue;
            speckle_law_init(law, fit->looks, fit->texture);
            double quartiles[3], pen[2] = {NAN, NAN};
            for (int k = 0; k < 3; k++)
                quartiles[k] = speckle_law_quantile(law, 0.25 * (k + 1));
            const struct colour colour = is_chosen ? blue : family_colours[family];
            for (int i = 0; i <= CURVE_POINTS; i++) {
                const double median = left + (right - left) * i / CURVE_POINTS;
                const double full = curve_full_scale(found, swath);
                const double level =
                    curve_log_intensity((enum curve_family)family, fit->parameter, full, median) -
                    quartiles[1];
                const double spread = curve_value((enum curve_family)family, fit->parameter, full,
                                                  level + quartiles[2]) -
                                      curve_value((enum curve_family)family, fit->parameter, full,
                                                  level + quartiles[0]);
                draw_to(chart, pen, median, spread, is_chosen ? 3.0 : 1.5, colour);
            }
            draw_legend(chart, is_chosen ? 0 : line++, false, colour, "%s",
                        family_text(found, (enum curve_family)family, text));
        }
}

static void draw_histogram(struct chart *chart, const struct calibration *found)
{
    char text[TEXT_BYTES];
    double top = 0.0;
    for (int i = 1; i + 1 < PAGE_BINS; i++)
        top = fmax(top, found->histogram[i]);
    set_axes(chart, 0.0, 1.04 * found->histogram_top, 0.0, 125.0 * top);
    draw_frame(chart, "Stored numbers", "stored number", "% of the pixels");
    for (int i = 0; i < PAGE_BINS; i++) {
        const double value = (i + 0.5) / PAGE_BINS * found->histogram_top;
        const double share = fmin(100.0 * found->histogram[i], chart->high[1]);
        const double base[2] = {value, 0.0}, tip[2] = {value, share};
        draw_piece(chart, base, tip, 1.6, grey);
    }
    if (found->full_scale.unseen) {
        draw_legend(chart, 0, true, ink, "no ceiling: no clipped pixels");
        return;
    }
    const double foot[2] = {found->full_scale.value, 0.0};
    const double head[2] = {found->full_scale.value, chart->high[1]};
    draw_piece(chart, foot, head, 2.0, red);
    snprintf(text, sizeof text, "ceiling %.6g, %.2f %% clipped", found->full_scale.value,
             100.0 * found->clipped.value);
    text_at(chart,
            (int64_t)chart_x(chart, found->full_scale.value) - 8 - text_length(text, SIZE_MAX),
            chart->top + 22, text, red);
}

/* Draws the distribution of log intensity over the tiles' levels, and the fitted law. */
static void draw_law(struct chart *chart, const struct calibration *found,
                     const struct stored_swath *swath, struct speckle_law *law)
{
    const struct curve_fit *fit = &found->fits[found->family];
    const struct plain_tiles *tiles = &found->tiles;
    const size_t side = tiles->side, pixels = side * side;
    const double width = (LAW_HIGHEST - LAW_LOWEST) / LAW_BINS;
    double bins[LAW_BINS] = {0.0}, density, top = 0.0;
    for (size_t i = 0; i < tiles->count * pixels; i++) {
        const size_t at = (tiles->rows[i / pixels] + i % pixels / side) * swath->columns +
                          tiles->columns[i / pixels] + i % side;
        const double x =
            pixel_log_intensity(found, swath, (double)swath->values[at]) - fit->levels[i / pixels];
        const double bin = (x - LAW_LOWEST) / width;
        if (bin >= 0.0 && bin < LAW_BINS)
            bins[(size_t)bin] += 1.0 / (double)(tiles->count * pixels) / width;
    }
    speckle_law_init(law, fit->looks, fit->texture);
    for (int i = 0; i < LAW_BINS; i++) {
        speckle_law_below(law, LAW_LOWEST + (i + 0.5) * width, &density);
        top = fmax(top, fmax(density, bins[i]));
    }
    set_axes(chart, LAW_LOWEST / log(10.0) * 10.0, LAW_HIGHEST / log(10.0) * 10.0, 0.0, 1.25 * top);
    draw_frame(chart, "Speckle, and the law fitted to it", "intensity over its tile's mean, dB",
               "density");
    const double decibels = 10.0 / log(10.0);
    double pen[2] = {NAN, NAN};
    for (int i = 0; i < LAW_BINS; i++)
        draw_dot(chart, (LAW_LOWEST + (i + 0.5) * width) * decibels, bins[i], 5.0, grey);
    for (int i = 0; i <= CURVE_POINTS; i++) {
        const double x = LAW_LOWEST + (LAW_HIGHEST - LAW_LOWEST) * i / CURVE_POINTS;
        speckle_law_below(law, x, &density);
        draw_to(chart, pen, x * decibels, density, 2.5, blue);
    }
    if (found->looks.unseen)
        draw_legend(chart, 0, false, blue, "looks not found, 1 assumed");
    else
        draw_legend(chart, 0, false, blue, "looks %.3g +- %.2g", found->looks.value,
                    found->looks.error);
    draw_legend(chart, 1, false, blue, "%s: %.2g +- %.1g %% of pixels off",
                curve_fits(fit) ? "fits" : "does not fit", 100.0 * fit->misfit,
                100.0 * fit->misfit_error);
    if (fit->texture > 0.0)
        draw_legend(chart, 2, false, blue, "K shape %.3g", 1.0 / fit->texture);
}

static void draw_correlation(struct chart *chart, const struct calibration *found)
{
    const struct estimate *widths[] = {&found->along_rows, &found->range_columns};
    const struct colour colours[] = {blue, red};
    static const char *const names[] = {"along track", "range"};
    static const char *const units[] = {"rows", "columns"};
    set_axes(chart, 0.0, CALIBRATION_LAGS - 1, -0.15, 1.1);
    draw_frame(chart, "Correlation, with a Gaussian response", "pixels apart", "of intensity");
    for (int axis = 0; axis < 2; axis++) {
        double pen[2] = {NAN, NAN};
        for (int i = 0; i <= CURVE_POINTS && !widths[axis]->unseen; i++) {
            const double x = (CALIBRATION_LAGS - 1.0) * i / CURVE_POINTS;
            const double ratio = x / widths[axis]->value;
            draw_to(chart, pen, x, exp(-2.0 * log(2.0) * ratio * ratio), 1.5, colours[axis]);
        }
        for (int lag = 0; lag < CALIBRATION_LAGS; lag++)
            draw_dot(chart, lag, found->correlation[axis][lag], 6.0, colours[axis]);
        if (widths[axis]->unseen)
            draw_legend(chart, axis, true, colours[axis], "%s: not seen", names[axis]);
        else
            draw_legend(chart, axis, true, colours[axis], "%s: %.3g +- %.2g %s", names[axis],
                        widths[axis]->value, widths[axis]->error, units[axis]);
    }
}

static void draw_water(struct chart *chart, const struct calibration *found)
{
    static const char title[] = "First return";
    const struct first_returns *returns = &found->returns;
    double lowest = INFINITY, highest = 0.0;
    if (!returns->columns) {
        draw_reason(chart, title, found->nadir_column.unseen);
        return;
    }
    for (size_t row = 0; row < found->rows; row++) {
        lowest = fmin(lowest, returns->columns[row]);
        highest = fmax(highest, returns->columns[row]);
    }
    set_axes(chart, 0.0, (double)found->rows, lowest - 0.1 * (highest - lowest) - 2.0,
             highest + 0.25 * (highest - lowest) + 2.0);
    draw_frame(chart, title, "row", "columns from the nadir");
    double pen[2] = {NAN, NAN};
    for (size_t row = 0; row < found->rows; row++)
        draw_to(chart, pen, (double)row, returns->columns[row], 1.5, blue);
    const bool has_nadir = !found->nadir_column.unseen;
    if (has_nadir)
        draw_legend(chart, 0, true, ink, "nadir column %.5g +- %.2g", found->nadir_column.value,
                    found->nadir_column.error);
    if (!found->altitude_m.unseen) {
        draw_legend(chart, has_nadir, true, ink, "altitude %.3g m (median)",
                    found->altitude_m.value);
        draw_legend(chart, 1 + has_nadir, true, ink, "%.3g...%.3g m (5...95 %%)",
                    found->altitude_ends_m[0], found->altitude_ends_m[1]);
    }
}

static void draw_gain(struct chart *chart, const struct calibration *found)
{
    double lowest = 0.0, highest = 0.0;
    const bool has_floor = !found->noise_floor_db.unseen;
    for (size_t band = 0; band < found->gain_bands; band++)
        if (!isnan(found->gain_db[band])) {
            lowest = fmin(lowest, found->gain_db[band] - found->gain_error_db[band]);
            highest = fmax(highest, found->gain_db[band] + found->gain_error_db[band]);
        }
    if (has_floor)
        lowest += found->noise_floor_db.value;
    set_axes(chart, 0.0, (double)found->columns, lowest - 0.1 * (highest - lowest) - 1.0,
             highest + 0.3 * (highest - lowest) + 1.0);
    draw_frame(chart, "Level against range, and noise floor", "column", "over the median, dB");
    for (size_t band = 0; band < found->gain_bands; band++) {
        const double x = ((double)band + 0.5) * (double)found->columns / (double)found->gain_bands;
        const double low[2] = {x, found->gain_db[band] - found->gain_error_db[band]};
        const double high[2] = {x, found->gain_db[band] + found->gain_error_db[band]};
        draw_dot(chart, x, found->gain_db[band], 6.0, blue);
        draw_piece(chart, low, high, 1.5, blue);
        if (has_floor)
            draw_dot(chart, x, found->gain_db[band] + found->noise_floor_db.value, 6.0, red);
    }
    if (has_floor)
        draw_legend(chart, 0, true, red, "noise floor %.3g +- %.2g dB, of %zu shadows",
                    found->noise_floor_db.value, found->noise_floor_db.error, found->shadows);
    else
        draw_legend(chart, 0, true, red, "noise floor not found");
}

/* Writes one line that sums up the calibration. */
static void draw_head(struct canvas *canvas, const struct calibration *found, const char *title)
{
    char text[2 * TEXT_BYTES], curve[TEXT_BYTES], excerpt[TEXT_BYTES], alike[TEXT_BYTES];
    family_text(found, found->family, curve);
    const size_t length = strlen(title);
    snprintf(excerpt, sizeof excerpt, "%s%s", length > 120 ? "..." : "",
             length > 120 ? title + length - 117 : title);
    draw_text(canvas, 24, 30, excerpt, SIZE_MAX, TEXT_RIGHTWARDS, ink);
    snprintf(text, sizeof text, "%zu x %zu pixels, %zu plain tiles: %s", found->rows,
             found->columns, found->tiles.count, curve);
    if (found->transfer.kind >= SONJECT_TRANSFER_DECIBEL) {
        snprintf(curve, sizeof curve, " +- %.2g%s", found->parameter.error,
                 found->parameter.unseen ? ", not found: amplitude assumed" : "");
        strncat(text, curve, sizeof text - strlen(text) - 1);
    }
    for (int family = 0; family < CURVE_FAMILIES; family++)
        if (found->alike[family]) {
            snprintf(alike, sizeof alike, ", or equally %s",
                     curve_text(found, (enum curve_family)family, curve));
            strncat(text, alike, sizeof text - strlen(text) - 1);
        }
    draw_text(canvas, 24, 54, text, SIZE_MAX, TEXT_RIGHTWARDS, blue);
}

/* Fills the medians and interquartile distances of the tiles' stored numbers. */
static void fill_spreads(const struct calibration *found, const struct stored_swath *swath,
                         float *sorted, double *medians, double *spreads)
{
    const struct plain_tiles *tiles = &found->tiles;
    const size_t side = tiles->side, pixels = side * side;
    for (size_t tile = 0; tile < tiles->count; tile++) {
        for (size_t i = 0; i < side; i++)
            memcpy(sorted + i * side,
                   swath->values + (tiles->rows[tile] + i) * swath->columns + tiles->columns[tile],
                   side * sizeof *sorted);
        qsort(sorted, pixels, sizeof *sorted, compare_floats);
        medians[tile] = (double)sorted[pixels / 2];
        spreads[tile] = (double)(sorted[3 * pixels / 4] - sorted[pixels / 4]);
    }
}

static struct chart chart_number(struct canvas *canvas, int number)
{
    struct chart chart = {canvas,
                          LEFT + number % CHARTS_ACROSS * (LEFT + CHART_WIDTH + RIGHT),
                          HEAD + ABOVE + number / CHARTS_ACROSS * (ABOVE + CHART_HEIGHT + BELOW),
                          {0.0, 0.0},
                          {1.0, 1.0}};
    return chart;
}

sonject_status calibration_page_write(struct report *report, const struct calibration *found,
                                      const struct stored_swath *swath, const char *title,
                                      const char *path)
{
    struct canvas canvas;
    const size_t count = found->tiles.count, pixels = found->tiles.side * found->tiles.side;
    struct speckle_law *law = allocate_array(1, sizeof *law);
    double *medians = allocate_array(count, 2 * sizeof *medians);
    float *sorted = allocate_array(pixels, sizeof *sorted);
    sonject_status status = SONJECT_OK;
    const bool has_canvas = canvas_create(&canvas, HEAD + 2 * (ABOVE + CHART_HEIGHT + BELOW) + 8,
                                          CHARTS_ACROSS * (LEFT + CHART_WIDTH + RIGHT), white);
    if (!has_canvas || !law || !medians || !sorted) {
        status = report_out_of_memory(report, "a calibration's page");
    } else if (found->transfer_kind.unseen) {
        struct chart chart = chart_number(&canvas, 0);
        draw_reason(&chart, "Curve", found->transfer_kind.unseen);
    } else {
        struct chart charts[6];
        for (int i = 0; i < 6; i++)
            charts[i] = chart_number(&canvas, i);
        fill_spreads(found, swath, sorted, medians, medians + count);
        draw_head(&canvas, found, title ? title : "numbers in memory");
        draw_spread(&charts[0], found, swath, medians, medians + count, law);
        draw_histogram(&charts[1], found);
        draw_law(&charts[2], found, swath, law);
        draw_correlation(&charts[3], found);
        draw_water(&charts[4], found);
        draw_gain(&charts[5], found);
    }
    if (has_canvas)
        status = picture_write(report, status, &canvas, path);
    free(law);
    free(medians);
    free(sorted);
    return status;
}
