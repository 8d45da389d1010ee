#include "trace/glints.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static sonject_status begin_mirrored(struct glints *glints, struct tracer *tracer, uint32_t object)
{
    struct source_pairs pairs;
    struct source_pair pair;
    source_pairs_begin(&pairs, tracer, object);
    while (source_pairs_next(&pairs, &pair)) {
        struct smooth_trace *trace = &glints->traces[glints->count];
        CHECK(smooth_trace_begin_mirrored(trace, tracer, object, &pair));
        glints->grid.bins = span_join(glints->grid.bins, trace->grid.bins);
        glints->count += trace->grid.bins.count > 0;
    }
    return SONJECT_OK;
}

static sonject_status begin_corners(struct glints *glints, struct tracer *tracer, uint32_t object)
{
    const sonject_status status = corners_begin(&glints->corners, tracer, object);
    glints->grid.strips = span_join(glints->grid.strips, glints->corners.grid.strips);
    glints->grid.bins = span_join(glints->grid.bins, glints->corners.grid.bins);
    return status;
}

sonject_status glints_begin(struct glints *glints, struct tracer *tracer, uint32_t object)
{
    memset(glints, 0, sizeof *glints);
    glints->traces =
        allocate_array(1 + (size_t)SOURCES_MAX * (SOURCES_MAX + 1) / 2, sizeof *glints->traces);
    CHECK_MEMORY(tracer->report, glints->traces, "glints");
    sonject_status status = smooth_trace_begin(&glints->traces[0], tracer, object);
    if (status == SONJECT_OK) {
        glints->count = 1;
        glints->grid = glints->traces[0].grid;
        if (glints->grid.strips.count > 0)
            status = begin_mirrored(glints, tracer, object);
    }
    THEN(status, begin_corners(glints, tracer, object));
    if (status == SONJECT_OK) {
        const size_t chunk = (size_t)glints_chunk(glints) * (size_t)glints->grid.bins.count;
        glints->real_part = allocate_array(chunk, sizeof(float));
        glints->imaginary_part = allocate_array(chunk, sizeof(float));
        if (!glints->real_part || !glints->imaginary_part)
            status = report_out_of_memory(tracer->report, "glints");
    }
    if (status != SONJECT_OK)
        glints_end(glints);
    return status;
}

void glints_end(struct glints *glints)
{
    for (size_t i = 0; i < glints->count; i++)
        smooth_trace_end(&glints->traces[i]);
    corners_end(&glints->corners);
    free(glints->traces);
    free(glints->real_part);
    free(glints->imaginary_part);
    memset(glints, 0, sizeof *glints);
}

int32_t glints_chunk(const struct glints *glints)
{
    int32_t chunk = smooth_trace_chunk(&glints->traces[0]);
    for (size_t i = 1; i < glints->count; i++) {
        const int32_t one = smooth_trace_chunk(&glints->traces[i]);
        chunk = one < chunk ? one : chunk;
    }
    return chunk;
}

/* Adds one trace's bins to those of the common grid, from a line of the planes on. */
static void add_bins(const struct glints *glints, const struct smooth_trace *trace, int32_t strips,
                     size_t first_line, float *real_part, float *imaginary_part)
{
    const size_t width = (size_t)trace->grid.bins.count;
    const size_t offset = (size_t)(trace->grid.bins.first - glints->grid.bins.first);
    for (size_t strip = 0; strip < (size_t)strips; strip++) {
        const size_t at = (first_line + strip) * (size_t)glints->grid.bins.count + offset;
        for (size_t bin = 0; bin < width; bin++) {
            real_part[at + bin] += glints->real_part[strip * width + bin];
            imaginary_part[at + bin] += glints->imaginary_part[strip * width + bin];
        }
    }
}

sonject_status glints_trace(struct glints *glints, struct tracer *tracer, struct span strips,
                            float *real_part, float *imaginary_part)
{
    const size_t bytes = (size_t)strips.count * (size_t)glints->grid.bins.count * sizeof *real_part;
    if (glints->count == 1 && glints->corners.grid.strips.count == 0)
        return smooth_trace_strips(&glints->traces[0], tracer, strips, real_part, imaginary_part);
    memset(real_part, 0, bytes);
    memset(imaginary_part, 0, bytes);
    for (size_t i = 0; i < glints->count; i++) {
        const struct span some = span_overlap(strips, glints->traces[i].grid.strips);
        if (some.count == 0)
            continue;
        CHECK(smooth_trace_strips(&glints->traces[i], tracer, some, glints->real_part,
                                  glints->imaginary_part));
        add_bins(glints, &glints->traces[i], some.count, (size_t)(some.first - strips.first),
                 real_part, imaginary_part);
    }
    corners_add(&glints->corners, strips, &glints->grid, real_part, imaginary_part);
    return SONJECT_OK;
}
