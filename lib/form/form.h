/* Image formation: lines of bins become pixels. The pulse (G) compresses a line, the bins of one
 * strip, into columns. Then the cross-range response (W) combines all lines into rows. */
#ifndef SONJECT_FORM_FORM_H
#define SONJECT_FORM_FORM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"
#include "device/device.h"
#include "kernels/layout.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"

/* Columns that share one cross-range response of a beam; holds whole groups of any width. */
#define FORM_BLOCK_COLUMNS 16

/* Filled spans are worth forming: glints of clutter lie in few places of large grids, and the zeros
 * around add nothing. */
bool filled_span_is_empty(struct filled_span span);

/* Returns the span of a line's bins outside which all are 0. imaginary_part may be NULL. */
struct filled_span filled_span_of(const float *real_part, const float *imaginary_part, size_t bins);

/* Returns the next run of strips after another, which at first is {0, 0}. A run begins and ends
 * with filled strips, and holds gaps that cost less to form than to leave out. count 0: no more. */
struct span next_filled_strips(const struct filled_span *filled, int32_t count, struct span before);

/* The kinds of formation. Complex amplitudes are formed by G and W, energies by |G|^2 and |W|^2,
 * one plane of them or two side by side. Glints are kept to side lobes of -60 dB, which may stand
 * out of the seabed. Fields (speckle, the measured seabed, a glint's peak) and energies are kept
 * where 99.9 % of |W|^2 lies. */
enum form_kind {
    FORM_GLINT,
    FORM_FIELD,
    FORM_ENERGY, /* in the real plane; the imaginary plane is 0 */
    FORM_TWO_ENERGIES
};

struct form_lines {
    struct report *report;
    struct device *device;
    const struct patch_view *view; /* borrowed */
    struct line_grid grid;
    enum form_kind kind;
    size_t planes;    /* planes of lines and pixels: 1 or 2 */
    struct window at; /* the view's pixels that are formed; none: columns is 0 */
    size_t stride;    /* floats from one line of columns to the next */
    int32_t reach;    /* reach of the cross-range response, strips */
    int32_t pulse_first, pulse_taps;
    struct filled_span *filled_columns; /* columns that each strip's line fills; owned */
    double row_spacing_m;
    struct point_response response;
    device_buffer lines[2], pulse;
    device_buffer imaginary_pulse; /* NULL where G is real */
    device_buffer filled;          /* filled_columns, while lines are combined */
    device_kernel sort, compress;
};

/* Prepares lines for those of the view's pixels that cells of the grid reach. Without such pixels
 * lines->at.columns is 0 and the other calls do nothing. After success the caller calls
 * form_lines_end; on failure nothing is held. Errors: DEVICE, MEMORY. */
sonject_status form_lines_begin(struct form_lines *lines, struct report *report,
                                struct device *device, const struct patch_view *view,
                                const struct point_response *response, enum form_kind kind,
                                const struct line_grid *grid);
void form_lines_end(struct form_lines *lines);

/* Returns the strips on each side of a row from which this kind of formation takes aspects. */
int32_t form_reach(const struct patch_view *view, const struct point_response *response,
                   enum form_kind kind, uint32_t strips_per_row);

/* Range-compresses count strips from `strip` on: two planes of count x bins.count, the bins counted
 * from the grid's first. The grid's other bins are empty. A NULL imaginary_part is zero. Errors:
 * DEVICE, MEMORY. */
sonject_status form_lines_add(struct form_lines *lines, int32_t strip, int32_t count,
                              struct span bins, const float *real_part,
                              const float *imaginary_part);

/* Draws sqrt(energy) times complex normal deviates that depend on seed, stream, strip and bin
 * alone, for strips.count x bins.count cells of one grid. Both buffers are the caller's for
 * buffer_release, also on failure. Errors: DEVICE, MEMORY. */
sonject_status speckle_draw(struct report *report, struct device *device, struct span bins,
                            struct span strips, const float *energy, uint64_t seed, uint32_t stream,
                            device_buffer parts[2]);

/* Range-compresses strips like form_lines_add, with amplitudes of speckle_draw. */
sonject_status form_lines_add_speckle(struct form_lines *lines, int32_t strip, int32_t count,
                                      const float *energy, uint64_t seed, uint32_t stream);

/* Combines all lines into two planes of the pixels in lines->at. imaginary_part may be NULL for
 * FORM_ENERGY. Errors: DEVICE, MEMORY. */
sonject_status form_lines_finish(struct form_lines *lines, float *real_part, float *imaginary_part);

/* Combines as form_lines_finish does, into planes of all of the view's pixels. Those outside
 * lines->at stay as they are. */
sonject_status form_lines_finish_view(struct form_lines *lines, float *real_part,
                                      float *imaginary_part);

/* Combines all lines into padded planes of lines->at.rows x lines->stride on the device. */
sonject_status form_combine(struct form_lines *lines, const device_buffer out[2]);

static inline bool form_is_of_energies(const struct form_lines *lines)
{
    return lines->kind == FORM_ENERGY || lines->kind == FORM_TWO_ENERGIES;
}

#endif
