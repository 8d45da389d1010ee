/* Objects that are triangle meshes, whole, and cut by planes. What is left of a closed one is a
 * solid with flat faces: a ray is inside where the facets ahead of it wind about it. Sheets are cut
 * away and nothing closes them. */
#ifndef SONJECT_KERNELS_MESH_OBJECT_H
#define SONJECT_KERNELS_MESH_OBJECT_H

#include "cut.h"
#include "layout.h"
#include "mesh.h"
#include "mesh_surface.h"

/* A ray's second walk, for the facet at a distance that is known, looks so far before and behind,
 * in radii of the mesh: the distances of a ray that is moved along itself differ by their
 * rounding. */
#define MESH_FACET_SLACK 1.0e-6f

FUNCTION GLOBAL const struct mesh_record *mesh_record_of_object(
    GLOBAL const struct object_record *object)
{
    return (GLOBAL const struct mesh_record *)((GLOBAL const RECORD_WORD *)object +
                                               object->mesh_words);
}

/* Meshes lie behind the records of all objects: a mesh_record, its branches, its leaves and, of a
 * smooth one, the normals at its corners. */
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

/* Distance from the ray's closest approach `start`, in the object's own frame, to the first facet
 * beyond `minimum` and not beyond `farthest`; FAR_AWAY if there is none. */
NOINLINE vfloat mesh_object_distance(GLOBAL const struct object_record *object,
                                     struct vector3 start, struct vector3 direction, vfloat minimum,
                                     vfloat farthest)
{
    return mesh_nearest_hit(mesh_of_object(object), start, direction, minimum, farthest).distance;
}

/* The surface at a distance from the closest approach, in the object's own frame. Normals are
 * outward; those of sheets, which have no inside, on the side that the ray came from. */
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

/* An edge's function, of the edge from `from` to `to` as seen along the ray; where it is 0, its
 * change for a ray that is shifted across by next to nothing, and by yet less upward. */
FUNCTION vfloat function_beside_edge(vfloat function, struct vector3 from, struct vector3 to)
{
    const vfloat shifted = SELECT(MASK_OF(to.y - from.y == 0.0f), from.x - to.x, to.y - from.y);
    return SELECT(MASK_OF(function == 0.0f), shifted, function);
}

/* What a triangle counts: 1 where the ray leaves through it, -1 where it enters, 0 where it misses
 * it. A ray through an edge or a corner counts as one just beside it, for all triangles there: they
 * agree on corners to the bit. */
FUNCTION vfloat crossing_of_triangle(const struct mesh_ray *ray, const struct mesh_corners *corners)
{
    struct mesh_corners seen;
    seen.a = seen_along(ray, corners->a);
    seen.b = seen_along(ray, corners->b);
    seen.c = seen_along(ray, corners->c);
    struct vector3 edges = edge_functions(&seen);
    edges.x = function_beside_edge(edges.x, seen.b, seen.c);
    edges.y = function_beside_edge(edges.y, seen.c, seen.a);
    edges.z = function_beside_edge(edges.z, seen.a, seen.b);
    const mask enters = MASK_OF(smaller(smaller(edges.x, edges.y), edges.z) > 0.0f);
    const mask leaves = MASK_OF(larger(larger(edges.x, edges.y), edges.z) < 0.0f);
    return SELECT(enters, SPLAT(-1.0f), SELECT(leaves, SPLAT(1.0f), SPLAT(0.0f)));
}

FUNCTION float crossings_of_leaf(const struct mesh_ray *ray, GLOBAL const struct mesh_leaf *leaf)
{
    float sum = 0.0f;
    for (int first = 0; first < leaf->triangles; first += WIDTH) {
        const struct mesh_corners corners = leaf_corners(leaf, first);
        vfloat distance;
        const mask is_met = meets_triangle(ray, &corners, &distance);
        RECORD_WORD met = lane_bits(is_met & MASK_OF(distance > ray->minimum));
        if (met == 0)
            continue;
        const vfloat crossing = crossing_of_triangle(ray, &corners);
        float crossings[WIDTH];
        STORE_VFLOAT(crossing, crossings);
        for (; met != 0; met &= met - 1)
            sum += crossings[lowest_bit(met)];
    }
    return sum;
}

/* Crossings of all triangles beyond the ray's minimum. Such sums are exact, so the order of the
 * walk changes nothing. */
FUNCTION float crossings_of_one(struct mesh_view mesh, const struct mesh_ray_lanes *lanes, int lane)
{
    const struct mesh_ray ray = one_mesh_ray(lanes, lane);
    struct single_stack stack;
    float sum = 0.0f;
    stack.count = 1;
    stack.child[0] = 0;
    while (stack.count > 0) {
        const int number = stack.child[--stack.count];
        if (number >= 0)
            open_branch_single(&ray, &mesh.branches[number], FAR_AWAY, &stack);
        else
            sum += crossings_of_leaf(&ray, &mesh.leaves[~number]);
    }
    return sum;
}

/* Whether the rays' points at a distance `at` are inside the closed mesh: its winding number there
 * is not 0. So a ray that grazes an edge between a near and a far side is not taken in, whichever
 * of the two rounding puts first, and pieces that overlap are one solid. */
NOINLINE mask is_inside_mesh(struct mesh_view mesh, struct vector3 start, struct vector3 direction,
                             vfloat at, mask is_wanted)
{
    const struct mesh_ray ray = mesh_ray_of(start, direction, at, mesh.padding);
    struct mesh_ray_lanes lanes;
    float windings[WIDTH];
    store_mesh_ray(&ray, &lanes);
    for (int lane = 0; lane < WIDTH; lane++)
        windings[lane] = 0.0f;
    for (RECORD_WORD set = lane_bits(is_wanted); set != 0; set &= set - 1) {
        const int lane = lowest_bit(set);
        windings[lane] = crossings_of_one(mesh, &lanes, lane);
    }
    return MASK_OF(magnitude(LOAD_VFLOAT(windings)) > 0.5f);
}

FUNCTION mask is_in_mesh_box(GLOBAL const struct object_record *object, struct vector3 point,
                             float padding)
{
    return MASK_OF(magnitude(point.x) <= object->half_length + padding) &
           MASK_OF(magnitude(point.y) <= object->half_width + padding) &
           MASK_OF(magnitude(point.z) <= object->half_height + padding);
}

/* As mesh_object_distance, of what the cuts leave, for the rays that are wanted. A ray that comes
 * out of what is cut off meets the plane's own face if it is inside the mesh there; so does one
 * that starts in the solid and meets no facet before the plane. */
NOINLINE vfloat cut_mesh_distance(GLOBAL const struct object_record *object, struct vector3 start,
                                  struct vector3 direction, vfloat minimum, mask is_wanted)
{
    const struct mesh_view mesh = mesh_of_object(object);
    const struct interval left = interval_under_cuts(object, start, direction);
    const vfloat first = larger(minimum, left.entry);
    const mask is_left = is_wanted & MASK_OF(first <= left.exit);
    const vfloat last = SELECT(is_left, left.exit, SPLAT(-FAR_AWAY));
    const vfloat facet = mesh_object_distance(object, start, direction, first, last);
    if (mesh_record_of_object(object)->is_sheet)
        return facet;
    const mask enters = MASK_OF(left.entry > minimum);
    const mask leaves = MASK_OF(left.exit > minimum) & MASK_OF(facet >= FAR_AWAY);
    const vfloat face = SELECT(enters, left.entry, left.exit);
    const mask is_asked = is_left & (enters | leaves) & MASK_OF(magnitude(face) < FAR_AWAY) &
                          is_in_mesh_box(object, along3(start, direction, face), mesh.padding);
    if (!ANY(is_asked))
        return facet;
    return SELECT(is_inside_mesh(mesh, start, direction, face, is_asked), face, facet);
}

/* The surface of what the cuts leave, as mesh_object_surface: the face of a cut is flat, whatever
 * the facets stand for. approach: of the closest approach along the ray; distance counts from where
 * that does. */
NOINLINE struct mesh_surface cut_mesh_surface(GLOBAL const struct object_record *object,
                                              struct vector3 start, struct vector3 direction,
                                              vfloat approach, vfloat distance)
{
    struct mesh_surface surface =
        mesh_object_surface(object, start, direction, distance - approach);
    if (mesh_record_of_object(object)->is_sheet)
        return surface;
    const struct cut_face face = cut_face_at(object, start, direction, approach, distance);
    const struct vector3 point = along3(start, direction, distance - approach);
    surface.point = choose3(face.is_met, point, surface.point);
    surface.facet = choose3(face.is_met, face.normal, surface.facet);
    surface.smooth = choose3(face.is_met, face.normal, surface.smooth);
    surface.lifted = choose3(face.is_met, point, surface.lifted);
    return surface;
}

#endif
