#include "elements/speckle.h"

#include "cl/launch.h"
#include "cl/program.h"

/* Buffers and the kernel of a drawing. */
struct drawing {
    cl_mem energy, real_part, imaginary_part;
    cl_kernel kernel;
};

static sonject_status drawing_run(struct drawing *drawing, struct report *report,
                                  struct device *device, struct span bins, struct span strips,
                                  uint64_t seed, uint32_t stream)
{
    const cl_int bin_count = bins.count;
    const cl_int first_bin = bins.first;
    const cl_int first_strip = strips.first;
    const cl_uint seed_low = (cl_uint)(seed & 0xffffffffu);
    const cl_uint seed_high = (cl_uint)(seed >> 32);
    const cl_uint stream_number = stream;
    const struct kernel_argument arguments[] = {
        ARGUMENT(drawing->energy), ARGUMENT(bin_count),          ARGUMENT(first_bin),
        ARGUMENT(first_strip),     ARGUMENT(seed_low),           ARGUMENT(seed_high),
        ARGUMENT(stream_number),   ARGUMENT(drawing->real_part), ARGUMENT(drawing->imaginary_part)};
    const size_t global[2] = {((size_t)bins.count + device->width - 1) / device->width,
                              (size_t)strips.count};
    return kernel_run(report, device, drawing->kernel, arguments,
                      sizeof arguments / sizeof *arguments, 2, global);
}

sonject_status speckle_draw(struct report *report, struct device *device, struct span bins,
                            struct span strips, const float *energy, uint64_t seed, uint32_t stream,
                            float *real_part, float *imaginary_part)
{
    const size_t bytes = (size_t)strips.count * (size_t)bins.count * sizeof(float);
    struct drawing drawing = {NULL, NULL, NULL, NULL};
    sonject_status status =
        kernel_create(report, device, PROGRAM_IMAGE_FORMATION, 0, "draw_speckle", &drawing.kernel);
    THEN(status, buffer_create(report, device, bytes, energy, &drawing.energy));
    THEN(status, buffer_create(report, device, bytes, NULL, &drawing.real_part));
    THEN(status, buffer_create(report, device, bytes, NULL, &drawing.imaginary_part));
    THEN(status, drawing_run(&drawing, report, device, bins, strips, seed, stream));
    THEN(status, buffer_read(report, device, drawing.real_part, 0, bytes, real_part));
    THEN(status, buffer_read(report, device, drawing.imaginary_part, 0, bytes, imaginary_part));
    if (drawing.kernel)
        clReleaseKernel(drawing.kernel);
    buffer_release(&drawing.energy);
    buffer_release(&drawing.real_part);
    buffer_release(&drawing.imaginary_part);
    return status;
}
