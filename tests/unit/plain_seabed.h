/* A seabed without ripples and patches: nothing but speckle. */
#ifndef SONJECT_TESTS_PLAIN_SEABED_H
#define SONJECT_TESTS_PLAIN_SEABED_H

#include "claims.h"

#include "image/synthetic.h"
#include "scene/scene.h"

/* Returns the amplitudes, which the caller frees. Responses: a sinc of row_width pixels, a Gaussian
 * of a -3 dB width of column_width pixels. shape: of the K distribution; INFINITY: Rayleigh. */
static inline float *make_plain_seabed(uint32_t rows, uint32_t columns, double shape,
                                       double row_width, double column_width, uint64_t seed)
{
    struct report report = {.host = NULL};
    struct scene scene;
    float *pixels = zeroed((size_t)rows * columns, sizeof *pixels);
    scene_init(&scene);
    sonject_synthetic_params *synthetic = &scene.synthetic;
    scene.geometry.first_slant_range_m = 40.0;
    synthetic->rows = rows;
    synthetic->columns = columns;
    synthetic->seed = seed;
    synthetic->speckle_shape = shape;
    synthetic->ripple_contrast = 0.0;
    synthetic->patch_contrast_db = 0.0;
    EXPECT_OK(&report, synthesise_seabed(&report, synthetic, &scene.geometry, row_width * 0.025,
                                         column_width * 0.025, pixels));
    return pixels;
}

#endif
