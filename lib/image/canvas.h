/* A picture to draw on: RGB bytes, row 0 at the top, clipped at the edges. Text is ASCII in a plain
 * stroke font with smooth edges. */
#ifndef SONJECT_IMAGE_CANVAS_H
#define SONJECT_IMAGE_CANVAS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct canvas {
    uint8_t *rgb; /* height x width x 3 */
    uint32_t height, width;
};

struct colour {
    uint8_t red, green, blue;
};

/* Creates a canvas, whose pixels the caller frees by free(). Returns false where memory is out.
 * height, width: below 2^30. */
bool canvas_create(struct canvas *canvas, uint32_t height, uint32_t width,
                   struct colour background);

void canvas_fill(struct canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                 struct colour colour);

/* Draws a line one pixel wide around the rectangle, outside it. */
void canvas_frame(struct canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                  struct colour colour);

/* Draws a straight line with round ends and smooth edges; one point makes a dot. Draws nothing
 * where an end is not a finite number. */
void canvas_line(struct canvas *canvas, double x0, double y0, double x1, double y1,
                 double thickness, struct colour colour);

#define FONT_CAPITAL_HEIGHT 12 /* pixels */
#define FONT_ASCENT         14 /* height of the highest stroke above the baseline */
#define FONT_DESCENT        5

enum text_direction {
    TEXT_RIGHTWARDS,
    TEXT_UPWARDS
};

/* Returns the length in pixels of the first `count` characters, or of all if these are fewer. */
int64_t text_length(const char *text, size_t count);

/* Returns how many of the text's first characters fit into a length in pixels. */
size_t text_fit(const char *text, int64_t length);

/* Draws at most `count` characters. x, y: where the baseline begins. Characters other than
 * printable ASCII become boxes. */
void draw_text(struct canvas *canvas, int64_t x, int64_t y, const char *text, size_t count,
               enum text_direction direction, struct colour colour);

#endif
