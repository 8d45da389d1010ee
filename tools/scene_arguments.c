#include "scene_arguments.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

sonject_status scene_arguments_read(sonject_context *context,
                                    const struct scene_arguments *arguments, sonject_scene **scene)
{
    char seed[48];
    size_t count = arguments->overrides.count;
    const char **overrides = calloc(count + 1, sizeof(*overrides));
    if (!overrides)
        return SONJECT_ERROR_MEMORY;
    if (count > 0)
        memcpy(overrides, arguments->overrides.texts, count * sizeof(*overrides));
    snprintf(seed, sizeof(seed), "injection.seed=%llu", (unsigned long long)arguments->seed.value);
    if (arguments->seed.is_given)
        overrides[count++] = seed;
    sonject_scene_read_params params;
    sonject_scene_read_params_init(&params);
    params.allows_user_shapes = arguments->allows_user_shapes;
    const sonject_status status =
        sonject_scene_read_with(context, arguments->path, overrides, count, &params, scene);
    free(overrides);
    return status;
}
