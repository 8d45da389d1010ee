/* Objects: shape, pose and surface of each thing that is put on the seabed. */
#ifndef SONJECT_OBJECT_H
#define SONJECT_OBJECT_H

#include <stdint.h>

#include <sonject/export.h>
#include <sonject/material.h>

SONJECT_BEGIN_DECLARATIONS

/* Lengths are overall. Length runs along the object's nose direction (own x), width across it (own
 * y, to the left of the nose as seen from above), height upwards when the pose is level (own z). An
 * object is the same thing to port and to starboard. */
typedef enum sonject_shape {
    SONJECT_SHAPE_PLANE = 0,  /* rectangle length x width, facing up when pose is level; both sides
                                 reflect */
    SONJECT_SHAPE_SPHERE = 1, /* diameter */
    SONJECT_SHAPE_CYLINDER = 2,  /* length x diameter, axis along the nose; ends as nose_end and
                                    tail_end say */
    SONJECT_SHAPE_CAPSULE = 3,   /* length x diameter, length includes the spherical ends */
    SONJECT_SHAPE_DISC = 4,      /* diameter, facing up when pose is level; both sides reflect */
    SONJECT_SHAPE_ELLIPSOID = 5, /* length x width x height */
    SONJECT_SHAPE_BOX = 6,       /* length x width x height */
    SONJECT_SHAPE_WEDGE = 7,     /* length x width x height; the top slants from height at the tail
                                    to front_height at the nose */
    SONJECT_SHAPE_CONE = 8,      /* diameter x height, tip up when pose is level */
    SONJECT_SHAPE_TRUNCATED_CONE = 9, /* diameter (below) and top_diameter x height */
    SONJECT_SHAPE_TORUS = 10, /* diameter x height, lying flat when pose is level; its height is
                                 the thickness of the ring */
    SONJECT_SHAPE_PARTS = 11, /* the union of parts, see sonject_scene_add_part; no sizes */
    SONJECT_SHAPE_MESH = 12,  /* triangles, see sonject_scene_add_mesh; no sizes */
    SONJECT_SHAPE_USER = 13   /* code, see sonject_scene_add_user_shape; no sizes */
} sonject_shape;

/* An end of a cylinder. With an open end the cylinder is a tube: its wall is thin and reflects on
 * both sides. */
typedef enum sonject_end {
    SONJECT_END_FLAT = 0,
    SONJECT_END_OPEN = 1,
    SONJECT_END_SPHERICAL = 2 /* a part of a sphere that joins the rim */
} sonject_end;

/* How burial is given. */
typedef enum sonject_burial_kind {
    SONJECT_BURIAL_DEPTH = 0,    /* burial_m */
    SONJECT_BURIAL_FRACTION = 1, /* burial_fraction */
    SONJECT_BURIAL_PROUD = 2     /* proud_height_m */
} sonject_burial_kind;

/* A plane that cuts a part off an object: what lies more than distance_m from the centre towards a
 * direction of the object's own. A solid shows a flat face there, a sheet (a plane, a disc, a tube,
 * an open mesh, an open user's shape) just ends. */
typedef struct sonject_cut {
    double azimuth_rad;   /* of the direction, from the nose towards the object's own y */
    double elevation_rad; /* towards the object's own z */
    double distance_m;    /* of any sign */
} sonject_cut;

#define SONJECT_CUTS_CAPACITY 2

/* How a position is given. The ground point under the object's centre is meant: the middle of its
 * overall length, width and height, whatever is cut off; of an object of parts, the origin that
 * their places are counted from. Over relief that point of the mean seabed is meant; burial counts
 * from the relief's height there. */
typedef enum sonject_position_kind {
    SONJECT_POSITION_PATCH_CENTRE = 0, /* along = range = 0 */
    SONJECT_POSITION_METRES = 1,       /* along: along-track m, range: apparent slant range m, both
                                          as the image's geometry counts them */
    SONJECT_POSITION_PIXELS = 2 /* along: row, range: column of the swath, centres at integers */
} sonject_position_kind;

/* What sets the level of an object's echo. The other two scale all that the object returns by one
 * factor, so that the largest expected energy of its pixels, speckle averaged out, becomes as told.
 */
typedef enum sonject_level_kind {
    SONJECT_LEVEL_PHYSICAL = 0,        /* its shape and material, against the seabed's strength */
    SONJECT_LEVEL_TARGET_STRENGTH = 1, /* level_db: re 1 m^2, -200...200 */
    SONJECT_LEVEL_OVER_SEABED = 2      /* level_db: over the local mean seabed, -200...200 */
} sonject_level_kind;

#define SONJECT_NAME_CAPACITY 64

typedef struct sonject_object_params {
    uint32_t struct_size;
    uint32_t shape;                         /* sonject_shape; half a wavelength large at least */
    char name[SONJECT_NAME_CAPACITY];       /* "" becomes "object N"; both are terminated UTF-8
                                               without controls of terminals or text direction */
    char class_name[SONJECT_NAME_CAPACITY]; /* label class; "" becomes the shape's name */
    double length_m;        /* plane, cylinder, capsule (>= diameter), ellipsoid, box, wedge */
    double width_m;         /* plane, ellipsoid, box, wedge */
    double diameter_m;      /* sphere, cylinder, capsule, disc, cones, torus (> 2 height) */
    uint32_t position_kind; /* sonject_position_kind */
    uint32_t burial_kind;   /* sonject_burial_kind */
    double position_along;  /* see sonject_position_kind */
    double position_range;
    double heading_rad; /* from along-track (+x) towards range (+y), whichever side that is */
    double pitch_rad;   /* raises the nose */
    double roll_rad;    /* about the nose direction; as the heading, counted in the image: it raises
                           the left side to port, the right side to starboard */
    double burial_m;    /* depth of the lowest point below the seabed; negative: above it */
    sonject_material_params material;
    double height_m;         /* ellipsoid, box, wedge, cones, torus */
    double top_diameter_m;   /* truncated cone; 0: a cone; may be the larger one */
    double front_height_m;   /* wedge: at the nose, 0...height */
    uint32_t nose_end;       /* sonject_end, cylinder */
    uint32_t tail_end;       /* likewise */
    double nose_end_depth_m; /* of a spherical end, above 0...half the diameter; 0: half the
                                diameter, a half sphere. The length includes it */
    double tail_end_depth_m; /* likewise */
    double burial_fraction;  /* 0...1 of the height that the object has in its pose */
    double proud_height_m;   /* of the highest point above the seabed, 0...that height */
    uint32_t cut_count;      /* of cuts that count */
    uint32_t mesh;           /* number of a mesh of the scene */
    sonject_cut cuts[SONJECT_CUTS_CAPACITY];
    uint32_t user_shape; /* number of a user's shape of the scene */
    uint32_t level_kind; /* sonject_level_kind */
    double level_db;     /* not for SONJECT_LEVEL_PHYSICAL */
} sonject_object_params;

/* How the numbers of a mesh file are meant. */
typedef struct sonject_mesh_params {
    uint32_t struct_size;
    uint32_t allows_open; /* 1: a mesh with edges that do not join two triangles is taken as thin
                             sheets, which reflect on both sides; else it is refused */
    double unit_m;        /* m a unit of the file, above 0; 0.001 for mm */
    int32_t axes[3];      /* which axis of the file the object's x (nose), y and z axis is: 1, 2, 3,
                             negative: the reverse of it. Together a rotation, not a mirror. A file
                             whose y axis is up and whose nose is x: 1, -3, 2 */
    int32_t reserved;
    double smooth_angle_rad; /* 0...pi: facets that meet at less stand for one smooth surface where
                                sound is scattered (the rough part, and paths of several
                                interactions); 0: all facets are flat. Glints by physical optics
                                are always those of the facets */
} sonject_mesh_params;

/* Metres, the file's axes, closed meshes only, flat facets. */
SONJECT_API void sonject_mesh_params_init(sonject_mesh_params *mesh);

/* Where a part lies in its object. */
typedef struct sonject_part_params {
    uint32_t struct_size;
    uint32_t reserved;
    double along_m;     /* of the part's centre from the object's origin, along the object's nose */
    double across_m;    /* along its own y */
    double up_m;        /* along its own z */
    double heading_rad; /* of the part's nose, from the object's nose towards its own y */
    double pitch_rad;   /* raises the part's nose towards the object's own z */
    double roll_rad;    /* about the part's nose */
} sonject_part_params;

/* In the middle of the object, turned as the object is. */
SONJECT_API void sonject_part_params_init(sonject_part_params *part);

/* A proud sphere of 0.5 m diameter in the middle of the patch, default material. */
SONJECT_API void sonject_object_params_init(sonject_object_params *object);

SONJECT_END_DECLARATIONS

#endif
