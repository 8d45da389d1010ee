#define _POSIX_C_SOURCE 200809L
#include "base/hdf5_values.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

#define TEXT_BYTES_MAX  ((size_t)65535)
#define TEXTS_BYTES_MAX ((size_t)1 << 24)

/* Most builds of HDF5 may be used by one thread at a time. */
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

hid_t hdf5_make_group(hid_t file, const char *path)
{
    const hid_t creation = H5Pcreate(H5P_GROUP_CREATE);
    hid_t group = -1;
    if (creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        group = H5Gcreate2(file, path, H5P_DEFAULT, creation, H5P_DEFAULT);
    if (creation >= 0)
        H5Pclose(creation);
    return group;
}

void hdf5_abandon(hid_t file)
{
    void *handle = NULL;
    const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (nowhere >= 0 && H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) >= 0 && handle)
        dup2(nowhere, *(const int *)handle);
    if (nowhere >= 0)
        close(nowhere);
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

bool hdf5_write_whole(hid_t object, const char *name, uint64_t value)
{
    return write_scalar(object, name, H5T_STD_U64LE, H5T_NATIVE_UINT64, &value);
}

bool hdf5_write_integer(hid_t object, const char *name, int64_t value)
{
    return write_scalar(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

bool hdf5_write_number(hid_t object, const char *name, double value)
{
    return write_scalar(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

/* Texts of `bytes` bytes, their terminator among them. */
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

/* An attribute of one value of a class; negative if there is none. */
static hid_t open_scalar(hid_t object, const char *name, H5T_class_t of_class)
{
    if (H5Aexists(object, name) <= 0)
        return -1;
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    const hid_t type = attribute < 0 ? -1 : H5Aget_type(attribute);
    const hid_t space = attribute < 0 ? -1 : H5Aget_space(attribute);
    const bool is_one = type >= 0 && space >= 0 && H5Tget_class(type) == of_class &&
                        H5Sget_simple_extent_npoints(space) == 1;
    if (type >= 0)
        H5Tclose(type);
    if (space >= 0)
        H5Sclose(space);
    if (is_one)
        return attribute;
    if (attribute >= 0)
        H5Aclose(attribute);
    return -1;
}

static bool read_scalar(hid_t object, const char *name, H5T_class_t of_class, hid_t native,
                        void *value)
{
    const hid_t attribute = open_scalar(object, name, of_class);
    if (attribute < 0)
        return false;
    const bool is_done = H5Aread(attribute, native, value) >= 0;
    H5Aclose(attribute);
    return is_done;
}

bool hdf5_read_whole(hid_t object, const char *name, uint64_t *value)
{
    return read_scalar(object, name, H5T_INTEGER, H5T_NATIVE_UINT64, value);
}

bool hdf5_read_integer(hid_t object, const char *name, int64_t low, int64_t high, int32_t *value)
{
    int64_t read = 0;
    if (!read_scalar(object, name, H5T_INTEGER, H5T_NATIVE_INT64, &read) || read < low ||
        read > high || low < INT32_MIN || high > INT32_MAX)
        return false;
    *value = (int32_t)read;
    return true;
}

bool hdf5_read_number(hid_t object, const char *name, double *value)
{
    return read_scalar(object, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, value);
}

/* Bytes of a text type of fixed size; 0 if it is none, or larger than limit. */
static size_t text_bytes(hid_t type, size_t limit)
{
    if (type < 0 || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0)
        return 0;
    const size_t bytes = H5Tget_size(type);
    return bytes <= limit ? bytes : 0;
}

bool hdf5_read_text(hid_t object, const char *name, char **text)
{
    *text = NULL;
    const hid_t attribute = open_scalar(object, name, H5T_STRING);
    if (attribute < 0)
        return false;
    const hid_t type = H5Aget_type(attribute);
    const size_t bytes = text_bytes(type, TEXT_BYTES_MAX);
    if (bytes > 0)
        *text = allocate_array(bytes + 1, 1);
    const bool is_done = *text && H5Aread(attribute, type, *text) >= 0;
    if (!is_done) {
        free(*text);
        *text = NULL;
    }
    if (type >= 0)
        H5Tclose(type);
    H5Aclose(attribute);
    return is_done;
}

static bool write_packed(hid_t group, const char *name, const char *packed, size_t bytes,
                         size_t count)
{
    const hsize_t extent = count;
    const hid_t type = text_type(bytes);
    const hid_t space = H5Screate_simple(1, &extent, NULL);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    hid_t set = -1;
    if (type >= 0 && space >= 0 && creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        set = H5Dcreate2(group, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    bool is_done = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed) >= 0;
    if (set >= 0)
        is_done = H5Dclose(set) >= 0 && is_done;
    if (creation >= 0)
        H5Pclose(creation);
    if (space >= 0)
        H5Sclose(space);
    if (type >= 0)
        H5Tclose(type);
    return is_done;
}

bool hdf5_write_texts(hid_t group, const char *name, const char *const *texts, size_t count)
{
    size_t bytes = 1;
    for (size_t i = 0; i < count; i++)
        bytes = strlen(texts[i]) + 1 > bytes ? strlen(texts[i]) + 1 : bytes;
    char *packed = bytes * count <= TEXTS_BYTES_MAX ? allocate_array(count, bytes) : NULL;
    if (!packed)
        return false;
    for (size_t i = 0; i < count; i++)
        memcpy(packed + i * bytes, texts[i], strlen(texts[i]));
    const bool is_done = write_packed(group, name, packed, bytes, count);
    free(packed);
    return is_done;
}

/* Takes them apart. */
static bool unpack(const char *packed, size_t bytes, size_t count, char ***texts)
{
    *texts = allocate_array(count, sizeof **texts);
    for (size_t i = 0; *texts && i < count; i++) {
        (*texts)[i] = allocate_array(bytes + 1, 1);
        if (!(*texts)[i]) {
            while (i-- > 0)
                free((*texts)[i]);
            free(*texts);
            *texts = NULL;
            return false;
        }
        memcpy((*texts)[i], packed + i * bytes, bytes);
    }
    return *texts != NULL;
}

bool hdf5_read_texts(hid_t group, const char *name, char ***texts, size_t *count)
{
    *texts = NULL;
    *count = 0;
    if (H5Lexists(group, name, H5P_DEFAULT) <= 0)
        return false;
    const hid_t set = H5Dopen2(group, name, H5P_DEFAULT);
    if (set < 0)
        return false;
    const hid_t type = H5Dget_type(set);
    const hid_t space = H5Dget_space(set);
    const hssize_t points = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    const size_t bytes = text_bytes(type, TEXTS_BYTES_MAX);
    bool is_done = false;
    if (points >= 0 && bytes > 0 && (uint64_t)points <= TEXTS_BYTES_MAX / bytes) {
        char *packed = allocate_array((size_t)points, bytes);
        is_done = packed && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed) >= 0 &&
                  unpack(packed, bytes, (size_t)points, texts);
        *count = is_done ? (size_t)points : 0;
        free(packed);
    }
    if (space >= 0)
        H5Sclose(space);
    if (type >= 0)
        H5Tclose(type);
    H5Dclose(set);
    return is_done;
}
