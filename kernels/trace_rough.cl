/* Entry point of the incoherent part at one interaction. */
#include "trace_rough.h"

TRACE_KERNEL(trace_rough, trace_rough_strip(&trace))
