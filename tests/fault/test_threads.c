/* Two threads, each with a context of its own and as many runs as the first: the same images. */
#define _POSIX_C_SOURCE 200809L

#include "claims.h"

#include <pthread.h>

#include <sonject/sonject.h>

#ifndef RUNS
#define RUNS 50 /* of each thread; a slow checker may be compiled with fewer */
#endif
#define SIDE  24
#define KINDS 3 /* different scenes, which a thread takes in turn */

struct images {
    float pixels[KINDS][SIDE * SIDE];
};

struct worker {
    const struct images *expected; /* NULL: fill `images` with one run of each kind */
    struct images images;
    unsigned first_kind;
    bool is_right;
    char message[512];
};

static bool note(struct worker *worker, sonject_context *context, sonject_status status)
{
    if (status != SONJECT_OK)
        snprintf(worker->message, sizeof worker->message, "%s: %s", sonject_status_name(status),
                 context ? sonject_context_message(context) : "");
    return status == SONJECT_OK;
}

/* A sphere, whose glint is weak, or a cylinder, in different places. */
static sonject_status fill_scene(sonject_scene *scene, unsigned kind)
{
    sonject_geometry_params geometry;
    sonject_sonar_params sonar;
    sonject_injection_params injection;
    sonject_object_params object;
    sonject_geometry_params_init(&geometry);
    geometry.row_spacing_m = 0.06;
    geometry.column_spacing_m = 0.06;
    geometry.first_slant_range_m = 20.0 + kind;
    sonject_sonar_params_init(&sonar);
    sonar.centre_frequency_hz = 100e3;
    sonar.bandwidth_hz = 15e3;
    sonar.altitude_m = 8.0;
    sonject_injection_params_init(&injection);
    injection.seed = 7 + kind;
    sonject_object_params_init(&object);
    object.shape = kind == 1 ? SONJECT_SHAPE_CYLINDER : SONJECT_SHAPE_SPHERE;
    object.diameter_m = 0.3;
    object.length_m = kind == 1 ? 0.5 : 0.0;
    sonject_status status = sonject_scene_set_geometry(scene, &geometry);
    if (status == SONJECT_OK)
        status = sonject_scene_set_sonar(scene, &sonar);
    if (status == SONJECT_OK)
        status = sonject_scene_set_injection(scene, &injection);
    if (status == SONJECT_OK)
        status = sonject_scene_set_input_uniform(scene, SIDE, SIDE);
    return status == SONJECT_OK ? sonject_scene_add_object(scene, &object, NULL) : status;
}

static bool inject(struct worker *worker, sonject_context *context, unsigned kind, float *pixels)
{
    sonject_scene *scene = NULL;
    sonject_result *result = NULL;
    sonject_status status = sonject_scene_create(context, &scene);
    if (status == SONJECT_OK)
        status = fill_scene(scene, kind);
    if (status == SONJECT_OK)
        status = sonject_inject(context, scene, NULL, NULL, NULL, &result);
    if (status == SONJECT_OK)
        status =
            sonject_result_layer(result, SONJECT_LAYER_IMAGE, pixels, SIDE * SIDE * sizeof *pixels);
    const bool is_done = note(worker, context, status);
    sonject_result_release(&result);
    sonject_scene_release(&scene);
    return is_done;
}

static void *work(void *argument)
{
    struct worker *worker = argument;
    sonject_context *context = NULL;
    float pixels[SIDE * SIDE];
    worker->is_right = note(worker, NULL, sonject_context_create(NULL, &context));
    const unsigned runs = worker->expected ? RUNS : KINDS;
    for (unsigned run = 0; worker->is_right && run < runs; run++) {
        const unsigned kind = (worker->first_kind + run) % KINDS;
        float *to = worker->expected ? pixels : worker->images.pixels[kind];
        worker->is_right = inject(worker, context, kind, to);
        if (worker->is_right && worker->expected &&
            memcmp(pixels, worker->expected->pixels[kind], sizeof pixels) != 0) {
            snprintf(worker->message, sizeof worker->message, "run %u gives another image", run);
            worker->is_right = false;
        }
    }
    sonject_context_release(&context);
    return NULL;
}

static void test_two_threads_give_what_one_gives(void **state)
{
    struct worker *workers = calloc(3, sizeof *workers);
    pthread_t threads[2];
    assert_non_null(workers);
    (void)work(&workers[2]);
    if (!workers[2].is_right)
        fail_msg("%s", workers[2].message);
    assert_memory_not_equal(workers[2].images.pixels[0], workers[2].images.pixels[1],
                            sizeof workers[2].images.pixels[0]);
    for (unsigned i = 0; i < 2; i++) {
        workers[i].expected = &workers[2].images;
        workers[i].first_kind = i;
        assert_int_equal(pthread_create(&threads[i], NULL, work, &workers[i]), 0);
    }
    for (size_t i = 0; i < 2; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    for (size_t i = 0; i < 2; i++)
        if (!workers[i].is_right)
            fail_msg("thread %zu: %s", i, workers[i].message);
    free(workers);
}

TEST_PROGRAM(NULL, NULL, TEST(test_two_threads_give_what_one_gives))
