/* The n-th call fails, of those that the library makes for memory, of OpenCL, or of files, or that
 * libraries under it make for memory: a status and a message, nothing held, no file that is not
 * whole, and the next call works.
 *
 * SONJECT_FAULT_POINTS: how many n are tried of each piece of work (0: all). KIND: the calls. */
#include "claims.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "faults.h"
#include "work.h"

#ifndef POINTS
#define POINTS 12
#endif

/* What an OpenCL call may say; a device that is lost stays so. */
static const int opencl_errors[] = {CL_OUT_OF_RESOURCES, CL_DEVICE_NOT_AVAILABLE,
                                    CL_OUT_OF_HOST_MEMORY, CL_MEM_OBJECT_ALLOCATION_FAILURE};

static long points_wanted(void)
{
    const char *text = getenv("SONJECT_FAULT_POINTS");
    return text ? strtol(text, NULL, 10) : POINTS;
}

static bool is_right_status(sonject_status status)
{
    switch (KIND) {
    case FAULT_MEMORY:
        return status == SONJECT_ERROR_MEMORY;
    case FAULT_OPENCL:
        return status == SONJECT_ERROR_DEVICE || status == SONJECT_ERROR_MEMORY;
    default: /* where an input cannot be opened or read, INPUT */
        return status == SONJECT_ERROR_STORAGE || status == SONJECT_ERROR_INPUT ||
               (KIND == FAULT_LIBRARIES && status == SONJECT_ERROR_MEMORY);
    }
}

static void expect_nothing_held(const char *name, long n, long blocks)
{
    if (fault_blocks() != blocks)
        fail_msg("%s, call %ld: %ld blocks of memory are left", name, n, fault_blocks() - blocks);
    if (fault_objects() != 0)
        fail_msg("%s, call %ld: %ld OpenCL objects are left", name, n, fault_objects());
}

static struct work work;

/* Returns whether the work failed; a call may be one that the library can do without. */
static bool fail_at(const struct work_piece *piece, long n)
{
    const char *name = piece->name;
    const int error = KIND == FAULT_OPENCL ? opencl_errors[(size_t)n % COUNT(opencl_errors)] : 0;
    const bool stays = KIND == FAULT_OPENCL ? error == CL_DEVICE_NOT_AVAILABLE : n % 2 == 1;
    const long blocks = fault_blocks();
    fault_arm(KIND, n, stays, error);
    const sonject_status status = work_do(&work, piece);
    const long calls = fault_disarm();
    /* a device that fails may be asked in another order; then there is nothing to be seen */
    if (calls < n && status != SONJECT_OK)
        fail_msg("%s failed of itself: %s", name, work.message);
    if (status != SONJECT_OK && !is_right_status(status))
        fail_msg("%s, call %ld: %s: %s", name, n, sonject_status_name(status), work.message);
    if (status != SONJECT_OK && status != SONJECT_ERROR_MEMORY && work.message[0] == '\0')
        fail_msg("%s, call %ld: no message", name, n);
    expect_nothing_held(name, n, blocks);
    work_check_results(&work, status == SONJECT_OK);
    return status != SONJECT_OK;
}

static void expect_done(const struct work_piece *piece)
{
    const long blocks = fault_blocks();
    if (work_do(&work, piece) != SONJECT_OK)
        fail_msg("%s, undisturbed: %s", piece->name, work.message);
    expect_nothing_held(piece->name, 0, blocks);
}

/* Fails calls spread over all that the work makes, the next call of which must work each time that
 * a third of them is done. */
static void test_piece(void **state)
{
    const struct work_piece *piece = *state;
    if (piece == &work_form)
        expect_done(&work_trace);
    expect_done(piece); /* fills the driver's cache */
    work_expect(&work);
    fault_arm(KIND, 0, false, 0);
    expect_done(piece);
    const long calls = fault_disarm();
    work_check_results(&work, true);
    const long wanted = points_wanted();
    const long points = wanted > 0 && wanted < calls ? wanted : calls;
    long failed = 0;
    for (long i = 0; i < points; i++) {
        /* one of each of as many runs of calls, another in each so that none is left out for ever
         */
        const long first = i * calls / points;
        const long length = (i + 1) * calls / points - first;
        failed += fail_at(piece, 1 + first + (7 * i) % length);
        if (i % (points / 3 + 1) == points / 3 || i == points - 1) {
            expect_done(piece);
            work_check_results(&work, true);
        }
    }
    print_message("%s: %ld calls, %ld tried, %ld failed the work\n", piece->name, calls, points,
                  failed);
    assert_true(failed > 0);
}

static void test_discovery_short_of_memory_says_so(void **state)
{
    for (long n = 1; n <= 2; n++) { /* platforms, devices */
        fault_arm(FAULT_OPENCL, n, false, CL_OUT_OF_HOST_MEMORY);
        const sonject_status status = work_do(&work, &work_inject);
        (void)fault_disarm();
        assert_int_equal(status, SONJECT_ERROR_MEMORY);
        assert_non_null(strstr(work.message, "too little memory"));
    }
}

/* Without memory HDF5 1.10 loses what all its later calls need, and libtiff 4.5 ends the process:
 * what uses them is left out where libraries lack it. */
#define PIECE(of)                                                                                  \
    {                                                                                              \
#of, test_piece, NULL, NULL, (void *)(uintptr_t)&of                                        \
    }

int main(void)
{
    const struct CMUnitTest discovery[] = {
        cmocka_unit_test(test_discovery_short_of_memory_says_so)};
    const struct CMUnitTest with_device[] = {PIECE(work_inject), PIECE(work_run), PIECE(work_trace),
                                             PIECE(work_form)};
    /* the OpenCL calls of some are those of the others, and the last ones have none */
    const struct CMUnitTest others[] = {
        PIECE(work_shards),  PIECE(work_campaign),  PIECE(work_read),  PIECE(work_check),
        PIECE(work_measure), PIECE(work_quicklook), PIECE(work_seabed)};
    const struct CMUnitTest of_libraries[] = {PIECE(work_inject), PIECE(work_read),
                                              PIECE(work_check), PIECE(work_campaign),
                                              PIECE(work_quicklook)};
    fault_take_jansson();
    int failed = work_prepare(&work);
    if (KIND == FAULT_LIBRARIES) {
        failed += cmocka_run_group_tests(of_libraries, NULL, NULL);
    } else {
        failed += cmocka_run_group_tests(with_device, NULL, NULL);
        failed += KIND == FAULT_OPENCL ? cmocka_run_group_tests(discovery, NULL, NULL)
                                       : cmocka_run_group_tests(others, NULL, NULL);
    }
    return failed + work_remove(&work);
}
