#define WIDTH          16
#define WITHOUT_MESHES /* as the device builds them for these scenes */
#define WITHOUT_RELIEF
#define WITHOUT_ASPECTS
#define WITHOUT_FOULING
#include "kernels/trace_chains.h"
#include "kernels/trace_rough.h"
#include "kernels/trace_smooth.h"

#include "native_kernel.h"

#define OVER_STRIPS(name, outcome)                                                                 \
    void name(const struct fan_record *fan, void *const *buffers, uint32_t first, uint32_t last,   \
              struct outcome_record *outcomes)                                                     \
    {                                                                                              \
        for (int strip = (int)first; strip < (int)last; strip++)                                   \
            for (int segment = 0; segment < fan->segments; segment++)                              \
                outcomes[strip] = outcome;                                                         \
    }

OVER_STRIPS(native_trace_rough, trace_rough_strip(fan, NULL, buffers[0], buffers[1], buffers[2],
                                                  buffers[3], buffers[4], strip, segment))
OVER_STRIPS(native_trace_smooth,
            trace_smooth_strip(fan, NULL, buffers[0], buffers[1], strip, segment))
OVER_STRIPS(native_trace_chains, trace_chains_strip(fan, NULL, buffers[0], buffers[1], buffers[2],
                                                    buffers[3], buffers[4], strip, segment))
