/* Kernels of the embedded sources. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"
#include "base/system/process.h"
#include "device/opencl/opencl.h"

/* Writes options: no fast-math of any kind; correctly rounded division if it must be asked for. */
static void program_options(const struct device *device, enum program_variant variant,
                            char options[OPTIONS_CAPACITY])
{
    cl_device_fp_config precision = 0;
    clGetDeviceInfo(device->id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof precision, &precision, NULL);
    snprintf(options, OPTIONS_CAPACITY, "-cl-std=CL1.2%s -DWIDTH=%u -DGROUP_ITEMS=%u%s",
             precision & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT
                 ? " -cl-fp32-correctly-rounded-divide-sqrt"
                 : "",
             (unsigned)device->width, (unsigned)device->group_items,
             variant == PROGRAM_PLAIN ? " -DPLAIN" : "");
}

/* A program to be built, and the outcome, which is reported after driver_leave. */
struct building {
    struct report *report;
    struct device *device;
    const struct embedded_source *source;
    const char *name; /* the kernel's name */
    device_kernel *kernel;
    char options[OPTIONS_CAPACITY];
    const char *call; /* the last OpenCL call; NULL: none yet */
    cl_int error;
    cl_program failed; /* the program with the log; NULL: none */
    double seconds;    /* duration of the build, s; 0: not built */
};

static sonject_status tell_failure(struct report *report, const struct building *building)
{
    const struct device *device = building->device;
    size_t bytes = 0;
    clGetProgramBuildInfo(building->failed, device->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &bytes);
    char *log = allocate_array(bytes + 1, 1);
    CHECK_MEMORY(report, log, "the build log");
    if (clGetProgramBuildInfo(building->failed, device->id, CL_PROGRAM_BUILD_LOG, bytes, log,
                              NULL) != CL_SUCCESS)
        log[0] = '\0';
    /* the first error says what is wrong, warnings before it do not */
    const char *error = strstr(log, "error:");
    const char *first = error ? error : log;
    const size_t length = strcspn(first, "\n");
    const sonject_status status =
        report_failure(report, SONJECT_ERROR_DEVICE, "device '%s' cannot build %s: %s: %.*s%s",
                       device->name, building->source->name, opencl_error_name(building->error),
                       (int)(length < 511 ? length : 511), first,
                       error ? "" : ": has its cache, such as ~/.cache/pocl, room on the disk?");
    free(log);
    return status;
}

/* Returns NULL on failure: see `building`. */
static cl_program compile(struct building *building)
{
    /* LLVM removes its files at a signal, and so fails in its work. Kernels that are known to be
     * right are built again, so that the caller can stop as it does elsewhere. */
    int tries = 3;
    const struct device *device = building->device;
    building->call = "clCreateProgramWithSource";
    cl_program program = clCreateProgramWithSource(
        device->context, 1, (const char *[]){building->source->text}, NULL, &building->error);
    if (building->error != CL_SUCCESS)
        return NULL;
    do
        building->error = clBuildProgram(program, 1, &device->id, building->options, NULL, NULL);
    while (building->error == CL_BUILD_PROGRAM_FAILURE && --tries > 0);
    if (building->error == CL_SUCCESS)
        return program;
    building->failed = program;
    return NULL;
}

static cl_program find_kept(const struct building *building)
{
    const struct shared_device *shared = building->device->shared;
    for (size_t i = 0; i < shared->program_count; i++)
        if (shared->programs[i].source == building->source &&
            strcmp(shared->programs[i].options, building->options) == 0)
            return shared->programs[i].program;
    return NULL;
}

/* Builds the program, which the device keeps, in place of the last one if there is no room. Returns
 * NULL on failure: see `building`. */
static cl_program build(struct building *building)
{
    struct shared_device *shared = building->device->shared;
    const double start = clock_seconds();
    struct kept_program kept = {compile(building), building->source, {0}};
    if (!kept.program)
        return NULL;
    building->seconds = clock_seconds() - start;
    memcpy(kept.options, building->options, sizeof kept.options);
    if (shared->program_count == PROGRAMS_KEPT)
        clReleaseProgram(shared->programs[--shared->program_count].program);
    shared->programs[shared->program_count++] = kept;
    return kept.program;
}

/* Makes the kernel. Does nothing if the program must be built and builds is false. */
static void make_kernel(struct building *building, bool builds)
{
    if (driver_enter(building->report) != SONJECT_OK)
        return;
    cl_program program = find_kept(building);
    if (!program && builds)
        program = build(building);
    if (program) {
        building->call = "clCreateKernel";
        *building->kernel = clCreateKernel(program, building->name, &building->error);
    }
    driver_leave();
}

static void build_kernel(void *building)
{
    make_kernel(building, true);
}

sonject_status opencl_kernel_create(struct report *report, struct device *device,
                                    enum device_program program, enum program_variant variant,
                                    const char *name, device_kernel *kernel)
{
    struct building building = {.report = report,
                                .device = device,
                                .source = &embedded_sources[program],
                                .name = name,
                                .kernel = kernel,
                                .error = CL_SUCCESS};
    program_options(device, variant, building.options);
    CHECK(driver_claim(report));
    make_kernel(&building, false);
    const sonject_status waited =
        building.call ? SONJECT_OK : wait_for_compiler(report, build_kernel, &building);
    if (building.seconds > 0.0) {
        report_log(report, "%s built in %.1f s", building.source->name, building.seconds);
        device->fresh = *kernel;
    }
    if (building.failed) {
        const sonject_status status = tell_failure(report, &building);
        clReleaseProgram(building.failed);
        return status;
    }
    if (building.error != CL_SUCCESS)
        *kernel = NULL;
    CHECK(opencl_answer(report, device, building.call, building.error));
    if (waited != SONJECT_OK)
        kernel_release(device, kernel);
    return waited;
}
