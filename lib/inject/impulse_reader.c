#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hdf5_values.h"
#include "base/memory.h"
#include "inject/impulse_reading.h"
#include "inject/impulse_seal.h"

sonject_status impulse_file_refuse(const struct impulse_file *file, const char *name,
                                   const char *what)
{
    return report_failure(file->report, SONJECT_ERROR_INPUT, "%s: %s %s: trace again", file->path,
                          name, what);
}

hid_t impulse_group_open(hid_t file, const char *path)
{
    char parent[IMPULSE_GROUP_CAPACITY] = "";
    const char *last = strrchr(path, '/');
    if (last > path)
        memcpy(parent, path, (size_t)(last - path));
    if ((*parent && H5Lexists(file, parent, H5P_DEFAULT) <= 0) ||
        H5Lexists(file, path, H5P_DEFAULT) <= 0)
        return -1;
    return H5Gopen2(file, path, H5P_DEFAULT);
}

struct head_group {
    const char *name;
    bool (*read)(hid_t group, struct impulse_head *head);
};

static bool read_scene(hid_t group, struct impulse_head *head)
{
    char **texts = NULL;
    size_t count = 0;
    if (!hdf5_read_short_text(group, "hash", head->scene_hash, sizeof head->scene_hash) ||
        !hdf5_read_whole(group, "seed", &head->seed))
        return false;
    if (H5Lexists(group, "text", H5P_DEFAULT) <= 0)
        return true;
    if (!hdf5_read_text(group, "path", &head->scene_path) ||
        !hdf5_read_text(group, "folder", &head->scene_folder) ||
        !hdf5_read_texts(group, "text", &texts, &count))
        return false;
    for (size_t i = 1; i < count; i++)
        free(texts[i]);
    head->scene_text = count > 0 ? texts[0] : NULL;
    free(texts);
    return head->scene_text &&
           (H5Lexists(group, "overrides", H5P_DEFAULT) <= 0 ||
            hdf5_read_texts(group, "overrides", &head->overrides, &head->override_count));
}

static bool read_image(hid_t group, struct impulse_head *head)
{
    return hdf5_read_text(group, "path", &head->image_path) &&
           hdf5_read_whole(group, "rows", &head->image_rows) &&
           hdf5_read_whole(group, "columns", &head->image_columns) &&
           hdf5_read_short_text(group, "xxhash", head->image_hash, sizeof head->image_hash);
}

static bool read_sonar(hid_t group, struct impulse_head *head)
{
    sonject_sonar_params *sonar = &head->sonar;
    int32_t window = 0;
    int32_t terms = 0;
    const bool is_done =
        hdf5_read_number(group, "bandwidth_hz", &sonar->bandwidth_hz) &&
        hdf5_read_number(group, "along_track_resolution_m", &sonar->along_track_resolution_m) &&
        hdf5_read_number(group, "taylor_sidelobe_db", &sonar->taylor_sidelobe_db) &&
        hdf5_read_integer(group, "response_window", 0, INT32_MAX, &window) &&
        hdf5_read_integer(group, "taylor_terms", 0, INT32_MAX, &terms);
    sonar->response_window = (uint32_t)window;
    sonar->taylor_terms = (uint32_t)terms;
    return is_done;
}

static bool read_patch(hid_t group, struct impulse_head *head)
{
    return hdf5_read_whole(group, "first_row", &head->first_row) &&
           hdf5_read_whole(group, "first_column", &head->first_column) &&
           hdf5_read_whole(group, "rows", &head->rows) &&
           hdf5_read_whole(group, "columns", &head->columns) &&
           hdf5_read_number(group, "row_spacing_m", &head->row_spacing_m) &&
           hdf5_read_number(group, "column_spacing_m", &head->column_spacing_m) &&
           hdf5_read_number(group, "first_slant_range_m", &head->first_slant_range_m);
}

static bool read_counts(hid_t group, struct impulse_head *head)
{
    return hdf5_read_whole(group, "pings", &head->counts.pings) &&
           hdf5_read_whole(group, "rays", &head->counts.rays) &&
           hdf5_read_whole(group, "ray_queries", &head->counts.queries) &&
           hdf5_read_whole(group, "impulses", &head->counts.impulses);
}

static sonject_status read_head(struct impulse_file *file)
{
    static const struct head_group groups[] = {{"/scene", read_scene},
                                               {"/image", read_image},
                                               {"/sonar", read_sonar},
                                               {"/patch", read_patch},
                                               {"/counts", read_counts}};
    char format[sizeof IMPULSE_FORMAT];
    int32_t version = 0;
    if (!hdf5_read_short_text(file->file, "format", format, sizeof format) ||
        strcmp(format, IMPULSE_FORMAT) != 0 ||
        !hdf5_read_integer(file->file, "format_version", 0, INT32_MAX, &version))
        return report_failure(file->report, SONJECT_ERROR_INPUT,
                              "%s: not a file that sonject trace writes: another kind of HDF5 file",
                              file->path);
    if (version != IMPULSE_FORMAT_VERSION)
        return report_failure(file->report, SONJECT_ERROR_INPUT,
                              "%s: its format is %ld, but this build reads %d: trace again",
                              file->path, (long)version, IMPULSE_FORMAT_VERSION);
    if (!hdf5_read_short_text(file->file, "sonject", file->head.version, sizeof file->head.version))
        return impulse_file_refuse(file, "its version", "is damaged");
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
        const hid_t group = impulse_group_open(file->file, groups[i].name);
        const bool is_done = group >= 0 && groups[i].read(group, &file->head);
        if (group >= 0)
            H5Gclose(group);
        if (!is_done)
            return impulse_file_refuse(file, groups[i].name, "is damaged");
    }
    return SONJECT_OK;
}

sonject_status impulse_file_open(struct report *report, const char *path,
                                 struct impulse_file **file)
{
    struct hdf5_session session;
    struct file_identity identity;
    *file = NULL;
    if (!file_exists(path))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s: there is no such file of impulses; check its name", path);
    sonject_status status = file_identify(report, path, &identity);
    if (status == SONJECT_OK)
        status = impulse_seal_check(report, path);
    if (status != SONJECT_OK)
        return status;
    struct impulse_file *made = allocate_array(1, sizeof *made);
    if (!made)
        return report_out_of_memory(report, "a file of impulses");
    made->report = report;
    made->path = path;
    hdf5_enter(&session);
    made->file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    status = made->file >= 0 ? read_head(made)
                             : report_failure(report, SONJECT_ERROR_INPUT,
                                              "%s: not an HDF5 file: trace again", path);
    hdf5_leave(&session);
    if (status == SONJECT_OK)
        *file = made;
    else
        impulse_file_close(&made);
    return status;
}

const struct impulse_head *impulse_file_head(const struct impulse_file *file)
{
    return &file->head;
}

void impulse_file_close(struct impulse_file **file)
{
    struct hdf5_session session;
    if (!*file)
        return;
    hdf5_enter(&session);
    if ((*file)->file >= 0)
        H5Fclose((*file)->file);
    hdf5_leave(&session);
    impulse_head_clear(&(*file)->head);
    free(*file);
    *file = NULL;
}
