/* A thin tube of rays about one ray. It holds the distance and the angle to neighbouring rays,
 * which left the wavefront at the first hit a unit away, along-track or across (kernels/MATH.md,
 * "Multi-bounce specular paths"). */
#ifndef SONJECT_KERNELS_TUBE_H
#define SONJECT_KERNELS_TUBE_H

#include "vector3.h"

/* A neighbouring ray relative to the middle ray. Both vectors are across the middle ray. */
struct tube_side {
    struct vector3 offset; /* m per m */
    struct vector3 turn;   /* change of the direction, rad per m */
};

struct tube {
    struct tube_side along, across;
};

/* Returns (a x b) . c. */
FUNCTION vfloat triple3(struct vector3 a, struct vector3 b, struct vector3 c)
{
    return (a.y * b.z - a.z * b.y) * c.x + (a.z * b.x - a.x * b.z) * c.y +
           (a.x * b.y - a.y * b.x) * c.z;
}

/* Returns where the neighbouring ray meets the tangent plane of a surface, relative to the middle
 * ray's hit. cosine: of the middle ray's angle of incidence. */
FUNCTION struct vector3 offset_on_surface(const struct tube_side *side, struct vector3 direction,
                                          struct vector3 normal, vfloat cosine)
{
    return along3(side->offset, direction, dot3(normal, side->offset) / cosine);
}

FUNCTION void transfer_side(struct tube_side *side, vfloat distance)
{
    side->offset = along3(side->offset, side->turn, distance);
}

FUNCTION void transfer_tube(struct tube *tube, vfloat distance)
{
    transfer_side(&tube->along, distance);
    transfer_side(&tube->across, distance);
}

/* Reflects a side by d' = d - 2 (d.n) n, varied in d and n. direction: of the incoming ray; cosine:
 * -(d.n); normal_change: of the surface where the neighbouring ray meets it. */
FUNCTION void reflect_side(struct tube_side *side, struct vector3 direction, struct vector3 normal,
                           vfloat cosine, struct vector3 normal_change)
{
    const struct vector3 turned = reflected3(side->turn, normal);
    side->offset = reflected3(side->offset, normal);
    side->turn = along3(along3(turned, normal_change, 2.0f * cosine), normal,
                        -2.0f * dot3(direction, normal_change));
}

/* Returns the tube's cross-section over that of the wavefront at the first hit. The sign tells the
 * handedness of the sides and the ray. */
FUNCTION vfloat tube_section(const struct tube *tube, struct vector3 direction)
{
    return triple3(tube->along.offset, tube->across.offset, direction);
}

/* Turns (real_part, imaginary_part) by -pi/2 for every caustic within the distance, where the tube
 * has no cross-section. A + B s + C s^2 always has real roots, since a wavefront's curvatures are
 * real. Ends of unlike sign have one root between them. Ends of like sign have two if the turning
 * point lies between them with the other sign (nearly so: both roots may be one). */
FUNCTION void turn_by_caustics(const struct tube *tube, struct vector3 direction, vfloat distance,
                               vfloat *real_part, vfloat *imaginary_part)
{
    const vfloat a = tube_section(tube, direction);
    const vfloat b = triple3(tube->along.turn, tube->across.offset, direction) +
                     triple3(tube->along.offset, tube->across.turn, direction);
    const vfloat c = triple3(tube->along.turn, tube->across.turn, direction);
    const vfloat end = a + distance * (b + distance * c);
    const mask is_one = MASK_OF(a * end < 0.0f);
    const mask is_bent = MASK_OF(magnitude(c) > 0.0f);
    const vfloat turning = -0.5f * b / SELECT(is_bent, c, SPLAT(1.0f));
    const vfloat there = a + 0.5f * b * turning;
    const mask is_two = ~is_one & is_bent & MASK_OF(turning > 0.0f) & MASK_OF(turning < distance) &
                        MASK_OF(a * c > 0.0f) & MASK_OF(there * a < 0.1f * (a * a));
    const vfloat was_real = *real_part;
    const vfloat was_imaginary = *imaginary_part;
    *real_part = SELECT(is_one, was_imaginary, SELECT(is_two, -was_real, was_real));
    *imaginary_part = SELECT(is_one, -was_real, SELECT(is_two, -was_imaginary, was_imaginary));
}

#define TUBE_LIMIT 1.0e4f /* a wider tube is no part of any echo */

FUNCTION mask is_narrow_side(const struct tube_side *side)
{
    return MASK_OF(dot3(side->offset, side->offset) < TUBE_LIMIT * TUBE_LIMIT) &
           MASK_OF(dot3(side->turn, side->turn) < TUBE_LIMIT * TUBE_LIMIT);
}

FUNCTION mask is_narrow(const struct tube *tube)
{
    return is_narrow_side(&tube->along) & is_narrow_side(&tube->across);
}

#endif
