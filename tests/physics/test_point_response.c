/* The point response of images, seabeds and noise, along the track (W, of the aspects' window) and
 * in range (G, of the pulse): resolution, side lobes, energy, and place between pixels. */
#include "sea.h"

#define RANGE      50.0
#define CELL       0.025 /* c / 2B at 1500 m/s and 30 kHz */
#define RESOLUTION 0.04
#define QUADRATURE 4000

/* Windows of W, and pulses of G. G is a Gaussian, the transform of a chirp's window, or a table. A
 * half-power width of 0 is not known in closed form. */
static const struct weighting {
    uint32_t window; /* sonject_response_window or sonject_pulse_window */
    double sidelobe_db;
    uint32_t terms;
    double width, lobe_db, tolerance_db; /* theory: sinc, sinc / (1 - z^2), tables of windows */
} windows[] =
    {
        {SONJECT_WINDOW_RECTANGULAR, 0.0, 0, 0.8859, -13.26, 0.02},
        {SONJECT_WINDOW_HAMMING, 0.0, 0, 1.3030, -42.7, 0.3},
        {SONJECT_WINDOW_TAYLOR, 25.0, 4, 0.0, -25.0, 0.5}, /* a little under the design's level */
        {SONJECT_WINDOW_TAYLOR, 35.0, 5, 0.0, -35.0, 0.5},
        {SONJECT_WINDOW_TAYLOR, 45.0, 8, 0.0, -45.0, 0.5},
},
  pulses[] = {
      {SONJECT_PULSE_RECTANGULAR, 0.0, 0, 0.8859, -13.26, 0.02},
      {SONJECT_PULSE_HANN, 0.0, 0, 1.4406, -31.47, 0.02},
      {SONJECT_PULSE_TAYLOR, 35.0, 5, 0.0, -35.0, 0.5},
      {UINT32_MAX, 0.0, 0, 0.0, 0.0, 0.0},
};
#define TABLE 3 /* index in pulses */

static void choose_window(struct sea *sea, const struct weighting *shape)
{
    sea->sonar->response_window = shape->window;
    if (shape->window == SONJECT_WINDOW_TAYLOR) {
        sea->sonar->taylor_sidelobe_db = shape->sidelobe_db;
        sea->sonar->taylor_terms = shape->terms;
    }
    sea->sonar->along_track_resolution_m = RESOLUTION;
}

/* Returns the full width of the stretched ideal equal-lobe pattern at |W|^2 = 1/2, resolutions. */
static double taylor_width(const struct weighting *shape)
{
    const double r = pow(10.0, shape->sidelobe_db / 20.0), a = acosh(r) / PI, n = shape->terms;
    return 2.0 / PI * sqrt(pow(acosh(r), 2.0) - pow(acosh(r / sqrt(2.0)), 2.0)) * n /
           sqrt(a * a + (n - 0.5) * (n - 0.5));
}

/* Returns the transform of a weighting, 1 and a cosine, over its mean, at z resolutions or cells.
 * The table's has Hann's weights, and phases of 2nd and 3rd order of an uncompensated
 * transducer. */
static double complex transform(double cosine, bool is_table, double z)
{
    double complex sum = 0.0;
    for (int k = 0; k < QUADRATURE; k++) {
        const double v = (k + 0.5) / QUADRATURE - 0.5;
        const double phase = is_table ? 6.0 * v * v + 10.0 * v * v * v : 0.0;
        sum += (1.0 + cosine * cos(2.0 * PI * v)) * cexp(I * (phase + 2.0 * PI * v * z));
    }
    return sum / QUADRATURE;
}

static double complex expected_window(const struct weighting *shape, double z)
{
    return shape->sidelobe_db > 0.0
               ? taylor_pattern(shape->sidelobe_db, (int)shape->terms, z)
               : transform(shape->window == SONJECT_WINDOW_HAMMING ? 0.46 / 0.54 : 0.0, false, z);
}

static double complex expected_pulse(const struct weighting *shape, double z)
{
    return shape->sidelobe_db > 0.0
               ? taylor_pattern(shape->sidelobe_db, (int)shape->terms, z)
               : transform(shape->window == SONJECT_PULSE_RECTANGULAR ? 0.0 : 1.0,
                           shape == &pulses[TABLE], z);
}

static void choose_pulse(struct sea *sea, const struct weighting *shape)
{
    enum {
        SIDE = 160 /* eight samples a cell, 20 cells to each side */
    };
    double positions[2 * SIDE + 1], real_part[2 * SIDE + 1], imaginary_part[2 * SIDE + 1];
    sea->pulse->kind = SONJECT_PULSE_CHIRP;
    sea->pulse->window = shape->window;
    sea->pulse->taylor_sidelobe_db = shape->sidelobe_db;
    sea->pulse->taylor_terms = shape->terms;
    if (shape != &pulses[TABLE])
        return;
    sea->pulse->window = SONJECT_PULSE_RECTANGULAR;
    for (int i = -SIDE; i <= SIDE; i++) { /* in seconds, at half the sound speed */
        const double complex g = 3.0 * cexp(I * 2.0) * expected_pulse(shape, i / 8.0);
        positions[i + SIDE] = i / 8.0 * CELL / 750.0;
        real_part[i + SIDE] = creal(g);
        imaginary_part[i + SIDE] = cimag(g);
    }
    sea_set_pulse(sea, positions, real_part, imaginary_part, COUNT(positions), true);
}

/* Returns the sample of largest magnitude, by which a table is divided. */
static double complex peak_of(const struct weighting *shape)
{
    double complex peak = expected_pulse(shape, 0.0);
    for (int i = -160; shape == &pulses[TABLE] && i <= 160; i++) {
        const double complex g = expected_pulse(shape, i / 8.0);
        peak = cabs(g) > cabs(peak) ? g : peak;
    }
    return peak;
}

/* Return the full width where the square of W or G is half of its peak, and the largest value
 * beyond the first minimum, dB. */
static double half_power_width(const struct sea *sea,
                               double (*response)(const struct sea *, double), double unit)
{
    double low = 0.0, high = 2.0 * unit;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        *(response(sea, middle) > sqrt(0.5) ? &low : &high) = middle;
    }
    return 2.0 * low / unit;
}

static double highest_lobe_db(const struct sea *sea, double (*response)(const struct sea *, double),
                              double unit)
{
    const double step = 1e-3 * unit;
    double x = 0.0, highest = 0.0;
    while (fabs(response(sea, x + step)) < fabs(response(sea, x)))
        x += step;
    for (; x < 40.0 * unit; x += step)
        highest = fmax(highest, fabs(response(sea, x)));
    return decibels_of_amplitude(highest);
}

CLAIM(windows_are_transforms_of_their_aspects)
{
    for (size_t i = 0; i < COUNT(windows); i++) {
        struct sea *sea = sea_open(4, 4, RANGE);
        choose_window(sea, &windows[i]);
        sea_ready(sea);
        double worst = 0.0;
        for (double z = -12.037; z < 12.0; z += 0.173)
            worst = fmax(worst,
                         cabs(sea_window(sea, RESOLUTION * z) - expected_window(&windows[i], z)));
        print_message("window %zu\n", i);
        expect_close("W at its middle", sea_window(sea, 0.0), 1.0, 1e-12);
        expect_below("W less the transform", worst, 1e-6);
        const double width = windows[i].width > 0.0 ? windows[i].width : taylor_width(&windows[i]);
        expect_close("half-power width, resolutions", half_power_width(sea, sea_window, RESOLUTION),
                     width, 0.01 * width);
        expect_close("highest side lobe, dB", highest_lobe_db(sea, sea_window, RESOLUTION),
                     windows[i].lobe_db, windows[i].tolerance_db);
        /* energy by quadrature out to 400 resolutions, which leaves a tail of 2/(2 pi^2 x) */
        double energy = 0.0, inside = 0.0;
        const double step = 0.02 * RESOLUTION,
                     reach = along_track_energy_reach(sea_response(sea), 0.01);
        for (double x = 0.5 * step; x < 400.0 * RESOLUTION; x += step) {
            const double square = 2.0 * pow(sea_window(sea, x), 2.0) * step;
            energy += square;
            inside += x < reach ? square : 0.0;
        }
        expect_close("energy width over resolution", sea_window_energy(sea) / RESOLUTION,
                     energy / RESOLUTION, 1e-3);
        expect_close("energy inside the reach of 99 %", inside / energy, 0.99, 6e-3);
    }
}

/* The Gaussian's half power is at half of c/2B. */
CLAIM(pulses_are_transforms_of_their_spectra)
{
    struct sea *sea = sea_open(4, 4, RANGE);
    sea_ready(sea);
    expect_close("Gaussian |G|^2 at c/4B", pow(sea_pulse(sea, 0.5 * CELL), 2.0), 0.5, 1e-9);
    expect_close("its energy width over c/2B", sea_pulse_energy(sea) / CELL,
                 sqrt(PI / (4.0 * log(2.0))), 1e-9);
    for (size_t i = 0; i < COUNT(pulses); i++) {
        const double complex peak = peak_of(&pulses[i]);
        double worst = 0.0, energy = 0.0;
        sea = sea_open(4, 4, RANGE);
        choose_pulse(sea, &pulses[i]);
        sea_ready(sea);
        for (int k = -1600; k <= 1600; k++) {
            const double z = (k + 0.37) / 80.0;
            worst = fmax(worst, cabs(sea_pulse_complex(sea, z * CELL) -
                                     expected_pulse(&pulses[i], z) / peak));
        }
        for (int k = -160000; k < 160000; k++)
            energy +=
                pow(cabs(sea_pulse_complex(sea, (k + 0.5) * CELL / 800.0)), 2.0) * CELL / 800.0;
        print_message("pulse %zu\n", i);
        /* quadrature errs by 1e-6; a cubic between eight samples a cell by a thousandth */
        expect_below("G less the transform", worst, i == TABLE ? 2e-3 : 1e-5);
        /* a sinc has 1 / (pi^2 200) of its energy beyond 200 cells */
        expect_close("energy over the sum's", sea_pulse_energy(sea) / energy, 1.0, 6e-4);
        if (i == TABLE) /* Parseval: Hann's spectrum has 1.5 times its mean's square */
            expect_close("energy of the table", sea_pulse_energy(sea) / CELL,
                         1.5 / pow(cabs(peak), 2.0), 2e-3);
        else
            expect_close("highest side lobe, dB", highest_lobe_db(sea, sea_pulse, CELL),
                         pulses[i].lobe_db, pulses[i].tolerance_db);
        if (pulses[i].width > 0.0)
            expect_close("half-power width, cells", half_power_width(sea, sea_pulse, CELL),
                         pulses[i].width, 1e-4);
    }
}

#define ROWS    161
#define COLUMNS 121

/* Puts a ball far smaller than any resolution, of half a wavelength at least, on the middle of the
 * middle pixel. */
static void hang_ball(struct sea *sea, double radius)
{
    sea_add_sphere(sea, radius, 0.1);
    sea_ready(sea);
    sea_move(sea, sea_slant_range(sea, 0));
    place_in_metres(sea_object(sea, 0), (double)(sea->rows / 2) * sea->geometry->row_spacing_m,
                    RANGE);
    sea_ready(sea);
}

CLAIM(the_image_of_a_point_is_w_times_g)
{
    for (size_t i = 0; i < COUNT(windows); i++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea->geometry->row_spacing_m = 0.005;
        sea->geometry->column_spacing_m = 0.002;
        sea->sonar->centre_frequency_hz = 800e3;
        choose_window(sea, &windows[i]);
        sea_move(sea, RANGE);
        hang_ball(sea, 0.0005);
        const double complex *pixels = sea_image(sea)->target;
        const double peak = cabs(pixels[80 * COLUMNS + 60]);
        double along = 0.0, in_range = 0.0;
        assert_true(peak > 0.0);
        /* two sub-strips of 2.5 mm hold the ball: W's mean over 2.5 mm of 40 */
        for (size_t row = 0; row < ROWS; row++) {
            const double x = ((double)row - 80.0) * 0.005;
            const double w = 0.5 * (sea_window(sea, x - 0.00125) + sea_window(sea, x + 0.00125));
            along = fmax(along, fabs(cabs(pixels[row * COLUMNS + 60]) / peak - fabs(w)));
        }
        for (size_t column = 0; column < COLUMNS; column++)
            in_range = fmax(in_range, fabs(cabs(pixels[80 * COLUMNS + column]) / peak -
                                           sea_pulse(sea, ((double)column - 60.0) * 0.002)));
        print_message("window %zu\n", i);
        expect_below("along-track cut less W", along, 0.02);
        expect_below("range cut less G", in_range, 0.02);
    }
}

CLAIM(the_image_of_a_point_has_the_pulses_phase)
{
    for (size_t i = 0; i < COUNT(pulses); i++) {
        struct sea *sea = sea_open(21, COLUMNS, RANGE);
        sea->geometry->column_spacing_m = 0.003;
        sea->sonar->centre_frequency_hz = 400e3;
        sea->injection->ray_scale = 16.0;
        choose_pulse(sea, &pulses[i]);
        sea_move(sea, RANGE);
        hang_ball(sea, 0.001);
        const double complex *pixels = sea_image(sea)->target + 10 * COLUMNS;
        double complex scale = 0.0, g[COLUMNS];
        double norm = 0.0, worst = 0.0;
        for (int column = 0; column < COLUMNS; column++) {
            g[column] = sea_pulse_complex(sea, (column - 60.0) * 0.003 + 0.001);
            scale += conj(g[column]) * pixels[column]; /* by least squares */
            norm += pow(cabs(g[column]), 2.0);
        }
        for (int column = 0; column < COLUMNS; column++)
            worst = fmax(worst, cabs(pixels[column] / (scale / norm) - g[column]));
        print_message("pulse %zu\n", i);
        assert_true(cabs(scale) > 0.0);
        /* the glint is a radius before the ball's middle; bins err by 5e-4, its depth by more */
        expect_below("range cut less G", worst, 0.02);
    }
}

/* A ball that moves by a part of a pixel moves the centroid of its energy by that part. */
CLAIM(a_point_between_pixels)
{
    double first[3] = {0.0, 0.0, 0.0}; /* row, column, range */
    for (int step = 0; step <= 8; step++) {
        struct sea *sea = sea_open(101, 101, RANGE);
        choose_window(sea, &windows[3]); /* low side lobes: the patch cuts nothing off */
        /* a centroid needs |W|^2 and G^2 sampled finely enough: twice an image's usual pixels */
        sea->sonar->along_track_resolution_m = 0.05;
        sea->sonar->bandwidth_hz = 15e3;
        sea->injection->ray_scale = 16.0;
        place_in_metres(sea_add_sphere(sea, 0.025, 0.1), (50.0 + step / 8.0) * 0.025,
                        RANGE + step / 8.0 * 0.025);
        const struct image *image = sea_image(sea);
        double sum = 0.0, here[3] = {0.0, 0.0, sea_slant_range(sea, 0)};
        for (size_t i = 0; i < image->pixels; i++) {
            const double energy = pow(cabs(image->target[i]), 2.0);
            sum += energy;
            here[0] += energy * (double)(i / image->columns);
            here[1] += energy * (double)(i % image->columns);
        }
        for (int k = 0; k < 3; k++) {
            here[k] /= k < 2 ? sum : 1.0;
            first[k] = step == 0 ? here[k] : first[k];
        }
        expect_close("row", here[0], 50.0 + step / 8.0, 0.02);
        expect_close("moved columns", here[1] - first[1], (here[2] - first[2]) / 0.025, 0.02);
    }
}

/* Returns G's autocorrelation at a lag, over G's energy. */
static double complex autocorrelation(const struct sea *sea, double lag)
{
    const double step = CELL / 40.0;
    double complex sum = 0.0;
    double energy = 0.0;
    for (int i = -8000; i < 8000; i++) {
        const double complex g = sea_pulse_complex(sea, i * step);
        sum += conj(g) * sea_pulse_complex(sea, i * step + lag);
        energy += pow(cabs(g), 2.0);
    }
    return sum / energy;
}

/* Compares within 4 standard errors. Pixels of 0.4 cell are independent every 1.5 cells at best. */
static void expect_pulse_in(const struct sea *sea, const double complex *field, size_t edge)
{
    for (size_t lag = 1; lag <= 4; lag++) {
        const double error =
            4.0 * sqrt(1.5 / 0.4 / ((double)(sea->rows * (sea->columns - 2 * edge))));
        const double complex measured = correlation_of(sea, field, 0, lag, edge);
        const double complex expected = autocorrelation(sea, (double)lag * 0.01);
        expect_close("correlation, real part", creal(measured), creal(expected), error);
        expect_close("imaginary part", cimag(measured), cimag(expected), error);
    }
}

CLAIM(seabed_and_noise_have_the_pulse)
{
    for (size_t i = 0; i < COUNT(pulses); i++) {
        const size_t edge = 60;
        struct sea *sea = sea_open(240, 360, RANGE);
        sea->geometry->column_spacing_m = 0.01;
        choose_pulse(sea, &pulses[i]);
        sea_move(sea, RANGE);
        const struct image *image = sea_image_of(sea, NULL, true);
        const double count = 240.0 * (360.0 - 2.0 * (double)edge);
        print_message("pulse %zu\n", i);
        /* jittered rays, and 0.6 % of the energy beyond taps and margins, are 0.03 dB */
        expect_close(
            "mean energy of the seabed, dB",
            decibels_of_energy(level_over(sea, image, 0, edge, false, sea_seabed_level).mean), 0.0,
            0.04);
        /* 4 standard errors of exponential intensities, one every 1.5 cells of 2.5 pixels */
        expect_close("speckle over it",
                     level_over(sea, image, 0, edge, true, sea_seabed_level).mean, 1.0,
                     4.0 * sqrt(3.75 / count));
        expect_pulse_in(sea, unit_field(sea, image->seabed, image->seabed_energy), edge);
        const double complex *noise = sea_noise(sea, NOISE_OF_IMAGE);
        const double pixels = 240.0 * 360.0;
        expect_close("noise", creal(correlation_of(sea, noise, 0, 0, 0)), 1.0,
                     4.0 * sqrt(3.75 / pixels) + 6e-3);
        expect_pulse_in(sea, noise, edge);
    }
}

/* The image is the same whether the Gaussian is known or measured. */
CLAIM(a_table_of_the_gaussian_is_the_gaussian)
{
    const struct image *images[2];
    double positions[81], values[81], peak;
    for (int i = 0; i < 81; i++) {
        positions[i] = (i - 40) * CELL / 8.0;
        values[i] = 7.0 * exp(-2.0 * log(2.0) * pow((i - 40) / 8.0, 2.0));
    }
    for (int with_table = 0; with_table < 2; with_table++) {
        struct sea *sea = sea_open(41, 81, RANGE);
        sea_add_sphere(sea, 0.15, 0.0)->material.lambert = 0.01;
        if (with_table)
            sea_set_pulse(sea, positions, values, NULL, 81, false);
        images[with_table] = sea_image(sea);
    }
    const double worst = image_difference(images[0], images[1], &peak);
    expect_below("difference over the peak", worst / peak, 2e-3); /* for the cubic */
}
