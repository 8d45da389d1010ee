/* A scene's parameters as structures, in SI units. The tables of keys (lib/schema) fill them. A
 * key's row gives its meaning, unit, range, default and member; the comments here add the rest. */
#ifndef SONJECT_SCENE_PARAMS_H
#define SONJECT_SCENE_PARAMS_H

#include <stdbool.h>
#include <stdint.h>

#include <sonject/elements.h>
#include <sonject/result.h>
#include <sonject/scene.h>

#include "kernels/shapes/shapes.h"

/* Sonar images: the meaning of pixels and their places on the seabed. */

/* The side of the track that the image shows. */
typedef enum sonject_side {
    SONJECT_SIDE_PORT = 0,
    SONJECT_SIDE_STARBOARD = 1
} sonject_side;

/* The geometry of an image. Rows are track positions, columns slant range. Pixel (n, j) is centred
 * on track position first_along_track_m + n * row_spacing_m and on slant range first_slant_range_m
 * + j * column_spacing_m, where range is reference sound speed * time / 2. With a nadir column,
 * port lies left of it, starboard right, and range grows to both sides (scene/geometry.h). */
typedef struct sonject_geometry_params {
    uint32_t side; /* sonject_side; on either side poses count in the image's own ping order */
    double row_spacing_m;
    double column_spacing_m;
    double first_along_track_m;
    double first_slant_range_m; /* slant range of column 0, or of the nadir column; NaN: not set */
    double nadir_column;        /* 0: none */
} sonject_geometry_params;

/* A channel of an XTF or JSF file: a number as in the file, or the only one of a side. */
enum {
    SONJECT_CHANNEL_PORT = -1,
    SONJECT_CHANNEL_STARBOARD = -2,
    SONJECT_CHANNEL_ONLY = -3 /* the file's only sidescan channel */
};

/* The function that made stored numbers from amplitudes. v: stored number; q: v / full scale, by
 * default 255 or 65535 for 8 and 16 bit images and 1 for floating point. Amplitude is relative to
 * full scale. */
typedef enum sonject_transfer {
    SONJECT_TRANSFER_AMPLITUDE = 0, /* amplitude = q */
    SONJECT_TRANSFER_INTENSITY = 1, /* amplitude = sqrt(q) */
    SONJECT_TRANSFER_DECIBEL = 2,   /* amplitude = 10^((v * parameter + offset) / 20) */
    SONJECT_TRANSFER_GAMMA = 3,     /* amplitude = q^parameter */
    SONJECT_TRANSFER_SCHLICK = 4    /* amplitude = q / (b - (b - 1) q), b = parameter */
} sonject_transfer;

/* The transfer function of an image file. */
typedef struct sonject_transfer_params {
    uint32_t kind; /* sonject_transfer */
    double parameter;
    double offset;
    double full_scale; /* the largest value that the recorder stores, such as 32767 or 4095 in 16
                          bits: pixels there count as clipped, and none brighter is written. 0, or
                          more than the type's: the type's. Floating point is only scaled by it */
} sonject_transfer_params;

/* The options of an image file beside its name. */
struct image_options {
    int32_t channel;   /* SONJECT_CHANNEL_PORT and the like, or a number */
    const char *array; /* name of the array; NULL: the only one */
    sonject_transfer_params transfer;
    bool has_geometry;
    sonject_geometry_params geometry; /* geometry in slant range */
};

/* A synthetic seabed: amplitudes with K-distributed speckle on patches and ripples. */
typedef struct sonject_synthetic_params {
    bool complex_pixels; /* false: amplitudes */
    uint32_t rows;
    uint32_t columns;
    uint64_t seed;
    double speckle_shape;
    double texture_length_m;
    double ripple_wavelength_m;
    double ripple_contrast;
    double ripple_heading_rad; /* direction across the crests, from +x towards +y */
    double patch_contrast_db;
    double patch_length_m;
    double mean_amplitude; /* rms amplitude of the darker sediment */
} sonject_synthetic_params;

/* The sonar as its images show it. */

/* The weighting of the aspects that form a pixel. It shapes the along-track point response. */
typedef enum sonject_response_window {
    SONJECT_WINDOW_RECTANGULAR = 0, /* sinc(x / resolution) */
    SONJECT_WINDOW_HAMMING = 1,
    SONJECT_WINDOW_TAYLOR = 2 /* side lobes at -taylor_sidelobe_db, taylor_terms constant ones */
} sonject_response_window;

/* The source of the image's resolution along the track. */
typedef enum sonject_sonar_kind {
    SONJECT_SONAR_SYNTHETIC = 0, /* an aperture along the track: the same at every range */
    SONJECT_SONAR_REAL = 1       /* sidescan: the array's two-way beam, which widens with range */
} sonject_sonar_kind;

typedef struct sonject_sonar_params {
    uint32_t response_window; /* sonject_response_window */
    double centre_frequency_hz;
    double bandwidth_hz; /* below twice the centre frequency; the -3 dB width is c/(2 bandwidth) */
    double altitude_m;
    double along_track_resolution_m; /* the aspects within sin(aspect) = +-wavelength/(4 resolution)
                                        are integrated; 0: the image's row spacing */
    double transducer_side_m;        /* side of the source that rays are connected to; 0: a point */
    double taylor_sidelobe_db;
    uint32_t taylor_terms;
    uint32_t kind;       /* sonject_sonar_kind */
    double aperture_rad; /* synthetic: full angle of the aspects that shadows and rough highlights
                            are integrated over; 0: broadside alone; negative: the response's own,
                            wavelength/(2 resolution), which smooth highlights always have */
    /* Real: the array, a uniform rectangle that sends and receives. Its long side lies along the
     * track and its beam looks broadside before the array is turned. */
    double array_length_m; /* length; the two-way energy is sinc(length u / wavelength)^4 with sinc
                              z = sin(pi z)/(pi z) and u the cosine between the long side and the
                              path to the echo */
    double array_height_m; /* height; the same pattern across; 0: all elevations are heard alike */
    double array_heading_rad; /* heading of the long side, from along-track (+x) towards range (+y),
                                 to port or starboard */
    double array_pitch_rad;   /* pitch of the long side over the horizontal */
    double array_depression_rad; /* depression of the beam below the horizontal */
} sonject_sonar_params;

/* The compressed pulse: the response of a point in range. */

/* The weighting of a compressed sweep's spectrum over the bandwidth B. Half-power widths, in c /
 * 2B: 0.886 rectangular, 1.441 Hann, Taylor between them. */
typedef enum sonject_pulse_window {
    SONJECT_PULSE_RECTANGULAR = 0, /* sinc: side lobes at -13.3 dB */
    SONJECT_PULSE_HANN = 1,        /* side lobes at -31.5 dB, which fall fast */
    SONJECT_PULSE_TAYLOR = 2       /* side lobes at -taylor_sidelobe_db */
} sonject_pulse_window;

typedef struct sonject_pulse_params {
    uint32_t kind;   /* sonject_pulse_kind */
    uint32_t window; /* sonject_pulse_window of a chirp */
    uint32_t taylor_terms;
    double taylor_sidelobe_db;
} sonject_pulse_params;

/* Motion that the navigation did not see. It defocuses synthetic apertures. */

#define SONJECT_SWAYS_CAPACITY 8
#define SONJECT_YAWS_CAPACITY  8

/* A sine of the along-track position x: amplitude * sin(2 pi x / wavelength_m + phase_rad). */
typedef struct sonject_wave {
    double amplitude; /* sway in m, yaw in rad */
    double wavelength_m;
    double phase_rad;
} sonject_wave;

/* Residual sway: horizontal, across the track, positive towards the imaged side. Sines, random sway
 * and table are added. Sway shortens the path to the seabed at grazing angle gamma by
 * sway * cos(gamma).
 *
 * Residual yaw: the heading of an array of several hydrophones, less the heading that the processor
 * knows. It is positive where the bow is turned towards the imaged side, port or starboard. Bias,
 * sines, random yaw and table are added. Pings are at multiples of yaw_advance_m, and the phase
 * centres of each fill one advance around it. One that is x ahead of its ping's middle sways by
 * yaw * x. */
typedef struct sonject_motion_params {
    uint32_t sway_count;
    sonject_wave sways[SONJECT_SWAYS_CAPACITY];
    double random_rms_m;         /* rms of a Gaussian random sway; 0: none */
    double random_correlation_m; /* length in the autocorrelation exp(-(x / length)^2 / 2) */
    uint64_t seed;
    double yaw_advance_m; /* distance from ping to ping, along-track: half the hydrophone array if
                             its pings neither overlap nor leave gaps; 0: no yaw */
    double yaw_bias_rad;  /* yaw of all pings */
    double yaw_random_rms_rad;       /* rms of a Gaussian random yaw; 0: none */
    double yaw_random_correlation_m; /* length, as for sway */
    uint64_t yaw_seed;
    uint32_t yaw_count;
    sonject_wave yaws[SONJECT_YAWS_CAPACITY];
} sonject_motion_params;

/* The water: sound speed, in layers if need be, and absorption. */

typedef struct sonject_medium_params {
    double sound_speed_mps;           /* not used with layers */
    double reference_sound_speed_mps; /* sound speed that the image processor assumed; 0: the true
                                         one (with layers: that around the seabed). A target at
                                         range r appears at r * reference / true */
    double absorption_db_per_m;
} sonject_medium_params;

/* Surfaces: the amount and directions of the sound that they return. */

/* The dependence of the reflection coefficient on the angle. */
typedef enum sonject_reflection_kind {
    SONJECT_REFLECTION_CONSTANT = 0, /* `reflection` at every angle */
    SONJECT_REFLECTION_FLUID = 1     /* Rayleigh coefficient of a fluid half-space of density_ratio,
                                        speed_ratio and loss; `reflection` is not used */
} sonject_reflection_kind;

/* A surface returns sound in two parts that are never mixed (kernels/MATH.md).
 * Smooth: specular, amplitude R(angle) exp(-P^2/2), P = 2 k roughness cos(angle).
 * Rough: scattering per area and solid angle f cos cos,
 *     f = lambert (n + 1)/2 (cos cos)^(n - 1)  +  a cone of rms slope glossy_slope about the
 *     specular direction that returns at most the fraction glossy_albedo of the energy,
 * reduced at both angles by what the smooth part keeps, so that no more energy leaves than came. */
typedef struct sonject_material_params {
    uint32_t reflection_kind; /* sonject_reflection_kind */
    double reflection;        /* amplitude reflection coefficient; 0: no smooth part */
    double roughness_m;       /* rms height */
    double lambert; /* Lambert coefficient mu, linear; pi*mu + glossy_albedo <= reflection^2, or <=
                       1 without a smooth part or for a fluid */
    double lambert_exponent; /* exponent n; 1: Lambert's law */
    double glossy_albedo;
    double glossy_slope;
    double density_ratio; /* ratio to the water's */
    double speed_ratio;   /* sound speed, ratio to the water's */
    double loss; /* imaginary over real part of the wavenumber; a plane wave in the material loses
                    54.6 * loss dB a wavelength */
} sonject_material_params;

/* Fills in a named material of schema/materials.c, where '_' and '-' may replace blanks. Returns
 * false for an unknown name and leaves *material unchanged. */
bool material_named(const char *name, sonject_material_params *material);

/* Returns name number index of all that material_named knows, NULL beyond the last. Static. */
const char *material_name(uint32_t index);
/* Returns the grain size of the sediment of a name's index, in phi; NaN: no sediment. */
double material_grain_size(uint32_t index);

/* The seabed, with reflectivity from the image: the plane z = 0, or a relief about this plane. */

/* The reflectivity that resynthesise uses. */
typedef enum sonject_seabed_map {
    SONJECT_MAP_INTENSITY = 0,  /* the measured intensity as it is, speckle and all */
    SONJECT_MAP_DESPECKLED = 1, /* the local mean over a few resolution cells */
    SONJECT_MAP_COHERENT = 2    /* complex reflectivity; needs a complex image */
} sonject_seabed_map;

/* The scattering of sound at the seabed that does not come straight from the sonar and go straight
 * back, as between seabed and target. */
typedef enum sonject_forward_rule {
    SONJECT_FORWARD_MODEL = 0, /* the material `forward` alone */
    SONJECT_FORWARD_MAP = 1 /* the material, with its rough part times the measured reflectivity, as
                               for sound that goes straight back */
} sonject_forward_rule;

typedef struct sonject_seabed_params {
    uint32_t map;   /* sonject_seabed_map */
    double lambert; /* mu0, backscatter per area and solid angle at normal incidence, linear */
    double level_radius_m;
    double despeckle_radius_m;
    uint32_t forward_rule;           /* sonject_forward_rule */
    sonject_material_params forward; /* lambert NaN: the seabed's own mu0. The rough part is the
                                        same at every angle, smooth part or not */
    double grain_size_phi; /* grain size of the sediment that sets mu0; NaN: lambert sets it */
} sonject_seabed_params;

/* Heights of the seabed over its mean plane z = 0, as a grid: rows along-track, columns in ground
 * range, which is horizontal from the track. Heights are bilinear between the points and 0 outside
 * the grid. */
typedef struct sonject_relief_params {
    uint32_t rows; /* 0: no grid */
    uint32_t columns;
    double first_along_track_m;  /* along-track position of row 0 */
    double first_ground_range_m; /* ground range of column 0 */
    double row_spacing_m;
    double column_spacing_m;
} sonject_relief_params;

/* The sea surface over the scene. */
typedef struct sonject_surface_params {
    double water_depth_m; /* height of the surface over the mean seabed, above the sonar; 0: too far
                             away to be heard */
    /* The rough part acts on paths of several interactions, where no layer bends sound below the
     * surface. glossy_albedo NaN: all that lambert leaves of the energy that roughness takes, see
     * surface_material. The default slope of the keys is the sea's at 7 m/s of wind (C. Cox, W.
     * Munk, J. Opt. Soc. Am. 44, 1954, 838). */
    sonject_material_params material;
} sonject_surface_params;

/* Returns the surface's material, with a NaN glossy_albedo replaced by reflection^2 - pi*lambert,
 * or by 1 - pi*lambert for a fluid. */
sonject_material_params surface_material(const sonject_surface_params *surface);

/* Objects: shape, pose and surface of each thing that is put on the seabed. */

/* An end of a cylinder. An open end makes the cylinder a tube, whose wall is thin and reflects on
 * both sides. */
typedef enum sonject_end {
    SONJECT_END_FLAT = 0,
    SONJECT_END_OPEN = 1,
    SONJECT_END_SPHERICAL = 2 /* a part of a sphere that joins the rim */
} sonject_end;

/* The form in which burial is given. */
typedef enum sonject_burial_kind {
    SONJECT_BURIAL_DEPTH = 0,    /* burial_m */
    SONJECT_BURIAL_FRACTION = 1, /* burial_fraction */
    SONJECT_BURIAL_PROUD = 2     /* proud_height_m */
} sonject_burial_kind;

/* The form in which a position is given. A position is the ground point under the object's centre,
 * the middle of its overall length, width and height. An object of parts has the origin of the
 * parts' places instead. Over relief the position is a point of the mean seabed, and burial counts
 * from the relief's height there. */
typedef enum sonject_position_kind {
    SONJECT_POSITION_PATCH_CENTRE = 0, /* along = range = 0 */
    SONJECT_POSITION_METRES = 1, /* along: along-track m, range: apparent slant range m, as the
                                    image's geometry counts them */
    SONJECT_POSITION_PIXELS = 2  /* along: row, range: column of the swath, centres at integers */
} sonject_position_kind;

/* The growth on an object: two random fields of Gaussian autocorrelation exp(-(r/length)^2/2) over
 * its surface, in its own coordinates. */
typedef struct sonject_fouling_params {
    double albedo_db; /* rms of the scattered energy, whose mean stays; 0: even */
    double albedo_length_m;
    double relief_m; /* rms height; tilts what scatters, and adds to the roughness; 0: none */
    double relief_length_m;
} sonject_fouling_params;

/* An object. Lengths are overall. Length runs along the nose (own x), width across it (own y, to
 * the left of the nose as seen from above), height upwards when the pose is level (own z). An
 * object is the same thing to port and to starboard. */
typedef struct sonject_object_params {
    uint32_t shape;                   /* enum shape_kind; size at least half a wavelength */
    char name[SONJECT_NAME_CAPACITY]; /* "" becomes "object N"; like class_name it is terminated
                                         UTF-8 without controls of terminals or text direction */
    char class_name[SONJECT_NAME_CAPACITY]; /* label class; "" becomes the shape's name */
    double length_m; /* this and other sizes: for the shapes that have them */
    double width_m;
    double diameter_m;
    uint32_t position_kind; /* sonject_position_kind */
    uint32_t burial_kind;   /* sonject_burial_kind */
    double position_along;  /* see sonject_position_kind */
    double position_range;
    double heading_rad; /* heading from along-track (+x) towards range (+y), to port or starboard */
    double pitch_rad;   /* raises the nose */
    double roll_rad;    /* about the nose; like the heading counted in the image: it raises the left
                           side to port, the right side to starboard */
    double burial_m;    /* depth of the lowest point below the seabed; negative: above it */
    sonject_material_params material;
    double height_m;
    double top_diameter_m;   /* truncated cone; 0: a cone; may be the larger one */
    double front_height_m;   /* wedge: at the nose, 0...height */
    uint32_t nose_end;       /* sonject_end, cylinder */
    uint32_t tail_end;       /* sonject_end, cylinder */
    double nose_end_depth_m; /* depth of a spherical end, above 0...half the diameter; 0: half the
                                diameter, a half sphere. The length includes it */
    double tail_end_depth_m; /* as nose_end_depth_m */
    double burial_fraction;  /* 0...1, share of the height that the object has in its pose */
    double proud_height_m;   /* height of the highest point above the seabed, 0...height in pose */
    uint32_t mesh;           /* number of a mesh of the scene */
    uint32_t level_kind;     /* sonject_level_kind */
    double level_db;         /* not used for SONJECT_LEVEL_PHYSICAL */
    sonject_fouling_params fouling; /* fouling of the whole object; the parts' own is not used */
} sonject_object_params;

/* The injection of targets into an image. */

/* The way of injection: objects composed into the patch, or the whole patch traced again. */
typedef enum sonject_injection_mode {
    SONJECT_MODE_COMPOSITE = 0, /* measured pixels outside the target's influence keep every bit */
    SONJECT_MODE_RESYNTHESISE = 1 /* the whole patch is traced from the reflectivity map */
} sonject_injection_mode;

/* The way in which paths to the source are found. */
typedef enum sonject_estimator {
    SONJECT_ESTIMATOR_CONNECT =
        0, /* every hit is connected to the source; targets are sampled on purpose */
    SONJECT_ESTIMATOR_BRUTE_FORCE =
        1 /* the paper's: rays are spawned into hemisphere and specular cone and count when they
             happen to hit the source's rectangle (transducer side > 0); resynthesise only */
} sonject_estimator;

/* The column of an echo of several interactions. With one interaction both rules agree. */
typedef enum sonject_column_rule {
    SONJECT_COLUMNS_FOCUSED = 0, /* mean along-track position of first and last hit */
    SONJECT_COLUMNS_PAPER = 1    /* the first hit's */
} sonject_column_rule;

/* The source of a property of echoes in a measured magnitude image (composite mode; complex,
 * uniform and synthetic images follow the sonar's parameters). */
typedef enum sonject_match {
    SONJECT_MATCH_NOMINAL = 0, /* the sonar's parameters, the file's full scale */
    SONJECT_MATCH_IMAGE = 1    /* the image around the objects, where it clearly differs */
} sonject_match;

#define RAY_SCALE_MAX 4096.0

typedef struct sonject_injection_params {
    uint32_t mode;         /* sonject_injection_mode */
    uint32_t column_rule;  /* sonject_column_rule */
    bool estimate_noise;   /* true: the patch gives the noise floor, noise_floor_db is unused */
    double noise_floor_db; /* noise energy over the mean seabed's */
    double noise_floor_over_db; /* level of that seabed everywhere; NaN: the local level */
    double influence_db; /* composite: a pixel is the target's if its change is above this level
                            over the seabed */
    double ray_scale;    /* factor on the number of rays, up to RAY_SCALE_MAX; not used with an
                            accuracy */
    double accuracy; /* relative standard error of expected energies, which sets the number of rays;
                        0: ray_scale does */
    uint64_t seed;
    uint64_t ray_seed;         /* changes only the rays' random numbers; no key */
    uint32_t interactions;     /* largest number of surfaces that a path may meet */
    uint32_t estimator;        /* sonject_estimator */
    bool order_energies;       /* keep the energy of each number of interactions (layers) */
    uint32_t match_response;   /* sonject_match: the point response's widths */
    double match_looks;        /* looks averaged in a magnitude pixel of the input; 0: estimated
                                  from the image around the objects */
    uint32_t match_saturation; /* sonject_match: the amplitude at which highlights are cut */
} sonject_injection_params;

/* The source of the swath. */
typedef enum sonject_input_kind {
    SONJECT_INPUT_MEMORY = 0,   /* the caller passes pixels to sonject_inject */
    SONJECT_INPUT_FILE = 1,     /* an image file */
    SONJECT_INPUT_UNIFORM = 2,  /* rows x columns of unit reflectivity */
    SONJECT_INPUT_SYNTHETIC = 3 /* made by sonject */
} sonject_input_kind;

/* The part of the swath that is worked on; all 0: the whole swath. */
typedef struct sonject_patch_params {
    uint64_t first_row;
    uint64_t first_column;
    uint64_t rows;
    uint64_t columns;
} sonject_patch_params;

#endif
