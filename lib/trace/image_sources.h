/* The sonar and its images in the plane boundaries over and under the scene, and the pairs of them
 * between which an object carries sound: by image sources before, after or both. */
#ifndef SONJECT_TRACE_IMAGE_SOURCES_H
#define SONJECT_TRACE_IMAGE_SOURCES_H

#include "trace/tracer.h"

#define SOURCES_MAX 15 /* the sonar, and two images for each of 1...7 bounces */

/* A source seen from an object: sound comes from it by `bounces` boundaries in turn, the last of
 * which is last_boundary. */
struct sound_source {
    struct ray_path path;
    uint32_t bounces;
    enum boundary last_boundary; /* of no meaning without bounces */
};

/* Whether the scene has the boundary, and its height over the mean seabed and its material. */
bool scene_boundary(const struct scene *scene, enum boundary kind, double *height_m,
                    const sonject_material_params **material);

/* Lists the sonar (first) and all of its images of up to `bounces` bounces, by bounces; returns
 * their number. water is borrowed by them. */
size_t sources_list(const struct scene *scene, const struct water *water, uint32_t bounces,
                    struct sound_source sources[SOURCES_MAX]);

/* outgoing->bounces <= returning->bounces: the reverse path is counted along. */
struct image_pair {
    const struct sound_source *outgoing, *returning;
    uint32_t number; /* among all pairs of the scene, for the random numbers */
};

/* Pairs of one object, in turn. */
struct image_pairs {
    const struct tracer *tracer;
    const struct placement *placement;
    struct sound_source sources[SOURCES_MAX];
    size_t count;
    uint32_t object_hits;       /* interactions that a pair leaves to objects, at least */
    size_t outgoing, returning; /* the pair to look at next */
};

/* All pairs by image sources, or (has_straight) the straight one before them. The tracer is
 * borrowed. */
void image_pairs_begin(struct image_pairs *pairs, const struct tracer *tracer, uint32_t part,
                       bool has_straight, uint32_t object_hits);

/* Finds the next pair (which points into *pairs) within the limit of interactions whose boundaries
 * return anything; false when there is none. */
bool image_pairs_next(struct image_pairs *pairs, struct image_pair *pair);

/* Bins, of the grid's size, from one range to another, and one more on each side. */
struct span bins_of_ranges(const struct tracer *tracer, const struct line_grid *grid,
                           double nearest_m, double farthest_m);

/* Bins of half the path out from one source to the part and back to the other. Of the grid only
 * the size of its bins is used. */
struct span image_pair_bins(const struct tracer *tracer, uint32_t part,
                            const struct image_pair *pair, const struct line_grid *grid);

/* Of these, the bins whose pulse reaches the patch; count 0 if there is none. */
struct span image_pair_bins_in_patch(const struct tracer *tracer, uint32_t part,
                                     const struct image_pair *pair, const struct line_grid *grid);

/* What of some bins, of the grid's size, has a pulse that reaches the patch. */
struct span bins_in_patch(const struct tracer *tracer, const struct line_grid *grid,
                          struct span bins);

/* Whether any pair, the straight one or another, keeps more than exp(-12), -104 dB, of what the
 * part returns as a mirror: roughness takes exp(-P^2/2), P = 2 k eta cos(theta), of which half the
 * angle between the directions to both sources is theta. Where none does, the echoes of edges of
 * slanting faces, of which roughness would leave more, are not traced either: edges are as rough.
 */
bool part_has_glints(const struct tracer *tracer, uint32_t part);

/* The bins in the patch of all the part's pairs but the straight one; count 0 if there is none.
 */
struct span image_source_bins(const struct tracer *tracer, uint32_t part,
                              const struct line_grid *grid);

/* The smallest span that holds both; a span of count 0 holds nothing. */
struct span span_join(struct span one, struct span other);

/* What both hold. */
struct span span_overlap(struct span one, struct span other);

/* Fills in the pair's record, and a fan from the outgoing source, in a frame centred on the
 * part. The fan as fan_record_init, its bins and phases those of half the path. Appends the rays
 * of both paths. Errors: as patch_rays_init. */
sonject_status image_pair_aim(struct fan_record *fan, struct image_pair_record *record,
                              struct ray_table *rays, const struct tracer *tracer, uint32_t part,
                              const struct image_pair *pair, const struct line_grid *grid);

#endif
