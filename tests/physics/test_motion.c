/* Images of a synthetic aperture whose sonar left its track, and those of a measured cross-range
 * response. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "scene/cross_range.h"
#include "scene/motion_response.h"

#define ROWS       161
#define COLUMNS    41
#define SPACING    0.0125
#define RESOLUTION 0.05
#define RANGE      50.0
#define MIDDLE     80
#define LEVEL_DB   0.2

static void open_aperture(struct bench *bench)
{
    bench_open(bench, ROWS, COLUMNS, RANGE);
    bench->scene.geometry.row_spacing_m = SPACING;
    bench->scene.sonar.along_track_resolution_m = RESOLUTION;
    bench->scene.sonar.response_window = SONJECT_WINDOW_HAMMING; /* lobes at -43 dB */
    bench_move(bench, RANGE);
    sonject_object_params *object = bench_add(bench, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 0.008);
    object->burial_m = -0.1;
    object->position_kind = SONJECT_POSITION_METRES;
    object->position_along = MIDDLE * SPACING;
    object->position_range = RANGE;
    bench->scene.injection.ray_scale = 4.0;
    bench_ready(bench);
}

/* The along-track cut through the ball over its value on the straight track. */
static void cut_of(struct bench *bench, double complex *cut)
{
    static double complex straight;
    struct echoes echoes;
    bench_ready(bench);
    bench_echoes(bench, NULL, SEABED_FIELD_NONE, &echoes);
    size_t brightest = 0;
    for (size_t column = 0; column < COLUMNS; column++) {
        double here = 0.0;
        double best = 0.0;
        for (size_t row = 0; row < ROWS; row++) {
            here += pow(echoes.target_real[row * COLUMNS + column], 2.0) +
                    pow(echoes.target_imaginary[row * COLUMNS + column], 2.0);
            best += pow(echoes.target_real[row * COLUMNS + brightest], 2.0) +
                    pow(echoes.target_imaginary[row * COLUMNS + brightest], 2.0);
        }
        if (here > best)
            brightest = column;
    }
    for (size_t row = 0; row < ROWS; row++) {
        const size_t i = row * COLUMNS + brightest;
        cut[row] = echoes.target_real[i] + I * (double)echoes.target_imaginary[i];
    }
    if (aperture_motion_is_still(&bench->scene.motion) && bench->scene.cross_range_table.count == 0)
        straight = cut[MIDDLE];
    assert_true(cabs(straight) > 0.0);
    for (size_t row = 0; row < ROWS; row++)
        cut[row] /= straight;
    echoes_clear(&echoes);
}

static double cosine_of_grazing(const struct bench *bench)
{
    const struct patch_view *view = &bench->tracer.view;
    return cos(view_grazing(view, view_apparent_range(view, 0.5 * (COLUMNS - 1))));
}

/* Height and place of the highest point of a parabola through the largest of some rows. */
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

/* exp(i beta sin) is the sum of Bessel functions J_m(beta) of its harmonics; each moves W by
 * wavelength range / (2 wavelength of the sway). */
static void test_paired_echoes(void **unused)
{
    struct bench bench;
    double complex cut[ROWS];
    (void)unused;
    open_aperture(&bench);
    /* lobes at -43 dB would move an echo at -20 dB by 0.13 resolutions, at -70 dB by 0.006 */
    bench.scene.sonar.response_window = SONJECT_WINDOW_TAYLOR;
    bench.scene.sonar.taylor_sidelobe_db = 70.0;
    bench.scene.sonar.taylor_terms = 10;
    cut_of(&bench, cut);
    const double beta = 0.2; /* J0 0.99002497, J1 0.09950083 */
    const double away = 1.5;
    const double amplitude = beta / (2.0 * bench_wavenumber(&bench) * cosine_of_grazing(&bench));
    print_message("amplitude of the sway: %.3g m\n", amplitude);
    bench.scene.motion.params.sway_count = 1;
    bench.scene.motion.params.sways[0].amplitude_m = amplitude;
    bench.scene.motion.params.sways[0].wavelength_m = away;
    bench.scene.motion.params.sways[0].phase_rad = 0.7;
    cut_of(&bench, cut);
    const double shift =
        bench.tracer.view.wavelength_m * bench.tracer.response.motion_range_m / (2.0 * away);
    double row;
    const double main_peak = peak_between(cut, MIDDLE - 4, MIDDLE + 4, &row);
    expect_close("main lobe over J0, dB", decibels_of_amplitude(main_peak / 0.99002497), 0.0,
                 LEVEL_DB);
    for (int side = -1; side <= 1; side += 2) {
        const double expected = MIDDLE + side * shift / SPACING;
        const double peak =
            peak_between(cut, (size_t)(expected - 3.0), (size_t)(expected + 3.0), &row);
        /* the tangent of an aspect is up to 0.3 % above the sine */
        expect_close("place of the echo, resolutions", (row - expected) * SPACING / RESOLUTION, 0.0,
                     0.02);
        expect_close("level of the echo over J1, dB", decibels_of_amplitude(peak / 0.09950083), 0.0,
                     LEVEL_DB);
    }
    bench_close(&bench);
}

static double sine_ratio(double x)
{
    return x == 0.0 ? 1.0 : sin(PI * x) / (PI * x);
}

/* A constant yaw makes the sway a sawtooth, as long as the pings' advance A: phases of period A,
 * whose harmonics are c_m = sinc(m + 2 yaw A cos(grazing) / wavelength). Each moves W by
 * -m wavelength range / 2A, the lobes of a grating of this spacing; of the two beside the main one,
 * that on the side where the array looks is the higher. */
static void test_lobes_of_a_constant_yaw(void **unused)
{
    struct bench bench;
    double complex cut[ROWS];
    (void)unused;
    open_aperture(&bench);
    bench.scene.sonar.response_window = SONJECT_WINDOW_TAYLOR; /* see test_paired_echoes */
    bench.scene.sonar.taylor_sidelobe_db = 70.0;
    bench.scene.sonar.taylor_terms = 10;
    cut_of(&bench, cut);
    const double advance = 1.2; /* beams of elements leave 0.05 dB less of the lobes */
    const double steps = 0.3;   /* of a phase of 2 pi, within a ping */
    const double wavelength = bench.tracer.view.wavelength_m;
    bench.scene.motion.params.yaw_advance_m = advance;
    bench.scene.motion.params.yaw_bias_rad =
        steps * wavelength / (2.0 * advance * cosine_of_grazing(&bench));
    print_message("yaw: %.3g rad\n", bench.scene.motion.params.yaw_bias_rad);
    cut_of(&bench, cut);
    const double spacing = wavelength * bench.tracer.response.motion_range_m / (2.0 * advance);
    for (int m = -1; m <= 1; m++) {
        const double expected = MIDDLE - m * spacing / SPACING;
        double row;
        const double peak =
            peak_between(cut, (size_t)(expected - 3.0), (size_t)(expected + 3.0), &row);
        /* the tangent of an aspect is up to 0.3 % above the sine */
        expect_close("place of the lobe, resolutions", (row - expected) * SPACING / RESOLUTION, 0.0,
                     0.02);
        expect_close("level of the lobe over sinc, dB",
                     decibels_of_amplitude(peak / fabs(sine_ratio(m + steps))), 0.0, LEVEL_DB);
    }
    bench_close(&bench);
}

/* The same lobes as they leave the beam of elements of 2 delta, whose zero is where lobe A/delta
 * lies; delta is such that each lobe lies at a zero of all others. The beam leaves the mean over
 * |v| < 1/2 of sinc(v + t)^2 / sinc(v)^2, t = m delta/A: for whole t that of v^2 / (v + t)^2. */
static void test_lobes_beyond_the_beam(void **unused)
{
    enum {
        PINGS_ADVANCE = 8, /* resolutions */
        APART = 5,         /* of lobes, resolutions */
        STRIPS = 2,        /* in a resolution */
        LAST = 8,
        REACH = LAST * APART * STRIPS
    };
    static double real_part[2 * REACH + 1], imaginary_part[2 * REACH + 1];
    static const struct {
        int lobe;
        double left;
    } lobes[] = {
        {-8, 0.1361087}, /* 1 - 2 ln 3 + 4/3 */
        {-1, 0.9732098}, /* by the midpoint rule, as is the next but one */
        {0, 1.0},        {4, 0.6380988}, {8, 0.1361087},
    };
    struct bench bench;
    struct motion_response motion;
    (void)unused;
    open_aperture(&bench);
    const double wavelength = bench.tracer.view.wavelength_m;
    const double range = 0.5 * (view_apparent_range(&bench.tracer.view, 0.0) +
                                view_apparent_range(&bench.tracer.view, COLUMNS - 1.0));
    const double resolution = sqrt(wavelength * range / (2.0 * PINGS_ADVANCE * APART));
    const double steps = 0.3;
    bench.scene.sonar.along_track_resolution_m = resolution;
    bench.scene.sonar.response_window = SONJECT_WINDOW_RECTANGULAR;
    bench.scene.motion.params.yaw_advance_m = PINGS_ADVANCE * resolution;
    bench.scene.motion.params.yaw_bias_rad =
        steps * wavelength / (2.0 * PINGS_ADVANCE * resolution * cosine_of_grazing(&bench));
    bench_ready(&bench);
    assert_int_equal(motion_response_begin(&motion, &bench.report, &bench.tracer.response,
                                           &bench.tracer.view, resolution / STRIPS, 0.0, REACH),
                     SONJECT_OK);
    motion_response_row(&motion, MIDDLE, real_part, imaginary_part);
    motion_response_end(&motion);
    for (size_t i = 0; i < sizeof lobes / sizeof *lobes; i++) {
        const int at = REACH - lobes[i].lobe * APART * STRIPS;
        const double expected = fabs(sine_ratio(lobes[i].lobe + steps)) * lobes[i].left;
        print_message("lobe %d: ", lobes[i].lobe);
        expect_close("level over what the elements leave, dB",
                     decibels_of_amplitude(hypot(real_part[at], imaginary_part[at]) / expected),
                     0.0, LEVEL_DB);
    }
    bench_close(&bench);
}

/* What elements of two resolutions hear of a point, over what they hear of the pixel `distance`
 * from it: the mean over aspects under Hamming's weights. */
static double heard_share(const struct bench *bench, double distance)
{
    enum {
        STEPS = 200
    };
    const double aside = 2.0 * RESOLUTION / bench->tracer.view.wavelength_m *
                         sin(atan(distance / bench->tracer.response.motion_range_m));
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double v = (i + 0.5) / STEPS - 0.5;
        sum += (0.54 + 0.46 * cos(2.0 * PI * v)) / 0.54 / STEPS *
               pow(sine_ratio(v + aside) / sine_ratio(v), 2.0);
    }
    return sum;
}

/* W of a row by its definition, over the straight one's peak: the mean over aspects. */
static double complex moved_response(const struct bench *bench, double row, double distance,
                                     double (*sway)(double))
{
    enum {
        STEPS = 20000
    };
    const double k = bench_wavenumber(bench);
    const double steepest = PI / k / (2.0 * RESOLUTION); /* wavelength / 4 resolution */
    const double range = bench->tracer.response.motion_range_m;
    const double heard = heard_share(bench, distance);
    double complex sum = 0.0;
    double total = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double v = (i + 0.5) / STEPS - 0.5;
        const double sine = 2.0 * v * steepest;
        const double weight = 0.54 + 0.46 * cos(2.0 * PI * v);
        const double place = row * SPACING + range * tan(asin(sine));
        const double error =
            -2.0 * k * cosine_of_grazing(bench) * sqrt(1.0 - sine * sine) * sway(place);
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

static void give_sway(struct bench *bench, double (*sway)(double))
{
    enum {
        COUNT = 2001
    };
    static double x[COUNT], y[COUNT];
    for (int i = 0; i < COUNT; i++) {
        x[i] = -8.0 + 0.01 * i;
        y[i] = sway(x[i]);
    }
    assert_int_equal(motion_table_set(&bench->scene.motion.sway_table, &bench->report, x, y, COUNT),
                     SONJECT_OK);
}

static void test_quadratic_error(void **unused)
{
    struct bench bench;
    double complex cut[ROWS];
    (void)unused;
    open_aperture(&bench);
    cut_of(&bench, cut);
    give_sway(&bench, parabola);
    cut_of(&bench, cut);
    double worst = 0.0;
    double brightest = 0.0;
    for (int row = 0; row < ROWS; row++) {
        const double complex expected =
            moved_response(&bench, row, (row - MIDDLE) * SPACING, parabola);
        worst = fmax(worst, cabs(cut[row] - expected));
        brightest = fmax(brightest, cabs(cut[row]));
    }
    print_message("largest amplitude %.3f of the straight track's\n", brightest);
    assert_true(brightest < 0.7);
    expect_below("cut less the transform", worst, 0.01); /* two strips of 3 mm hold the ball */
    bench_close(&bench);
}

#define ADVANCE 0.4

static double yaw_of_ping(double x)
{
    return 8e-3 * sin(2.0 * PI * x / 1.7 + 0.4) - 2e-3;
}

/* That yaw, which each ping has anew, as the sway of its phase centres. */
static double sway_of_a_yaw(double x)
{
    const double ping = floor(x / ADVANCE + 0.5) * ADVANCE;
    return yaw_of_ping(ping) * (x - ping);
}

static void give_yaw(struct bench *bench)
{
    sonject_motion_params *motion = &bench->scene.motion.params;
    motion->yaw_advance_m = ADVANCE;
    motion->yaw_bias_rad = -2e-3;
    motion->yaw_count = 1;
    motion->yaws[0].amplitude_rad = 8e-3;
    motion->yaws[0].wavelength_m = 1.7;
    motion->yaws[0].phase_rad = 0.4;
}

static void test_changing_yaw(void **unused)
{
    struct bench bench;
    double complex cut[ROWS];
    (void)unused;
    open_aperture(&bench);
    cut_of(&bench, cut);
    give_yaw(&bench);
    cut_of(&bench, cut);
    double worst = 0.0;
    double faintest = 1.0;
    for (int row = 0; row < ROWS; row++) {
        const double complex expected =
            moved_response(&bench, row, (row - MIDDLE) * SPACING, sway_of_a_yaw);
        worst = fmax(worst, cabs(cut[row] - expected));
        faintest = fmin(faintest, row == MIDDLE ? cabs(cut[row]) : 1.0);
    }
    print_message("peak %.3f of the straight track's\n", faintest);
    assert_true(faintest < 0.95);
    expect_below("cut less the transform", worst, 0.01); /* two strips of 3 mm hold the ball */
    bench_close(&bench);
}

/* From the transmitter in the array's middle to a point of the seabed, at x along the track, and
 * back to the hydrophone at e on the array. */
static double way_of(const struct bench *bench, double ping, double e, double yaw, double x)
{
    const double range = bench->tracer.response.motion_range_m;
    const double height = bench->tracer.view.altitude_m;
    const double across = sqrt(range * range - height * height) - e * sin(yaw);
    const double along = x - (ping + e * cos(yaw));
    return sqrt(range * range + (x - ping) * (x - ping)) +
           sqrt(along * along + across * across + height * height);
}

/* Amplitude of a point, `distance` before the pixel, from all hydrophones of all pings of the
 * aperture, focused as if the array had kept its heading. Each hears alike all around. */
static double heard_amplitude(const struct bench *bench, double pixel, double distance)
{
    enum {
        HYDROPHONES = 200
    };
    const double k = bench_wavenumber(bench);
    const double range = bench->tracer.response.motion_range_m;
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
            /* even in the sine */
            const double weight =
                (0.54 + 0.46 * cos(PI * sine / steepest)) * pow(1.0 - sine * sine, 1.5);
            const double way = way_of(bench, ping, e, yaw_of_ping(ping), pixel - distance) -
                               way_of(bench, ping, e, 0.0, pixel);
            sum += weight * cexp(I * k * way);
            total += weight;
        }
    return cabs(sum) / total;
}

/* The response that yaw gives a row is what hydrophones at their true places would make of it, but
 * for their beam. */
static void test_yaw_of_hydrophones(void **unused)
{
    enum {
        REACH = 100
    };
    static double real_part[2 * REACH + 1], imaginary_part[2 * REACH + 1];
    struct bench bench;
    struct motion_response motion;
    (void)unused;
    open_aperture(&bench);
    give_yaw(&bench);
    bench_ready(&bench);
    assert_int_equal(motion_response_begin(&motion, &bench.report, &bench.tracer.response,
                                           &bench.tracer.view, SPACING, 0.0, REACH),
                     SONJECT_OK);
    double worst = 0.0;
    double straight = 0.0;
    for (int row = 7; row < ROWS; row += 50) {
        motion_response_row_all_around(&motion, row, real_part, imaginary_part);
        for (int j = -REACH; j <= REACH; j += 3) {
            const double heard = heard_amplitude(&bench, row * SPACING, j * SPACING);
            const double model = hypot(real_part[j + REACH], imaginary_part[j + REACH]);
            worst = fmax(worst, fabs(heard - model));
            straight = fmax(
                straight, fabs(heard - along_track_response(&bench.tracer.response, j * SPACING)));
        }
    }
    motion_response_end(&motion);
    print_message("a straight track's differs by %.3f\n", straight);
    assert_true(straight > 0.1);
    /* hydrophones 4 mm apart; at x beside the pixel ranges are curved: k x^2 aspect^2 / r */
    expect_below("response less what hydrophones hear", worst, 0.004);
    bench_close(&bench);
}

static double wander(double x)
{
    return 1e-3 * sin(1.7 * x) + 4e-4 * cos(5.1 * x + 0.3);
}

static double energy_of(const double *real_part, const double *imaginary_part, int reach)
{
    double energy = 0.0;
    for (int i = 0; i < 2 * reach + 1; i++)
        energy += SPACING * (real_part[i] * real_part[i] + imaginary_part[i] * imaginary_part[i]);
    return energy;
}

/* Neither the energy of a row's response nor the seabed's level changes, but for what the elements'
 * beam leaves out; starboard is port, reversed. */
static void test_energy_stays(void **unused)
{
    struct bench bench;
    struct motion_response motion;
    struct echoes echoes;
    enum {
        REACH = 3000
    };
    static double real_part[2 * REACH + 1], imaginary_part[2 * REACH + 1];
    (void)unused;
    open_aperture(&bench);
    give_sway(&bench, wander);
    bench.scene.motion.params.random_rms_m = 1e-3;
    bench_ready(&bench);
    print_message("energy reaches %.3g m farther\n", bench.tracer.response.motion_spread_m[1]);
    const double straight = along_track_energy_width(&bench.tracer.response);
    assert_int_equal(motion_response_begin(&motion, &bench.report, &bench.tracer.response,
                                           &bench.tracer.view, SPACING, 0.0, REACH),
                     SONJECT_OK);
    double heard = 0.0;
    for (int row = 0; row < ROWS; row += 40) {
        motion_response_row_all_around(&motion, row, real_part, imaginary_part);
        expect_close("energy of a row's response",
                     energy_of(real_part, imaginary_part, REACH) / straight, 1.0, 1e-3);
        motion_response_row(&motion, row, real_part, imaginary_part);
        heard += energy_of(real_part, imaginary_part, REACH) / straight / 5.0;
    }
    assert_true(heard < 0.9995);
    expect_close("share that elements hear", bench.tracer.response.motion_energy_share, heard,
                 2e-4);
    motion_response_end(&motion);
    bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, &echoes);
    double ratio = 0.0;
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        ratio += echoes.seabed_energy[i] /
                 seabed_cell_energy(&bench.tracer.view, &bench.tracer.response,
                                    bench.scene.seabed.lambert,
                                    view_apparent_range(&bench.tracer.view, (double)(i % COLUMNS)));
    /* taps and margins leave out 0.6 % */
    expect_close("mean energy of the seabed, dB", decibels_of_energy(ratio / (ROWS * COLUMNS)), 0.0,
                 0.04);
    echoes_clear(&echoes);
    bench_close(&bench);
}

static double wander_of_starboard(double x)
{
    return wander(160 * SPACING - x);
}

static void test_starboard(void **unused)
{
    double complex cuts[2][ROWS];
    (void)unused;
    for (int side = 0; side < 2; side++) {
        struct bench bench;
        open_aperture(&bench);
        bench.scene.geometry.side = side ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        cut_of(&bench, cuts[side]);
        give_sway(&bench, side ? wander_of_starboard : wander);
        /* the bow is at the other end; pings lie at the same places */
        bench.scene.motion.params.yaw_advance_m = 0.25;
        bench.scene.motion.params.yaw_bias_rad = side ? -0.02 : 0.02;
        cut_of(&bench, cuts[side]);
        bench_close(&bench);
    }
    double worst = 0.0;
    for (int row = 0; row < ROWS; row++)
        worst = fmax(worst, cabs(cuts[0][row] - cuts[1][row]));
    expect_below("port less starboard", worst, 1e-3);
}

static sonject_status try_motion(struct bench *bench)
{
    struct point_response response;
    const sonject_status status = point_response_of_scene(&response, &bench->report, &bench->scene,
                                                          &bench->tracer.view, 1500.0);
    print_message("%s\n", status == SONJECT_OK ? "taken" : bench->report.message);
    return status;
}

/* Sway that turns sound by more than the aspects, so that no response is long enough; yaw whose
 * pings are unknown, or too many; motion that is too fast to be followed. */
static void test_motion_that_is_refused(void **unused)
{
    static const double x[] = {0.0, 1.0};
    static const double yaw[] = {1e-3, 2e-3};
    struct bench bench;
    (void)unused;
    open_aperture(&bench);
    sonject_motion_params *motion = &bench.scene.motion.params;
    motion->random_rms_m = 1e-3;
    assert_int_equal(try_motion(&bench), SONJECT_OK);
    motion->random_rms_m = 10.0;
    assert_int_equal(try_motion(&bench), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(bench.report.message, "lessen it"));
    motion->random_rms_m = 0.0;
    assert_int_equal(motion_table_set(&bench.scene.motion.yaw_table, &bench.report, x, yaw, 2),
                     SONJECT_OK);
    assert_int_equal(try_motion(&bench), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(bench.report.message, "without the advance"));
    motion->yaw_advance_m = 0.5;
    assert_int_equal(try_motion(&bench), SONJECT_OK);
    motion->yaw_advance_m = 1e-4;
    assert_int_equal(try_motion(&bench), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(bench.report.message, "aspects"));
    motion->yaw_advance_m = 0.5;
    bench.tracer.view.rows = 1000000000;
    assert_int_equal(try_motion(&bench), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(bench.report.message, "pings"));
    motion->random_rms_m = 1e-3;
    assert_int_equal(try_motion(&bench), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(bench.report.message, "steps of the sway"));
    bench_close(&bench);
}

/* The random sway's autocorrelation, by an average over seeds. */
static void test_random_sway(void **unused)
{
    enum {
        SEEDS = 4000
    };
    double sums[3] = {0.0, 0.0, 0.0};
    struct aperture_motion motion;
    (void)unused;
    memset(&motion, 0, sizeof motion);
    sonject_motion_params_init(&motion.params);
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

/* A response that is neither even nor real, as a table. */
static double complex measured(double x)
{
    const double y = x / RESOLUTION;
    return exp(-0.5 * (y - 0.2) * (y - 0.2)) * cexp(I * (1.0 + 0.8 * y + 0.3 * y * y));
}

static void test_measured_response(void **unused)
{
    enum {
        SIDE = 60
    };
    struct bench bench;
    struct echoes echoes;
    double complex cut[ROWS];
    double x[2 * SIDE + 1], real_part[2 * SIDE + 1], imaginary_part[2 * SIDE + 1];
    (void)unused;
    for (int i = -SIDE; i <= SIDE; i++) {
        x[i + SIDE] = i * RESOLUTION / 10.0;
        real_part[i + SIDE] = 5.0 * creal(measured(x[i + SIDE]));
        imaginary_part[i + SIDE] = 5.0 * cimag(measured(x[i + SIDE]));
    }
    open_aperture(&bench);
    cut_of(&bench, cut);
    assert_int_equal(response_table_set(&bench.scene.cross_range_table, &bench.report, x, real_part,
                                        imaginary_part, 2 * SIDE + 1, false),
                     SONJECT_OK);
    cut_of(&bench, cut);
    double worst = 0.0;
    const double complex peak = measured(0.2 * RESOLUTION);
    for (int row = 0; row < ROWS; row++)
        worst = fmax(worst, cabs(cut[row] - measured((row - MIDDLE) * SPACING) / peak));
    expect_below("cut less the table", worst, 0.02); /* strips of 3 mm, a cubic of ten samples */
    expect_close("energy width, resolutions",
                 cross_range_energy_width(&bench.tracer.response, RANGE) / RESOLUTION, sqrt(PI),
                 1e-3);
    bench_echoes(&bench, NULL, SEABED_FIELD_SPECKLE, &echoes);
    double ratio = 0.0;
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        ratio += echoes.seabed_energy[i] /
                 seabed_cell_energy(&bench.tracer.view, &bench.tracer.response,
                                    bench.scene.seabed.lambert,
                                    view_apparent_range(&bench.tracer.view, (double)(i % COLUMNS)));
    expect_close("mean energy of the seabed, dB", decibels_of_energy(ratio / (ROWS * COLUMNS)), 0.0,
                 0.04);
    echoes_clear(&echoes);
    bench_close(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_paired_echoes),
        cmocka_unit_test(test_quadratic_error),
        cmocka_unit_test(test_lobes_of_a_constant_yaw),
        cmocka_unit_test(test_lobes_beyond_the_beam),
        cmocka_unit_test(test_changing_yaw),
        cmocka_unit_test(test_yaw_of_hydrophones),
        cmocka_unit_test(test_energy_stays),
        cmocka_unit_test(test_starboard),
        cmocka_unit_test(test_motion_that_is_refused),
        cmocka_unit_test(test_random_sway),
        cmocka_unit_test(test_measured_response),
    };
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
