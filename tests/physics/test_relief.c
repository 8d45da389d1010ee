/* A seabed that is not level: its own echo by the local grazing angle, its shadows and layover, and
 * its effect on targets, compared with geometry and integration in double precision. */
#include "sea.h"

#define ROWS    160
#define COLUMNS 400
#define RANGE   30.0

static double middle_x(const struct sea *sea)
{
    return sea_x(sea, 0.5 * (ROWS - 1));
}

static double middle_ground(const struct sea *sea)
{
    return sea_ground(sea, sea_range(sea, 0.5 * (COLUMNS - 1)));
}

static struct sea *open_sea(double ray_scale)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sea->injection->ray_scale = ray_scale;
    return sea;
}

/* Returns the energy of a column, a mean over the 40 middle rows. */
static double mean_of_column(const struct image *image, size_t column)
{
    double mean = 0.0;
    for (size_t row = 60; row < 100; row++)
        mean += (double)image->seabed_energy[row * COLUMNS + column] / 40.0;
    return mean;
}

/* Returns the height of a slope of `half` m each way, which then falls to 0 in `half` m more. */
static double ramp(double slope, double way, double half)
{
    const double beyond = (fabs(way) - half) / half;
    if (beyond <= 0.0)
        return slope * way;
    return beyond < 1.0 ? copysign(slope * half * 0.5 * (1.0 + cos(PI * beyond)), slope * way)
                        : 0.0;
}

/* Lays a plane through the patch's middle: 0.7 m each way along the track, or 2 m in range. */
static void lay_slope(struct sea *sea, double along, double outward)
{
    const double step = 0.025;
    sonject_relief_params grid;
    sea_ready(sea);
    const double near = sea_ground(sea, sea_range(sea, -1.0));
    const double far = sea_ground(sea, sea_range(sea, COLUMNS));
    memset(&grid, 0, sizeof grid);
    grid.first_along_track_m = sea_x(sea, -1.0);
    grid.first_ground_range_m = near;
    grid.row_spacing_m = grid.column_spacing_m = step;
    grid.rows = (uint32_t)((ROWS + 1) * sea->geometry->row_spacing_m / step) + 2;
    grid.columns = (uint32_t)((far - near) / step) + 2;
    float *heights = claim_memory((size_t)grid.rows * grid.columns, sizeof *heights);
    for (uint32_t row = 0; row < grid.rows; row++)
        for (uint32_t column = 0; column < grid.columns; column++)
            heights[(size_t)row * grid.columns + column] =
                (float)(ramp(along, grid.first_along_track_m + row * step - middle_x(sea), 0.7) +
                        ramp(outward, near + column * step - middle_ground(sea), 2.0));
    sea_set_heights(sea, &grid, heights);
    sea_ready(sea);
}

/* Returns the energy of a slope: mu sin^2(local) / cos(local) times the point response's area on
 * the ground. On a slope the sound of a range comes from another point, at another angle. */
static double slope_energy(const struct sea *sea, double slope, double range)
{
    const double altitude = sea->sonar->altitude_m;
    double low = 1.0;
    double high = range;
    for (int i = 0; i < 60; i++) {
        const double y = 0.5 * (low + high);
        const double z = slope * (y - middle_ground(sea));
        if (hypot(y, altitude - z) < range)
            low = y;
        else
            high = y;
    }
    const double height = slope * (low - middle_ground(sea));
    const double local = atan2(altitude - height, low) + atan(slope);
    const double square = sin(local) * sin(local);
    return sea->seabed->lambert * square / cos(local) * sea_window_energy(sea) *
           sea_pulse_energy(sea);
}

CLAIM(slopes_towards_and_away)
{
    static const double slopes[] = {0.2, -0.15};
    for (int i = 0; i < 2; i++) {
        double sum = 0.0, squares = 0.0;
        struct sea *sea = open_sea(4.0);
        lay_slope(sea, 0.0, slopes[i]);
        const struct image *image = sea_image(sea);
        for (size_t column = 150; column < 250; column++) {
            const double range = sea_range(sea, (double)column);
            const double ratio =
                mean_of_column(image, column) / slope_energy(sea, slopes[i], range);
            sum += ratio;
            squares += ratio * ratio;
        }
        struct estimate energy = estimate_of_sums(sum, squares, 100.0);
        energy.error *= sqrt(3.0); /* three columns lie within a pulse */
        /* W's tail beyond the kept reach has 0.1 % of the energy */
        expect_estimate("energy over closed form", energy, 1.0, 2e-3);
        expect_below("its error", energy.error, 2e-3);
    }
}

/* Ground rises along the track. Seen from broadside the range does not change along a row, and
 * Lambert's law leaves 1/sqrt(1 + slope^2). */
CLAIM(a_slope_along_the_track)
{
    const double slope = 0.4;
    double sum = 0.0;
    struct sea *sea = open_sea(4.0);
    lay_slope(sea, slope, 0.0);
    const struct image *image = sea_image(sea);
    for (size_t row = 60; row < 100; row++)
        for (size_t column = 150; column < 250; column++) {
            const double height = slope * (sea_x(sea, (double)row) - middle_x(sea));
            const double sine = (sea->sonar->altitude_m - height) / sea_range(sea, (double)column);
            const double expected = sea->seabed->lambert * sine * sine / sqrt(1.0 - sine * sine) /
                                    sqrt(1.0 + slope * slope) * sea_window_energy(sea) *
                                    sea_pulse_energy(sea);
            sum += (double)image->seabed_energy[row * COLUMNS + column] / expected / 4000.0;
        }
    /* 4000 pixels of some 3 % scatter; W's tail 0.1 % */
    expect_close("energy over closed form", sum, 1.0, 4.0 * 0.03 / sqrt(4000.0) * 3.0 + 2e-3);
}

/* Integrates the row through the middle in double precision, over short steps of the ground. A step
 * that stands over all nearer ones is lit and returns mu cos^2 of its energy, by G^2. */
static const double *integrate_row(const struct sea *sea)
{
    const double step = 2e-4, altitude = sea->sonar->altitude_m, x = middle_x(sea);
    const double near = sea_ground(sea, sea_range(sea, 0.0)) - 1.0;
    const double far = sea_ground(sea, sea_range(sea, COLUMNS + 40.0));
    double *energy = claim_memory(COLUMNS, sizeof *energy), horizon = -INFINITY;
    for (double y = near; y < far; y += step) {
        const double z = sea_height(sea, x, y);
        const double rise = sea_height(sea, x, y + 0.5 * step) - sea_height(sea, x, y - 0.5 * step);
        if ((z - altitude) / y <= horizon)
            continue;
        horizon = (z - altitude) / y;
        const double range = hypot(y, altitude - z), length = hypot(step, rise);
        const double cosine = (y * rise + (altitude - z) * step) / (range * length);
        const int column = (int)sea_column(sea, range);
        for (int i = column - 8; i <= column + 9; i++)
            if (cosine > 0.0 && i >= 0 && i < COLUMNS)
                energy[i] += sea->seabed->lambert * cosine * cosine * length *
                             pow(sea_pulse(sea, sea_range(sea, i) - range), 2.0) *
                             sea_window_energy(sea);
    }
    return energy;
}

/* Every pixel of the mean line over long-crested ripples agrees with integration, from gentle
 * ripples to those that hide half of the ground. */
CLAIM(ripples_by_integration)
{
    static const double heights[] = {0.02, 0.10};
    for (int i = 0; i < 2; i++) {
        double mean = 0.0, expected_mean = 0.0, squares = 0.0, most = 0.0, least = INFINITY;
        struct sea *sea = open_sea(4.0);
        sea_add_ripples(sea, 0.5, heights[i], 0.5 * PI, 0.6); /* crests along the track */
        sea_ready(sea);
        const double y = middle_ground(sea) + 0.123, phase = 2.0 * PI * y / 0.5;
        expect_close("height of the ripples", sea_height(sea, middle_x(sea), y),
                     0.5 * heights[i] * (cos(phase) + 0.15 * cos(2.0 * phase)),
                     0.01 * heights[i]); /* bilinear between 40 points a wavelength */
        const struct image *image = sea_image(sea);
        const double *expected = integrate_row(sea);
        for (size_t column = 80; column < COLUMNS - 80; column++) {
            const double line = mean_of_column(image, column);
            mean += line / 240.0;
            expected_mean += expected[column] / 240.0;
            squares += pow(line - expected[column], 2.0) / 240.0;
            most = fmax(most, expected[column]);
            least = fmin(least, expected[column]);
        }
        expect_close("mean over integration", mean / expected_mean, 1.0, 2e-3);
        /* 40 rows of rays that meet a pixel some 50 times each, in strata; the grid's facets err by
         * 1/2 % of the slope */
        expect_below("rms difference over the mean", sqrt(squares) / expected_mean, 0.01);
        assert_true(heights[i] < 0.05 || least < 0.01 * most);
    }
}

/* The shadow of a mound ends where the line over the crest meets the ground, and begins where the
 * line touches the mound. */
CLAIM(the_shadow_of_a_mound)
{
    struct sea *sea = open_sea(4.0);
    double highest = -INFINITY, touch = 0.0;
    sea_add_mound(sea, 0.8, 0.5, 0.0);
    sea_ready(sea);
    const double altitude = sea->sonar->altitude_m;
    for (double y = -0.8; y < 0.8; y += 1e-4) {
        const double ground = middle_ground(sea) + y, z = 0.25 * (1.0 + cos(PI * y / 0.8));
        if ((z - altitude) / ground > highest) {
            highest = (z - altitude) / ground;
            touch = hypot(ground, altitude - z);
        }
    }
    const double end = hypot(altitude / highest, altitude);
    const struct image *image = sea_image(sea);
    double lit[COLUMNS];
    for (size_t i = 0; i < COLUMNS; i++)
        lit[i] = (double)image->seabed_energy[(ROWS / 2) * COLUMNS + i] /
                 (double)image->level_energy[(ROWS / 2) * COLUMNS + i];
    size_t column = (size_t)(sea_column(sea, 0.5 * (touch + end)));
    assert_true(lit[column] < 1e-3);
    size_t last = column;
    while (lit[last + 1] < 0.5)
        last++;
    const double share = (0.5 - lit[last]) / (lit[last + 1] - lit[last]);
    /* half a pixel: the edge is a step smoothed by the pulse, and 5 cm of W's main lobe see a
     * shadow that is 1 mm shorter */
    expect_close("end of the shadow, m", sea_range(sea, (double)last + share), end, 0.0125);
    while (lit[column] < 0.05)
        column--;
    /* light fades on the back of the mound, where it grazes */
    expect_close("beginning of the shadow, m", sea_range(sea, (double)column), touch, 0.08);
}

/* A relief of no height gives the plane's bits in energies, glints and chains. */
CLAIM(no_height_is_the_plane)
{
    for (int is_wide = 0; is_wide < 2; is_wide++) {
        const struct image *images[2];
        for (int i = 0; i < 2; i++) {
            struct sea *sea = open_sea(1.0);
            sonject_object_params *object = sea_add_sphere(sea, 0.25, -0.1);
            object->material.lambert = 0.1;
            object->material.reflection = 0.5;
            sea->sonar->transducer_side_m = is_wide ? 0.1 : 0.0;
            sea->injection->interactions = 2;
            if (i == 1)
                sea_add_mound(sea, 1.0, 0.0, 0.0);
            images[i] = sea_image(sea);
        }
        assert_null(images[0]->level_energy);
        /* the object is in some ways to a wide source, but not over the level seabed */
        if (!is_wide)
            assert_memory_equal(images[1]->level_energy, images[0]->seabed_energy,
                                images[0]->pixels * sizeof(float));
        assert_false(images_differ(images[0], images[1]));
    }
}

/* A sphere on the bottom of a pit glints from its place, at its own strength. Behind a mound it
 * does not. */
CLAIM(a_glint_in_a_pit)
{
    for (int is_hidden = 0; is_hidden < 2; is_hidden++) {
        double range;
        struct sea *sea = open_sea(1.0);
        sea_add_sphere(sea, 0.2, 0.0);
        sea_add_mound(sea, 2.0, -0.4, 0.0);
        if (is_hidden)
            sea_add_mound(sea, 1.0, 0.7, -50.0 * 0.025);
        const double peak = sea_peak(sea, &range), *centre = sea_centre(sea, 0);
        if (is_hidden) {
            expect_below("glint behind a mound over that of a sphere", peak / 0.1, 0.01);
            continue;
        }
        expect_close("height of its centre, m", centre[2], -0.2, 2e-3);
        expect_close("range of its glint, m", range,
                     hypot(centre[1], sea->sonar->altitude_m - centre[2]) - 0.2, 2e-3);
        expect_close("its strength over a/2", peak / 0.1, 1.0, 0.01);
    }
}

/* The sea surface shows a sphere that a mound hides: only the way by the surface, there and back,
 * passes over the crest. The line over the crest is 12 cm over the place of the straight glint. */
CLAIM(a_glint_over_a_mound)
{
    double range;
    struct sea *sea = open_sea(1.0);
    sea_add_sphere(sea, 0.2, 0.0);
    sea_add_mound(sea, 1.2, 0.85, -50.0 * 0.025);
    sea->surface->water_depth_m = 14.0;
    sea->injection->interactions = 3;
    sea_ready(sea);
    const double *centre = sea_centre(sea, 0), altitude = sea->sonar->altitude_m;
    const struct line line = sea_line(sea, 0);
    const double peak = line_peak(sea, &line, &range);
    expect_close("range by way of the surface, m", range,
                 hypot(centre[1], 2.0 * 14.0 - altitude - centre[2]) - 0.2, 2e-3);
    expect_close("its strength over a/2", peak / 0.1, 1.0, 0.01);
    const double direct = hypot(centre[1], altitude - centre[2]) - 0.2;
    expect_below("straight glint", cabs(line_at(sea, &line, direct)), 1e-4);
    expect_below("glint one way by the surface", cabs(line_at(sea, &line, 0.5 * (direct + range))),
                 1e-4);
}

/* An upright plate on rising ground throws a shorter shadow, up the slope. The shadow ends where
 * the line over the far top edge meets the ground z = slope (y - middle). */
CLAIM(a_shadow_on_a_slope)
{
    const double slope = 0.25;
    struct sea *sea = open_sea(4.0);
    sea_add(sea, SHAPE_BOX, 2.0, 0.1, 0.0)->height_m = 0.6;
    lay_slope(sea, 0.0, slope);
    const double *visibility = visibility_of(sea_image(sea)) + (ROWS / 2) * COLUMNS;
    const double altitude = sea->sonar->altitude_m, middle = middle_ground(sea);
    const double fall = (altitude - 0.6) / (middle + 0.05);
    const double y = (altitude + slope * middle) / (fall + slope);
    const double end = hypot(y, altitude - slope * (y - middle));
    size_t column = (size_t)sea_column(sea, end - 0.1);
    assert_true(visibility[column] < 0.01);
    while (visibility[column] < 0.5)
        column++;
    expect_close("end of the shadow, m", sea_range(sea, (double)column - 0.5), end, 0.02);
}

/* Layers of nearly one sound speed bend nothing. The table of rays, with points above and below the
 * mean seabed, gives the energy of straight rays. */
CLAIM(layers_that_bend_nothing)
{
    static const struct water_layer layers[] = {{0.0, 1500.0, 1.0}, {4.0, 1500.0001, 1.0}};
    const struct image *images[2];
    double sums[2] = {0.0, 0.0}, difference = 0.0;
    for (int i = 0; i < 2; i++) {
        struct sea *sea = open_sea(1.0);
        sea->sonar->transducer_side_m = 0.05; /* so that ways home are looked up, too */
        sea_add_ripples(sea, 0.5, 0.08, 0.5 * PI, 0.6);
        sea_add_mound(sea, 1.0, -0.3, 0.0);
        sea_set_layers(sea, layers, i ? 2 : 0);
        sea_ready(sea);
        assert_int_equal(sea->bench->water.count, 1 + i);
        images[i] = sea_image(sea);
        sums[i] = sum_of(images[i]->seabed_energy, images[i]->pixels);
    }
    for (size_t k = 0; k < images[0]->pixels; k++)
        difference += fabs((double)images[0]->seabed_energy[k] - images[1]->seabed_energy[k]);
    expect_close("energy through layers over straight", sums[1] / sums[0], 1.0, 1e-3);
    /* the fans' strata differ, so rays meet other points of a pixel: some per cent of it */
    expect_below("difference of pixels over the mean", difference / sums[0], 0.05);
}

/* A composite keeps every bit beyond the relief's reach, brightens the face of a mound, darkens its
 * back, and keeps the mean where all is level. */
CLAIM(a_mound_in_a_composite)
{
    struct sea *sea = open_sea(1.0);
    float *pixels = claim_memory(sea->pixels, sizeof *pixels);
    for (size_t i = 0; i < sea->pixels; i++)
        pixels[i] = 1.0f + 0.3f * (float)((i * 7919) % 101) / 101.0f;
    sea_add_mound(sea, 0.8, 0.5, 0.0);
    const struct injected *result = sea_inject(sea, pixels, false);
    size_t kept = 0;
    double most = 0.0, least = 1.0;
    for (size_t i = 0; i < sea->pixels; i++) {
        const double v = (double)result->visibility[i];
        most = fmax(most, v);
        least = fmin(least, v);
        if (result->influence[i]) { /* no target: sqrt(V) of what was, and noise where V < 1 */
            assert_true(v <= 1.0 || fabs((double)result->image[i] - sqrt(v) * (double)pixels[i]) <
                                        1e-5 * sqrt(v));
            continue;
        }
        kept++;
        assert_true(result->visibility[i] == 1.0f);
        assert_memory_equal(&result->image[i], &pixels[i], sizeof(float));
    }
    assert_true(kept > sea->pixels / 3 && most > 2.0 && least < 1e-3);
}

static sonject_status try_relief(struct sea *sea)
{
    struct relief *relief = NULL;
    const struct footprint none = {0};
    const sonject_status status = relief_create(&relief, &sea->bench->report, &sea->bench->scene,
                                                sea_view(sea), 0.0, 0.0, &none);
    assert_null(relief);
    assert_null(strchr(sea_message(sea), '\n'));
    return status;
}

/* Refusals of a smooth seabed and of heights near the sonar are in
 * tests/unit/test_scene_relief.c. */
CLAIM(relief_that_is_refused)
{
    struct sea *sea = open_sea(1.0);
    sea_ready(sea);
    struct relief_feature *mound = bench_add_relief(sea->bench, RELIEF_MOUND);
    mound->radius_m = 0.5;
    mound->height_m = 1.0;
    EXPECT_REFUSED(sea, "degrees", try_relief(sea));
    mound->height_m = 0.1;
    mound->radius_m = 0.001;
    EXPECT_REFUSED(sea, "too fine", try_relief(sea));
    mound->kind = RELIEF_SCOUR;
    mound->width_m = 0.5;
    strcpy(mound->object, "nothing");
    EXPECT_REFUSED(sea, "no object has that name", try_relief(sea));
    sea->injection->mode = SONJECT_MODE_RESYNTHESISE;
    sea->seabed->map = SONJECT_MAP_COHERENT;
    EXPECT_REFUSED(sea, "level seabed", try_relief(sea));
}
