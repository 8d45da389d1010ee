/* Chains of several interactions, on the kernel's own source: closed forms of their energies. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "kernels/trace_chains.h"

#define PI           3.14159265358979323846
#define ORDERS       6
#define BINS         40000
#define BINS_A_METRE 1000.0f
#define RADIUS       5.0f

/* A sonar in the middle of a sphere, its rays in one vertical plane. */
static void lay_sphere(struct fan_record *fan, struct chain_record *chains,
                       struct object_record *sphere, float lambert)
{
    memset(fan, 0, sizeof *fan);
    fan->reference_range = RADIUS; /* the frame lies where the middle ray meets the sphere */
    fan->cosine_depression = 0.8f;
    fan->sine_depression = 0.6f;
    fan->seabed_height = -1000.0f;
    fan->strip_width = 0.04f;
    fan->first_elevation = -1.0f;
    fan->rays = 20000;
    fan->elevation_step = 2.0f / 20000.0f;
    fan->strips = 1;
    fan->bins_per_metre = BINS_A_METRE;
    fan->bins = BINS;
    fan->quanta = 17179869184.0f; /* so fine that what is cut off does not count */
    fan->seed_low = 11;
    fan->stream = STREAM_CHAIN_RAYS;
    fan->only_object = -2;
    fan->objects = 1;
    fan->segments = 1;
    memset(chains, 0, sizeof *chains);
    chains->interactions = ORDERS;
    chains->first_order = 1;
    chains->planes = ORDERS;
    chains->tally_strips = 1;
    memset(sphere, 0, sizeof *sphere);
    sphere->shape = SHAPE_SPHERE;
    sphere->centre_y = -RADIUS * fan->cosine_depression;
    sphere->centre_z = RADIUS * fan->sine_depression;
    sphere->axes[0] = sphere->axes[4] = sphere->axes[8] = 1.0f;
    sphere->radius = RADIUS;
    sphere->bounding_radius = RADIUS;
    sphere->surface.lambert = lambert;
    sphere->surface.lambert_exponent = 1.0f;
}

/* Energy of each order without the normalisation by half the path to the fourth power. */
static void raw_energies(const struct fan_record *fan, const int64_t *tallies,
                         double energy[ORDERS])
{
    for (int order = 0; order < ORDERS; order++) {
        energy[order] = 0.0;
        for (int bin = 0; bin < BINS; bin++) {
            const double half_path =
                (double)fan->reference_range + (double)bin / (double)fan->bins_per_metre;
            energy[order] += (double)tallies[order * BINS + bin] / pow(half_path, 4.0);
        }
    }
}

/* In a closed diffuse sphere with the sonar at its centre every bounce keeps the albedo, whatever
 * the direction; so the orders' energies are a geometric series. A strip of millimetres is off the
 * centre by so little that cosines differ by 1e-5. */
static void test_closed_sphere(void **state)
{
    (void)state;
    const float lambert = 0.25f;
    const double albedo = PI * (double)lambert;
    struct fan_record fan;
    struct chain_record chains;
    struct object_record sphere;
    lay_sphere(&fan, &chains, &sphere, lambert);
    int64_t *tallies = calloc((size_t)ORDERS * BINS, sizeof *tallies);
    assert_non_null(tallies);
    const struct outcome_record outcome =
        trace_chains_strip(&fan, NULL, &chains, &sphere, NULL, NULL, tallies, 0, 0);
    assert_int_equal(outcome.faults, 0);
    double energy[ORDERS];
    raw_energies(&fan, tallies, energy);
    for (int order = 1; order < ORDERS; order++) {
        const double ratio = energy[order] / energy[0] / pow(albedo, order);
        printf("order %d over order 1, over albedo^%d: %.6f\n", order + 1, order, ratio);
        /* every path has the same raw energy: what is left is the width of the bins */
        assert_true(fabs(ratio - 1.0) < 1e-3);
    }
    free(tallies);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
