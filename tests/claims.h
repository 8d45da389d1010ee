/* CMocka with the headers that must come before it, and macros that most tests in C share. */
#ifndef SONJECT_TESTS_CLAIMS_H
#define SONJECT_TESTS_CLAIMS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define COUNT(list) (sizeof(list) / sizeof(list)[0])
#define PI          3.14159265358979323846

/* The program runs each TEST(name) { ... } in the file's order, with `state` as CMocka gives it.
 * TEST_WITH also names the fixture functions that run before and after the test. */
#define TEST(name) TEST_WITH(name, NULL, NULL)
#define TEST_WITH(name, before, after)                                                             \
    static void name(void **state);                                                                \
    __attribute__((constructor)) static void add_##name(void)                                      \
    {                                                                                              \
        add_test((struct CMUnitTest){#name, name, before, after, NULL});                           \
    }                                                                                              \
    static void name(void **state)

static struct CMUnitTest own_tests[32];
static size_t own_test_count;

static inline void add_test(struct CMUnitTest test)
{
    if (own_test_count == COUNT(own_tests))
        abort();
    own_tests[own_test_count++] = test;
}

static inline int run_own_tests(CMFixtureFunction before, CMFixtureFunction after)
{
    return _cmocka_run_group_tests("tests", own_tests, own_test_count, before, after);
}

/* Defines main, with the fixture functions that run before and after all tests, or NULL. */
#define TEST_PROGRAM(before, after)                                                                \
    int main(void)                                                                                 \
    {                                                                                              \
        return run_own_tests(before, after);                                                       \
    }

/* Returns the next number of Knuth's 64-bit generator, whose upper bits are random. */
static inline uint64_t next_random(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return *state;
}

/* Returns zeroed memory for count elements of size bytes, for free(). */
static inline void *zeroed(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (!memory) /* compilers do not know that a failed assertion does not return */
        abort();
    return memory;
}

/* Fails the test with the report's message if the call does not succeed. */
#define EXPECT_OK(report, call)                                                                    \
    do {                                                                                           \
        if ((call) != SONJECT_OK)                                                                  \
            fail_msg("%s", (report)->message);                                                     \
    } while (0)

#endif
