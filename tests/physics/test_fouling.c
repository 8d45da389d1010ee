/* Fouling keeps the mean level of an object's material. It takes from glints as roughness does. */
#include "sea.h"

#define ROWS    65
#define COLUMNS 65
#define RANGE   40.0
#define RADIUS  0.25
#define SEEDS   100

static sonject_object_params *open_ball(struct sea **sea, double albedo_db, double relief_m)
{
    *sea = sea_open(ROWS, COLUMNS, RANGE);
    sonject_object_params *ball = sea_add_sphere(*sea, RADIUS, 0.5);
    ball->fouling = (sonject_fouling_params){albedo_db, 0.02, relief_m, 0.02};
    return ball;
}

/* Returns the energy of a ball with fouling over that without, which rays know to 1e-4. */
static struct estimate level_of(double albedo_db, double relief_m)
{
    double ratios[SEEDS];
    struct sea *sea;
    open_ball(&sea, albedo_db, relief_m);
    make_rough(sea_object(sea, 0), 0.1);
    struct tile_sums sums;
    for (int seed = 0; seed < SEEDS; seed++) {
        sea->injection->seed = (uint64_t)seed;
        sea_rough(sea, &sums, NULL);
        ratios[seed] = sums.energy;
    }
    memset(&sea_object(sea, 0)->fouling, 0, sizeof(sonject_fouling_params));
    sea_rough(sea, &sums, NULL);
    for (int seed = 0; seed < SEEDS; seed++)
        ratios[seed] /= sums.energy;
    return estimate_of(ratios, SEEDS);
}

CLAIM(albedo_leaves_the_mean_level)
{
    expect_estimate("level with 4 dB", level_of(4.0, 0.0), 1.0, 0.0);
    expect_estimate("level with 7 dB", level_of(7.0, 0.0), 1.0, 0.0);
}

/* Returns the level of a ball with slopes of rms s over that of a clean ball. Where the surface
 * stands at the cosine u to the sonar, a clean facet shows u. A sloped one shows u + s sqrt(1 -
 * u^2) g, g normal, limited to 0...4 u, which is a little more on the mean. */
static double level_on_slopes(double slope)
{
    double sum = 0.0;
    for (int i = 0; i < 400; i++) {
        const double u = (i + 0.5) / 400.0, across = slope * sqrt(1.0 - u * u);
        double mean = 0.0, weight = 0.0;
        for (double g = -6.0; g <= 6.0; g += 0.02) {
            const double share = exp(-0.5 * g * g);
            mean += share * fmin(fmax(u + across * g, 0.0), 4.0 * u);
            weight += share;
        }
        sum += mean / weight * 2.0 * u / 400.0;
    }
    return sum / (2.0 / 3.0);
}

CLAIM(relief_changes_the_level_by_what_facets_hide_alone)
{
    expect_estimate("level on slopes of 0.1", level_of(0.0, 0.002), level_on_slopes(0.1), 1e-4);
    expect_estimate("level on slopes of 0.4", level_of(0.0, 0.008), level_on_slopes(0.4), 1e-3);
}

/* The sound that the ball sends on to the seabed, or gets from there, keeps its level. */
CLAIM(albedo_leaves_the_level_of_two_interactions)
{
    static const struct ranges all = {0, 0.0, 1.0};
    struct sea *sea;
    struct energies energies[2];
    for (int is_fouled = 0; is_fouled < 2; is_fouled++) {
        open_ball(&sea, is_fouled ? 4.0 : 0.0, is_fouled ? 0.001 : 0.0);
        make_rough(sea_object(sea, 0), 0.1);
        sea->injection->interactions = 2;
        energies[is_fouled] = sea_chains(sea, &all, 1, 60);
    }
    const struct estimate ratio =
        ratio_of(energy_of(&energies[1], 1, 0), energy_of(&energies[0], 1, 0));
    expect_estimate("energy of two interactions", ratio, 1.0, 1e-3);
    expect_below("its error", ratio.error, 0.05);
    /* the scatter from seed to seed is the growth's */
    expect_below("scatter without growth over that with it",
                 energy_of(&energies[0], 1, 0).error / energy_of(&energies[1], 1, 0).error, 0.5);
}

CLAIM(relief_takes_from_glints_as_roughness_does)
{
    struct sea *sea;
    double peaks[3], range;
    for (int i = 0; i < 3; i++) {
        open_ball(&sea, 0.0, i == 1 ? 0.001 : 0.0);
        sea_object(sea, 0)->material.roughness_m = i == 2 ? hypot(0.0005, 0.001) : 0.0005;
        sea_ready(sea);
        peaks[i] = sea_peak(sea, &range);
    }
    assert_true(peaks[1] == peaks[2]);
    const double phase = 2.0 * sea_wavenumber(sea) * 0.001;
    expect_close("share of the glint", peaks[1] / peaks[0], exp(-0.5 * phase * phase), 1e-3);
}
