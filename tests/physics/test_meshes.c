/* Meshes compared with the shapes that they stand for: glints of facets by physical optics,
 * energies and shadows, plates as large as their facets, sheets with two sides, coarse facets of
 * smooth surfaces; and one mesh shown by several objects. */
#include "sea.h"

#define ROWS    121
#define COLUMNS 121
#define FAR_M   50.0
#define RANGE   40.0
#define BALL    0.25 /* radius, m */

static void add_sample(struct sea *sea, struct mesh_sample *sample, double unit_m,
                       double smooth_angle_rad)
{
    sea_add_mesh(sea, sample, unit_m, smooth_angle_rad);
    sample_clear(sample);
}

/* ---- a ball ---- */

enum ball {
    SPHERE,
    MESH
};

/* Facets of 90 deg/128. They lie up to BALL (0.0123 rad)^2 / 6 = 6 um under the sphere, and four
 * times as much at the middles of the octahedron's faces. */
#define SUBDIVISIONS 7

/* Adds a ball with its lowest point at a height. */
static sonject_object_params *add_ball(struct sea *sea, enum ball kind, int subdivisions,
                                       double height)
{
    static const enum shape_kind shapes[] = {SHAPE_SPHERE, SHAPE_MESH};
    struct mesh_sample sample;
    sonject_object_params *object =
        sea_add(sea, shapes[kind], 0.0, 0.0, kind == SPHERE ? 2.0 * BALL : 0.0);
    object->burial_m = -height;
    if (kind == MESH) {
        sample_sphere(&sample, subdivisions);
        add_sample(sea, &sample, BALL, 0.0);
    }
    return object;
}

static struct sea *open_ball(enum ball kind, int subdivisions)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, FAR_M);
    add_ball(sea, kind, subdivisions, 1.0);
    sea_ready(sea);
    return sea;
}

/* Compares in the pulse's band. Outside it, cells of other sizes leave other echoes. */
static double difference_db(const struct sea *sea, struct line one, const struct line *other)
{
    const double energy = line_energy_in_band(sea, other);
    line_add(&one, other, -1.0);
    return decibels_of_energy(line_energy_in_band(sea, &one) / energy);
}

/* Facets fine enough for a sphere's glint have its level and phase. Coarse ones, some wavelengths
 * wide, have not, but converge as their sagitta, which falls with the square of their width. */
CLAIM(facets_converge_to_the_sphere)
{
    double range, at, last = INFINITY;
    struct sea *sea = open_ball(SPHERE, 0);
    const struct line sphere = sea_line(sea, 0);
    const double peak = line_peak(sea, &sphere, &range);
    for (int subdivisions = 5; subdivisions <= 7; subdivisions++) {
        sea = open_ball(MESH, subdivisions);
        const struct line line = sea_line(sea, 0);
        const double level = decibels_of_amplitude(line_peak(sea, &line, &at) / peak);
        const double difference = difference_db(sea, line, &sphere);
        print_message("%d subdivisions: difference %.1f dB\n", subdivisions, difference);
        assert_true(difference < last - 3.0);
        last = difference;
        if (subdivisions < 7)
            continue;
        /* a depth of 24 um x 2 ways is 1.2 degrees of phase; both have cells that leave -39 dB */
        expect_close("level, dB", level, 0.0, 0.05);
        expect_close("range, mm", 1e3 * (at - range), 0.0, 0.5);
        expect_below("facets less the sphere, dB", difference, -30.0);
    }
}

/* Rays that meet sphere and mesh are the same. Energies differ by less than the facets' depth over
 * the radius, 1e-4, and by the few rays between both outlines. */
CLAIM(rough_balls_are_lit_like_the_sphere)
{
    struct tile_sums sums[2];
    for (enum ball kind = SPHERE; kind <= MESH; kind++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, FAR_M);
        make_rough(add_ball(sea, kind, SUBDIVISIONS, -0.2), 0.1);
        sea_rough(sea, &sums[kind], NULL);
        if (kind == SPHERE)
            continue;
        expect_close("echoes", sums[kind].energy / sums[0].energy, 1.0, 1e-3);
        expect_close("shadow", sums[kind].lost / sums[0].lost, 1.0, 1e-3);
        expect_close("hits", sums[kind].footprint / sums[0].footprint, 1.0, 1e-3);
    }
}

/* A box with one upper corner cut away is unlike its mirror image. Half a turn about the vertical
 * takes a view to starboard into one to port along the reverse track, where a heading h is pi - h.
 * So both show the same. A mirrored box would return 3 % less. */
CLAIM(both_sides_show_the_same)
{
    static double positions[][3] = {{-0.5, -0.2, -0.1}, {0.5, -0.2, -0.1}, {0.5, 0.2, -0.1},
                                    {-0.5, 0.2, -0.1},  {-0.5, -0.2, 0.1}, {0.5, -0.2, 0.1},
                                    {-0.5, 0.2, 0.1},   {0.1, 0.2, 0.1},   {0.5, 0.0, 0.1},
                                    {0.5, 0.2, 0.0}};
    static uint32_t corners[][3] = {
        {0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {0, 4, 6}, {0, 6, 3}, {1, 2, 9}, {1, 9, 8},
        {1, 8, 5}, {2, 3, 9}, {3, 6, 7}, {3, 7, 9}, {4, 5, 8}, {4, 8, 7}, {4, 7, 6}, {7, 8, 9}};
    const struct mesh_sample box = {positions[0], corners[0], COUNT(positions), COUNT(corners)};
    struct tile_sums sums[2];
    for (int i = 0; i < 2; i++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, FAR_M);
        sea->geometry->side = i ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        sonject_object_params *object = sea_add(sea, SHAPE_MESH, 0.0, 0.0, 0.0);
        make_rough(object, 0.1);
        object->heading_rad = i ? PI - 0.4 : 0.4;
        sea_add_mesh(sea, &box, 1.0, 0.0);
        sea_rough(sea, &sums[i], NULL);
    }
    expect_close("echoes", sums[1].energy / sums[0].energy, 1.0, 0.01);
    expect_close("shadow", sums[1].lost / sums[0].lost, 1.0, 0.01);
}

/* ---- plates ---- */

/* Makes the seabed a mirror that reflects all sound. */
static void lay_mirror(struct sea *sea)
{
    set_mirror(&sea->seabed->forward, 1.0);
}

/* Twelve facets of many wavelengths look like the box. The same rays meet both, so only single
 * precision and the rays at the edges differ. Once a face is seen straight on. */
CLAIM(a_box_of_facets_is_the_box)
{
    /* no edge lies along the track, where a box has finer cells and a mesh has not */
    static const double poses[][3] = {{0.3, 0.0, -0.25}, {-0.5, 0.1, 0.0}, {0.9, 0.3, 0.4}};
    for (size_t pose = 0; pose < COUNT(poses); pose++) {
        const struct image *images[2];
        double peak;
        for (int is_mesh = 0; is_mesh < 2; is_mesh++) {
            struct mesh_sample sample;
            struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
            sonject_object_params *object =
                sea_add(sea, is_mesh ? SHAPE_MESH : SHAPE_BOX, 1.0, 0.6, 0.0);
            object->height_m = 0.3;
            object->heading_rad = poses[pose][0];
            object->pitch_rad = poses[pose][1];
            object->roll_rad = poses[pose][2];
            sample_box(&sample);
            if (is_mesh)
                add_sample(sea, &sample, 0.5, 0.0);
            else
                sample_clear(&sample);
            images[is_mesh] = sea_image(sea);
        }
        const double difference = image_difference(images[0], images[1], &peak);
        print_message("pose %zu: ", pose);
        /* a phase of 2 k x 1e-6 m of rounding is -61 dB; a few cells of (lambda/8)^2 at the edges
         * of a face of 0.3 m^2 are less */
        expect_below("mesh less box, dB of the glint", decibels_of_amplitude(difference / peak),
                     -50.0);
    }
}

/* Returns the image of a plate: as a mesh facing the sonar (0) or away (1), or as the shape (2). */
static const struct image *image_of_sheet(int kind, bool is_rough)
{
    static double positions[][3] = {
        {-0.3, -0.2, 0.0}, {0.3, -0.2, 0.0}, {0.3, 0.2, 0.0}, {-0.3, 0.2, 0.0}};
    static uint32_t corners[][2][3] = {{{0, 1, 2}, {0, 2, 3}}, {{0, 2, 1}, {0, 3, 2}}};
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sea->injection->interactions = is_rough ? 3 : 1;
    sonject_object_params *object =
        sea_add(sea, kind < 2 ? SHAPE_MESH : SHAPE_PLANE, 0.6, 0.4, 0.0);
    object->heading_rad = 0.4; /* no edge lies along the track, where a plate has finer cells */
    object->roll_rad = -1.3;
    if (is_rough)
        make_rough(object, 0.1);
    lay_mirror(sea);
    if (kind < 2) {
        const struct mesh_sample sheet = {positions[0], corners[kind][0], 4, 2};
        sea_add_mesh(sea, &sheet, 1.0, 0.0);
    }
    return sea_image(sea);
}

/* Mirrors and chains find both sides, too. The same rays meet sheet and plate, but for rays through
 * the edges: 2 m of edges, with cells of some mm in 0.24 m^2. */
CLAIM(sheets_reflect_on_both_sides)
{
    for (int i = 0; i < 4; i++) {
        const struct image *plate = image_of_sheet(2, i / 2 > 0);
        const struct image *sheet = image_of_sheet(i % 2, i / 2 > 0);
        double peak;
        print_message("%s, side %d: ", i / 2 ? "rough" : "smooth", i % 2);
        if (i / 2)
            expect_close("energy over the plate's",
                         sum_of(sheet->target_energy, sheet->pixels) /
                             sum_of(plate->target_energy, plate->pixels),
                         1.0, 0.01);
        else
            expect_below("difference, dB of the glint",
                         decibels_of_amplitude(image_difference(plate, sheet, &peak) / peak),
                         -40.0);
    }
}

/* ---- coarse facets with smooth normals ---- */

#define RADIUS 0.3

enum sphere_kind {
    EXACT,
    FLAT,
    SMOOTH
};
static const char *const kind_names[] = {"sphere", "flat facets", "smooth facets"};

/* Returns the radius at which a unit sphere's facets together have the sphere's surface. Convex
 * bodies of equal surface show the same area on average over all directions (Cauchy). */
static double radius_of_equal_surface(const struct mesh_sample *sample)
{
    double surface = 0.0;
    for (size_t i = 0; i < sample->triangles; i++) {
        const double *a = &sample->positions[3 * sample->corners[3 * i]];
        const double *b = &sample->positions[3 * sample->corners[3 * i + 1]];
        const double *c = &sample->positions[3 * sample->corners[3 * i + 2]];
        const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        const double v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        surface +=
            0.5 * sqrt(pow(u[1] * v[2] - u[2] * v[1], 2.0) + pow(u[2] * v[0] - u[0] * v[2], 2.0) +
                       pow(u[0] * v[1] - u[1] * v[0], 2.0));
    }
    return sqrt(4.0 * PI / surface);
}

/* Opens a Lambert sphere of 128 facets (22.5 degrees), or the shape itself. */
static struct sea *open_lambert_sphere(enum sphere_kind kind, double range)
{
    struct mesh_sample sample;
    struct sea *sea = sea_open(ROWS, COLUMNS, range);
    sonject_object_params *object =
        sea_add(sea, kind == EXACT ? SHAPE_SPHERE : SHAPE_MESH, 0.0, 0.0, 2.0 * RADIUS);
    make_rough(object, 0.1);
    object->burial_m = -1.0;
    sample_sphere(&sample, 2);
    const double unit = RADIUS * radius_of_equal_surface(&sample);
    if (kind != EXACT)
        add_sample(sea, &sample, unit, kind == SMOOTH ? 1.0 : 0.0);
    else
        sample_clear(&sample);
    return sea;
}

/* Returns the rms error of the cosine c that a surface shows to rays, over cells of a strip and a
 * bin of range, weighted by energy. On a sphere c falls from 1 by the depth over the radius. With
 * exponents 1 and 2 a surface returns c and 3/2 c^3, so the ratio tells c, however echoes are
 * shared between bins. Rays are the same for all. *brightness: shown c over expected c, summed. */
static double shading_error(enum sphere_kind kind, double *brightness)
{
    struct strips tiles[2];
    double sums[4] = {0.0, 0.0, 0.0, 0.0};
    struct sea *sea = NULL;
    for (int i = 0; i < 2; i++) {
        sea = open_lambert_sphere(kind, RANGE);
        sea->injection->ray_scale = 16.0;
        sea_object(sea, 0)->material.lambert_exponent = 1.0 + i;
        sea_rough(sea, NULL, &tiles[i]);
    }
    for (int i = 0; i < tiles[0].strips * tiles[0].bins; i++) {
        const double energy = (double)tiles[0].energy[i];
        const double column =
            (double)(tiles[0].first_bin + i % tiles[0].bins) / tiles[0].bins_per_pixel;
        const double expected = (sea_slant_range(sea, 0) - sea_range(sea, column)) / RADIUS;
        if (!(energy > 0.0) || expected < 0.05)
            continue; /* the outline */
        const double shown = sqrt((double)tiles[1].energy[i] / (1.5 * energy));
        sums[0] += energy;
        sums[1] += energy * pow(shown - expected, 2.0);
        sums[2] += energy * shown;
        sums[3] += energy * expected;
    }
    assert_true(sums[0] > 0.0);
    *brightness = sums[2] / sums[3];
    return sqrt(sums[1] / sums[0]);
}

CLAIM(smooth_normals_shade_like_the_sphere)
{
    double error[3], brightness = 0.0;
    for (enum sphere_kind kind = EXACT; kind <= SMOOTH; kind++)
        error[kind] = shading_error(kind, &brightness);
    expect_below("of the sphere itself, half a bin over its radius", error[EXACT], 0.0052);
    expect_below("smooth over flat", error[SMOOTH] / error[FLAT], 1.0 / 3.5);
    /* the remaining error: facets up to 6 mm off the sphere look like 0.02 of its depth */
    expect_close("brightness", brightness, 1.0, 0.01);
}

/* A convex body sees nothing of itself, and neither do the facets that stand for one. All energy of
 * two interactions comes by way of a seabed that hardly scatters. */
CLAIM(facets_see_nothing_of_themselves)
{
    double share[3];
    for (enum sphere_kind kind = EXACT; kind <= SMOOTH; kind++) {
        struct sea *sea = open_lambert_sphere(kind, RANGE);
        sea->injection->interactions = 2;
        sea->injection->order_energies = 1;
        sea->seabed->lambert = 1e-6;
        const struct image *image = sea_image(sea);
        share[kind] = sum_of(image->order_energy[1], image->pixels) /
                      sum_of(image->order_energy[0], image->pixels);
        if (kind != EXACT) /* some thousand rays from seabed to sphere: 2 % */
            expect_close(kind_names[kind], share[kind] / share[EXACT], 1.0, 0.1);
    }
}

/* Gives the energy, by column, of paths by the seabed's mirror there or back. The sphere is lit
 * from 75 degrees beside the direction from which it is seen. */
static void mirrored_energy(enum sphere_kind kind, double columns[COLUMNS])
{
    memset(columns, 0, COLUMNS * sizeof *columns);
    for (uint32_t interactions = 2; interactions >= 1; interactions--) {
        struct sea *sea = open_lambert_sphere(kind, 13.5);
        sea->injection->ray_scale = 4.0;
        sea->injection->interactions = interactions;
        lay_mirror(sea);
        const struct image *image = sea_image(sea);
        for (size_t i = 0; i < image->pixels; i++)
            columns[i % COLUMNS] +=
                (interactions == 2 ? 1.0 : -1.0) * (double)image->target_energy[i];
    }
}

CLAIM(facets_throw_no_shadows)
{
    double exact[COLUMNS], smooth[COLUMNS], peak = 0.0, tails[2] = {0.0, 0.0};
    mirrored_energy(EXACT, exact);
    mirrored_energy(SMOOTH, smooth);
    for (size_t i = 0; i < COLUMNS; i++) {
        if (exact[i] >= peak)
            tails[0] = tails[1] = 0.0; /* the peak is still to come */
        peak = fmax(peak, exact[i]);
        tails[0] += exact[i] > 0.02 * peak ? 0.0 : exact[i];
        tails[1] += exact[i] > 0.02 * peak ? 0.0 : smooth[i];
    }
    /* within some ten facets of the shadow's edge; facets that shadow each other leave 0.25 */
    expect_close("energy where light fades out, over the sphere's", tails[1] / tails[0], 1.0, 0.4);
}

/* ---- shared by several objects ---- */

#define RINGS 3

/* Lays rings in different poses. Each object shows a mesh of its own, or all show the first one.
 * Returns the bytes of the device's buffer of objects. */
static size_t lay_rings(struct sea *sea, bool is_shared)
{
    struct rough_trace trace;
    size_t bytes = 0;
    sea->injection->interactions = 2;
    sea->injection->ray_scale = 0.2;
    for (uint32_t i = 0; i < RINGS; i++) {
        struct mesh_sample sample;
        sonject_object_params *object = sea_add(sea, SHAPE_MESH, 0.0, 0.0, 0.0);
        object->mesh = is_shared ? 0 : i;
        place_in_metres(object, 1.0, RANGE - 1.2 + i);
        object->heading_rad = 0.7 * i;
        object->pitch_rad = 1.1 * i;
        object->material.lambert = 0.05;
        object->material.roughness_m = 0.002;
        if (i > object->mesh)
            continue;
        sample_ring(&sample, 60, 40);
        add_sample(sea, &sample, 0.4, 0.5);
    }
    sea_ready(sea);
    assert_int_equal(rough_trace_begin(&trace, &sea->bench->tracer, NULL), SONJECT_OK);
    bytes = bench_buffer_bytes(sea->bench, trace.launch.buffers[LAUNCH_OBJECTS]);
    rough_trace_end(&trace);
    return bytes;
}

/* One mesh shown by several objects gives the bits of a mesh for each, and is stored once. */
CLAIM(a_mesh_of_many_objects_is_held_once)
{
    const struct image *images[2];
    size_t bytes[2], of_mesh = 0;
    for (int is_shared = 0; is_shared < 2; is_shared++) {
        struct sea *sea = sea_open(81, 161, RANGE);
        bytes[is_shared] = lay_rings(sea, is_shared > 0);
        const struct mesh_hierarchy *hierarchy = &sea->bench->scene.meshes[0].hierarchy;
        of_mesh = hierarchy->branch_count * sizeof *hierarchy->branches +
                  hierarchy->leaf_count *
                      (sizeof *hierarchy->leaves + MESH_SLOTS * sizeof(struct mesh_corner_normals));
        images[is_shared] = sea_image_of(sea, NULL, true);
    }
    assert_true(sum_of(images[0]->target_energy, images[0]->pixels) > 0.0);
    assert_false(images_differ(images[0], images[1]));
    /* meshes begin at multiples of 64 bytes */
    assert_in_range(bytes[0] - bytes[1], 2 * of_mesh, 2 * of_mesh + 2 * 128);
    assert_in_range(bytes[1], of_mesh, of_mesh + 8192);
}
