/* Entry point of the coherent part of several smooth faces. */
#include "trace_multibounce.h"

TRACE_KERNEL(trace_multibounce, trace_multibounce_strip(&trace))
