#include "api/histogram_plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

#define BINS   24
#define WIDTH  320
#define HEIGHT 200
#define LEFT   12
#define BOTTOM 160
#define TOP    34

static void add_base64(struct growing_text *text, const char *bytes)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const size_t count = strlen(bytes);
    for (size_t i = 0; i < count; i += 3) {
        unsigned long bits = 0;
        for (size_t j = 0; j < 3; j++)
            bits = bits << 8 | (i + j < count ? (unsigned char)bytes[i + j] : 0u);
        for (size_t j = 0; j < 4; j++)
            if (i + j <= count)
                growing_text_add(text, "%c", digits[bits >> (18 - 6 * j) & 63]);
            else
                growing_text_add(text, "=");
    }
}

/* Keys are plain words; what is not is left out. */
static void add_plain(struct growing_text *svg, const char *words)
{
    for (; *words; words++)
        if (!strchr("<>&\"'", *words))
            growing_text_add(svg, "%c", *words);
}

static void add_label(struct growing_text *svg, int x, const char *anchor, double value)
{
    char number[40];
    growing_text_add(svg, "<text x=\"%d\" y=\"%d\" text-anchor=\"%s\">%s</text>", x, BOTTOM + 16,
                     anchor, text_of_number(number, sizeof number, value, 4));
}

static void draw(struct growing_text *svg, const char *name, const char *unit, const size_t *bins,
                 double low, double high, size_t count)
{
    size_t most = 1;
    const int bar = (WIDTH - 2 * LEFT) / BINS;
    for (int i = 0; i < BINS; i++)
        most = bins[i] > most ? bins[i] : most;
    growing_text_add(svg,
                     "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
                     "font-family=\"sans-serif\" font-size=\"12\"><text x=\"%d\" y=\"16\">",
                     WIDTH, HEIGHT, LEFT);
    add_plain(svg, name);
    growing_text_add(svg, "%s", *unit ? ", " : "");
    add_plain(svg, unit);
    growing_text_add(svg, "</text>");
    for (int i = 0; i < BINS; i++) {
        const int height = (int)lround((double)(BOTTOM - TOP) * (double)bins[i] / (double)most);
        growing_text_add(svg,
                         "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#4878a8\"/>",
                         LEFT + i * bar, BOTTOM - height, bar - 1, height);
    }
    growing_text_add(svg, "<path d=\"M%d %dH%d\" stroke=\"#000\"/>", LEFT, BOTTOM,
                     LEFT + BINS * bar);
    add_label(svg, LEFT, "start", low);
    add_label(svg, LEFT + BINS * bar, "end", high);
    growing_text_add(svg, "<text x=\"%d\" y=\"%d\">%lu values, at most %lu in a bin</text></svg>",
                     LEFT, BOTTOM + 34, (unsigned long)count, (unsigned long)most);
}

void histogram_write(struct growing_text *text, const char *name, const char *unit,
                     const double *values, size_t count)
{
    size_t bins[BINS] = {0};
    struct growing_text svg = {NULL, 0, 0, false};
    if (count == 0)
        return;
    double low = values[0];
    double high = values[0];
    for (size_t i = 1; i < count; i++) {
        low = fmin(low, values[i]);
        high = fmax(high, values[i]);
    }
    for (size_t i = 0; i < count; i++) {
        const double place = high > low ? (values[i] - low) / (high - low) * BINS : 0.0;
        bins[place < BINS ? (int)place : BINS - 1]++;
    }
    draw(&svg, name, unit, bins, low, high, count);
    char *picture = growing_text_end(&svg);
    growing_text_add(text, "<img width=\"%d\" height=\"%d\" alt=\"", WIDTH, HEIGHT);
    add_plain(text, name);
    growing_text_add(text, "\" src=\"data:image/svg+xml;base64,");
    if (picture)
        add_base64(text, picture);
    else
        text->failed = true;
    growing_text_add(text, "\">\n");
    free(picture);
}
