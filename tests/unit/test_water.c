/* Tests sound through level layers against Snell's law summed up in long double, against Fermat's
 * principle, the arcs of a linear profile and the power that a ray tube carries. */
#include "claims.h"
#include "medium/water.h"
#include "physics/reference_layers.h"

#define BOUNCES_MAX 3

static struct report report;

static void expect_within(const char *what, double measured, double expected, double tolerance)
{
    if (!(fabs(measured - expected) <= tolerance))
        fail_msg("%s: %.17g is not %.17g within %.3g", what, measured, expected, tolerance);
}

static void expect_relative(const char *what, double measured, double expected, double tolerance)
{
    expect_within(what, measured, expected, tolerance * fabs(expected));
}

static void lay(struct water *water, const struct water_layer *layers, size_t count,
                double highest_m)
{
    EXPECT_OK(&report, water_init(water, &report, layers, count, 1500.0, highest_m, 0.0));
}

static struct ray_path way_of(const struct water *water, const struct reference_way *folded)
{
    return folded->bounces == 0 ? ray_path_direct(water, folded->sonar_height)
                                : ray_path_image(water, folded->sonar_height, folded->depth,
                                                 folded->bounces, folded->comes_from_seabed);
}

/* ---- waters to try ---- */

static const struct water_layer two_layers[] = {{0.0, 1490.0, 1.0}, {8.0, 1520.0, 1.0}};
static const struct water_layer three_layers[] = {
    {0.0, 1500.0, 1.0}, {6.0, 1450.0, 1.0}, {14.0, 1530.0, 1.0}};
static const struct water_layer ten_layers[] = {
    {0.0, 1503.0, 1.0},  {2.5, 1497.0, 1.0},  {4.0, 1511.0, 1.0},  {5.5, 1460.0, 1.0},
    {7.25, 1472.0, 1.0}, {9.0, 1490.0, 1.0},  {12.0, 1535.0, 1.0}, {13.0, 1519.0, 1.0},
    {16.5, 1501.0, 1.0}, {18.0, 1526.0, 1.0},
};

static const struct {
    const struct water_layer *layers;
    size_t count;
    double sonar_height;
} waters[] = {
    {two_layers, COUNT(two_layers), 20.0},     {two_layers, COUNT(two_layers), 5.0},
    {three_layers, COUNT(three_layers), 20.0}, {three_layers, COUNT(three_layers), 10.0},
    {ten_layers, COUNT(ten_layers), 21.0},     {ten_layers, COUNT(ten_layers), 12.5},
};

#define DEPTH 25.0 /* water depth, m */

typedef void each_way(const struct water *water, const struct reference_way *folded, double height);

/* Runs a test in every water, on every path of up to three mirrors, to points high and low. */
static void on_every_way(each_way *run)
{
    static const double heights[] = {0.0, 0.3, 1.7};
    for (size_t w = 0; w < COUNT(waters); w++) {
        struct water water;
        lay(&water, waters[w].layers, waters[w].count, 2.0);
        assert_int_equal(water.count, waters[w].count);
        assert_true(water.straight_speed_mps == waters[w].layers[0].speed_mps);
        for (uint32_t bounces = 0; bounces <= BOUNCES_MAX; bounces++)
            for (int last = 0; last < (bounces ? 2 : 1); last++)
                for (size_t h = 0; h < COUNT(heights); h++) {
                    const struct reference_way folded = {
                        water.layers, water.count, waters[w].sonar_height,
                        DEPTH,        bounces,     last == 1};
                    if (last == 1 && heights[h] == 0.0)
                        continue; /* the point is on the mirror */
                    run(&water, &folded, heights[h]);
                }
        water_clear(&water);
    }
}

static double signed_angle(const struct reference_way *folded, double angle)
{
    return folded->bounces > 0 && folded->comes_from_seabed ? -angle : angle;
}

/* Finds grazing angles in the straight water for which there is a ray: cos < c/c_max. */
#define ANGLES 9
static void find_angles(const struct reference_way *folded, double height, double angles[ANGLES])
{
    static const double shares[ANGLES] = {1e-6, 1e-4, 1e-2, 0.05, 0.2, 0.4, 0.7, 0.95, 0.9999};
    const double most = reference_fastest(folded, height);
    const double least = acos(fmin(1.0, folded->layers[0].speed_mps / most));
    for (size_t i = 0; i < ANGLES; i++)
        angles[i] = least + shares[i] * (0.5 * PI - least);
}

/* ---- Snell ---- */

static double largest_error; /* largest relative error of ranges and times */

static void note_error(double measured, long double expected)
{
    largest_error = fmax(largest_error, (double)fabsl((measured - expected) / expected));
}

static void compare_ray(const struct water *water, const struct reference_way *folded,
                        double height)
{
    const struct ray_path path = way_of(water, folded);
    const double c = water->straight_speed_mps;
    const double c0 = reference_speed_at(folded, folded->sonar_height);
    double angles[ANGLES];
    find_angles(folded, height, angles);
    for (size_t i = 2; i < ANGLES; i++) { /* closer to total reflection the angle itself rounds */
        const double angle = signed_angle(folded, angles[i]);
        const struct arrival ray = ray_path_arrival(&path, angle, height);
        const long double p = cosl((long double)angle) / c;
        const struct reference_ray sum = reference_sum(folded, height, p);
        const long double sine = sinl((long double)angles[i]);
        const long double sine0 = sqrtl(1.0L - p * c0 * p * c0);
        note_error(ray.ground_range_m, sum.range);
        note_error(ray.straight_range_m, sum.time * c);
        /* the angle's own rounding over its distance from total reflection: 1e-16 of 1e-2 */
        expect_relative("ground range", ray.ground_range_m, (double)sum.range, 1e-12);
        expect_relative("straight range", ray.straight_range_m, (double)(sum.time * c), 1e-12);
        expect_relative("length", ray.length_m, (double)sum.length, 1e-12);
        expect_relative("wavefront", ray.wavefront_m, (double)(sine * sine / c * sum.growth),
                        1e-11);
        expect_relative("spreading", ray.spreading,
                        (double)(c0 / c * cosl((long double)angle) * sine / sine0), 1e-12);
    }
}

TEST(test_snell)
{
    largest_error = 0.0;
    on_every_way(compare_ray);
    print_message("largest relative error of range and time: %.2g\n", largest_error);
}

/* Returns whether long double is wider than double. Valgrind's is not. */
static bool has_wide_reference(void)
{
    const volatile long double small = 1e-18L;
    const volatile long double sum = 1.0L + small;
    return sum != 1.0L;
}

/* Expects the ray found for two points to come to the point, in the time of the point. */
static void compare_two_points(const struct water *water, const struct reference_way *folded,
                               double height)
{
    static const double ranges[] = {1e-3, 0.5, 4.0, 12.0, 40.0, 120.0, 700.0, 5000.0};
    const struct ray_path path = way_of(water, folded);
    const double c = water->straight_speed_mps;
    for (size_t i = 0; i < COUNT(ranges); i++) {
        const double angle = ray_path_grazing(&path, ranges[i], height);
        assert_true(isfinite(angle));
        assert_true(folded->bounces > 0 && folded->comes_from_seabed ? angle < 0.0 : angle > 0.0);
        const double fastest_speed = reference_fastest(folded, height);
        const long double p = cosl((long double)angle) / c;
        const struct reference_ray sum = reference_sum(folded, height, p);
        /* error of the range by the angle's last digits, as the angle is an arc cosine near 1 */
        const double digit = 2e-15 * (double)(sinl(fabsl((long double)angle)) / c * sum.growth);
        /* the sum itself, too, loses digits towards total reflection */
        if (p * fastest_speed < 1.0L - (has_wide_reference() ? 1e-13L : 1e-5L))
            expect_within("range of the ray found", (double)sum.range, ranges[i],
                          1e-10 * ranges[i] + digit);
        /* the sum's time errs by p times its range error, which is taken off */
        const double measured = ray_path_range(&path, ranges[i], height);
        const long double expected = sum.time * c + p * c * (ranges[i] - sum.range);
        if (digit < 1e-3 * ranges[i]) {
            note_error(measured, expected);
            expect_relative("time", measured, (double)expected, 1e-12);
        }
    }
}

TEST(test_two_points)
{
    largest_error = 0.0;
    on_every_way(compare_two_points);
    print_message("largest relative error of the time between two points: %.2g\n", largest_error);
}

/* Fermat's principle: sound takes the quickest of all paths through a plane between two waters.
 * Nothing of Snell's law is in here. */
TEST(test_fermat)
{
    static const double ranges[] = {1.0, 10.0, 35.0, 120.0, 1000.0};
    struct water water;
    lay(&water, two_layers, 2, 2.0);
    const struct ray_path path = ray_path_direct(&water, 20.0);
    for (size_t i = 0; i < COUNT(ranges); i++) {
        const long double height = 0.7L;
        long double low = 0.0L, high = ranges[i];
        long double time = 0.0L;
        for (int k = 0; k < 400; k++) {
            long double times[2];
            for (int side = 0; side < 2; side++) {
                const long double x = low + (high - low) * (side ? 2.0L : 1.0L) / 3.0L;
                times[side] =
                    hypotl(x, 12.0L) / 1520.0L + hypotl(ranges[i] - x, 8.0L - height) / 1490.0L;
            }
            if (times[0] < times[1])
                high -= (high - low) / 3.0L;
            else
                low += (high - low) / 3.0L;
            time = fminl(times[0], times[1]);
        }
        expect_relative("quickest way", ray_path_range(&path, ranges[i], (double)height),
                        (double)(time * 1490.0L), 1e-13);
    }
    water_clear(&water);
}

/* ---- a linear profile ---- */

/* Returns the exact time along the arc between two points, s. */
static double arc_time(double bottom_speed, double growth, double range, double high, double low)
{
    const double one = bottom_speed + growth * high;
    const double other = bottom_speed + growth * low;
    const double step = high - low;
    const double q = growth * growth * (range * range + step * step) / (2.0 * one * other);
    /* acosh(1 + q) without cancellation */
    return log1p(q + sqrt(q * (q + 2.0))) / fabs(growth);
}

/* The profile is like one of scene files, also with targets that reach through many layers. */
TEST(test_linear_profiles_bend_rays_to_arcs)
{
    static const double heights[] = {0.0, 25.0};
    static const struct {
        double growth, highest_target; /* m/s per m; m */
    } cases[] = {{2.0, 0.0}, {-2.0, 0.0}, {0.1, 0.0}, {2.0, 1.0}};
    for (size_t k = 0; k < COUNT(cases); k++) {
        const double growth = cases[k].growth;
        const double bottom = growth > 0.0 ? 1480.0 : 1530.0;
        const double speeds[] = {bottom, bottom + 25.0 * growth};
        struct water_layer *layers = NULL;
        struct water water;
        size_t count = 0;
        EXPECT_OK(&report, layers_of_profile(heights, speeds, 2, &report, &layers, &count));
        lay(&water, layers, count, cases[k].highest_target);
        assert_true(cases[k].highest_target > 0.0 ? water.count < count : water.count == count);
        const struct ray_path path = ray_path_direct(&water, 20.0);
        for (double range = 10.0; range < 150.0; range += 10.0) {
            const double time = ray_path_range(&path, range, 0.0) / water.straight_speed_mps;
            expect_relative("time", time, arc_time(bottom, growth, range, 20.0, 0.0), 1e-6);
        }
        water_clear(&water);
        free(layers);
    }
}

/* ---- equal layers ---- */

/* Layers of one speed are isovelocity water, also where the layers above the sonar differ. */
TEST(test_straight_water)
{
    static const struct water_layer equal[] = {
        {0.0, 1490.0, 1.0}, {3.0, 1490.0, 1.0}, {9.0, 1490.0, 1.0}};
    static const struct water_layer above[] = {{0.0, 1490.0, 1.0}, {30.0, 1520.0, 1.2}};
    struct water water;
    lay(&water, equal, 3, 2.0);
    assert_int_equal(water.count, 1);
    assert_true(water.straight_speed_mps == 1490.0);
    assert_true(ray_path_direct(&water, 20.0).is_straight);
    water_clear(&water);
    lay(&water, above, 2, 2.0);
    assert_true(ray_path_direct(&water, 20.0).is_straight);
    assert_true(ray_path_image(&water, 20.0, 40.0, 1, true).is_straight);
    assert_false(ray_path_image(&water, 20.0, 40.0, 1, false).is_straight);
    assert_false(ray_path_direct(&water, 31.0).is_straight);
    water_clear(&water);
    lay(&water, NULL, 0, 2.0);
    assert_true(water.straight_speed_mps == 1500.0);
    const struct ray_path path = ray_path_direct(&water, 20.0);
    assert_true(path.is_straight);
    for (double range = 1.0; range < 1000.0; range *= 2.0) {
        const double angle = ray_path_grazing(&path, range, 0.5);
        const struct arrival ray = ray_path_arrival(&path, angle, 0.5);
        expect_relative("angle", angle, atan2(19.5, range), 1e-14);
        expect_relative("straight range", ray.straight_range_m, hypot(19.5, range), 1e-13);
        expect_relative("wavefront", ray.wavefront_m, hypot(19.5, range), 1e-12);
        expect_relative("spreading", ray.spreading, cos(angle), 1e-13);
    }
    water_clear(&water);
}

/* ---- the ray tube ---- */

/* The wavefront's width comes from two rays, half a step in angle to either side, by their points
 * at one height seen across the ray. Power is sent into an angle, here and back from the point. */
static void compare_tube(const struct water *water, const struct reference_way *folded,
                         double height)
{
    const struct ray_path path = way_of(water, folded);
    const double c = water->straight_speed_mps;
    const double c0 = reference_speed_at(folded, folded->sonar_height);
    const double step = 1e-5;
    double angles[ANGLES];
    find_angles(folded, height, angles);
    for (size_t i = 2; i < ANGLES - 1; i++) {
        double launch[2], landing[2], range[2];
        for (int side = 0; side < 2; side++) {
            landing[side] = angles[i] + (side - 0.5) * step;
            launch[side] = acos(cos(landing[side]) * c0 / c);
            range[side] =
                ray_path_arrival(&path, signed_angle(folded, landing[side]), height).ground_range_m;
        }
        const struct arrival ray = ray_path_arrival(&path, signed_angle(folded, angles[i]), height);
        const double apart = fabs(range[1] - range[0]);
        expect_relative("wavefront", ray.wavefront_m, apart * sin(angles[i]) / step, 1e-5);
        /* per rad of azimuth; solid angle is the difference of sines */
        const double there =
            fabs(sin(launch[1]) - sin(launch[0])) / (ray.ground_range_m * apart * sin(angles[i]));
        const double launch_sine = sqrt(1.0 - pow(cos(angles[i]) * c0 / c, 2.0));
        const double back =
            fabs(sin(landing[1]) - sin(landing[0])) / (ray.ground_range_m * apart * launch_sine);
        expect_relative("intensity of the return path over that of the way out", back / there,
                        c * c / (c0 * c0), 1e-5);
        const double amplitude = ray.spreading / (ray.ground_range_m * ray.wavefront_m);
        expect_relative("intensity there and back", amplitude * amplitude, there * back, 2e-5);
        /* wavefronts grow by 1 m per m */
        if (height >= 0.3) {
            const struct arrival lower =
                ray_path_arrival(&path, signed_angle(folded, angles[i]), height - 0.2);
            const double sign = folded->bounces > 0 && folded->comes_from_seabed ? -1.0 : 1.0;
            expect_within("growth of the wavefront", lower.wavefront_m - ray.wavefront_m,
                          sign * 0.2 / sin(angles[i]), 1e-9 * ray.wavefront_m);
        }
    }
}

TEST(test_ray_tube)
{
    on_every_way(compare_tube);
}

/* ---- planes where density differs ---- */

/* Returns 1 - R^2 of a plane between two fluids for sound of p = cos/c. */
static double plane_passes(const struct water_layer *one, const struct water_layer *other, double p)
{
    const double z1 = one->density * one->speed_mps / sqrt(1.0 - pow(p * one->speed_mps, 2.0));
    const double z2 =
        other->density * other->speed_mps / sqrt(1.0 - pow(p * other->speed_mps, 2.0));
    return 1.0 - pow((z1 - z2) / (z1 + z2), 2.0);
}

TEST(test_transmission)
{
    static const struct water_layer light[] = {{0.0, 1490.0, 1030.0},
                                               {6.0, 1510.0, 1030.0}, /* this plane passes all */
                                               {9.0, 1510.0, 400.0},  /* density alone differs */
                                               {12.0, 1470.0, 700.0}};
    struct water_layer same[4];
    memcpy(same, light, sizeof same);
    for (size_t i = 0; i < 4; i++)
        same[i].density = 1.0;
    struct water water, plain;
    lay(&water, light, 4, 2.0);
    lay(&plain, same, 4, 2.0);
    assert_int_equal(plain.count, 3);
    static const struct reference_way ways[] = {
        {light, 4, 20.0, 0.0, 0, false},  {light, 4, 10.0, 0.0, 0, false},
        {light, 4, 20.0, DEPTH, 1, true}, {light, 4, 20.0, DEPTH, 1, false},
        {light, 4, 20.0, DEPTH, 2, true}, {light, 4, 10.0, DEPTH, 2, false},
        {light, 4, 20.0, DEPTH, 3, true}, {light, 4, 20.0, DEPTH, 3, false},
    };
    /* numbers of crossings, for each path, of the planes at 9 m and at 12 m */
    static const int crossings[][2] = {{1, 1}, {1, 0}, {1, 1}, {1, 1},
                                       {1, 1}, {3, 2}, {3, 3}, {3, 3}};
    for (size_t i = 0; i < COUNT(ways); i++)
        for (double angle = 0.2; angle < 1.5; angle += 0.1) {
            const struct ray_path path = way_of(&water, &ways[i]);
            const struct ray_path other = way_of(&plain, &ways[i]);
            const double signed_one = signed_angle(&ways[i], angle);
            const double measured = ray_path_arrival(&path, signed_one, 0.4).spreading /
                                    ray_path_arrival(&other, signed_one, 0.4).spreading;
            const double p = cos(angle) / 1490.0;
            expect_relative("what planes transmit", measured,
                            pow(plane_passes(&light[1], &light[2], p), crossings[i][0]) *
                                pow(plane_passes(&light[2], &light[3], p), crossings[i][1]),
                            1e-12);
        }
    water_clear(&water);
    water_clear(&plain);
}

/* The effect of layers goes with their contrast. Where density alone differs rays are straight, but
 * not all of their sound passes. */
TEST(test_slight_contrasts)
{
    static const struct {
        struct water_layer layers[2];
        double passing, tolerance;
    } cases[] = {
        /* tolerance: 1e-9 over the square of the angle */
        {{{0.0, 1500.0, 1.0}, {8.0, 1500.0 + 1.5e-6, 1.0}}, 1.0, 3e-7},
        {{{0.0, 1500.0, 3.0}, {8.0, 1500.0, 1.0}}, 0.75, 1e-12},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct water water;
        lay(&water, cases[i].layers, 2, 2.0);
        assert_int_equal(water.count, 2);
        const struct ray_path path = ray_path_direct(&water, 20.0);
        assert_false(path.is_straight);
        for (double angle = 0.1; angle < 1.5; angle += 0.1) {
            const struct arrival ray = ray_path_arrival(&path, angle, 0.0);
            const double range = 20.0 / sin(angle);
            expect_relative("range", ray.straight_range_m, range, cases[i].tolerance);
            expect_relative("wavefront", ray.wavefront_m, range, cases[i].tolerance);
            expect_relative("spreading", ray.spreading, cases[i].passing * cos(angle),
                            cases[i].tolerance);
        }
        water_clear(&water);
    }
}

/* ---- total reflection ---- */

static bool is_infinite(const struct arrival *ray)
{
    return isinf(ray->ground_range_m) && isinf(ray->straight_range_m) && isinf(ray->length_m) &&
           isinf(ray->wavefront_m) && isinf(ray->spreading);
}

TEST(test_total_reflection)
{
    static const struct water_layer layers[] = {
        {0.0, 1490.0, 1.0}, {10.0, 1540.0, 1.0}, {15.0, 1490.0, 1.0}};
    struct water water;
    lay(&water, layers, 3, 2.0);
    const struct ray_path path = ray_path_direct(&water, 20.0);
    const double least = acos(1490.0 / 1540.0);
    for (double share = 0.0; share < 0.9999; share += 0.1) {
        const struct arrival ray = ray_path_arrival(&path, share * least, 0.0);
        assert_true(is_infinite(&ray));
    }
    const struct arrival last = ray_path_arrival(&path, least * (1.0 - 1e-12), 0.0);
    assert_true(is_infinite(&last));
    const struct arrival first = ray_path_arrival(&path, least * (1.0 + 1e-12), 0.0);
    assert_true(first.ground_range_m > 1e4 && isfinite(first.ground_range_m));
    /* far rays run level through the fast layer, whose speed gives all growth of time */
    double before = 0.0;
    for (double range = 200.0; range < 3e5; range *= 1.5) {
        const double angle = ray_path_grazing(&path, range, 0.2);
        assert_true(angle >= least && angle < 0.5 * PI);
        const double time = ray_path_range(&path, range, 0.2);
        const struct arrival ray = ray_path_arrival(&path, angle * (1.0 + 1e-15), 0.2);
        assert_false(isnan(ray.spreading) || isnan(ray.wavefront_m) || isnan(ray.ground_range_m));
        if (before > 0.0) {
            const double slope = (time - before) / (range - range / 1.5);
            assert_true(slope > 0.99 * 1490.0 / 1540.0 && slope < 1490.0 / 1540.0 * (1.0 + 1e-9));
        }
        before = time;
        /* at best the path is level in the fast layer, at worst it has both slow layers on top */
        const double level = range * 1490.0 / 1540.0;
        const double steep = 14.8 * sin(least);
        assert_true(time > level + steep && time < level + steep + 5.0 * 1490.0 / 1540.0);
    }
    const double angle = ray_path_grazing(&path, 2000.0, 0.0);
    const struct arrival ray = ray_path_arrival(&path, angle, 0.0);
    print_message("2000 m over 5 m: %.3g rad above total reflection, ray's range %.6f m\n",
                  angle - least, ray.ground_range_m);
    expect_relative("range", ray.ground_range_m, 2000.0, 1e-8);
    water_clear(&water);
}

/* ---- the seabed by travel time ---- */

TEST(test_ground_range)
{
    for (size_t w = 0; w < COUNT(waters); w++)
        for (uint32_t bounces = 0; bounces <= 2; bounces++) {
            struct water water;
            lay(&water, waters[w].layers, waters[w].count, 2.0);
            const struct reference_way folded = {water.layers, water.count, waters[w].sonar_height,
                                                 DEPTH,        bounces,     false};
            const struct ray_path path = way_of(&water, &folded);
            const long double down =
                reference_sum(&folded, 0.0, 0.0L).time * water.straight_speed_mps;
            assert_true(ray_path_ground_range(&path, 0.0) == 0.0);
            assert_true(ray_path_ground_range(&path, (double)down * (1.0 - 1e-9)) == 0.0);
            for (double range = 0.01; range < 3000.0; range *= 1.7) {
                const double straight = ray_path_range(&path, range, 0.0);
                /* dt/dr = cos/c: near the foot the ground range is a square root of the time */
                const double cosine = cos(ray_path_grazing(&path, range, 0.0));
                expect_within("ground range", ray_path_ground_range(&path, straight), range,
                              1e-12 * straight / cosine + 1e-12 * range);
            }
            /* straight down */
            expect_relative("depth", ray_path_range(&path, 1e-6, 0.0), (double)down, 1e-13);
            const double steep = ray_path_grazing(&path, 1e-6, 0.0);
            assert_true(steep > 1.57 && steep <= 0.5 * PI);
            /* straight down the spreading is that of heights weighted by their speed */
            const struct arrival ray = ray_path_arrival(&path, 0.5 * PI - 1e-6, 0.0);
            long double weighted = 0.0L;
            for (size_t i = 0; i < water.count; i++)
                weighted += reference_crossed(&folded, i, 0.0) * water.layers[i].speed_mps /
                            water.straight_speed_mps;
            expect_relative("wavefront", ray.wavefront_m, (double)weighted, 1e-9);
            expect_relative("ground range", ray.ground_range_m, (double)weighted * 1e-6, 1e-9);
            water_clear(&water);
        }
}

/* ---- laying the water ---- */

/* Returns the time straight up to a height, s. */
static double time_up(const struct water_layer *layers, size_t count, double height)
{
    const struct reference_way up = {layers, count, height, 0.0, 0, false};
    return (double)reference_sum(&up, 0.0, 0.0L).time;
}

TEST(test_joined_layers)
{
    static const struct water_layer layers[] = {{0.0, 1490.0, 1.0},
                                                {0.4, 1491.0, 1.0},
                                                {0.9, 1492.0, 1.0},
                                                {1.3, 1492.5, 1.0},
                                                {3.0, 1510.0, 1.0}};
    /* highest target, m, and number of layers left; layers over the target keep their speed */
    static const struct {
        double highest;
        size_t count;
    } cases[] = {{0.0, 5}, {0.3, 5}, {0.6, 5}, {1.0, 4}, {1.5, 3}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct water water;
        lay(&water, layers, COUNT(layers), cases[i].highest);
        assert_int_equal(water.count, cases[i].count);
        assert_true(water.straight_speed_mps == water.layers[0].speed_mps);
        assert_true(water.layers[0].bottom_m == 0.0);
        assert_true(water.count == 1 || water.layers[1].bottom_m >= cases[i].highest);
        expect_relative("time straight up", time_up(water.layers, water.count, 20.0),
                        time_up(layers, COUNT(layers), 20.0), 1e-14);
        for (double height = 0.1; height < 21.0; height += 0.7) {
            size_t number = water.count - 1;
            while (water.layers[number].bottom_m > height)
                number--;
            assert_true(water_layer_at(&water, height) == &water.layers[number]);
        }
        water_clear(&water);
    }
}

static void expect_refused(const struct water_layer *layers, size_t count)
{
    struct water water;
    memset(&water, 0, sizeof water);
    assert_int_equal(water_init(&water, &report, layers, count, 1500.0, 1.0, 0.0),
                     SONJECT_ERROR_INPUT);
    print_message("%s\n", report.message);
    assert_null(water.layers);
    /* no target stands so high */
    lay(&water, layers, count, 0.4);
    assert_int_equal(water.count, count);
    water_clear(&water);
}

/* Up to 1 m both halves count alike: each is half the difference away from the joined layer. */
TEST(test_refused_layers)
{
    struct water_layer layers[] = {{0.0, 1500.0, 1.0}, {0.5, 1500.0, 1.0}, {2.0, 1530.0, 1.2}};
    struct water water;
    layers[1].speed_mps = 1500.0 * (1.0 + 1.0 / 260.0);
    layers[1].density = 1.0 + 1.0 / 260.0;
    lay(&water, layers, COUNT(layers), 1.0);
    assert_int_equal(water.count, 3);
    assert_true(water.layers[1].bottom_m == 1.0);
    assert_true(water.layers[1].speed_mps == layers[1].speed_mps);
    water_clear(&water);
    for (int sign = -1; sign <= 1; sign += 2) {
        layers[1].speed_mps = 1500.0 * (1.0 + sign / 240.0);
        layers[1].density = 1.0;
        expect_refused(layers, COUNT(layers));
        layers[1].speed_mps = 1500.0;
        layers[1].density = 1.0 + sign / 240.0;
        expect_refused(layers, COUNT(layers));
    }
}

TEST_PROGRAM(NULL, NULL)
