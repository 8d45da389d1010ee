/* Hashes that tell whether two runs have the same inputs. */
#ifndef SONJECT_INJECT_SCENE_HASH_H
#define SONJECT_INJECT_SCENE_HASH_H

#include <jansson.h>

#include "base/hash.h"
#include "base/report.h"
#include "device/device.h"
#include "scene/scene.h"

/* Hashes everything that the result depends on: version, scene, and the input's identity. Places of
 * files and the device do not count, since the answer does not depend on them. Errors: MEMORY. */
sonject_status scene_hash(struct report *report, const struct scene *scene,
                          const char *input_identity, char hash[HASH_TEXT_CAPACITY]);

/* Makes the same hash, and lists its digests by sections of the scene's keys in *inputs, with
 * version and seed in clear. *inputs is for json_decref, also on failure. Errors: MEMORY. */
sonject_status scene_inputs(struct report *report, const struct scene *scene,
                            const char *input_identity, char hash[HASH_TEXT_CAPACITY],
                            json_t **inputs);

/* Hashes all that a file of sums depends on: all but the sonar's pulse and cross-range response.
 * Errors: MEMORY. */
sonject_status traced_scene_hash(struct report *report, const struct scene *scene,
                                 const char *input_identity, char hash[HASH_TEXT_CAPACITY]);

/* Hashes the library's version and the kernels' sources. Errors: MEMORY. */
sonject_status code_hash(struct report *report, char hash[HASH_TEXT_CAPACITY]);

#endif
