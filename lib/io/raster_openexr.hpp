/* OpenEXR images: of 32-bit or 16-bit floating point, in scanlines, stored without loss. */
#ifndef SONJECT_IO_RASTER_OPENEXR_HPP
#define SONJECT_IO_RASTER_OPENEXR_HPP

#include <vector>

#include "io/raster_source.hpp"

namespace raster
{

/* A copy that is asked for. */
struct copy_order {
    struct report *report;
    const char *source, *path;
    const struct region *region;
    const void *pixels;
    sonject_progress_function progress;
    void *user;

    void tell(double fraction) const
    {
        if (progress && progress(user, fraction, "write") != 0)
            throw failure{report_failure(report, SONJECT_CANCELLED, "cancelled")};
    }
};

/* Refuses channels that sonject does not read, beside what exr_check refused, and finds out how the
 * numbers are stored. */
void check_openexr(struct report *report, struct raster_image &file);

/* Writes an image of the source's pixels but in the region, whose chunks fit into the source. */
void encode_openexr(const copy_order &order, struct raster_image &source, const char *encoded);

/* The order's pixels as 16-bit floating point holds them; refuses those beyond. */
std::vector<float> rounded_to_halves(const copy_order &order, const struct raster_layout &layout);

} // namespace raster

#endif
