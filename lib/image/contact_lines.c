#include "image/contact_lines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define SKIRT_REACH     32   /* rows */
#define DEVIATION_LEAST 0.15 /* pixels, of a point response that is finer than they are */
#define ROOT_OF_PI      1.7724538509055159
#define PI              3.14159265358979323846

sonject_status contact_lines_create(struct contact_lines *lines, struct report *report,
                                    const struct contact_image *image)
{
    const size_t most = image->rows > image->columns ? image->rows : image->columns;
    memset(lines, 0, sizeof *lines);
    lines->image = image;
    lines->means = allocate_array(most, sizeof *lines->means);
    lines->skirt = allocate_array(most, sizeof *lines->skirt);
    return lines->means && lines->skirt ? SONJECT_OK
                                        : report_out_of_memory(report, "a contact's measures");
}

void contact_lines_clear(struct contact_lines *lines)
{
    free(lines->means);
    free(lines->skirt);
    memset(lines, 0, sizeof *lines);
}

long line_shift(const struct contact_lines *lines, size_t row)
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

/* What side lobes of the highlight bring to a pixel: sinc^2 falls as 1/(pi x)^2, and is half of
 * that on average. */
static double skirt_at(const struct contact_image *image, size_t row, size_t column)
{
    double sum = 0.0;
    for (size_t away = 1; away <= SKIRT_REACH; away++) {
        const double share = 0.5 / (PI * PI * (double)away * (double)away);
        if (away <= row)
            sum += share * highlight_at(image, row - away, column);
        if (row + away < image->rows)
            sum += share * highlight_at(image, row + away, column);
    }
    return sum;
}

typedef double pixel_value(const struct contact_image *image, size_t row, size_t column);

static double mean_of(const struct contact_lines *lines, const struct window_box *box,
                      pixel_value *value, double otherwise)
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

double mean_along_lines(const struct contact_lines *lines, const struct window_box *box)
{
    return mean_of(lines, box, intensity_at, lines->seabed);
}

/* Pixels for one that is independent: the sum of exp(-(x / length)^2) over all. */
static double pixels_a_sample(double correlation_length)
{
    return fmax(1.0, ROOT_OF_PI * correlation_length);
}

/* Of the energy of a Gaussian response, whose speckle's correlation is exp(-x^2 / (2 deviation)^2):
 * by the neighbouring pixel where that falls to 1/e between pixels, which are too far apart then to
 * tell where. */
static double deviation_of(const struct speckle_axis *axis)
{
    const double next = axis->correlation[1];
    const double deviation = axis->length_pixels > 1.0 || next >= 1.0
                                 ? 0.5 * axis->length_pixels
                                 : 0.5 / sqrt(-log(fmax(next, 1e-9)));
    return fmax(DEVIATION_LEAST, deviation);
}

/* The box's row or column that is so far along the path. */
static struct window_box line_of(const struct profile_path *path, size_t k)
{
    const size_t index = path->step > 0 ? path->start + k : path->start - k;
    struct window_box line = path->box;
    if (path->is_along_track) {
        line.first_row = index;
        line.rows = 1;
    } else {
        line.first_column = index;
        line.columns = 1;
    }
    return line;
}

struct profile profile_along(const struct contact_lines *lines, const struct profile_path *path)
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
    struct profile profile = {lines->means, lines->skirt, 0, 0.0, 0.0};
    profile.count = room < path->most ? room : path->most;
    profile.samples = looks * fmax(1.0, (double)pixels / pixels_a_sample(across->length_pixels)) /
                      pixels_a_sample(along->length_pixels);
    profile.deviation = deviation_of(along);
    for (size_t k = 0; k < profile.count; k++) {
        const struct window_box line = line_of(path, k);
        lines->means[k] = mean_along_lines(lines, &line);
        lines->skirt[k] = 0.0;
    }
    return profile;
}

struct profile profile_with_skirt(const struct contact_lines *lines,
                                  const struct profile_path *path)
{
    const struct profile profile = profile_along(lines, path);
    for (size_t k = 0; k < profile.count; k++) {
        const struct window_box line = line_of(path, k);
        lines->skirt[k] = mean_of(lines, &line, skirt_at, 0.0);
    }
    return profile;
}
