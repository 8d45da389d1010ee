/* Injections into pixels in memory, and their results. */
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

/* Puts the scene's objects into a patch in memory. pixels: the patch, whose pixel (0, 0) is at the
 * geometry's first track position and range; NULL is allowed if the scene's input is uniform or
 * synthetic. The geometry of the scene's input is used, its patch is ignored. Pixels with a
 * transfer function are treated like those of a file: untouched ones keep their numbers, and the
 * bits are those of a run on such a file. A row of zeros alone is one where nothing was heard, and
 * stays empty. progress may be NULL. On success *result is the caller's, for
 * sonject_result_release; on failure it is NULL. Errors: ARGUMENT, INPUT (NaN pixels, object
 * outside the patch, ...), DEVICE, MEMORY, CANCELLED. */
SONJECT_API sonject_status sonject_inject(sonject_context *context, const sonject_scene *scene,
                                          const sonject_pixels *pixels,
                                          sonject_progress_function progress, void *user,
                                          sonject_result **result);

/* Releases the result and sets *result to NULL; NULL allowed. */
SONJECT_API void sonject_result_release(sonject_result **result);

/* The arrays of a result. */
typedef enum sonject_layer {
    SONJECT_LAYER_IMAGE = 0, /* the patch with the objects, in the kind, units and transfer function
                                of the input */
    SONJECT_LAYER_FIELD = 1, /* complex; |pixel|^2 is a backscattering cross-section in m^2; 0 where
                                the image was not changed */
    SONJECT_LAYER_ENERGY = 2,     /* float; expected cross-section in m^2 of the objects and of the
                                     seabed still in view, without speckle and noise; that of plain
                                     seabed where the image was not changed */
    SONJECT_LAYER_VISIBILITY = 3, /* float, 0...1; share of the seabed's energy that still arrives.
                                     With relief it is relative to a level seabed without objects,
                                     and slopes that face the sonar exceed 1 */
    SONJECT_LAYER_HIGHLIGHT = 4,  /* uint8, 255 where an object's echo dominates */
    SONJECT_LAYER_SHADOW = 5,   /* uint8, 255 where less than half of the seabed's energy arrives */
    SONJECT_LAYER_LABELS = 6,   /* uint8, object number + 1 in highlights and shadows (highlight
                                   wins), 0 elsewhere */
    SONJECT_LAYER_INFLUENCE = 7 /* uint8, 255 where the image was changed */
} sonject_layer;

/* Gets the size of the layers, and the sonject_pixel_kind of the image. Errors: ARGUMENT. */
SONJECT_API sonject_status sonject_result_size(const sonject_result *result, uint64_t *rows,
                                               uint64_t *columns, uint32_t *image_kind);

/* Copies a layer into buffer, rows packed. buffer has exactly rows * columns * pixel size bytes,
 * aligned as its values are. Errors: ARGUMENT (unknown layer, wrong size). */
SONJECT_API sonject_status sonject_result_layer(const sonject_result *result, sonject_layer layer,
                                                void *buffer, size_t bytes);

/* Copies the expected cross-section in m^2 of the paths that meet exactly `order` surfaces,
 * 1...interactions. The result must be of a scene whose injection asked for order_energies; all
 * orders then add up to SONJECT_LAYER_ENERGY. buffer gets float, rows x columns, packed, and has
 * exactly that many bytes. Echoes of an object by image sources (sea surface, smooth seabed) and
 * over several smooth faces count in order 1, with which they interfere. The joint echo of two
 * objects counts for each of them as the half that meets it first. Errors: ARGUMENT (not asked for,
 * no such order, wrong size). */
SONJECT_API sonject_status sonject_result_order_energy(const sonject_result *result, uint32_t order,
                                                       void *buffer, size_t bytes);

/* A box of whole pixels of the patch (in truth files of the swath); rows = columns = 0: empty. */
typedef struct sonject_box {
    uint64_t first_row;
    uint64_t first_column;
    uint64_t rows;
    uint64_t columns;
} sonject_box;

/* The rule that sets the level of an object's echo. The last two rules scale all that the object
 * returns by one factor. The largest expected energy of its pixels, speckle averaged out, then has
 * the level. */
typedef enum sonject_level_kind {
    SONJECT_LEVEL_PHYSICAL = 0, /* level by shape and material, against the seabed's strength */
    SONJECT_LEVEL_TARGET_STRENGTH = 1, /* target strength re 1 m^2 */
    SONJECT_LEVEL_OVER_SEABED = 2      /* level over the local mean seabed */
} sonject_level_kind;

/* The place of an object in the patch, and its appearance. */
typedef struct sonject_object_truth {
    uint32_t struct_size;
    uint32_t is_visible;       /* 1: the object dominates some pixel, or casts a shadow */
    uint32_t highlight_is_cut; /* 1: the highlight touches the patch's edge */
    uint32_t shadow_is_cut;    /* 1: the shadow touches the patch's edge */
    double row;                /* row of the object's centre, patch pixels */
    double column;             /* column of the centre's slant range, patch pixels */
    double along_track_m;      /* position of the centre */
    double slant_range_m;      /* apparent slant range of the centre */
    double ground_range_m;     /* ground range of the centre */
    double height_m;           /* height of the centre over the mean seabed */
    sonject_box highlight; /* box of the mask, which is the layer of this name; side lobes and other
                              faint changes may lie beyond: the layer influence shows all */
    sonject_box shadow;
    sonject_box both;
    uint64_t highlight_pixels;
    uint64_t shadow_pixels;
    double target_strength_db;    /* 10 log10 of the largest expected cross-section in m^2 of the
                                     echo by one interaction, wherever pixels lie and however far
                                     apart they are: of glints through the point response, of rough
                                     surfaces with speckle averaged out. -infinity: nothing of the
                                     object is in view */
    double highlight_contrast_db; /* see sonject_contact_measures; of this object alone, and of
                                     expected energies without speckle */
    double shadow_contrast_db;
    double burial_m;    /* depth of the object's lowest point below the seabed under its origin;
                           negative: above the seabed */
    double grazing_rad; /* grazing angle of the sound that comes straight to the centre */
    double transmission_loss_db; /* one-way loss from 1 m off the sonar to the centre: spreading
                                    (through layers that of the ray tube, mean of there and back),
                                    transmission and absorption */
    uint32_t level_kind;         /* sonject_level_kind of the scene */
    uint32_t reserved;
    double level_gain_db;  /* gain of the echo that its level needed; 0: physical */
    double over_seabed_db; /* target_strength_db over the cross-section of a pixel of plain seabed
                              at the echo's range; -infinity: nothing of the object is in view */
    double seabed_strength_db; /* assumed strength of that seabed: 10 log10 of its cross-section per
                                  m^2 at its grazing angle */
    double highlight_visible;  /* share, 0...1, of the object's energy in the patch that lies in
                                  pixels where it dominates seabed, noise and all other objects; NaN:
                                  nothing of it is in view */
    double shadow_visible; /* share, 0...1, of the shadow's pixels that no other object's highlight
                              fills; NaN: no shadow */
    double overall_length_m;  /* extent of all parts of the object along its nose */
    double overall_width_m;   /* extent along the object's own y */
    double overall_height_m;  /* extent along the object's own z */
    double highlight_along_m; /* see sonject_contact_measures, also for the next five; NaN: absent
                               */
    double highlight_range_m;
    double shadow_along_m;
    double shadow_range_m;
    double gap_range_m;
    double dim_range_m;
    double highlight_visibility_db; /* see sonject_contact_measures; of the image itself with its
                                       speckle: what somebody who labels it sees */
    double shadow_visibility_db;
    double highlight_clipped; /* share, 0...1, of the highlight's pixels that are as bright as the
                                 image, or the numbers in its file, can be; NaN: no highlight */
    double ceiling_over_seabed_db; /* brightest possible level over the local mean seabed where
                                      the echo is strongest; infinity: nothing is cut; NaN: no
                                      highlight */
} sonject_object_truth;

/* Gets the truth of object number index. truth->struct_size must be set. Errors: ARGUMENT. */
SONJECT_API sonject_status sonject_result_object(const sonject_result *result, uint32_t index,
                                                 sonject_object_truth *truth);

/* The origin of a number that was used. */
typedef enum sonject_source {
    SONJECT_SOURCE_DEFAULT = 0,     /* the key's default */
    SONJECT_SOURCE_SCENE = 1,       /* the scene's key */
    SONJECT_SOURCE_CALIBRATION = 2, /* the file of the scene's input.calibration */
    SONJECT_SOURCE_PATCH = 3,       /* measured in the patch */
    SONJECT_SOURCE_FALLBACK = 4,    /* a fallback, since the patch does not tell it */
    SONJECT_SOURCE_FILE = 5         /* the image's file or the table of its pings */
} sonject_source;

/* The counts of an injection, its times in seconds, and a comparison of output and input. */
typedef struct sonject_statistics {
    uint32_t struct_size;
    uint32_t reserved;
    uint64_t pings; /* track positions that were traced, margins included; a row may have several */
    uint64_t rays;  /* primary rays; in composite mode only those in windows about the objects */
    uint64_t ray_queries; /* rays and visibility tests */
    uint64_t impulses;    /* echoes that were recorded */
    double trace_s;       /* wall-clock times of the stages */
    double form_s;
    double inject_s;
    double noise_floor_db;   /* noise floor that was used, over the local mean seabed energy */
    uint64_t input_clipped;  /* stored pixels of the patch at full scale */
    uint64_t output_clipped; /* changed pixels that were cut at full scale when stored */
    uint64_t changed_pixels; /* pixels of the layer influence; rounding may keep some numbers */
    /* Output against input where nothing of the objects is in view, as in the paper's Figure 5; NaN
     * except in resynthesise mode. */
    double level_change_db;
    double input_contrast; /* standard deviation of intensity over its mean */
    double output_contrast;
    double histogram_distance; /* Kolmogorov-Smirnov distance of intensities over their means */
    double correlation;        /* correlation of the intensities */
    /* The measured image around the objects; NaN: too small, or without speckle. */
    double seabed_amplitude_contrast; /* standard deviation of amplitude over its mean */
    double seabed_shape; /* shape of the K distribution of intensity; infinite: no texture */
    double seabed_looks; /* independent samples averaged in a pixel, >= 1 */
    double seabed_row_correlation;    /* correlation of the speckle's intensity between neighbouring
                                         rows */
    double seabed_column_correlation; /* correlation between neighbouring columns */
    /* Values used for the injected echoes. */
    double along_track_resolution_m; /* for a real aperture the energy width of its two-way beam in
                                        the middle of the patch */
    double range_resolution_m;       /* -3 dB width */
    double looks;                    /* 1: single-look */
    double saturation_amplitude;     /* infinite: no limit but the format's full scale */
    uint32_t noise_floor_source;     /* sonject_source */
    uint32_t looks_source;           /* sonject_source */
    double seabed_lambert;           /* mu of the seabed, given or that of its sediment */
    double ray_scale;                /* factor on the number of rays that were traced */
    double energy_error; /* standard error of the expected energies, relative to these plus the
                            noise floor, rms over the changed pixels; NaN unless the scene asks for
                            an accuracy */
} sonject_statistics;

/* Gets the statistics of an injection. statistics->struct_size must be set. Errors: ARGUMENT. */
SONJECT_API sonject_status sonject_result_statistics(const sonject_result *result,
                                                     sonject_statistics *statistics);

SONJECT_END_DECLARATIONS

#endif
