/* Probes a mesh with one packet of rays, for tests that use this source natively and as OpenCL C.
 * Arrays have one plane for each quantity, with `rays` elements each (a multiple of WIDTH). */
#ifndef SONJECT_TESTS_MESH_PROBE_H
#define SONJECT_TESTS_MESH_PROBE_H

#include "mesh_surface.h"

enum probe_input {
    PROBE_POINT = 0, /* x, y, z of the ray's point closest to the mesh's origin */
    PROBE_DIRECTION = 3,
    PROBE_MINIMUM = 6,
    PROBE_MAXIMUM = 7,
    PROBE_INPUTS = 8
};

enum probe_output {
    PROBE_DISTANCE = 0,
    PROBE_TRIANGLE = 1, /* bits of an integer */
    PROBE_BLOCKED = 2,  /* bits of an integer, 0 or -1 */
    PROBE_FACET = 3,    /* x, y, z; like all planes below, 0 without a hit */
    PROBE_SMOOTH = 6,
    PROBE_LIFTED = 9,
    PROBE_HIT = 12,
    PROBE_OUTPUTS = 15
};

FUNCTION struct vector3 probe_load(GLOBAL const float *planes, RECORD_WORD rays, RECORD_WORD first)
{
    struct vector3 v;
    v.x = LOAD_VFLOAT(planes + first);
    v.y = LOAD_VFLOAT(planes + rays + first);
    v.z = LOAD_VFLOAT(planes + 2 * rays + first);
    return v;
}

FUNCTION void probe_store(struct vector3 v, mask is_kept, GLOBAL float *planes, RECORD_WORD rays,
                          RECORD_WORD first)
{
    const vfloat x = SELECT(is_kept, v.x, SPLAT(0.0f));
    const vfloat y = SELECT(is_kept, v.y, SPLAT(0.0f));
    const vfloat z = SELECT(is_kept, v.z, SPLAT(0.0f));
    STORE_VFLOAT(x, planes + first);
    STORE_VFLOAT(y, planes + rays + first);
    STORE_VFLOAT(z, planes + 2 * rays + first);
}

FUNCTION void probe_nearest(struct mesh_view mesh, GLOBAL const float *input, GLOBAL float *output,
                            RECORD_WORD rays, RECORD_WORD first)
{
    const struct mesh_hit hit =
        mesh_nearest_hit(mesh, probe_load(input + PROBE_POINT * rays, rays, first),
                         probe_load(input + PROBE_DIRECTION * rays, rays, first),
                         LOAD_VFLOAT(input + PROBE_MINIMUM * rays + first),
                         LOAD_VFLOAT(input + PROBE_MAXIMUM * rays + first));
    const vfloat triangle = AS_VFLOAT(hit.triangle);
    STORE_VFLOAT(hit.distance, output + PROBE_DISTANCE * rays + first);
    STORE_VFLOAT(triangle, output + PROBE_TRIANGLE * rays + first);
}

FUNCTION void probe_blocked(struct mesh_view mesh, GLOBAL const float *input, GLOBAL float *output,
                            RECORD_WORD rays, RECORD_WORD first)
{
    const mask is_blocked =
        mesh_is_in_the_way(mesh, probe_load(input + PROBE_POINT * rays, rays, first),
                           probe_load(input + PROBE_DIRECTION * rays, rays, first),
                           LOAD_VFLOAT(input + PROBE_MINIMUM * rays + first),
                           LOAD_VFLOAT(input + PROBE_MAXIMUM * rays + first));
    const vfloat blocked = AS_VFLOAT(is_blocked);
    STORE_VFLOAT(blocked, output + PROBE_BLOCKED * rays + first);
}

/* Finds the surface at the triangles that probe_nearest found. */
FUNCTION void probe_surface(struct mesh_view mesh, GLOBAL const float *input, GLOBAL float *output,
                            RECORD_WORD rays, RECORD_WORD first)
{
    const vint triangle = AS_VINT(LOAD_VFLOAT(output + PROBE_TRIANGLE * rays + first));
    const mask is_hit = MASK_OF(triangle >= 0);
    const struct mesh_surface surface =
        mesh_surface_at(mesh, probe_load(input + PROBE_POINT * rays, rays, first),
                        probe_load(input + PROBE_DIRECTION * rays, rays, first), triangle);
    probe_store(surface.facet, is_hit, output + PROBE_FACET * rays, rays, first);
    probe_store(surface.smooth, is_hit, output + PROBE_SMOOTH * rays, rays, first);
    probe_store(surface.lifted, is_hit, output + PROBE_LIFTED * rays, rays, first);
    probe_store(surface.point, is_hit, output + PROBE_HIT * rays, rays, first);
}

#endif
