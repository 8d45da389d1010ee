#include "scene/sediment.h"

#include <complex.h>
#include <math.h>

#define PI       3.14159265358979323846
#define EXPONENT 3.25                   /* exponent of the relief's spectrum */
#define ALPHA    (0.5 * EXPONENT - 1.0) /* half the exponent of its structure function */
#define DEGREES  (180.0 / PI)

struct sediment sediment_of_grain_size(double phi)
{
    struct sediment sediment;
    const double square = phi * phi;
    double attenuation; /* dB per m and kHz */
    if (phi < 1.0) {
        sediment.density_ratio = 0.007797 * square - 0.17057 * phi + 2.3139;
        sediment.speed_ratio = 0.002709 * square - 0.056452 * phi + 1.2778;
    } else if (phi < 5.3) {
        sediment.density_ratio =
            -0.0165406 * square * phi + 0.2290201 * square - 1.1069031 * phi + 3.0455;
        sediment.speed_ratio =
            -0.0014881 * square * phi + 0.0213937 * square - 0.1382798 * phi + 1.3425;
    } else {
        sediment.density_ratio = -0.0012973 * phi + 1.1565;
        sediment.speed_ratio = -0.0024324 * phi + 1.0019;
    }
    if (phi < 0.0)
        attenuation = 0.4556;
    else if (phi < 2.6)
        attenuation = 0.4556 + 0.0245 * phi;
    else if (phi < 4.5)
        attenuation = 0.1978 + 0.1245 * phi;
    else if (phi < 6.0)
        attenuation = 8.0399 - 2.5228 * phi + 0.20098 * square;
    else
        attenuation = 0.9431 - 0.2041 * phi + 0.0117 * square;
    /* the water's sound speed is the handbook's 1528 m/s */
    sediment.loss = attenuation * sediment.speed_ratio * 1.528 * log(10.0) / (40.0 * PI);
    sediment.volume = phi < 5.5 ? 0.002 : 0.001;
    const double relief_cm =
        phi < 5.0 ? (2.03846 - 0.26923 * phi) / (1.0 + 0.076923 * phi) : 0.5; /* rms over a metre */
    sediment.strength = 0.00207 * relief_cm * relief_cm;
    return sediment;
}

/* Returns the vertical wavenumber in the sediment over the water's wavenumber. */
static double complex upright(const struct sediment *sediment, double grazing)
{
    const double complex ratio = (1.0 + sediment->loss * I) / sediment->speed_ratio;
    return csqrt(ratio * ratio - cos(grazing) * cos(grazing));
}

static double complex reflection(const struct sediment *sediment, double grazing)
{
    const double complex y = sediment->density_ratio * sin(grazing) / upright(sediment, grazing);
    return (y - 1.0) / (y + 1.0);
}

/* Returns the scattering of small roughness by perturbation theory. wavenumber: 1/cm. */
static double of_small_roughness(const struct sediment *sediment, double wavenumber, double grazing)
{
    const double density = sediment->density_ratio, across = cos(grazing), up = sin(grazing);
    const double complex ratio = (1.0 + sediment->loss * I) / sediment->speed_ratio;
    const double complex root = density * up + upright(sediment, grazing);
    const double complex y =
        ((density - 1.0) * (density - 1.0) * across * across + density * density - ratio * ratio) /
        (root * root);
    const double bragg = wavenumber * sqrt(4.0 * across * across + 0.01);
    return 4.0 * pow(wavenumber * up, 4.0) * pow(cabs(y), 2.0) * sediment->strength *
           pow(bragg, -EXPONENT);
}

static double of_volume(const struct sediment *sediment, double wavenumber, double grazing)
{
    const double complex root = upright(sediment, grazing), r = reflection(sediment, grazing);
    (void)wavenumber;
    return 5.0 * sediment->loss * sediment->volume * pow(cabs(1.0 - r * r) * sin(grazing), 2.0) /
           (sediment->speed_ratio * log(10.0) * pow(cabs(root), 2.0) * cimag(root));
}

/* Returns the mean over large slopes, by Gauss and Hermite. */
static double over_slopes(const struct sediment *sediment, double wavenumber, double grazing,
                          double slope,
                          double (*scattering)(const struct sediment *, double, double))
{
    static const double nodes[] = {1.224745, 0.0, -1.224745};
    static const double weights[] = {0.166667, 0.666667, 0.166667};
    double mean = 0.0;
    for (int i = 0; i < 3; i++) {
        const double tilted = fmin(grazing - nodes[i] * slope, 0.5 * PI);
        mean += tilted > 0.0 ? weights[i] * scattering(sediment, wavenumber, tilted) : 0.0;
    }
    return mean;
}

/* Returns the share of the ground that slopes of that rms do not hide. */
static double lit_share(double grazing, double slope)
{
    const double t = tan(grazing) / slope;
    const double q = (exp(-t * t) / sqrt(PI) - t * erfc(t)) / (4.0 * t);
    return t > 2.0 ? 1.0 : (1.0 - exp(-2.0 * q)) / (2.0 * q);
}

static double falling(double x)
{
    return 1.0 / (1.0 + exp(fmin(fmax(x, -40.0), 40.0)));
}

/* Kirchhoff's approximation near the vertical, with a fraction that is exact there in place of the
 * integral over the structure function q. */
struct kirchhoff {
    double a, b, q;
};

static struct kirchhoff kirchhoff_of(const struct sediment *sediment, double wavenumber)
{
    struct kirchhoff k;
    const double structure = 2.0 * PI * sediment->strength * tgamma(2.0 - ALPHA) *
                             pow(2.0, -2.0 * ALPHA) / (ALPHA * (1.0 - ALPHA) * tgamma(1.0 + ALPHA));
    k.q = structure * pow(2.0, 1.0 - 2.0 * ALPHA) * pow(wavenumber, 2.0 * (1.0 - ALPHA));
    k.a = pow(8.0 * ALPHA * ALPHA * tgamma(0.5 / ALPHA + 0.5) /
                  (tgamma(0.5) * tgamma(1.0 / ALPHA) * tgamma(0.5 / ALPHA)),
              2.0 * ALPHA);
    k.b = pow(k.a, 0.5 + 0.5 / ALPHA) * tgamma(1.0 / ALPHA) / (2.0 * ALPHA);
    return k;
}

/* Returns the scattering of gravel and coarser relief, fitted to measurements. */
static double of_large_relief(const struct sediment *sediment, double grazing, double slope,
                              double upright_share)
{
    const double speed = sediment->speed_ratio, angle = grazing * DEGREES, s = slope * DEGREES;
    const double critical = speed >= 1.001 ? acos(1.0 / speed) * DEGREES : 2.5613;
    const double bent = 1.0 + 0.81 * critical * critical / (angle * angle);
    const double level = 0.04682 * pow(slope, 1.25) * pow(speed, 3.25) *
                         pow((1.0 - 2.0 / sediment->density_ratio) / (speed * speed) + 1.0, 2.0) /
                         (1.0 + 3.54 * s / critical);
    const double off = angle - 90.0;
    return level * pow(sin(PI / bent), 0.7263 * pow(slope, -1.0 / 3.0)) +
           0.0260 * upright_share /
               (slope * slope * pow(1.0 + off * off / (2.6 * s * s), 1.9) * bent);
}

double sediment_backscatter(const struct sediment *sediment, double wavelength_m,
                            double grazing_rad)
{
    const double grazing = fmax(grazing_rad, 1e-3 / DEGREES);
    const double wavenumber = 2.0 * PI / (100.0 * wavelength_m); /* 1/cm */
    const double upright_share = pow(cabs(reflection(sediment, 0.5 * PI)), 2.0);
    const double slope =
        sqrt(pow(2.0 * PI * sediment->strength, 1.0 / ALPHA) / (2.0 * (1.0 - ALPHA)) *
             pow(wavenumber * wavenumber / ALPHA, (1.0 - ALPHA) / ALPHA));
    const struct kirchhoff k = kirchhoff_of(sediment, wavenumber);
    const double lit = lit_share(grazing, slope);
    const double steep =
        grazing * DEGREES < 40.0
            ? 0.0
            : k.b * k.q * upright_share /
                  (8.0 * PI *
                   pow(pow(cos(grazing), 4.0 * ALPHA) + k.a * k.q * k.q * pow(sin(grazing), 4.0),
                       (1.0 + ALPHA) / (2.0 * ALPHA)));
    const double flat = lit * over_slopes(sediment, wavenumber, grazing, slope, of_small_roughness);
    const double c = pow(1000.0, 1.0 / (1.0 + ALPHA)) * pow(k.a * k.q * k.q, 1.0 / ALPHA);
    const double steep_share = falling((cos(grazing) - pow(1.0 / c + 4.0, -0.25)) / 0.0125);
    const double moderate_share = falling((atan(slope) * DEGREES - 7.0) / 0.5);
    const double surface =
        moderate_share * (steep_share * steep + (1.0 - steep_share) * flat) +
        (1.0 - moderate_share) * of_large_relief(sediment, grazing, slope, upright_share);
    return surface + lit * over_slopes(sediment, wavenumber, grazing, slope, of_volume);
}

double sediment_lambert(double phi, double wavelength_m, double grazing_rad)
{
    const struct sediment sediment = sediment_of_grain_size(phi);
    const double up = sin(grazing_rad);
    return fmin(sediment_backscatter(&sediment, wavelength_m, grazing_rad) / (up * up), 1.0 / PI);
}
