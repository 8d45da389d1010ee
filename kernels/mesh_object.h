/* Objects that are triangle meshes. */
#ifndef SONJECT_KERNELS_MESH_OBJECT_H
#define SONJECT_KERNELS_MESH_OBJECT_H

#include "layout.h"
#include "mesh.h"
#include "mesh_surface.h"

/* A ray's second walk, for the facet at a distance that is known, looks so far before and behind,
 * in radii of the mesh: the distances of a ray that is moved along itself differ by their
 * rounding. */
#define MESH_FACET_SLACK 1.0e-6f

/* Meshes lie behind the records of all objects: a mesh_record, its branches, its leaves. */
FUNCTION struct mesh_view mesh_of_object(GLOBAL const struct object_record *object)
{
    GLOBAL const RECORD_WORD *words = (GLOBAL const RECORD_WORD *)object + object->mesh_words;
    GLOBAL const struct mesh_record *mesh = (GLOBAL const struct mesh_record *)words;
    GLOBAL const struct mesh_branch *branches = (GLOBAL const struct mesh_branch *)(mesh + 1);
    GLOBAL const struct mesh_leaf *leaves =
        (GLOBAL const struct mesh_leaf *)(branches + mesh->branches);
    return mesh_view_of(mesh, branches, leaves, 0); /* facets are flat */
}

/* Distance from the ray's closest approach `start`, in the object's own frame, to the first facet
 * beyond `minimum`; FAR_AWAY if there is none, or the ray is not wanted. */
APART real mesh_object_distance(GLOBAL const struct object_record *object, struct vector3 start,
                                struct vector3 direction, real minimum, mask is_wanted)
{
    const real farthest = CHOOSE(is_wanted, SPLAT(FAR_AWAY), minimum - 1.0f);
    return mesh_nearest_hit(mesh_of_object(object), start, direction, minimum, farthest).distance;
}

/* Outward normal of the facet at a distance from the closest approach, in the object's own
 * frame. */
APART struct vector3 mesh_object_normal(GLOBAL const struct object_record *object,
                                        struct vector3 start, struct vector3 direction,
                                        real distance)
{
    const struct mesh_view mesh = mesh_of_object(object);
    const real slack = MESH_FACET_SLACK * (object->bounding_radius + magnitude(distance));
    const struct mesh_hit hit =
        mesh_nearest_hit(mesh, start, direction, distance - slack, distance + slack);
    return mesh_surface_at(mesh, start, direction, hit.triangle).facet;
}

#endif
