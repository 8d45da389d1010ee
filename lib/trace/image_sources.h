/* The sonar and its images in the plane boundaries over and under the scene, and pairs of sources
 * between which an object carries sound. Boundaries come before the object, after it, or both. */
#ifndef SONJECT_TRACE_IMAGE_SOURCES_H
#define SONJECT_TRACE_IMAGE_SOURCES_H

#include "trace/tracer.h"

#define SOURCES_MAX 15 /* the sonar, and two images for each of 1...7 bounces */

/* A source seen from an object. Sound meets `bounces` boundaries in turn, last_boundary last. */
struct sound_source {
    struct ray_path path;
    uint32_t bounces;
    enum boundary last_boundary; /* meaningless without bounces */
};

/* Returns whether the scene has the boundary. Tells its height over the mean seabed and its
 * material. */
bool scene_boundary(const struct scene *scene, enum boundary kind, double *height_m,
                    const sonject_material_params **material);

/* Lists the sonar and then its images of up to `bounces` bounces, ordered by bounces. Returns their
 * number. The sources borrow water. */
size_t sources_list(const struct scene *scene, const struct water *water, uint32_t bounces,
                    struct sound_source sources[SOURCES_MAX]);

/* Two sources with outgoing->bounces <= returning->bounces. The reverse path is counted along. */
struct image_pair {
    const struct sound_source *outgoing, *returning;
    uint32_t number; /* number among all pairs of the scene, for the random numbers */
};

/* The pairs of one part, in turn. */
struct image_pairs {
    const struct tracer *tracer;
    const struct placement *placement;
    struct sound_source sources[SOURCES_MAX];
    size_t count;
    uint32_t object_hits;       /* fewest interactions that a pair leaves to objects */
    size_t outgoing, returning; /* the pair to look at next */
};

/* Begins the list of pairs by image sources, and before them the straight one if has_straight.
 * Borrows the tracer. */
void image_pairs_begin(struct image_pairs *pairs, const struct tracer *tracer, uint32_t part,
                       bool has_straight, uint32_t object_hits);

/* Finds the next pair within the limit of interactions whose boundaries return anything. The pair
 * points into *pairs. Returns false when there is none. */
bool image_pairs_next(struct image_pairs *pairs, struct image_pair *pair);

/* Returns the bins, of the grid's size, between two ranges, and one more on each side. */
struct span bins_of_ranges(const struct tracer *tracer, const struct line_grid *grid,
                           double nearest_m, double farthest_m);

/* Returns the bins of half the path from one source to the part and on to the other. Only the size
 * of the grid's bins is used. */
struct span image_pair_bins(const struct tracer *tracer, uint32_t part,
                            const struct image_pair *pair, const struct line_grid *grid);

/* Returns those of image_pair_bins whose pulse reaches the patch; count 0 if there are none. */
struct span image_pair_bins_in_patch(const struct tracer *tracer, uint32_t part,
                                     const struct image_pair *pair, const struct line_grid *grid);

/* Returns those of some bins, of the grid's size, whose pulse reaches the patch. */
struct span bins_in_patch(const struct tracer *tracer, const struct line_grid *grid,
                          struct span bins);

/* Returns whether any pair keeps more than exp(-12), -104 dB, of what the part returns as a mirror.
 * Roughness takes exp(-P^2/2), P = 2 k eta cos(theta), theta being half the angle between the
 * directions to both sources. Where no pair does, echoes of edges of slanting faces are not traced
 * either. Roughness would leave more of them, but edges are as rough. */
bool part_has_glints(const struct tracer *tracer, uint32_t part);

/* Returns the bins in the patch of all the part's pairs but the straight one; count 0 for none. */
struct span image_source_bins(const struct tracer *tracer, uint32_t part,
                              const struct line_grid *grid);

/* Returns the smallest span that holds both spans. A span of count 0 holds nothing. */
struct span span_join(struct span one, struct span other);

/* Returns the span that both spans hold. */
struct span span_overlap(struct span one, struct span other);

/* Fills in a pair's record, and a fan from the outgoing source in a frame centred on the part. The
 * fan is like that of fan_record_init, with bins and phases of half the path. Appends the rays of
 * both paths. Errors: as patch_rays_init. */
sonject_status image_pair_aim(struct fan_record *fan, struct image_pair_record *record,
                              struct ray_table *rays, const struct tracer *tracer, uint32_t part,
                              const struct image_pair *pair, const struct line_grid *grid);

#endif
