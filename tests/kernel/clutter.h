/* Hundreds of objects of all shapes for the tests of the hierarchy over objects: strewn, touching,
 * one in the other, and the same one twice. */
#ifndef SONJECT_TESTS_CLUTTER_H
#define SONJECT_TESTS_CLUTTER_H

#include "physics/bench.h"
#include "trace/object_buffer.h"

/* Fills the scene of a bench, before bench_ready. count <= 250. size: of the largest object, m. */
void clutter_strew(struct bench *bench, uint32_t count, double size);

enum search_question {
    SEARCH_NEAREST,  /* find_nearest_hit: distance, object */
    SEARCH_OBSTACLE, /* find_obstacle: -1 where something is within the limit */
    SEARCH_AHEAD,    /* find_nearest_ahead: rays leave an object behind */
    SEARCH_QUESTIONS
};

/* The number of input planes, of `rays` elements each: x, y, z of points, then of directions,
 * limits, and numbers of the objects left behind. */
#define SEARCH_INPUTS 8

/* Answer a question for rays [0, rays), a multiple of 8, as plain C of one lane and as native
 * vectors of 8. distance, object: an answer for each ray; obstacles leave distance 0. */
void clutter_search_one(const struct object_record *objects, int count,
                        enum search_question question, const float *input, float *distance,
                        int32_t *object, uint32_t rays);
void clutter_search_wide(const struct object_record *objects, int count,
                         enum search_question question, const float *input, float *distance,
                         int32_t *object, uint32_t rays);

#endif
