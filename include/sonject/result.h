/* What an injection gives back. */
#ifndef SONJECT_RESULT_H
#define SONJECT_RESULT_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/pixels.h>
#include <sonject/scene.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_result sonject_result;

/* Puts the scene's objects into a patch in memory. pixels: the patch; its pixel (0, 0) is the
 * geometry's first track position and range; of the scene's input its geometry counts, of its
 * patch nothing. Pixels with
 * a transfer function are treated as those of a file: untouched ones keep their numbers, the bits
 * are those of a run on such a file, and a row of nothing but 0 is one where nothing was heard,
 * which stays empty. pixels may be NULL where the scene's input is uniform or synthetic. progress
 * may be NULL. On success *result is the caller's, for sonject_result_release; on failure NULL.
 * Errors: ARGUMENT, INPUT (NaN pixels, object outside the patch, ...), DEVICE, MEMORY, CANCELLED.
 */
SONJECT_API sonject_status sonject_inject(sonject_context *context, const sonject_scene *scene,
                                          const sonject_pixels *pixels,
                                          sonject_progress_function progress, void *user,
                                          sonject_result **result);

/* Releases the result and sets *result to NULL; NULL allowed. */
SONJECT_API void sonject_result_release(sonject_result **result);

/* The arrays of a result. */
typedef enum sonject_layer {
    SONJECT_LAYER_IMAGE = 0, /* the patch with the objects, kind, units and transfer function of the
                                input */
    SONJECT_LAYER_FIELD = 1, /* complex; |pixel|^2 is a backscattering cross-section in m^2; 0 where
                                the image was not changed */
    SONJECT_LAYER_ENERGY = 2, /* float; expected cross-section in m^2 of objects and the seabed that
                                 still is in view, no speckle, no noise; where the image was not
                                 changed that of plain seabed */
    SONJECT_LAYER_VISIBILITY =
        3, /* float 0...1; fraction of the seabed's energy that still arrives; with relief over that
              of a level seabed without objects: slopes that face the sonar return more than 1 */
    SONJECT_LAYER_HIGHLIGHT = 4, /* uint8, 255 where an object's echo dominates */
    SONJECT_LAYER_SHADOW = 5, /* uint8, 255 where less than half of the seabed's energy arrives */
    SONJECT_LAYER_LABELS =
        6, /* uint8, object number + 1 of highlights and shadows (highlight wins), 0 elsewhere */
    SONJECT_LAYER_INFLUENCE = 7 /* uint8, 255 where the image was changed */
} sonject_layer;

/* Size of the layers, and the sonject_pixel_kind of the image. Errors: ARGUMENT. */
SONJECT_API sonject_status sonject_result_size(const sonject_result *result, uint64_t *rows,
                                               uint64_t *columns, uint32_t *image_kind);

/* Copies a layer, rows packed, into buffer of exactly rows * columns * pixel size bytes, aligned as
 * its values are.
 * Errors: ARGUMENT (unknown layer, wrong size). */
SONJECT_API sonject_status sonject_result_layer(const sonject_result *result, sonject_layer layer,
                                                void *buffer, size_t bytes);

/* Copies the expected cross-section in m^2, as SONJECT_LAYER_ENERGY counts it, of the paths that
 * meet exactly `order` surfaces, 1...interactions: float, rows x columns, packed, into buffer of
 * exactly that many bytes. Echoes of an object by image sources (sea surface, smooth seabed) and
 * over several smooth faces are in order 1, with which they interfere; what two objects return
 * together counts for each of them as the half that meets it first. Kept where the scene's
 * injection asked for order_energies; all orders add up to that layer. Errors: ARGUMENT (not asked
 * for, no such order, wrong size). */
SONJECT_API sonject_status sonject_result_order_energy(const sonject_result *result, uint32_t order,
                                                       void *buffer, size_t bytes);

/* Whole pixels of the patch (of the swath in truth files); rows = columns = 0: empty. */
typedef struct sonject_box {
    uint64_t first_row;
    uint64_t first_column;
    uint64_t rows;
    uint64_t columns;
} sonject_box;

/* What sets the level of an object's echo. The other two scale all that the object returns by one
 * factor, so that the largest expected energy of its pixels, speckle averaged out, becomes as told.
 */
typedef enum sonject_level_kind {
    SONJECT_LEVEL_PHYSICAL = 0,        /* its shape and material, against the seabed's strength */
    SONJECT_LEVEL_TARGET_STRENGTH = 1, /* re 1 m^2 */
    SONJECT_LEVEL_OVER_SEABED = 2      /* over the local mean seabed */
} sonject_level_kind;

/* Where an object came to lie in the patch, and how it shows. */
typedef struct sonject_object_truth {
    uint32_t struct_size;
    uint32_t is_visible;       /* 1: some pixel of it dominates, or it casts a shadow */
    uint32_t highlight_is_cut; /* 1: the highlight touches the patch's edge */
    uint32_t shadow_is_cut;    /* 1: the shadow touches the patch's edge */
    double row;                /* of the object's centre, patch pixels */
    double column;             /* where its centre's slant range lies, patch pixels */
    double along_track_m;      /* of the centre */
    double slant_range_m;      /* apparent, of the centre */
    double ground_range_m;     /* of the centre */
    double height_m;           /* of the centre over the mean seabed */
    sonject_box highlight;     /* of masks, as the layers of these names; what changes less, such as
                                  side lobes do, may lie beyond: the layer influence shows all */
    sonject_box shadow;
    sonject_box both;
    uint64_t highlight_pixels;
    uint64_t shadow_pixels;
    double target_strength_db;    /* 10 log10 of its echo's largest expected cross-section in m^2,
                                     wherever pixels lie and however far apart they are: of its glints
                                     through the point response, and of rough surfaces speckle
                                     averaged out. -infinity where nothing of it is in view */
    double highlight_contrast_db; /* as in sonject_contact_measures, see there; of this object alone
                                     and of expected energies, without speckle */
    double shadow_contrast_db;
    double burial_m;    /* depth of its lowest point below the seabed under its origin; negative:
                           above that */
    double grazing_rad; /* of the sound that comes straight to the centre */
    double transmission_loss_db; /* one way, from 1 m off the sonar to the centre: spreading
                                    (through layers: of the ray tube, mean of there and back),
                                    transmission and absorption */
    uint32_t level_kind;         /* sonject_level_kind that was asked for */
    uint32_t reserved;
    double level_gain_db;      /* by which its echo was scaled; 0: physical */
    double over_seabed_db;     /* that cross-section over a pixel's of plain seabed at its range;
                                  -infinity where nothing of it is in view */
    double seabed_strength_db; /* assumed: 10 log10 of the seabed's cross-section per m^2 at the
                                  grazing angle of that plain seabed */
    double highlight_visible;  /* share, 0...1, of the energy that the patch holds of it which lies
                                  in pixels where it dominates seabed, noise and all other objects;
                                  NaN where nothing of it is in view */
    double shadow_visible;     /* share, 0...1, of its shadow's pixels that no other object's
                                  highlight fills; NaN where it casts none */
    double overall_length_m;   /* of what is left of it, along its nose */
    double overall_width_m;    /* along its own y */
    double overall_height_m;   /* along its own z */
    double highlight_along_m;  /* likewise as in sonject_contact_measures; NaN: not there */
    double highlight_range_m;
    double shadow_along_m;
    double shadow_range_m;
    double gap_range_m;
    double dim_range_m;
    double highlight_visibility_db; /* as in sonject_contact_measures, but of the image itself, with
                                       its speckle: what somebody who labels it sees */
    double shadow_visibility_db;
    double highlight_clipped; /* share, 0...1, of its highlight's pixels that are as bright as the
                                 image, or what its file stores, can be; NaN where it has none */
    double ceiling_over_seabed_db; /* that brightest there can be over the local mean seabed where
                                      its echo is strongest; infinity: nothing is cut; NaN: no
                                      highlight */
} sonject_object_truth;

/* Truth of object number index. truth->struct_size must be set. Errors: ARGUMENT. */
SONJECT_API sonject_status sonject_result_object(const sonject_result *result, uint32_t index,
                                                 sonject_object_truth *truth);

/* Where a number that was used came from. */
typedef enum sonject_source {
    SONJECT_SOURCE_DEFAULT = 0,     /* the key's own */
    SONJECT_SOURCE_SCENE = 1,       /* the scene's key */
    SONJECT_SOURCE_CALIBRATION = 2, /* the file of the scene's input.calibration */
    SONJECT_SOURCE_PATCH = 3,       /* measured in the patch */
    SONJECT_SOURCE_FALLBACK = 4,    /* taken since the patch does not tell it */
    SONJECT_SOURCE_FILE = 5         /* the image's file or the table of its pings */
} sonject_source;

/* Counts, times in seconds, and how the output compares with the input. */
typedef struct sonject_statistics {
    uint32_t struct_size;
    uint32_t reserved;
    uint64_t pings; /* track positions that were traced, margins included; there may be several to a
                       row */
    uint64_t rays;  /* primary rays, of a composite in windows about its objects */
    uint64_t ray_queries; /* rays and visibility tests */
    uint64_t impulses;    /* echoes that were recorded */
    double trace_s;       /* wall-clock time of the stages */
    double form_s;
    double inject_s;
    double noise_floor_db;   /* that was used, over the local mean seabed energy */
    uint64_t input_clipped;  /* stored pixels of the patch at full scale */
    uint64_t output_clipped; /* changed pixels that full scale cut as they were stored */
    uint64_t changed_pixels;
    /* Output against input where nothing of the objects is in view, as in the paper's Figure 5
     * (resynthesise; otherwise NaN). */
    double level_change_db;
    double input_contrast; /* intensity standard deviation over mean */
    double output_contrast;
    double histogram_distance; /* Kolmogorov-Smirnov, intensities over their means */
    double correlation;        /* of the intensities */
    /* The measured image around the objects, NaN where it says nothing (too small, no speckle). */
    double seabed_amplitude_contrast; /* amplitude standard deviation over mean */
    double seabed_shape;              /* of the K distribution of intensity; infinite: no texture */
    double seabed_looks;              /* independent samples averaged in a pixel, >= 1 */
    double seabed_row_correlation;    /* of speckle's intensity, from a row to the next */
    double seabed_column_correlation; /* from a column to the next */
    /* What was used for what was put in. */
    double along_track_resolution_m; /* of a real aperture the energy width of its two-way beam in
                                        the middle of the patch */
    double range_resolution_m;       /* -3 dB width */
    double looks;                    /* 1: single-look */
    double saturation_amplitude;     /* infinite: none but the format's full scale */
    uint32_t noise_floor_source;     /* sonject_source */
    uint32_t looks_source;           /* sonject_source */
    double seabed_lambert;           /* mu of the seabed, as given or of its sediment */
    double ray_scale;                /* factor on the number of rays that were traced */
    double energy_error; /* standard error of the expected energies, over them and the noise
                            floor, rms over the changed pixels; NaN unless the scene asks for
                            an accuracy */
} sonject_statistics;

/* statistics->struct_size must be set. Errors: ARGUMENT. */
SONJECT_API sonject_status sonject_result_statistics(const sonject_result *result,
                                                     sonject_statistics *statistics);

SONJECT_END_DECLARATIONS

#endif
