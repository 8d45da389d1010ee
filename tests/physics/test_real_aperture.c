/* Images of a sidescan: points, spheres, seabeds and noise as the array's beam shows them, and
 * shadows, which are those of pings. Their edges are as wide as the beam is. */
#include "sea.h"

#define ROWS       161
#define MIDDLE     80 /* row */
#define COLUMNS    61
#define WIDE       240
#define SPACING    0.05
#define ARRAY      0.5
#define WAVELENGTH 0.015
#define LEVEL_DB   0.2

static const double ranges[] = {20.0, 40.0, 60.0};

static struct sea *open_sidescan(size_t rows, size_t columns, double range)
{
    struct sea *sea = sea_open(rows, columns, range);
    sea->sonar->kind = SONJECT_SONAR_REAL;
    sea->sonar->array_length_m = ARRAY;
    sea->geometry->row_spacing_m = SPACING;
    sea->injection->ray_scale = 4.0;
    return sea;
}

/* Hangs a ball over the seabed, in the middle of the middle row. */
static void hang_ball(struct sea *sea, double range, double radius)
{
    place_in_metres(sea_add_sphere(sea, radius, 0.1), MIDDLE * SPACING, range);
    sea_ready(sea);
}

/* Returns the brightest column of the middle row. */
static size_t brightest_column(const struct image *image)
{
    const double complex *row = image->target + MIDDLE * image->columns;
    size_t at = 0;
    for (size_t column = 1; column < image->columns; column++)
        at = cabs(row[column]) > cabs(row[at]) ? column : at;
    return at;
}

/* Returns the two-way beam by its definition: the square of the array's amplitude pattern, and the
 * phase of the longer way. sine: of the way off broadside. longer: than the shortest way, m. */
static double complex beam_of(double sine, double longer)
{
    return pow(sinc(ARRAY * sine / WAVELENGTH), 2.0) * cexp(I * 4.0 * PI / WAVELENGTH * longer);
}

static double complex beam(double range, double x)
{
    const double distance = hypot(range, x);
    return beam_of(x / distance, distance - range);
}

/* Returns the full width where the squared magnitude is one half, m, by lines between rows. */
static double half_power_width(const struct image *image, size_t column)
{
    const double peak = cabs(image->target[MIDDLE * image->columns + column]);
    double width = 0.0;
    for (int side = -1; side <= 1; side += 2) {
        double here = 1.0, next = 1.0;
        int row = MIDDLE;
        while (next > 0.5) {
            row += side;
            here = next;
            next = pow(cabs(image->target[(size_t)row * image->columns + column]) / peak, 2.0);
        }
        width += abs(row - MIDDLE) - 1.0 + (here - 0.5) / (here - next);
    }
    return width * SPACING;
}

/* sinc(z)^4 = 1/2 at z = 0.31895, so the width is 0.638 range wavelength / length. A synthetic
 * aperture's point does not widen. */
CLAIM(a_point_widens_with_range)
{
    for (int i = 0; i < 6; i++) {
        const double distance = ranges[i % 3];
        struct sea *sea = open_sidescan(ROWS, COLUMNS, distance);
        if (i >= 3) {
            sea->sonar->kind = SONJECT_SONAR_SYNTHETIC;
            sea->sonar->along_track_resolution_m = 0.4;
        }
        hang_ball(sea, distance, 0.004);
        const double range = sea_slant_range(sea, 0);
        const struct image *image = sea_image(sea);
        const size_t column = brightest_column(image);
        print_message("%g m\n", distance);
        expect_close("half-power width, m", half_power_width(image, column),
                     i < 3 ? 2.0 * 0.31895 * range * WAVELENGTH / ARRAY : 0.8859 * 0.4, 0.01);
        double worst = 0.0;
        for (size_t row = 0; row < ROWS; row++)
            worst = fmax(worst, cabs(image->target[row * COLUMNS + column] /
                                         image->target[MIDDLE * COLUMNS + column] -
                                     beam(range, ((double)row - MIDDLE) * SPACING)));
        /* errors of strips of an eighth of a wavelength, 2e-3 of the peak's phase at the beam's
         * foot, and of the bins' range instead of the echo's */
        if (i < 3)
            expect_below("along-track cut less the beam", worst, 0.02);
    }
}

/* The integral of sinc(z)^4 is 2/3. */
CLAIM(the_resolution_that_is_told_is_the_beam_s)
{
    float *pixels = claim_memory(ROWS * COLUMNS, sizeof *pixels);
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        pixels[i] = 1.0f;
    for (int i = 0; i < 3; i++) {
        struct sea *sea = open_sidescan(ROWS, COLUMNS, ranges[i]);
        hang_ball(sea, ranges[i], 0.1);
        const double expected = 2.0 / 3.0 * ranges[i] * WAVELENGTH / ARRAY;
        expect_close("energy width of the beam, m",
                     sea_inject(sea, pixels, false)->statistics.along_track_resolution_m, expected,
                     0.01 * expected);
    }
}

/* Returns a turned array's beam at the ball's own place, by the cosine between the way and the long
 * side, ahead in the image's rows. side: +-1, the way along which rows run. */
static double complex turned_beam(const struct sea *sea, double x, double side)
{
    const double heading = sea->sonar->array_heading_rad, pitch = sea->sonar->array_pitch_rad;
    const double *ball = sea_centre(sea, 0);
    const double down = sea->sonar->altitude_m - ball[2];
    const double range = hypot(ball[1], down), distance = hypot(range, x);
    const double along = side * -x * cos(heading) * cos(pitch) +
                         ball[1] * sin(heading) * cos(pitch) - down * sin(pitch);
    return beam_of(along / distance, distance - range);
}

/* Pings ahead of a ball see it where the bow is turned towards the ball. Rows of the view run the
 * other way to starboard. */
CLAIM(a_turned_array_sees_a_point_from_elsewhere)
{
    for (int i = 0; i < 2; i++) {
        const double side = i ? -1.0 : 1.0;
        struct sea *sea = open_sidescan(ROWS, COLUMNS, 40.0);
        sea->geometry->side = i ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        sea->sonar->array_heading_rad = 0.006;
        sea->sonar->array_pitch_rad = -0.004;
        hang_ball(sea, 40.0, 0.004);
        assert_int_equal(sea_check_response(sea), SONJECT_OK);
        const struct image *image = sea_image(sea);
        const double complex *cut = image->target + brightest_column(image);
        const double complex middle = cut[MIDDLE * COLUMNS] / turned_beam(sea, 0.0, side);
        double worst = 0.0;
        size_t top = 0;
        for (size_t row = 0; row < ROWS; row++) {
            const double x = ((double)row - MIDDLE) * SPACING;
            worst = fmax(worst, cabs(cut[row * COLUMNS] / middle - turned_beam(sea, x, side)));
            top = cabs(cut[row * COLUMNS]) > cabs(cut[top * COLUMNS]) ? row : top;
        }
        expect_close("rows ahead of the ball", side * ((double)top - MIDDLE),
                     40.0 * (0.006 * cos(asin(0.25)) + 0.004 * 0.25) / SPACING, 0.6);
        /* as for an array along the track; a ball 10 cm high is seen 1e-5 rad elsewhere */
        expect_below("along-track cut less the turned beam", worst, 0.03);
    }
}

/* The glint is a/2 times the sphere's divergence r / (r + a). Columns 4 mm apart lose 0.08 dB. */
CLAIM(the_glint_of_a_sphere)
{
    for (int i = 0; i < 3; i++) {
        struct sea *sea = open_sidescan(ROWS, WIDE, ranges[i]);
        sea->geometry->column_spacing_m = 0.004;
        sea_move(sea, ranges[i]);
        hang_ball(sea, ranges[i], 0.15);
        const struct image *image = sea_image(sea);
        const double r = sea_slant_range(sea, 0);
        const double peak = cabs(image->target[MIDDLE * WIDE + brightest_column(image)]);
        expect_close("peak over a/2, dB", decibels_of_amplitude(peak / (0.075 * r / (r + 0.15))),
                     0.0, LEVEL_DB);
    }
}

/* Returns the autocorrelation of W over its energy: the correlation of speckle in pings a lag
 * apart. Far away it is the transform of sinc^4, the cubic spline at 2 lag / length. */
static double autocorrelation(double range, double lag)
{
    const double step = 0.002;
    double complex sum = 0.0;
    double energy = 0.0;
    for (int i = -4000; i < 4000; i++) {
        const double complex w = beam(range, i * step);
        sum += conj(w) * beam(range, i * step + lag);
        energy += pow(cabs(w), 2.0);
    }
    return creal(sum / energy);
}

/* Compares within 4 standard errors. Pixels are independent every 7 pings (0.35 m), 1.5 columns. */
static void expect_pings(const struct sea *sea, double range, const double complex *field)
{
    for (size_t lag = 2; lag <= 8; lag += 2) {
        const double error = 4.0 * sqrt(10.5 / (double)((ROWS - lag) * WIDE));
        const double complex measured = correlation_of(sea, field, lag, 0, 0);
        expect_close("correlation of pings", creal(measured),
                     autocorrelation(range, (double)lag * SPACING), error);
        expect_close("imaginary part", cimag(measured), 0.0, error);
    }
}

CLAIM(seabed_and_noise_have_the_beam)
{
    for (int i = 0; i < 3; i += 2) {
        struct sea *sea = open_sidescan(ROWS, WIDE, ranges[i]);
        sea->injection->ray_scale = 1.0;
        const struct image *image = sea_image_of(sea, NULL, true);
        const double error = 4.0 * sqrt(10.5 / (ROWS * WIDE));
        print_message("%g m\n", ranges[i]);
        /* integral of sinc^4: 2/3 range wavelength / length */
        expect_close("width of |W|^2 over theory",
                     cross_range_energy_width(sea_response(sea), ranges[i]) /
                         (2.0 / 3.0 * ranges[i] * WAVELENGTH / ARRAY),
                     1.0, 2e-3);
        /* rows near the edges miss 0.25 % of it, taps 0.1 %; 16 columns have the |W|^2 of one */
        expect_close("mean energy of the seabed, dB",
                     decibels_of_energy(level_over(sea, image, 0, 0, false, sea_seabed_level).mean),
                     0.0, 0.04);
        expect_close("speckle over it", level_over(sea, image, 0, 0, true, sea_seabed_level).mean,
                     1.0, error + 0.01);
        expect_pings(sea, ranges[i], unit_field(sea, image->seabed, image->seabed_energy));
        const double complex *noise = sea_noise(sea, NOISE_OF_IMAGE);
        expect_close("noise", creal(correlation_of(sea, noise, 0, 0, 0)), 1.0, error + 0.01);
        expect_pings(sea, ranges[i], noise);
    }
}

static void expect_response(struct sea *sea, double length, double heading, sonject_status expected)
{
    sea->sonar->array_length_m = length;
    sea->sonar->array_heading_rad = heading;
    sea_ready(sea);
    assert_int_equal(sea_check_response(sea), expected);
    if (expected != SONJECT_OK)
        print_message("%s\n", sea_message(sea));
}

/* Beams are refused if their range migration exceeds a quarter of the cell. It is 0.0509 r
 * (wavelength / length)^2, which is a quarter at a length of 0.333 m. */
CLAIM(beams_that_are_refused)
{
    struct sea *sea = open_sidescan(ROWS, COLUMNS, 60.0);
    expect_response(sea, 0.32, 0.0, SONJECT_ERROR_INPUT);
    expect_response(sea, 0.34, 0.0, SONJECT_OK);
    expect_response(sea, 0.34, 0.01, SONJECT_ERROR_INPUT);
    expect_response(sea, 1.0, 0.008, SONJECT_OK);
    sea->injection->interactions = 2;
    expect_response(sea, 1.0, 0.0, SONJECT_OK);
    expect_response(sea, 1.0, 0.008, SONJECT_ERROR_INPUT);
    sea->injection->interactions = 1;
    sea->injection->mode = SONJECT_MODE_RESYNTHESISE;
    expect_response(sea, 1.0, 0.008, SONJECT_ERROR_INPUT);
    sea->injection->mode = SONJECT_MODE_COMPOSITE;
    sea_add_mound(sea, 1.0, 0.2, 0.0);
    expect_response(sea, 1.0, 0.008, SONJECT_ERROR_INPUT);
}

/* ---- shadows ---- */

#define LONG_ROWS       241
#define LONG_COLUMNS    161
#define LONG_MIDDLE_ROW 120
#define SCREEN_M        3.0

static double place_of(size_t row)
{
    return ((double)row - LONG_MIDDLE_ROW) * SPACING;
}

/* Gives the visibility half-way down the shadow of an upright screen, a mean over columns that the
 * pulse joins. The screen, 1 m high, faces the middle row 1 m before the middle of the patch. */
static void line_behind_screen(struct sea *sea, double range, double line[LONG_ROWS])
{
    sonject_object_params *screen = sea_add(sea, SHAPE_PLANE, SCREEN_M, 2.0, 0.0);
    screen->roll_rad = 0.5 * PI;
    screen->burial_m = 1.0;
    place_in_metres(screen, LONG_MIDDLE_ROW * SPACING, range - 1.0);
    const double *visibility = visibility_of(sea_image(sea));
    for (size_t row = 0; row < LONG_ROWS; row++) {
        line[row] = 0.0;
        for (size_t k = LONG_COLUMNS / 2 - 4; k <= LONG_COLUMNS / 2 + 4; k++)
            line[row] += visibility[row * LONG_COLUMNS + k] / 9.0;
    }
}

/* Returns the share of its beam that a ping at x sees past a screen around 0, at the distance s.
 * The edge is as wide as the beam is there. */
static double expected_visibility(double x, double s)
{
    double seen = 0.0, all = 0.0;
    for (int i = 0; i < 4000; i++) {
        const double sine = 2.0 * WAVELENGTH / ARRAY * ((i + 0.5) / 2000.0 - 1.0);
        const double energy = pow(sinc(ARRAY * sine / WAVELENGTH), 4.0);
        seen += fabs(x + s * sine / sqrt(1.0 - sine * sine)) > 0.5 * SCREEN_M ? energy : 0.0;
        all += energy;
    }
    return seen / all;
}

/* Edges of shadows widen with range. A ping's energy of the bare seabed, over that of a strip, is
 * the integral of sinc^4, 2/3 of range wavelength / length, over the strip's width. 10^5 rays of
 * weights whose deviation is below their mean know it to 0.014 dB. */
CLAIM(shadows_and_pings_widen_with_range)
{
    static const double places[] = {25.0, 40.0, 55.0};
    for (int i = 0; i < 3; i++) {
        double line[LONG_ROWS], square = 0.0, sums[2] = {0.0, 0.0};
        struct sea *sea = open_sidescan(LONG_ROWS, LONG_COLUMNS, places[i]);
        line_behind_screen(sea, places[i], line);
        for (size_t row = 0; row < LONG_ROWS; row++)
            square += pow(line[row] - expected_visibility(place_of(row), places[i] - 1.0), 2.0);
        /* some 1200 stratified rays a point; a beam that is 15 % wider misses by more */
        expect_below("rms of visibility less expected", sqrt(square / LONG_ROWS), 0.008);
        sea = open_sidescan(LONG_ROWS, LONG_COLUMNS, places[i]);
        sea_ready(sea);
        for (int is_beam = 0; is_beam < 2; is_beam++) {
            const struct strips seabed =
                is_beam ? sea_rough_of(sea, true, NULL, NULL) : sea_rough(sea, NULL, NULL);
            const int middle = LONG_COLUMNS / 2 * seabed.bins_per_pixel - seabed.first_bin;
            for (int strip = 0; strip < seabed.strips; strip++)
                sums[is_beam] +=
                    sum_of(seabed.energy + strip * seabed.bins + middle - 20, 41) / seabed.strips;
        }
        expect_close("ping over strip, dB", decibels_of_energy(sums[1] / sums[0]),
                     decibels_of_energy(2.0 / 3.0 * places[i] * WAVELENGTH / ARRAY / SPACING),
                     0.06);
    }
}

/* A turned array sees the screen from the place where the middle of its beam meets the screen.
 * Heading turns the bow towards the imaged side, and the beam backwards. So pings that see the
 * screen are ahead of it, which to starboard is before it in the view's rows. The long side has a
 * cosine off the slant plane, so x goes by ground range. Columns are 1 m behind the screen. */
CLAIM(heading_moves_shadows)
{
    for (int i = 0; i < 2; i++) {
        double width = 0.0, middle = 0.0, line[LONG_ROWS];
        struct sea *sea = open_sidescan(LONG_ROWS, LONG_COLUMNS, 40.0);
        sea->geometry->side = i ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        sea->sonar->array_heading_rad = 0.08;
        line_behind_screen(sea, 40.0, line);
        for (size_t row = 0; row < LONG_ROWS; row++) {
            width += (1.0 - line[row]) * SPACING;
            middle += (1.0 - line[row]) * SPACING * place_of(row);
        }
        expect_close("shadow's width, m", width, SCREEN_M, 0.05);
        expect_close("shadow's middle, m", middle / width,
                     (i ? -1.0 : 1.0) * sqrt(39.0 * 39.0 - 100.0) * tan(0.08), 0.03);
    }
}
