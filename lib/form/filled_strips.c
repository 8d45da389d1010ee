#include "form/filled_strips.h"

#include <string.h>

#define SEARCH_STEP 64 /* bins that are looked at together */
#define SHORT_GAP   8  /* strips: their copy takes as long as another launch */

typedef char filled_span_is_packed[sizeof(struct filled_span) == 2 * 4 ? 1 : -1];

bool filled_span_is_empty(struct filled_span span)
{
    return span.first >= span.end;
}

static struct filled_span filled_part(const float *line, int32_t bins)
{
    static const float zeros[SEARCH_STEP];
    struct filled_span filled = {0, bins};
    while (filled.first + SEARCH_STEP <= filled.end &&
           memcmp(line + filled.first, zeros, sizeof zeros) == 0)
        filled.first += SEARCH_STEP;
    while (filled.first < filled.end && line[filled.first] == 0.0f)
        filled.first++;
    while (filled.end - SEARCH_STEP >= filled.first &&
           memcmp(line + filled.end - SEARCH_STEP, zeros, sizeof zeros) == 0)
        filled.end -= SEARCH_STEP;
    while (filled.end > filled.first && line[filled.end - 1] == 0.0f)
        filled.end--;
    return filled;
}

struct filled_span filled_span_of(const float *real_part, const float *imaginary_part, size_t bins)
{
    struct filled_span filled = filled_part(real_part, (int32_t)bins);
    if (!imaginary_part)
        return filled;
    const struct filled_span other = filled_part(imaginary_part, (int32_t)bins);
    if (filled_span_is_empty(filled))
        return other;
    if (filled_span_is_empty(other))
        return filled;
    filled.first = other.first < filled.first ? other.first : filled.first;
    filled.end = other.end > filled.end ? other.end : filled.end;
    return filled;
}

struct span next_filled_strips(const struct filled_span *filled, int32_t count, struct span before)
{
    struct span run = {before.first + before.count, 0};
    while (run.first < count && filled_span_is_empty(filled[run.first]))
        run.first++;
    for (int32_t i = run.first; i < count && i - run.first - run.count < SHORT_GAP; i++)
        if (!filled_span_is_empty(filled[i]))
            run.count = i - run.first + 1;
    return run;
}
