/* Tests heights of the seabed from a file, and messages about files that are no heights. */
#include "claims.h"
#include "scene_folder.h"
#include "swath/raster_file.h"

#define RELIEF BASE "seabed:\n  relief:\n" /* five lines */
#define HEIGHTS(keys)                                                                              \
    RELIEF "  - heights: {file: heights.tif, row_spacing: 50 cm, column_spacing: 25 cm, "          \
           "first_ground_range: 30 m, " keys "}\n"

#define ROWS    3
#define COLUMNS 4

static void write_heights(const struct raster_layout *layout, const void *pixels)
{
    assert_int_equal(
        raster_file_write(&folder->report, file_in("heights.tif"), layout, NULL, NULL, 0, pixels),
        SONJECT_OK);
}

static void expect_heights(double first_along_track_m, const float heights_m[ROWS * COLUMNS])
{
    const struct relief_features *relief = &folder->scene.relief;
    sonject_relief_params grid;
    memset(&grid, 0, sizeof grid);
    grid.rows = ROWS;
    grid.columns = COLUMNS;
    grid.row_spacing_m = 0.5;
    grid.column_spacing_m = 0.25;
    grid.first_ground_range_m = 30.0;
    grid.first_along_track_m = first_along_track_m;
    assert_int_equal(relief->count, 0);
    assert_memory_equal(&relief->grid, &grid, sizeof grid);
    assert_memory_equal(relief->heights_m, heights_m, ROWS * COLUMNS * sizeof *heights_m);
}

/* All numbers are binary fractions, so that no height is rounded. */
TEST(test_numbers_become_heights)
{
    static const double numbers[ROWS * COLUMNS] = {0, 1, 2, 3, 4, 50, 60, 70, 255, 100, 9, 11};
    static const enum pixel_type types[] = {PIXEL_UINT8, PIXEL_UINT16, PIXEL_FLOAT32};
    static const struct {
        const char *text;
        double scale, offset, first_along_track_m;
    } cases[] = {
        {HEIGHTS("unit: 0.125"), 0.125, 0.0, 0.0},
        {HEIGHTS("unit: 0.03125 m, positive: up, offset: -2 m"), 0.03125, -2.0, 0.0},
        {HEIGHTS("unit: 125 mm, positive: down, offset: 10 m, first_along_track: -7 m"), -0.125,
         10.0, -7.0},
    };
    for (size_t type = 0; type < COUNT(types); type++) {
        const struct raster_layout layout = {ROWS, COLUMNS, 1, types[type]};
        float pixels[ROWS * COLUMNS]; /* room for pixels of any type */
        for (size_t i = 0; i < COUNT(numbers); i++)
            assert_true(pixel_store(types[type], pixels, i, numbers[i]));
        write_heights(&layout, pixels);
        for (size_t i = 0; i < COUNT(cases); i++) {
            float heights[ROWS * COLUMNS];
            for (size_t j = 0; j < COUNT(numbers); j++)
                heights[j] = (float)(cases[i].offset + cases[i].scale * numbers[j]);
            expect_scene_taken(cases[i].text);
            expect_heights(cases[i].first_along_track_m, heights);
        }
    }
}

/* Heights add to the other features. */
TEST(test_heights_among_features)
{
    static const float flat[ROWS * COLUMNS] = {0.0f};
    static const struct raster_layout layout = {ROWS, COLUMNS, 1, PIXEL_FLOAT32};
    write_heights(&layout, flat);
    expect_scene_taken(RELIEF
                       "  - mound: {radius: 1 m, height: 10 cm}\n"
                       "  - heights: {file: heights.tif, unit: m, row_spacing: 1, column_spacing: "
                       "1, first_ground_range: 0}\n"
                       "  - pit: {radius: 1 m, depth: 10 cm}\n");
    assert_int_equal(folder->scene.relief.count, 2);
    assert_int_equal(folder->scene.relief.features[1].kind, RELIEF_PIT);
    assert_non_null(folder->scene.relief.heights_m);
}

TEST(test_what_is_refused)
{
    static const struct refusal wrong[] = {
        {RELIEF "  - heights: heights.tif\n",
         ":6:14: seabed.relief[0].heights: must be a section of 'key: value' lines, not a single "
         "value"},
        {RELIEF "  - heights: {file: heights.tif, first_ground_range: 0}\n",
         ":6:14: seabed.relief[0].heights.unit: missing; add it (unit of the file's "
         "numbers)\n"
         ":6:14: seabed.relief[0].heights.row_spacing: missing; add it (distance between rows)\n"
         ":6:14: seabed.relief[0].heights.column_spacing: missing; add it (distance between "
         "columns, horizontal)"},
        {HEIGHTS("unit: -1 m"),
         ":6:109: seabed.relief[0].heights.unit: must be a length of 1e-9 to "
         "1e9 m, not -1 m"},
        {HEIGHTS("unit: m") "  - heights: {file: heights.tif, unit: m, row_spacing: 1, "
                            "column_spacing: 1, first_ground_range: 0}\n",
         ":7:14: seabed.relief[1].heights: only one file of heights is possible; join them"},
        {HEIGHTS("unit: m") "    mound: {radius: 1 m, height: 1 m}\n",
         ":6:5: seabed.relief[0]: more than one of ripples, mound, pit, scour and heights is "
         "there; give one"},
    };
    static const uint8_t pixels[ROWS * COLUMNS] = {0};
    static const struct raster_layout layout = {ROWS, COLUMNS, 1, PIXEL_UINT8};
    write_heights(&layout, pixels);
    expect_all_refused(wrong, COUNT(wrong));
    assert_null(folder->scene.relief.heights_m);
}

static void expect_bad_heights(const char *keys, const char *what)
{
    char text[1000];
    snprintf(text, sizeof text, HEIGHTS("%s"), keys);
    expect_bad_file(text, ":6:21: seabed.relief[0].heights.file", "heights.tif",
                    SONJECT_ERROR_INPUT, what);
    assert_null(folder->scene.relief.heights_m);
}

TEST(test_files_that_are_no_heights)
{
    static const float hole[ROWS * COLUMNS] = {[6] = NAN};
    static const float deep[ROWS * COLUMNS] = {[11] = -9999.0f};
    static const float huge[ROWS * COLUMNS] = {[1] = 3e38f};
    static const struct raster_layout plain = {ROWS, COLUMNS, 1, PIXEL_FLOAT32};
    static const struct raster_layout pairs = {ROWS, 2, 2, PIXEL_FLOAT32};
    static const struct raster_layout line = {1, COLUMNS, 1, PIXEL_FLOAT32};
    static const struct raster_layout wide = {2, 16385, 1, PIXEL_UINT8};
    static const struct raster_layout large = {4096, 4097, 1, PIXEL_UINT8};
    uint8_t *many = zeroed(4096, 4097);
    const struct {
        const struct raster_layout *layout;
        const void *pixels;
        const char *keys, *what;
    } files[] = {
        {&plain, hole, "unit: m", "at row 1, column 2 it is nan m"},
        {&plain, deep, "unit: m", "at row 2, column 3 it is -9999 m"},
        {&plain, huge, "unit: 1e9 m", "at row 0, column 1 it is inf m"},
        {&plain, huge, "unit: 1e9 m, positive: down", "at row 0, column 1 it is -inf m"},
        {&pairs, hole, "unit: m", "has 2 channels; heights need one"},
        {&line, hole, "unit: m", "has 1 rows and 4 columns"},
        {&wide, many, "unit: m", "has 2 rows and 16385 columns"},
        {&large, many, "unit: m", "has 4096 rows and 4097 columns"},
    };
    for (size_t i = 0; i < COUNT(files); i++) {
        write_heights(files[i].layout, files[i].pixels);
        expect_bad_heights(files[i].keys, files[i].what);
    }
    free(many);
    write_heights(&plain, hole);
    assert_int_equal(truncate(file_in("heights.tif"), 90), 0);
    expect_bad_heights("unit: m", "");
    assert_int_equal(truncate(file_in("heights.tif"), 0), 0);
    expect_bad_heights("unit: m", "");
    assert_int_equal(unlink(file_in("heights.tif")), 0);
    expect_bad_heights("unit: m", "there is no file");
}

TEST_PROGRAM(make_scene_folder, remove_scene_folder)
