/* Tests regions of multi-bounce echoes: every echo is in one region, and little else is. */
#include "claims.h"
#include "trace/multibounce.h"

#define STRIPS 9000
#define BINS   30000
#define PLACES 5
#define ABOUT  4000 /* number of echoes about places */
#define COLUMN 30   /* number of echoes in a column, 16 strips apart */
#define ECHOES (ABOUT + COLUMN + 2)

static struct report report;

/* Returns an echo: about a few places, far from all, or in a column. Two others, on both sides of
 * the column's foot, are joined, and their region must join the column's, too. */
static struct multibounce_echo_record echo_of(uint32_t number)
{
    static const int32_t places[PLACES][2] = {
        {300, 900}, {500, 29000}, {4000, 15000}, {4100, 15700}, {8500, 200}};
    const uint32_t random = (number + 1) * 2654435761u;
    const int32_t *place = places[number % PLACES];
    struct multibounce_echo_record echo = {
        .strip = place[0] + (int32_t)(random >> 24), /* up to 255 beyond */
        .bin = place[1] + (int32_t)(random >> 8 & 0xff),
        .real_part = 1.0f,
        .imaginary_part = -2.0f,
        .dither = 0.5f,
    };
    if (number >= ABOUT) {
        const int32_t i = (int32_t)number - ABOUT;
        echo.strip = 7000 + 16 * (i < COLUMN ? i : i - 1);
        echo.bin = i < COLUMN ? 5500 : i == COLUMN ? 7000 : 4000;
    } else if (number % 1000 == 0)
        echo.strip = (int32_t)(random % STRIPS);
    return echo;
}

/* Lays echoes of two pairs of sources, whose grids begin in different bins. Only the second has the
 * column. */
static void lay_echoes(struct multibounce *multibounce)
{
    memset(multibounce, 0, sizeof *multibounce);
    multibounce->count = 2;
    multibounce->sums = zeroed(multibounce->count, sizeof *multibounce->sums);
    for (int32_t k = 0; k < 2; k++) {
        const struct line_grid grid = {.strips = {-100, STRIPS + 200},
                                       .bins = {-50 * k, BINS + 100}};
        assert_true(multibounce_sums_init(&multibounce->sums[k], &grid));
        multibounce->sums[k].amplitude_of_quantum = 0.5;
        for (uint32_t i = 0; i < (k == 0 ? ABOUT : ECHOES); i++) {
            struct multibounce_echo_record echo = echo_of(i);
            echo.bin += 50 * k; /* the device's bins count from the grid's first */
            assert_true(multibounce_sums_add(&multibounce->sums[k], &echo, 1));
        }
    }
}

static bool is_within(struct span span, int32_t place)
{
    return place >= span.first && place < span.first + span.count;
}

static bool are_apart(struct span one, struct span other)
{
    return span_overlap(one, other).count == 0;
}

TEST(test_regions_hold_all_echoes_once)
{
    struct multibounce multibounce;
    lay_echoes(&multibounce);
    EXPECT_OK(&report, multibounce_find_regions(&multibounce, &report));
    double cells = 0.0;
    for (size_t i = 0; i < multibounce.region_count; i++) {
        const struct multibounce_region *one = &multibounce.regions[i];
        cells += (double)one->strips.count * one->bins.count;
        for (size_t k = 0; k < i; k++)
            assert_true(are_apart(one->strips, multibounce.regions[k].strips) ||
                        are_apart(one->bins, multibounce.regions[k].bins));
    }
    for (uint32_t i = 0; i < ECHOES; i++) {
        const struct multibounce_echo_record echo = echo_of(i);
        size_t found = 0;
        for (size_t k = 0; k < multibounce.region_count; k++)
            found += is_within(multibounce.regions[k].strips, echo.strip) &&
                     is_within(multibounce.regions[k].bins, echo.bin);
        assert_int_equal(found, 1);
    }
    /* two of the places lie so near to each other that they share one */
    assert_true(multibounce.region_count >= 4);
    assert_true(cells < 0.02 * STRIPS * BINS);
    multibounce_end(&multibounce);
}

/* Regions are read whole, however few strips are read at a time, and by their filled bins alone. */
TEST(test_regions_are_read_whole)
{
    struct multibounce multibounce;
    lay_echoes(&multibounce);
    EXPECT_OK(&report, multibounce_find_regions(&multibounce, &report));
    double real_sum = 0.0, imaginary_sum = 0.0, all = 0.0, read = 0.0;
    for (size_t i = 0; i < multibounce.region_count; i++) {
        const struct multibounce_region *region = &multibounce.regions[i];
        const size_t most = 37 * (size_t)region->bins.count;
        float *parts = zeroed(2 * most, sizeof *parts);
        for (int32_t done = 0; done < region->strips.count; done += 37) {
            const int32_t left = region->strips.count - done;
            const struct span strips = {region->strips.first + done, left < 37 ? left : 37};
            const struct span bins = multibounce_bins_filled(&multibounce, region, strips);
            multibounce_read(&multibounce, strips, bins, parts, parts + most);
            all += (double)strips.count * region->bins.count;
            read += (double)strips.count * bins.count;
            for (size_t k = 0; k < (size_t)strips.count * (size_t)bins.count; k++) {
                real_sum += (double)parts[k];
                imaginary_sum += (double)parts[most + k];
            }
        }
        free(parts);
    }
    assert_true(real_sum == 0.5 * (ABOUT + ECHOES));
    assert_true(imaginary_sum == -2.0 * 0.5 * (ABOUT + ECHOES));
    print_message("%.0f of %.0f cells are read\n", read, all);
    assert_true(read < all);
    multibounce_end(&multibounce);
}

TEST_PROGRAM(NULL, NULL)
