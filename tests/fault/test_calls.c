/* Tests that the library survives the failure of its n-th call for memory, of OpenCL or of files,
 * or of the n-th call for memory by the libraries under it. A status and a message come back,
 * nothing is held, no file is left incomplete, and the next call works.
 *
 * SONJECT_FAULT_POINTS: the number of n to try of each piece of work (0: all). KIND: the calls. */
#include "claims.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "faults.h"
#include "work.h"

#ifndef POINTS
#define POINTS 12
#endif

/* Errors that an OpenCL call may return. A device that is lost stays lost. */
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
    default: /* INPUT where an input cannot be opened or read */
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

/* Returns whether the work failed. The library can do without some calls. */
static bool fail_at(const struct work_piece *piece, long n)
{
    const char *name = piece->name;
    const int error = KIND == FAULT_OPENCL ? opencl_errors[(size_t)n % COUNT(opencl_errors)] : 0;
    const bool stays = KIND == FAULT_OPENCL ? error == CL_DEVICE_NOT_AVAILABLE : n % 2 == 1;
    const long blocks = fault_blocks();
    fault_arm(KIND, n, stays, error);
    const sonject_status status = work_do(&work, piece);
    const long calls = fault_disarm();
    /* calls may come in another order, and fewer than n of them: then none failed */
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

/* Fails calls spread over all calls of the work. Undisturbed work must succeed each time that a
 * third of them is done. */
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
        /* divides the calls into runs, and fails one in each at varying places, so that none is
         * left out for ever */
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
    for (long n = 1; n <= 2; n++) { /* 1: platforms, 2: devices */
        fault_arm(FAULT_OPENCL, n, false, CL_OUT_OF_HOST_MEMORY);
        const sonject_status status = work_do(&work, &work_inject);
        (void)fault_disarm();
        assert_int_equal(status, SONJECT_ERROR_MEMORY);
        assert_non_null(strstr(work.message, "too little memory"));
    }
}

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
    /* no OpenCL faults: their OpenCL calls are those of with_device, or none */
    const struct CMUnitTest others[] = {
        PIECE(work_shards),  PIECE(work_campaign),  PIECE(work_read),  PIECE(work_check),
        PIECE(work_measure), PIECE(work_quicklook), PIECE(work_seabed)};
    /* Without memory HDF5 1.10 loses state that all its later calls need, and libtiff 4.5 ends the
     * process. Work that uses them is left out here. */
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
