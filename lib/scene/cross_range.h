/* The cross-range response W as the image has it: of a synthetic aperture the window's, or a
 * measured one, alike at all ranges; of a real one the array's two-way beam. Residual motion, which
 * makes it differ from row to row: scene/motion_response.h. */
#ifndef SONJECT_SCENE_CROSS_RANGE_H
#define SONJECT_SCENE_CROSS_RANGE_H

#include <stdbool.h>

#include "scene/patch_view.h"
#include "scene/point_response.h"

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

/* Half width in m that glints are spread over: to where a beam's side lobes are below -60 dB;
 * infinite for a synthetic aperture. */
double cross_range_tail(const struct point_response *response, double range_m);

/* Whether images can be formed so: echoes must stay within their range cell over a real aperture's
 * beam, in all columns of the patch, and a turned array has level ground, straight rays, one
 * interaction and a measured seabed. Errors: INPUT. */
sonject_status cross_range_check(const struct point_response *response, struct report *report,
                                 const struct scene *scene, const struct patch_view *view);

#endif
