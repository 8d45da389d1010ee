/* A small sea for physical claims: one patch, some objects, one device. What the library computes
 * of it is given out as plain numbers, and its inside is named in sea*.c alone; all that is given
 * out lives until the claim ends. Calls that fail end the claim. */
#ifndef SONJECT_TESTS_SEA_H
#define SONJECT_TESTS_SEA_H

#include <complex.h>

#include <sonject/sonject.h>

#include "claims.h"
#include "estimate.h"

struct bench;
struct water_layer;

/* ---- claims ---- */

struct claim {
    const char *name;
    void (*hold)(void);
};

#define CLAIM(function)                                                                            \
    {                                                                                              \
#function, function                                                                        \
    }

/* The program: each claim, on every device. */
#define CLAIMS(...)                                                                                \
    int main(void)                                                                                 \
    {                                                                                              \
        static const struct claim claims[] = {__VA_ARGS__};                                        \
        return hold_claims(claims, COUNT(claims));                                                 \
    }

int hold_claims(const struct claim *claims, size_t count);

/* Memory of zeros until the claim ends. */
void *claim_memory(size_t count, size_t bytes);

/* The device that claims are held on now; NULL: the default one. */
const char *claim_device(void);

/* ---- the scene ---- */

struct sea {
    sonject_sonar_params *sonar;
    sonject_pulse_params *pulse;
    sonject_motion_params *motion;
    sonject_medium_params *medium;
    sonject_seabed_params *seabed;
    sonject_surface_params *surface;
    sonject_geometry_params *geometry;
    sonject_injection_params *injection;
    size_t rows, columns, pixels; /* pixels: rows x columns */
    struct bench *bench;          /* the library's inside */
};

/* Lays a patch with default parameters: 100 kHz, 30 kHz, 10 m altitude, 2.5 cm, but with broadside
 * rays alone. Its middle column is at an apparent range. There is one sea at a time: an earlier one
 * is closed. */
struct sea *sea_open(size_t rows, size_t columns, double middle_range_m);

/* Puts the middle column somewhere else, after spacing or size changed. */
void sea_move(struct sea *sea, double middle_range_m);

/* An object in the middle of the patch, rigid and without a rough part; all lengths are those of
 * the shape's own words. Valid until the next one is added. */
sonject_object_params *sea_add(struct sea *sea, sonject_shape shape, double length_m,
                               double width_m, double diameter_m);

/* A sphere in the middle, its lowest point at a height. */
sonject_object_params *sea_add_sphere(struct sea *sea, double radius_m, double height_m);
sonject_object_params *sea_object(const struct sea *sea, uint32_t number);
void place_in_pixels(sonject_object_params *object, double row, double column);
void place_in_metres(sonject_object_params *object, double along_m, double range_m);

/* No glint, and Lambert's law. */
void make_rough(sonject_object_params *object, double lambert);

/* A part of the first object, which is of parts, with that one's surface; turned about its own
 * axes. Valid until the next one is added. */
sonject_object_params *sea_add_part(struct sea *sea, sonject_shape shape, const double centre[3],
                                    const double heading_pitch_roll[3]);

/* Gives all objects and their parts a surface. */
void sea_set_material(struct sea *sea, const sonject_material_params *material);

/* The scene's next mesh. */
struct triangles {
    const double *positions; /* vertices x 3, m */
    const uint32_t *corners;
    size_t vertices, triangles;
};
void sea_add_mesh(struct sea *sea, const struct triangles *mesh, double unit_m,
                  double smooth_angle_rad);

/* The scene's next shape by code (user_codes.h); bounds are taken from its bounding radius. */
void sea_add_code(struct sea *sea, const char *name, const char *code, double bounding_radius_m,
                  double first, double second);

/* A tetrahedron within 0.5 m of its middle. */
void sea_add_tetrahedron(struct sea *sea);

/* The seabed: a raised cosine (a pit where the height is negative) so far beyond the patch's
 * middle; ripples across a heading; a scour about the first object; or any heights. */
void sea_add_mound(struct sea *sea, double radius_m, double height_m, double beyond_m);
void sea_add_ripples(struct sea *sea, double wavelength_m, double height_m, double heading_rad,
                     double sharpness);
void sea_add_scour(struct sea *sea, double width_m, double depth_m);
void sea_set_heights(struct sea *sea, const sonject_relief_params *grid, const float *heights_m);
void sea_set_layers(struct sea *sea, const struct water_layer *layers, size_t count);

/* A material that mirrors alone. */
void set_mirror(sonject_material_params *material, double reflection);

/* ---- what is laid ---- */

/* Whether image formation takes it, after sea_ready; why not: sea_message. */
sonject_status sea_check_response(struct sea *sea);
const char *sea_message(const struct sea *sea);

/* Works out view, response and places from the scene as it now is. */
void sea_ready(struct sea *sea);
double sea_range(const struct sea *sea, double column); /* apparent */
double sea_column(const struct sea *sea, double processor_range_m);
double sea_ground(const struct sea *sea, double processor_range_m);
double sea_grazing(const struct sea *sea, double processor_range_m);
double sea_x(const struct sea *sea, double row);
double sea_height(const struct sea *sea, double x_m, double ground_m);      /* of the relief */
const struct water_layer *sea_layers(const struct sea *sea, size_t *count); /* as they were laid */
double sea_wavelength(const struct sea *sea);
double sea_wavenumber(const struct sea *sea);
double sea_pulse(const struct sea *sea, double distance_m); /* G, its real part */
double complex sea_pulse_complex(const struct sea *sea, double distance_m);
double sea_window(const struct sea *sea, double distance_m); /* W of a straight track */
double sea_pulse_energy(const struct sea *sea);              /* integrals of their squares, m */
double sea_window_energy(const struct sea *sea);

/* Half width, m, beyond which less than a share of W's energy lies. */
double sea_window_reach(const struct sea *sea, double share);

/* Integral of |W|^2, m, whatever the aperture, at an apparent range. */
double sea_cross_range_energy(const struct sea *sea, double processor_range_m);

/* Tables of the pulse, over seconds or m, and of W over m; imaginary parts may be NULL. */
void sea_set_pulse(struct sea *sea, const double *positions, const double *real_part,
                   const double *imaginary_part, size_t count, bool is_in_seconds);
void sea_set_window(struct sea *sea, const double *positions, const double *real_part,
                    const double *imaginary_part, size_t count);

/* Expected cross-section of a pixel of level seabed as the library levels patches. */
double sea_seabed_level(const struct sea *sea, double processor_range_m);

/* Of a part of an object. */
const double *sea_centre(const struct sea *sea, uint32_t part);
const double (*sea_axes(const struct sea *sea, uint32_t part))[3];
double sea_slant_range(const struct sea *sea, uint32_t part);

/* The whole object's lowest and highest point and origin, m over the mean seabed. */
void sea_heights(const struct sea *sea, uint32_t object, double heights[3]);

/* Puts it exactly where it is wanted, after sea_ready; nose and own y are square unit vectors. */
void sea_put(struct sea *sea, uint32_t part, const double centre[3], const double nose[3],
             const double own_y[3]);

/* Turns the first object's nose to the sonar, and then by `forward` up. */
void face_sonar(struct sea *sea, double forward);

/* ---- glints, of one object, mirrors and all ---- */

/* Without any cross-range response: the sum of all sub-strips, bin by bin along apparent range. */
struct line {
    size_t bins;
    double first_range_m, spacing_m;
    double complex *values;
};

struct line sea_line(struct sea *sea, uint32_t object);

/* Through the pulse, at an apparent range; the largest amplitude after it, and its range. */
double complex line_at(const struct sea *sea, const struct line *line, double range_m);
double line_peak(const struct sea *sea, const struct line *line, double *range_m);
double line_energy(const struct line *line);

/* Adds another line, times a factor, where both have bins. */
void line_add(struct line *sum, const struct line *line, double factor);

/* After sea_ready: the peak of the first object's line. */
double sea_peak(struct sea *sea, double *range_m);

/* ---- energies before the image is formed ---- */

/* Of the seabed without objects, strips x bins; strip 0 is first_strip of strips_per_row a row. */
struct strips {
    int strips, bins, first_strip, first_bin, strips_per_row, bins_per_pixel;
    const float *energy;
};
struct tile_sums {
    double energy, lost, footprint; /* of one part: its echo, hidden seabed (m2), rays that hit */
};

/* The rough part. sums, tiles: of each part; may be NULL. And of an even seabed as the beam of a
 * real aperture sees it, one strip a ping. */
struct strips sea_rough(struct sea *sea, struct tile_sums *sums, struct strips *tiles);
struct strips sea_rough_of_beam(struct sea *sea);

/* Strips of which the patch's tallies are made, and where they begin and end along x. */
struct strips sea_grid(const struct sea *sea, double *first_x, double *last_x);

#define CHAIN_RANGES 12
#define CHAIN_ORDERS 4

/* Energies of several interactions by order (index 0: two) and range, sums over seeds. */
struct ranges {
    int count;
    double first_m, width_m;
};
struct energies {
    int seeds;
    double sum[CHAIN_ORDERS][CHAIN_RANGES], square[CHAIN_ORDERS][CHAIN_RANGES];
};

/* ranges: those counted; count 0: all in one. */
struct energies sea_chains(struct sea *sea, const struct ranges *ranges, uint64_t first_seed,
                           int seeds);
/* The same where a claim changes what the device is told (bench.h) before rays are traced. */
struct chain_trace;
struct energies sea_changed_chains(struct sea *sea, const struct ranges *ranges,
                                   uint64_t first_seed, int seeds,
                                   void (*change)(struct bench *bench, struct chain_trace *trace));

/* How many rays more than begun were followed, connections to the source among them. */
uint64_t sea_queries(const struct sea *sea);
struct estimate energy_of(const struct energies *energies, int order, int range);

/* ---- images ---- */

struct object_image {
    size_t first_column, columns;
    const float *energy;
    double peak_energy;
};
struct image {
    size_t rows, columns, pixels;
    const float *seabed_energy, *level_energy, *lost_energy, *target_energy, *energy;
    const float *order_energy[CHAIN_ORDERS];
    uint32_t orders;
    const double complex *target, *seabed; /* realisations, m */
    const struct object_image *objects;
};

/* Of the sea as it is laid. map: reflectivity over mu0 or NULL; seabed is NULL without speckle. */
const struct image *sea_image(struct sea *sea);
const struct image *sea_image_of(struct sea *sea, const float *map, bool has_speckle);
double sum_of(const float *plane, size_t count);
double complex brightest(const struct image *image, size_t *row, size_t *column);

/* 1 - lost / all, pixel by pixel. */
double *visibility_of(const struct image *image);

/* Whether any plane differs in a bit. */
bool images_differ(const struct image *one, const struct image *other);

/* Largest difference of two realisations of targets, and the largest value of the first. */
double image_difference(const struct image *one, const struct image *other, double *peak);

/* Complex normal deviates of unit mean square with the sonar's point response, pairs: what the
 * library puts into images, what it takes for the phases of amplitudes, or others (MEASURED, and
 * MEASURED + 1 and so on). */
enum noise {
    NOISE_OF_IMAGE,
    NOISE_OF_PHASE,
    NOISE_MEASURED
};
double complex *sea_noise(struct sea *sea, enum noise kind);

/* Of the seabed, energy or realisation, over that of its plain pixels, without so many columns at
 * either side: the mean of the columns' means and its error, were these independent. */
struct estimate level_over(const struct sea *sea, const struct image *image, size_t edge,
                           bool is_field);

/* Mean of conj(a) b over pixels a and those b so many rows and columns on; and a field over the
 * roots of its expected energies. */
double complex correlation_of(const struct sea *sea, const double complex *field, size_t rows,
                              size_t columns, size_t edge);
double complex *unit_field(const struct sea *sea, const double complex *field, const float *energy);

/* ---- injections ---- */

struct injected {
    const float *image, *energy, *visibility;
    const float *field; /* pairs */
    const float *order_energy[CHAIN_ORDERS];
    const uint8_t *highlight, *labels, *influence;
    const sonject_object_truth *objects;
    sonject_statistics statistics;
};

/* pixels: amplitudes or pairs. */
const struct injected *sea_inject(struct sea *sea, const float *pixels, bool is_complex);
float *pairs_of(const double complex *field, size_t count);
float *magnitudes_of(const double complex *field, size_t count);

/* The level of a measured patch, its mean over pixels of one kind: intensity of the patch, energy
 * of plain seabed (m2) by column, and noise over level. */
struct level {
    const float *level, *cell_energy;
    double noise_ratio;
};
struct level sea_level(struct sea *sea, const float *pixels, bool is_complex);

#endif
