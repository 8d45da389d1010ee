/* Values in HDF5 files. Each call says whether it succeeded, and trusts nothing that it reads. HDF5
 * keeps global state, so calls must be between hdf5_enter and hdf5_leave, which do nothing in
 * builds without HDF5. */
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

/* The state between hdf5_enter and hdf5_leave. hdf5_enter waits until no other thread is there, and
 * keeps HDF5 from printing. The first call also asks HDF5, if unused before, not to tidy up when
 * the program ends. Tidying up crashes if a full disk kept HDF5 from closing a file. */
struct hdf5_session {
    H5E_auto2_t print;
    void *print_data;
};
void hdf5_enter(struct hdf5_session *session);
void hdf5_leave(const struct hdf5_session *session);

/* Lets a file be closed that cannot be written: HDF5's further writes to the file are lost. */
void hdf5_abandon(hid_t file);

/* Writes a text attribute. */
bool hdf5_write_text(hid_t object, const char *name, const char *text);

#endif

#endif
