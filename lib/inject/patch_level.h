/* The measured patch as reflectivity: its level, its map, and its scale to cross-sections; and
 * echoes scaled to the level that their objects were given. */
#ifndef SONJECT_INJECT_PATCH_LEVEL_H
#define SONJECT_INJECT_PATCH_LEVEL_H

#include "base/report.h"
#include "inject/echoes.h"
#include "inject/injection.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"
#include "scene/scene.h"

/* Owned planes, rows x columns of the view. */
struct patch_level {
    float *intensity;     /* measured */
    float *level;         /* smooth local mean of it, > 0 */
    float *map;           /* reflectivity over mu0 for the tracer */
    float *cell_energy;   /* expected cross-section of a pixel of plain seabed (mu0), m^2; a column
                             each */
    double noise_ratio;   /* noise energy over level */
    size_t water_columns; /* before the first return from the bottom; their level is that of the
                             seabed nearby */
};

/* pixels: amplitudes or pairs, in the view's row order. Errors: INPUT (nothing but zeros; not a
 * finite number: says where), MEMORY. On failure nothing is held. */
sonject_status patch_level_init(struct patch_level *level, struct report *report,
                                const struct scene *scene, const struct patch_view *view,
                                const struct point_response *response, const float *pixels,
                                bool is_complex);
void patch_level_clear(struct patch_level *level);

/* Expected cross-section in m^2 of a pixel of Lambert seabed (mu) at a processor range: mu sin^2 of
 * the grazing angle times the area that the point response covers. */
double seabed_cell_energy(const struct patch_view *view, const struct point_response *response,
                          double mu, double processor_range_m);

/* Finds for each object the factor that gives its echo's peak the level it asks for,
 * and scales fields and energies by it: at each pixel by the mean of the objects' factors, weighted
 * with their energies there, which is exact where one object is heard. Tells level_kind,
 * level_gain_db, over_seabed_db and seabed_strength_db in result->objects. Errors: MEMORY. */
sonject_status set_target_levels(const struct tracer *tracer, struct echoes *echoes,
                                 struct injection_result *result);

#endif
