/* A ring, lying flat when level. */
#include <math.h>

#include "scene/shapes/shape.h"

#define RING_SLICES 720
#define PI          3.14159265358979323846

static void check(struct check *check, const sonject_object_params *object)
{
    if (object->diameter_m <= 2.0 * object->height_m)
        check_relation(check, "diameter", "height",
                       "of a torus is that of its outline and must be above twice its height, %g "
                       "m, or there is no hole; it is %g m",
                       2.0 * object->height_m, object->diameter_m);
}

static void init(struct shape_size *size, const sonject_object_params *object)
{
    (void)object;
    size->ring_radius_m = size->half_height_m;
    size->radius_m -= size->ring_radius_m;
    size->bounding_radius_m = size->radius_m + size->ring_radius_m;
    size->radius_about_nose_m = size->bounding_radius_m;
    /* of the ring's section, and of the hole's waist */
    size->least_radius_of_curvature_m =
        fmin(size->ring_radius_m, size->radius_m - size->ring_radius_m);
}

static double extent(const struct shape_size *size, const double v[3])
{
    return size->radius_m * hypot(v[0], v[1]) +
           size->ring_radius_m * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* A point of a ring's section (r outwards, z) against the cuts, and what it gives. */
static double section_point(const struct shape_size *size, double lines[][3], const double v[2],
                            double r, double z)
{
    for (uint32_t i = 0; i < size->cut_count; i++)
        if (lines[i][0] * r + lines[i][1] * z > lines[i][2] + 1e-9 * size->radius_m)
            return -INFINITY;
    return v[0] * r + v[1] * z;
}

/* Where a line meets the section's circle. */
static double chord_extent(const struct shape_size *size, double lines[][3], const double v[2],
                           const double line[3])
{
    const double square = line[0] * line[0] + line[1] * line[1];
    const double away = line[2] - line[0] * size->radius_m;
    const double half = size->ring_radius_m * size->ring_radius_m * square - away * away;
    if (!(square > 0.0) || half < 0.0)
        return -INFINITY;
    const double r = size->radius_m + line[0] * away / square;
    const double z = line[1] * away / square;
    const double step_r = -line[1] * sqrt(half) / square;
    const double step_z = line[0] * sqrt(half) / square;
    return fmax(section_point(size, lines, v, r + step_r, z + step_z),
                section_point(size, lines, v, r - step_r, z - step_z));
}

/* A torus is no convex shape, but each section of its ring is: a disc within lines. The extreme
 * point is the disc's own or an end of a line's chord; where two lines cross in one section, the
 * edge of both cuts goes on to the ring's surface in another, which is as extreme. */
static double section_extent(const struct shape_size *size, const double v[3], double angle)
{
    const double cosine = cos(angle);
    const double sine = sin(angle);
    const double along[2] = {v[0] * cosine + v[1] * sine, v[2]};
    double lines[SONJECT_CUTS_CAPACITY][3];
    for (uint32_t i = 0; i < size->cut_count; i++) {
        const struct cut_plane *cut = &size->cuts[i];
        lines[i][0] = cut->normal[0] * cosine + cut->normal[1] * sine;
        lines[i][1] = cut->normal[2];
        lines[i][2] = cut->offset_m;
    }
    const double length = fmax(hypot(along[0], along[1]), 1e-300);
    const double b = size->ring_radius_m;
    double extent = section_point(size, lines, along, size->radius_m + b * along[0] / length,
                                  b * along[1] / length);
    for (uint32_t i = 0; i < size->cut_count; i++)
        extent = fmax(extent, chord_extent(size, lines, along, lines[i]));
    return extent;
}

static double cut_extent(const struct shape_size *size, const double v[3])
{
    double largest = -INFINITY;
    double at = 0.0;
    for (int i = 0; i < RING_SLICES; i++) {
        const double angle = 2.0 * PI * i / RING_SLICES;
        const double extent = section_extent(size, v, angle);
        if (extent > largest) {
            largest = extent;
            at = angle;
        }
    }
    for (double step = PI / RING_SLICES; step > 1e-12; step *= 0.5)
        for (int sense = -1; sense <= 1; sense += 2) {
            const double extent = section_extent(size, v, at + sense * step);
            if (extent > largest) {
                largest = extent;
                at += sense * step;
            }
        }
    return largest;
}

static bool is_left(const struct shape_size *size)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    return isfinite(cut_extent(size, upward));
}

const struct shape shape_torus = {.needs = SHAPE_HAS_DIAMETER | SHAPE_HAS_HEIGHT,
                                  .check = check,
                                  .init = init,
                                  .extent = extent,
                                  .cut_extent = cut_extent,
                                  .is_left = is_left};
