/* Where rays meet shapes, against a reference in double precision that tries every piece of every
 * surface. Rays come from sonars at 50 m and 500 m, many of them grazing. */
#include "claims.h"
#include "fan.h"
#include "intersection.h"
#include "random_rays.h"

#define RAYS 100000

/* An object as both sides know it: the record, read back into double. */
static struct object_record make_object(int shape, double length, double width, double diameter,
                                        struct point centre)
{
    struct object_record object;
    memset(&object, 0, sizeof object);
    const double heading = uniform(-PI, PI);
    const double pitch = uniform(-1.2, 1.2);
    const double roll = uniform(-PI, PI);
    const double cp = cos(pitch), sp = sin(pitch);
    const double nose[3] = {cos(heading) * cp, sin(heading) * cp, sp};
    const double side[3] = {-sin(heading), cos(heading), 0.0};
    const double up[3] = {-cos(heading) * sp, -sin(heading) * sp, cp};
    object.shape = shape;
    for (int i = 0; i < 3; i++) {
        object.axes[i] = (float)nose[i];
        object.axes[3 + i] = (float)(side[i] * cos(roll) + up[i] * sin(roll));
        object.axes[6 + i] = (float)(up[i] * cos(roll) - side[i] * sin(roll));
    }
    object.centre_x = (float)centre.x;
    object.centre_y = (float)centre.y;
    object.centre_z = (float)centre.z;
    object.radius = (float)(0.5 * diameter);
    object.half_width = (float)(0.5 * width);
    object.half_length = (float)(shape == SHAPE_CAPSULE ? 0.5 * (length - diameter) : 0.5 * length);
    const double reach = shape == SHAPE_PLANE      ? hypot(0.5 * length, 0.5 * width)
                         : shape == SHAPE_SPHERE   ? 0.5 * diameter
                         : shape == SHAPE_CYLINDER ? hypot(0.5 * length, 0.5 * diameter)
                                                   : 0.5 * length;
    object.bounding_radius = (float)(reach * (1.0 + 1e-6));
    return object;
}

static struct object_record random_object(int shape, struct point centre)
{
    const double diameter = uniform(0.1, 1.0);
    const double length = diameter * uniform(1.0, 5.0);
    return make_object(shape, length, uniform(0.1, 1.0), diameter, centre);
}

static double size_of(const struct object_record *object)
{
    return object->bounding_radius;
}

struct hit {
    double distance; /* INFINITY: none */
    struct point normal;
    double to_edge; /* from the hit to the nearest sharp edge */
};

static void offer(struct hit *hit, double distance, double minimum, struct point normal,
                  double to_edge)
{
    if (distance > minimum && distance < hit->distance) {
        hit->distance = distance;
        hit->normal = normal;
        hit->to_edge = to_edge;
    }
}

/* Both roots of a t^2 + 2 b t + c = 0; 0 if there is none. */
static int roots(double a, double b, double c, double root[2])
{
    const double square = b * b - a * c;
    if (!(square >= 0.0) || a == 0.0)
        return 0;
    root[0] = (-b - sqrt(square)) / a;
    root[1] = (-b + sqrt(square)) / a;
    return 2;
}

static void meet_ball(struct hit *hit, struct point p, struct point d, double minimum,
                      double centre, double radius, double from, double to)
{
    double t[2];
    const struct point q = {p.x - centre, p.y, p.z};
    const int count = roots(dot(d, d), dot(q, d), dot(q, q) - radius * radius, t);
    for (int i = 0; i < count; i++) {
        const struct point at = add(q, d, t[i]);
        if (at.x >= from && at.x <= to)
            offer(hit, t[i], minimum, scaled(at, 1.0 / radius), INFINITY);
    }
}

static void meet_tube(struct hit *hit, struct point p, struct point d, double minimum,
                      double radius, double half_length, int has_edges)
{
    double t[2];
    const int count = roots(d.y * d.y + d.z * d.z, p.y * d.y + p.z * d.z,
                            p.y * p.y + p.z * p.z - radius * radius, t);
    for (int i = 0; i < count; i++) {
        const struct point at = add(p, d, t[i]);
        const struct point normal = {0.0, at.y / radius, at.z / radius};
        if (fabs(at.x) <= half_length)
            offer(hit, t[i], minimum, normal,
                  has_edges ? half_length - fabs(at.x) : (double)INFINITY);
    }
}

static void meet_disc(struct hit *hit, struct point p, struct point d, double minimum, double x,
                      double radius)
{
    if (d.x == 0.0)
        return;
    const double t = (x - p.x) / d.x;
    const struct point at = add(p, d, t);
    const struct point normal = {x < 0.0 ? -1.0 : 1.0, 0.0, 0.0};
    const double from_axis = hypot(at.y, at.z);
    if (from_axis <= radius)
        offer(hit, t, minimum, normal, radius - from_axis);
}

/* The first surface beyond minimum; sizes grown by `more`. */
static struct hit reference_hit(const struct object_record *object, struct point origin,
                                struct point direction, double minimum, double more)
{
    struct hit hit = {INFINITY, {0.0, 0.0, 0.0}, INFINITY};
    const struct point centre = {object->centre_x, object->centre_y, object->centre_z};
    const struct point p = turned(object, add(origin, centre, -1.0));
    const struct point d = turned(object, direction);
    const double half = object->half_length + (object->shape == SHAPE_CAPSULE ? 0.0 : more);
    const double radius = object->radius + more;
    switch (object->shape) {
    case SHAPE_PLANE: {
        const double t = -p.z / d.z;
        const struct point at = add(p, d, t);
        const struct point normal = {0.0, 0.0, d.z > 0.0 ? -1.0 : 1.0};
        const double to_edge = fmin(half - fabs(at.x), object->half_width + more - fabs(at.y));
        if (d.z != 0.0 && to_edge >= 0.0)
            offer(&hit, t, minimum, normal, to_edge);
        break;
    }
    case SHAPE_SPHERE:
        meet_ball(&hit, p, d, minimum, 0.0, radius, -INFINITY, INFINITY);
        break;
    case SHAPE_CYLINDER:
        meet_tube(&hit, p, d, minimum, radius, half, 1);
        meet_disc(&hit, p, d, minimum, half, radius);
        meet_disc(&hit, p, d, minimum, -half, radius);
        break;
    default:
        meet_tube(&hit, p, d, minimum, radius, half, 0);
        meet_ball(&hit, p, d, minimum, half, radius, 0.0, INFINITY);
        meet_ball(&hit, p, d, minimum, -half, radius, -INFINITY, 0.0);
        break;
    }
    hit.normal = turned_back(object, hit.normal);
    return hit;
}

/* A point on or near the object's surface: half of the rays graze it. */
static struct point aim(const struct object_record *object)
{
    const struct point way = random_direction();
    const struct point centre = {object->centre_x, object->centre_y, object->centre_z};
    const struct point outside = add(centre, way, 3.0 * size_of(object));
    const struct hit hit = reference_hit(object, outside, scaled(way, -1.0), 0.0, 0.0);
    if (uniform(0.0, 1.0) < 0.5 && isfinite(hit.distance))
        return add(outside, way, -hit.distance);
    return add(centre, random_direction(), size_of(object) * uniform(0.0, 1.4));
}

/* Positions near the frame's origin carry single precision's 6e-8 of a few metres: 2e-7 m a
 * coordinate, a few of which add up. Whoever passes an outline closer than this may err. */
#define OUTLINE 2e-6

struct worst {
    double across, of_size, normal;
    int hits, misses, undecided;
};

static void compare(const struct object_record *object, const struct ray *ray, double range,
                    struct worst *worst)
{
    const double minimum = -range;
    const struct hit expected = reference_hit(object, ray->origin, ray->direction, minimum, 0.0);
    const int surely =
        isfinite(reference_hit(object, ray->origin, ray->direction, minimum, -OUTLINE).distance);
    const int perhaps =
        isfinite(reference_hit(object, ray->origin, ray->direction, minimum, OUTLINE).distance);
    const float distance = object_distance(object, ray->p, ray->d, (float)minimum);
    const int is_hit = distance < 0.5f * FAR_AWAY;
    if (surely != perhaps || surely != isfinite(expected.distance)) {
        worst->undecided++;
        return;
    }
    if (is_hit != surely)
        fail_msg("shape %d: a ray that %s is said to %s", object->shape, surely ? "hits" : "misses",
                 is_hit ? "hit" : "miss");
    if (!is_hit) {
        worst->misses++;
        return;
    }
    worst->hits++;
    const double cosine = -dot(expected.normal, ray->direction);
    const double error = fabs(distance - expected.distance);
    if (expected.to_edge < 2.0 * OUTLINE / cosine)
        return; /* the other face of the edge may be met */
    worst->across = fmax(worst->across, error * cosine);
    worst->of_size = fmax(worst->of_size, error * cosine / size_of(object));
    if (cosine > 0.05 && expected.to_edge > 1e-3 * size_of(object)) {
        const struct vector3 n = object_normal(object, ray->p, ray->d, distance);
        const struct point off = {n.x - expected.normal.x, n.y - expected.normal.y,
                                  n.z - expected.normal.z};
        worst->normal = fmax(worst->normal, sqrt(dot(off, off)));
    }
}

static void test_each_shape(void **state)
{
    static const double ranges[] = {50.0, 500.0};
    for (int shape = SHAPE_PLANE; shape <= SHAPE_CAPSULE; shape++)
        for (size_t r = 0; r < 2; r++) {
            struct worst worst = {0.0, 0.0, 0.0, 0, 0, 0};
            struct object_record object = {0};
            for (int i = 0; i < RAYS; i++) {
                const struct point centre = {uniform(-2.0, 2.0), uniform(-2.0, 2.0),
                                             uniform(-1.0, 1.0)};
                if (i % 16 == 0)
                    object = random_object(shape, centre);
                const struct ray ray = ray_towards(aim(&object), ranges[r]);
                compare(&object, &ray, ranges[r], &worst);
            }
            print_message("shape %d from %.0f m: %d hits, %d misses, %d on the outline; across the "
                          "surface %.2g m or %.2g of size, normal %.2g rad\n",
                          shape, ranges[r], worst.hits, worst.misses, worst.undecided, worst.across,
                          worst.of_size, worst.normal);
            assert_true(worst.hits > RAYS / 5);
            assert_true(worst.misses > RAYS / 50);
            assert_true(worst.undecided < RAYS / 20);
            assert_true(worst.across < 5e-7);
            assert_true(worst.of_size < 1e-5);
            assert_true(worst.normal < 1e-3);
        }
}

/* From a start as far off the surface as the tracer's (2e-5 m) no way outwards meets a convex shape
 * again. */
static void test_no_self_hit(void **state)
{
    static const double offsets[] = {2.0, 20.0, 100.0};
    for (size_t o = 0; o < 3; o++)
        for (int shape = SHAPE_PLANE; shape <= SHAPE_CAPSULE; shape++) {
            int self_hits = 0;
            int tried = 0;
            struct object_record object = {0};
            for (int i = 0; i < RAYS; i++) {
                const struct point centre = {uniform(-offsets[o], offsets[o]),
                                             uniform(-offsets[o], offsets[o]), uniform(0.0, 1.0)};
                if (i % 16 == 0)
                    object = random_object(shape, centre);
                const struct ray ray = ray_towards(aim(&object), 200.0);
                const float distance = object_distance(&object, ray.p, ray.d, -200.0f);
                if (distance > 0.5f * FAR_AWAY)
                    continue;
                const struct vector3 n = object_normal(&object, ray.p, ray.d, distance);
                const struct vector3 start = along3(along3(ray.p, ray.d, distance), n, 2.0e-5f);
                /* a source point within half a metre of the receiver, 200 m away */
                struct point back = {-ray.direction.x + uniform(-0.0025, 0.0025), -ray.direction.y,
                                     -ray.direction.z + uniform(-0.0025, 0.0025)};
                back = scaled(back, 1.0 / sqrt(dot(back, back)));
                const struct vector3 way = {(float)back.x, (float)back.y, (float)back.z};
                if (dot3(way, n) <= 0.0f)
                    continue;
                tried++;
                self_hits += object_distance(&object, start, way, 0.0f) < 0.5f * FAR_AWAY;
            }
            print_message("shape %d within %.0f m: %d self-hits of %d\n", shape, offsets[o],
                          self_hits, tried);
            assert_true(tried > RAYS / 5);
            assert_int_equal(self_hits, 0);
        }
}

static void test_nearest_of_several(void **state)
{
    struct object_record objects[7];
    int seen[7] = {0};
    memset(objects, 0, sizeof objects);
    for (int i = 0; i < RAYS; i++) {
        if (i % 50 == 0)
            for (int k = 0; k < 7; k++) {
                const struct point centre = {uniform(-1.0, 1.0), uniform(-1.0, 1.0),
                                             uniform(-1.0, 1.0)};
                objects[k] = random_object(k % 4, centre);
            }
        const struct ray ray = ray_towards(aim(&objects[i % 7]), 60.0);
        struct hit nearest = {INFINITY, {0.0, 0.0, 0.0}, 0.0};
        double second = INFINITY;
        int number = -1;
        int is_clear = 1;
        for (int k = 0; k < 7; k++) {
            const struct hit hit =
                reference_hit(&objects[k], ray.origin, ray.direction, -60.0, 0.0);
            const double inner =
                reference_hit(&objects[k], ray.origin, ray.direction, -60.0, -OUTLINE).distance;
            const double outer =
                reference_hit(&objects[k], ray.origin, ray.direction, -60.0, OUTLINE).distance;
            is_clear = is_clear && isfinite(inner) == isfinite(outer);
            if (hit.distance < nearest.distance) {
                second = nearest.distance;
                nearest = hit;
                number = k;
            } else if (hit.distance < second) {
                second = hit.distance;
            }
        }
        if (!is_clear || second - nearest.distance < 1e-4)
            continue;
        const struct nearest_hit found = find_nearest_hit(objects, 7, ray.p, ray.d, -60.0f);
        if (found.object != number)
            fail_msg("object %d is met first, not %d", number, (int)found.object);
        if (number >= 0) {
            seen[number]++;
            assert_true(fabs(found.distance - nearest.distance) < 1e-3);
        }
    }
    for (int k = 0; k < 7; k++)
        assert_true(seen[k] > 1000);
    const struct ray ray = ray_towards((struct point){0.0, 0.0, 0.0}, 60.0);
    const struct nearest_hit none = find_nearest_hit(objects, 0, ray.p, ray.d, -60.0f);
    assert_true(none.object == -1 && none.distance == FAR_AWAY);
}

/* Rays along an axis, or so close to it that rounding decides, still meet the ends. */
static void test_along_the_axis(void **state)
{
    int hits = 0;
    for (int i = 0; i < RAYS; i++) {
        struct object_record object =
            make_object(i % 2 ? SHAPE_CYLINDER : SHAPE_CAPSULE, 1.0, 0.0, 0.4, (struct point){0});
        memset(object.axes, 0, sizeof object.axes);
        object.axes[0] = object.axes[4] = object.axes[8] = 1.0f;
        const double tilt = pow(10.0, uniform(-10.0, -4.0));
        const double turn = uniform(-PI, PI);
        struct ray ray;
        memset(&ray, 0, sizeof ray);
        ray.d.x = i & 4 ? 1.0f : -1.0f;
        ray.d.y = (float)(i & 8 ? 0.0 : tilt * cos(turn));
        ray.d.z = (float)(i & 8 ? 0.0 : tilt * sin(turn));
        ray.p.y = (float)uniform(-0.25, 0.25);
        ray.p.z = (float)uniform(-0.25, 0.25);
        ray.direction = (struct point){ray.d.x, ray.d.y, ray.d.z};
        ray.origin = (struct point){ray.p.x, ray.p.y, ray.p.z};
        struct worst worst = {0.0, 0.0, 0.0, 0, 0, 0};
        compare(&object, &ray, 10.0, &worst);
        hits += worst.hits;
        assert_true(worst.across < OUTLINE);
    }
    assert_true(hits > RAYS / 4);
}

/* The first surface beyond `minimum`, also from inside a shape: its way out. */
static void test_minimum(void **state)
{
    for (int i = 0; i < RAYS; i++) {
        const struct point centre = {uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)};
        const struct object_record object = random_object(SHAPE_SPHERE + i % 3, centre);
        const struct ray ray = ray_towards(aim(&object), 50.0);
        const struct hit entry = reference_hit(&object, ray.origin, ray.direction, -50.0, 0.0);
        if (!isfinite(entry.distance))
            continue;
        const double beyond = entry.distance + 1e-4;
        const struct hit leave = reference_hit(&object, ray.origin, ray.direction, beyond, 0.0);
        const float found = object_distance(&object, ray.p, ray.d, (float)beyond);
        if (!isfinite(leave.distance) || leave.distance < beyond + 1e-4)
            continue; /* a corner is cut */
        const double cosine = fabs(dot(leave.normal, ray.direction));
        if (leave.to_edge > 1e-4 && cosine > 0.02)
            assert_true(fabs(found - leave.distance) < 2.0 * OUTLINE / cosine);
    }
}

/* What the fan's geometry promises, in double: a ray of elevation e through the neighbourhood of
 * the origin, at 500 m as at 5 m. */
static void test_fan(void **state)
{
    static const double ranges[] = {5.0, 50.0, 500.0};
    for (size_t r = 0; r < 3; r++)
        for (int i = 0; i < 10000; i++) {
            const double depression = uniform(0.02, 1.4);
            struct fan_record fan;
            memset(&fan, 0, sizeof fan);
            fan.reference_range = (float)ranges[r];
            fan.cosine_depression = (float)cos(depression);
            fan.sine_depression = (float)sin(depression);
            const float elevation = (float)(uniform(-5.0, 5.0) / ranges[r]);
            const struct fan_ray ray = fan_ray_at(&fan, NULL, 0.25f, elevation);
            const double range = fan.reference_range;
            const double d_y = fan.cosine_depression, d_z = -fan.sine_depression;
            const double e = elevation;
            const struct point direction = {0.0, d_y * cos(e) - d_z * sin(e),
                                            d_z * cos(e) + d_y * sin(e)};
            const double along = range * cos(e);
            const struct point closest = {0.25, -range * d_y + along * direction.y,
                                          -range * d_z + along * direction.z};
            assert_true(ray.closest.x == 0.25f && ray.direction.x == 0.0f);
            assert_true(fabs(ray.direction.y - direction.y) < 3e-7);
            assert_true(fabs(ray.direction.z - direction.z) < 3e-7);
            /* offsets of up to 5 m; the depression's own rounding turns the whole fan, which
             * moves nothing in it, but leaves (1 - sine^2 - cosine^2) range in `closest` here */
            const double slack = 1e-6 + 1e-7 * range;
            assert_true(fabs(ray.closest.y - closest.y) < slack);
            assert_true(fabs(ray.closest.z - closest.z) < slack);
            assert_true(fabs(ray.range_at_closest - range * (cos(e) - 1.0)) < 1e-6);
            assert_true(fabs(dot3(ray.upward, ray.direction)) < 1e-7f);
            assert_true(fabs(dot3(ray.closest, ray.direction)) < 2e-6f);
        }
}

/* Buried parts are not met: the seabed comes first. */
static void test_burial(void **state)
{
    struct fan_record fan;
    memset(&fan, 0, sizeof fan);
    fan.reference_range = 50.0f;
    int shown = 0;
    int hidden = 0;
    for (int i = 0; i < RAYS; i++) {
        fan.seabed_height = (float)uniform(-0.3, 0.3);
        const struct point centre = {uniform(-1.0, 1.0), uniform(-1.0, 1.0), 0.0};
        const struct object_record object = random_object(i % 4, centre);
        const struct ray ray = ray_towards(aim(&object), 50.0);
        const struct hit hit = reference_hit(&object, ray.origin, ray.direction, -50.0, 0.0);
        if (!isfinite(hit.distance) || fabs(dot(hit.normal, ray.direction)) < 0.05 ||
            hit.to_edge < 1e-4)
            continue;
        const double height = add(ray.origin, ray.direction, hit.distance).z - fan.seabed_height;
        if (fabs(height) < 1e-5)
            continue;
        const float seabed = plane_distance(&fan, ray.p, ray.d);
        const float object_at = object_distance(&object, ray.p, ray.d, -50.0f);
        assert_int_equal(object_at<seabed, height> 0.0);
        shown += height > 0.0;
        hidden += height < 0.0;
    }
    assert_true(shown > RAYS / 10 && hidden > RAYS / 10);
    /* a level or rising ray never meets the seabed */
    const struct vector3 point = {0.0f, 0.0f, 1.0f};
    const struct vector3 level = {0.0f, 1.0f, 0.0f};
    const struct vector3 rising = {0.0f, 0.8f, 0.6f};
    assert_true(plane_distance(&fan, point, level) == FAR_AWAY);
    assert_true(plane_distance(&fan, point, rising) == FAR_AWAY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_shape),
        cmocka_unit_test(test_no_self_hit),
        cmocka_unit_test(test_nearest_of_several),
        cmocka_unit_test(test_minimum),
        cmocka_unit_test(test_along_the_axis),
        cmocka_unit_test(test_fan),
        cmocka_unit_test(test_burial),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
