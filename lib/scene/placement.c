#include "scene/placement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/pose.h"

#define PI                   3.14159265358979323846
#define SMALLEST_WAVELENGTHS 0.5    /* an object's size, at least */
#define THINNEST_M           1.0e-4 /* a plate without thickness lies on the seabed, not in it */

static const double outward[3] = {0.0, 1.0, 0.0};
static const double upward[3] = {0.0, 0.0, 1.0};
static const double downward[3] = {0.0, 0.0, -1.0};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
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
    return water_way_range(&view->water, placement->centre[1], placement->centre[2]);
}

double placement_grazing(const struct placement *placement, const struct patch_view *view)
{
    return water_way_grazing(&view->water, placement->centre[1], placement->centre[2]);
}

double placement_shadow_end(const struct placement *placement, const struct patch_view *view,
                            double ground_m)
{
    const double top = placement->centre[2] + placement_extent(placement, upward);
    const double end = placement->centre[1] + placement_extent(placement, outward);
    return top > ground_m ? end + (top - ground_m) / tan(water_way_grazing(&view->water, end, top))
                          : end;
}

/* How far some parts reach along a direction, from the origin that their centres are counted from;
 * 0 if there is none. */
static double parts_extent(const struct placement *parts, uint32_t count, const double direction[3])
{
    double extent = count > 0 ? -INFINITY : 0.0;
    for (uint32_t i = 0; i < count; i++)
        extent =
            fmax(extent, dot(parts[i].centre, direction) + placement_extent(&parts[i], direction));
    return extent;
}

/* From one side to the other along an axis of the view. */
static double overall_size(const struct placement *parts, uint32_t count, int axis)
{
    double forward[3] = {0.0, 0.0, 0.0};
    double back[3] = {0.0, 0.0, 0.0};
    forward[axis] = 1.0;
    back[axis] = -1.0;
    return parts_extent(parts, count, forward) + parts_extent(parts, count, back);
}

static void take_shape(struct placement *part, const struct scene *scene, uint32_t object,
                       const sonject_object_params *shape)
{
    memset(part, 0, sizeof *part);
    part->shape = shape->shape;
    part->object = object;
    part->material = &shape->material;
    shape_size_init_in_scene(&part->size, scene, shape);
    part->bounding_radius_m = part->size.bounding_radius_m;
}

/* Turns a part that lies in its object's own frame, and its centre, as the object's axes say. */
static void turn_part(struct placement *part, const struct scene_part *in_object, double axes[3][3])
{
    double own[3][3];
    memcpy(own, in_object->axes, sizeof own);
    compose_axes(part->axes, own, axes);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            part->centre[i] += in_object->centre[k] * axes[k][i];
}

void object_axes(double axes[3][3], const sonject_object_params *object, bool is_mirrored)
{
    /* the image's along-track axis is -x in a mirrored view: heading and roll change sense; what is
     * turned stays as it is, a left hand does not become a right one */
    turn_axes(axes, is_mirrored ? PI - object->heading_rad : object->heading_rad, object->pitch_rad,
              is_mirrored ? -object->roll_rad : object->roll_rad);
}

/* The parts of an object, their centres counted from its origin in axes of the view. Returns their
 * number. parts: room for them, or NULL to count. */
static uint32_t pose_parts(struct placement *parts, const struct scene *scene, uint32_t object,
                           bool is_mirrored)
{
    const sonject_object_params *whole = &scene->objects[object];
    double axes[3][3];
    uint32_t count = 0;
    object_axes(axes, whole, is_mirrored);
    if (whole->shape != SONJECT_SHAPE_PARTS) {
        if (parts) {
            take_shape(parts, scene, object, whole);
            memcpy(parts->axes, axes, sizeof axes);
        }
        return 1;
    }
    for (uint32_t i = 0; i < scene->part_count; i++) {
        if (scene->parts[i].object != object)
            continue;
        if (parts) {
            take_shape(&parts[count], scene, object, &scene->parts[i].shape);
            turn_part(&parts[count], &scene->parts[i], axes);
        }
        count++;
    }
    return count;
}

/* Depth of the lowest point below the seabed. */
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
    /* to which side the sonar looks does not matter */
    const uint32_t count = pose_parts(NULL, scene, object, false);
    struct placement *parts = allocate_array(count, sizeof *parts);
    if (!parts)
        return report_out_of_memory(report, "an object's parts");
    pose_parts(parts, scene, object, false);
    *top_m = overall_size(parts, count, 2) - burial_in_pose(parts, count, &scene->objects[object]);
    free(parts);
    return SONJECT_OK;
}

/* The ground point under an object's origin. */
static sonject_status find_ground_point(double origin[3], struct report *report,
                                        const struct patch_view *view, double first_row,
                                        double first_column, const sonject_object_params *object)
{
    double row, column;
    view_find_pixel(view, first_row, first_column, object->position_kind, object->position_along,
                    object->position_range, &row, &column);
    if (!(row >= -0.5 && row < (double)view->rows - 0.5 && column >= -0.5 &&
          column < (double)view->columns - 0.5))
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "object '%s' lies outside the patch: its centre is %.1f m along-track "
            "and at %.1f m slant range; move it or the patch",
            object->name, view_x_of_row(view, row) * (view->is_mirrored ? -1 : 1),
            view_processor_range(view, column));
    if (!(view_ground_range(view, view_processor_range(view, column)) > 0.0))
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "object '%s' lies in the water column, before the first return from "
                              "the bottom at %.2f m slant range: move it outwards",
                              object->name, view_bottom_range(view));
    origin[0] = view_x_of_row(view, row);
    origin[1] = view_ground_range(view, view_processor_range(view, column));
    origin[2] = 0.0;
    return SONJECT_OK;
}

/* How high an object's origin comes to lie over the seabed under it, its parts being posed. */
static sonject_status find_height(double *height_m, struct report *report,
                                  const sonject_object_params *object,
                                  const struct placement *parts, uint32_t count)
{
    const double height = overall_size(parts, count, 2);
    const double burial = burial_in_pose(parts, count, object);
    if (object->burial_kind == SONJECT_BURIAL_PROUD && burial < 0.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "object '%s' cannot stand %.3f m proud of the seabed: in its pose it "
                              "is %.3f m high; lower burial.proud",
                              object->name, object->proud_height_m, height);
    *height_m = parts_extent(parts, count, downward) - burial;
    if (height < THINNEST_M && burial == 0.0)
        *height_m += THINNEST_M;
    return SONJECT_OK;
}

/* What an object covers of the ground, its parts being posed about their origin. */
static struct footprint footprint_of(const struct placement *parts, uint32_t count,
                                     const double origin[3])
{
    const double *nose = parts[0].axes[0];
    const double level = hypot(nose[0], nose[1]);
    const double along[3] = {level > 0.1 ? nose[0] / level : 1.0,
                             level > 0.1 ? nose[1] / level : 0.0, 0.0};
    const double across[3] = {-along[1], along[0], 0.0};
    double reach[4]; /* along, back, across and to its other side */
    for (int i = 0; i < 4; i++) {
        const double *axis = i < 2 ? along : across;
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        const double direction[3] = {sign * axis[0], sign * axis[1], 0.0};
        reach[i] = parts_extent(parts, count, direction);
    }
    const double forward = 0.5 * (reach[0] - reach[1]);
    const double aside = 0.5 * (reach[2] - reach[3]);
    struct footprint footprint;
    footprint.x_m = origin[0] + forward * along[0] + aside * across[0];
    footprint.y_m = origin[1] + forward * along[1] + aside * across[1];
    footprint.along_x = along[0];
    footprint.along_y = along[1];
    footprint.half_width_m = 0.5 * (reach[2] + reach[3]);
    footprint.half_length_m = fmax(0.0, 0.5 * (reach[0] + reach[1]) - footprint.half_width_m);
    return footprint;
}

/* Smaller objects are less than rays, which are a fraction of a wavelength apart, and physical
 * optics can tell the echo of (kernels/MATH.md, "Small objects"). */
static sonject_status check_size(struct report *report, const struct patch_view *view,
                                 const char *name, double size_m)
{
    if (size_m >= SMALLEST_WAVELENGTHS * view->wavelength_m)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "object '%s' is %.3g mm large, which is less than half the wavelength of "
                          "%.3g mm: make it larger or raise sonar.frequency",
                          name, 1e3 * size_m, 1e3 * view->wavelength_m);
}

static sonject_status check_room(struct report *report, const struct patch_view *view,
                                 const sonject_object_params *object, const struct placement *parts,
                                 uint32_t count)
{
    const double patch_length = (double)view->rows * view->row_spacing_m;
    const double patch_width = (double)view->columns * view->column_spacing_m;
    if (overall_size(parts, count, 0) > patch_length || overall_size(parts, count, 1) > patch_width)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "object '%s' is larger than the patch of %.2f m x %.2f m: use a "
                              "larger patch",
                              object->name, patch_length, patch_width);
    for (uint32_t i = 0; i < count; i++)
        if (parts[i].centre[2] + placement_extent(&parts[i], upward) >= view->altitude_m ||
            placement_range(&parts[i], view) <= 2.0 * parts[i].bounding_radius_m)
            return report_failure(
                report, SONJECT_ERROR_INPUT,
                "object '%s' reaches up to the sonar: lower it or raise the altitude",
                object->name);
    return SONJECT_OK;
}

/* Poses an object and finds its place on the ground. */
static sonject_status pose(struct placements *placements, struct report *report,
                           const struct scene *scene, const struct patch_view *view,
                           double first_row, double first_column, uint32_t number)
{
    const sonject_object_params *object = &scene->objects[number];
    struct placed_object *placed = &placements->objects[number];
    struct placement *parts = &placements->parts[placements->part_count];
    placed->first_part = placements->part_count;
    placed->part_count = pose_parts(parts, scene, number, view->is_mirrored);
    placements->part_count += placed->part_count;
    if (placed->part_count == 0)
        return scene_locate(scene, report,
                            report_failure(report, SONJECT_ERROR_INPUT,
                                           "object '%s' has no parts: give it some or a shape",
                                           object->name),
                            "objects[%u]", (unsigned)number);
    const sonject_status status =
        find_ground_point(placed->origin, report, view, first_row, first_column, object);
    if (status != SONJECT_OK)
        placed->part_count = 0; /* it is not to be settled */
    return scene_locate(scene, report, status, "objects[%u].position", (unsigned)number);
}

/* Lets a posed object down on the seabed. */
static sonject_status settle(struct placements *placements, struct report *report,
                             const struct scene *scene, const struct patch_view *view,
                             uint32_t number)
{
    const sonject_object_params *object = &scene->objects[number];
    struct placed_object *placed = &placements->objects[number];
    struct placement *parts = &placements->parts[placed->first_part];
    double height = 0.0;
    CHECK(scene_locate(scene, report,
                       find_height(&height, report, object, parts, placed->part_count),
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
    sonject_status status = check_size(report, view, object->name, placed->size_m);
    THEN(status, check_room(report, view, object, parts, placed->part_count));
    return scene_locate(scene, report, status, "objects[%u]", (unsigned)number);
}

/* Random numbers are told apart by the number of a shape. */
static sonject_status check_shape_count(struct report *report, const struct scene *scene)
{
    uint32_t count = scene->part_count;
    for (uint32_t i = 0; i < scene->object_count; i++)
        count += scene->objects[i].shape != SONJECT_SHAPE_PARTS;
    if (count <= SCENE_SHAPES_MAX)
        return SONJECT_OK;
    return report_failure(report, SONJECT_ERROR_INPUT,
                          "objects: %u shapes, counting those of parts, are too many: a scene may "
                          "have %d; split it",
                          (unsigned)count, SCENE_SHAPES_MAX);
}

/* Scour lies around objects, so the relief needs their places. */
static sonject_status lay_relief(struct placements *placements, struct report *report,
                                 const struct scene *scene, const struct patch_view *view,
                                 double first_row, double first_column)
{
    struct footprint *footprints = allocate_array(scene->object_count, sizeof *footprints);
    if (!footprints)
        return report_out_of_memory(report, "objects");
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct placed_object *placed = &placements->objects[i];
        footprints[i] = footprint_of(&placements->parts[placed->first_part], placed->part_count,
                                     placed->origin);
    }
    const sonject_status status = relief_create(&placements->relief, report, scene, view, first_row,
                                                first_column, footprints);
    free(footprints);
    return status;
}

sonject_status placements_init(struct placements *placements, struct report *report,
                               const struct scene *scene, const struct patch_view *view,
                               double first_row, double first_column)
{
    char lines[REPORT_CAPACITY] = "";
    memset(placements, 0, sizeof *placements);
    placements->object_count = scene->object_count;
    placements->parts =
        allocate_array((size_t)scene->object_count + scene->part_count, sizeof *placements->parts);
    placements->objects = allocate_array(scene->object_count, sizeof *placements->objects);
    sonject_status status = placements->parts && placements->objects
                                ? SONJECT_OK
                                : report_out_of_memory(report, "objects");
    THEN(status, check_shape_count(report, scene));
    const bool can_be_posed = status == SONJECT_OK;
    for (uint32_t i = 0; can_be_posed && i < scene->object_count; i++)
        status = report_gather(report, lines, status,
                               pose(placements, report, scene, view, first_row, first_column, i));
    if (status == SONJECT_OK && scene_has_relief(scene))
        status = report_gather(
            report, lines, status,
            scene_locate(scene, report,
                         lay_relief(placements, report, scene, view, first_row, first_column),
                         "seabed.relief"));
    for (uint32_t i = 0; can_be_posed && status != SONJECT_ERROR_MEMORY && i < scene->object_count;
         i++)
        if (placements->objects[i].part_count > 0)
            status =
                report_gather(report, lines, status, settle(placements, report, scene, view, i));
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
