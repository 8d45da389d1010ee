/* Sizes of rasters and regions. */
#include "claims.h"
#include "image/raster.h"

static const struct raster_layout swath = {1000, 400, 2, PIXEL_FLOAT32};

static void test_pixel_types(void **state)
{
    assert_int_equal(pixel_bytes(PIXEL_UINT8), 1);
    assert_int_equal(pixel_bytes(PIXEL_UINT16), 2);
    assert_int_equal(pixel_bytes(PIXEL_FLOAT32), 4);
    assert_true(pixel_full_scale(PIXEL_UINT8) == 255.0);
    assert_true(pixel_full_scale(PIXEL_UINT16) == 65535.0);
    assert_true(pixel_full_scale(PIXEL_FLOAT32) == 1.0);
}

static void test_bytes(void **state)
{
    const struct region region = {5, 6, 10, 20};
    size_t bytes = 0;
    assert_true(region_bytes(&swath, &region, &bytes));
    assert_int_equal(bytes, 10 * 20 * 2 * 4);
}

static void test_bytes_that_overflow(void **state)
{
    const struct region regions[] = {{0, 0, UINT64_MAX, 1},
                                     {0, 0, 1, UINT64_MAX},
                                     {0, 0, (uint64_t)1 << 32, (uint64_t)1 << 32},
                                     {0, 0, (uint64_t)1 << 31, (uint64_t)1 << 30}};
    size_t bytes = 7;
    for (size_t i = 0; i < COUNT(regions); i++)
        assert_false(region_bytes(&swath, &regions[i], &bytes));
    assert_int_equal(bytes, 7);
}

static void test_inside(void **state)
{
    const struct region inside[] = {
        {0, 0, 1000, 400}, {999, 399, 1, 1}, {990, 0, 10, 400}, {0, 390, 1, 10}};
    const struct region outside[] = {
        {0, 0, 0, 1},          {0, 0, 1, 0},          {0, 0, 1001, 1},      {0, 0, 1, 401},
        {1, 0, 1000, 1},       {0, 1, 1, 400},        {1000, 0, 1, 1},      {UINT64_MAX, 0, 2, 1},
        {0, UINT64_MAX, 1, 2}, {1, 0, UINT64_MAX, 1}, {0, 1, 1, UINT64_MAX}};
    for (size_t i = 0; i < COUNT(inside); i++)
        assert_true(region_is_inside(&swath, &inside[i]));
    for (size_t i = 0; i < COUNT(outside); i++)
        assert_false(region_is_inside(&swath, &outside[i]));
}

TEST_PROGRAM(NULL, NULL, TEST(test_pixel_types), TEST(test_bytes), TEST(test_bytes_that_overflow),
             TEST(test_inside))
