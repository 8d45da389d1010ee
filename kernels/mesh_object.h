/* Objects that are triangle meshes. */
#ifndef SONJECT_KERNELS_MESH_OBJECT_H
#define SONJECT_KERNELS_MESH_OBJECT_H

#include "layout.h"
#include "mesh.h"
#include "mesh_surface.h"

/* The slack of a ray's second walk for the facet at a known distance, before and behind, in radii
 * of the mesh. The distances of a ray that is moved along itself differ by their rounding. */
#define MESH_FACET_SLACK 1.0e-6f

FUNCTION GLOBAL const struct mesh_record *mesh_record_of_object(
    GLOBAL const struct object_record *object)
{
    return (GLOBAL const struct mesh_record *)((GLOBAL const RECORD_WORD *)object +
                                               object->mesh_words);
}

/* Returns the object's mesh. Meshes lie behind the records of all objects: a mesh_record, its
 * branches, its leaves and, if smooth, the normals at its corners. */
FUNCTION struct mesh_view mesh_of_object(GLOBAL const struct object_record *object)
{
    GLOBAL const struct mesh_record *mesh = mesh_record_of_object(object);
    GLOBAL const struct mesh_branch *branches = (GLOBAL const struct mesh_branch *)(mesh + 1);
    GLOBAL const struct mesh_leaf *leaves =
        (GLOBAL const struct mesh_leaf *)(branches + mesh->branches);
    GLOBAL const struct mesh_corner_normals *normals =
        (GLOBAL const struct mesh_corner_normals *)(leaves + mesh->leaves);
    return mesh_view_of(mesh, branches, leaves, normals);
}

/* Returns the distance from the ray's closest approach `start`, in the object's own frame, to the
 * first facet beyond `minimum` and not beyond `farthest`; FAR_AWAY if there is none. */
NOINLINE vfloat mesh_object_distance(GLOBAL const struct object_record *object,
                                     struct vector3 start, struct vector3 direction, vfloat minimum,
                                     vfloat farthest)
{
    return mesh_nearest_hit(mesh_of_object(object), start, direction, minimum, farthest).distance;
}

/* Returns the surface at a distance from the closest approach, in the object's own frame. Normals
 * are outward. Sheets have no inside; their normals are on the side that the ray came from. */
NOINLINE struct mesh_surface mesh_object_surface(GLOBAL const struct object_record *object,
                                                 struct vector3 start, struct vector3 direction,
                                                 vfloat distance)
{
    const struct mesh_view mesh = mesh_of_object(object);
    const vfloat slack = MESH_FACET_SLACK * (object->bounding_radius + magnitude(distance));
    const struct mesh_hit hit =
        mesh_nearest_hit(mesh, start, direction, distance - slack, distance + slack);
    struct mesh_surface surface = mesh_surface_at(mesh, start, direction, hit.triangle);
    if (mesh_record_of_object(object)->is_sheet) {
        const mask is_behind = MASK_OF(dot3(surface.facet, direction) > 0.0f);
        surface.facet = choose3(is_behind, reversed3(surface.facet), surface.facet);
        surface.smooth = choose3(is_behind, reversed3(surface.smooth), surface.smooth);
    }
    return surface;
}

#endif
