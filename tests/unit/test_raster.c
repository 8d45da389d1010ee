/* Tests sizes of rasters and regions, and the transfer of stored numbers to amplitudes and back. */
#include "claims.h"

#include <float.h>

#include "image/raster.h"

static sonject_transfer_params make(sonject_transfer kind, double parameter, double offset)
{
    sonject_transfer_params transfer = {(uint32_t)kind, parameter, offset, 0.0};
    return transfer;
}

/* Returns the largest number that the type stores. */
static size_t last_of(enum pixel_type type)
{
    return type == PIXEL_UINT8 ? 255 : 65535;
}

/* Takes all values of the type there and back, in one call, which uses a table, or one by one. */
static void expect_round_trip(const sonject_transfer_params *transfer, enum pixel_type type,
                              bool is_one_call)
{
    const size_t count = last_of(type) + 1;
    const size_t at_once = is_one_call ? count : 1;
    const size_t size = pixel_bytes(type);
    unsigned char *stored = zeroed(count, size);
    unsigned char *back = zeroed(count, size);
    float *amplitude = zeroed(count, sizeof *amplitude);
    uint64_t clipped = 0;
    size_t bad = 0;
    for (size_t i = 0; i < count; i++)
        assert_true(pixel_store(type, stored, i, (double)i));
    for (size_t i = 0; i < count; i += at_once) {
        assert_int_equal(transfer_to_amplitude(transfer, type, stored + i * size, at_once,
                                               amplitude + i, &bad, &clipped),
                         SONJECT_OK);
        transfer_to_stored(transfer, type, type != PIXEL_FLOAT32, amplitude + i, at_once,
                           back + i * size, &clipped);
    }
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && !(amplitude[i] > amplitude[i - 1]))
            fail_msg("kind %u: the test is wrong: not strictly monotonic at %zu", transfer->kind,
                     i);
        for (size_t j = 0; j < size; j++)
            if (stored[i * size + j] != back[i * size + j])
                fail_msg("kind %u, parameter %g: %zu does not come back", transfer->kind,
                         transfer->parameter, i);
    }
    assert_int_equal(clipped,
                     1); /* the last value is full scale; none is limited on the way back */
    free(stored);
    free(back);
    free(amplitude);
}

TEST(test_every_value_comes_back)
{
    const sonject_transfer_params kinds[] = {
        make(SONJECT_TRANSFER_AMPLITUDE, 0.0, 0.0),   make(SONJECT_TRANSFER_INTENSITY, 0.0, 0.0),
        make(SONJECT_TRANSFER_DECIBEL, 0.378, -90.0), make(SONJECT_TRANSFER_DECIBEL, 0.001, -60.0),
        make(SONJECT_TRANSFER_GAMMA, 0.5, 0.0),       make(SONJECT_TRANSFER_GAMMA, 2.2, 0.0),
        make(SONJECT_TRANSFER_GAMMA, 1.0, 0.0),       make(SONJECT_TRANSFER_SCHLICK, 1.0, 0.0),
        make(SONJECT_TRANSFER_SCHLICK, 3.0, 0.0),     make(SONJECT_TRANSFER_SCHLICK, 1000.0, 0.0)};
    for (size_t i = 0; i < COUNT(kinds); i++) {
        /* 0.378 dB a step over 65535 steps is more than a float holds */
        const bool fits_16_bit = kinds[i].parameter != 0.378;
        expect_round_trip(&kinds[i], PIXEL_UINT8, true);
        expect_round_trip(&kinds[i], PIXEL_UINT8, false);
        if (fits_16_bit) {
            expect_round_trip(&kinds[i], PIXEL_UINT16, true);
            expect_round_trip(&kinds[i], PIXEL_UINT16, false);
        }
    }
}

TEST(test_plain_floats_keep_every_bit)
{
    const sonject_transfer_params plain = make(SONJECT_TRANSFER_AMPLITUDE, 0.0, 0.0);
    const float stored[] = {0.0f,     -0.0f,   1.0f,        -1.0f,  1.0f / 3.0f, FLT_MAX,
                            -FLT_MAX, FLT_MIN, FLT_MIN / 3, 1e-45f, 123456.789f};
    const size_t count = COUNT(stored);
    float amplitude[COUNT(stored)];
    float back[COUNT(stored)];
    size_t bad;
    uint64_t clipped = 0;
    assert_int_equal(
        transfer_to_amplitude(&plain, PIXEL_FLOAT32, stored, count, amplitude, &bad, &clipped),
        SONJECT_OK);
    assert_memory_equal(amplitude, stored, sizeof stored);
    transfer_to_stored(&plain, PIXEL_FLOAT32, 0, amplitude, count, back, &clipped);
    assert_memory_equal(back, stored, sizeof stored);
    assert_int_equal(clipped, 0);
}

static void expect_refused(sonject_transfer kind, float value)
{
    const sonject_transfer_params transfer = make(kind, 2.0, 0.0);
    const float stored[] = {0.5f, 0.25f, 0.0f, value, 0.125f};
    float amplitude[5];
    size_t bad = 99;
    uint64_t clipped = 0;
    if (transfer_to_amplitude(&transfer, PIXEL_FLOAT32, stored, 5, amplitude, &bad, &clipped) !=
        SONJECT_ERROR_INPUT)
        fail_msg("kind %d took %g", (int)kind, (double)value);
    assert_int_equal(bad, 3);
}

TEST(test_values_without_an_amplitude)
{
    for (int kind = SONJECT_TRANSFER_AMPLITUDE; kind <= SONJECT_TRANSFER_SCHLICK; kind++) {
        expect_refused((sonject_transfer)kind, NAN);
        expect_refused((sonject_transfer)kind, INFINITY);
    }
    expect_refused(SONJECT_TRANSFER_AMPLITUDE, -INFINITY);
    expect_refused(SONJECT_TRANSFER_INTENSITY, -1e-9f);
    expect_refused(SONJECT_TRANSFER_DECIBEL, 1e6f);
    expect_refused(SONJECT_TRANSFER_GAMMA, 1e30f);
    expect_refused(SONJECT_TRANSFER_SCHLICK, 2.0f); /* the pole of q / (2 - q) */
    expect_refused(SONJECT_TRANSFER_SCHLICK, -0.1f);
    expect_refused(SONJECT_TRANSFER_SCHLICK, 3.0f);
}

TEST(test_full_scale_is_counted)
{
    const sonject_transfer_params plain = make(SONJECT_TRANSFER_AMPLITUDE, 0.0, 0.0);
    const uint8_t stored[] = {255, 254, 0, 255};
    const uint16_t wide[] = {65535, 65534, 255};
    float amplitude[4];
    size_t bad;
    uint64_t clipped = 10;
    (void)transfer_to_amplitude(&plain, PIXEL_UINT8, stored, 4, amplitude, &bad, &clipped);
    assert_int_equal(clipped, 12);
    (void)transfer_to_amplitude(&plain, PIXEL_UINT16, wide, 3, amplitude, &bad, &clipped);
    assert_int_equal(clipped, 13);
}

/* The recorder stores twelve bits in sixteen. */
TEST(test_the_recorders_full_scale)
{
    sonject_transfer_params plain = make(SONJECT_TRANSFER_AMPLITUDE, 0.0, 0.0);
    plain.full_scale = 4095.0;
    const uint16_t stored[] = {4095, 4094, 8190};
    uint16_t back[3];
    float amplitude[3];
    size_t bad;
    uint64_t clipped = 0;
    assert_int_equal(
        transfer_to_amplitude(&plain, PIXEL_UINT16, stored, 3, amplitude, &bad, &clipped),
        SONJECT_OK);
    assert_true(amplitude[0] == 1.0f && amplitude[2] == 2.0f);
    assert_int_equal(clipped, 2);
    transfer_to_stored(&plain, PIXEL_UINT16, 1, amplitude, 3, back, &clipped);
    assert_int_equal(back[1], 4094);
    assert_int_equal(back[2], 4095);
    assert_int_equal(clipped, 3);
    uint8_t narrow;
    transfer_to_stored(&plain, PIXEL_UINT8, 1, amplitude, 1, &narrow, &clipped);
    assert_int_equal(narrow, 255);
}

TEST(test_rounding_and_limits)
{
    const sonject_transfer_params plain = make(SONJECT_TRANSFER_AMPLITUDE, 0.0, 0.0);
    const sonject_transfer_params decibel = make(SONJECT_TRANSFER_DECIBEL, 0.5, -100.0);
    const float amplitude[] = {0.0f, 0.0019f, 0.0020f, 1.0f, 1.0019f, 1.0020f, 1e30f};
    const uint8_t expected[] = {0, 0, 1, 255, 255, 255, 255};
    uint8_t stored[7];
    uint64_t clipped = 5;
    transfer_to_stored(&plain, PIXEL_UINT8, 1, amplitude, 7, stored, &clipped);
    assert_memory_equal(stored, expected, sizeof expected);
    assert_int_equal(clipped, 7); /* 1.0019 rounds to full scale; two lie above */
    transfer_to_stored(&decibel, PIXEL_UINT8, 1, amplitude, 1, stored, &clipped);
    assert_int_equal(stored[0], 0);
    assert_int_equal(clipped, 7);
    float level = 0.0f;
    const sonject_transfer_params level_itself = make(SONJECT_TRANSFER_DECIBEL, 1.0, 0.0);
    transfer_to_stored(&level_itself, PIXEL_FLOAT32, 0, amplitude, 1, &level, &clipped);
    assert_true(isfinite(level) && level < -700.0f);
    assert_int_equal(clipped, 7);
    float large = 0.0f;
    const sonject_transfer_params gamma = make(SONJECT_TRANSFER_GAMMA, 0.01, 0.0);
    transfer_to_stored(&gamma, PIXEL_FLOAT32, 0, amplitude + 6, 1, &large, &clipped);
    assert_true(large == FLT_MAX);
    assert_int_equal(clipped, 8);
}

static const struct raster_layout swath = {1000, 400, 2, PIXEL_FLOAT32};

TEST(test_bytes_that_overflow)
{
    const struct region regions[] = {{0, 0, UINT64_MAX, 1},
                                     {0, 0, 1, UINT64_MAX},
                                     {0, 0, (uint64_t)1 << 32, (uint64_t)1 << 32},
                                     {0, 0, (uint64_t)1 << 31, (uint64_t)1 << 30}};
    size_t bytes = 7;
    for (size_t i = 0; i < COUNT(regions); i++)
        assert_false(region_bytes(&swath, &regions[i], &bytes));
    assert_int_equal(bytes, 7);
    assert_true(region_bytes(&swath, &(struct region){5, 6, 10, 20}, &bytes));
    assert_int_equal(bytes, 10 * 20 * 2 * 4);
}

TEST(test_inside)
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

TEST_PROGRAM(NULL, NULL)
