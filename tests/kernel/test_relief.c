/* Tests rays on a height field: 10^5 rays from 50 m and 500 m, down to 2 degrees, against an
 * independent solver in double precision. Where all is level, bits must be the plane's. */
#include "base/memory.h"
#include "claims.h"
#include "random_rays.h"
#include "seabed.h"
#include "trace/object_buffer.h"

#define RAYS       100000
#define HIGHEST    0.7 /* m, above all heights here */
#define WORDS_HEAD 16  /* words in front of the relief, where objects would be */

/* A relief as the fan sees it. */
struct sea {
    struct relief relief;
    struct trace trace;
    uint32_t *words;
};

typedef double height_function(double x, double y);

/* Returns a height of long-crested ripples, a mound, a pit and level ground in one. */
static double varied(double x, double y)
{
    const double ripples = 0.03 * cos(2.0 * PI * (0.3 * x + 0.95 * y) / 0.4);
    const double mound = 0.5 * exp(-((x - 1.0) * (x - 1.0) + (y + 1.5) * (y + 1.5)) / 0.3);
    const double pit = -0.3 * exp(-((x + 1.2) * (x + 1.2) + (y - 1.0) * (y - 1.0)) / 0.2);
    const double part = fmin(1.0, fmax(0.0, 2.0 + y)); /* level beyond y = -2 m */
    const double edge = fmin(1.0, fmax(0.0, 3.0 - fmax(fabs(x), fabs(y))) / 0.5);
    return edge * part * (ripples + mound + pit);
}

static double one_mound(double x, double y)
{
    const double distance = hypot(x, y) / 0.7;
    return distance < 1.0 ? 0.2 * (1.0 + cos(PI * distance)) : 0.0;
}

static double level(double x, double y)
{
    (void)x;
    (void)y;
    return 0.0;
}

static void sea_init(struct sea *sea, height_function *height, double step, double side)
{
    struct relief *relief = &sea->relief;
    memset(sea, 0, sizeof *sea);
    relief->rows = relief->columns = (uint32_t)(side / step) + 1;
    relief->row_step_m = relief->column_step_m = step;
    relief->first_x_m = relief->first_y_m = -0.5 * side;
    const size_t points = (size_t)relief->rows * relief->columns;
    relief->heights = zeroed(points, sizeof(float));
    relief->slopes = zeroed(points, 2 * sizeof(float));
    for (uint32_t row = 1; row + 1 < relief->rows; row++)
        for (uint32_t column = 1; column + 1 < relief->columns; column++)
            relief->heights[(size_t)row * relief->columns + column] =
                (float)height(-0.5 * side + row * step, -0.5 * side + column * step);
    relief_finish(relief);
    sea->words = zeroed(WORDS_HEAD + relief_word_count(relief), sizeof *sea->words);
    relief_words_init(sea->words + WORDS_HEAD, relief);
    sea->trace.objects = (const struct object_record *)sea->words;
    sea->trace.fan.relief_words = WORDS_HEAD;
    sea->trace.fan.relief_x = (float)relief->first_x_m;
    sea->trace.fan.relief_y = (float)relief->first_y_m;
}

static void sea_clear(struct sea *sea)
{
    free(sea->relief.heights);
    free(sea->relief.slopes);
    free(sea->words);
}

/* A ray in double precision, from the single precision that the kernel gets. */
struct line {
    double point[3], direction[3];
};

static double clearance(const struct sea *sea, const struct line *line, double t)
{
    return line->point[2] + t * line->direction[2] -
           relief_height(&sea->relief, line->point[0] + t * line->direction[0],
                         line->point[1] + t * line->direction[1]);
}

/* Returns where the line first comes through the surface from above beyond `begin`; INFINITY:
 * nowhere. Between two lines of the grid the clearance is a polynomial of degree 2, known by three
 * values. All crossings of grid lines are listed and sorted, and each piece is solved. */
static double reference_distance(const struct sea *sea, const struct line *line, double begin)
{
    const struct relief *relief = &sea->relief;
    const double low[2] = {relief->first_x_m, relief->first_y_m};
    const double step = relief->row_step_m;
    static double cuts[8192];
    size_t count = 0;
    const double far = line->direction[2] < 0.0 ? -line->point[2] / line->direction[2] : INFINITY;
    for (int axis = 0; axis < 2; axis++)
        for (uint32_t i = 0; i < relief->rows; i++) {
            const double t = (low[axis] + i * step - line->point[axis]) / line->direction[axis];
            if (line->direction[axis] != 0.0 && t > begin && t < begin + 2000.0)
                cuts[count++] = t;
        }
    bool is_inside = false;
    cuts[count++] = begin;
    qsort(cuts, count, sizeof *cuts, compare_doubles);
    for (size_t i = 0; i + 1 < count; i++) {
        const double a = cuts[i];
        const double b = cuts[i + 1];
        const double middle = 0.5 * (a + b);
        const double x = line->point[0] + middle * line->direction[0];
        const double y = line->point[1] + middle * line->direction[1];
        if (line->point[2] + b * line->direction[2] > HIGHEST &&
            line->point[2] + a * line->direction[2] > HIGHEST)
            continue;
        if (fabs(x) >= -low[0] || fabs(y) >= -low[1])
            continue;
        if (far > begin && far <= a && !is_inside) /* the line met the plane before the grid */
            return far;
        is_inside = true;
        /* values off the grid's own lines, on which either cell would do */
        const double width = b - a;
        const double values[3] = {clearance(sea, line, a + 1e-9 * width),
                                  clearance(sea, line, middle),
                                  clearance(sea, line, b - 1e-9 * width)};
        const double square = 2.0 * (values[0] + values[2] - 2.0 * values[1]);
        const double slope = values[2] - values[0] - square;
        double best = INFINITY;
        if (fabs(square) < 1e-12) {
            if (slope < 0.0)
                best = -values[0] / slope;
        } else if (slope * slope - 4.0 * square * values[0] >= 0.0) {
            /* the root at which the clearance falls */
            best = (-slope - sqrt(slope * slope - 4.0 * square * values[0])) / (2.0 * square);
        }
        if (best >= -1e-12 && best <= 1.0 + 1e-12)
            return a + best * width;
    }
    return far > begin ? far : INFINITY;
}

static float seabed_at(const struct sea *sea, struct vector3 point, struct vector3 direction,
                       float minimum)
{
    return seabed_distance(&sea->trace, point, direction, minimum, -1);
}

static struct vector3 normal_at(const struct sea *sea, struct vector3 hit, struct vector3 direction)
{
    return seabed_normal(&sea->trace, hit, direction);
}

static double lowest_between(const struct sea *sea, const struct line *line, double a, double b)
{
    double lowest = INFINITY;
    for (int i = 0; i <= 2000; i++)
        lowest = fmin(lowest, clearance(sea, line, a + (b - a) * i / 2000.0));
    return lowest;
}

static struct line line_of(struct vector3 point, struct vector3 direction)
{
    const struct line line = {{(double)point.x, (double)point.y, (double)point.z},
                              {(double)direction.x, (double)direction.y, (double)direction.z}};
    return line;
}

struct errors {
    double height, distance; /* largest; distances only at local grazing angles above 3 degrees */
    size_t hits, misses, grazed;
};

static void compare_ray(const struct sea *sea, struct vector3 point, struct vector3 direction,
                        float minimum, struct errors *errors)
{
    const struct line line = line_of(point, direction);
    const float found = seabed_at(sea, point, direction, minimum);
    const double expected = reference_distance(sea, &line, (double)minimum);
    const double at = (double)found < 0.5 * (double)FAR_AWAY ? (double)found : INFINITY;
    errors->hits += isfinite(expected) != 0;
    errors->misses += isfinite(expected) == 0;
    if (at == expected || fabs(at - expected) < 1e-3) {
        if (!isfinite(at))
            return;
        const double here = clearance(sea, &line, at);
        errors->height = fmax(errors->height, fabs(here));
        const double fall =
            (clearance(sea, &line, at - 1e-4) - clearance(sea, &line, at + 1e-4)) / 2e-4;
        if (fall > 0.05)
            errors->distance = fmax(errors->distance, fabs(at - expected));
        return;
    }
    /* one of the two passes a crest that the other one grazes: by less than 5 um */
    errors->grazed++;
    const double first = fmin(at, expected);
    const double end = fmin(fmax(at, expected), first + 0.02);
    if (at < expected)
        assert_true(fabs(clearance(sea, &line, at)) < 5e-6);
    else
        assert_true(lowest_between(sea, &line, first, end) > -5e-6);
}

/* Draws a ray of a fan from a range: its closest point to the frame's origin and its direction, at
 * a grazing angle of 2 to 70 degrees and any azimuth. */
static void fan_ray_from(double range, struct vector3 *point, struct vector3 *direction)
{
    const double grazing = 0.035 + 1.2 * pow(uniform(0.0, 1.0), 2.0);
    const double azimuth = uniform(0.0, 1.0) < 0.5 ? 0.5 * PI : 2.0 * PI * uniform(0.0, 1.0);
    const double aim[3] = {6.0 * uniform(0.0, 1.0) - 3.0, 6.0 * uniform(0.0, 1.0) - 3.0,
                           0.3 * uniform(0.0, 1.0) - 0.1};
    const double d[3] = {cos(grazing) * cos(azimuth), cos(grazing) * sin(azimuth), -sin(grazing)};
    /* a fan's ray goes from the sonar through a point of the sea to its closest point */
    double from[3];
    double along = 0.0;
    for (int i = 0; i < 3; i++) {
        from[i] = aim[i] - range * d[i];
        along -= from[i] * d[i];
    }
    point->x = (float)(from[0] + along * d[0]);
    point->y = (float)(from[1] + along * d[1]);
    point->z = (float)(from[2] + along * d[2]);
    direction->x = fabs(d[0]) < 1e-9 ? 0.0f : (float)d[0];
    direction->y = (float)d[1];
    direction->z = (float)d[2];
}

TEST(test_primary_rays)
{
    static const double ranges[] = {50.0, 500.0};
    struct sea sea;
    sea_init(&sea, varied, 0.025, 6.5);
    for (int i = 0; i < 2; i++) {
        struct errors errors = {0.0, 0.0, 0, 0, 0};
        for (int ray = 0; ray < RAYS; ray++) {
            struct vector3 point, direction;
            fan_ray_from(ranges[i], &point, &direction);
            compare_ray(&sea, point, direction, (float)-ranges[i], &errors);
        }
        print_message("%.0f m: %zu hits, %zu misses, %zu graze a crest; height off by %.2g m, "
                      "distance by %.2g m\n",
                      ranges[i], errors.hits, errors.misses, errors.grazed, errors.height,
                      errors.distance);
        assert_true(errors.hits > RAYS / 2);
        assert_true(errors.grazed < RAYS / 1000);
        /* coordinates up to 6.5 m err by 2^-21 m each, on slopes of 1 and less; distances err by as
         * much over the sine of at least 3 degrees */
        assert_true(errors.height < 3e-6);
        assert_true(errors.distance < 6.5e-5);
    }
    sea_clear(&sea);
}

/* Rays that leave points of the surface all around must not meet the surface again at once. */
TEST(test_rays_from_the_surface)
{
    struct sea sea;
    struct errors errors = {0.0, 0.0, 0, 0, 0};
    sea_init(&sea, varied, 0.025, 6.5);
    for (int ray = 0; ray < RAYS; ray++) {
        struct vector3 point, direction;
        fan_ray_from(50.0, &point, &direction);
        const float distance = seabed_at(&sea, point, direction, -50.0f);
        const struct vector3 hit = along3(point, direction, distance);
        if (fabsf(hit.x) > 3.2f || fabsf(hit.y) > 3.2f)
            continue;
        const struct vector3 normal = normal_at(&sea, hit, direction);
        assert_true(dot3(normal, direction) < 0.0f);
        assert_true(fabsf(dot3(normal, normal) - 1.0f) < 1e-6f);
        const struct vector3 start = along3(hit, normal, 2.0e-5f);
        /* the way straight back is clear */
        assert_true(is_clear_of_relief(&sea.trace, start, reversed3(direction), 49.0f, -1) ||
                    -dot3(normal, direction) < 0.02f);
        const double azimuth = 2.0 * PI * uniform(0.0, 1.0);
        const double up = uniform(-0.3, 1.0); /* also down into the pit */
        direction.x = (float)(sqrt(1.0 - up * up) * cos(azimuth));
        direction.y = (float)(sqrt(1.0 - up * up) * sin(azimuth));
        direction.z = (float)up;
        const struct line line = line_of(start, direction);
        if (dot3(normal, direction) < 0.05f || clearance(&sea, &line, 0.0) <= 0.0)
            continue;
        compare_ray(&sea, start, direction, 0.0f, &errors);
    }
    print_message("%zu meet a slope, %zu get away, %zu graze\n", errors.hits, errors.misses,
                  errors.grazed);
    assert_true(errors.hits > 1000);
    assert_true(errors.misses > 1000);
    assert_true(errors.grazed < RAYS / 1000);
    sea_clear(&sea);
}

/* Rays along the grid's own lines and through its points find the surface. */
TEST(test_rays_on_grid_lines)
{
    struct sea sea;
    sea_init(&sea, varied, 0.03125, 6.5);
    for (int ray = 0; ray < RAYS / 10; ray++) {
        /* steps and corners that single precision holds exactly */
        const int row = 1 + (int)(205.0 * uniform(0.0, 1.0));
        const int column = 1 + (int)(205.0 * uniform(0.0, 1.0));
        const float height = sea.relief.heights[(size_t)row * sea.relief.columns + (size_t)column];
        const int kind = ray % 4;
        const double slant = kind == 0 ? 0.0 : 2.0;
        struct vector3 direction, point;
        direction.x = kind == 2 ? 0.0f : (float)(slant / sqrt(1.0 + slant * slant));
        direction.y = kind == 2 ? (float)(slant / sqrt(1.0 + slant * slant)) : 0.0f;
        direction.z = (float)(-1.0 / sqrt(1.0 + slant * slant));
        if (kind == 3)
            direction.x = direction.y = (float)sqrt(0.25);
        if (kind == 3)
            direction.z = (float)-sqrt(0.5);
        point.x = (float)(-3.25 + row * 0.03125) - direction.x;
        point.y = (float)(-3.25 + column * 0.03125) - direction.y;
        point.z = height - direction.z;
        const struct line line = line_of(point, direction);
        const float found = seabed_at(&sea, point, direction, -1.0f);
        const double here = clearance(&sea, &line, (double)found);
        /* slopes reach 1.7: coordinates are off by 2^-22 m */
        if (fabs(here) > 3e-6)
            fail_msg("kind %d at row %d, column %d: %g m off", kind, row, column, here);
        /* a slanting ray may just pass over a crest that it is aimed at */
        assert_true(kind != 0 || fabsf(found - 1.0f) < 3e-6f);
    }
    sea_clear(&sea);
}

/* Returns whether all points that give a place's height and slopes are at 0. */
static bool is_level_at(const struct sea *sea, struct vector3 place)
{
    const struct relief *relief = &sea->relief;
    const int row = (int)floor(((double)place.x - relief->first_x_m) / relief->row_step_m);
    const int column = (int)floor(((double)place.y - relief->first_y_m) / relief->column_step_m);
    for (int r = row - 2; r <= row + 3; r++)
        for (int c = column - 2; c <= column + 3; c++)
            if (r < 0 || c < 0 || r >= (int)relief->rows || c >= (int)relief->columns ||
                relief->heights[(size_t)r * relief->columns + (size_t)c] != 0.0f)
                return false;
    return true;
}

/* Ground at height 0, and level ground next to a mound, has the plane's distances, normals and
 * bits. */
TEST(test_level_ground_is_the_plane)
{
    for (int has_mound = 0; has_mound < 2; has_mound++) {
        struct sea sea;
        size_t met = 0;
        sea_init(&sea, has_mound ? one_mound : level, 0.025, 6.5);
        for (int ray = 0; ray < RAYS; ray++) {
            struct vector3 point, direction;
            fan_ray_from(has_mound || ray % 2 ? 50.0 : 500.0, &point, &direction);
            const float plane = plane_distance(&sea.trace.fan, point, direction);
            const float found = seabed_at(&sea, point, direction, has_mound ? -50.0f : -600.0f);
            const struct vector3 place = along3(point, direction, found);
            if (has_mound && (!is_level_at(&sea, place) || fabsf(place.z) > 1e-5f))
                continue;
            const struct vector3 normal = normal_at(&sea, place, direction);
            assert_memory_equal(&plane, &found, sizeof plane);
            assert_true(normal.x == 0.0f && normal.y == 0.0f && normal.z == 1.0f);
            met += hypot((double)place.x, (double)place.y) < 0.9;
        }
        assert_true(met > 200); /* hits in blocks that a mound reaches into */
        sea_clear(&sea);
    }
}

static double ripples_alone(double x, double y)
{
    return 0.03 * cos(2.0 * PI * (0.6 * x + 0.8 * y) / 0.4);
}

/* Normals are those of the smooth surface, not of the cells. A wavelength has 24 points. */
TEST(test_normals)
{
    struct sea sea;
    double worst = 0.0;
    sea_init(&sea, ripples_alone, 0.4 / 24.0, 6.4);
    for (int ray = 0; ray < RAYS / 10; ray++) {
        struct vector3 point, direction;
        fan_ray_from(50.0, &point, &direction);
        const float distance = seabed_at(&sea, point, direction, -50.0f);
        const struct vector3 hit = along3(point, direction, distance);
        if (fabsf(hit.x) > 3.0f || fabsf(hit.y) > 3.0f)
            continue;
        const struct vector3 normal = normal_at(&sea, hit, direction);
        const double phase = 2.0 * PI * (0.6 * (double)hit.x + 0.8 * (double)hit.y) / 0.4;
        const double slope = 0.03 * 2.0 * PI / 0.4 * sin(phase);
        const double length = sqrt(1.0 + slope * slope);
        const double cosine = ((double)normal.x * 0.6 + (double)normal.y * 0.8) * slope / length +
                              (double)normal.z / length;
        const double facing = -(0.6 * slope * (double)direction.x +
                                0.8 * slope * (double)direction.y + (double)direction.z) /
                              length;
        if (facing > 0.01)
            worst = fmax(worst, acos(fmin(1.0, cosine)));
    }
    /* linear interpolation of slopes up to 0.47 errs by (k step)^2/8 of them, 0.004, and finite
     * differences by (k step)^4/30 of them, less than 1e-4 */
    print_message("normals are within %.4f rad of the smooth surface's\n", worst);
    assert_true(worst < 0.0045);
    assert_true(worst > 0.0);
    sea_clear(&sea);
}

TEST_PROGRAM(NULL, NULL)
