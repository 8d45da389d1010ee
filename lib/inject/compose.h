/* Composition of measured and traced sound in one picture: the patch's level, the statistics of the
 * image around the objects, the levels of objects, composition, and truth. Formulas:
 * kernels/MATH.md, "Blending". */
#ifndef SONJECT_INJECT_COMPOSE_H
#define SONJECT_INJECT_COMPOSE_H

#include "image/statistics.h"
#include "inject/echoes.h"
#include "inject/injection.h"
#include "scene/patch_view.h"
#include "scene/point_response.h"
#include "scene/scene.h"

/* The measured patch as reflectivity: its level, its map, and its scale to cross-sections. Planes
 * have rows x columns pixels of the view, in memory that is owned. */
struct patch_level {
    float *intensity;     /* measured intensity */
    float *level;         /* smooth local mean of the intensity, > 0 */
    float *map;           /* reflectivity over mu0, for the tracer */
    float *cell_energy;   /* expected cross-section of a plain pixel (mu0), m^2; one a column */
    double noise_ratio;   /* noise energy over level, or over noise_over if that is not 0 */
    double noise_over;    /* level that the noise refers to; 0: each pixel's */
    size_t water_columns; /* columns before the first return from the bottom; their level is that of
                             the seabed nearby */
};

/* The facts that all pixels of the patch tell. */
struct patch_facts {
    double mean_intensity;
    size_t first_heard, end_heard; /* columns before and after which all pixels are 0 */
    double noise_ratio;            /* noise energy over level */
    bool measures_noise;           /* estimated, from a shadow of the patch */
};

/* pixels: amplitudes or pairs, in the view's row order. Errors: INPUT (all pixels are 0, or one is
 * not a finite number, whose place is reported), MEMORY, CANCELLED. */
sonject_status patch_facts_init(struct patch_facts *facts, struct report *report,
                                const struct scene *scene, const struct patch_view *view,
                                const float *pixels, bool is_complex);

/* Returns the length of a span widened by a reach on both sides, within 0...all. */
size_t widened_span(size_t first, size_t count, size_t reach, size_t all, size_t *start);

/* Marks the holes in a window: rectangles of zeros with sides of at least side_m. Dark seabed and
 * shadows in coarse grey levels have zeros, too, but fewer together. What is around the window
 * counts, so that all windows see the same holes. view, pixels: the patch's. *holes gets memory for
 * free(), or NULL if there are none. Errors: MEMORY. */
sonject_status find_holes(struct report *report, const struct patch_view *view,
                          const struct window *at, double side_m, const float *pixels,
                          bool is_complex, uint8_t **holes);

/* Returns the intensities of a window of the patch, for free(); NULL where memory is out. */
float *window_intensities(const struct window *at, const struct patch_view *view,
                          const float *pixels, bool is_complex);

/* Finds the level in the tracer's window of the patch, as it is within all of the patch. view,
 * pixels: the patch's. On failure nothing is held. Errors: MEMORY. */
sonject_status patch_level_init(struct patch_level *level, const struct tracer *tracer,
                                const struct patch_view *view, const struct patch_facts *facts,
                                const float *pixels, bool is_complex);
void patch_level_clear(struct patch_level *level);

/* Returns the noise energy at a pixel over its level. */
double noise_over_level(const struct patch_level *level, size_t i);

/* Fills the expected cross-sections, m^2, of pixels of plain seabed in the view's columns. */
void fill_cell_energies(const struct patch_view *view, const struct point_response *response,
                        float *energies);

/* Returns the expected cross-section, m^2, of a pixel of Lambert seabed (mu) at a processor range:
 * mu sin^2 of the grazing angle, times the area that the point response covers. */
double seabed_cell_energy(const struct patch_view *view, const struct point_response *response,
                          double mu, double processor_range_m);

/* A request for echoes, from the measured patch. */
struct patch_request {
    struct patch_level level;
    float *reflectivity; /* two planes of the coherent map; owned; NULL: none */
    struct echo_request request;
};

/* Prepares a request for the tracer's window of the patch. view, pixels: the patch's. On success
 * the caller gives it to patch_request_clear; on failure nothing is held. Errors: MEMORY. */
sonject_status patch_request_init(struct patch_request *patch, struct tracer *tracer,
                                  const struct patch_view *view, const struct patch_facts *facts,
                                  const float *pixels, bool is_complex,
                                  sonject_progress_function progress, void *user);
void patch_request_clear(struct patch_request *patch);

/* Finds the factor that gives each object's echo the peak level that the scene asks for. Scales
 * fields and energies: a pixel's factor is the mean of the objects', weighted with their energies
 * there. That is exact where one object is heard. Fills level_kind, level_gain_db, over_seabed_db
 * and seabed_strength_db in result->objects. Errors: MEMORY. */
sonject_status set_target_levels(const struct tracer *tracer, struct echoes *echoes,
                                 struct injected_window *result);

/* The response, looks and saturation that targets take from a measured magnitude image. */
struct image_match {
    struct speckle_statistics seabed; /* measured around the objects */
    double looks;                     /* looks of the targets' speckle; 1: single-look */
    uint32_t looks_source;            /* sonject_source */
    double saturation;                /* amplitude that cuts highlights, or INFINITY */
    double ceiling; /* the lesser of saturation and the file's largest amplitude */
};

/* Measures the patch's pixels around the placed objects. Pixels are in the view's row order, else
 * as in the input. A composite into a measured magnitude image may widen or narrow the tracer's
 * response, if the scene asks for that and the image clearly differs. Images that sonject made, and
 * resynthesised ones, keep the sonar's parameters. Errors: MEMORY. */
sonject_status match_image(struct tracer *tracer, const float *pixels,
                           const struct injection_input *input, struct image_match *match);

/* Returns the intensity correlation of the response's single-look speckle at a distance in m. */
double along_track_speckle_correlation(const struct point_response *response, double distance_m);

void tell_match(const struct image_match *match, const struct tracer *tracer,
                sonject_statistics *statistics);

/* Returns a ratio in dB; -INFINITY for 0. */
double decibels(double ratio);

/* Draws a field of complex normal deviates of unit mean square with the sonar's point response, in
 * two planes of rows x columns of the view. Fills the window alone; values do not depend on its
 * size. Errors: DEVICE, MEMORY. */
sonject_status coloured_noise(struct tracer *tracer, uint32_t stream, const struct window *window,
                              float *real_part, float *imaginary_part);

/* Finds the weights of looks whose weighted mean intensity has the contrast of `looks` (1...64, a
 * fraction too) independent equal looks. The last has *last, all others have *weight. Returns the
 * number of looks. */
uint32_t look_weights(double looks, double *weight, double *last);

/* Composes a window. Fills result's image, field, energy, visibility and influence (allocated, in
 * the view's row order) from the input's pixels (same order). match: the statistics of the image
 * around the objects. Errors: DEVICE, MEMORY. */
sonject_status compose(struct tracer *tracer, const struct image_match *match,
                       const struct patch_level *level, const struct echoes *echoes,
                       const float *pixels, bool is_complex, struct injected_window *result);

/* Composes the touched pixels (result->influence, within the window) of a magnitude image again, as
 * the root of a mean over looks. Each look has its own realisation of measured seabed, noise and
 * rough targets; glints are the same in all. result->visibility must be filled; image and field are
 * changed. Errors: DEVICE, MEMORY. */
sonject_status compose_looks(struct tracer *tracer, double looks, const struct patch_level *level,
                             const struct echoes *echoes, const float *pixels,
                             const struct window *window, struct injected_window *result);

/* Finds masks, boxes and levels of every object that is followed. Fills result's masks and objects
 * (allocated), in the view's row order. is_empty: true for the window's rows where nothing was
 * heard, which are in no mask or box. Errors: MEMORY. */
sonject_status find_truth(const struct tracer *tracer, const struct patch_level *level,
                          const struct image_match *match, const bool *is_empty,
                          const struct echoes *echoes, struct injected_window *result);

#endif
