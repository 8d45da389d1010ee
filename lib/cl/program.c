#include "cl/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/clock.h"
#include "base/memory.h"
#include "cl/cache.h"
#include "cl/sources.h"

static bool divides_correctly(const struct device *device)
{
    cl_device_fp_config precision = 0;
    clGetDeviceInfo(device->id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof precision, &precision, NULL);
    return (precision & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
}

/* No fast-math of any kind; correctly rounded division where the compiler has to be told. A CPU's
 * work-items own their tallies; a GPU's share them. */
void program_options(const struct device *device, uint32_t variant, const char *more,
                     char options[PROGRAM_OPTIONS_CAPACITY])
{
    snprintf(options, PROGRAM_OPTIONS_CAPACITY, "-cl-std=CL1.2 -DWIDTH=%u%s%s%s%s%s%s",
             (unsigned)device->width, variant & PROGRAM_WITH_MESHES ? " -DWITH_MESHES" : "",
             variant & PROGRAM_WITH_RELIEF ? " -DWITH_RELIEF" : "",
             variant & PROGRAM_WITH_ASPECTS ? " -DWITH_ASPECTS" : "",
             device->is_cpu ? "" : " -DTALLY_IS_SHARED",
             divides_correctly(device) ? " -cl-fp32-correctly-rounded-divide-sqrt" : "", more);
}

sonject_status program_key(struct report *report, const struct device *device,
                           const struct program_text *text, char key[HASH_TEXT_CAPACITY])
{
    struct hash *hash = hash_begin();
    if (!hash)
        return report_out_of_memory(report, "the program cache");
    hash_add_text(hash, sonject_version());
    for (size_t i = 0; i < text->count; i++)
        hash_add_text(hash, text->pieces[i]);
    hash_add_text(hash, text->options);
    hash_add_text(hash, device->name);
    hash_add_text(hash, device->platform);
    hash_add_text(hash, device->driver);
    hash_end(hash, key);
    return SONJECT_OK;
}

static sonject_status explain(struct report *report, const struct device *device,
                              const struct program_text *text, const char *whole, cl_int error)
{
    char log[512];
    /* the first error says what is wrong, warnings before it do not */
    const char *first = strstr(whole, "error:");
    snprintf(log, sizeof log, "%s", first ? first : whole);
    log[strcspn(log, "\n")] = '\0';
    return report_failure(report, SONJECT_ERROR_DEVICE, "device '%s' cannot build %s: %s: %s",
                          device->name, text->name, cl_error_name(error), log);
}

static sonject_status build_failure(struct report *report, const struct device *device,
                                    const struct program_text *text, cl_program program,
                                    cl_int error)
{
    size_t bytes = 0;
    clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &bytes);
    char *log = allocate_array(bytes + 1, 1);
    if (!log)
        return report_out_of_memory(report, "the build log");
    if (clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, bytes, log, NULL) !=
        CL_SUCCESS)
        log[0] = '\0';
    const sonject_status status = text->explain && error == CL_BUILD_PROGRAM_FAILURE
                                      ? text->explain(report, device, text, log)
                                      : explain(report, device, text, log, error);
    free(log);
    return status;
}

/* The program from the cache, NULL if there is none that the device accepts. */
static cl_program from_cache(struct device *device, const char *key, const char *options)
{
    unsigned char *bytes;
    size_t count;
    if (!device->cache_folder || !cache_read(device->cache_folder, key, &bytes, &count))
        return NULL;
    cl_int error = CL_SUCCESS;
    cl_int accepted = CL_SUCCESS;
    const unsigned char *binary = bytes;
    cl_program program = clCreateProgramWithBinary(device->context, 1, &device->id, &count, &binary,
                                                   &accepted, &error);
    free(bytes);
    if (error != CL_SUCCESS)
        return NULL;
    if (accepted != CL_SUCCESS ||
        clBuildProgram(program, 1, &device->id, options, NULL, NULL) != CL_SUCCESS) {
        clReleaseProgram(program);
        return NULL;
    }
    return program;
}

static void into_cache(struct device *device, const char *key, cl_program program)
{
    size_t count = 0;
    if (!device->cache_folder ||
        clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof count, &count, NULL) !=
            CL_SUCCESS ||
        count == 0)
        return;
    unsigned char *bytes = allocate_array(count, 1);
    if (bytes &&
        clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof bytes, &bytes, NULL) == CL_SUCCESS)
        cache_write(device->cache_folder, key, bytes, count);
    free(bytes);
}

static sonject_status build(struct report *report, struct device *device,
                            const struct program_text *text, cl_program *out)
{
    cl_int error = CL_SUCCESS;
    cl_program program = clCreateProgramWithSource(device->context, (cl_uint)text->count,
                                                   (const char **)text->pieces, NULL, &error);
    if (error != CL_SUCCESS)
        return device_failure(report, device, "clCreateProgramWithSource", error);
    error = clBuildProgram(program, 1, &device->id, text->options, NULL, NULL);
    if (error != CL_SUCCESS) {
        const sonject_status status = build_failure(report, device, text, program, error);
        clReleaseProgram(program);
        return status;
    }
    *out = program;
    return SONJECT_OK;
}

sonject_status program_make(struct report *report, struct device *device,
                            const struct program_text *text, const char *key, cl_program *out)
{
    *out = from_cache(device, key, text->options);
    if (*out) {
        report_news(report, "%s taken from the cache", text->name);
        return SONJECT_OK;
    }
    const double start = clock_seconds();
    const sonject_status status = build(report, device, text, out);
    if (status != SONJECT_OK)
        return status;
    report_news(report, "%s built in %.1f s", text->name, clock_seconds() - start);
    into_cache(device, key, *out);
    return SONJECT_OK;
}

sonject_status program_get(struct report *report, struct device *device, enum device_program number,
                           uint32_t variant, cl_program *out)
{
    cl_program *program = &device->programs[number][variant];
    if (!*program) {
        const char *const pieces[] = {embedded_sources[number].text};
        char options[PROGRAM_OPTIONS_CAPACITY];
        char key[HASH_TEXT_CAPACITY];
        program_options(device, variant, "", options);
        const struct program_text text = {
            embedded_sources[number].name, pieces, 1, options, NULL, NULL};
        sonject_status status = program_key(report, device, &text, key);
        if (status == SONJECT_OK)
            status = program_make(report, device, &text, key, program);
        if (status != SONJECT_OK)
            return status;
    }
    *out = *program;
    return SONJECT_OK;
}

sonject_status program_kernel(struct report *report, const struct device *device,
                              cl_program program, const char *name, cl_kernel *kernel)
{
    cl_int error = CL_SUCCESS;
    *kernel = clCreateKernel(program, name, &error);
    if (error == CL_SUCCESS)
        return SONJECT_OK;
    *kernel = NULL;
    return device_failure(report, device, "clCreateKernel", error);
}

sonject_status kernel_create(struct report *report, struct device *device,
                             enum device_program number, uint32_t variant, const char *name,
                             cl_kernel *kernel)
{
    cl_program program;
    *kernel = NULL;
    const sonject_status status = program_get(report, device, number, variant, &program);
    return status == SONJECT_OK ? program_kernel(report, device, program, name, kernel) : status;
}
