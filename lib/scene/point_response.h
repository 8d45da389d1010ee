/* The point response of the formed image, along-track (W) and in range (G), as pure functions of
 * the sonar. Distances are in m. W and G are 1 at 0, measured ones 1 at their largest sample. W of
 * a synthetic aperture is the window's, or measured, and the same at all ranges; W of a real
 * aperture is the array's two-way beam. Residual motion makes W differ from row to row
 * (scene/motion_response.h). Formulas: kernels/MATH.md, "Point response". */
#ifndef SONJECT_SCENE_POINT_RESPONSE_H
#define SONJECT_SCENE_POINT_RESPONSE_H

#include <stdbool.h>

#include "scene/params.h"

#include "base/report.h"
#include "scene/response_table.h"

#define MARGIN_ENERGY_SHARE 0.005 /* share of |W|^2 and |G|^2 beyond a grid's margins */
#define LOBE_LOSS           0.1   /* share of a measured W or G outside its main lobe, at most */
#define MOTION_SHARES       3

/* The pulses: ROW(number, after SONJECT_PULSE_; word in scene files). The functions of
 * point_response.c whose names begin with the word define a pulse. */
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
    double resolution_m; /* delta: aspects within +-wavelength/(4 delta) are integrated */
    double strip_m;      /* longest strip of independent deviates that W does not alias */
    int terms;           /* cosine terms of the aspect weighting */
    double weights[16];  /* weights of terms m = 1..., relative to the constant one */

    sonject_pulse_kind pulse_kind;
    double range_resolution_m; /* c / 2B, or a table's half-power width where that is less */
    double range_deviation_m;  /* sigma of the Gaussian of that width */
    int pulse_terms;           /* terms and weights of a chirp's spectrum, as above */
    double pulse_weights[16];
    const struct response_table *pulse_table; /* borrowed */
    double metres_per_position;               /* length of one unit of the table's positions, m */
    double pulse_energy_m;                    /* table's integral of |G|^2, m */
    double pulse_margin_m, pulse_reach_m; /* half widths with all but 0.5 % and 0.1 % of |G|^2 */
    double pulse_tail_m; /* half width at which glints' side lobes are cut, at -60 dB */

    const struct response_table *cross_range_table; /* a measured W; borrowed; NULL: none */
    double cross_range_energy_m;
    bool is_mirrored; /* the table's positions are the image's, and the view's are reversed */

    double array_length_m;   /* length of a real aperture; 0: synthetic */
    double array_along[3];   /* the array's long side, in the view's axes */
    double array_altitude_m; /* over the mean seabed */
    double wavelength_m, range_ratio;
    double beam_energy; /* integral of |W|^2 over x / range */

    const struct aperture_motion *motion; /* residual motion; borrowed; NULL: none */
    double motion_range_m;     /* straight range that the motion's effect is computed for */
    double motion_phase_per_m; /* phase of the echo, rad per m of sway */
    double motion_spread_m[MOTION_SHARES]; /* see motion_spread */
    double motion_energy_share;            /* share of the straight W's energy */
};

struct scene;
struct patch_view;

/* Sets all of a scene's response for a patch. cross_range_check tells whether images of a real
 * aperture can have it. Errors: INPUT (responses that exclude each other, tables that no grid of
 * the patch could hold), MEMORY. */
sonject_status point_response_of_scene(struct point_response *response, struct report *report,
                                       const struct scene *scene, const struct patch_view *view,
                                       double reference_sound_speed_mps);

/* Sets the widths of the window's W (delta) and of a Gaussian pulse (half-power, in range). */
void point_response_set_widths(struct point_response *response, double resolution_m,
                               double range_resolution_m);

/* Sets a Gaussian pulse and the sonar's window on a straight track. row_spacing_m replaces a
 * resolution that the sonar does not give. */
void point_response_init(struct point_response *response, const sonject_sonar_params *sonar,
                         double reference_sound_speed_mps, double row_spacing_m);

/* Sets the pulse, after point_response_init. table: for the kind TABLE; borrowed. */
void point_response_set_pulse(struct point_response *response, const sonject_pulse_params *pulse,
                              const struct response_table *table, double reference_sound_speed_mps);

/* Returns the window's real W(x): the weighting is symmetric and the track straight. */
double along_track_response(const struct point_response *response, double distance_m);

/* Returns the integral of W's square over x, m (delta for the rectangular window). */
double along_track_energy_width(const struct point_response *response);

/* Returns the half width, m, beyond which less than `share` of that integral lies. */
double along_track_energy_reach(const struct point_response *response, double share);

/* Returns the half width, m, beyond which |W| is below -60 dB. */
double along_track_tail(const struct point_response *response);

/* Return G(r): exp(-r^2 / 2 sigma^2), a compressed sweep, or a table; real part or complex. */
double range_response(const struct point_response *response, double distance_m);
struct complex_number range_response_complex(const struct point_response *response,
                                             double distance_m);
bool range_response_is_real(const struct point_response *response);

/* Returns the integral of |G|^2 over r, m: sqrt(pi) sigma = 1.0645 c / 2B for the Gaussian. */
double range_energy_width(const struct point_response *response);

/* Returns how far, m, from a point the main lobe of a measured G lies at most; 0 for other pulses.
 */
double range_shift(const struct point_response *response);

/* Returns the half width, m, with all but `share` of that integral; at least 3 resolutions. */
double range_energy_reach(const struct point_response *response, double share);

/* Returns whether W is the real function along_track_response at all ranges and rows. */
bool cross_range_is_plain(const struct point_response *response);

/* Returns W of a pixel `distance_m` farther along the track than the point, at a processor's slant
 * range, without residual motion. */
struct complex_number cross_range_response(const struct point_response *response, double range_m,
                                           double distance_m);

/* Returns the integral of |W|^2 over distance, m. Motion does not change it (Parseval), except for
 * energy from beyond the beam of the elements. */
double cross_range_energy_width(const struct point_response *response, double range_m);

/* Returns the half width, m, beyond which less than `share` of that integral lies. */
double cross_range_energy_reach(const struct point_response *response, double range_m,
                                double share);

/* Returns how far, m, from a point the main lobe of its echo lies at most, moved there by a turned
 * array, residual motion or a measured response; 0 for the others. */
double cross_range_shift(const struct point_response *response, double range_m);

/* Returns the half width, m, that glints are spread over, to where side lobes are below -60 dB;
 * infinite with residual motion. */
double cross_range_tail(const struct point_response *response, double range_m);

/* Checks that images can be formed: echoes must stay within their range cell over a real aperture's
 * beam in all columns, and a turned array needs level ground, straight rays, one interaction and a
 * measured seabed. Errors: INPUT. */
sonject_status cross_range_check(const struct point_response *response, struct report *report,
                                 const struct scene *scene, const struct patch_view *view);

#endif
