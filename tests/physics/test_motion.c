/* Images of a synthetic aperture whose sonar leaves its track, and images with a measured
 * cross-range response. */
#include "scene/motion_response.h"
#include "sea.h"

#define ROWS       161
#define COLUMNS    41
#define SPACING    0.0125
#define RESOLUTION 0.05
#define RANGE      50.0
#define MIDDLE     80
#define LEVEL_DB   0.2

/* Opens a ball, far smaller than any resolution, over the middle row. Side lobes are at -43 dB, or
 * at -70 dB where the former would move an echo at -20 dB by 0.13 resolutions. */
static struct sea *open_aperture(bool has_low_lobes)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sea->geometry->row_spacing_m = SPACING;
    sea->sonar->along_track_resolution_m = RESOLUTION;
    sea->sonar->response_window = has_low_lobes ? SONJECT_WINDOW_TAYLOR : SONJECT_WINDOW_HAMMING;
    if (has_low_lobes) {
        sea->sonar->taylor_sidelobe_db = 70.0;
        sea->sonar->taylor_terms = 10;
    }
    place_in_metres(sea_add_sphere(sea, 0.004, 0.1), MIDDLE * SPACING, RANGE);
    sea->injection->ray_scale = 4.0;
    sea_ready(sea);
    return sea;
}

static const struct point_response *response_of(const struct sea *sea)
{
    return &sea->bench->tracer.response;
}

/* Returns the along-track cut through the ball, in the brightest column, over `straight`. */
static const double complex *cut_through(struct sea *sea, double complex straight)
{
    double complex *cut = claim_memory(ROWS, sizeof *cut);
    double most = 0.0;
    assert_true(cabs(straight) > 0.0);
    const struct image *image = sea_image(sea);
    for (size_t column = 0; column < COLUMNS; column++) {
        double energy = 0.0;
        for (size_t row = 0; row < ROWS; row++)
            energy += pow(cabs(image->target[row * COLUMNS + column]), 2.0);
        for (size_t row = 0; row < ROWS && energy > most; row++)
            cut[row] = image->target[row * COLUMNS + column] / straight;
        most = fmax(most, energy);
    }
    return cut;
}

/* Returns the middle of the cut on a straight track. */
static double complex middle_of(struct sea *sea)
{
    return cut_through(sea, 1.0)[MIDDLE];
}

static double cosine_of_grazing(const struct sea *sea)
{
    return cos(sea_grazing(sea, sea_range(sea, 0.5 * (COLUMNS - 1))));
}

/* Returns the height of a parabola through the largest of some rows, and its place in *row. */
static double peak_between(const double complex *cut, size_t first, size_t last, double *row)
{
    size_t top = first;
    for (size_t i = first; i <= last; i++)
        if (cabs(cut[i]) > cabs(cut[top]))
            top = i;
    const double a = cabs(cut[top - 1]);
    const double b = cabs(cut[top]);
    const double c = cabs(cut[top + 1]);
    const double shift = 0.5 * (a - c) / (a - 2.0 * b + c);
    *row = (double)top + shift;
    return b - 0.25 * (a - c) * shift;
}

/* Compares the place of lobe m of the cut, and its level. */
static void expect_lobe(const double complex *cut, double m, double spacing, double level)
{
    const double expected = MIDDLE + m * spacing / SPACING;
    double row;
    const double peak = peak_between(cut, (size_t)(expected - 3.0), (size_t)(expected + 3.0), &row);
    /* the tangent of an aspect is up to 0.3 % above the sine */
    expect_close("place of the lobe, resolutions", (row - expected) * SPACING / RESOLUTION, 0.0,
                 0.02);
    expect_close("level of the lobe, dB", decibels_of_amplitude(peak / level), 0.0, LEVEL_DB);
}

/* exp(i beta sin) is a sum of harmonics of the amplitudes J_m(beta), Bessel functions. Each moves W
 * by wavelength range / (2 wavelength of the sway) from the one before. */
CLAIM(a_sway_makes_paired_echoes)
{
    const double beta = 0.2, away = 1.5; /* J0 0.99002497, J1 0.09950083 */
    struct sea *sea = open_aperture(true);
    const double complex straight = middle_of(sea);
    sea->motion->sway_count = 1;
    sea->motion->sways[0].amplitude = beta / (2.0 * sea_wavenumber(sea) * cosine_of_grazing(sea));
    sea->motion->sways[0].wavelength_m = away;
    sea->motion->sways[0].phase_rad = 0.7;
    const double complex *cut = cut_through(sea, straight);
    const double spacing = sea_wavelength(sea) * response_of(sea)->motion_range_m / (2.0 * away);
    for (int m = -1; m <= 1; m++)
        expect_lobe(cut, m, spacing, m == 0 ? 0.99002497 : 0.09950083);
}

/* Returns the response that motion gives a row of the image, at places `spacing` apart. */
static const double complex *row_of_response(struct sea *sea, double spacing, double row, int reach,
                                             bool is_all_around)
{
    const size_t count = 2 * (size_t)reach + 1;
    double *parts = claim_memory(2 * count, sizeof *parts);
    double complex *values = claim_memory(count, sizeof *values);
    struct motion_response motion;
    assert_int_equal(motion_response_begin(&motion, &sea->bench->report, response_of(sea),
                                           &sea->bench->tracer.view, spacing, 0.0, reach),
                     SONJECT_OK);
    (is_all_around ? motion_response_row_all_around : motion_response_row)(&motion, row, parts,
                                                                           parts + count);
    motion_response_end(&motion);
    for (size_t i = 0; i < count; i++)
        values[i] = parts[i] + I * parts[count + i];
    return values;
}

/* A constant yaw makes the sway a sawtooth, as long as the pings' advance A. The phases have the
 * period A and the harmonics c_m = sinc(m + 2 yaw A cos(grazing) / wavelength). Each moves W by -m
 * wavelength range / 2A, to the lobes of a grating of this spacing. The higher one of the two
 * beside the main lobe is on the side where the array looks. Lobes leave the beam of elements of 2
 * delta, whose zero is where lobe A/delta lies. delta is such that each lobe lies at a zero of all
 * others. The beam leaves the mean over |v| < 1/2 of sinc(v + t)^2 / sinc(v)^2, t = m delta/A. For
 * whole t that is the mean of v^2 / (v + t)^2. */
CLAIM(lobes_leave_the_elements_beam)
{
    enum {
        PINGS_ADVANCE = 8, /* resolutions */
        APART = 5,         /* spacing of lobes, resolutions */
        STRIPS = 2,        /* strips in a resolution */
        LAST = 8,
        REACH = LAST * APART * STRIPS
    };
    static const struct {
        int lobe;
        double left;
    } lobes[] = {
        {-8, 0.1361087}, /* 1 - 2 ln 3 + 4/3 */
        {-1, 0.9732098}, /* by the midpoint rule, and so for lobe 4 */
        {0, 1.0},        {4, 0.6380988}, {8, 0.1361087},
    };
    const double steps = 0.3;
    struct sea *sea = open_aperture(false);
    const double wavelength = sea_wavelength(sea);
    const double range = 0.5 * (sea_range(sea, 0.0) + sea_range(sea, COLUMNS - 1.0));
    const double resolution = sqrt(wavelength * range / (2.0 * PINGS_ADVANCE * APART));
    sea->sonar->along_track_resolution_m = resolution;
    sea->sonar->response_window = SONJECT_WINDOW_RECTANGULAR;
    sea->motion->yaw_advance_m = PINGS_ADVANCE * resolution;
    sea->motion->yaw_bias_rad =
        steps * wavelength / (2.0 * PINGS_ADVANCE * resolution * cosine_of_grazing(sea));
    sea_ready(sea);
    const double complex *row = row_of_response(sea, resolution / STRIPS, MIDDLE, REACH, false);
    for (size_t i = 0; i < COUNT(lobes); i++) {
        const double expected = fabs(sinc(lobes[i].lobe + steps)) * lobes[i].left;
        print_message("lobe %d: ", lobes[i].lobe);
        expect_close(
            "level over what the elements leave, dB",
            decibels_of_amplitude(cabs(row[REACH - lobes[i].lobe * APART * STRIPS]) / expected),
            0.0, LEVEL_DB);
    }
}

/* Returns the energy that elements of two resolutions hear of a point, over that of the pixel
 * `distance` from it: the mean over aspects with Hamming's weights. */
static double heard_share(const struct sea *sea, double distance)
{
    enum {
        STEPS = 200
    };
    const double aside = 2.0 * RESOLUTION / sea_wavelength(sea) *
                         sin(atan(distance / response_of(sea)->motion_range_m));
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double v = (i + 0.5) / STEPS - 0.5;
        sum +=
            (0.54 + 0.46 * cos(2.0 * PI * v)) / 0.54 / STEPS * pow(sinc(v + aside) / sinc(v), 2.0);
    }
    return sum;
}

/* Returns W of a row by its definition, the mean over aspects, over the peak of the straight W. */
static double complex moved_response(const struct sea *sea, double row, double distance,
                                     double (*sway)(double))
{
    enum {
        STEPS = 20000
    };
    const double k = sea_wavenumber(sea);
    const double steepest = PI / k / (2.0 * RESOLUTION); /* wavelength / 4 resolution */
    const double range = response_of(sea)->motion_range_m;
    const double heard = heard_share(sea, distance);
    double complex sum = 0.0;
    double total = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double v = (i + 0.5) / STEPS - 0.5;
        const double sine = 2.0 * v * steepest;
        const double weight = 0.54 + 0.46 * cos(2.0 * PI * v);
        const double place = row * SPACING + range * tan(asin(sine));
        const double error =
            -2.0 * k * cosine_of_grazing(sea) * sqrt(1.0 - sine * sine) * sway(place);
        sum +=
            weight * (1.0 + heard * (cexp(I * error) - 1.0)) * cexp(I * 2.0 * k * sine * distance);
        total += weight;
    }
    return sum / total;
}

static double parabola(double x)
{
    return 0.6e-3 * (x - 1.3) * (x - 1.3);
}

static void give_sway(struct sea *sea, double (*sway)(double))
{
    double x[2001], y[2001];
    for (int i = 0; i < 2001; i++) {
        x[i] = -8.0 + 0.01 * i;
        y[i] = sway(x[i]);
    }
    assert_int_equal(
        motion_table_set(&sea->bench->scene.motion.sway_table, &sea->bench->report, x, y, COUNT(x)),
        SONJECT_OK);
}

#define ADVANCE 0.4

static double yaw_of_ping(double x)
{
    return 8e-3 * sin(2.0 * PI * x / 1.7 + 0.4) - 2e-3;
}

/* Returns the sway of phase centres by that yaw, of which each ping has its own. */
static double sway_of_a_yaw(double x)
{
    const double ping = floor(x / ADVANCE + 0.5) * ADVANCE;
    return yaw_of_ping(ping) * (x - ping);
}

static void give_yaw(struct sea *sea)
{
    sea->motion->yaw_advance_m = ADVANCE;
    sea->motion->yaw_bias_rad = -2e-3;
    sea->motion->yaw_count = 1;
    sea->motion->yaws[0].amplitude = 8e-3;
    sea->motion->yaws[0].wavelength_m = 1.7;
    sea->motion->yaws[0].phase_rad = 0.4;
}

/* Compares the cut with the mean over aspects with the sway's phase. The tolerance is for the two
 * strips of 3 mm that hold the ball. The cut's peak must be lower than `highest`. */
static void expect_moved(struct sea *sea, double complex straight, double (*sway)(double),
                         double highest)
{
    const double complex *cut = cut_through(sea, straight);
    double worst = 0.0, brightest = 0.0;
    for (int row = 0; row < ROWS; row++) {
        const double away = (row - MIDDLE) * SPACING;
        worst = fmax(worst, cabs(cut[row] - moved_response(sea, row, away, sway)));
        brightest = fmax(brightest, cabs(cut[row]));
    }
    assert_true(brightest < highest);
    expect_below("cut less the transform", worst, 0.01);
}

CLAIM(sway_and_yaw_turn_each_aspects_phase)
{
    struct sea *sea = open_aperture(false);
    const double complex straight = middle_of(sea);
    give_sway(sea, parabola);
    expect_moved(sea, straight, parabola, 0.7);
    sea = open_aperture(false);
    give_yaw(sea);
    expect_moved(sea, straight, sway_of_a_yaw, 0.95);
}

/* Returns the way from the transmitter in the array's middle to a point of the seabed, at x along
 * the track, and back to the hydrophone at e on the array. */
static double way_of(const struct sea *sea, double ping, double e, double yaw, double x)
{
    const double range = response_of(sea)->motion_range_m;
    const double height = sea->sonar->altitude_m;
    const double across = sqrt(range * range - height * height) - e * sin(yaw);
    const double along = x - (ping + e * cos(yaw));
    return sqrt(range * range + (x - ping) * (x - ping)) +
           sqrt(along * along + across * across + height * height);
}

/* Returns the amplitude of a point `distance` before the pixel, from all hydrophones of all pings
 * of the aperture, focused as if the array had kept its heading. Each hears alike all around. */
static double heard_amplitude(const struct sea *sea, double pixel, double distance)
{
    enum {
        HYDROPHONES = 200
    };
    const double k = sea_wavenumber(sea);
    const double range = response_of(sea)->motion_range_m;
    const double steepest = PI / k / (2.0 * RESOLUTION);
    double complex sum = 0.0;
    double total = 0.0;
    for (int p = -20; p <= 20; p++)
        for (int i = 0; i < HYDROPHONES; i++) {
            const double ping = (floor(pixel / ADVANCE) + p) * ADVANCE;
            const double e = ((i + 0.5) / HYDROPHONES - 0.5) * 2.0 * ADVANCE;
            const double sine = sin(atan((ping + 0.5 * e - pixel) / range));
            if (fabs(sine) > steepest)
                continue;
            /* weights are even in the sine */
            const double weight =
                (0.54 + 0.46 * cos(PI * sine / steepest)) * pow(1.0 - sine * sine, 1.5);
            const double way = way_of(sea, ping, e, yaw_of_ping(ping), pixel - distance) -
                               way_of(sea, ping, e, 0.0, pixel);
            sum += weight * cexp(I * k * way);
            total += weight;
        }
    return cabs(sum) / total;
}

/* Yaw gives a row the response of hydrophones at their true places, but for their beam. */
CLAIM(yaw_is_what_hydrophones_hear)
{
    const int reach = 100;
    struct sea *sea = open_aperture(false);
    give_yaw(sea);
    sea_ready(sea);
    double worst = 0.0, straight = 0.0;
    for (int row = 7; row < ROWS; row += 50) {
        const double complex *response = row_of_response(sea, SPACING, row, reach, true);
        for (int j = -reach; j <= reach; j += 3) {
            const double heard = heard_amplitude(sea, row * SPACING, j * SPACING);
            worst = fmax(worst, fabs(heard - cabs(response[j + reach])));
            straight = fmax(straight, fabs(heard - sea_window(sea, j * SPACING)));
        }
    }
    assert_true(straight > 0.1); /* a straight track's response would fail */
    /* hydrophones 4 mm apart; at x beside the pixel ranges are curved: k x^2 aspect^2 / r */
    expect_below("response less what hydrophones hear", worst, 0.004);
}

static double wander(double x)
{
    return 1e-3 * sin(1.7 * x) + 4e-4 * cos(5.1 * x + 0.3);
}

static double wander_of_starboard(double x)
{
    return wander(160 * SPACING - x);
}

/* Taps and margins leave out 0.6 % of the energy. */
static void expect_level_of_seabed(struct sea *sea)
{
    const struct image *image = sea_image_of(sea, NULL, true);
    expect_close("mean energy of the seabed, dB",
                 decibels_of_energy(level_over(sea, image, 0, 0, false, sea_seabed_level).mean),
                 0.0, 0.04);
}

/* Motion changes neither the energy of a row's response nor the seabed's level, but for the share
 * that the elements' beam leaves out. */
CLAIM(motion_keeps_energy)
{
    const int reach = 3000;
    struct sea *sea = open_aperture(false);
    give_sway(sea, wander);
    sea->motion->random_rms_m = 1e-3;
    sea_ready(sea);
    double heard = 0.0;
    for (int i = 0; i < 2 * ((ROWS + 39) / 40); i++) {
        const double complex *row = row_of_response(sea, SPACING, i / 2 * 40, reach, i % 2);
        double energy = 0.0;
        for (int k = 0; k < 2 * reach + 1; k++)
            energy += SPACING * pow(cabs(row[k]), 2.0) / sea_window_energy(sea);
        if (i % 2)
            expect_close("energy of a row's response", energy, 1.0, 1e-3);
        else
            heard += energy / 5.0;
    }
    assert_true(heard < 0.9995);
    expect_close("share that elements hear", response_of(sea)->motion_energy_share, heard, 2e-4);
    expect_level_of_seabed(sea);
}

/* Starboard is port reversed. The bow is at the other end, and pings lie at the same places. */
CLAIM(starboard_is_port_reversed)
{
    const double complex *cuts[2];
    double worst = 0.0;
    for (int side = 0; side < 2; side++) {
        struct sea *sea = open_aperture(false);
        sea->geometry->side = side ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        const double complex straight = middle_of(sea);
        give_sway(sea, side ? wander_of_starboard : wander);
        sea->motion->yaw_advance_m = 0.25;
        sea->motion->yaw_bias_rad = side ? -0.02 : 0.02;
        cuts[side] = cut_through(sea, straight);
    }
    for (int row = 0; row < ROWS; row++)
        worst = fmax(worst, cabs(cuts[0][row] - cuts[1][row]));
    expect_below("port less starboard", worst, 1e-3);
}

/* Motion is refused if its sway turns sound by more than the aspects, so that no response is long
 * enough, if its yaw has too many pings, or if it is too fast to be followed. */
CLAIM(motion_that_is_refused)
{
    static const double x[] = {0.0, 1.0}, yaw[] = {1e-3, 2e-3};
    struct sea *sea = open_aperture(false);
    sea->motion->random_rms_m = 1e-3;
    assert_int_equal(sea_check_response(sea), SONJECT_OK);
    sea->motion->random_rms_m = 10.0;
    EXPECT_REFUSED(sea, "reduce it", sea_check_response(sea));
    sea->motion->random_rms_m = 0.0;
    assert_int_equal(
        motion_table_set(&sea->bench->scene.motion.yaw_table, &sea->bench->report, x, yaw, 2),
        SONJECT_OK);
    sea->motion->yaw_advance_m = 0.5;
    assert_int_equal(sea_check_response(sea), SONJECT_OK);
    sea->motion->yaw_advance_m = 1e-4;
    EXPECT_REFUSED(sea, "aspects", sea_check_response(sea));
    sea->motion->yaw_advance_m = 0.5;
    sea->bench->tracer.view.rows = 1000000000;
    EXPECT_REFUSED(sea, "pings", sea_check_response(sea));
    sea->motion->random_rms_m = 1e-3;
    EXPECT_REFUSED(sea, "steps of the sway", sea_check_response(sea));
}

/* The random sway has its autocorrelation, on an average over seeds. */
CLAIM(a_random_sways_autocorrelation)
{
    enum {
        SEEDS = 4000
    };
    double sums[3] = {0.0, 0.0, 0.0};
    struct aperture_motion motion;
    memset(&motion, 0, sizeof motion);
    motion.params.random_rms_m = 2.0;
    motion.params.random_correlation_m = 3.0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        double sway[3];
        motion.params.seed = seed;
        aperture_motion_sway(&motion, 10.0, 3.0, 3, sway);
        for (int i = 0; i < 3; i++)
            sums[i] += sway[0] * sway[i] / 4.0 / SEEDS;
    }
    /* a product of unit normal deviates has variance 1 + correlation^2 */
    for (int i = 0; i < 3; i++) {
        const double expected = exp(-0.5 * i * i);
        expect_close("autocorrelation", sums[i], expected,
                     4.0 * sqrt((1.0 + expected * expected) / SEEDS));
    }
}

/* Returns a response that is neither even nor real, for a table. */
static double complex measured(double x)
{
    const double y = x / RESOLUTION;
    return exp(-0.5 * (y - 0.2) * (y - 0.2)) * cexp(I * (1.0 + 0.8 * y + 0.3 * y * y));
}

CLAIM(a_measured_response_is_the_images)
{
    enum {
        SIDE = 60
    };
    double x[2 * SIDE + 1], real_part[2 * SIDE + 1], imaginary_part[2 * SIDE + 1], worst = 0.0;
    struct sea *sea = open_aperture(false);
    const double complex straight = middle_of(sea), peak = measured(0.2 * RESOLUTION);
    for (int i = -SIDE; i <= SIDE; i++) {
        x[i + SIDE] = i * RESOLUTION / 10.0;
        real_part[i + SIDE] = 5.0 * creal(measured(x[i + SIDE]));
        imaginary_part[i + SIDE] = 5.0 * cimag(measured(x[i + SIDE]));
    }
    sea_set_window(sea, x, real_part, imaginary_part, COUNT(x));
    const double complex *cut = cut_through(sea, straight);
    for (int row = 0; row < ROWS; row++)
        worst = fmax(worst, cabs(cut[row] - measured((row - MIDDLE) * SPACING) / peak));
    expect_below("cut less the table", worst,
                 0.02); /* for strips of 3 mm and a cubic of ten samples */
    expect_close("energy width, resolutions",
                 cross_range_energy_width(sea_response(sea), RANGE) / RESOLUTION, sqrt(PI), 1e-3);
    expect_level_of_seabed(sea);
}
