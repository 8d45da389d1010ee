/* Measured and traced sound in one picture: the patch's level, what the image around the objects
 * tells, the levels that objects were given, composition, and the truth. Formulas: kernels/MATH.md,
 * "Blending". */
#ifndef SONJECT_INJECT_COMPOSE_H
#define SONJECT_INJECT_COMPOSE_H

#include "image/statistics.h"
#include "inject/echoes.h"
#include "inject/injection.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"
#include "scene/scene.h"

/* The measured patch as reflectivity: its level, its map, and its scale to cross-sections. Planes
 * of rows x columns of the view, in memory that is owned. */
struct patch_level {
    float *intensity;     /* measured */
    float *level;         /* smooth local mean of it, > 0 */
    float *map;           /* reflectivity over mu0 for the tracer */
    float *cell_energy;   /* expected cross-section of a pixel of plain seabed (mu0), m^2; a column
                             each */
    double noise_ratio;   /* noise energy over level, or over the one below */
    double noise_over;    /* 0: over that of each pixel */
    size_t water_columns; /* before the first return from the bottom; their level is that of the
                             seabed nearby */
};

/* What all pixels of the patch tell. */
struct patch_facts {
    double mean_intensity;
    double noise_ratio;  /* noise energy over level */
    bool measures_noise; /* it was estimated, and a shadow of the patch told it */
};

/* pixels: amplitudes or pairs, in the view's row order. Errors: INPUT (nothing but zeros; not a
 * finite number: says where), MEMORY, CANCELLED. */
sonject_status patch_facts_init(struct patch_facts *facts, struct report *report,
                                const struct scene *scene, const struct patch_view *view,
                                const float *pixels, bool is_complex);

/* Intensities of a window of the patch, for free(); NULL where memory is out. */
float *window_intensities(const struct window *at, const struct patch_view *view,
                          const float *pixels, bool is_complex);

/* Of the tracer's window of the patch: what all of the patch would tell there. view, pixels: the
 * patch's. Errors: MEMORY. On failure nothing is held. */
sonject_status patch_level_init(struct patch_level *level, const struct tracer *tracer,
                                const struct patch_view *view, const struct patch_facts *facts,
                                const float *pixels, bool is_complex);
void patch_level_clear(struct patch_level *level);

/* Noise energy at a pixel over its level. */
double noise_over_level(const struct patch_level *level, size_t i);

/* Expected cross-sections, m^2, of pixels of plain seabed in the view's columns. */
void fill_cell_energies(const struct patch_view *view, const struct point_response *response,
                        float *energies);

/* Expected cross-section in m^2 of a pixel of Lambert seabed (mu) at a processor range: mu sin^2 of
 * the grazing angle times the area that the point response covers. */
double seabed_cell_energy(const struct patch_view *view, const struct point_response *response,
                          double mu, double processor_range_m);

/* What echoes are asked for, from the measured patch. */
struct patch_request {
    struct patch_level level;
    float *reflectivity; /* two planes of the coherent map; owned; NULL: none */
    struct echo_request request;
};

/* Of a window of the patch, whose view the tracer has. view, pixels: the patch's. On success to be
 * given to patch_request_clear; on failure nothing is held. Errors: MEMORY. */
sonject_status patch_request_init(struct patch_request *patch, struct tracer *tracer,
                                  const struct patch_view *view, const struct patch_facts *facts,
                                  const float *pixels, bool is_complex,
                                  sonject_progress_function progress, void *user);
void patch_request_clear(struct patch_request *patch);

/* Finds for each object the factor that gives its echo's peak the level it asks for,
 * and scales fields and energies by it: at each pixel by the mean of the objects' factors, weighted
 * with their energies there, which is exact where one object is heard. Tells level_kind,
 * level_gain_db, over_seabed_db and seabed_strength_db in result->objects. Errors: MEMORY. */
sonject_status set_target_levels(const struct tracer *tracer, struct echoes *echoes,
                                 struct injected_window *result);

/* What is put into a measured magnitude image takes that image's own widths, looks and saturation.
 */
struct image_match {
    struct speckle_statistics seabed; /* measured around the objects */
    double looks;                     /* of speckle that is put in; 1: single-look */
    uint32_t looks_source;            /* sonject_source */
    double saturation;                /* amplitude that cuts highlights, or INFINITY */
    double ceiling; /* of the image and its file: the lesser of that and what is stored */
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

void tell_match(const struct image_match *match, const struct tracer *tracer,
                sonject_statistics *statistics);

/* -INFINITY for 0. */
double decibels(double ratio);

/* A field of complex normal deviates of unit mean square with the sonar's point response, in two
 * planes of rows x columns of the view. Only the window is filled; its values do not depend on the
 * window's size. Errors: DEVICE, MEMORY. */
sonject_status coloured_noise(struct tracer *tracer, uint32_t stream, const struct window *window,
                              float *real_part, float *imaginary_part);

/* Weights of the looks whose weighted mean intensity has the contrast of `looks` (1...64, a
 * fraction too) independent equal ones: all but the last are *weight, the last is *last. Returns
 * their number. */
uint32_t look_weights(double looks, double *weight, double *last);

/* match: what the image around the objects tells. Fills result's image, field, energy, visibility
 * and influence (allocated, in the view's row order) from the input's pixels (same order). Errors:
 * DEVICE, MEMORY. */
sonject_status compose(struct tracer *tracer, const struct image_match *match,
                       const struct patch_level *level, const struct echoes *echoes,
                       const float *pixels, bool is_complex, struct injected_window *result);

/* Composes the touched pixels (result->influence, within the window) of a magnitude image anew as
 * the root of a mean over looks: of the measured seabed, the noise and the rough targets each look
 * has its own realisation, glints are the same in all. result->visibility is filled in already;
 * image and field are changed. Errors: DEVICE, MEMORY. */
sonject_status compose_looks(struct tracer *tracer, double looks, const struct patch_level *level,
                             const struct echoes *echoes, const float *pixels,
                             const struct window *window, struct injected_window *result);

/* Masks, boxes and levels of every object that is followed: fills result's masks and objects
 * (allocated), in the view's row order. is_empty: of its rows, those where nothing was heard; they
 * are in no mask or box. Errors: MEMORY. */
sonject_status find_truth(const struct tracer *tracer, const struct patch_level *level,
                          const struct image_match *match, const bool *is_empty,
                          const struct echoes *echoes, struct injected_window *result);

#endif
