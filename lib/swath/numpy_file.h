/* Arrays in NumPy's own format (.npy, version 1.0): a header in ASCII and the numbers,
 * little-endian, the last index running fastest. */
#ifndef SONJECT_IO_NUMPY_FILE_H
#define SONJECT_IO_NUMPY_FILE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"

/* Writes count numbers of the shape, float32 or pairs as complex64. The file appears whole or not
 * at all. Errors: STORAGE, MEMORY. */
sonject_status numpy_file_write(struct report *report, const char *path, const uint64_t shape[3],
                                bool is_complex, const float *numbers);

#endif
