#include "probe_device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/file.h"
#include "base/report.h"
#include "base/system/process.h"
#include "kernel/mesh_probe.h"

static void require(const struct report *report, int is_well, const char *what)
{
    if (is_well)
        return;
    fprintf(stderr, "%s: %s\n", what, report->message);
    abort();
}

static device_buffer upload(struct probe_device *probe, const void *contents, size_t count,
                            size_t size)
{
    device_buffer buffer;
    require(probe->report,
            buffer_create(probe->report, probe->device, contents ? count * size : 1,
                          contents ? contents : "", &buffer) == SONJECT_OK,
            "buffer");
    return buffer;
}

static void build(struct probe_device *probe)
{
    char options[1024];
    char *source;
    cl_device_fp_config precision = 0;
    size_t bytes;
    cl_int error;
    require(probe->report,
            file_read_whole(probe->report, SOURCE_ROOT "/tests/kernel/mesh_probe.cl", 1 << 20,
                            &source, &bytes) == SONJECT_OK,
            "source");
    probe->program = clCreateProgramWithSource(probe->device->context, 1, (const char *[]){source},
                                               &bytes, &error);
    free(source);
    require(probe->report, error == CL_SUCCESS, "program");
    clGetDeviceInfo(probe->device->id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof precision, &precision,
                    NULL);
    snprintf(options, sizeof options, "-cl-std=CL1.2 -DWIDTH=%u -I%s/kernels -I%s/tests/kernel%s",
             probe->width, SOURCE_ROOT, SOURCE_ROOT,
             precision & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT
                 ? " -cl-fp32-correctly-rounded-divide-sqrt"
                 : "");
    error = clBuildProgram(probe->program, 1, &probe->device->id, options, NULL, NULL);
    if (error != CL_SUCCESS) {
        static char log[8192];
        clGetProgramBuildInfo(probe->program, probe->device->id, CL_PROGRAM_BUILD_LOG, sizeof log,
                              log, NULL);
        fprintf(stderr, "%s\n", log);
        abort();
    }
}

void probe_device_begin(struct probe_device *probe, struct report *report, struct device *device,
                        unsigned width, const struct mesh *mesh)
{
    const struct mesh_record record = mesh_record_of(mesh, 0, 0, 0);
    const struct mesh_hierarchy *hierarchy = &mesh->hierarchy;
    memset(probe, 0, sizeof *probe);
    probe->report = report;
    probe->device = device;
    probe->width = width;
    build(probe);
    probe->record = upload(probe, &record, 1, sizeof record);
    probe->branches =
        upload(probe, hierarchy->branches, hierarchy->branch_count, sizeof *hierarchy->branches);
    probe->leaves =
        upload(probe, hierarchy->leaves, hierarchy->leaf_count, sizeof *hierarchy->leaves);
    probe->normals =
        upload(probe, mesh->normals, hierarchy->leaf_count * MESH_SLOTS, sizeof *mesh->normals);
}

void probe_device_end(struct probe_device *probe)
{
    buffer_release(probe->device, &probe->record);
    buffer_release(probe->device, &probe->branches);
    buffer_release(probe->device, &probe->leaves);
    buffer_release(probe->device, &probe->normals);
    clReleaseProgram(probe->program);
}

static double seconds_of(const struct device *device)
{
    return device->is_cpu ? (double)clock() / CLOCKS_PER_SEC / device->compute_units
                          : clock_seconds();
}

double probe_device_run(struct probe_device *probe, const char *name, const float *input,
                        float *output, uint32_t rays, int repeats)
{
    cl_int error;
    const size_t bytes = PROBE_OUTPUTS * (size_t)rays * sizeof *output;
    const size_t global = rays / probe->width;
    double best = 1e9;
    cl_kernel kernel = clCreateKernel(probe->program, name, &error);
    require(probe->report, error == CL_SUCCESS, name);
    device_buffer from = upload(probe, input, PROBE_INPUTS * (size_t)rays, sizeof *input);
    device_buffer to = upload(probe, output, PROBE_OUTPUTS * (size_t)rays, sizeof *output);
    const struct kernel_argument arguments[] = {ARGUMENT(probe->record), ARGUMENT(probe->branches),
                                                ARGUMENT(probe->leaves), ARGUMENT(probe->normals),
                                                ARGUMENT(from),          ARGUMENT(to),
                                                ARGUMENT(rays)};
    for (int i = 0; i < repeats; i++) {
        const double start = seconds_of(probe->device);
        require(probe->report,
                kernel_run(probe->report, probe->device, kernel, arguments, 7, 1, &global) ==
                    SONJECT_OK,
                name);
        const double taken = seconds_of(probe->device) - start;
        best = taken < best ? taken : best;
    }
    require(probe->report,
            buffer_read(probe->report, probe->device, to, 0, bytes, output) == SONJECT_OK, "read");
    buffer_release(probe->device, &from);
    buffer_release(probe->device, &to);
    clReleaseKernel(kernel);
    return best;
}
