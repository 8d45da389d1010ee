/* The point response of the formed image, along-track (W) and in range (G): pure functions of the
 * sonar. Distances in m; both are 1 at 0. Formulas: kernels/MATH.md, "Point response". */
#ifndef SONJECT_SCENE_POINT_RESPONSE_H
#define SONJECT_SCENE_POINT_RESPONSE_H

#include <stdbool.h>

#include <sonject/sonar.h>

struct point_response {
    double resolution_m;      /* delta: the aspects integrated are within +-wavelength/(4 delta) */
    int terms;                /* cosine terms of the aspect weighting */
    double weights[16];       /* of term m = 1..., relative to the constant one */
    double range_deviation_m; /* sigma of the Gaussian envelope, in apparent range */
};

/* row_spacing_m stands in for the resolution where the sonar does not give one. */
void point_response_init(struct point_response *response, const sonject_sonar_params *sonar,
                         double reference_sound_speed_mps, double row_spacing_m);

/* W(x). Real, because the weighting is symmetric and the track straight. */
double along_track_response(const struct point_response *response, double distance_m);

/* G(r) = exp(-r^2 / 2 sigma^2). */
double range_response(const struct point_response *response, double distance_m);

/* Integral of |W|^2 over x, m (delta for the rectangular window). */
double along_track_energy_width(const struct point_response *response);

/* Integral of G^2 over r, m: sqrt(pi) sigma = 1.0645 c / 2B. */
double range_energy_width(const struct point_response *response);

/* Half width in m beyond which less than `share` of the integral of |W|^2 lies. */
double along_track_energy_reach(const struct point_response *response, double share);

#endif
