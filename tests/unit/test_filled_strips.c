/* Tests what image formation leaves out: nothing but zeros, and most of the zeros. */
#include "claims.h"
#include "form/form.h"

#define BINS     301 /* several whole searches and a rest */
#define STRIPS   400
#define LONG_GAP 8 /* number of empty strips that part two runs */

/* Tries first and last bins of one part, with the other part absent, empty, or one bin. */
TEST(test_bins_of_a_line)
{
    static float line[BINS], other[BINS];
    for (int32_t first = 0; first < BINS; first += 7)
        for (int32_t last = first; last < BINS; last += 11) {
            line[first] = 1.0f;
            line[last] = -1.0f;
            struct filled_span filled = filled_span_of(line, NULL, BINS);
            assert_int_equal(filled.first, first);
            assert_int_equal(filled.end, last + 1);
            filled = filled_span_of(other, line, BINS);
            assert_int_equal(filled.first, first);
            assert_int_equal(filled.end, last + 1);
            other[100] = 1.0f;
            filled = filled_span_of(line, other, BINS);
            assert_int_equal(filled.first, first < 100 ? first : 100);
            assert_int_equal(filled.end, last > 100 ? last + 1 : 101);
            line[first] = line[last] = other[100] = 0.0f;
        }
    assert_true(filled_span_is_empty(filled_span_of(line, NULL, BINS)));
    assert_true(filled_span_is_empty(filled_span_of(line, other, BINS)));
}

/* Every filled strip is in one run, runs begin and end with filled strips, and only long gaps part
 * them. */
TEST(test_runs_of_strips)
{
    static struct filled_span filled[STRIPS];
    uint32_t number = 1;
    int32_t found = 0, wanted = 0;
    for (int32_t i = 0; i < STRIPS; i++) {
        number = number * 1664525u + 1013904223u;
        filled[i].end = (number >> 24) < 40u ? 5 : 0;
        wanted += filled[i].end > 0;
    }
    struct span run = {0, 0};
    int32_t runs = 0, gap = 0;
    for (int32_t end = 0; (run = next_filled_strips(filled, STRIPS, run)).count > 0; runs++) {
        assert_true(end == 0 || run.first - end >= LONG_GAP);
        end = run.first + run.count;
        assert_true(end <= STRIPS && filled[run.first].end > 0 && filled[end - 1].end > 0);
        for (int32_t i = run.first; i < end; i++) {
            gap = filled[i].end > 0 ? 0 : gap + 1;
            assert_true(gap < LONG_GAP);
            found += filled[i].end > 0;
        }
    }
    assert_int_equal(found, wanted);
    assert_true(runs > 10);
    assert_int_equal(next_filled_strips(filled, 0, (struct span){0, 0}).count, 0);
}

TEST_PROGRAM(NULL, NULL)
