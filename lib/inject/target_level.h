/* Echoes scaled to the level that their objects were given. */
#ifndef SONJECT_INJECT_TARGET_LEVEL_H
#define SONJECT_INJECT_TARGET_LEVEL_H

#include "inject/echoes.h"
#include "inject/injection.h"

/* Finds for each object the factor that gives its echo's peak the level it asks for,
 * and scales fields and energies by it: at each pixel by the mean of the objects' factors, weighted
 * with their energies there, which is exact where one object is heard. Tells level_kind,
 * level_gain_db, over_seabed_db and seabed_strength_db in result->objects. Errors: MEMORY. */
sonject_status set_target_levels(const struct tracer *tracer, struct echoes *echoes,
                                 struct injection_result *result);

#endif
