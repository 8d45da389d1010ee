#define WIDTH          16
#define WITHOUT_MESHES /* as the device builds them for these scenes */
#define WITHOUT_RELIEF
#define WITHOUT_ASPECTS
#include "kernels/trace_chains.h"
#include "kernels/trace_rough.h"
#include "kernels/trace_smooth.h"

#include "native_kernel.h"

void native_trace_rough(const struct fan_record *fan, const struct object_record *objects,
                        const float *map, int64_t *seabed, int64_t *tiles, int first, int last,
                        struct outcome_record *outcomes)
{
    for (int strip = first; strip < last; strip++)
        for (int segment = 0; segment < fan->segments; segment++)
            outcomes[strip] =
                trace_rough_strip(fan, NULL, objects, map, seabed, tiles, strip, segment);
}

void native_trace_smooth(const struct fan_record *fan, const struct object_record *objects,
                         int64_t *tally, int first, int last, struct outcome_record *outcomes)
{
    for (int strip = first; strip < last; strip++)
        for (int segment = 0; segment < fan->segments; segment++)
            outcomes[strip] = trace_smooth_strip(fan, NULL, objects, tally, strip, segment);
}

void native_trace_chains(const struct fan_record *fan, const struct chain_record *chains,
                         const struct object_record *objects, const struct sphere_record *spheres,
                         int64_t *tallies, int first, int last, struct outcome_record *outcomes)
{
    for (int strip = first; strip < last; strip++)
        for (int segment = 0; segment < fan->segments; segment++)
            outcomes[strip] = trace_chains_strip(fan, NULL, chains, objects, spheres, NULL, tallies,
                                                 strip, segment);
}
