/* A picture to draw on, RGB bytes, row 0 at the top; everything outside is cut off. And a plain
 * stroke font for ASCII text on it, with smooth edges. */
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

/* Allocates the pixels, to be given to free(); false when memory is out. height, width: below
 * 2^30. */
bool canvas_create(struct canvas *canvas, uint32_t height, uint32_t width,
                   struct colour background);

void canvas_fill(struct canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                 struct colour colour);

/* A line one pixel wide around the rectangle, outside it. */
void canvas_frame(struct canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                  struct colour colour);

/* A straight line with round ends and smooth edges; one point makes a dot. Nothing where an end is
 * no number. */
void canvas_line(struct canvas *canvas, double x0, double y0, double x1, double y1,
                 double thickness, struct colour colour);

#define FONT_CAPITAL_HEIGHT 12 /* pixels */
#define FONT_ASCENT         14 /* of the highest stroke above the baseline */
#define FONT_DESCENT        5

enum text_direction {
    TEXT_RIGHTWARDS,
    TEXT_UPWARDS
};

/* Length of the first `count` characters, or of the whole text if that is shorter, in pixels. */
int64_t text_length(const char *text, size_t count);

/* How many of the text's first characters are at most that long. */
size_t text_fit(const char *text, int64_t length);

/* Draws at most `count` characters; x, y: where the baseline begins. Other than printable ASCII
 * characters become boxes. */
void draw_text(struct canvas *canvas, int64_t x, int64_t y, const char *text, size_t count,
               enum text_direction direction, struct colour colour);

#endif
