/* A composite traces windows about the pixels that objects change. A reference that traces the
 * whole patch changes nothing outside them. Inside, its rays bring the same echoes but for
 * rounding. */
#include "inject/compose.h"
#include "sea.h"

#define ROWS    560
#define COLUMNS 560
#define PIXELS  ((size_t)ROWS * COLUMNS)
#define RANGE   45.0
#define SEEDS   2

static struct sea *open_sea(void)
{
    struct sea *sea = sea_open(ROWS, COLUMNS, RANGE);
    sea->sonar->response_window = SONJECT_WINDOW_TAYLOR;
    sea->sonar->taylor_sidelobe_db = 35.0;
    sea->sonar->taylor_terms = 4;
    sea->injection->estimate_noise = 0;
    sea->injection->noise_floor_db = -20.0;
    return sea;
}

static void add_target(struct sea *sea, double row, double column)
{
    place_in_pixels(sea_add_capsule(sea), row, column);
}

/* The scenes. Each function adds its objects and returns how many windows they need. */
static size_t lay_target(struct sea *sea)
{
    add_target(sea, 250.0, 200.0);
    return 1;
}

static size_t lay_aperture(struct sea *sea)
{
    sea->sonar->aperture_rad = -1.0; /* the aperture of the resolution */
    add_target(sea, 250.0, 200.0);
    return 1;
}

static size_t lay_two_apart(struct sea *sea)
{
    add_target(sea, 90.0, 100.0);
    add_target(sea, 470.0, 320.0);
    return 2;
}

static size_t lay_edges(struct sea *sea)
{
    add_target(sea, 3.0, 300.0);
    add_target(sea, 480.0, 555.0);
    return 2;
}

static size_t lay_beam(struct sea *sea)
{
    sea->sonar->kind = SONJECT_SONAR_REAL;
    sea->sonar->array_length_m = 2.0;
    add_target(sea, 250.0, 200.0);
    return 1;
}

static size_t lay_sea_surface(struct sea *sea)
{
    sea->surface->water_depth_m = 12.0;
    sea->injection->interactions = 2;
    sea->injection->order_energies = 1;
    add_target(sea, 250.0, 100.0);
    return 1;
}

static size_t lay_two_interactions(struct sea *sea)
{
    sea->injection->interactions = 2;
    add_target(sea, 250.0, 120.0);
    sea->injection->order_energies = 1;
    return 1;
}

static size_t (*const scenes[])(struct sea *) = {
    lay_target, lay_aperture,    lay_two_apart,        lay_edges,
    lay_beam,   lay_sea_surface, lay_two_interactions,
};

static bool is_in_windows(const struct injected *result, size_t i)
{
    const size_t row = i / COLUMNS;
    const size_t column = i % COLUMNS;
    for (size_t k = 0; k < result->window_count; k++) {
        const struct window *at = &result->windows[k].at;
        if (row >= at->first_row && row < at->first_row + at->rows && column >= at->first_column &&
            column < at->first_column + at->columns)
            return true;
    }
    return false;
}

/* Returns a patch with speckle and uneven levels. */
static const float *measured(struct sea *sea)
{
    sea_ready(sea);
    const double complex *field = sea_noise(sea, NOISE_MEASURED);
    float *pixels = magnitudes_of(field, PIXELS);
    for (size_t i = 0; i < PIXELS; i++)
        pixels[i] *=
            1.0f + 0.5f * sinf(0.02f * (float)(i % COLUMNS) + 0.01f * (float)(i / COLUMNS));
    return pixels;
}

/* Raises *image and *energy to the differences within the windows: the rms difference of the images
 * over the rms change, and that of the energies over their rms. */
static void add_differences(double *image, double *energy, const struct injected *window,
                            const struct injected *whole, const float *pixels)
{
    double differences[2] = {0.0, 0.0}, sums[2] = {0.0, 0.0};
    for (size_t i = 0; i < PIXELS; i++) {
        if (!is_in_windows(window, i) || !window->influence[i] || !whole->influence[i])
            continue;
        differences[0] += pow((double)window->image[i] - whole->image[i], 2.0);
        sums[0] += pow((double)whole->image[i] - pixels[i], 2.0);
        differences[1] += pow((double)window->energy[i] - whole->energy[i], 2.0);
        sums[1] += pow((double)whole->energy[i], 2.0);
    }
    *image = fmax(*image, sqrt(differences[0] / sums[0]));
    *energy = fmax(*energy, sqrt(differences[1] / sums[1]));
}

/* Sums over the pixels beyond the windows: changed ones, energy of two interactions, and energy of
 * plain seabed. Many pixels are summed, since few rays go there and each brings much. */
struct beyond {
    double pixels, changed, energy, seabed;
};

static void look_beyond(struct beyond *beyond, const struct injected *window,
                        const struct injected *whole)
{
    for (size_t i = 0; i < PIXELS; i++) {
        if (is_in_windows(window, i))
            continue;
        beyond->pixels += 1.0;
        beyond->changed += whole->influence[i] != 0;
        beyond->energy += whole->order_energy[1] ? whole->order_energy[1][i] : 0.0;
        beyond->seabed += window->energy[i];
    }
}

CLAIM(windows_show_what_the_whole_patch_does)
{
    for (size_t scene = 0; scene < sizeof scenes / sizeof *scenes; scene++) {
        struct sea *sea = open_sea();
        const size_t windows = scenes[scene](sea);
        const float *pixels = measured(sea);
        struct beyond beyond = {0.0, 0.0, 0.0, 0.0};
        double image = 0.0, energy = 0.0;
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            sea->injection->seed = 100 + seed;
            const struct injected *window = sea_inject(sea, pixels, false);
            const struct injected *whole = sea_inject_whole(sea, pixels, false);
            assert_int_equal(window->window_count, windows);
            assert_int_equal(whole->window_count, 1);
            look_beyond(&beyond, window, whole);
            add_differences(&image, &energy, window, whole, pixels);
        }
        print_message("scene %zu: %.0f %% of the patch are beyond the windows, %.1f pixels of them "
                      "changed, by %.1e of the seabed; images differ by %.1e of the change, "
                      "energies by %.1e\n",
                      scene, 100.0 * beyond.pixels / SEEDS / PIXELS, beyond.changed / SEEDS,
                      beyond.energy / beyond.seabed, image, energy);
        assert_true(beyond.pixels > 0.1 * SEEDS * PIXELS);
        if (sea->injection->interactions > 1)
            assert_true(beyond.energy <
                        pow(10.0, sea->injection->influence_db / 10.0) * beyond.seabed);
        else
            assert_true(beyond.changed == 0.0);
        assert_true(image < 5e-3 && energy < 1e-4);
    }
}
