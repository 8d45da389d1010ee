/* Tests how draws move towards contacts in a world whose laws are known, and a campaign's file with
 * new numbers in their places. */
#include "claims.h"

#include "dataset/fit.h"
#include "scene_folder.h"

#define CONTACTS 400
#define ROUNDS   6

/* ---- A world where contacts show their sizes, some noise, and their levels. */

/* Distributions that are drawn from: centres, and half widths of uniform ones about them. */
struct draws_of_world {
    double centre[FITTED_KINDS], half[FITTED_KINDS];
};

static double noise(uint64_t seed, uint32_t stream, uint64_t index, double deviation)
{
    double sum = -6.0; /* the sum of twelve uniform numbers is normal enough */
    for (uint32_t i = 0; i < 12; i++)
        sum += uniform_number(seed, 100 + 12 * stream + i, index);
    return deviation * sum;
}

static void show(const struct draws_of_world *draws, uint64_t seed, uint64_t index,
                 struct drawn_contact *contact)
{
    double *of = contact->shown.of;
    for (uint32_t k = 0; k < FITTED_KINDS; k++)
        contact->drawn[k] = contact->now[k] =
            draws->centre[k] +
            draws->half[k] * (2.0 * stratified_number(seed, k, index, CONTACTS) - 1.0);
    const double heading = 2.0 * PI * stratified_number(seed, 20, index, CONTACTS);
    const double length = exp(contact->drawn[FITTED_LENGTH]);
    const double width = exp(contact->drawn[FITTED_WIDTH]);
    const double along = log(hypot(length * cos(heading), width * sin(heading)));
    const double across = log(hypot(length * sin(heading), width * cos(heading)));
    contact->heading_rad = heading;
    for (int i = 0; i < EXTENT_KINDS; i++)
        of[i] = NAN;
    of[EXTENT_SHADOW_ALONG] = along + noise(seed, 1, index, 0.1);
    of[EXTENT_HIGHLIGHT_ALONG] = along + noise(seed, 2, index, 0.1);
    of[EXTENT_HIGHLIGHT_RANGE] = across + noise(seed, 3, index, 0.2) - 0.5;
    of[EXTENT_SHADOW_HEIGHT] = contact->drawn[FITTED_HEIGHT] + noise(seed, 4, index, 0.1);
    of[EXTENT_HIGHLIGHT_LEVEL] = contact->drawn[FITTED_LEVEL] - 3.0 + noise(seed, 5, index, 1.0);
    of[EXTENT_SHADOW_LEVEL] = contact->drawn[FITTED_FLOOR] + noise(seed, 6, index, 1.0);
}

TEST(draws_reach_what_made_the_contacts)
{
    const struct draws_of_world hidden = {{-0.3, -1.0, -1.5, 13.0, -14.0},
                                          {0.4, 0.4, 0.5, 5.0, 0.0}};
    struct draws_of_world now = {{0.3, -0.6, -0.8, 30.0, -22.0}, {0.6, 0.4, 0.5, 3.0, 0.0}};
    static struct drawn_contact made[ROUNDS * CONTACTS];
    static struct contact_extents real[CONTACTS];
    struct quantile_goal goals[EXTENT_KINDS];
    struct move_prior prior = {.contacts = CONTACTS};
    for (uint64_t i = 0; i < CONTACTS; i++) {
        struct drawn_contact contact;
        show(&hidden, 1, i, &contact);
        real[i] = contact.shown;
    }
    EXPECT_OK(&folder->report, quantile_goals(&folder->report, real, CONTACTS, goals));
    assert_int_equal(goals[EXTENT_SHADOW_ALONG].levels, 9);
    assert_int_equal(goals[EXTENT_AXIS_LENGTH].levels, 0); /* no contact shows it */
    for (uint32_t round = 0; round < ROUNDS; round++) {
        struct draw_move moves[FITTED_KINDS];
        const size_t count = (round + 1) * (size_t)CONTACTS;
        for (uint64_t i = 0; i < CONTACTS; i++) {
            show(&now, 10 + round, i, &made[round * CONTACTS + i]);
            made[round * CONTACTS + i].round = round;
        }
        EXPECT_OK(&folder->report, fit_moves(&folder->report, made, count, goals, &prior, moves));
        for (size_t k = 0; k < FITTED_KINDS; k++) {
            prior.shift[k] += moves[k].shift;
            prior.stretch[k] += log(moves[k].stretch);
            now.centre[k] = draw_moved(&moves[k], now.centre[k]);
            now.half[k] *= moves[k].stretch;
            for (size_t i = 0; i < count; i++)
                made[i].now[k] = draw_moved(&moves[k], made[i].now[k]);
        }
    }
    /* Tolerances are four standard errors, and what the belief in the campaign's own values leaves.
     * Means of 400 contacts of such spreads have standard errors of 0.02 (twice as much for sizes,
     * as headings show one or another), 0.15 dB and 0.05 dB. */
    static const double tolerances[FITTED_KINDS] = {0.12, 0.12, 0.08, 0.8, 0.5};
    for (size_t k = 0; k < FITTED_KINDS; k++) {
        print_message("%zu: %.3f of %.3f, half %.3f of %.3f\n", k, now.centre[k], hidden.centre[k],
                      now.half[k], hidden.half[k]);
        assert_true(fabs(now.centre[k] - hidden.centre[k]) < tolerances[k]);
    }
    assert_true(fabs(now.half[FITTED_LEVEL] - 5.0) < 1.0);
}

static const struct draws_of_world world = {{0.0, 0.0, -1.0, 10.0, -15.0},
                                            {0.5, 0.5, 0.5, 5.0, 0.0}};
static const struct move_prior unmoved = {.contacts = CONTACTS};

/* Returns the move of heights where copies of one extent ask for 0.2 more and another for none. */
static double move_by_copies(size_t copies)
{
    static const enum extent alike[] = {EXTENT_SHADOW_HEIGHT, EXTENT_AXIS_LENGTH, EXTENT_AXIS_WIDTH,
                                        EXTENT_HIGHLIGHT_ROWS};
    static struct drawn_contact made[CONTACTS];
    static struct contact_extents real[CONTACTS];
    struct quantile_goal goals[EXTENT_KINDS];
    struct draw_move moves[FITTED_KINDS];
    for (uint64_t i = 0; i < CONTACTS; i++) {
        show(&world, 1, i, &made[i]);
        double *of = made[i].shown.of;
        const double shown = made[i].drawn[FITTED_HEIGHT] + noise(3, 1, i, 0.3);
        of[EXTENT_SHADOW_HEIGHT] = of[EXTENT_SHADOW_LEVEL] = NAN;
        of[EXTENT_SHADOW_ALONG] = made[i].drawn[FITTED_HEIGHT] + noise(3, 2, i, 0.3);
        real[i] = made[i].shown;
        for (size_t k = 0; k < copies; k++) {
            of[alike[k]] = shown;
            real[i].of[alike[k]] = shown + 0.2;
        }
        made[i].round = 0;
    }
    EXPECT_OK(&folder->report, quantile_goals(&folder->report, real, CONTACTS, goals));
    EXPECT_OK(&folder->report, fit_moves(&folder->report, made, CONTACTS, goals, &unmoved, moves));
    return moves[FITTED_HEIGHT].shift;
}

/* Four copies of an extent are not four extents. Independent ones would move heights four fifths of
 * the way. */
TEST(copies_of_an_extent_count_little)
{
    const double one = move_by_copies(1);
    const double four = move_by_copies(4);
    print_message("one: %.3f, four: %.3f\n", one, four);
    assert_true(one > 0.07 && one < 0.13);
    assert_true(four - one < 0.5 * (0.16 - 0.1));
}

/* In a round that has been stretched since, the largest contacts alone have hardly moved. They
 * alone are no sample. */
TEST(rounds_are_compared_whole)
{
    static struct drawn_contact made[2 * CONTACTS];
    static struct contact_extents real[CONTACTS];
    struct quantile_goal goals[EXTENT_KINDS];
    struct draw_move moves[FITTED_KINDS];
    for (uint64_t i = 0; i < CONTACTS; i++) {
        struct drawn_contact *old = &made[i], *now = &made[CONTACTS + i];
        show(&world, 2, i, now);
        real[i] = now->shown;
        now->round = 1;
        show(&world, 2, i, old);
        /* the old round was drawn 0.4 times as widely, about the upper end */
        for (size_t k = 0; k < FITTED_KINDS; k++)
            old->drawn[k] = world.centre[k] + world.half[k] +
                            0.4 * (now->drawn[k] - world.centre[k] - world.half[k]);
        old->round = 0;
    }
    EXPECT_OK(&folder->report, quantile_goals(&folder->report, real, CONTACTS, goals));
    EXPECT_OK(&folder->report,
              fit_moves(&folder->report, made, (size_t)2 * CONTACTS, goals, &unmoved, moves));
    for (size_t k = 0; k < FITTED_LEVEL; k++) {
        print_message("%zu: %.4f\n", k, moves[k].shift);
        assert_true(fabs(moves[k].shift) < 0.01);
    }
}

TEST(a_median_has_the_error_of_statistics)
{
    /* normal distribution: sqrt(pi / 2) of the mean's error */
    const double error = quantile_error(0.5, 2.0 * 0.67449 * 3.0, 100.0);
    assert_true(fabs(error - 0.3 * sqrt(PI / 2.0)) < 1e-3);
    /* at 5 %: sqrt(0.05 * 0.95) / phi(1.6449) */
    const double tail = 10.0 * quantile_error(0.05, 2.0 * 0.67449, 100.0);
    assert_true(fabs(tail - sqrt(0.0475) / 0.10314) < 0.01);
}

/* A quantile of ten values between 0 and 1 is too low in as many samples as it is too high. */
TEST(quantiles_of_few_are_in_the_middle)
{
    enum {
        SAMPLES = 4000,
        VALUES = 10
    };
    for (int fifth = 1; fifth < 5; fifth++) {
        const double share = 0.2 * fifth;
        double low = 0.0;
        for (uint64_t sample = 0; sample < SAMPLES; sample++) {
            double values[VALUES];
            for (uint64_t i = 0; i < VALUES; i++)
                values[i] = uniform_number(7, 0, sample * VALUES + i);
            qsort(values, VALUES, sizeof *values, compare_doubles);
            low += sorted_quantile(values, VALUES, share) < share ? 1.0 / SAMPLES : 0.0;
        }
        /* four standard errors, and the error of straight lines between values */
        assert_true(fabs(low - 0.5) < 4.0 * 0.5 / sqrt(SAMPLES) + 0.01);
    }
}

/* The smallest and the largest of ten have large errors, but finite ones. */
TEST(ends_of_published_quantiles_have_errors)
{
    for (int end = 0; end <= 1; end++) {
        const double error = quantile_error(end, 1.0, 10.0);
        assert_true(error > quantile_error(0.5, 1.0, 10.0) && error < 10.0);
    }
}

/* ---- Files. */

static const char block_file[] =
    "# mines of ours\n"
    "sonject_campaign: 1\n"
    "scene: s.yaml\n"
    "images: 10 # a few\n"
    "chip:\n"
    "  rows: 64\n"
    "  columns: 64\n"
    "swaths: [{path: a.tif}, {path: b.tif}, {path: c.tif, range_over_altitude: [1, 9]}]\n"
    "targets:\n"
    "  - class: \"m\xc3\xbcll\" # \xc3\xbc\n"
    "    object: {shape: box, height: 2 m}\n"
    "    draw:\n"
    "      length: {log_uniform: [100 cm, 400 cm]} # of all\n"
    "      heading: 30 deg\n"
    "  - {class: \"t\xc3\xbcn\", object: {shape: cylinder}, "
    "draw: {length: 2, diameter: {of: length, uniform: [0.25, 0.5]}}}\n";

static const char moved_file[] =
    "# fitted\n"
    "# mines of ours\n"
    "sonject_campaign: 1\n"
    "scene: s.yaml\n"
    "images: 10 # a few\n"
    "chip:\n"
    "  range_over_altitude: [1.5, 6.25]\n"
    "  rows: 64\n"
    "  columns: 64\n"
    "swaths: [{range_over_altitude: [2, 4], path: a.tif}, {path: b.tif}, {path: c.tif, "
    "range_over_altitude: [1.25, 3]}]\n"
    "targets:\n"
    "  - class: \"m\xc3\xbcll\" # \xc3\xbc\n"
    "    object: {shape: box, height: 2 m}\n"
    "    draw:\n"
    "      level.over_seabed: {uniform: [12 dB, 24 dB]}\n"
    "      length: {log_uniform: [50 cm, 200 cm]} # of all\n"
    "      heading: 30 deg\n"
    "  - {class: \"t\xc3\xbcn\", object: {shape: cylinder}, draw: {level.over_seabed: {uniform: "
    "[12 dB, "
    "24 dB]}, length: 1, diameter: {of: length, uniform: [0.125, 0.25]}}}\n"
    "draw: {injection.noise_floor: -15 dB}\n"
    "visible: {highlight: 1.2 dB, shadow: -2.3 dB, otherwise: redraw}\n";

TEST(a_fitted_file_is_the_users_own_with_other_numbers)
{
    struct report *report = &folder->report;
    /* lengths halve; widths and heights fall to a quarter; levels spread to twice their width */
    const struct draw_move moves[FITTED_KINDS] = {{0.0, log(0.5), 1.0},
                                                  {0.0, log(0.25), 1.0},
                                                  {0.0, log(0.25), 1.0},
                                                  {21.0, -3.0, 2.0},
                                                  {-22.0, 7.0, 1.0}};
    static struct campaign campaign;
    struct fit_draws draws;
    char *text;
    memset(&draws, 0, sizeof draws);
    write_file("campaign.yaml", block_file, strlen(block_file));
    EXPECT_OK(report, campaign_read(report, file_in("campaign.yaml"), NULL, NULL, 0, &campaign));
    EXPECT_OK(report, fit_draws_find(&draws, report, &campaign));
    assert_string_equal(draws.unchanged.characters, "targets[0].draw.heading\n");
    assert_non_null(strstr(draws.fixed.characters, "are not fitted: m\xc3\xbcll (width, height)"));
    draws.level_db[0] = 18.0;
    draws.level_db[1] = 24.0;
    draws.floor_db = -22.0;
    draws.has_added = true;
    fit_draws_move(&draws, moves);
    struct ratio_limits swaths[] = {{2.0, 4.0}, {0.0, 0.0}, {1.25, 3.0}};
    const struct fitted_selection selection = {1.2, -2.3, {1.5, 6.25}, swaths};
    EXPECT_OK(report, fit_draws_text(&draws, report, &selection, "# fitted\n", &text));
    assert_string_equal(text, moved_file);
    free(text);
    fit_draws_clear(&draws);
    campaign_clear(&campaign);
}

static char *fitted_text(const char *file, const char *override, char unchanged[200])
{
    static struct campaign campaign;
    static const struct draw_move moves[FITTED_KINDS] = {
        {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 1.0, 1.0}, {0.0, 2.0, 1.0}};
    static const struct fitted_selection selection = {1.2, -2.3, {1.5, 6.25}, NULL};
    struct report *report = &folder->report;
    struct fit_draws draws;
    char *text = NULL;
    memset(&draws, 0, sizeof draws);
    write_file("campaign.yaml", file, strlen(file));
    EXPECT_OK(report, campaign_read(report, file_in("campaign.yaml"), NULL, &override,
                                    override ? 1 : 0, &campaign));
    EXPECT_OK(report, fit_draws_find(&draws, report, &campaign));
    snprintf(unchanged, 200, "%s", draws.unchanged.characters ? draws.unchanged.characters : "");
    fit_draws_move(&draws, moves);
    fit_draws_text(&draws, report, &selection, "", &text);
    fit_draws_clear(&draws);
    campaign_clear(&campaign);
    return text;
}

/* Sections in braces go on over lines, and the whole file may be one. */
static const char flow_file[] = "{sonject_campaign: 1, scene: s.yaml, images: 10,\n"
                                " chip: {\n  rows: 64, columns: 64},\n"
                                " swaths: [{path: a.tif}],\n"
                                " draw: {injection.noise_floor: {uniform: [-20 dB, -18 dB]}},\n"
                                " targets: [{class: tin, object: {shape: sphere, diameter: 1},\n"
                                "  draw: {level.over_seabed: 12 dB}}]}\n";

TEST(what_is_in_braces_stays_so)
{
    char unchanged[200];
    char *text = fitted_text(flow_file, NULL, unchanged);
    assert_string_equal(text,
                        "{visible: {highlight: 1.2 dB, shadow: -2.3 dB, otherwise: redraw}, "
                        "sonject_campaign: 1, scene: s.yaml, images: 10,\n"
                        " chip: {\n  range_over_altitude: [1.5, 6.25], rows: 64, columns: 64},\n"
                        " swaths: [{path: a.tif}],\n"
                        " draw: {injection.noise_floor: {uniform: [-18 dB, -16 dB]}},\n"
                        " targets: [{class: tin, object: {shape: sphere, diameter: 1},\n"
                        "  draw: {level.over_seabed: 13 dB}}]}\n");
    assert_string_equal(unchanged, ""); /* the noise floor is moved */
    free(text);
}

TEST(what_overrides_give_is_not_written_over)
{
    static const char *const overrides[] = {"visible={highlight: 3 dB, shadow: -1 dB}",
                                            "chip.range_over_altitude=[2, 9]",
                                            "chip={rows: 64, columns: 64}"};
    for (size_t i = 0; i < COUNT(overrides); i++) {
        char unchanged[200];
        assert_null(fitted_text(flow_file, overrides[i], unchanged));
        assert_non_null(strstr(folder->report.message, "gives a key that the fit changes"));
        assert_memory_equal(folder->report.message, "--set ", 6);
    }
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
