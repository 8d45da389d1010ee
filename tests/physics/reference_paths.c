#include "reference_paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LIFT_M 1e-9 /* far above rounding at some 100 m (1e-14), far below every size */

/* Nearest meeting so far, in the object's own axes. */
struct meeting {
    double distance;
    struct reference_vector normal;
};

struct reference_vector reference_vector(double x, double y, double z)
{
    const struct reference_vector result = {x, y, z};
    return result;
}

struct reference_vector reference_sum(struct reference_vector a, double scale,
                                      struct reference_vector b)
{
    return reference_vector(a.x + scale * b.x, a.y + scale * b.y, a.z + scale * b.z);
}

double reference_dot(struct reference_vector a, struct reference_vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

struct reference_vector reference_cross(struct reference_vector a, struct reference_vector b)
{
    return reference_vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

struct reference_vector reference_unit(struct reference_vector a)
{
    return reference_sum(reference_vector(0.0, 0.0, 0.0), 1.0 / sqrt(reference_dot(a, a)), a);
}

struct reference_object *reference_add_object(struct reference_scene *scene,
                                              enum reference_shape shape, double radius,
                                              double lambert)
{
    struct reference_object *object = &scene->objects[scene->object_count++];
    memset(object, 0, sizeof *object);
    object->shape = shape;
    object->radius = radius;
    object->lambert = lambert;
    object->axes[0] = reference_vector(1.0, 0.0, 0.0);
    object->axes[1] = reference_vector(0.0, 1.0, 0.0);
    object->axes[2] = reference_vector(0.0, 0.0, 1.0);
    return object;
}

/* Roots of a t^2 + 2 b t + c = 0, its discriminant b^2 - a c given by whoever knows it without
   cancellation. */
static int quadratic_roots(double a, double b, double c, double discriminant, double roots[2])
{
    if (discriminant < 0.0 || a == 0.0)
        return 0;
    const double q = -(b + copysign(sqrt(discriminant), b));
    roots[0] = q / a;
    roots[1] = q != 0.0 ? c / q : roots[0];
    return 2;
}

static void keep_nearest(struct meeting *nearest, double distance, struct reference_vector normal)
{
    if (distance > 0.0 && distance < nearest->distance) {
        nearest->distance = distance;
        nearest->normal = normal;
    }
}

/* Sphere about (shift, 0, 0); of a capsule's end (`end` -1 or 1) only what lies beyond it. */
static void meet_sphere(struct meeting *nearest, struct reference_vector o,
                        struct reference_vector d, double radius, double shift, int end)
{
    const struct reference_vector from = reference_vector(o.x - shift, o.y, o.z);
    const struct reference_vector moment = reference_cross(from, d);
    double roots[2];
    const int count =
        quadratic_roots(1.0, reference_dot(from, d), reference_dot(from, from) - radius * radius,
                        radius * radius - reference_dot(moment, moment), roots);
    for (int i = 0; i < count; i++) {
        const struct reference_vector outwards = reference_sum(from, roots[i], d);
        if (end == 0 || outwards.x * end >= 0.0)
            keep_nearest(nearest, roots[i], reference_unit(outwards));
    }
}

/* Round side of a cylinder along own x. */
static void meet_side(struct meeting *nearest, struct reference_vector o, struct reference_vector d,
                      double radius, double half_length)
{
    const double a = d.y * d.y + d.z * d.z, moment = o.y * d.z - o.z * d.y;
    double roots[2];
    const int count =
        quadratic_roots(a, o.y * d.y + o.z * d.z, o.y * o.y + o.z * o.z - radius * radius,
                        a * radius * radius - moment * moment, roots);
    for (int i = 0; i < count; i++) {
        const struct reference_vector at = reference_sum(o, roots[i], d);
        if (fabs(at.x) <= half_length)
            keep_nearest(nearest, roots[i], reference_unit(reference_vector(0.0, at.y, at.z)));
    }
}

static void meet_flat_ends(struct meeting *nearest, struct reference_vector o,
                           struct reference_vector d, double radius, double half_length)
{
    for (int end = -1; end <= 1 && d.x != 0.0; end += 2) {
        const double distance = (end * half_length - o.x) / d.x;
        const struct reference_vector at = reference_sum(o, distance, d);
        if (at.y * at.y + at.z * at.z <= radius * radius)
            keep_nearest(nearest, distance, reference_vector(end, 0.0, 0.0));
    }
}

static struct reference_vector in_own_axes(const struct reference_object *object,
                                           struct reference_vector v)
{
    return reference_vector(reference_dot(v, object->axes[0]), reference_dot(v, object->axes[1]),
                            reference_dot(v, object->axes[2]));
}

static struct meeting meet_object(const struct reference_object *object,
                                  struct reference_vector origin, struct reference_vector direction)
{
    struct meeting nearest = {INFINITY, {0.0, 0.0, 0.0}};
    const struct reference_vector o =
        in_own_axes(object, reference_sum(origin, -1.0, object->centre));
    const struct reference_vector d = in_own_axes(object, direction);
    const double half = 0.5 * object->length, radius = object->radius;
    switch (object->shape) {
    case REFERENCE_SPHERE:
        meet_sphere(&nearest, o, d, radius, 0.0, 0);
        break;
    case REFERENCE_CAPSULE:
        meet_side(&nearest, o, d, radius, half - radius);
        meet_sphere(&nearest, o, d, radius, half - radius, 1);
        meet_sphere(&nearest, o, d, radius, radius - half, -1);
        break;
    case REFERENCE_CYLINDER:
        meet_side(&nearest, o, d, radius, half);
        meet_flat_ends(&nearest, o, d, radius, half);
        break;
    }
    return nearest;
}

static struct reference_vector in_scene_axes(const struct reference_object *object,
                                             struct reference_vector v)
{
    struct reference_vector result = reference_vector(0.0, 0.0, 0.0);
    result = reference_sum(result, v.x, object->axes[0]);
    result = reference_sum(result, v.y, object->axes[1]);
    return reference_sum(result, v.z, object->axes[2]);
}

bool reference_nearest(const struct reference_scene *scene, struct reference_vector origin,
                       struct reference_vector direction, struct reference_hit *hit)
{
    struct reference_hit nearest = {
        INFINITY, origin, {0.0, 0.0, 1.0}, scene->seabed_lambert, false};
    const double to_seabed = -origin.z / direction.z;
    if (direction.z != 0.0 && to_seabed > 0.0)
        nearest.distance = to_seabed;
    for (int i = 0; i < scene->object_count; i++) {
        const struct reference_object *object = &scene->objects[i];
        const struct meeting meeting = meet_object(object, origin, direction);
        if (meeting.distance >= nearest.distance)
            continue;
        nearest.distance = meeting.distance;
        nearest.normal = in_scene_axes(object, meeting.normal);
        nearest.lambert = object->lambert;
        nearest.on_object = true;
    }
    if (isinf(nearest.distance))
        return false;
    if (reference_dot(nearest.normal, direction) > 0.0)
        nearest.normal = reference_vector(-nearest.normal.x, -nearest.normal.y, -nearest.normal.z);
    nearest.point =
        reference_sum(reference_sum(origin, nearest.distance, direction), LIFT_M, nearest.normal);
    *hit = nearest;
    return true;
}

bool reference_blocked(const struct reference_scene *scene, struct reference_vector from,
                       struct reference_vector to)
{
    const struct reference_vector way = reference_sum(to, -1.0, from);
    const double distance = sqrt(reference_dot(way, way));
    struct reference_hit hit;
    return reference_nearest(scene, from, reference_unit(way), &hit) && hit.distance < distance;
}

/* ---- paths ---- */

/* Energies of one batch; the last bin takes all ranges. */
struct batch {
    double energy[REFERENCE_ENDS][REFERENCE_ORDERS][REFERENCE_BINS + 1];
};

struct path {
    struct reference_vector sonar, origin, direction;
    double length; /* m, down to the last hit */
    double weight; /* energy over that of the last leg */
    bool first_on_object, last_on_object;
};

/* A run on its way. */
struct tracing {
    const struct reference_scene *scene;
    const struct reference_request *request;
    uint64_t state;
    struct batch batch, sum, square;
};

static void deposit(struct tracing *tracing, const struct path *path, int order, double last_leg,
                    double energy)
{
    const struct reference_request *request = tracing->request;
    const double range = 0.5 * (path->length + last_leg);
    if (!request->pressure)
        energy *= range * range * range * range;
    const int ends = (path->first_on_object ? 2 : 0) + (path->last_on_object ? 1 : 0);
    double *of_ends = tracing->batch.energy[ends][order - 1];
    const double bin = floor((range - request->first_range) / request->bin_width);
    if (bin >= 0.0 && bin < request->bins)
        of_ends[(int)bin] += energy;
    of_ends[REFERENCE_BINS] += energy;
}

static void connect_sonar(struct tracing *tracing, const struct path *path,
                          const struct reference_hit *hit, int order)
{
    const struct reference_vector way = reference_sum(path->sonar, -1.0, hit->point);
    const double square = reference_dot(way, way), last_leg = sqrt(square);
    const double cosine = reference_dot(way, hit->normal) / last_leg;
    if (cosine > 0.0 && !reference_blocked(tracing->scene, hit->point, path->sonar))
        deposit(tracing, path, order, last_leg, path->weight * hit->lambert * cosine / square);
}

/* A point on the unit sphere that touches the surface from above, seen from the point of contact,
   lies in directions distributed as the cosine off the normal. */
static struct reference_vector cosine_direction(struct tracing *tracing,
                                                struct reference_vector normal)
{
    const double z = 2.0 * next_uniform(&tracing->state) - 1.0;
    const double azimuth = 2.0 * PI * next_uniform(&tracing->state), level = sqrt(1.0 - z * z);
    const struct reference_vector ball =
        reference_vector(level * cos(azimuth), level * sin(azimuth), z);
    return reference_unit(reference_sum(normal, 1.0, ball));
}

static void trace_path(struct tracing *tracing, struct path *path)
{
    for (int order = 1; order <= tracing->request->limit; order++) {
        struct reference_hit hit;
        if (!reference_nearest(tracing->scene, path->origin, path->direction, &hit))
            break;
        path->length += hit.distance;
        path->last_on_object = hit.on_object;
        if (order == 1) { /* dA / r1^2, which only now is known */
            path->first_on_object = hit.on_object;
            path->weight /= hit.distance;
        }
        connect_sonar(tracing, path, &hit, order);
        path->weight *= hit.lambert * PI; /* f cos / pdf */
        path->origin = hit.point;
        path->direction = cosine_direction(tracing, hit.normal);
    }
}

/* Elevations are stratified inside a batch: one ray a stratum. */
static void trace_batch(struct tracing *tracing)
{
    const struct reference_request *request = tracing->request;
    const uint64_t rays = request->rays / REFERENCE_BATCHES;
    const double width = request->last_x - request->first_x;
    const double step = (request->last_elevation - request->first_elevation) / (double)rays;
    for (uint64_t i = 0; i < rays; i++) {
        const double x = request->first_x + width * next_uniform(&tracing->state);
        const double elevation =
            request->first_elevation + step * ((double)i + next_uniform(&tracing->state));
        struct path path;
        memset(&path, 0, sizeof path);
        path.sonar = reference_vector(x, 0.0, request->altitude);
        path.origin = path.sonar;
        path.direction = reference_vector(0.0, cos(elevation), -sin(elevation));
        path.weight = width * step;
        trace_path(tracing, &path);
    }
}

static struct estimate value_of(const struct tracing *tracing, int ends, int order, int bin)
{
    return estimate_of_sums(tracing->sum.energy[ends][order][bin],
                            tracing->square.energy[ends][order][bin], REFERENCE_BATCHES);
}

void reference_trace(const struct reference_scene *scene, const struct reference_request *request,
                     struct reference_energy *energy)
{
    static struct tracing tracing;
    memset(&tracing, 0, sizeof tracing);
    tracing.scene = scene;
    tracing.request = request;
    /* Scrambled, or seeds that differ by the sequence's step would give shifted copies. */
    tracing.state = (request->seed ^ (request->seed >> 29)) * UINT64_C(0xd6e8feb86659fd93) + 1;
    const double *value = &tracing.batch.energy[0][0][0];
    double *sum = &tracing.sum.energy[0][0][0], *square = &tracing.square.energy[0][0][0];
    for (int batch = 0; batch < REFERENCE_BATCHES; batch++) {
        memset(&tracing.batch, 0, sizeof tracing.batch);
        trace_batch(&tracing);
        for (size_t i = 0; i < sizeof tracing.batch / sizeof(double); i++) {
            sum[i] += value[i];
            square[i] += value[i] * value[i];
        }
    }
    for (int ends = 0; ends < REFERENCE_ENDS; ends++)
        for (int order = 0; order < REFERENCE_ORDERS; order++) {
            for (int bin = 0; bin < REFERENCE_BINS; bin++)
                energy->bins[ends][order][bin] = value_of(&tracing, ends, order, bin);
            energy->all_ranges[ends][order] = value_of(&tracing, ends, order, REFERENCE_BINS);
        }
}
