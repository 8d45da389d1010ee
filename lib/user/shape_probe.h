/* Asks a user's shape on the device for what rays meet. */
#ifndef SONJECT_USER_SHAPE_PROBE_H
#define SONJECT_USER_SHAPE_PROBE_H

#include "cl/device.h"
#include "scene/user_shapes.h"

/* In the shape's own frame, as the kernels ask: see sonject_user_shape_params. */
struct probe_ray {
    float point[3], direction[3];
    float nearest;
    float reserved;
};

/* As the code says it. */
struct probe_hit {
    float distance;
    float normal[3]; /* 0 where the distance is not finite */
};

struct shape_probe {
    struct report *report;
    struct device *device;
    cl_kernel kernel;
    cl_mem shape;
};

/* On failure nothing is held. Errors: INPUT (code that does not compile), DEVICE, MEMORY. */
sonject_status shape_probe_begin(struct shape_probe *probe, struct report *report,
                                 struct device *device, const struct user_shapes *shapes,
                                 uint32_t number);
void shape_probe_end(struct shape_probe *probe);

/* Errors: DEVICE, MEMORY. */
sonject_status shape_probe_ask(struct shape_probe *probe, const struct probe_ray *rays,
                               struct probe_hit *hits, size_t count);

#endif
