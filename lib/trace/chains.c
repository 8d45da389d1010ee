#include "trace/chains.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "device/device.h"
#include "scene/surface_material.h"
#include "trace/chain_fans.h"
#include "trace/checkpoint.h"
#include "trace/fan.h"
#include "trace/image_sources.h"
#include "trace/object_buffer.h"
#include "trace/target_spheres.h"

#define PI              3.14159265358979323846
#define SEABED_SHARE    8.0f /* then all within about four widths of a target are followed */
#define TALLY_BYTES_MAX ((size_t)1 << 30)

typedef char orders_have_room[CHAIN_ORDERS_MAX == SCENE_INTERACTIONS_MAX ? 1 : -1];

static sonject_material_params seabed_material(const struct scene *scene)
{
    sonject_material_params material = scene->seabed.forward;
    if (isnan(material.lambert))
        material.lambert = scene->seabed.lambert;
    return material;
}

static void chain_record_init(struct chain_record *record, const struct chain_trace *trace,
                              const struct tracer *tracer, const struct target_spheres *spheres)
{
    const struct scene *scene = tracer->scene;
    const sonject_material_params seabed = seabed_material(scene);
    const bool is_brute_force = scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
    memset(record, 0, sizeof *record);
    record->interactions = (int32_t)scene->injection.interactions;
    record->estimator = is_brute_force ? CHAINS_BRUTE_FORCE : CHAINS_CONNECT;
    record->is_focused = scene->injection.column_rule == SONJECT_COLUMNS_FOCUSED;
    record->is_reciprocal = record->is_focused && scene->sonar.transducer_side_m == 0.0;
    record->forward_is_map = scene->seabed.forward_rule == SONJECT_FORWARD_MAP;
    record->spheres = (int32_t)spheres->count;
    record->groups = (int32_t)spheres->groups;
    record->seabed_share = SEABED_SHARE;
    for (int i = 0; i < CHAIN_ORDERS_MAX; i++)
        record->finer[i] = i + 1 < CHAIN_ORDERS_MAX
                               ? ldexpf(1.0f, trace->exponents[i + 1] - trace->exponents[i])
                               : 1.0f;
    record->first_order = (int32_t)trace->first_order;
    record->planes = (int32_t)trace->planes;
    record->tally_first_strip = trace->grid.strips.first;
    record->tally_strips = trace->grid.strips.count;
    surface_record_init(&record->seabed, &seabed, tracer->view.wavelength_m);
    record->seabed.rough_is_apart = true; /* as for sound that goes straight back */
    if (!trace->has_sea_surface)
        return;
    const sonject_material_params sea_surface = surface_material(&scene->surface);
    record->sea_surface_height = (float)scene->surface.water_depth_m;
    surface_record_init(&record->sea_surface, &sea_surface, tracer->view.wavelength_m);
}

/* The most of the sound that meets a surface: what goes on, and what scatters to the source. */
struct most_sent {
    double onward, returned;
};

/* is_led: the way on is sought among the targets, so that what goes there counts for itself and not
 * for a share of the albedo. rough: what the rough part is times, 0 if there is none. */
static void join_surface(struct most_sent *most, const sonject_material_params *material,
                         bool is_led, double rough)
{
    const bool is_fluid = material->reflection_kind == SONJECT_REFLECTION_FLUID;
    const double mirror = is_fluid ? 1.0 : material->reflection * material->reflection;
    const double scattering = rough * material_brightness(material);
    const double albedo = rough * (PI * material->lambert + material->glossy_albedo);
    most->onward = fmax(most->onward, mirror + (is_led ? 2.0 * PI * scattering : albedo));
    most->returned = fmax(most->returned, scattering);
}

static struct most_sent most_sent_by_surfaces(const struct chain_trace *trace,
                                              const struct tracer *tracer, const float *map)
{
    const struct scene *scene = tracer->scene;
    const sonject_material_params seabed = seabed_material(scene);
    const sonject_material_params sea_surface = surface_material(&scene->surface);
    struct most_sent most = {1e-12, 1e-12}; /* that an exponent exists */
    double brightest = 1.0;
    if (map && scene->seabed.forward_rule == SONJECT_FORWARD_MAP)
        for (size_t i = 0; i < tracer->view.rows * tracer->view.columns; i++)
            brightest = fmax(brightest, map[i]);
    join_surface(&most, &seabed, true, brightest);
    for (uint32_t i = 0; i < tracer->part_count; i++) {
        const sonject_material_params *material = tracer->placements[i].material;
        join_surface(&most, material, false, material_is_rough(material));
    }
    if (trace->has_sea_surface)
        join_surface(&most, &sea_surface, true, material_is_rough(&sea_surface));
    return most;
}

/* The most that one ray can bring is about its wavefront times what surfaces send on and back.
 * Quanta leave four powers of ten over that, since directions that are drawn rarely count for many,
 * and below it eleven. Orders in one plane have the quanta of the one that brings most. */
static sonject_status choose_quanta(struct chain_trace *trace, struct tracer *tracer,
                                    const float *map)
{
    struct fan_record fan;
    CHECK(patch_fan_init(&fan, tracer, &trace->grid, trace->has_map, 0.5));
    const double range = fan.reference_range;
    const double area = (double)fan.source_side * fan.source_side;
    struct most_sent most = most_sent_by_surfaces(trace, tracer, map);
    if (tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE && area > 0.0)
        most.returned = fmax(most.returned, most.onward * range * range / area);
    double bound = (double)fan.strip_width * fan.elevation_step * 2.0 * range * most.returned;
    if (trace->planes == 1)
        bound *= pow(most.onward, trace->first_order - 1.0) *
                 fmax(1.0, pow(most.onward, trace->orders - 1.0));
    for (int i = 0; i < CHAIN_ORDERS_MAX; i++) {
        trace->exponents[i] = 37 - (int)ceil(log2(bound));
        if (trace->planes > 1)
            bound *= most.onward;
    }
    return SONJECT_OK;
}

static sonject_status make_buffers(struct chain_trace *trace, struct tracer *tracer,
                                   const float *map)
{
    struct report *report = tracer->report;
    struct device *device = tracer->device;
    const uint32_t objects = tracer->part_count;
    struct object_record *records = allocate_array(objects, sizeof *records);
    struct target_spheres spheres;
    struct chain_record chains;
    double origin[3];
    patch_fan_origin(origin, &tracer->view);
    sonject_status status = target_spheres_init(&spheres, tracer, origin);
    if (status == SONJECT_OK && !records)
        status = report_out_of_memory(report, "objects");
    if (status == SONJECT_OK) {
        object_records_init(records, tracer, origin);
        chain_record_init(&chains, trace, tracer, &spheres);
        status = buffer_create(report, device, sizeof chains, &chains, &trace->chains);
    }
    THEN(status, object_buffer_create(tracer, records, (struct part_list){NULL, tracer->part_count},
                                      &trace->objects));
    THEN(status, buffer_create(report, device, spheres.bytes, spheres.records, &trace->spheres));
    THEN(status, buffer_create(report, device,
                               map ? tracer->view.rows * tracer->view.columns * sizeof *map : 0,
                               map, &trace->map));
    free(records);
    target_spheres_clear(&spheres);
    return status;
}

static sonject_status make_tallies(struct chain_trace *trace, struct tracer *tracer)
{
    const size_t cells = line_grid_cells(&trace->grid);
    const size_t bytes = trace->planes * cells * sizeof(int64_t);
    if (cells > TALLY_BYTES_MAX / sizeof(int64_t) / trace->planes ||
        bytes > tracer->device->allocation_limit)
        return report_failure(tracer->report, SONJECT_ERROR_INPUT,
                              "the patch of %zu x %zu pixels is too large for %u interactions: use "
                              "a smaller patch",
                              tracer->view.rows, tracer->view.columns,
                              (unsigned)tracer->scene->injection.interactions);
    sonject_status status =
        buffer_create(tracer->report, tracer->device, bytes, NULL, &trace->tallies);
    THEN(status, buffer_clear(tracer->report, tracer->device, trace->tallies, bytes));
    return status;
}

sonject_status chain_trace_begin(struct chain_trace *trace, struct tracer *tracer, const float *map)
{
    const sonject_injection_params *injection = &tracer->scene->injection;
    const bool is_brute_force = injection->estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
    memset(trace, 0, sizeof *trace);
    if (!is_brute_force && (injection->interactions < 2 || tracer->part_count == 0))
        return SONJECT_OK;
    trace->first_order = is_brute_force ? 1 : 2;
    trace->orders = injection->interactions - trace->first_order + 1;
    trace->planes = injection->order_energies ? trace->orders : 1;
    line_grid_for_patch(&trace->grid, &tracer->view, &tracer->response);
    trace->has_map = map != NULL;
    trace->has_sea_surface = sea_surface_is_in_chains(tracer, &trace->grid);
    sonject_status status = choose_quanta(trace, tracer, map);
    THEN(status, patch_rays_init(&trace->rays, &trace->table, tracer, &trace->grid));
    THEN(status, make_buffers(trace, tracer, map));
    THEN(status, make_tallies(trace, tracer));
    THEN(status, trace_kernel_create(tracer, tracer_variant(tracer), PROGRAM_TRACE_CHAINS,
                                     "trace_chains", &trace->kernel));
    if (status != SONJECT_OK)
        chain_trace_end(trace);
    return status;
}

void chain_trace_end(struct chain_trace *trace)
{
    kernel_release(&trace->kernel);
    ray_table_clear(&trace->rays);
    buffer_release(&trace->chains);
    buffer_release(&trace->objects);
    buffer_release(&trace->spheres);
    buffer_release(&trace->map);
    buffer_release(&trace->tallies);
}

sonject_status chain_trace_strips(struct chain_trace *trace, struct tracer *tracer,
                                  struct chain_fan *fan, struct span strips)
{
    const device_buffer buffers[] = {trace->chains, trace->objects, trace->spheres, trace->map,
                                     trace->tallies};
    fan->record.first_strip = strips.first;
    fan->record.strips = strips.count;
    fan->record.quanta = ldexpf(1.0f, trace->exponents[0]);
    fan->record.table = trace->table;
    return trace_launch(tracer, trace->kernel, &fan->record, &trace->rays, buffers, 5);
}

sonject_status chain_trace_read(struct chain_trace *trace, struct tracer *tracer, uint32_t plane,
                                float *energy)
{
    const size_t cells = line_grid_cells(&trace->grid);
    const void *mapped;
    const int64_t *tallies;
    const double energy_of_quantum =
        ldexp(view_energy_scale(&tracer->view), -trace->exponents[trace->first_order - 1 + plane]);
    CHECK(buffer_map(tracer->report, tracer->device, trace->tallies,
                     trace->planes * cells * sizeof(int64_t), &mapped));
    sonject_status status = checkpoint_sums(
        tracer->checkpoint, (const int64_t *)mapped + plane * cells, cells, &tallies);
    for (size_t i = 0; status == SONJECT_OK && i < cells; i++)
        energy[i] = (float)((double)tallies[i] * energy_of_quantum);
    buffer_unmap(tracer->device, trace->tallies, mapped);
    return status;
}
