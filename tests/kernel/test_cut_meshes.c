/* Meshes that planes cut, against every triangle in double precision: where rays meet what is left,
 * and how it faces there, for rays from 50 m and 500 m, that start anywhere, through edges and
 * corners, and nearly along the planes. */
#include "mesh_arrays.h"
#include "mesh_samples.h"
#include "physics/bench.h"
#include "ray_claims.h"

#include "trace/object_buffer.h"

#define RAYS      6000
#define SHIFT_M   4e-6 /* so far aside a ray may act: rounding of coordinates up to 2 m (1e-7) */
#define CLOSE_M   4e-6 /* rounding of distances up to 500 m from the closest approach: their own */
#define FACES_MAX 4096

/* What a ray meets: a facet, or the face of a cut. */
struct reference_hit {
    double distance; /* INFINITY: nothing */
    int surface;     /* number of a facet, -1 - number of a cut */
    struct point normal;
};

/* A cut mesh as the kernels get it, and its triangles. */
struct cut_solid {
    struct bench bench;
    struct object_record *record;
    struct mesh *mesh;
    bool is_sheet;
    float reach; /* rays start so far before their closest approach, m */
};

static void cut_solid_begin(struct cut_solid *solid, const struct mesh_sample *sample)
{
    struct mesh_options options;
    mesh_options_init(&options);
    bench_open(&solid->bench, 128, 128, 50.0);
    struct scene *scene = &solid->bench.scene;
    scene->meshes = calloc(1, sizeof *scene->meshes);
    assert_non_null(scene->meshes);
    scene->mesh_count = 1;
    EXPECT_OK(&solid->bench.report,
              mesh_from_arrays(&solid->bench.report, "sample", sample->positions, sample->vertices,
                               sample->corners, sample->triangles, &options, &scene->meshes[0]));
    solid->mesh = &scene->meshes[0];
    solid->is_sheet = !solid->mesh->topology.is_closed;
    sonject_object_params *object = bench_add(&solid->bench, SHAPE_MESH, 0.0, 0.0, 0.0);
    object->burial_m = -2.0;
    object->heading_rad = 0.6;
    object->pitch_rad = 0.3;
    object->roll_rad = -0.4;
    object->cut_count = 1; /* some cut, drawn anew later */
    bench_ready(&solid->bench);
    const double *centre = solid->bench.placements[0].centre;
    const double origin[3] = {centre[0] + 0.3, centre[1] - 0.7, centre[2] + 0.2};
    struct object_record record;
    device_buffer buffer = NULL;
    object_record_init(&record, &solid->bench.tracer, solid->bench.placements, origin);
    if (object_buffer_create(&solid->bench.tracer, &record, &(struct part_list){NULL, 1, 0},
                             &buffer) != SONJECT_OK)
        fail_msg("%s", solid->bench.report.message);
    solid->record = bench_copy_buffer(&solid->bench, buffer);
    buffer_release(solid->bench.tracer.device, &buffer);
}

static void cut_solid_end(struct cut_solid *solid)
{
    free(solid->record);
    bench_close(&solid->bench);
}

/* One or two planes through the middle half of the mesh; now and then along an axis. */
static void draw_cuts(struct cut_solid *solid)
{
    struct object_record *record = solid->record;
    record->cuts = 1 + (int)uniform(0.0, 2.0);
    for (int i = 0; i < record->cuts; i++) {
        struct point normal = random_direction();
        if (uniform(0.0, 1.0) < 0.2)
            normal = (struct point){0.0, 0.0, 1.0};
        record->cut[i].normal_x = (float)normal.x;
        record->cut[i].normal_y = (float)normal.y;
        record->cut[i].normal_z = (float)normal.z;
        record->cut[i].offset = (float)uniform(-0.4, 0.4) * record->bounding_radius;
    }
}

static struct point corner_of(const struct mesh *mesh, size_t triangle, size_t corner)
{
    const float *p = &mesh->vertices[3 * mesh->corners[3 * triangle + corner % 3]];
    const struct point point = {p[0], p[1], p[2]};
    return point;
}

static struct point cross(struct point a, struct point b)
{
    const struct point c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return c;
}

static struct point facet_normal(const struct mesh *mesh, size_t facet)
{
    const struct point a = corner_of(mesh, facet, 0);
    const struct point n =
        cross(add(corner_of(mesh, facet, 1), a, -1.0), add(corner_of(mesh, facet, 2), a, -1.0));
    return scaled(n, 1.0 / sqrt(dot(n, n)));
}

struct crossing {
    double distance;
    int facet;
    double side; /* 1: the ray leaves, -1: it enters */
};

/* All crossings of a ray's whole line with a mesh. */
static size_t cross_all(const struct mesh *mesh, struct point p, struct point d,
                        struct crossing *crossings)
{
    size_t count = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const struct point a = corner_of(mesh, i, 0);
        const struct point ab = add(corner_of(mesh, i, 1), a, -1.0);
        const struct point ac = add(corner_of(mesh, i, 2), a, -1.0);
        const struct point n = cross(ab, ac);
        const double slope = dot(n, d);
        if (slope == 0.0)
            continue;
        const double distance = dot(n, add(a, p, -1.0)) / slope;
        const struct point q = add(add(p, d, distance), a, -1.0);
        const double square = dot(n, n);
        const double along_b = dot(cross(q, ac), n) / square;
        const double along_c = dot(cross(ab, q), n) / square;
        if (along_b < 0.0 || along_c < 0.0 || along_b + along_c > 1.0)
            continue;
        assert_true(count < FACES_MAX);
        crossings[count++] = (struct crossing){distance, (int)i, slope > 0.0 ? 1.0 : -1.0};
    }
    return count;
}

/* Winding number of the mesh about the ray's point there. */
static bool is_inside(const struct crossing *crossings, size_t count, double distance)
{
    double winding = 0.0;
    for (size_t i = 0; i < count; i++)
        if (crossings[i].distance > distance)
            winding += crossings[i].side;
    return winding != 0.0;
}

/* In the object's own frame. */
static struct reference_hit reference_hit_of(const struct cut_solid *solid, struct point p,
                                             struct point d, double minimum)
{
    static struct crossing crossings[FACES_MAX];
    const struct object_record *record = solid->record;
    double low = -INFINITY, high = INFINITY;
    int low_cut = 0, high_cut = 0;
    for (int i = 0; i < record->cuts; i++) {
        const struct cut_record *cut = &record->cut[i];
        const struct point normal = {cut->normal_x, cut->normal_y, cut->normal_z};
        const double at = (cut->offset - dot(normal, p)) / dot(normal, d);
        if (dot(normal, d) > 0.0 && at < high) {
            high = at;
            high_cut = i;
        } else if (dot(normal, d) <= 0.0 && at > low) {
            low = at;
            low_cut = i;
        }
    }
    struct reference_hit hit = {INFINITY, 0, {0.0, 0.0, 0.0}};
    const double first = fmax(low, minimum);
    if (first > high)
        return hit;
    const size_t count = cross_all(solid->mesh, p, d, crossings);
    for (size_t i = 0; i < count; i++)
        if (crossings[i].distance > first && crossings[i].distance <= high &&
            crossings[i].distance < hit.distance) {
            hit.distance = crossings[i].distance;
            hit.surface = crossings[i].facet;
        }
    int cut = -1;
    if (!solid->is_sheet && low > minimum && is_inside(crossings, count, low))
        cut = low_cut, hit.distance = low;
    else if (!solid->is_sheet && low <= minimum && !isfinite(hit.distance) &&
             is_inside(crossings, count, high))
        cut = high_cut, hit.distance = high;
    if (cut >= 0) {
        hit.surface = -1 - cut;
        hit.normal = (struct point){record->cut[cut].normal_x, record->cut[cut].normal_y,
                                    record->cut[cut].normal_z};
    } else if (isfinite(hit.distance)) {
        const struct point n = facet_normal(solid->mesh, (size_t)hit.surface);
        hit.normal = scaled(n, solid->is_sheet && dot(n, d) > 0.0 ? -1.0 : 1.0);
    }
    return hit;
}

/* The ray itself, others a little aside, and others that start a little sooner or later. */
#define NEIGHBOURS 19
#define THE_RAY    17

static void ask_neighbours(const struct cut_solid *solid, const struct ray *ray, double minimum,
                           struct reference_hit hits[NEIGHBOURS])
{
    const struct point centre = {solid->record->centre_x, solid->record->centre_y,
                                 solid->record->centre_z};
    const struct point p = turned(solid->record, add(ray->origin, centre, -1.0));
    const struct point d = turned(solid->record, ray->direction);
    const struct point any =
        fabs(d.x) < 0.7 ? (struct point){1.0, 0.0, 0.0} : (struct point){0.0, 1.0, 0.0};
    struct point across = cross(d, any);
    across = scaled(across, 1.0 / sqrt(dot(across, across)));
    const struct point upward = cross(across, d);
    for (int i = 0; i < NEIGHBOURS; i++) {
        const double angle = 0.25 * PI * i;
        const double shift = i < 8 ? SHIFT_M : i < 16 ? 0.1 * SHIFT_M : 0.0;
        const struct point start =
            add(add(p, across, shift * cos(angle)), upward, shift * sin(angle));
        hits[i] = reference_hit_of(solid, start, d, minimum + (i < 16 ? 0 : i - THE_RAY) * CLOSE_M);
    }
}

static bool is_same_way(struct point a, struct point b)
{
    return dot(a, b) > 1.0 - 1e-5;
}

/* Whether a normal is that of a facet that has a corner in common with another one. */
static bool is_beside(const struct mesh *mesh, int surface, struct point normal)
{
    for (size_t i = 0; surface >= 0 && i < mesh->triangle_count; i++)
        for (int k = 0; k < 9; k++)
            if (mesh->corners[3 * i + (size_t)(k % 3)] ==
                    mesh->corners[3 * (size_t)surface + (size_t)(k / 3)] &&
                fabs(dot(facet_normal(mesh, i), normal)) > 1.0 - 1e-5)
                return true;
    return false;
}

/* Whether the answer is that of the ray or of a neighbour. Where two facets meet, both are met at
 * the same distance, and either normal is right. */
static bool is_explained(const struct mesh *mesh, const struct reference_hit hits[NEIGHBOURS],
                         struct point direction, float distance, struct point normal)
{
    for (int i = 0; i < NEIGHBOURS; i++) {
        if (distance > 0.5f * FAR_AWAY && !isfinite(hits[i].distance))
            return true;
        const double allowed = CLOSE_M + SHIFT_M / fabs(dot(hits[i].normal, direction));
        if (fabs(distance - hits[i].distance) <= allowed &&
            (is_same_way(normal, hits[i].normal) || is_beside(mesh, hits[i].surface, normal)))
            return true;
    }
    return false;
}

/* A ray through a point of the object's own frame. */
static struct ray ray_through(const struct object_record *record, struct point own,
                              struct point direction)
{
    const struct point centre = {record->centre_x, record->centre_y, record->centre_z};
    const struct point aim = add(turned_back(record, own), centre, 1.0);
    const struct point way = turned_back(record, direction);
    const struct point closest = add(aim, way, -dot(aim, way));
    return ray_of(closest, way);
}

static struct ray draw_ray(const struct cut_solid *solid, int kind)
{
    const struct object_record *record = solid->record;
    const double radius = record->bounding_radius;
    struct point aim = scaled(random_direction(), radius * uniform(0.0, 1.05));
    struct point way = random_direction();
    const size_t facet = (size_t)uniform(0.0, (double)solid->mesh->triangle_count);
    if (kind == 1 || kind == 2) { /* an edge, a corner */
        const struct point a = corner_of(solid->mesh, facet, 0);
        const struct point ab = add(corner_of(solid->mesh, facet, 1), a, -1.0);
        aim = add(a, ab, kind == 1 ? uniform(0.0, 1.0) : 0.0);
    } else if (kind == 3) { /* nearly along the plane */
        const struct cut_record *cut = &record->cut[0];
        const struct point normal = {cut->normal_x, cut->normal_y, cut->normal_z};
        aim = add(aim, normal, cut->offset - dot(aim, normal));
        way = add(way, normal, -dot(way, normal) + pow(10.0, uniform(-4.0, -1.0)));
        way = scaled(way, 1.0 / sqrt(dot(way, way)));
    }
    return ray_through(record, aim, way);
}

static struct point met_normal(const struct object_record *record, const struct ray *ray,
                               float distance)
{
    const struct vector3 normal = object_normal(record, ray->p, ray->d, distance);
    const struct point in_frame = {normal.x, normal.y, normal.z};
    return turned(record, in_frame);
}

static void expect_reference(const char *name, struct cut_solid *solid)
{
    struct reference_hit hits[NEIGHBOURS];
    int on_faces = 0, on_facets = 0, aside = 0;
    for (int i = 0; i < RAYS; i++) {
        if (i % 40 == 0)
            draw_cuts(solid);
        const struct ray ray = draw_ray(solid, i % 4);
        /* from the sonar, or from near or within the solid */
        const double radius = solid->record->bounding_radius;
        const float minimum = i % 3 == 0   ? -50.0f
                              : i % 3 == 1 ? -500.0f
                                           : (float)uniform(-2.0 * radius, 2.0 * radius);
        const float distance = object_distance(solid->record, ray.p, ray.d, minimum);
        struct point normal = {0.0, 0.0, 0.0};
        if (distance < 0.5f * FAR_AWAY)
            normal = met_normal(solid->record, &ray, distance);
        ask_neighbours(solid, &ray, (double)minimum, hits);
        if (!is_explained(solid->mesh, hits, turned(solid->record, ray.direction), distance,
                          normal))
            fail_msg("%s, ray %d: met at %.9g (%g %g %g), not at %.9g on surface %d (%g %g %g)",
                     name, i, (double)distance, normal.x, normal.y, normal.z,
                     hits[THE_RAY].distance, hits[THE_RAY].surface, hits[THE_RAY].normal.x,
                     hits[THE_RAY].normal.y, hits[THE_RAY].normal.z);
        on_faces += isfinite(hits[THE_RAY].distance) && hits[THE_RAY].surface < 0;
        on_facets += isfinite(hits[THE_RAY].distance) && hits[THE_RAY].surface >= 0;
        aside += i % 4 % 3 == 0 && isfinite(hits[THE_RAY].distance) != (distance < 0.5f * FAR_AWAY);
    }
    print_message("%s: %d hits of faces, %d of facets, %d beside outlines\n", name, on_faces,
                  on_facets, aside);
    assert_true(solid->is_sheet ? on_faces == 0 : on_faces > RAYS / 20);
    assert_true(on_facets > RAYS / 20);
    assert_true(aside < RAYS / 1000);
}

static void compare_sample(const char *name, struct mesh_sample *sample)
{
    struct cut_solid solid;
    cut_solid_begin(&solid, sample);
    expect_reference(name, &solid);
    cut_solid_end(&solid);
    sample_clear(sample);
}

static void test_solids(void **state)
{
    struct mesh_sample sample;
    sample_box(&sample);
    compare_sample("box", &sample);
    sample_sphere(&sample, 3);
    compare_sample("sphere", &sample);
    sample_ring(&sample, 24, 10);
    compare_sample("ring", &sample);
}

/* A second box, of another size and place, beside the first. */
static void sample_two_boxes(struct mesh_sample *sample, double size, double along, bool is_cavity)
{
    struct mesh_sample one, other;
    sample_box(&one);
    sample_box(&other);
    sample->vertices = one.vertices + other.vertices;
    sample->triangles = one.triangles + other.triangles;
    sample->positions = calloc(3 * sample->vertices, sizeof *sample->positions);
    sample->corners = calloc(3 * sample->triangles, sizeof *sample->corners);
    assert_true(sample->positions && sample->corners);
    memcpy(sample->positions, one.positions, 3 * one.vertices * sizeof *one.positions);
    memcpy(sample->corners, one.corners, 3 * one.triangles * sizeof *one.corners);
    for (size_t i = 0; i < 3 * other.vertices; i++)
        sample->positions[3 * one.vertices + i] =
            size * other.positions[i] + (i % 3 == 0 ? along : 0.0);
    for (size_t i = 0; i < other.triangles; i++)
        for (size_t k = 0; k < 3; k++)
            sample->corners[3 * (one.triangles + i) + k] =
                other.corners[3 * i + (is_cavity ? 2 - k : k)] + (uint32_t)one.vertices;
    sample_clear(&one);
    sample_clear(&other);
}

/* The face of a cut spans all of them, but for the cavity. */
static void test_pieces(void **state)
{
    struct mesh_sample sample;
    sample_two_boxes(&sample, 0.7, 0.9, false);
    compare_sample("boxes that overlap", &sample);
    sample_two_boxes(&sample, 0.7, 0.1, true);
    compare_sample("box with a cavity", &sample);
}

static void test_sheets(void **state)
{
    struct mesh_sample sample;
    sample_ring(&sample, 24, 10);
    sample.triangles -= 40; /* open */
    compare_sample("open ring", &sample);
}

/* Rays being together or apart. */
static void test_lanes(void **state)
{
    struct mesh_sample sample;
    struct cut_solid solid;
    sample_ring(&sample, 48, 20);
    cut_solid_begin(&solid, &sample);
    for (int i = 0; i < 2000; i++) {
        struct ray single[LANES];
        if (i % 10 == 0)
            draw_cuts(&solid);
        for (int lane = 0; lane < LANES; lane++) {
            single[lane] = draw_ray(&solid, i % 4);
            if (i % 2 && lane > 0) {
                single[lane] = single[0];
                single[lane].p.x += 1e-3f * (float)lane;
            }
        }
        expect_same_in_all_lanes(solid.record, single, i % 5 ? -100.0f : 0.1f);
    }
    cut_solid_end(&solid);
    sample_clear(&sample);
}

static void test_no_way_outwards_meets_the_face_of_a_cut_again(void **state)
{
    struct mesh_sample sample;
    struct cut_solid solid;
    int tried = 0;
    sample_box(&sample);
    cut_solid_begin(&solid, &sample);
    for (int i = 0; i < RAYS; i++) {
        if (i % 40 == 0)
            draw_cuts(&solid);
        const struct ray ray = draw_ray(&solid, 0);
        const int is_met = meets_itself(solid.record, &ray, false);
        assert_true(is_met <= 0);
        tried += is_met == 0;
    }
    print_message("%d ways leave a cut box\n", tried);
    assert_true(tried > RAYS / 20);
    cut_solid_end(&solid);
    sample_clear(&sample);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solids),
        cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_sheets),
        cmocka_unit_test(test_lanes),
        cmocka_unit_test(test_no_way_outwards_meets_the_face_of_a_cut_again),
    };
    return bench_run_on_devices(tests, COUNT(tests));
}
