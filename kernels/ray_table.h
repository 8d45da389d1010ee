/* Rays bent by layers of water, from tables of the host: for each elevation the straight line of
 * the ray in the straight water or in a slice (kernels/MATH.md, "Layers"). */
#ifndef SONJECT_KERNELS_RAY_TABLE_H
#define SONJECT_KERNELS_RAY_TABLE_H

#include "elementary.h"
#include "layout.h"
#include "vector3.h"

/* A ray's line in the plane of its strip. */
struct table_ray {
    vfloat offset;    /* offset of its closest point from the frame's origin, along `upward` */
    vfloat range;     /* range at that point less the reference range */
    vfloat wavefront; /* width per rad of elevation at that point; it grows by 1 m per m */
    vfloat spreading; /* spreading of struct arrival (lib/medium/water.h) */
};

/* Looks up a ray. Its offset a(e) is a cubic in each piece, and its wavefront the derivative of a.
 * Its range is the integral of -a, because wavefronts stand at right angles to rays. */
FUNCTION struct table_ray look_up_ray(struct ray_table_record table,
                                      GLOBAL const struct ray_piece_record *pieces,
                                      vfloat elevation)
{
    const vfloat place = (elevation - table.first_elevation) * table.pieces_per_radian;
    const vfloat inside = smaller(larger(place, SPLAT(0.0f)), SPLAT((float)table.pieces - 0.5f));
    const vint number = VINT_OF(inside);
    const vfloat along = place - VFLOAT_OF(number); /* beyond the table the last cubic goes on */
    int numbers[WIDTH];
    float lanes[7][WIDTH];
    STORE_VINT(number, numbers);
    for (int lane = 0; lane < WIDTH; lane++) {
        GLOBAL const struct ray_piece_record *piece = &pieces[table.first_piece + numbers[lane]];
        for (int i = 0; i < 4; i++)
            lanes[i][lane] = piece->offset[i];
        lanes[4][lane] = piece->range;
        lanes[5][lane] = piece->spreading;
        lanes[6][lane] = piece->spreading_growth;
    }
    const vfloat a0 = LOAD_VFLOAT(lanes[0]), a1 = LOAD_VFLOAT(lanes[1]);
    const vfloat a2 = LOAD_VFLOAT(lanes[2]), a3 = LOAD_VFLOAT(lanes[3]);
    struct table_ray ray;
    ray.offset = ((a3 * along + a2) * along + a1) * along + a0;
    ray.wavefront = ((3.0f * a3 * along + 2.0f * a2) * along + a1) * table.pieces_per_radian;
    ray.range = LOAD_VFLOAT(lanes[4]) -
                (((0.25f * a3 * along + 0.33333333f * a2) * along + 0.5f * a1) * along + a0) *
                    along * table.radians_per_piece;
    ray.spreading = LOAD_VFLOAT(lanes[5]) + along * LOAD_VFLOAT(lanes[6]);
    return ray;
}

/* A direction away from the source, in the plane of a strip. Its elevation counts from the
 * direction to the frame's origin. */
struct ray_directions {
    vfloat away_y, away_z;
};

FUNCTION struct ray_directions directions_at(float cosine_depression, float sine_depression,
                                             vfloat elevation)
{
    vfloat sine, cosine;
    sine_cosine_of_cycles(elevation * 0.15915494309f, &sine, &cosine);
    cosine = SQUARE_ROOT(1.0f - sine * sine);
    struct ray_directions directions;
    directions.away_y = cosine * cosine_depression + sine * sine_depression;
    directions.away_z = sine * cosine_depression - cosine * sine_depression;
    return directions;
}

/* A ray where it is broadside of a point. */
struct ray_to_point {
    struct ray_directions directions;
    vfloat beside;    /* distance of the point to the ray's upper side, m */
    vfloat range;     /* range there less the reference range */
    vfloat wavefront; /* width per rad of elevation there */
    vfloat spreading;
};

FUNCTION struct ray_to_point broadside_ray(struct ray_table_record table,
                                           GLOBAL const struct ray_piece_record *pieces,
                                           float cosine_depression, float sine_depression,
                                           vfloat elevation, vfloat y, vfloat z)
{
    const struct table_ray ray = look_up_ray(table, pieces, elevation);
    struct ray_to_point to;
    to.directions = directions_at(cosine_depression, sine_depression, elevation);
    const vfloat along = y * to.directions.away_y + z * to.directions.away_z;
    to.beside = z * to.directions.away_y - y * to.directions.away_z - ray.offset;
    to.range = ray.range + along;
    to.wavefront = ray.wavefront + along;
    to.spreading = ray.spreading;
    return to;
}

#define RAY_SEARCH_STEPS 24
#define RAY_NEAR_ENOUGH  1.0e-4f /* m beside the point; the range errs by its square over 2 r */

/* Returns the ray through a point (y, z) of the strip's plane, by Newton's iteration guarded by
 * bisection. A larger elevation moves the point towards the ray's lower side. */
FUNCTION struct ray_to_point find_ray_to(struct ray_table_record table,
                                         GLOBAL const struct ray_piece_record *pieces,
                                         float cosine_depression, float sine_depression, vfloat y,
                                         vfloat z)
{
    vfloat low = SPLAT(table.first_elevation);
    vfloat high = low + (float)table.pieces * table.radians_per_piece;
    vfloat elevation = smaller(larger(SPLAT(0.0f), low), high);
    mask is_searching = MASK_OF(elevation == elevation);
    for (int i = 0; i < RAY_SEARCH_STEPS && ANY(is_searching); i++) {
        const struct ray_to_point to =
            broadside_ray(table, pieces, cosine_depression, sine_depression, elevation, y, z);
        const mask is_above = MASK_OF(to.beside > 0.0f);
        low = SELECT(is_above, elevation, low);
        high = SELECT(is_above, high, elevation);
        const vfloat newton = elevation + to.beside / larger(to.wavefront, SPLAT(1.0e-3f));
        const mask is_guarded = MASK_OF(newton > low) & MASK_OF(newton < high);
        is_searching = is_searching & MASK_OF(magnitude(to.beside) > RAY_NEAR_ENOUGH);
        elevation =
            SELECT(is_searching, SELECT(is_guarded, newton, 0.5f * (low + high)), elevation);
    }
    return broadside_ray(table, pieces, cosine_depression, sine_depression, elevation, y, z);
}

#endif
