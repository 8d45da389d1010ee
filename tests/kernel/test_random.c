/* Tests kernels/random.h and the deviates of image_formation.h. */
#include "claims.h"

#include "base/memory.h"
#include "image_formation.h"
#include "layout.h"

#define DRAWS 1000000

/* The answers of threefry2x32 with 20 rounds are in the authors' own Random123 distribution. */
TEST(test_known_answers)
{
    static const uint32_t vectors[][6] = {
        {0x00000000, 0x00000000, 0x00000000, 0x00000000, 0x6b200159, 0x99ba4efe},
        {0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0x1cb996fc, 0xbb002be7},
        {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xc4923a9c, 0x483df7a0},
    };
    for (size_t i = 0; i < COUNT(vectors); i++) {
        uint32_t a = vectors[i][0];
        uint32_t b = vectors[i][1];
        threefry(vectors[i][2], vectors[i][3], &a, &b);
        assert_int_equal(a, vectors[i][4]);
        assert_int_equal(b, vectors[i][5]);
        a = vectors[i][0];
        b = vectors[i][1];
        threefry_scalar(vectors[i][2], vectors[i][3], &a, &b);
        assert_int_equal(a, vectors[i][4]);
        assert_int_equal(b, vectors[i][5]);
    }
}

TEST(test_uniforms_stay_inside)
{
    assert_true(uniform_from(0u) > 0.0f);
    assert_true(uniform_from(0xffffffffu) < 1.0f);
    /* each of the 2^23 parts has its own exact middle */
    float before = 0.0f;
    for (uint32_t part = 0; part < 1u << 23; part++) {
        const float value = uniform_from(part << 9);
        assert_true(value == (float)((part + 0.5) / 8388608.0));
        assert_true(value > before);
        before = value;
    }
}

/* A lattice's error of the integral of the product of its coordinates, from 256 neighbours, over
 * that of random numbers, sqrt((3^-d - 4^-d) / 256). *bias: the mean error in its standard errors.
 */
static double lattice_error(const uint32_t *multipliers, int dimensions, double *bias)
{
    const int points = 256, shifts = 1000;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < shifts; i++) {
        double mean = 0.0;
        uint32_t first = (uint32_t)i, unused = 0, shift[6];
        threefry(5, 0, &first, &unused);
        for (uint32_t j = 0; j < 6; j++) {
            shift[j] = (uint32_t)i;
            unused = j + 1;
            threefry(5, 0, &shift[j], &unused);
        }
        for (uint32_t n = 0; n < (uint32_t)points; n++) {
            double product = 1.0;
            for (int j = 0; j < dimensions; j++)
                product *= (double)lattice_uniform(first + n, multipliers[j], shift[j]);
            mean += product / points;
        }
        const double error = mean - pow(0.5, dimensions);
        sum += error;
        squares += error * error;
    }
    *bias = sum / sqrt(squares);
    return sqrt(squares / shifts / ((pow(3.0, -dimensions) - pow(4.0, -dimensions)) / points));
}

TEST(lattices_integrate_better_than_random_numbers)
{
    static const uint32_t two[] = {LATTICE_OF_2_0, LATTICE_OF_2_1};
    static const uint32_t six[] = {LATTICE_OF_6_0, LATTICE_OF_6_1, LATTICE_OF_6_2,
                                   LATTICE_OF_6_3, LATTICE_OF_6_4, LATTICE_OF_6_5};
    double bias;
    assert_true(lattice_error(two, 2, &bias) < 0.3);
    assert_true(fabs(bias) < 4.0);
    for (int i = 0; i < 6; i++) { /* by itself, and with the next */
        assert_true(lattice_error(&six[i], 1, &bias) < 0.35);
        assert_true(i == 5 || lattice_error(&six[i], 2, &bias) < 0.45);
    }
    assert_true(lattice_error(six, 6, &bias) < 0.8);
    assert_true(fabs(bias) < 4.0);
}

/* Returns chi-square of counts in equal classes as a normal deviate (classes are many). */
static double chi_square(const uint32_t *counts, int classes, double draws)
{
    const double expected = draws / classes;
    double sum = 0.0;
    for (int i = 0; i < classes; i++)
        sum += (counts[i] - expected) * (counts[i] - expected) / expected;
    return (sum - (classes - 1)) / sqrt(2.0 * (classes - 1));
}

/* All tolerances are 4 standard errors, which a fair generator passes 15,786 times of 15,787. */
TEST(test_uniformity)
{
    for (uint32_t draw = 0; draw < 3; draw++) {
        static uint32_t singles[1024], pairs[1024], neighbours[1024];
        for (int i = 0; i < 1024; i++)
            singles[i] = pairs[i] = neighbours[i] = 0;
        const struct random_key key = random_key_of(7, 0, STREAM_ROUGH_RAYS, 1000 + draw);
        double sum = 0.0;
        double squares = 0.0;
        float before = 0.5f;
        for (uint32_t ray = 0; ray < DRAWS; ray++) {
            float u, v;
            two_uniforms(key, ray, draw, &u, &v);
            sum += u + v;
            squares += (u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5);
            singles[(int)(u * 1024.0f)]++;
            pairs[(int)(u * 32.0f) * 32 + (int)(v * 32.0f)]++;
            neighbours[(int)(before * 32.0f) * 32 + (int)(u * 32.0f)]++;
            before = u;
        }
        const double mean = sum / (2.0 * DRAWS);
        const double variance = squares / (2.0 * DRAWS);
        const double of_singles = chi_square(singles, 1024, DRAWS);
        const double of_pairs = chi_square(pairs, 1024, DRAWS);
        const double of_neighbours = chi_square(neighbours, 1024, DRAWS);
        print_message("draw %u: mean %.6f, variance %.6f, chi-square %.2f %.2f %.2f sigma\n",
                      (unsigned)draw, mean, variance, of_singles, of_pairs, of_neighbours);
        assert_true(fabs(mean - 0.5) < 4.0 * sqrt(1.0 / 12.0 / (2.0 * DRAWS)));
        assert_true(fabs(variance - 1.0 / 12.0) < 4.0 * sqrt(1.0 / 180.0 / (2.0 * DRAWS)));
        assert_true(fabs(of_singles) < 4.0);
        assert_true(fabs(of_pairs) < 4.0);
        assert_true(fabs(of_neighbours) < 4.0);
    }
}

struct source {
    uint32_t seed_low, seed_high, stream, strip, draw;
};

static double correlation_between(struct source a, struct source b)
{
    const struct random_key key_a = random_key_of(a.seed_low, a.seed_high, a.stream, a.strip);
    const struct random_key key_b = random_key_of(b.seed_low, b.seed_high, b.stream, b.strip);
    double sum = 0.0;
    for (uint32_t ray = 0; ray < 100000; ray++) {
        float u, v, p, q;
        two_uniforms(key_a, ray, a.draw, &u, &v);
        two_uniforms(key_b, ray, b.draw, &p, &q);
        sum += (u - 0.5) * (p - 0.5) + (v - 0.5) * (q - 0.5) + (u - 0.5) * (q - 0.5);
    }
    /* in standard errors: a term has variance 1/144 */
    return sum / sqrt(3.0 * 100000.0 / 144.0);
}

/* Streams that the program uses side by side must not share anything. */
TEST(test_streams_are_independent)
{
    const struct source one = {1, 0, STREAM_SEABED_SPECKLE, 5, 0};
    const struct source others[] = {
        {2, 0, STREAM_SEABED_SPECKLE, 5, 0},
        {1, 1, STREAM_SEABED_SPECKLE, 5, 0},
        {1, 0, STREAM_NOISE, 5, 0},
        {1, 0, STREAM_INPUT_PHASE, 5, 0},
        {1, 0, STREAM_OBJECT_SPECKLE, 5, 0},
        {1, 0, STREAM_OBJECT_SPECKLE + 1, 5, 0},
        {1, 0, STREAM_SMOOTH_RAYS, 5, 0},
        {1, 0, STREAM_SEABED_SPECKLE, 6, 0},
        {1, 0, STREAM_SEABED_SPECKLE, 0xfffffffb, 0},
        {1, 0, STREAM_SEABED_SPECKLE, 5, 1},
        {0, 1, STREAM_SEABED_SPECKLE, 5, 0},
        {5, 0, STREAM_SEABED_SPECKLE, 1, 0},
    };
    for (size_t i = 0; i < COUNT(others); i++) {
        const double sigmas = correlation_between(one, others[i]);
        print_message("pair %u: %.2f sigma\n", (unsigned)i, sigmas);
        assert_true(fabs(sigmas) < 4.0);
    }
    assert_true(fabs(correlation_between(one, one)) > 100.0);
}

/* The third deviate fills its cells evenly. It is made of spare bits of the other two, but
 * correlates with neither. */
TEST(test_third_uniform)
{
    const struct random_key key = random_key_of(3, 0, STREAM_CHAIN_RAYS, 7);
    enum {
        COUNT = 200000,
        CELLS = 64
    };
    uint32_t counts[CELLS] = {0};
    double with_first = 0.0;
    double with_second = 0.0;
    for (uint32_t ray = 0; ray < COUNT; ray++) {
        float u, v, p, q, choice;
        three_uniforms(key, ray, 2, &u, &v, &choice);
        two_uniforms(key, ray, 2, &p, &q);
        assert_true(u == p && v == q);
        assert_true(choice > 0.0f && choice < 1.0f);
        counts[(int)(choice * CELLS)]++;
        with_first += (u - 0.5) * (choice - 0.5);
        with_second += (v - 0.5) * (choice - 0.5);
    }
    const double sigmas = chi_square(counts, CELLS, COUNT);
    print_message("chi-square %.2f sigma\n", sigmas);
    assert_true(fabs(sigmas) < 4.0);
    /* a term has variance 1/144 */
    assert_true(fabs(with_first) < 4.0 * sqrt(COUNT / 144.0));
    assert_true(fabs(with_second) < 4.0 * sqrt(COUNT / 144.0));
}

/* Deviates have unit mean square, are circular, and have exponential intensity, by Kolmogorov and
 * Smirnov at the 6e-5 level of 4 standard errors: 2.27 / sqrt(n). */
TEST(test_complex_normal)
{
    const struct random_key key = random_key_of(3, 0, STREAM_SEABED_SPECKLE, 17);
    double *intensity = zeroed(DRAWS, sizeof *intensity);
    double real_sum = 0.0, imaginary_sum = 0.0, energy = 0.0, energy_squared = 0.0;
    double square_real = 0.0, square_imaginary = 0.0;
    for (uint32_t i = 0; i < DRAWS; i++) {
        float a, b;
        complex_normal(key, i, &a, &b);
        intensity[i] = (double)a * a + (double)b * b;
        real_sum += a;
        imaginary_sum += b;
        energy += intensity[i];
        energy_squared += intensity[i] * intensity[i];
        square_real += (double)a * a - (double)b * b; /* the mean of z^2 is 0 if circular */
        square_imaginary += 2.0 * a * b;
    }
    qsort(intensity, DRAWS, sizeof *intensity, compare_doubles);
    double distance = 0.0;
    for (int i = 0; i < DRAWS; i++) {
        const double expected = 1.0 - exp(-intensity[i]);
        distance = fmax(
            distance, fmax(fabs((i + 1.0) / DRAWS - expected), fabs((double)i / DRAWS - expected)));
    }
    free(intensity);
    const double root = sqrt((double)DRAWS);
    print_message("mean (%.5f, %.5f), mean square %.5f, fourth moment %.5f, KS %.5f of %.5f\n",
                  real_sum / DRAWS, imaginary_sum / DRAWS, energy / DRAWS, energy_squared / DRAWS,
                  distance, 2.27 / root);
    assert_true(fabs(real_sum / DRAWS) < 4.0 * sqrt(0.5) / root);
    assert_true(fabs(imaginary_sum / DRAWS) < 4.0 * sqrt(0.5) / root);
    assert_true(fabs(energy / DRAWS - 1.0) < 4.0 / root);
    /* variance of I^2 for an exponential I: 4! - 2!^2 */
    assert_true(fabs(energy_squared / DRAWS - 2.0) < 4.0 * sqrt(20.0) / root);
    assert_true(fabs(square_real / DRAWS) < 4.0 / root);
    assert_true(fabs(square_imaginary / DRAWS) < 4.0 / root);
    assert_true(distance < 2.27 / root);
}

TEST_PROGRAM(NULL, NULL)
