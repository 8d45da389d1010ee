#include "sixteen_lanes.h"

#define WIDTH LANES
#include "intersection.h"

void sixteen_lanes_hit(const struct object_record *object, float rays[6][LANES], float minimum,
                       float distance[LANES], float normal[3][LANES])
{
    struct vector3 point, direction;
    point.x = LOAD_REAL(rays[0]);
    point.y = LOAD_REAL(rays[1]);
    point.z = LOAD_REAL(rays[2]);
    direction.x = LOAD_REAL(rays[3]);
    direction.y = LOAD_REAL(rays[4]);
    direction.z = LOAD_REAL(rays[5]);
    const real met = object_distance(object, point, direction, SPLAT(minimum));
    const real safe = CHOOSE(MASK_OF(met < 0.5f * FAR_AWAY), met, SPLAT(0.0f));
    const struct vector3 out = object_normal(object, point, direction, safe);
    STORE_REAL(met, distance);
    STORE_REAL(out.x, normal[0]);
    STORE_REAL(out.y, normal[1]);
    STORE_REAL(out.z, normal[2]);
}
