/* Surfaces of the reference: a plane seabed and a few bodies, met by rays in double precision. */
#ifndef SONJECT_TESTS_REFERENCE_SHAPES_H
#define SONJECT_TESTS_REFERENCE_SHAPES_H

#include <stdbool.h>

#define REFERENCE_OBJECTS 8

struct reference_vector {
    double x, y, z;
};

enum reference_shape {
    REFERENCE_SPHERE,   /* radius */
    REFERENCE_CAPSULE,  /* length with its round ends (>= 2 radius), radius; along the nose */
    REFERENCE_CYLINDER, /* length, radius; flat ends; along the nose */
    REFERENCE_RECTANGLE /* length along the nose, width along its own y; both sides alike */
};

/* Lengths in m. `axes` are orthonormal: nose, own y, own z. `lambert` is mu, albedo pi mu. */
struct reference_object {
    enum reference_shape shape;
    struct reference_vector centre;
    struct reference_vector axes[3];
    double length, radius, width;
    double lambert;
};

/* The seabed is all of the plane z = 0. */
struct reference_scene {
    double seabed_lambert;
    int object_count; /* 0 .. REFERENCE_OBJECTS */
    struct reference_object objects[REFERENCE_OBJECTS];
};

/* `normal` faces the side that the ray came from, so closed bodies may hold a sonar. `point` is
   lifted off the surface by a nanometre, ready to start another ray. */
struct reference_hit {
    double distance;
    struct reference_vector point, normal;
    double lambert;
    bool on_object;
};

struct reference_vector reference_vector(double x, double y, double z);
struct reference_vector reference_sum(struct reference_vector a, double scale,
                                      struct reference_vector b); /* a + scale b */
double reference_dot(struct reference_vector a, struct reference_vector b);
struct reference_vector reference_cross(struct reference_vector a, struct reference_vector b);
struct reference_vector reference_unit(struct reference_vector a);

/* An unturned object at the origin, its nose along x; other sizes 0. The scene must have room. */
struct reference_object *reference_add_object(struct reference_scene *scene,
                                              enum reference_shape shape, double radius,
                                              double lambert);

/* Heading (rad) from +x towards +y, then pitch, nose down. */
void reference_turn(struct reference_object *object, double heading, double pitch);

/* Nearest surface along a ray of unit direction; false, and *hit untouched, if there is none. */
bool reference_nearest(const struct reference_scene *scene, struct reference_vector origin,
                       struct reference_vector direction, struct reference_hit *hit);

/* Whether anything lies between. */
bool reference_blocked(const struct reference_scene *scene, struct reference_vector from,
                       struct reference_vector to);

#endif
