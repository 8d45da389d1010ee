/* What is put into a measured magnitude image takes that image's own widths, looks and saturation.
 * Formulas: kernels/MATH.md, "Blending". */
#ifndef SONJECT_INJECT_MATCH_H
#define SONJECT_INJECT_MATCH_H

#include "image/statistics.h"
#include "inject/injection.h"
#include "trace/tracer.h"

struct image_match {
    struct speckle_statistics seabed; /* measured around the objects */
    double looks;                     /* of speckle that is put in; 1: single-look */
    double saturation;                /* amplitude that cuts highlights, or INFINITY */
};

/* Measures the patch's pixels (in the view's row order, otherwise as the input says) around the
 * placed objects. Where that is a measured magnitude image that targets are composed into, widens
 * or narrows the tracer's response if the scene asks for it and the image clearly differs: images
 * that sonject makes are what the sonar's parameters say, and so are those that are traced anew.
 * Errors: MEMORY. */
sonject_status match_image(struct tracer *tracer, const float *pixels,
                           const struct injection_input *input, struct image_match *match);

/* Intensity correlation of single-look speckle formed by the response, at a distance in m. */
double along_track_speckle_correlation(const struct point_response *response, double distance_m);

void tell_match(const struct image_match *match, const struct point_response *response,
                sonject_statistics *statistics);

#endif
