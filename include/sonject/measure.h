/* Measures of an image: its seabed's speckle, and its contacts. */
#ifndef SONJECT_MEASURE_H
#define SONJECT_MEASURE_H

#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/result.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* An image, as a file or as pixels in memory, and facts about it. */
typedef struct sonject_measure_params {
    uint32_t struct_size;
    uint32_t box_count;
    const char *image;            /* file of one channel, or of two: real and imaginary part */
    const sonject_pixels *pixels; /* pixels instead of a file */
    const char *channel;          /* channel; see sonject_quicklook_params, also for the next two */
    const char *array;
    const char *transfer;
    /* For sonject_measure: a mask of the image's size, not 0 where there is no seabed, such as in
     * highlights and shadows. Either may be NULL. */
    const char *labels;         /* file with the mask; like channel, array and transfer, of `image`
                                   alone: beside pixels, ARGUMENT */
    const uint8_t *labels_mask; /* mask of `pixels` alone: rows x columns bytes */
    /* For sonject_measure_contacts. */
    const char *truth; /* a run's truth.json, for its boxes and spacings; NULL: none */
    const sonject_box
        *boxes;              /* box_count boxes, beside those of truth; one of both must be given */
    double row_spacing_m;    /* 0: the value of truth or of the image's file, if any */
    double column_spacing_m; /* spacing in slant range */
    uint32_t range_to_left;  /* 1: range grows to the left, as in the port half of an image of two
                                sides; 0: to the right, or as in truth */
} sonject_measure_params;

/* The statistics of an image's seabed. */
typedef struct sonject_measurement {
    uint32_t struct_size;
    uint32_t reserved;
    /* Medians over blocks of 32 x 32 pixels of untouched seabed. NaN: cannot be measured. */
    double amplitude_contrast; /* standard deviation over mean; Rayleigh: 0.523 */
    double intensity_contrast; /* standard deviation over mean; Rayleigh: 1 */
    double looks;              /* independent samples averaged in a pixel, >= 1 */
    double shape;              /* shape of the K distribution of intensity; infinite: no texture */
    double row_correlation; /* correlation of the speckle's intensity between neighbouring rows */
    double column_correlation; /* correlation between neighbouring columns */
    double row_length_pixels;  /* distance at which the correlation falls to 1/e, at most 7 */
    double column_length_pixels;
} sonject_measurement;

/* Measures an image. measurement->struct_size must be set. Errors: ARGUMENT, INPUT, STORAGE,
 * MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_measure(sonject_context *context,
                                           const sonject_measure_params *params,
                                           sonject_measurement *measurement);

/* The measures of a contact, by one ruler for measured and injected contacts. Truth
 * (sonject_object_truth, truth.json) gives measures of these names, too, of the object's expected
 * energies on plain seabed without speckle. The drawing shows intensity over slant range, across
 * the middle third of the rows:
 *
 *               highlight_range
 *                 |<------>|          gap_range      lit, but no highlight: a rim, a level top
 *                 |  ____  |<------->|
 *                 | /    \ |         |               shadow_range
 *     6 dB over - |/      \|____     |<--------------------------------->|
 *     seabed ~~~~~~             \    |<- dim_range ->|                   |  ~~~~~~~~~~~~
 *                                \   |_______        |                   | /
 *     6 dB under -                \__|       \_______|__________________/|/
 *                                                     shadow_contrast of the darkest third
 *
 * In truth the names `highlight`, `shadow`, `box` and their pixels are those of masks, which only
 * truth knows. The mask of a highlight is where the object's echo dominates. The mask of a shadow
 * is where more than half of the seabed's energy is hidden, a rim included. Boxes by the thresholds
 * here are `highlight_box` and `shadow_box` in JSON.
 *
 * NaN: absent or unknown. Thresholds apply to means of 3 x 3 pixels. A highlight is 6 dB over the
 * seabed, and less than 20 dB under the contact's brightest. A shadow is 9 or more pixels that are
 * 6 dB under the seabed.
 *
 * Edges are the likeliest ones amid speckle, to fractions of a pixel. A highlight ends where
 * intensities fall below 6 dB over the seabed, less the spread by the point response. Its length
 * along the track is measured on lines laid along the highlight, between the ends of its outermost
 * columns. Its range length is measured across the middle third of its rows. A shadow begins where
 * the last lit part ends. Lit is brighter than the geometric mean of shadow and seabed, and than
 * side lobes of the highlight may be. The shadow ends half way up the penumbra towards the seabed.
 * Its range length is the mean across the middle third of its rows.
 *
 * A thick target leaves a part between its bright face and its shadow. If this part is lit, such as
 * a level top, it is `gap` and no part of the shadow's length. If it is nearly as dark as the
 * shadow, it is `dim`, the first part of that length, caused by the target or by side lobes in
 * range. A face that is no brighter than the shadow is not seen. The upper side of a round target,
 * where sound grazes it, counts as shadow.
 *
 * Errors are standard errors by speckle alone. They leave out that a shadow's rows differ in
 * length, and what is lit below a raised target, of which up to 2 pixels count as shadow. That of a
 * highlight along the track is at least the change of this length if the 6 dB become 4.5 or 7.5 dB.
 * This is much where a highlight fades towards its ends, or has lumps there. For slabs in random
 * poses that stand in the seabed, whose geometry is known, shadows are off by 1.2 errors (rms) and
 * highlights by 0.8. For thick targets, whose tops end in between, shadows are off by up to twice
 * as many (tests/physics/test_contact_measures.c). Highlights of rough targets are off by 0.8 to
 * 1.2 errors, and by up to 3 where few, bright lumps of fouling show. */
typedef struct sonject_contact_measures {
    uint32_t struct_size;
    uint32_t is_cut; /* 1: highlight or shadow reaches the edge of the image or of the box, and
                        lengths may be too short */
    sonject_box highlight; /* box of the highlight's pixels; rows 0: none */
    sonject_box shadow;    /* box of the shadow's pixels, in the highlight's rows, beyond its near
                              edge; rows 0: none */
    double highlight_along_pixels;
    double highlight_range_pixels;
    double shadow_along_pixels; /* extent across the shadow's darkest columns */
    double shadow_range_pixels; /* the shadow's length */
    double highlight_along_m;
    double highlight_range_m;
    double shadow_along_m;
    double shadow_range_m;
    double axis_length_m; /* length of a uniform bar with the highlight's second moments of energy,
                             along the principal axis */
    double axis_width_m;  /* width of this bar, across the axis */
    double axis_rad;      /* direction of the axis, from along-track towards range, -pi/2...pi/2 */
    double highlight_db;  /* mean intensity of the highlight's pixels, 10 log10 of squared amplitude
                             units */
    double shadow_db; /* mean over the darkest third of the shadow's columns in the middle third of
                         its rows */
    double seabed_db; /* median of means of 6 x 6 pixels around the box */
    double highlight_contrast_db; /* contrast over the seabed; the standard error of both contrasts
                                     is 0.4 dB for contacts of 100 pixels and more of single-look
                                     speckle */
    double shadow_contrast_db;
    double seabed_shape; /* this and the next three: of the whole image without the contacts that
                            are measured with it, as in sonject_measurement */
    double seabed_looks;
    double row_length_pixels;
    double column_length_pixels;
    double gap_range_pixels; /* distance from the highlight's far edge to the beginning of the
                                shadow */
    double gap_range_m;
    double dim_range_pixels; /* first part of the shadow's length if it is brighter than the rest,
                                else 0 */
    double dim_range_m;
    double highlight_along_error_pixels;
    double highlight_range_error_pixels;
    double shadow_along_error_pixels;
    double shadow_range_error_pixels;
    double gap_range_error_pixels;
    double dim_range_error_pixels;
    sonject_box box; /* the box that was measured */
    /* Visibility to somebody who labels images. Highlight: its brightest mean of 3 x 3 pixels over
     * the 99.5 % quantile of such means of the seabed within 24 pixels. Shadow: its darkest mean of
     * 3 rows and 7 columns over the 0.5 % quantile, below 0 if darker than all but the darkest
     * seabed. NaN: no such part, or hardly any seabed about it. */
    double highlight_visibility_db;
    double shadow_visibility_db;
} sonject_contact_measures;

/* Measures a contact in pixels in memory. box: pixels of the image, around highlight and shadow
 * with some seabed; NULL: the whole image, of which the highlight of most energy is taken. Spacings
 * are in m; 0: unknown, and lengths are known in pixels alone. measures->struct_size must be set.
 * Errors: ARGUMENT, INPUT (box outside the image, a dark image), MEMORY. */
SONJECT_API sonject_status sonject_measure_contact(sonject_context *context,
                                                   const sonject_pixels *pixels,
                                                   const sonject_box *box, double row_spacing_m,
                                                   double column_spacing_m,
                                                   sonject_contact_measures *measures);

/* Measures contacts of an image. *text gets JSON, {"contacts": [...]}, with the members of
 * sonject_contact_measures (null: not known). *text is the caller's, for sonject_text_release; on
 * failure it is NULL. Contacts come in the order of boxes, then of truth. Errors: ARGUMENT, INPUT,
 * STORAGE, MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_measure_contacts(sonject_context *context,
                                                    const sonject_measure_params *params,
                                                    char **text);

SONJECT_END_DECLARATIONS

#endif
