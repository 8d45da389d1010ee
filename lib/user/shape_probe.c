#include "user/shape_probe.h"

#include <string.h>

#include "cl/launch.h"
#include "user/user_program.h"

sonject_status shape_probe_begin(struct shape_probe *probe, struct report *report,
                                 struct device *device, const struct user_shapes *shapes,
                                 uint32_t number)
{
    const struct user_record record = user_record_of(&shapes->shapes[number]);
    memset(probe, 0, sizeof *probe);
    probe->report = report;
    probe->device = device;
    sonject_status status =
        user_kernel_create(report, device, shapes, false, PROGRAM_PROBE_USER_SHAPE,
                           "probe_user_shape", &probe->kernel);
    THEN(status, buffer_create(report, device, sizeof record, &record, &probe->shape));
    if (status != SONJECT_OK)
        shape_probe_end(probe);
    return status;
}

void shape_probe_end(struct shape_probe *probe)
{
    if (probe->kernel)
        clReleaseKernel(probe->kernel);
    probe->kernel = NULL;
    buffer_release(&probe->shape);
}

sonject_status shape_probe_ask(struct shape_probe *probe, const struct probe_ray *rays,
                               struct probe_hit *hits, size_t count)
{
    struct report *report = probe->report;
    struct device *device = probe->device;
    cl_mem ray_buffer = NULL;
    cl_mem hit_buffer = NULL;
    if (count == 0)
        return SONJECT_OK;
    sonject_status status = buffer_create(report, device, count * sizeof *rays, rays, &ray_buffer);
    THEN(status, buffer_create(report, device, count * sizeof *hits, NULL, &hit_buffer));
    if (status == SONJECT_OK) {
        const struct kernel_argument arguments[] = {{sizeof probe->shape, &probe->shape},
                                                    {sizeof ray_buffer, &ray_buffer},
                                                    {sizeof hit_buffer, &hit_buffer}};
        status = kernel_run(report, device, probe->kernel, arguments, 3, 1, &count);
    }
    THEN(status, buffer_read(report, device, hit_buffer, 0, count * sizeof *hits, hits));
    buffer_release(&ray_buffer);
    buffer_release(&hit_buffer);
    return status;
}
