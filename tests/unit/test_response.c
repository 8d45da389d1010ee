/* Tests measured responses and motion from callers and files: what is taken, and what is refused in
 * one line. */
#include "claims.h"

#include "scene_folder.h"

#define RESPONSE START INPUT "sonar:\n  frequency: 100e3\n  bandwidth: 30e3\n  altitude: 10\n"

static void expect_refused_table(const char *key, const char *table, const char *message)
{
    char scene[1200], expected[TEMPORARY_CAPACITY + 300];
    write_file("table.csv", table, strlen(table));
    snprintf(scene, sizeof scene, RESPONSE "  %s\n", key);
    assert_int_equal(read_scene_text(scene, NULL, 0), SONJECT_ERROR_INPUT);
    snprintf(expected, sizeof expected, "%s%s", file_in("table.csv"), message);
    assert_string_equal(folder->report.message, expected);
}

#define PULSE  "pulse: {kind: table, file: table.csv}"
#define CROSS  "measured_response: table.csv"
#define MOTION "motion: {file: table.csv}"
#define YAW    "motion: {yaw: {advance: 1, file: table.csv}}"

TEST(test_hostile_tables)
{
    static const struct {
        const char *key, *table, *message;
    } cases[] = {
        {PULSE, "range_m,real\n-1,0\n0,1\n1,0\n",
         ":4: range_m: must have 4...65536 samples, not 3"},
        {PULSE, "range_m,real\n-1,0\n0,1\n0,1\n1,0\n",
         ":4: range_m: must be above that of the sample before, 0, not 0"},
        {PULSE, "range_m,real\n-1,0\n0,inf\n1,1\n2,0\n",
         ":3: real: must be within +-1e+15, not inf"},
        {PULSE, "time_s,real,imaginary\n-1,0,0\n0,1,-1e300\n1,1,0\n2,0,0\n",
         ":3: imaginary: must be within +-1e+15, not -1e+300"},
        {PULSE, "range_m,real\n-1,0\n0,0\n1,0\n2,0\n",
         ":5: range_m: must have a sample whose value is not 0"},
        {PULSE, "range_m,real\n0,0\n1,1\n2,0\n3,0\n",
         ":5: range_m: must reach from below position 0, the target's, to above it"},
        {PULSE, "range_m,real\n-1e7,0\n1,1\n2,0\n3,0\n",
         ":2: range_m: must be within +-1e+06, not -1e+07"},
        {CROSS, "along_track_m,real\n-1,0\n1,0\n0,1\n2,0\n",
         ":4: along_track_m: must be above that of the sample before, 1, not 0"},
        {YAW, "along_track_m,yaw_rad\n1,0\n2,0.2\n", ":3: yaw_rad: must be within +-0.1, not 0.2"},
        {MOTION, "along_track_m,sway_m\n1,2\n",
         ":2: along_track_m: must have 2...65536 samples, not 1"},
        {MOTION, "along_track_m,sway_m\n1,0\n2,2000\n",
         ":3: sway_m: must be within +-1000, not 2000"},
        {MOTION, "along_track_m,sway_m\n1,0\n1,0\n",
         ":3: along_track_m: must be above that of the sample before, 1, not 1"},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        expect_refused_table(cases[i].key, cases[i].table, cases[i].message);
}

TEST(test_hostile_keys)
{
    static const struct {
        const char *key, *message;
    } cases[] = {
        {"pulse: chirp", ":7:10: sonar.pulse: must be a section of 'key: value' lines"},
        {"pulse: {kind: gaussian, window: hann}",
         ":7:35: sonar.pulse.window: only a chirp has one; set kind: chirp"},
        {"pulse: {kind: table}", ":7:10: sonar.pulse.file: missing; the table is read from it"},
        {"pulse: {kind: chirp, file: scene.yaml}",
         ":7:30: sonar.pulse.file: belongs to kind: table; remove it"},
        {"motion: {yaw: {bias: 1 deg}}", "sonar.motion.yaw.advance: missing"},
        {"motion: {yaw: {advance: 0}}", "sonar.motion.yaw.advance: must be 0.1...1000 m, not 0"},
        {"motion: {yaw: {advance: 1, bias: -9 deg}}",
         "sonar.motion.yaw.bias: must be -5.72957...5.72957 deg, not -"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        char scene[1200];
        snprintf(scene, sizeof scene, RESPONSE "  %s\n", cases[i].key);
        assert_int_equal(read_scene_text(scene, NULL, 0), SONJECT_ERROR_INPUT);
        if (!strstr(folder->report.message, cases[i].message))
            fail_msg("%s\nnot: %s", folder->report.message, cases[i].message);
    }
}

/* The cubic goes through the samples, is exact for parabolas, and the largest sample is 1. */
TEST(test_interpolation)
{
    double x[9], real_part[9], imaginary_part[9];
    struct report report = {.host = NULL};
    struct response_table table;
    memset(&table, 0, sizeof table);
    for (int i = 0; i < 9; i++) {
        x[i] = 0.3 * (i - 4) + 0.02 * (i - 4) * (i - 4) - 0.1; /* uneven steps */
        real_part[i] = 2.0 - x[i] * x[i];
        imaginary_part[i] = 0.0;
    }
    assert_int_equal(response_table_set(&table, &report, x, real_part, imaginary_part, 9, false),
                     SONJECT_OK);
    double peak = 0.0;
    for (int i = 0; i < 9; i++)
        peak = fmax(peak, real_part[i]);
    double energy = 0.0;
    for (int i = 0; i < 1000; i++) {
        const double at = x[1] + (x[7] - x[1]) * (i + 0.5) / 1000.0;
        const struct complex_number value = response_table_at(&table, at);
        assert_true(fabs(value.real_part - (2.0 - at * at) / peak) < 1e-12); /* rounding */
        assert_true(fabs(value.imaginary_part) < 1e-15);
        energy += pow((2.0 - at * at) / peak, 2.0) * (x[7] - x[1]) / 1000.0;
    }
    /* tolerance: midpoints of 1000 steps */
    assert_true(fabs(response_table_energy(&table, x[1], x[7]) / energy - 1.0) < 1e-5);
    assert_true(response_table_at(&table, x[0] - 0.01).real_part == 0.0);
    assert_true(response_table_at(&table, x[8] + 0.01).real_part == 0.0);
    const double reach = response_table_reach(&table, 0.1);
    assert_true(fabs(response_table_energy(&table, -reach, reach) /
                         response_table_energy(&table, -9.0, 9.0) -
                     0.9) < 1e-9);
    response_table_clear(&table);
}

/* A peak of any phase becomes 1. */
TEST(test_normalisation)
{
    const double x[] = {-1.0, 0.0, 0.5, 1.0};
    const double real_part[] = {1.0, 3.0, 0.0, 0.0};
    const double imaginary_part[] = {0.0, -4.0, 2.5, 0.0};
    struct report report = {.host = NULL};
    struct response_table table;
    memset(&table, 0, sizeof table);
    assert_int_equal(response_table_set(&table, &report, x, real_part, imaginary_part, 4, false),
                     SONJECT_OK);
    const struct complex_number peak = response_table_at(&table, 0.0);
    const struct complex_number side = response_table_at(&table, 0.5);
    assert_true(fabs(peak.real_part - 1.0) < 1e-15 && fabs(peak.imaginary_part) < 1e-15);
    /* 2.5 i / (3 - 4 i) = (-10 + 7.5 i) / 25 */
    assert_true(fabs(side.real_part + 0.4) < 1e-15 && fabs(side.imaginary_part - 0.3) < 1e-15);
    response_table_clear(&table);
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
