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
static sonject_status make_scene(sonject_context *context, unsigned kind, sonject_scene **scene)
{
    char text[500];
    const sonject_scene_read_params params = {.struct_size = sizeof params, .text = text};
    snprintf(text, sizeof text,
             "sonject: 1\n"
             "input: {uniform: {rows: %d, columns: %d}, geometry: {row_spacing: 0.06,\n"
             "  column_spacing: 0.06, first_slant_range: %u}}\n"
             "sonar: {frequency: 100e3, bandwidth: 15e3, altitude: 8}\n"
             "injection: {seed: %u}\n"
             "objects: [{shape: %s, diameter: 0.3}]\n",
             SIDE, SIDE, 20 + kind, 7 + kind, kind == 1 ? "cylinder, length: 0.5" : "sphere");
    return sonject_scene_read(context, NULL, &params, scene);
}

static bool inject(struct worker *worker, sonject_context *context, unsigned kind, float *pixels)
{
    sonject_scene *scene = NULL;
    sonject_result *result = NULL;
    sonject_status status = make_scene(context, kind, &scene);
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
