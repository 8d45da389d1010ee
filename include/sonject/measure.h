/* What an image says about itself: its seabed's speckle, and its contacts. */
#ifndef SONJECT_MEASURE_H
#define SONJECT_MEASURE_H

#include <stdint.h>

#include <sonject/context.h>
#include <sonject/export.h>
#include <sonject/result.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* An image, and what is told of it: a file, or pixels in memory. */
typedef struct sonject_measure_params {
    uint32_t struct_size;
    uint32_t box_count;
    const char *image;            /* one channel, or two: real and imaginary part */
    const sonject_pixels *pixels; /* instead of a file */
    const char *channel; /* of the file, as of sonject_quicklook_params, like the next two */
    const char *array;
    const char *transfer;
    /* For sonject_measure; each may be NULL: mask of the image's size, not 0 where no seabed is,
     * such as highlights and shadows. */
    const char *labels;         /* file */
    const uint8_t *labels_mask; /* the same of pixels: rows x columns bytes */
    /* For sonject_measure_contacts. */
    const char *truth;        /* a run's truth.json: its boxes, and the spacing that they tell; or
                                 NULL */
    const sonject_box *boxes; /* box_count of them, beside those of truth; where neither is given,
                                 contacts are looked for in the whole image */
    double row_spacing_m;     /* 0: as truth or the image's file tells, if they do */
    double column_spacing_m;  /* of slant range */
    double find_contrast_db;  /* a contact's brightest mean of 3 x 3 pixels is at least so far over
                                 the seabed within some 64 pixels of it; 6...100, 0: 12 */
    uint32_t find_most;       /* of the contacts that are looked for, the brightest; 0: 100 */
    uint32_t range_to_left;   /* 1: range grows to the left, as in the port half of an image of two
                                 sides; 0: to the right, or as truth tells */
} sonject_measure_params;

/* What an image says of its seabed. */
typedef struct sonject_measurement {
    uint32_t struct_size;
    uint32_t reserved;
    /* Untouched seabed, medians over blocks of 32 x 32 pixels. NaN: nothing can be told. */
    double amplitude_contrast; /* standard deviation over mean; Rayleigh: 0.523 */
    double intensity_contrast; /* Rayleigh: 1 */
    double looks;              /* independent samples averaged in a pixel, >= 1 */
    double shape;              /* of the K distribution of intensity; infinite: no texture */
    double row_correlation;    /* of speckle's intensity, from a row to the next */
    double column_correlation; /* from a column to the next */
    double row_length_pixels;  /* where the intensity's correlation falls to 1/e, at most 7 */
    double column_length_pixels;
} sonject_measurement;

/* Measures an image. measurement->struct_size must be set. Errors: ARGUMENT, INPUT, STORAGE,
 * MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_measure(sonject_context *context,
                                           const sonject_measure_params *params,
                                           sonject_measurement *measurement);

/* One ruler for measured and injected contacts: what truth (sonject_object_truth, truth.json) tells
 * by these names it has read off the object's expected energies, on plain seabed and without
 * speckle. Across the middle third of the rows, intensity over slant range:
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
 * Truth's own names are those of masks, which only it knows: `highlight`, `shadow`, `box` and their
 * pixels are where the object's echo dominates and where more than half of the seabed's energy is
 * hidden, a rim included. Boxes by the thresholds here are `highlight_box` and `shadow_box` in
 * JSON.
 *
 * NaN: not there, or not known. A highlight are
 * pixels whose mean with their neighbours is 6 dB over the seabed (and less than 20 dB under the
 * contact's brightest), a shadow 9 or more that are 6 dB under it.
 *
 * Edges are the likeliest ones amid speckle, to fractions of a pixel. A highlight's lie where what
 * is at least 6 dB over the seabed goes over into what is no brighter than that, less what the
 * point response spreads. Its length along the track is that of lines laid along it, between the
 * ends of its outermost columns; its range length is across the middle third of its rows. A shadow
 * begins where the last that is lit ends: that is brighter than the geometric mean of shadow and
 * seabed, and than side lobes of the highlight may be. It ends half way up the penumbra towards the
 * seabed. Its range length is the mean across the middle third of its rows.
 *
 * What a thick target leaves between its bright face and its shadow is told apart: `gap` if it is
 * lit, such as a level top, and no part of the shadow's length; `dim` if it is nearly as dark as
 * the shadow, and then it is the first part of that length, which may be the target's or side lobes
 * in range. A face that is no brighter than the shadow is not seen, nor is the upper side of a
 * round target where sound grazes it: it counts as shadow.
 *
 * Errors are standard errors by speckle alone; that a highlight fades towards its ends, or that a
 * shadow's rows are of unlike lengths, is not in them, nor is what is lit below a raised target: up
 * to 2 pixels of it count as shadow. Of slabs in random poses that stand in the seabed, whose
 * geometry is known, shadows are off by 1.1 of them (rms), and highlights by 1.0; of thick targets,
 * whose tops end in between, shadows are by up to twice as many
 * (tests/physics/test_contact_measures.c). */
typedef struct sonject_contact_measures {
    uint32_t struct_size;
    uint32_t is_cut; /* 1: highlight or shadow reaches the edge of the image or of the box, and
                        lengths may be too short */
    sonject_box highlight; /* around its pixels; rows 0: there is none */
    sonject_box shadow;    /* beyond the highlight's near edge, in its rows */
    double highlight_along_pixels;
    double highlight_range_pixels;
    double shadow_along_pixels; /* across its darkest columns */
    double shadow_range_pixels; /* its length */
    double highlight_along_m;
    double highlight_range_m;
    double shadow_along_m;
    double shadow_range_m;
    double axis_length_m; /* of the highlight along its principal axis, of second moments of energy:
                             that of a uniform bar */
    double axis_width_m;  /* likewise, across it */
    double axis_rad;      /* from along-track towards range, -pi/2...pi/2 */
    double highlight_db;  /* mean intensity of its pixels, 10 log10 of squared amplitude units */
    double shadow_db;     /* of the darkest third of its columns in the middle third of its rows */
    double seabed_db;     /* median of means of 6 x 6 pixels around the box */
    double highlight_contrast_db; /* over the seabed; both contrasts' standard error is 0.4 dB for
                                     contacts of 100 pixels and more of single-look speckle */
    double shadow_contrast_db;
    double seabed_shape; /* of the whole image without the contacts that are measured with it, as in
                            sonject_measurement */
    double seabed_looks;
    double row_length_pixels;
    double column_length_pixels;
    double gap_range_pixels; /* from the highlight's far edge to where the shadow begins */
    double gap_range_m;
    double dim_range_pixels; /* of the shadow's length, the first part if it is brighter than the
                                rest; 0: it is not */
    double dim_range_m;
    double highlight_along_error_pixels;
    double highlight_range_error_pixels;
    double shadow_along_error_pixels;
    double shadow_range_error_pixels;
    double gap_range_error_pixels;
    double dim_range_error_pixels;
    sonject_box box; /* that was measured */
    /* Whether somebody who labels images sees it: its brightest mean of 3 x 3 pixels over the
     * 99.5 % quantile of equal means of the seabed within 24 pixels; and its darkest of 3 rows and
     * 7 columns over the 0.5 % quantile, below 0 if it is darker than all but the darkest seabed.
     * NaN: no such part, or hardly any seabed about it. */
    double highlight_visibility_db;
    double shadow_visibility_db;
} sonject_contact_measures;

/* Measures a contact in pixels in memory. box: pixels of the image, around highlight and
 * shadow with some seabed; NULL: the whole image, of which the highlight of most energy is taken.
 * Spacings, m: 0 where they are unknown, and lengths are known in pixels alone.
 * measures->struct_size must be set. Errors: ARGUMENT, INPUT (box outside the image, a dark image),
 * MEMORY. */
SONJECT_API sonject_status sonject_measure_contact(sonject_context *context,
                                                   const sonject_pixels *pixels,
                                                   const sonject_box *box, double row_spacing_m,
                                                   double column_spacing_m,
                                                   sonject_contact_measures *measures);

/* Measures contacts of an image. *text gets JSON, {"contacts": [...], "left_off": N} with the
 * members of sonject_contact_measures (null where they are not known), the caller's for
 * sonject_text_release; NULL on failure. Contacts are those of boxes, then of truth, in their
 * order. Ones that were looked for come the brightest first; none touches the box of a brighter
 * one, nor is it 20 dB fainter than one in its columns within 64 rows, as side lobes are. The water
 * column of a sidescan image and the first return at its end hold none. N tells how many more areas
 * are bright enough. Errors: ARGUMENT, INPUT, STORAGE, MEMORY, UNSUPPORTED. */
SONJECT_API sonject_status sonject_measure_contacts(sonject_context *context,
                                                    const sonject_measure_params *params,
                                                    char **text);

SONJECT_END_DECLARATIONS

#endif
