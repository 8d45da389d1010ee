/* A plain stroke font for ASCII text, drawn with smooth edges. */
#ifndef SONJECT_IMAGE_FONT_H
#define SONJECT_IMAGE_FONT_H

#include <stddef.h>

#include "image/canvas.h"

#define FONT_CAPITAL_HEIGHT 12 /* pixels */
#define FONT_ASCENT         14 /* of the highest stroke above the baseline */
#define FONT_DESCENT        5

enum text_direction {
    TEXT_RIGHTWARDS,
    TEXT_UPWARDS
};

/* Length of the first `count` characters, or of the whole text if that is shorter, in pixels. */
int64_t text_length(const char *text, size_t count);

/* Draws at most `count` characters; x, y: where the baseline begins. Other than printable ASCII
 * characters become boxes. */
void draw_text(struct canvas *canvas, int64_t x, int64_t y, const char *text, size_t count,
               enum text_direction direction, struct colour colour);

#endif
