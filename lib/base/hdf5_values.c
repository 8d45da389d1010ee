#include "base/hdf5_values.h"

#include <pthread.h>
#include <string.h>

#include "base/system/file_system.h"

#define TEXT_BYTES_MAX ((size_t)65535)

/* A lock, because most builds of HDF5 allow only one thread at a time. */
static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;
static bool is_begun;

void hdf5_enter(struct hdf5_session *session)
{
    pthread_mutex_lock(&one_at_a_time);
    if (!is_begun)
        H5dont_atexit();
    is_begun = true;
    session->print = NULL;
    session->print_data = NULL;
    H5Eget_auto2(H5E_DEFAULT, &session->print, &session->print_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

void hdf5_leave(const struct hdf5_session *session)
{
    H5Eset_auto2(H5E_DEFAULT, session->print, session->print_data);
    pthread_mutex_unlock(&one_at_a_time);
}

void hdf5_abandon(hid_t file)
{
    void *handle = NULL;
    if (H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) >= 0 && handle)
        descriptor_lead_nowhere(*(const int *)handle);
}

static bool write_scalar(hid_t object, const char *name, hid_t stored, hid_t native,
                         const void *value)
{
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute =
        space < 0 ? -1 : H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT);
    bool is_done = attribute >= 0 && H5Awrite(attribute, native, value) >= 0;
    if (attribute >= 0)
        is_done = H5Aclose(attribute) >= 0 && is_done;
    if (space >= 0)
        H5Sclose(space);
    return is_done;
}

/* Returns the type of texts of `bytes` bytes with their terminator; negative on failure. */
static hid_t text_type(size_t bytes)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (type >= 0 && H5Tset_size(type, bytes) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0)
        return type;
    if (type >= 0)
        H5Tclose(type);
    return -1;
}

bool hdf5_write_text(hid_t object, const char *name, const char *text)
{
    const size_t bytes = strlen(text) + 1;
    const hid_t type = bytes <= TEXT_BYTES_MAX ? text_type(bytes) : -1;
    const bool is_done = type >= 0 && write_scalar(object, name, type, type, text);
    if (type >= 0)
        H5Tclose(type);
    return is_done;
}
