/* Tests kernels/surface.h and brdf.h against double precision: directions against their density,
 * energies by quadrature over the hemisphere, and reflection by complex arithmetic. */
#include "claims.h"

#include <complex.h>

#include "kernels/surface.h"

#define SAMPLES          200000
#define POLAR_CELLS      48  /* cells between the normal and the horizon */
#define TURN_CELLS       192 /* cells round the normal */
#define CELLS            (POLAR_CELLS * TURN_CELLS)
#define NODES            8
#define FURNACE_CELLS    64      /* cells in either angle */
#define SINGLE_PRECISION 5.97e-8 /* half a unit in the last place of 1 */

/* The nodes above 0 of Gauss and Legendre's rule on -1...1. */
static const double positive_nodes[NODES / 2] = {0.18343464249564980, 0.52553240991632899,
                                                 0.79666647741362674, 0.96028985649753623};
static const double positive_weights[NODES / 2] = {0.36268378337836198, 0.31370664587788729,
                                                   0.22238103445337447, 0.10122853629037626};

static double node_of(int i)
{
    return i < NODES / 2 ? -positive_nodes[i] : positive_nodes[i - NODES / 2];
}

static double weight_of(int i)
{
    return positive_weights[i % (NODES / 2)];
}

/* A generator of its own, so that the one in random.h plays no part. */
static uint64_t generator = 0x9e3779b97f4a7c15u;

/* Returns a number in 0...1 without the ends, exact in single precision. */
static double random_fraction(void)
{
    return ((double)(next_random(&generator) >> 41) + 0.5) / 8388608.0;
}

static float random_deviate(void)
{
    return (float)random_fraction();
}

/* A tilted surface. Its rows are two directions along the surface, and the normal. */
static const double frame[3][3] = {
    {0.8, 0.0, 0.6}, {-0.36, 0.8, 0.48}, {-0.48, -0.6, 0.64}}; /* a rotation, exactly */

static struct vector3 direction_at(double polar, double turn)
{
    const double along[3] = {sin(polar) * cos(turn), sin(polar) * sin(turn), cos(polar)};
    double sum[3];
    for (int k = 0; k < 3; k++)
        sum[k] = along[0] * frame[0][k] + along[1] * frame[1][k] + along[2] * frame[2][k];
    const struct vector3 direction = {(float)sum[0], (float)sum[1], (float)sum[2]};
    return direction;
}

static struct vector3 surface_normal(void)
{
    return direction_at(0.0, 0.0);
}

static double component(struct vector3 direction, int axis)
{
    /* rounded as the kernel's normal is, so that small cosines compare */
    return (double)direction.x * (double)(float)frame[axis][0] +
           (double)direction.y * (double)(float)frame[axis][1] +
           (double)direction.z * (double)(float)frame[axis][2];
}

static double degrees(double angle)
{
    return angle * PI / 180.0;
}

/* Returns the record of a fluid half-space. */
static struct surface_record fluid(double density, double speed, double loss)
{
    const double complex index = (1.0 + loss * I) / speed;
    const double complex square = index * index;
    struct surface_record surface = {.reflection_kind = REFLECTION_FLUID};
    surface.density_ratio = (float)density;
    surface.index_real = (float)creal(square);
    surface.index_imaginary = (float)cimag(square);
    surface.lambert_exponent = 1.0f;
    return surface;
}

static struct surface_record rough(double lambert, double exponent, double albedo, double slope)
{
    struct surface_record surface = {.reflection_kind = REFLECTION_NONE};
    surface.lambert = (float)lambert;
    surface.lambert_exponent = (float)exponent;
    surface.glossy_albedo = (float)albedo;
    surface.glossy_slope = (float)slope;
    return surface;
}

#define KINDS 7

static struct surface_record rough_kind(int kind)
{
    static const struct {
        double lambert, exponent, albedo, slope;
    } kinds[KINDS] = {{1.0 / PI, 1.0, 0.0, 0.1}, {1.0 / PI, 3.0, 0.0, 0.1},
                      {0.0, 1.0, 1.0, 0.05},     {0.0, 1.0, 1.0, 0.2},
                      {0.0, 1.0, 1.0, 0.6},      {0.6 / PI, 1.0, 0.4, 0.2},
                      {0.3 / PI, 3.0, 0.7, 0.6}};
    return rough(kinds[kind].lambert, kinds[kind].exponent, kinds[kind].albedo, kinds[kind].slope);
}

/* The number of smooth parts. Rough parts cover them as far as a material's limits just allow. */
#define SMOOTH_KINDS 6

static struct surface_record over_smooth(int kind, const struct surface_record *rough_part)
{
    struct surface_record surface = {.reflection_kind = REFLECTION_CONSTANT, .reflection = 0.9f};
    if (kind == 3 || kind == 5)
        surface = fluid(2.231, 1.2503, 0.01638); /* coarse sand */
    if (kind == 4)
        surface = fluid(1.149, 0.9873, 0.00386); /* silt */
    static const float phases[SMOOTH_KINDS] = {0.1f, 1.0f, 8.0f, 1.0f, 2.0f, 20.0f};
    surface.roughness_phase = phases[kind];
    const float available = surface.reflection_kind == REFLECTION_CONSTANT ? 0.81f : 1.0f;
    surface.lambert = rough_part->lambert * available;
    surface.lambert_exponent = rough_part->lambert_exponent;
    surface.glossy_albedo = rough_part->glossy_albedo * available;
    surface.glossy_slope = rough_part->glossy_slope;
    return surface;
}

/* ---- The same formulas in double precision ---- */

static double complex exact_reflection(const struct surface_record *surface, double cosine)
{
    if (surface->reflection_kind != REFLECTION_FLUID)
        return (double)surface->reflection;
    const double complex square =
        (double)surface->index_real + (double)surface->index_imaginary * I;
    const double complex root = csqrt(square - (1.0 - cosine * cosine));
    const double above = (double)surface->density_ratio * cosine;
    return (above - root) / (above + root);
}

/* Returns the part of |R|^2 that roughness leaves to the mirror. *scattered gets the rest. */
static double exact_specular(const struct surface_record *surface, double cosine, double *scattered)
{
    const double modulus = cabs(exact_reflection(surface, cosine));
    const double phase = (double)surface->roughness_phase * cosine;
    *scattered = -modulus * modulus * expm1(-phase * phase);
    return modulus * modulus * exp(-phase * phase);
}

struct facet {
    double tilt, half_angle, density; /* cosines; density 1/sr */
    double condition; /* relative error of the density over the error of the cosines */
};

static struct facet exact_facet(struct vector3 one, struct vector3 other, double slope)
{
    struct facet facet = {0.0, 0.0, 0.0, 0.0};
    double sum[3], square = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        sum[axis] = component(one, axis) + component(other, axis);
        square += sum[axis] * sum[axis];
    }
    facet.tilt = sum[2] / sqrt(square);
    facet.half_angle = 0.5 * sqrt(square);
    const double tangent = sqrt(1.0 / (facet.tilt * facet.tilt) - 1.0);
    facet.density =
        exp(-tangent * tangent / (slope * slope)) / (PI * slope * slope * pow(facet.tilt, 4.0));
    facet.condition =
        (4.0 + 2.0 / pow(slope * facet.tilt, 2.0)) * (1.0 + 0.5 / (facet.half_angle * facet.tilt));
    return facet;
}

static double exact_scattering(const struct surface_record *surface, struct vector3 one,
                               struct vector3 other, double *condition)
{
    const double in = component(one, 2), out = component(other, 2);
    const double n = (double)surface->lambert_exponent;
    double f = (double)surface->lambert * 0.5 * (n + 1.0) * pow(in * out, n - 1.0);
    *condition = 4.0 + n * (1.0 / in + 1.0 / out);
    if (surface->glossy_albedo > 0.0f) {
        const struct facet facet = exact_facet(one, other, (double)surface->glossy_slope);
        const double shading = fmin(1.0, 2.0 * facet.tilt * fmin(in, out) / facet.half_angle);
        f += (double)surface->glossy_albedo * facet.density * shading / (4.0 * in * out);
        *condition += facet.condition;
    }
    return f;
}

static double exact_density(const struct surface_record *surface, struct vector3 back,
                            struct vector3 direction, double *condition)
{
    const double n = (double)surface->lambert_exponent;
    const double diffuse = PI * (double)surface->lambert;
    const double cone = (double)surface->glossy_albedo;
    double density =
        diffuse * (n + 1.0) / (2.0 * PI) * pow(component(direction, 2), n) / (diffuse + cone);
    *condition = 4.0 + n / component(direction, 2);
    if (cone > 0.0) {
        const struct facet facet = exact_facet(back, direction, (double)surface->glossy_slope);
        density += cone / (diffuse + cone) * facet.density * facet.tilt / (4.0 * facet.half_angle);
        *condition += facet.condition;
    }
    return density;
}

static struct vector3 random_direction(double least_cosine)
{
    const double cosine = least_cosine + (1.0 - least_cosine) * random_fraction();
    return direction_at(acos(cosine), 2.0 * PI * random_fraction());
}

TEST(test_formulas)
{
    for (int kind = 0; kind < KINDS; kind++) {
        const struct surface_record surface = rough_kind(kind);
        double worst_scattering = 0.0, worst_density = 0.0;
        for (int i = 0; i < SAMPLES; i++) {
            const struct vector3 one = random_direction(0.01);
            const struct vector3 other = random_direction(0.01);
            double condition;
            const double f = exact_scattering(&surface, one, other, &condition);
            const double f_found = (double)rough_scattering(&surface, surface_normal(), one, other);
            /* the kernel's exponential ends at exp(-80) = 2e-35 */
            if (f > 1e-30)
                worst_scattering = fmax(worst_scattering, fabs(f_found / f - 1.0) / condition);
            const double p = exact_density(&surface, one, other, &condition);
            const double p_found =
                (double)rough_direction_density(&surface, surface_normal(), one, other);
            if (p > 1e-30)
                worst_density = fmax(worst_density, fabs(p_found / p - 1.0) / condition);
        }
        print_message("kind %d: scattering off by %.2g, density by %.2g of the cosines' error\n",
                      kind, worst_scattering / SINGLE_PRECISION, worst_density / SINGLE_PRECISION);
        /* a cosine is three products, two sums and a normalisation: 8 roundings */
        assert_true(worst_scattering < 8.0 * SINGLE_PRECISION);
        assert_true(worst_density < 8.0 * SINGLE_PRECISION);
    }
}

/* ---- Directions against their density ---- */

static double expected[CELLS], counted[CELLS];

static double density_over_cell(const struct surface_record *surface, struct vector3 back,
                                int polar_cell, int turn_cell)
{
    const double height = 0.5 * PI / POLAR_CELLS, width = 2.0 * PI / TURN_CELLS;
    double sum = 0.0;
    for (int i = 0; i < NODES; i++) {
        const double polar = height * (polar_cell + 0.5 + 0.5 * node_of(i));
        for (int j = 0; j < NODES; j++) {
            const double turn = width * (turn_cell + 0.5 + 0.5 * node_of(j));
            const float density =
                rough_direction_density(surface, surface_normal(), back, direction_at(polar, turn));
            sum += weight_of(i) * weight_of(j) * sin(polar) * (double)density;
        }
    }
    return 0.25 * height * width * sum;
}

/* Returns the cell of a direction, -1 below the surface. */
static int cell_of(struct vector3 direction)
{
    const double cosine = component(direction, 2);
    if (cosine <= 0.0)
        return -1;
    double turn = atan2(component(direction, 1), component(direction, 0)) / (2.0 * PI);
    turn -= floor(turn);
    const int polar_cell = (int)(acos(fmin(cosine, 1.0)) / (0.5 * PI) * POLAR_CELLS);
    const int turn_cell = (int)(turn * TURN_CELLS);
    return (polar_cell < POLAR_CELLS ? polar_cell : POLAR_CELLS - 1) * TURN_CELLS +
           (turn_cell < TURN_CELLS ? turn_cell : 0);
}

/* Returns the statistic over blocks of block x block cells. Cells below 20 expected are merged. */
static double chi_square(int block, int *freedom)
{
    double statistic = 0.0, want = 0.0, have = 0.0, wanted = 0.0, had = 0.0;
    int groups = 0;
    for (int p = 0; p < POLAR_CELLS; p += block)
        for (int t = 0; t < TURN_CELLS; t += block) {
            for (int i = 0; i < block * block; i++) {
                const int cell = (p + i / block) * TURN_CELLS + t + i % block;
                want += expected[cell];
                have += counted[cell];
            }
            if (want >= 20.0) {
                statistic += (have - want) * (have - want) / want;
                wanted += want;
                had += have;
                groups++;
                want = have = 0.0;
            }
        }
    /* the last group is all that is left, and all below the surface */
    want = SAMPLES - wanted;
    have = SAMPLES - had;
    if (want >= 20.0) {
        statistic += (have - want) * (have - want) / want;
        groups++;
    }
    *freedom = groups - 1;
    return statistic;
}

static void expect_directions_as_density(const struct surface_record *surface, int kind,
                                         double angle)
{
    const struct vector3 back = direction_at(degrees(angle), 0.1);
    double above = 0.0;
    for (int cell = 0; cell < CELLS; cell++) {
        const double share = density_over_cell(surface, back, cell / TURN_CELLS, cell % TURN_CELLS);
        above += share;
        expected[cell] = SAMPLES * share;
        counted[cell] = 0.0;
    }
    int below = 0;
    for (int i = 0; i < SAMPLES; i++) {
        const float choice = random_deviate(), u = random_deviate(), v = random_deviate();
        const int cell =
            cell_of(sample_rough_direction(surface, surface_normal(), back, choice, u, v));
        if (cell < 0)
            below++;
        else
            counted[cell] += 1.0;
    }
    print_message("kind %d at %2.0f degrees: below %.5f, 1 - integral %.5f", kind, angle,
                  (double)below / SAMPLES, 1.0 - above);
    for (int block = 1; block <= 8; block *= 8) {
        int freedom;
        const double statistic = chi_square(block, &freedom);
        print_message("; chi square %.1f of %d", statistic, freedom);
        /* B. Laurent, P. Massart (Ann. Stat. 28, 2000): chi square exceeds d + 2 sqrt(d x) + 2 x
         * with a probability of at most exp(-x); exp(-13.9) < 1e-6 */
        assert_true(statistic < freedom + 2.0 * sqrt(13.9 * freedom) + 2.0 * 13.9);
    }
    print_message("\n");
    const double share = fmax(0.0, 1.0 - above);
    /* 4 standard errors, and 1e-5 for quadrature in single precision */
    assert_true(fabs((double)below / SAMPLES - share) <
                4.0 * sqrt(share * (1.0 - share) / SAMPLES) + 1e-5);
}

TEST(test_directions)
{
    static const double angles[] = {0.0, 45.0, 80.0};
    for (int kind = 0; kind < KINDS; kind++) {
        const struct surface_record surface = rough_kind(kind);
        for (size_t i = 0; i < COUNT(angles); i++)
            expect_directions_as_density(&surface, kind, angles[i]);
    }
}

/* ---- Energy ---- */

/* Integrates f cos(out) over the hemisphere for sound that came at an angle. Turns are dense about
 * the specular direction, where the cone is narrow at grazing incidence. */
static double albedo(const struct surface_record *surface, double angle)
{
    const struct vector3 back = direction_at(angle, PI);
    const double step = 1.0 / FURNACE_CELLS;
    double sum = 0.0;
    for (int i = 0; i < FURNACE_CELLS * NODES; i++) {
        const double polar = 0.5 * PI * step * (i / NODES + 0.5 + 0.5 * node_of(i % NODES));
        double ring = 0.0;
        for (int j = 0; j < FURNACE_CELLS * NODES / 2; j++) {
            const double part = 2.0 * step * (j / NODES + 0.5 + 0.5 * node_of(j % NODES));
            const double turn = PI * part * part * part;
            const float f =
                rough_scattering(surface, surface_normal(), back, direction_at(polar, turn));
            ring += weight_of(j % NODES) * 3.0 * part * part * (double)f;
        }
        sum += weight_of(i % NODES) * sin(polar) * cos(polar) * ring;
    }
    /* 2: both sides of the plane of incidence */
    return 2.0 * sum * 0.25 * PI * step * PI * step;
}

/* The error of the quadrature, by kinks of the shading and by single precision. */
#define QUADRATURE 1e-4

static const double furnace_angles[] = {0.0, 10.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9};

TEST(test_rough_furnace)
{
    for (int kind = 0; kind < KINDS; kind++) {
        const struct surface_record surface = rough_kind(kind);
        print_message("kind %d, albedo:", kind);
        for (size_t i = 0; i < COUNT(furnace_angles); i++) {
            const double angle = degrees(furnace_angles[i]);
            const double found = albedo(&surface, angle);
            const double diffuse = PI * (double)surface.lambert *
                                   pow(cos(angle), (double)surface.lambert_exponent - 1.0);
            print_message(" %.5f", found);
            assert_true(found < diffuse + (double)surface.glossy_albedo + QUADRATURE);
            assert_true(found > diffuse - QUADRATURE);
            if (surface.glossy_albedo == 0.0f)
                assert_true(fabs(found - diffuse) < 1e-6 + 1e-5 * diffuse); /* exact polynomials */
        }
        print_message("\n");
    }
}

TEST(test_furnace_over_smooth_part)
{
    for (int smooth = 0; smooth < SMOOTH_KINDS; smooth++) {
        double most = 0.0, most_of_all = 0.0;
        for (int kind = 0; kind < KINDS; kind++) {
            const struct surface_record rough_part = rough_kind(kind);
            const struct surface_record surface = over_smooth(smooth, &rough_part);
            for (size_t i = 0; i < COUNT(furnace_angles); i += 2) {
                const double angle = degrees(furnace_angles[i]);
                double scattered;
                const double specular = exact_specular(&surface, cos(angle), &scattered);
                const double found = albedo(&surface, angle);
                most = fmax(most, found / scattered);
                most_of_all = fmax(most_of_all, found + specular);
                assert_true(found < scattered * (1.0 + QUADRATURE) + 1e-6);
                assert_true(found + specular < 1.0 + 1e-6);
            }
        }
        print_message(
            "smooth kind %d: rough at most %.5f of what is scattered, both at most %.5f\n", smooth,
            most, most_of_all);
    }
}

TEST(test_reciprocity)
{
    double worst = 0.0;
    for (int smooth = -1; smooth < SMOOTH_KINDS; smooth++)
        for (int kind = 0; kind < KINDS; kind++) {
            struct surface_record surface = rough_kind(kind);
            if (smooth >= 0)
                surface = over_smooth(smooth, &surface);
            for (int i = 0; i < 20000; i++) {
                const struct vector3 one = random_direction(1e-3);
                const struct vector3 other = random_direction(1e-3);
                const double there =
                    (double)rough_scattering(&surface, surface_normal(), one, other);
                const double back =
                    (double)rough_scattering(&surface, surface_normal(), other, one);
                assert_true(there >= 0.0);
                /* below the least normal number digits are lost */
                worst = fmax(worst, fabs(back - there) / (SINGLE_PRECISION * there + 1e-37));
            }
        }
    print_message("there and back differ by at most %.2f roundings\n", worst);
    /* the product with the share left by the smooth part has another order: 2 roundings each */
    assert_true(worst < 6.0);
}

/* ---- Reflection ---- */

/* Returns the error of R. R has roundings of its own, and those of s^2 = n^2 - sin^2, which the
 * square root enlarges near the critical angle. A constant has only its rounding. */
static double reflection_error(const struct surface_record *surface, double cosine)
{
    if (surface->reflection_kind != REFLECTION_FLUID)
        return SINGLE_PRECISION;
    const double m = (double)surface->density_ratio;
    const double complex square =
        (double)surface->index_real - 1.0 + cosine * cosine + (double)surface->index_imaginary * I;
    const double error =
        4.0 * SINGLE_PRECISION * fmax(1.0, fabs((double)surface->index_real)); /* error of s^2 */
    const double root_error = error / (cabs(csqrt(square)) + sqrt(error));
    const double sum = cabs(m * cosine + csqrt(square));
    return 2e-6 + 2.0 * m * cosine * root_error / (sum * sum);
}

static double reflection_off(const struct surface_record *surface, float cosine)
{
    float real_part, imaginary_part;
    plane_reflection(surface, cosine, &real_part, &imaginary_part);
    const double complex found = (double)real_part + (double)imaginary_part * I;
    return cabs(found - exact_reflection(surface, (double)cosine)) /
           reflection_error(surface, (double)cosine);
}

TEST(test_fluid_reflection)
{
    static const struct {
        double density, speed, loss;
    } fluids[] = {{2.231, 1.2503, 0.0},     {2.231, 1.2503, 0.01638}, {1.149, 0.9873, 0.0},
                  {1.149, 0.9873, 0.00386}, {0.0013, 0.23, 0.0},      {7.8, 4.0, 0.01},
                  {1.0, 1.0, 0.0},          {100.0, 20.0, 1.0},       {0.001, 0.01, 1.0},
                  {100.0, 0.01, 0.0},       {0.001, 20.0, 0.0}};
    for (size_t i = 0; i < COUNT(fluids); i++) {
        const struct surface_record surface =
            fluid(fluids[i].density, fluids[i].speed, fluids[i].loss);
        double worst = 0.0;
        for (int k = 1; k <= 100000; k++) {
            const float cosine = (float)(k / 1e5);
            worst = fmax(worst, reflection_off(&surface, cosine));
            float real_part, imaginary_part;
            fluid_reflection(&surface, cosine, &real_part, &imaginary_part);
            const double modulus = hypot((double)real_part, (double)imaginary_part);
            assert_true(modulus < 1.0 + 1e-6); /* no energy is gained */
        }
        print_message("density %g, speed %g, loss %g: off by %.2f of what is allowed\n",
                      fluids[i].density, fluids[i].speed, fluids[i].loss, worst);
        assert_true(worst < 1.0);
    }
}

static double modulus_at_grazing(const struct surface_record *surface, double grazing,
                                 double *real_part)
{
    float first, second;
    fluid_reflection(surface, (float)sin(grazing), &first, &second);
    *real_part = (double)first;
    return hypot((double)first, (double)second);
}

TEST(test_critical_angle)
{
    const struct surface_record sand = fluid(2.231, 1.2503, 0.0);
    const double critical = acos(1.0 / 1.2503); /* grazing: cos = 1 / speed ratio */
    assert_true(fabs(critical - degrees(36.88)) < degrees(0.01));
    double real_part;
    for (int k = 0; k <= 1000; k++) {
        const double below =
            modulus_at_grazing(&sand, critical * (0.9999 * k / 1000.0), &real_part);
        assert_true(fabs(below - 1.0) < 1e-6); /* total reflection: all roundings are of 1 */
    }
    for (int k = 1; k <= 1000; k++) {
        const double grazing = critical + (0.5 * PI - critical) * k / 1000.0;
        assert_true(modulus_at_grazing(&sand, grazing, &real_part) < 1.0 - 1e-3);
    }
    /* broadside: R = (m v - 1) / (m v + 1) */
    const double impedance = 2.231 * 1.2503;
    modulus_at_grazing(&sand, 0.5 * PI, &real_part);
    assert_true(fabs(real_part - (impedance - 1.0) / (impedance + 1.0)) < 2e-6);
    /* loss weakens total reflection */
    const struct surface_record lossy = fluid(2.231, 1.2503, 0.01638);
    assert_true(modulus_at_grazing(&lossy, 0.9 * critical, &real_part) < 0.97);
}

TEST(test_intromission_angle)
{
    const double m = 1.149, index = 1.0 / 0.9873;
    /* m cos = s where sin^2 = (m^2 - n^2) / (m^2 - 1) */
    const double square_sine = (m * m - index * index) / (m * m - 1.0);
    const double grazing = 0.5 * PI - asin(sqrt(square_sine));
    const struct surface_record silt = fluid(m, 0.9873, 0.0);
    double real_part;
    print_message("intromission at %.2f degrees of grazing, |R| %.2g\n", grazing * 180.0 / PI,
                  modulus_at_grazing(&silt, grazing, &real_part));
    assert_true(modulus_at_grazing(&silt, grazing, &real_part) < 2e-6);
    modulus_at_grazing(&silt, grazing - 0.01, &real_part);
    assert_true(real_part < -1e-3); /* the phase turns */
    modulus_at_grazing(&silt, grazing + 0.01, &real_part);
    assert_true(real_part > 1e-3);
}

TEST(test_grazing_limit)
{
    static const double speeds[] = {0.9873, 1.2503, 4.0};
    for (size_t i = 0; i < COUNT(speeds); i++)
        for (int lossy = 0; lossy < 2; lossy++) {
            const struct surface_record surface = fluid(2.0, speeds[i], 0.01 * lossy);
            float real_part, imaginary_part;
            fluid_reflection(&surface, 0.0f, &real_part, &imaginary_part);
            assert_true(fabs((double)real_part + 1.0) < 1e-6);
            assert_true(fabs((double)imaginary_part) < 1e-6);
            assert_true(reflection_off(&surface, 1e-4f) < 1.0);
        }
}

TEST(test_specular_part)
{
    const struct surface_record none = rough_kind(0);
    for (int smooth = 0; smooth < SMOOTH_KINDS; smooth++) {
        const struct surface_record surface = over_smooth(smooth, &none);
        double worst = 0.0;
        for (int k = 1; k <= 1000; k++) {
            const float cosine = (float)(k / 1000.0);
            const double phase = (double)surface.roughness_phase * (double)cosine;
            const double complex exact =
                exact_reflection(&surface, (double)cosine) * exp(-0.5 * phase * phase);
            /* error of R, and roundings of the exponential's argument */
            const double error = reflection_error(&surface, (double)cosine) +
                                 SINGLE_PRECISION * (4.0 + 2.0 * phase * phase) * cabs(exact);
            float real_part, imaginary_part;
            smooth_reflection(&surface, cosine, &real_part, &imaginary_part);
            const double complex found = (double)real_part + (double)imaginary_part * I;
            worst = fmax(worst, cabs(found - exact) / error);
            double scattered;
            const double energy = exact_specular(&surface, (double)cosine, &scattered);
            const double energy_found = (double)specular_energy(&surface, cosine);
            worst = fmax(worst, fabs(energy_found - energy) / (2.0 * error));
            const double part = (double)scattered_fraction(&surface, cosine);
            const double available = surface.reflection_kind == REFLECTION_FLUID ? 1.0 : 0.81;
            /* 1 - exp rounds as 1 does */
            worst = fmax(worst, fabs(part * available - scattered) / (2.0 * error + 4e-7));
        }
        print_message("smooth kind %d: off by %.2f of what is allowed\n", smooth, worst);
        assert_true(worst < 1.0);
    }
}

/* A sediment's rough part keeps its energy at every angle. The specular part gives way to it. */
TEST(test_rough_part_apart)
{
    const struct surface_record rough_part = rough(0.05, 1.0, 0.0, 0.1);
    for (int smooth = 0; smooth < SMOOTH_KINDS; smooth++) {
        struct surface_record surface = over_smooth(smooth, &rough_part);
        surface.rough_is_apart = 1;
        surface.lambert = 0.05f;
        for (size_t i = 0; i < COUNT(furnace_angles); i++) {
            const double angle = furnace_angles[i] * PI / 180.0;
            const double cosine = (double)(float)cos(angle);
            double scattered;
            const double specular = exact_specular(&surface, cosine, &scattered);
            const double left = specular * (1.0 - PI * 0.05);
            const double found = (double)specular_energy(&surface, (float)cosine);
            const double returned = albedo(&surface, angle);
            /* errors of R near the critical angle, and of the quadrature */
            assert_true(fabs(found - left) < 2.0 * reflection_error(&surface, cosine) + 2e-6);
            assert_true(fabs(returned - PI * 0.05) < 1e-4);
            assert_true(found + returned < 1.0 + 1e-4);
        }
    }
}

TEST_PROGRAM(NULL, NULL)
