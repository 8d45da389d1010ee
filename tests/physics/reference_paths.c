#include "reference_paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* Energies of one batch; the last bin takes all ranges. */
struct batch {
    double energy[REFERENCE_ENDS][REFERENCE_ORDERS][REFERENCE_BINS + 1];
};

/* Sums over batches of value and square. */
struct tally {
    struct batch batch, sum, square;
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
    struct reference_vector source_across, source_normal; /* the square's other edge */
    uint64_t state;
    struct tally *tally;
};

/* A Weyl sequence scrambled by two multiply-and-shift rounds; 53 bits, never 0 or 1. */
static double next_uniform(struct tracing *tracing)
{
    tracing->state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t bits = tracing->state;
    bits = (bits ^ (bits >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    bits = (bits ^ (bits >> 27)) * UINT64_C(0x94d049bb133111eb);
    bits ^= bits >> 31;
    return ((double)(bits >> 11) + 0.5) / 9007199254740992.0;
}

static void deposit(struct tracing *tracing, const struct path *path, int order, double last_leg,
                    double energy)
{
    const struct reference_request *request = tracing->request;
    const double range = 0.5 * (path->length + last_leg);
    if (!request->pressure)
        energy *= range * range * range * range;
    const int ends = (path->first_on_object ? 2 : 0) + (path->last_on_object ? 1 : 0);
    double *of_ends = tracing->tally->batch.energy[ends][order - 1];
    double *of_all = tracing->tally->batch.energy[REFERENCE_ALL_ENDS][order - 1];
    const double bin = floor((range - request->first_range) / request->bin_width);
    if (bin >= 0.0 && bin < request->bins) {
        of_ends[(int)bin] += energy;
        of_all[(int)bin] += energy;
    }
    of_ends[REFERENCE_BINS] += energy;
    of_all[REFERENCE_BINS] += energy;
}

/* The last leg as the paper does it: the path's ray happens to meet the source before the next
   surface. Its points share the energy 1 / A each; per solid angle that is r^2 / (A cos). */
static void meet_source(struct tracing *tracing, const struct path *path, int order,
                        double distance)
{
    const double side = tracing->request->source_side;
    const double cosine = reference_dot(path->direction, tracing->source_normal);
    const struct reference_vector way = reference_sum(path->sonar, -1.0, path->origin);
    const double last_leg = reference_dot(way, tracing->source_normal) / cosine;
    if (!(last_leg > 0.0 && last_leg < distance))
        return;
    const struct reference_vector on_source =
        reference_sum(reference_sum(path->origin, last_leg, path->direction), -1.0, path->sonar);
    if (fabs(on_source.x) > 0.5 * side ||
        fabs(reference_dot(on_source, tracing->source_across)) > 0.5 * side)
        return;
    deposit(tracing, path, order, last_leg, path->weight / (side * side * fabs(cosine)));
}

static void connect_source(struct tracing *tracing, const struct path *path,
                           const struct reference_hit *hit, int order)
{
    const double side = tracing->request->source_side;
    struct reference_vector source = path->sonar;
    if (side > 0.0) {
        source.x += side * (next_uniform(tracing) - 0.5);
        source =
            reference_sum(source, side * (next_uniform(tracing) - 0.5), tracing->source_across);
    }
    const struct reference_vector way = reference_sum(source, -1.0, hit->point);
    const double square = reference_dot(way, way), last_leg = sqrt(square);
    const double cosine = reference_dot(way, hit->normal) / last_leg;
    if (cosine > 0.0 && !reference_blocked(tracing->scene, hit->point, source))
        deposit(tracing, path, order, last_leg, path->weight * hit->lambert * cosine / square);
}

/* A point on the unit sphere that touches the surface from above, seen from the point of contact,
   lies in directions distributed as the cosine off the normal. */
static struct reference_vector cosine_direction(struct tracing *tracing,
                                                struct reference_vector normal)
{
    const double z = 2.0 * next_uniform(tracing) - 1.0;
    const double azimuth = 2.0 * PI * next_uniform(tracing), level = sqrt(1.0 - z * z);
    const struct reference_vector ball =
        reference_vector(level * cos(azimuth), level * sin(azimuth), z);
    return reference_unit(reference_sum(normal, 1.0, ball));
}

static void trace_path(struct tracing *tracing, struct path *path)
{
    const struct reference_request *request = tracing->request;
    const bool brute_force = request->estimator == REFERENCE_BRUTE_FORCE;
    for (int order = 1; order <= request->limit + (brute_force ? 1 : 0); order++) {
        struct reference_hit hit;
        const bool met = reference_nearest(tracing->scene, path->origin, path->direction, &hit);
        if (brute_force && order > 1)
            meet_source(tracing, path, order - 1, met ? hit.distance : INFINITY);
        if (!met)
            break;
        path->length += hit.distance;
        path->last_on_object = hit.on_object;
        if (order == 1) { /* dA / r1^2, which only now is known */
            path->first_on_object = hit.on_object;
            path->weight /= hit.distance;
        }
        if (!brute_force)
            connect_source(tracing, path, &hit, order);
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
        const double x = request->first_x + width * next_uniform(tracing);
        const double elevation =
            request->first_elevation + step * ((double)i + next_uniform(tracing));
        struct path path;
        memset(&path, 0, sizeof path);
        path.sonar = reference_vector(x, 0.0, request->altitude);
        path.origin = path.sonar;
        path.direction = reference_vector(0.0, cos(elevation), -sin(elevation));
        path.weight = width * step;
        trace_path(tracing, &path);
    }
}

static void add_batch(struct tally *tally)
{
    const double *value = &tally->batch.energy[0][0][0];
    double *sum = &tally->sum.energy[0][0][0], *square = &tally->square.energy[0][0][0];
    for (size_t i = 0; i < sizeof tally->batch.energy / sizeof(double); i++) {
        sum[i] += value[i];
        square[i] += value[i] * value[i];
    }
}

static struct reference_value value_of(const struct tally *tally, int ends, int order, int bin)
{
    const double batches = REFERENCE_BATCHES;
    struct reference_value value;
    value.mean = tally->sum.energy[ends][order][bin] / batches;
    const double variance =
        tally->square.energy[ends][order][bin] / batches - value.mean * value.mean;
    value.error = sqrt(fmax(0.0, variance) / (batches - 1.0));
    return value;
}

static void read_tally(const struct tally *tally, struct reference_energy *energy)
{
    for (int ends = 0; ends < REFERENCE_ENDS; ends++)
        for (int order = 0; order < REFERENCE_ORDERS; order++) {
            for (int bin = 0; bin < REFERENCE_BINS; bin++)
                energy->bins[ends][order][bin] = value_of(tally, ends, order, bin);
            energy->all_ranges[ends][order] = value_of(tally, ends, order, REFERENCE_BINS);
        }
}

static bool is_sound(const struct reference_scene *scene, const struct reference_request *request)
{
    const bool has_square = request->source_side > 0.0;
    const struct reference_vector central = request->central;
    return scene->object_count >= 0 && scene->object_count <= REFERENCE_OBJECTS &&
           request->limit >= 1 && request->limit <= REFERENCE_ORDERS && request->bins >= 1 &&
           request->bins <= REFERENCE_BINS && request->bin_width > 0.0 &&
           request->rays >= REFERENCE_BATCHES && request->last_x > request->first_x &&
           request->last_elevation > request->first_elevation && request->source_side >= 0.0 &&
           (has_square || request->estimator == REFERENCE_CONNECT) &&
           (!has_square || central.y * central.y + central.z * central.z > 0.0);
}

int reference_trace(const struct reference_scene *scene, const struct reference_request *request,
                    struct reference_energy *energy)
{
    if (!is_sound(scene, request))
        return -1;
    struct tracing tracing;
    memset(&tracing, 0, sizeof tracing);
    tracing.scene = scene;
    tracing.request = request;
    if (request->source_side > 0.0) {
        const struct reference_vector along = reference_vector(1.0, 0.0, 0.0);
        tracing.source_across = reference_unit(reference_cross(along, request->central));
        tracing.source_normal = reference_cross(along, tracing.source_across);
    }
    tracing.tally = calloc(1, sizeof *tracing.tally);
    if (!tracing.tally)
        return -1;
    /* Scrambled, or seeds that differ by the sequence's step would give shifted copies. */
    tracing.state = (request->seed ^ (request->seed >> 29)) * UINT64_C(0xd6e8feb86659fd93) + 1;
    for (int batch = 0; batch < REFERENCE_BATCHES; batch++) {
        memset(&tracing.tally->batch, 0, sizeof tracing.tally->batch);
        trace_batch(&tracing);
        add_batch(tracing.tally);
    }
    read_tally(tracing.tally, energy);
    free(tracing.tally);
    return 0;
}
