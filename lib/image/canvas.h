/* A picture to draw on: RGB bytes, row 0 at the top. Everything outside is cut off. */
#ifndef SONJECT_IMAGE_CANVAS_H
#define SONJECT_IMAGE_CANVAS_H

#include <stdbool.h>
#include <stdint.h>

struct canvas {
    uint8_t *rgb; /* height x width x 3 */
    uint32_t height, width;
};

struct colour {
    uint8_t red, green, blue;
};

/* Allocates the pixels, to be given to free(); false when memory is out. height, width: below
 * 2^30. */
bool canvas_create(struct canvas *canvas, uint32_t height, uint32_t width,
                   struct colour background);

/* coverage 0...1: how much of the pixel takes the colour. */
void canvas_blend(struct canvas *canvas, int64_t x, int64_t y, struct colour colour,
                  double coverage);

void canvas_fill(struct canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                 struct colour colour);

/* A line one pixel wide around the rectangle, outside it. */
void canvas_frame(struct canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                  struct colour colour);

#endif
