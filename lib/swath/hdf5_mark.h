/* Whether a file is HDF5, without HDF5. */
#ifndef SONJECT_IO_HDF5_MARK_H
#define SONJECT_IO_HDF5_MARK_H

#include "base/byte_file.h"

/* True if the mark stands at byte 0, or at 512, 1024, 2048, ..., behind a user's block. */
bool hdf5_mark_is_in(const char *path);

#endif
