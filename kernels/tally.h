/* Tallies in 64-bit fixed point. Integer sums, and so images, do not depend on the order. */
#ifndef SONJECT_KERNELS_TALLY_H
#define SONJECT_KERNELS_TALLY_H

#include "group.h"
#include "layout.h"
#include "width.h"

#ifdef __OPENCL_C_VERSION__
#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
#define ATOMIC_ADD(tally, count) atom_add((volatile GLOBAL TALLY *)(tally), count)
#else
#define ATOMIC_ADD(tally, count) __atomic_fetch_add(tally, count, __ATOMIC_RELAXED)
#endif

/* The largest value that is no fault of scaling, 2^51. A tally has room for 2^12 of them. */
#define QUANTA_LIMIT 2251799813685248.0f

/* Returns whether quanta can be counted, and reports a fault if they cannot. */
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

/* Rounds quanta to a whole number, up or down by chance. The mean of all counts is then exact,
 * however little each path brings. dither: a uniform deviate in 0...1 of the path's own. */
FUNCTION TALLY whole_quanta(float quanta, float dither)
{
    const TALLY count = (TALLY)quanta; /* rounded towards zero */
    const float rest = quanta - (float)count;
    return count + (dither < rest) - (dither < -rest);
}

/* Adds quanta to a tally. is_shared: other work-items may add to it at the same time. The items of
 * a group may always do so. */
FUNCTION void tally_add(GLOBAL TALLY *tally, int is_shared, float quanta, float dither,
                        RECORD_WORD *faults)
{
    if (!is_countable(quanta, faults))
        return;
    if (is_shared | (GROUP_ITEMS > 1))
        ATOMIC_ADD(tally, whole_quanta(quanta, dither));
    else
        *tally += whole_quanta(quanta, dither);
}

/* Shares an echo between two neighbouring bins of a line. Its energy and mean range stay the same.
 * Bins outside the line get nothing. later: the share of the second bin. */
FUNCTION void tally_shares(GLOBAL TALLY *line, int bins, int is_shared, int bin, float later,
                           float quanta, float dither, RECORD_WORD *faults)
{
    if (bin >= 0 && bin < bins)
        tally_add(&line[bin], is_shared, quanta * (1.0f - later), dither, faults);
    if (bin >= -1 && bin + 1 < bins)
        tally_add(&line[bin + 1], is_shared, quanta * later, 1.0f - dither, faults);
}

#endif
