/* Shapes that are written by users, in OpenCL C. */
#ifndef SONJECT_USER_SHAPE_H
#define SONJECT_USER_SHAPE_H

#define SONJECT_USER_PARAMETERS_CAPACITY 16 /* numbers that are handed to the code, as float */

/* A shape given by two functions in OpenCL C 1.2 (objects[].user of a scene), which are compiled as
 * a translation unit of their own and linked to the program that traces:
 *
 *   float shape_distance(float3 point, float3 direction, float nearest, const float *parameters)
 *     {distance in m of the first surface beyond `nearest` on the ray point + distance * direction,
 *      or INFINITY}
 *   float3 shape_normal(float3 point, const float *parameters)
 *     {outward normal at a point of the surface, of any length but 0}
 *
 * in the object's own frame (x nose, y to its left, z up when level) and in metres. direction is a
 * unit vector; point is where the ray comes closest to the origin, so that single precision holds
 * the shape and not the range; nearest, of any sign, is at least minus the bounding radius, and
 * surfaces are looked for within the bounding sphere only. Distances must be good to a few um, for
 * rays go on from 20 um off a surface; one that is not a number counts as no surface, a normal that
 * is not one fails the run. Every ray must get the same answer each time it is asked.
 *
 * A closed shape's surfaces must be all there, so that a ray enters and leaves it in turn.
 *
 * The code may hold further functions, types, `constant` tables and macros; their names meet
 * neither those of the program nor of other shapes, with a compiler other than clang where
 * functions and tables are `static`. All of it must be in one file: #include is refused. Errors
 * have the line that the compiler tells. sonject_check tries a shape with some thousand rays. A
 * device whose driver links no programs takes no such shapes.
 *
 * The code is a program: it runs with the rights of the process (on a CPU it can do what the
 * process can), and one that does not come to an end cannot be stopped, it holds the device until
 * the process ends. Take it from nobody whose programs you would not run. */

#endif
