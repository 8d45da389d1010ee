/* A plain Lambert seabed has mu sin^2(grazing) times the area of a pixel's point response, from the
 * first return on. Rays, pixels and the sharing between bins do not change that. Its speckle is
 * circular Gaussian with the point response's correlation. */
#include "sea.h"

#define ROWS    240
#define COLUMNS 200
#define EDGE    24 /* pixels near an edge, which lack a part of |W|^2 or of the pulse */

/* Returns the level by formulas, not the library's: mu sin^2(g) dA. dA is the width of |W|^2 times
 * the ground length of G^2, 1.0645 c/2B / cos(g) on the water's own range scale. A target at r
 * shows at r c_ref/c, and energies gain (c_ref/c)^4. */
static double closed_form(const struct sea *sea, double processor_range)
{
    const double c = sea->medium->sound_speed_mps;
    const double reference = sea->medium->reference_sound_speed_mps;
    const double range = processor_range * (reference > 0.0 ? c / reference : 1.0);
    const double sine = sea->sonar->altitude_m / range;
    const double delta = sea->sonar->along_track_resolution_m > 0.0
                             ? sea->sonar->along_track_resolution_m
                             : sea->geometry->row_spacing_m;
    const double length = sqrt(PI / (4.0 * log(2.0))) * c / (2.0 * sea->sonar->bandwidth_hz);
    return sea->seabed->lambert * sine * sine * delta * length / sqrt(1.0 - sine * sine) *
           pow(processor_range / range, 4.0);
}

/* Cases are ranges, rays, a wrong sound speed, a source beside the receiver, which changes path and
 * angle by a few mm in 30 m, and another pixel grid, resolution and bandwidth. */
CLAIM(the_level_is_lamberts)
{
    static const struct {
        double range, rays, reference_speed, source, row, column, resolution, bandwidth;
    } cases[] = {
        {14.0, 1.0, 0.0, 0.0, 0.025, 0.025, 0.0, 30e3},
        {50.0, 1.0, 0.0, 0.0, 0.025, 0.025, 0.0, 30e3},
        {180.0, 1.0, 0.0, 0.0, 0.025, 0.025, 0.0, 30e3},
        {30.0, 1.0, 0.0, 0.0, 0.025, 0.025, 0.0, 30e3},
        {30.0, 4.0, 0.0, 0.0, 0.025, 0.025, 0.0, 30e3},
        {30.0, 16.0, 0.0, 0.0, 0.025, 0.025, 0.0, 30e3},
        {30.0, 1.0, 1400.0, 0.0, 0.025, 0.025, 0.0, 30e3},
        {30.0, 1.0, 0.0, 0.1, 0.025, 0.025, 0.0, 30e3},
        {30.0, 1.0, 0.0, 0.0, 0.03, 0.01, 0.02, 50e3},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, cases[i].range);
        sea->injection->ray_scale = cases[i].rays;
        if (cases[i].reference_speed > 0.0)
            sea->medium->reference_sound_speed_mps = cases[i].reference_speed;
        sea->sonar->transducer_side_m = cases[i].source;
        sea->geometry->row_spacing_m = cases[i].row;
        sea->geometry->column_spacing_m = cases[i].column;
        if (cases[i].resolution > 0.0)
            sea->sonar->along_track_resolution_m = cases[i].resolution;
        sea->sonar->bandwidth_hz = cases[i].bandwidth;
        sea_move(sea, cases[i].range);
        const struct image *image = sea_image_of(sea, NULL, true);
        const struct estimate energy = level_over(sea, image, EDGE, EDGE, false, closed_form);
        const struct estimate field = level_over(sea, image, EDGE, EDGE, true, closed_form);
        print_message("%.0f m, %.0f times the rays\n", cases[i].range, cases[i].rays);
        /* W's tail beyond the kept reach has 0.1 % of the energy */
        expect_estimate("expected energy over closed form", energy, 1.0, 2e-3);
        expect_estimate("realisation over closed form", field, 1.0, 2e-3);
        expect_below("4 standard errors of the realisation", 4.0 * field.error, 0.047); /* 0.2 dB */
        expect_below("largest scatter of the expected energy", energy.error, 1e-3);
    }
}

/* A map multiplies the level, by 3 in one half along the track and by 10 in one half in range. The
 * middle of each quarter shows it. Steps lie between pixels, with half-way energy. */
CLAIM(a_map_multiplies)
{
    static const size_t at[4][2] = {{60, 50}, {180, 50}, {60, 150}, {180, 150}};
    static const double factor[4] = {1.0, 3.0, 10.0, 30.0};
    struct sea *sea = sea_open(ROWS, COLUMNS, 30.0);
    float *map = claim_memory(sea->pixels, sizeof *map);
    for (size_t i = 0; i < sea->pixels; i++)
        map[i] = (float)((i / COLUMNS < ROWS / 2 ? 1.0 : 3.0) *
                         (i % COLUMNS < COLUMNS / 2 ? 1.0 : 10.0));
    const struct image *image = sea_image_of(sea, map, false);
    double *ratio = claim_memory(sea->pixels, sizeof *ratio);
    for (size_t i = 0; i < sea->pixels; i++)
        ratio[i] =
            image->seabed_energy[i] / closed_form(sea, sea_range(sea, (double)(i % COLUMNS)));
    for (size_t i = 0; i < 4; i++) {
        double sum = 0.0;
        for (size_t row = at[i][0] - 10; row < at[i][0] + 10; row++)
            for (size_t column = at[i][1] - 10; column < at[i][1] + 10; column++)
                sum += ratio[row * COLUMNS + column];
        /* W's side lobes bring in some of the brighter half: 1/(pi^2 50) of 2 times its level */
        expect_close("over closed form", sum / 400.0 / factor[i], 1.0, 0.01);
    }
    double line[COLUMNS] = {0.0};
    for (size_t row = 40; row < 80; row++)
        for (size_t column = 0; column < COLUMNS; column++)
            line[column] += ratio[row * COLUMNS + column] / 40.0;
    size_t step = 80;
    while (step < 120 && line[step + 1] < 5.5)
        step++;
    expect_close("step of the map, column",
                 (double)step + (5.5 - line[step]) / (line[step + 1] - line[step]),
                 COLUMNS / 2 - 0.5, 0.1);
    step = 100;
    while (step < 140 && ratio[(step + 1) * COLUMNS + 50] < 2.0)
        step++;
    expect_close("step of the map, row", (double)step + 0.5, ROWS / 2 - 0.5, 0.51);
}

/* The energy of a strip up to a ground range y is the integral of mu sin^2(grazing) over its
 * length, mu h atan(y/h). There is none before the bin whose middle comes last before the first
 * return. The sonar is 10 m over the seabed, or 2 m in a patch that begins within reach of the
 * pulse. */
CLAIM(the_first_return)
{
    static const double ranges[] = {10.6, 3.01}, altitudes[] = {10.0, 2.0};
    for (int i = 0; i < 2; i++) {
        struct sea *sea = sea_open(48, 241, ranges[i]);
        const double h = altitudes[i];
        sea->sonar->altitude_m = h;
        const struct strips rough = sea_rough(sea, NULL, NULL);
        const double strip = sea->geometry->row_spacing_m / rough.strips_per_row;
        const double per_pixel = rough.bins_per_pixel;
        double sum = 0.0;
        for (int bin = 0; bin < rough.bins; bin++) {
            const double next = sea_range(sea, (rough.first_bin + bin + 1) / per_pixel);
            const double end = sea_range(sea, (rough.first_bin + bin + 0.5) / per_pixel);
            for (int q = 0; q < rough.strips; q++)
                sum += (double)rough.energy[q * rough.bins + bin] / rough.strips;
            assert_true(next >= h || sum == 0.0);
            if (bin % 200 == 150 && end > h) /* sharing smooths the sum over a bin of 3 mm; 0.5 m
                                                on, 1e-5 of its curvature is left */
                expect_close(
                    "energy so far over the closed form",
                    sum / (sea->seabed->lambert * strip * h * atan(sqrt(end * end - h * h) / h)),
                    1.0, 0.001);
        }
        assert_true(sum > 0.0);
    }
}

/* Echoes from beyond the middles of the outermost bins are shared with these, too, since rays go
 * that far. Each outermost bin has the energy of its neighbour but for 1e-4 of range. */
CLAIM(outermost_bins_are_full)
{
    struct sea *sea = sea_open(64, 96, 50.0);
    sea->injection->ray_scale = 16.0;
    const struct strips rough = sea_rough(sea, NULL, NULL);
    for (int end = 0; end < 2; end++) {
        double sum = 0.0, square = 0.0;
        for (int strip = 0; strip < rough.strips; strip++) {
            const float *line = &rough.energy[strip * rough.bins];
            const double ratio = end == 0 ? (double)line[0] / (double)line[1]
                                          : (double)line[rough.bins - 1] / line[rough.bins - 2];
            sum += ratio;
            square += ratio * ratio;
        }
        expect_estimate("outermost bin over the one beside it",
                        estimate_of_sums(sum, square, rough.strips), 1.0, 1e-3);
    }
}

/* ---- echoes between bins ---- */

#define STEPS   16 /* of the face, within a pixel */
#define REACH   3  /* pixels on either side that hold its echo */
#define SIDE_M  0.1
#define LAMBERT 0.2

/* Gives the energy of the pixels about a rough face by column, over all rows. Returns the face's
 * range less that of the middle pixel, m. */
static double trace_face(struct sea *sea, int step, double energy[2 * REACH + 1])
{
    sonject_object_params *face = sea_object(sea, 0);
    place_in_metres(face, 0.5 * (double)sea->rows * 0.025, 50.0 + 0.025 * step / STEPS);
    for (int i = 0; i < 2; i++) { /* the face hangs by its lowest point */
        sea_ready(sea);
        const double *centre = sea_centre(sea, 0);
        face->roll_rad = 0.5 * PI - atan2(sea->sonar->altitude_m - centre[2], centre[1]);
    }
    const struct image *image = sea_image(sea);
    const double column = sea_column(sea, sea_slant_range(sea, 0));
    const size_t middle = (size_t)(column + 0.5);
    for (size_t k = 0; k <= 2 * REACH; k++) {
        energy[k] = 0.0;
        for (size_t row = 0; row < image->rows; row++)
            energy[k] += (double)image->target_energy[row * image->columns + middle + k - REACH];
    }
    return (column - (double)middle) * 0.025;
}

/* A rough face at one range moves through a pixel in steps finer than bins. Its echo is the pulse
 * at its own range, of its own energy, wherever bins lie. Sharing between bins d apart widens the
 * pulse's energy, a Gaussian of variance s^2, by up to d^2/4. With d = s/3.4 its peak is 0.047 dB
 * low at most, and 0.02 mm off. Rays count the face's area to 0.2 %. Bins keep a pixel's mean. */
CLAIM(a_face_within_a_pixel)
{
    static double energy[STEPS][2 * REACH + 1], beyond[STEPS];
    struct sea *sea = sea_open(64, 96, 50.0);
    sea->injection->ray_scale = 16.0;
    sonject_object_params *face = sea_add(sea, SHAPE_PLANE, SIDE_M, SIDE_M, 0.0);
    face->burial_m = -1.0;
    make_rough(face, LAMBERT);
    double sum = 0.0;
    for (int step = 0; step < STEPS; step++) {
        beyond[step] = trace_face(sea, step, energy[step]);
        for (int k = 0; k <= 2 * REACH; k++)
            sum += energy[step][k];
    }
    const double deviation = 0.025 / (2.0 * sqrt(log(2.0))); /* of G^2 times sqrt(2) */
    const double peak = sum * 0.025 / STEPS / (deviation * sqrt(PI));
    double farthest = 0.0, off = 0.0, worst = 0.0;
    for (int step = 0; step < STEPS; step++) {
        /* where the parabola through three logarithms peaks */
        const double *e = &energy[step][REACH - 1];
        const double slope = 0.5 * log(e[2] / e[0]), bend = log(e[2] * e[0] / (e[1] * e[1]));
        const double level = exp(log(e[1]) - 0.5 * slope * slope / bend);
        const double from_pixel = beyond[step] / deviation;
        farthest = fmax(farthest, fabs(-slope / bend * 0.025 - beyond[step]));
        off = fmax(off, fabs(decibels_of_energy(level / peak)));
        worst = fmax(worst, fabs(decibels_of_energy(energy[step][REACH] / peak *
                                                    exp(from_pixel * from_pixel))));
    }
    /* of all rows, but for the response's tails */
    expect_close("energy over the face's", peak / (LAMBERT * SIDE_M * SIDE_M), 1.0, 0.02);
    expect_below("peak's range off the face's, mm", 1e3 * farthest, 0.1);
    expect_below("level off the face's, dB", off, 0.05);
    expect_below("the nearest pixel off the pulse, dB", worst, 0.05);
}

/* ---- speckle ---- */

#define SIDE   480 /* pixels */
#define MARGIN 40  /* pixels next to an edge, which lack a part of their response */
#define BLOCKS 20  /* of rows, for standard errors from the scatter between them */

static struct sea *open_speckle(double ray_scale, uint64_t seed)
{
    struct sea *sea = sea_open(SIDE, SIDE, 40.0);
    sea->injection->ray_scale = ray_scale;
    sea->injection->seed = seed;
    sea->sonar->along_track_resolution_m = 0.05; /* two rows, so that rows correlate */
    sea_ready(sea);
    return sea;
}

/* Returns the seabed's realisation over the root of the expected energy. */
static const double complex *speckle_of(double ray_scale, uint64_t seed)
{
    struct sea *sea = open_speckle(ray_scale, seed);
    double complex *field = claim_memory(sea->pixels, sizeof *field);
    const struct image *image = sea_image_of(sea, NULL, true);
    for (size_t i = 0; i < sea->pixels; i++)
        field[i] =
            image->seabed[i] / sqrt(sea_seabed_level(sea, sea_range(sea, (double)(i % SIDE))));
    return field;
}

/* Compares intensities on a lattice of 3 resolutions or more with an exponential law. */
static void expect_exponential(const double complex *field)
{
    double *samples = claim_memory(SIDE * SIDE, sizeof *samples);
    size_t count = 0;
    double sum = 0.0, squares = 0.0, distance = 0.0;
    for (size_t row = MARGIN; row < SIDE - MARGIN; row += 6)
        for (size_t column = MARGIN; column < SIDE - MARGIN; column += 4) {
            const double intensity = pow(cabs(field[row * SIDE + column]), 2.0);
            samples[count++] = intensity;
            sum += intensity;
            squares += intensity * intensity;
        }
    const double n = (double)count, mean = sum / n;
    qsort(samples, count, sizeof *samples, compare_doubles);
    for (size_t i = 0; i < count; i++) {
        const double expected = 1.0 - exp(-samples[i]);
        distance = fmax(distance, fmax((double)(i + 1) / n - expected, expected - (double)i / n));
    }
    /* the mean and the contrast of exponential intensities both have the standard error 1/sqrt(n).
     * Kolmogorov's distance stays below 2.27/sqrt(n) as often as a normal deviate within 4 sigma.
     * The tail of W that is left out takes 0.1 % of the mean */
    expect_close("mean", mean, 1.0, 4.0 / sqrt(n) + 1e-3);
    expect_close("contrast", sqrt(squares / n - mean * mean) / mean, 1.0, 4.0 / sqrt(n));
    expect_below("Kolmogorov-Smirnov distance", distance, 2.27 / sqrt(n) + 4e-4);
}

/* Gives the mean of conj(a) b at a lag, real and imaginary part, with the standard error from the
 * scatter of row blocks. */
static void correlate(const double complex *a, const double complex *b, size_t rows, size_t columns,
                      struct estimate parts[2])
{
    const size_t block = (SIDE - 2 * MARGIN) / BLOCKS;
    double means[2][BLOCKS];
    for (size_t k = 0; k < BLOCKS; k++) {
        double complex sum = 0.0;
        for (size_t row = MARGIN + k * block; row < MARGIN + (k + 1) * block; row++)
            for (size_t i = row * SIDE + MARGIN; i < row * SIDE + SIDE - MARGIN; i++)
                sum += conj(a[i]) * b[i + rows * SIDE + columns];
        means[0][k] = creal(sum) / (double)(block * (SIDE - 2 * MARGIN));
        means[1][k] = cimag(sum) / (double)(block * (SIDE - 2 * MARGIN));
    }
    for (int part = 0; part < 2; part++)
        parts[part] = estimate_of(means[part], BLOCKS);
}

/* The autocorrelation of sinc(x/delta) is the sinc, that of exp(-r^2/2s^2) is exp(-r^2/4s^2). */
static void expect_response(const double complex *field)
{
    const double deviation = 0.025 / (2.0 * sqrt(log(2.0))); /* c/2B = 2.5 cm */
    static const size_t lags[][2] = {{1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {0, 1},
                                     {0, 2}, {0, 3}, {1, 1}, {3, 2}, {0, 8}, {9, 0}};
    for (size_t i = 0; i < COUNT(lags); i++) {
        const double range = (double)lags[i][1] * 0.025 / deviation;
        struct estimate parts[2];
        correlate(field, field, lags[i][0], lags[i][1], parts);
        print_message("lag of %zu rows, %zu columns\n", lags[i][0], lags[i][1]);
        expect_estimate("correlation", parts[0],
                        sinc((double)lags[i][0] / 2.0) * exp(-0.25 * range * range), 1e-3);
        expect_estimate("its imaginary part", parts[1], 0.0, 0.0);
        expect_below("standard error", parts[0].error, 0.02);
    }
}

CLAIM(speckle_is_gaussian_with_the_responses_correlation)
{
    for (int i = 0; i < 3; i++) {
        print_message("%s\n", i == 0 ? "noise" : i == 1 ? "seabed" : "seabed, 16 times the rays");
        const double complex *field = i == 0 ? sea_noise(open_speckle(1.0, 1), NOISE_OF_IMAGE)
                                             : speckle_of(i == 1 ? 1.0 : 16.0, 1);
        expect_exponential(field);
        expect_response(field);
    }
}

CLAIM(fields_are_independent)
{
    const double complex *seabed = speckle_of(1.0, 1);
    const double complex *noise = sea_noise(open_speckle(1.0, 1), NOISE_OF_IMAGE);
    const struct {
        const char *name;
        const double complex *one, *other;
    } pairs[] = {
        {"seabed of two seeds", seabed, speckle_of(1.0, 2)},
        {"seabed of two seeds' upper words", seabed, speckle_of(1.0, (uint64_t)1 << 32 | 1)},
        {"seabed and noise", seabed, noise},
        {"noise and input phase", noise, sea_noise(open_speckle(1.0, 1), NOISE_OF_PHASE)},
    };
    for (size_t i = 0; i < COUNT(pairs); i++)
        for (size_t lag = 0; lag < 4; lag++) {
            struct estimate parts[2];
            correlate(pairs[i].one, pairs[i].other, lag / 2, lag % 2, parts);
            for (int part = 0; part < 2; part++)
                expect_estimate(pairs[i].name, parts[part], 0.0, 0.0);
        }
}
