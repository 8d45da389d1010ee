/* A synthetic aperture sees shadows from all its aspects. Penumbrae are wider and shadows brighter
 * the farther the target is. Echoes are imaged at their true places. */
#include "sea.h"

#define ROWS          241
#define COLUMNS       401
#define MIDDLE_ROW    120
#define ROW_SPACING   0.025                       /* m, and the resolution */
#define SLOPE         (0.015 / (2 * ROW_SPACING)) /* of the aspects' sines: lambda / 2 delta */
#define RANGE         44.0
#define GROUND        40.0 /* ground range of a screen, m */
#define SCREEN_HEIGHT 1.8  /* m */

/* Opens a patch whose middle column is at a range, seen from the aspects of its response. */
static struct sea *open_aperture(double range_m, uint32_t window, double ray_scale)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, range_m);
    sea->geometry->row_spacing_m = ROW_SPACING;
    sea->sonar->aperture_rad = -1.0;
    sea->sonar->response_window = window;
    sea->injection->ray_scale = ray_scale;
    return sea;
}

/* Returns the visibility of every pixel behind an upright screen, which stands along the track in
 * the middle row, with its foot at a ground range. */
static const double *behind_screen(struct sea *sea, double width_m, double height_m,
                                   double ground_range_m)
{
    sonject_object_params *screen = sea_add(sea, SHAPE_PLANE, width_m, 2.0 * height_m, 0.0);
    screen->roll_rad = 0.5 * PI;
    screen->burial_m = height_m;
    sea_ready(sea);
    place_in_pixels(screen, MIDDLE_ROW,
                    sea_column(sea, hypot(ground_range_m, sea->sonar->altitude_m)));
    return visibility_of(sea_image(sea));
}

/* Returns the energy window of the aspects at an offset within one period. */
static double window_energy(uint32_t window, double offset)
{
    return window == SONJECT_WINDOW_HAMMING ? pow(0.54 + 0.46 * cos(2.0 * PI * offset), 2.0) : 1.0;
}

/* Returns the visibility at x along the track behind a screen of `width` around 0, at a distance d
 * behind it in the plane across the track. It is the share of aspects whose path passes beside the
 * screen, at x - d tan(aspect). By Lambert's law each aspect has the square of its cosine. */
static double expected_visibility(double x, double width, double d, uint32_t window)
{
    const int steps = 4000;
    double seen = 0.0, all = 0.0;
    for (int i = 0; i < steps; i++) {
        const double offset = (i + 0.5) / steps - 0.5, sine = SLOPE * offset;
        const double energy = window_energy(window, offset) * (1.0 - sine * sine);
        const double at_screen = x - d * sine / sqrt(1.0 - sine * sine);
        seen += fabs(at_screen) > 0.5 * width ? energy : 0.0;
        all += energy;
    }
    return seen / all;
}

/* Return the distance from the screen to a column's seabed, along the path in the plane across the
 * track, and the first column at least that far behind the screen. */
static double distance_behind(const struct sea *sea, size_t column, double screen_ground)
{
    const double range = sea_range(sea, (double)column), ground = sea_ground(sea, range);
    return (ground - screen_ground) * range / ground;
}

static size_t column_behind(const struct sea *sea, double screen_ground, double distance)
{
    size_t column = 0;
    while (column + 1 < COLUMNS && distance_behind(sea, column, screen_ground) < distance)
        column++;
    return column;
}

/* Returns the mean over nine columns of a row, which the pulse joins anyway. */
static double visibility_at(const double *visibility, size_t row, size_t column)
{
    double mean = 0.0;
    for (size_t k = column - 4; k <= column + 4; k++)
        mean += visibility[row * COLUMNS + k] / 9.0;
    return mean;
}

/* Visibility is linear across a penumbra d * wavelength / (2 resolution) wide at a distance d
 * behind the screen; a Hamming window's square narrows it. The line's own kinks, smoothed over a
 * few pixels, and 70 rays a point, stratified, leave less than 0.015. A penumbra a tenth wider
 * would miss by 0.02 or more. Behind a screen of width w the core closes where the aspects look
 * around both of its ends, at 2 w resolution / wavelength. At d beyond that, the share of lit
 * aspects is 1 less that length over d, and the shadow fades. The tangent's growth over the sine's
 * and cos^2 are below 0.02.
 *
 * Screens of half a metre are seen at other ranges, at 0.6 of the shadow's length behind them. A
 * ramp of visibility v from 0 to 1 is six times the integral of v (1 - v) wide. Here the integral
 * holds both edges of a screen wider than its penumbrae, in rows that hold nothing else. 560 rays a
 * point leave an rms below 0.01, which takes 6 x 10^-4 off the width. Rows of 2.5 cm add less than
 * 0.01. */
CLAIM(shadows_are_those_of_the_aspects)
{
    static const struct {
        double range, ground, width, height, rays, first, last, step; /* m behind the screen */
        uint32_t window;
    } cases[] = {
        {RANGE, GROUND, 2.0, SCREEN_HEIGHT, 4.0, 1.0, 1.0, 1.0, SONJECT_WINDOW_RECTANGULAR},
        {RANGE, GROUND, 2.0, SCREEN_HEIGHT, 4.0, 3.0, 6.0, 3.0, SONJECT_WINDOW_RECTANGULAR},
        {RANGE, GROUND, 2.0, SCREEN_HEIGHT, 4.0, 1.0, 1.0, 1.0, SONJECT_WINDOW_HAMMING},
        {RANGE, GROUND, 2.0, SCREEN_HEIGHT, 4.0, 3.0, 6.0, 3.0, SONJECT_WINDOW_HAMMING},
        {RANGE, GROUND, 0.6, SCREEN_HEIGHT, 4.0, 0.5, 6.0, 0.5, SONJECT_WINDOW_RECTANGULAR},
        {25.0, 0.0, 2.0, 0.5, 16.0, 0.0, 0.0, 1.0, SONJECT_WINDOW_RECTANGULAR},
        {60.0, 0.0, 2.0, 0.5, 16.0, 0.0, 0.0, 1.0, SONJECT_WINDOW_RECTANGULAR},
        {150.0, 0.0, 2.0, 0.5, 16.0, 0.0, 0.0, 1.0, SONJECT_WINDOW_RECTANGULAR},
        {25.0, 0.0, 0.24, 0.5, 16.0, 0.0, 0.0, 1.0, SONJECT_WINDOW_RECTANGULAR},
        {60.0, 0.0, 0.24, 0.5, 16.0, 0.0, 0.0, 1.0, SONJECT_WINDOW_RECTANGULAR},
        {150.0, 0.0, 0.24, 0.5, 16.0, 0.0, 0.0, 1.0, SONJECT_WINDOW_RECTANGULAR},
    };
    double faded = -1.0;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const bool is_low = cases[i].ground == 0.0;
        const double width = cases[i].width, near = cases[i].range - 4.0;
        const double ground = is_low ? sqrt(near * near - 100.0) : cases[i].ground;
        struct sea *sea = open_aperture(cases[i].range, cases[i].window, cases[i].rays);
        const double *visibility = behind_screen(sea, width, cases[i].height, ground);
        for (double at = cases[i].first; at <= cases[i].last; at += cases[i].step) {
            /* length of a low screen's shadow along the ray: the way to the screen's foot times its
             * height over the rest of the altitude */
            const size_t column = column_behind(
                sea, ground, is_low ? 0.6 * cases[i].height / (10.0 - cases[i].height) * near : at);
            const double d = distance_behind(sea, column, ground);
            double square = 0.0, integral = 0.0;
            for (size_t row = 0; row < ROWS; row++) {
                const double x = ((double)row - MIDDLE_ROW) * ROW_SPACING;
                const double v = visibility_at(visibility, row, column);
                square += pow(v - expected_visibility(x, width, d, cases[i].window), 2.0);
                integral += v * (1.0 - v) * ROW_SPACING;
            }
            const double seen = visibility_at(visibility, MIDDLE_ROW, column);
            print_message("%.0f m, %.2f m behind the screen of %.2f m, penumbra %.2f m\n",
                          cases[i].range, d, width, d * SLOPE);
            expect_below("rms of visibility less expected", sqrt(square / ROWS), 0.015);
            if (width < 1.0)
                expect_close("visibility in the middle", seen, fmax(0.0, 1.0 - width / SLOPE / d),
                             is_low ? 0.03 : 0.04);
            else if (is_low)
                expect_close("width of the penumbra over the geometry's",
                             0.5 * 6.0 * integral / (d * SLOPE), 1.0, 0.03);
            if (width < 1.0 && is_low) { /* contrast falls as the shadow grows with range */
                assert_true(seen > faded);
                faded = seen;
            }
        }
    }
}

/* The noise of a pixel's visibility with the default rays, largest in the middle of a penumbra. */
CLAIM(noise_amid_a_penumbra)
{
    struct sea *sea = open_aperture(RANGE, SONJECT_WINDOW_RECTANGULAR, 1.0);
    const double *visibility = behind_screen(sea, 2.0, SCREEN_HEIGHT, GROUND);
    double square = 0.0;
    size_t count = 0;
    for (size_t column = column_behind(sea, GROUND, 3.0); column < column_behind(sea, GROUND, 6.0);
         column++)
        for (size_t row = 0; row < ROWS; row++) {
            const double expected = expected_visibility(((double)row - MIDDLE_ROW) * ROW_SPACING,
                                                        2.0, distance_behind(sea, column, GROUND),
                                                        SONJECT_WINDOW_RECTANGULAR);
            if (expected < 0.2 || expected > 0.8)
                continue;
            square += pow(visibility[row * COLUMNS + column] - expected, 2.0);
            count++;
        }
    assert_true(count > 1000);
    /* some 9 rays a pixel would leave 0.16 without strata; the standard deviation of speckle is 1
     * of the mean intensity */
    expect_below("rms noise of visibility", sqrt(square / (double)count), 0.1);
}

/* Lambert's law at an aspect has the square of the aspect's cosine, 1 - sine^2/3 on the mean of
 * all. A squared Hamming window has its own mean of sine^2. 10^6 rays have stratified weights. */
CLAIM(the_seabeds_level_over_aspects)
{
    double sums[2], weights = 0.0, squares = 0.0;
    for (int is_on = 0; is_on < 2; is_on++) {
        struct sea *sea = open_aperture(RANGE, SONJECT_WINDOW_HAMMING, 1.0);
        sea->sonar->aperture_rad = is_on ? -1.0 : 0.0;
        sums[is_on] = sum_of(sea_image(sea)->seabed_energy, sea->pixels);
    }
    for (int i = 0; i < 1000; i++) {
        const double offset = (i + 0.5) / 1000.0 - 0.5;
        weights += window_energy(SONJECT_WINDOW_HAMMING, offset);
        squares += window_energy(SONJECT_WINDOW_HAMMING, offset) * pow(SLOPE * offset, 2.0);
    }
    expect_close("level, dB", decibels_of_energy(sums[1] / sums[0]),
                 decibels_of_energy(1.0 - squares / weights), 0.002);
}

/* A rough sphere of 1 cm stays in its own strip at every height and has the energy that it has from
 * broadside. All rays that meet the sphere count, also from beyond the patch's ends. */
CLAIM(a_highlight_stays_where_it_is)
{
    static const double heights[] = {0.0, 1.5};
    static const double rows[] = {MIDDLE_ROW, 1.0};
    for (size_t i = 0; i < 2; i++) {
        struct tile_sums sums[2];
        for (int is_on = 0; is_on < 2; is_on++) {
            struct strips tile;
            struct sea *sea = open_aperture(RANGE, SONJECT_WINDOW_RECTANGULAR, 64.0);
            sea->sonar->aperture_rad = is_on ? -1.0 : 0.0;
            sonject_object_params *sphere = sea_add_sphere(sea, 0.01, heights[i]);
            make_rough(sphere, 0.2);
            place_in_pixels(sphere, rows[i], 200.0);
            sea_rough(sea, &sums[is_on], &tile);
            const double of_sphere = (sea_centre(sea, 0)[0] - sea_x(sea, 0.0)) / ROW_SPACING;
            /* the sphere reaches 0.4 strips to each side of its centre */
            for (int strip = 0; strip < tile.strips; strip++)
                assert_true(fabs(tile.first_strip + strip - of_sphere) <= 0.9 ||
                            sum_of(tile.energy + strip * tile.bins, (size_t)tile.bins) == 0.0);
        }
        print_message("%.1f m over the seabed: ", heights[i]);
        /* in some 160 strata of elevation 0.6 rays each meet the sphere on the mean, by chance
         * along the track: errors of 0.065 each, and four standard errors of the ratio */
        expect_close("energy over that from broadside", sums[1].energy / sums[0].energy, 1.0, 0.37);
    }
}

/* Rays meet a steep mound, a quarter of a metre high, well before the mean seabed and in other
 * strips than their own. The image must show the mound at its true place. */
CLAIM(relief_stays_where_it_is)
{
    double lines[2][ROWS], difference = 0.0, brightness = 0.0;
    for (int is_on = 0; is_on < 2; is_on++) {
        struct sea *sea = open_aperture(RANGE, SONJECT_WINDOW_RECTANGULAR, 2.0);
        sea->sonar->aperture_rad = is_on ? -1.0 : 0.0;
        sea_add_mound(sea, 0.25, 0.25, 0.0);
        sea_ready(sea);
        /* the bright side towards the sonar, without the shadow behind */
        const float *energy = sea_image(sea)->seabed_energy;
        for (size_t row = 0; row < ROWS; row++)
            lines[is_on][row] = sum_of(energy + row * COLUMNS + 150, 198 - 150);
    }
    for (size_t row = 0; row < ROWS; row++) {
        difference += fabs(lines[1][row] - lines[0][row]);
        brightness += fabs(lines[0][row] - lines[0][0]);
    }
    /* aspects light the flanks a little differently: 0.07. Echoes in the rays' own strips, up to 17
     * cm to each side, would differ by 0.22 */
    expect_below("difference over the mound's own brightness", difference / brightness, 0.1);
}
