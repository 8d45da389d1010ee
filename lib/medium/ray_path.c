/* Snell's law through level layers (kernels/MATH.md, "Layers"). A ray has the ray parameter
 * p = cos(grazing angle) / c. x is the cotangent of that angle where sound is fastest, at c_max.
 * In x, from 0 to infinity, nothing cancels near total reflection and ranges grow about linearly:
 *     p c = rho x / sqrt(1 + x^2),  sin = sqrt((1 + x^2 (1 - rho^2)) / (1 + x^2)),  rho = c / c_max
 */
#include "medium/water.h"

#include <math.h>

#define PI           3.14159265358979323846
#define NEWTON_STEPS 200
#define TOLERANCE    1e-15 /* relative error of ranges */

struct ray_path ray_path_direct(const struct water *water, double sonar_height_m)
{
    struct ray_path path = {water, sonar_height_m, sonar_height_m, 0.0, 0, false, false};
    path.is_straight = water->count < 2 || water->layers[1].bottom_m >= sonar_height_m;
    return path;
}

struct ray_path ray_path_image(const struct water *water, double sonar_height_m, double depth_m,
                               uint32_t bounces, bool comes_from_seabed)
{
    struct ray_path path = ray_path_direct(water, sonar_height_m);
    path.depth_m = depth_m;
    path.bounces = bounces;
    path.comes_from_seabed = comes_from_seabed;
    const bool meets_surface = bounces > 1 || !comes_from_seabed;
    path.is_straight =
        meets_surface ? water->count < 2 || water->layers[1].bottom_m >= depth_m : path.is_straight;
    /* each image is that of the one before, from the far boundary to the one next to the target */
    bool by_seabed = (bounces % 2 == 1) == comes_from_seabed;
    for (uint32_t i = 0; i < bounces; i++, by_seabed = !by_seabed)
        path.image_height_m = (by_seabed ? 0.0 : 2.0 * depth_m) - path.image_height_m;
    return path;
}

/* Returns whether the sound meets the seabed first, or no boundary. */
static bool goes_down_first(const struct ray_path *path)
{
    return path->bounces == 0 || (path->bounces % 2 == 1) == path->comes_from_seabed;
}

/* Heights between the sonar and the first boundary, and after the last boundary. In between, the
 * path crosses the whole depth bounces - 1 times. */
struct legs {
    double first_low, first_high, last_low, last_high;
    uint32_t whole;
};

static struct legs legs_of(const struct ray_path *path)
{
    struct legs legs = {0.0, path->sonar_height_m, 0.0, 0.0, 0};
    if (path->bounces == 0)
        return legs;
    legs.whole = path->bounces - 1;
    if (!goes_down_first(path)) {
        legs.first_low = path->sonar_height_m;
        legs.first_high = path->depth_m;
    }
    if (!path->comes_from_seabed)
        legs.last_high = path->depth_m;
    return legs;
}

static double between(double low, double high, double bottom, double top)
{
    return fmax(0.0, fmin(high, top) - fmax(low, bottom));
}

/* The last stretch of a path. In the straight water it leads from the upper edge or the seabed to a
 * height; in a slice it leads down to a height. */
struct stretch {
    size_t layer;
    double height_m; /* height that it crosses */
    double speed_mps;
};

static struct stretch last_stretch(const struct ray_path *path, double height)
{
    const struct water *water = path->water;
    const struct water_layer *layers = water->layers;
    size_t i = 0;
    while (path->bounces == 0 && i + 1 < water->slices && layers[i + 1].bottom_m < height)
        i++;
    struct stretch last = {i, path->comes_from_seabed ? height : layers[1].bottom_m - height,
                           layers[i].speed_mps};
    if (i > 0)
        last.height_m =
            fmin(i + 1 < water->count ? layers[i + 1].bottom_m : INFINITY, path->sonar_height_m) -
            height;
    return last;
}

/* Returns the height of layer i that the path crosses before the last stretch. */
static double crossed_height(const struct ray_path *path, const struct legs *legs,
                             const struct stretch *last, size_t i)
{
    const struct water *water = path->water;
    const double bottom = water->layers[i].bottom_m;
    const double top = i + 1 < water->count ? water->layers[i + 1].bottom_m : INFINITY;
    if (last->layer > 0 && i <= last->layer)
        return 0.0;
    double height = between(legs->first_low, legs->first_high, bottom, top) +
                    between(legs->last_low, legs->last_high, bottom, top);
    if (legs->whole > 0)
        height += legs->whole * between(0.0, path->depth_m, bottom, top);
    if (i == 0 && !path->comes_from_seabed)
        height -= top;
    return height;
}

/* Returns how often the path crosses the plane at a height. */
static uint32_t crossings(const struct legs *legs, double height)
{
    return legs->whole + (height > legs->first_low && height < legs->first_high) +
           (height > legs->last_low && height < legs->last_high);
}

/* Returns the sound speed of the fastest water on the path. */
static double fastest(const struct ray_path *path, const struct legs *legs,
                      const struct stretch *last)
{
    double speed = last->height_m > 0.0 ? last->speed_mps : 0.0;
    for (size_t i = 0; i < path->water->count; i++)
        if (crossed_height(path, legs, last, i) > 0.0)
            speed = fmax(speed, path->water->layers[i].speed_mps);
    return speed;
}

/* The sums over a ray's path. */
struct sums {
    double range;  /* horizontal, m */
    double time;   /* s */
    double length; /* m */
    double growth; /* dr/dp = sum of h c / sin^3, m^2/s */
};

static void add_layer(struct sums *sums, double height, double speed, double fastest_speed,
                      double x)
{
    const double rho = speed / fastest_speed;
    const double square = 1.0 + x * x;
    const double sine = sqrt((1.0 + x * x * (1.0 - rho) * (1.0 + rho)) / square);
    sums->range += height * rho * x / (sqrt(square) * sine);
    sums->time += height / (speed * sine);
    sums->length += height / sine;
    sums->growth += height * speed / (sine * sine * sine);
}

static struct sums sum_path(const struct ray_path *path, const struct legs *legs,
                            const struct stretch *last, double fastest_speed, double x)
{
    struct sums sums = {0.0, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < path->water->count; i++) {
        const double height = crossed_height(path, legs, last, i);
        if (height > 0.0)
            add_layer(&sums, height, path->water->layers[i].speed_mps, fastest_speed, x);
    }
    if (last->height_m > 0.0)
        add_layer(&sums, last->height_m, last->speed_mps, fastest_speed, x);
    return sums;
}

/* Returns the share of energy that a plane between layers transmits: 1 - R^2, with Rayleigh's R. */
static double plane_transmission(const struct water_layer *one, const struct water_layer *other,
                                 double ray_parameter)
{
    const double sine_one = sqrt(1.0 - pow(ray_parameter * one->speed_mps, 2.0));
    const double sine_other = sqrt(1.0 - pow(ray_parameter * other->speed_mps, 2.0));
    const double first = one->density * one->speed_mps * sine_other;
    const double second = other->density * other->speed_mps * sine_one;
    const double reflection = (first - second) / (first + second);
    return 1.0 - reflection * reflection;
}

/* Returns the share of energy that all planes transmit. Planes between equal densities are those of
 * a profile, which changes gently, and transmit all. */
static double transmission(const struct ray_path *path, const struct legs *legs,
                           const struct stretch *last, double ray_parameter)
{
    double share = 1.0;
    for (size_t i = last->layer; i + 1 < path->water->count; i++) {
        const struct water_layer *below = &path->water->layers[i];
        const struct water_layer *above = &path->water->layers[i + 1];
        if (below->density != above->density)
            share *= pow(plane_transmission(below, above, ray_parameter),
                         crossings(legs, above->bottom_m));
    }
    return share;
}

static struct arrival straight_ray(const struct ray_path *path, double grazing, double height)
{
    const double drop = path->image_height_m - height;
    struct arrival ray;
    ray.grazing_rad = grazing;
    ray.straight_range_m = drop / sin(grazing);
    ray.ground_range_m = ray.straight_range_m * cos(grazing);
    ray.length_m = ray.straight_range_m;
    ray.wavefront_m = ray.straight_range_m;
    ray.spreading = cos(grazing);
    return ray;
}

struct arrival ray_path_arrival(const struct ray_path *path, double grazing_rad, double height_m)
{
    static const struct arrival none = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY};
    if (path->is_straight)
        return straight_ray(path, grazing_rad, height_m);
    const struct legs legs = legs_of(path);
    const struct stretch last = last_stretch(path, height_m);
    const double straight_speed = path->water->straight_speed_mps;
    const double fastest_speed = fastest(path, &legs, &last);
    const double speed = last.speed_mps;
    double cosine = cos(grazing_rad);
    double sine = fabs(sin(grazing_rad));
    const double fast_cosine = cosine * fastest_speed / straight_speed;
    if (!(fast_cosine < 1.0))
        return none;
    const struct sums sums =
        sum_path(path, &legs, &last, fastest_speed,
                 fast_cosine / sqrt((1.0 - fast_cosine) * (1.0 + fast_cosine)));
    const double at_sonar = water_layer_at(path->water, path->sonar_height_m)->speed_mps / speed;
    struct arrival ray;
    ray.grazing_rad = grazing_rad;
    if (last.layer > 0) {
        cosine *= speed / straight_speed;
        sine = sqrt((1.0 - cosine) * (1.0 + cosine));
        ray.grazing_rad = acos(cosine);
    }
    ray.ground_range_m = sums.range;
    ray.straight_range_m = sums.time * straight_speed;
    ray.length_m = sums.length;
    ray.wavefront_m = sums.growth * sine * sine / speed;
    ray.spreading = at_sonar * cosine * sine * transmission(path, &legs, &last, cosine / speed) /
                    sqrt(1.0 - pow(cosine * at_sonar, 2.0));
    return ray;
}

/* Returns the x of the ray with the wanted range, or travel time. Both grow with x: dr/dx = dr/dp
 * dp/dx and dt/dp = p dr/dp. */
static double find_ray(const struct ray_path *path, const struct legs *legs,
                       const struct stretch *last, double fastest_speed, double wanted,
                       bool is_time)
{
    double low = 0.0, high = INFINITY;
    double x = 1.0;
    for (int i = 0; i < NEWTON_STEPS; i++) {
        const struct sums sums = sum_path(path, legs, last, fastest_speed, x);
        const double found = is_time ? sums.time : sums.range;
        const double square = 1.0 + x * x;
        const double per_x = 1.0 / (fastest_speed * square * sqrt(square));
        const double parameter = x / (fastest_speed * sqrt(square));
        const double slope = sums.growth * per_x * (is_time ? parameter : 1.0);
        if (fabs(found - wanted) <= TOLERANCE * wanted)
            break;
        *(found < wanted ? &low : &high) = x;
        const double newton = x - (found - wanted) / slope;
        const double middle = isinf(high) ? 2.0 * x : 0.5 * (low + high);
        const double next = newton > low && newton < high ? newton : middle;
        if (next == x)
            break;
        x = next;
    }
    return x;
}

/* The ray to a height at a known range, or travel time. */
struct found_ray {
    struct legs legs;
    struct stretch last;
    double fastest_speed, x;
};

static struct found_ray ray_to(const struct ray_path *path, double height, double wanted,
                               bool is_time)
{
    struct found_ray ray = {legs_of(path), last_stretch(path, height), 0.0, 0.0};
    ray.fastest_speed = fastest(path, &ray.legs, &ray.last);
    ray.x = find_ray(path, &ray.legs, &ray.last, ray.fastest_speed, wanted, is_time);
    return ray;
}

double ray_path_grazing(const struct ray_path *path, double ground_range_m, double height_m)
{
    if (path->is_straight)
        return atan2(path->image_height_m - height_m, ground_range_m);
    const struct found_ray ray = ray_to(path, height_m, ground_range_m, false);
    const double grazing = acos(path->water->straight_speed_mps / ray.fastest_speed * ray.x /
                                sqrt(1.0 + ray.x * ray.x));
    return path->comes_from_seabed ? -grazing : grazing;
}

double ray_path_direction(const struct ray_path *path, double ground_range_m, double height_m)
{
    const double grazing = ray_path_grazing(path, ground_range_m, height_m);
    if (path->is_straight)
        return grazing;
    const struct stretch last = last_stretch(path, height_m);
    return last.layer == 0 ? grazing
                           : acos(cos(grazing) * last.speed_mps / path->water->straight_speed_mps);
}

double ray_path_shadow(const struct ray_path *path, double ground_range_m, double top_m,
                       double ground_m)
{
    if (!(top_m > ground_m))
        return 0.0;
    const double grazing = ray_path_grazing(path, ground_range_m, top_m);
    if (path->water->slices == 1)
        return (top_m - ground_m) / tan(grazing);
    return ray_path_arrival(path, grazing, ground_m).ground_range_m - ground_range_m;
}

double ray_path_range(const struct ray_path *path, double ground_range_m, double height_m)
{
    if (path->is_straight)
        return hypot(ground_range_m, path->image_height_m - height_m);
    const struct found_ray ray = ray_to(path, height_m, ground_range_m, false);
    return sum_path(path, &ray.legs, &ray.last, ray.fastest_speed, ray.x).time *
           path->water->straight_speed_mps;
}

double ray_path_ground_range(const struct ray_path *path, double straight_range_m)
{
    if (path->is_straight) {
        const double drop = path->image_height_m;
        const double square = straight_range_m * straight_range_m - drop * drop;
        return square > 0.0 ? sqrt(square) : 0.0;
    }
    const struct legs legs = legs_of(path);
    const struct stretch last = last_stretch(path, 0.0);
    const double time = straight_range_m / path->water->straight_speed_mps;
    if (time <= sum_path(path, &legs, &last, fastest(path, &legs, &last), 0.0).time)
        return 0.0;
    const struct found_ray ray = ray_to(path, 0.0, time, true);
    return sum_path(path, &ray.legs, &ray.last, ray.fastest_speed, ray.x).range;
}
