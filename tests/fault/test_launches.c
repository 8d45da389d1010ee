/* Tests that threads with contexts of their own run kernels one at a time on PoCL: see
 * lib/device/opencl/launch.c. The linker sends the library's calls through the wrappers below. */
#include "claims.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <pthread.h>

#include "form/form.h"

#define THREADS  4
#define LAUNCHES 100 /* launches of each thread */
#define SIDE     64

static int running, most; /* numbers of launches, now and at most; atomic */

cl_int __real_clEnqueueNDRangeKernel(cl_command_queue, cl_kernel, cl_uint, const size_t *,
                                     const size_t *, const size_t *, cl_uint, const cl_event *,
                                     cl_event *);
cl_int __real_clFinish(cl_command_queue);

cl_int __wrap_clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                                     const size_t *offset, const size_t *global,
                                     const size_t *local, cl_uint event_count,
                                     const cl_event *events, cl_event *event)
{
    const int now = __atomic_add_fetch(&running, 1, __ATOMIC_SEQ_CST);
    int before = __atomic_load_n(&most, __ATOMIC_SEQ_CST);
    while (now > before && !__atomic_compare_exchange_n(&most, &before, now, false,
                                                        __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST))
        continue;
    return __real_clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local,
                                         event_count, events, event);
}

cl_int __wrap_clFinish(cl_command_queue queue)
{
    const cl_int error = __real_clFinish(queue);
    __atomic_sub_fetch(&running, 1, __ATOMIC_SEQ_CST);
    return error;
}

struct runner {
    bool is_pocl;
    struct report report;
    sonject_status status;
};

static void *run(void *argument)
{
    static const sonject_context_params any = {.struct_size = sizeof any};
    static float energy[SIDE * SIDE];
    const struct span cells = {0, SIDE};
    struct runner *runner = argument;
    struct device *device;
    runner->status = device_open(&runner->report, &any, &device);
    runner->is_pocl = device && device->is_pocl;
    for (int i = 0; i < LAUNCHES; i++) {
        device_buffer parts[2] = {NULL, NULL};
        THEN(runner->status,
             speckle_draw(&runner->report, device, cells, cells, energy, 1, 2, parts));
        buffer_release(device, &parts[0]);
        buffer_release(device, &parts[1]);
    }
    device_close(&device);
    return NULL;
}

TEST(test_pocl_runs_one_kernel_at_a_time)
{
    static struct runner runners[THREADS];
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, run, &runners[i]), 0);
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
    for (int i = 0; i < THREADS; i++)
        EXPECT_OK(&runners[i].report, runners[i].status);
    if (!runners[0].is_pocl)
        skip();
    assert_int_equal(most, 1);
}

TEST_PROGRAM(NULL, NULL)
