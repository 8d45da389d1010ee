/* Tallies in 64-bit fixed point: integer sums do not depend on their order, so neither do images.
 */
#ifndef SONJECT_KERNELS_TALLY_H
#define SONJECT_KERNELS_TALLY_H

#include "layout.h"
#include "width.h"

#ifdef __OPENCL_C_VERSION__
#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
#endif

/* A value this large is a fault of scaling: 2^12 of them would still fit. */
#define QUANTA_LIMIT 2251799813685248.0f /* 2^51 */

/* Whether quanta can be counted; reports what cannot. */
FUNCTION int is_countable(float quanta, RECORD_WORD *faults)
{
    if (quanta != quanta)
        *faults |= FAULT_NOT_A_NUMBER;
    else if (quanta > QUANTA_LIMIT || quanta < -QUANTA_LIMIT)
        *faults |= FAULT_OVERFLOW;
    else
        return 1;
    return 0;
}

/* Whole quanta, those below or above by chance, so that the mean of what is counted is exact
 * however little each path brings. chance: uniform in 0...1, of the path's own. */
FUNCTION TALLY whole_quanta(float quanta, float chance)
{
    const TALLY count = (TALLY)quanta; /* towards zero */
    const float rest = quanta - (float)count;
    return count + (chance < rest) - (chance < -rest);
}

/* Adds quanta to a tally that other work-items may add to at the same time. */
FUNCTION void tally_add_shared(GLOBAL TALLY *tally, float quanta, float chance, RECORD_WORD *faults)
{
    if (!is_countable(quanta, faults))
        return;
#ifdef __OPENCL_C_VERSION__
    atom_add((volatile GLOBAL TALLY *)tally, whole_quanta(quanta, chance));
#else
    *tally += whole_quanta(quanta, chance);
#endif
}

/* Adds quanta to a tally of which this work-item's segments are the only owners: work-items share
 * a strip where TALLY_IS_SHARED. */
FUNCTION void tally_add(GLOBAL TALLY *tally, float quanta, float chance, RECORD_WORD *faults)
{
#if defined(TALLY_IS_SHARED)
    tally_add_shared(tally, quanta, chance, faults);
#else
    if (is_countable(quanta, faults))
        *tally += whole_quanta(quanta, chance);
#endif
}

#endif
