/* A context that all tests of a program use, and scenes whose keys they set. */
#ifndef SONJECT_TESTS_UNIT_SCENE_CONTEXT_H
#define SONJECT_TESTS_UNIT_SCENE_CONTEXT_H

#include <sonject/sonject.h>

#include "api/handles.h"
#include "claims.h"

static sonject_context *context;

static int make_context(void **state)
{
    return sonject_context_create(NULL, &context) != SONJECT_OK;
}

static int release_context(void **state)
{
    sonject_context_release(&context);
    return 0;
}

static void set(sonject_scene *scene, const char *key, const char *value)
{
    EXPECT_OK(&context->report, sonject_scene_set(scene, key, value));
}

/* Reads a scene from a text, as if from the file `path`, which may be NULL. */
static sonject_scene *read_text(const char *path, const char *text)
{
    sonject_scene *scene = NULL;
    const sonject_scene_read_params params = {.struct_size = sizeof params, .text = text};
    EXPECT_OK(&context->report, sonject_scene_read(context, path, &params, &scene));
    return scene;
}

#endif
