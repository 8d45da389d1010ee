#include "scene/placement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define PI                   3.14159265358979323846
#define SMALLEST_WAVELENGTHS 0.5    /* the least size of an object */
#define THINNEST_M           1.0e-4 /* a plate without thickness lies on the seabed, not in it */

static const double outward[3] = {0.0, 1.0, 0.0};
static const double upward[3] = {0.0, 0.0, 1.0};
static const double downward[3] = {0.0, 0.0, -1.0};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void turn_axes(double axes[3][3], double heading, double pitch, double roll)
{
    const double cp = cos(pitch);
    const double sp = sin(pitch);
    const double nose[3] = {cos(heading) * cp, sin(heading) * cp, sp};
    const double side[3] = {-sin(heading), cos(heading), 0.0};
    const double up[3] = {-cos(heading) * sp, -sin(heading) * sp, cp};
    for (int i = 0; i < 3; i++) {
        axes[0][i] = nose[i];
        axes[1][i] = side[i] * cos(roll) + up[i] * sin(roll);
        axes[2][i] = up[i] * cos(roll) - side[i] * sin(roll);
    }
}

void compose_axes(double product[3][3], double inner[3][3], double outer[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            product[i][k] = 0.0;
            for (int m = 0; m < 3; m++)
                product[i][k] += inner[i][m] * outer[m][k];
        }
}

double placement_extent(const struct placement *placement, const double direction[3])
{
    double own[3];
    for (int axis = 0; axis < 3; axis++)
        own[axis] = dot(placement->axes[axis], direction);
    return shape_extent(&placement->size, placement->shape, own);
}

double placement_half_extent(const struct placement *placement, const double direction[3])
{
    const double back[3] = {-direction[0], -direction[1], -direction[2]};
    return fmax(placement_extent(placement, direction), placement_extent(placement, back));
}

double placement_range(const struct placement *placement, const struct patch_view *view)
{
    return ray_path_range(&view->water, placement->centre[1], placement->centre[2]);
}

double placement_grazing(const struct placement *placement, const struct patch_view *view)
{
    return ray_path_grazing(&view->water, placement->centre[1], placement->centre[2]);
}

double placement_shadow_end(const struct placement *placement, const struct patch_view *view,
                            double ground_m)
{
    const double top = placement->centre[2] + placement_extent(placement, upward);
    const double end = placement->centre[1] + placement_extent(placement, outward);
    return end + ray_path_shadow(&view->water, end, top, ground_m);
}

/* Returns how far parts reach along a direction from the origin that their centres count from; 0 if
 * there are none. */
static double parts_extent(const struct placement *parts, uint32_t count, const double direction[3])
{
    double extent = count > 0 ? -INFINITY : 0.0;
    for (uint32_t i = 0; i < count; i++)
        extent =
            fmax(extent, dot(parts[i].centre, direction) + placement_extent(&parts[i], direction));
    return extent;
}

/* Returns the size from one side to the other along an axis of the view. */
static double overall_size(const struct placement *parts, uint32_t count, int axis)
{
    double forward[3] = {0.0, 0.0, 0.0};
    double back[3] = {0.0, 0.0, 0.0};
    forward[axis] = 1.0;
    back[axis] = -1.0;
    return parts_extent(parts, count, forward) + parts_extent(parts, count, back);
}

void object_axes(double axes[3][3], const sonject_object_params *object, bool is_mirrored)
{
    /* The image's along-track axis is -x in a mirrored view, so heading and roll change sense. Only
     * the pose changes: a left hand does not become a right one. */
    turn_axes(axes, is_mirrored ? PI - object->heading_rad : object->heading_rad, object->pitch_rad,
              is_mirrored ? -object->roll_rad : object->roll_rad);
}

/* Returns a part as it lies in its object. in_object is NULL for an object that is its own only
 * part. axes: the object's. */
static struct placement pose_part(const struct scene *scene, uint32_t object,
                                  const struct scene_part *in_object, double axes[3][3])
{
    const sonject_object_params *shape = in_object ? &in_object->shape : &scene->objects[object];
    const sonject_fouling_params *fouling = &scene->objects[object].fouling;
    struct placement part = {.shape = shape->shape, .object = object, .material = shape->material};
    if (fouling->relief_m > 0.0) {
        part.material.roughness_m = hypot(part.material.roughness_m, fouling->relief_m);
        part.material.glossy_slope =
            hypot(part.material.glossy_slope, fouling->relief_m / fouling->relief_length_m);
    }
    shape_size_init_in_scene(&part.size, scene, shape);
    part.bounding_radius_m = part.size.bounding_radius_m;
    if (!in_object) {
        memcpy(part.axes, axes, sizeof part.axes);
        return part;
    }
    double own[3][3];
    memcpy(own, in_object->axes, sizeof own);
    compose_axes(part.axes, own, axes);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            part.centre[i] += in_object->centre[k] * axes[k][i];
    return part;
}

/* Finds the parts of an object, whose centres count from its origin in axes of the view, and
 * returns their number. parts: room for them, or NULL to count. */
static uint32_t pose_parts(struct placement *parts, const struct scene *scene, uint32_t object,
                           bool is_mirrored)
{
    double axes[3][3];
    uint32_t count = 0;
    object_axes(axes, &scene->objects[object], is_mirrored);
    if (scene->objects[object].shape != SHAPE_PARTS) {
        if (parts)
            parts[0] = pose_part(scene, object, NULL, axes);
        return 1;
    }
    for (uint32_t i = 0; i < scene->part_count; i++) {
        if (scene->parts[i].object != object)
            continue;
        if (parts)
            parts[count] = pose_part(scene, object, &scene->parts[i], axes);
        count++;
    }
    return count;
}

/* Returns the depth of the lowest point below the seabed. */
static double burial_in_pose(const struct placement *parts, uint32_t count,
                             const sonject_object_params *object)
{
    switch (object->burial_kind) {
    case SONJECT_BURIAL_FRACTION:
        return object->burial_fraction * overall_size(parts, count, 2);
    case SONJECT_BURIAL_PROUD:
        return overall_size(parts, count, 2) - object->proud_height_m;
    default:
        return object->burial_m;
    }
}

sonject_status object_top(const struct scene *scene, struct report *report, uint32_t object,
                          double *top_m)
{
    /* the side to which the sonar looks does not matter */
    const uint32_t count = pose_parts(NULL, scene, object, false);
    struct placement *parts = allocate_array(count, sizeof *parts);
    CHECK_MEMORY(report, parts, "an object's parts");
    pose_parts(parts, scene, object, false);
    *top_m = overall_size(parts, count, 2) - burial_in_pose(parts, count, &scene->objects[object]);
    free(parts);
    return SONJECT_OK;
}

/* Placements while they are made. */
struct placing {
    struct placements *placements;
    struct report *report;
    const struct scene *scene;
    const struct patch_view *view;
    double first_row, first_column; /* patch's first pixel in the swath */
};

/* Finds the ground point under an object's origin. */
static sonject_status find_ground_point(double origin[3], const struct placing *placing,
                                        const sonject_object_params *object)
{
    const struct patch_view *view = placing->view;
    double row, column;
    view_find_pixel(view, placing->first_row, placing->first_column, object->position_kind,
                    object->position_along, object->position_range, &row, &column);
    const double range = view_processor_range(view, column);
    if (!(row >= -0.5 && row < (double)view->rows - 0.5 && column >= -0.5 &&
          column < (double)view->columns - 0.5))
        return report_failure(
            placing->report, SONJECT_ERROR_INPUT,
            "object '%s' lies outside the patch: its centre is %.1f m along-track "
            "and at %.1f m slant range; move it or the patch",
            object->name, view_x_of_row(view, row) * (view->is_mirrored ? -1 : 1), range);
    if (!(view_ground_range(view, range) > 0.0))
        return report_failure(placing->report, SONJECT_ERROR_INPUT,
                              "object '%s' lies in the water column, before the first return from "
                              "the bottom at %.2f m slant range: move it outwards",
                              object->name, view_bottom_range(view));
    origin[0] = view_x_of_row(view, row);
    origin[1] = view_ground_range(view, range);
    origin[2] = 0.0;
    return SONJECT_OK;
}

/* Finds the height of a posed object's origin over the seabed under it. */
static sonject_status find_height(double *height_m, struct report *report,
                                  const sonject_object_params *object,
                                  const struct placement *parts, uint32_t count)
{
    const double burial = burial_in_pose(parts, count, object);
    if (object->burial_kind == SONJECT_BURIAL_PROUD && burial < 0.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "object '%s' cannot stand %.3f m proud of the seabed: in its pose it "
                              "is %.3f m high; lower burial.proud",
                              object->name, object->proud_height_m, overall_size(parts, count, 2));
    *height_m = parts_extent(parts, count, downward) - burial;
    if (overall_size(parts, count, 2) < THINNEST_M && burial == 0.0)
        *height_m += THINNEST_M;
    return SONJECT_OK;
}

/* Returns the ground that an object covers. Its parts are posed about their origin. */
static struct footprint footprint_of(const struct placement *parts, uint32_t count,
                                     const double origin[3])
{
    const double *nose = parts[0].axes[0];
    const double level = hypot(nose[0], nose[1]);
    const double along[3] = {level > 0.1 ? nose[0] / level : 1.0,
                             level > 0.1 ? nose[1] / level : 0.0, 0.0};
    const double across[3] = {-along[1], along[0], 0.0};
    double reach[4]; /* along, back, across and to the other side */
    for (int i = 0; i < 4; i++) {
        const double *axis = i < 2 ? along : across;
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        const double direction[3] = {sign * axis[0], sign * axis[1], 0.0};
        reach[i] = parts_extent(parts, count, direction);
    }
    const double forward = 0.5 * (reach[0] - reach[1]);
    const double aside = 0.5 * (reach[2] - reach[3]);
    const double half_width = 0.5 * (reach[2] + reach[3]);
    return (struct footprint){.x_m = origin[0] + forward * along[0] + aside * across[0],
                              .y_m = origin[1] + forward * along[1] + aside * across[1],
                              .along_x = along[0],
                              .along_y = along[1],
                              .half_width_m = half_width,
                              .half_length_m = fmax(0.0, 0.5 * (reach[0] + reach[1]) - half_width)};
}

/* Checks that an object is large enough for its echo and fits into patch and water. */
static sonject_status check_object_size(const struct placing *placing, const char *name,
                                        const struct placed_object *placed,
                                        const struct placement *parts)
{
    const struct patch_view *view = placing->view;
    const double patch_length = (double)view->rows * view->row_spacing_m;
    const double patch_width = (double)view->columns * view->column_spacing_m;
    /* Rays are a fraction of a wavelength apart, and physical optics fails for smaller objects
     * (kernels/MATH.md, "Small objects"). */
    if (placed->size_m < SMALLEST_WAVELENGTHS * view->wavelength_m)
        return report_failure(placing->report, SONJECT_ERROR_INPUT,
                              "object '%s' is %.3g mm large, which is less than half the "
                              "wavelength of %.3g mm: check its sizes (of a mesh, mesh.unit), or "
                              "raise sonar.frequency",
                              name, 1e3 * placed->size_m, 1e3 * view->wavelength_m);
    const double along = overall_size(parts, placed->part_count, 0);
    const double across = overall_size(parts, placed->part_count, 1);
    if (along > patch_length || across > patch_width)
        return report_failure(placing->report, SONJECT_ERROR_INPUT,
                              "object '%s', %.4g m x %.4g m, is larger than the patch of %.2f m x "
                              "%.2f m: check its sizes (of a mesh, mesh.unit), or use a larger "
                              "patch",
                              name, along, across, patch_length, patch_width);
    for (uint32_t i = 0; i < placed->part_count; i++)
        if (parts[i].centre[2] + placement_extent(&parts[i], upward) >= view->altitude_m ||
            placement_range(&parts[i], view) <= 2.0 * parts[i].bounding_radius_m)
            return report_failure(
                placing->report, SONJECT_ERROR_INPUT,
                "object '%s' reaches up to the sonar: lower it or raise the altitude", name);
    return SONJECT_OK;
}

/* Poses an object and finds its place on the ground. */
static sonject_status pose(const struct placing *placing, uint32_t number)
{
    struct placements *placements = placing->placements;
    const sonject_object_params *object = &placing->scene->objects[number];
    struct placed_object *placed = &placements->objects[number];
    placed->first_part = placements->part_count;
    placed->part_count = pose_parts(&placements->parts[placements->part_count], placing->scene,
                                    number, placing->view->is_mirrored);
    placements->part_count += placed->part_count;
    if (placed->part_count == 0)
        return scene_locate(placing->scene, placing->report,
                            report_failure(placing->report, SONJECT_ERROR_INPUT,
                                           "object '%s' has no parts: give it some or a shape",
                                           object->name),
                            "objects[%u]", (unsigned)number);
    const sonject_status status = find_ground_point(placed->origin, placing, object);
    if (status != SONJECT_OK)
        placed->part_count = 0; /* keeps place() from settling it */
    return scene_locate(placing->scene, placing->report, status, "objects[%u].position",
                        (unsigned)number);
}

/* Puts a posed object on the seabed. */
static sonject_status settle(const struct placing *placing, uint32_t number)
{
    struct placements *placements = placing->placements;
    const sonject_object_params *object = &placing->scene->objects[number];
    struct placed_object *placed = &placements->objects[number];
    struct placement *parts = &placements->parts[placed->first_part];
    double height = 0.0;
    CHECK(scene_locate(placing->scene, placing->report,
                       find_height(&height, placing->report, object, parts, placed->part_count),
                       "objects[%u].burial", (unsigned)number));
    placed->seabed_m = relief_height(placements->relief, placed->origin[0], placed->origin[1]);
    placed->origin[2] = placed->seabed_m + height;
    for (uint32_t i = 0; i < placed->part_count; i++)
        for (int k = 0; k < 3; k++)
            parts[i].centre[k] += placed->origin[k];
    placed->bottom_m = -parts_extent(parts, placed->part_count, downward);
    placed->top_m = parts_extent(parts, placed->part_count, upward);
    for (int axis = 0; axis < 3; axis++)
        placed->size_m = fmax(placed->size_m, overall_size(parts, placed->part_count, axis));
    return scene_locate(placing->scene, placing->report,
                        check_object_size(placing, object->name, placed, parts), "objects[%u]",
                        (unsigned)number);
}

/* Checks the number of shapes, because random numbers are told apart by the number of a shape. */
static sonject_status check_shape_count(struct report *report, const struct scene *scene)
{
    uint32_t count = scene->part_count;
    for (uint32_t i = 0; i < scene->object_count; i++)
        count += scene->objects[i].shape != SHAPE_PARTS;
    if (count <= SCENE_SHAPES_MAX)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "objects: %u shapes, counting those of parts, are too many: a scene may "
                          "have %d; split it",
                          (unsigned)count, SCENE_SHAPES_MAX);
}

/* Lays the relief after the objects have places, because scour surrounds objects. */
static sonject_status lay_relief(const struct placing *placing)
{
    struct placements *placements = placing->placements;
    struct footprint *footprints = allocate_array(placements->object_count, sizeof *footprints);
    CHECK_MEMORY(placing->report, footprints, "objects");
    for (uint32_t i = 0; i < placements->object_count; i++) {
        const struct placed_object *placed = &placements->objects[i];
        footprints[i] = footprint_of(&placements->parts[placed->first_part], placed->part_count,
                                     placed->origin);
    }
    const sonject_status status =
        relief_create(&placements->relief, placing->report, placing->scene, placing->view,
                      placing->first_row, placing->first_column, footprints);
    free(footprints);
    return scene_locate(placing->scene, placing->report, status, "seabed.relief");
}

/* Places all objects and reports all wrong ones. */
static sonject_status place(const struct placing *placing)
{
    char lines[REPORT_CAPACITY] = "";
    struct placements *placements = placing->placements;
    struct report *report = placing->report;
    sonject_status status = SONJECT_OK;
    CHECK_MEMORY(report, placements->parts && placements->objects, "objects");
    CHECK(check_shape_count(report, placing->scene));
    for (uint32_t i = 0; i < placements->object_count; i++)
        status = report_gather(report, lines, status, pose(placing, i));
    if (status == SONJECT_OK && scene_has_relief(placing->scene))
        status = report_gather(report, lines, status, lay_relief(placing));
    for (uint32_t i = 0; status != SONJECT_ERROR_MEMORY && i < placements->object_count; i++)
        if (placements->objects[i].part_count > 0)
            status = report_gather(report, lines, status, settle(placing, i));
    return status;
}

sonject_status placements_init(struct placements *placements, struct report *report,
                               const struct scene *scene, const struct patch_view *view,
                               double first_row, double first_column)
{
    const struct placing placing = {placements, report, scene, view, first_row, first_column};
    memset(placements, 0, sizeof *placements);
    placements->object_count = scene->object_count;
    placements->parts =
        allocate_array((size_t)scene->object_count + scene->part_count, sizeof *placements->parts);
    placements->objects = allocate_array(scene->object_count, sizeof *placements->objects);
    const sonject_status status = place(&placing);
    if (status != SONJECT_OK)
        placements_clear(placements);
    return status;
}

void placements_clear(struct placements *placements)
{
    free(placements->parts);
    free(placements->objects);
    relief_release(&placements->relief);
    memset(placements, 0, sizeof *placements);
}

void sonar_array_axes(double axes[3][3], const sonject_sonar_params *sonar, bool is_mirrored)
{
    turn_axes(axes, sonar->array_heading_rad, sonar->array_pitch_rad, -sonar->array_depression_rad);
    if (!is_mirrored)
        return;
    /* the view's track runs the other way, and so does the long side that points ahead */
    for (int i = 0; i < 3; i++)
        axes[i][0] = -axes[i][0];
    for (int k = 0; k < 3; k++)
        axes[0][k] = -axes[0][k];
}

bool sonar_array_is_turned(const sonject_sonar_params *sonar)
{
    return sonar->array_heading_rad != 0.0 || sonar->array_pitch_rad != 0.0;
}
