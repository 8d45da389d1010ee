#include "cl/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "cl/sources.h"

static bool divides_correctly(const struct device *device)
{
    cl_device_fp_config precision = 0;
    clGetDeviceInfo(device->id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof precision, &precision, NULL);
    return (precision & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
}

/* No fast-math of any kind; correctly rounded division where the compiler has to be told. */
static void language_options(const struct device *device, char options[PROGRAM_OPTIONS_CAPACITY])
{
    snprintf(options, PROGRAM_OPTIONS_CAPACITY, "-cl-std=CL1.2%s",
             divides_correctly(device) ? " -cl-fp32-correctly-rounded-divide-sqrt" : "");
}

/* A CPU's work-items own their tallies; a GPU's share them. */
void program_options(const struct device *device, uint32_t variant, const char *more,
                     char options[PROGRAM_OPTIONS_CAPACITY])
{
    language_options(device, options);
    const size_t length = strlen(options);
    snprintf(options + length, PROGRAM_OPTIONS_CAPACITY - length, " -DWIDTH=%u%s%s%s%s%s",
             (unsigned)device->width, variant & PROGRAM_WITH_MESHES ? " -DWITH_MESHES" : "",
             variant & PROGRAM_WITH_RELIEF ? " -DWITH_RELIEF" : "",
             variant & PROGRAM_WITH_ASPECTS ? " -DWITH_ASPECTS" : "",
             device->is_cpu ? "" : " -DTALLY_IS_SHARED", more);
}

/* Digits that stand for what a program is made of, on its device; the source is its name's. */
static sonject_status program_key(struct report *report, const struct program_text *text,
                                  char key[HASH_TEXT_CAPACITY])
{
    struct hash *hash = hash_begin();
    if (!hash)
        return report_out_of_memory(report, "the name of a program");
    hash_add_text(hash, text->name);
    hash_add_text(hash, text->options);
    for (size_t i = 0; i < text->unit_count; i++)
        hash_add_text(hash, text->units[i]);
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
    return report_failure(report, SONJECT_ERROR_DEVICE, "device '%s' cannot build %s: %s: %s%s",
                          device->name, text->name, cl_error_name(error), log,
                          first ? "" : ": has its cache, such as ~/.cache/pocl, room on the disk?");
}

/* What came of building a program, to be told when the driver is left. */
struct building {
    const char *call; /* that failed */
    cl_int error;
    cl_program failed; /* has the log; NULL: none */
    size_t unit;       /* that did not compile; unit_count: the library's own source */
    double seconds;    /* 0: it was there */
};

static sonject_status build_failure(struct report *report, const struct device *device,
                                    const struct program_text *text,
                                    const struct building *building)
{
    size_t bytes = 0;
    clGetProgramBuildInfo(building->failed, device->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &bytes);
    char *log = allocate_array(bytes + 1, 1);
    if (!log)
        return report_out_of_memory(report, "the build log");
    if (clGetProgramBuildInfo(building->failed, device->id, CL_PROGRAM_BUILD_LOG, bytes, log,
                              NULL) != CL_SUCCESS)
        log[0] = '\0';
    const sonject_status status =
        building->unit < text->unit_count && building->error == CL_COMPILE_PROGRAM_FAILURE
            ? text->explain(report, device, text->user, building->unit, log)
            : explain(report, device, text, log, building->error);
    free(log);
    return status;
}

/* One translation unit, to be linked or not; NULL: see `building`. */
static cl_program compile(struct device *device, const char *const pieces[2], const char *options,
                          bool is_linked, struct building *building)
{
    /* LLVM removes its files at a signal, and so fails in what it was about. Kernels that are known
     * to be right are built again, for the caller to stop as it does elsewhere. */
    int tries = is_linked ? 1 : 3;
    building->call = "clCreateProgramWithSource";
    cl_program program = clCreateProgramWithSource(device->context, pieces[1] ? 2 : 1,
                                                   (const char **)pieces, NULL, &building->error);
    if (building->error != CL_SUCCESS)
        return NULL;
    do
        building->error = is_linked ? clCompileProgram(program, 1, &device->id, options, 0, NULL,
                                                       NULL, NULL, NULL)
                                    : clBuildProgram(program, 1, &device->id, options, NULL, NULL);
    while (building->error == CL_BUILD_PROGRAM_FAILURE && --tries > 0);
    if (building->error == CL_SUCCESS)
        return program;
    building->failed = program;
    return NULL;
}

/* The source with all units; NULL: see `building`. */
static cl_program compile_and_link(struct device *device, const struct program_text *text,
                                   struct building *building)
{
    cl_program programs[1 + PROGRAM_UNITS_MAX];
    cl_program linked = NULL;
    char options[PROGRAM_OPTIONS_CAPACITY];
    cl_uint count = 0;
    language_options(device, options);
    for (; count < text->unit_count; count++) {
        building->unit = count;
        programs[count] =
            compile(device, (const char *const[2]){text->units[count]}, options, true, building);
        if (!programs[count])
            break;
    }
    if (count == text->unit_count) {
        building->unit = count;
        programs[count] = compile(device, (const char *const[2]){text->source, text->calls},
                                  text->options, true, building);
        count += programs[count] != NULL;
    }
    if (count > text->unit_count) {
        building->call = "clLinkProgram, which users' shapes need,";
        linked = clLinkProgram(device->context, 1, &device->id, "", count, programs, NULL, NULL,
                               &building->error);
        if (building->error != CL_SUCCESS) {
            building->failed = linked;
            linked = NULL;
        }
    }
    while (count > 0)
        clReleaseProgram(programs[--count]);
    return linked;
}

/* The program stays the device's; NULL: see `building`. */
static cl_program find_or_build(struct device *device, const struct program_text *text,
                                const char *key, struct building *building)
{
    cl_program program = shared_program_find(device->shared, key);
    if (program)
        return program;
    const double start = clock_seconds();
    program = text->unit_count > 0 ? compile_and_link(device, text, building)
                                   : compile(device, (const char *const[2]){text->source},
                                             text->options, false, building);
    if (!program)
        return NULL;
    building->seconds = clock_seconds() - start;
    shared_program_keep(device->shared, key, program);
    return program;
}

sonject_status kernel_of_text(struct report *report, struct device *device,
                              const struct program_text *text, const char *name, cl_kernel *kernel)
{
    struct building building = {NULL, CL_SUCCESS, NULL, 0, 0.0};
    char key[HASH_TEXT_CAPACITY];
    *kernel = NULL;
    sonject_status status = program_key(report, text, key);
    THEN(status, driver_enter(report));
    if (status != SONJECT_OK)
        return status;
    cl_program program = find_or_build(device, text, key, &building);
    if (program) {
        building.call = "clCreateKernel";
        *kernel = clCreateKernel(program, name, &building.error);
    }
    driver_leave();
    if (building.seconds > 0.0)
        report_news(report, "%s built in %.1f s", text->name, building.seconds);
    if (building.failed) {
        status = build_failure(report, device, text, &building);
        clReleaseProgram(building.failed);
    } else if (building.error != CL_SUCCESS) {
        *kernel = NULL;
        status = device_failure(report, device, building.call, building.error);
    }
    return status;
}

sonject_status kernel_create(struct report *report, struct device *device,
                             enum device_program number, uint32_t variant, const char *name,
                             cl_kernel *kernel)
{
    char options[PROGRAM_OPTIONS_CAPACITY];
    program_options(device, variant, "", options);
    const struct program_text text = {.name = embedded_sources[number].name,
                                      .source = embedded_sources[number].text,
                                      .options = options};
    return kernel_of_text(report, device, &text, name, kernel);
}
