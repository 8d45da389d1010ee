/* Objects: shape, pose and surface of each thing that is put on the seabed. */
#ifndef SONJECT_OBJECT_H
#define SONJECT_OBJECT_H

#include <stdint.h>

#include <sonject/export.h>
#include <sonject/material.h>

SONJECT_BEGIN_DECLARATIONS

/* Lengths are overall. The axis of cylinder and capsule lies along the object's nose direction. */
typedef enum sonject_shape {
    SONJECT_SHAPE_PLANE = 0,  /* rectangle length x width, facing up when pose is level; both sides
                                 reflect */
    SONJECT_SHAPE_SPHERE = 1, /* diameter */
    SONJECT_SHAPE_CYLINDER = 2, /* length x diameter, flat ends */
    SONJECT_SHAPE_CAPSULE = 3   /* length x diameter, length includes the spherical ends */
} sonject_shape;

/* How a position is given. The ground point under the object's centre is meant. */
typedef enum sonject_position_kind {
    SONJECT_POSITION_PATCH_CENTRE = 0, /* along = range = 0 */
    SONJECT_POSITION_METRES = 1,       /* along: along-track m, range: apparent slant range m, both
                                          as the image's geometry counts them */
    SONJECT_POSITION_PIXELS = 2 /* along: row, range: column of the swath, centres at integers */
} sonject_position_kind;

#define SONJECT_NAME_CAPACITY 64

typedef struct sonject_object_params {
    uint32_t struct_size;
    uint32_t shape;                         /* sonject_shape */
    char name[SONJECT_NAME_CAPACITY];       /* UTF-8, terminated; "" becomes "object N" */
    char class_name[SONJECT_NAME_CAPACITY]; /* label class; "" becomes the shape's name */
    double length_m;                        /* plane, cylinder, capsule (>= diameter) */
    double width_m;                         /* plane */
    double diameter_m;                      /* sphere, cylinder, capsule */
    uint32_t position_kind;                 /* sonject_position_kind */
    uint32_t reserved;
    double position_along; /* see sonject_position_kind */
    double position_range;
    double heading_rad; /* from along-track (+x) towards range (+y) */
    double pitch_rad;   /* raises the nose */
    double roll_rad;    /* about the nose direction */
    double burial_m;    /* depth of the lowest point below the seabed; negative: above it */
    sonject_material_params material;
} sonject_object_params;

/* A proud sphere of 0.5 m diameter in the middle of the patch, default material. */
SONJECT_API void sonject_object_params_init(sonject_object_params *object);

SONJECT_END_DECLARATIONS

#endif
