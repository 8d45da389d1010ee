#include "image/canvas.h"

#include <math.h>

#include "base/memory.h"

#define LETTER_GAP  4    /* pixels between the strokes of neighbouring letters */
#define SPACE_WIDTH 3    /* pixels of a blank, besides the gaps */
#define HALF_STROKE 0.72 /* half a stroke's thickness, pixels */
#define STROKES_MAX 40

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

/* coverage 0...1: the share of the pixel that takes the colour. */
static void blend(struct canvas *canvas, int64_t x, int64_t y, struct colour colour,
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

/* The strokes of each character from ' ' to '~', as points of two characters each. A blank lifts
 * the pen. x is a digit. y is a letter: E on the baseline, M the height of small letters, Q of
 * capitals. A stroke of one point is a dot. */
/* clang-format off */
static const char *const glyphs[] = {
    "", "0Q0I 0E", "0Q0M 3Q3M", "2E4Q 5E7Q 0I8I 1M9M", "7O5P3P1O0N1L3K5K7J8H7F5E3E1F0G 4S4B",
    "2Q3P3N2M1M0N0P1Q2Q 7I8H8F7E6E5F5H6I7I 8Q0E", "8E1N1P2Q4Q5P5N0I0G2E4E8J", "0Q0M",
    "3S1P0M0H1E3B", "0S2P3M3H2E0B", "3Q3K 0P6L 6P0L", "4F4N 0J8J", "1E0B", "0J5J", "0E", "0D6R",
    "3E4E6F7H7N6P4Q3Q1P0N0H1F3E", "0N3Q3E", "0N1P3Q5Q7O7M6K0E7E", "0P2Q5Q7O7M5K3K 5K7I7G5E2E0F",
    "5E5Q0H7H", "6Q1Q0K2L4L6K7I7H6F4E2E0F", "6P4Q3Q1O0K0H1F3E4E6F7H7I6K4L3L1K0I", "0Q7Q2E",
    "3K1L0N1P3Q4Q6P7N6L4K3K1J0H1F3E4E6F7H6J4K", "1F3E4E6G7K7N6P4Q3Q1P0N0M1K3J4J6K7M", "0E 0L",
    "1E0B 1L", "7E0J7O", "0H7H 0L7L", "0E7J0O", "0N1P3Q4Q6P7N7M4J4H 4E",
    "6H6L4L3K3I4H6H8H9K9M8P6Q3Q1P0M0H1F3E7E", "0E4Q8E 1I7I", "0E0Q5Q7P8N7L5K0K 5K7J8H7F5E0E",
    "8O7P5Q3Q1P0N0H1F3E5E7F8G", "0E0Q4Q7P8M8I7F4E0E", "7E0E0Q7Q 0K6K", "0E0Q7Q 0K6K",
    "8O7P5Q3Q1P0N0H1F3E5E7F8H8J5J", "0E0Q 8E8Q 0K8K", "0E0Q", "5Q5H4F3E2E1F0H", "0E0Q 7Q0I 2K7E",
    "0Q0E6E", "0E0Q4H8Q8E", "0E0Q8E8Q", "3E5E7F8H8N7P5Q3Q1P0N0H1F3E", "0E0Q5Q7P8N8M7K5J0J",
    "3E5E7F8H8N7P5Q3Q1P0N0H1F3E 5H8D", "0E0Q5Q7P8N8M7K5J0J 4J8E",
    "8O7P5Q3Q1P0N1L3K5K7J8H7F5E3E1F0G", "0Q8Q 4Q4E", "0Q0H1F3E5E7F8H8Q", "0Q4E8Q", "0Q2E4N6E8Q",
    "0E8Q 0Q8E", "0Q4J8Q 4J4E", "0Q8Q0E8E", "3S0S0B3B", "0R6D", "0S3S3B0B", "0M3Q6M", "0C7C",
    "0Q2N", "7M7E 7J6L4M3M1L0J0H1F3E4E6F7H", "0Q0E 0J1L3M4M6L7J7H6F4E3E1F0H",
    "7K6L4M3M1L0J0H1F3E4E6F7G", "7Q7E 7J6L4M3M1L0J0H1F3E4E6F7H", "0I7I7J6L4M3M1L0J0H1F3E4E6F7G",
    "5Q4Q3P2N2E 0M5M", "7M7C6B4A3A1B 7J6L4M3M1L0J0H1F3E4E6F7H", "0Q0E 0J1L3M4M6L7J7E", "0M0E 0Q",
    "2M2C1A0A 2Q", "0Q0E 6M0H 2J6E", "0Q0G1E2E", "0M0E 0J1L2M3M4L4E 4J5L6M7M8L8E",
    "0M0E 0J1L3M4M6L7J7E", "3E4E6F7H7J6L4M3M1L0J0H1F3E", "0M0A 0J1L3M4M6L7J7H6F4E3E1F0H",
    "7M7A 7J6L4M3M1L0J0H1F3E4E6F7H", "0M0E 0J1L3M4M", "6K5L4M2M0L0K1J5I6H6G5F4E2E1E0F",
    "2P2H3F4E5E 0M5M", "0M0H1F3E4E6F7H 7M7E", "0M3E6M", "0M2E4K6E8M", "0E6M 0M6E", "0M3E 6M3E2B0A",
    "0M6M0E6E", "3S2S1R1L0K1J1C2B3B", "0S0B", "0S1S2R2L3K2J2C1B0B", "0I1J2K3K5I6I7J8K",
};
/* clang-format on */

static const char unknown_glyph[] = "0E0Q7Q7E0E";

struct stroke {
    double x0, y0, x1, y1; /* distance from the letter's left edge, height above the baseline */
};

static const char *glyph_of(char character)
{
    return character >= ' ' && character <= '~' ? glyphs[character - ' '] : unknown_glyph;
}

static int glyph_width(const char *glyph)
{
    int width = *glyph ? 0 : SPACE_WIDTH;
    for (; *glyph; glyph++)
        if (*glyph >= '0' && *glyph <= '9' && *glyph - '0' > width)
            width = *glyph - '0';
    return width;
}

int64_t text_length(const char *text, size_t count)
{
    int64_t length = 0;
    for (size_t i = 0; i < count && text[i]; i++)
        length += glyph_width(glyph_of(text[i])) + (i > 0 ? LETTER_GAP : 0);
    return length;
}

size_t text_fit(const char *text, int64_t length)
{
    size_t count = 0;
    while (text[count] && text_length(text, count + 1) <= length)
        count++;
    return count;
}

static int strokes_of(const char *glyph, struct stroke strokes[STROKES_MAX])
{
    int count = 0;
    bool pen_is_down = false;
    double x = 0.0;
    double y = 0.0;
    while (*glyph && count < STROKES_MAX) {
        if (*glyph == ' ') {
            pen_is_down = false;
            glyph++;
            continue;
        }
        const struct stroke stroke = {x, y, glyph[0] - '0', glyph[1] - 'E'};
        x = stroke.x1;
        y = stroke.y1;
        glyph += 2;
        const bool is_dot = !pen_is_down && (*glyph == '\0' || *glyph == ' ');
        if (pen_is_down)
            strokes[count++] = stroke;
        if (is_dot)
            strokes[count++] = (struct stroke){x, y, x, y};
        pen_is_down = true;
    }
    return count;
}

static double square_distance_to(const struct stroke *stroke, double x, double y)
{
    const double along_x = stroke->x1 - stroke->x0;
    const double along_y = stroke->y1 - stroke->y0;
    const double square = along_x * along_x + along_y * along_y;
    const double projected = (x - stroke->x0) * along_x + (y - stroke->y0) * along_y;
    const double at = square > 0.0 ? fmin(fmax(projected / square, 0.0), 1.0) : 0.0;
    const double across_x = x - stroke->x0 - at * along_x;
    const double across_y = y - stroke->y0 - at * along_y;
    return across_x * across_x + across_y * across_y;
}

void canvas_line(struct canvas *canvas, double x0, double y0, double x1, double y1,
                 double thickness, struct colour colour)
{
    const struct stroke stroke = {x0, y0, x1, y1};
    const double reach = 0.5 * thickness + 1.0;
    if (!isfinite(x0 + y0 + x1 + y1))
        return;
    const double left = fmax(0.0, floor(fmin(x0, x1) - reach));
    const double right = fmin(canvas->width - 1.0, ceil(fmax(x0, x1) + reach));
    const double top = fmax(0.0, floor(fmin(y0, y1) - reach));
    const double bottom = fmin(canvas->height - 1.0, ceil(fmax(y0, y1) + reach));
    for (double y = top; y <= bottom; y += 1.0)
        for (double x = left; x <= right; x += 1.0)
            blend(canvas, (int64_t)x, (int64_t)y, colour,
                  fmin(fmax(0.5 * thickness + 0.5 - sqrt(square_distance_to(&stroke, x, y)), 0.0),
                       1.0));
}

static void draw_glyph(struct canvas *canvas, int64_t x, int64_t y, const char *glyph,
                       enum text_direction direction, struct colour colour)
{
    struct stroke strokes[STROKES_MAX];
    const int count = strokes_of(glyph, strokes);
    const int width = glyph_width(glyph);
    for (int up = -FONT_DESCENT; up <= FONT_ASCENT + 1; up++) {
        for (int right = -1; right <= width + 1; right++) {
            double nearest = 100.0;
            for (int i = 0; i < count; i++)
                nearest = fmin(nearest, square_distance_to(&strokes[i], right, up));
            const double coverage = fmin(fmax(HALF_STROKE + 0.5 - sqrt(nearest), 0.0), 1.0);
            if (direction == TEXT_RIGHTWARDS)
                blend(canvas, x + right, y - up, colour, coverage);
            else
                blend(canvas, x - up, y - right, colour, coverage);
        }
    }
}

void draw_text(struct canvas *canvas, int64_t x, int64_t y, const char *text, size_t count,
               enum text_direction direction, struct colour colour)
{
    int64_t along = 0;
    for (size_t i = 0; i < count && text[i]; i++) {
        const char *glyph = glyph_of(text[i]);
        if (direction == TEXT_RIGHTWARDS)
            draw_glyph(canvas, x + along, y, glyph, direction, colour);
        else
            draw_glyph(canvas, x, y - along, glyph, direction, colour);
        along += glyph_width(glyph) + LETTER_GAP;
    }
}
