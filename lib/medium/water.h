/* Water in level layers, its absorption, and the ways of sound across it. The lowest layer is the
 * straight water. Targets lie in it, or reach into layers over it, which are called slices. A path
 * leads from the sonar, or from its image in level boundaries, to the straight water. Straight from
 * the sonar it also leads to slices. Functions are pure. x plays no part: layers are level. */
#ifndef SONJECT_MEDIUM_WATER_H
#define SONJECT_MEDIUM_WATER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#define WATER_LAYERS_MAX 4096

/* A layer of water. Layers are listed from the seabed upwards, the first at 0. Each ends where the
 * next begins, and the last has no upper edge. */
struct water_layer {
    double bottom_m; /* height of its lower edge over the mean seabed */
    double speed_mps;
    double density; /* in the same unit for all layers */
};

/* Heights closer than this count as the same. */
#define WATER_HEIGHT_STEP_MIN_M 1e-6
#define WATER_SPEED_MIN_MPS     100.0
#define WATER_SPEED_MAX_MPS     10000.0

/* Makes the layers of a profile whose heights rise by WATER_HEIGHT_STEP_MIN_M or more, the last one
 * above the seabed. Each linear piece above the seabed gives equally high layers with its sound
 * speed at their middles. Steps between neighbours stay below 1/20000 of the speed. Below the first
 * sample and above the last one the speed is theirs. Equal neighbours are one layer. *layers is for
 * free(). Errors: INPUT (more than WATER_LAYERS_MAX), MEMORY. */
sonject_status layers_of_profile(const double *heights_m, const double *speeds_mps, size_t count,
                                 struct report *report, struct water_layer **layers,
                                 size_t *layer_count);

#define ABSORPTION_FREQUENCY_MIN_HZ 200.0
#define ABSORPTION_FREQUENCY_MAX_HZ 1e6

struct sea_water {
    double temperature_celsius; /* -2...30 */
    double salinity_permille;   /* 0...40 */
    double depth_m;             /* below the sea surface, 0...5000 */
    double ph;                  /* 7...9 */
};

struct water {
    struct water_layer *layers; /* owned; neighbours differ; the first is the straight water */
    size_t count;
    size_t slices; /* number of layers that targets reach into, straight water included */
    double straight_speed_mps;
};

/* Lays the water. Neighbours that do not differ are joined, and so are layers up to straight_m over
 * the seabed, at the speed that keeps the travel time straight up. Layers that targets reach into,
 * up to sliced_m, are slices. Slices are joined where that changes no speed by more than 3e-5, and
 * travel time straight up by no more than 5 um of way anywhere. count 0: isovelocity water. After
 * success the caller calls water_clear; on failure nothing is held. Errors: INPUT (a layer up to
 * straight_m differs from the joined one by more than 1/500), MEMORY. */
sonject_status water_init(struct water *water, struct report *report,
                          const struct water_layer *layers, size_t count,
                          double isovelocity_speed_mps, double straight_m, double sliced_m);
void water_clear(struct water *water);

/* Returns the layer at a height over the seabed. */
const struct water_layer *water_layer_at(const struct water *water, double height_m);

/* A path from the sonar to the straight water by way of `bounces` boundaries in turn: the seabed,
 * and the sea surface depth_m over it. */
struct ray_path {
    const struct water *water; /* borrowed */
    double sonar_height_m;
    double image_height_m; /* height of the sonar, or image, over the seabed, unfolded */
    double depth_m;        /* height of the sea surface; meaningless without bounces */
    uint32_t bounces;
    bool comes_from_seabed; /* the last bounce is there: sound goes upwards in the straight water */
    bool is_straight;       /* the path crosses no other layer */
};

/* Returns the path of sound that has met no boundary. */
struct ray_path ray_path_direct(const struct water *water, double sonar_height_m);

/* Returns the path by `bounces` >= 1 boundaries in turn, with the seabed or the surface last. */
struct ray_path ray_path_image(const struct water *water, double sonar_height_m, double depth_m,
                               uint32_t bounces, bool comes_from_seabed);

/* The sound that comes to a point of the straight water or a slice. A ray is known by its grazing
 * angle in the straight water, rad, positive downwards. */
struct arrival {
    double grazing_rad;      /* angle of the sound's direction at the point itself */
    double ground_range_m;   /* horizontal, from the sonar */
    double straight_range_m; /* travel time times the straight water's speed */
    double length_m;         /* length of the path */
    double wavefront_m;      /* width of the wavefront per rad of grazing angle */
    double spreading; /* s: a target is heard with the intensity (s / (ground range * wavefront))^2
                         at 1 m of a unit source, there and back, less what planes reflect. In
                         isovelocity water s is the cosine of the angle */
};

/* Returns the ray of a grazing angle as it comes to a height. The angle is positive, or negative
 * for a path that comes from the seabed, where height_m is above it. All members are INFINITY for
 * an angle that no sound from the source has (total reflection on the path). */
struct arrival ray_path_arrival(const struct ray_path *path, double grazing_rad, double height_m);

/* Returns the grazing angle of the ray from the source to a point, by a guarded Newton iteration.
 * It is NaN where the ray turns back over the straight water. ground_range_m > 0. */
double ray_path_grazing(const struct ray_path *path, double ground_range_m, double height_m);

/* Returns the grazing angle of the sound at a point itself. */
double ray_path_direction(const struct ray_path *path, double ground_range_m, double height_m);

/* Returns the length, m, of the shadow that a point at top_m throws on ground at ground_m; 0 if the
 * point is not above the ground. */
double ray_path_shadow(const struct ray_path *path, double ground_range_m, double top_m,
                       double ground_m);

/* Returns the ground range, m, at which sound meets the seabed after a travel time of
 * straight_range_m over the straight speed; 0 before sound gets there at all. */
double ray_path_ground_range(const struct ray_path *path, double straight_range_m);

/* Returns the straight range of a point, m. */
double ray_path_range(const struct ray_path *path, double ground_range_m, double height_m);

#endif
