/* Values in HDF5 files: each call says whether it succeeded, and believes nothing of what it reads.
 * The library keeps its state in one place, so calls come between hdf5_enter and hdf5_leave, which
 * do nothing in builds without it. */
#ifndef SONJECT_BASE_HDF5_VALUES_H
#define SONJECT_BASE_HDF5_VALUES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifndef HAS_HDF5
struct hdf5_session {
    int none;
};
static inline void hdf5_enter(struct hdf5_session *session)
{
    (void)session;
}
static inline void hdf5_leave(const struct hdf5_session *session)
{
    (void)session;
}
#else
#include <hdf5.h>

/* Waits until no other thread is between them, and keeps the library from printing. The first call
 * also asks HDF5, if nothing has used it before, not to tidy up when the program ends: it crashes
 * there where a full disk kept it from closing a file. */
struct hdf5_session {
    H5E_auto2_t print;
    void *print_data;
};
void hdf5_enter(struct hdf5_session *session);
void hdf5_leave(const struct hdf5_session *session);

/* Lets a file that cannot be written be closed: what HDF5 still wants to write goes nowhere. */
void hdf5_abandon(hid_t file);

/* An attribute. */
bool hdf5_write_text(hid_t object, const char *name, const char *text);

#endif

#endif
