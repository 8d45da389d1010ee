/* Entry point of the incoherent part beyond the first interaction. */
#include "trace_chains.h"

TRACE_KERNEL(trace_chains, trace_chains_strip(&trace))
