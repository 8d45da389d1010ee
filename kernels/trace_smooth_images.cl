/* Entry point like that of trace_smooth.cl, in a program of its own: compiling it takes long, and
 * few scenes have boundaries. */
#include "trace_smooth.h"

TRACE_KERNEL(trace_smooth_images, trace_smooth_strip(&trace, 1))
