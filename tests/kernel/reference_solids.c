#include "reference_solids.h"

#include <complex.h>

static double value_at(const struct surface *surface, struct point p)
{
    const double *n = surface->numbers;
    switch (surface->kind) {
    case PLANE:
        return n[0] * p.x + n[1] * p.y + n[2] * p.z - n[3];
    case BALL:
        return pow(p.x - n[0], 2.0) + p.y * p.y + p.z * p.z - n[1] * n[1];
    case TUBE:
        return p.y * p.y + p.z * p.z - n[0] * n[0];
    case ELLIPSOID:
        return pow(p.x / n[0], 2.0) + pow(p.y / n[1], 2.0) + pow(p.z / n[2], 2.0) - 1.0;
    case CONE:
        return p.x * p.x + p.y * p.y - pow(n[0] + n[1] * p.z, 2.0);
    case TORUS:
        return pow(dot(p, p) + n[0] * n[0] - n[1] * n[1], 2.0) -
               4.0 * n[0] * n[0] * (p.x * p.x + p.y * p.y);
    }
    return NAN;
}

static struct point gradient_at(const struct surface *surface, struct point p, double step)
{
    const struct point x = {step, 0.0, 0.0};
    const struct point y = {0.0, step, 0.0};
    const struct point z = {0.0, 0.0, step};
    const struct point gradient = {
        (value_at(surface, add(p, x, 1.0)) - value_at(surface, add(p, x, -1.0))) / (2.0 * step),
        (value_at(surface, add(p, y, 1.0)) - value_at(surface, add(p, y, -1.0))) / (2.0 * step),
        (value_at(surface, add(p, z, 1.0)) - value_at(surface, add(p, z, -1.0))) / (2.0 * step)};
    return gradient;
}

static struct surface *add_surface(struct body *body, enum surface_kind kind, double a, double b,
                                   double c, double d)
{
    const struct surface surface = {kind, {a, b, c, d}, -INFINITY, INFINITY};
    body->surfaces[body->count] = surface;
    return &body->surfaces[body->count++];
}

static void build_plane(struct body *body, const sonject_object_params *solid, double more)
{
    add_surface(body, PLANE, 0.0, 0.0, 1.0, 0.0);
    body->is_thin = 1;
    body->half_length = 0.5 * solid->length_m + more;
    body->half_width = 0.5 * solid->width_m + more;
}

static void build_disc(struct body *body, const sonject_object_params *solid, double more)
{
    add_surface(body, PLANE, 0.0, 0.0, 1.0, 0.0);
    body->is_thin = 1;
    body->rim = 0.5 * solid->diameter_m + more;
}

static void build_sphere(struct body *body, const sonject_object_params *solid, double more)
{
    add_surface(body, BALL, 0.0, 0.5 * solid->diameter_m + more, 0.0, 0.0);
}

static void build_ellipsoid(struct body *body, const sonject_object_params *solid, double more)
{
    add_surface(body, ELLIPSOID, 0.5 * solid->length_m + more, 0.5 * solid->width_m + more,
                0.5 * solid->height_m + more, 0.0);
}

static void build_torus(struct body *body, const sonject_object_params *solid, double more)
{
    add_surface(body, TORUS, 0.5 * (solid->diameter_m - solid->height_m),
                0.5 * solid->height_m + more, 0.0, 0.0);
}

static void fit_torus(sonject_object_params *solid, double thinnest)
{
    solid->height_m = solid->diameter_m * uniform(thinnest, 0.48);
}

static void build_box(struct body *body, const sonject_object_params *solid, double more)
{
    const double x = 0.5 * solid->length_m + more;
    const double y = 0.5 * solid->width_m + more;
    const double z = 0.5 * solid->height_m + more;
    for (int sense = -1; sense <= 1; sense += 2) {
        add_surface(body, PLANE, sense, 0.0, 0.0, x);
        add_surface(body, PLANE, 0.0, sense, 0.0, y);
        add_surface(body, PLANE, 0.0, 0.0, sense, z);
    }
}

/* Builds a wedge. Its top goes through the upper edges of tail and nose. */
static void build_wedge(struct body *body, const sonject_object_params *solid, double more)
{
    const double fall = (solid->height_m - solid->front_height_m) / solid->length_m;
    const double length = sqrt(1.0 + fall * fall);
    const double middle = 0.5 * solid->front_height_m; /* height of the top over x = 0 */
    build_box(body, solid, more);
    body->surfaces[body->count - 1].numbers[3] += solid->height_m; /* lifts the level top away */
    add_surface(body, PLANE, fall / length, 0.0, 1.0 / length, middle / length + more);
}

static void fit_wedge(sonject_object_params *solid, double thinnest)
{
    (void)thinnest;
    solid->front_height_m = uniform(0.0, 1.0) < 0.3 ? 0.0 : uniform(0.0, solid->height_m);
}

static void add_end(struct body *body, const sonject_object_params *solid, double outward,
                    uint32_t kind, double depth, double more, struct surface *side)
{
    const double radius = 0.5 * solid->diameter_m;
    const double tip = 0.5 * solid->length_m;
    if (kind == SONJECT_END_SPHERICAL) {
        const double h = depth > 0.0 ? depth : radius;
        const double ball = (radius * radius + h * h) / (2.0 * h);
        const double joint = tip - h;
        struct surface *end =
            add_surface(body, BALL, outward * (tip - ball), ball + more, 0.0, 0.0);
        *(outward > 0.0 ? &end->from : &end->to) = outward * joint;
        *(outward > 0.0 ? &side->to : &side->from) = outward * joint;
    } else {
        *(outward > 0.0 ? &side->to : &side->from) = outward * (tip + more);
        if (kind == SONJECT_END_FLAT)
            add_surface(body, PLANE, outward, 0.0, 0.0, tip + more);
    }
}

static void build_capsule(struct body *body, const sonject_object_params *solid, double more)
{
    const double radius = 0.5 * solid->diameter_m;
    struct surface *side = add_surface(body, TUBE, radius + more, 0.0, 0.0, 0.0);
    add_end(body, solid, 1.0, SONJECT_END_SPHERICAL, radius, more, side);
    add_end(body, solid, -1.0, SONJECT_END_SPHERICAL, radius, more, side);
    body->is_round = 1;
}

static void fit_capsule(sonject_object_params *solid, double thinnest)
{
    solid->length_m = solid->diameter_m * uniform(1.1, 0.2 / thinnest);
}

static void build_cylinder(struct body *body, const sonject_object_params *solid, double more)
{
    struct surface *side = add_surface(body, TUBE, 0.5 * solid->diameter_m + more, 0.0, 0.0, 0.0);
    add_end(body, solid, 1.0, solid->nose_end, solid->nose_end_depth_m, more, side);
    add_end(body, solid, -1.0, solid->tail_end, solid->tail_end_depth_m, more, side);
    body->is_round = 1;
    body->is_thin = solid->nose_end == SONJECT_END_OPEN || solid->tail_end == SONJECT_END_OPEN;
}

static uint32_t random_end(double open)
{
    const double choice = uniform(0.0, 1.0);
    return choice < open         ? SONJECT_END_OPEN
           : choice < 0.3 + open ? SONJECT_END_FLAT
                                 : SONJECT_END_SPHERICAL;
}

static void fit_ends(sonject_object_params *solid)
{
    const double radius = 0.5 * solid->diameter_m;
    if (solid->nose_end == SONJECT_END_SPHERICAL && uniform(0.0, 1.0) < 0.7)
        solid->nose_end_depth_m = radius * pow(10.0, uniform(-2.0, 0.0));
    if (solid->tail_end == SONJECT_END_SPHERICAL && uniform(0.0, 1.0) < 0.7)
        solid->tail_end_depth_m = radius * pow(10.0, uniform(-2.0, 0.0));
}

/* Chooses flat or spherical ends. */
static void fit_cylinder(sonject_object_params *solid, double thinnest)
{
    fit_capsule(solid, thinnest);
    solid->nose_end = random_end(0.0);
    solid->tail_end = random_end(0.0);
    fit_ends(solid);
}

/* Chooses ends of which at least one is open. */
static void fit_tube(sonject_object_params *solid, double thinnest)
{
    fit_capsule(solid, thinnest);
    solid->nose_end = random_end(0.3);
    solid->tail_end =
        solid->nose_end == SONJECT_END_OPEN ? random_end(0.3) : (uint32_t)SONJECT_END_OPEN;
    fit_ends(solid);
}

static void build_truncated_cone(struct body *body, const sonject_object_params *solid, double more)
{
    const double base = 0.5 * solid->diameter_m;
    const double top = 0.5 * solid->top_diameter_m;
    const double growth = (top - base) / solid->height_m;
    add_surface(body, CONE, 0.5 * (base + top) + more * sqrt(1.0 + growth * growth), growth, 0.0,
                0.0);
    add_surface(body, PLANE, 0.0, 0.0, 1.0, 0.5 * solid->height_m + more);
    add_surface(body, PLANE, 0.0, 0.0, -1.0, 0.5 * solid->height_m + more);
}

static void fit_cone(sonject_object_params *solid, double thinnest)
{
    (void)thinnest;
    solid->top_diameter_m = 0.0;
}

const struct solid_row solid_rows[] = {
    {"plane", SHAPE_PLANE, build_plane, NULL},
    {"sphere", SHAPE_SPHERE, build_sphere, NULL},
    {"cylinder", SHAPE_CYLINDER, build_cylinder, fit_cylinder},
    {"tube", SHAPE_CYLINDER, build_cylinder, fit_tube},
    {"capsule", SHAPE_CAPSULE, build_capsule, fit_capsule},
    {"disc", SHAPE_DISC, build_disc, NULL},
    {"ellipsoid", SHAPE_ELLIPSOID, build_ellipsoid, NULL},
    {"box", SHAPE_BOX, build_box, NULL},
    {"wedge", SHAPE_WEDGE, build_wedge, fit_wedge},
    {"cone", SHAPE_CONE, build_truncated_cone, fit_cone},
    {"truncated cone", SHAPE_TRUNCATED_CONE, build_truncated_cone, NULL},
    {"torus", SHAPE_TORUS, build_torus, fit_torus},
};
const int solid_row_count = sizeof solid_rows / sizeof *solid_rows;

void body_init(struct body *body, const sonject_object_params *solid, double more)
{
    const struct solid_row *row = solid_rows;
    while (row->shape != solid->shape)
        row++;
    *body = (struct body){.rim = INFINITY, .half_length = INFINITY, .half_width = INFINITY};
    body->size = 0.5 * fmax(fmax(solid->length_m, solid->width_m),
                            fmax(fmax(solid->diameter_m, solid->top_diameter_m), solid->height_m));
    row->build(body, solid, more);
}

/* Returns whether a point lies within all surfaces but one. A cylinder is the union of its straight
 * part and its ends. */
static int is_within(const struct body *body, const struct surface *but, struct point p)
{
    const int is_cylinder = body->is_round;
    int in_part = !is_cylinder;
    for (int i = 0; i < body->count; i++) {
        const struct surface *surface = &body->surfaces[i];
        if (surface == but)
            continue;
        const double value = value_at(surface, p);
        if (surface->kind == PLANE && !body->is_thin) {
            if (value > 0.0)
                return 0;
        } else if (is_cylinder) {
            in_part |= value <= 0.0 && p.x >= surface->from && p.x <= surface->to;
        } else if (value > 1e-12) { /* rims lie on both surfaces */
            return 0;
        }
        if (surface->kind == CONE && surface->numbers[0] + surface->numbers[1] * p.z < 0.0)
            return 0;
    }
    return in_part;
}

int body_holds(const struct body *body, struct point p)
{
    struct body filled = *body;
    filled.is_thin = 0;
    return hypot(p.x, p.y) <= body->rim && fabs(p.x) <= body->half_length &&
           fabs(p.y) <= body->half_width && is_within(&filled, NULL, p);
}

static int is_on(const struct body *body, const struct surface *surface, struct point p)
{
    if (p.x < surface->from || p.x > surface->to || hypot(p.x, p.y) > body->rim ||
        fabs(p.x) > body->half_length || fabs(p.y) > body->half_width)
        return 0;
    if (surface->kind == CONE && surface->numbers[0] + surface->numbers[1] * p.z < 0.0)
        return 0;
    if (body->is_round) /* a flat end is as wide as the tube */
        return surface->kind != PLANE || value_at(&body->surfaces[0], p) <= 0.0;
    return is_within(body, surface, p);
}

static int real_roots(const double c[5], double root[4])
{
    double complex z[4];
    int count = 0;
    for (int i = 0; i < 4; i++)
        z[i] = cpow(0.4 + 0.9 * I, i);
    for (int step = 0; step < 80; step++)
        for (int i = 0; i < 4; i++) {
            double complex below = c[4];
            const double complex x = z[i];
            const double complex value = (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
            for (int k = 0; k < 4; k++)
                if (k != i)
                    below *= x - z[k];
            z[i] -= value / below;
        }
    for (int i = 0; i < 4; i++)
        if (fabs(cimag(z[i])) < 1e-8)
            root[count++] = creal(z[i]);
    return count;
}

/* Finds the roots of the surface's polynomial along the ray, in units of `step` from `middle`. */
static int crossings(const struct surface *surface, struct point middle, struct point step,
                     double root[4])
{
    const double at_0 = value_at(surface, middle);
    const double even = 0.5 * (value_at(surface, add(middle, step, 1.0)) +
                               value_at(surface, add(middle, step, -1.0)));
    const double odd = 0.5 * (value_at(surface, add(middle, step, 1.0)) -
                              value_at(surface, add(middle, step, -1.0)));
    if (surface->kind == TORUS) {
        const double half_even = 0.5 * (value_at(surface, add(middle, step, 0.5)) +
                                        value_at(surface, add(middle, step, -0.5)));
        const double half_odd = 0.5 * (value_at(surface, add(middle, step, 0.5)) -
                                       value_at(surface, add(middle, step, -0.5)));
        double c[5];
        c[0] = at_0;
        c[4] = ((even - at_0) - 4.0 * (half_even - at_0)) * 4.0 / 3.0;
        c[2] = even - at_0 - c[4];
        c[3] = (odd - 2.0 * half_odd) * 4.0 / 3.0;
        c[1] = odd - c[3];
        return real_roots(c, root);
    }
    const double a = surface->kind == PLANE ? 0.0 : even - at_0;
    if (fabs(a) <= 1e-14 * (fabs(odd) + fabs(at_0))) {
        root[0] = -at_0 / odd;
        return odd != 0.0;
    }
    const double square = odd * odd - 4.0 * a * at_0;
    if (square < 0.0)
        return 0;
    const double half = -0.5 * (odd + copysign(sqrt(square), odd)); /* avoids cancellation */
    root[0] = half / a;
    root[1] = half != 0.0 ? at_0 / half : 0.0;
    return 2;
}

static double edge_distance(const struct body *body, const struct surface *on, struct point p)
{
    double nearest =
        fmin(fabs(body->rim - hypot(p.x, p.y)),
             fmin(fabs(body->half_length - fabs(p.x)), fabs(body->half_width - fabs(p.y))));
    for (int i = 0; i < body->count; i++) {
        const struct surface *surface = &body->surfaces[i];
        const struct point gradient = gradient_at(surface, p, 1e-6 * body->size);
        nearest = fmin(nearest, fmin(fabs(p.x - surface->from), fabs(p.x - surface->to)));
        if (surface != on)
            nearest = fmin(nearest, fabs(value_at(surface, p)) / sqrt(dot(gradient, gradient)));
    }
    /* the tip of a cone has all normals */
    return on->kind == CONE ? fmin(nearest, hypot(p.x, p.y)) : nearest;
}

struct solid_hit solid_first_hit(const sonject_object_params *solid, struct point start,
                                 struct point direction, double minimum, double more)
{
    struct solid_hit hit = {INFINITY, {0.0, 0.0, 0.0}, INFINITY};
    struct body body;
    body_init(&body, solid, more);
    const double to_middle = -dot(start, direction) / dot(direction, direction);
    const struct point middle = add(start, direction, to_middle);
    const struct point step = scaled(direction, body.size);
    for (int i = 0; i < body.count; i++) {
        double root[4];
        const int count = crossings(&body.surfaces[i], middle, step, root);
        for (int k = 0; k < count; k++) {
            const double distance = to_middle + root[k] * body.size;
            const struct point at = add(middle, step, root[k]);
            if (!(distance > minimum && distance < hit.distance) ||
                !is_on(&body, &body.surfaces[i], at))
                continue;
            const struct point out = gradient_at(&body.surfaces[i], at, 1e-6 * body.size);
            const double sense = body.is_thin && dot(out, direction) > 0.0 ? -1.0 : 1.0;
            hit.distance = distance;
            hit.normal = scaled(out, sense / sqrt(dot(out, out)));
            hit.to_edge = edge_distance(&body, &body.surfaces[i], at);
        }
    }
    return hit;
}
