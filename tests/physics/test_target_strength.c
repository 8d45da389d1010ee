/* An object's target strength is its own: its echo's peak, wherever pixels lie and however far
 * apart they are. */
#include "sea.h"

#define RANGE       50.0
#define RESOLUTION  0.025
#define WAVELENGTH  0.015
#define CLOSED_FORM 0.05    /* dB: systematic, of bins and of parabolas between points */
#define ROUGH_DB    0.2     /* its energies are known by strips of a resolution */
#define GIBBS       1.08949 /* 1/2 + Si(pi)/pi: sinc passing over the end of a line */

/* Pixels, m: along the track and in range; and where a centre lies between them. */
static const double spacings[][2] = {{0.025, 0.025}, {0.01, 0.0125}, {0.1, 0.075}};
static const double offsets[][2] = {{0.0, 0.0}, {0.5, 0.27}, {0.21, 0.5}, {0.77, 0.83}};
#define PLACES (COUNT(spacings) * COUNT(offsets))

static struct sea *hang(size_t place, enum shape_kind shape, double length_m, double diameter_m)
{
    const double *spacing = spacings[place % COUNT(spacings)];
    const double *offset = offsets[place / COUNT(spacings)];
    struct sea *sea = sea_open((size_t)(4.0 / spacing[0]), (size_t)(4.0 / spacing[1]), RANGE);
    sea->sonar->along_track_resolution_m = RESOLUTION;
    sea->geometry->row_spacing_m = spacing[0];
    sea->geometry->column_spacing_m = spacing[1];
    sea_move(sea, RANGE);
    sonject_object_params *object = sea_add(sea, shape, length_m, 0.0, diameter_m);
    object->burial_m = -1.0;
    place_in_pixels(object, floor(2.0 / spacing[0]) + offset[0],
                    floor(2.0 / spacing[1]) + offset[1]);
    return sea;
}

static double peak_db(struct sea *sea)
{
    return decibels_of_energy(sea_image(sea)->objects[0].peak_energy);
}

/* 1/lambda times the integral of sinc(x/delta) exp(2ikd) G(offset - d) over the disc, d the depth
 * of the sphere's front, where the pulse's middle makes it largest; the front is curved against the
 * wavefront. About a/2 times the factor of W alone, -0.8 dB and -3.2 dB for these. */
static double sphere_db(double a)
{
    const double deviation = 0.601 * RESOLUTION; /* of the default bandwidth: c/2B is 2.5 cm */
    const double step = WAVELENGTH / 40.0;
    double largest = 0.0;
    for (int i = 0; i < 8; i++) {
        double complex sum = 0.0;
        for (double x = 0.5 * step; x < a; x += step)
            for (double w = 0.5 * step; x * x + w * w < a * a; w += step) {
                const double depth = a - sqrt(a * a - x * x - w * w);
                const double behind = (i * 0.125 * RESOLUTION - depth) / deviation;
                sum += 4.0 * step * step * sinc(x / RESOLUTION) *
                       cexp(4.0 * PI * I * depth / WAVELENGTH - 0.5 * behind * behind);
            }
        largest = fmax(largest, cabs(sum) / WAVELENGTH);
    }
    return decibels_of_amplitude(largest / sqrt(1.0 + a / RANGE));
}

/* The level that is asked for is the target's, too, not that of a pixel. */
CLAIM(spheres_wherever_pixels_lie)
{
    static const double radii[] = {0.15, 0.3};
    const double expected[] = {sphere_db(radii[0]), sphere_db(radii[1])};
    for (size_t i = 0; i < 2 * PLACES; i++) {
        struct sea *sea = hang(i / 2, SHAPE_SPHERE, 0.0, 2.0 * radii[i % 2]);
        expect_close("sphere's target strength, dB", peak_db(sea), expected[i % 2], CLOSED_FORM);
        if (i % 2)
            continue;
        sea_object(sea, 0)->level_kind = SONJECT_LEVEL_TARGET_STRENGTH;
        sea_object(sea, 0)->level_db = -10.0;
        float *pixels = claim_memory(sea->pixels, sizeof *pixels);
        for (size_t k = 0; k < sea->pixels; k++)
            pixels[k] = 1.0f;
        const sonject_object_truth *truth = sea_inject(sea, pixels, false)->objects;
        expect_close("gain, dB", truth->level_gain_db, -10.0 - expected[0], CLOSED_FORM);
        expect_close("level, dB", truth->target_strength_db, -10.0, 1e-9);
    }
}

/* Broadside: sqrt(a / 2 lambda) delta where W passes over the line, Gibbs' overshoot at its end. */
CLAIM(a_cylinder_peaks_at_its_ends)
{
    for (size_t i = 0; i < PLACES; i++)
        expect_close("cylinder's target strength, dB", peak_db(hang(i, SHAPE_CYLINDER, 1.5, 0.3)),
                     decibels_of_amplitude(GIBBS * RESOLUTION * sqrt(0.5 * 0.15 / WAVELENGTH)),
                     CLOSED_FORM);
}

/* Lambert's sphere: the expected energy, speckle averaged out. No closed form is held here, but
 * that pixels do not matter. */
CLAIM(a_rough_sphere_wherever_pixels_lie)
{
    double lowest = INFINITY, highest = -INFINITY;
    for (size_t i = 0; i < PLACES; i += COUNT(spacings)) {
        struct sea *sea = hang(i, SHAPE_SPHERE, 0.0, 0.6);
        make_rough(sea_object(sea, 0), 0.1);
        const double peak = peak_db(sea);
        lowest = fmin(lowest, peak);
        highest = fmax(highest, peak);
    }
    expect_below("rough sphere's target strengths are apart, dB", highest - lowest, ROUGH_DB);
}
