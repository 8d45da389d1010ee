#include "sea.h"

#include "bench.h"
#include "scene/placement.h"
#include "scene/point_response.h"

/* ---- claims ---- */

static void **kept; /* until the claim ends */
static size_t kept_count;

static void *keep(void *memory)
{
    kept = realloc(kept, (kept_count + 1) * sizeof *kept);
    assert_true(kept && memory);
    kept[kept_count++] = memory;
    return memory;
}

void *claim_memory(size_t count, size_t bytes)
{
    return keep(calloc(count, bytes));
}

const char *claim_device(void)
{
    return bench_device;
}

static struct bench the_bench;
static struct sea the_sea; /* its bench is NULL where none is open */

static void close_sea(void)
{
    if (the_sea.bench)
        bench_close(the_sea.bench);
    the_sea.bench = NULL;
}

static void hold(void **state)
{
    ((const struct claim *)*state)->hold();
}

static int end_claim(void **state)
{
    (void)state;
    close_sea();
    for (size_t i = 0; i < kept_count; i++)
        free(kept[i]);
    free(kept);
    kept = NULL;
    kept_count = 0;
    return 0;
}

int hold_claims(const struct claim *claims, size_t count)
{
    struct CMUnitTest tests[32];
    assert_true(count <= COUNT(tests));
    for (size_t i = 0; i < count; i++) {
        const struct CMUnitTest test = {claims[i].name, hold, NULL, end_claim, (void *)&claims[i]};
        tests[i] = test;
    }
    return bench_run_on_devices(tests, count);
}

/* ---- the scene ---- */

struct sea *sea_open(size_t rows, size_t columns, double middle_range_m)
{
    close_sea();
    bench_open(&the_bench, rows, columns, middle_range_m);
    struct scene *scene = &the_bench.scene;
    const struct sea sea = {&scene->sonar,    &scene->pulse,     &scene->motion.params,
                            &scene->medium,   &scene->seabed,    &scene->surface,
                            &scene->geometry, &scene->injection, rows,
                            columns,          rows * columns,    &the_bench};
    the_sea = sea;
    return &the_sea;
}

void sea_move(struct sea *sea, double middle_range_m)
{
    bench_move(sea->bench, middle_range_m);
}

sonject_object_params *sea_add(struct sea *sea, sonject_shape shape, double length_m,
                               double width_m, double diameter_m)
{
    return bench_add(sea->bench, shape, length_m, width_m, diameter_m);
}

sonject_object_params *sea_add_sphere(struct sea *sea, double radius_m, double height_m)
{
    sonject_object_params *sphere = sea_add(sea, SONJECT_SHAPE_SPHERE, 0.0, 0.0, 2.0 * radius_m);
    sphere->burial_m = -height_m;
    return sphere;
}

sonject_object_params *sea_object(const struct sea *sea, uint32_t number)
{
    return &sea->bench->scene.objects[number];
}

void place_in_pixels(sonject_object_params *object, double row, double column)
{
    object->position_kind = SONJECT_POSITION_PIXELS;
    object->position_along = row;
    object->position_range = column;
}

void place_in_metres(sonject_object_params *object, double along_m, double range_m)
{
    object->position_kind = SONJECT_POSITION_METRES;
    object->position_along = along_m;
    object->position_range = range_m;
}

void make_rough(sonject_object_params *object, double lambert)
{
    object->material.reflection = 0.0;
    object->material.lambert = lambert;
}

sonject_object_params *sea_add_part(struct sea *sea, sonject_shape shape, const double centre[3],
                                    const double heading_pitch_roll[3])
{
    struct scene *scene = &sea->bench->scene;
    struct scene_part part;
    memset(&part, 0, sizeof part);
    part.shape = scene->objects[0];
    part.shape.shape = shape;
    memcpy(part.centre, centre, sizeof part.centre);
    turn_axes(part.axes, heading_pitch_roll[0], heading_pitch_roll[1], heading_pitch_roll[2]);
    EXPECT_OK(&sea->bench->report, scene_append_part(scene, &sea->bench->report, &part));
    return &scene->parts[scene->part_count - 1].shape;
}

void sea_set_material(struct sea *sea, const sonject_material_params *material)
{
    struct scene *scene = &sea->bench->scene;
    for (uint32_t i = 0; i < scene->object_count; i++)
        scene->objects[i].material = *material;
    for (uint32_t i = 0; i < scene->part_count; i++)
        scene->parts[i].shape.material = *material;
}

void sea_add_mesh(struct sea *sea, const struct triangles *mesh, double unit_m,
                  double smooth_angle_rad)
{
    struct scene *scene = &sea->bench->scene;
    struct mesh_options options;
    mesh_options_init(&options);
    options.unit_m = unit_m;
    options.smooth_angle_rad = smooth_angle_rad;
    scene->meshes = realloc(scene->meshes, (scene->mesh_count + 1) * sizeof *scene->meshes);
    assert_non_null(scene->meshes);
    EXPECT_OK(&sea->bench->report, mesh_from_arrays(&sea->bench->report, "mesh", mesh->positions,
                                                    mesh->vertices, mesh->corners, mesh->triangles,
                                                    &options, &scene->meshes[scene->mesh_count]));
    scene->mesh_count++;
}

void sea_add_code(struct sea *sea, const char *name, const char *code, double bounding_radius_m,
                  double first, double second)
{
    sonject_user_shape_params params;
    sonject_user_shape_params_init(&params);
    params.name = name;
    params.code = code;
    params.bounding_radius_m = bounding_radius_m;
    params.parameter_count = 2;
    params.parameters[0] = first;
    params.parameters[1] = second;
    EXPECT_OK(&sea->bench->report, check_user_shape(&params, &sea->bench->report, NULL));
    EXPECT_OK(&sea->bench->report,
              user_shapes_append(&sea->bench->scene.user_shapes, &sea->bench->report, &params));
}

void sea_add_tetrahedron(struct sea *sea)
{
    bench_add_tetrahedron(sea->bench);
}

void sea_add_mound(struct sea *sea, double radius_m, double height_m, double beyond_m)
{
    struct relief_feature *mound =
        bench_add_relief(sea->bench, height_m < 0.0 ? RELIEF_PIT : RELIEF_MOUND);
    mound->radius_m = radius_m;
    mound->height_m = fabs(height_m);
    if (beyond_m == 0.0)
        return;
    mound->position_kind = SONJECT_POSITION_PIXELS;
    mound->position_along = 0.5 * (double)(sea->rows - 1);
    mound->position_range =
        0.5 * (double)(sea->columns - 1) + beyond_m / sea->geometry->column_spacing_m;
}

void sea_add_ripples(struct sea *sea, double wavelength_m, double height_m, double heading_rad,
                     double sharpness)
{
    struct relief_feature *ripples = bench_add_relief(sea->bench, RELIEF_RIPPLES);
    ripples->wavelength_m = wavelength_m;
    ripples->height_m = height_m;
    ripples->heading_rad = heading_rad;
    ripples->sharpness = sharpness;
}

void sea_add_scour(struct sea *sea, double width_m, double depth_m)
{
    struct relief_feature *scour = bench_add_relief(sea->bench, RELIEF_SCOUR);
    scour->width_m = width_m;
    scour->height_m = depth_m;
    strcpy(scour->object, "scoured");
    strcpy(sea_object(sea, 0)->name, "scoured");
}

void sea_set_heights(struct sea *sea, const sonject_relief_params *grid, const float *heights_m)
{
    EXPECT_OK(&sea->bench->report, relief_features_set_grid(&sea->bench->scene.relief,
                                                            &sea->bench->report, grid, heights_m));
}

void sea_set_layers(struct sea *sea, const struct water_layer *layers, size_t count)
{
    bench_set_layers(sea->bench, layers, count);
}

void set_mirror(sonject_material_params *material, double reflection)
{
    material->reflection_kind = SONJECT_REFLECTION_CONSTANT;
    material->reflection = reflection;
    material->roughness_m = 0.0;
    material->lambert = 0.0;
}

/* ---- what is laid ---- */

void sea_ready(struct sea *sea)
{
    bench_ready(sea->bench);
}

sonject_status sea_check_response(struct sea *sea)
{
    struct bench *bench = sea->bench;
    struct point_response response;
    const sonject_status status =
        point_response_of_scene(&response, &bench->report, &bench->scene, &bench->tracer.view,
                                bench->tracer.view.range_ratio * bench->water.straight_speed_mps);
    return status == SONJECT_OK
               ? cross_range_check(&response, &bench->report, &bench->scene, &bench->tracer.view)
               : status;
}

const char *sea_message(const struct sea *sea)
{
    return sea->bench->report.message;
}

static const struct patch_view *view_of(const struct sea *sea)
{
    return &sea->bench->tracer.view;
}

double sea_range(const struct sea *sea, double column)
{
    return view_processor_range(view_of(sea), column);
}

double sea_column(const struct sea *sea, double processor_range_m)
{
    return view_column_of_range(view_of(sea), processor_range_m);
}

double sea_ground(const struct sea *sea, double processor_range_m)
{
    return view_ground_range(view_of(sea), processor_range_m);
}

double sea_grazing(const struct sea *sea, double processor_range_m)
{
    return view_grazing(view_of(sea), processor_range_m);
}

double sea_x(const struct sea *sea, double row)
{
    return view_x_of_row(view_of(sea), row);
}

double sea_height(const struct sea *sea, double x_m, double ground_m)
{
    return relief_height(sea->bench->placed.relief, x_m, ground_m);
}

const struct water_layer *sea_layers(const struct sea *sea, size_t *count)
{
    *count = sea->bench->water.count;
    return sea->bench->water.layers;
}

double sea_wavelength(const struct sea *sea)
{
    return view_of(sea)->wavelength_m;
}

double sea_wavenumber(const struct sea *sea)
{
    return 2.0 * PI * sea->sonar->centre_frequency_hz / sea->medium->sound_speed_mps;
}

double sea_pulse(const struct sea *sea, double distance_m)
{
    return range_response(&sea->bench->tracer.response, distance_m);
}

double complex sea_pulse_complex(const struct sea *sea, double distance_m)
{
    const struct complex_number g =
        range_response_complex(&sea->bench->tracer.response, distance_m);
    return g.real_part + I * g.imaginary_part;
}

double sea_window(const struct sea *sea, double distance_m)
{
    return along_track_response(&sea->bench->tracer.response, distance_m);
}

double sea_pulse_energy(const struct sea *sea)
{
    return range_energy_width(&sea->bench->tracer.response);
}

double sea_window_energy(const struct sea *sea)
{
    return along_track_energy_width(&sea->bench->tracer.response);
}

double sea_window_reach(const struct sea *sea, double share)
{
    return along_track_energy_reach(&sea->bench->tracer.response, share);
}

double sea_cross_range_energy(const struct sea *sea, double processor_range_m)
{
    return cross_range_energy_width(&sea->bench->tracer.response, processor_range_m);
}

void sea_set_pulse(struct sea *sea, const double *positions, const double *real_part,
                   const double *imaginary_part, size_t count, bool is_in_seconds)
{
    EXPECT_OK(&sea->bench->report,
              response_table_set(&sea->bench->scene.pulse_table, &sea->bench->report, positions,
                                 real_part, imaginary_part, count, is_in_seconds));
    sea->pulse->kind = SONJECT_PULSE_TABLE;
}

void sea_set_window(struct sea *sea, const double *positions, const double *real_part,
                    const double *imaginary_part, size_t count)
{
    EXPECT_OK(&sea->bench->report,
              response_table_set(&sea->bench->scene.cross_range_table, &sea->bench->report,
                                 positions, real_part, imaginary_part, count, false));
}

double sea_seabed_level(const struct sea *sea, double processor_range_m)
{
    return seabed_cell_energy(view_of(sea), &sea->bench->tracer.response, sea->seabed->lambert,
                              processor_range_m);
}

const double *sea_centre(const struct sea *sea, uint32_t part)
{
    return sea->bench->placements[part].centre;
}

const double (*sea_axes(const struct sea *sea, uint32_t part))[3]
{
    return (const double(*)[3])sea->bench->placements[part].axes;
}

double sea_slant_range(const struct sea *sea, uint32_t part)
{
    return placement_range(&sea->bench->placements[part], view_of(sea));
}

void sea_heights(const struct sea *sea, uint32_t object, double heights[3])
{
    const struct placed_object *placed = &sea->bench->placed.objects[object];
    heights[0] = placed->bottom_m;
    heights[1] = placed->top_m;
    heights[2] = placed->origin[2];
}

void sea_put(struct sea *sea, uint32_t part, const double centre[3], const double nose[3],
             const double own_y[3])
{
    struct placement *placement = &sea->bench->placements[part];
    memcpy(placement->centre, centre, sizeof placement->centre);
    memcpy(placement->axes[0], nose, sizeof placement->axes[0]);
    memcpy(placement->axes[1], own_y, sizeof placement->axes[1]);
    for (int k = 0; k < 3; k++)
        placement->axes[2][k] =
            nose[(k + 1) % 3] * own_y[(k + 2) % 3] - nose[(k + 2) % 3] * own_y[(k + 1) % 3];
}

void face_sonar(struct sea *sea, double forward)
{
    sonject_object_params *object = sea_object(sea, 0);
    object->heading_rad = -0.5 * PI;
    object->pitch_rad = 0.0;
    for (int i = 0; i < 50; i++) { /* turning moves the centre: its lowest point is held */
        sea_ready(sea);
        const double *centre = sea_centre(sea, 0);
        object->pitch_rad = atan2(sea->sonar->altitude_m - centre[2], centre[1]) + forward;
    }
    sea_ready(sea);
}
