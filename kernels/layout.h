/* The records that host and device share. All members have four bytes, so no compiler pads them.
 * The host asserts every size (lib/trace/tracer.c and its neighbours).
 *
 * A launch runs one kernel over strips of the track, in a frame of coordinates that the host
 * centres on what is traced. A strip is a piece of the track within a row of pixels, a bin a piece
 * of range within a pixel. A window is the piece of the patch that is traced, and a chunk the
 * strips of one launch. A part is one shape of an object. A tile holds the sums of one object,
 * counted in quanta, the units of integer sums. */
#ifndef SONJECT_KERNELS_LAYOUT_H
#define SONJECT_KERNELS_LAYOUT_H

/* The types of the members, of sums (TALLY) and of indices into large arrays (LONG_INDEX). */
#ifdef __OPENCL_C_VERSION__
#define RECORD_INT  int
#define RECORD_WORD uint
#define TALLY       long
#define LONG_INDEX  long
#else
#include <stdint.h>
#define RECORD_INT  int32_t
#define RECORD_WORD uint32_t
#define TALLY       int64_t
#define LONG_INDEX  int64_t
#endif

/* Programs are built in two variants. The plain one suits most scenes: no meshes, no relief, no
 * fouling, no targets in layers that bend sound. It traces up to a tenth faster. */
#ifdef PLAIN
#define HAS_MESHES  0
#define HAS_RELIEF  0
#define HAS_FOULING 0
#define HAS_SLICES  0
#else
#define HAS_MESHES  1
#define HAS_RELIEF  1
#define HAS_FOULING 1
#define HAS_SLICES  1
#endif

/* The purposes of random numbers. A purpose is part of the number's key. */
enum random_stream {
    STREAM_ROUGH_RAYS = 1,
    STREAM_SEABED_SPECKLE = 2,
    STREAM_NOISE = 3,
    STREAM_INPUT_PHASE = 4,
    STREAM_CHAIN_SPECKLE = 5,
    STREAM_LOOKS = 8,            /* + 3 * (look - 1) + 0...2: phase, noise, targets; 63 looks */
    STREAM_OBJECT_SPECKLE = 256, /* + object */
    STREAM_SMOOTH_RAYS = 1024,   /* + part */
    STREAM_CHAIN_RAYS = 2050,    /* + first surface: part, -1 the seabed, -2 any */
    STREAM_IMAGE_RAYS = 4096,    /* + STREAMS_OF_PAIR * number of the pair of sources + part */
    STREAM_IMAGE_ROUGH_RAYS = 1048576, /* + the same offset */
    STREAM_MULTIBOUNCE_RAYS = 2097152, /* + the same offset; the sonar alone is pair 0 */
    STREAM_SECOND_ORDER = 4194304,     /* + object */
    STREAM_FOULING = 536870912,        /* + object */
    STREAMS_OF_PAIR = 1024
};

/* The faults that a work-item reports, as bits. Any fault fails the run. */
enum fault {
    FAULT_NOT_A_NUMBER = 1,
    FAULT_OVERFLOW = 2,
    FAULT_OUTSIDE_TILE = 4
};

enum reflection_kind {
    REFLECTION_NONE = 0, /* no smooth part */
    REFLECTION_CONSTANT = 1,
    REFLECTION_FLUID = 2
};

/* The reflection and scattering of a surface, made from a sonject_material_params. */
struct surface_record {
    RECORD_INT reflection_kind;
    float reflection;    /* CONSTANT: the amplitude */
    float density_ratio; /* FLUID: its density over the water's */
    float index_real;    /* FLUID: square of the refractive index k2/k, real and imaginary part */
    float index_imaginary;
    float roughness_phase;  /* 2 k eta: P = roughness_phase * cos(angle) */
    float lambert;          /* mu */
    float lambert_exponent; /* n >= 1 */
    float glossy_albedo;
    float glossy_slope; /* rms */
    RECORD_INT
    rough_is_apart; /* 1: the rough part does not come from what roughness takes from the specular
                       part (sediment returns sound from its volume); the rough albedo is taken off
                       the specular part */
};

enum end_number {
    END_NOSE = 0, /* towards +x */
    END_TAIL = 1,
    ENDS = 2
};

struct end_record {
    float joint; /* outward distance from the object's centre to the end of the straight part, m */
    float depth; /* depth of the spherical cap beyond the joint, m; 0: flat */
    float curvature; /* curvature of the cap, 1/m */
    RECORD_INT is_open;
};

/* One part of an object, or an object without parts, in the frame of a launch. The `objects` that
 * kernels count are these records. */
struct object_record {
    RECORD_INT shape;                   /* enum shape_kind (shapes/shapes.h) */
    float centre_x, centre_y, centre_z; /* m, in the frame */
    float axes[9]; /* rows: the object's own x (nose), y and z axis in frame coordinates */
    /* The sizes. The shape's file in shapes/ says which ones it has and what its radii are. */
    float half_length; /* m, along x */
    float half_width;  /* m, along y */
    float half_height; /* m, along z */
    float radius;      /* m */
    float ring_radius; /* m */
    /* The slanted face of a wedge or cone: */
    float slant_across;    /* unit normal's component along x or away from the z axis */
    float slant_up;        /* unit normal's z component */
    float slant_offset;    /* distance from the centre, m */
    float bounding_radius; /* m, about the centre */
    struct end_record ends[ENDS];
    RECORD_WORD mesh_words; /* a mesh only: offset of its mesh_record from here, in 4-byte words */
    RECORD_WORD fouling_words; /* offset of its fouling_record, in the same words; 0: none */
    RECORD_WORD tree_words; /* first record only: offset of the object_tree_record of all objects,
                               in the same words; 0: none */
    struct surface_record surface;
    /* The object's tile for echoes and shadow, in the tile buffer (incoherent part). */
    RECORD_WORD tile_offset;     /* index of its first element */
    RECORD_INT tile_first_strip; /* number of a strip of the launch's track */
    RECORD_INT tile_strips;
    RECORD_INT tile_first_bin; /* number of a bin; the launch's first bin is 0 */
    RECORD_INT tile_bins;
};

/* The planes of an object's tile, one behind the other. */
enum tile_plane {
    TILE_ENERGY = 0,    /* expected cross-section of its echoes, in quanta */
    TILE_FOOTPRINT = 1, /* number of rays that hit it */
    TILE_LOST = 2,      /* seabed energy that it hides, in quanta */
    TILE_PLANES = 3
};

/* The rays of a source where layers of water bend them: pieces of elevation, each a cubic. A slice
 * is a layer that targets reach into; the lowest one is the straight water. The pieces of the
 * straight water come first. Behind them lie, for each higher slice, a record of its own, then
 * pieces of offset and spreading, then as many pieces with ranges as their offset. A slice's own
 * record holds in `offset` the height of its bottom in the frame, its sound speed over the straight
 * water's, and the reciprocal. */
struct ray_table_record {
    RECORD_INT pieces; /* 0: there are no layers, and rays are straight */
    RECORD_INT slices; /* number of slices, with the straight water */
    RECORD_INT first_piece;
    float first_elevation; /* rad from the central direction */
    float pieces_per_radian, radians_per_piece;
    float ground_range; /* horizontal distance from the track to the frame's origin, m */
};

/* One piece of a ray table. The variable is the share 0...1 of the piece below the elevation. */
struct ray_piece_record {
    float offset[4]; /* coefficients of the ray's offset from the frame's origin, m */
    float range;     /* range at the piece's lower edge less the reference range, m */
    float spreading, spreading_growth;
};

#define ASPECT_TERMS 15

/* The aspects of a synthetic aperture, over which seabed and rough surfaces are integrated. */
struct aspects_record {
    float sine;  /* sine of the largest angle off broadside; 0: broadside only */
    float end;   /* range where the patch ends, less the reference range, m */
    float scale; /* 1 / the mean square of the window */
    RECORD_INT terms;
    float weights[ASPECT_TERMS]; /* the window is 1 + sum of weights[m-1] * cos(2 pi m offset) */
    /* Squinted rays meet things in strips other than their own. Strips of the whole track: */
    RECORD_INT tally_first_strip, tally_strips; /* strips whose seabed is tallied */
    RECORD_INT core_first_strip, core_strips;   /* strips whose rays tally objects */
};

/* The two-way beam of a real aperture. Its rays leave from the place of each ping. */
struct beam_record {
    float reach;     /* largest direction cosine of rays along the array's long side, off the beam's
                        middle; 0: no beam */
    float length;    /* the array's long side, in wavelengths */
    float height;    /* the array's other side, in wavelengths */
    float along[3];  /* unit vector of the long side, in the frame */
    float across[3]; /* unit vector of the other side, in the frame */
};

/* A fan of rays over a track, in a frame that the host centres on what is traced. In this frame the
 * sonar moves along (y, z) = (-cos, sin)(depression) * reference_range. Where layers bend the rays,
 * it only seems to. Ranges are travel times multiplied by the sound speed around the origin. */
struct fan_record {
    float reference_range;                    /* m, from the track to the frame's origin */
    float cosine_depression, sine_depression; /* depression from the track to the origin */
    float seabed_height;                      /* z of the mean seabed in the frame, m */
    float first_strip_x;                      /* x of the middle of strip 0, m */
    float strip_width;                        /* m */
    float first_elevation; /* lower edge of the fan, rad from the central direction, upward */
    float elevation_step;  /* rad a ray; the widest step where rays have edges of their own */
    float edge_across; /* wavelengths that half the path changes across a cell, up to which the loss
                          at edges is made up */
    RECORD_WORD rays;  /* number of rays in elevation, for each strip and stratum */
    RECORD_WORD first_ray;  /* number of the first ray in the whole patch, for random numbers, so
                               that a window has the patch's rays */
    RECORD_WORD strata;     /* along-track parts of a strip, each with its own rays */
    RECORD_INT first_strip; /* number of the first strip of this launch, counted on the whole track
                               so that chunks change nothing */
    RECORD_INT strips;      /* number of strips of this launch */
    RECORD_INT track_strip; /* number of the track's strip 0 in the whole patch, for the random
                               numbers of a window */
    float bins_per_metre;   /* bins per m of true range; they divide processor range evenly */
    float bin_at_reference; /* bin coordinate of reference_range; the grid's first bin is 0 */
    RECORD_INT bins;        /* number of bins of the grid */
    float source_side;      /* side of the square source, m; 0: a point at the receiver */
    float seabed_lambert;   /* mu0; 0: no seabed energy is wanted */
    float quanta;           /* quanta per m^2 (energy) or per m (amplitude), a power of two */
    RECORD_INT map_rows, map_columns; /* size of the reflectivity map; 0: uniform */
    float map_row_at_origin;          /* map row at x = 0 of the frame */
    float map_rows_per_metre;
    float map_column_at_reference; /* map column of reference_range */
    float map_columns_per_metre;
    float cycles_per_metre; /* 2 / wavelength: phase of a two-way path, in cycles per m of range */
    float first_cycles;     /* phase at reference_range, a fraction of a cycle */
    float inverse_wavelength; /* 1/m */
    RECORD_WORD seed_low, seed_high, stream;
    RECORD_INT objects;
    RECORD_INT only_object;  /* smooth part: the object whose glints are wanted; chains: the first
                                surface, -1 for the seabed, -2 for any */
    RECORD_INT target;       /* index of the target_record: the part's, or the object's first one */
    RECORD_INT is_sample;    /* 1: samples of the object's second-order paths, not rays */
    RECORD_INT segments;     /* number of groups of work-items that share a strip */
    RECORD_INT strip_stride; /* step from a group's strip to the next one's (strip_of_group) */
    RECORD_INT first_turn;   /* number of the first turn of this call, in the order of the stride */
    struct ray_table_record table;
    RECORD_WORD relief_words; /* offset of the relief_record from the first object's record, in
                                 words; 0: the seabed is a plane */
    float relief_x, relief_y; /* place of the relief's first grid point in the frame, m */
    struct aspects_record aspects;
    struct beam_record beam;
};

/* Sixteen spheres that are tested at once. A radius of 0 marks an empty slot. */
struct sphere_group {
    float centre_x[16], centre_y[16], centre_z[16], radius[16];
};

/* A sphere around a part of a target. A target lies within the union of its spheres. */
struct sphere_record {
    float centre_x, centre_y, centre_z; /* m, in the frame */
    float radius;
};

#define LEAST_WEIGHT 0.02f /* least weight of a target at which samples of a cell begin on it */

/* A part on which second-order paths begin. Ranges are less the reference range. */
struct target_record {
    float centre_x;             /* m, in the frame */
    float range, nearest_range; /* m: its centre's, and one before all echoes by way of it */
    float square_radius;        /* squared radius of the sphere around it, m^2 */
    float first_x, width; /* m: the window that it fills along-track, as seen from the sonar */
    float first_elevation, elevations; /* rad: the same window in elevation */
    float least_y;                     /* least y of the seabed that exchanges sound with it, m */
    float top;                         /* height over the seabed, m */
    float weight; /* m^2: divided by the squared distance to the seabed, about its echo over the
                     seabed's, where 1 needs all samples (struct target_weights) */
    float rays;   /* rays of its fan per m rad of wavefront */
    RECORD_INT part;
    RECORD_INT first_target, targets; /* the target_records of its object */
    RECORD_INT first_cell, cells;     /* the output's cells in which its object's samples end */
};

enum chain_estimator {
    CHAINS_CONNECT = 0,    /* every hit is connected to the source */
    CHAINS_BRUTE_FORCE = 1 /* a path counts when it meets the source's rectangle by itself */
};

#define CHAIN_ORDERS_MAX 8

/* The rules for chains of several interactions, and the place of their tallies. Each order has a
 * plane of the whole track's strips times bins. */
struct chain_record {
    RECORD_INT interactions; /* the most surfaces that a path may meet */
    RECORD_INT estimator;
    RECORD_INT is_focused; /* 1: echoes go to the mean of first and last hit, 0: to the first */
    /* 1: a path between seabed and target that is found one way also stands for its reverse. Echoes
     * are then focused, and the source is a point at the receiver. */
    RECORD_INT is_reciprocal;
    RECORD_INT forward_is_map; /* 1: the map scales the seabed's rough part */
    RECORD_INT spheres;        /* number of spheres around targets */
    RECORD_INT groups;         /* groups of spheres where they are many (many_targets.h), else 0 */
    float seabed_share;        /* share of the seabed's rays that are followed, over the sum of the
                                  targets' openings seen from there; 0: all are followed */
    RECORD_INT first_order;    /* lowest order that is tallied */
    float finer[CHAIN_ORDERS_MAX]; /* [k - 1]: quanta per m^2 of order k + 1 over those of order k,
                                      which brings more; powers of two */
    RECORD_INT tally_first_strip;
    RECORD_INT tally_strips;
    /* Second-order paths, between seabed and target (second_order.h): */
    RECORD_WORD target_words; /* offset of the target_records from the first sphere, in words */
    RECORD_INT cell_samples;  /* samples of each range cell of a strip; 0: fans find these paths */
    RECORD_INT cell_bins;     /* bins of a cell; the middle of cell 0 is the patch's bin 0 */
    RECORD_INT first_bin;     /* number of the grid's first bin in the patch */
    struct surface_record seabed;
    float sea_surface_height; /* z in the frame, m; 0: chains do not meet the sea surface */
    struct surface_record sea_surface;
};

/* The level boundaries that sound may meet on its way. */
enum boundary {
    BOUNDARY_SEABED = 0,
    BOUNDARY_SURFACE = 1,
    BOUNDARIES = 2
};

struct boundary_record {
    float height;      /* z of the plane in the frame, m */
    float speed_ratio; /* sound speed at the boundary over that around the object */
    struct surface_record surface;
};

/* The sonar or one of its images in the boundaries. In the frame the source moves along the line
 * (y, z) = (-cos, sin)(depression) * range. */
struct source_record {
    float range;                              /* distance from its track to the frame's origin, m */
    float cosine_depression, sine_depression; /* sine < 0: the source is below the origin */
    RECORD_INT bounces; /* boundaries that fold the straight line from the source to an object */
    RECORD_INT last_boundary; /* enum boundary: the one next to the object; both alternate */
    struct ray_table_record table;
};

/* Two sources between which an object carries sound. The launch's fan leaves `outgoing`. Its
 * bin_at_reference and first_cycles are those of half the path by way of the frame's origin. */
struct image_pair_record {
    struct source_record outgoing, returning;
    struct boundary_record boundaries[BOUNDARIES];
    float echoes; /* 2 where the reverse path is an echo of its own, else 1 */
};

/* The rules for paths over several smooth faces. */
struct multibounce_record {
    RECORD_INT interactions; /* the most surfaces that a path may meet between its sources */
    RECORD_INT is_focused;   /* 1: echoes go to the mean of first and last hit; 0: to the first */
    struct surface_record seabed; /* the boundary between two hits; no smooth part: none */
};

/* One echo of a path over several smooth faces. */
struct multibounce_echo_record {
    RECORD_INT strip; /* number on the whole track */
    RECORD_INT bin;
    float real_part, imaginary_part; /* quanta */
    float fraction;                  /* share of a bin beyond `bin` */
    float dither;                    /* uniform deviate for rounding (tally.h) */
};

/* The counts of a work-item. */
struct outcome_record {
    RECORD_WORD queries; /* rays and visibility tests */
    RECORD_WORD impulses;
    RECORD_WORD faults;
    RECORD_WORD rays; /* rays that were followed */
};

/* The bins or columns of a line that may hold anything but zeros: first...end - 1. */
struct filled_span {
    RECORD_INT first, end;
};

/* The number of waves whose sum is a random field of an object's fouling. */
#define FOULING_WAVES 12

struct fouling_wave {
    float x, y, z; /* cycles per m, in the frame's axes */
    float phase;   /* cycles, at the centre of the object or part */
};

struct fouling_record {
    float albedo_gain; /* nepers of energy that a wave adds at its crest; 0: albedo is even */
    float albedo_peak; /* the albedo where all crests meet */
    float slope_gain;  /* largest slope of a wave of one cycle per m, m; 0: no relief */
    struct fouling_wave albedo[FOULING_WAVES];
    struct fouling_wave relief[FOULING_WAVES]; /* the phases are those of slopes */
};

/* The largest numbers of spheres around targets. */
#define FEW_SPHERES_MAX    128 /* more spheres lie in groups (many_targets.h) */
#define SPHERES_OF_GROUP   16
#define TARGET_SPHERES_MAX 1280
#define TARGET_GROUPS_MAX  (TARGET_SPHERES_MAX / SPHERES_OF_GROUP)

#define RELIEF_BLOCK 8 /* cells of a block of the relief, each way */

/* The seabed's relief: heights over the mean seabed on a level grid, 0 outside; rows along-track,
 * columns in ground range. Behind the record lie rows x columns heights (m), as many pairs of
 * slopes (along-track, in range), and block_rows x block_columns pairs of a block's highest and
 * lowest point. */
struct relief_record {
    RECORD_INT rows, columns; /* grid points, at least 2 each */
    RECORD_INT block_rows, block_columns;
    float rows_per_metre, columns_per_metre;
    float lowest, highest; /* m; a little beyond all heights */
};

/* Boxes lie in rows of one face each: the lower faces along x, y, z, then the upper ones. */
#define BOX_FACES 6

/* The hierarchy over many objects. */
#define OBJECTS_IN_LOOP    16 /* up to this number, objects are tested one after the other */
#define OBJECTS_IN_PACKET  40 /* limit for rays that run apart from each other */
#define OBJECT_TREE_SLOTS  16 /* children of a branch */
#define OBJECT_TREE_LEVELS 6  /* most branches from the root to an object, the root included */

/* The padding of boxes, as a share of the distance from which rays may come. It exceeds the
 * rounding of all tests (MATH.md, "Many objects"). */
#define OBJECT_TREE_PADDING 3.814697265625e-6f /* 2^-18 */

/* A branch of the hierarchy: the boxes of its children about the tree's middle, m. */
struct object_branch {
    float faces[BOX_FACES][OBJECT_TREE_SLOTS];
    RECORD_INT child[OBJECT_TREE_SLOTS]; /* >= 0: number of a branch; < 0: ~ number of an object */
};

/* The hierarchy over many objects. Its branches lie behind the record, the root first. */
struct object_tree_record {
    float middle_x, middle_y, middle_z; /* m, in the frame */
    float farthest; /* m from the middle; rays that start farther away test every object */
    float slack;    /* m; more than the rounding of distances */
    float grain;    /* m; rays no further apart than this are tested together */
    float radius;   /* m about the middle; holds every box */
    RECORD_INT branches;
};

#endif
