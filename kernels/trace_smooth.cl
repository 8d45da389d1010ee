/* Entry point of the coherent part at one interaction. */
#include "trace_smooth.h"

TRACE_KERNEL(trace_smooth, trace_smooth_strip(&trace, 0))
