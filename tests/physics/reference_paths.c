#include "reference_paths.h"

#define LIFT_M 1e-9 /* far above the rounding at some 100 m (1e-14), far below every size */

/* ---- surfaces ---- */

struct reference_vector reference_sum(struct reference_vector a, double scale,
                                      struct reference_vector b)
{
    const struct reference_vector sum = {a.x + scale * b.x, a.y + scale * b.y, a.z + scale * b.z};
    return sum;
}

double reference_dot(struct reference_vector a, struct reference_vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct reference_vector cross(struct reference_vector a, struct reference_vector b)
{
    const struct reference_vector product = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                                             a.x * b.y - a.y * b.x};
    return product;
}

static struct reference_vector unit(struct reference_vector a)
{
    const double length = sqrt(reference_dot(a, a));
    const struct reference_vector along = {a.x / length, a.y / length, a.z / length};
    return along;
}

/* The nearest hit so far, in the body's own axes. */
struct meeting {
    double distance;
    struct reference_vector normal;
};

static void keep_nearest(struct meeting *nearest, double distance, struct reference_vector normal)
{
    if (distance > 0.0 && distance < nearest->distance) {
        nearest->distance = distance;
        nearest->normal = normal;
    }
}

/* Meets a sphere about (shift, 0, 0). A capsule's end (`end` -1, 1) is the outer half. */
static void meet_sphere(struct meeting *nearest, struct reference_vector o,
                        struct reference_vector d, double radius, double shift, int end)
{
    const struct reference_vector from = {o.x - shift, o.y, o.z};
    const struct reference_vector moment = cross(from, d);
    const double discriminant = radius * radius - reference_dot(moment, moment);
    if (discriminant <= 0.0)
        return;
    const double distance = -reference_dot(from, d) - sqrt(discriminant);
    const struct reference_vector outwards = reference_sum(from, distance, d);
    if (end == 0 || outwards.x * end >= 0.0)
        keep_nearest(nearest, distance, unit(outwards));
}

/* Meets the round side of a cylinder along own x. */
static void meet_side(struct meeting *nearest, struct reference_vector o, struct reference_vector d,
                      double radius, double half_length)
{
    const double a = d.y * d.y + d.z * d.z, moment = o.y * d.z - o.z * d.y;
    const double discriminant = a * radius * radius - moment * moment;
    if (discriminant <= 0.0)
        return;
    const double distance = -(o.y * d.y + o.z * d.z + sqrt(discriminant)) / a;
    const struct reference_vector at = reference_sum(o, distance, d);
    const struct reference_vector outwards = {0.0, at.y, at.z};
    if (fabs(at.x) <= half_length)
        keep_nearest(nearest, distance, unit(outwards));
}

static void meet_flat_ends(struct meeting *nearest, struct reference_vector o,
                           struct reference_vector d, double radius, double half_length)
{
    for (int end = -1; end <= 1 && d.x != 0.0; end += 2) {
        const double distance = (end * half_length - o.x) / d.x;
        const struct reference_vector at = reference_sum(o, distance, d), out = {end, 0.0, 0.0};
        if (at.y * at.y + at.z * at.z <= radius * radius)
            keep_nearest(nearest, distance, out);
    }
}

static struct reference_vector in_own_axes(const struct reference_body *body,
                                           struct reference_vector v)
{
    const struct reference_vector own = {reference_dot(v, body->axes[0]),
                                         reference_dot(v, body->axes[1]),
                                         reference_dot(v, body->axes[2])};
    return own;
}

/* Meets the body. The normal is returned in the scene's axes. */
static struct meeting meet_body(const struct reference_body *body, struct reference_vector origin,
                                struct reference_vector direction)
{
    struct meeting nearest = {INFINITY, {0.0, 0.0, 0.0}};
    const struct reference_vector from = reference_sum(origin, -1.0, body->centre);
    const double half = 0.5 * body->length, radius = body->radius;
    if (body->shape == REFERENCE_SPHERE) { /* the same in all axes */
        meet_sphere(&nearest, from, direction, radius, 0.0, 0);
        return nearest;
    }
    const struct reference_vector o = in_own_axes(body, from), d = in_own_axes(body, direction);
    if (body->shape == REFERENCE_CAPSULE) {
        meet_side(&nearest, o, d, radius, half - radius);
        meet_sphere(&nearest, o, d, radius, half - radius, 1);
        meet_sphere(&nearest, o, d, radius, radius - half, -1);
    } else {
        meet_side(&nearest, o, d, radius, half);
        meet_flat_ends(&nearest, o, d, radius, half);
    }
    const struct reference_vector own = nearest.normal, none = {0.0, 0.0, 0.0};
    nearest.normal = reference_sum(
        reference_sum(reference_sum(none, own.x, body->axes[0]), own.y, body->axes[1]), own.z,
        body->axes[2]);
    return nearest;
}

enum reference_surface reference_nearest(const struct reference_scene *scene,
                                         struct reference_vector origin,
                                         struct reference_vector direction,
                                         struct reference_hit *hit)
{
    const bool is_up = direction.z > 0.0;
    const struct meeting on_body = meet_body(&scene->body, origin, direction);
    const double height = is_up ? scene->depth : 0.0;
    const double on_plane = direction.z != 0.0 ? (height - origin.z) / direction.z : INFINITY;
    const bool is_on_body = on_body.distance < on_plane;
    const struct reference_vector plane_normal = {0.0, 0.0, is_up ? -1.0 : 1.0};
    hit->distance = is_on_body ? on_body.distance : on_plane;
    if (!(hit->distance > 0.0 && hit->distance < INFINITY))
        return MET_NOTHING;
    hit->normal = is_on_body ? on_body.normal : plane_normal;
    hit->point =
        reference_sum(reference_sum(origin, hit->distance, direction), LIFT_M, hit->normal);
    return is_on_body ? MET_TARGET : is_up ? MET_SURFACE : MET_SEABED;
}

bool reference_blocked(const struct reference_scene *scene, struct reference_vector from,
                       struct reference_vector to)
{
    const struct reference_vector way = reference_sum(to, -1.0, from);
    return meet_body(&scene->body, from, unit(way)).distance < sqrt(reference_dot(way, way));
}

/* Returns 1 - exp(-P^2), the share that roughness takes from the mirror. */
static double taken(const struct reference_scene *scene, double cosine)
{
    const double phase = scene->phase * cosine;
    return scene->reflection == 0.0 ? 1.0 : 1.0 - exp(-phase * phase);
}

static double mirrored(const struct reference_scene *scene, double cosine)
{
    return scene->reflection * scene->reflection * (1.0 - taken(scene, cosine));
}

static double lambert_of(const struct reference_scene *scene, int met, double cosine_in,
                         double cosine_out)
{
    if (met == MET_SURFACE && scene->rough_is_apart)
        return scene->surface_lambert;
    if (met == MET_SURFACE)
        return scene->surface_lambert * taken(scene, cosine_in) * taken(scene, cosine_out);
    return met == MET_TARGET ? scene->body.lambert : scene->seabed_lambert;
}

/* Returns the radius of a sphere that holds the body. */
static double bounding_radius(const struct reference_body *body)
{
    return hypot(0.5 * body->length, body->radius);
}

/* ---- paths ---- */

struct tally {
    double first[REFERENCE_PATHS][REFERENCE_BINS], both[REFERENCE_PATHS][REFERENCE_BINS];
};

struct run {
    const struct reference_scene *scene;
    const struct reference_request *request;
    uint64_t state;
    struct tally batch;
};

struct ray {
    struct reference_vector origin, way;
    double sonar_x, length, weight;
    double first_leg;
    int path, hits;
    bool has_spread; /* the ray met something that is no mirror */
};

int reference_met(int path, int met[REFERENCE_ORDERS])
{
    int count = 0;
    for (int rest = path; rest > 0; rest /= 5)
        count++;
    for (int i = count - 1, rest = path; i >= 0; i--, rest /= 5)
        met[i] = rest % 5;
    return count;
}

static bool is_counted(const struct reference_request *request, double x)
{
    return x >= request->first_x && x <= request->last_x;
}

static double column_of(const struct run *run, const struct ray *ray)
{
    return run->request->is_focused ? 0.5 * (ray->sonar_x + ray->origin.x) : ray->sonar_x;
}

static void deposit(struct run *run, const struct ray *ray, int path, double last_leg,
                    double energy)
{
    const struct ranges *ranges = &run->request->ranges;
    const double column = column_of(run, ray);
    const double longer = hypot(ray->first_leg, ray->sonar_x - column) - ray->first_leg;
    const double range = 0.5 * (ray->length + longer + last_leg);
    const double bin = floor((range - ranges->first_m) / ranges->width_m);
    if (bin < 0.0 || bin >= ranges->count || !is_counted(run->request, column) ||
        path >= REFERENCE_PATHS)
        return;
    run->batch.first[path][(int)bin] += energy * pow(range, 4.0);
    if (is_counted(run->request, ray->origin.x))
        run->batch.both[path][(int)bin] += energy * pow(range, 4.0);
}

static struct reference_vector source_point(struct run *run, const struct ray *ray)
{
    const struct reference_scene *scene = run->scene;
    const double along = scene->source_side * (next_uniform(&run->state) - 0.5);
    const double up = scene->source_side * (next_uniform(&run->state) - 0.5);
    const struct reference_vector source = {column_of(run, ray) + along,
                                            up * sin(scene->source_grazing),
                                            scene->altitude + up * cos(scene->source_grazing)};
    return source;
}

static bool is_looked_at(const struct run *run, struct reference_vector seabed)
{
    const struct reference_request *request = run->request;
    return seabed.y >= request->near_ground && seabed.y <= request->far_ground &&
           fabs(seabed.x - run->scene->body.centre.x) <= request->reach_x;
}

/* Returns false where the library cannot find the path. It finds paths surface - target - seabed in
 * reverse, so their seabed must be looked at. */
static bool is_found_from_seabed(const struct run *run, const struct ray *ray)
{
    const bool is_reverse = ray->hits == 3 && ray->path / 25 >= MET_SURFACE &&
                            ray->path % 25 == 5 * MET_TARGET + MET_SEABED;
    return !is_reverse || is_looked_at(run, ray->origin);
}

/* Connects the hit to the source: straight, and by the mirror unless the surface itself is hit. */
static void connect(struct run *run, const struct ray *ray, struct reference_vector normal, int met,
                    double cosine_in)
{
    const struct reference_scene *scene = run->scene;
    const struct reference_vector facing = {0.0, cos(scene->source_grazing),
                                            -sin(scene->source_grazing)};
    if (!is_found_from_seabed(run, ray))
        return;
    for (int by_image = 0; by_image < 2; by_image++) {
        if (by_image && (met == MET_SURFACE || scene->reflection == 0.0))
            continue;
        const struct reference_vector source = source_point(run, ray);
        struct reference_vector goal = source;
        if (by_image)
            goal.z = 2.0 * scene->depth - goal.z;
        const struct reference_vector to = reference_sum(goal, -1.0, ray->origin);
        const double square = reference_dot(to, to);
        const double cosine = reference_dot(to, normal) / sqrt(square);
        struct reference_vector home = {-to.x, -to.y, by_image ? to.z : -to.z};
        if (cosine <= 0.0 || (scene->source_side > 0.0 && reference_dot(home, facing) <= 0.0))
            continue;
        double energy = ray->weight * lambert_of(scene, met, cosine_in, cosine) * cosine / square;
        struct reference_vector from = ray->origin;
        if (by_image) {
            const double share = (scene->depth - from.z) / to.z;
            const struct reference_vector bounce = reference_sum(from, share, to);
            energy *= mirrored(scene, to.z / sqrt(square));
            if (reference_blocked(scene, from, bounce))
                continue;
            from = bounce;
        }
        if (energy > 0.0 && !reference_blocked(scene, from, source))
            deposit(run, ray, by_image ? 5 * ray->path + MET_MIRROR : ray->path, sqrt(square),
                    energy);
    }
}

static struct reference_vector about(struct reference_vector axis, double cosine, double turn)
{
    const struct reference_vector x = {1.0, 0.0, 0.0}, y = {0.0, 1.0, 0.0}, none = {0.0, 0.0, 0.0};
    const struct reference_vector other = fabs(axis.x) < 0.7 ? x : y;
    const struct reference_vector first =
        unit(reference_sum(other, -reference_dot(other, axis), axis));
    const double sine = sqrt(fmax(0.0, 1.0 - cosine * cosine));
    return reference_sum(reference_sum(reference_sum(none, cosine, axis), sine * cos(turn), first),
                         sine * sin(turn), cross(axis, first));
}

/* Scatters half of the rays by Lambert's law and half into the cone of the body's bounding sphere.
 * From the body all follow Lambert's law. The weight gains f cos / density. */
static void scatter(struct run *run, struct ray *ray, struct reference_vector normal, int met,
                    double cosine_in)
{
    const struct reference_scene *scene = run->scene;
    const struct reference_vector to = reference_sum(scene->body.centre, -1.0, ray->origin);
    const double radius = bounding_radius(&scene->body);
    const double opening = 1.0 - sqrt(fmax(0.0, 1.0 - radius * radius / reference_dot(to, to)));
    const double cone_share = met == MET_TARGET ? 0.0 : 0.5;
    const double turn = 2.0 * PI * next_uniform(&run->state);
    const double u = next_uniform(&run->state);
    ray->way = next_uniform(&run->state) < cone_share ? about(unit(to), 1.0 - u * opening, turn)
                                                      : about(normal, sqrt(u), turn);
    const double cosine = reference_dot(normal, ray->way);
    const bool is_in_cone = reference_dot(unit(to), ray->way) >= 1.0 - opening;
    const double density = (1.0 - cone_share) * fmax(0.0, cosine) / PI +
                           (is_in_cone ? cone_share / (2.0 * PI * opening) : 0.0);
    ray->weight = cosine > 0.0
                      ? ray->weight * lambert_of(scene, met, cosine_in, cosine) * cosine / density
                      : 0.0;
}

/* Returns whether the ray belongs to fan `aim`; others do not count. Fans are of rays that meet the
 * target at once, the seabed at once, the target after the mirror (MET_MIRROR), or the surface. */
static bool is_aimed(const struct ray *ray, int aim)
{
    if (ray->hits == 1)
        return ray->path == MET_MIRROR ? aim >= MET_SURFACE : ray->path == aim;
    if (ray->hits == 2 && ray->path / 5 == MET_MIRROR)
        return (ray->path % 5 == MET_TARGET) == (aim == MET_MIRROR);
    return true;
}

/* Follows a ray. At the sea surface a lot decides between the smooth and the rough part. */
static void follow(struct run *run, struct ray *ray, int aim)
{
    const struct ranges *ranges = &run->request->ranges;
    const double limit = ranges->first_m + ranges->count * ranges->width_m;
    while (ray->hits < REFERENCE_ORDERS && ray->weight > 0.0) {
        struct reference_hit hit;
        int met = (int)reference_nearest(run->scene, ray->origin, ray->way, &hit);
        if (met == MET_SURFACE && run->scene->reflection != 0.0) {
            ray->weight *= 2.0;
            met = next_uniform(&run->state) < 0.5 ? MET_MIRROR : MET_SURFACE;
        }
        ray->path = 5 * ray->path + met;
        ray->hits++;
        ray->length += hit.distance;
        if (met == MET_NOTHING || 0.5 * ray->length > limit || !is_aimed(ray, aim))
            return;
        ray->origin = hit.point;
        if (ray->hits == 1 && met == MET_SEABED && !is_looked_at(run, ray->origin))
            return;
        const double cosine = -reference_dot(hit.normal, ray->way);
        if (met == MET_MIRROR) {
            ray->weight *= mirrored(run->scene, cosine);
            ray->way.z = -ray->way.z;
            continue;
        }
        if (!ray->has_spread) { /* dA / r1^2, now that r1 is known */
            ray->weight /= ray->length;
            ray->first_leg = ray->length;
        }
        ray->has_spread = true;
        connect(run, ray, hit.normal, met, cosine);
        scatter(run, ray, hit.normal, met, cosine);
    }
}

/* The x at which rays begin, m, and their elevations, rad, upwards. */
struct fan {
    double first_x, last_x, first, last;
};

static double area_of(const struct fan *fan)
{
    return (fan->last_x - fan->first_x) * (fan->last - fan->first);
}

/* Traces a fan. Every other ray is from `most`, the part of the fan that brings most energy.
 * Elevations are stratified inside a batch, one ray a stratum. */
static void trace_fan(struct run *run, int aim, const struct fan *all, const struct fan *most)
{
    const uint64_t rays = run->request->rays / REFERENCE_BATCHES / 2 * 2;
    for (uint64_t i = 0; i < rays; i++) {
        const struct fan *fan = i % 2 ? most : all;
        const double stratum = 2.0 * ((double)(i / 2) + next_uniform(&run->state)) / (double)rays;
        const double elevation = fan->first + (fan->last - fan->first) * stratum;
        struct ray ray;
        memset(&ray, 0, sizeof ray);
        ray.sonar_x = fan->first_x + (fan->last_x - fan->first_x) * next_uniform(&run->state);
        ray.origin.x = ray.sonar_x;
        ray.origin.z = run->scene->altitude;
        ray.way.y = cos(elevation);
        ray.way.z = sin(elevation);
        const bool is_in_most = ray.sonar_x >= most->first_x && ray.sonar_x <= most->last_x &&
                                elevation >= most->first && elevation <= most->last;
        ray.weight =
            2.0 / (1.0 / area_of(all) + (is_in_most ? 1.0 / area_of(most) : 0.0)) / (double)rays;
        follow(run, &ray, aim);
    }
}

static void trace_batch(struct run *run)
{
    const struct reference_scene *scene = run->scene;
    const struct reference_request *request = run->request;
    const struct reference_vector centre = scene->body.centre;
    const double radius = bounding_radius(&scene->body), about_it = radius + 2.0;
    const double heights[] = {centre.z, 2.0 * scene->depth - centre.z};
    static const int aims[] = {MET_TARGET, MET_MIRROR};
    for (int i = 0; i < (scene->reflection != 0.0 ? 2 : 1); i++) {
        const double rise = heights[i] - scene->altitude, middle = atan2(rise, centre.y);
        const double half = asin(radius / hypot(rise, centre.y));
        const struct fan fan = {centre.x - radius, centre.x + radius, middle - half, middle + half};
        trace_fan(run, aims[i], &fan, &fan);
    }
    /* a first hit beside the track may be heard in a column on the way to the last hit */
    const double track = request->last_x - request->first_x;
    const double beside =
        request->is_focused ? fmin(0.5 * track, fmax(0.0, request->reach_x - 0.5 * track)) : 0.0;
    const struct fan seabed = {request->first_x - beside, request->last_x + beside,
                               -atan2(scene->altitude, request->near_ground),
                               -atan2(scene->altitude, request->far_ground)};
    const struct fan near_body = {fmax(seabed.first_x, centre.x - about_it),
                                  fmin(seabed.last_x, centre.x + about_it),
                                  fmax(seabed.first, -atan2(scene->altitude, centre.y - about_it)),
                                  fmin(seabed.last, -atan2(scene->altitude, centre.y + about_it))};
    const struct fan surface = {seabed.first_x, seabed.last_x, 0.0, PI};
    if (scene->seabed_lambert > 0.0)
        trace_fan(run, MET_SEABED, &seabed, &near_body);
    if (scene->depth < INFINITY)
        trace_fan(run, MET_SURFACE, &surface, &surface);
}

void reference_of_sea(const struct sea *sea, enum reference_shape shape,
                      struct reference_scene *scene, struct reference_request *request)
{
    const sonject_object_params *object = sea_object(sea, 0);
    const sonject_material_params *surface = &sea->surface->material;
    const double *centre = sea_centre(sea, 0);
    const double depth = sea->surface->water_depth_m;
    *scene = (struct reference_scene){
        .altitude = sea->sonar->altitude_m,
        .depth = depth > 0.0 ? depth : INFINITY,
        .seabed_lambert = sea->seabed->lambert,
        .surface_lambert = surface->lambert,
        .reflection = depth > 0.0 ? surface->reflection : 0.0,
        .phase = 2.0 * sea_wavenumber(sea) * surface->roughness_m,
        .body = {.shape = shape,
                 .centre = {centre[0], centre[1], centre[2]},
                 .length = object->length_m,
                 .radius = 0.5 * object->diameter_m,
                 .lambert = object->material.lambert},
        .source_side = sea->sonar->transducer_side_m,
    };
    for (int axis = 0; axis < 3; axis++) {
        const double *own = sea_axes(sea, 0)[axis];
        scene->body.axes[axis] = (struct reference_vector){own[0], own[1], own[2]};
    }
    *request = (struct reference_request){.far_ground = INFINITY, .reach_x = INFINITY};
    sea_grid(sea, &request->first_x, &request->last_x);
}

void reference_trace(const struct reference_scene *scene, const struct reference_request *request,
                     struct reference_energy *energy)
{
    static struct run run;
    memset(energy, 0, sizeof *energy);
    run.scene = scene;
    run.request = request;
    run.state = UINT64_C(0xe05ef70acc75ef06); /* any seed */
    struct estimate *kept[] = {&energy->in_first[0][0], &energy->in_both[0][0]};
    const double *traced[] = {&run.batch.first[0][0], &run.batch.both[0][0]};
    for (int batch = 0; batch < REFERENCE_BATCHES; batch++) {
        memset(&run.batch, 0, sizeof run.batch);
        trace_batch(&run);
        for (int k = 0; k < 2; k++)
            for (int i = 0; i < REFERENCE_PATHS * REFERENCE_BINS;
                 i++) { /* sums of values and squares, for now */
                kept[k][i].mean += traced[k][i];
                kept[k][i].error += traced[k][i] * traced[k][i];
            }
    }
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < REFERENCE_PATHS * REFERENCE_BINS; i++)
            kept[k][i] = estimate_of_sums(kept[k][i].mean, kept[k][i].error, REFERENCE_BATCHES);
}
