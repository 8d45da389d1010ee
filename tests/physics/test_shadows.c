/* Shadows lie where rays put them and count once, and starboard mirrors port. */
#include "sea.h"

#define ROWS    201
#define COLUMNS 401
#define RANGE   40.0

/* Returns the visibility, pixel by pixel, with many rays. */
static const double *trace_visibility(struct sea *sea)
{
    sea->injection->ray_scale = 16.0;
    const double *visibility = visibility_of(sea_image(sea));
    for (size_t i = 0; i < sea->pixels; i++) /* single precision sums of the same energies */
        assert_true(visibility[i] > -1e-5 && visibility[i] < 1.0 + 1e-5);
    return visibility;
}

/* Gives the visibility along the track, a mean over some columns. Where an edge runs along the
 * rays, each ray of a strip is hidden or not by chance. */
static void along_track(const double *visibility, size_t first_column, size_t columns,
                        double line[ROWS])
{
    for (size_t row = 0; row < ROWS; row++) {
        line[row] = 0.0;
        for (size_t column = first_column; column < first_column + columns; column++)
            line[row] += visibility[row * COLUMNS + column] / (double)columns;
    }
}

static double column_of_ground(const struct sea *sea, double ground_range)
{
    return sea_column(sea, hypot(ground_range, sea->sonar->altitude_m));
}

/* A level plate at height H hides the ground from y h/(h - H) of its near edge to that of its far
 * edge, H y/(h - H) behind each. Half a pixel is required. Stratified rays draw a tenth of it. */
CLAIM(the_shadow_of_a_flat_top)
{
    static const double heights[] = {0.3, 0.6, 1.0};
    for (size_t i = 0; i < 3; i++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea_add(sea, SHAPE_PLANE, 2.0, 1.2, 0.0)->burial_m = -heights[i];
        const double *visibility = trace_visibility(sea), *row = visibility + 100 * COLUMNS;
        const double h = sea->sonar->altitude_m, centre = sea_centre(sea, 0)[1];
        const double near = (centre - 0.6) * h / (h - heights[i]);
        const double far = (centre + 0.6) * h / (h - heights[i]);
        const size_t middle = (size_t)column_of_ground(sea, 0.5 * (near + far));
        print_message("height %.1f m\n", heights[i]);
        expect_close("shadow begins, column", shadow_edge(row, 0, middle),
                     column_of_ground(sea, near), 0.05);
        expect_close("shadow ends, column", shadow_edge(row, middle, COLUMNS - 1),
                     column_of_ground(sea, far), 0.05);
        /* the plate's middle is on row 100, its ends 1 m = 40 rows away; 20 columns of some 130
         * rays each: 0.5/sqrt(2600) is 0.01, 0.02 rows */
        double line[ROWS];
        along_track(visibility, middle - 10, 21, line);
        expect_close("shadow's side, row", shadow_edge(line, 0, 100), 60.0, 0.08);
        expect_close("shadow's other side, row", shadow_edge(line, 100, ROWS - 1), 140.0, 0.08);
        expect_below("visibility in the middle", row[middle], 0.02);
    }
}

/* A source of side s is centred on the receiver. Beside the shadow of a plate at height H, ground x
 * away from the edge is hidden from the part of the source beyond x h/H along the track. So each
 * side of the shadow lacks s H/8h of the seabed's energy. Energy that the receiver cannot see is
 * lost to the plate, and does not lack. The plate is so wide in range that it hides its middle from
 * all of the source. Echoes lie o^2/4r farther, along a level that falls: 0.02 rows brighter.
 * Standard errors are 0.022 of hiding and 0.016 of the cosine; four are 0.11. */
CLAIM(a_wide_source_dims_the_sides_of_a_shadow)
{
    const double height = 1.0, sides[] = {0.0, 2.0};
    double sums[2] = {0.0, 0.0};
    for (int i = 0; i < 2; i++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea->sonar->transducer_side_m = sides[i];
        sea->injection->ray_scale = 16.0;
        sea_add(sea, SHAPE_PLANE, 2.0, 2.0, 0.0)->burial_m = -height;
        const struct image *image = sea_image(sea);
        const double h = sea->sonar->altitude_m;
        const size_t middle =
            (size_t)column_of_ground(sea, sea_centre(sea, 0)[1] * h / (h - height));
        for (size_t row = 0; row < ROWS; row++)
            for (size_t column = middle - 10; column <= middle + 10; column++)
                sums[i] += image->seabed_energy[row * COLUMNS + column];
    }
    expect_close("energy lacking beside the shadow, rows", ROWS * (1.0 - sums[1] / sums[0]),
                 2.0 * sides[1] * height / (8.0 * 10.0) / 0.025 - 0.02, 0.11);
}

/* Rays tangent to the sphere, in the plane through its centre, bound the shadow. The rows beside,
 * which |W|^2 brings in, have a shorter one. In the middle the shadow is as wide as the sphere. */
CLAIM(the_shadow_of_a_sphere)
{
    static const double radii[] = {0.25, 0.35}, lifts[] = {0.0, 0.2};
    for (size_t i = 0; i < 4; i++) {
        const double a = radii[i % 2];
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea_add_sphere(sea, a, lifts[i / 2]);
        const double *visibility = trace_visibility(sea), *row = visibility + 100 * COLUMNS;
        const double *centre = sea_centre(sea, 0), h = sea->sonar->altitude_m;
        const double depression = atan2(h - centre[2], centre[1]);
        const double half = asin(a / hypot(h - centre[2], centre[1]));
        const double near = column_of_ground(sea, h / tan(depression + half));
        const double far = column_of_ground(sea, h / tan(depression - half));
        const size_t middle = (size_t)(0.5 * (near + far));
        print_message("radius %.2f m, %.1f m over the seabed\n", a, lifts[i / 2]);
        expect_close("shadow begins, column", shadow_edge(row, 0, middle), near, 0.06);
        expect_close("shadow ends, column", shadow_edge(row, middle, COLUMNS - 1), far, 0.06);
        double line[ROWS];
        along_track(visibility, (size_t)(column_of_ground(sea, h / tan(depression)) + 0.5), 1,
                    line);
        expect_close("width, rows", shadow_edge(line, 100, ROWS - 1) - shadow_edge(line, 0, 100),
                     2.0 * a / 0.025, 0.15);
    }
}

/* Injects a tilted plate off the middle into an even patch, so that nothing is symmetric. */
static const struct injected *inject_plate(struct sea *sea, double row, double heading, double roll)
{
    float *pixels = claim_memory(sea->pixels, sizeof *pixels);
    for (size_t i = 0; i < sea->pixels; i++)
        pixels[i] = 1.0f;
    sonject_object_params *object = sea_add(sea, SHAPE_PLANE, 1.0, 0.7, 0.0);
    place_in_pixels(object, row, 180.0);
    object->heading_rad = heading;
    object->pitch_rad = 0.3;
    object->roll_rad = roll;
    object->material.lambert = 0.05;
    object->material.reflection = 0.5;
    object->material.roughness_m = 1e-3;
    return sea_inject(sea, pixels, false);
}

/* Starboard is port seen from the other end: rows are reversed, a heading h becomes pi - h, and
 * roll changes its sign. The same rays are traced, so every bit agrees. */
CLAIM(starboard_is_port_from_the_other_end)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sea->geometry->first_along_track_m = -200.0 * 0.025;
    const struct injected *port = inject_plate(sea, 200.0 - 80.0, PI - 0.5, -0.25);
    sea = sea_open(ROWS, COLUMNS, RANGE);
    sea->geometry->side = SONJECT_SIDE_STARBOARD;
    const struct injected *starboard = inject_plate(sea, 80.0, 0.5, 0.25);
    size_t shaded = 0;
    for (size_t i = 0; i < sea->pixels; i++) {
        const size_t j = (ROWS - 1 - i / COLUMNS) * COLUMNS + i % COLUMNS;
        assert_true(starboard->energy[i] == port->energy[j]);
        assert_true(starboard->visibility[i] == port->visibility[j]);
        assert_true(starboard->image[i] == port->image[j]);
        assert_true(starboard->field[2 * i] == port->field[2 * j]);
        assert_int_equal(starboard->labels[i], port->labels[j]);
        shaded += starboard->visibility[i] < 0.5f;
    }
    assert_true(shaded > 100);
    expect_close("row of the truth", starboard->objects[0].row, 80.0, 1e-9);
}

/* A scene makes the same image on both sides, since poses are meant in ping order. Other
 * rays are traced, so energies agree as far as the number of rays allows. */
CLAIM(sides_look_alike)
{
    const struct injected *sides[2];
    double difference = 0.0, sum = 0.0;
    for (int side = 0; side < 2; side++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea->injection->ray_scale = 4.0;
        sea->geometry->side = side ? SONJECT_SIDE_STARBOARD : SONJECT_SIDE_PORT;
        sides[side] = inject_plate(sea, 80.0, 0.5, 0.25);
    }
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        difference += fabs(sides[1]->visibility[i] - sides[0]->visibility[i]);
        sum += 1.0 - sides[0]->visibility[i];
    }
    /* a pixel on the shadow's edge has some 100 rays: a few per cent of the edge's pixels, which
     * are a tenth of the shadow. A turned plate would share half of its shadow at best. */
    expect_below("shadows' difference over their area", difference / sum, 0.02);
}

/* A ball hides as much seabed when 39 others stand in its shadow or inside it. Seabed that is
 * hidden twice is lost once. */
CLAIM(shadows_are_lost_once)
{
    double hidden[2] = {0.0, 0.0};
    for (int is_crowded = 0; is_crowded < 2; is_crowded++) {
        static struct tile_sums sums[40];
        struct sea *sea = sea_open(400, 400, 25.0);
        for (int i = 0; is_crowded && i < 39; i++) /* inside, or behind within the ball's shadow */
            place_in_pixels(sea_add_sphere(sea, 0.025, 0.0), 200.0 + 1.5 * (i % 3 - 1),
                            150.0 + 0.6 * i);
        place_in_pixels(sea_add_sphere(sea, 0.3, 0.0), 200.0, 150.0);
        sea_rough(sea, sums, NULL);
        for (int i = 0; i < (is_crowded ? 40 : 1); i++)
            hidden[is_crowded] += sums[i].lost;
    }
    assert_true(hidden[0] > 0.0);
    expect_close("hidden in a crowd over alone", hidden[1] / hidden[0], 1.0, 1e-6);
}
