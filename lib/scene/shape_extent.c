/* Support functions of the shapes. With cuts, by duality: of a convex shape within n . p <= c the
 * largest p . v is the least of h(v - t n) + t c over t >= 0, h the shape's own. */
#include <math.h>

#include "scene/cut_mesh.h"
#include "scene/shape_size.h"

#define GOLDEN      0.61803398874989485
#define STEPS       90
#define RING_SLICES 720
#define PI          3.14159265358979323846

static double end_extent(const struct end_size *end, double radius, double outward, double along,
                         double across)
{
    const double v = outward * along;
    if (end->depth_m > 0.0) {
        const double sphere = (radius * radius / end->depth_m + end->depth_m) / 2.0;
        const double centre = end->joint_m + end->depth_m - sphere;
        const double length = hypot(along, across);
        if (v * sphere >= length * (sphere - end->depth_m)) /* its normal meets the round end */
            return centre * v + sphere * length;
    }
    return end->joint_m * v + radius * across;
}

static double wedge_extent(const struct shape_size *size, const double v[3])
{
    const double x = size->half_length_m;
    const double z = size->half_height_m;
    const double corners[4][2] = {{-x, -z}, {x, -z}, {x, size->front_height_m - z}, {-x, z}};
    double extent = -INFINITY;
    for (int i = 0; i < 4; i++)
        extent = fmax(extent, corners[i][0] * v[0] + corners[i][1] * v[2]);
    return extent + size->half_width_m * fabs(v[1]);
}

static double mesh_extent(const struct mesh *mesh, const double v[3])
{
    double extent = -INFINITY;
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *p = &mesh->vertices[3 * i];
        extent = fmax(extent, p[0] * v[0] + p[1] * v[1] + p[2] * v[2]);
    }
    return extent;
}

static double user_shape_extent(const struct user_shape *shape, const double v[3])
{
    const double box = shape->half_length_m * fabs(v[0]) + shape->half_width_m * fabs(v[1]) +
                       shape->half_height_m * fabs(v[2]);
    return fmin(box, shape->bounding_radius_m * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
}

static double uncut_extent(const struct shape_size *size, uint32_t shape, const double v[3])
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const double about_nose = hypot(v[1], v[2]);
    const double level = hypot(v[0], v[1]);
    const double x = size->half_length_m * v[0];
    const double y = size->half_width_m * v[1];
    const double z = size->half_height_m * v[2];
    switch (shape) {
    case SONJECT_SHAPE_PLANE:
        return fabs(x) + fabs(y);
    case SONJECT_SHAPE_SPHERE:
        return size->radius_m * length;
    case SONJECT_SHAPE_CYLINDER:
        return fmax(end_extent(&size->nose, size->radius_m, 1.0, v[0], about_nose),
                    end_extent(&size->tail, size->radius_m, -1.0, v[0], about_nose));
    case SONJECT_SHAPE_CAPSULE:
        return fabs(x) + size->radius_m * length;
    case SONJECT_SHAPE_DISC:
        return size->radius_m * level;
    case SONJECT_SHAPE_ELLIPSOID:
        return sqrt(x * x + y * y + z * z);
    case SONJECT_SHAPE_BOX:
        return fabs(x) + fabs(y) + fabs(z);
    case SONJECT_SHAPE_WEDGE:
        return wedge_extent(size, v);
    case SONJECT_SHAPE_CONE:
    case SONJECT_SHAPE_TRUNCATED_CONE:
        return fmax(size->radius_m * level - z, size->top_radius_m * level + z);
    default:
        return size->radius_m * level + size->ring_radius_m * length;
    }
}

/* With the first `cuts` of the cuts; the shape is convex and something of it is left. */
static double convex_extent(const struct shape_size *size, uint32_t shape, uint32_t cuts,
                            const double v[3]);

/* The value of the dual at t. */
static double relaxed(const struct shape_size *size, uint32_t shape, uint32_t cuts,
                      const double v[3], double t)
{
    const struct cut_plane *cut = &size->cuts[cuts - 1];
    double turned[3];
    for (int k = 0; k < 3; k++)
        turned[k] = v[k] - t * cut->normal[k];
    return convex_extent(size, shape, cuts - 1, turned) + t * cut->offset_m;
}

static double convex_extent(const struct shape_size *size, uint32_t shape, uint32_t cuts,
                            const double v[3])
{
    if (cuts == 0)
        return uncut_extent(size, shape, v);
    double high = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0;
         i < 40 && relaxed(size, shape, cuts, v, 2.0 * high) < relaxed(size, shape, cuts, v, high);
         i++)
        high *= 2.0;
    double lower = 0.0;
    double upper = 2.0 * high;
    double least = fmin(relaxed(size, shape, cuts, v, lower), relaxed(size, shape, cuts, v, upper));
    double one = upper - GOLDEN * (upper - lower);
    double other = lower + GOLDEN * (upper - lower);
    double at_one = relaxed(size, shape, cuts, v, one);
    double at_other = relaxed(size, shape, cuts, v, other);
    for (int i = 0; i < STEPS; i++) {
        if (at_one < at_other) {
            upper = other;
            other = one;
            at_other = at_one;
            one = upper - GOLDEN * (upper - lower);
            at_one = relaxed(size, shape, cuts, v, one);
        } else {
            lower = one;
            one = other;
            at_one = at_other;
            other = lower + GOLDEN * (upper - lower);
            at_other = relaxed(size, shape, cuts, v, other);
        }
        least = fmin(least, fmin(at_one, at_other));
    }
    return least;
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

static double torus_extent(const struct shape_size *size, const double v[3])
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

/* The box and the sphere that hold a user's shape, as shapes. */
static struct shape_size sphere_about(const struct shape_size *size)
{
    struct shape_size sphere = *size;
    sphere.radius_m = size->user_shape->bounding_radius_m;
    return sphere;
}

static double cut_user_shape_extent(const struct shape_size *size, const double v[3])
{
    const struct shape_size sphere = sphere_about(size);
    return fmin(convex_extent(size, SONJECT_SHAPE_BOX, size->cut_count, v),
                convex_extent(&sphere, SONJECT_SHAPE_SPHERE, size->cut_count, v));
}

/* Whether something of a mesh is left, and not just where a plane touches it. */
static bool mesh_is_left(const struct shape_size *size)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    struct cut_plane cuts[SONJECT_CUTS_CAPACITY];
    for (uint32_t i = 0; i < size->cut_count; i++) {
        cuts[i] = size->cuts[i];
        cuts[i].offset_m -= 1e-9 * size->bounding_radius_m;
    }
    return isfinite(cut_mesh_extent(size->mesh, cuts, size->cut_count, upward));
}

bool shape_is_left(const struct shape_size *size, uint32_t shape)
{
    static const double upward[3] = {0.0, 0.0, 1.0};
    if (shape == SONJECT_SHAPE_MESH)
        return size->cut_count == 0 || mesh_is_left(size);
    if (shape == SONJECT_SHAPE_USER) {
        const struct shape_size sphere = sphere_about(size);
        return shape_is_left(size, SONJECT_SHAPE_BOX) &&
               shape_is_left(&sphere, SONJECT_SHAPE_SPHERE);
    }
    if (shape == SONJECT_SHAPE_TORUS && size->cut_count > 0)
        return isfinite(torus_extent(size, upward));
    /* nothing is left where some mean of the cuts lies beyond the whole shape */
    double lower = 0.0;
    double upper = 1.0;
    double least = INFINITY;
    for (int i = 0; i < STEPS && size->cut_count > 0; i++) {
        double values[2];
        for (int k = 0; k < 2; k++) {
            const double share =
                k == 0 ? upper - GOLDEN * (upper - lower) : lower + GOLDEN * (upper - lower);
            const struct cut_plane *one = &size->cuts[0];
            const struct cut_plane *other = &size->cuts[size->cut_count - 1];
            double back[3];
            for (int axis = 0; axis < 3; axis++)
                back[axis] = -(1.0 - share) * one->normal[axis] - share * other->normal[axis];
            values[k] = uncut_extent(size, shape, back) + (1.0 - share) * one->offset_m +
                        share * other->offset_m;
            least = fmin(least, values[k]);
        }
        if (values[0] < values[1])
            upper = lower + GOLDEN * (upper - lower);
        else
            lower = upper - GOLDEN * (upper - lower);
    }
    return least > 0.0;
}

double shape_extent(const struct shape_size *size, uint32_t shape, const double v[3])
{
    if (shape == SONJECT_SHAPE_MESH)
        return size->cut_count == 0 ? mesh_extent(size->mesh, v)
                                    : cut_mesh_extent(size->mesh, size->cuts, size->cut_count, v);
    if (size->cut_count == 0)
        return shape == SONJECT_SHAPE_USER ? user_shape_extent(size->user_shape, v)
                                           : uncut_extent(size, shape, v);
    if (shape == SONJECT_SHAPE_TORUS)
        return torus_extent(size, v);
    if (!shape_is_left(size, shape))
        return -INFINITY;
    if (shape == SONJECT_SHAPE_USER)
        return cut_user_shape_extent(size, v);
    return convex_extent(size, shape, size->cut_count, v);
}
