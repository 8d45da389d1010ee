/* Tallies in 64-bit fixed point: integer sums do not depend on their order, so neither do images.
 */
#ifndef SONJECT_KERNELS_TALLY_H
#define SONJECT_KERNELS_TALLY_H

#include "layout.h"
#include "width.h"

/* A value this large is a fault of scaling: 2^12 of them would still fit. */
#ifdef TALLY_IS_SHARED
#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
#endif

#define QUANTA_LIMIT 2251799813685248.0f /* 2^51 */

/* Adds quanta to a tally that other work-items may share (TALLY_IS_SHARED) or that is this one's
 * own. Reports what cannot be counted. */
FUNCTION void tally_add(GLOBAL TALLY *tally, float quanta, RECORD_WORD *faults)
{
    if (quanta != quanta) {
        *faults |= FAULT_NOT_A_NUMBER;
        return;
    }
    if (quanta > QUANTA_LIMIT || quanta < -QUANTA_LIMIT) {
        *faults |= FAULT_OVERFLOW;
        return;
    }
#if defined(TALLY_IS_SHARED)
    atom_add((volatile GLOBAL TALLY *)tally, (TALLY)quanta);
#else
    *tally += (TALLY)quanta;
#endif
}

#endif
