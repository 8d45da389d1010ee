/* Tests where rays meet shapes, against polynomials solved in double precision. Rays come from
 * sonars at 50 m and 500 m, many of them grazing. test_many_objects.c and test_bits.c test that all
 * lanes have the same bits. */
#include "claims.h"
#include "fan.h"
#include "reference_solids.h"
#include "scene/placement.h"
#include "scene/shapes/shape.h"

#define RAYS 16000 /* 20 at each of 800 solids, so that a fault of 1 % of solids is met 8 times */

/* Rays that pass an outline closer than this may err, m. Positions carry single precision's 6e-8 of
 * a few metres, some of which add up. */
#define OUTLINE 3e-6
/* The largest shift of a grazing hit, as a share of the size. Moving the outline shifts the hit by
 * sqrt(8 radius OUTLINE), and a larger jump goes to another surface. */
#define GRAZING 0.02

struct solid {
    sonject_object_params params;
    struct object_record record;
};

static void random_sizes(sonject_object_params *params, const struct solid_row *row)
{
    memset(params, 0, sizeof *params);
    params->shape = row->shape;
    params->length_m = uniform(0.1, 1.5);
    params->width_m = uniform(0.1, 1.5);
    params->height_m = uniform(0.1, 1.5);
    params->diameter_m = uniform(0.1, 1.0);
    params->top_diameter_m = uniform(0.0, 1.0);
    if (row->fit)
        row->fit(params, 0.04);
}

static void turn_at_random(struct object_record *record)
{
    const double heading = uniform(-PI, PI), pitch = uniform(-1.5, 1.5), roll = uniform(-PI, PI);
    double axes[3][3];
    turn_axes(axes, heading, pitch, roll);
    for (int i = 0; i < 9; i++)
        record->axes[i] = (float)axes[i / 3][i % 3];
}

static void make_record(struct solid *solid, double reach)
{
    struct shape_size size;
    memset(&solid->record, 0, sizeof solid->record);
    shape_size_init(&size, &solid->params);
    shape_record_init(&solid->record, &size, solid->params.shape);
    solid->record.centre_x = (float)uniform(-reach, reach);
    solid->record.centre_y = (float)uniform(-reach, reach);
    solid->record.centre_z = (float)uniform(-0.5, 0.5) * (float)fmin(reach, 2.0);
    turn_at_random(&solid->record);
}

static struct solid random_solid(const struct solid_row *row, double reach)
{
    struct solid solid;
    random_sizes(&solid.params, row);
    make_record(&solid, reach);
    return solid;
}

static struct solid_hit reference_hit(const struct solid *solid, struct point origin,
                                      struct point direction, double minimum, double more)
{
    const struct object_record *record = &solid->record;
    const struct point centre = {record->centre_x, record->centre_y, record->centre_z};
    struct solid_hit hit =
        solid_first_hit(&solid->params, turned(record, add(origin, centre, -1.0)),
                        turned(record, direction), minimum, more);
    hit.normal = turned_back(record, hit.normal);
    return hit;
}

/* Returns a point on or near the surface. Half of the rays to such points graze the surface. */
static struct point aim(const struct solid *solid)
{
    const struct point way = random_direction();
    const struct point centre = {solid->record.centre_x, solid->record.centre_y,
                                 solid->record.centre_z};
    const double size = solid->record.bounding_radius;
    const struct point outside = add(centre, way, 3.0 * size);
    const struct point inwards = add(scaled(way, -1.0), random_direction(), 0.2);
    const struct solid_hit hit = reference_hit(solid, outside, inwards, 0.0, 0.0);
    if (uniform(0.0, 1.0) < 0.5 && isfinite(hit.distance))
        return add(outside, inwards, hit.distance);
    return add(centre, random_direction(), size * uniform(0.0, 1.3));
}

struct worst {
    double of_size, normal;
    int hits, misses, undecided;
};

static void compare(const struct solid *solid, const struct solid_row *row, const struct ray *ray,
                    double range, struct worst *worst)
{
    const struct solid_hit expected =
        reference_hit(solid, ray->origin, ray->direction, -range, 0.0);
    const struct solid_hit less =
        reference_hit(solid, ray->origin, ray->direction, -range, -OUTLINE);
    const struct solid_hit more =
        reference_hit(solid, ray->origin, ray->direction, -range, OUTLINE);
    const float distance = object_distance(&solid->record, ray->p, ray->d, (float)-range);
    const int is_hit = distance < 0.5f * FAR_AWAY;
    const int surely = isfinite(less.distance);
    const double spread = fabs(more.distance - less.distance);
    const double cosine = surely ? fabs(dot(expected.normal, ray->direction)) : 1.0;
    /* undecided unless the three outlines agree on a hit, and on the surface that is hit */
    if (surely != isfinite(more.distance) || surely != isfinite(expected.distance) ||
        (surely &&
         (spread > 30.0 * OUTLINE / cosine || spread > GRAZING * solid->record.bounding_radius ||
          expected.to_edge < 3.0 * OUTLINE / cosine))) {
        worst->undecided++;
        return;
    }
    if (is_hit != surely)
        fail_msg("%s: a ray that %s is said to %s", row->name, surely ? "hits" : "misses",
                 is_hit ? "hit" : "miss");
    worst->hits += is_hit;
    worst->misses += !is_hit;
    if (!is_hit)
        return;
    const double size = solid->record.bounding_radius;
    worst->of_size = fmax(worst->of_size, fabs(distance - expected.distance) * cosine / size);
    if (cosine > 0.05 && expected.to_edge > 2e-3 * size) {
        const struct vector3 n = object_normal(&solid->record, ray->p, ray->d, distance);
        const struct point off = {n.x - expected.normal.x, n.y - expected.normal.y,
                                  n.z - expected.normal.z};
        worst->normal = fmax(worst->normal, sqrt(dot(off, off)));
    }
}

/* Tests of this file, and of extents, go through solid_rows. No shape may lack a row. */
TEST(test_every_shape_of_the_table_is_tested)
{
    for (uint32_t shape = 0; shape < SHAPE_PARTS; shape++) {
        int rows = shape == SHAPE_MESH; /* meshes have tests of their own */
        for (int i = 0; i < solid_row_count; i++)
            rows += solid_rows[i].shape == shape;
        if (rows == 0)
            fail_msg("%s has no row in reference_solids.c", shape_name(shape));
    }
}

TEST(test_against_the_reference)
{
    static const double ranges[] = {50.0, 500.0};
    for (const struct solid_row *row = solid_rows; row < solid_rows + solid_row_count; row++) {
        struct worst worst = {0.0, 0.0, 0, 0, 0};
        struct solid solid;
        for (int i = 0; i < RAYS; i++) {
            if (i % 20 == 0)
                solid = random_solid(row, 2.0);
            const double range = ranges[i % 2];
            const struct ray ray = ray_towards(aim(&solid), range);
            compare(&solid, row, &ray, range, &worst);
        }
        print_message("%s: %d hits, %d misses, %d on an outline or edge; off by %.2g of size, "
                      "normal %.2g rad\n",
                      row->name, worst.hits, worst.misses, worst.undecided, worst.of_size,
                      worst.normal);
        assert_true(worst.hits > RAYS / 8);
        assert_true(worst.misses > RAYS / 50);
        assert_true(worst.undecided < RAYS / 20);
        assert_true(worst.of_size < 1e-5);
        assert_true(worst.normal < 1e-3);
    }
}

/* Returns whether a way from the point where a ray meets an object meets the object again. The way
 * is straight back or random, and starts as far off the surface as the tracer's ways do (2e-5 m).
 * -1: the way does not lead outwards, or nothing is met. */
static int meets_itself(const struct object_record *object, const struct ray *ray,
                        bool is_straight_back)
{
    const float distance = object_distance(object, ray->p, ray->d, -200.0f);
    if (distance > 0.5f * FAR_AWAY)
        return -1;
    const struct vector3 n = object_normal(object, ray->p, ray->d, distance);
    const struct vector3 start = along3(along3(ray->p, ray->d, distance), n, 2.0e-5f);
    const struct point back = is_straight_back ? scaled(ray->direction, -1.0) : random_direction();
    const struct vector3 way = {(float)back.x, (float)back.y, (float)back.z};
    return dot3(way, n) <= 0.0f ? -1 : object_distance(object, start, way, 0.0f) < 0.5f * FAR_AWAY;
}

TEST(test_ways_outwards_meet_hollow_solids_alone_again)
{
    static const double reaches[] = {2.0, 100.0};
    for (const struct solid_row *row = solid_rows; row < solid_rows + solid_row_count; row++) {
        int self_hits = 0, tried = 0;
        struct solid solid;
        for (int i = 0; i < RAYS; i++) {
            if (i % 20 == 0)
                solid = random_solid(row, reaches[i / 20 % 2]);
            const struct ray ray = ray_towards(aim(&solid), 200.0);
            const int is_met = meets_itself(&solid.record, &ray, i % 2 == 0);
            tried += is_met >= 0;
            self_hits += is_met > 0;
        }
        print_message("%s: %d self-hits of %d\n", row->name, self_hits, tried);
        assert_true(tried > RAYS / 8);
        assert_int_equal(self_hits > 0, !is_convex(&solid.record));
    }
}

/* Between near hits on one surface the normal turns by at most their distance over the least radius
 * of curvature. Within a tenth of that radius the way along the surface is at most 1e-3 longer. */
TEST(test_surfaces_are_bent_no_more_than_is_said)
{
    for (const struct solid_row *row = solid_rows; row < solid_rows + solid_row_count; row++) {
        /* cones are bent more near the axis, as lib/scene/shapes/shape.h says */
        const int is_bent_more = row->shape == SHAPE_CONE || row->shape == SHAPE_TRUNCATED_CONE;
        double most = 0.0;
        int compared = 0;
        struct solid solid;
        struct shape_size size;
        for (int i = 0; i < RAYS; i++) {
            if (i % 20 == 0) {
                solid = random_solid(row, 0.0);
                shape_size_init(&size, &solid.params);
            }
            const double radius = size.least_radius_of_curvature_m;
            const double near = 0.1 * fmin(radius, size.bounding_radius_m);
            const struct ray ray = ray_towards(aim(&solid), 50.0);
            struct point at[2], start = ray.origin;
            struct solid_hit hits[2];
            double to_edge = INFINITY;
            for (int k = 0; k < 2; k++) {
                hits[k] = reference_hit(&solid, start, ray.direction, -50.0, 0.0);
                at[k] = add(start, ray.direction, hits[k].distance);
                to_edge =
                    fmin(to_edge,
                         fabs(dot(hits[k].normal, ray.direction)) < 0.05 ? 0.0 : hits[k].to_edge);
                start = add(start, random_direction(), 0.3 * near);
            }
            const struct point way = add(at[1], at[0], -1.0);
            const double distance = sqrt(dot(way, way));
            const struct point own = turned(&solid.record, at[0]); /* about the solid's centre */
            if (!(distance < near && to_edge > 2.0 * distance) ||
                (is_bent_more && hypot(own.x, own.y) < radius + distance))
                continue;
            const struct point turn = add(hits[1].normal, hits[0].normal, -1.0);
            const double bent = sqrt(dot(turn, turn)) - distance / radius;
            most = fmax(most, sqrt(dot(turn, turn)) * size.bounding_radius_m / distance);
            compared++;
            if (bent > 2e-3 * distance / radius + 1e-6)
                fail_msg("%s: its normal turns by %g rad within %g m, so "
                         "least_radius_of_curvature_m is less than %g m",
                         row->name, sqrt(dot(turn, turn)), distance, radius);
        }
        print_message("%s: %d pairs of hits, bent by up to 1/%.3g of its size\n", row->name,
                      compared, most);
        assert_true(compared > RAYS / 50);
    }
}

/* Rays from inside find the way out, and rays through a ring's hole find its other side. */
TEST(test_beyond_the_first)
{
    for (const struct solid_row *row = solid_rows; row < solid_rows + solid_row_count; row++) {
        int compared = 0;
        struct solid solid;
        for (int i = 0; i < RAYS / 4; i++) {
            if (i % 20 == 0)
                solid = random_solid(row, 1.0);
            const struct ray ray = ray_towards(aim(&solid), 50.0);
            double minimum = -50.0;
            for (int crossing = 0; crossing < 4; crossing++) {
                const struct solid_hit hit =
                    reference_hit(&solid, ray.origin, ray.direction, minimum, 0.0);
                const double cosine = fabs(dot(hit.normal, ray.direction));
                if (!isfinite(hit.distance) || cosine < 0.05 || hit.to_edge < 1e-3 ||
                    hit.distance < minimum + 1e-3)
                    break;
                const float met = object_distance(&solid.record, ray.p, ray.d, (float)minimum);
                assert_true(fabs(met - hit.distance) < 4.0 * OUTLINE / cosine);
                minimum = (float)(hit.distance + 1e-3);
                compared += crossing > 0;
            }
        }
        print_message("%s: %d later crossings\n", row->name, compared);
        const int is_flat = row->shape == SHAPE_PLANE || row->shape == SHAPE_DISC;
        assert_true(is_flat || compared > RAYS / 50);
    }
}

/* Rays run along and across the axes, or so nearly that rounding decides. */
TEST(test_along_the_axes)
{
    for (const struct solid_row *row = solid_rows; row < solid_rows + solid_row_count; row++) {
        struct worst worst = {0.0, 0.0, 0, 0, 0};
        for (int i = 0; i < RAYS / 4; i++) {
            struct solid solid = random_solid(row, 0.0);
            memset(solid.record.axes, 0, sizeof solid.record.axes);
            solid.record.axes[0] = solid.record.axes[4] = solid.record.axes[8] = 1.0f;
            const double tilt = i & 8 ? 0.0 : pow(10.0, uniform(-10.0, -4.0));
            double d[3] = {tilt * uniform(-1.0, 1.0), tilt * uniform(-1.0, 1.0),
                           tilt * uniform(-1.0, 1.0)};
            d[i % 3] = i & 4 ? 1.0 : -1.0;
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = k == i % 3 || (i % 100 == 0 &&
                                      row->shape != SHAPE_CONE) /* a cone's tip has no normal */
                           ? 0.0
                           : uniform(-1.1, 1.1) * solid.record.bounding_radius;
            const struct ray ray =
                ray_of((struct point){p[0], p[1], p[2]}, (struct point){d[0], d[1], d[2]});
            compare(&solid, row, &ray, 10.0, &worst);
        }
        print_message("%s along axes: %d hits, %d misses, %d undecided, off by %.2g\n", row->name,
                      worst.hits, worst.misses, worst.undecided, worst.of_size);
        /* planes are met least often: LW/1.21(L^2 + W^2) of a third of the rays hit, 430 +- 17 */
        assert_true(worst.hits > RAYS / 45);
        assert_true(worst.of_size < 1e-5 && worst.normal < 1e-3);
    }
}

TEST(test_nearest_of_several)
{
    struct solid solids[7];
    struct object_record objects[7];
    int seen[7] = {0};
    for (int i = 0; i < RAYS; i++) {
        if (i % 50 == 0)
            for (int k = 0; k < 7; k++) {
                solids[k] = random_solid(&solid_rows[(i / 50 + k) % solid_row_count], 1.0);
                objects[k] = solids[k].record;
            }
        const struct ray ray = ray_towards(aim(&solids[i % 7]), 60.0);
        struct solid_hit nearest = {INFINITY, {0.0, 0.0, 0.0}, 0.0};
        double second = INFINITY;
        int number = -1;
        int is_clear = 1;
        for (int k = 0; k < 7; k++) {
            const struct solid_hit hit =
                reference_hit(&solids[k], ray.origin, ray.direction, -60.0, 0.0);
            const double inner =
                reference_hit(&solids[k], ray.origin, ray.direction, -60.0, -OUTLINE).distance;
            const double outer =
                reference_hit(&solids[k], ray.origin, ray.direction, -60.0, OUTLINE).distance;
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
        assert_true(seen[k] > RAYS / 100);
    const struct ray ray = ray_towards((struct point){0.0, 0.0, 0.0}, 60.0);
    const struct nearest_hit none = find_nearest_hit(objects, 0, ray.p, ray.d, -60.0f);
    assert_true(none.object == -1 && none.distance == FAR_AWAY);
}

/* The fan's geometry holds in double precision: a ray of elevation e goes through the neighbourhood
 * of the origin, at 500 m as at 5 m. */
TEST(test_fan)
{
    static const double ranges[] = {5.0, 50.0, 500.0};
    for (size_t r = 0; r < 3; r++)
        for (int i = 0; i < 10000; i++) {
            const double depression = uniform(0.02, 1.4);
            const struct fan_record fan = {.reference_range = (float)ranges[r],
                                           .cosine_depression = (float)cos(depression),
                                           .sine_depression = (float)sin(depression)};
            const struct trace trace = {.fan = fan};
            const float elevation = (float)(uniform(-5.0, 5.0) / ranges[r]);
            const struct fan_ray ray = fan_ray_at(&trace, 0.25f, elevation);
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
            /* offsets are up to 5 m; the depression's rounding turns the whole fan, which moves
             * nothing in the fan but leaves (1 - sine^2 - cosine^2) range in `closest` here */
            const double slack = 1e-6 + 1e-7 * range;
            assert_true(fabs(ray.closest.y - closest.y) < slack);
            assert_true(fabs(ray.closest.z - closest.z) < slack);
            assert_true(fabs(ray.range_at_closest - range * (cos(e) - 1.0)) < 1e-6);
            assert_true(fabs(dot3(ray.upward, ray.direction)) < 1e-7f);
            assert_true(fabs(dot3(ray.closest, ray.direction)) < 2e-6f);
        }
}

/* Buried parts are not met: the seabed comes first. */
TEST(test_burial)
{
    struct fan_record fan;
    memset(&fan, 0, sizeof fan);
    fan.reference_range = 50.0f;
    int shown = 0;
    int hidden = 0;
    for (int i = 0; i < RAYS; i++) {
        fan.seabed_height = (float)uniform(-0.3, 0.3);
        struct solid solid = random_solid(&solid_rows[i % solid_row_count], 1.0);
        solid.record.centre_z = 0.0f;
        const struct ray ray = ray_towards(aim(&solid), 50.0);
        const struct solid_hit hit = reference_hit(&solid, ray.origin, ray.direction, -50.0, 0.0);
        if (!isfinite(hit.distance) || fabs(dot(hit.normal, ray.direction)) < 0.05 ||
            hit.to_edge < 1e-4)
            continue;
        const double height = add(ray.origin, ray.direction, hit.distance).z - fan.seabed_height;
        if (fabs(height) < 1e-5)
            continue;
        const float seabed = plane_distance(&fan, ray.p, ray.d);
        const float object_at = object_distance(&solid.record, ray.p, ray.d, -50.0f);
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

TEST_PROGRAM(NULL, NULL)
