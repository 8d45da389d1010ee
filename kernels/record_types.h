/* Types of the members that host and device share. */
#ifndef SONJECT_KERNELS_RECORD_TYPES_H
#define SONJECT_KERNELS_RECORD_TYPES_H

#ifdef __OPENCL_C_VERSION__
#define RECORD_INT  int
#define RECORD_WORD uint
#define TALLY       long
#else
#include <stdint.h>
#define RECORD_INT  int32_t
#define RECORD_WORD uint32_t
#define TALLY       int64_t
#endif

#endif
