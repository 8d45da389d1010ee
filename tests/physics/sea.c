#include "sea.h"
#include "mesh_arrays.h"

#include "scene/placement.h"
#include "scene/point_response.h"

/* ---- claims ---- */

/* The functions to be called when the claim ends. */
static struct {
    void (*clear)(void *);
    void *of;
} * endings;
static size_t ending_count;

void claim_end(void (*clear)(void *), void *of)
{
    endings = realloc(endings, (ending_count + 1) * sizeof *endings);
    assert_true(endings && of);
    endings[ending_count].clear = clear;
    endings[ending_count++].of = of;
}

void *claim_memory(size_t count, size_t bytes)
{
    void *memory = calloc(count, bytes);
    claim_end(free, memory);
    return memory;
}

const char *claim_device(void)
{
    return bench_device;
}

static struct bench the_bench;
static struct sea the_sea; /* its bench is NULL if no sea is open */

static void close_sea(void)
{
    if (the_sea.bench)
        bench_close(the_sea.bench);
    the_sea.bench = NULL;
}

static void (*holds[32])(void);
static struct CMUnitTest tests[COUNT(holds)];
static size_t claim_count;

static void hold(void **state)
{
    (*(void (**)(void)) * state)();
}

static int end_claim(void **state)
{
    (void)state;
    close_sea();
    while (ending_count > 0) {
        ending_count--;
        endings[ending_count].clear(endings[ending_count].of);
    }
    free(endings);
    endings = NULL;
    return 0;
}

void add_claim(const char *name, void (*function)(void))
{
    if (claim_count == COUNT(holds))
        abort();
    holds[claim_count] = function;
    tests[claim_count] = (struct CMUnitTest){name, hold, NULL, end_claim, &holds[claim_count]};
    claim_count++;
}

int main(void)
{
    return bench_run_on_default(tests, claim_count);
}

/* ---- the scene ---- */

struct sea *sea_open(size_t rows, size_t columns, double middle_range_m)
{
    close_sea();
    bench_open(&the_bench, rows, columns, middle_range_m);
    struct scene *scene = &the_bench.scene;
    the_sea =
        (struct sea){&scene->sonar,  &scene->pulse,   &scene->motion.params, &scene->medium,
                     &scene->seabed, &scene->surface, &scene->geometry,      &scene->injection,
                     rows,           columns,         rows * columns,        false,
                     &the_bench};
    return &the_sea;
}

sonject_object_params *sea_add_sphere(struct sea *sea, double radius_m, double height_m)
{
    sonject_object_params *sphere = sea_add(sea, SHAPE_SPHERE, 0.0, 0.0, 2.0 * radius_m);
    sphere->burial_m = -height_m;
    return sphere;
}

sonject_object_params *sea_add_capsule(struct sea *sea)
{
    sonject_object_params *capsule = sea_add(sea, SHAPE_CAPSULE, 1.0, 0.0, 0.4);
    capsule->heading_rad = 0.6;
    capsule->burial_m = 0.1;
    capsule->material.reflection = 0.3;
    capsule->material.roughness_m = 2e-3;
    capsule->material.lambert = 0.1;
    return capsule;
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

sonject_object_params *sea_add_part(struct sea *sea, enum shape_kind shape, const double centre[3],
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

void sea_add_mesh(struct sea *sea, const struct mesh_sample *mesh, double unit_m,
                  double smooth_angle_rad)
{
    struct scene *scene = &sea->bench->scene;
    scene->meshes = realloc(scene->meshes, (scene->mesh_count + 1) * sizeof *scene->meshes);
    assert_non_null(scene->meshes);
    mesh_of_sample(mesh, unit_m, smooth_angle_rad, &scene->meshes[scene->mesh_count++]);
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
    const size_t count = (size_t)grid->rows * grid->columns;
    float *copy = zeroed(count, sizeof *copy); /* freed by the scene */
    memcpy(copy, heights_m, count * sizeof *copy);
    relief_features_take_grid(&sea->bench->scene.relief, grid, copy);
}

void set_mirror(sonject_material_params *material, double reflection)
{
    material->reflection_kind = SONJECT_REFLECTION_CONSTANT;
    material->reflection = reflection;
    material->roughness_m = 0.0;
    material->lambert = 0.0;
}

/* ---- what is laid ---- */

static void clear_placements(void *placements)
{
    placements_clear(placements);
}

/* Earlier placements stay until the claim ends, since claims may hold pointers to them. */
void sea_ready(struct sea *sea)
{
    struct placements *before = claim_memory(1, sizeof *before);
    *before = sea->bench->placed;
    memset(&sea->bench->placed, 0, sizeof sea->bench->placed);
    claim_end(clear_placements, before);
    bench_ready(sea->bench);
    sea->is_put = false;
}

void sea_lay(struct sea *sea)
{
    if (!sea->is_put)
        sea_ready(sea);
}

sonject_status sea_check_response(struct sea *sea)
{
    struct bench *bench = sea->bench;
    struct point_response response;
    CHECK(point_response_of_scene(&response, &bench->report, &bench->scene, sea_view(sea),
                                  sea_view(sea)->range_ratio * bench->water.straight_speed_mps));
    return cross_range_check(&response, &bench->report, &bench->scene, sea_view(sea));
}

double sea_wavenumber(const struct sea *sea)
{
    return 2.0 * PI * sea->sonar->centre_frequency_hz / sea->medium->sound_speed_mps;
}

double sea_pulse(const struct sea *sea, double distance_m)
{
    return range_response(sea_response(sea), distance_m);
}

double complex sea_pulse_complex(const struct sea *sea, double distance_m)
{
    const struct complex_number g = range_response_complex(sea_response(sea), distance_m);
    return g.real_part + I * g.imaginary_part;
}

double sea_window(const struct sea *sea, double distance_m)
{
    return along_track_response(sea_response(sea), distance_m);
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
    return seabed_cell_energy(sea_view(sea), sea_response(sea), sea->seabed->lambert,
                              processor_range_m);
}

void sea_put(struct sea *sea, uint32_t part, const double centre[3], const double nose[3],
             const double own_y[3])
{
    sea->is_put = true;
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
    for (int i = 0; i < 50; i++) { /* turning moves the centre, since the lowest point stays */
        sea_ready(sea);
        const double *centre = sea_centre(sea, 0);
        object->pitch_rad = atan2(sea->sonar->altitude_m - centre[2], centre[1]) + forward;
    }
    sea_ready(sea);
}
