/* Tests tables of sound speeds: every way to write them, and files that are not tables. */
#include "claims.h"
#include "clean_folder.h"
#include "schema/tables.h"

static sonject_status read_bytes(const void *bytes, size_t count, struct profile_table *table)
{
    const char *path = file_in("cast.csv");
    write_bytes(path, bytes, count);
    memset(table, 0, sizeof *table);
    return profile_table_read(&report, path, NULL, table);
}

/* Expects the samples of all good tables: 12 m and 1490.5 m/s, then 15.5 m and 1.5e3 m/s. */
static void expect_taken(const char *text, bool is_depth)
{
    struct profile_table table;
    if (read_bytes(text, strlen(text), &table) != SONJECT_OK)
        fail_msg("%s\nwas refused: %s", text, report.message);
    assert_int_equal(table.count, 2);
    assert_int_equal(table.is_depth, is_depth);
    assert_true(table.positions_m[0] == 12.0 && table.positions_m[1] == 15.5);
    assert_true(table.speeds_mps[0] == 1490.5 && table.speeds_mps[1] == 1500.0);
    profile_table_clear(&table);
}

CLEAN(test_every_way_to_write_a_table)
{
    expect_taken("height_m,sound_speed_mps\n12,1490.5\n15.5,1.5e3\n", false);
    expect_taken("height_m,sound_speed_mps\n12,1490.5\n15.5,1.5e3", false);
    expect_taken("depth_m;sound_speed_mps\r\n12;1490.5\r\n15.5;1500\r\n", true);
    expect_taken("depth_m sound_speed_mps\n12 1490.5\n15.5 1500\n", true);
    expect_taken("\tdepth_m\t  sound_speed_mps\n 12\t\t1490.5  \n15.5 \t1500\t\n", true);
    expect_taken("sound_speed_mps , height_m\n 1490.5 ,\t12\n1500, 15.5 \n", false);
    expect_taken("\xEF\xBB\xBFheight_m,sound_speed_mps\n12,1490.5\n15.5,1500\n", false);
    expect_taken("# of 20\xB0"
                 "C\n\n \t \nheight_m,sound_speed_mps# metres\n#\n12,1490.5 # a\n\n"
                 "15.5,1500#\n#",
                 false);
    expect_taken("time;depth_m;temp, C;sound_speed_mps;\n"
                 "10:00;12;4,5;1490.5;\n10:01;15.5;;1500;\n",
                 true);
    expect_taken("\"depth_m\", \"a \"\"b\"\", #c\",sound_speed_mps\n\"12\" ,\"d,e\",1490.5 # \"f\n"
                 "15.5,\"\",\"1500\"#\n",
                 true);
    expect_taken("a;\"depth_m\";sound_speed_mps\n\"x;12;1490.5\ny\"z;15.5;1500\n", true);
}

CLEAN(test_heights_rise_however_the_table_runs)
{
    static const struct {
        const char *text;
        double heights[3], speeds[3];
    } tables[] = {
        {"height_m,sound_speed_mps\n1,1501\n2,1502\n4,1504\n", {1, 2, 4}, {1501, 1502, 1504}},
        {"height_m,sound_speed_mps\n4,1504\n2,1502\n1,1501\n", {1, 2, 4}, {1501, 1502, 1504}},
        {"depth_m,sound_speed_mps\n1,1501\n2,1502\n4,1504\n", {16, 18, 19}, {1504, 1502, 1501}},
        {"depth_m,sound_speed_mps\n4,1504\n2,1502\n1,1501\n", {16, 18, 19}, {1504, 1502, 1501}},
        {"depth_m,sound_speed_mps\n19,1501\n20,1502\n24,1504\n", {-4, 0, 1}, {1504, 1502, 1501}},
    };
    for (size_t i = 0; i < COUNT(tables); i++) {
        struct profile_table table;
        EXPECT_OK(&report, read_bytes(tables[i].text, strlen(tables[i].text), &table));
        profile_table_to_heights(&table, 20.0);
        assert_int_equal(table.count, 3);
        assert_memory_equal(table.positions_m, tables[i].heights, sizeof tables[i].heights);
        assert_memory_equal(table.speeds_mps, tables[i].speeds, sizeof tables[i].speeds);
        profile_table_clear(&table);
    }
}

/* Expects a refusal. message: the text behind the file's name. */
static void expect_refused(const void *bytes, size_t count, const char *message)
{
    struct profile_table table;
    if (read_bytes(bytes, count, &table) != SONJECT_ERROR_INPUT)
        fail_msg("not refused, though %s", message);
    assert_null(table.positions_m);
    const size_t place = strlen(folder->file);
    if (strncmp(report.message, folder->file, place) != 0 ||
        strcmp(report.message + place, message) != 0)
        fail_msg("the message is\n%s\nand not\n%s%s", report.message, folder->file, message);
}

#define H "height_m,sound_speed_mps\n"

CLEAN(test_tables_that_are_wrong)
{
    static const struct {
        const char *text, *message;
    } wrong[] = {
        {"", ": there is nothing in it"},
        {"# only a comment\n\n", ": there is nothing in it"},
        {"12,1490\n15,1500\n", ":1: this line must name the columns, among them height_m or "
                               "depth_m, and sound_speed_mps"},
        {"\nheight_m\n12\n15\n", ":2: this line must name the columns, among them height_m or "
                                 "depth_m, and sound_speed_mps"},
        {"sound_speed_mps,height\n", ":1: this line must name the columns, among them height_m or "
                                     "depth_m, and sound_speed_mps"},
        {"height_m,depth_m,sound_speed_mps\n",
         ":1: both height_m and depth_m are there; rename one"},
        {"height_m,height_m,sound_speed_mps\n",
         ":1: height_m: two columns of this name; rename one"},
        {H, ":1: height_m: a profile needs at least two samples, not 0"},
        {H "1,1500\n", ":2: height_m: a profile needs at least two samples, not 1"},
        {H "1,1500\n2\n", ":3: has 1 column, but 2 have names"},
        {H "1,1500\n2,\n", ":3: sound_speed_mps: '' is not a number"},
        {H "1,1500\n2,1500,3\n", ":3: has 3 columns, but 2 have names"},
        {H "1 1500\n2 1500\n", ":2: has 1 column, but 2 have names"},
        {H "# two\n\n1,1500\n2,nan\n", ":5: sound_speed_mps: 'nan' is not a number"},
        {H "1,1500\nNaN,1500\n", ":3: height_m: 'NaN' is not a number"},
        {H "1,1500\n2,inf\n", ":3: sound_speed_mps: must be 100...10000 m/s, not inf"},
        {H "1,1500\n-inf,1500\n", ":3: height_m: must be -1e+06...1e+06 m, not -inf"},
        {H "1,1500\n1e999,1500\n", ":3: height_m: must be -1e+06...1e+06 m, not inf"},
        {H "1,1.5\n2,1.6\n", ":2: sound_speed_mps: must be 100...10000 m/s, not 1.5"},
        {"depth_m,sound_speed_mps\n-1,1500\n2,1500\n", ":2: depth_m: must be 0...1e+06 m, not -1"},
        {H "1,1500\n2,1500 m/s\n", ":3: sound_speed_mps: '1500 m/s' is not a number"},
        {"height_m;sound_speed_mps\n1;1500,5\n", ":2: sound_speed_mps: '1500,5' is not a number"},
        {H "1,1500\n1,1501\n",
         ":3: height_m: must rise or fall from one to the next by at least 1e-06 m; 1 follows 1"},
        {H "1,1500\n2,1501\n2.0000001,1501\n",
         ":4: height_m: must go on rising from one to the next by at least 1e-06 m; 2.0000001 "
         "follows 2"},
        {H "\n1,1500\n2,1501\n1.5,1501\n",
         ":5: height_m: must go on rising from one to the next by at least 1e-06 m; 1.5 follows 2"},
        {"depth_m,sound_speed_mps\n2,1500\n1,1501\n3,1501\n",
         ":4: depth_m: must go on falling from one to the next by at least 1e-06 m; 3 follows 1"},
        {H "1,1500\n\x01,1500\n", ":3: not UTF-8 text; is this a table?"},
        {H "1,1500\n2,\xFF\n", ":3: not UTF-8 text; is this a table?"},
        {H "1,12345678901234567890123456789012345678901234567890x\n",
         ":2: sound_speed_mps: '123456789012345678901234567890123456...' is not a number"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++)
        expect_refused(wrong[i].text, strlen(wrong[i].text), wrong[i].message);
    expect_refused(H "1,1500\n2,15\00000\n", sizeof H "1,1500\n2,15\00000\n" - 1,
                   ":3: not UTF-8 text; is this a table?");
    expect_refused("\x89PNG\r\n\x1A\n", 8, ":1: not UTF-8 text; is this a table?");
}

CLEAN(test_limits)
{
    char *text = zeroed(PROFILE_BYTES_MAX + 2, 1);
    size_t length = (size_t)sprintf(text, H);
    for (int i = 0; i < PROFILE_SAMPLES_MAX; i++)
        length += (size_t)sprintf(text + length, "%d,1500\n", i);
    struct profile_table table;
    EXPECT_OK(&report, read_bytes(text, length, &table));
    assert_int_equal(table.count, PROFILE_SAMPLES_MAX);
    profile_table_clear(&table);
    length += (size_t)sprintf(text + length, "%d,1500\n", PROFILE_SAMPLES_MAX);
    expect_refused(text, length, ":4098: more than 4096 samples; thin them out");

    length = (size_t)sprintf(text, "height_m,sound_speed_mps");
    for (int i = 0; i < 62; i++)
        length += (size_t)sprintf(text + length, ",c%d", i);
    expect_refused(text, length, ":1: height_m: a profile needs at least two samples, not 0");
    length += (size_t)sprintf(text + length, ",one\n");
    expect_refused(text, length, ":1: more than 64 columns; remove those that are not needed");

    memset(text, '#', PROFILE_BYTES_MAX + 1);
    expect_refused(text, PROFILE_BYTES_MAX, ": there is nothing in it");
    expect_refused(text, PROFILE_BYTES_MAX + 1, ": larger than 1048576 bytes");
    memset(text, ',', PROFILE_BYTES_MAX);
    expect_refused(text, PROFILE_BYTES_MAX,
                   ":1: more than 64 columns; remove those that are not needed");
    free(text);
}

CLEAN(test_files_that_cannot_be_read)
{
    struct profile_table table = {NULL, NULL, 0, false};
    assert_int_equal(profile_table_read(&report, file_in("absent.csv"), NULL, &table),
                     SONJECT_ERROR_STORAGE);
    assert_non_null(strstr(report.message, "absent.csv: cannot open"));
    assert_int_equal(profile_table_read(&report, folder->path, NULL, &table),
                     SONJECT_ERROR_STORAGE);
    assert_non_null(strstr(report.message, "cannot read"));
    assert_null(table.positions_m);
}

/* ---- Layers of good tables. */

#define STEP (1.0 / 20000.0) /* largest relative step of the sound speed between layers */

struct profile {
    double heights[5], speeds[5];
    size_t count;
};

/* Returns the sound speed at a height, by straight lines between samples. */
static double speed_at(const struct profile *profile, double height)
{
    size_t i = 0;
    if (height <= profile->heights[0])
        return profile->speeds[0];
    if (height >= profile->heights[profile->count - 1])
        return profile->speeds[profile->count - 1];
    while (profile->heights[i + 1] < height)
        i++;
    const double share =
        (height - profile->heights[i]) / (profile->heights[i + 1] - profile->heights[i]);
    return (1.0 - share) * profile->speeds[i] + share * profile->speeds[i + 1];
}

/* Expects layers of the straight pieces over the seabed: as few as the step allows, and one for a
 * constant speed. The next layer joins it if its speed is the same. */
static void expect_layers(const struct profile *profile, size_t expected)
{
    struct water_layer *layers;
    size_t count;
    EXPECT_OK(&report, layers_of_profile(profile->heights, profile->speeds, profile->count, &report,
                                         &layers, &count));
    assert_int_equal(count, expected);
    assert_true(layers[0].bottom_m == 0.0);
    for (size_t i = 0; i < count; i++) {
        const bool is_last = i + 1 == count;
        const double bottom = layers[i].bottom_m;
        const double middle = is_last ? bottom + 1.0 : 0.5 * (bottom + layers[i + 1].bottom_m);
        /* 1e-12: roundings of the middle and of the interpolation */
        assert_true(fabs(layers[i].speed_mps / speed_at(profile, middle) - 1.0) < 1e-12);
        assert_true(layers[i].density == layers[0].density);
        if (is_last)
            continue;
        const double next = layers[i + 1].speed_mps;
        assert_true(layers[i + 1].bottom_m > bottom && next != layers[i].speed_mps);
        assert_true(fabs(next - layers[i].speed_mps) <=
                    STEP * (1.0 + 1e-9) * fmin(next, layers[i].speed_mps));
    }
    free(layers);
}

TEST(test_profiles_become_thin_layers)
{
    /* 1490 to 1520 m/s: 30 / (1490 / 20000) = 402.7 layers, and one below and above */
    const struct profile thermocline = {{0, 12, 16, 25}, {1490, 1490, 1520, 1520}, 4};
    const struct profile falling = {{3, 20}, {1500.0, 1499.0}, 2};      /* 13.3 layers, and two */
    const struct profile buried = {{-4, 4, 6}, {1500, 1504, 1504}, 3};  /* 1502...1504: 26.6 */
    const struct profile below = {{-9, -5, 10}, {1400, 1500, 1501}, 3}; /* 2/3 m/s: 8.9 */
    const struct profile little = {{1, 2, 3}, {1500, 1500.06, 1500.01}, 3}; /* less than a step */
    const struct profile constant = {{1, 2, 3}, {1480, 1480, 1480}, 3};
    const struct profile corner = {{0, 10, 20}, {1500, 1503.1, 1499}, 3}; /* 41.3 and 54.7 */
    expect_layers(&thermocline, 405);
    expect_layers(&falling, 16);
    expect_layers(&buried, 28);
    expect_layers(&below, 10);
    expect_layers(&little, 4);
    expect_layers(&constant, 1);
    expect_layers(&corner, 98);
}

/* Samples are as close and as far up as heights may be, and as steep as fits. */
TEST(test_steep_profiles_keep_rising)
{
    const double heights[] = {999999.0, 999999.0000011}, speeds[] = {1400.0, 1660.0};
    struct water_layer *layers;
    size_t count;
    EXPECT_OK(&report, layers_of_profile(heights, speeds, 2, &report, &layers, &count));
    for (size_t i = 1; i < count; i++)
        assert_true(layers[i].bottom_m > layers[i - 1].bottom_m);
    free(layers);
}

TEST_PROGRAM(NULL, NULL)
