#include "image/canvas.h"

#include <stddef.h>

#include "base/memory.h"

bool canvas_create(struct canvas *canvas, uint32_t height, uint32_t width, struct colour background)
{
    canvas->height = height;
    canvas->width = width;
    canvas->rgb = allocate_array(height, (size_t)width * 3);
    if (!canvas->rgb)
        return false;
    canvas_fill(canvas, 0, 0, width, height, background);
    return true;
}

static uint8_t mix(uint8_t under, uint8_t over, double coverage)
{
    return (uint8_t)(under + (over - under) * coverage + 0.5);
}

void canvas_blend(struct canvas *canvas, int64_t x, int64_t y, struct colour colour,
                  double coverage)
{
    if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height)
        return;
    uint8_t *pixel = canvas->rgb + ((size_t)y * canvas->width + (size_t)x) * 3;
    pixel[0] = mix(pixel[0], colour.red, coverage);
    pixel[1] = mix(pixel[1], colour.green, coverage);
    pixel[2] = mix(pixel[2], colour.blue, coverage);
}

void canvas_fill(struct canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                 struct colour colour)
{
    const int64_t right = x + width < canvas->width ? x + width : canvas->width;
    const int64_t bottom = y + height < canvas->height ? y + height : canvas->height;
    for (int64_t row = y > 0 ? y : 0; row < bottom; row++) {
        for (int64_t column = x > 0 ? x : 0; column < right; column++) {
            uint8_t *pixel = canvas->rgb + ((size_t)row * canvas->width + (size_t)column) * 3;
            pixel[0] = colour.red;
            pixel[1] = colour.green;
            pixel[2] = colour.blue;
        }
    }
}

void canvas_frame(struct canvas *canvas, int64_t x, int64_t y, int64_t width, int64_t height,
                  struct colour colour)
{
    canvas_fill(canvas, x - 1, y - 1, width + 2, 1, colour);
    canvas_fill(canvas, x - 1, y + height, width + 2, 1, colour);
    canvas_fill(canvas, x - 1, y, 1, height, colour);
    canvas_fill(canvas, x + width, y, 1, height, colour);
}
