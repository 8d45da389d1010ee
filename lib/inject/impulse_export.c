#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "inject/impulses.h"
#include "inject/injection.h"

#ifdef HAS_HDF5

#include "base/file.h"
#include "base/hdf5_values.h"
#include "base/memory.h"

#define CELLS_A_CHUNK     ((size_t)1 << 18)
#define DEFLATE_LEVEL     1 /* more saves a few per cent and takes several times as long */
#define CHUNK_CACHE_BYTES ((size_t)16 << 20)

struct impulse_export {
    struct report *report;
    const char *path;
    char *part; /* NULL once published */
    hid_t file;
    hid_t planes[IMPULSE_PLANES_MAX]; /* of the set that comes in; negative: closed */
};

static sonject_status cannot_write(struct impulse_export *export)
{
    const int error = errno;
    if (export->file >= 0)
        hdf5_abandon(export->file);
    if (error != 0)
        return file_failure(export->report, export->path, "write", error);
    return report_failure(export->report, SONJECT_ERROR_STORAGE, "%s: cannot write: HDF5 failed",
                          export->path);
}

sonject_status impulse_export_begin(struct report *report, const char *path,
                                    struct impulse_export **export)
{
    struct hdf5_session session;
    struct impulse_export *made = allocate_array(1, sizeof *made);
    *export = NULL;
    if (made)
        made->part = file_part_name(path);
    if (!made || !made->part) {
        free(made);
        return report_out_of_memory(report, "an export");
    }
    made->report = report;
    made->path = path;
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++)
        made->planes[i] = -1;
    hdf5_enter(&session);
    errno = 0;
    made->file = H5Fcreate(made->part, H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT);
    sonject_status status = made->file >= 0 ? SONJECT_OK : cannot_write(made);
    hdf5_leave(&session);
    if (status == SONJECT_OK)
        *export = made;
    else
        impulse_export_release(&made);
    return status;
}

static void close_planes(struct impulse_export *export)
{
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++) {
        if (export->planes[i] >= 0)
            H5Dclose(export->planes[i]);
        export->planes[i] = -1;
    }
}

/* Brings them to the file before they are closed. */
static bool finish_planes(struct impulse_export *export)
{
    for (int i = 0; i < IMPULSE_PLANES_MAX; i++)
        if (export->planes[i] >= 0 && H5Dflush(export->planes[i]) < 0)
            return false;
    close_planes(export);
    return true;
}

static const struct {
    const char *group;
    struct {
        const char *name, *units;
    } planes[IMPULSE_PLANES_MAX];
} sets[IMPULSE_KINDS] = {
    [IMPULSES_SEABED] = {"/seabed", {{"energy", "m^2"}, {"in_view", "m^2"}}},
    [IMPULSES_OBJECT] = {"/objects", {{"energy", "m^2"}, {"footprint", "rays"}, {"lost", "m^2"}}},
    [IMPULSES_GLINT] = {"/glints", {{"real", "m"}, {"imaginary", "m"}}},
    [IMPULSES_MULTIBOUNCE] = {"/multibounce", {{"real", "m"}, {"imaginary", "m"}}},
    [IMPULSES_BEAM] = {"/beam", {{"energy", "m^2"}}},
    [IMPULSES_HIDDEN] = {"/hidden", {{"lost", "m^2"}}},
    [IMPULSES_LEVEL] = {"/level", {{"energy", "m^2"}}},
    [IMPULSES_CHAINS] = {"/chains", {{"energy", "m^2"}}},
};

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

/* Closes what is open of them, whatever it is. */
static void close_all(const hid_t *identifiers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (identifiers[i] >= 0)
            H5Idec_ref(identifiers[i]);
}

static hid_t make_plane(hid_t group, const char *name, const struct line_grid *grid)
{
    const hsize_t extent[2] = {(hsize_t)grid->strips.count, (hsize_t)grid->bins.count};
    const hid_t used[3] = {H5Screate_simple(2, extent, NULL), H5Pcreate(H5P_DATASET_CREATE),
                           H5Pcreate(H5P_DATASET_ACCESS)};
    hid_t plane = -1;
    if (used[0] >= 0 && used[1] >= 0 && used[2] >= 0 && choose_storage(used[1], used[2], grid))
        plane = H5Dcreate2(group, name, H5T_IEEE_F32LE, used[0], H5P_DEFAULT, used[1], used[2]);
    close_all(used, 3);
    return plane;
}

static bool begin_set(struct impulse_export *export, const struct impulse_lines *lines)
{
    char name[32];
    const enum impulse_kind kind = lines->kind;
    const bool is_one = kind == IMPULSES_SEABED || kind == IMPULSES_BEAM || kind == IMPULSES_LEVEL;
    snprintf(name, sizeof name, is_one ? "%s" : "%s/%" PRIu32, sets[kind].group, lines->number);
    const hid_t group = hdf5_make_group(export->file, name);
    bool is_done = group >= 0 && describe_grid(group, &lines->grid);
    for (uint32_t i = 0; is_done && line_grid_cells(&lines->grid) > 0 && i < lines->planes; i++) {
        export->planes[i] = make_plane(group, sets[kind].planes[i].name, &lines->grid);
        is_done = export->planes[i] >= 0 &&
                  hdf5_write_text(export->planes[i], "units", sets[kind].planes[i].units);
    }
    if (group >= 0)
        is_done = H5Gclose(group) >= 0 && is_done;
    return is_done;
}

static bool write_plane(hid_t plane, const struct impulse_lines *lines, const float *values)
{
    const hsize_t first[2] = {(hsize_t)(lines->strips.first - lines->grid.strips.first), 0};
    const hsize_t count[2] = {(hsize_t)lines->strips.count, (hsize_t)lines->grid.bins.count};
    const hid_t spaces[2] = {H5Screate_simple(2, count, NULL), H5Dget_space(plane)};
    const bool is_done =
        spaces[0] >= 0 && spaces[1] >= 0 &&
        H5Sselect_hyperslab(spaces[1], H5S_SELECT_SET, first, NULL, count, NULL) >= 0 &&
        H5Dwrite(plane, H5T_NATIVE_FLOAT, spaces[0], spaces[1], H5P_DEFAULT, values) >= 0;
    close_all(spaces, 2);
    return is_done;
}

sonject_status impulse_export_lines(struct impulse_export *export,
                                    const struct impulse_lines *lines)
{
    struct hdf5_session session;
    hdf5_enter(&session);
    errno = 0;
    bool is_done = !impulse_lines_begin(lines) || begin_set(export, lines);
    for (uint32_t i = 0; is_done && line_grid_cells(&lines->grid) > 0 && i < lines->planes; i++)
        is_done = write_plane(export->planes[i], lines, lines->plane[i]);
    if (is_done && impulse_lines_end(lines))
        is_done = finish_planes(export);
    const sonject_status status = is_done ? SONJECT_OK : cannot_write(export);
    hdf5_leave(&session);
    return status;
}

static bool write_facts(hid_t file, const struct scene *scene, const struct injection_input *input,
                        const struct export_facts *facts)
{
    const sonject_sonar_params *sonar = &scene->sonar;
    const sonject_geometry_params *geometry = &scene->geometry;
    const struct {
        const char *name;
        uint64_t value;
    } wholes[] = {
        {"seed", scene->injection.seed},
        {"image_rows", facts->image_rows},
        {"image_columns", facts->image_columns},
        {"response_window", sonar->response_window},
        {"taylor_terms", sonar->taylor_terms},
        {"patch_first_row", (uint64_t)input->first_row},
        {"patch_first_column", (uint64_t)input->first_column},
        {"patch_rows", input->rows},
        {"patch_columns", input->columns},
        {"pings", facts->counts.pings},
        {"rays", facts->counts.rays},
        {"ray_queries", facts->counts.queries},
        {"impulses", facts->counts.impulses},
    };
    const struct {
        const char *name;
        double value;
    } numbers[] = {
        {"bandwidth_hz", sonar->bandwidth_hz},
        {"along_track_resolution_m", sonar->along_track_resolution_m},
        {"taylor_sidelobe_db", sonar->taylor_sidelobe_db},
        {"row_spacing_m", geometry->row_spacing_m},
        {"column_spacing_m", geometry->column_spacing_m},
        {"first_slant_range_m", geometry->first_slant_range_m},
        {"nadir_column", geometry->nadir_column},
    };
    bool is_done = true;
    for (size_t i = 0; is_done && i < sizeof wholes / sizeof *wholes; i++)
        is_done = hdf5_write_whole(file, wholes[i].name, wholes[i].value);
    for (size_t i = 0; is_done && i < sizeof numbers / sizeof *numbers; i++)
        is_done = hdf5_write_number(file, numbers[i].name, numbers[i].value);
    return is_done;
}

sonject_status impulse_export_publish(struct impulse_export *export, const struct scene *scene,
                                      const struct injection_input *input,
                                      const struct export_facts *facts)
{
    struct hdf5_session session;
    hdf5_enter(&session);
    errno = 0;
    const bool is_whole =
        hdf5_write_text(export->file, "sonject", sonject_version()) &&
        hdf5_write_text(export->file, "scene", facts->scene_hash) &&
        hdf5_write_text(export->file, "image_path", scene->input_path ? scene->input_path : "") &&
        hdf5_write_text(export->file, "image_xxhash", facts->image_hash) &&
        hdf5_write_text(export->file, "side",
                        scene->geometry.side == SONJECT_SIDE_PORT ? "port" : "starboard") &&
        write_facts(export->file, scene, input, facts) &&
        H5Fflush(export->file, H5F_SCOPE_GLOBAL) >= 0;
    sonject_status status = is_whole ? SONJECT_OK : cannot_write(export);
    const bool is_closed = H5Fclose(export->file) >= 0;
    export->file = -1;
    if (!is_closed && status == SONJECT_OK)
        status = cannot_write(export);
    hdf5_leave(&session);
    if (status != SONJECT_OK)
        return status;
    status = file_publish(export->report, export->part, export->path);
    free(export->part);
    export->part = NULL;
    return status;
}

void impulse_export_release(struct impulse_export **export)
{
    struct hdf5_session session;
    if (!*export)
        return;
    hdf5_enter(&session);
    if ((*export)->file >= 0)
        hdf5_abandon((*export)->file);
    close_planes(*export);
    if ((*export)->file >= 0)
        H5Fclose((*export)->file);
    hdf5_leave(&session);
    if ((*export)->part)
        file_discard((*export)->part);
    free((*export)->part);
    free(*export);
    *export = NULL;
}

#else /* a build without HDF5 */

sonject_status impulse_export_begin(struct report *report, const char *path,
                                    struct impulse_export **export)
{
    *export = NULL;
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject exports no impulses: build it with HDF5",
                          path);
}

sonject_status impulse_export_lines(struct impulse_export *export,
                                    const struct impulse_lines *lines)
{
    (void)export, (void)lines;
    return SONJECT_ERROR_UNSUPPORTED;
}

sonject_status impulse_export_publish(struct impulse_export *export, const struct scene *scene,
                                      const struct injection_input *input,
                                      const struct export_facts *facts)
{
    (void)export, (void)scene, (void)input, (void)facts;
    return SONJECT_ERROR_UNSUPPORTED;
}

void impulse_export_release(struct impulse_export **export)
{
    *export = NULL;
}

#endif
