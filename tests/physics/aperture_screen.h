/* A screen before a synthetic aperture: what its shadow must be, and what it is. */
#ifndef SONJECT_TESTS_APERTURE_SCREEN_H
#define SONJECT_TESTS_APERTURE_SCREEN_H

#include "bench.h"

#define ROWS        241
#define COLUMNS     401
#define MIDDLE_ROW  120
#define ROW_SPACING 0.025 /* m */

/* A patch whose middle column is at a range, seen by the aspects of its response, whose resolution
 * is the row spacing. */
void open_synthetic_aperture(struct bench *bench, double range_m, uint32_t window,
                             double ray_scale);

/* An upright screen across the track's normal in the middle row, its foot at a ground range. */
void add_screen(struct bench *bench, double width_m, double height_m, double ground_range_m);

/* Visibility of every pixel, for free(). */
double *visibility_of(struct bench *bench);

/* Energy window of the aspects, over one period of the offset. */
double window_energy(uint32_t window, double offset);

/* Visibility at x along the track behind a screen of `width` around 0, at a distance d behind it in
 * the plane across the track: the aspects whose way from there, x - d tan(aspect) at the screen, is
 * beside it. Lambert's law gives each aspect the square of its cosine. */
double expected_visibility(double x, double width, double d, double largest_sine, uint32_t window);

/* Distance, along the sound's way in the plane across the track, from the screen to a column's
 * seabed. */
double distance_behind(const struct bench *bench, double column, double screen_ground);

/* The first column at least that far behind. */
size_t column_behind(const struct bench *bench, double screen_ground, double distance);

/* Mean over nine columns, which the pulse joins anyway, in a row. */
double visibility_at(const double *visibility, size_t row, size_t column);

/* Rms over all rows of visibility_at less what the geometry gives. */
double line_error(const double *visibility, const struct bench *bench, double width, double ground,
                  size_t column, uint32_t window);

#endif
