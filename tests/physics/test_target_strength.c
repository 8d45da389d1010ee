/* An object's target strength is its echo's peak, wherever the pixels lie and at any spacing. */
#include "sea.h"

#define RANGE       50.0
#define RESOLUTION  0.025
#define WAVELENGTH  0.015
#define CLOSED_FORM 0.05    /* dB; systematic errors of bins and of parabolas between points */
#define ROUGH_DB    0.2     /* dB; rough energies are known in strips of a resolution */
#define GIBBS       1.08949 /* 1/2 + Si(pi)/pi, as a sinc passes over a line's end */

/* Spacings of pixels along the track and in range, m, and offsets of a centre from a pixel. */
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

/* Returns a sphere's target strength, dB: 1/lambda times the integral of sinc(x/delta) exp(2ikd)
 * G(offset - d) over the disc, with the offset that makes it largest. d is the depth behind the
 * sphere's foremost point. The root is for the wavefront's own curvature. The result is about a/2
 * times the factor of W alone, -0.8 dB and -3.2 dB for these spheres. */
static double sphere_db(double a)
{
    const double deviation = 0.601 * RESOLUTION; /* for the default c/2B of 2.5 cm */
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

/* A level that is asked for is the target's, too, and not a pixel's. */
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

/* At broadside the amplitude is sqrt(a / 2 lambda) delta where W passes over the line. At the
 * line's ends Gibbs' overshoot multiplies it. */
CLAIM(a_cylinder_peaks_at_its_ends)
{
    for (size_t i = 0; i < PLACES; i++)
        expect_close("cylinder's target strength, dB", peak_db(hang(i, SHAPE_CYLINDER, 1.5, 0.3)),
                     decibels_of_amplitude(GIBBS * RESOLUTION * sqrt(0.5 * 0.15 / WAVELENGTH)),
                     CLOSED_FORM);
}

#define BEAM_RANGE 100.0
#define BEAM_ARRAY 0.5

/* Returns the target strength of a 1.5 m by 0.3 m cylinder, 1 m above the seabed, to an array. It
 * is the largest over all pings of sqrt(a / 2 lambda) times the integral, along the cylinder, of
 * sinc(D x / lambda R)^2 (r / R)^2 exp(2ik (R - r)). R and x lead from the ping to the cylinder. */
static double cylinder_in_beam_db(double heading)
{
    const double altitude = 10.0, a = 0.15, length = 1.5;
    const double step = length / 2000.0;
    const double ground = sqrt(BEAM_RANGE * BEAM_RANGE - altitude * altitude);
    const double down = altitude - 1.0 - a;
    const double middle = hypot(ground, down) - a;
    double largest = 0.0;
    for (double ping = -2.0; ping <= 2.0; ping += 0.01) {
        double complex sum = 0.0;
        for (double s = 0.5 * (step - length); s < 0.5 * length; s += step) {
            const double x = s * cos(heading) - ping;
            const double range = hypot(hypot(ground + s * sin(heading), down) - a, x);
            const double beam = sinc(BEAM_ARRAY * x / (WAVELENGTH * range)) * middle / range;
            sum += step * beam * beam * cexp(4.0 * PI * I * (range - middle) / WAVELENGTH);
        }
        largest = fmax(largest, cabs(sum));
    }
    return decibels_of_amplitude(largest * sqrt(0.5 * a / WAVELENGTH));
}

/* The parts of a long target add up in a few pings, far fewer than the beam has, and those of a
 * slanting one beside it. */
CLAIM(a_cylinder_in_a_wide_beam)
{
    static const double headings[] = {0.0, 0.7 * PI / 180.0, PI / 180.0};
    for (size_t i = 0; i < COUNT(headings) * COUNT(spacings); i++) {
        const double heading = headings[i / COUNT(spacings)];
        struct sea *sea = hang(i % COUNT(spacings), SHAPE_CYLINDER, 1.5, 0.3);
        sea->sonar->kind = SONJECT_SONAR_REAL;
        sea->sonar->array_length_m = BEAM_ARRAY;
        sea->sonar->along_track_resolution_m = 0.0;
        sea->sonar->bandwidth_hz = 5e3;
        sea_object(sea, 0)->heading_rad = heading;
        sea_move(sea, BEAM_RANGE);
        expect_close("cylinder's target strength in a beam, dB", peak_db(sea),
                     cylinder_in_beam_db(heading), CLOSED_FORM);
    }
}

/* Pixels do not change the expected energy of a Lambert sphere, whose speckle is averaged out. It
 * is not compared with a closed form. */
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
