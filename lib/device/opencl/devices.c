/* OpenCL's devices, found and opened, and what a process has one of. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/system/process.h"
#include "base/text.h"
#include "device/opencl/opencl.h"

#define DEVICES_MAX 64
#define GPU_GROUP   64 /* work-items: two warps of NVIDIA, one wavefront of AMD */

static long process_of_driver; /* 0: no call yet; atomic */
static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;
static struct shared_device *devices_in_use;

struct found_device {
    cl_platform_id platform;
    cl_device_id id;
    cl_device_type type;
};

const char *opencl_error_name(cl_int error)
{
    static const struct {
        cl_int error;
        const char *name;
    } names[] = {
#define NAME(error) {error, #error}
        NAME(CL_DEVICE_NOT_FOUND),
        NAME(CL_DEVICE_NOT_AVAILABLE),
        NAME(CL_COMPILER_NOT_AVAILABLE),
        NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE),
        NAME(CL_OUT_OF_RESOURCES),
        NAME(CL_OUT_OF_HOST_MEMORY),
        NAME(CL_BUILD_PROGRAM_FAILURE),
        NAME(CL_MAP_FAILURE),
        NAME(CL_INVALID_VALUE),
        NAME(CL_INVALID_DEVICE),
        NAME(CL_INVALID_CONTEXT),
        NAME(CL_INVALID_COMMAND_QUEUE),
        NAME(CL_INVALID_MEM_OBJECT),
        NAME(CL_INVALID_BINARY),
        NAME(CL_INVALID_BUILD_OPTIONS),
        NAME(CL_INVALID_PROGRAM),
        NAME(CL_INVALID_PROGRAM_EXECUTABLE),
        NAME(CL_INVALID_KERNEL_NAME),
        NAME(CL_INVALID_KERNEL),
        NAME(CL_INVALID_ARG_INDEX),
        NAME(CL_INVALID_ARG_VALUE),
        NAME(CL_INVALID_ARG_SIZE),
        NAME(CL_INVALID_KERNEL_ARGS),
        NAME(CL_INVALID_WORK_DIMENSION),
        NAME(CL_INVALID_WORK_GROUP_SIZE),
        NAME(CL_INVALID_WORK_ITEM_SIZE),
        NAME(CL_INVALID_OPERATION),
        NAME(CL_INVALID_BUFFER_SIZE),
        NAME(CL_INVALID_GLOBAL_WORK_SIZE)
#undef NAME
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (names[i].error == error)
            return names[i].name;
    return "unknown OpenCL error";
}

sonject_status opencl_answer(struct report *report, const struct device *device, const char *call,
                             cl_int error)
{
    if (error == CL_SUCCESS)
        return SONJECT_OK;
    return report_failure(
        report, error == CL_OUT_OF_HOST_MEMORY ? SONJECT_ERROR_MEMORY : SONJECT_ERROR_DEVICE,
        "device '%s': %s failed with %s (%d)", device->name, call, opencl_error_name(error),
        (int)error);
}

/* Notes the process before the lock is taken, so that no child waits for a lock that a thread of
 * its parent held. */
sonject_status driver_claim(struct report *report)
{
    long first = 0;
    const long process = process_number();
    if (__atomic_compare_exchange_n(&process_of_driver, &first, process, false, __ATOMIC_SEQ_CST,
                                    __ATOMIC_SEQ_CST) ||
        first == process)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_DEVICE,
                          "OpenCL was in use when this process was forked, and its calls would "
                          "wait for ever: start a new process instead (in Python, spawn it), or "
                          "fork before OpenCL is used");
}

sonject_status driver_enter(struct report *report)
{
    const sonject_status status = driver_claim(report);
    if (status == SONJECT_OK)
        pthread_mutex_lock(&one_at_a_time);
    return status;
}

void driver_leave(void)
{
    pthread_mutex_unlock(&one_at_a_time);
}

/* Reports why there is no device. Memory may be short: drivers that do not load are skipped. */
static sonject_status explain_no_device(struct report *report, cl_int error)
{
    if (error == CL_OUT_OF_HOST_MEMORY || memory_is_short())
        return report_failure(report, SONJECT_ERROR_MEMORY,
                              "too little memory to find OpenCL devices: allow the process more, "
                              "a gigabyte at least (ulimit -v)");
    if (error == CL_SUCCESS)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_DEVICE, "no OpenCL device answers: %s (%d)",
                          opencl_error_name(error), (int)error);
}

/* Finds all devices. A platform that fails is skipped if another has a device. */
static sonject_status find_devices(struct report *report, struct found_device *found, size_t *count)
{
    cl_platform_id platforms[16];
    cl_uint platform_count = 0;
    cl_int error = clGetPlatformIDs(16, platforms, &platform_count);
    *count = 0;
    if (error != CL_SUCCESS)
        platform_count = 0;
    if (error == CL_PLATFORM_NOT_FOUND_KHR)
        error = CL_SUCCESS;
    for (cl_uint p = 0; p < platform_count && p < 16; p++) {
        cl_device_id ids[DEVICES_MAX];
        cl_uint ids_count = 0;
        const cl_int answer =
            clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, DEVICES_MAX, ids, &ids_count);
        if (answer != CL_SUCCESS && answer != CL_DEVICE_NOT_FOUND)
            error = answer;
        for (cl_uint d = 0; answer == CL_SUCCESS && d < ids_count && *count < DEVICES_MAX; d++) {
            struct found_device *device = &found[(*count)++];
            *device = (struct found_device){platforms[p], ids[d], 0};
            clGetDeviceInfo(ids[d], CL_DEVICE_TYPE, sizeof device->type, &device->type, NULL);
        }
    }
    return *count > 0 ? SONJECT_OK : explain_no_device(report, error);
}

static void read_text(cl_device_id id, cl_device_info what, char *text, size_t capacity)
{
    size_t bytes = 0;
    text[0] = '\0';
    char *whole = NULL;
    if (clGetDeviceInfo(id, what, 0, NULL, &bytes) == CL_SUCCESS)
        whole = allocate_array(bytes + 1, 1);
    if (whole && clGetDeviceInfo(id, what, bytes, whole, NULL) == CL_SUCCESS)
        snprintf(text, capacity, "%s", whole);
    free(whole);
}

/* Returns the number of lanes: on CPUs what registers hold; on GPUs 1, as work-items are lanes. */
static uint32_t lanes_for(cl_device_id id, cl_device_type type)
{
    cl_uint native = 1;
    if (!(type & CL_DEVICE_TYPE_CPU))
        return 1;
    clGetDeviceInfo(id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof native, &native, NULL);
    return native >= 16 ? 16 : native >= 8 ? 8 : native >= 4 ? 4 : 1;
}

static void describe(cl_device_id id, cl_device_type type, cl_platform_id platform,
                     sonject_device_info *info)
{
    cl_uint units = 0;
    memset(info, 0, sizeof *info);
    read_text(id, CL_DEVICE_NAME, info->name, sizeof info->name);
    read_text(id, CL_DRIVER_VERSION, info->driver, sizeof info->driver);
    if (clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof info->platform, info->platform,
                          NULL) != CL_SUCCESS)
        info->platform[0] = '\0';
    clGetDeviceInfo(id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    info->compute_units = units;
    info->vector_width = lanes_for(id, type);
}

/* Returns the first GPU's index; count if there is none. */
static size_t first_gpu(const struct found_device *found, size_t count)
{
    size_t i = 0;
    while (i < count && !(found[i].type & CL_DEVICE_TYPE_GPU))
        i++;
    return i;
}

sonject_status opencl_list(struct report *report, sonject_device_info *devices, size_t capacity,
                           size_t *count, size_t *gpu)
{
    struct found_device found[DEVICES_MAX];
    *count = *gpu = 0;
    CHECK(driver_enter(report));
    const sonject_status status = find_devices(report, found, count);
    for (size_t i = 0; i < *count && i < capacity; i++)
        describe(found[i].id, found[i].type, found[i].platform, &devices[i]);
    *gpu = first_gpu(found, *count);
    driver_leave();
    return status;
}

static sonject_status choose_device(struct report *report, const char *name,
                                    struct found_device *chosen)
{
    struct found_device found[DEVICES_MAX];
    size_t count;
    CHECK(find_devices(report, found, &count));
    size_t i = 0;
    if (name) {
        char device_name[128];
        for (; i < count; i++) {
            read_text(found[i].id, CL_DEVICE_NAME, device_name, sizeof device_name);
            if (contains_ignoring_case(device_name, name))
                break;
        }
    } else {
        const size_t gpu = first_gpu(found, count);
        i = gpu < count ? gpu : 0;
    }
    if (i < count) {
        *chosen = found[i];
        return SONJECT_OK;
    }
    if (count == 0)
        return report_failure(report, SONJECT_ERROR_DEVICE,
                              "no OpenCL device found: install a driver, such as the package "
                              "pocl-opencl-icd for the CPU, or name the device native");
    return report_failure(report, SONJECT_ERROR_DEVICE,
                          "no device has '%s' in its name: `sonject devices` lists them", name);
}

/* Returns the device's record, which is made for its first user and released by its last. */
static struct shared_device *find_shared(cl_device_id id, cl_int *error)
{
    *error = CL_SUCCESS;
    struct shared_device *device = devices_in_use;
    while (device && device->id != id)
        device = device->next;
    if (!device) {
        device = allocate_array(1, sizeof *device);
        if (!device) {
            *error = CL_OUT_OF_HOST_MEMORY;
            return NULL;
        }
        device->context = clCreateContext(NULL, 1, &id, NULL, NULL, error);
        if (*error != CL_SUCCESS) {
            free(device);
            return NULL;
        }
        device->id = id;
        device->next = devices_in_use;
        devices_in_use = device;
    }
    device->users++;
    return device;
}

static void release_shared(struct shared_device *device)
{
    if (--device->users > 0)
        return;
    struct shared_device **link = &devices_in_use;
    while (*link != device)
        link = &(*link)->next;
    *link = device->next;
    for (size_t i = 0; i < device->program_count; i++)
        clReleaseProgram(device->programs[i].program);
    clReleaseContext(device->context);
    free(device);
}

static sonject_status open_queue(struct report *report, struct device *device)
{
    cl_int error;
    device->shared = find_shared(device->id, &error);
    CHECK(opencl_answer(report, device, "clCreateContext", error));
    device->context = device->shared->context;
    cl_command_queue queue = clCreateCommandQueue(device->context, device->id, 0, &error);
    CHECK(opencl_answer(report, device, "clCreateCommandQueue", error));
    device->queue = queue;
    return SONJECT_OK;
}

static sonject_status check_abilities(struct report *report, struct device *device)
{
    cl_ulong limit = 0;
    cl_device_fp_config precision = 0;
    cl_int error =
        clGetDeviceInfo(device->id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof limit, &limit, NULL);
    CHECK(opencl_answer(report, device, "clGetDeviceInfo", error));
    error =
        clGetDeviceInfo(device->id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof precision, &precision, NULL);
    CHECK(opencl_answer(report, device, "clGetDeviceInfo", error));
    device->allocation_limit = limit > SIZE_MAX ? SIZE_MAX : (size_t)limit;
    if (!(precision & CL_FP_INF_NAN) || !(precision & CL_FP_ROUND_TO_NEAREST))
        return report_failure(report, SONJECT_ERROR_DEVICE,
                              "device '%s' does not compute single precision as IEEE 754 does: "
                              "choose another",
                              device->name);
    return SONJECT_OK;
}

void opencl_close(struct device *device)
{
    struct report ignored = {.host = NULL};
    if (!device->shared || driver_enter(&ignored) != SONJECT_OK)
        return;
    if (device->queue)
        clReleaseCommandQueue(device->queue);
    release_shared(device->shared);
    driver_leave();
}

static sonject_status open_in_driver(struct report *report, const char *name, struct device *device)
{
    struct found_device chosen = {NULL, NULL, 0};
    sonject_device_info info;
    CHECK(choose_device(report, name, &chosen));
    describe(chosen.id, chosen.type, chosen.platform, &info);
    device_take_info(device, &info);
    device->calls = &opencl_calls;
    device->id = chosen.id;
    device->is_cpu = (chosen.type & CL_DEVICE_TYPE_CPU) != 0;
    device->group_items = device->is_cpu ? 1 : GPU_GROUP;
    device->is_pocl = strcmp(info.platform, "Portable Computing Language") == 0;
    CHECK(check_abilities(report, device));
    return open_queue(report, device);
}

sonject_status opencl_open(struct report *report, const char *name, struct device *device)
{
    CHECK(driver_enter(report));
    const sonject_status status = open_in_driver(report, name, device);
    driver_leave();
    return status;
}
