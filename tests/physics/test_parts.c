/* The union of an object's parts looks like a single shape of the same outline. Rays of the two
 * differ, so images agree as two seeds of one do. Smooth surfaces agree within sampling errors. */
#include "sea.h"

#define ROWS    161
#define COLUMNS 161
#define RANGE   40.0
#define SEEDS   4

/* The wavelength and the size of a ray's cell on the wavefront, m. */
#define WAVELENGTH 0.015
#define CELL       (WAVELENGTH / 8.0)
#define GRAZING    0.245 /* rad, about that of the sound at the objects */

/* Adds an object of one shape or of parts. The width and height of parts are those of its boxes. */
static sonject_object_params *add(struct sea *sea, enum shape_kind shape, double length,
                                  double width, double height, double diameter)
{
    sonject_object_params *object = sea_add(sea, shape, length, width, diameter);
    object->height_m = height;
    return object;
}

/* Adds a part of the first object, with the object's surface and level within it. */
static sonject_object_params *add_part(struct sea *sea, enum shape_kind shape, double length,
                                       double diameter, double along, double across, double up)
{
    static const double level[3] = {0.0, 0.0, 0.0};
    const double centre[3] = {along, across, up};
    sonject_object_params *part = sea_add_part(sea, shape, centre, level);
    part->length_m = length;
    part->diameter_m = diameter;
    return part;
}

/* Makes one of two objects that look the same. */
typedef void (*builder)(struct sea *sea, bool other);

#define LENGTH   1.2
#define DIAMETER 0.4

static void build_capsule(struct sea *sea, bool of_parts)
{
    const double straight = LENGTH - DIAMETER;
    add(sea, of_parts ? SHAPE_PARTS : SHAPE_CAPSULE, LENGTH, 0.0, 0.0, DIAMETER);
    if (!of_parts)
        return;
    add_part(sea, SHAPE_CYLINDER, straight, DIAMETER, 0.0, 0.0, 0.0);
    add_part(sea, SHAPE_SPHERE, 0.0, DIAMETER, 0.5 * straight, 0.0, 0.0);
    add_part(sea, SHAPE_SPHERE, 0.0, DIAMETER, -0.5 * straight, 0.0, 0.0);
}

static void build_box(struct sea *sea, bool of_parts)
{
    add(sea, of_parts ? SHAPE_PARTS : SHAPE_BOX, 1.0, 0.6, 0.4, 0.0);
    if (!of_parts)
        return;
    add_part(sea, SHAPE_BOX, 0.7, 0.0, -0.15, 0.0, 0.0);
    add_part(sea, SHAPE_BOX, 0.3, 0.0, 0.35, 0.0, 0.0);
}

/* Two spheres in one place. No sound meets the second, here and in build_hidden_sphere. */
static void build_spheres(struct sea *sea, bool of_parts)
{
    add(sea, of_parts ? SHAPE_PARTS : SHAPE_SPHERE, 0.0, 0.0, 0.0, 0.6);
    if (!of_parts)
        return;
    add_part(sea, SHAPE_SPHERE, 0.0, 0.6, 0.0, 0.0, 0.0);
    add_part(sea, SHAPE_SPHERE, 0.0, 0.6, 0.0, 0.0, 0.0);
}

static void build_hidden_sphere(struct sea *sea, bool of_parts)
{
    add(sea, of_parts ? SHAPE_PARTS : SHAPE_SPHERE, 0.0, 0.0, 0.0, 0.6);
    if (!of_parts)
        return;
    add_part(sea, SHAPE_SPHERE, 0.0, 0.6, 0.0, 0.0, 0.0);
    add_part(sea, SHAPE_SPHERE, 0.0, 0.4, 0.05, -0.05, 0.02);
}

/* A lopsided object on the starboard side, or its mirror image on the port side. Poses are counted
 * in the image, where both look the same. Parts left of one nose are right of the other. */
static void build_lopsided(struct sea *sea, bool is_starboard)
{
    const double hand = is_starboard ? 1.0 : -1.0;
    const double centre[3] = {-0.4, -0.2 * hand, 0.2}, pose[3] = {0.7 * hand, 0.3, 0.4 * hand};
    sea->geometry->side = is_starboard ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
    add(sea, SHAPE_PARTS, 0.0, 0.0, 0.0, 0.0);
    add_part(sea, SHAPE_CYLINDER, 1.0, 0.2, 0.0, 0.0, 0.0);
    add_part(sea, SHAPE_SPHERE, 0.0, 0.4, 0.5, 0.3 * hand, 0.1);
    sonject_object_params *turned = sea_add_part(sea, SHAPE_CYLINDER, centre, pose);
    turned->length_m = 0.8;
    turned->diameter_m = 0.2;
}

/* A box with an upright cylinder sunk into its top, once as parts, once as the mesh of their union,
 * whose round facets lie within 0.005 mm of the cylinder. */
#define SECTORS    512 /* a multiple of 8, so that the square's corners are among them */
#define HALF_WIDTH 0.4 /* of the box, m */
#define BOX_TOP    0.3
#define RADIUS     0.25
#define TOP        0.8
#define SUNK       0.1 /* depth of the cylinder in the box */

/* Rings of vertices from the bottom to the top, SECTORS each, then the middles of both ends. */
enum ring {
    BOX_BELOW,
    BOX_ABOVE,
    CYLINDER_BELOW,
    CYLINDER_ABOVE,
    RINGS
};

static void put_vertex(double *positions, size_t number, double x, double y, double z)
{
    positions[3 * number] = x;
    positions[3 * number + 1] = y;
    positions[3 * number + 2] = z;
}

static void put_triangle(uint32_t **corners, uint32_t a, uint32_t b, uint32_t c)
{
    (*corners)[0] = a;
    (*corners)[1] = b;
    (*corners)[2] = c;
    *corners += 3;
}

static void build_union(struct sea *sea, bool is_mesh)
{
    add(sea, is_mesh ? SHAPE_MESH : SHAPE_PARTS, 0.0, 2.0 * HALF_WIDTH, BOX_TOP, 2.0 * RADIUS);
    if (!is_mesh) { /* a mesh has its origin in its middle, and so have the parts */
        const double length = TOP - BOX_TOP + SUNK;
        const double centre[3] = {0.0, 0.0, 0.5 * (TOP - length)}, upright[3] = {0, 0.5 * PI, 0};
        add_part(sea, SHAPE_BOX, 2.0 * HALF_WIDTH, 0.0, 0.0, 0.0, 0.5 * (BOX_TOP - TOP));
        sea_add_part(sea, SHAPE_CYLINDER, centre, upright)->length_m = length;
        return;
    }
    const size_t vertices = RINGS * SECTORS + 2;
    double *positions = claim_memory(vertices, 3 * sizeof *positions);
    uint32_t *corners = claim_memory(8 * SECTORS, 3 * sizeof *corners), *end = corners;
    for (size_t i = 0; i < SECTORS; i++) {
        const double angle = 2.0 * PI * (double)i / SECTORS;
        const double x = cos(angle);
        const double y = sin(angle);
        const double to_square = HALF_WIDTH / fmax(fabs(x), fabs(y));
        put_vertex(positions, BOX_BELOW * SECTORS + i, to_square * x, to_square * y, 0.0);
        put_vertex(positions, BOX_ABOVE * SECTORS + i, to_square * x, to_square * y, BOX_TOP);
        put_vertex(positions, CYLINDER_BELOW * SECTORS + i, RADIUS * x, RADIUS * y, BOX_TOP);
        put_vertex(positions, CYLINDER_ABOVE * SECTORS + i, RADIUS * x, RADIUS * y, TOP);
    }
    put_vertex(positions, vertices - 2, 0.0, 0.0, 0.0);
    put_vertex(positions, vertices - 1, 0.0, 0.0, TOP);
    for (uint32_t i = 0; i < SECTORS; i++) {
        const uint32_t next = (i + 1) % SECTORS;
        put_triangle(&end, (uint32_t)vertices - 2, next, i);
        for (uint32_t ring = BOX_BELOW; ring < CYLINDER_ABOVE; ring++) {
            const uint32_t below = ring * SECTORS;
            const uint32_t above = below + SECTORS;
            put_triangle(&end, below + i, below + next, above + next);
            put_triangle(&end, below + i, above + next, above + i);
        }
        put_triangle(&end, (uint32_t)vertices - 1, CYLINDER_ABOVE * SECTORS + i,
                     CYLINDER_ABOVE * SECTORS + next);
    }
    const struct mesh_sample mesh = {positions, corners, vertices, 8 * SECTORS};
    sea_add_mesh(sea, &mesh, 1.0, 0.0);
}

/* Makes the object and its parts rough. */
static void make_all_rough(struct sea *sea)
{
    sonject_material_params material = sea_object(sea, 0)->material;
    material.reflection = 0.0;
    material.lambert = 0.1;
    sea_set_material(sea, &material);
}

static const struct image *compute(builder build, bool other, bool is_rough, const double pose[3],
                                   uint64_t seed)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    build(sea, other);
    sonject_object_params *object = sea_object(sea, 0);
    object->heading_rad = pose[0];
    object->pitch_rad = pose[1];
    object->roll_rad = pose[2];
    if (is_rough)
        make_all_rough(sea);
    sea->injection->seed = seed;
    return sea_image(sea);
}

/* Returns a pixel's energy of targets, or its visibility. is_reversed: rows run the other way. */
static double value_at(const struct image *image, bool is_energy, bool is_reversed, size_t i)
{
    const size_t at = is_reversed ? (ROWS - 1 - i / COLUMNS) * COLUMNS + i % COLUMNS : i;
    return is_energy ? (double)image->target_energy[at]
                     : 1.0 - (double)image->lost_energy[at] / image->seabed_energy[at];
}

/* Compares images of both objects, SEEDS each. Mean square differences between both, over those
 * between seeds of one, are 1 if the objects are the same. Some thousand pixels in 16 pairs tell
 * within a few per cent. A visible joint, or a shadow that is a pixel off, changes much more. */
static void expect_same_rough_object(builder build, const double pose[3])
{
    const struct image *images[2 * SEEDS];
    for (size_t i = 0; i < 2 * SEEDS; i++)
        images[i] = compute(build, i >= SEEDS, true, pose, i + 1);
    for (int is_energy = 0; is_energy < 2; is_energy++) {
        double between = 0.0, within = 0.0, totals[2 * SEEDS] = {0.0};
        for (size_t i = 0; i < 2 * SEEDS; i++)
            for (size_t k = 0; k <= i; k++) {
                const bool is_same = (i < SEEDS) == (k < SEEDS);
                double *sum = is_same ? &within : &between;
                for (size_t at = 0; at < ROWS * COLUMNS; at++) {
                    const bool reverses = build == build_lopsided;
                    const double one = value_at(images[i], is_energy, reverses && i >= SEEDS, at);
                    const double two = value_at(images[k], is_energy, reverses && k >= SEEDS, at);
                    *sum +=
                        (one - two) * (one - two) / (is_same ? SEEDS * (SEEDS - 1) : SEEDS * SEEDS);
                    totals[i] += k == i ? one : 0.0;
                }
            }
        struct estimate other = estimate_of(totals + SEEDS, SEEDS);
        const struct estimate one = estimate_of(totals, SEEDS);
        other.error = hypot(one.error, other.error);
        print_message("%s: ", is_energy ? "energy" : "visibility");
        expect_estimate("total", other, one.mean, 1e-6 * one.mean);
        expect_close("differences over those of seeds", between / within, 1.0, 0.1);
    }
}

/* Compares glints within the error of a pixel that had all of the rays' chance errors. A cell of
 * the wavefront that an edge divides is hit or missed: 0.29 of its area (a uniform number's
 * deviation) over the wavelength. In truth these errors spread over dozens of pixels. outlines:
 * length of the edges, m. */
static void expect_same_smooth_object(builder build, const double pose[3], double outlines)
{
    double peak;
    const double largest = image_difference(compute(build, false, false, pose, 1),
                                            compute(build, true, false, pose, 1), &peak);
    print_message("glint of %.1f dB re 1 m: ", decibels_of_amplitude(peak));
    expect_below("largest difference, dB", decibels_of_amplitude(largest),
                 decibels_of_amplitude(0.29 * sqrt(outlines / CELL) * CELL * CELL / WAVELENGTH));
}

/* Objects are rough in the first pose and smooth in all. The capsule lies in any pose, broadside,
 * and nose to the sonar, where the ends of the cylinder within would mirror the most. Its edges are
 * two outlines and half of the joints' four sides. The box has a face to the sonar: a long one,
 * with the joint in it, and the nose, behind which the joint lies like another face. The lopsided
 * one is rough. The mesh of a union is turned about the vertical, and tipped. Facets of its
 * cylinder are 3 mm wide and lie 0.005 mm within it, 0.004 rad of phase. Edges are 10 m long. */
CLAIM(parts_look_like_the_shape_they_make_up)
{
    const double outline = 2.0 * (LENGTH - DIAMETER) + PI * DIAMETER;
    const struct {
        const char *name;
        builder build;
        size_t poses;
        double pose[3][3], outlines;
    } cases[] = {
        {"capsule",
         build_capsule,
         3,
         {{0.6, 0.2, 0.0}, {0.0, 0.0, 0.0}, {-0.5 * PI, GRAZING, 0.0}},
         2.0 * outline + 2.0 * PI * DIAMETER},
        {"box",
         build_box,
         3,
         {{-1.0, 0.0, 0.15}, {0.0, 0.0, -GRAZING}, {-0.5 * PI, GRAZING, 0.0}},
         2.0 * (1.0 + 0.6 + 0.4) * 2.0},
        {"lopsided", build_lopsided, 0, {{0.5, 0.1, 0.2}}, 0.0},
        {"union", build_union, 2, {{0.4, 0.0, 0.0}, {0.0, 0.0, -GRAZING}}, 10.0},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        print_message("%s\n", cases[i].name);
        expect_same_rough_object(cases[i].build, cases[i].pose[0]);
        for (size_t pose = 0; pose < cases[i].poses; pose++)
            expect_same_smooth_object(cases[i].build, cases[i].pose[pose], cases[i].outlines);
    }
}

/* A union's mesh scatters as much to itself as the parts scatter to one another. */
CLAIM(a_mesh_of_the_union_lights_itself)
{
    double shares[2][SEEDS];
    for (int i = 0; i < 2 * SEEDS; i++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        build_union(sea, i % 2 > 0);
        make_all_rough(sea);
        sea_object(sea, 0)->burial_m = -1.0;
        sea->seabed->lambert = 1e-6; /* so that all goes from object to object */
        sea->injection->interactions = 2;
        sea->injection->order_energies = 1;
        sea->injection->seed = (uint64_t)i + 1;
        const struct image *image = sea_image(sea);
        shares[i % 2][i / 2] = sum_of(image->order_energy[1], image->pixels) /
                               sum_of(image->order_energy[0], image->pixels);
    }
    const struct estimate parts = estimate_of(shares[0], SEEDS);
    struct estimate mesh = estimate_of(shares[1], SEEDS);
    mesh.error = hypot(mesh.error, parts.error);
    assert_true(parts.mean > 1e-3);
    expect_estimate("share of two interactions", mesh, parts.mean, 1e-3 * parts.mean);
}

/* The second of two parts in one place, and a part within another, add no echo and hide nothing.
 * The first one's rays are those of the object by itself. */
CLAIM(hidden_parts_change_no_bit)
{
    static const double level[3] = {0.0, 0.0, 0.0};
    static const builder builders[] = {build_spheres, build_hidden_sphere};
    for (int i = 0; i < 4; i++) {
        const struct image *one = compute(builders[i / 2], false, i % 2 > 0, level, 1);
        const struct image *other = compute(builders[i / 2], true, i % 2 > 0, level, 1);
        const size_t bytes = one->pixels * sizeof(float);
        assert_true(sum_of(one->target_energy, one->pixels) > 0.0);
        assert_memory_equal(one->target, other->target, one->pixels * sizeof *one->target);
        assert_memory_equal(one->target_energy, other->target_energy, bytes);
        assert_memory_equal(one->lost_energy, other->lost_energy, bytes);
    }
}

/* An object has a sphere ahead and a box behind, which stays level as the object is pitched. Bounds
 * are exact but for double precision. */
CLAIM(parts_rest_on_the_seabed)
{
    for (uint32_t i = 0; i < 6; i++) {
        const double pitch = 0.3, lowest = -0.5 * sin(pitch) - 0.1;
        const double height = sin(pitch) + 0.2 - lowest;
        const double bottom = i / 2 == 0 ? -0.05 : i / 2 == 1 ? -0.25 * height : 0.3 - height;
        const double behind[3] = {-0.5, 0.0, 0.0}, level[3] = {0.0, -pitch, 0.0};
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea->geometry->side = i % 2 ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        sonject_object_params *object = add(sea, SHAPE_PARTS, 0.0, 0.4, 0.2, 0.0);
        object->heading_rad = 0.7;
        object->pitch_rad = pitch;
        object->burial_kind = i / 2;
        object->burial_m = 0.05;
        object->burial_fraction = 0.25;
        object->proud_height_m = 0.3;
        add_part(sea, SHAPE_SPHERE, 0.0, 0.4, 1.0, 0.0, 0.0);
        sea_add_part(sea, SHAPE_BOX, behind, level)->length_m = 0.6;
        sea_ready(sea);
        const struct placed_object *placed = &sea->bench->placed.objects[0];
        expect_close("lowest point, m", placed->bottom_m, bottom, 1e-12);
        expect_close("highest point, m", placed->top_m, bottom + height, 1e-12);
        expect_close("origin, m", placed->origin[2], bottom - lowest, 1e-12);
    }
}
