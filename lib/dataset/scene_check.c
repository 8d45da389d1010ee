#include "dataset/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"
#include "image/statistics.h"
#include "inject/injection.h"
#include "inject/swath.h"
#include "scene/placement.h"
#include "swath/geometry_notes.h"

#define MAP_ROWS    20
#define MAP_COLUMNS 64

static double grazing_degrees(const struct patch_view *view, double processor_range)
{
    return view_grazing(view, processor_range) * DEGREES_PER_RADIAN;
}

static void describe_water(struct growing_text *text, const struct ray_path *path)
{
    const struct water *water = path->water;
    growing_text_add(text, "water      %.1f m/s around seabed%s", water->straight_speed_mps,
                     water->slices == 1 ? " and objects" : "");
    if (water->count == 1)
        growing_text_add(text, "\n");
    else
        growing_text_add(text, " up to %.2f m, %.1f m/s at the sonar, %zu layers%s\n",
                         water->layers[1].bottom_m,
                         water_layer_at(water, path->sonar_height_m)->speed_mps, water->count,
                         path->is_straight ? ", none of which the sound crosses" : "");
}

static void add_note(void *user, uint32_t level, const char *line)
{
    (void)level;
    growing_text_add(user, "           note: %s\n", line);
}

/* Describes altitudes that differ from ping to ping: the altitude at the objects may be far off. */
static sonject_status describe_altitudes(struct growing_text *text, struct report *report,
                                         const struct scene *scene, const struct region *patch)
{
    struct swath_file *file;
    double spread[3];
    if (scene->altitude_by == ALTITUDE_GIVEN)
        return SONJECT_OK;
    double *altitudes = allocate_array((size_t)patch->rows, sizeof *altitudes);
    CHECK_MEMORY(report, altitudes, "the altitudes");
    const sonject_status status =
        swath_file_open_array(report, scene->input_path, scene->channel, scene->array, &file);
    if (status == SONJECT_OK) {
        row_altitudes(scene, swath_file_recording(file), patch, altitudes);
        spread_of(altitudes, (size_t)patch->rows, spread);
        growing_text_add(text,
                         "           altitudes of the pings: %.3g m in the median, %.3g...%.3g m "
                         "(5...95 %%)\n",
                         spread[1], spread[0], spread[2]);
        swath_file_close(&file);
    }
    free(altitudes);
    return status;
}

static sonject_status describe_patch(struct growing_text *text, struct report *report,
                                     const struct scene *scene, const struct swath *swath,
                                     const struct patch_view *view)
{
    const double last = view_processor_range(view, (double)view->columns - 1.0);
    growing_text_add(text, "image      %llu x %llu pixels, %u channel%s\n",
                     (unsigned long long)swath->layout.rows,
                     (unsigned long long)swath->layout.columns, (unsigned)swath->layout.channels,
                     swath->layout.channels == 1 ? "" : "s");
    char pings[PING_LIST_CAPACITY];
    if (swath->skipped.count > 0)
        growing_text_add(text, "           pings without samples give no row: %s\n",
                         ping_list_text(&swath->skipped, pings));
    growing_text_add(
        text, "patch      %llu x %llu pixels from row %llu, column %llu\n",
        (unsigned long long)swath->patch.rows, (unsigned long long)swath->patch.columns,
        (unsigned long long)swath->patch.first_row, (unsigned long long)swath->patch.first_column);
    growing_text_add(text, "           %.2f m along-track, slant range %.2f...%.2f m, %s\n",
                     (double)view->rows * view->row_spacing_m, view->first_range_m, last,
                     view->is_mirrored ? "starboard" : "port");
    growing_text_add(text, "           grazing angle %.1f...%.1f deg\n",
                     grazing_degrees(view, view->first_range_m), grazing_degrees(view, last));
    growing_text_add(
        text, "sonar      %.4g kHz, bandwidth %.4g kHz, altitude %.3g m%s%s, wavelength %.4g mm\n",
        scene->sonar.centre_frequency_hz / 1e3, scene->sonar.bandwidth_hz / 1e3,
        scene->sonar.altitude_m,
        scene->altitude_by == ALTITUDE_OF_RETURNS ? " by first returns" : "",
        scene->altitude_by == ALTITUDE_GIVEN || scene->patch.rows > 0 || scene->object_count == 0
            ? ""
            : " at the objects' pings",
        view->wavelength_m * 1e3);
    CHECK(describe_altitudes(text, report, scene, &swath->patch));
    const struct report_host host = {.log_user = text};
    struct report noting = {.log = add_note, .host = &host};
    tell_scene(&noting, scene, swath);
    describe_water(text, &view->water);
    growing_text_add(
        text, "injection  %s, paths that meet up to %u surface%s\n",
        scene->injection.mode == SONJECT_MODE_RESYNTHESISE ? "resynthesise" : "composite",
        (unsigned)scene->injection.interactions, scene->injection.interactions == 1 ? "" : "s");
    return SONJECT_OK;
}

static void describe_objects(struct growing_text *text, const struct scene *scene,
                             const struct patch_view *view, const struct placements *placements)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct placed_object *object = &placements->objects[i];
        const double *origin = object->origin;
        const double range = ray_path_range(&view->water, origin[1], origin[2]) * view->range_ratio;
        const double grazing = ray_path_direction(&view->water, origin[1], origin[2]);
        const double row = view_row_of_x(view, origin[0]);
        growing_text_add(
            text,
            "object %-3u %s (%s): row %.1f, slant range %.2f m, grazing angle %.1f deg, top "
            "%.3f m, shadow %.2f m on the ground\n",
            (unsigned)(i + 1), scene->objects[i].name, shape_name(scene->objects[i].shape),
            (double)scene->patch.first_row +
                (view->is_mirrored ? (double)view->rows - 1.0 - row : row),
            range, grazing * DEGREES_PER_RADIAN, object->top_m,
            ray_path_shadow(&view->water, origin[1], object->top_m, 0.0));
    }
}

static void describe_meshes(struct growing_text *text, const struct scene *scene,
                            const struct placements *placements)
{
    for (uint32_t i = 0; i < scene->mesh_count; i++) {
        const struct mesh *mesh = &scene->meshes[i];
        const struct mesh_topology *topology = &mesh->topology;
        char excerpt[200];
        unsigned shown = 0;
        for (uint32_t k = 0; k < placements->part_count; k++)
            shown += placements->parts[k].size.mesh == mesh;
        growing_text_add(
            text, "mesh %-5u %s: %zu triangles, %.4g x %.4g x %.4g m, shown %u time%s\n",
            (unsigned)(i + 1), text_excerpt(excerpt, sizeof excerpt, mesh->name),
            mesh->triangle_count, (double)mesh->upper_m[0] - (double)mesh->lower_m[0],
            (double)mesh->upper_m[1] - (double)mesh->lower_m[1],
            (double)mesh->upper_m[2] - (double)mesh->lower_m[2], shown, shown == 1 ? "" : "s");
        if (topology->is_closed)
            growing_text_add(text, "           watertight, %.4g m3", mesh->topology.volume);
        else
            growing_text_add(
                text,
                "           not watertight, thin sheets: %zu edges of one triangle, %zu of more "
                "than two, %zu twisted",
                topology->open_edges, topology->crowded_edges, topology->twisted_edges);
        growing_text_add(text, ", %zu piece%s", topology->pieces, topology->pieces == 1 ? "" : "s");
        if (topology->turned > 0)
            growing_text_add(text, "; %zu triangles turned to show the outside", topology->turned);
        if (mesh->welded > 0)
            growing_text_add(text, "; %zu vertices of seams welded", mesh->welded);
        if (mesh->degenerate > 0)
            growing_text_add(text, "; %zu triangles without area left out", mesh->degenerate);
        growing_text_add(text, "\n");
    }
}

/* Marks the cells of the plan that a box on the ground covers. */
static void mark(char plan[MAP_ROWS][MAP_COLUMNS + 1], const struct patch_view *view,
                 const double low[2], const double high[2], char sign)
{
    for (int row = 0; row < MAP_ROWS; row++)
        for (int column = 0; column < MAP_COLUMNS; column++) {
            const double x = view_x_of_row(view, (row + 0.5) / MAP_ROWS * (double)view->rows);
            const double range =
                view_processor_range(view, (column + 0.5) / MAP_COLUMNS * (double)view->columns);
            const double y = view_ground_range(view, range);
            const double half_x = 0.5 * (double)view->rows / MAP_ROWS * view->row_spacing_m;
            const double half_y =
                0.5 * (double)view->columns / MAP_COLUMNS * view->column_spacing_m;
            if (x + half_x > low[0] && x - half_x < high[0] && y + half_y > low[1] &&
                y - half_y < high[1] && plan[row][column] != '#')
                plan[row][column] = sign;
        }
}

static void draw_plan(struct growing_text *text, const struct patch_view *view,
                      const struct placements *placements)
{
    static const double along[3] = {1.0, 0.0, 0.0};
    static const double outward[3] = {0.0, 1.0, 0.0};
    static const double upward[3] = {0.0, 0.0, 1.0};
    char plan[MAP_ROWS][MAP_COLUMNS + 1];
    for (int row = 0; row < MAP_ROWS; row++) {
        memset(plan[row], '.', MAP_COLUMNS);
        plan[row][MAP_COLUMNS] = '\0';
    }
    for (uint32_t i = 0; i < placements->part_count; i++) {
        const struct placement *part = &placements->parts[i];
        const double x = placement_half_extent(part, along);
        const double y = placement_half_extent(part, outward);
        const double top = part->centre[2] + placement_extent(part, upward);
        const double low[2] = {part->centre[0] - x, part->centre[1] - y};
        const double high[2] = {part->centre[0] + x, part->centre[1] + y};
        const double end[2] = {high[0],
                               high[1] + ray_path_shadow(&view->water, part->centre[1], top, 0.0)};
        mark(plan, view, low, high, '#');
        mark(plan, view, low, end, ':');
    }
    growing_text_add(
        text, "\nplan, track at the left, range to the right (# object's bounds, : shadow)\n");
    for (int row = 0; row < MAP_ROWS; row++)
        growing_text_add(text, "  |%s|\n", plan[view->is_mirrored ? MAP_ROWS - 1 - row : row]);
}

sonject_status describe_scene(struct report *report, const struct scene *scene, char **out)
{
    struct swath swath;
    struct injection_setup setup;
    CHECK(swath_describe(report, scene, &swath));
    const struct injection_input input = swath_input(&swath);
    sonject_status status = injection_setup_init_scene(&setup, report, NULL, scene, &input);
    if (status == SONJECT_OK) {
        const struct patch_view *view = &setup.tracer.view;
        const struct placements *placements = &setup.placements;
        struct growing_text text = {0};
        status = describe_patch(&text, report, scene, &swath, view);
        const struct relief *relief = placements->relief;
        if (relief)
            growing_text_add(
                &text,
                "relief     %.3f...%.3f m over the mean seabed, points %.3g m x %.3g m "
                "apart\n",
                relief->lowest_m, relief->highest_m, relief->row_step_m, relief->column_step_m);
        describe_objects(&text, scene, view, placements);
        describe_meshes(&text, scene, placements);
        draw_plan(&text, view, placements);
        char *characters = growing_text_end(&text);
        if (!characters)
            THEN(status, report_out_of_memory(report, "the description"));
        if (status == SONJECT_OK) {
            text_use_points(characters);
            *out = characters;
        } else {
            free(characters);
        }
    }
    injection_setup_clear(&setup);
    swath_close(&swath);
    return status;
}
