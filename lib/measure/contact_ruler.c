/* The length and width of a contact's highlight and shadow.
 *
 * The sources of the formulas:
 * - Speckle is circular Gaussian: a mean of n independent intensities has the gamma distribution of
 *   shape n (Goodman, Speckle Phenomena in Optics, section 3.3). n is looks times pixels of a line,
 *   over the sum of the correlation: sqrt(pi) times the length at which a Gaussian falls to 1/e.
 * - An edge is the mean of its likelihood, and the deviation is its error (contact_edges.h).
 * - The point response: speckle's correlation is the square of its amplitude's autocorrelation. The
 *   deviation of a Gaussian's energy is then half the length at which that correlation is 1/e.
 *   Other responses are taken for Gaussian. 1/(2 pi^2 x^2) is the mean of sinc^2 over a side lobe.
 * - A shadow has two levels if those are e^10 times as likely as one. By chance that happens in one
 *   of some 200 shadows of 100 pixels.
 * Thresholds are conventions, not physics: those of contacts.h, and, for a shadow's near edge, the
 * geometric mean of the levels of shadow and seabed. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "measure/contact_edges.h"
#include "measure/contacts.h"

#define LOBE_BIAS_REACH 32   /* rows */
#define DEVIATION_LEAST 0.15 /* pixels; floor for finer point responses */
#define DOUBT           1.41 /* ratio by which a highlight's threshold moves to tell its doubt */
#define ROOT_OF_PI      1.7724538509055159
#define PI              3.14159265358979323846
#define EDGE_REACH      8 /* pixels beyond a part in which its edge may lie */
#define END_ROWS        4 /* rows of a highlight whose columns locate its end */
#define BANDS           3 /* bands of rows in which a shadow's edge counts as straight */
#define TILTS           8 /* tilts to either side that a far edge may have, along the highlight */
#define TILT_STEP       0.125
/* The darkest level of a shadow, as a share of the seabed's: side lobes of the seabed around a
 * shadow fill its edges. */
#define SHADOW_LEAST 0.03
/* The brightest level of a shadow with noise, as a multiple of its own level. */
#define SHADOW_CEILING 2.0
#define EDGE_MARGIN    3.0  /* columns at a shadow's edges that may be less dark */
#define DIM_GAIN       10.0 /* log likelihood from which a shadow has two levels */

/* Lines through a contact, laid along its highlight, and their mean intensities. A box's columns
 * hold at middle_row. Elsewhere they are shifted to the right, by slant for each row from
 * middle_row and by an edge's tilt for each row from tilt_row. */
struct contact_lines {
    const struct contact_image *image;
    double seabed; /* mean intensity */
    double bright; /* least intensity of a highlight */
    double slant, middle_row;
    double tilt, tilt_row;
    double *means, *lobe_bias; /* room for one profile */
};

/* Rows or columns of a box, one after the other from `start`, backwards where step is -1. */
struct profile_path {
    sonject_box box;
    bool is_along_track; /* row after row */
    size_t start;
    int step;
    size_t most; /* longest path, which also ends at the image's edge */
};

/* Returns by how many columns lines are shifted to the right in a row. */
static long line_shift(const struct contact_lines *lines, size_t row)
{
    return lround(lines->slant * ((double)row - lines->middle_row) +
                  lines->tilt * ((double)row - lines->tilt_row));
}

static double intensity_at(const struct contact_image *image, size_t row, size_t column)
{
    return (double)image->intensity[row * image->columns + column];
}

static double highlight_at(const struct contact_image *image, size_t row, size_t column)
{
    const bool is_marked = image->marks[row * image->columns + column] == PART_HIGHLIGHT;
    return is_marked ? intensity_at(image, row, column) : 0.0;
}

/* Returns what side lobes of the highlight add to a pixel: 1/(pi x)^2, halved on average. */
static double lobe_bias_at(const struct contact_image *image, size_t row, size_t column)
{
    double sum = 0.0;
    for (size_t away = 1; away <= LOBE_BIAS_REACH; away++) {
        const double share = 0.5 / (PI * PI * (double)away * (double)away);
        if (away <= row)
            sum += share * highlight_at(image, row - away, column);
        if (row + away < image->rows)
            sum += share * highlight_at(image, row + away, column);
    }
    return sum;
}

typedef double pixel_value(const struct contact_image *image, size_t row, size_t column);

static double mean_of(const struct contact_lines *lines, const sonject_box *box, pixel_value *value,
                      double otherwise)
{
    const struct contact_image *image = lines->image;
    double sum = 0.0;
    size_t count = 0;
    for (size_t row = box->first_row; row < box->first_row + box->rows; row++) {
        const long first = (long)box->first_column + line_shift(lines, row);
        for (long k = 0; k < (long)box->columns; k++) {
            if (first + k < 0 || first + k >= (long)image->columns)
                continue;
            sum += value(image, row, (size_t)(first + k));
            count++;
        }
    }
    return count > 0 ? sum / (double)count : otherwise;
}

/* Returns the mean over the box's pixels inside the image, or the seabed's if there are none. */
static double mean_along_lines(const struct contact_lines *lines, const sonject_box *box)
{
    return mean_of(lines, box, intensity_at, lines->seabed);
}

/* Returns the number of pixels for one independent sample: the sum of exp(-(x / length)^2). */
static double pixels_a_sample(double correlation_length)
{
    return fmax(1.0, ROOT_OF_PI * correlation_length);
}

/* Returns the deviation of the energy of a Gaussian response, whose speckle has the correlation
 * exp(-x^2 / (2 deviation)^2). Where that falls to 1/e within a pixel, the length is too coarse,
 * and the correlation of neighbouring pixels counts instead. */
static double deviation_of(const struct speckle_axis *axis)
{
    const double next = axis->correlation[1];
    const double deviation = axis->length_pixels > 1.0 || next >= 1.0
                                 ? 0.5 * axis->length_pixels
                                 : 0.5 / sqrt(-log(fmax(next, 1e-9)));
    return fmax(DEVIATION_LEAST, deviation);
}

/* Returns the box's row or column number k of the path. */
static sonject_box line_of(const struct profile_path *path, size_t k)
{
    const size_t index = path->step > 0 ? path->start + k : path->start - k;
    const sonject_box *box = &path->box;
    const sonject_box row = {index, box->first_column, 1, box->columns};
    const sonject_box column = {box->first_row, index, box->rows, 1};
    return path->is_along_track ? row : column;
}

/* Returns the mean intensities along a path, valid until the next call. */
static struct profile profile_along(const struct contact_lines *lines,
                                    const struct profile_path *path)
{
    const struct speckle_statistics *speckle = &lines->image->speckle;
    const struct speckle_axis *along =
        path->is_along_track ? &speckle->along_track : &speckle->range;
    const struct speckle_axis *across =
        path->is_along_track ? &speckle->range : &speckle->along_track;
    const size_t pixels = path->is_along_track ? path->box.columns : path->box.rows;
    const size_t size = path->is_along_track ? lines->image->rows : lines->image->columns;
    const size_t room = path->step > 0 ? size - path->start : path->start + 1;
    const double looks = speckle->blocks > 0 ? speckle->looks : 1.0;
    struct profile profile = {lines->means, lines->lobe_bias, 0, 0.0, 0.0};
    profile.count = room < path->most ? room : path->most;
    profile.samples = looks * fmax(1.0, (double)pixels / pixels_a_sample(across->length_pixels)) /
                      pixels_a_sample(along->length_pixels);
    profile.deviation = deviation_of(along);
    for (size_t k = 0; k < profile.count; k++) {
        const sonject_box line = line_of(path, k);
        lines->means[k] = mean_along_lines(lines, &line);
        lines->lobe_bias[k] = 0.0;
    }
    return profile;
}

/* Returns the mean intensities with the side-lobe bias of the highlight's marked pixels. Side lobes
 * lie along the track, as from an aperture without a window. */
static struct profile profile_with_lobe_bias(const struct contact_lines *lines,
                                             const struct profile_path *path)
{
    const struct profile profile = profile_along(lines, path);
    for (size_t k = 0; k < profile.count; k++) {
        const sonject_box line = line_of(path, k);
        lines->lobe_bias[k] = mean_of(lines, &line, lobe_bias_at, 0.0);
    }
    return profile;
}

static struct contact_length length_between(const struct profile_edge *a,
                                            const struct profile_edge *b)
{
    const struct contact_length length = {fmax(0.0, a->place + b->place),
                                          hypot(a->error, b->error)};
    return length;
}

/* Returns the middle third of a part's rows, at least one. */
static sonject_box middle_rows(const sonject_box *part)
{
    sonject_box middle = *part;
    middle.rows = (part->rows + 2) / 3;
    middle.first_row = part->first_row + (part->rows - middle.rows) / 2;
    return middle;
}

/* Returns the levels that tell a highlight from the seabed or darker pixels. */
static struct end_levels levels_of_highlight(const struct contact_lines *lines)
{
    const struct end_levels levels = {lines->bright, lines->seabed};
    return levels;
}

/* Lays lines along the straight line through the marked pixels of the rows. *part gets the columns
 * of these lines at the middle row, as many as an average row has. */
static void lie_along(struct contact_lines *lines, const struct contact_area *area,
                      sonject_box *part)
{
    const struct contact_image *image = lines->image;
    const double count = (double)area->pixels;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    for (size_t row = 0; row < area->box.rows; row++)
        for (size_t column = 0; column < area->box.columns; column++) {
            if (image->marks[(area->box.first_row + row) * image->columns + area->box.first_column +
                             column] != PART_HIGHLIGHT)
                continue;
            x += (double)row / count;
            y += (double)column / count;
            xx += (double)row * (double)row / count;
            xy += (double)row * (double)column / count;
        }
    const double width = count / (double)area->box.rows;
    lines->slant = xx - x * x > 0.0 ? (xy - x * y) / (xx - x * x) : 0.0;
    lines->middle_row = (double)area->box.first_row + x;
    *part = area->box;
    part->first_column += (size_t)fmax(0.0, floor(y - 0.5 * width + 0.5));
    part->columns = (size_t)fmax(1.0, width + 0.5);
}

/* Returns the columns, counted along the lines, of a highlight's marks in some of its rows. */
static sonject_box columns_marked(const struct contact_lines *lines, const sonject_box *highlight,
                                  size_t first_row, size_t rows)
{
    const struct contact_image *image = lines->image;
    long low = LONG_MAX;
    long high = 0;
    for (size_t row = first_row; row < first_row + rows; row++)
        for (size_t k = 0; k < highlight->columns; k++) {
            const size_t column = highlight->first_column + k;
            const long place = (long)column - line_shift(lines, row);
            if (image->marks[row * image->columns + column] != PART_HIGHLIGHT || place < 0)
                continue;
            low = place < low ? place : low;
            high = place > high ? place : high;
        }
    const sonject_box columns = {first_row, (size_t)(low < high ? low : high), rows,
                                 low < high ? (size_t)(high - low + 1) : 1};
    return columns;
}

/* Returns the row at which a highlight ends: among its last rows if step is 1, its first if -1. */
static struct profile_edge end_along_track(const struct contact_lines *lines,
                                           const sonject_box *highlight, int step)
{
    const struct end_levels levels = levels_of_highlight(lines);
    const size_t rows = smaller_size(END_ROWS, highlight->rows);
    const size_t inner = smaller_size(EDGE_REACH, (highlight->rows - 1) / 2);
    const size_t last =
        step > 0 ? highlight->first_row + highlight->rows - 1 : highlight->first_row;
    const sonject_box box =
        columns_marked(lines, highlight, step > 0 ? last + 1 - rows : last, rows);
    const struct profile_path path = {box, true, step > 0 ? last - inner : last + inner, step,
                                      inner + 1 + EDGE_REACH};
    const struct profile profile = profile_with_lobe_bias(lines, &path);
    struct profile_edge end = find_profile_end(&profile, &levels);
    end.place = (double)path.start + (double)step * end.place;
    return end;
}

/* Returns the width of a highlight in range, across some rows. */
static struct contact_length width_of_highlight(const struct contact_lines *lines,
                                                const sonject_box *rows)
{
    const struct end_levels levels = levels_of_highlight(lines);
    struct profile_path path = {*rows, false, rows->first_column + rows->columns / 2, 1,
                                rows->columns / 2 + EDGE_REACH + 1};
    struct profile profile = profile_with_lobe_bias(lines, &path);
    const struct profile_edge far = find_profile_end(&profile, &levels);
    path.step = -1;
    profile = profile_with_lobe_bias(lines, &path);
    const struct profile_edge near = find_profile_end(&profile, &levels);
    return length_between(&near, &far);
}

/* Returns the length along the track, from speckle alone. Leaves the lines along the highlight. */
static struct contact_length length_along_track(struct contact_lines *lines,
                                                const struct contact_area *highlight,
                                                sonject_box *along)
{
    lie_along(lines, highlight, along);
    struct profile_edge first = end_along_track(lines, &highlight->box, -1);
    const struct profile_edge last = end_along_track(lines, &highlight->box, 1);
    first.place = -first.place;
    return length_between(&first, &last);
}

/* Finds by how much the length changes along the track if the least intensity of a highlight is a
 * little lower or higher. That is much where the ends fade, or are lumps. */
static sonject_status find_doubt(struct contact_lines *lines, struct contact_image *image,
                                 struct report *report, const struct contact_place *place,
                                 double lengths[2])
{
    for (int i = 0; i < 2; i++) {
        struct contact_area area;
        sonject_box along;
        lines->bright = (i == 0 ? 1.0 / DOUBT : DOUBT) * HIGHLIGHT_OVER_SEABED * lines->seabed;
        CHECK(find_contact_highlight(image, report, place, lines->bright, &area));
        lengths[i] = area.pixels > 0 ? length_along_track(lines, &area, &along).pixels : 0.0;
    }
    lines->bright = HIGHLIGHT_OVER_SEABED * lines->seabed;
    return SONJECT_OK;
}

/* Leaves the lines along the highlight. Returns the highlight's middle column at the middle row. */
static size_t measure_highlight(struct contact_lines *lines, const double doubted[2],
                                struct contact_sizes *sizes)
{
    sonject_box along;
    struct contact_length *length = &sizes->highlight_rows;
    *length = length_along_track(lines, &sizes->highlight, &along);
    const sonject_box middle = middle_rows(&along);
    for (int i = 0; i < 2; i++)
        length->error = fmax(length->error, fabs(doubted[i] - length->pixels));
    sizes->highlight_columns = width_of_highlight(lines, &middle);
    sizes->highlight_intensity = sizes->highlight.energy / (double)sizes->highlight.pixels;
    return along.first_column + along.columns / 2;
}

/* Returns the darkest third of a shadow's columns, at least three. *level gets the mean. */
static sonject_box darkest_columns(const struct contact_lines *lines, const sonject_box *middle,
                                   double *level)
{
    sonject_box darkest = *middle;
    darkest.columns = smaller_size(middle->columns, middle->columns > 9 ? middle->columns / 3 : 3);
    sonject_box tried = darkest;
    *level = INFINITY;
    for (; tried.first_column + tried.columns <= middle->first_column + middle->columns;
         tried.first_column++) {
        const double mean = mean_along_lines(lines, &tried);
        if (mean < *level) {
            *level = mean;
            darkest = tried;
        }
    }
    return darkest;
}

/* Weighs where the seabed begins on a path from `start` in a shadow. The edge may be tilted. */
static struct edge_posterior weigh_edge_in_seabed(const struct contact_lines *lines,
                                                  const struct profile_path *path, double dark)
{
    struct edge_posterior belief;
    struct contact_lines tilted = *lines;
    const int tilts = path->box.rows > 1 && !path->is_along_track ? TILTS : 0;
    struct step_levels levels;
    step_levels_init(&levels, dark, lines->seabed);
    memset(&belief, 0, sizeof belief);
    tilted.tilt_row = (double)path->box.first_row + 0.5 * (double)(path->box.rows - 1);
    for (int i = -tilts; i <= tilts; i++) {
        tilted.tilt = TILT_STEP * i;
        const struct profile profile = profile_along(&tilted, path);
        weigh_profile_step(&belief, &profile, &levels);
    }
    return belief;
}

static struct profile_edge edge_in_seabed(const struct contact_lines *lines,
                                          const struct profile_path *path, double dark)
{
    const struct edge_posterior belief = weigh_edge_in_seabed(lines, path, dark);
    return mean_step_believed(&belief, 1);
}

/* A shadow as it is measured in range. */
struct shadow_view {
    sonject_box part;
    size_t highlight; /* a column of the highlight; core if there is none */
    size_t core;      /* a column in the dark part */
    double dark;      /* level of the dark part */
};

/* The near edge of a shadow, and the far end of the brightness before it: columns from the core. */
struct shadow_edges {
    struct profile_edge bright, near;
};

static struct edge_posterior weigh_far_edge(const struct contact_lines *lines,
                                            const struct shadow_view *shadow,
                                            const sonject_box *rows)
{
    struct profile_path path = {*rows, false, shadow->core, 1, 0};
    path.most = shadow->part.first_column + shadow->part.columns - shadow->core + EDGE_REACH;
    return weigh_edge_in_seabed(lines, &path, shadow->dark);
}

static struct shadow_edges find_near_edges(const struct contact_lines *lines,
                                           const struct shadow_view *shadow,
                                           const sonject_box *rows)
{
    struct shadow_edges edges;
    struct profile_path path = {*rows, false, shadow->core, 1, 0};
    if (shadow->highlight < shadow->core) {
        const struct end_levels bright = levels_of_highlight(lines);
        const struct end_levels lit = {sqrt(lines->seabed * shadow->dark),
                                       SHADOW_CEILING * shadow->dark};
        path.start = shadow->highlight;
        path.most = shadow->core - shadow->highlight;
        const struct profile profile = profile_with_lobe_bias(lines, &path);
        edges.bright = find_profile_end(&profile, &bright);
        edges.near = find_profile_end(&profile, &lit);
        edges.bright.place -= (double)path.most;
        edges.near.place -= (double)path.most;
    } else {
        path.step = -1;
        path.most = shadow->core - shadow->part.first_column + EDGE_REACH;
        edges.near = edge_in_seabed(lines, &path, shadow->dark);
        edges.near.place = -edges.near.place;
        edges.bright.place = edges.bright.error = NAN;
    }
    return edges;
}

/* Measures how far a first part of the shadow is brighter than the rest, between the mean edges. */
static void measure_dim_part(const struct contact_lines *lines, const struct shadow_view *shadow,
                             const sonject_box *middle, double near, struct contact_sizes *sizes)
{
    const double first = (double)shadow->core + near + EDGE_MARGIN;
    const double columns = sizes->shadow_columns.pixels - 2.0 * EDGE_MARGIN;
    const struct contact_length none = {0.0, 0.0};
    sizes->dim_columns = none;
    if (!(first >= 0.0 && first < (double)lines->image->columns && columns >= 2.0))
        return;
    const struct profile_path path = {*middle, false, (size_t)first, 1, (size_t)columns};
    const struct profile profile = profile_with_lobe_bias(lines, &path);
    const double level = sizes->shadow.energy / (double)sizes->shadow.pixels;
    double gain;
    for (size_t k = 0; k < profile.count; k++)
        lines->lobe_bias[k] /= level;
    const struct profile_edge change = find_profile_change(&profile, &gain);
    if (gain < DIM_GAIN)
        return;
    sizes->dim_columns.pixels = (double)path.start + change.place - (double)shadow->core - near;
    sizes->dim_columns.error = change.error;
}

/* Measures a shadow in range, as the mean over bands of rows, whose speckle is independent. */
static void measure_in_range(const struct contact_lines *lines, const struct shadow_view *shadow,
                             const sonject_box *middle, struct contact_sizes *sizes)
{
    const size_t bands = smaller_size(BANDS, middle->rows);
    struct edge_posterior far_edges[BANDS];
    double gap = 0.0;
    double near = 0.0;
    double near_variance = 0.0;
    double gap_variance = 0.0;
    for (size_t band = 0; band < bands; band++) {
        sonject_box rows = *middle;
        rows.first_row += band * middle->rows / bands;
        rows.rows = (band + 1) * middle->rows / bands - band * middle->rows / bands;
        const struct shadow_edges edges = find_near_edges(lines, shadow, &rows);
        far_edges[band] = weigh_far_edge(lines, shadow, &rows);
        near += edges.near.place;
        gap += edges.near.place - edges.bright.place;
        near_variance += edges.near.error * edges.near.error;
        gap_variance += edges.bright.error * edges.bright.error;
    }
    const double count = (double)bands;
    const struct profile_edge far = mean_step_believed(far_edges, bands);
    gap_variance += near_variance;
    sizes->shadow_columns.pixels = fmax(0.0, far.place - near / count);
    sizes->shadow_columns.error = hypot(far.error, sqrt(near_variance) / count);
    sizes->gap_columns.pixels = shadow->highlight < shadow->core ? fmax(0.0, gap / count) : NAN;
    sizes->gap_columns.error = sqrt(gap_variance) / count;
    measure_dim_part(lines, shadow, middle, near / count, sizes);
}

/* highlight: a column of the highlight along the lines; NULL: no highlight. */
static void measure_shadow(const struct contact_lines *lines, const size_t *highlight,
                           struct contact_sizes *sizes)
{
    const sonject_box *part = &sizes->shadow.box;
    const sonject_box middle = middle_rows(part);
    double level;
    const sonject_box darkest = darkest_columns(lines, &middle, &level);
    struct shadow_view view = {*part, 0, darkest.first_column + darkest.columns / 2, 0.0};
    view.highlight = highlight ? *highlight : view.core;
    view.dark =
        fmin(fmax(level, SHADOW_LEAST * lines->seabed), SHADOW_UNDER_SEABED * lines->seabed);
    sizes->shadow_intensity = level;
    measure_in_range(lines, &view, &middle, sizes);
    struct profile_path across = {darkest, true, part->first_row + part->rows / 2, 1,
                                  part->rows / 2 + 1 + EDGE_REACH};
    const struct profile_edge last = edge_in_seabed(lines, &across, view.dark);
    across.step = -1;
    const struct profile_edge first = edge_in_seabed(lines, &across, view.dark);
    sizes->shadow_rows = length_between(&first, &last);
}

sonject_status measure_contact_sizes(struct contact_image *image, struct report *report,
                                     const struct contact_place *place, struct contact_sizes *sizes)
{
    const struct contact_length unknown = {NAN, NAN};
    const size_t most = image->rows > image->columns ? image->rows : image->columns;
    struct contact_lines lines;
    size_t bright_column = 0;
    memset(&lines, 0, sizeof lines);
    memset(sizes, 0, sizeof *sizes);
    sizes->highlight_rows = sizes->highlight_columns = unknown;
    sizes->shadow_rows = sizes->shadow_columns = sizes->gap_columns = sizes->dim_columns = unknown;
    sizes->highlight_intensity = sizes->shadow_intensity = NAN;
    CHECK(find_seabed_level(image, report, &place->box, &sizes->seabed));
    if (!(sizes->seabed > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the image is dark around row %zu, column %zu: there is no seabed to "
                              "measure a contact against",
                              place->box.first_row, place->box.first_column);
    lines.image = image;
    lines.seabed = sizes->seabed;
    lines.means = allocate_array(most, 2 * sizeof *lines.means);
    CHECK_MEMORY(report, lines.means, "a contact's measures");
    lines.lobe_bias = lines.means + most;
    double doubted[2];
    sonject_status status = find_doubt(&lines, image, report, place, doubted);
    THEN(status, find_contact_parts(image, report, place, sizes->seabed, &sizes->highlight,
                                    &sizes->shadow));
    if (status == SONJECT_OK && sizes->highlight.pixels > 0)
        bright_column = measure_highlight(&lines, doubted, sizes);
    if (status == SONJECT_OK && sizes->shadow.pixels > 0)
        measure_shadow(&lines, sizes->highlight.pixels > 0 ? &bright_column : NULL, sizes);
    free(lines.means);
    return status;
}
