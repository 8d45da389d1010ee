/* OpenCL's functions, passed on to its library. The first call loads the library, so that only
 * processes that ask for OpenCL's devices need it. Without the library, no platform is found. */
#include <pthread.h>
#include <string.h>

#include "base/system/process.h"
#include "device/opencl/opencl.h"

/* Finds a function; NULL if there is no library. A library stays loaded. If loading fails, for want
 * of memory say, the next call tries again. */
static void *find(const char *name)
{
    static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;
    static void *library;
    pthread_mutex_lock(&one_at_a_time);
    if (!library)
        library = library_load("OpenCL", 1);
    void *function = library ? library_function(library, name) : NULL;
    pthread_mutex_unlock(&one_at_a_time);
    return function;
}

/* absent: the result without the library. */
#define FORWARD(result, name, parameters, arguments, absent)                                       \
    result CL_API_CALL name parameters                                                             \
    {                                                                                              \
        static void *kept; /* atomic */                                                            \
        __typeof__(name) *function;                                                                \
        void *found = __atomic_load_n(&kept, __ATOMIC_RELAXED);                                    \
        if (!found)                                                                                \
            __atomic_store_n(&kept, found = find(#name), __ATOMIC_RELAXED);                        \
        memcpy(&function, &found, sizeof function);                                                \
        return function ? function arguments : absent;                                             \
    }
#define STATUS(name, parameters, arguments)                                                        \
    FORWARD(cl_int, name, parameters, arguments, CL_PLATFORM_NOT_FOUND_KHR)
#define OBJECT(result, name, parameters, arguments)                                                \
    FORWARD(result, name, parameters, arguments, NULL)

STATUS(clGetPlatformIDs, (cl_uint capacity, cl_platform_id *platforms, cl_uint *count),
       (capacity, platforms, count))
STATUS(clGetPlatformInfo,
       (cl_platform_id platform, cl_platform_info what, size_t capacity, void *value, size_t *size),
       (platform, what, capacity, value, size))
STATUS(clGetDeviceIDs,
       (cl_platform_id platform, cl_device_type type, cl_uint capacity, cl_device_id *devices,
        cl_uint *count),
       (platform, type, capacity, devices, count))
STATUS(clGetDeviceInfo,
       (cl_device_id device, cl_device_info what, size_t capacity, void *value, size_t *size),
       (device, what, capacity, value, size))

OBJECT(cl_context, clCreateContext,
       (const cl_context_properties *properties, cl_uint count, const cl_device_id *devices,
        void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *user,
        cl_int *error),
       (properties, count, devices, notify, user, error))
STATUS(clReleaseContext, (cl_context context), (context))
OBJECT(cl_command_queue, clCreateCommandQueue,
       (cl_context context, cl_device_id device, cl_command_queue_properties properties,
        cl_int *error),
       (context, device, properties, error))
STATUS(clReleaseCommandQueue, (cl_command_queue queue), (queue))
STATUS(clFinish, (cl_command_queue queue), (queue))

OBJECT(cl_program, clCreateProgramWithSource,
       (cl_context context, cl_uint count, const char **texts, const size_t *lengths,
        cl_int *error),
       (context, count, texts, lengths, error))
STATUS(clBuildProgram,
       (cl_program program, cl_uint count, const cl_device_id *devices, const char *options,
        void(CL_CALLBACK *notify)(cl_program, void *), void *user),
       (program, count, devices, options, notify, user))
STATUS(clGetProgramBuildInfo,
       (cl_program program, cl_device_id device, cl_program_build_info what, size_t capacity,
        void *value, size_t *size),
       (program, device, what, capacity, value, size))
STATUS(clReleaseProgram, (cl_program program), (program))
OBJECT(cl_kernel, clCreateKernel, (cl_program program, const char *kernel_name, cl_int *error),
       (program, kernel_name, error))
STATUS(clReleaseKernel, (cl_kernel kernel), (kernel))
STATUS(clGetKernelWorkGroupInfo,
       (cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info what, size_t capacity,
        void *value, size_t *size),
       (kernel, device, what, capacity, value, size))
STATUS(clSetKernelArg, (cl_kernel kernel, cl_uint place, size_t size, const void *value),
       (kernel, place, size, value))

OBJECT(cl_mem, clCreateBuffer,
       (cl_context context, cl_mem_flags flags, size_t size, void *memory, cl_int *error),
       (context, flags, size, memory, error))
STATUS(clReleaseMemObject, (cl_mem memory), (memory))
STATUS(clEnqueueReadBuffer,
       (cl_command_queue queue, cl_mem buffer, cl_bool waits, size_t offset, size_t size, void *to,
        cl_uint count, const cl_event *events, cl_event *event),
       (queue, buffer, waits, offset, size, to, count, events, event))
STATUS(clEnqueueWriteBuffer,
       (cl_command_queue queue, cl_mem buffer, cl_bool waits, size_t offset, size_t size,
        const void *from, cl_uint count, const cl_event *events, cl_event *event),
       (queue, buffer, waits, offset, size, from, count, events, event))
STATUS(clEnqueueFillBuffer,
       (cl_command_queue queue, cl_mem buffer, const void *pattern, size_t pattern_size,
        size_t offset, size_t size, cl_uint count, const cl_event *events, cl_event *event),
       (queue, buffer, pattern, pattern_size, offset, size, count, events, event))
OBJECT(void *, clEnqueueMapBuffer,
       (cl_command_queue queue, cl_mem buffer, cl_bool waits, cl_map_flags flags, size_t offset,
        size_t size, cl_uint count, const cl_event *events, cl_event *event, cl_int *error),
       (queue, buffer, waits, flags, offset, size, count, events, event, error))
STATUS(clEnqueueUnmapMemObject,
       (cl_command_queue queue, cl_mem buffer, void *mapped, cl_uint count, const cl_event *events,
        cl_event *event),
       (queue, buffer, mapped, count, events, event))
STATUS(clEnqueueNDRangeKernel,
       (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *offset,
        const size_t *size, const size_t *group, cl_uint count, const cl_event *events,
        cl_event *event),
       (queue, kernel, dimensions, offset, size, group, count, events, event))
