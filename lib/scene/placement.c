#include "scene/placement.h"

#include <math.h>
#include <string.h>

#define PI         3.14159265358979323846
#define THINNEST_M 1.0e-4 /* a plate without thickness lies on the seabed, not in it */

static const double outward[3] = {0.0, 1.0, 0.0};
static const double upward[3] = {0.0, 0.0, 1.0};
static const double downward[3] = {0.0, 0.0, -1.0};

/* Heading turns +x towards +y, pitch raises the nose, roll turns about it. In a mirrored view the
 * image's along-track axis is -x, so heading and roll change sense. */
static void turn_axes(double axes[3][3], const sonject_object_params *object, bool is_mirrored)
{
    const double heading = is_mirrored ? PI - object->heading_rad : object->heading_rad;
    const double roll = is_mirrored ? -object->roll_rad : object->roll_rad;
    const double cp = cos(object->pitch_rad);
    const double sp = sin(object->pitch_rad);
    const double nose[3] = {cos(heading) * cp, sin(heading) * cp, sp};
    const double side[3] = {-sin(heading), cos(heading), 0.0};
    const double up[3] = {-cos(heading) * sp, -sin(heading) * sp, cp};
    for (int i = 0; i < 3; i++) {
        axes[0][i] = nose[i];
        axes[1][i] = side[i] * cos(roll) + up[i] * sin(roll);
        axes[2][i] = up[i] * cos(roll) - side[i] * sin(roll);
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double placement_extent(const struct placement *placement, uint32_t shape,
                        const double direction[3])
{
    double own[3];
    for (int axis = 0; axis < 3; axis++)
        own[axis] = dot(placement->axes[axis], direction);
    return shape_extent(&placement->size, shape, own);
}

double placement_half_extent(const struct placement *placement, uint32_t shape,
                             const double direction[3])
{
    const double back[3] = {-direction[0], -direction[1], -direction[2]};
    const double forward = placement_extent(placement, shape, direction);
    return fmax(forward, placement_extent(placement, shape, back));
}

/* From one side to the other along an axis of the view. */
static double overall_size(const struct placement *placement, uint32_t shape, int axis)
{
    double forward[3] = {0.0, 0.0, 0.0};
    double back[3] = {0.0, 0.0, 0.0};
    forward[axis] = 1.0;
    back[axis] = -1.0;
    return placement_extent(placement, shape, forward) + placement_extent(placement, shape, back);
}

static void pose(struct placement *placement, const sonject_object_params *object, bool is_mirrored)
{
    shape_size_init(&placement->size, object, is_mirrored);
    placement->bounding_radius_m = placement->size.bounding_radius_m;
    turn_axes(placement->axes, object, is_mirrored);
}

static double burial_in_pose(const struct placement *placement, const sonject_object_params *object)
{
    switch (object->burial_kind) {
    case SONJECT_BURIAL_FRACTION:
        return object->burial_fraction * overall_size(placement, object->shape, 2);
    case SONJECT_BURIAL_PROUD:
        return overall_size(placement, object->shape, 2) - object->proud_height_m;
    default:
        return object->burial_m;
    }
}

double burial_of_object(const sonject_object_params *object)
{
    struct placement placement;
    pose(&placement, object, false);
    return burial_in_pose(&placement, object);
}

double placement_range(const struct placement *placement, const struct patch_view *view)
{
    return water_way_range(&view->water, placement->centre[1], placement->centre[2]);
}

double placement_grazing(const struct placement *placement, const struct patch_view *view)
{
    return water_way_grazing(&view->water, placement->centre[1], placement->centre[2]);
}

double placement_shadow_end(const struct placement *placement, uint32_t shape,
                            const struct patch_view *view)
{
    const double top = placement->centre[2] + placement_extent(placement, shape, upward);
    const double end = placement->centre[1] + placement_extent(placement, shape, outward);
    return top > 0.0 ? end + top / tan(water_way_grazing(&view->water, end, top)) : end;
}

double object_top(const sonject_object_params *object)
{
    struct placement placement;
    pose(&placement, object, false); /* to which side the sonar looks does not matter */
    return placement_extent(&placement, object->shape, upward) +
           placement_extent(&placement, object->shape, downward) -
           burial_in_pose(&placement, object);
}

/* Row and column of the view under the object's centre. */
static void find_pixel(const struct patch_view *view, double first_row, double first_column,
                       const sonject_object_params *object, double *row, double *column)
{
    *row = 0.5 * (double)(view->rows - 1);
    *column = 0.5 * (double)(view->columns - 1);
    if (object->position_kind == SONJECT_POSITION_METRES) {
        const double x = view->is_mirrored ? -object->position_along : object->position_along;
        *row = view_row_of_x(view, x);
        *column = view_column_of_range(view, object->position_range);
    } else if (object->position_kind == SONJECT_POSITION_PIXELS) {
        const double image_row = object->position_along - first_row;
        *row = view->is_mirrored ? (double)(view->rows - 1) - image_row : image_row;
        *column = object->position_range - first_column;
    }
}

sonject_status placement_init(struct placement *placement, struct report *report,
                              const struct patch_view *view, double first_row, double first_column,
                              const sonject_object_params *object)
{
    memset(placement, 0, sizeof *placement);
    double row, column;
    find_pixel(view, first_row, first_column, object, &row, &column);
    if (!(row >= -0.5 && row < (double)view->rows - 0.5 && column >= -0.5 &&
          column < (double)view->columns - 0.5))
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "object '%s' lies outside the patch: its centre is %.1f m along-track "
            "and at %.1f m slant range; move it or the patch",
            object->name, view_x_of_row(view, row) * (view->is_mirrored ? -1 : 1),
            view_apparent_range(view, column));
    const uint32_t shape = object->shape;
    pose(placement, object, view->is_mirrored);
    const double burial = burial_in_pose(placement, object);
    if (object->burial_kind == SONJECT_BURIAL_PROUD && burial < 0.0)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "object '%s' cannot stand %.3f m proud of the seabed: in its pose it "
                              "is %.3f m high; lower burial.proud",
                              object->name, object->proud_height_m,
                              overall_size(placement, shape, 2));
    placement->centre[0] = view_x_of_row(view, row);
    placement->centre[1] = view_ground_range(view, view_apparent_range(view, column));
    placement->centre[2] = placement_extent(placement, shape, downward) - burial;
    if (placement->centre[2] == 0.0 && overall_size(placement, shape, 2) < THINNEST_M)
        placement->centre[2] = THINNEST_M;
    const double patch_length = (double)view->rows * view->row_spacing_m;
    const double patch_width = (double)view->columns * view->column_spacing_m;
    if (overall_size(placement, shape, 0) > patch_length ||
        overall_size(placement, shape, 1) > patch_width)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "object '%s' is larger than the patch of %.2f m x %.2f m: use a "
                              "larger patch",
                              object->name, patch_length, patch_width);
    if (placement->centre[2] + placement_extent(placement, shape, upward) >= view->altitude_m ||
        placement_range(placement, view) <= 2.0 * placement->bounding_radius_m)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "object '%s' reaches up to the sonar: lower it or raise the altitude",
                              object->name);
    return SONJECT_OK;
}
