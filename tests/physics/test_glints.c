/* Glints compared with the closed forms of physical optics: level, range and phase of each shape's
 * glint, and its image. Levels have a systematic tolerance of 0.2 dB. */
#include "sea.h"

#define ROWS       201
#define COLUMNS    201
#define RANGE      50.0
#define LEVEL_DB   0.2
#define PHASE      0.05 /* rad; the next order of stationary phase is 1/(2ka), 1/250 for 0.3 m */
#define WAVELENGTH 0.015

/* Opens a sea with a shape 1 m over the seabed. */
static struct sea *open_with(enum shape_kind shape, double length, double width, double height,
                             double diameter)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sonject_object_params *object = sea_add(sea, shape, length, width, diameter);
    object->height_m = height;
    object->burial_m = -1.0;
    sea_ready(sea);
    return sea;
}

static void turn(struct sea *sea, double heading_deg, double pitch_deg, double roll_deg)
{
    sonject_object_params *object = sea_object(sea, 0);
    object->heading_rad = heading_deg * PI / 180.0;
    object->pitch_rad = pitch_deg * PI / 180.0;
    object->roll_rad = roll_deg * PI / 180.0;
    sea_ready(sea);
}

/* A rigid sphere echoes a/2, all sub-strips together. With the wavefront's own curvature in
 * elevation (the fan is a line of circular fans) it is a/2 / sqrt(1 + a/r). A wrong sound speed in
 * the processor scales ranges by c_ref/c. Amplitudes are normalised by the square of the
 * processor's range, so they scale by the square. */
CLAIM(a_sphere_echoes_half_its_radius)
{
    static const struct {
        double radius, range, reference_speed;
    } cases[] = {{0.15, RANGE, 1500.0}, {0.3, RANGE, 1500.0}, {0.5, RANGE, 1500.0},
                 {0.15, 450.0, 1500.0}, {0.3, 450.0, 1500.0}, {0.5, 450.0, 1500.0},
                 {0.3, RANGE, 1425.0}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const double a = cases[i].radius, ratio = cases[i].reference_speed / 1500.0;
        struct sea *sea = sea_open(ROWS, COLUMNS, cases[i].range);
        double range;
        sea->medium->reference_sound_speed_mps = cases[i].reference_speed;
        sea_add_sphere(sea, a, 1.0);
        const double peak = sea_peak(sea, &range), nearest = sea_slant_range(sea, 0) - a;
        print_message("sphere of radius %.2f m at %.0f m\n", a, cases[i].range);
        expect_close("level re a/2, dB", decibels_of_amplitude(peak / (0.5 * a * ratio * ratio)),
                     -decibels_of_amplitude(sqrt(1.0 + a / nearest)), LEVEL_DB);
        /* to a bin: 1/16 of the pulse's deviation */
        expect_close("range, m", range, nearest * ratio, 0.002);
    }
}

/* Spheres down to half a wavelength echo a/2 within 2 dB. The errors are physical optics' false
 * echo of the terminator and cells of an eighth of a wavelength. */
CLAIM(smallest_spheres_echo)
{
    static const double radii[] = {0.2505, 0.4, 0.5, 0.8}; /* wavelengths */
    for (size_t i = 0; i < COUNT(radii); i++) {
        const double a = radii[i] * WAVELENGTH;
        struct sea *sea = open_with(SHAPE_SPHERE, 0.0, 0.0, 0.0, 2.0 * a);
        print_message("sphere of radius %.1f mm\n", 1e3 * a);
        expect_close("small sphere's level re a/2, dB",
                     decibels_of_amplitude(sea_peak(sea, NULL) / (0.5 * a)), 0.0, 2.0);
    }
}

/* Returns the expected energy of a Lambert sphere over its radius squared, in long pixels. */
static double rough_energy(double a, uint64_t seed)
{
    struct sea *sea = sea_open(41, 41, RANGE);
    sea->geometry->row_spacing_m = 0.1;
    sea->injection->seed = seed;
    make_rough(sea_add_sphere(sea, a, 0.1), 0.1);
    const struct image *image = sea_image(sea);
    return sum_of(image->target_energy, image->pixels) / (a * a);
}

/* 16 rays meet the smallest rough sphere, so each run knows its energy to a quarter. The mean of
 * all agrees with the large sphere's to 4 standard errors and 1 %. */
CLAIM(the_smallest_rough_sphere_keeps_its_energy)
{
    double ratios[16];
    const double large = rough_energy(0.2, 1);
    for (size_t i = 0; i < COUNT(ratios); i++)
        ratios[i] = rough_energy(0.2505 * WAVELENGTH, i + 1) / large;
    const struct estimate ratio = estimate_of(ratios, COUNT(ratios));
    expect_estimate("mean over the large sphere's", ratio, 1.0, 0.01);
    expect_below("deviation of one run", ratio.error * sqrt(COUNT(ratios) - 1.0), 0.4);
}

/* A target's front, depth(x, w) behind its nearest point, with x and w across the line of sight.
 * Its echo is -i/lambda times the integral of W(x) exp(2ik depth + ik w^2/r) G(offset - depth),
 * since the wavefront is curved in elevation alone. resolution 0: no W. depth < 0: nothing
 * there. */
struct front {
    double (*depth)(double x, double w, const double *sizes);
    const double *sizes;
    double half_side; /* of the square that holds the front, m */
};

static double complex optics(const struct sea *sea, const struct front *front, double distance,
                             double offset, double resolution)
{
    const double k = sea_wavenumber(sea), step = WAVELENGTH / 24.0;
    double complex sum = 0.0;
    for (double x = -front->half_side + 0.5 * step; x < front->half_side; x += step)
        for (double w = -front->half_side + 0.5 * step; w < front->half_side; w += step) {
            const double depth = front->depth(x, w, front->sizes);
            if (depth >= 0.0)
                sum += cexp(I * k * (2.0 * depth + w * w / distance)) * step * step *
                       sea_pulse(sea, offset - depth) *
                       (resolution > 0.0 ? sinc(x / resolution) : 1.0);
        }
    return -I / WAVELENGTH * sum;
}

static double disc_depth(double x, double w, const double *sizes)
{
    return hypot(x, w) <= sizes[0] ? 0.0 : -1.0;
}

static double rectangle_depth(double x, double w, const double *sizes)
{
    return fabs(x) <= sizes[0] && fabs(w) <= sizes[1] ? 0.0 : -1.0;
}

/* sizes: half lengths along the track and across the sight, and the tangent of the tilt. */
static double tilted_depth(double x, double w, const double *sizes)
{
    return fabs(x) <= sizes[0] && fabs(w) <= sizes[1] ? (w + sizes[1]) * sizes[2] : -1.0;
}

static double cone_depth(double x, double w, const double *sizes)
{
    const double rho = hypot(x, w);
    return rho <= sizes[0] ? rho * sizes[1] : -1.0;
}

/* A capsule off broadside shows the ball of one end: sqrt(R1 R2)/2 at the specular point. The joint
 * of ball and tube is at least 2.5 Fresnel radii sqrt(lambda a/2) from the point here. */
CLAIM(a_capsule_shows_the_ball_of_an_end)
{
    static const double degrees[][2] = {{30.0, 0.0}, {-45.0, 15.0}, {60.0, -20.0}, {90.0, 10.0}};
    for (size_t i = 0; i < COUNT(degrees); i++) {
        struct sea *sea = open_with(SHAPE_CAPSULE, 2.3, 0.0, 0.0, 0.6);
        sea_object(sea, 0)->burial_m = -2.0;
        turn(sea, degrees[i][0], degrees[i][1], 0.0);
        print_message("heading %.0f, pitch %.0f degrees\n", degrees[i][0], degrees[i][1]);
        expect_close("capsule's level re a/2, dB",
                     decibels_of_amplitude(sea_peak(sea, NULL) / 0.15), 0.0, LEVEL_DB);
    }
}

/* A wall seen broadside is a plane in x. The tube's curvature and the wavefront's add: 1/R = 1/a +
 * 1/r. sigma = R L^2 / (2 lambda). An open tube echoes as a solid cylinder does, and along its axis
 * lets the sound through. */
CLAIM(a_cylinder_broadside)
{
    const double curvature = 1.0 / (1.0 / 0.15 + 1.0 / RANGE);
    double along[2];
    for (int is_open = 0; is_open < 2; is_open++) {
        struct sea *sea = open_with(SHAPE_CYLINDER, 1.0, 0.0, 0.0, 0.3);
        sonject_object_params *object = sea_object(sea, 0);
        object->nose_end = object->tail_end = is_open ? SONJECT_END_OPEN : SONJECT_END_FLAT;
        expect_close("no W, dB re 1 m^2", decibels_of_amplitude(sea_peak(sea, NULL)),
                     decibels_of_energy(curvature / (2.0 * WAVELENGTH)), LEVEL_DB);
        /* a pixel at the middle: the sinc's integral over the wall is delta within 1/(pi^2 20) */
        const double column = sea_column(sea, sea_slant_range(sea, 0) - 0.15);
        const double nearest = floor(column + 0.5);
        const double complex pixel = sea_image(sea)->target[100 * COLUMNS + (size_t)nearest];
        expect_close("a pixel, dB re 1 m^2", decibels_of_amplitude(cabs(pixel)),
                     decibels_of_energy(curvature * 0.025 * 0.025 / (2.0 * WAVELENGTH)) +
                         decibels_of_amplitude(sea_pulse(sea, (column - nearest) * 0.025)),
                     LEVEL_DB);
        face_sonar(sea, 0.0);
        along[is_open] = sea_peak(sea, NULL);
    }
    expect_below("open end on, dB re solid", decibels_of_amplitude(along[1] / along[0]), -20.0);
}

/* Returns the amplitude off axis: sqrt(a cos(theta) / 2 lambda) |integral over the axis of exp(2iks
 * sin(theta)) G|. Without the pulse its square is (a L^2 / 2 lambda) (sin beta/beta)^2 cos(theta),
 * beta = k L sin(theta). */
static double tilted_cylinder(const struct sea *sea, double a, double length, double theta)
{
    const double k = sea_wavenumber(sea), step = 1e-4;
    double largest = 0.0;
    for (double middle = 0.0; middle <= 0.5 * length * sin(theta); middle += 0.001) {
        double complex sum = 0.0;
        for (double s = -0.5 * length + 0.5 * step; s < 0.5 * length; s += step)
            sum +=
                cexp(2.0 * I * k * s * sin(theta)) * sea_pulse(sea, middle - s * sin(theta)) * step;
        largest = fmax(largest, cabs(sum));
    }
    const double curvature = a * cos(theta) / (1.0 + a * cos(theta) / RANGE);
    return sqrt(curvature / (2.0 * WAVELENGTH)) * largest;
}

CLAIM(a_cylinder_off_axis)
{
    static const double degrees[] = {0.1, 0.2, 0.3, 0.62, 1.06};
    for (size_t i = 0; i < COUNT(degrees); i++) {
        struct sea *sea = open_with(SHAPE_CYLINDER, 1.0, 0.0, 0.0, 0.3);
        turn(sea, degrees[i], 0.0, 0.0);
        /* the angle between the sight and the plane across the axis. The axis is level and the
         * sight is not: sin(theta) = sin(heading) cos(depression) */
        const double theta =
            asin(sin(degrees[i] * PI / 180.0) * sea_centre(sea, 0)[1] / sea_slant_range(sea, 0));
        print_message("heading %.2f degrees\n", degrees[i]);
        expect_close("tilted cylinder, dB re 1 m^2", decibels_of_amplitude(sea_peak(sea, NULL)),
                     decibels_of_amplitude(tilted_cylinder(sea, 0.15, 1.0, theta)), LEVEL_DB);
    }
}

/* A tilted wall shows, with W, a delta^2/(2 lambda) a pixel while sin(theta) < lambda/4 delta (8.6
 * degrees), and nothing beyond. */
CLAIM(a_cylinder_leaves_the_aspects)
{
    static const double degrees[] = {3.0, 5.0, 13.0};
    for (size_t i = 0; i < COUNT(degrees); i++) {
        const double theta = degrees[i] * PI / 180.0;
        struct sea *sea = open_with(SHAPE_CYLINDER, 3.0, 0.0, 0.0, 0.3);
        turn(sea, degrees[i], 0.0, 0.0);
        const struct image *image = sea_image(sea);
        /* mean energy along the middle of the wall, summed over columns, over which the pulse
         * spreads the integral of G^2 */
        double sum = 0.0;
        for (size_t row = 90; row <= 110; row++)
            for (size_t column = 0; column < COLUMNS; column++) {
                const double wall = sea_slant_range(sea, 0) - 0.15 / cos(theta) +
                                    ((double)row - 100.0) * 0.025 * tan(theta);
                if (fabs(sea_range(sea, (double)column) - wall) < 0.08)
                    sum += pow(cabs(image->target[row * COLUMNS + column]), 2.0);
            }
        const double energy = sum / 21.0 * 0.025 / sea_pulse_energy(sea);
        const double curvature = 0.15 * cos(theta) / (1.0 + 0.15 / RANGE);
        const double level =
            decibels_of_energy(energy / (curvature * 0.025 * 0.025 / (2.0 * WAVELENGTH)));
        print_message("heading %.0f degrees\n", degrees[i]);
        if (degrees[i] < 8.0)
            expect_close("pixel, dB re a delta^2/2 lambda", level, 0.0, LEVEL_DB);
        else /* the wide-angle echo of the ends, 1.5 m away, leaks in */
            expect_below("pixel beyond the aspects, dB re a delta^2/2 lambda", level, -30.0);
    }
}

/* Flat faces at right angles to the sight: a cylinder's end, a plate, a disc, a box and a wedge's
 * slope. The small ones return a plane wave's (A/lambda)^2 within 0.1 dB. (With a point source the
 * wavefront would curve in both directions: r sin(ka^2/2r) for the disc.) */
CLAIM(flat_faces)
{
    static const double sizes[][2] = {{0.05, 0.05}, {0.15, 0.15}, {0.3, 0.3}};
    static const double box[] = {0.2, 0.1}, slope[] = {0.15, 0.25};
    static const struct {
        const char *name;
        enum shape_kind shape;
        double length, width, height, diameter; /* m */
        double forward, before;                 /* rad; face before the centre, m */
        double (*depth)(double, double, const double *);
        const double *sizes;
    } faces[] = {
        {"end", SHAPE_CYLINDER, 0.2, 0.0, 0.0, 0.1, 0.0, 0.1, disc_depth, sizes[0]},
        {"end", SHAPE_CYLINDER, 0.2, 0.0, 0.0, 0.3, 0.0, 0.1, disc_depth, sizes[1]},
        {"end", SHAPE_CYLINDER, 0.2, 0.0, 0.0, 0.6, 0.0, 0.1, disc_depth, sizes[2]},
        {"plate", SHAPE_PLANE, 0.1, 0.1, 0.0, 0.0, -0.5 * PI, 0.0, rectangle_depth, sizes[0]},
        {"plate", SHAPE_PLANE, 0.3, 0.3, 0.0, 0.0, -0.5 * PI, 0.0, rectangle_depth, sizes[1]},
        {"plate", SHAPE_PLANE, 0.6, 0.6, 0.0, 0.0, -0.5 * PI, 0.0, rectangle_depth, sizes[2]},
        {"disc", SHAPE_DISC, 0.0, 0.0, 0.0, 0.1, -0.5 * PI, 0.0, disc_depth, sizes[0]},
        {"disc", SHAPE_DISC, 0.0, 0.0, 0.0, 0.3, -0.5 * PI, 0.0, disc_depth, sizes[1]},
        {"disc", SHAPE_DISC, 0.0, 0.0, 0.0, 0.6, -0.5 * PI, 0.0, disc_depth, sizes[2]},
        {"box", SHAPE_BOX, 0.6, 0.4, 0.2, 0.0, 0.0, 0.3, rectangle_depth, box},
        {"wedge", SHAPE_WEDGE, 0.4, 0.3, 0.3, 0.0, -0.92729521800161219, 0.0, rectangle_depth,
         slope}, /* atan(0.4 / 0.3) */
    };
    for (size_t i = 0; i < COUNT(faces); i++) {
        struct sea *sea = open_with(faces[i].shape, faces[i].length, faces[i].width,
                                    faces[i].height, faces[i].diameter);
        face_sonar(sea, faces[i].forward);
        const double distance = sea_slant_range(sea, 0) - faces[i].before;
        const struct front front = {faces[i].depth, faces[i].sizes, 0.35};
        const double complex expected = optics(sea, &front, distance, 0.0, 0.0);
        const struct line line = sea_line(sea, 0);
        double range;
        const double peak = line_peak(sea, &line, &range);
        print_message("%s: ", faces[i].name);
        expect_close("face, dB re its own", decibels_of_amplitude(peak / cabs(expected)), 0.0,
                     LEVEL_DB);
        expect_close("range, m", range, distance, 0.002);
        const double phase = carg(line_at(sea, &line, distance)) -
                             2.0 * sea_wavenumber(sea) * distance - carg(expected);
        expect_close("phase over 2kr and the face's own, rad", remainder(phase, 2.0 * PI), 0.0,
                     PHASE);
    }
}

/* A plate turned off the sight echoes from both far edges, as by quadrature at all its ranges. */
CLAIM(a_plate_off_the_sight)
{
    const double tilt = 0.1, sizes[] = {0.15, 0.25 * cos(tilt), tan(tilt)};
    const struct front front = {tilted_depth, sizes, 0.26};
    struct sea *sea = open_with(SHAPE_PLANE, 0.5, 0.3, 0.0, 0.0);
    double peak = 0.0, off = 0.0;
    face_sonar(sea, -0.5 * PI + tilt);
    const double nearest = sea_slant_range(sea, 0) - 0.25 * sin(tilt);
    const double complex turn = cexp(-2.0 * I * sea_wavenumber(sea) * nearest);
    const struct line line = sea_line(sea, 0);
    for (int i = -8; i <= 16; i++) {
        const double behind = i / 8.0 * 0.5 * sin(tilt);
        const double complex expected = optics(sea, &front, nearest, behind, 0.0);
        peak = fmax(peak, cabs(expected));
        off = fmax(off, cabs(line_at(sea, &line, nearest + behind) * turn - expected));
    }
    /* ranges of 50 m come in steps of 3.8 um in single precision: two of them are a phase of
     * 0.0064, and 0.02 dB of level. Cells of lambda/8 that the edges, 1.6 m of them, divide are hit
     * or missed by chance: 4 x 0.29 sqrt(L/c) c^2/lambda = 0.008 m */
    expect_below("error, dB re 1 m", decibels_of_amplitude(off),
                 decibels_of_amplitude(0.008 + 0.009 * peak));
}

/* A plane reflects as its image source does: +R exp(2ikr) for both curvatures. A sphere has both
 * with any fan: +(a/2) exp(2ik(r - a)). So a mirror's -i/lambda has the right sign. A path longer
 * by lambda/8 (there and back lambda/4) turns the phase by +pi/2. A pressure-release face turns the
 * sign. Roughness leaves exp(-P^2/2), P = 2 k eta. */
CLAIM(phase_and_level_are_those_of_path_and_surface)
{
    static const struct {
        double longer, reflection, roughness; /* lambda/8, -, m */
    } cases[] = {{0, 1, 0},    {1, 1, 0},         {2, 1, 0},       {3, 1, 0},      {4, 1, 0},
                 {0, -0.7, 0}, {0, -0.7, 0.5e-3}, {0, -0.7, 1e-3}, {0, -0.7, 2e-3}};
    double before = 0.0;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct sea *sea = open_with(SHAPE_SPHERE, 0.0, 0.0, 0.0, 0.6);
        sonject_object_params *sphere = sea_object(sea, 0);
        place_in_metres(sphere, 0.0, RANGE + cases[i].longer * WAVELENGTH / 8.0);
        sphere->material.reflection = cases[i].reflection;
        sphere->material.roughness_m = cases[i].roughness;
        const struct line line = sea_line(sea, 0);
        const double k = sea_wavenumber(sea), nearest = sea_slant_range(sea, 0) - 0.3;
        const double p = 2.0 * k * cases[i].roughness;
        const double complex echo = line_at(sea, &line, nearest) * cexp(-2.0 * I * k * nearest) /
                                    (cases[i].reflection < 0.0 ? -1.0 : 1.0);
        expect_close("level, dB", decibels_of_amplitude(cabs(echo)),
                     decibels_of_amplitude(fabs(cases[i].reflection) * 0.15 * exp(-0.5 * p * p)),
                     LEVEL_DB);
        expect_close("phase less 2kr, rad", carg(echo), 0.0, PHASE);
        if (cases[i].longer > 0.0)
            expect_close("phase step less that of the path, rad", carg(echo) - before, 0.0, 0.02);
        before = carg(echo);
    }
}

CLAIM(more_rays_change_no_glint)
{
    double level[3];
    static const double scales[] = {1.0, 4.0, 16.0};
    for (size_t i = 0; i < 3; i++) {
        struct sea *sea = open_with(SHAPE_CAPSULE, 1.0, 0.0, 0.0, 0.3);
        sea->injection->ray_scale = scales[i];
        sea_object(sea, 0)->heading_rad = 0.2;
        level[i] = decibels_of_amplitude(sea_peak(sea, NULL));
    }
    expect_close("4 times the rays, dB", level[1], level[0], 0.06);
    expect_close("16 times the rays, dB", level[2], level[0], 0.06);
}

/* A bar so thin that three cells of the default spacing cover it. */
CLAIM(more_rays_change_no_thin_bar)
{
    double mean[2] = {0.0, 0.0};
    for (size_t i = 0; i < 17; i++) { /* one run of many rays, 16 of few */
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sonject_object_params *bar = sea_add(sea, SHAPE_BOX, 1.0, 0.1, 0.0);
        bar->height_m = 0.006;
        bar->burial_m = -1.0;
        sea->injection->ray_scale = i ? 1.0 : 256.0;
        sea->injection->seed = i;
        mean[i > 0] += sea_peak(sea, NULL) / (i ? 16.0 : 1.0);
    }
    expect_close("default rays over 256 times as many, dB",
                 decibels_of_amplitude(mean[1] / mean[0]), 0.0, 0.25);
}

/* A level face that is seen flat returns nothing from between its edges, at grazing angles at which
 * the path changes by 0.6 to 2.1 wavelengths from one ray of the default spacing to the next. */
CLAIM(faces_seen_flat_return_nothing_but_edges)
{
    static const double altitudes[] = {20.0, 15.0, 12.5, 11.0, 9.0, 7.0};
    for (size_t i = 0; i < COUNT(altitudes); i++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sonject_object_params *box = sea_add(sea, SHAPE_BOX, 1.6, 1.4, 0.0);
        box->height_m = 0.4;
        box->heading_rad = 0.2;
        sea->sonar->altitude_m = altitudes[i];
        const struct image *image = sea_image(sea);
        const double middle = sea_column(sea, sea_slant_range(sea, 0) - 0.2 * altitudes[i] / RANGE);
        const size_t first = (size_t)(middle - 10.0);
        double sum = 0.0, at_edge = 0.0;
        for (size_t row = 100 - 10; row <= 100 + 10; row++)
            for (size_t column = first; column < first + 60; column++) {
                const double energy = pow(cabs(image->target[row * COLUMNS + column]), 2.0);
                sum += column < first + 20 ? energy : 0.0;
                at_edge = fmax(at_edge, column < first + 20 ? 0.0 : energy);
            }
        print_message("grazing %.1f degrees: ", asin((altitudes[i] - 0.4) / RANGE) * 180.0 / PI);
        expect_below("between the edges, dB re 1 m^2", decibels_of_energy(sum / (21.0 * 20.0)),
                     -100.0);
        expect_below("at the far edge", decibels_of_energy(at_edge), -64.0);
    }
}

/* The far edge of a level face, which lies along the track, returns the rest of the integral over
 * the face: W tan(grazing) / 4 pi of all sub-strips, whatever the number of rays. */
CLAIM(far_edges_return_what_is_left_of_the_face)
{
    static const double altitudes[] = {25.0, 15.0, 11.0, 8.5};
    static const double scales[] = {0.5, 1.0, 16.0};
    for (size_t i = 0; i < COUNT(altitudes); i++)
        for (size_t k = 0; k < COUNT(scales); k++) {
            struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
            sonject_object_params *box = sea_add(sea, SHAPE_BOX, 1.0, 1.2, 0.0);
            box->height_m = 0.4;
            sea->sonar->altitude_m = altitudes[i];
            sea->injection->ray_scale = scales[k];
            sea_ready(sea);
            const double below = altitudes[i] - 0.4;
            const double ground = sea_centre(sea, 0)[1] + 0.6;
            const double expected = below / ground / (4.0 * PI);
            const struct line line = sea_line(sea, 0);
            const double echo = cabs(line_at(sea, &line, hypot(ground, below)));
            print_message("grazing %.1f degrees, %g times the rays: ",
                          atan2(below, ground) * 180.0 / PI, scales[k]);
            expect_close("far edge over the closed form, dB",
                         decibels_of_amplitude(echo / expected), 0.0, 0.5);
        }
}

/* The residual where a smooth convex body returns nothing is -76 dB re 1 m^2, and -78 with four times
 * the rays. A pixel of seabed at -27 dB lies at -73. */
CLAIM(little_is_left_beside_a_glint)
{
    static const double scales[] = {1.0, 4.0};
    for (size_t i = 0; i < 2; i++) {
        struct sea *sea = open_with(SHAPE_SPHERE, 0.0, 0.0, 0.0, 0.8);
        sea->injection->ray_scale = scales[i];
        const struct image *image = sea_image(sea);
        /* between the glint and the terminator (0.4 m behind), clear of both pulses (-108 dB at
         * 3.1 columns), over the rows of the sphere */
        const double range = sea_slant_range(sea, 0);
        const size_t first = (size_t)ceil(sea_column(sea, range - 0.4) + 5.0);
        const size_t last = (size_t)floor(sea_column(sea, range) - 5.0);
        double sum = 0.0;
        assert_true(last > first);
        for (size_t row = 100 - 14; row <= 100 + 14; row++)
            for (size_t column = first; column <= last; column++)
                sum += pow(cabs(image->target[row * COLUMNS + column]), 2.0);
        print_message("%.0f times the rays: ", scales[i]);
        expect_below("residual, dB re 1 m^2",
                     decibels_of_energy(sum / (29.0 * (double)(last - first + 1))),
                     scales[i] > 1.0 ? -77.0 : -75.0);
    }
}

/* Cells are as wide as curvature and columns allow (cell_of_part). Compared with 16 times as many
 * rays, a pixel is off by less than -80 dB re 1 m^2 on the mean. A pixel of seabed lies at -73. */
CLAIM(wide_cells_leave_no_more_than_noise)
{
    static const struct {
        enum shape_kind shape;
        double length, width, height, diameter, heading_deg, pitch_deg;
    } bodies[] = {{SHAPE_SPHERE, 0.0, 0.0, 0.0, 0.8, 0.0, 0.0},
                  {SHAPE_CAPSULE, 1.4, 0.0, 0.0, 0.4, 35.0, 5.0},
                  {SHAPE_CAPSULE, 1.4, 0.0, 0.0, 0.4, 0.0, 0.0},
                  {SHAPE_ELLIPSOID, 1.0, 0.7, 0.4, 0.0, 40.0, 10.0},
                  {SHAPE_TORUS, 0.0, 0.0, 0.15, 0.8, 20.0, 30.0},
                  {SHAPE_BOX, 1.0, 0.6, 0.4, 0.0, 20.0, 0.0},
                  {SHAPE_CYLINDER, 1.4, 0.0, 0.0, 0.4, 35.0, 5.0}};
    static const double frequencies[] = {100e3, 455e3};
    for (size_t k = 0; k < COUNT(bodies) * COUNT(frequencies); k++) {
        const size_t i = k / COUNT(frequencies);
        const double frequency = frequencies[k % COUNT(frequencies)];
        const struct image *images[2];
        double sum = 0.0;
        size_t pixels = 0;
        for (int j = 0; j < 2; j++) {
            struct sea *sea = open_with(bodies[i].shape, bodies[i].length, bodies[i].width,
                                        bodies[i].height, bodies[i].diameter);
            sea->sonar->centre_frequency_hz = frequency;
            sea->injection->ray_scale = j ? 16.0 : 1.0;
            turn(sea, bodies[i].heading_deg, bodies[i].pitch_deg, 0.0);
            images[j] = sea_image(sea);
        }
        for (size_t p = 0; p < ROWS * COLUMNS; p++) {
            sum += pow(cabs(images[0]->target[p] - images[1]->target[p]), 2.0);
            pixels += images[1]->target[p] != 0.0;
        }
        print_message("body %zu, heading %.0f, %.0f kHz: ", i, bodies[i].heading_deg,
                      1e-3 * frequency);
        assert_true(pixels > 0);
        expect_below("off, dB re 1 m^2", decibels_of_energy(sum / (double)pixels), -80.0);
    }
}

/* The front of an ellipsoid of semi-axes a, b, c, seen along n in its own frame, is h = sqrt(a^2
 * nx^2 + b^2 ny^2 + c^2 nz^2) before the centre. There sqrt(R1 R2) = abc/h^2. */
CLAIM(an_ellipsoid)
{
    static const double poses[][3] = {
        {0.0, 0.0, 0.0}, {40.0, 0.0, 0.0}, {70.0, 25.0, 0.0}, {-100.0, -15.0, 60.0}};
    static const double half[] = {0.5, 0.35, 0.25};
    for (size_t i = 0; i < COUNT(poses); i++) {
        struct sea *sea = open_with(SHAPE_ELLIPSOID, 1.0, 0.7, 0.5, 0.0);
        turn(sea, poses[i][0], poses[i][1], poses[i][2]);
        const double *centre = sea_centre(sea, 0), slant = sea_slant_range(sea, 0);
        double square = 0.0, range;
        for (int axis = 0; axis < 3; axis++) {
            const double *own = sea_axes(sea, 0)[axis];
            const double n = (-own[1] * centre[1] + own[2] * (10.0 - centre[2])) / slant;
            square += pow(half[axis] * n, 2.0);
        }
        const double peak = sea_peak(sea, &range);
        print_message("heading %.0f, pitch %.0f, roll %.0f degrees\n", poses[i][0], poses[i][1],
                      poses[i][2]);
        expect_close("level re sqrt(R1 R2)/2, dB",
                     decibels_of_amplitude(peak / (0.5 * 0.5 * 0.35 * 0.25 / square)), 0.0,
                     LEVEL_DB);
        /* to a bin; the front is hit a little before the plane through the centre */
        expect_close("range, m", range, slant - sqrt(square), 0.003);
    }
}

/* A ring edge on shows its outer equator: R1 = R + b, R2 = b. Face on, a whole circle of the ring
 * is equally near: rho = R. The front there is a parabola of radius b across the ring, so the
 * amplitude is 1/lambda 2 pi R sqrt(lambda b/2). The wavefront's curvature in elevation leaves
 * |mean over the circle of exp(ik (R sin)^2/r)| of it. */
CLAIM(a_torus)
{
    for (int is_face_on = 0; is_face_on < 2; is_face_on++) {
        struct sea *sea = open_with(SHAPE_TORUS, 0.0, 0.0, 0.3, 1.0);
        face_sonar(sea, is_face_on ? -0.5 * PI : 0.0);
        const double distance = sea_slant_range(sea, 0) - (is_face_on ? 0.15 : 0.5);
        double complex mean = 0.0;
        for (int i = 0; i < 3600; i++)
            mean += cexp(I * sea_wavenumber(sea) * pow(0.35 * sin(2.0 * PI * i / 3600.0), 2.0) /
                         distance) /
                    3600.0;
        const double ring =
            2.0 * PI * 0.35 * sqrt(0.5 * WAVELENGTH * 0.15) / WAVELENGTH * cabs(mean);
        double range;
        const double peak = sea_peak(sea, &range);
        expect_close("torus, dB re its own",
                     decibels_of_amplitude(peak / (is_face_on ? ring : 0.5 * sqrt(0.15 * 0.5))),
                     0.0, LEVEL_DB);
        expect_close("range, m", range, distance, is_face_on ? 0.003 : 0.002);
    }
}

/* Tip on, a cone shows its tip, lambda tan^2(alpha)/8 pi, and its rim, where its side ends
 * abruptly, a tan(alpha)/2. The side is so flat that cells of lambda/8 hold the rim's phase. */
CLAIM(a_cone_tip_on)
{
    static const double sizes[] = {0.3, 1.0 / 3.0}; /* radius, height over radius */
    const struct front front = {cone_depth, sizes, 0.31};
    struct sea *sea = open_with(SHAPE_CONE, 0.0, 0.0, 0.1, 0.6);
    face_sonar(sea, -0.5 * PI);
    const double tip = sea_slant_range(sea, 0) - 0.05;
    const struct line line = sea_line(sea, 0);
    double range;
    const double peak = line_peak(sea, &line, &range), at_tip = cabs(line_at(sea, &line, tip));
    expect_close("rim's range, m", range, tip + 0.1, 0.003);
    const double u = 0.25 * PI * sizes[1];
    expect_close("rim, dB re its own",
                 decibels_of_amplitude(peak / cabs(optics(sea, &front, tip, range - tip, 0.0))),
                 2.0 * decibels_of_amplitude(sin(u) / u), LEVEL_DB);
    expect_close("tip, dB re lambda tan^2(alpha)/8 pi",
                 decibels_of_amplitude(at_tip / (WAVELENGTH * 9.0 / (8.0 * PI))), 0.0, LEVEL_DB);
    expect_below("tip, dB re a tan(alpha)/2", decibels_of_amplitude(at_tip / 0.45), -30.0);
}

/* A capsule is a cylinder with two half spheres, image for image: the same rays meet both. */
CLAIM(a_capsule_is_a_cylinder_with_round_ends)
{
    const struct image *images[2];
    double peak;
    for (int i = 0; i < 2; i++) {
        struct sea *sea = open_with(i ? SHAPE_CYLINDER : SHAPE_CAPSULE, 1.4, 0.0, 0.0, 0.4);
        sonject_object_params *object = sea_object(sea, 0);
        object->nose_end = object->tail_end = i ? SONJECT_END_SPHERICAL : SONJECT_END_FLAT;
        object->heading_rad = 0.6;
        object->pitch_rad = 0.1;
        object->burial_m = 0.1;
        object->material.lambert = 0.05;
        object->material.roughness_m = 1e-3;
        images[i] = sea_image(sea);
    }
    const double off = image_difference(images[0], images[1], &peak);
    assert_true(peak > 0.01);
    /* rounding of 2e-7 m turns phases by 1e-4, and moves some rays off the outline */
    expect_below("difference over the largest amplitude, dB", decibels_of_amplitude(off / peak),
                 -60.0);
    for (int k = 0; k < 2; k++)
        expect_close(
            k ? "shadow over the capsule's" : "energy over the capsule's",
            sum_of(k ? images[1]->lost_energy : images[1]->target_energy, ROWS * COLUMNS) /
                sum_of(k ? images[0]->lost_energy : images[0]->target_energy, ROWS * COLUMNS),
            1.0, 1e-3);
}
