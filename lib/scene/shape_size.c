#include "scene/shape_size.h"

#include <math.h>
#include <string.h>

static void take_end(struct end_size *end, const sonject_object_params *object, uint32_t kind,
                     double depth_m)
{
    end->is_open = kind == SONJECT_END_OPEN;
    end->depth_m = 0.0;
    if (kind == SONJECT_END_SPHERICAL)
        end->depth_m = depth_m > 0.0 ? depth_m : 0.5 * object->diameter_m;
    end->joint_m = 0.5 * object->length_m - end->depth_m;
}

static void take_cuts(struct shape_size *size, const sonject_object_params *object)
{
    size->cut_count = object->cut_count;
    for (uint32_t i = 0; i < object->cut_count; i++) {
        const sonject_cut *cut = &object->cuts[i];
        struct cut_plane *plane = &size->cuts[i];
        plane->normal[0] = cos(cut->azimuth_rad) * cos(cut->elevation_rad);
        plane->normal[1] = sin(cut->azimuth_rad) * cos(cut->elevation_rad);
        plane->normal[2] = sin(cut->elevation_rad);
        plane->offset_m = cut->distance_m;
    }
}

static double bounding_radius(const struct shape_size *size, uint32_t shape)
{
    switch (shape) {
    case SONJECT_SHAPE_PLANE:
        return hypot(size->half_length_m, size->half_width_m);
    case SONJECT_SHAPE_CYLINDER: /* tips and rims */
        return fmax(size->half_length_m,
                    hypot(fmax(size->nose.joint_m, size->tail.joint_m), size->radius_m));
    case SONJECT_SHAPE_CAPSULE:
        return size->half_length_m + size->radius_m;
    case SONJECT_SHAPE_ELLIPSOID:
        return fmax(fmax(size->half_length_m, size->half_width_m), size->half_height_m);
    case SONJECT_SHAPE_BOX:
    case SONJECT_SHAPE_WEDGE:
        return hypot(hypot(size->half_length_m, size->half_width_m), size->half_height_m);
    case SONJECT_SHAPE_CONE:
    case SONJECT_SHAPE_TRUNCATED_CONE:
        return hypot(fmax(size->radius_m, size->top_radius_m), size->half_height_m);
    case SONJECT_SHAPE_TORUS:
        return size->radius_m + size->ring_radius_m;
    default: /* sphere, disc */
        return size->radius_m;
    }
}

void shape_size_of_mesh(struct shape_size *size, const struct mesh *mesh)
{
    size->mesh = mesh;
    size->half_length_m = mesh->upper_m[0];
    size->half_width_m = mesh->upper_m[1];
    size->half_height_m = mesh->upper_m[2];
    size->bounding_radius_m = (1.0 + 1e-6) * mesh->radius_m;
}

void shape_size_of_user_shape(struct shape_size *size, const struct user_shape *shape)
{
    size->user_shape = shape;
    size->half_length_m = shape->half_length_m;
    size->half_width_m = shape->half_width_m;
    size->half_height_m = shape->half_height_m;
    size->bounding_radius_m = (1.0 + 1e-6) * shape->bounding_radius_m;
}

void shape_size_init(struct shape_size *size, const sonject_object_params *object)
{
    memset(size, 0, sizeof *size);
    size->half_length_m = 0.5 * object->length_m;
    size->half_width_m = 0.5 * object->width_m;
    size->half_height_m = 0.5 * object->height_m;
    size->radius_m = 0.5 * object->diameter_m;
    switch (object->shape) {
    case SONJECT_SHAPE_PLANE:
        size->radius_m = 0.0;
        break;
    case SONJECT_SHAPE_SPHERE:
        size->half_length_m = 0.0;
        break;
    case SONJECT_SHAPE_CYLINDER:
        take_end(&size->nose, object, object->nose_end, object->nose_end_depth_m);
        take_end(&size->tail, object, object->tail_end, object->tail_end_depth_m);
        break;
    case SONJECT_SHAPE_CAPSULE:
        size->half_length_m -= size->radius_m;
        break;
    case SONJECT_SHAPE_WEDGE:
        size->front_height_m = object->front_height_m;
        break;
    case SONJECT_SHAPE_TRUNCATED_CONE:
        size->top_radius_m = 0.5 * object->top_diameter_m;
        break;
    case SONJECT_SHAPE_TORUS:
        size->ring_radius_m = size->half_height_m;
        size->radius_m -= size->ring_radius_m;
        break;
    default:
        break;
    }
    take_cuts(size, object);
    /* rounding to single precision must not cut */
    size->bounding_radius_m = (1.0 + 1e-6) * bounding_radius(size, object->shape);
}

double shape_radius_about_nose(const struct shape_size *size, uint32_t shape)
{
    switch (shape) {
    case SONJECT_SHAPE_PLANE:
        return size->half_width_m;
    case SONJECT_SHAPE_ELLIPSOID:
        return fmax(size->half_width_m, size->half_height_m);
    case SONJECT_SHAPE_BOX:
    case SONJECT_SHAPE_WEDGE:
    case SONJECT_SHAPE_MESH:
        return hypot(size->half_width_m, size->half_height_m);
    case SONJECT_SHAPE_USER:
        return fmin(hypot(size->half_width_m, size->half_height_m), size->bounding_radius_m);
    case SONJECT_SHAPE_CONE:
    case SONJECT_SHAPE_TRUNCATED_CONE:
    case SONJECT_SHAPE_TORUS:
        return bounding_radius(size, shape);
    default:
        return size->radius_m;
    }
}
