#include "faults.h"

#include <stddef.h>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

/* Wraps a call that returns its error. */
#define ANSWERS(name, parameters, arguments)                                                       \
    cl_int __real_##name parameters;                                                               \
    cl_int __wrap_##name parameters;                                                               \
    cl_int __wrap_##name parameters                                                                \
    {                                                                                              \
        int error;                                                                                 \
        if (fault_is_due(FAULT_OPENCL, &error))                                                    \
            return error;                                                                          \
        fault_look_away();                                                                         \
        const cl_int done = __real_##name arguments;                                               \
        fault_look_again();                                                                        \
        return done;                                                                               \
    }

/* Wraps a call that makes an object. The last parameter of the call is `cl_int *answer`. */
#define MAKES(type, name, parameters, arguments)                                                   \
    type __real_##name parameters;                                                                 \
    type __wrap_##name parameters;                                                                 \
    type __wrap_##name parameters                                                                  \
    {                                                                                              \
        int error;                                                                                 \
        if (fault_is_due(FAULT_OPENCL, &error)) {                                                  \
            *answer = error;                                                                       \
            return NULL;                                                                           \
        }                                                                                          \
        fault_look_away();                                                                         \
        type object = __real_##name arguments;                                                     \
        fault_look_again();                                                                        \
        if (object)                                                                                \
            fault_count_object(1);                                                                 \
        return object;                                                                             \
    }

/* Wraps a call that gives an object up, which never fails. */
#define RELEASES(name, type)                                                                       \
    cl_int __real_##name(type object);                                                             \
    cl_int __wrap_##name(type object);                                                             \
    cl_int __wrap_##name(type object)                                                              \
    {                                                                                              \
        fault_count_object(-1);                                                                    \
        fault_look_away();                                                                         \
        const cl_int done = __real_##name(object);                                                 \
        fault_look_again();                                                                        \
        return done;                                                                               \
    }

ANSWERS(clGetPlatformIDs, (cl_uint room, cl_platform_id *platforms, cl_uint *count),
        (room, platforms, count))
ANSWERS(clGetPlatformInfo,
        (cl_platform_id platform, cl_platform_info what, size_t room, void *value, size_t *bytes),
        (platform, what, room, value, bytes))
ANSWERS(clGetDeviceIDs,
        (cl_platform_id platform, cl_device_type type, cl_uint room, cl_device_id *devices,
         cl_uint *count),
        (platform, type, room, devices, count))
ANSWERS(clGetDeviceInfo,
        (cl_device_id device, cl_device_info what, size_t room, void *value, size_t *bytes),
        (device, what, room, value, bytes))
MAKES(cl_context, clCreateContext,
      (const cl_context_properties *properties, cl_uint count, const cl_device_id *devices,
       void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *user,
       cl_int *answer),
      (properties, count, devices, notify, user, answer))
MAKES(cl_command_queue, clCreateCommandQueue,
      (cl_context context, cl_device_id device, cl_command_queue_properties properties,
       cl_int *answer),
      (context, device, properties, answer))
MAKES(cl_mem, clCreateBuffer,
      (cl_context context, cl_mem_flags flags, size_t bytes, void *contents, cl_int *answer),
      (context, flags, bytes, contents, answer))
MAKES(cl_program, clCreateProgramWithSource,
      (cl_context context, cl_uint count, const char **texts, const size_t *lengths,
       cl_int *answer),
      (context, count, texts, lengths, answer))
MAKES(cl_kernel, clCreateKernel, (cl_program program, const char *name, cl_int *answer),
      (program, name, answer))
ANSWERS(clBuildProgram,
        (cl_program program, cl_uint count, const cl_device_id *devices, const char *options,
         void(CL_CALLBACK *notify)(cl_program, void *), void *user),
        (program, count, devices, options, notify, user))
ANSWERS(clGetProgramBuildInfo,
        (cl_program program, cl_device_id device, cl_program_build_info what, size_t room,
         void *value, size_t *bytes),
        (program, device, what, room, value, bytes))
ANSWERS(clSetKernelArg, (cl_kernel kernel, cl_uint index, size_t bytes, const void *value),
        (kernel, index, bytes, value))
ANSWERS(clEnqueueNDRangeKernel,
        (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *offset,
         const size_t *global, const size_t *local, cl_uint count, const cl_event *before,
         cl_event *event),
        (queue, kernel, dimensions, offset, global, local, count, before, event))
ANSWERS(clEnqueueReadBuffer,
        (cl_command_queue queue, cl_mem buffer, cl_bool waits, size_t offset, size_t bytes,
         void *contents, cl_uint count, const cl_event *before, cl_event *event),
        (queue, buffer, waits, offset, bytes, contents, count, before, event))
ANSWERS(clEnqueueWriteBuffer,
        (cl_command_queue queue, cl_mem buffer, cl_bool waits, size_t offset, size_t bytes,
         const void *contents, cl_uint count, const cl_event *before, cl_event *event),
        (queue, buffer, waits, offset, bytes, contents, count, before, event))
ANSWERS(clEnqueueFillBuffer,
        (cl_command_queue queue, cl_mem buffer, const void *pattern, size_t pattern_bytes,
         size_t offset, size_t bytes, cl_uint count, const cl_event *before, cl_event *event),
        (queue, buffer, pattern, pattern_bytes, offset, bytes, count, before, event))
typedef void *mapping;
MAKES(mapping, clEnqueueMapBuffer,
      (cl_command_queue queue, cl_mem buffer, cl_bool waits, cl_map_flags flags, size_t offset,
       size_t bytes, cl_uint count, const cl_event *before, cl_event *event, cl_int *answer),
      (queue, buffer, waits, flags, offset, bytes, count, before, event, answer))
ANSWERS(clFinish, (cl_command_queue queue), (queue))

RELEASES(clReleaseContext, cl_context)
RELEASES(clReleaseCommandQueue, cl_command_queue)
RELEASES(clReleaseMemObject, cl_mem)
RELEASES(clReleaseProgram, cl_program)
RELEASES(clReleaseKernel, cl_kernel)

cl_int __real_clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem buffer, void *contents,
                                      cl_uint count, const cl_event *before, cl_event *event);
cl_int __wrap_clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem buffer, void *contents,
                                      cl_uint count, const cl_event *before, cl_event *event);
cl_int __wrap_clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem buffer, void *contents,
                                      cl_uint count, const cl_event *before, cl_event *event)
{
    fault_count_object(-1);
    fault_look_away();
    const cl_int done =
        __real_clEnqueueUnmapMemObject(queue, buffer, contents, count, before, event);
    fault_look_again();
    return done;
}
