/* Shapes that users write: against the built-in sphere by physical optics, energies and
 * chains; several codes beside a mesh; compilers' errors in the user's
 * lines; and what the check of a shape catches. */
#include "sea.h"
#include "user/shape_check.h"
#include "user/snippet.h"
#include "user_codes.h"

CLAIMS_COMPILE

#define ROWS    121
#define COLUMNS 121
#define RANGE   50.0
#define RADIUS  0.25
#define DOME_A  0.4
#define DOME_H  0.25

static struct user_shapes *shapes_of(struct sea *sea)
{
    return &sea->bench->scene.user_shapes;
}

enum sound_shape {
    LIT_SPHERE,
    LIT_DISC,
    LIT_WITHOUT_NORMAL,
    SPHERE_SHAPE,
    PAIR_SHAPE
};

/* A shape by code, or the library's own. Programs take long to compile, the longer the more codes
 * there are: what is lit has one list of codes, what is heard by glints and chains another. */
static sonject_object_params *add_shape(struct sea *sea, enum sound_shape shape, bool is_user)
{
    static const enum shape_kind own[] = {SHAPE_SPHERE, SHAPE_DISC, SHAPE_USER, SHAPE_SPHERE,
                                          SHAPE_PARTS};
    sonject_object_params *object =
        sea_add(sea, is_user ? SHAPE_USER : own[shape], 0.0, 0.0, is_user ? 0.0 : 2.0 * RADIUS);
    object->user_shape = shape < SPHERE_SHAPE ? shape : shape - SPHERE_SHAPE;
    if (!is_user)
        return object;
    sea_add_code(sea, "sphere.cl", SPHERE_CODE, RADIUS, RADIUS, 0.0);
    if (shape >= SPHERE_SHAPE) {
        sea_add_code(sea, "pair.cl", PAIR_CODE, 0.6, 0.25, 0.3);
        shapes_of(sea)->shapes[1].half_height_m = shapes_of(sea)->shapes[1].half_width_m = 0.25;
        return object;
    }
    sea_add_code(sea, "disc.cl", DISC_CODE, RADIUS, RADIUS, 0.0);
    shapes_of(sea)->shapes[1].is_open = true;
    shapes_of(sea)->shapes[1].half_height_m = 1e-9;
    sea_add_code(sea, "my.cl",
                 SPHERE_DISTANCE
                 "float3 shape_normal(float3 p, const float *a) { return 0.0f * p; }\n",
                 RADIUS, RADIUS, 0.0);
    return object;
}

static void expect_same_sums(const struct tile_sums *one, const struct tile_sums *other,
                             double tolerance)
{
    assert_true(other->energy > 0.0 && other->lost > 0.0 && other->footprint > 0.0);
    expect_close("echoes", one->energy / other->energy, 1.0, tolerance);
    expect_close("shadow", one->lost / other->lost, 1.0, tolerance);
    expect_close("hits", one->footprint / other->footprint, 1.0, tolerance);
}

/* The same rays, the same formula: what is left are roundings and rays along the outline, of which
 * a disc at 11 deg of grazing has more: level, 10 cm above the seabed, seen from above, so that its
 * normal has to turn. */
CLAIM(rough_shapes_are_lit_like_the_librarys)
{
    for (enum sound_shape shape = LIT_SPHERE; shape <= LIT_DISC; shape++) {
        struct tile_sums sums[2];
        for (int is_user = 0; is_user < 2; is_user++) {
            struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
            sonject_object_params *object = add_shape(sea, shape, is_user);
            make_rough(object, 0.1);
            object->burial_m = shape == LIT_DISC ? -0.1 : 0.0;
            sea_rough(sea, &sums[is_user], NULL);
        }
        expect_same_sums(&sums[1], &sums[0], shape == LIT_DISC ? 1e-3 : 1e-4);
    }
}

/* In the pulse's band. Code has the usual cells, a sphere those that its radius allows. */
CLAIM(a_sphere_by_code_glints_like_the_sphere)
{
    struct line lines[2];
    struct sea *sea = NULL;
    for (int is_user = 0; is_user < 2; is_user++) {
        sea = sea_open(ROWS, COLUMNS, RANGE);
        add_shape(sea, SPHERE_SHAPE, is_user)->burial_m = -1.0;
        lines[is_user] = sea_line(sea, 0);
    }
    const double energy = line_energy_in_band(sea, &lines[0]);
    assert_true(energy > 0.0);
    line_add(&lines[1], &lines[0], -1.0);
    expect_below("difference of glints, dB",
                 decibels_of_energy(line_energy_in_band(sea, &lines[1]) / energy), -35.0);
}

static const struct ranges all_ranges = {0, 0.0, 0.0};

/* Chains between sphere and seabed. The library leaves a convex shape out where rays leave it; code
 * is asked, 20 um off its surface: some grazing ways may be decided otherwise. */
CLAIM(a_sphere_by_code_has_the_spheres_chains)
{
    struct energies energies[2];
    for (int is_user = 0; is_user < 2; is_user++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea->injection->interactions = 3;
        sea->injection->order_energies = 1;
        sea->injection->ray_scale = 0.25;
        make_rough(add_shape(sea, SPHERE_SHAPE, is_user), 0.1);
        energies[is_user] = sea_chains(sea, &all_ranges, 1, 1);
    }
    for (int order = 1; order < 3; order++) {
        assert_true(energies[0].sum[order][0] > 0.0);
        expect_close("chains", energies[1].sum[order][0] / energies[0].sum[order][0], 1.0, 1e-3);
    }
}

/* Of PAIR_CODE, as parts of the last object. */
static void add_two_spheres(struct sea *sea)
{
    for (int i = 0; i < 2; i++) {
        static const double level[3] = {0.0, 0.0, 0.0};
        const double centre[3] = {i == 0 ? -0.3 : 0.3, 0.0, 0.0};
        sea_add_part(sea, SHAPE_SPHERE, centre, level)->diameter_m = 0.5;
    }
}

/* Two spheres light each other. As one shape of code they must find each other as parts do; the
 * seabed scatters nothing. */
CLAIM(a_shape_by_code_meets_itself)
{
    struct estimate energy[2];
    for (int is_user = 0; is_user < 2; is_user++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea->injection->interactions = 2;
        sea->seabed->lambert = 1e-12;
        sonject_object_params *object = add_shape(sea, PAIR_SHAPE, is_user);
        make_rough(object, 0.1);
        object->burial_m = -0.5;
        if (!is_user)
            add_two_spheres(sea);
        const struct energies energies = sea_chains(sea, &all_ranges, 10, 4);
        energy[is_user] = energy_of(&energies, 1, 0);
    }
    const struct estimate ratio = ratio_of(energy[1], energy[0]);
    assert_true(ratio.error < 0.02);
    expect_estimate("echoes between the spheres", ratio, 1.0, 0.0);
}

/* Two rigid spheres by code send on what each reflects to the other, as parts do: what two
 * interactions add, through the pulse. Other rays over the same spheres: 0.2 dB. */
CLAIM(a_shape_by_code_echoes_from_face_to_face)
{
    double peak[2], range[2];
    for (int is_user = 0; is_user < 2; is_user++) {
        struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
        sea->injection->ray_scale = 4.0;
        add_shape(sea, PAIR_SHAPE, is_user)->burial_m = -0.5;
        if (!is_user)
            add_two_spheres(sea);
        struct line lines[2];
        for (int i = 0; i < 2; i++) {
            sea->injection->interactions = i == 0 ? 2 : 1;
            lines[i] = sea_line(sea, 0);
            if (is_user)
                continue;
            const struct line other = sea_line(sea, 1);
            line_add(&lines[i], &other, 1.0);
        }
        line_add(&lines[0], &lines[1], -1.0);
        peak[is_user] = line_peak(sea, &lines[0], &range[is_user]);
    }
    assert_true(peak[0] > 0.05); /* of a sphere's own echo: 0.125 */
    expect_close("echo from sphere to sphere, dB", decibels_of_amplitude(peak[1] / peak[0]), 0.0,
                 0.2);
    expect_close("its range, m", range[1], range[0], 1e-3);
}

/* Dome, sphere twice (one code, two sizes), dome of other sizes and a mesh, along the track: each
 * tile is what it is where the library's own spheres stand. */
CLAIM(several_codes_beside_a_mesh)
{
    static const double radii[2] = {RADIUS, 0.15};
    struct tile_sums sums[2][5];
    for (int is_user = 0; is_user < 2; is_user++) {
        struct sea *sea = sea_open(321, COLUMNS, RANGE);
        struct user_shapes *shapes = shapes_of(sea);
        sea_add_tetrahedron(sea);
        for (int i = 0; i < 5; i++) {
            const bool is_dome = i == 0 || i == 3, is_sphere = i == 1 || i == 2;
            sonject_object_params *object = sea_add(sea,
                                                    i == 4               ? SHAPE_MESH
                                                    : is_dome || is_user ? SHAPE_USER
                                                                         : SHAPE_SPHERE,
                                                    0.0, 0.0, is_sphere ? 2.0 * radii[i - 1] : 0.0);
            place_in_pixels(object, 40.0 + 60.0 * i, 50.0);
            make_rough(object, 0.1);
            /* both codes wherever the spheres are from: the program is then the same */
            object->user_shape = shapes->count;
            if (is_dome) {
                const double a = i == 0 ? DOME_A : 0.3, h = i == 0 ? DOME_H : 0.1;
                sea_add_code(sea, "dome.cl", DOME_CODE, 0.6, a, h);
                shapes->shapes[shapes->count - 1].half_height_m = h;
            } else if (is_sphere) {
                sea_add_code(sea, "sphere.cl", SPHERE_CODE, radii[i - 1], radii[i - 1], 0.0);
            }
        }
        assert_int_equal(shapes->snippet_count, 2);
        sea_rough(sea, sums[is_user], NULL);
    }
    for (int i = 0; i < 5; i++)
        expect_same_sums(&sums[1][i], &sums[0][i], 1e-3);
    /* other parameters, another size */
    assert_true(sums[1][3].footprint < 0.6 * sums[1][0].footprint);
    assert_true(sums[1][2].footprint < 0.6 * sums[1][1].footprint);
}

#define MINE "my \"shape\\.cl" /* a name that may end a text, or be read as another */

/* The message that a program with a code, behind a sound one, gives on a device. */
static sonject_status compile(struct sea *sea, const char *code, enum device_program program,
                              const char *kernel_name)
{
    device_kernel kernel;
    user_shapes_clear(shapes_of(sea));
    sea_add_code(sea, "sound.cl", SPHERE_CODE, 1.0, 1.0, 0.0);
    sea_add_code(sea, MINE, code, 1.0, 1.0, 0.0);
    const sonject_status status =
        scene_kernel_create(&sea->bench->report, sea->bench->tracer.device, &sea->bench->scene,
                            PROGRAM_FULL, program, kernel_name, &kernel);
    if (status == SONJECT_OK)
        kernel_release(sea->bench->tracer.device, &kernel);
    return status;
}

CLAIM(errors_are_in_the_users_lines)
{
    /* what stands in the message after the name of the code */
    static const struct {
        const char *code, *place;
    } cases[] = {
        {SPHERE_NORMAL "\n\nfloat shape_distance(float3 p, float3 d, float t, const float *a)\n"
                       "{\n    return undeclared * t;\n}\n",
         MINE ":6:"},
        {"float shape_distance(float3 p, float3 d, float t, const float *a) { return t "
         "}\n" SPHERE_NORMAL,
         MINE ":1:"},
        {"\nfloat shape_distance(float3 p) { return 1.0f; }\n" SPHERE_NORMAL, MINE ":2:"},
        {SPHERE_CODE "/* a long\n comment */ #error my own words\n", MINE ":19:"},
        {SPHERE_CODE "#error my own words\n", ": my own words"},
        /* brackets that only macros show */
        {SPHERE_CODE "#define CLOSE }\nfloat g(float x) { return x; CLOSE }\n", MINE ":19:"},
        {SPHERE_CODE "#define OPEN {\nfloat g(float x) { return x; OPEN }\n", MINE},
        {SPHERE_CODE "#define HASH #undef\nHASH FUNCTION\n", MINE ":19:"},
        /* what would hide our own text behind it */
        {SPHERE_CODE "}\n", MINE ":18:"},
        {SPHERE_CODE "\n/* to the end\n", MINE ":19:"},
        {SPHERE_CODE "#if 0\n\n", MINE ":18:"},
        {SPHERE_CODE "constant char c[] = \"open;\n", MINE ":18:"},
        {"#define shape_normal other\n" SPHERE_CODE, MINE ":1:"},
        /* declared, never written */
        {"float shape_distance(float3 p, float3 d, float t, const float *a);\n" SPHERE_NORMAL,
         "'shape_distance'"},
    };
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    const char *message = sea_message(sea);
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_int_equal(compile(sea, cases[i].code, PROGRAM_PROBE_USER_SHAPE, "probe_user_shape"),
                         SONJECT_ERROR_INPUT);
        if (!strstr(message, cases[i].place))
            fail_msg("case %zu: '%s' is not in '%s'", i, cases[i].place, message);
        assert_null(strstr(message, "user_1_"));
        assert_non_null(strstr(message, MINE));
        assert_null(strchr(message, '\n'));
    }
    /* the programs that trace say the same */
    assert_int_equal(compile(sea, cases[0].code, PROGRAM_TRACE_ROUGH, "trace_rough"),
                     SONJECT_ERROR_INPUT);
    assert_non_null(strstr(message, cases[0].place));
    assert_int_equal(compile(sea, DOME_CODE, PROGRAM_PROBE_USER_SHAPE, "probe_user_shape"),
                     SONJECT_OK);
}

/* A normal that is none must not be drawn. */
CLAIM(a_missing_normal_fails_the_run)
{
    static struct rough_trace trace;
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    struct tracer *tracer = &sea->bench->tracer;
    make_rough(add_shape(sea, LIT_WITHOUT_NORMAL, true), 0.1);
    sea_ready(sea);
    assert_int_equal(rough_trace_begin(&trace, tracer, NULL), SONJECT_OK);
    float *seabed = claim_memory(line_grid_cells(&trace.grid), sizeof *seabed);
    assert_int_equal(rough_trace_strips(&trace, tracer, trace.grid.strips, seabed),
                     SONJECT_ERROR_DEVICE);
    assert_non_null(strstr(sea_message(sea), "not a number"));
    rough_trace_end(&trace);
}

/* ---- the check of a shape ---- */

static sonject_status check(struct sea *sea, struct shape_check *result)
{
    return shape_check_run(&sea->bench->report, sea->bench->tracer.device, shapes_of(sea), 0,
                           result);
}

static sonject_status check_code(struct sea *sea, const char *code, double radius, bool is_open,
                                 struct shape_check *result)
{
    user_shapes_clear(shapes_of(sea));
    sea_add_code(sea, "my.cl", code, radius, RADIUS, DOME_H);
    shapes_of(sea)->shapes[0].is_open = is_open;
    return check(sea, result);
}

CLAIM(sound_shapes_pass_the_check)
{
    static const struct {
        const char *code;
        double radius;
        bool is_open;
    } cases[] = {
        {SPHERE_CODE, RADIUS, false}, {SPHERE_CODE, 2.0 * RADIUS, false},
        {DOME_CODE, 0.36, false},     {DISC_CODE, RADIUS, true},
        {PAIR_CODE, 0.6, false},
    };
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct shape_check result;
        if (check_code(sea, cases[i].code, cases[i].radius, cases[i].is_open, &result) !=
            SONJECT_OK)
            fail_msg("case %zu: %s", i, sea_message(sea));
        /* a sphere of the bounding radius fills 1 / 1.3^2 of the disc of rays: 2424 of 4096, +-31
         */
        if (i == 0)
            expect_close("hits", (double)result.hits, 4096.0 / 1.69, 4.0 * 31.4);
        assert_true(result.compared > result.hits / 3);
        expect_below("median, deg", result.median_deg, 0.1);
    }
}

#define SPHERE_WITH(result)                                                                        \
    "float met(float3 p, float3 d, float nearest, const float *a)\n"                               \
    "{\n"                                                                                          \
    "    const float s = sqrt(a[0] * a[0] - dot(p, p));\n"                                         \
    "    return -s > nearest ? -s : s > nearest ? s : INFINITY;\n"                                 \
    "}\n"                                                                                          \
    "float shape_distance(float3 p, float3 d, float nearest, const float *a)\n"                    \
    "{\n"                                                                                          \
    "    const float s = sqrt(a[0] * a[0] - dot(p, p));\n"                                         \
    "    return dot(p, p) > a[0] * a[0] ? INFINITY : " result ";\n"                                \
    "}\n"

CLAIM(the_check_catches_small_boxes)
{
    struct shape_check result;
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sea_add_code(sea, "dome.cl", DOME_CODE, 0.5, DOME_A, DOME_H);
    struct user_shape *shape = &shapes_of(sea)->shapes[0];
    double *const sizes[3] = {&shape->half_length_m, &shape->half_width_m, &shape->half_height_m};
    const double true_sizes[3] = {DOME_A, DOME_A, DOME_H};
    const char *const keys[3] = {"half_length", "half_width", "half_height"};
    for (int k = 0; k < 3; k++)
        *sizes[k] = true_sizes[k];
    assert_int_equal(check(sea, &result), SONJECT_OK);
    for (int k = 0; k < 3; k++) {
        *sizes[k] = 0.97 * true_sizes[k];
        assert_int_equal(check(sea, &result), SONJECT_ERROR_INPUT);
        assert_non_null(strstr(sea_message(sea), keys[k]));
        *sizes[k] = true_sizes[k];
    }
}

CLAIM(the_check_catches_wrong_codes)
{
    static const struct {
        const char *code;
        double radius;
        const char *words;
    } cases[] = {
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) "
                         "{ return p + (float3)(0.0f, 0.0f, 0.03f); }\n",
         RADIUS, "shape_normal is not the normal"},
        /* only one pole in ten is wrong */
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) "
                         "{ return p + (float3)(0.0f, p.z > 0.2f ? 0.05f : 0.0f, 0.0f); }\n",
         RADIUS, "shape_normal is not the normal"},
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) { return -p; }\n", RADIUS,
         "point away from the ray"},
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) { return 0.0f * p; }\n",
         RADIUS, "a normal of length 0"},
        {SPHERE_DISTANCE "float3 shape_normal(float3 p, const float *a) { return p / 0.0f; }\n",
         RADIUS, "shape_normal gives what is not a finite number"},
        {SPHERE_CODE, 0.99 * RADIUS, "beyond the bounding_radius of 0.2475 m"},
        {SPHERE_CODE, 0.5 * RADIUS, "beyond the bounding_radius"},
        {SPHERE_WITH("NAN") SPHERE_NORMAL, RADIUS, "shape_distance gives what is not a number"},
        {SPHERE_WITH("INFINITY") SPHERE_NORMAL, RADIUS, "none of 4096 rays"},
        {SPHERE_WITH("-2.0f") SPHERE_NORMAL, RADIUS, "where the nearest that is asked for is"},
        {SPHERE_WITH("-s") SPHERE_NORMAL, RADIUS, "is not beyond `nearest`"},
        {SPHERE_WITH("-s > nearest ? -s : INFINITY") SPHERE_NORMAL, RADIUS,
         "do not next meet its inner side"},
        {SPHERE_WITH("nearest < -0.24999999f ? -s : met(p, d, nearest + 0.01f, a)") SPHERE_NORMAL,
         RADIUS, "not found again by the same ray"},
        /* surfaces 0.1 mm too far along each ray: echoes go on from within */
        {SPHERE_WITH("met(p, d, nearest - 1e-4f, a) + 1e-4f") SPHERE_NORMAL, RADIUS,
         "meet it again at once"},
    };
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct shape_check result;
        if (check_code(sea, cases[i].code, cases[i].radius, false, &result) != SONJECT_ERROR_INPUT)
            fail_msg("case %zu is not caught: %s", i, sea_message(sea));
        if (!strstr(sea_message(sea), cases[i].words))
            fail_msg("case %zu: '%s' is not in '%s'", i, cases[i].words, sea_message(sea));
    }
}
