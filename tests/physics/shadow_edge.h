/* Where the edge of a shadow lies in an image. */
#ifndef SONJECT_TESTS_SHADOW_EDGE_H
#define SONJECT_TESTS_SHADOW_EDGE_H

#include <stddef.h>

/* Index, as a fraction, at which a line of visibilities (0...1) passes 1/2 between first and last.
 * The edge of a shadow is a step smoothed by G^2, hence an error function, which is what is
 * interpolated. Fails the test if there is no such place. */
double shadow_edge(const double *visibilities, size_t first, size_t last);

#endif
