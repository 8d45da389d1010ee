/* The page of a fit: measures of real and injected contacts, before and after, moved numbers,
 * measures that do not match, and example chips. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json_document.h"
#include "base/memory.h"
#include "base/text.h"
#include "dataset/data_set.h"
#include "dataset/fit.h"
#include "dataset/run.h"
#include "image/canvas.h"
#include "measure/contacts.h"
#include "swath/raster_file.h"

#define DIGITS     6   /* digits of the page's numbers */
#define CELL_SIDE  150 /* pixels of the picture, also for the gap */
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

/* The series of contacts. */
enum series {
    SERIES_REAL,
    SERIES_BEFORE,
    SERIES_AFTER,
    SERIES_KINDS
};

/* Lists an extent of a series' contacts, m or dB, and returns how many. values: room for all. */
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

/* Returns a histogram of an extent over all series; null where all contacts show the same. values:
 * room for all of a series. */
static json_t *histogram_document(const struct fit *fit, size_t extent, double *values)
{
    double low = INFINITY;
    double high = -INFINITY;
    json_t *bins[SERIES_KINDS];
    for (int series = 0; series < SERIES_KINDS; series++) {
        const size_t n = list_values(fit, extent, (enum series)series, values);
        if (n == 0)
            continue;
        qsort(values, n, sizeof *values, compare_doubles);
        low = fmin(low, sorted_quantile(values, n, 0.02));
        high = fmax(high, sorted_quantile(values, n, 0.98));
    }
    if (!(high > low))
        return json_null();
    for (int series = 0; series < SERIES_KINDS; series++) {
        const size_t n = list_values(fit, extent, (enum series)series, values);
        bins[series] = histogram_counts(values, n, low, high);
    }
    return JSON_OBJECT({"name", json_string(extent_names[extent])}, {"unit", json_string("")},
                       {"low", json_number(low)}, {"high", json_number(high)},
                       {"bins", bins[SERIES_REAL]}, {"before", bins[SERIES_BEFORE]},
                       {"after", bins[SERIES_AFTER]});
}

static json_t *histograms_document(const struct fit *fit, double *values)
{
    json_t *histograms = json_array();
    for (size_t k = 0; k < EXTENT_KINDS; k++)
        if (fit->goals[k].levels > 0)
            json_append(&histograms, histogram_document(fit, k, values));
    return histograms;
}

/* Returns the largest distance of quantiles of injected contacts from real ones, standard errors;
 * 0: unknown. */
static double farthest_quantile(const struct fit *fit, size_t extent, double *values)
{
    const struct quantile_goal *goal = &fit->goals[extent];
    const size_t n = list_values(fit, extent, SERIES_AFTER, values);
    const bool is_length = extent < EXTENT_LENGTHS;
    double farthest = 0.0;
    if (n == 0)
        return 0.0;
    qsort(values, n, sizeof *values, compare_doubles);
    const double half = sorted_quantile(values, n, 0.75) - sorted_quantile(values, n, 0.25);
    const double middle = sorted_quantile(values, n, 0.5);
    for (size_t i = 0; i < goal->levels; i++) {
        const double value = sorted_quantile(values, n, goal->level[i]);
        const double own =
            quantile_error(goal->level[i], is_length ? half / middle : half, (double)n);
        farthest = fmax(farthest, fabs((is_length ? log(value) : value) - goal->value[i]) /
                                      hypot(goal->error[i], own));
    }
    return farthest;
}

/* Returns the extents whose quantiles injected contacts do not reach. */
static json_t *unmatched_document(const struct fit *fit, double *values)
{
    json_t *unmatched = json_object();
    for (size_t k = 0; k < EXTENT_KINDS; k++) {
        const double farthest = farthest_quantile(fit, k, values);
        if (farthest > FAR_ERRORS)
            json_add(&unmatched, extent_names[k], json_number(farthest));
    }
    return unmatched;
}

static json_t *quantity(double value, const char *unit)
{
    char digits[32], text[64];
    snprintf(text, sizeof text, "%s%s", text_of_number(digits, sizeof digits, value, 3), unit);
    return json_string(text);
}

/* Returns one or two numbers, those that are finite; `otherwise` where the first is not. */
static json_t *numbers_document(double first, double second, const char *unit,
                                const char *otherwise)
{
    json_t *numbers = json_array();
    if (!isfinite(first))
        json_append(&numbers, json_string(otherwise));
    else
        json_append(&numbers, quantity(first, unit));
    if (isfinite(first) && isfinite(second))
        json_append(&numbers, quantity(second, unit));
    return numbers;
}

/* Adds a key with its value before and its one or two numbers now, if the first is finite. */
static void add_row(json_t **rows, const char *key, json_t *before, double first, double second,
                    const char *unit)
{
    if (isfinite(first))
        json_append(rows, JSON_OBJECT({"key", json_string(key)}, {"before", before},
                                      {"after", numbers_document(first, second, unit, "")}));
    else
        json_decref(before);
}

static void add_threshold(json_t **rows, const char *key, double before, double now)
{
    add_row(rows, key, numbers_document(before, NAN, " dB", "any"), now, NAN, " dB");
}

static void add_ratio(json_t **rows, const char *key, const struct ratio_limits *before,
                      const struct ratio_limits *now)
{
    const double least = before->least > 0.0 ? before->least : NAN;
    if (now->least > 0.0)
        add_row(rows, key, numbers_document(least, before->most, "", "any"), now->least, now->most,
                "");
}

/* Returns the numbers before and after, in the order in which a key has them. */
static json_t *draws_document(const struct fit *fit)
{
    const struct fit_draws *draws = &fit->draws;
    const struct fitted_selection *selection = &fit->selection;
    const struct campaign *campaign = draws->campaign;
    json_t *rows = json_array();
    for (size_t i = 0, end; i < draws->count; i = end) {
        const char *key = draws->numbers[i].key;
        json_t *before = json_array();
        json_t *after = json_array();
        for (end = i; end < draws->count && strcmp(draws->numbers[end].key, key) == 0; end++) {
            const struct fitted_number *number = &draws->numbers[end];
            json_append(&before, quantity(number->start, number->unit));
            json_append(&after, quantity(number->value, number->unit));
        }
        json_append(&rows,
                    JSON_OBJECT({"key", json_string(key)}, {"before", before}, {"after", after}));
    }
    for (uint32_t i = 0; draws->has_added && i < campaign->target_count; i++) {
        char key[64];
        snprintf(key, sizeof key, "targets[%u].draw.level.over_seabed", (unsigned)i);
        if (draws->lacks_level[i])
            add_row(&rows, key, json_pack("[s]", "by shape and material"), draws->level_db[0],
                    draws->level_db[1], " dB");
    }
    if (draws->has_added && draws->lacks_floor)
        add_row(&rows, "draw.injection.noise_floor", json_pack("[s]", "the scene's"),
                draws->floor_db, NAN, " dB");
    add_threshold(&rows, "visible.highlight", campaign->visible_highlight_db,
                  selection->highlight_db);
    add_threshold(&rows, "visible.shadow", campaign->visible_shadow_db, selection->shadow_db);
    add_ratio(&rows, "chip.range_over_altitude", &campaign->ratio, &selection->chip);
    for (size_t i = 0; selection->swaths && i < campaign->swath_count; i++) {
        char key[64];
        snprintf(key, sizeof key, "swaths[%zu].range_over_altitude", i);
        add_ratio(&rows, key, &campaign->swaths[i].ratio, &selection->swaths[i]);
    }
    return rows;
}

static sonject_status write_page(const struct fit *fit, const char *picture, const char *path)
{
    const size_t most = fit->real_count > fit->made_count ? fit->real_count : fit->made_count;
    const char *unchanged = fit->draws.unchanged.characters;
    const char *fixed = fit->draws.fixed.characters;
    const char *notes = fit->notes.characters;
    double *values = allocate_array(most + 1, sizeof *values);
    CHECK_MEMORY(fit->report, values, "the page");
    json_t *classes = json_array();
    for (size_t i = 0; i < fit->choice.class_count; i++)
        json_append(&classes, json_text(fit->choice.classes[i]));
    json_t *unmatched = unmatched_document(fit, values);
    if (json_object_size(unmatched) > 0)
        report_note(fit->report,
                    "%zu measures of injected contacts do not match those of real ones: see %s, "
                    "Not matched%s%s",
                    json_object_size(unmatched), path, fixed ? "; " : "", fixed ? fixed : "");
    json_t *page = JSON_OBJECT(
        {"sonject", json_string(sonject_version())},
        {"contacts",
         json_count(fit->real_count > 0 ? fit->set.count : (uint64_t)fit->set.quantiles.contacts)},
        {"classes", classes}, {"fit", histograms_document(fit, values)}, {"unmatched", unmatched},
        {"draws", draws_document(fit)}, {"unchanged", json_string(unchanged ? unchanged : "")},
        {"notes", json_string(notes ? notes : "")}, {"picture", json_text(picture)});
    free(values);
    return report_page_write(fit->report, page, DIGITS, path);
}

/* ---- The picture. */

/* Returns the picture's pixels per metre, the same for all chips: the longest fills its place. */
static double chip_scale(const struct contact_chip *chips, size_t count, double scale)
{
    for (size_t i = 0; i < count; i++)
        scale = fmin(scale, CELL_SIDE / fmax((double)chips[i].rows * chips[i].row_spacing_m,
                                             (double)chips[i].columns * chips[i].column_spacing_m));
    return scale;
}

/* Draws a chip in dB about its median. Sizes and grey levels are alike for all chips. */
static sonject_status draw_chip(struct report *report, struct canvas *canvas,
                                const struct contact_chip *chip, double scale, int64_t x, int64_t y)
{
    const size_t count = chip->rows * chip->columns;
    float *sorted = allocate_array(count, sizeof *sorted);
    CHECK_MEMORY(report, sorted, "the page");
    memcpy(sorted, chip->intensity, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_floats);
    const double median_db = 10.0 * log10(fmax((double)sorted[count / 2], 1e-30));
    free(sorted);
    const sonject_box *label = &chip->label;
    const double down = scale * chip->row_spacing_m, across = scale * chip->column_spacing_m;
    const uint32_t sides[2] = {(uint32_t)fmax(1.0, floor(down * (double)chip->rows)),
                               (uint32_t)fmax(1.0, floor(across * (double)chip->columns))};
    for (uint32_t i = 0; i < sides[0]; i++)
        for (uint32_t j = 0; j < sides[1]; j++) {
            const size_t at =
                i * chip->rows / sides[0] * chip->columns + j * chip->columns / sides[1];
            const double db = 10.0 * log10(fmax((double)chip->intensity[at], 1e-30)) - median_db;
            const uint8_t grey = (uint8_t)(255.0 * fmin(fmax((db + 14.0) / 34.0, 0.0), 1.0));
            canvas_fill(canvas, x + j, y + i, 1, 1, (struct colour){grey, grey, grey});
        }
    canvas_frame(canvas, x + (int64_t)((double)label->first_column * across),
                 y + (int64_t)((double)label->first_row * down),
                 (int64_t)((double)label->columns * across), (int64_t)((double)label->rows * down),
                 (struct colour){255, 160, 0});
    return SONJECT_OK;
}

static sonject_status draw_chips(struct report *report, struct canvas *canvas,
                                 const struct contact_chip *chips, size_t count, double scale,
                                 size_t first_row)
{
    for (size_t i = 0; i < count; i++)
        CHECK(draw_chip(report, canvas, &chips[i], scale,
                        CELL_GAP + (int64_t)(i % ACROSS) * (CELL_SIDE + CELL_GAP),
                        CELL_GAP + (int64_t)(first_row + i / ACROSS) * (CELL_SIDE + CELL_GAP)));
    return SONJECT_OK;
}

static sonject_status write_picture(const struct fit *fit, const char *path)
{
    const size_t real_rows = (fit->real_chip_count + ACROSS - 1) / ACROSS;
    const size_t made_rows = (fit->made_chip_count + ACROSS - 1) / ACROSS;
    const double scale = chip_scale(fit->made_chips, fit->made_chip_count,
                                    chip_scale(fit->real_chips, fit->real_chip_count, INFINITY));
    struct canvas canvas;
    if (!canvas_create(&canvas,
                       CELL_GAP + (uint32_t)(real_rows + made_rows) * (CELL_SIDE + CELL_GAP),
                       CELL_GAP + ACROSS * (CELL_SIDE + CELL_GAP), (struct colour){255, 255, 255}))
        return report_out_of_memory(fit->report, "the page");
    sonject_status status =
        draw_chips(fit->report, &canvas, fit->real_chips, fit->real_chip_count, scale, 0);
    THEN(status,
         draw_chips(fit->report, &canvas, fit->made_chips, fit->made_chip_count, scale, real_rows));
    return picture_write(fit->report, status, &canvas, path);
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
