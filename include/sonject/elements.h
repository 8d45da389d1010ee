/* Element level: time series of each hydrophone of an along-track array, for a user's own
 * beamformer. Transmitter and hydrophones lie on the sonar's track, parallel to it, and stand still
 * from ping to echo (stop and hop). SI units. */
#ifndef SONJECT_ELEMENTS_H
#define SONJECT_ELEMENTS_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/result.h>
#include <sonject/run.h>
#include <sonject/scene.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* The form of a series. Each impulse that image formation draws is heard as a point at its track
 * position x' and its processor range r' from the track. Impulses come from all targets and, in
 * resynthesise mode, from the seabed. In composite mode only targets are heard, since the seabed is
 * the measured image, which has no element data. A point at the distances R_t and R_r from
 * transmitter and hydrophone is heard after the delay tau = (R_t + R_r) / c as
 *
 *     A b_t b_r / (R_t R_r) exp(+i 2 pi f0 tau) g(t - tau)
 *
 * where |A|^2 is a backscattering cross-section in m^2, and b = sinc(length sin(aspect) /
 * wavelength) at f0. A series is the pressure over that of the source at 1 m, without absorption,
 * unless source_level_db makes it a pressure. */
typedef enum sonject_series_form {
    SONJECT_SERIES_BASEBAND = 0, /* the complex envelope above */
    SONJECT_SERIES_PASSBAND = 1  /* the real part of this envelope times exp(-i 2 pi f0 t) */
} sonject_series_form;

/* The pulse g of a series. */
typedef enum sonject_series_pulse {
    SONJECT_SERIES_COMPRESSED = 0, /* g: the image's own pulse, exp(-t^2 / (2 sigma^2)) */
    SONJECT_SERIES_CHIRP = 1       /* g: as transmitted from t = 0 on, with unit amplitude, from the
                                      lowest to the highest frequency of the band */
} sonject_series_pulse;

/* The scene's section elements, with every default filled in. Along-track positions are those of
 * the image's geometry. Offsets are measured along the track from the array's origin. */
typedef struct sonject_elements_params {
    uint32_t struct_size;
    uint32_t form;        /* sonject_series_form */
    uint32_t pulse;       /* sonject_series_pulse */
    uint32_t hydrophones; /* 1...65536 */
    uint32_t pings;       /* at most 2^24; 0: enough for the patch's whole aperture */
    uint32_t reserved;
    double first_ping_m;   /* position of the array's origin; NaN: pings are centred on the patch */
    double ping_spacing_m; /* 0: half the array, so that phase centres are evenly spaced */
    double transmitter_offset_m; /* offset of the transmitter's middle */
    double transmitter_length_m; /* NaN: twice the along-track resolution; 0: omnidirectional */
    double first_hydrophone_m;   /* offset of its middle; NaN: the array is centred on its origin */
    double hydrophone_spacing_m; /* 0: the hydrophone's length or, if it is 0, the default length */
    double hydrophone_length_m;  /* NaN: twice the along-track resolution; 0: omnidirectional */
    double sampling_rate_hz; /* at least the bandwidth, in pass band plus twice the frequency; 0:
                                twice the bandwidth, in pass band plus twice the frequency */
    double first_time_s; /* first sample, after transmission; NaN: as the patch's aperture needs */
    double last_time_s;  /* last sample; NaN: as the patch's aperture needs */
    double chirp_duration_s; /* duration of the chirp, above 0 */
    double aspect_limit_rad; /* largest angle off abeam of echoes, 0...pi/2; 0: no limit */
    double source_level_db;  /* rms source level re 1 uPa at 1 m, 0...300: the series are pressures
                                in Pa (for a tone sqrt(2) times its rms), less the water's absorption
                                on the way to each echo abeam and back; NaN: the series are ratios */
} sonject_elements_params;

/* The places and times of a series. */
typedef struct sonject_element_layout {
    uint32_t struct_size;
    uint32_t reserved;
    sonject_elements_params elements;
    uint64_t samples;       /* samples of each hydrophone and ping */
    double sound_speed_mps; /* sound speed for the delays, the image processor's */
    double centre_frequency_hz;
    double bandwidth_hz;
    double along_track_resolution_m; /* resolution of images */
} sonject_element_layout;

/* Describes the series of a patch of rows x columns pixels; both 0: of the uniform or synthetic
 * patch that the scene makes. layout->struct_size must be set. Errors: ARGUMENT, INPUT (no pixels,
 * too low a sampling rate, empty windows, ...). */
SONJECT_API sonject_status sonject_elements_describe(sonject_context *context,
                                                     const sonject_scene *scene, uint64_t rows,
                                                     uint64_t columns,
                                                     sonject_element_layout *layout);

/* Computes the series into exactly `bytes` bytes of the caller's: float, pings x hydrophones x
 * samples, in base band pairs of real and imaginary part. pixels, progress: as for sonject_inject.
 * The scene's injection.estimator must be connect, and its objects' levels physical. The time grows
 * with impulses x hydrophones x pings. Errors: ARGUMENT, INPUT, DEVICE, MEMORY, CANCELLED; the
 * buffer's contents are then undefined. */
SONJECT_API sonject_status sonject_element_series(sonject_context *context,
                                                  const sonject_scene *scene,
                                                  const sonject_pixels *pixels,
                                                  sonject_progress_function progress, void *user,
                                                  float *series, size_t bytes);

/* Computes the series of the scene's own input and writes them into the folder: series.npy (NumPy's
 * format, complex64 or float32, [ping, hydrophone, sample]), then elements.json, which describes
 * the geometry. Series in the folder are kept or refused, as sonject_run does with its result. Each
 * file appears whole or not at all. Errors: as of sonject_element_series, also STORAGE, UNSUPPORTED
 * (no raster files in this build). */
SONJECT_API sonject_status sonject_elements_run(sonject_context *context,
                                                const sonject_scene *scene,
                                                const sonject_run_params *params,
                                                sonject_progress_function progress, void *user);

SONJECT_END_DECLARATIONS

#endif
