/* Water in level layers, what it absorbs, and how sound crosses it. The lowest layer is the
 * straight water. Targets lie in it, or reach into layers over it, the slices. A path leads from
 * the sonar, or from its image in level boundaries, to the straight water, and straight from the
 * sonar to the slices too. Pure functions; x along-track plays no part, since layers are level. */
#ifndef SONJECT_MEDIUM_WATER_H
#define SONJECT_MEDIUM_WATER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/report.h"

#define WATER_LAYERS_MAX 4096

/* Layers are listed from the seabed upwards, the first at 0; each ends where the next begins, the
 * last has no upper edge. */
struct water_layer {
    double bottom_m; /* height of its lower edge over the mean seabed */
    double speed_mps;
    double density; /* in the unit of all the others */
};

/* Heights closer than this are taken as the same. */
#define WATER_HEIGHT_STEP_MIN_M 1e-6
#define WATER_SPEED_MIN_MPS     100.0
#define WATER_SPEED_MAX_MPS     10000.0

/* Layers of a profile whose heights rise by WATER_HEIGHT_STEP_MIN_M or more, the last one above the
 * seabed. Each linear piece above the seabed gives equally high layers with the piece's sound speed
 * at their middle, as many as keep the steps from one to the next below 1/20000 of the speed; below
 * the first sample and above the last one the speed is theirs. Equal neighbours are one layer. On
 * success *layers is the caller's for free(). Errors: INPUT (more than WATER_LAYERS_MAX), MEMORY.
 */
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
    size_t slices; /* layers that targets reach into, the straight water included */
    double straight_speed_mps;
};

/* Lays the water: neighbours that do not differ are joined, and so are those up to straight_m over
 * the seabed, at the speed that keeps the travel time straight up. Those that targets reach into,
 * up to sliced_m, are slices: of them, neighbours are joined where that changes no one's speed by
 * more than 3e-5, and the travel time straight up by no more than 5 um of way anywhere. count 0:
 * isovelocity water. On success *water is the caller's for water_clear; on failure nothing is held.
 * Errors: INPUT (a layer up to straight_m differs from all of them joined by more than 1/500),
 * MEMORY. */
sonject_status water_init(struct water *water, struct report *report,
                          const struct water_layer *layers, size_t count,
                          double isovelocity_speed_mps, double straight_m, double sliced_m);
void water_clear(struct water *water);

/* The layer at a height over the seabed. */
const struct water_layer *water_layer_at(const struct water *water, double height_m);

/* A path from the sonar to the straight water, by way of `bounces` boundaries in turn: the seabed
 * and the sea surface, depth_m over it. */
struct ray_path {
    const struct water *water; /* borrowed */
    double sonar_height_m;
    double image_height_m; /* of the sonar, or of its image, over the seabed in unfolded space */
    double depth_m;        /* of the sea surface; of no meaning without bounces */
    uint32_t bounces;
    bool comes_from_seabed; /* the last bounce: the sound goes upwards in the straight water */
    bool is_straight;       /* no other layer is crossed */
};

/* The path of sound that has met no boundary. */
struct ray_path ray_path_direct(const struct water *water, double sonar_height_m);

/* The path by `bounces` >= 1 boundaries in turn, the last of which is the seabed or the surface. */
struct ray_path ray_path_image(const struct water *water, double sonar_height_m, double depth_m,
                               uint32_t bounces, bool comes_from_seabed);

/* Sound at a point of the straight water or a slice. Rays are known by their grazing angles in the
 * straight water, in rad, positive downwards. */
struct arrival {
    double grazing_rad;      /* of the sound's direction at the point itself */
    double ground_range_m;   /* from the sonar, horizontal */
    double straight_range_m; /* travel time times the straight water's speed */
    double length_m;         /* of the path */
    double wavefront_m;      /* width of the wavefront per rad of grazing angle */
    double spreading;        /* s: a target is heard with the intensity (s / (ground range *
                                wavefront))^2 at 1 m of unit source, there and back; what planes
                                transmit is in it. In isovelocity water s = cos of the angle */
};

/* The ray of a grazing angle as it comes to a height: positive, or negative for a path that comes
 * from the seabed, where height_m is above it. INFINITY all over for an angle that no sound from
 * the source has (total reflection on the path). */
struct arrival ray_path_arrival(const struct ray_path *path, double grazing_rad, double height_m);

/* Grazing angle of the ray from the source to a point: a guarded Newton iteration. NaN where it
 * turns back over the straight water. ground_range_m > 0. */
double ray_path_grazing(const struct ray_path *path, double ground_range_m, double height_m);

/* Grazing angle of the sound at a point itself. */
double ray_path_direction(const struct ray_path *path, double ground_range_m, double height_m);

/* Length, on ground of a height, of the shadow of something up there; 0 if it is not over it. */
double ray_path_shadow(const struct ray_path *path, double ground_range_m, double top_m,
                       double ground_m);

/* Ground range at which sound meets the seabed after a travel time of straight_range_m over the
 * straight speed; 0 before it gets there at all. */
double ray_path_ground_range(const struct ray_path *path, double straight_range_m);

/* Straight range of a point. */
double ray_path_range(const struct ray_path *path, double ground_range_m, double height_m);

#endif
