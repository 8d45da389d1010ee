/* Tests that fouling has the fields that were asked for, and that the fields are the object's. */
#include "claims.h"
#include "fouling.h"

#include "physics/bench.h"
#include "trace/fouling.h"
#include "trace/object_buffer.h"

#define SEEDS 400

/* An object's record with its fouling behind it, as a launch lays both. */
struct fouled {
    struct object_record object;
    struct fouling_record fouling;
};

static void lay(struct fouled *fouled, struct bench *bench, uint32_t part, uint64_t seed)
{
    const struct placement *placement = &bench->placements[part];
    bench->scene.injection.seed = seed;
    object_record_init(&fouled->object, &bench->tracer, placement, placement->centre);
    fouling_record_init(&fouled->fouling, &bench->tracer, placement);
    fouled->object.fouling_words = sizeof fouled->object / 4;
}

static struct vector3 facet_of(const struct fouled *fouled, float x, float y, float z,
                               struct vector3 normal)
{
    const struct vector3 point = {x, y, z};
    return facet_at(&fouled->fouling, point, normal);
}

static double albedo_of(const struct fouled *fouled, float x, float y, float z)
{
    const struct vector3 point = {x, y, z};
    return (double)albedo_at(&fouled->fouling, point);
}

static const struct vector3 up = {0.0f, 0.0f, 1.0f};

static sonject_object_params *open_fouled(struct bench *bench, double albedo_db, double relief_m)
{
    bench_open(bench, 65, 65, 40.0);
    sonject_object_params *object = bench_add(bench, SHAPE_SPHERE, 0.0, 0.0, 0.5);
    object->heading_rad = 0.7;
    object->fouling = (sonject_fouling_params){albedo_db, 0.2, relief_m, 0.05};
    bench_ready(bench);
    return &bench->scene.objects[0];
}

/* Means are taken over points many lengths apart. Each of SEEDS fields gives one estimate. */
#define POINTS 16
static const float lags[] = {0.0f, 0.5f, 1.0f, 2.0f};

TEST(test_albedo_is_as_asked)
{
    static const double levels[] = {2.0, 4.0, 8.0};
    for (size_t l = 0; l < COUNT(levels); l++) {
        struct bench bench;
        struct fouled fouled;
        double means[SEEDS], lagged[COUNT(lags)][SEEDS];
        open_fouled(&bench, levels[l], 0.0);
        memset(lagged, 0, sizeof lagged);
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            means[seed] = 0.0;
            lay(&fouled, &bench, 0, seed);
            for (int i = 0; i < POINTS; i++) {
                const float x = 3.0f * (float)(i % 4), y = 2.0f * (float)(i / 4);
                const double albedo = albedo_of(&fouled, x, y, 0.1f);
                means[seed] += albedo / POINTS;
                /* dB values of a lognormal field of mean 1 have the mean -variance ln(10)/20 only
                 * if waves are many: levels count from the field's own mean over points */
                for (size_t k = 0; k < COUNT(lags); k++) {
                    const double other = albedo_of(&fouled, x, y + lags[k] * 0.2f, 0.1f);
                    const double mid =
                        10.0 * log10((double)fouled.fouling.albedo_peak) -
                        10.0 / log(10.0) * FOULING_WAVES * (double)fouled.fouling.albedo_gain;
                    lagged[k][seed] +=
                        (10.0 * log10(albedo) - mid) * (10.0 * log10(other) - mid) / POINTS;
                }
            }
        }
        expect_estimate("mean albedo", estimate_of(means, SEEDS), 1.0, 2e-4);
        for (size_t k = 0; k < COUNT(lags); k++) {
            const double lag = (double)lags[k];
            expect_estimate("covariance of its level, dB^2", estimate_of(lagged[k], SEEDS),
                            levels[l] * levels[l] * exp(-0.5 * lag * lag), 1e-3);
        }
        bench_close(&bench);
    }
}

TEST(test_slopes_are_as_asked)
{
    struct bench bench;
    struct fouled fouled;
    double lagged[COUNT(lags)][SEEDS];
    open_fouled(&bench, 0.0, 0.01);
    memset(lagged, 0, sizeof lagged);
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        lay(&fouled, &bench, 0, seed);
        for (int i = 0; i < POINTS; i++) {
            const float x = 3.0f * (float)(i % 4), y = 2.0f * (float)(i / 4);
            const struct vector3 here = facet_of(&fouled, x, y, 0.1f, up);
            for (size_t k = 0; k < COUNT(lags); k++) {
                const struct vector3 there = facet_of(&fouled, x, y + lags[k] * 0.05f, 0.1f, up);
                lagged[k][seed] += (double)(here.x * there.x) / POINTS;
            }
        }
    }
    /* the covariance is h^2/L^2 exp(-r^2/2L^2), across the slope */
    for (size_t k = 0; k < COUNT(lags); k++) {
        const double lag = (double)lags[k];
        expect_estimate("covariance of slopes", estimate_of(lagged[k], SEEDS),
                        0.04 * exp(-0.5 * lag * lag), 1e-5);
    }
    bench_close(&bench);
}

/* Returns the relief's height over the mean surface by the C library, m. */
static double height_at(const struct fouled *fouled, double x, double y, double z, double rms)
{
    double height = 0.0;
    for (int i = 0; i < FOULING_WAVES; i++) {
        const struct fouling_wave *wave = &fouled->fouling.relief[i];
        const double cycles = (double)wave->x * x + (double)wave->y * y + (double)wave->z * z +
                              (double)wave->phase - 0.25;
        height += rms * sqrt(2.0 / FOULING_WAVES) * cos(2.0 * PI * cycles);
    }
    return height;
}

/* A facet is n less the height's gradient along the surface, here by differences true to 1e-6. */
TEST(test_facets_are_the_reliefs)
{
    struct bench bench;
    struct fouled fouled;
    const double rms = 0.008, step = 1e-5;
    double worst = 0.0;
    open_fouled(&bench, 3.0, rms);
    for (uint32_t seed = 0; seed < 50; seed++) {
        const double turn = 0.37 * seed, x = 0.2 * cos(turn), y = 0.2 * sin(turn), z = 0.15;
        const struct vector3 normal = {0.8f * (float)cos(turn), 0.8f * (float)sin(turn), 0.6f};
        lay(&fouled, &bench, 0, seed);
        const struct vector3 facet = facet_of(&fouled, (float)x, (float)y, (float)z, normal);
        const double slope[3] = {
            (height_at(&fouled, x + step, y, z, rms) - height_at(&fouled, x - step, y, z, rms)) /
                (2.0 * step),
            (height_at(&fouled, x, y + step, z, rms) - height_at(&fouled, x, y - step, z, rms)) /
                (2.0 * step),
            (height_at(&fouled, x, y, z + step, rms) - height_at(&fouled, x, y, z - step, rms)) /
                (2.0 * step)};
        const double n[3] = {(double)normal.x, (double)normal.y, (double)normal.z};
        const double found[3] = {(double)(facet.x), (double)(facet.y), (double)(facet.z)};
        const double up_it = slope[0] * n[0] + slope[1] * n[1] + slope[2] * n[2];
        for (int i = 0; i < 3; i++)
            worst = fmax(worst, fabs(found[i] - (n[i] - slope[i] + up_it * n[i])));
    }
    /* cosines err by 5e-5, 12 waves' slopes by 12 times this times 2 pi h/L sqrt(2/12) */
    expect_below("error of a facet", worst, 12.0 * 5e-5 * 0.16 * 2.5 + 1e-6);
    bench_close(&bench);
}

TEST(test_cosine)
{
    double worst = 0.0;
    for (int i = -40000; i <= 40000; i++) {
        const float cycles = (float)i / 16384.0f;
        worst = fmax(worst, fabs((double)cosine_nearly(cycles) - cos(2.0 * PI * (double)cycles)));
    }
    expect_below("error of a wave's cosine", worst, 5e-5);
}

/* All parts of an object show one field, whichever way they lie. Other objects show another. */
TEST(test_the_field_is_the_objects)
{
    struct bench bench;
    struct fouled parts[2], other;
    bench_open(&bench, 65, 65, 40.0);
    sonject_object_params *object = bench_add(&bench, SHAPE_PARTS, 0.0, 0.0, 0.0);
    object->heading_rad = 0.8;
    object->roll_rad = 0.4;
    for (int i = 0; i < 2; i++) {
        struct scene_part part = {.object = 0};
        object_init(&part.shape);
        part.shape.diameter_m = 0.3;
        part.centre[0] = 0.2 * i;
        part.centre[1] = -0.1 * i;
        turn_axes(part.axes, 0.5 * i, 0.2 * i, 0.0);
        EXPECT_OK(&bench.report, scene_append_part(&bench.scene, &bench.report, &part));
    }
    bench_add(&bench, SHAPE_SPHERE, 0.0, 0.0, 0.3); /* may move the objects */
    for (int i = 0; i < 2; i++)
        bench.scene.objects[i].fouling = (sonject_fouling_params){6.0, 0.2, 0.005, 0.05};
    bench_ready(&bench);
    lay(&parts[0], &bench, 0, 7);
    lay(&parts[1], &bench, 1, 7);
    lay(&other, &bench, 2, 7);
    const double *from = bench.placements[0].centre, *to = bench.placements[1].centre;
    const float x = (float)(from[0] - to[0] + 0.1), y = (float)(from[1] - to[1] + 0.05),
                z = (float)(from[2] - to[2] + 0.02);
    const double albedo = albedo_of(&parts[0], 0.1f, 0.05f, 0.02f);
    /* tolerance: phases of a few cycles in single precision, times gains below 8 */
    expect_close("albedo", albedo_of(&parts[1], x, y, z) / albedo, 1.0, 2e-5);
    expect_close("slope", (double)facet_of(&parts[1], x, y, z, up).x,
                 (double)facet_of(&parts[0], 0.1f, 0.05f, 0.02f, up).x, 2e-5);
    assert_true(fabs(albedo_of(&other, 0.1f, 0.05f, 0.02f) / albedo - 1.0) > 0.01);
    bench_close(&bench);
}

TEST_PROGRAM(NULL, NULL)
