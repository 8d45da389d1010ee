/* The point response of the formed image, along-track (W) and in range (G): pure functions of the
 * sonar. Distances in m; both are 1 at 0, measured ones 1 at their largest sample. Of a synthetic
 * aperture W is the window's, or a measured one, alike at all ranges; of a real one the array's
 * two-way beam. Residual motion, which makes it differ from row to row: scene/motion_response.h.
 * Formulas: kernels/MATH.md, "Point response". */
#ifndef SONJECT_SCENE_POINT_RESPONSE_H
#define SONJECT_SCENE_POINT_RESPONSE_H

#include <stdbool.h>

#include "scene/params.h"

#include "base/report.h"
#include "scene/response_table.h"

#define MARGIN_ENERGY_SHARE 0.005 /* of |W|^2 and |G|^2 that lies beyond a grid's margins */
#define MOTION_SHARES       3

/* ROW(number: SONJECT_PULSE_ and this, word in scene files). Functions of point_response.c with the
 * word before their names say what a pulse is. */
#define PULSES(ROW)                                                                                \
    ROW(GAUSSIAN, gaussian) /* half-power width c / (2 bandwidth) */                               \
    ROW(CHIRP, chirp)       /* linear sweep over the bandwidth, compressed: the transform of the   \
                               spectrum's weighting */                                             \
    ROW(TABLE, table)       /* samples */

#define PULSE_NUMBER(NUMBER, word) SONJECT_PULSE_##NUMBER,
typedef enum sonject_pulse_kind {
    PULSES(PULSE_NUMBER) PULSE_KINDS
} sonject_pulse_kind;

struct point_response {
    double resolution_m; /* delta: the aspects integrated are within +-wavelength/(4 delta) */
    double strip_m;      /* longest strip of independent deviates that W does not alias */
    int terms;           /* cosine terms of the aspect weighting */
    double weights[16];  /* of term m = 1..., relative to the constant one */

    sonject_pulse_kind pulse_kind;
    double range_resolution_m; /* c / 2B, or a table's half-power width where that is less */
    double range_deviation_m;  /* sigma of the Gaussian of that half-power width */
    int pulse_terms;           /* as terms and weights, of a chirp's spectrum */
    double pulse_weights[16];
    const struct response_table *pulse_table; /* borrowed */
    double metres_per_position;               /* of its positions */
    double pulse_energy_m;                    /* of the table: integral of |G|^2 */
    double pulse_margin_m, pulse_reach_m;     /* where |G|^2 has all but 0.5 %, 0.1 % within */
    double pulse_tail_m;                      /* where glints' side lobes are cut, at -60 dB */

    const struct response_table *cross_range_table; /* a measured W; borrowed; NULL: none */
    double cross_range_energy_m;

    double array_length_m;   /* of a real aperture; 0: synthetic */
    double array_along[3];   /* its long side, in the view's axes */
    double array_altitude_m; /* over the mean seabed */
    double wavelength_m, range_ratio;
    double beam_energy; /* integral of |W|^2 over x / range */

    const struct aperture_motion *motion;  /* residual; borrowed; NULL: none */
    double motion_range_m;                 /* straight range that it is worked out for */
    double motion_phase_per_m;             /* of the echo, rad per m of sway */
    double motion_spread_m[MOTION_SHARES]; /* how much farther the energy of W reaches: see
                                              motion_spread */
    double motion_energy_share;            /* of the straight W's energy */
};

struct scene;
struct patch_view;

/* All that the scene says about it, for a patch; cross_range_check says whether images of a real
 * aperture can have it. Errors: INPUT (responses that exclude each other, tables that no grid of
 * the patch could hold), MEMORY. */
sonject_status point_response_of_scene(struct point_response *response, struct report *report,
                                       const struct scene *scene, const struct patch_view *view,
                                       double reference_sound_speed_mps);

/* The widths of the window's W (delta) and of a Gaussian pulse (half-power, in range). */
void point_response_set_widths(struct point_response *response, double resolution_m,
                               double range_resolution_m);

/* row_spacing_m stands in for the resolution where the sonar does not give one. The pulse is
 * Gaussian, W the sonar's window, the track straight. */
void point_response_init(struct point_response *response, const sonject_sonar_params *sonar,
                         double reference_sound_speed_mps, double row_spacing_m);

/* After point_response_init. table: for the kind TABLE; borrowed. */
void point_response_set_pulse(struct point_response *response, const sonject_pulse_params *pulse,
                              const struct response_table *table, double reference_sound_speed_mps);

/* The window's W(x). Real, because the weighting is symmetric and the track straight. */
double along_track_response(const struct point_response *response, double distance_m);

/* Integral of its square over x, m (delta for the rectangular window). */
double along_track_energy_width(const struct point_response *response);

/* Half width in m beyond which less than `share` of that integral lies. */
double along_track_energy_reach(const struct point_response *response, double share);

/* Half width in m beyond which |W| is below -60 dB. */
double along_track_tail(const struct point_response *response);

/* G(r): exp(-r^2 / 2 sigma^2), or the compressed sweep's; of a table the real part. */
double range_response(const struct point_response *response, double distance_m);
struct complex_number range_response_complex(const struct point_response *response,
                                             double distance_m);
bool range_response_is_real(const struct point_response *response);

/* Integral of |G|^2 over r, m: sqrt(pi) sigma = 1.0645 c / 2B for the Gaussian. */
double range_energy_width(const struct point_response *response);

/* Half width in m beyond which less than `share` of that lies, at least 3 resolutions. */
double range_energy_reach(const struct point_response *response, double share);

/* Whether W is one real function at all ranges and rows: along_track_response. */
bool cross_range_is_plain(const struct point_response *response);

/* W of a pixel `distance_m` farther along the track than the point, at a processor's slant range;
 * without residual motion. */
struct complex_number cross_range_response(const struct point_response *response, double range_m,
                                           double distance_m);

/* Integral of |W|^2 over distance, m. Motion leaves it as it is (Parseval), but for what comes from
 * beyond the beam of the elements. */
double cross_range_energy_width(const struct point_response *response, double range_m);

/* Half width in m beyond which less than `share` of that lies. */
double cross_range_energy_reach(const struct point_response *response, double range_m,
                                double share);

/* Half width in m that glints are spread over: to where side lobes are below -60 dB; infinite with
 * residual motion. */
double cross_range_tail(const struct point_response *response, double range_m);

/* Whether images can be formed so: echoes must stay within their range cell over a real aperture's
 * beam, in all columns of the patch, and a turned array has level ground, straight rays, one
 * interaction and a measured seabed. Errors: INPUT. */
sonject_status cross_range_check(const struct point_response *response, struct report *report,
                                 const struct scene *scene, const struct patch_view *view);

#endif
