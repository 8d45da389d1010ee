/* The kernels' own functions compiled as native C with 16 SIMD lanes, for comparison. */
#ifndef SONJECT_TESTS_NATIVE_KERNEL_H
#define SONJECT_TESTS_NATIVE_KERNEL_H

#include <stdint.h>

struct chain_record;
struct fan_record;
struct object_record;
struct outcome_record;
struct sphere_record;

/* As trace_rough_strip and trace_smooth_strip, over the strips [first, last) of the launch. */
void native_trace_rough(const struct fan_record *fan, const struct object_record *objects,
                        const float *map, int64_t *seabed, int64_t *tiles, int first, int last,
                        struct outcome_record *outcomes);
void native_trace_smooth(const struct fan_record *fan, const struct object_record *objects,
                         int64_t *tally, int first, int last, struct outcome_record *outcomes);
/* As trace_chains_strip; several threads must not share tallies. */
void native_trace_chains(const struct fan_record *fan, const struct chain_record *chains,
                         const struct object_record *objects, const struct sphere_record *spheres,
                         int64_t *tallies, int first, int last, struct outcome_record *outcomes);

#endif
