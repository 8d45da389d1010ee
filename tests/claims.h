/* CMocka with the headers that it wants before it, and what most tests in C have in common. */
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

#define TEST(function) cmocka_unit_test(function)

/* The program: tests, with what is made before all and removed after them, or NULL. */
#define TEST_PROGRAM(before, after, ...)                                                           \
    int main(void)                                                                                 \
    {                                                                                              \
        const struct CMUnitTest tests[] = {__VA_ARGS__};                                           \
        return cmocka_run_group_tests(tests, before, after);                                       \
    }

/* Knuth's numbers of 64 bits, whose upper ones are random: the next, the same for the same state.
 */
static inline uint64_t next_random(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return *state;
}

/* The call must succeed; otherwise the test fails with the message of its report. */
#define EXPECT_OK(report, call)                                                                    \
    do {                                                                                           \
        if ((call) != SONJECT_OK)                                                                  \
            fail_msg("%s", (report)->message);                                                     \
    } while (0)

#endif
