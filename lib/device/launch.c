/* Buffers and launches, all on the device's in-order queue. */
#include <pthread.h>

#include "device/opencl.h"

/* PoCL ends the process, by an assertion on its count of a kernel's users, where two threads run
 * one kernel over ranges of different width at once: seen with 3.1, and the same in the source of
 * 5.0. A launch uses all cores, so little is lost by one at a time. */
static pthread_mutex_t one_launch_of_pocl = PTHREAD_MUTEX_INITIALIZER;

sonject_status buffer_reserve(struct report *report, struct device *device, size_t bytes,
                              device_buffer *buffer)
{
    cl_int error = CL_SUCCESS;
    const size_t size = bytes > 0 ? bytes : 1;
    *buffer = NULL;
    if (size > device->allocation_limit)
        return report_failure(report, SONJECT_ERROR_DEVICE,
                              "device '%s' allows buffers of %zu MB, %zu MB are needed: use a "
                              "smaller patch",
                              device->name, device->allocation_limit >> 20, size >> 20);
    cl_mem made = clCreateBuffer(device->context, CL_MEM_READ_WRITE, size, NULL, &error);
    CHECK(opencl_answer(report, device, "clCreateBuffer", error));
    *buffer = made;
    return SONJECT_OK;
}

sonject_status buffer_create(struct report *report, struct device *device, size_t bytes,
                             const void *contents, device_buffer *buffer)
{
    CHECK(buffer_reserve(report, device, bytes, buffer));
    const sonject_status status = contents
                                      ? buffer_write(report, device, *buffer, 0, bytes, contents)
                                      : buffer_clear(report, device, *buffer, bytes);
    if (status != SONJECT_OK)
        buffer_release(buffer);
    return status;
}

void buffer_release(device_buffer *buffer)
{
    if (*buffer)
        clReleaseMemObject(*buffer);
    *buffer = NULL;
}

sonject_status buffer_read(struct report *report, struct device *device, device_buffer buffer,
                           size_t offset, size_t bytes, void *contents)
{
    if (bytes == 0)
        return SONJECT_OK;
    return opencl_answer(report, device, "clEnqueueReadBuffer",
                         clEnqueueReadBuffer(device->queue, buffer, CL_TRUE, offset, bytes,
                                             contents, 0, NULL, NULL));
}

sonject_status buffer_write(struct report *report, struct device *device, device_buffer buffer,
                            size_t offset, size_t bytes, const void *contents)
{
    if (bytes == 0)
        return SONJECT_OK;
    return opencl_answer(report, device, "clEnqueueWriteBuffer",
                         clEnqueueWriteBuffer(device->queue, buffer, CL_TRUE, offset, bytes,
                                              contents, 0, NULL, NULL));
}

sonject_status buffer_map(struct report *report, struct device *device, device_buffer buffer,
                          size_t bytes, const void **contents)
{
    cl_int error = CL_SUCCESS;
    *contents = clEnqueueMapBuffer(device->queue, buffer, CL_TRUE, CL_MAP_READ, 0,
                                   bytes > 0 ? bytes : 1, 0, NULL, NULL, &error);
    return opencl_answer(report, device, "clEnqueueMapBuffer", error);
}

void buffer_unmap(struct device *device, device_buffer buffer, const void *contents)
{
    /* the queue is in order, so nothing that follows can overtake this */
    (void)clEnqueueUnmapMemObject(device->queue, buffer, (void *)contents, 0, NULL, NULL);
}

sonject_status buffer_clear(struct report *report, struct device *device, device_buffer buffer,
                            size_t bytes)
{
    const cl_uchar zero = 0;
    if (bytes == 0)
        return SONJECT_OK;
    return opencl_answer(
        report, device, "clEnqueueFillBuffer",
        clEnqueueFillBuffer(device->queue, buffer, &zero, sizeof zero, 0, bytes, 0, NULL, NULL));
}

sonject_status kernel_run(struct report *report, struct device *device, device_kernel kernel,
                          const struct kernel_argument *arguments, size_t argument_count,
                          uint32_t dimensions, const size_t *global)
{
    for (size_t i = 0; i < argument_count; i++)
        CHECK(opencl_answer(
            report, device, "clSetKernelArg",
            clSetKernelArg(kernel, (cl_uint)i, arguments[i].bytes, arguments[i].value)));
    /* on a CPU a work-item is a whole strip: groups of one let the cores share them evenly */
    static const size_t alone[3] = {1, 1, 1};
    if (device->is_pocl)
        pthread_mutex_lock(&one_launch_of_pocl);
    const char *call = "clEnqueueNDRangeKernel";
    cl_int error = clEnqueueNDRangeKernel(device->queue, kernel, dimensions, NULL, global,
                                          device->is_cpu ? alone : NULL, 0, NULL, NULL);
    if (error == CL_SUCCESS) {
        call = "clFinish";
        error = clFinish(device->queue);
    }
    if (device->is_pocl)
        pthread_mutex_unlock(&one_launch_of_pocl);
    return opencl_answer(report, device, call, error);
}

void kernel_release(device_kernel *kernel)
{
    if (*kernel)
        clReleaseKernel(*kernel);
    *kernel = NULL;
}
