#include "sea.h"

#include "bench.h"
#include "inject/injection.h"
#include "scene/cross_range.h"
#include "scene/pose.h"
#include "trace/glints.h"

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

static void expect_ok(const struct sea *sea, sonject_status status)
{
    if (status != SONJECT_OK)
        fail_msg("%s", sea->bench->report.message);
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
    expect_ok(sea, scene_append_part(scene, &sea->bench->report, &part));
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
    expect_ok(sea, mesh_from_arrays(&sea->bench->report, "mesh", mesh->positions, mesh->vertices,
                                    mesh->corners, mesh->triangles, &options,
                                    &scene->meshes[scene->mesh_count]));
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
    expect_ok(sea, check_user_shape(&params, &sea->bench->report, NULL));
    expect_ok(sea,
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
    expect_ok(sea, relief_features_set_grid(&sea->bench->scene.relief, &sea->bench->report, grid,
                                            heights_m));
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
    return view_apparent_range(view_of(sea), column);
}

double sea_column(const struct sea *sea, double apparent_range_m)
{
    return view_column_of_range(view_of(sea), apparent_range_m);
}

double sea_ground(const struct sea *sea, double apparent_range_m)
{
    return view_ground_range(view_of(sea), apparent_range_m);
}

double sea_grazing(const struct sea *sea, double apparent_range_m)
{
    return view_grazing(view_of(sea), apparent_range_m);
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

double sea_cross_range_energy(const struct sea *sea, double apparent_range_m)
{
    return cross_range_energy_width(&sea->bench->tracer.response, apparent_range_m);
}

void sea_set_pulse(struct sea *sea, const double *positions, const double *real_part,
                   const double *imaginary_part, size_t count, bool is_in_seconds)
{
    expect_ok(sea, response_table_set(&sea->bench->scene.pulse_table, &sea->bench->report,
                                      positions, real_part, imaginary_part, count, is_in_seconds));
    sea->pulse->kind = SONJECT_PULSE_TABLE;
}

void sea_set_window(struct sea *sea, const double *positions, const double *real_part,
                    const double *imaginary_part, size_t count)
{
    expect_ok(sea, response_table_set(&sea->bench->scene.cross_range_table, &sea->bench->report,
                                      positions, real_part, imaginary_part, count, false));
}

double sea_seabed_level(const struct sea *sea, double apparent_range_m)
{
    return seabed_cell_energy(view_of(sea), &sea->bench->tracer.response, sea->seabed->lambert,
                              apparent_range_m);
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

/* ---- glints ---- */

struct line sea_line(struct sea *sea, uint32_t object)
{
    struct tracer *tracer = &sea->bench->tracer;
    struct glints glints;
    struct line line;
    expect_ok(sea, glints_begin(&glints, tracer, object));
    line.bins = (size_t)glints.grid.bins.count;
    line.spacing_m = tracer->view.column_spacing_m / glints.grid.bins_per_pixel;
    line.first_range_m = tracer->view.first_range_m + glints.grid.bins.first * line.spacing_m;
    line.values = claim_memory(line.bins, sizeof *line.values);
    const int32_t chunk = glints_chunk(&glints);
    float *real_part = calloc((size_t)chunk * line.bins, sizeof *real_part);
    float *imaginary_part = calloc((size_t)chunk * line.bins, sizeof *imaginary_part);
    assert_true(real_part && imaginary_part);
    for (int32_t done = 0; done < glints.grid.strips.count; done += chunk) {
        const int32_t left = glints.grid.strips.count - done;
        const struct span strips = {glints.grid.strips.first + done, left < chunk ? left : chunk};
        expect_ok(sea, glints_trace(&glints, tracer, strips, real_part, imaginary_part));
        for (size_t i = 0; i < (size_t)strips.count * line.bins; i++)
            line.values[i % line.bins] += real_part[i] + I * (double)imaginary_part[i];
    }
    free(real_part);
    free(imaginary_part);
    glints_end(&glints);
    return line;
}

double complex line_at(const struct sea *sea, const struct line *line, double range_m)
{
    double complex sum = 0.0;
    for (size_t i = 0; i < line->bins; i++)
        sum += line->values[i] *
               sea_pulse(sea, range_m - (line->first_range_m + (double)i * line->spacing_m));
    return sum;
}

double line_peak(const struct sea *sea, const struct line *line, double *range_m)
{
    double largest = 0.0;
    for (size_t i = 0; i < line->bins; i++) {
        const double range = line->first_range_m + (double)i * line->spacing_m;
        const double amplitude = cabs(line_at(sea, line, range));
        if (amplitude > largest && range_m)
            *range_m = range;
        largest = fmax(largest, amplitude);
    }
    return largest;
}

double line_energy(const struct line *line)
{
    double energy = 0.0;
    for (size_t i = 0; i < line->bins; i++)
        energy += pow(cabs(line->values[i]), 2.0);
    return energy;
}

void line_add(struct line *sum, const struct line *line, double factor)
{
    const long shift = lround((sum->first_range_m - line->first_range_m) / line->spacing_m);
    for (size_t bin = 0; bin < sum->bins; bin++) {
        const long other = (long)bin + shift;
        if (other >= 0 && other < (long)line->bins)
            sum->values[bin] += factor * line->values[other];
    }
}

double sea_peak(struct sea *sea, double *range_m)
{
    const struct line line = sea_line(sea, 0);
    return line_peak(sea, &line, range_m);
}

/* ---- energies before the image is formed ---- */

static struct strips strips_of(const struct line_grid *grid, const float *energy)
{
    const struct strips strips = {grid->strips.count,
                                  grid->bins.count,
                                  grid->strips.first,
                                  grid->bins.first,
                                  (int)grid->strips_per_row,
                                  (int)grid->bins_per_pixel,
                                  energy};
    return strips;
}

struct strips sea_rough(struct sea *sea, struct tile_sums *sums, struct strips *tiles)
{
    static struct rough_trace trace;
    struct tracer *tracer = &sea->bench->tracer;
    expect_ok(sea, rough_trace_begin(&trace, tracer, NULL));
    float *energy = claim_memory(line_grid_cells(&trace.grid), sizeof *energy);
    float *planes = claim_memory(trace.tile_elements + 1, sizeof *planes);
    expect_ok(sea, rough_trace_strips(&trace, tracer, trace.grid.strips, energy));
    if (tracer->part_count > 0)
        expect_ok(sea, rough_trace_tiles(&trace, tracer, planes));
    for (uint32_t part = 0; part < tracer->part_count; part++) {
        const float *first = planes + trace.tiles[part].offset;
        const size_t plane = line_grid_cells(&trace.tiles[part].grid);
        if (sums) {
            sums[part].energy = sum_of(first + TILE_ENERGY * plane, plane);
            sums[part].lost = sum_of(first + TILE_LOST * plane, plane);
            sums[part].footprint = sum_of(first + TILE_FOOTPRINT * plane, plane);
        }
        if (tiles)
            tiles[part] = strips_of(&trace.tiles[part].grid, first + TILE_ENERGY * plane);
    }
    const struct strips strips = strips_of(&trace.grid, energy);
    rough_trace_end(&trace);
    return strips;
}

struct strips sea_rough_of_beam(struct sea *sea)
{
    static struct rough_trace trace;
    struct tracer *tracer = &sea->bench->tracer;
    expect_ok(sea, rough_trace_begin_beam(&trace, tracer, &tracer->response));
    float *energy = claim_memory(line_grid_cells(&trace.grid), sizeof *energy);
    expect_ok(sea, rough_trace_strips(&trace, tracer, trace.grid.strips, energy));
    const struct strips strips = strips_of(&trace.grid, energy);
    rough_trace_end(&trace);
    return strips;
}

struct strips sea_grid(const struct sea *sea, double *first_x, double *last_x)
{
    struct line_grid grid;
    line_grid_for_patch(&grid, view_of(sea), &sea->bench->tracer.response);
    const double strips = grid.strips_per_row;
    *first_x = sea_x(sea, grid.strips.first / strips - 0.5);
    *last_x = sea_x(sea, (grid.strips.first + grid.strips.count) / strips - 0.5);
    return strips_of(&grid, NULL);
}

static void add_chains(struct sea *sea, const struct ranges *ranges,
                       void (*change)(struct bench *, struct chain_trace *),
                       struct energies *energies)
{
    struct tracer *tracer = &sea->bench->tracer;
    struct chain_trace trace;
    expect_ok(sea, chain_trace_begin(&trace, tracer, NULL));
    if (change)
        change(sea->bench, &trace);
    for (uint32_t i = 0; i < chain_fan_count(tracer); i++) {
        struct chain_fan fan;
        expect_ok(sea, chain_fan_init(&fan, tracer, &trace.grid, false, i));
        expect_ok(sea, chain_trace_strips(&trace, tracer, &fan, fan.strips));
    }
    const size_t cells = line_grid_cells(&trace.grid);
    float *plane = malloc(cells * sizeof *plane);
    assert_non_null(plane);
    for (uint32_t p = 0; p < trace.planes; p++) {
        const uint32_t order = trace.first_order - 1 + p;
        double values[CHAIN_RANGES] = {0.0};
        expect_ok(sea, chain_trace_read(&trace, tracer, p, plane));
        for (size_t i = 0; i < cells; i++) {
            const int32_t bin =
                trace.grid.bins.first + (int32_t)(i % (size_t)trace.grid.bins.count);
            const double range = sea_range(sea, (double)bin / trace.grid.bins_per_pixel);
            const int at =
                ranges->count > 0 ? (int)floor((range - ranges->first_m) / ranges->width_m) : 0;
            if (at >= 0 && at < (ranges->count > 0 ? ranges->count : 1))
                values[at] += (double)plane[i];
        }
        for (int range = 0; order < CHAIN_ORDERS && range < CHAIN_RANGES; range++) {
            energies->sum[order][range] += values[range];
            energies->square[order][range] += values[range] * values[range];
        }
    }
    free(plane);
    chain_trace_end(&trace);
}

struct energies sea_changed_chains(struct sea *sea, const struct ranges *ranges,
                                   uint64_t first_seed, int seeds,
                                   void (*change)(struct bench *bench, struct chain_trace *trace))
{
    struct energies energies;
    memset(&energies, 0, sizeof energies);
    for (; energies.seeds < seeds; energies.seeds++) {
        sea->injection->seed = first_seed + (uint64_t)energies.seeds;
        add_chains(sea, ranges, change, &energies);
    }
    return energies;
}

struct energies sea_chains(struct sea *sea, const struct ranges *ranges, uint64_t first_seed,
                           int seeds)
{
    return sea_changed_chains(sea, ranges, first_seed, seeds, NULL);
}

uint64_t sea_queries(const struct sea *sea)
{
    return sea->bench->tracer.counts.queries - sea->bench->tracer.counts.rays;
}

struct estimate energy_of(const struct energies *energies, int order, int range)
{
    return estimate_of_sums(energies->sum[order][range], energies->square[order][range],
                            energies->seeds);
}

/* ---- images ---- */

static float *copy_plane(const float *plane, size_t count)
{
    float *copy = plane ? claim_memory(count, sizeof *copy) : NULL;
    if (plane)
        memcpy(copy, plane, count * sizeof *copy);
    return copy;
}

static double complex *join_planes(const float *real_part, const float *imaginary_part,
                                   size_t count)
{
    double complex *joined = real_part ? claim_memory(count, sizeof *joined) : NULL;
    for (size_t i = 0; real_part && i < count; i++)
        joined[i] = real_part[i] + I * (double)imaginary_part[i];
    return joined;
}

static const struct object_image *copy_objects(const struct echoes *echoes)
{
    struct object_image *objects = claim_memory(echoes->object_count + 1, sizeof *objects);
    for (uint32_t i = 0; i < echoes->object_count; i++) {
        const struct object_echo *echo = &echoes->objects[i];
        objects[i].first_column = echo->first_column;
        objects[i].columns = echo->columns;
        objects[i].energy = copy_plane(echo->energy, echoes->rows * echo->columns);
        objects[i].peak_energy = echo->peak_energy;
    }
    return objects;
}

const struct image *sea_image_of(struct sea *sea, const float *map, bool has_speckle)
{
    struct image *image = claim_memory(1, sizeof *image);
    struct echoes echoes;
    struct echo_request request;
    memset(&request, 0, sizeof request);
    request.map = map;
    request.field = has_speckle ? SEABED_FIELD_SPECKLE : SEABED_FIELD_NONE;
    expect_ok(sea, echoes_compute(&echoes, &sea->bench->tracer, &request));
    const size_t count = echoes.rows * echoes.columns;
    image->rows = echoes.rows;
    image->columns = echoes.columns;
    image->pixels = count;
    image->seabed_energy = copy_plane(echoes.seabed_energy, count);
    image->level_energy = copy_plane(echoes.level_energy, count);
    image->lost_energy = copy_plane(echoes.lost_energy, count);
    image->target_energy = copy_plane(echoes.target_energy, count);
    image->energy = copy_plane(echoes.energy, count);
    image->orders = echoes.orders;
    for (uint32_t order = 0; order < echoes.orders && order < CHAIN_ORDERS; order++)
        image->order_energy[order] = copy_plane(echoes.order_energy[order], count);
    image->target = join_planes(echoes.target_real, echoes.target_imaginary, count);
    image->seabed = join_planes(echoes.seabed_real, echoes.seabed_imaginary, count);
    image->objects = copy_objects(&echoes);
    echoes_clear(&echoes);
    return image;
}

const struct image *sea_image(struct sea *sea)
{
    return sea_image_of(sea, NULL, false);
}

double sum_of(const float *plane, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += (double)plane[i];
    return sum;
}

double complex brightest(const struct image *image, size_t *row, size_t *column)
{
    size_t at = 0;
    for (size_t i = 1; i < image->pixels; i++)
        if (cabs(image->target[i]) > cabs(image->target[at]))
            at = i;
    *row = at / image->columns;
    *column = at % image->columns;
    return image->target[at];
}

double *visibility_of(const struct image *image)
{
    double *visibility = claim_memory(image->pixels, sizeof *visibility);
    for (size_t i = 0; i < image->pixels; i++)
        visibility[i] = 1.0 - (double)image->lost_energy[i] / image->seabed_energy[i];
    return visibility;
}

bool images_differ(const struct image *one, const struct image *other)
{
    const size_t bytes = one->pixels * sizeof(float);
    bool differ =
        memcmp(one->target, other->target, one->pixels * sizeof *one->target) != 0 ||
        memcmp(one->target_energy, other->target_energy, bytes) != 0 ||
        memcmp(one->seabed_energy, other->seabed_energy, bytes) != 0 ||
        memcmp(one->lost_energy, other->lost_energy, bytes) != 0 ||
        memcmp(one->energy, other->energy, bytes) != 0 || one->orders != other->orders ||
        (one->seabed && memcmp(one->seabed, other->seabed, one->pixels * sizeof *one->seabed) != 0);
    for (uint32_t order = 0; order < one->orders && order < CHAIN_ORDERS; order++)
        differ = differ || memcmp(one->order_energy[order], other->order_energy[order], bytes) != 0;
    return differ;
}

double image_difference(const struct image *one, const struct image *other, double *peak)
{
    double largest = 0.0;
    *peak = 0.0;
    for (size_t i = 0; i < one->pixels; i++) {
        *peak = fmax(*peak, cabs(one->target[i]));
        largest = fmax(largest, cabs(one->target[i] - other->target[i]));
    }
    return largest;
}

double complex *sea_noise(struct sea *sea, enum noise kind)
{
    const uint32_t stream = kind == NOISE_OF_IMAGE   ? STREAM_NOISE
                            : kind == NOISE_OF_PHASE ? STREAM_INPUT_PHASE
                                                     : 75 + (uint32_t)kind;
    const struct window window = {0, sea->rows, 0, sea->columns};
    float *parts[2];
    for (int k = 0; k < 2; k++)
        parts[k] = claim_memory(sea->pixels, sizeof *parts[k]);
    expect_ok(sea, coloured_noise(&sea->bench->tracer, stream, &window, parts[0], parts[1]));
    return join_planes(parts[0], parts[1], sea->pixels);
}

struct estimate level_over(const struct sea *sea, const struct image *image, size_t edge,
                           bool is_field)
{
    double sum = 0.0, squares = 0.0;
    for (size_t column = edge; column + edge < sea->columns; column++) {
        const double expected = sea_seabed_level(sea, sea_range(sea, (double)column));
        double mean = 0.0;
        for (size_t row = 0; row < sea->rows; row++) {
            const size_t i = row * sea->columns + column;
            mean += (is_field ? pow(cabs(image->seabed[i]), 2.0) : image->seabed_energy[i]) /
                    expected / (double)sea->rows;
        }
        sum += mean;
        squares += mean * mean;
    }
    return estimate_of_sums(sum, squares, (double)(sea->columns - 2 * edge));
}

double complex correlation_of(const struct sea *sea, const double complex *field, size_t rows,
                              size_t columns, size_t edge)
{
    double complex sum = 0.0;
    double count = 0.0;
    for (size_t row = 0; row + rows < sea->rows; row++)
        for (size_t column = edge; column + columns + edge <= sea->columns; column++) {
            const size_t i = row * sea->columns + column;
            sum += conj(field[i]) * field[i + rows * sea->columns + columns];
            count += 1.0;
        }
    return sum / count;
}

double complex *unit_field(const struct sea *sea, const double complex *field, const float *energy)
{
    double complex *unit = claim_memory(sea->pixels, sizeof *unit);
    for (size_t i = 0; i < sea->pixels; i++)
        unit[i] = field[i] / sqrt((double)energy[i]);
    return unit;
}

/* ---- injections ---- */

static const void *copy_bytes(const void *from, size_t bytes)
{
    void *copy = claim_memory(bytes + 1, 1);
    if (bytes > 0)
        memcpy(copy, from, bytes);
    return copy;
}

const struct injected *sea_inject(struct sea *sea, const float *pixels, bool is_complex)
{
    struct injected *injected = claim_memory(1, sizeof *injected);
    struct injection_input input;
    struct injection_result result;
    memset(&input, 0, sizeof input);
    input.rows = sea->rows;
    input.columns = sea->columns;
    input.is_complex = is_complex;
    input.pixels = pixels;
    expect_ok(sea, injection_run(&sea->bench->report, sea->bench->tracer.device, &sea->bench->scene,
                                 &input, NULL, NULL, &result));
    injected->image = copy_plane(result.image, sea->pixels * (is_complex ? 2 : 1));
    injected->field = copy_plane(result.field, 2 * sea->pixels);
    injected->energy = copy_plane(result.energy, sea->pixels);
    injected->visibility = copy_plane(result.visibility, sea->pixels);
    for (uint32_t order = 0; order < result.orders && order < CHAIN_ORDERS; order++)
        injected->order_energy[order] = copy_plane(result.order_energy[order], sea->pixels);
    injected->highlight = copy_bytes(result.highlight, sea->pixels);
    injected->labels = copy_bytes(result.labels, sea->pixels);
    injected->influence = copy_bytes(result.influence, sea->pixels);
    injected->objects = copy_bytes(result.objects, result.object_count * sizeof *result.objects);
    injected->statistics = result.statistics;
    injection_result_clear(&result);
    return injected;
}

float *pairs_of(const double complex *field, size_t count)
{
    float *pairs = claim_memory(2 * count, sizeof *pairs);
    for (size_t i = 0; i < count; i++) {
        pairs[2 * i] = (float)creal(field[i]);
        pairs[2 * i + 1] = (float)cimag(field[i]);
    }
    return pairs;
}

float *magnitudes_of(const double complex *field, size_t count)
{
    float *magnitudes = claim_memory(count, sizeof *magnitudes);
    for (size_t i = 0; i < count; i++)
        magnitudes[i] = (float)cabs(field[i]);
    return magnitudes;
}

struct level sea_level(struct sea *sea, const float *pixels, bool is_complex)
{
    struct patch_level level;
    expect_ok(sea, patch_level_init(&level, &sea->bench->report, &sea->bench->scene, view_of(sea),
                                    &sea->bench->tracer.response, pixels, is_complex));
    const struct level copy = {copy_plane(level.level, sea->pixels),
                               copy_plane(level.cell_energy, sea->columns), level.noise_ratio};
    patch_level_clear(&level);
    return copy;
}
