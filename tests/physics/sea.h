/* A small sea for physical claims: one patch, some objects, one device (bench.h). Functions return
 * the library's results as plain numbers, which live until the claim ends. A call that fails ends
 * the claim. */
#ifndef SONJECT_TESTS_SEA_H
#define SONJECT_TESTS_SEA_H

#include <complex.h>

#include <sonject/sonject.h>

#include "../kernel/mesh_samples.h"
#include "bench.h"
#include "inject/injection.h"
#include "scene/params.h"

/* ---- claims ---- */

/* The program tests CLAIM(name) { ... } on the default device. Kernel tests compare all devices. */
#define CLAIM(name)                                                                                \
    static void name(void);                                                                        \
    __attribute__((constructor)) static void add_##name(void)                                      \
    {                                                                                              \
        add_claim(#name, name);                                                                    \
    }                                                                                              \
    static void name(void)

void add_claim(const char *name, void (*hold)(void));

/* Returns zeroed memory that lives until the claim ends. */
void *claim_memory(size_t count, size_t bytes);

/* Registers clear(of) to be called when the claim ends. */
void claim_end(void (*clear)(void *), void *of);

/* Returns the name of the device that claims are tested on now. NULL: the default device. */
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
    bool is_put;                  /* a part was put by hand after the sea was laid */
    struct bench *bench;          /* access to the library's inside */
};

/* Lays a patch with default parameters (100 kHz, 30 kHz, 10 m altitude, 2.5 cm), but with broadside
 * rays alone. The middle column is at a processor range. A sea that was open before is closed. */
struct sea *sea_open(size_t rows, size_t columns, double middle_range_m);

/* Moves the middle column to a processor range, also after spacing or size changed. */
#define sea_move(sea, middle_range_m) bench_move((sea)->bench, middle_range_m)

/* Adds an object in the middle of the patch, rigid and without a rough part. Each length is the
 * shape's own dimension of that name. Valid until the next object is added. */
#define sea_add(sea, shape, length_m, width_m, diameter_m)                                         \
    bench_add((sea)->bench, shape, length_m, width_m, diameter_m)
#define sea_object(sea, number) (&(sea)->bench->scene.objects[number])

/* Adds a sphere in the middle, with its lowest point at a height. */
sonject_object_params *sea_add_sphere(struct sea *sea, double radius_m, double height_m);
/* Adds a capsule across the line of sight, a bit buried, with glints and a rough part. */
sonject_object_params *sea_add_capsule(struct sea *sea);
void place_in_pixels(sonject_object_params *object, double row, double column);
void place_in_metres(sonject_object_params *object, double along_m, double range_m);

/* Takes the glints away and sets Lambert's law. */
void make_rough(sonject_object_params *object, double lambert);

/* Adds a part to the first object, which is made of parts, and gives it that object's surface.
 * Angles turn it about its own axes. Valid until the next part is added. */
sonject_object_params *sea_add_part(struct sea *sea, enum shape_kind shape, const double centre[3],
                                    const double heading_pitch_roll[3]);

/* Gives all objects and their parts a surface. */
void sea_set_material(struct sea *sea, const sonject_material_params *material);

/* Makes a sample the scene's next mesh. */
void sea_add_mesh(struct sea *sea, const struct mesh_sample *mesh, double unit_m,
                  double smooth_angle_rad);

/* Adds the mesh of a tetrahedron within 0.5 m of its middle. */
#define sea_add_tetrahedron(sea) bench_add_tetrahedron((sea)->bench)

/* Shape the seabed: a raised cosine, `beyond_m` beyond the patch's middle (a pit if the height is
 * negative); ripples across a heading; a scour about the first object; any heights. */
void sea_add_mound(struct sea *sea, double radius_m, double height_m, double beyond_m);
void sea_add_ripples(struct sea *sea, double wavelength_m, double height_m, double heading_rad,
                     double sharpness);
void sea_add_scour(struct sea *sea, double width_m, double depth_m);
void sea_set_heights(struct sea *sea, const sonject_relief_params *grid, const float *heights_m);

/* Makes a material a mirror without a rough part. */
void set_mirror(sonject_material_params *material, double reflection);

/* ---- what is laid ---- */

/* Works out view, response and places from the scene as it now is. Every trace does so by sea_lay,
 * unless a part was put by hand since. */
void sea_ready(struct sea *sea);
void sea_lay(struct sea *sea);
#define sea_set_layers(sea, layers, count) bench_set_layers((sea)->bench, layers, count)

/* Checks the response for image formation, after sea_ready. sea_message tells why it fails. */
sonject_status sea_check_response(struct sea *sea);
#define sea_message(sea) ((const char *)(sea)->bench->report.message)

/* Expects that the call, which has the sea's report, fails for bad input and says these words. */
#define EXPECT_REFUSED(sea, words, call)                                                           \
    do {                                                                                           \
        assert_int_equal(call, SONJECT_ERROR_INPUT);                                               \
        if (!strstr(sea_message(sea), words))                                                      \
            fail_msg("'%s' does not say '%s'", sea_message(sea), words);                           \
    } while (0)

/* Places of the patch. Ranges are processor ranges, heights those of the relief. */
#define sea_view(sea)                  (&(sea)->bench->tracer.view)
#define sea_range(sea, column)         view_processor_range(sea_view(sea), column)
#define sea_column(sea, range_m)       view_column_of_range(sea_view(sea), range_m)
#define sea_ground(sea, range_m)       view_ground_range(sea_view(sea), range_m)
#define sea_grazing(sea, range_m)      view_grazing(sea_view(sea), range_m)
#define sea_x(sea, row)                view_x_of_row(sea_view(sea), row)
#define sea_height(sea, x_m, ground_m) relief_height((sea)->bench->placed.relief, x_m, ground_m)
#define sea_wavelength(sea)            (sea_view(sea)->wavelength_m)
double sea_wavenumber(const struct sea *sea);

/* The pulse G or its real part, W of a straight track, and the integrals of their squares, m. */
#define sea_response(sea)      (&(sea)->bench->tracer.response)
#define sea_pulse_energy(sea)  range_energy_width(sea_response(sea))
#define sea_window_energy(sea) along_track_energy_width(sea_response(sea))
double sea_pulse(const struct sea *sea, double distance_m);
double complex sea_pulse_complex(const struct sea *sea, double distance_m);
double sea_window(const struct sea *sea, double distance_m);

/* Set tables of the pulse, over s or m, and of W, over m. Imaginary parts may be NULL. */
void sea_set_pulse(struct sea *sea, const double *positions, const double *real_part,
                   const double *imaginary_part, size_t count, bool is_in_seconds);
void sea_set_window(struct sea *sea, const double *positions, const double *real_part,
                    const double *imaginary_part, size_t count);

/* Returns the expected cross-section of a level seabed's pixel, as the library levels patches. */
double sea_seabed_level(const struct sea *sea, double processor_range_m);

/* Properties of a part of an object. */
#define sea_part(sea, part)        (&(sea)->bench->placements[part])
#define sea_centre(sea, part)      ((const double *)sea_part(sea, part)->centre)
#define sea_axes(sea, part)        ((const double(*)[3])sea_part(sea, part)->axes)
#define sea_slant_range(sea, part) placement_range(sea_part(sea, part), sea_view(sea))

/* Puts a part at an exact place, after sea_ready. nose and own_y: orthogonal unit vectors. */
void sea_put(struct sea *sea, uint32_t part, const double centre[3], const double nose[3],
             const double own_y[3]);

/* Turns the first object's nose to the sonar, and then up by `forward` rad. */
void face_sonar(struct sea *sea, double forward);

/* ---- glints, of one object, mirrors and all ---- */

/* The sum of all sub-strips, bin by bin along processor range, without a cross-range response. */
struct line {
    size_t bins;
    double first_range_m, spacing_m;
    double complex *values;
};

struct line sea_line(struct sea *sea, uint32_t object);

/* Return the amplitude after the pulse: at a processor range, or the largest one and its range. */
double complex line_at(const struct sea *sea, const struct line *line, double range_m);
double line_peak(const struct sea *sea, const struct line *line, double *range_m);
double line_energy(const struct line *line);
double line_energy_in_band(const struct sea *sea, const struct line *line); /* the pulse's band */

/* Adds another line, times a factor, where both have bins. */
void line_add(struct line *sum, const struct line *line, double factor);

/* Returns the peak of the first object's line. */
double sea_peak(struct sea *sea, double *range_m);

/* ---- energies before the image is formed ---- */

/* Energies, strips x bins. Strip 0 here is number first_strip, of strips_per_row a row. */
struct strips {
    int strips, bins, first_strip, first_bin, strips_per_row, bins_per_pixel;
    const float *energy;
};
struct tile_sums {
    double energy, lost, footprint; /* a part's echo, hidden seabed (m2), rays that hit */
};

/* Trace the rough part and return the seabed's energy without objects. sums, tiles: of each part;
 * may be NULL. is_beam: an even seabed as the beam of a real aperture sees it, one strip a ping. */
struct strips sea_rough(struct sea *sea, struct tile_sums *sums, struct strips *tiles);
struct strips sea_rough_of(struct sea *sea, bool is_beam, struct tile_sums *sums,
                           struct strips *tiles);

/* Returns the strips of the patch's tallies, and where they begin and end along x. */
struct strips sea_grid(const struct sea *sea, double *first_x, double *last_x);

#define CHAIN_RANGES 12
#define CHAIN_ORDERS 4

/* Sums over seeds of the energies of chains, by order (index 0: two interactions) and range. */
struct ranges {
    int count;
    double first_m, width_m;
};
struct energies {
    int seeds;
    double sum[CHAIN_ORDERS][CHAIN_RANGES], square[CHAIN_ORDERS][CHAIN_RANGES];
};

/* Traces chains. ranges: those that count; with a count of 0 all are one. */
struct energies sea_chains(struct sea *sea, const struct ranges *ranges, uint64_t first_seed,
                           int seeds);
/* Traces chains after `change` has changed the device's input (bench.h). */
struct energies sea_changed_chains(struct sea *sea, const struct ranges *ranges,
                                   uint64_t first_seed, int seeds,
                                   void (*change)(struct bench *bench, struct chain_trace *trace));

/* Compares an order's energies with the expected ones, range by range and in their sum, where the
 * latter are a fiftieth of the largest or more. systematic: as a share. In `least` ranges or more
 * the error must be below the share `resolved` of the energy. */
void expect_energies(const char *what, const struct energies *measured, int order,
                     const struct estimate *expected, int count, double systematic, double resolved,
                     int least);
struct estimate energy_of(const struct energies *energies, int order, int range);

/* ---- images ---- */

struct image {
    size_t rows, columns, pixels;
    const float *seabed_energy, *level_energy, *lost_energy, *target_energy, *energy;
    const float *order_energy[CHAIN_ORDERS];
    uint32_t orders;
    const double complex *target, *seabed; /* fields of one realisation, m */
    const struct object_echo *objects;
};

/* Form the image of the sea. map: reflectivity over mu0 or NULL. Without speckle seabed is NULL. */
const struct image *sea_image(struct sea *sea);
const struct image *sea_image_of(struct sea *sea, const float *map, bool has_speckle);
double sum_of(const float *plane, size_t count);
double complex brightest(const struct image *image, size_t *row, size_t *column);

/* Returns 1 - lost / all, pixel by pixel. */
double *visibility_of(const struct image *image);

/* Returns whether any plane differs in a bit. */
bool images_differ(const struct image *one, const struct image *other);

/* Returns the largest difference of two images' targets, and the largest value of the first. */
double image_difference(const struct image *one, const struct image *other, double *peak);

/* Returns complex normal deviates of unit mean square with the sonar's point response: those that
 * the library puts into images, those it takes for the phases of amplitudes, or others (MEASURED,
 * MEASURED + 1 and so on). */
enum noise {
    NOISE_OF_IMAGE,
    NOISE_OF_PHASE,
    NOISE_MEASURED
};
double complex *sea_noise(struct sea *sea, enum noise kind);

/* Returns the seabed's energy, expected or of one realisation, over that expected of a pixel at its
 * processor range (sea_seabed_level or a closed form). It is the mean of the columns' means,
 * without the edges. Its error allows for three correlated columns, the most within a pulse. */
typedef double expected_level(const struct sea *sea, double processor_range_m);
struct estimate level_over(const struct sea *sea, const struct image *image, size_t edge_rows,
                           size_t edge_columns, bool is_field, expected_level *expected);

/* Return the mean of conj(a) b over pixels a and pixels b that lie `rows` and `columns` further on,
 * and a field over the roots of its expected energies. */
double complex correlation_of(const struct sea *sea, const double complex *field, size_t rows,
                              size_t columns, size_t edge);
double complex *unit_field(const struct sea *sea, const double complex *field, const float *energy);

/* ---- injections ---- */

/* Planes of an injection, and the windows that it traced. */
struct injected {
    const float *image, *field, *energy, *visibility, *order_energy[CHAIN_ORDERS];
    const uint8_t *highlight, *shadow, *labels, *influence;
    const sonject_object_truth *objects;
    sonject_statistics statistics;
    const struct injected_window *windows;
    size_t window_count;
};

/* pixels: amplitudes or pairs. sea_inject_whole traces all of the patch instead of windows. */
const struct injected *sea_inject(struct sea *sea, const float *pixels, bool is_complex);
const struct injected *sea_inject_whole(struct sea *sea, const float *pixels, bool is_complex);
float *pairs_of(const double complex *field, size_t count);
float *magnitudes_of(const double complex *field, size_t count);

/* Returns the level of a measured patch. */
const struct patch_level *sea_level(struct sea *sea, const float *pixels, bool is_complex);

#endif
