/* Tests the energies of chains of interactions, from the kernel's source, against closed forms. */
#include "claims.h"
#include "kernels/trace_chains.h"

#define ORDERS       6
#define BINS         40000
#define BINS_A_METRE 1000.0f
#define RADIUS       5.0f

/* Places a sonar in the middle of a sphere, with its rays in one vertical plane. */
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
    fan->bin_at_reference = 1.0f; /* echoes come up to 0.04 bins before the middle one */
    fan->quanta = 17179869184.0f; /* fine enough that rounding is negligible */
    fan->seed_low = 11;
    fan->stream = STREAM_CHAIN_RAYS;
    fan->only_object = -2;
    fan->objects = 1;
    fan->segments = 1;
    memset(chains, 0, sizeof *chains);
    chains->interactions = ORDERS;
    chains->first_order = 1;
    chains->tally_strips = 1;
    for (int i = 0; i < CHAIN_ORDERS_MAX; i++)
        chains->finer[i] = 1.0f;
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

/* Computes each order's energy without the normalisation by half the path to the fourth power. */
static void raw_energies(const struct fan_record *fan, const int64_t *tallies,
                         double energy[ORDERS])
{
    for (int order = 0; order < ORDERS; order++) {
        energy[order] = 0.0;
        for (int bin = 0; bin < BINS; bin++) {
            const double half_path =
                (double)fan->reference_range +
                (bin - (double)fan->bin_at_reference) / (double)fan->bins_per_metre;
            energy[order] += (double)tallies[order * BINS + bin] / pow(half_path, 4.0);
        }
    }
}

/* Tests that the orders' energies are a geometric series. In a closed diffuse sphere with the sonar
 * at its centre every bounce keeps the albedo, whatever the direction. The strip of 4 cm is so
 * little off the centre that cosines differ by 1e-5. */
TEST(test_closed_sphere)
{
    const float lambert = 0.25f;
    const double albedo = PI * (double)lambert;
    struct fan_record fan;
    struct chain_record chains;
    struct object_record sphere;
    lay_sphere(&fan, &chains, &sphere, lambert);
    int64_t *tallies = zeroed((size_t)ORDERS * BINS, sizeof *tallies);
    struct outcome_record outcome = {0};
    struct trace trace = {.fan = fan,
                          .objects = &sphere,
                          .chains = &chains,
                          .tallies = tallies,
                          .throughputs = (float[1]){0.0f},
                          .outcome = &outcome};
    begin_strip(&trace, 0, 0);
    trace_chains_strip(&trace);
    assert_int_equal(outcome.faults, 0);
    double energy[ORDERS];
    raw_energies(&fan, tallies, energy);
    for (int order = 1; order < ORDERS; order++) {
        const double ratio = energy[order] / energy[0] / pow(albedo, order);
        printf("order %d over order 1, over albedo^%d: %.6f\n", order + 1, order, ratio);
        /* all paths have the same raw energy: the tolerance is for the width of the bins */
        assert_true(fabs(ratio - 1.0) < 1e-3);
    }
    free(tallies);
}

#define SAMPLES 150000

/* Lays a wavy sea surface over a near target. Each kind of surface has lobes of its own. */
static void lay_waves(struct chain_record *chains, struct sphere_record *sphere, int kind)
{
    memset(chains, 0, sizeof *chains);
    chains->sea_surface_height = 10.0f;
    chains->sea_surface.reflection_kind = kind == 0 ? REFLECTION_NONE : REFLECTION_CONSTANT;
    chains->sea_surface.reflection = -0.95f;
    chains->sea_surface.roughness_phase = kind == 1 ? 0.8f : 4.0f;
    chains->sea_surface.lambert = kind == 2 ? 0.1f : 0.2f;
    chains->sea_surface.lambert_exponent = kind == 1 ? 3.0f : 1.0f;
    chains->sea_surface.glossy_albedo = 0.9f - 3.14159265f * chains->sea_surface.lambert;
    chains->sea_surface.glossy_slope = 0.2f;
    sphere->centre_x = 0.5f;
    sphere->centre_y = 1.0f;
    sphere->centre_z = 7.0f;
    sphere->radius = 1.0f;
}

/* Returns the share of arriving energy that the surface sends on: by its mirror, and by its rough
 * part, integrated over all directions. */
static double energy_sent_on(const struct chain_record *chains, const struct chain_hit *hit)
{
    const int steps = 500;
    const double cosine = (double)-hit->back.z;
    double sum = 0.0;
    for (int i = 0; i < steps; i++)
        for (int k = 0; k < steps; k++) {
            const double down = (i + 0.5) / steps;
            const double across = sqrt(1.0 - down * down);
            const double turn = 2.0 * PI * (k + 0.5) / steps;
            struct vector3 out;
            out.x = (float)(across * cos(turn));
            out.y = (float)(across * sin(turn));
            out.z = (float)-down;
            sum += (double)rough_scattering(&chains->sea_surface, hit->normal, hit->back, out) *
                   down * 2.0 * PI / steps / steps;
        }
    if (has_smooth_part(&chains->sea_surface))
        sum += (double)specular_energy(&chains->sea_surface, (float)cosine);
    return sum;
}

/* Tests that steps from the sea surface bring, on average, what the surface sends on and no more
 * than came, whether directions are led to the target or not. Tolerance: 4 standard errors, 0.2 %
 * for the quadrature. */
TEST(test_sea_surface_keeps_energy)
{
    static const float cosines[] = {1.0f, 0.6f, 0.2f, 0.05f};
    for (int variant = 0; variant < 3 * 4 * 2; variant++) {
        struct chain_record chains;
        struct sphere_record sphere;
        struct chain_hit hit;
        lay_waves(&chains, &sphere, variant / 8);
        chains.spheres = variant % 2;
        memset(&hit, 0, sizeof hit);
        const float cosine = cosines[variant / 2 % 4];
        hit.point.z = chains.sea_surface_height;
        hit.normal.z = -1.0f;
        hit.back.y = -sqrtf(1.0f - cosine * cosine);
        hit.back.z = -cosine;
        double sum = 0.0, square = 0.0;
        const struct trace trace = {.chains = &chains, .spheres = &sphere};
        for (uint32_t i = 0; i < SAMPLES; i++) {
            float u, v, choice;
            three_uniforms(random_key_of(3, 0, 77, (uint32_t)variant), i, 0, &u, &v, &choice);
            const struct chain_step step = step_from_surface(&trace, NULL, &chains.sea_surface,
                                                             SEA_SURFACE, 2, &hit, choice, u, v);
            sum += (double)step.weight;
            square += (double)step.weight * (double)step.weight;
        }
        const double mean = sum / SAMPLES;
        const double error = sqrt((square / SAMPLES - mean * mean) / SAMPLES);
        const double expected = energy_sent_on(&chains, &hit);
        printf("waves %d, cosine %.2f, led %d: %.4f, expected %.4f +- %.1g\n", variant / 8,
               (double)cosine, variant % 2, mean, expected, error);
        assert_true(fabs(mean - expected) < 4.0 * error + 0.002 * expected);
        assert_true(expected < 1.0);
    }
}

#define ROWS_OF_SKY 8 /* rings, and sectors: parts of equal projected solid angle */
#define SKY         (ROWS_OF_SKY * ROWS_OF_SKY)

/* Spheres as a launch lays them, with the groups that stand for many. */
struct targets {
    struct sphere_record spheres[3];
    struct sphere_group group, bound;
};

/* Lays `count` spheres around a point of level seabed. The first `inside` of them contain it. */
static void lay_targets(struct targets *targets, struct chain_record *chains, int count, int inside)
{
    static const float ways[3][3] = {
        {0.05f, -0.02f, 0.1f}, {-0.1f, 0.1f, 0.05f}, {0.03f, 0.1f, 0.12f}};
    memset(targets, 0, sizeof *targets);
    for (int i = 0; i < count; i++) {
        const float scale = i < inside ? 1.0f : 6.0f;
        struct sphere_record *sphere = &targets->spheres[i];
        sphere->centre_x = targets->group.centre_x[i] = scale * ways[i][0];
        sphere->centre_y = targets->group.centre_y[i] = scale * ways[i][1];
        sphere->centre_z = targets->group.centre_z[i] = scale * ways[i][2];
        sphere->radius = targets->group.radius[i] = 0.3f;
    }
    targets->bound.radius[0] = 2.0f;
    memset(chains, 0, sizeof *chains);
    chains->spheres = 3; /* groups lie behind three spheres */
    chains->sea_surface_height = 10.0f;
    chains->seabed.lambert = 0.1f;
    chains->seabed.lambert_exponent = 1.0f;
}

static void lay_hit(struct chain_hit *hit)
{
    memset(hit, 0, sizeof *hit);
    hit->is_hit = -1;
    hit->surface = SEABED;
    hit->normal.z = 1.0f;
    hit->back.y = -0.8f;
    hit->back.z = 0.6f;
}

static struct chain_step sample_step(const struct chain_record *chains,
                                     const struct targets *targets, int order,
                                     const struct chain_hit *hit, uint32_t stream, uint32_t ray)
{
    float u, v, choice;
    three_uniforms(random_key_of(5, 0, 78, stream), ray, 0, &u, &v, &choice);
    const struct trace trace = {.chains = chains, .spheres = targets->spheres};
    return step_from_surface(&trace, NULL, &chains->seabed, SEABED, order, hit, choice, u, v);
}

static int part_of_sky(struct vector3 direction)
{
    const double square = 1.0 - (double)direction.z * (double)direction.z;
    const double turn = atan2((double)direction.y, (double)direction.x) / (2.0 * PI) + 0.5;
    const int ring = (int)fmin(ROWS_OF_SKY * square, ROWS_OF_SKY - 1.0);
    const int sector = (int)fmin(ROWS_OF_SKY * turn, ROWS_OF_SKY - 1.0);
    return ROWS_OF_SKY * ring + sector;
}

static int is_towards_some(const struct targets *targets, int count, struct vector3 direction)
{
    for (int i = 0; i < count; i++) {
        const struct sphere_record *sphere = &targets->spheres[i];
        const float along = sphere->centre_x * direction.x + sphere->centre_y * direction.y +
                            sphere->centre_z * direction.z;
        const float square = sphere->centre_x * sphere->centre_x +
                             sphere->centre_y * sphere->centre_y +
                             sphere->centre_z * sphere->centre_z;
        if (along > 0.0f && square - along * along < sphere->radius * sphere->radius)
            return 1;
    }
    return 0;
}

/* Computes what Lambert's law sends to each part of the sky, or only towards the targets. */
static void light_sky(const struct targets *targets, int count, int is_all, double sky[SKY])
{
    const int steps = 100 * ROWS_OF_SKY;
    memset(sky, 0, SKY * sizeof *sky);
    for (int i = 0; i < steps; i++)
        for (int k = 0; k < steps; k++) {
            const double square = (i + 0.5) / steps;
            const double turn = 2.0 * PI * (k + 0.5) / steps;
            const struct vector3 way = {(float)(sqrt(square) * cos(turn)),
                                        (float)(sqrt(square) * sin(turn)),
                                        (float)sqrt(1.0 - square)};
            if (is_all || is_towards_some(targets, count, way))
                sky[part_of_sky(way)] += 0.1 * PI / steps / steps;
        }
}

/* Expects steps to bring the energy of Lambert's law to each part of the sky. Weights are
 * scattering over the density of directions, which must be the density of the draws. Squared
 * differences over variances are compared with chi squared. 0.1 % of a part is for quadrature. */
static void expect_sky(const struct targets *targets, const struct chain_record *chains, int count,
                       int is_all, int order, uint32_t stream)
{
    double sky[SKY], sum[SKY] = {0.0}, square[SKY] = {0.0}, chi_squared = 0.0;
    struct chain_hit hit;
    int parts = 0;
    light_sky(targets, count, is_all, sky);
    lay_hit(&hit);
    for (uint32_t i = 0; i < SAMPLES; i++) {
        const struct chain_step step = sample_step(chains, targets, order, &hit, stream, i);
        const double weight = (double)step.weight;
        if (weight > 0.0) {
            sum[part_of_sky(step.direction)] += weight;
            square[part_of_sky(step.direction)] += weight * weight;
        }
    }
    for (int part = 0; part < SKY; part++) {
        const double mean = sum[part] / SAMPLES;
        const double variance = (square[part] / SAMPLES - mean * mean) / SAMPLES;
        const double difference = mean - sky[part];
        if (variance > 0.0 && sky[part] > 1e-4) {
            chi_squared += difference * difference / (variance + 1e-6 * sky[part] * sky[part]);
            parts++;
        } else {
            assert_true(fabs(difference) < 2e-4);
        }
    }
    printf("%d spheres, %s, order %d: chi squared %.1f of %d parts\n", count,
           is_all ? "and all around" : "alone", order, chi_squared, parts);
    assert_true(parts > 5);
    assert_true(chi_squared < parts + 4.0 * sqrt(2.0 * parts));
}

TEST(test_directions_are_weighed_as_they_are_drawn)
{
    for (uint32_t variant = 0; variant < 4 * 3 * 2 * 2; variant++) {
        const int inside = (int)variant % 4;
        const int count = (int)variant / 4 % 3 + 1;
        const int leads_elsewhere = (int)variant / 12 % 2;
        struct targets targets;
        struct chain_record chains;
        if (inside > count)
            continue;
        lay_targets(&targets, &chains, count, inside);
        if (variant / 24)
            chains.groups = 1;
        else
            chains.spheres = count;
        expect_sky(&targets, &chains, count, inside > 0 || leads_elsewhere, 1 + leads_elsewhere,
                   variant);
    }
}

/* Lambert's law sends mu cos times pi r^2/d^2 into a cone above the horizon. A direction is rounded
 * by 1e-7 of the distance, which must not take it out of the cone that it was drawn in. */
TEST(test_far_and_small_targets_get_their_share)
{
    static const float radii[] = {0.15f, 0.05f, 0.02f, 0.005f};
    static const float distances[] = {0.7f, 5.0f, 30.0f};
    for (int i = 0; i < 4 * 3; i++) {
        const float radius = radii[i % 4], distance = distances[i / 4];
        const double angle = (double)radius / (double)distance;
        struct targets targets;
        struct chain_record chains;
        struct chain_hit hit;
        double sum = 0.0;
        lay_targets(&targets, &chains, 1, 0);
        chains.spheres = 1;
        targets.spheres[0].centre_x = 0.36f * distance;
        targets.spheres[0].centre_y = 0.48f * distance;
        targets.spheres[0].centre_z = 0.8f * distance;
        targets.spheres[0].radius = radius;
        lay_hit(&hit);
        for (uint32_t ray = 0; ray < SAMPLES / 10; ray++)
            sum += (double)sample_step(&chains, &targets, 1, &hit, 79, ray).weight;
        const double share = 10.0 * sum / SAMPLES / (0.1 * 0.8 * PI * angle * angle);
        printf("radius %g m at %g m: %.5f of its share\n", (double)radius, (double)distance, share);
        assert_true(fabs(share - 1.0) < 2e-3);
    }
}

TEST_PROGRAM(NULL, NULL)
