/* Entry point like that of trace_rough.cl, in a program of its own: compiling it takes long, and
 * few scenes have boundaries. */
#include "trace_rough_images.h"

TRACE_KERNEL(trace_rough_images, trace_rough_images_strip(&trace))
