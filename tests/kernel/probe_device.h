/* The probe of meshes (mesh_probe.cl) on an OpenCL device. Failures end the program. */
#ifndef SONJECT_TESTS_PROBE_DEVICE_H
#define SONJECT_TESTS_PROBE_DEVICE_H

#include "device/opencl/opencl.h"
#include "mesh/mesh.h"

struct probe_device {
    struct report *report;
    struct device *device;
    unsigned width;
    cl_program program;
    device_buffer record, branches, leaves, normals;
};

/* Builds the probe for `width` lanes and loads the mesh. */
void probe_device_begin(struct probe_device *probe, struct report *report, struct device *device,
                        unsigned width, const struct mesh *mesh);
void probe_device_end(struct probe_device *probe);

/* Runs "nearest", "blocked" or "surface" over `rays` rays (a multiple of the width). input has
 * PROBE_INPUTS planes. output, PROBE_OUTPUTS planes, is read and written. Returns the best of
 * `repeats` times, s: for CPUs processor time over cores, as other programs may run too. */
double probe_device_run(struct probe_device *probe, const char *kernel, const float *input,
                        float *output, uint32_t rays, int repeats);

#endif
