#include "multibounce_reference.h"

struct face_point {
    double place[3], normal[3]; /* the normal is on the side that the sound meets */
    double scale[2];            /* m per unit of the coordinates */
};

static double dot_of(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct face face_of_plane(const struct sea *sea, uint32_t part)
{
    const sonject_object_params *plane = sea_object(sea, part);
    const double half[2] = {0.5 * plane->length_m, 0.5 * plane->width_m};
    const struct face face = {part, FACE_PLANE, 0.0, {-half[0], -half[1]}, {half[0], half[1]}};
    return face;
}

static struct face_point point_at(const struct sea *sea, const struct face *face,
                                  const double at[2])
{
    const double *centre = sea_centre(sea, face->part);
    const double(*axes)[3] = sea_axes(sea, face->part);
    struct face_point point = {{0}, {0}, {1.0, 1.0}};
    double own[3] = {at[0], at[1], 0.0};
    double normal[3] = {0.0, 0.0, 1.0};
    if (face->kind == FACE_SPHERE) {
        const double direction[3] = {cos(at[0]) * cos(at[1]), cos(at[0]) * sin(at[1]), sin(at[0])};
        for (int k = 0; k < 3; k++) {
            normal[k] = direction[k];
            own[k] = face->radius * direction[k];
        }
        point.scale[0] = face->radius;
        point.scale[1] = face->radius * cos(at[0]);
    } else if (face->kind == FACE_INSIDE_TUBE) {
        own[1] = face->radius * cos(at[1]);
        own[2] = face->radius * sin(at[1]);
        normal[1] = -cos(at[1]);
        normal[2] = -sin(at[1]);
        point.scale[1] = face->radius;
    } else {
        const double to_sonar[3] = {0.0, -centre[1], sea->sonar->altitude_m - centre[2]};
        normal[2] = dot_of(axes[2], to_sonar) > 0.0 ? 1.0 : -1.0;
    }
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++) {
            point.place[k] += own[axis] * axes[axis][k] + (axis == 0 ? centre[k] : 0.0);
            point.normal[k] += normal[axis] * axes[axis][k];
        }
    return point;
}

/* A path source - one - other - source, with both sources broadside of the mean of both points. */
struct path {
    double legs[3], ways[3][3]; /* lengths, and unit vectors at the legs' beginnings */
    double last_way[3];         /* unit vector at the second leg's end */
    double length;
};

static struct path path_over(const struct multibounce_way *way, const double one[3],
                             const double other[3])
{
    const double x = 0.5 * (one[0] + other[0]);
    const double out[3] = {x, 0.0, way->height_out};
    const double home[3] = {x, 0.0, way->height_home};
    const double folded[3] = {other[0], other[1], way->is_folded ? -other[2] : other[2]};
    const double *begins[3] = {out, one, other};
    const double *ends[3] = {one, folded, home};
    struct path path;
    path.length = 0.0;
    for (int leg = 0; leg < 3; leg++) {
        for (int k = 0; k < 3; k++)
            path.ways[leg][k] = ends[leg][k] - begins[leg][k];
        path.legs[leg] = sqrt(dot_of(path.ways[leg], path.ways[leg]));
        for (int k = 0; k < 3; k++)
            path.ways[leg][k] /= path.legs[leg];
        path.length += path.legs[leg];
    }
    for (int k = 0; k < 3; k++)
        path.last_way[k] = path.ways[1][k];
    if (way->is_folded)
        path.last_way[2] = -path.last_way[2];
    return path;
}

struct multibounce_way straight_way(const struct sea *sea)
{
    const double height = sea->sonar->altitude_m;
    const struct multibounce_way way = {height, height, false};
    return way;
}

double multibounce_range(const struct multibounce_way *way, const double one[3],
                         const double other[3])
{
    return 0.5 * path_over(way, one, other).length;
}

/* The input of the search for a stationary point. */
struct search {
    const struct sea *sea;
    const struct multibounce_way *way;
    const struct face *first;
};

/* Returns the path length by the first face's point at `at`, displaced by steps of `step` m. */
static double length_by(const struct search *search, const double at[2], int one_step,
                        int other_step, double step, const double place[3])
{
    const struct face_point here = point_at(search->sea, search->first, at);
    const double displaced[2] = {at[0] + one_step * step / here.scale[0],
                                 at[1] + other_step * step / here.scale[1]};
    const struct face_point there = point_at(search->sea, search->first, displaced);
    return path_over(search->way, there.place, place).length;
}

/* The gradient and the second derivatives, 1/m, of the path length on the first face. */
struct shape_of_path {
    double gradient[2], one, other, mixed;
};

static struct shape_of_path shape_of_path(const struct search *search, const double at[2],
                                          const double place[3])
{
    const double step = 2e-4;
    const double middle = length_by(search, at, 0, 0, step, place);
    double around[2][2];
    struct shape_of_path shape;
    for (int i = 0; i < 2; i++)
        for (int sign = 0; sign < 2; sign++)
            around[i][sign] = length_by(search, at, i == 0 ? 2 * sign - 1 : 0,
                                        i == 1 ? 2 * sign - 1 : 0, step, place);
    for (int i = 0; i < 2; i++)
        shape.gradient[i] = (around[i][1] - around[i][0]) / (2.0 * step);
    shape.one = (around[0][1] - 2.0 * middle + around[0][0]) / (step * step);
    shape.other = (around[1][1] - 2.0 * middle + around[1][0]) / (step * step);
    shape.mixed =
        (length_by(search, at, 1, 1, step, place) - length_by(search, at, 1, -1, step, place) -
         length_by(search, at, -1, 1, step, place) + length_by(search, at, -1, -1, step, place)) /
        (4.0 * step * step);
    return shape;
}

/* Runs Newton's iteration from `at` in steps of at most 2 cm. Returns whether it ends on the face.
 * *has_ended: whether it ends at all. */
static bool ends_on_face(const struct search *search, double at[2], const double place[3],
                         bool *has_ended)
{
    const struct face *first = search->first;
    double size = 1.0;
    for (int i = 0; i < 60 && size > 1e-9; i++) {
        const struct shape_of_path shape = shape_of_path(search, at, place);
        const double determinant = shape.one * shape.other - shape.mixed * shape.mixed;
        const double step[2] = {
            -(shape.other * shape.gradient[0] - shape.mixed * shape.gradient[1]) / determinant,
            -(shape.one * shape.gradient[1] - shape.mixed * shape.gradient[0]) / determinant};
        size = hypot(step[0], step[1]);
        const double scale = size > 0.02 ? 0.02 / size : 1.0;
        const struct face_point here = point_at(search->sea, search->first, at);
        for (int k = 0; k < 2; k++)
            at[k] += scale * step[k] / here.scale[k];
    }
    *has_ended = size < 1e-7;
    return *has_ended && at[0] >= first->first[0] && at[0] <= first->last[0] &&
           at[1] >= first->first[1] && at[1] <= first->last[1];
}

#define STARTS 9

/* Searches from the previous solution in `at`, then from points all over the face. A plane has only
 * one stationary point, on this face or beside it. */
static bool find_stationary(const struct search *search, double at[2], const double place[3])
{
    const struct face *first = search->first;
    bool has_ended;
    if (ends_on_face(search, at, place, &has_ended) || (has_ended && first->kind == FACE_PLANE))
        return has_ended && at[0] >= first->first[0] && at[0] <= first->last[0] &&
               at[1] >= first->first[1] && at[1] <= first->last[1];
    for (int i = 0; i < STARTS * STARTS; i++) {
        const double share[2] = {(i / STARTS + 0.5) / STARTS, (i % STARTS + 0.5) / STARTS};
        for (int k = 0; k < 2; k++)
            at[k] = first->first[k] + share[k] * (first->last[k] - first->first[k]);
        if (ends_on_face(search, at, place, &has_ended))
            return true;
    }
    return false;
}

/* Returns the sound that a point of the last face gets from the first and sends home: exp(ikr)
 * times -(i/2 lambda)(cos + cos)/(r1 d) lambda e^(i pi signature/4) / sqrt|det H| for the first
 * face, times -(i/2 lambda)(cos + cos)/r2 for the last. */
static double complex echo_of_point(const struct search *search, const double at[2],
                                    const struct face_point *last, double range)
{
    const struct sea *sea = search->sea;
    const double wavelength = sea_wavelength(sea);
    const struct face_point one = point_at(sea, search->first, at);
    const struct path path = path_over(search->way, one.place, last->place);
    const double in_first = -dot_of(one.normal, path.ways[0]);
    const double out_first = dot_of(one.normal, path.ways[1]);
    const double in_last = -dot_of(last->normal, path.last_way);
    const double out_last = dot_of(last->normal, path.ways[2]);
    if (in_first <= 0.0 || out_first <= 0.0 || in_last <= 0.0 || out_last <= 0.0)
        return 0.0;
    const struct shape_of_path shape = shape_of_path(search, at, last->place);
    const double determinant = shape.one * shape.other - shape.mixed * shape.mixed;
    const double complex turn = determinant < 0.0 ? 1.0 : shape.one + shape.other > 0.0 ? I : -I;
    const double half = 0.5 * path.length;
    return -I / 2.0 * turn * (in_first + out_first) /
           (path.legs[0] * path.legs[1] * sqrt(fabs(determinant))) * -I / (2.0 * wavelength) *
           (in_last + out_last) / path.legs[2] * half * half * sea_pulse(sea, range - half) *
           cexp(2.0 * I * sea_wavenumber(sea) * half);
}

double complex multibounce_echo(const struct sea *sea, const struct multibounce_way *way,
                                const struct face *first, const struct face *last, double spacing,
                                double range)
{
    const struct search search = {sea, way, first};
    double complex sum = 0.0;
    int steps[2];
    const double middle[2] = {0.5 * (last->first[0] + last->last[0]),
                              0.5 * (last->first[1] + last->last[1])};
    const struct face_point there = point_at(sea, last, middle);
    for (int k = 0; k < 2; k++)
        steps[k] = (int)ceil((last->last[k] - last->first[k]) * there.scale[k] / spacing);
    for (int i = 0; i < steps[0]; i++) {
        double at[2] = {0.5 * (first->first[0] + first->last[0]),
                        0.5 * (first->first[1] + first->last[1])};
        for (int j = 0; j < steps[1]; j++) {
            const double share[2] = {(i + 0.5) / steps[0], (j + 0.5) / steps[1]};
            double on_last[2];
            double area = 1.0;
            for (int k = 0; k < 2; k++)
                on_last[k] = last->first[k] + share[k] * (last->last[k] - last->first[k]);
            const struct face_point point = point_at(sea, last, on_last);
            for (int k = 0; k < 2; k++)
                area *= (last->last[k] - last->first[k]) / steps[k] * point.scale[k];
            if (find_stationary(&search, at, point.place))
                sum += area * echo_of_point(&search, at, &point, range);
        }
    }
    return sum;
}
