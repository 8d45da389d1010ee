/* The page of a fit: what real contacts show beside injected ones, before and after, what was moved
 * and what could not be, with example chips. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/data_set.h"
#include "dataset/fit.h"
#include "image/canvas.h"
#include "measure/contacts.h"
#include "swath/raster_file.h"

#define BINS       20
#define BAR        12 /* pixels of the page, as all below */
#define LEFT       12
#define WIDTH      (2 * LEFT + BINS * BAR)
#define HEIGHT     176
#define BOTTOM     140
#define TOP        30
#define CELL_SIDE  150 /* of the picture */
#define CELL_GAP   6
#define ACROSS     10
#define FAR_ERRORS 3.0 /* standard errors between quantiles that do not agree */

static const char *const extent_names[EXTENT_KINDS] = {
    [EXTENT_HIGHLIGHT_ALONG] = "highlight along the track, m",
    [EXTENT_HIGHLIGHT_RANGE] = "highlight in ground range, m",
    [EXTENT_SHADOW_ALONG] = "shadow along the track, m",
    [EXTENT_SHADOW_HEIGHT] = "height that throws the shadow, m",
    [EXTENT_AXIS_LENGTH] = "longer axis of the highlight, m",
    [EXTENT_AXIS_WIDTH] = "shorter axis of the highlight, m",
    [EXTENT_HIGHLIGHT_ROWS] = "box of the highlight along the track, m",
    [EXTENT_HIGHLIGHT_COLUMNS] = "box of the highlight in ground range, m",
    [EXTENT_SHADOW_ROWS] = "box of the shadow along the track, m",
    [EXTENT_HIGHLIGHT_SLANT] = "highlight in slant range, m",
    [EXTENT_SHADOW_SLANT] = "shadow in slant range, m",
    [EXTENT_HIGHLIGHT_LEVEL] = "highlight over the seabed, dB",
    [EXTENT_SHADOW_LEVEL] = "shadow over the seabed, dB"};

static void add_escaped(struct growing_text *text, const char *raw)
{
    for (; *raw; raw++)
        if (strchr("<>&\"'", *raw))
            growing_text_add(text, "&#%d;", *raw);
        else
            growing_text_add(text, "%c", *raw);
}

/* Whose contacts. */
enum series {
    SERIES_REAL,
    SERIES_BEFORE,
    SERIES_AFTER,
    SERIES_KINDS
};

/* What contacts of a series show of an extent, in m or dB. values: room for all. */
static size_t list_values(const struct fit *fit, size_t extent, enum series series, double *values)
{
    const uint32_t round = series == SERIES_BEFORE ? 0 : FIT_ROUNDS - 1;
    size_t n = 0;
    for (size_t i = 0; series == SERIES_REAL && i < fit->real_count; i++)
        values[n++] = fit->real[i].of[extent];
    for (size_t i = 0; series != SERIES_REAL && i < fit->made_count; i++)
        if (fit->made[i].round == round)
            values[n++] = fit->made[i].shown.of[extent];
    size_t kept = 0;
    for (size_t i = 0; i < n; i++)
        if (isfinite(values[i]))
            values[kept++] = extent < EXTENT_LENGTHS ? exp(values[i]) : values[i];
    return kept;
}

/* The share of each bin: bars for real contacts, steps for injected ones. */
static void write_series(struct growing_text *text, const double *values, size_t count, double low,
                         double high, enum series series)
{
    static const char *const styles[SERIES_KINDS] = {
        [SERIES_BEFORE] = "fill=\"none\" stroke=\"#b06020\" stroke-dasharray=\"4 3\"",
        [SERIES_AFTER] = "fill=\"none\" stroke=\"#103060\" stroke-width=\"2\""};
    double bins[BINS] = {0.0};
    for (size_t i = 0; i < count; i++) {
        const double place = (values[i] - low) / (high - low) * BINS;
        bins[(int)fmin(fmax(place, 0.0), BINS - 1)] += 1.0 / (double)count;
    }
    if (series != SERIES_REAL)
        growing_text_add(text, "<path %s d=\"M%d %d", styles[series], LEFT, BOTTOM);
    for (int i = 0; i < BINS; i++) {
        /* a third of all in one bin fills the height */
        const int height = (int)lround((BOTTOM - TOP) * fmin(1.0, 3.0 * bins[i]));
        if (series == SERIES_REAL)
            growing_text_add(
                text, "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#a8c4e0\"/>",
                LEFT + i * BAR, BOTTOM - height, BAR - 1, height);
        else
            growing_text_add(text, "V%dH%d", BOTTOM - height, LEFT + (i + 1) * BAR);
    }
    if (series != SERIES_REAL)
        growing_text_add(text, "V%d\"/>", BOTTOM);
}

/* values: room for all of a series. */
static void write_histogram(const struct fit *fit, size_t extent, double *values,
                            struct growing_text *text)
{
    double low = INFINITY;
    double high = -INFINITY;
    char ends[2][40];
    for (int series = 0; series < SERIES_KINDS; series++) {
        const size_t n = list_values(fit, extent, (enum series)series, values);
        if (n == 0)
            continue;
        qsort(values, n, sizeof *values, compare_doubles);
        low = fmin(low, sorted_quantile(values, n, 0.02));
        high = fmax(high, sorted_quantile(values, n, 0.98));
    }
    if (!(high > low))
        return;
    growing_text_add(text,
                     "<svg width=\"%d\" height=\"%d\" font-size=\"12\"><text x=\"%d\" "
                     "y=\"16\">%s</text>",
                     WIDTH, HEIGHT, LEFT, extent_names[extent]);
    for (int series = 0; series < SERIES_KINDS; series++) {
        const size_t n = list_values(fit, extent, (enum series)series, values);
        if (n > 0)
            write_series(text, values, n, low, high, (enum series)series);
    }
    growing_text_add(text,
                     "<path d=\"M%d %dH%d\" stroke=\"#000\"/><text x=\"%d\" y=\"%d\">%s</text>"
                     "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%s</text></svg>\n",
                     LEFT, BOTTOM, WIDTH - LEFT, LEFT, BOTTOM + 16,
                     text_of_number(ends[0], sizeof ends[0], low, 3), WIDTH - LEFT, BOTTOM + 16,
                     text_of_number(ends[1], sizeof ends[1], high, 3));
}

/* Extents whose quantiles injected contacts do not reach. */
static void write_unmatched(const struct fit *fit, double *values, struct growing_text *text)
{
    bool has_some = false;
    for (size_t k = 0; k < EXTENT_KINDS; k++) {
        const struct quantile_goal *goal = &fit->goals[k];
        const size_t n = list_values(fit, k, SERIES_AFTER, values);
        double farthest = 0.0;
        if (goal->levels == 0 || n == 0)
            continue;
        qsort(values, n, sizeof *values, compare_doubles);
        const double half = sorted_quantile(values, n, 0.75) - sorted_quantile(values, n, 0.25);
        const double middle = sorted_quantile(values, n, 0.5);
        for (size_t i = 0; i < goal->levels; i++) {
            const double value = sorted_quantile(values, n, goal->level[i]);
            const bool is_length = k < EXTENT_LENGTHS;
            const double own =
                quantile_error(goal->level[i], is_length ? half / middle : half, (double)n);
            farthest = fmax(farthest, fabs((is_length ? log(value) : value) - goal->value[i]) /
                                          hypot(goal->error[i], own));
        }
        if (farthest > FAR_ERRORS)
            growing_text_add(
                text, "%s<li>%s: quantiles differ by up to %.1f standard errors</li>\n",
                has_some ? "" : "<h2>Not matched</h2>\n<ul>", extent_names[k], farthest);
        has_some = has_some || farthest > FAR_ERRORS;
    }
    growing_text_add(text, "%s", has_some ? "</ul>\n" : "");
}

static void write_row(struct growing_text *text, const char *key, const char *before,
                      const char *after)
{
    growing_text_add(text, "<tr><td>%s</td><td>%s</td><td>%s</td></tr>\n", key, before, after);
}

/* Numbers before and after, in the order in which a key has them. */
static void write_moves(const struct fit *fit, struct growing_text *text)
{
    const struct fit_draws *draws = &fit->draws;
    const struct fitted_selection *selection = &fit->selection;
    char value[80];
    growing_text_add(text, "<h2>Draws</h2>\n<table><tr><th>key</th><th>before</th><th>fitted</th>"
                           "</tr>\n");
    for (size_t i = 0, end; i < draws->count; i = end) {
        struct growing_text before = {NULL, 0, 0, false};
        struct growing_text after = {NULL, 0, 0, false};
        for (end = i;
             end < draws->count && strcmp(draws->numbers[end].key, draws->numbers[i].key) == 0;
             end++) {
            const struct fitted_number *number = &draws->numbers[end];
            char digits[32];
            growing_text_add(&before, "%s%s%s", end > i ? ", " : "",
                             text_of_number(digits, sizeof digits, number->start, 3), number->unit);
            growing_text_add(&after, "%s%s%s", end > i ? ", " : "",
                             text_of_number(digits, sizeof digits, number->value, 3), number->unit);
        }
        char *was = growing_text_end(&before);
        char *is = growing_text_end(&after);
        write_row(text, draws->numbers[i].key, was ? was : "", is ? is : "");
        free(was);
        free(is);
    }
    for (uint32_t i = 0; draws->has_added && i < draws->campaign->target_count; i++) {
        char key[64];
        if (!draws->lacks_level[i])
            continue;
        snprintf(key, sizeof key, "targets[%u].draw.level.over_seabed", (unsigned)i);
        snprintf(value, sizeof value, "%.1f dB, %.1f dB", draws->level_db[0], draws->level_db[1]);
        write_row(text, key, "by shape and material", value);
    }
    if (draws->has_added && draws->lacks_floor) {
        snprintf(value, sizeof value, "%.1f dB", draws->floor_db);
        write_row(text, "draw.injection.noise_floor", "the scene's", value);
    }
    if (isfinite(selection->highlight_db)) {
        snprintf(value, sizeof value, "%.1f dB", selection->highlight_db);
        write_row(text, "visible.highlight", "", value);
    }
    if (isfinite(selection->shadow_db)) {
        snprintf(value, sizeof value, "%.1f dB", selection->shadow_db);
        write_row(text, "visible.shadow", "", value);
    }
    if (isfinite(selection->nearest_range_m)) {
        snprintf(value, sizeof value, "%.3g m, %.3g m", selection->nearest_range_m,
                 selection->farthest_range_m);
        write_row(text, "chip.slant_range", "", value);
    }
    growing_text_add(text, "</table>\n");
    if (fit->has_no_such_ranges)
        growing_text_add(text, "<p>The campaign's swaths do not reach the slant ranges of the "
                               "contacts; its chips lie where they lay.</p>\n");
    if (draws->unchanged.characters)
        growing_text_add(text, "<p>Not observed in contacts, and unchanged:</p>\n<pre>%s</pre>\n",
                         draws->unchanged.characters);
}

static sonject_status write_page(const struct fit *fit, const char *picture, const char *path)
{
    const size_t most = fit->real_count > fit->made_count ? fit->real_count : fit->made_count;
    double *values = allocate_array(most + 1, sizeof *values);
    struct growing_text text = {NULL, 0, 0, false};
    CHECK_MEMORY(fit->report, values, "the page");
    growing_text_add(
        &text,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Fit</title>"
        "<style>body{font-family:sans-serif;margin:2em;max-width:1100px}"
        "table{border-collapse:collapse;margin:1em 0}svg{margin:.5em}"
        "td,th{border:1px solid #999;padding:.2em .6em;text-align:left}</style></head><body>\n"
        "<h1>A campaign fitted to %zu contacts</h1>\n"
        "<p>Bars: real contacts. Dashed: injected, before. Line: injected, after. All are measured "
        "by the same ruler.</p>\n",
        fit->real_count > 0 ? fit->set.count : (size_t)fit->set.quantiles.contacts);
    for (size_t k = 0; k < EXTENT_KINDS; k++)
        if (fit->goals[k].levels > 0)
            write_histogram(fit, k, values, &text);
    write_unmatched(fit, values, &text);
    write_moves(fit, &text);
    growing_text_add(&text, "<h2>Chips</h2>\n<p>Real contacts above, injected ones below.</p>\n"
                            "<p><img src=\"");
    add_escaped(&text, picture);
    growing_text_add(&text, "\" alt=\"chips\"></p>\n</body></html>\n");
    free(values);
    return growing_text_write(fit->report, &text, path);
}

/* ---- The picture. */

/* A chip in dB about its median, the same scale for all. */
static sonject_status draw_chip(struct report *report, struct canvas *canvas,
                                const struct contact_chip *chip, int64_t x, int64_t y)
{
    const size_t count = chip->rows * chip->columns;
    float *sorted = allocate_array(count, sizeof *sorted);
    CHECK_MEMORY(report, sorted, "the page");
    memcpy(sorted, chip->intensity, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_floats);
    const double median_db = 10.0 * log10(fmax((double)sorted[count / 2], 1e-30));
    free(sorted);
    const sonject_box *label = &chip->label;
    const double scale =
        fmin(1.0, CELL_SIDE / (double)(chip->rows > chip->columns ? chip->rows : chip->columns));
    for (int64_t i = 0; i < (int64_t)((double)chip->rows * scale); i++)
        for (int64_t j = 0; j < (int64_t)((double)chip->columns * scale); j++) {
            const size_t at =
                (size_t)((double)i / scale) * chip->columns + (size_t)((double)j / scale);
            const double db = 10.0 * log10(fmax((double)chip->intensity[at], 1e-30)) - median_db;
            const uint8_t grey = (uint8_t)(255.0 * fmin(fmax((db + 14.0) / 34.0, 0.0), 1.0));
            canvas_fill(canvas, x + j, y + i, 1, 1, (struct colour){grey, grey, grey});
        }
    canvas_frame(canvas, x + (int64_t)((double)label->first_column * scale),
                 y + (int64_t)((double)label->first_row * scale),
                 (int64_t)((double)label->columns * scale), (int64_t)((double)label->rows * scale),
                 (struct colour){255, 160, 0});
    return SONJECT_OK;
}

static sonject_status draw_chips(struct report *report, struct canvas *canvas,
                                 const struct contact_chip *chips, size_t count, size_t first_row)
{
    for (size_t i = 0; i < count; i++)
        CHECK(draw_chip(report, canvas, &chips[i],
                        CELL_GAP + (int64_t)(i % ACROSS) * (CELL_SIDE + CELL_GAP),
                        CELL_GAP + (int64_t)(first_row + i / ACROSS) * (CELL_SIDE + CELL_GAP)));
    return SONJECT_OK;
}

static sonject_status write_picture(const struct fit *fit, const char *path)
{
    const size_t real_rows = (fit->real_chip_count + ACROSS - 1) / ACROSS;
    const size_t made_rows = (fit->made_chip_count + ACROSS - 1) / ACROSS;
    struct canvas canvas;
    if (!canvas_create(&canvas,
                       CELL_GAP + (uint32_t)(real_rows + made_rows) * (CELL_SIDE + CELL_GAP),
                       CELL_GAP + ACROSS * (CELL_SIDE + CELL_GAP), (struct colour){255, 255, 255}))
        return report_out_of_memory(fit->report, "the page");
    sonject_status status =
        draw_chips(fit->report, &canvas, fit->real_chips, fit->real_chip_count, 0);
    THEN(status,
         draw_chips(fit->report, &canvas, fit->made_chips, fit->made_chip_count, real_rows));
    if (status == SONJECT_OK) {
        const struct raster_layout layout = {canvas.height, canvas.width, 3, PIXEL_UINT8};
        status = raster_file_write(fit->report, path, &layout, NULL, NULL, 0, canvas.rgb);
    }
    free(canvas.rgb);
    return status;
}

sonject_status fit_page_name(struct report *report, const char *fitted, const char *extension,
                             char path[PATH_CAPACITY])
{
    const char *dot = strrchr(path_name(fitted), '.');
    const int stem = (int)(dot ? dot - fitted : (long)strlen(fitted));
    return path_in(report, path, "", "%.*s%s", stem, fitted, extension);
}

sonject_status fit_page_write(const struct fit *fit, const char *fitted)
{
    char path[PATH_CAPACITY], picture[PATH_CAPACITY];
    CHECK(fit_page_name(fit->report, fitted, ".png", picture));
    CHECK(fit_page_name(fit->report, fitted, ".html", path));
    CHECK(write_picture(fit, picture));
    return write_page(fit, path_name(picture), path);
}
