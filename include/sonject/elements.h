/* Element level: time series of each hydrophone of an along-track array, for a user's own
 * beamformer. Transmitter and hydrophones are on the sonar's track, parallel to it; they stand
 * still from ping to echo (stop and hop). SI units. */
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

/* What is heard is every impulse that image formation draws, as a point at its track position x'
 * and processor range r' from the track: from all targets, and in resynthesise mode from the seabed
 * (in composite mode the seabed is the measured image, which has no element data: targets alone).
 * With R_t, R_r its distances from transmitter and hydrophone, tau = (R_t + R_r) / c arrives
 *
 *     A b_t b_r / (R_t R_r) exp(+i 2 pi f0 tau) g(t - tau)
 *
 * |A|^2 is a backscattering cross-section in m^2, so that a series is the pressure over that of the
 * source at 1 m, without absorption, unless source_level_db makes it a pressure; b = sinc(length
 * sin(aspect) / wavelength) at f0. */
typedef enum sonject_series_form {
    SONJECT_SERIES_BASEBAND = 0, /* the complex envelope above */
    SONJECT_SERIES_PASSBAND = 1  /* the real part of it times exp(-i 2 pi f0 t) */
} sonject_series_form;

/* The pulse g of a series. */
typedef enum sonject_series_pulse {
    SONJECT_SERIES_COMPRESSED = 0, /* g: the image's own pulse, exp(-t^2 / (2 sigma^2)) */
    SONJECT_SERIES_CHIRP = 1       /* g: as transmitted, from t = 0 on: unit amplitude, from the
                                      lowest to the highest frequency of the band */
} sonject_series_pulse;

/* The scene's section elements, with every default filled in. Along-track positions are those of
 * the image's geometry; offsets count from the array's origin, along the track. */
typedef struct sonject_elements_params {
    uint32_t struct_size;
    uint32_t form;        /* sonject_series_form */
    uint32_t pulse;       /* sonject_series_pulse */
    uint32_t hydrophones; /* 1...65536 */
    uint32_t pings;       /* at most 2^24; 0: as many as see the patch's whole aperture */
    uint32_t reserved;
    double first_ping_m;         /* the origin's position; NaN: the pings are about the patch */
    double ping_spacing_m;       /* 0: half the array, so that phase centres are evenly spaced */
    double transmitter_offset_m; /* of its middle */
    double transmitter_length_m; /* NaN: twice the along-track resolution; 0: hears all alike */
    double first_hydrophone_m;   /* offset of its middle; NaN: the array is about its origin */
    double hydrophone_spacing_m; /* 0: the hydrophone's length, or what is its default */
    double hydrophone_length_m;  /* NaN: twice the along-track resolution; 0: hears all alike */
    double sampling_rate_hz; /* at least the bandwidth, in pass band with twice the frequency added;
                                0: twice the bandwidth, with the same */
    double first_time_s;     /* of each ping's first sample, after transmission; NaN, and */
    double last_time_s;      /* NaN: what the patch's aperture needs */
    double chirp_duration_s; /* of the chirp, above 0 */
    double aspect_limit_rad; /* echoes further off abeam are left out, 0...pi/2; 0: none are */
    double source_level_db;  /* rms, over 1 uPa at 1 m, 0...300: the series are then pressures in Pa
                                (of a tone, sqrt(2) times its rms), less the water's absorption on
                                the way to each echo abeam and back; NaN: ratios, see above */
} sonject_elements_params;

/* Where and when a series is taken. */
typedef struct sonject_element_layout {
    uint32_t struct_size;
    uint32_t reserved;
    sonject_elements_params elements;
    uint64_t samples;       /* of each hydrophone and ping */
    double sound_speed_mps; /* of the delays: the image processor's */
    double centre_frequency_hz;
    double bandwidth_hz;
    double along_track_resolution_m; /* of the scene's images */
} sonject_element_layout;

/* What the series of a patch of rows x columns pixels are; both 0: of the uniform or synthetic
 * patch that the scene makes. layout->struct_size must be set. Errors:
 * ARGUMENT, INPUT (no pixels, too low a sampling rate, empty windows, ...). */
SONJECT_API sonject_status sonject_elements_describe(sonject_context *context,
                                                     const sonject_scene *scene, uint64_t rows,
                                                     uint64_t columns,
                                                     sonject_element_layout *layout);

/* Computes the series: float, pings x hydrophones x samples, in base band pairs of real and
 * imaginary part, into exactly `bytes` bytes of the caller's. pixels, progress: as for
 * sonject_inject; the scene's estimator must be SONJECT_ESTIMATOR_CONNECT, and levels of its
 * objects physical. The time it takes grows with impulses x hydrophones x pings. Errors: ARGUMENT,
 * INPUT, DEVICE, MEMORY, CANCELLED; the buffer's contents are then of no meaning. */
SONJECT_API sonject_status sonject_element_series(sonject_context *context,
                                                  const sonject_scene *scene,
                                                  const sonject_pixels *pixels,
                                                  sonject_progress_function progress, void *user,
                                                  float *series, size_t bytes);

/* The same on the scene's own input, into the folder: series.npy (NumPy's format, complex64 or
 * float32, [ping, hydrophone, sample]) and then elements.json, which tells the geometry. Series
 * that the folder has already are kept, or refused, as sonject_run does with its result. Each file
 * appears whole or not at all. Errors: also STORAGE, UNSUPPORTED (no raster files in this build).
 */
SONJECT_API sonject_status sonject_elements_run(sonject_context *context,
                                                const sonject_scene *scene,
                                                const sonject_run_params *params,
                                                sonject_progress_function progress, void *user);

SONJECT_END_DECLARATIONS

#endif
