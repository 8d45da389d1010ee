/* Buffers and launches of OpenCL, all on the device's in-order queue. */
#include <pthread.h>

#include "device/opencl/opencl.h"

/* A lock for PoCL. If two threads run one kernel over ranges of different width at once, PoCL ends
 * the process, by an assertion on its count of a kernel's users: seen with 3.1, and the same in the
 * source of 5.0. A launch uses all cores, so one at a time costs little. */
static pthread_mutex_t one_launch_of_pocl = PTHREAD_MUTEX_INITIALIZER;

static sonject_status opencl_reserve(struct report *report, struct device *device, size_t bytes,
                                     device_buffer *buffer)
{
    cl_int error = CL_SUCCESS;
    *buffer = clCreateBuffer(device->context, CL_MEM_READ_WRITE, bytes, NULL, &error);
    return opencl_answer(report, device, "clCreateBuffer", error);
}

static void opencl_release(device_buffer buffer)
{
    clReleaseMemObject(buffer);
}

static sonject_status opencl_read(struct report *report, struct device *device,
                                  device_buffer buffer, size_t offset, size_t bytes, void *contents)
{
    return opencl_answer(report, device, "clEnqueueReadBuffer",
                         clEnqueueReadBuffer(device->queue, buffer, CL_TRUE, offset, bytes,
                                             contents, 0, NULL, NULL));
}

static sonject_status opencl_write(struct report *report, struct device *device,
                                   device_buffer buffer, size_t offset, size_t bytes,
                                   const void *contents)
{
    return opencl_answer(report, device, "clEnqueueWriteBuffer",
                         clEnqueueWriteBuffer(device->queue, buffer, CL_TRUE, offset, bytes,
                                              contents, 0, NULL, NULL));
}

static sonject_status opencl_map(struct report *report, struct device *device, device_buffer buffer,
                                 size_t bytes, const void **contents)
{
    cl_int error = CL_SUCCESS;
    *contents = clEnqueueMapBuffer(device->queue, buffer, CL_TRUE, CL_MAP_READ, 0, bytes, 0, NULL,
                                   NULL, &error);
    return opencl_answer(report, device, "clEnqueueMapBuffer", error);
}

static void opencl_unmap(struct device *device, device_buffer buffer, const void *contents)
{
    /* the queue is in order, so no later command overtakes this one */
    (void)clEnqueueUnmapMemObject(device->queue, buffer, (void *)contents, 0, NULL, NULL);
}

static sonject_status opencl_clear(struct report *report, struct device *device,
                                   device_buffer buffer, size_t bytes)
{
    const cl_uchar zero = 0;
    return opencl_answer(
        report, device, "clEnqueueFillBuffer",
        clEnqueueFillBuffer(device->queue, buffer, &zero, sizeof zero, 0, bytes, 0, NULL, NULL));
}

struct kernel_launch {
    const struct device *device;
    device_kernel kernel;
    cl_uint dimensions;
    const size_t *global, *group; /* group: NULL: the driver's choice */
    const char *call;             /* the last OpenCL call */
    cl_int error;
};

static void launch(void *kernel_launch)
{
    struct kernel_launch *launch = kernel_launch;
    const struct device *device = launch->device;
    if (device->is_pocl)
        pthread_mutex_lock(&one_launch_of_pocl);
    launch->call = "clEnqueueNDRangeKernel";
    launch->error = clEnqueueNDRangeKernel(device->queue, launch->kernel, launch->dimensions, NULL,
                                           launch->global, launch->group, 0, NULL, NULL);
    if (launch->error == CL_SUCCESS) {
        launch->call = "clFinish";
        launch->error = clFinish(device->queue);
    }
    if (device->is_pocl)
        pthread_mutex_unlock(&one_launch_of_pocl);
}

static sonject_status opencl_kernel_run(struct report *report, struct device *device,
                                        device_kernel kernel,
                                        const struct kernel_argument *arguments,
                                        size_t argument_count, uint32_t dimensions,
                                        const size_t *global)
{
    for (size_t i = 0; i < argument_count; i++)
        CHECK(opencl_answer(
            report, device, "clSetKernelArg",
            clSetKernelArg(kernel, (cl_uint)i, arguments[i].bytes, arguments[i].value)));
    /* a CPU's work-item is a whole strip: in groups of one, cores share strips evenly */
    size_t group[3] = {1, 1, 1};
    bool has_group = device->is_cpu;
    if (!device->is_cpu) {
        CHECK(opencl_answer(report, device, "clGetKernelWorkGroupInfo",
                            clGetKernelWorkGroupInfo(kernel, device->id,
                                                     CL_KERNEL_COMPILE_WORK_GROUP_SIZE,
                                                     sizeof group, group, NULL)));
        has_group = group[0] > 0;
    }
    struct kernel_launch run = {.device = device,
                                .kernel = kernel,
                                .dimensions = dimensions,
                                .global = global,
                                .group = has_group ? group : NULL};
    sonject_status waited = SONJECT_OK;
    if (kernel == device->fresh) { /* PoCL compiles most of the kernel now */
        device->fresh = NULL;
        waited = wait_for_compiler(report, launch, &run);
    } else {
        launch(&run);
    }
    CHECK(opencl_answer(report, device, run.call, run.error));
    return waited;
}

static void opencl_kernel_release(device_kernel kernel)
{
    clReleaseKernel(kernel);
}

const struct device_calls opencl_calls = {
    .claim = driver_claim,
    .close = opencl_close,
    .buffer_reserve = opencl_reserve,
    .buffer_release = opencl_release,
    .buffer_read = opencl_read,
    .buffer_write = opencl_write,
    .buffer_map = opencl_map,
    .buffer_unmap = opencl_unmap,
    .buffer_clear = opencl_clear,
    .kernel_create = opencl_kernel_create,
    .kernel_release = opencl_kernel_release,
    .kernel_run = opencl_kernel_run,
};
