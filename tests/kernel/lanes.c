#include "lanes.h"

#define WIDTH LANES
#include "intersection.h"

void lanes_hit(const struct object_record *object, float rays[6][LANES], float minimum,
               float distance[LANES], float normal[3][LANES])
{
    struct vector3 point, direction;
    point.x = LOAD_VFLOAT(rays[0]);
    point.y = LOAD_VFLOAT(rays[1]);
    point.z = LOAD_VFLOAT(rays[2]);
    direction.x = LOAD_VFLOAT(rays[3]);
    direction.y = LOAD_VFLOAT(rays[4]);
    direction.z = LOAD_VFLOAT(rays[5]);
    const vfloat met = object_distance(object, point, direction, SPLAT(minimum));
    const vfloat safe = SELECT(MASK_OF(met < 0.5f * FAR_AWAY), met, SPLAT(0.0f));
    const struct vector3 out = object_normal(object, point, direction, safe);
    STORE_VFLOAT(met, distance);
    STORE_VFLOAT(out.x, normal[0]);
    STORE_VFLOAT(out.y, normal[1]);
    STORE_VFLOAT(out.z, normal[2]);
}
