/* The number of rays follows the accuracy that a scene asks for. The accuracy and the error that is
 * told are compared with the error against the same scene traced with many times the rays. */
#include "sea.h"

#define ROWS           320
#define COLUMNS        320
#define PIXELS         ((size_t)ROWS * COLUMNS)
#define RANGE          45.0
#define REFERENCE_RAYS 8.0 /* times the rays of the finer accuracy; adds 6 % to the error */
#define SEEDS          6
#define NOISE_DB       (-20.0)

static void lay_one_interaction(struct sea *sea)
{
    sea_add_capsule(sea);
}

static void lay_two_interactions(struct sea *sea)
{
    sea->injection->interactions = 2;
    sea_add_capsule(sea);
}

static void lay_beam(struct sea *sea)
{
    sea->sonar->kind = SONJECT_SONAR_REAL;
    sea->sonar->array_length_m = 2.0;
    sea_add_capsule(sea);
}

/* Fouling belongs to the scene and is no error of rays. */
static void lay_fouled(struct sea *sea)
{
    sea_add_capsule(sea);
    sea_object(sea, 0)->fouling = (sonject_fouling_params){4.0, 0.05, 1e-3, 0.05};
}

static void (*const scenes[])(struct sea *) = {lay_one_interaction, lay_two_interactions, lay_beam,
                                               lay_fouled};

static struct sea *open_sea(size_t scene)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sea->injection->estimate_noise = 0;
    sea->injection->noise_floor_db = NOISE_DB;
    scenes[scene](sea);
    sea_ready(sea);
    return sea;
}

static float *plain_seabed(void)
{
    float *pixels = claim_memory(PIXELS, sizeof *pixels);
    for (size_t i = 0; i < PIXELS; i++)
        pixels[i] = 1.0f;
    return pixels;
}

/* Returns the reference's mean energy over 5 x 5 pixels about an inner pixel of the patch. */
static double energy_about(const struct injected *reference, size_t i)
{
    double sum = 0.0;
    for (size_t row = 0; row < 5; row++)
        for (size_t column = 0; column < 5; column++)
            sum += reference->energy[i + (row - 2) * COLUMNS + (column - 2)];
    return sum / 25.0;
}

/* Returns the rms error over the reference's changed pixels. */
static double error_of(const struct sea *sea, const struct injected *result,
                       const struct injected *reference)
{
    double sum = 0.0, count = 0.0;
    for (size_t i = 2 * COLUMNS + 2; i + 2 * COLUMNS + 2 < PIXELS; i++) {
        if (!reference->influence[i])
            continue;
        const double noise = pow(10.0, NOISE_DB / 10.0) *
                             sea_seabed_level(sea, sea_range(sea, (double)(i % COLUMNS)));
        const double ratio = ((double)result->energy[i] - reference->energy[i]) /
                             (energy_about(reference, i) + noise);
        sum += ratio * ratio;
        count += 1.0;
    }
    assert_true(count > 1000.0);
    return sqrt(sum / count);
}

/* The results of one accuracy, each by rays of its own. */
struct results {
    const struct injected *of_seed[SEEDS];
    double rays, told;
};

static struct results inject_to(struct sea *sea, const float *pixels, double accuracy)
{
    struct results results = {{NULL}, 0.0, 0.0};
    double square = 0.0;
    sea->injection->accuracy = accuracy;
    sea->injection->ray_scale = 1.0;
    for (size_t seed = 0; seed < SEEDS; seed++) {
        sea->injection->ray_seed = 100 + seed;
        results.of_seed[seed] = sea_inject(sea, pixels, false);
        square += pow(results.of_seed[seed]->statistics.energy_error, 2.0) / SEEDS;
        results.rays = fmax(results.rays, results.of_seed[seed]->statistics.ray_scale);
    }
    results.told = sqrt(square);
    return results;
}

/* The error that is told is mostly too large, since errors fall faster than with the root of the
 * rays. It may be too small with two interactions, whose rare bright paths pilots may miss. */
static void expect_accuracy(const struct sea *sea, const struct results *results, double accuracy,
                            const struct injected *reference)
{
    double square = 0.0;
    for (size_t seed = 0; seed < SEEDS; seed++)
        square += pow(error_of(sea, results->of_seed[seed], reference), 2.0) / SEEDS;
    const double error = sqrt(square);
    print_message("%.1f %% asked, %.2f %% told, %.2f %% found, by %.3g times the rays\n",
                  100.0 * accuracy, 100.0 * results->told, 100.0 * error, results->rays);
    assert_true(error < accuracy);
    assert_true(results->told > 0.65 * error && results->told < 2.0 * error);
}

CLAIM(rays_are_as_many_as_the_accuracy_takes)
{
    for (size_t scene = 0; scene < sizeof scenes / sizeof *scenes; scene++) {
        struct sea *sea = open_sea(scene);
        const float *pixels = plain_seabed();
        const struct results coarse = inject_to(sea, pixels, 0.06);
        const struct results fine = inject_to(sea, pixels, 0.04);
        assert_true(fine.rays > coarse.rays);
        sea->injection->accuracy = 0.0;
        sea->injection->ray_scale = REFERENCE_RAYS * fine.rays;
        sea->injection->ray_seed = 200;
        const struct injected *reference = sea_inject(sea, pixels, false);
        assert_true(isnan(reference->statistics.energy_error));
        assert_true(reference->statistics.ray_scale == REFERENCE_RAYS * fine.rays);
        print_message("scene %zu:\n", scene);
        expect_accuracy(sea, &coarse, 0.06, reference);
        expect_accuracy(sea, &fine, 0.04, reference);
    }
}

CLAIM(more_rays_than_can_be_traced_are_refused)
{
    struct sea *sea = open_sea(0);
    const float *pixels = plain_seabed();
    const struct injection_input input = {.rows = ROWS, .columns = COLUMNS, .pixels = pixels};
    struct injection_result result;
    sea->injection->accuracy = 1e-4; /* below what a scene's file may ask for */
    EXPECT_REFUSED(sea, "times the usual number of rays",
                   injection_run(&sea->bench->report, sea->bench->tracer.device, &sea->bench->scene,
                                 &input, NULL, NULL, &result));
    assert_null(result.windows);
}
