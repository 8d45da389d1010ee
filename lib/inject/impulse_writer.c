#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/hdf5_values.h"
#include "base/memory.h"
#include "inject/impulse_file.h"
#include "inject/impulse_seal.h"

#define CELLS_A_CHUNK     ((size_t)1 << 18)
#define DEFLATE_LEVEL     1 /* more saves a few per cent and takes several times as long */
#define CHUNK_CACHE_BYTES ((size_t)16 << 20)

struct impulse_writer {
    struct report *report;
    const char *path;
    char *part; /* NULL once published */
    hid_t file;
    hid_t planes[IMPULSE_PLANES_MAX]; /* of the set that comes in; negative: closed */
    bool has_folder[IMPULSE_KINDS];   /* the group of a kind's sets */
};

static sonject_status cannot_write(struct impulse_writer *writer)
{
    const int error = errno;
    if (writer->file >= 0)
        hdf5_abandon(writer->file);
    if (error != 0)
        return file_failure(writer->report, writer->path, "write", error);
    return report_failure(writer->report, SONJECT_ERROR_STORAGE, "%s: cannot write: HDF5 failed",
                          writer->path);
}

/* The format of HDF5 1.10, whose headers and indices have checksums. */
static hid_t create_file(const char *path)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    hid_t file = -1;
    if (access >= 0 && creation >= 0 && H5Pset_obj_track_times(creation, 0) >= 0 &&
        H5Pset_userblock(creation, IMPULSE_SEAL_BYTES) >= 0 &&
        H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0)
        file = H5Fcreate(path, H5F_ACC_EXCL, creation, access);
    if (creation >= 0)
        H5Pclose(creation);
    if (access >= 0)
        H5Pclose(access);
    return file;
}

sonject_status impulse_writer_begin(struct report *report, const char *path,
                                    struct impulse_writer **writer)
{
    struct hdf5_session session;
    struct impulse_writer *made = allocate_array(1, sizeof *made);
    *writer = NULL;
    if (made)
        made->part = file_part_name(path);
    if (!made || !made->part) {
        free(made);
        return report_out_of_memory(report, "a file of impulses");
    }
    made->report = report;
    made->path = path;
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++)
        made->planes[i] = -1;
    hdf5_enter(&session);
    errno = 0;
    made->file = create_file(made->part);
    sonject_status status = made->file >= 0 ? SONJECT_OK : cannot_write(made);
    hdf5_leave(&session);
    if (status == SONJECT_OK)
        *writer = made;
    else
        impulse_writer_release(&made);
    return status;
}

static void close_planes(struct impulse_writer *writer)
{
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++) {
        if (writer->planes[i] >= 0)
            H5Dclose(writer->planes[i]);
        writer->planes[i] = -1;
    }
}

/* Brings them to the file before they are closed. */
static bool finish_planes(struct impulse_writer *writer)
{
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++)
        if (writer->planes[i] >= 0 && H5Dflush(writer->planes[i]) < 0)
            return false;
    close_planes(writer);
    return true;
}

/* The groups "/objects" and the like. */
static bool make_folder(struct impulse_writer *writer, enum impulse_kind kind)
{
    static const char *const folders[IMPULSE_KINDS] = {[IMPULSES_OBJECT] = "/objects",
                                                       [IMPULSES_GLINT] = "/glints",
                                                       [IMPULSES_HIDDEN] = "/hidden",
                                                       [IMPULSES_CHAINS] = "/chains"};
    if (!folders[kind] || writer->has_folder[kind])
        return true;
    writer->has_folder[kind] = true;
    const hid_t group = hdf5_make_group(writer->file, folders[kind]);
    return group >= 0 && H5Gclose(group) >= 0;
}

static bool describe_grid(hid_t group, const struct line_grid *grid)
{
    const struct {
        const char *name;
        int64_t value;
    } values[] = {
        {"strips_per_row", grid->strips_per_row}, {"bins_per_pixel", grid->bins_per_pixel},
        {"first_strip", grid->strips.first},      {"strips", grid->strips.count},
        {"first_bin", grid->bins.first},          {"bins", grid->bins.count},
    };
    bool is_done = true;
    for (size_t i = 0; is_done && i < sizeof values / sizeof *values; i++)
        is_done = hdf5_write_integer(group, values[i].name, values[i].value);
    return is_done;
}

static bool choose_storage(hid_t creation, hid_t access, const struct line_grid *grid)
{
    const size_t bins = (size_t)grid->bins.count;
    const size_t strips = (size_t)grid->strips.count;
    const size_t rows = bins < CELLS_A_CHUNK ? CELLS_A_CHUNK / bins : 1;
    const hsize_t chunk[2] = {rows < strips ? rows : strips, bins};
    return H5Pset_obj_track_times(creation, 0) >= 0 && H5Pset_chunk(creation, 2, chunk) >= 0 &&
           H5Pset_shuffle(creation) >= 0 && H5Pset_deflate(creation, DEFLATE_LEVEL) >= 0 &&
           H5Pset_fletcher32(creation) >= 0 &&
           H5Pset_chunk_cache(access, 521, CHUNK_CACHE_BYTES, 1.0) >= 0;
}

static hid_t make_plane(hid_t group, const char *name, const struct line_grid *grid)
{
    const hsize_t extent[2] = {(hsize_t)grid->strips.count, (hsize_t)grid->bins.count};
    const hid_t space = H5Screate_simple(2, extent, NULL);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
    hid_t plane = -1;
    if (space >= 0 && creation >= 0 && access >= 0 && choose_storage(creation, access, grid))
        plane = H5Dcreate2(group, name, H5T_IEEE_F32LE, space, H5P_DEFAULT, creation, access);
    if (access >= 0)
        H5Pclose(access);
    if (creation >= 0)
        H5Pclose(creation);
    if (space >= 0)
        H5Sclose(space);
    return plane;
}

static bool begin_set(struct impulse_writer *writer, const struct impulse_lines *lines)
{
    char name[IMPULSE_GROUP_CAPACITY];
    impulse_group_name(lines->kind, lines->number, name);
    if (!make_folder(writer, lines->kind))
        return false;
    const hid_t group = hdf5_make_group(writer->file, name);
    bool is_done = group >= 0 && describe_grid(group, &lines->grid);
    for (uint32_t i = 0; is_done && line_grid_cells(&lines->grid) > 0 && i < lines->planes; i++) {
        writer->planes[i] = make_plane(group, impulse_plane_names(lines->kind)[i], &lines->grid);
        is_done = writer->planes[i] >= 0;
    }
    if (group >= 0)
        is_done = H5Gclose(group) >= 0 && is_done;
    return is_done;
}

static bool write_plane(hid_t plane, const struct impulse_lines *lines, const float *values)
{
    const hsize_t first[2] = {(hsize_t)(lines->strips.first - lines->grid.strips.first), 0};
    const hsize_t count[2] = {(hsize_t)lines->strips.count, (hsize_t)lines->grid.bins.count};
    const hid_t memory = H5Screate_simple(2, count, NULL);
    const hid_t space = H5Dget_space(plane);
    const bool is_done =
        memory >= 0 && space >= 0 &&
        H5Sselect_hyperslab(space, H5S_SELECT_SET, first, NULL, count, NULL) >= 0 &&
        H5Dwrite(plane, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, values) >= 0;
    if (space >= 0)
        H5Sclose(space);
    if (memory >= 0)
        H5Sclose(memory);
    return is_done;
}

static sonject_status take(void *taker, const struct impulse_lines *lines)
{
    struct impulse_writer *writer = taker;
    struct hdf5_session session;
    hdf5_enter(&session);
    errno = 0;
    bool is_done = !impulse_lines_begin(lines) || begin_set(writer, lines);
    for (uint32_t i = 0; is_done && line_grid_cells(&lines->grid) > 0 && i < lines->planes; i++)
        is_done = write_plane(writer->planes[i], lines, lines->plane[i]);
    if (is_done && impulse_lines_end(lines))
        is_done = finish_planes(writer);
    const sonject_status status = is_done ? SONJECT_OK : cannot_write(writer);
    hdf5_leave(&session);
    return status;
}

struct impulse_sink impulse_writer_sink(struct impulse_writer *writer)
{
    const struct impulse_sink sink = {take, writer};
    return sink;
}

static bool write_scene(hid_t group, const struct impulse_head *head)
{
    const char *const *overrides = (const char *const *)head->overrides;
    const char *text = head->scene_text;
    return hdf5_write_text(group, "hash", head->scene_hash) &&
           hdf5_write_whole(group, "seed", head->seed) &&
           (!text || (hdf5_write_text(group, "path", head->scene_path) &&
                      hdf5_write_text(group, "folder", head->scene_folder) &&
                      hdf5_write_texts(group, "text", &text, 1) &&
                      (head->override_count == 0 ||
                       hdf5_write_texts(group, "overrides", overrides, head->override_count))));
}

static bool write_image(hid_t group, const struct impulse_head *head)
{
    return hdf5_write_text(group, "path", head->image_path) &&
           hdf5_write_whole(group, "rows", head->image_rows) &&
           hdf5_write_whole(group, "columns", head->image_columns) &&
           hdf5_write_text(group, "xxhash", head->image_hash);
}

static bool write_sonar(hid_t group, const struct impulse_head *head)
{
    const sonject_sonar_params *sonar = &head->sonar;
    return hdf5_write_number(group, "bandwidth_hz", sonar->bandwidth_hz) &&
           hdf5_write_number(group, "along_track_resolution_m", sonar->along_track_resolution_m) &&
           hdf5_write_integer(group, "response_window", sonar->response_window) &&
           hdf5_write_number(group, "taylor_sidelobe_db", sonar->taylor_sidelobe_db) &&
           hdf5_write_integer(group, "taylor_terms", sonar->taylor_terms);
}

static bool write_patch(hid_t group, const struct impulse_head *head)
{
    return hdf5_write_whole(group, "first_row", head->first_row) &&
           hdf5_write_whole(group, "first_column", head->first_column) &&
           hdf5_write_whole(group, "rows", head->rows) &&
           hdf5_write_whole(group, "columns", head->columns) &&
           hdf5_write_number(group, "row_spacing_m", head->row_spacing_m) &&
           hdf5_write_number(group, "column_spacing_m", head->column_spacing_m) &&
           hdf5_write_number(group, "first_slant_range_m", head->first_slant_range_m);
}

static bool write_counts(hid_t group, const struct impulse_head *head)
{
    return hdf5_write_whole(group, "pings", head->counts.pings) &&
           hdf5_write_whole(group, "rays", head->counts.rays) &&
           hdf5_write_whole(group, "ray_queries", head->counts.queries) &&
           hdf5_write_whole(group, "impulses", head->counts.impulses);
}

static bool write_head(hid_t file, const struct impulse_head *head)
{
    static const struct {
        const char *name;
        bool (*write)(hid_t group, const struct impulse_head *head);
    } groups[] = {{"/scene", write_scene},
                  {"/image", write_image},
                  {"/sonar", write_sonar},
                  {"/patch", write_patch},
                  {"/counts", write_counts}};
    bool is_done = hdf5_write_text(file, "format", IMPULSE_FORMAT) &&
                   hdf5_write_integer(file, "format_version", IMPULSE_FORMAT_VERSION) &&
                   hdf5_write_text(file, "sonject", sonject_version());
    for (size_t i = 0; is_done && i < sizeof groups / sizeof *groups; i++) {
        const hid_t group = hdf5_make_group(file, groups[i].name);
        is_done = group >= 0 && groups[i].write(group, head);
        if (group >= 0)
            is_done = H5Gclose(group) >= 0 && is_done;
    }
    return is_done;
}

sonject_status impulse_writer_publish(struct impulse_writer *writer,
                                      const struct impulse_head *head)
{
    struct hdf5_session session;
    hdf5_enter(&session);
    errno = 0;
    const bool is_whole =
        write_head(writer->file, head) && H5Fflush(writer->file, H5F_SCOPE_GLOBAL) >= 0;
    sonject_status status = is_whole ? SONJECT_OK : cannot_write(writer);
    const bool is_closed = H5Fclose(writer->file) >= 0;
    writer->file = -1;
    if (!is_closed && status == SONJECT_OK)
        status = cannot_write(writer);
    hdf5_leave(&session);
    if (status == SONJECT_OK)
        status = impulse_seal_write(writer->report, writer->part, writer->path);
    if (status != SONJECT_OK)
        return status;
    status = file_publish(writer->report, writer->part, writer->path);
    free(writer->part);
    writer->part = NULL;
    return status;
}

void impulse_writer_release(struct impulse_writer **writer)
{
    struct hdf5_session session;
    if (!*writer)
        return;
    hdf5_enter(&session);
    if ((*writer)->file >= 0)
        hdf5_abandon((*writer)->file);
    close_planes(*writer);
    if ((*writer)->file >= 0)
        H5Fclose((*writer)->file);
    hdf5_leave(&session);
    if ((*writer)->part)
        file_discard((*writer)->part);
    free((*writer)->part);
    free(*writer);
    *writer = NULL;
}
