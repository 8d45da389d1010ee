/* Two-dimensional data sets of HDF5 files: float64, float32, uint8, uint16, int16, or complex, a
 * compound of two equal floats r and i (h5py) or real and imag (MATLAB). Rows are the first index.
 * MATLAB v7.3, told by the attribute MATLAB_class, stores column after column, so its rows are the
 * second index. Refused: a damaged file, no such data set or several (the message lists them),
 * other types, data in other files, filters that sonject does not know or that change numbers. Soft
 * and external links are not followed. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "base/hdf5_values.h"
#include "base/memory.h"
#include "swath/image_library.h"
#include "swath/raster_file.h"
#include "swath/swath_format.h"

#define NAME_BYTES 256    /* a data set's path with its final 0 */
#define LINKS_MAX  100000 /* limit of the walk: groups may hold each other */

/* A data set and its type. */
struct data_set {
    char name[NAME_BYTES];
    hsize_t sides[2];  /* in the file's order */
    const char *fault; /* why sonject does not read it, for messages; NULL: it does */
    bool may_be_image; /* see array_list_add */
    enum stored_type number;
    bool is_complex;
    bool is_column_major;  /* stored by MATLAB: sides are columns, rows */
    char part_names[2][8]; /* names of a complex compound's parts */
};

struct hdf5_array {
    const char *path; /* for messages */
    struct data_set set;
    struct raster_layout layout;
    hid_t file, dataset;
    bool writes;
};

/* Releases any identifier. Negative ones, of failed calls, are ignored. */
static void release(hid_t id)
{
    if (id >= 0)
        H5Idec_ref(id);
}

/* Finds the type of numbers. Returns false for types that sonject does not read. */
static bool number_of(hid_t type, enum stored_type *number)
{
    const size_t bytes = H5Tget_size(type);
    const H5T_class_t kind = H5Tget_class(type);
    const bool is_double = H5Tequal(type, H5T_IEEE_F64LE) + H5Tequal(type, H5T_IEEE_F64BE) > 0;
    const bool is_single = H5Tequal(type, H5T_IEEE_F32LE) + H5Tequal(type, H5T_IEEE_F32BE) > 0;
    if (kind == H5T_FLOAT) {
        *number = is_double ? STORED_FLOAT64 : STORED_FLOAT32;
        return is_double || is_single;
    }
    const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
    *number = bytes == 1 ? STORED_UINT8 : is_signed ? STORED_INT16 : STORED_UINT16;
    return kind == H5T_INTEGER && H5Tget_precision(type) == 8 * bytes &&
           ((bytes == 1 && !is_signed) || bytes == 2);
}

/* Takes a compound of two equal floats, r and i or real and imag. Returns false for others. */
static bool take_compound(hid_t type, struct data_set *set)
{
    static const char *const names[2][2] = {{"r", "real"}, {"i", "imag"}};
    enum stored_type numbers[2] = {STORED_INT8, STORED_INT8};
    set->is_complex = true;
    for (unsigned k = 0; k < 2 && H5Tget_nmembers(type) == 2; k++) {
        char *name = H5Tget_member_name(type, k);
        const hid_t member = H5Tget_member_type(type, k);
        if (name && member >= 0 &&
            (strcmp(name, names[k][0]) == 0 || strcmp(name, names[k][1]) == 0) &&
            number_of(member, &numbers[k]))
            strcpy(set->part_names[k], name);
        release(member);
        if (name)
            H5free_memory(name);
    }
    set->number = numbers[0];
    return *set->part_names[0] && *set->part_names[1] && numbers[0] == numbers[1] &&
           numbers[0] >= STORED_FLOAT32;
}

/* MATLAB marks its variables with their class. Logical ones and text are no images. */
static bool is_of_words(hid_t dataset)
{
    char name[8] = "";
    const hid_t attribute = H5Aopen(dataset, "MATLAB_class", H5P_DEFAULT);
    const hid_t type = attribute < 0 ? -1 : H5Aget_type(attribute);
    if (type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 &&
        H5Tget_size(type) < sizeof name)
        (void)H5Aread(attribute, type, name);
    release(type);
    release(attribute);
    return strcmp(name, "logical") == 0 || strcmp(name, "char") == 0;
}

/* Finds out what sonject makes of a data set's numbers and sides. */
static void take_facts(hid_t dataset, hid_t type, int dimensions, const hsize_t *sides,
                       struct data_set *set)
{
    const H5T_class_t kind = H5Tget_class(type);
    const bool is_of_numbers =
        (kind == H5T_INTEGER || kind == H5T_FLOAT || kind == H5T_COMPOUND) && !is_of_words(dataset);
    int wide = 0;
    for (int i = 0; i < dimensions; i++)
        wide += sides[i] > 1;
    set->may_be_image = is_of_numbers && wide > 1;
    set->is_column_major = H5Aexists(dataset, "MATLAB_class") > 0;
    if (dimensions != 2)
        set->fault = "has another number of dimensions than two: save it as one of rows and "
                     "columns";
    else if (!is_of_numbers ||
             !(kind == H5T_COMPOUND ? take_compound(type, set) : number_of(type, &set->number)))
        set->fault = "is of a type that sonject does not read: save it as float64, float32, uint8, "
                     "uint16 or int16, complex ones as r and i, or real and imag, of float64 or "
                     "float32";
    memcpy(set->sides, sides, sizeof set->sides);
}

/* Finds out what a data set is. Returns false for sets without numbers. */
static bool look_at(hid_t dataset, struct data_set *set)
{
    hsize_t sides[H5S_MAX_RANK] = {0};
    memset(set, 0, sizeof *set);
    const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
    const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);
    const int dimensions =
        space < 0 || type < 0 ? -1 : H5Sget_simple_extent_dims(space, sides, NULL);
    bool is_there = dimensions > 0;
    for (int i = 0; i < dimensions; i++)
        is_there = is_there && sides[i] > 0 && sides[i] < (hsize_t)1 << 31;
    if (dimensions < 0) {
        set->may_be_image = is_there = true;
        set->fault = "cannot be opened: it is damaged, or made for a newer HDF5 than sonject's; "
                     "write it again";
    } else if (is_there) {
        take_facts(dataset, type, dimensions, sides, set);
    }
    release(type);
    release(space);
    return is_there;
}

/* A walk through all groups along hard links. */
struct walk {
    struct array_list list;
    struct data_set *chosen;
    char path[NAME_BYTES]; /* the current group's path */
    unsigned links;
};

/* Visits a link. H5Lvisit would end at a damaged group or data set; this walk passes it over. */
static herr_t visit_link(hid_t group, const char *name, const H5L_info_t *link, void *user)
{
    struct walk *walk = user;
    struct data_set set;
    const size_t end = strlen(walk->path);
    /* names that begin with # hold what MATLAB's cells refer to */
    if (link->type != H5L_TYPE_HARD || name[0] == '#' ||
        end + strlen(name) + 2 > sizeof walk->path || walk->links++ >= LINKS_MAX)
        return 0;
    sprintf(walk->path + end, "%s%s", end > 0 ? "/" : "", name);
    const hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    const H5I_type_t kind = object < 0 ? H5I_BADID : H5Iget_type(object);
    if (kind == H5I_GROUP) {
        H5Literate(object, H5_INDEX_NAME, H5_ITER_INC, NULL, visit_link, walk);
    } else if (kind != H5I_DATATYPE && look_at(object, &set)) {
        const uint64_t rows = set.fault ? 0 : set.sides[set.is_column_major];
        strcpy(set.name, walk->path);
        if (array_list_add(&walk->list, set.name, rows, set.sides[!set.is_column_major],
                           set.may_be_image))
            *walk->chosen = set;
    }
    release(object);
    walk->path[end] = '\0';
    return 0;
}

/* Looks at the file's data sets and keeps the one that is wanted. */
static sonject_status choose_set(struct report *report, struct hdf5_array *array,
                                 const char *wanted)
{
    struct walk walk = {.chosen = &array->set};
    while (wanted && *wanted == '/')
        wanted++;
    walk.list.wanted = wanted;
    if (H5Literate(array->file, H5_INDEX_NAME, H5_ITER_INC, NULL, visit_link, &walk) < 0 &&
        walk.list.matches == 0)
        return input_failure(report, array->path, "is damaged: HDF5 cannot read it; copy it again");
    CHECK(array_list_check(report, array->path, &walk.list));
    return array->set.fault ? input_failure(report, array->path, "the array %s %s", array->set.name,
                                            array->set.fault)
                            : SONJECT_OK;
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
            return input_failure(report, path,
                                 "its array is stored with the filter %d (%s); sonject knows gzip, "
                                 "shuffle and fletcher32: store it with these",
                                 (int)filter, name);
        if (H5Zfilter_avail(filter) <= 0)
            return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                                  "%s: this build of HDF5 lacks the filter %d (%s)", path,
                                  (int)filter, name);
    }
    return SONJECT_OK;
}

static sonject_status check_storage(struct report *report, const struct hdf5_array *array,
                                    hid_t creation)
{
    const char *path = array->path;
    const H5D_layout_t layout = creation < 0 ? H5D_LAYOUT_ERROR : H5Pget_layout(creation);
    if (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT)
        return input_failure(report, path,
                             "its array is put together from other ones: store it itself");
    if (H5Pget_external_count(creation) > 0)
        return input_failure(report, path,
                             "the samples of its array lie in other files: store them in this one");
    if (layout == H5D_CONTIGUOUS && H5Dget_offset(array->dataset) == HADDR_UNDEF)
        return input_failure(report, path, "its array was never filled: choose another file");
    return layout == H5D_CHUNKED ? check_filters(report, path, creation) : SONJECT_OK;
}

/* Reports why samples could not be moved. errno, which must be 0 before, tells failures of the disk
 * and limits of memory from faults of the file. */
static sonject_status cannot_move(struct report *report, const struct hdf5_array *array)
{
    const int error = errno;
    if (error == ENOMEM)
        return input_failure(report, array->path,
                             "reading its array takes more memory than a sound one in chunks of "
                             "some megabytes would: store it again");
    if (error == ENOSPC || error == EDQUOT || error == EFBIG || file_error_is_of_system(error))
        return file_failure(report, array->path, array->writes ? "copy" : "read", error);
    return input_failure(report, array->path, "its array is cut short or damaged: copy it again");
}

/* Adds an attribute to the description if it is one of sonject's and a single text. */
static herr_t add_attribute(hid_t dataset, const char *name, const H5A_info_t *info, void *text)
{
    const hid_t attribute =
        strncmp(name, "sonject:", 8) == 0 ? H5Aopen(dataset, name, H5P_DEFAULT) : -1;
    const hid_t type = attribute < 0 ? -1 : H5Aget_type(attribute);
    const bool is_text =
        type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
    const size_t bytes = is_text ? H5Tget_size(type) : 0;
    char *value = bytes > 0 && bytes < DESCRIPTION_MAX && info->data_size == bytes
                      ? allocate_array(bytes + 1, 1)
                      : NULL;
    if (value && H5Aread(attribute, type, value) >= 0)
        growing_text_add(text, "%s=%s\n", name, value);
    free(value);
    release(type);
    release(attribute);
    return 0;
}

static sonject_status open_image(struct report *report, const char *name, const char *path,
                                 const char *wanted, bool writes, void **image,
                                 struct image_facts *facts)
{
    struct hdf5_array *array = *image = allocate_array(1, sizeof *array);
    struct growing_text text = {0};
    CHECK_MEMORY(report, array, "a file");
    *array = (struct hdf5_array){.path = name, .writes = writes, .file = -1, .dataset = -1};
    array->file = H5Fopen(path, writes ? H5F_ACC_RDWR : H5F_ACC_RDONLY, H5P_DEFAULT);
    if (array->file < 0)
        return input_failure(report, array->path,
                             "HDF5 cannot open it: it is damaged or cut short (copy it again), or "
                             "open for writing elsewhere");
    CHECK(choose_set(report, array, wanted));
    const struct data_set *set = &array->set;
    array->dataset = H5Dopen2(array->file, set->name, H5P_DEFAULT);
    if (array->dataset < 0)
        return cannot_move(report, array);
    const hid_t creation = H5Dget_create_plist(array->dataset);
    const sonject_status status = check_storage(report, array, creation);
    release(creation);
    CHECK(status);
    array->layout =
        (struct raster_layout){set->sides[set->is_column_major], set->sides[!set->is_column_major],
                               set->is_complex ? 2 : 1,
                               set->number == STORED_UINT8     ? PIXEL_UINT8
                               : set->number >= STORED_FLOAT32 ? PIXEL_FLOAT32
                                                               : PIXEL_UINT16};
    facts->layout = array->layout;
    facts->largest = set->number == STORED_INT16 ? INT16_MAX : 0;
    facts->is_column_major = set->is_column_major;
    H5Aiterate2(array->dataset, H5_INDEX_NAME, H5_ITER_INC, NULL, add_attribute, &text);
    facts->description = growing_text_end(&text);
    CHECK_MEMORY(report, facts->description, array->path);
    return SONJECT_OK;
}

static sonject_status close_image(struct report *report, void *image)
{
    struct hdf5_array *array = image;
    const int before = errno; /* the earlier failure's, if an image is closed after one */
    errno = 0;
    bool is_done = !array->writes || array->file < 0 || H5Fflush(array->file, H5F_SCOPE_LOCAL) >= 0;
    if (!is_done)
        hdf5_abandon(array->file);
    release(array->dataset);
    is_done = (array->file < 0 || H5Fclose(array->file) >= 0) && is_done;
    const sonject_status status = is_done ? SONJECT_OK : cannot_move(report, array);
    free(array);
    errno = is_done ? before : errno;
    return status;
}

/* Returns the type in memory, of numbers or of pairs, for release. */
static hid_t memory_type(const struct data_set *set)
{
    const hid_t plain = set->number == STORED_UINT8     ? H5T_NATIVE_UINT8
                        : set->number == STORED_UINT16  ? H5T_NATIVE_UINT16
                        : set->number == STORED_INT16   ? H5T_NATIVE_INT16
                        : set->number == STORED_FLOAT64 ? H5T_NATIVE_DOUBLE
                                                        : H5T_NATIVE_FLOAT;
    const size_t bytes = H5Tget_size(plain);
    if (!set->is_complex)
        return H5Tcopy(plain);
    const hid_t type = H5Tcreate(H5T_COMPOUND, 2 * bytes);
    if (type >= 0 && H5Tinsert(type, set->part_names[0], 0, plain) >= 0 &&
        H5Tinsert(type, set->part_names[1], bytes, plain) >= 0)
        return type;
    release(type);
    return -1;
}

/* Reads or writes a part of the image, which lies in memory in the file's order. */
static bool move_run(const struct hdf5_array *array, const struct region *part, hid_t type,
                     void *run, bool writes)
{
    const bool is_column_major = array->set.is_column_major;
    const hsize_t start[2] = {is_column_major ? part->first_column : part->first_row,
                              is_column_major ? part->first_row : part->first_column};
    const hsize_t counts[2] = {is_column_major ? part->columns : part->rows,
                               is_column_major ? part->rows : part->columns};
    const hid_t space = H5Dget_space(array->dataset);
    const hid_t memory = H5Screate_simple(2, counts, NULL);
    bool is_done = space >= 0 && memory >= 0 &&
                   H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, counts, NULL) >= 0;
    if (is_done)
        is_done = (writes ? H5Dwrite(array->dataset, type, memory, space, H5P_DEFAULT, run)
                          : H5Dread(array->dataset, type, memory, space, H5P_DEFAULT, run)) >= 0;
    release(memory);
    release(space);
    return is_done;
}

/* Reads or writes a region, which is no larger than a piece of the decoder's requests. */
static sonject_status exchange(struct report *report, const struct hdf5_array *array,
                               const struct region *region, void *pixels, bool writes)
{
    const bool is_column_major = array->set.is_column_major;
    const enum stored_type stored = array->set.number;
    const ptrdiff_t pixel = (ptrdiff_t)array->layout.channels;
    const ptrdiff_t line = pixel * (ptrdiff_t)(is_column_major ? region->rows : region->columns);
    const hid_t type = memory_type(&array->set);
    unsigned char *run =
        type < 0 ? NULL
                 : allocate_array((size_t)(region->rows * region->columns), H5Tget_size(type));
    const struct stored_samples samples = {
        .bytes = {run, run ? run + stored_bytes(stored) : NULL},
        .types = {stored, stored},
        .row_step = is_column_major ? pixel : line,
        .column_step = is_column_major ? line : pixel,
        .is_big_endian = machine_is_big_endian(),
    };
    const bool needs_old = !writes || stored == STORED_FLOAT64;
    sonject_status status = run ? SONJECT_OK : report_out_of_memory(report, "samples of an array");
    errno = 0;
    if (run && needs_old && !move_run(array, region, type, run, false))
        status = cannot_move(report, array);
    THEN(status, samples_exchange(report, array->path, &array->layout, &samples, region, region,
                                  pixels, writes));
    if (status == SONJECT_OK && writes && !move_run(array, region, type, run, true))
        status = cannot_move(report, array);
    free(run);
    release(type);
    return status;
}

static sonject_status read_samples(struct report *report, void *image, const struct region *region,
                                   void *pixels)
{
    return exchange(report, image, region, pixels, false);
}

static sonject_status change_samples(struct report *report, void *image,
                                     const struct region *region, const void *pixels)
{
    return exchange(report, image, region, (void *)pixels, true);
}

const struct image_library hdf5_library = {open_image, close_image, read_samples, change_samples};

static bool fill_file(hid_t file, const struct raster_layout *layout,
                      const struct raster_attribute *notes, size_t note_count, const void *pixels)
{
    const hsize_t sides[2] = {layout->rows, layout->columns};
    const struct data_set described = {
        .number = layout->type == PIXEL_UINT8    ? STORED_UINT8
                  : layout->type == PIXEL_UINT16 ? STORED_UINT16
                                                 : STORED_FLOAT32,
        .is_complex = layout->channels == 2,
        .part_names = {"r", "i"},
    };
    const hid_t type = memory_type(&described);
    const hid_t space = H5Screate_simple(2, sides, NULL);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    hid_t set = -1;
    if (type >= 0 && space >= 0 && creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        set = H5Dcreate2(file, "image", type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    bool is_done = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pixels) >= 0;
    for (size_t i = 0; is_done && i < note_count; i++)
        is_done = hdf5_write_text(set, notes[i].name, notes[i].value);
    is_done = is_done && H5Fflush(file, H5F_SCOPE_LOCAL) >= 0;
    if (!is_done)
        hdf5_abandon(file);
    release(set);
    release(creation);
    release(space);
    release(type);
    return is_done;
}

sonject_status hdf5_array_write(struct report *report, const char *path,
                                const struct raster_layout *layout,
                                const struct raster_attribute *notes, size_t note_count,
                                const void *pixels)
{
    struct hdf5_session session;
    char *part = file_part_name(path);
    CHECK_MEMORY(report, part, "a file name");
    hdf5_enter(&session);
    errno = 0;
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    const hid_t file = creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0
                           ? H5Fcreate(part, H5F_ACC_TRUNC, creation, H5P_DEFAULT)
                           : -1;
    bool is_done = file >= 0 && fill_file(file, layout, notes, note_count, pixels);
    if (file >= 0)
        is_done = H5Fclose(file) >= 0 && is_done;
    release(creation);
    const int error = errno;
    hdf5_leave(&session);
    sonject_status status = SONJECT_OK;
    if (is_done) {
        status = file_publish(report, part, path);
    } else {
        file_discard(part);
        status = error != 0 ? file_failure(report, path, "write", error)
                            : report_failure(report, SONJECT_ERROR_STORAGE,
                                             "%s: cannot write: HDF5 failed", path);
    }
    free(part);
    return status;
}
