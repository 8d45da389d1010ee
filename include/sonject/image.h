/* Sonar images: what a pixel's number means and where on the seabed it lies. */
#ifndef SONJECT_IMAGE_H
#define SONJECT_IMAGE_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

/* The side of the track that the image shows. */
typedef enum sonject_side {
    SONJECT_SIDE_PORT = 0,
    SONJECT_SIDE_STARBOARD = 1
} sonject_side;

/* Rows are track positions, columns slant range: pixel (n, j) is centred on track position
 * first_along_track_m + n * row_spacing_m and slant range first_slant_range_m + j *
 * column_spacing_m, range being reference sound speed * time / 2. */
typedef struct sonject_geometry_params {
    uint32_t struct_size;
    uint32_t side; /* sonject_side; poses are meant in the image's own ping order on either side */
    double row_spacing_m;       /* > 0 */
    double column_spacing_m;    /* > 0 */
    double first_along_track_m; /* finite */
    double first_slant_range_m; /* of column 0 of the whole image; the patch must reach ranges
                                   above the altitude */
} sonject_geometry_params;

/* 2.5 cm pixels, port. first_slant_range_m is NaN, which is refused: it must be set. */
SONJECT_API void sonject_geometry_params_init(sonject_geometry_params *geometry);

/* A channel of an XTF file: a number as the file counts them, or the only one of a side. */
enum {
    SONJECT_CHANNEL_PORT = -1,
    SONJECT_CHANNEL_STARBOARD = -2,
    SONJECT_CHANNEL_ONLY = -3 /* the file's only sidescan channel */
};

/* How stored numbers came from amplitudes. v: stored value, as a number; q: v / full scale, which
 * unless said otherwise is 255 or 65535 for 8 and 16 bit images and 1 for floating point. Amplitude
 * is relative to full scale. */
typedef enum sonject_transfer {
    SONJECT_TRANSFER_AMPLITUDE = 0, /* amplitude = q */
    SONJECT_TRANSFER_INTENSITY = 1, /* amplitude = sqrt(q) */
    SONJECT_TRANSFER_DECIBEL = 2,   /* amplitude = 10^((v * parameter + offset) / 20), parameter in
                                       dB per unit of v, 1e-6...1000; offset within +-1000 dB */
    SONJECT_TRANSFER_GAMMA = 3,     /* amplitude = q^parameter, parameter 0.01...100 */
    SONJECT_TRANSFER_SCHLICK = 4    /* amplitude = q / (b - (b - 1) q), b = parameter >= 1 */
} sonject_transfer;

/* The transfer function of an image file, see sonject_transfer. */
typedef struct sonject_transfer_params {
    uint32_t struct_size;
    uint32_t kind; /* sonject_transfer */
    double parameter;
    double offset;
    double full_scale; /* the largest value that the recorder stores, such as 32767 or 4095 in 16
                          bits: pixels there count as clipped, and none brighter is written; 0 or
                          more than the type's: the type's. Floating point is only scaled by it */
} sonject_transfer_params;

/* Plain amplitude. */
SONJECT_API void sonject_transfer_params_init(sonject_transfer_params *transfer);

/* A synthetic seabed: amplitude with K-distributed speckle on patches and ripples. */
typedef struct sonject_synthetic_params {
    uint32_t struct_size;
    uint32_t complex_pixels; /* 1: complex, 0: amplitude */
    uint32_t rows;           /* 1...2^20 */
    uint32_t columns;        /* 1...2^20; rows * columns at most 2^31 */
    uint64_t seed;
    double speckle_shape;       /* K-distribution's shape, >= 0.01; infinite: Rayleigh amplitude */
    double texture_length_m;    /* correlation length of the K texture, > 0 */
    double ripple_wavelength_m; /* > 0 */
    double ripple_contrast;     /* 0...1, 0: no ripples */
    double ripple_heading_rad;  /* direction across the crests, from +x towards +y */
    double patch_contrast_db;   /* 0...100, level step between sediment patches; 0: one sediment */
    double patch_length_m;      /* typical size of a patch, > 0 */
    double mean_amplitude;      /* rms amplitude of the darker sediment, > 0 */
} sonject_synthetic_params;

/* 400 x 400 amplitudes, sand ripples on half of the ground. */
SONJECT_API void sonject_synthetic_params_init(sonject_synthetic_params *synthetic);

SONJECT_END_DECLARATIONS

#endif
