#include "mesh/mesh.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "mesh/mesh_reader.h"

/* Radii for which single precision has room for squares and products. */
#define RADIUS_LEAST_M 1e-6
#define RADIUS_MOST_M  1e6

#define STORE_BYTES_MOST ((uint64_t)512 << 20)

/* The largest gap of a seam, as a share of the bounding box's diagonal. Rounding to single
 * precision moves a point by less than a tenth of this. */
#define SEAM_SHARE 1e-6

void mesh_options_init(struct mesh_options *options)
{
    memset(options, 0, sizeof *options);
    options->unit_m = 1.0;
    for (int axis = 0; axis < 3; axis++)
        options->axes[axis] = axis + 1;
}

bool mesh_is_of(const struct mesh *mesh, const struct path_facts *file,
                const struct mesh_options *options)
{
    return mesh->file.device == file->device && mesh->file.number == file->number &&
           mesh->file.bytes == file->bytes && mesh->file.changed_s == file->changed_s &&
           mesh->file.changed_ns == file->changed_ns && mesh->options.unit_m == options->unit_m &&
           memcmp(mesh->options.axes, options->axes, sizeof options->axes) == 0 &&
           mesh->options.smooth_angle_rad == options->smooth_angle_rad;
}

void mesh_clear(struct mesh *mesh)
{
    free(mesh->vertices);
    free(mesh->corners);
    free(mesh->normals);
    free(mesh->name);
    mesh_hierarchy_clear(&mesh->hierarchy);
    memset(mesh, 0, sizeof *mesh);
}

/* Returns a coordinate of the file as the object's, m. */
static double coordinate(const struct mesh_soup *soup, size_t vertex, int axis,
                         const struct mesh_options *options)
{
    const int source = options->axes[axis];
    const double value = soup->positions[3 * vertex + (size_t)(abs(source) - 1)];
    return (source < 0 ? -value : value) * options->unit_m;
}

/* Finds the middle of the bounding box of all vertices that triangles use. Errors: INPUT (size). */
static sonject_status find_centre(const struct mesh_soup *soup, struct mesh *mesh)
{
    double square = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        double lower = DBL_MAX;
        double upper = -DBL_MAX;
        for (size_t i = 0; i < 3 * soup->triangles; i++) {
            const double value = coordinate(soup, soup->corners[i], axis, &mesh->options);
            lower = value < lower ? value : lower;
            upper = value > upper ? value : upper;
        }
        const double half = 0.5 * upper - 0.5 * lower;
        mesh->centre_m[axis] = lower + half;
        square += half * half;
    }
    if (sqrt(square) >= RADIUS_LEAST_M && sqrt(square) <= RADIUS_MOST_M)
        return SONJECT_OK;
    return input_failure(soup->report, soup->path, "the mesh is %g m across: check its unit",
                         2.0 * sqrt(square));
}

/* Brings the soup's vertices into the mesh's frame and welds those that are equal, or closer than
 * the tolerance. Keeps the triangles that have three corners left. */
static sonject_status weld_all(const struct mesh_soup *soup, struct mesh *mesh, struct weld *weld,
                               uint32_t *numbers) /* number + 1; 0: not yet met */
{
    for (size_t i = 0; i < soup->triangles; i++) {
        uint32_t corners[3];
        for (size_t k = 0; k < 3; k++) {
            const uint32_t vertex = soup->corners[3 * i + k];
            if (numbers[vertex] == 0) {
                double position[3];
                uint32_t number = 0;
                for (int axis = 0; axis < 3; axis++)
                    position[axis] =
                        (double)(float)(coordinate(soup, vertex, axis, &mesh->options) -
                                        mesh->centre_m[axis]);
                CHECK(weld_vertex(weld, position, &number));
                numbers[vertex] = number + 1;
            }
            corners[k] = numbers[vertex] - 1;
        }
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            mesh->degenerate++;
        else
            CHECK(mesh_soup_add_triangle(weld->soup, corners[0], corners[1], corners[2]));
    }
    if (weld->soup->triangles == 0)
        return input_failure(soup->report, soup->path,
                             "none of its %zu triangles has an area: export the mesh again",
                             soup->triangles);
    return SONJECT_OK;
}

/* Takes over the welded vertices and triangles. */
static sonject_status copy_welded(struct mesh_soup *welded, struct mesh *mesh)
{
    double square = 0.0;
    mesh->vertices = allocate_array(welded->vertices, 3 * sizeof *mesh->vertices);
    CHECK_MEMORY(welded->report, mesh->vertices, welded->path);
    mesh->vertex_count = welded->vertices;
    for (int axis = 0; axis < 3; axis++) {
        mesh->lower_m[axis] = FLT_MAX;
        mesh->upper_m[axis] = -FLT_MAX;
    }
    for (size_t i = 0; i < welded->vertices; i++) {
        double from_centre = 0.0;
        for (size_t axis = 0; axis < 3; axis++) {
            const double value = welded->positions[3 * i + axis];
            mesh->vertices[3 * i + axis] = (float)value;
            mesh->lower_m[axis] = fminf(mesh->lower_m[axis], (float)value);
            mesh->upper_m[axis] = fmaxf(mesh->upper_m[axis], (float)value);
            from_centre += value * value;
        }
        square = fmax(square, from_centre);
    }
    mesh->radius_m = nextafterf((float)sqrt(square), FLT_MAX);
    mesh->corners = welded->corners;
    mesh->triangle_count = welded->triangles;
    welded->corners = NULL;
    return SONJECT_OK;
}

/* Makes the mesh's vertices and triangles, and finds its topology. */
static sonject_status weld_and_orient(const struct mesh_soup *soup, struct mesh *mesh,
                                      double tolerance)
{
    struct mesh_soup welded = {.report = soup->report, .path = soup->path};
    struct weld weld = {.soup = &welded, .tolerance = tolerance};
    uint32_t *numbers = allocate_array(soup->vertices, sizeof *numbers);
    free(mesh->vertices);
    free(mesh->corners);
    mesh->vertices = NULL;
    mesh->corners = NULL;
    mesh->degenerate = 0;
    sonject_status status = numbers ? weld_all(soup, mesh, &weld, numbers)
                                    : report_out_of_memory(soup->report, soup->path);
    THEN(status, copy_welded(&welded, mesh));
    free(numbers);
    weld_clear(&weld);
    mesh_soup_clear(&welded);
    THEN(status, mesh_topology_find(soup->report, mesh->vertices, mesh->vertex_count, mesh->corners,
                                    mesh->triangle_count, &mesh->topology));
    return status;
}

/* Sets smooth normals in the order of the leaves' slots. */
static sonject_status set_normals(struct report *report, double angle, struct mesh *mesh)
{
    float *normals;
    const size_t slots = mesh->hierarchy.leaf_count * MESH_SLOTS;
    mesh->normals = allocate_array(slots, sizeof *mesh->normals);
    CHECK_MEMORY(report, mesh->normals, "the normals of a mesh");
    CHECK(mesh_smooth_normals(report, mesh->vertices, mesh->vertex_count, mesh->corners,
                              mesh->triangle_count, angle, &normals));
    for (size_t slot = 0; slot < slots; slot++) {
        const uint32_t triangle = mesh->hierarchy.triangles[slot];
        if (triangle != MESH_NO_TRIANGLE)
            memcpy(&mesh->normals[slot], &normals[9 * (size_t)triangle], sizeof *mesh->normals);
    }
    free(normals);
    return SONJECT_OK;
}

sonject_status mesh_of_soup(const struct mesh_soup *soup, struct mesh *mesh)
{
    struct report *report = soup->report;
    mesh->name = copy_text(soup->path);
    CHECK_MEMORY(report, mesh->name, soup->path);
    if (soup->triangles == 0)
        return input_failure(report, soup->path, "the mesh has no triangles");
    CHECK(find_centre(soup, mesh));
    CHECK(weld_and_orient(soup, mesh, 0.0));
    /* only an open mesh may have a seam; in others thin walls must stay apart */
    if (!mesh->topology.is_closed) {
        const size_t vertices = mesh->vertex_count;
        double square = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            const double side = (double)mesh->upper_m[axis] - (double)mesh->lower_m[axis];
            square += side * side;
        }
        CHECK(weld_and_orient(soup, mesh, SEAM_SHARE * sqrt(square)));
        mesh->welded = vertices - mesh->vertex_count;
    }
    CHECK(mesh_hierarchy_build(report, mesh->vertices, mesh->corners, mesh->triangle_count,
                               mesh->radius_m, &mesh->hierarchy));
    return mesh->options.smooth_angle_rad > 0.0
               ? set_normals(report, mesh->options.smooth_angle_rad, mesh)
               : SONJECT_OK;
}

sonject_status mesh_load(struct report *report, const char *path,
                         const struct mesh_options *options, struct mesh *mesh)
{
    struct mesh_soup soup = {.report = report, .path = path};
    memset(mesh, 0, sizeof *mesh);
    mesh->options = *options;
    sonject_status status = file_identify(report, path, &mesh->file);
    THEN(status, mesh_file_read(&soup));
    THEN(status, mesh_of_soup(&soup, mesh));
    mesh_soup_clear(&soup);
    if (status != SONJECT_OK)
        mesh_clear(mesh);
    return status;
}

sonject_status mesh_require_closed(struct report *report, const char *name, const struct mesh *mesh)
{
    const struct mesh_topology *topology = &mesh->topology;
    if (topology->is_closed)
        return SONJECT_OK;
    const float *vertex = &mesh->vertices[3 * (size_t)topology->edge[0]];
    return input_failure(
        report, name,
        "the mesh does not enclose a volume: %zu edges belong to one triangle, %zu to more than "
        "two, %zu are twisted, one of them at (%g, %g, %g) m: close it in a mesh editor",
        topology->open_edges, topology->crowded_edges, topology->twisted_edges,
        (double)vertex[0] + mesh->centre_m[0], (double)vertex[1] + mesh->centre_m[1],
        (double)vertex[2] + mesh->centre_m[2]);
}

struct mesh_record mesh_record_of(const struct mesh *mesh, uint32_t first_branch,
                                  uint32_t first_leaf, uint32_t first_normals)
{
    return (struct mesh_record){.first_branch = first_branch,
                                .branches = (uint32_t)mesh->hierarchy.branch_count,
                                .first_leaf = first_leaf,
                                .leaves = (uint32_t)mesh->hierarchy.leaf_count,
                                .first_normals = first_normals,
                                .is_smooth = mesh->normals != NULL,
                                .radius = mesh->radius_m,
                                .is_sheet = !mesh->topology.is_closed};
}

static uint64_t bytes_of(const struct mesh *mesh)
{
    const struct mesh_hierarchy *hierarchy = &mesh->hierarchy;
    const uint64_t slots = (uint64_t)hierarchy->leaf_count * MESH_SLOTS;
    return 3 * (mesh->vertex_count * sizeof *mesh->vertices +
                mesh->triangle_count * sizeof *mesh->corners) +
           hierarchy->branch_count * sizeof *hierarchy->branches +
           hierarchy->leaf_count * sizeof *hierarchy->leaves +
           slots * sizeof *hierarchy->triangles +
           (mesh->normals ? slots * sizeof *mesh->normals : 0);
}

/* Moves a mesh out of the store. */
static void remove_mesh(struct mesh_store *store, size_t number, struct mesh *mesh)
{
    *mesh = store->meshes[number];
    store->bytes -= bytes_of(mesh);
    store->count--;
    memmove(&store->meshes[number], &store->meshes[number + 1],
            (store->count - number) * sizeof *store->meshes);
}

bool mesh_store_take(struct mesh_store *store, const struct path_facts *file,
                     const struct mesh_options *options, struct mesh *mesh)
{
    for (size_t i = 0; i < store->count; i++)
        if (mesh_is_of(&store->meshes[i], file, options)) {
            remove_mesh(store, i, mesh);
            return true;
        }
    return false;
}

void mesh_store_give(struct mesh_store *store, struct mesh *mesh)
{
    const uint64_t bytes = bytes_of(mesh);
    while (store->count > 0 &&
           (store->count == MESH_STORE_MESHES || store->bytes + bytes > STORE_BYTES_MOST)) {
        struct mesh oldest;
        remove_mesh(store, 0, &oldest);
        mesh_clear(&oldest);
    }
    store->bytes += bytes;
    store->meshes[store->count++] = *mesh;
    memset(mesh, 0, sizeof *mesh);
}

void mesh_store_clear(struct mesh_store *store)
{
    for (size_t i = 0; i < store->count; i++)
        mesh_clear(&store->meshes[i]);
    memset(store, 0, sizeof *store);
}
