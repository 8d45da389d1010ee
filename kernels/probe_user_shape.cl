/* Asks a user's shape for what a list of rays meets, as the snippet itself says it: for checks. */
#include "user_object.h"

/* rays: point, direction, nearest, 0; hits: distance, normal as it is (0 where nothing is met); all
 * in the shape's own frame. */
__kernel void probe_user_shape(__global const struct user_record *user, __global const float *rays,
                               __global float *hits)
{
    const size_t ray = 8 * get_global_id(0);
    const size_t hit = 4 * get_global_id(0);
    float parameters[USER_PARAMETERS];
    copy_user_parameters(user, parameters);
    const float3 point = (float3)(rays[ray], rays[ray + 1], rays[ray + 2]);
    const float3 direction = (float3)(rays[ray + 3], rays[ray + 4], rays[ray + 5]);
    const float distance =
        user_distance(user->snippet, point, direction, rays[ray + 6], parameters);
    float3 normal = (float3)(0.0f);
    if (distance > -FAR_AWAY && distance < FAR_AWAY)
        normal = user_normal(user->snippet, point + direction * distance, parameters);
    hits[hit] = distance;
    hits[hit + 1] = normal.x;
    hits[hit + 2] = normal.y;
    hits[hit + 3] = normal.z;
}
