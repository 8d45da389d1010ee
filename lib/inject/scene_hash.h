/* Whether two runs have the same inputs. */
#ifndef SONJECT_INJECT_SCENE_HASH_H
#define SONJECT_INJECT_SCENE_HASH_H

#include <jansson.h>

#include "base/hash.h"
#include "base/report.h"
#include "device/device.h"
#include "scene/scene.h"

/* Hash of everything that the result depends on: version, scene, the input's identity, but not
 * where files lie. The device is not part of it, since the answer does not depend on it. Errors:
 * MEMORY. */
sonject_status scene_hash(struct report *report, const struct scene *scene,
                          const char *input_identity, char hash[HASH_TEXT_CAPACITY]);

/* The same, and of what it is made: by sections of the scene's keys, digests, but for the version
 * and the seed. *inputs: for json_decref, also on failure. Errors: MEMORY. */
sonject_status scene_inputs(struct report *report, const struct scene *scene,
                            const char *input_identity, char hash[HASH_TEXT_CAPACITY],
                            json_t **inputs);

/* The hash of what a file of sums cannot be formed without: all but the sonar's pulse and
 * cross-range response. Errors: MEMORY. */
sonject_status traced_scene_hash(struct report *report, const struct scene *scene,
                                 const char *input_identity, char hash[HASH_TEXT_CAPACITY]);

/* Of the library's version and the kernels' sources. Errors: MEMORY. */
sonject_status code_hash(struct report *report, char hash[HASH_TEXT_CAPACITY]);

#endif
