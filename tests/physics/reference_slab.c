#include "reference_slab.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "reference_paths.h"

struct tally {
    double first[SLAB_PATHS][SLAB_BINS], both[SLAB_PATHS][SLAB_BINS];
};

struct run {
    const struct slab_scene *scene;
    const struct slab_request *request;
    uint64_t state;
    struct tally *batch;
};

struct ray {
    struct reference_vector origin, way;
    double sonar_x, length, weight;
    double first_leg;
    int path, hits;
    bool has_spread; /* the wavefront met something that is no mirror */
};

static struct reference_vector centre_of(const struct slab_scene *scene)
{
    const struct reference_vector centre = {0.0, scene->centre_y, scene->centre_z};
    return centre;
}

static double to_sphere(const struct slab_scene *scene, struct reference_vector origin,
                        struct reference_vector way)
{
    const struct reference_vector to = reference_sum(centre_of(scene), -1.0, origin);
    const double along = reference_dot(to, way);
    const double root = scene->radius * scene->radius - (reference_dot(to, to) - along * along);
    return root > 0.0 && along > 0.0 && reference_dot(to, to) > scene->radius * scene->radius
               ? along - sqrt(root)
               : INFINITY;
}

static bool is_open(const struct slab_scene *scene, struct reference_vector from,
                    struct reference_vector to)
{
    const struct reference_vector way = reference_sum(to, -1.0, from);
    const double distance = sqrt(reference_dot(way, way));
    return to_sphere(scene, reference_sum(from, 1e-9, reference_unit(way)), reference_unit(way)) >
           distance;
}

/* 1 - exp(-P^2), what roughness takes. */
static double taken(const struct slab_scene *scene, double cosine)
{
    const double phase = scene->phase * cosine;
    return scene->reflection == 0.0 ? 1.0 : 1.0 - exp(-phase * phase);
}

static double mirrored(const struct slab_scene *scene, double cosine)
{
    return scene->reflection * scene->reflection * (1.0 - taken(scene, cosine));
}

static double lambert_of(const struct slab_scene *scene, int hit, double cosine_in,
                         double cosine_out)
{
    if (hit == SLAB_SURFACE && scene->rough_is_apart)
        return scene->surface_lambert;
    if (hit == SLAB_SURFACE)
        return scene->surface_lambert * taken(scene, cosine_in) * taken(scene, cosine_out);
    return hit == SLAB_TARGET ? scene->target_lambert : scene->seabed_lambert;
}

static double column_of(const struct run *run, const struct ray *ray)
{
    return run->request->is_focused ? 0.5 * (ray->sonar_x + ray->origin.x) : ray->sonar_x;
}

static void deposit(struct run *run, const struct ray *ray, int path, double last_leg,
                    double energy)
{
    const struct slab_request *request = run->request;
    const double column = column_of(run, ray);
    const double longer = hypot(ray->first_leg, ray->sonar_x - column) - ray->first_leg;
    const double range = 0.5 * (ray->length + longer + last_leg);
    const double bin = floor((range - request->first_range) / request->bin_width);
    if (bin < 0.0 || bin >= request->bins || fabs(column) > request->half_track ||
        path >= SLAB_PATHS)
        return;
    run->batch->first[path][(int)bin] += energy * pow(range, 4.0);
    if (fabs(ray->origin.x) <= request->half_track)
        run->batch->both[path][(int)bin] += energy * pow(range, 4.0);
}

static struct reference_vector source_point(struct run *run, const struct ray *ray)
{
    const struct slab_scene *scene = run->scene;
    const double along = scene->source_side * (next_uniform(&run->state) - 0.5);
    const double up = scene->source_side * (next_uniform(&run->state) - 0.5);
    const struct reference_vector source = {column_of(run, ray) + along,
                                            up * sin(scene->source_grazing),
                                            scene->altitude + up * cos(scene->source_grazing)};
    return source;
}

static bool is_looked_at(const struct slab_request *request, struct reference_vector seabed)
{
    return seabed.y >= request->near_ground && seabed.y <= request->far_ground &&
           fabs(seabed.x) <= request->reach_x;
}

/* Paths from the sea surface by way of the target to the seabed are found in reverse. */
static bool is_found_from_seabed(const struct slab_request *request, const struct ray *ray)
{
    const int first = ray->hits == 3 ? ray->path / 25 : 0;
    const bool is_reverse = (first == SLAB_SURFACE || first == SLAB_MIRROR) &&
                            ray->path % 25 == 5 * SLAB_TARGET + SLAB_SEABED;
    return !is_reverse || is_looked_at(request, ray->origin);
}

/* The hit is seen by the source: straight, and (but for the surface itself) in the mirror. */
static void connect(struct run *run, const struct ray *ray, struct reference_vector normal, int hit,
                    double cosine_in)
{
    const struct slab_scene *scene = run->scene;
    for (int by_mirror = 0; by_mirror < 2; by_mirror++) {
        if (by_mirror && (hit == SLAB_SURFACE || scene->reflection == 0.0))
            continue;
        const struct reference_vector source = source_point(run, ray);
        struct reference_vector goal = source;
        if (by_mirror)
            goal.z = 2.0 * scene->depth - goal.z;
        const struct reference_vector to = reference_sum(goal, -1.0, ray->origin);
        const double square = reference_dot(to, to);
        const double cosine = reference_dot(to, normal) / sqrt(square);
        if (cosine <= 0.0)
            continue;
        double energy = ray->weight * lambert_of(scene, hit, cosine_in, cosine) * cosine / square;
        bool is_seen;
        if (by_mirror) {
            const double share = (scene->depth - ray->origin.z) / to.z;
            const struct reference_vector bounce = reference_sum(ray->origin, share, to);
            energy *= mirrored(scene, to.z / sqrt(square));
            is_seen = is_open(scene, ray->origin, bounce) && is_open(scene, bounce, source);
        } else {
            is_seen = is_open(scene, ray->origin, goal);
        }
        if (!is_found_from_seabed(run->request, ray))
            continue;
        const struct reference_vector facing = {0.0, cos(scene->source_grazing),
                                                -sin(scene->source_grazing)};
        struct reference_vector home = reference_sum(ray->origin, -1.0, goal);
        home.z = by_mirror ? -home.z : home.z;
        if (is_seen && (scene->source_side == 0.0 || reference_dot(home, facing) > 0.0))
            deposit(run, ray, by_mirror ? 5 * ray->path + SLAB_MIRROR : ray->path, sqrt(square),
                    energy);
    }
}

static struct reference_vector about(struct reference_vector axis, double cosine, double turn)
{
    const struct reference_vector x = {1.0, 0.0, 0.0}, y = {0.0, 1.0, 0.0};
    const struct reference_vector other = fabs(axis.x) < 0.7 ? x : y;
    const struct reference_vector first =
        reference_unit(reference_sum(other, -reference_dot(other, axis), axis));
    const struct reference_vector second = reference_cross(axis, first);
    const double sine = sqrt(fmax(0.0, 1.0 - cosine * cosine));
    const struct reference_vector none = {0.0, 0.0, 0.0};
    return reference_sum(reference_sum(reference_sum(none, cosine, axis), sine * cos(turn), first),
                         sine * sin(turn), second);
}

/* Half by Lambert's law, half into the cone of the sphere, and off the sphere all by Lambert's law:
 * f cos / density. */
static void scatter(struct run *run, struct ray *ray, struct reference_vector normal, int hit,
                    double cosine_in)
{
    const struct slab_scene *scene = run->scene;
    const struct reference_vector to = reference_sum(centre_of(scene), -1.0, ray->origin);
    const double opening =
        1.0 - sqrt(fmax(0.0, 1.0 - scene->radius * scene->radius / reference_dot(to, to)));
    const double cone_share = hit == SLAB_TARGET ? 0.0 : 0.5;
    const double turn = 2.0 * PI * next_uniform(&run->state);
    const double u = next_uniform(&run->state);
    ray->way = next_uniform(&run->state) < cone_share
                   ? about(reference_unit(to), 1.0 - u * opening, turn)
                   : about(normal, sqrt(u), turn);
    const double cosine = reference_dot(normal, ray->way);
    const bool is_in_cone = reference_dot(reference_unit(to), ray->way) >= 1.0 - opening;
    const double density = (1.0 - cone_share) * fmax(0.0, cosine) / PI +
                           (is_in_cone ? cone_share / (2.0 * PI * opening) : 0.0);
    ray->weight = cosine > 0.0
                      ? ray->weight * lambert_of(scene, hit, cosine_in, cosine) * cosine / density
                      : 0.0;
}

/* The nearest surface; 0 if there is none before the last range. The sea surface is one of its two
 * parts, by lot. */
static int next_hit(struct run *run, struct ray *ray, struct reference_vector *normal,
                    double *cosine)
{
    const struct slab_scene *scene = run->scene;
    const double on_sphere = to_sphere(scene, ray->origin, ray->way);
    const double height = ray->way.z > 0.0 ? scene->depth : 0.0;
    const double on_plane = (height - ray->origin.z) / ray->way.z;
    const double distance = fmin(on_sphere, on_plane);
    const double limit = run->request->first_range + run->request->bins * run->request->bin_width;
    ray->length += distance;
    if (!(distance > 0.0) || 0.5 * ray->length > limit)
        return 0;
    ray->origin = reference_sum(ray->origin, distance, ray->way);
    if (on_sphere < on_plane) {
        *normal = reference_unit(reference_sum(ray->origin, -1.0, centre_of(scene)));
        *cosine = -reference_dot(*normal, ray->way);
        return SLAB_TARGET;
    }
    const struct reference_vector up = {0.0, 0.0, ray->way.z > 0.0 ? -1.0 : 1.0};
    *normal = up;
    *cosine = fabs(ray->way.z);
    ray->origin.z = height;
    if (ray->way.z < 0.0)
        return SLAB_SEABED;
    if (scene->reflection == 0.0)
        return SLAB_SURFACE;
    ray->weight *= 2.0;
    return next_uniform(&run->state) < 0.5 ? SLAB_MIRROR : SLAB_SURFACE;
}

/* aim: SLAB_TARGET and SLAB_MIRROR hit the sphere at once or after the mirror, and SLAB_SEABED all
 * else, or the ray does not count. */
static bool is_aimed(const struct ray *ray, int aim)
{
    if (ray->hits == 1)
        return ray->path == SLAB_TARGET   ? aim == SLAB_TARGET
               : ray->path == SLAB_MIRROR ? aim != SLAB_TARGET
                                          : aim == SLAB_SEABED;
    if (ray->hits == 2 && ray->path / 5 == SLAB_MIRROR)
        return (ray->path % 5 == SLAB_TARGET) == (aim == SLAB_MIRROR);
    return true;
}

static void follow(struct run *run, struct ray *ray, int aim)
{
    while (ray->hits < SLAB_ORDERS && ray->weight > 0.0) {
        struct reference_vector normal;
        double cosine;
        const int hit = next_hit(run, ray, &normal, &cosine);
        ray->path = 5 * ray->path + hit;
        ray->hits++;
        if (hit == 0 || !is_aimed(ray, aim))
            return;
        if (ray->hits == 1 && hit == SLAB_SEABED && !is_looked_at(run->request, ray->origin))
            return;
        if (hit == SLAB_MIRROR) {
            ray->weight *= mirrored(run->scene, cosine);
            ray->way.z = -ray->way.z;
            continue;
        }
        if (!ray->has_spread)
            ray->weight /= ray->length;
        if (!ray->has_spread)
            ray->first_leg = ray->length;
        ray->has_spread = true;
        connect(run, ray, normal, hit, cosine);
        scatter(run, ray, normal, hit, cosine);
    }
}

static void trace_fan(struct run *run, int aim, double half_width, double first, double last,
                      uint64_t rays)
{
    for (uint64_t i = 0; i < rays; i++) {
        const double elevation =
            first + (last - first) * ((double)i + next_uniform(&run->state)) / (double)rays;
        struct ray ray;
        memset(&ray, 0, sizeof ray);
        ray.sonar_x = half_width * (2.0 * next_uniform(&run->state) - 1.0);
        ray.origin.x = ray.sonar_x;
        ray.origin.z = run->scene->altitude;
        ray.way.y = cos(elevation);
        ray.way.z = sin(elevation);
        ray.weight = 2.0 * half_width * (last - first) / (double)rays;
        follow(run, &ray, aim);
    }
}

static void trace_batch(struct run *run)
{
    const struct slab_scene *scene = run->scene;
    const uint64_t rays = run->request->rays / SLAB_BATCHES / 3;
    const double heights[] = {scene->centre_z, 2.0 * scene->depth - scene->centre_z};
    static const int aims[] = {SLAB_TARGET, SLAB_MIRROR};
    for (int i = 0; i < 2; i++) {
        const double rise = heights[i] - scene->altitude;
        const double middle = atan2(rise, scene->centre_y);
        const double half = asin(scene->radius / hypot(rise, scene->centre_y));
        trace_fan(run, aims[i], scene->radius, middle - half, middle + half, rays);
    }
    /* a first hit beside the track may be heard in a column between it and a last one */
    const double half_track = run->request->half_track;
    const double half_width = run->request->is_focused
                                  ? fmin(2.0 * half_track, fmax(half_track, run->request->reach_x))
                                  : half_track;
    trace_fan(run, SLAB_SEABED, half_width, -0.5 * PI, 1.5 * PI, rays);
}

void slab_trace(const struct slab_scene *scene, const struct slab_request *request,
                struct slab_energy *energy)
{
    struct run run;
    memset(&run, 0, sizeof run);
    memset(energy, 0, sizeof *energy);
    run.scene = scene;
    run.request = request;
    run.state = (request->seed ^ (request->seed >> 29)) * UINT64_C(0xd6e8feb86659fd93) + 1;
    run.batch = malloc(sizeof *run.batch);
    if (!run.batch)
        abort();
    struct estimate *kept[] = {&energy->in_first[0][0], &energy->in_both[0][0]};
    const double *traced[] = {&run.batch->first[0][0], &run.batch->both[0][0]};
    for (int batch = 0; batch < SLAB_BATCHES; batch++) {
        memset(run.batch, 0, sizeof *run.batch);
        trace_batch(&run);
        for (int k = 0; k < 2; k++)
            for (int i = 0; i < SLAB_PATHS * SLAB_BINS; i++) { /* sums, for now */
                kept[k][i].mean += traced[k][i];
                kept[k][i].error += traced[k][i] * traced[k][i];
            }
    }
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < SLAB_PATHS * SLAB_BINS; i++)
            kept[k][i] = estimate_of_sums(kept[k][i].mean, kept[k][i].error, SLAB_BATCHES);
    free(run.batch);
}
