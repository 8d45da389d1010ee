#include "swath/hdf5_set.h"

#include <string.h>

#define DEPTH_MAX   16
#define OBJECTS_MAX 100000

static enum hdf5_number number_of(hid_t type)
{
    const size_t bytes = H5Tget_size(type);
    const H5T_class_t kind = H5Tget_class(type);
    if (kind == H5T_FLOAT && H5Tequal(type, H5T_IEEE_F64LE) + H5Tequal(type, H5T_IEEE_F64BE) > 0)
        return HDF5_FLOAT64;
    if (kind == H5T_FLOAT && H5Tequal(type, H5T_IEEE_F32LE) + H5Tequal(type, H5T_IEEE_F32BE) > 0)
        return HDF5_FLOAT32;
    if (kind != H5T_INTEGER || H5Tget_precision(type) != 8 * bytes)
        return HDF5_OTHER;
    const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
    if (bytes == 1 && !is_signed)
        return HDF5_UINT8;
    return bytes != 2 ? HDF5_OTHER : is_signed ? HDF5_INT16 : HDF5_UINT16;
}

/* Two floats of one type, r and i or real and imag. */
static bool take_compound(hid_t type, struct hdf5_set *set)
{
    static const char *const names[2][2] = {{"r", "real"}, {"i", "imag"}};
    enum hdf5_number numbers[2] = {HDF5_OTHER, HDF5_OTHER};
    if (H5Tget_nmembers(type) != 2)
        return false;
    for (unsigned k = 0; k < 2; k++) {
        char *name = H5Tget_member_name(type, k);
        const hid_t member = H5Tget_member_type(type, k);
        if (name && member >= 0 &&
            (strcmp(name, names[k][0]) == 0 || strcmp(name, names[k][1]) == 0)) {
            strcpy(set->part_names[k], name);
            numbers[k] = number_of(member);
        }
        if (member >= 0)
            H5Tclose(member);
        if (name)
            H5free_memory(name);
    }
    set->is_complex = true;
    set->number = numbers[0];
    return numbers[0] == numbers[1] && (numbers[0] == HDF5_FLOAT32 || numbers[0] == HDF5_FLOAT64);
}

static bool look_at_open(hid_t dataset, struct hdf5_set *set)
{
    const hid_t space = H5Dget_space(dataset);
    const hid_t type = H5Dget_type(dataset);
    bool is_plane = space >= 0 && type >= 0 && H5Sget_simple_extent_type(space) == H5S_SIMPLE &&
                    H5Sget_simple_extent_ndims(space) == 2 &&
                    H5Sget_simple_extent_dims(space, set->sides, NULL) == 2 && set->sides[0] > 0 &&
                    set->sides[1] > 0 && set->sides[0] < (hsize_t)1 << 31 &&
                    set->sides[1] < (hsize_t)1 << 31;
    if (is_plane) {
        set->number = number_of(type);
        if (H5Tget_class(type) == H5T_COMPOUND && !take_compound(type, set))
            set->number = HDF5_OTHER;
        set->is_matlab = H5Aexists(dataset, "MATLAB_class") > 0;
    }
    if (type >= 0)
        H5Tclose(type);
    if (space >= 0)
        H5Sclose(space);
    return is_plane;
}

/* What the data set of that path is; false if it is not one of two dimensions. */
static bool look_at(hid_t file, const char *name, struct hdf5_set *set)
{
    memset(set, 0, sizeof *set);
    set->number = HDF5_OTHER;
    if (strlen(name) >= sizeof set->name)
        return false;
    strcpy(set->name, name);
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    const bool is_plane = dataset >= 0 && look_at_open(dataset, set);
    if (dataset >= 0)
        H5Dclose(dataset);
    return is_plane;
}

bool hdf5_set_is_read(const struct hdf5_set *set)
{
    return set->number != HDF5_OTHER;
}

/* A walk through the groups, the innermost of which is at the end of the path. */
struct walk {
    hid_t file;
    struct array_list list;
    struct hdf5_set *chosen;
    char path[HDF5_NAME_MAX];
    unsigned depth, objects;
};

static void visit_group(struct walk *walk, hid_t group);

static void visit_link(struct walk *walk, hid_t group, const char *name)
{
    struct hdf5_set set;
    const size_t before = strlen(walk->path);
    H5L_info_t link;
    if (before + strlen(name) + 2 > sizeof walk->path || name[0] == '#' ||
        H5Lget_info(group, name, &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD)
        return; /* MATLAB keeps what its cells refer to under names that begin with # */
    if (before > 0)
        strcat(walk->path, "/");
    strcat(walk->path, name);
    const hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    const H5I_type_t kind = object >= 0 ? H5Iget_type(object) : H5I_BADID;
    if (kind == H5I_GROUP && walk->depth < DEPTH_MAX) {
        walk->depth++;
        visit_group(walk, object);
        walk->depth--;
    } else if (kind == H5I_DATASET && look_at(walk->file, walk->path, &set)) {
        const uint64_t rows = set.sides[set.is_matlab ? 1 : 0];
        const uint64_t columns = set.sides[set.is_matlab ? 0 : 1];
        if (array_list_add(&walk->list, walk->path, rows, columns,
                           hdf5_set_is_read(&set) && rows > 1 && columns > 1))
            *walk->chosen = set;
    }
    if (object >= 0)
        H5Oclose(object);
    walk->path[before] = '\0';
}

static void visit_group(struct walk *walk, hid_t group)
{
    H5G_info_t facts;
    char name[HDF5_NAME_MAX];
    if (H5Gget_info(group, &facts) < 0)
        return;
    for (hsize_t i = 0; i < facts.nlinks && walk->objects < OBJECTS_MAX; i++) {
        const ssize_t length = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name,
                                                  sizeof name, H5P_DEFAULT);
        walk->objects++;
        if (length > 0 && (size_t)length < sizeof name)
            visit_link(walk, group, name);
    }
}

sonject_status hdf5_set_choose(struct report *report, const char *path, hid_t file,
                               const char *wanted, struct hdf5_set *set)
{
    struct walk walk;
    memset(&walk, 0, sizeof walk);
    while (wanted && *wanted == '/')
        wanted++;
    walk.file = file;
    walk.list.wanted = wanted;
    walk.chosen = set;
    const hid_t root = H5Gopen2(file, "/", H5P_DEFAULT);
    if (root < 0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: is damaged: HDF5 cannot read it; copy it again", path);
    visit_group(&walk, root);
    H5Gclose(root);
    return array_list_check(report, path, &walk.list);
}

static sonject_status check_filters(struct report *report, const char *path, hid_t creation)
{
    const int count = H5Pget_nfilters(creation);
    for (int i = 0; i < count; i++) {
        unsigned flags = 0;
        unsigned settings = 0;
        size_t values = 0;
        char name[64] = "";
        const H5Z_filter_t filter = H5Pget_filter2(creation, (unsigned)i, &flags, &values, NULL,
                                                   sizeof name, name, &settings);
        if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE &&
            filter != H5Z_FILTER_FLETCHER32)
            return report_failure(report, SONJECT_ERROR_INPUT,
                                  "%s: its array is stored with the filter %d (%s); sonject knows "
                                  "gzip, shuffle and fletcher32: store it with these",
                                  path, (int)filter, name);
        if (H5Zfilter_avail(filter) <= 0)
            return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                                  "%s: this build of HDF5 lacks the filter %d (%s)", path,
                                  (int)filter, name);
    }
    return SONJECT_OK;
}

sonject_status hdf5_set_check_storage(struct report *report, const char *path, hid_t dataset)
{
    const hid_t creation = H5Dget_create_plist(dataset);
    const H5D_layout_t layout = creation < 0 ? H5D_LAYOUT_ERROR : H5Pget_layout(creation);
    sonject_status status = SONJECT_OK;
    if (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT)
        status =
            report_failure(report, SONJECT_ERROR_INPUT,
                           "%s: its array is put together from other ones: store it itself", path);
    else if (H5Pget_external_count(creation) > 0)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: the samples of its array lie in other files: store them in "
                                "this one",
                                path);
    else if (layout == H5D_CHUNKED)
        status = check_filters(report, path, creation);
    else if (layout == H5D_CONTIGUOUS && H5Dget_offset(dataset) == HADDR_UNDEF)
        status = report_failure(report, SONJECT_ERROR_INPUT,
                                "%s: its array was never filled: choose another file", path);
    if (creation >= 0)
        H5Pclose(creation);
    return status;
}

static hid_t plain_type(const struct hdf5_set *set)
{
    switch (set->number) {
    case HDF5_UINT8:
        return H5T_NATIVE_UINT8;
    case HDF5_UINT16:
        return H5T_NATIVE_UINT16;
    case HDF5_INT16:
        return H5T_NATIVE_INT16;
    case HDF5_FLOAT64:
        return H5T_NATIVE_DOUBLE;
    default:
        return H5T_NATIVE_FLOAT;
    }
}

hid_t hdf5_set_memory_type(const struct hdf5_set *set)
{
    const hid_t plain = plain_type(set);
    const size_t bytes = H5Tget_size(plain);
    if (!set->is_complex)
        return H5Tcopy(plain);
    const hid_t type = H5Tcreate(H5T_COMPOUND, 2 * bytes);
    if (type >= 0 && H5Tinsert(type, set->part_names[0], 0, plain) >= 0 &&
        H5Tinsert(type, set->part_names[1], bytes, plain) >= 0)
        return type;
    if (type >= 0)
        H5Tclose(type);
    return -1;
}
