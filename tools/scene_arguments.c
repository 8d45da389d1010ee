#include "scene_arguments.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

sonject_status scene_arguments_bands(sonject_context *context,
                                     const struct scene_arguments *arguments, char **names)
{
    const sonject_scene_read_params params = {.struct_size = sizeof(params),
                                              .overrides = arguments->overrides.texts,
                                              .override_count =
                                                  (uint32_t)arguments->overrides.count};
    return sonject_scene_bands(context, arguments->path, &params, names);
}

sonject_status scene_arguments_read(sonject_context *context,
                                    const struct scene_arguments *arguments, sonject_scene **scene)
{
    char seed[48];
    char band[SONJECT_NAME_CAPACITY + 8];
    size_t count = arguments->overrides.count;
    const char **overrides = calloc(count + 2, sizeof(*overrides));
    if (!overrides)
        return SONJECT_ERROR_MEMORY;
    if (count > 0)
        memcpy(overrides, arguments->overrides.texts, count * sizeof(*overrides));
    snprintf(seed, sizeof(seed), "injection.seed=%llu", (unsigned long long)arguments->seed.value);
    if (arguments->seed.is_given)
        overrides[count++] = seed;
    if (arguments->band) {
        snprintf(band, sizeof(band), "band=%s", arguments->band);
        overrides[count++] = band;
    }
    const sonject_scene_read_params params = {.struct_size = sizeof(params),
                                              .allows_user_shapes = arguments->allows_user_shapes,
                                              .overrides = overrides,
                                              .override_count = (uint32_t)count};
    const sonject_status status = sonject_scene_read(context, arguments->path, &params, scene);
    free(overrides);
    return status;
}
