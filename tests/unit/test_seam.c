/* The seam: chance where there is none, told where there is one. */
#include "plain_seabed.h"

#include "measure/measures.h"

#define ROWS    400
#define COLUMNS 400
#define PIXELS  ((size_t)ROWS * COLUMNS)

static struct report report;

/* Rows are correlated. */
static float *seabed(double row_width, uint64_t seed)
{
    return make_plain_seabed(ROWS, COLUMNS, INFINITY, row_width, 1.0, seed);
}

/* A target of 60 x 30 pixels, and a band of 36 around it. */
static void draw_masks(uint8_t *influence, uint8_t *labels)
{
    for (size_t i = 0; i < PIXELS; i++) {
        const size_t row = i / COLUMNS;
        const size_t column = i % COLUMNS;
        labels[i] = row >= 170 && row < 230 && column >= 185 && column < 215;
        influence[i] = row >= 134 && row < 266 && column >= 149 && column < 251;
    }
}

enum flaw {
    NO_FLAW,
    FLAW_CONTRAST,    /* 30 % more */
    FLAW_CORRELATION, /* 30 % less */
    FLAW_LEVEL        /* 1 dB more */
};

static struct seam seam_with(enum flaw flaw, uint64_t seed)
{
    struct seam seam;
    float *pixels = seabed(1.6, seed);
    float *other = seabed(1.35, seed + 100); /* sinc^2(1 / 1.35) is 0.7 sinc^2(1 / 1.6) */
    uint8_t *influence = calloc(PIXELS, 1);
    uint8_t *labels = calloc(PIXELS, 1);
    double mean = 0.0;
    assert_true(influence && labels);
    draw_masks(influence, labels);
    for (size_t i = 0; i < PIXELS; i++)
        mean += (double)pixels[i] / (double)PIXELS;
    for (size_t i = 0; i < PIXELS; i++) {
        if (labels[i])
            pixels[i] = 0.0f; /* what is not to be looked at */
        else if (influence[i] && flaw == FLAW_CONTRAST)
            pixels[i] = fmaxf(0.0f, (float)mean + 1.3f * (pixels[i] - (float)mean));
        else if (influence[i] && flaw == FLAW_CORRELATION)
            pixels[i] = other[i];
        else if (influence[i] && flaw == FLAW_LEVEL)
            pixels[i] *= 1.122f;
    }
    EXPECT_OK(&report, measure_seam(&report, pixels, influence, labels, ROWS, COLUMNS, &seam));
    print_message("flaw %d: %.3f +- %.3f of %zu and %zu\n", (int)flaw, seam.auc, seam.error,
                  seam.patches, seam.background);
    free(pixels);
    free(other);
    free(influence);
    free(labels);
    return seam;
}

#define SEEDS 8

/* Untouched seabed: chance, each time within 4 of the errors it tells, the mean of 8 within 4 of
 * its own; and the told errors are those of the scatter within a factor of 2, of which 8 values
 * leave a thousandth outside. */
TEST(test_no_seam)
{
    double sum = 0.0;
    double squares = 0.0;
    double errors = 0.0;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        const struct seam seam = seam_with(NO_FLAW, seed);
        assert_true(seam.patches >= 40 && seam.background >= seam.patches);
        assert_true(fabs(seam.auc - 0.5) < 4.0 * seam.error);
        sum += seam.auc - 0.5;
        squares += (seam.auc - 0.5) * (seam.auc - 0.5);
        errors += seam.error * seam.error;
    }
    assert_true(fabs(sum) / SEEDS < 4.0 * sqrt(errors) / SEEDS);
    assert_true(squares < 4.0 * errors && errors < 4.0 * squares);
}

TEST(test_seams_are_seen)
{
    for (uint64_t seed = 1; seed <= 3; seed++) {
        assert_true(seam_with(FLAW_CONTRAST, seed).auc > 0.7);
        assert_true(seam_with(FLAW_CORRELATION, seed).auc > 0.7);
        assert_true(seam_with(FLAW_LEVEL, seed).auc > 0.6);
    }
}

/* Nothing to compare: told as such. */
TEST(test_too_little)
{
    struct seam seam;
    float *pixels = seabed(1.6, 1);
    uint8_t *influence = calloc(PIXELS, 1);
    assert_non_null(influence);
    EXPECT_OK(&report, measure_seam(&report, pixels, influence, NULL, ROWS, COLUMNS, &seam));
    assert_true(isnan(seam.auc) && isnan(seam.error) && seam.patches == 0);
    memset(influence, 1, PIXELS);
    EXPECT_OK(&report, measure_seam(&report, pixels, influence, NULL, ROWS, COLUMNS, &seam));
    assert_true(isnan(seam.auc) && seam.patches == 0);
    EXPECT_OK(&report, measure_seam(&report, pixels, influence, NULL, 5, 7, &seam));
    assert_true(isnan(seam.auc));
    free(pixels);
    free(influence);
}

TEST_PROGRAM(NULL, NULL)
