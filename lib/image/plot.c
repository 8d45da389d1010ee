#include "image/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/canvas.h"

/* Lengths are in pixels. */
#define SINGLE_PANEL      800.0 /* longer side of a single panel */
#define SIDE_BY_SIDE      560.0 /* longer side of one of several panels */
#define PANELS_MAX        64
#define MARGIN            18
#define PANEL_GAP         34
#define TITLE_HEIGHT      (FONT_CAPITAL_HEIGHT + 12)
#define TICK_LENGTH       5
#define LABEL_GAP         6 /* between tick and number, and between numbers and axis label */
#define BAR_GAP           14
#define BAR_WIDTH         14
#define TICK_EVERY_ROW    60.0 /* least distance of ticks */
#define TICK_EVERY_COLUMN 80.0

#define LONGEST_SHAPE 5.0 /* length to width to scale; longer images are widened */

/* The energies of all float amplitudes lie between these. */
#define LOWEST_DB      -900.0
#define HIGHEST_DB     780.0
#define BINS_PER_DB    100
#define PERCENTILE_LOW 0.03
#define PERCENTILE_TOP 0.998

#define LARGEST_EXPONENT 12
#define LARGEST_NUMBER   1e6  /* largest tick number from 0, which has enough digits */
#define SLACK            1e-9 /* share of a step by which an end may miss a tick */

static double power_of_ten(int exponent)
{
    double power = 1.0;
    for (int i = 0; i < exponent; i++)
        power *= 10.0;
    return power;
}

static double step_of(const struct plot_ticks *ticks)
{
    return ticks->exponent < 0 ? ticks->multiple / power_of_ten(-ticks->exponent)
                               : ticks->multiple * power_of_ten(ticks->exponent);
}

/* Takes the next larger step: 1, 2, 5, 10, ... */
static void widen(struct plot_ticks *ticks)
{
    if (ticks->multiple == 1) {
        ticks->multiple = 2;
    } else if (ticks->multiple == 2) {
        ticks->multiple = 5;
    } else {
        ticks->multiple = 1;
        ticks->exponent++;
    }
}

struct plot_ticks plot_ticks_between(double low, double high, double most)
{
    const struct plot_ticks none = {0, -1, 1, 0};
    struct plot_ticks ticks = {0, -1, 1, -LARGEST_EXPONENT};
    if (!(isfinite(low) && isfinite(high) && high - low >= step_of(&ticks) && most >= 1.0))
        return none;
    while (ticks.exponent <= LARGEST_EXPONENT && step_of(&ticks) * (most + SLACK) < high - low)
        widen(&ticks);
    const double first = ceil(low / step_of(&ticks) - SLACK);
    const double last = floor(high / step_of(&ticks) + SLACK);
    if (ticks.exponent > LARGEST_EXPONENT || fabs(first) > LARGEST_NUMBER ||
        fabs(last) > LARGEST_NUMBER)
        return none;
    ticks.first = (int64_t)first;
    ticks.last = (int64_t)last;
    return ticks;
}

double plot_tick_value(const struct plot_ticks *ticks, int64_t number)
{
    return (double)number * step_of(ticks);
}

const char *plot_tick_label(const struct plot_ticks *ticks, int64_t number,
                            char label[TICK_LABEL_CAPACITY])
{
    size_t length = 0;
    snprintf(label, TICK_LABEL_CAPACITY, "%.*f", ticks->exponent < 0 ? -ticks->exponent : 0,
             plot_tick_value(ticks, number));
    for (const char *from = label; *from; from++)
        if (*from == '-' || (*from >= '0' && *from <= '9'))
            label[length++] = *from;
        else if (label[length - 1] != '.') /* the locale's point may have several bytes */
            label[length++] = '.';
    label[length] = '\0';
    return label;
}

/* One axis of a panel. `down` image pixels are averaged to a cell, which is drawn `up` pixels wide.
 * One of the two is 1. */
struct plot_scale {
    uint64_t pixels;
    uint32_t up, down;
    uint32_t cells;
};

/* Returns the scale that draws `pixels` image pixels about `length` picture pixels long. */
static struct plot_scale scale_of(uint64_t pixels, double length)
{
    struct plot_scale scale = {pixels, 1, 1, 0};
    const double size = length / (double)pixels;
    if (size >= 1.0)
        scale.up = (uint32_t)floor(size + 0.5);
    else
        scale.down = (uint32_t)floor(fmin(1.0 / size, 4e9) + 0.5);
    scale.cells = (uint32_t)((pixels - 1) / scale.down + 1);
    return scale;
}

/* Returns the height of a pixel over its width, or 1 if that is unknown. */
static double pixel_shape(double row_spacing_m, double column_spacing_m)
{
    const double ratio = row_spacing_m / fabs(column_spacing_m);
    return isfinite(ratio) && ratio > 0.0 ? ratio : 1.0;
}

/* Chooses the sides of a picture to scale, given its longer side. */
static void choose_sides(double rows, double columns, double shape, double longest, double *height,
                         double *width)
{
    const double in_columns = shape * rows;
    const double scale = longest / fmax(in_columns, columns);
    *height = fmax(in_columns * scale, longest / LONGEST_SHAPE);
    *width = fmax(columns * scale, longest / LONGEST_SHAPE);
}

void plot_small_sides(uint64_t rows, uint64_t columns, double row_spacing_m,
                      double column_spacing_m, uint32_t longest, uint32_t sides[2])
{
    const double shape = pixel_shape(row_spacing_m, column_spacing_m);
    const double finest =
        fmax((double)rows * fmax(shape, 1.0), (double)columns * fmax(1.0 / shape, 1.0));
    double height, width;
    choose_sides((double)rows, (double)columns, shape, fmin(longest, finest), &height, &width);
    sides[0] = (uint32_t)fmax(1.0, floor(height));
    sides[1] = (uint32_t)fmax(1.0, floor(width));
}

/* Chooses scales that make the longer side of a panel about `target` pixels long. Distances on both
 * axes keep their proportion, as far as whole factors can. */
static void choose_scales(const struct plot_frame *frame, double target,
                          struct plot_scale *along_track, struct plot_scale *range)
{
    double height, width;
    choose_sides((double)frame->rows, (double)frame->columns,
                 pixel_shape(frame->row_spacing_m, frame->column_spacing_m), target, &height,
                 &width);
    *along_track = scale_of(frame->rows, height);
    *range = scale_of(frame->columns, width);
}

/* Fills each cell's mean energy in dB (-infinity for 0) or mean difference. Pixels that are no
 * numbers do not count; a cell without others is NaN. */
static sonject_status fill_cells(struct report *report, const struct plot_panel *panel,
                                 const struct plot_scale *along_track,
                                 const struct plot_scale *range, float *values)
{
    double *sums = allocate_array(range->cells, sizeof *sums);
    uint64_t *counts = allocate_array(range->cells, sizeof *counts);
    const bool is_complete = sums && counts;
    for (uint64_t row = 0; is_complete && row < along_track->pixels; row++) {
        const float *pixels = panel->amplitude + row * range->pixels;
        for (uint64_t cell = 0, i = 0; cell < range->cells; cell++)
            for (uint32_t k = 0; k < range->down && i < range->pixels; k++, i++) {
                const double value = (double)pixels[i];
                if (isnan(value))
                    continue;
                sums[cell] += panel->is_difference ? value : value * value;
                counts[cell]++;
            }
        if ((row + 1) % along_track->down != 0 && row + 1 != along_track->pixels)
            continue;
        for (size_t cell = 0; cell < range->cells; cell++) {
            const double mean = sums[cell] / (double)counts[cell]; /* NaN if the cell has none */
            *values++ = (float)(panel->is_difference ? mean : 10.0 * log10(mean));
            sums[cell] = 0.0;
            counts[cell] = 0;
        }
    }
    free(sums);
    free(counts);
    CHECK_MEMORY(report, is_complete, "a picture");
    return SONJECT_OK;
}

/* Returns the middle of the first bin up to whose end at least `share` of all values lie. */
static double percentile(const uint32_t *bins, uint64_t total, double share)
{
    uint64_t passed = 0;
    size_t bin = 0;
    while ((double)(passed += bins[bin]) < share * (double)total)
        bin++;
    return LOWEST_DB + ((double)bin + 0.5) / BINS_PER_DB;
}

/* Finds the 3rd and 99.8th percentile of the finite values. Where these are less than 1 dB apart,
 * takes 10 dB to either side of their middle. */
static sonject_status find_limits(struct report *report, const float *decibels, size_t count,
                                  double *minimum, double *maximum)
{
    const size_t bin_count = (size_t)(HIGHEST_DB - LOWEST_DB) * BINS_PER_DB;
    uint32_t *bins = allocate_array(bin_count, sizeof *bins);
    CHECK_MEMORY(report, bins, "a picture");
    uint64_t total = 0;
    for (size_t i = 0; i < count; i++) {
        const double value = (double)decibels[i];
        if (value > LOWEST_DB && value < HIGHEST_DB) {
            bins[(size_t)((value - LOWEST_DB) * BINS_PER_DB)]++;
            total++;
        }
    }
    if (total > 0) {
        *minimum = percentile(bins, total, PERCENTILE_LOW);
        *maximum = percentile(bins, total, PERCENTILE_TOP);
    }
    free(bins);
    if (total == 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "nothing to draw: no pixel of the image is above 0");
    if (*maximum - *minimum < 1.0) {
        const double middle = 0.5 * (*minimum + *maximum);
        *minimum = middle - 10.0;
        *maximum = middle + 10.0;
    }
    return SONJECT_OK;
}

static const struct colour background = {250, 250, 250};
static const struct colour ink = {40, 40, 40};
static const struct colour lines = {110, 110, 110};
static const struct colour black = {0, 0, 0};
static const struct colour negative_colour = {33, 84, 160};
static const struct colour zero_colour = {247, 247, 247};
static const struct colour positive_colour = {172, 28, 36};

struct plot {
    const struct plot_frame *frame;
    const struct plot_panel *panels;
    uint32_t count;
    const char *range_label;
    struct plot_scale along_track, range;
    int64_t panel_height, panel_width; /* size in the picture */
    double minimum_db, maximum_db;
    float *values;  /* the cells of a panel */
    uint32_t shown; /* panel whose cells values holds; count: none yet */
    struct plot_ticks row_ticks, column_ticks;
    struct canvas canvas;
};

/* The scale of values that colours stand for. */
struct colour_scale {
    double low, high;
    bool is_difference;
};

static uint8_t between(uint8_t from, uint8_t to, double share)
{
    return (uint8_t)(from + (to - from) * share + 0.5);
}

static struct colour colour_of(const struct colour_scale *scale, double value)
{
    if (isnan(value))
        return black;
    const double place = (value - scale->low) / (scale->high - scale->low);
    const double share = place > 0.0 ? place < 1.0 ? place : 1.0 : 0.0;
    if (!scale->is_difference) {
        const uint8_t grey = between(0, 255, share);
        const struct colour colour = {grey, grey, grey};
        return colour;
    }
    const struct colour end = share < 0.5 ? negative_colour : positive_colour;
    const double strength = fabs(2.0 * share - 1.0);
    const struct colour colour = {between(zero_colour.red, end.red, strength),
                                  between(zero_colour.green, end.green, strength),
                                  between(zero_colour.blue, end.blue, strength)};
    return colour;
}

static struct colour_scale scale_of_panel(const struct plot *plot, uint32_t panel)
{
    const struct colour_scale grey = {plot->minimum_db, plot->maximum_db, false};
    const struct colour_scale difference = {-plot->frame->difference_db, plot->frame->difference_db,
                                            true};
    return plot->panels[panel].is_difference ? difference : grey;
}

/* Returns whether a panel has a colour bar: the last of neighbours that share a scale has one. */
static bool has_bar(const struct plot *plot, uint32_t panel)
{
    return panel + 1 == plot->count ||
           plot->panels[panel].is_difference != plot->panels[panel + 1].is_difference;
}

static struct plot_ticks bar_ticks(const struct plot *plot, const struct colour_scale *scale)
{
    return plot_ticks_between(scale->low, scale->high,
                              fmax(2.0, (double)plot->panel_height / TICK_EVERY_ROW));
}

static int64_t longest_label(const struct plot_ticks *ticks)
{
    int64_t longest = 0;
    char label[TICK_LABEL_CAPACITY];
    for (int64_t i = ticks->first; i <= ticks->last; i++) {
        const int64_t length = text_length(plot_tick_label(ticks, i, label), TICK_LABEL_CAPACITY);
        longest = length > longest ? length : longest;
    }
    return longest;
}

/* Returns the room for a bar with its ticks and numbers. */
static int64_t bar_room(const struct plot *plot, uint32_t panel)
{
    const struct colour_scale scale = scale_of_panel(plot, panel);
    const struct plot_ticks ticks = bar_ticks(plot, &scale);
    return BAR_GAP + BAR_WIDTH + TICK_LENGTH + LABEL_GAP + longest_label(&ticks);
}

/* Returns the room on the left for the along-track axis. */
static int64_t axis_room(const struct plot *plot)
{
    return MARGIN + FONT_ASCENT + 2 * LABEL_GAP + longest_label(&plot->row_ticks) + LABEL_GAP +
           TICK_LENGTH;
}

static struct plot_ticks axis_ticks(double first, double spacing, const struct plot_scale *scale,
                                    int64_t length, double every)
{
    const double start = first - 0.5 * spacing;
    const double end = start + spacing * (double)scale->pixels;
    return plot_ticks_between(fmin(start, end), fmax(start, end),
                              fmax(1.0, (double)length / every));
}

/* Returns the distance from the panel's edge to a value of an axis. */
static int64_t position_of(double value, double first, double spacing,
                           const struct plot_scale *scale)
{
    const double pixel = (value - first) / spacing + 0.5;
    return (int64_t)floor(pixel * scale->up / scale->down);
}

static void draw_rows_axis(struct plot *plot, int64_t x, int64_t y)
{
    const struct plot_frame *frame = plot->frame;
    const char *name = strcmp(plot->range_label, "column") == 0 ? "row" : "along-track, m";
    char label[TICK_LABEL_CAPACITY];
    for (int64_t i = plot->row_ticks.first; i <= plot->row_ticks.last; i++) {
        const char *number = plot_tick_label(&plot->row_ticks, i, label);
        const int64_t at =
            y + position_of(plot_tick_value(&plot->row_ticks, i), frame->first_along_track_m,
                            frame->row_spacing_m, &plot->along_track);
        draw_text(&plot->canvas,
                  x - TICK_LENGTH - LABEL_GAP - text_length(number, TICK_LABEL_CAPACITY),
                  at + FONT_CAPITAL_HEIGHT / 2, number, TICK_LABEL_CAPACITY, TEXT_RIGHTWARDS, ink);
    }
    draw_text(&plot->canvas, MARGIN + FONT_ASCENT,
              y + (plot->panel_height + text_length(name, SIZE_MAX)) / 2, name, SIZE_MAX,
              TEXT_UPWARDS, ink);
}

static void draw_ticks(struct plot *plot, int64_t x, int64_t y)
{
    const struct plot_frame *frame = plot->frame;
    char label[TICK_LABEL_CAPACITY];
    for (int64_t i = plot->row_ticks.first; i <= plot->row_ticks.last; i++) {
        const int64_t at =
            position_of(plot_tick_value(&plot->row_ticks, i), frame->first_along_track_m,
                        frame->row_spacing_m, &plot->along_track);
        canvas_fill(&plot->canvas, x - 1 - TICK_LENGTH, y + at, TICK_LENGTH, 1, lines);
    }
    const int64_t bottom = y + plot->panel_height;
    for (int64_t i = plot->column_ticks.first; i <= plot->column_ticks.last; i++) {
        const char *number = plot_tick_label(&plot->column_ticks, i, label);
        const int64_t at =
            x + position_of(plot_tick_value(&plot->column_ticks, i), frame->first_range_m,
                            frame->column_spacing_m, &plot->range);
        canvas_fill(&plot->canvas, at, bottom + 1, 1, TICK_LENGTH, lines);
        draw_text(&plot->canvas, at - text_length(number, TICK_LABEL_CAPACITY) / 2,
                  bottom + TICK_LENGTH + LABEL_GAP + FONT_CAPITAL_HEIGHT, number,
                  TICK_LABEL_CAPACITY, TEXT_RIGHTWARDS, ink);
    }
    draw_text(&plot->canvas, x + (plot->panel_width - text_length(plot->range_label, SIZE_MAX)) / 2,
              bottom + TICK_LENGTH + 3 * LABEL_GAP + 2 * FONT_CAPITAL_HEIGHT, plot->range_label,
              SIZE_MAX, TEXT_RIGHTWARDS, ink);
}

static void draw_bar(struct plot *plot, const struct colour_scale *scale, int64_t x, int64_t y)
{
    const struct plot_ticks ticks = bar_ticks(plot, scale);
    const double last = (double)(plot->panel_height - 1);
    char label[TICK_LABEL_CAPACITY];
    for (int64_t i = 0; i < plot->panel_height; i++) {
        const double share = last > 0.0 ? 1.0 - (double)i / last : 1.0;
        canvas_fill(&plot->canvas, x, y + i, BAR_WIDTH, 1,
                    colour_of(scale, scale->low + (scale->high - scale->low) * share));
    }
    canvas_frame(&plot->canvas, x, y, BAR_WIDTH, plot->panel_height, lines);
    for (int64_t i = ticks.first; i <= ticks.last; i++) {
        const double share = (plot_tick_value(&ticks, i) - scale->low) / (scale->high - scale->low);
        const int64_t at = y + (int64_t)floor((1.0 - share) * last + 0.5);
        canvas_fill(&plot->canvas, x + BAR_WIDTH + 1, at, TICK_LENGTH, 1, lines);
        draw_text(&plot->canvas, x + BAR_WIDTH + TICK_LENGTH + LABEL_GAP,
                  at + FONT_CAPITAL_HEIGHT / 2, plot_tick_label(&ticks, i, label),
                  TICK_LABEL_CAPACITY, TEXT_RIGHTWARDS, ink);
    }
    draw_text(&plot->canvas, x, y - 10, "dB", SIZE_MAX, TEXT_RIGHTWARDS, ink);
}

static sonject_status fill_values(struct report *report, struct plot *plot, uint32_t panel)
{
    if (panel == plot->shown)
        return SONJECT_OK;
    plot->shown = panel;
    return fill_cells(report, &plot->panels[panel], &plot->along_track, &plot->range, plot->values);
}

static sonject_status draw_panel(struct report *report, struct plot *plot, uint32_t number,
                                 int64_t x, int64_t y)
{
    const struct colour_scale scale = scale_of_panel(plot, number);
    const char *title = plot->panels[number].title ? plot->panels[number].title : "";
    CHECK(fill_values(report, plot, number));
    const int64_t cell_height = plot->along_track.up;
    const int64_t cell_width = plot->range.up;
    for (uint32_t row = 0; row < plot->along_track.cells; row++)
        for (uint32_t column = 0; column < plot->range.cells; column++)
            canvas_fill(
                &plot->canvas, x + column * cell_width, y + row * cell_height, cell_width,
                cell_height,
                colour_of(&scale, (double)plot->values[(size_t)row * plot->range.cells + column]));
    canvas_frame(&plot->canvas, x, y, plot->panel_width, plot->panel_height, lines);
    draw_ticks(plot, x, y);
    const size_t fitting = text_fit(title, plot->panel_width);
    draw_text(&plot->canvas, x + (plot->panel_width - text_length(title, fitting)) / 2, y - 10,
              title, fitting, TEXT_RIGHTWARDS, ink);
    if (has_bar(plot, number))
        draw_bar(plot, &scale, x + plot->panel_width + BAR_GAP, y);
    return SONJECT_OK;
}

static sonject_status choose_limits(struct report *report, struct plot *plot)
{
    plot->minimum_db = plot->frame->minimum_db;
    plot->maximum_db = plot->frame->maximum_db;
    if (isfinite(plot->minimum_db) && isfinite(plot->maximum_db) &&
        plot->minimum_db < plot->maximum_db)
        return SONJECT_OK;
    uint32_t first = 0;
    while (first < plot->count && plot->panels[first].is_difference)
        first++;
    if (first == plot->count)
        return SONJECT_OK; /* no panel needs the grey scale */
    CHECK(fill_values(report, plot, first));
    return find_limits(report, plot->values, (size_t)plot->along_track.cells * plot->range.cells,
                       &plot->minimum_db, &plot->maximum_db);
}

static sonject_status draw_all(struct report *report, struct plot *plot, struct plot_place *places)
{
    int64_t width = axis_room(plot);
    for (uint32_t i = 0; i < plot->count; i++)
        width += plot->panel_width + (has_bar(plot, i) ? bar_room(plot, i) : 0) +
                 (i + 1 < plot->count ? PANEL_GAP : MARGIN);
    const int64_t height = MARGIN + TITLE_HEIGHT + plot->panel_height + TICK_LENGTH +
                           3 * LABEL_GAP + 2 * FONT_CAPITAL_HEIGHT + FONT_DESCENT + MARGIN;
    if (!canvas_create(&plot->canvas, (uint32_t)height, (uint32_t)width, background))
        return report_out_of_memory(report, "a picture");
    const int64_t y = MARGIN + TITLE_HEIGHT;
    int64_t x = axis_room(plot);
    draw_rows_axis(plot, x, y);
    for (uint32_t i = 0; i < plot->count; i++) {
        CHECK(draw_panel(report, plot, i, x, y));
        if (places)
            places[i] = (struct plot_place){(uint32_t)x, (uint32_t)y, (uint32_t)plot->panel_width,
                                            (uint32_t)plot->panel_height};
        x += plot->panel_width + (has_bar(plot, i) ? bar_room(plot, i) : 0) + PANEL_GAP;
    }
    return SONJECT_OK;
}

sonject_status plot_panels(struct report *report, const struct plot_frame *frame,
                           const struct plot_panel *panels, uint32_t count, uint8_t **picture,
                           uint32_t *height, uint32_t *width, struct plot_place *places)
{
    *picture = NULL;
    if (frame->rows == 0 || frame->columns == 0 || count == 0 || count > PANELS_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT, "nothing to draw");
    struct plot plot;
    memset(&plot, 0, sizeof plot);
    plot.frame = frame;
    plot.panels = panels;
    plot.count = plot.shown = count;
    plot.range_label = frame->range_label ? frame->range_label : "";
    choose_scales(frame, count > 1 ? SIDE_BY_SIDE : SINGLE_PANEL, &plot.along_track, &plot.range);
    plot.panel_height = (int64_t)plot.along_track.cells * plot.along_track.up;
    plot.panel_width = (int64_t)plot.range.cells * plot.range.up;
    plot.row_ticks = axis_ticks(frame->first_along_track_m, frame->row_spacing_m, &plot.along_track,
                                plot.panel_height, TICK_EVERY_ROW);
    plot.column_ticks = axis_ticks(frame->first_range_m, frame->column_spacing_m, &plot.range,
                                   plot.panel_width, TICK_EVERY_COLUMN);
    plot.values = allocate_array((size_t)plot.along_track.cells * plot.range.cells, sizeof(float));
    sonject_status status = plot.values ? SONJECT_OK : report_out_of_memory(report, "a picture");
    THEN(status, choose_limits(report, &plot));
    THEN(status, draw_all(report, &plot, places));
    free(plot.values);
    if (status != SONJECT_OK) {
        free(plot.canvas.rgb);
        return status;
    }
    *picture = plot.canvas.rgb;
    *height = plot.canvas.height;
    *width = plot.canvas.width;
    return SONJECT_OK;
}
