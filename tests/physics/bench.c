#include "bench.h"

#include "claims.h"
#include "device/opencl/opencl.h"
#include "mesh_arrays.h"

const char *bench_device;

/* A device that a bench gave back, with its programs, or NULL, and the bench_device that it is. */
static struct device *free_device;
static const char *free_device_name;

struct device *bench_open_device(struct bench *bench)
{
    struct device *device = NULL;
    sonject_context_params context;
    memset(&context, 0, sizeof context);
    context.struct_size = sizeof context;
    context.device_name = bench_device;
    EXPECT_OK(&bench->report, device_open(&bench->report, &context, &device));
    return device;
}

struct device *bench_open_width(struct bench *bench, uint32_t width)
{
    struct device *device = bench_open_device(bench);
    device->width = width;
    if (width == 1 && device->is_pocl) {
        device->is_cpu = false;
        device->group_items = 64;
    }
    return device;
}

struct device *bench_open_reference(struct bench *bench)
{
    const char *kept = bench_device;
    uint32_t width = 1;
    while (!native_has_width(width))
        width *= 2;
    bench_device = "native";
    struct device *device = bench_open_width(bench, width);
    bench_device = kept;
    return device;
}

static void take_device(struct bench *bench)
{
    if (free_device && free_device_name == bench_device) {
        bench->tracer.device = free_device;
        free_device = NULL;
    } else {
        bench->tracer.device = bench_open_device(bench);
    }
    bench->device = bench->tracer.device;
    bench->device_width = bench->device->width;
}

/* Keeps the device for the next bench if it is as it was taken. Closes any other device. */
static void give_device_back(struct bench *bench)
{
    struct device **device = &bench->tracer.device;
    if (*device && *device == bench->device && (*device)->width == bench->device_width) {
        device_close(&free_device);
        free_device = *device;
        free_device_name = bench_device;
        *device = NULL;
    }
    device_close(device);
}

void bench_open(struct bench *bench, size_t rows, size_t columns, double middle_range_m)
{
    memset(bench, 0, sizeof *bench);
    scene_init(&bench->scene);
    bench->scene.sonar.aperture_rad = 0.0; /* closed forms assume one aspect */
    bench->scene.sonar.response_window = SONJECT_WINDOW_RECTANGULAR; /* and a sinc */
    bench->rows = rows;
    bench->columns = columns;
    bench->tracer.report = &bench->report;
    bench->tracer.scene = &bench->scene;
    bench_move(bench, middle_range_m);
    take_device(bench);
}

void bench_close(struct bench *bench)
{
    give_device_back(bench);
    placements_clear(&bench->placed);
    water_clear(&bench->water);
    scene_clear(&bench->scene);
}

void bench_set_width(struct bench *bench, uint32_t width)
{
    if (width == bench->tracer.device->width)
        return;
    give_device_back(bench);
    if (width == bench->device_width) {
        take_device(bench);
        return;
    }
    bench->tracer.device = bench_open_width(bench, width);
}

void bench_move(struct bench *bench, double middle_range_m)
{
    sonject_geometry_params *geometry = &bench->scene.geometry;
    geometry->first_slant_range_m =
        middle_range_m - 0.5 * (double)(bench->columns - 1) * geometry->column_spacing_m;
}

void bench_set_layers(struct bench *bench, const struct water_layer *layers, size_t count)
{
    struct scene *scene = &bench->scene;
    free(scene->water_layers);
    scene->water_layers = count > 0 ? malloc(count * sizeof *layers) : NULL;
    scene->water_layer_count = count;
    assert_true(count == 0 || scene->water_layers);
    if (count > 0)
        memcpy(scene->water_layers, layers, count * sizeof *layers);
}

sonject_object_params *bench_add(struct bench *bench, enum shape_kind shape, double length_m,
                                 double width_m, double diameter_m)
{
    sonject_object_params object;
    object_init(&object);
    object.shape = shape;
    object.length_m = length_m;
    object.width_m = width_m;
    object.diameter_m = diameter_m;
    object.material.reflection = 1.0;
    object.material.roughness_m = 0.0;
    object.material.lambert = 0.0;
    assert_true(bench->scene.object_count < SCENE_OBJECTS_MAX);
    EXPECT_OK(&bench->report, scene_append_object(&bench->scene, &bench->report, &object));
    return &bench->scene.objects[bench->scene.object_count - 1];
}

sonject_object_params *bench_place(sonject_object_params *object, double row, double column,
                                   double heading, double pitch, double roll)
{
    object->position_kind = SONJECT_POSITION_PIXELS;
    object->position_along = row;
    object->position_range = column;
    object->heading_rad = heading;
    object->pitch_rad = pitch;
    object->roll_rad = roll;
    object->material.lambert = 0.05;
    object->material.reflection = 0.8;
    object->material.roughness_m = 1e-3;
    return object;
}

struct relief_feature *bench_add_relief(struct bench *bench, enum relief_kind kind)
{
    struct relief_feature feature;
    memset(&feature, 0, sizeof feature);
    feature.kind = kind;
    EXPECT_OK(&bench->report,
              relief_features_append(&bench->scene.relief, &bench->report, &feature));
    return &bench->scene.relief.features[bench->scene.relief.count - 1];
}

void bench_add_tetrahedron(struct bench *bench)
{
    static double positions[][3] = {
        {-0.3, -0.3, -0.2}, {0.3, -0.3, -0.2}, {0.0, 0.4, -0.2}, {0.0, 0.0, 0.4}};
    static uint32_t corners[][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const struct mesh_sample tetrahedron = {positions[0], corners[0], 4, 4};
    bench->scene.meshes = zeroed(1, sizeof *bench->scene.meshes);
    bench->scene.mesh_count = 1;
    mesh_of_sample(&tetrahedron, 1.0, 0.0, &bench->scene.meshes[0]);
}

size_t bench_buffer_bytes(struct bench *bench, device_buffer buffer)
{
    size_t bytes = 0;
    if (native_is_named(bench->tracer.device->name))
        return native_buffer_bytes(buffer);
    assert_int_equal(clGetMemObjectInfo(buffer, CL_MEM_SIZE, sizeof bytes, &bytes, NULL),
                     CL_SUCCESS);
    return bytes;
}

void *bench_copy_buffer(struct bench *bench, device_buffer buffer)
{
    const size_t bytes = bench_buffer_bytes(bench, buffer);
    void *copy = zeroed(bytes, 1);
    EXPECT_OK(&bench->report,
              buffer_read(&bench->report, bench->tracer.device, buffer, 0, bytes, copy));
    return copy;
}

size_t bench_expect_sums(const char *what, const int64_t *measured, const int64_t *expected,
                         size_t count)
{
    size_t filled = 0;
    for (size_t i = 0; i < count; i++) {
        filled += expected[i] != 0;
        if (measured[i] != expected[i])
            fail_msg("%s: element %zu of %zu is %lld, not %lld", what, i, count,
                     (long long)measured[i], (long long)expected[i]);
    }
    return filled;
}

void bench_ready(struct bench *bench)
{
    struct tracer *tracer = &bench->tracer;
    water_clear(&bench->water);
    EXPECT_OK(&bench->report, scene_lay_water(&bench->scene, &bench->report, &bench->water));
    EXPECT_OK(&bench->report,
              patch_view_init(&tracer->view, &bench->report, &bench->scene, &bench->water, 0.0, 0.0,
                              bench->rows, bench->columns));
    placements_clear(&bench->placed);
    EXPECT_OK(&bench->report, placements_init(&bench->placed, &bench->report, &bench->scene,
                                              &tracer->view, 0.0, 0.0));
    bench->placements = bench->placed.parts;
    tracer->placements = bench->placed.parts;
    tracer->part_count = bench->placed.part_count;
    tracer->objects = bench->placed.objects;
    tracer->relief = bench->placed.relief;
    EXPECT_OK(&bench->report, point_response_of_scene(
                                  &tracer->response, &bench->report, &bench->scene, &tracer->view,
                                  tracer->view.range_ratio * bench->water.straight_speed_mps));
}

size_t bench_widths(uint32_t widths[BENCH_WIDTHS])
{
    struct bench bench;
    size_t count = 0;
    bench_open(&bench, 1, 1, 18.0);
    const bool is_native = native_is_named(bench.device->name);
    for (uint32_t width = 1; width <= 16; width *= 2)
        if (is_native ? native_has_width(width) : width == 1 || width == bench.device_width)
            widths[count++] = width;
    bench_close(&bench);
    return count;
}

size_t bench_devices(char names[BENCH_DEVICES][128])
{
    static sonject_device_info devices[BENCH_DEVICES];
    struct report report;
    size_t count = 0;
    memset(&report, 0, sizeof report);
    assert_int_equal(device_list(&report, devices, BENCH_DEVICES, &count), SONJECT_OK);
    assert_true(count > 0);
    count = count < BENCH_DEVICES ? count : BENCH_DEVICES;
    for (size_t i = 0; i < count; i++)
        memcpy(names[i], devices[i].name, sizeof devices[i].name);
    return count;
}

static int run_on(const char *device, const struct CMUnitTest *tests, size_t count)
{
    bench_device = device;
    print_message("device: %s\n", device ? device : "the default");
    const int failures = _cmocka_run_group_tests(device ? device : "", tests, count, NULL, NULL);
    device_close(&free_device);
    bench_device = NULL;
    return failures;
}

int bench_run_on_devices(const struct CMUnitTest *tests, size_t count)
{
    char names[BENCH_DEVICES][128];
    const size_t devices = bench_devices(names);
    int failures = 0;
    for (size_t i = 0; i < devices; i++)
        failures += run_on(names[i], tests, count);
    return failures;
}

int bench_run_on_default(const struct CMUnitTest *tests, size_t count)
{
    return run_on(NULL, tests, count);
}

void expect_close(const char *what, double measured, double expected, double tolerance)
{
    print_message("%s: %.6g, expected %.6g +- %.2g\n", what, measured, expected, tolerance);
    if (!(fabs(measured - expected) <= tolerance))
        fail_msg("%s: %.9g is not %.9g within %.3g", what, measured, expected, tolerance);
}

void expect_below(const char *what, double measured, double limit)
{
    print_message("%s: %.6g, to be below %.6g\n", what, measured, limit);
    if (!(measured < limit))
        fail_msg("%s: %.9g is not below %.9g", what, measured, limit);
}
