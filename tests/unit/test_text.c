/* Tests numbers from text: correctly rounded, and the same under a locale with a decimal comma. */
#include "claims.h"

#include <locale.h>

#include "base/report.h"
#include "base/text.h"

static void expect_number(const char *text, double expected, const char *expected_rest)
{
    double number = -1.0;
    const char *rest = NULL;
    if (!text_to_number(text, &number, &rest))
        fail_msg("'%s' was not taken for a number", text);
    if (memcmp(&number, &expected, sizeof number) != 0)
        fail_msg("'%s' gave %a, not %a", text, number, expected);
    assert_string_equal(rest, expected_rest);
}

/* Expected values are written as hexadecimal bits, so that no decimal conversion checks itself. */
TEST(test_numbers)
{
    static const struct {
        const char *text;
        double number;
        const char *rest;
    } cases[] = {{"0", 0.0, ""},
                 {"-0.0", -0.0, ""},
                 {"2.5", 0x1.4p1, ""},
                 {"+12 m", 0x1.8p3, " m"},
                 {".5", 0x1p-1, ""},
                 {"5.", 0x1.4p2, ""},
                 {"-27 dB", -0x1.bp4, " dB"},
                 {"1e3", 0x1.f4p9, ""},
                 {"1E-2", 0x1.47ae147ae147bp-7, ""},
                 {"0.1", 0x1.999999999999ap-4, ""},
                 {"0.067", 0x1.126e978d4fdf4p-4, ""},
                 {"1e", 1.0, "e"},
                 {"1e+", 1.0, "e+"},
                 {"1_000", 1.0, "_000"},
                 {"1,5", 1.0, ",5"},
                 {"1.5.2", 1.5, ".2"},
                 {"0x10", 0.0, "x10"},
                 {"007", 7.0, ""},
                 {"inf", HUGE_VAL, ""}, /* YAML's words */
                 {".inf", HUGE_VAL, ""},
                 {"-.INF", -HUGE_VAL, ""},
                 {"1e999", HUGE_VAL, ""},
                 {"-1e99999999999999999999999999", -HUGE_VAL, ""},
                 {"1e-99999999999999999999999999", 0.0, ""}};
    for (size_t i = 0; i < COUNT(cases); i++)
        expect_number(cases[i].text, cases[i].number, cases[i].rest);
}

TEST(test_what_is_no_number)
{
    static const char *const texts[] = {"",   "-",  ".",     "-.",   "e5", "nan", ".nan",
                                        " 1", "m5", "--1.0", "+-.5", ".i", "i",   ".e1"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        double number = 7.0;
        const char *rest = NULL;
        if (text_to_number(texts[i], &number, &rest))
            fail_msg("'%s' was taken for a number", texts[i]);
        assert_true(number == 7.0);
    }
}

/* 2^53 + 1 lies halfway between two doubles, and so does half of the smallest double. */
TEST(test_halfway_cases)
{
    char text[3000];
    expect_number("9007199254740993", 0x1p53, "");
    expect_number("9007199254740995", 0x1.0000000000002p53, "");
    expect_number("9007199254740993.0000000000000000000001", 0x1.0000000000001p53, "");
    snprintf(text, sizeof text, "9007199254740993.%01500d1", 0);
    expect_number(text, 0x1.0000000000001p53, "");
    snprintf(text, sizeof text, "9007199254740993.%01500d", 0);
    expect_number(text, 0x1p53, "");
    expect_number("2.4703282292062327e-324", 0.0, "");
    expect_number("2.4703282292062328e-324", 0x1p-1074, "");
    expect_number("1.7976931348623157e308", 0x1.fffffffffffffp1023, "");
    expect_number("1.7976931348623159e308", HUGE_VAL, "");
}

/* Half of the smallest double, 2^-1075, has 750 significant digits. Exactly these are a tie, and
 * any digit behind them decides. 2^-1075 = 5^1075 / 10^1075. */
TEST(test_a_tie_of_750_digits)
{
    char digits[1100];
    char text[1200];
    memset(digits, '0', sizeof digits);
    digits[1075] = 0;
    digits[1074] = '1';
    for (int power = 0; power < 1075; power++) {
        int carry = 0;
        for (int i = 1074; i >= 0; i--) {
            const int product = 5 * (digits[i] - '0') + carry;
            digits[i] = (char)('0' + product % 10);
            carry = product / 10;
        }
    }
    snprintf(text, sizeof text, "0.%s", digits);
    expect_number(text, 0.0, "");
    snprintf(text, sizeof text, "0.%s%020d1", digits, 0);
    expect_number(text, 0x1p-1074, "");
}

TEST(test_long_texts)
{
    char text[3000];
    snprintf(text, sizeof text, "0.%01200d1e1201", 0);
    expect_number(text, 1.0, "");
    snprintf(text, sizeof text, "1%01200de-1199", 0);
    expect_number(text, 10.0, "");
    snprintf(text, sizeof text, "%01200d5", 0);
    expect_number(text, 5.0, "");
}

TEST(test_a_shift_rounds_once)
{
    double number;
    const char *rest;
    assert_true(text_to_shifted_number("6.7 cm", -2, &number, &rest));
    assert_true(number == 0x1.126e978d4fdf4p-4); /* 0.067; 6.7 * 0.01 is one bit more */
    assert_true(text_to_shifted_number("0.4e0", -3, &number, &rest));
    assert_true(number == 0x1.a36e2eb1c432dp-12);
    assert_true(text_to_shifted_number("30", 3, &number, &rest));
    assert_true(number == 30000.0);
}

/* Any double printed with 17 digits must come back as it was. */
static void expect_round_trips(int count)
{
    uint64_t random = 1;
    for (int i = 0; i < count; i++) {
        char text[40];
        double value;
        next_random(&random);
        const uint64_t bits = random ^ (random >> 29);
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        snprintf(text, sizeof text, "%.17g", value);
        for (char *c = text; *c; c++)
            if (*c == ',')
                *c = '.';
        expect_number(text, value, "");
    }
}

TEST(test_round_trips)
{
    expect_round_trips(20000);
}

TEST(test_a_decimal_comma_changes_nothing)
{
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8",  "de_DE",      "fr_FR.UTF-8",
                                        "fr_FR.utf8",  "nb_NO.UTF-8", "nl_NL.UTF-8"};
    const char *found = NULL;
    for (size_t i = 0; i < sizeof names / sizeof names[0] && !found; i++)
        found = setlocale(LC_ALL, names[i]);
    if (!found || strcmp(localeconv()->decimal_point, ",") != 0) {
        setlocale(LC_ALL, "C");
        print_message("no locale with a decimal comma is installed\n");
        skip();
    }
    test_numbers(state);
    test_halfway_cases(state);
    expect_round_trips(2000);
    struct report report = {.log = NULL}; /* messages go into files */
    (void)report_failure(&report, SONJECT_ERROR_INPUT, "at least %g, not %.1f, or [1, 2]", 0.25,
                         -3.5);
    setlocale(LC_ALL, "C");
    assert_string_equal(report.message, "at least 0.25, not -3.5, or [1, 2]");
}

/* Returns the next of texts that end with bars; NULL: none is left. */
static const char *next_text(const char **texts, char text[32])
{
    const size_t length = strcspn(*texts, "|");
    if ((*texts)[length] == '\0')
        return NULL;
    memcpy(text, *texts, length);
    text[length] = '\0';
    *texts += length + 1;
    return text;
}

TEST(test_counts)
{
    const char *bad = "|-1|+1|1.0|1e3| 1|1 |0x1|1_0|18446744073709551616|99999999999999999999|";
    uint64_t count = 7;
    char text[32];
    while (next_text(&bad, text))
        assert_false(text_to_count(text, &count));
    assert_true(count == 7);
    assert_true(text_to_count("0", &count) && count == 0);
    assert_true(text_to_count("18446744073709551615", &count) && count == UINT64_MAX);
    assert_true(text_to_count("1099511627776", &count) && count == UINT64_C(1) << 40);
}

TEST(test_printable)
{
    const char *good = "|mine 1|\xC3\xA5|\xE2\x82\xAC|\xED\x9F\xBF|\xF0\x9F\x90\x9F|"
                       "\xF4\x8F\xBF\xBF|\xC2\xA0|\xD8\x9B|\xE2\x80\x8D|\xE2\x80\xAF|\xE2\x81\xAA|";
    const char *bad = "a\nb|\x1B[31m|\x7F|\xC2\x80|\xC2\x9F|\xD8\x9C|\xE2\x80\x8E|\xE2\x80\x8F|"
                      "\xE2\x80\xA8|\xE2\x80\xAA|\xE2\x80\xAE|\xE2\x81\xA6|\xE2\x81\xA9|\x80|\xC3|"
                      "\xC0\xAF|\xC1\xBF|\xE0\x9F\xBF|\xED\xA0\x80|\xE2\x82|\xF0\x8F\xBF\xBF|"
                      "\xF4\x90\x80\x80|\xF5\x80\x80\x80|\xFF|";
    char text[32];
    while (next_text(&good, text))
        if (!text_is_printable(text))
            fail_msg("good text before '%s' was refused", good);
    while (next_text(&bad, text))
        if (text_is_printable(text))
            fail_msg("bad text before '%s' was taken", bad);
}

TEST(test_what_goes_to_a_terminal_is_made_printable)
{
    char text[] = "a\nb \x1B[31m \xC2\x9B"
                  "31m \xE2\x80\xAEgnp.x \xFF \xC3\xA5 \xE2\x82";
    text_make_printable(text);
    assert_string_equal(text, "a b  [31m ?31m ?gnp.x ? \xC3\xA5 ??");
    assert_true(text_is_printable(text));
}

TEST(test_excerpts)
{
    char excerpt[8];
    assert_string_equal(text_excerpt(excerpt, sizeof excerpt, "seven 7"), "seven 7");
    assert_string_equal(text_excerpt(excerpt, sizeof excerpt, "eight  8"), "eigh...");
    /* A euro sign of three bytes does not fit after three letters, and is not cut in two. */
    assert_string_equal(text_excerpt(excerpt, sizeof excerpt, "abc\xE2\x82\xAC of it"), "abc...");
    assert_string_equal(text_excerpt(excerpt, 4, "abcd"), "...");
}

TEST_PROGRAM(NULL, NULL)
