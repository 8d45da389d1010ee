/* Records that host and device share. Four-byte members only, so no compiler pads them; the host
 * asserts every size (lib/trace/tracer.c and its neighbours). */
#ifndef SONJECT_KERNELS_LAYOUT_H
#define SONJECT_KERNELS_LAYOUT_H

/* Types of their members, of the sums, and of places in these. */
#ifdef __OPENCL_C_VERSION__
#define RECORD_INT  int
#define RECORD_WORD uint
#define TALLY       long
#define PLACE       long
#else
#include <stdint.h>
#define RECORD_INT  int32_t
#define RECORD_WORD uint32_t
#define TALLY       int64_t
#define PLACE       int64_t
#endif

/* Programs are built in two variants. Most scenes are plain: they have neither meshes nor relief
 * nor fouling, nor targets in layers that bend sound, and trace up to a tenth faster without. */
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

/* What a random number is for; part of its key. */
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
    STREAM_IMAGE_ROUGH_RAYS = 1048576, /* likewise */
    STREAM_MULTIBOUNCE_RAYS = 2097152, /* likewise; the sonar alone is pair 0 */
    STREAM_SECOND_ORDER = 4194304,     /* + object */
    STREAM_FOULING = 536870912,        /* + object */
    STREAMS_OF_PAIR = 1024
};

/* Bits that a work-item reports; any of them fails the run. */
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

/* What a surface does with sound; the record of a sonject_material_params. */
struct surface_record {
    RECORD_INT reflection_kind;
    float reflection;    /* amplitude; CONSTANT */
    float density_ratio; /* FLUID */
    float index_real;    /* FLUID: square of the refractive index k2/k, real and imaginary part */
    float index_imaginary;
    float roughness_phase;  /* 2 k eta: P = roughness_phase * cos(angle) */
    float lambert;          /* mu */
    float lambert_exponent; /* n >= 1 */
    float glossy_albedo;
    float glossy_slope; /* rms */
    RECORD_INT
    rough_is_apart; /* the rough part is not what roughness takes from the specular part (sediment
                       returns sound from its volume too); the specular part gives way to it */
};

/* An end of a cylinder, counted outwards from the object's centre along its axis. */
enum end_number {
    END_NOSE = 0, /* towards +x */
    END_TAIL = 1,
    ENDS = 2
};

struct end_record {
    float joint;     /* m: where the straight part ends */
    float depth;     /* m: of the part of a sphere beyond it; 0: flat */
    float curvature; /* 1/m: of that sphere */
    RECORD_INT is_open;
};

/* One object without parts, or one part, in the frame of a launch: `objects` are these wherever the
 * kernels count them. */
struct object_record {
    RECORD_INT shape;                   /* enum shape_kind (shapes/shapes.h) */
    float centre_x, centre_y, centre_z; /* m, in the frame */
    float axes[9]; /* rows: the object's own x (nose), y and z axis in frame coordinates */
    /* Sizes. Which of them a shape has, and which of its radii are meant, its file in shapes/
     * says. */
    float half_length; /* m, along x */
    float half_width;  /* m, along y */
    float half_height; /* m, along z */
    float radius;      /* m */
    float ring_radius; /* m */
    /* of a slanted face's unit normal: */
    float slant_across;    /* its component along x or away from the z axis */
    float slant_up;        /* its z component */
    float slant_offset;    /* m: of that face from the centre */
    float bounding_radius; /* m, about the centre */
    struct end_record ends[ENDS];
    RECORD_WORD mesh_words; /* mesh: where its mesh_record is, in 4-byte words from this record */
    RECORD_WORD fouling_words; /* where its fouling_record is, likewise; 0: it has none */
    RECORD_WORD tree_words; /* of the first record: where the object_tree_record of all objects is,
                               likewise; 0: there is none */
    struct surface_record surface;
    /* Where the object's echoes and shadow are tallied, in the tile buffer (incoherent part). */
    RECORD_WORD tile_offset;     /* first element */
    RECORD_INT tile_first_strip; /* strips of the launch's track */
    RECORD_INT tile_strips;
    RECORD_INT tile_first_bin; /* bins of the launch's grid, whose first is 0 */
    RECORD_INT tile_bins;
};

/* Planes of an object's tile, one after the other. */
enum tile_plane {
    TILE_ENERGY = 0,    /* expected cross-section of its echoes, in quanta */
    TILE_FOOTPRINT = 1, /* number of rays that hit it */
    TILE_LOST = 2,      /* seabed energy that it hides, in quanta */
    TILE_PLANES = 3
};

/* Where the rays of a source are that layers of water bend: pieces of elevation, each a cubic.
 * Behind those of the straight water lie, slice by slice, the slice itself (its offset: height of
 * its bottom in the frame, its sound speed over the straight water's, the reciprocal) and as many
 * pieces twice: offsets, with the spreading, and in the same place ranges. */
struct ray_table_record {
    RECORD_INT pieces; /* 0: no layers, rays are straight */
    RECORD_INT slices; /* layers that targets reach into, the straight water included */
    RECORD_INT first_piece;
    float first_elevation; /* rad from the central direction */
    float pieces_per_radian, radians_per_piece;
    float ground_range; /* m, horizontal, from the track to the frame's origin */
};

/* Coefficients in the share 0...1 of the piece that lies below a ray's elevation. */
struct ray_piece_record {
    float offset[4]; /* of the ray from the frame's origin, m */
    float range;     /* at the lower end, less the reference range, m */
    float spreading, spreading_growth;
};

#define ASPECT_TERMS 15

/* The aspects of a synthetic aperture, over which seabed and rough surfaces are integrated. */
struct aspects_record {
    float sine;  /* of the largest angle off broadside; 0: broadside alone */
    float end;   /* range where the patch ends, less the reference range, m */
    float scale; /* 1 / the mean square of the window */
    RECORD_INT terms;
    float weights[ASPECT_TERMS]; /* the window is 1 + sum of weights[m-1] * cos(2 pi m offset) */
    /* Squinted rays meet things in other strips than their own. Strips of the whole track: */
    RECORD_INT tally_first_strip, tally_strips; /* whose seabed is tallied */
    RECORD_INT core_first_strip, core_strips;   /* whose rays tally objects */
};

/* The two-way beam of a real aperture: rays leave from where each ping is. */
struct beam_record {
    float reach;  /* direction cosine off the beam's middle, along the array's long side, that
                     rays go out to; 0: no beam */
    float length; /* of the array's sides, in wavelengths */
    float height;
    float along[3];  /* unit, of the long side, in the frame */
    float across[3]; /* unit, of the other side */
};

/* A fan of rays over a track, in a frame that the host centres on what is traced. The sonar moves
 * along y = z = -reference_range * (0, cos, -sin)(depression) of that frame; where layers bend the
 * rays it only seems to. Ranges are travel times times the sound speed around the origin. */
struct fan_record {
    float reference_range;                    /* m, from the track to the frame's origin */
    float cosine_depression, sine_depression; /* of the direction from the track to the origin */
    float seabed_height;                      /* z of the mean seabed in the frame, m */
    float first_strip_x;                      /* x of the middle of strip 0, m */
    float strip_width;                        /* m */
    float first_elevation;  /* lower edge of the fan, rad from the central direction, upward */
    float elevation_step;   /* rad a ray; of rays that have edges of their own the widest */
    float edge_across;      /* wavelengths that half the path changes across a cell, up to which
                               what edges lose by it is made up */
    RECORD_WORD rays;       /* in elevation, a strip and along-track stratum */
    RECORD_WORD first_ray;  /* number of the first for random numbers, so that a window's rays are
                               those of the patch */
    RECORD_WORD strata;     /* along-track strata of a strip */
    RECORD_INT first_strip; /* number of the first strip of this launch; strips are numbered over
                               the whole track, so that chunks change nothing */
    RECORD_INT strips;      /* of this launch */
    RECORD_INT track_strip; /* number of the track's strip 0 in the whole patch, for the random
                               numbers of a window */
    float bins_per_metre;   /* of true range; processor range scales it */
    float bin_at_reference; /* bin coordinate of reference_range; the grid's first bin is 0 */
    RECORD_INT bins;        /* of the grid */
    float source_side;      /* m; 0: the source is a point at the receiver */
    float seabed_lambert;   /* mu0; 0: no seabed energy wanted */
    float quanta;           /* quanta per m^2 (energy) or per m (amplitude), a power of two */
    RECORD_INT map_rows, map_columns; /* of the reflectivity map; 0: uniform */
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
                                surface, -1 the seabed, -2 any */
    RECORD_INT target;       /* record of the part, or the object's first one (second_order.h) */
    RECORD_INT is_sample;    /* not rays but samples of the object's paths of second order */
    RECORD_INT segments;     /* groups of work-items that share a strip */
    RECORD_INT strip_stride; /* from a group's strip to the next one's, see strip_of_group */
    RECORD_INT first_turn;   /* of the strips in that order: where this call begins */
    struct ray_table_record table;
    RECORD_WORD relief_words; /* where the relief_record is, in words from the first object's
                                 record; 0: the seabed is the plane */
    float relief_x, relief_y; /* m, of its first grid point in the frame */
    struct aspects_record aspects;
    struct beam_record beam;
};

/* Sixteen spheres, to be tested at once; radius 0: none. */
struct sphere_group {
    float centre_x[16], centre_y[16], centre_z[16], radius[16];
};

/* A sphere around a part of a target; a target lies within the union of its spheres. */
struct sphere_record {
    float centre_x, centre_y, centre_z; /* m, in the frame */
    float radius;
};

#define LEAST_WEIGHT 0.02f /* of targets, below which none of a cell's samples begin on them */

/* A part as paths of second order begin on it. Ranges are less the reference range. */
struct target_record {
    float centre_x;             /* m, in the frame */
    float range, nearest_range; /* m, of its centre, and no later than any echo by way of it */
    float square_radius;        /* m^2, of the sphere around it */
    float first_x, width;       /* m; the window that it fills as seen from the sonar */
    float first_elevation, elevations; /* rad */
    float least_y;                     /* m; of seabed that it exchanges sound with */
    float top;                         /* m, over the seabed */
    float weight; /* m^2; over the square of the way to the seabed: about what it brings to a cell
                     over what the seabed returns, in units of what needs all samples */
    float rays;   /* of its fan, per m rad of wavefront */
    RECORD_INT part;
    RECORD_INT first_target, targets; /* the object's */
    RECORD_INT first_cell, cells;     /* of the output, that the object's samples end in */
};

enum chain_estimator {
    CHAINS_CONNECT = 0,    /* every hit is connected to the source */
    CHAINS_BRUTE_FORCE = 1 /* a path counts when it meets the source's rectangle by itself */
};

#define CHAIN_ORDERS_MAX 8

/* How chains of several interactions are walked and where their echoes are tallied: for each order
 * a plane of the whole track's strips times bins. */
struct chain_record {
    RECORD_INT interactions; /* most surfaces that a path may meet */
    RECORD_INT estimator;
    RECORD_INT is_focused;     /* echoes go to the mean of first and last hit, else to the first */
    RECORD_INT is_reciprocal;  /* focused, and the source is a point at the receiver: a path between
                                  seabed and target found one way also stands for its reverse */
    RECORD_INT forward_is_map; /* the seabed's lambert part is times the map */
    RECORD_INT spheres;        /* of targets */
    RECORD_INT groups;         /* that they lie in where they are many (many_targets.h), else 0 */
    float seabed_share;     /* of the seabed's rays that are followed, over the sum of the targets'
                               openings as seen from there; 0: all are */
    RECORD_INT first_order; /* lowest that is tallied */
    float finer[CHAIN_ORDERS_MAX]; /* [k - 1]: quanta per m^2 of order k + 1, which brings less,
                                      over those of order k; powers of two */
    RECORD_INT tally_first_strip;
    RECORD_INT tally_strips;
    /* Paths of second order, between seabed and target (second_order.h): */
    RECORD_WORD target_words; /* where the targets' records are, in words from the first sphere */
    RECORD_INT cell_samples;  /* of each range cell of a strip; 0: fans find these paths */
    RECORD_INT cell_bins;     /* of a cell; cell 0 has its middle in the patch's bin 0 */
    RECORD_INT first_bin;     /* of the grid, on the patch's numbering */
    struct surface_record seabed;
    float sea_surface_height; /* z in the frame, m; 0: chains do not meet the sea surface */
    struct surface_record sea_surface;
};

/* The plane boundaries that sound may meet on its way; both are level. */
enum boundary {
    BOUNDARY_SEABED = 0,
    BOUNDARY_SURFACE = 1,
    BOUNDARIES = 2
};

struct boundary_record {
    float height;      /* z of the plane in the frame, m */
    float speed_ratio; /* of the water at the boundary over that around the object */
    struct surface_record surface;
};

/* The sonar or one of its images in the boundaries: it moves along
 * y = z = -range * (0, cos, -sin)(depression) of the frame. */
struct source_record {
    float range;                              /* m, from its track to the frame's origin */
    float cosine_depression, sine_depression; /* sine < 0: the source is below the origin */
    RECORD_INT bounces; /* boundaries that fold the straight line from the source to an object */
    RECORD_INT last_boundary; /* enum boundary: the one next to the object; they alternate */
    struct ray_table_record table;
};

/* Two sources between which an object carries sound. The launch's fan goes out from `outgoing`; its
 * bin_at_reference and first_cycles belong to half the path by way of the frame's origin. */
struct image_pair_record {
    struct source_record outgoing, returning;
    struct boundary_record boundaries[BOUNDARIES];
    float echoes; /* 2 where the reverse path is an echo of its own, else 1 */
};

/* How paths over several smooth faces are followed. */
struct multibounce_record {
    RECORD_INT interactions; /* most surfaces that a path may meet between its sources */
    RECORD_INT is_focused;   /* echoes go to the mean of first and last hit, else to the first */
    struct surface_record seabed; /* a boundary between two hits; else without a smooth part */
};

/* One echo of such a path. */
struct multibounce_echo_record {
    RECORD_INT strip; /* of the whole track */
    RECORD_INT bin;
    float real_part, imaginary_part; /* quanta */
    float fraction;                  /* of a bin beyond `bin` */
    float chance;                    /* of rounding up, as in tally.h */
};

/* What a work-item counted. */
struct outcome_record {
    RECORD_WORD queries; /* rays and visibility tests */
    RECORD_WORD impulses;
    RECORD_WORD faults;
    RECORD_WORD rays; /* that were followed */
};

/* The bins, or columns, of a line that may hold anything but zeros, from first on to before end. */
struct filled_span {
    RECORD_INT first, end;
};

/* Waves whose sum is a random field of an object's fouling. */
#define FOULING_WAVES 12

struct fouling_wave {
    float x, y, z; /* cycles per m, in the frame's axes */
    float phase;   /* cycles, at the centre of the object or part */
};

struct fouling_record {
    float albedo_gain; /* nepers of energy that a wave adds at its crest; 0: albedo is even */
    float albedo_peak; /* the albedo where all crests meet */
    float slope_gain;  /* slope of a wave of one cycle per m at its steepest, m; 0: no relief */
    struct fouling_wave albedo[FOULING_WAVES];
    struct fouling_wave relief[FOULING_WAVES]; /* phase: of its slope */
};

/* How many spheres around targets there may be. */
#define FEW_SPHERES_MAX    128 /* more lie in groups (many_targets.h) */
#define SPHERES_OF_GROUP   16
#define TARGET_SPHERES_MAX 1280
#define TARGET_GROUPS_MAX  (TARGET_SPHERES_MAX / SPHERES_OF_GROUP)

/* The seabed's relief: heights over the mean seabed on a level grid, rows along-track, columns in
 * ground range; 0 outside. */
#define RELIEF_BLOCK 8 /* cells of a block each way */

/* Behind it lie rows x columns heights (m), as many pairs of slopes (along-track, in range), and
 * block_rows x block_columns pairs of the highest and lowest point of a block. */
struct relief_record {
    RECORD_INT rows, columns; /* grid points, at least 2 each */
    RECORD_INT block_rows, block_columns;
    float rows_per_metre, columns_per_metre;
    float lowest, highest; /* m: a little beyond all heights */
};

/* The hierarchy over many objects. */
#define OBJECTS_IN_LOOP    16 /* so many or fewer are tested one after the other */
#define OBJECTS_IN_PACKET  40 /* likewise, by rays that run apart from each other */
#define OBJECT_TREE_SLOTS  16 /* children of a branch */
#define OBJECT_TREE_LEVELS 6  /* most branches from the root to an object, the root included */

/* Boxes are padded by this fraction of the distance from which rays may come: more than the
 * rounding of all tests (MATH.md, "Many objects"). */
#define OBJECT_TREE_PADDING 3.814697265625e-6f /* 2^-18 */

/* Boxes of the children, about the tree's middle, m. */
struct object_branch {
    float lower_x[OBJECT_TREE_SLOTS], lower_y[OBJECT_TREE_SLOTS], lower_z[OBJECT_TREE_SLOTS];
    float upper_x[OBJECT_TREE_SLOTS], upper_y[OBJECT_TREE_SLOTS], upper_z[OBJECT_TREE_SLOTS];
    RECORD_INT child[OBJECT_TREE_SLOTS]; /* >= 0: number of a branch; < 0: ~ number of an object */
};

/* Its branches lie behind it, the root first. */
struct object_tree_record {
    float middle_x, middle_y, middle_z; /* m, in the frame */
    float farthest; /* m from the middle: rays that start farther away test every object */
    float slack;    /* m: more than the rounding of distances */
    float grain;    /* m: rays no further apart than this are tested together */
    float radius;   /* m about the middle: holds every box */
    RECORD_INT branches;
};

#endif
