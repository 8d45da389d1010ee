#include "trace/tracer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/shapes/shape.h"
#include "trace/checkpoint.h"
#include "trace/fan.h"
#include "trace/fouling.h"
#include "trace/object_buffer.h"

#define PI 3.14159265358979323846
/* Limits of a launch: larger tallies cost more to map and clear, fewer groups leave a GPU idle. */
#define TALLY_BYTES   ((size_t)16 << 20)
#define GROUPS_WANTED 4096

/* Host and device must agree on every byte. */
typedef char object_record_is_packed[sizeof(struct object_record) == 49 * 4 ? 1 : -1];
typedef char fan_record_is_packed[sizeof(struct fan_record) == 82 * 4 ? 1 : -1];
typedef char chain_record_is_packed[sizeof(struct chain_record) == 46 * 4 ? 1 : -1];
typedef char target_record_is_packed[sizeof(struct target_record) == 17 * 4 ? 1 : -1];
typedef char sphere_group_is_packed[sizeof(struct sphere_group) == 64 * 4 ? 1 : -1];
typedef char sphere_record_is_packed[sizeof(struct sphere_record) == 4 * 4 ? 1 : -1];
typedef char image_pair_record_is_packed[sizeof(struct image_pair_record) == 51 * 4 ? 1 : -1];
typedef char multibounce_record_is_packed[sizeof(struct multibounce_record) == 13 * 4 ? 1 : -1];
typedef char
    multibounce_echo_record_is_packed[sizeof(struct multibounce_echo_record) == 6 * 4 ? 1 : -1];
typedef char ray_piece_record_is_packed[sizeof(struct ray_piece_record) == 7 * 4 ? 1 : -1];
typedef char outcome_record_is_packed[sizeof(struct outcome_record) == 4 * 4 ? 1 : -1];

float power_of_two_below(double value)
{
    int exponent;
    frexp(value, &exponent);
    return (float)ldexp(1.0, exponent - 1);
}

void fan_record_init(struct fan_record *fan, const struct tracer *tracer, const double origin[3],
                     const struct line_grid *grid)
{
    const struct patch_view *view = &tracer->view;
    const double range = ray_path_range(&view->water, origin[1], origin[2]);
    const double grazing = ray_path_grazing(&view->water, origin[1], origin[2]);
    const double row_of_strip0 = 0.5 / grid->strips_per_row - 0.5;
    const double bins_per_processor_metre = grid->bins_per_pixel / view->column_spacing_m;
    const double cycles = 2.0 * range / view->wavelength_m;
    const uint64_t seed = tracer->scene->injection.seed ^ tracer->scene->injection.ray_seed;
    memset(fan, 0, sizeof *fan);
    fan->reference_range = (float)range;
    fan->cosine_depression = (float)cos(grazing);
    fan->sine_depression = (float)sin(grazing);
    fan->table.ground_range = (float)origin[1];
    fan->seabed_height = (float)-origin[2];
    fan->first_strip_x = (float)(view_x_of_row(view, row_of_strip0) - origin[0]);
    fan->strip_width = (float)(view->row_spacing_m / grid->strips_per_row);
    fan->strata = 1;
    fan->bins_per_metre = (float)(bins_per_processor_metre * view->range_ratio);
    fan->bin_at_reference =
        (float)((range * view->range_ratio - view->first_range_m) * bins_per_processor_metre -
                grid->bins.first);
    fan->bins = grid->bins.count;
    fan->source_side = (float)tracer->scene->sonar.transducer_side_m;
    fan->map_row_at_origin = (float)view_row_of_x(view, origin[0]);
    fan->map_rows_per_metre = (float)(1.0 / view->row_spacing_m);
    fan->map_column_at_reference = (float)view_column_of_range(view, range * view->range_ratio);
    fan->map_columns_per_metre = (float)(view->range_ratio / view->column_spacing_m);
    fan->cycles_per_metre = (float)(2.0 / view->wavelength_m);
    fan->first_cycles = (float)(cycles - floor(cycles));
    fan->inverse_wavelength = (float)(1.0 / view->wavelength_m);
    fan->seed_low = (uint32_t)(seed & 0xffffffffu);
    fan->seed_high = (uint32_t)(seed >> 32);
    fan->objects = (int32_t)tracer->part_count;
    fan->segments = 1;
    fan->track_strip = (int32_t)(view->first_row * grid->strips_per_row);
    fan->relief_words = object_buffer_relief_words(tracer, tracer->part_count);
    if (tracer->relief) {
        fan->relief_x = (float)(tracer->relief->first_x_m - origin[0]);
        fan->relief_y = (float)(tracer->relief->first_y_m - origin[1]);
    }
}

double tracer_lowest_seabed(const struct tracer *tracer)
{
    return tracer->relief ? tracer->relief->lowest_m : 0.0;
}

double tracer_highest_seabed(const struct tracer *tracer)
{
    return tracer->relief ? tracer->relief->highest_m : 0.0;
}

void surface_record_init(struct surface_record *record, const sonject_material_params *material,
                         double wavelength_m)
{
    /* k2/k = (1 + i loss) / speed ratio */
    const double slowness = 1.0 / (material->speed_ratio * material->speed_ratio);
    memset(record, 0, sizeof *record);
    record->reflection_kind = material->reflection_kind == SONJECT_REFLECTION_FLUID
                                  ? REFLECTION_FLUID
                              : material->reflection != 0.0 ? REFLECTION_CONSTANT
                                                            : REFLECTION_NONE;
    record->reflection = (float)material->reflection;
    record->density_ratio = (float)material->density_ratio;
    record->index_real = (float)((1.0 - material->loss * material->loss) * slowness);
    record->index_imaginary = (float)(2.0 * material->loss * slowness);
    record->roughness_phase = (float)(4.0 * PI * material->roughness_m / wavelength_m);
    record->lambert = (float)material->lambert;
    record->lambert_exponent = (float)material->lambert_exponent;
    record->glossy_albedo = (float)material->glossy_albedo;
    record->glossy_slope = (float)material->glossy_slope;
}

double material_brightness(const sonject_material_params *material)
{
    const double cone =
        material->glossy_albedo / (4.0 * PI * material->glossy_slope * material->glossy_slope);
    return 0.5 * material->lambert * (material->lambert_exponent + 1.0) + cone;
}

bool material_is_smooth(const sonject_material_params *material)
{
    return material->reflection_kind == SONJECT_REFLECTION_FLUID || material->reflection != 0.0;
}

bool material_is_rough(const sonject_material_params *material)
{
    return (material->lambert > 0.0 || material->glossy_albedo > 0.0) &&
           (!material_is_smooth(material) || material->roughness_m > 0.0);
}

/* Adds up the reports. A fault fails the run: a number that cannot be trusted must not be drawn. */
static sonject_status add_outcomes(struct tracer *tracer, const struct outcome_record *outcomes,
                                   size_t count)
{
    uint32_t faults = 0;
    for (size_t i = 0; i < count; i++) {
        tracer->counts.rays += outcomes[i].rays;
        tracer->counts.queries += outcomes[i].queries;
        tracer->counts.impulses += outcomes[i].impulses;
        faults |= outcomes[i].faults;
    }
    if (faults == 0)
        return SONJECT_OK;
    return report_failure(tracer->report, SONJECT_ERROR_DEVICE,
                          "device '%s' reported a fault while tracing:%s%s%s", tracer->device->name,
                          faults & FAULT_NOT_A_NUMBER ? " not a number;" : "",
                          faults & FAULT_OVERFLOW ? " energies out of scale;" : "",
                          faults & FAULT_OUTSIDE_TILE ? " shadow outside its bounds;" : "");
}

/* Returns the groups of a strip: one on a CPU, whose work-item does all; a GPU needs thousands. */
static int32_t segments_for(const struct tracer *tracer, const struct fan_record *fan)
{
    if (tracer->device->group_items == 1)
        return 1;
    const int32_t wanted = GROUPS_WANTED / (fan->strips > 0 ? fan->strips : 1);
    const int32_t limit = (int32_t)(fan->rays / tracer->device->group_items) + 1;
    return wanted < 1 ? 1 : wanted > limit ? limit : wanted;
}

/* Returns the golden section of the strips, or the next number that is coprime to them. */
static int32_t stride_of(int32_t strips)
{
    int32_t stride = (int32_t)(0.618 * strips) + 1;
    for (;; stride++) {
        int32_t a = strips, b = stride;
        while (b != 0) {
            const int32_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1)
            return stride;
    }
}

/* Runs some strips of a launch, in the order of their turns. */
static sonject_status run_turns(struct launch *launch, struct tracer *tracer, struct span turns)
{
    struct report *report = tracer->report;
    struct device *device = tracer->device;
    struct fan_record *fan = &launch->fan;
    const size_t groups = (size_t)turns.count * (size_t)fan->segments;
    const size_t items = groups * device->group_items;
    enum {
        LAST = LAUNCH_BUFFERS + 2
    };
    device_buffer buffers[LAST + 1] = {NULL};
    struct kernel_argument arguments[LAST + 1];
    struct outcome_record *outcomes = allocate_array(groups, sizeof *outcomes);
    CHECK_MEMORY(report, outcomes, "trace counts");
    fan->first_turn = turns.first;
    memcpy(buffers + 2, launch->buffers, sizeof launch->buffers);
    for (size_t i = 0; i <= LAST; i++)
        arguments[i] = (struct kernel_argument){sizeof buffers[i], &buffers[i]};
    sonject_status status = buffer_create(report, device, sizeof *fan, fan, &buffers[0]);
    THEN(status, buffer_create(report, device, launch->rays.count * sizeof *launch->rays.pieces,
                               launch->rays.pieces, &buffers[1]));
    THEN(status, buffer_create(report, device, groups * sizeof *outcomes, NULL, &buffers[LAST]));
    THEN(status, kernel_run(report, device, launch->kernel, arguments, LAST + 1, 1, &items));
    THEN(status,
         buffer_read(report, device, buffers[LAST], 0, groups * sizeof *outcomes, outcomes));
    THEN(status, add_outcomes(tracer, outcomes, groups));
    buffer_release(device, &buffers[0]);
    buffer_release(device, &buffers[1]);
    buffer_release(device, &buffers[LAST]);
    free(outcomes);
    return status;
}

sonject_status launch_run(struct launch *launch, struct tracer *tracer)
{
    struct checkpoint *checkpoint = tracer->checkpoint;
    struct fan_record *fan = &launch->fan;
    struct span turns = {0, fan->strips};
    fan->segments = 1;
    fan->first_turn = 0;
    fan->strip_stride = stride_of(fan->strips);
    if (checkpoint)
        checkpoint_launch(checkpoint, fan, &launch->rays);
    fan->segments = segments_for(tracer, fan);
    if (!checkpoint)
        return run_turns(launch, tracer, turns);
    while (checkpoint_next(checkpoint, &turns)) {
        CHECK(run_turns(launch, tracer, turns));
        checkpoint_advance(checkpoint, turns);
    }
    return SONJECT_OK;
}

sonject_status launch_begin(struct launch *launch, struct tracer *tracer,
                            enum device_program program, const char *kernel_name)
{
    bool is_plain =
        tracer->scene->mesh_count == 0 && !tracer->relief && tracer->view.water.water->slices == 1;
    for (uint32_t i = 0; i < tracer->scene->object_count; i++)
        is_plain = is_plain && !object_is_fouled(tracer, i);
    launch->device = tracer->device;
    if (tracer->checkpoint && tracer->checkpoint->files)
        return SONJECT_OK;
    return kernel_create(tracer->report, tracer->device, program,
                         is_plain ? PROGRAM_PLAIN : PROGRAM_FULL, kernel_name, &launch->kernel);
}

void launch_end(struct launch *launch)
{
    kernel_release(launch->device, &launch->kernel);
    for (size_t i = 0; i < LAUNCH_BUFFERS; i++)
        buffer_release(launch->device, &launch->buffers[i]);
    ray_table_clear(&launch->rays);
}

sonject_status launch_add(struct launch *launch, struct tracer *tracer, enum launch_buffer buffer,
                          size_t bytes, const void *contents)
{
    return buffer_create(tracer->report, tracer->device, bytes, contents, &launch->buffers[buffer]);
}

sonject_status launch_add_tallies(struct launch *launch, struct tracer *tracer, int32_t strips,
                                  size_t elements, int32_t *chunk)
{
    const size_t strip_bytes = elements * sizeof(int64_t);
    const size_t fitting = TALLY_BYTES / strip_bytes;
    *chunk = fitting < 1 ? 1 : fitting < (size_t)strips ? (int32_t)fitting : strips;
    return buffer_reserve(tracer->report, tracer->device, (size_t)*chunk * strip_bytes,
                          &launch->buffers[LAUNCH_TALLIES]);
}

sonject_status tallies_read(struct tracer *tracer, device_buffer tallies, size_t first,
                            size_t count, double unit, size_t plane_count, float *const *planes)
{
    const size_t total = count * plane_count;
    const void *mapped;
    const int64_t *sums;
    CHECK(buffer_map(tracer->report, tracer->device, tallies, (first + total) * sizeof *sums,
                     &mapped));
    const sonject_status status =
        checkpoint_sums(tracer->checkpoint, (const int64_t *)mapped + first, total, &sums);
    for (size_t p = 0; status == SONJECT_OK && p < plane_count; p++)
        for (size_t i = 0; i < count; i++)
            planes[p][i] = (float)((double)sums[i * plane_count + p] * unit);
    buffer_unmap(tracer->device, tallies, mapped);
    return status;
}
