/* Tests backscatter of sediments against the values that the model's own handbook tabulates. */
#include "claims.h"
#include "scene/patch_view.h"
#include "scene/sediment.h"

#define ANGLES 15

/* "APL-UW High-Frequency Ocean Environmental Acoustic Models Handbook", TR 9407 (1994), table 3,
 * pages IV-23 to IV-25, dB at these grazing angles and 1528 m/s; read from a transcription. volume:
 * sigma2 where it is not the grain size's. */
static const double angles_deg[ANGLES] = {1, 2, 3, 5, 7, 10, 20, 40, 60, 70, 80, 85, 88, 89, 90};
static const struct {
    double phi, frequency_hz, volume, strengths_db[ANGLES];
} columns[] = {
    {-1.0,
     30e3,
     0.0,
     {-50.3, -44.2, -40.3, -35.1, -31.7, -28.1, -22.1, -18.9, -16.5, -13.7, -9.9, -8.4, -8.0, -7.9,
      -7.8}},
    {0.5,
     30e3,
     0.0,
     {-47.1, -43.8, -41.5, -37.9, -34.9, -31.5, -25.1, -21.4, -18.8, -15.3, -8.9, -5.6, -4.6, -4.4,
      -4.4}},
    {1.5,
     10e3,
     0.0,
     {-61.5, -56.8, -53.2, -47.6, -43.4, -38.8, -30.9, -24.4, -22.6, -20.4, -13.2, -5.0, 1.2, 2.3,
      2.6}},
    {1.5,
     30e3,
     0.0,
     {-51.4, -48.1, -45.8, -42.1, -39.0, -35.4, -28.3, -23.5, -21.2, -17.7, -10.8, -5.5, -3.4, -3.1,
      -3.1}},
    {1.5,
     100e3,
     0.0,
     {-50.0, -44.9, -41.5, -36.6, -33.3, -29.8, -24.2, -21.7, -19.5, -16.4, -12.2, -10.4, -9.8,
      -9.7, -9.7}},
    {3.5,
     30e3,
     0.0,
     {-59.7, -54.7, -50.8, -44.6, -40.1, -35.2, -27.1, -24.9, -23.7, -23.1, -20.2, -13.1, -5.9,
      -4.3, -3.8}},
    {3.5,
     100e3,
     0.0,
     {-51.4, -47.9, -45.4, -41.3, -37.9, -34.0, -27.0, -24.8, -23.5, -22.3, -18.0, -12.9, -10.3,
      -10.0, -10.0}},
    {6.0,
     30e3,
     0.0,
     {-58.2, -51.1, -46.6, -41.3, -38.3, -35.7, -31.8, -28.8, -27.4, -27.0, -26.3, -23.9, -13.1,
      -6.8, -3.6}},
    {6.0,
     30e3,
     3e-4,
     {-63.4, -56.3, -51.8, -46.5, -43.5, -40.9, -37.0, -34.0, -32.6, -32.1, -30.5, -25.8, -13.3,
      -6.8, -3.6}},
};

TEST(test_the_handbooks_table)
{
    double worst = 0.0;
    for (size_t i = 0; i < COUNT(columns); i++) {
        struct sediment sediment = sediment_of_grain_size(columns[i].phi);
        if (columns[i].volume > 0.0)
            sediment.volume = columns[i].volume;
        for (int k = 0; k < ANGLES; k++) {
            const double found =
                10.0 * log10(sediment_backscatter(&sediment, 1528.0 / columns[i].frequency_hz,
                                                  angles_deg[k] * PI / 180.0));
            if (fabs(found - columns[i].strengths_db[k]) > fabs(worst))
                worst = found - columns[i].strengths_db[k];
            /* the table's tenths, and roundings of its own program before the last of them */
            if (fabs(found - columns[i].strengths_db[k]) > 0.25)
                print_error("phi %g, %g Hz, %g deg: %.2f, not %.1f\n", columns[i].phi,
                            columns[i].frequency_hz, angles_deg[k], found,
                            columns[i].strengths_db[k]);
        }
    }
    print_message("worst: %.2f dB\n", worst);
    assert_true(fabs(worst) <= 0.25);
}

/* The numbers are in the handbook's table 2, page IV-6: medium sand, sandy gravel, sandy mud. */
TEST(test_grain_sizes)
{
    const struct sediment sand = sediment_of_grain_size(1.5), mud = sediment_of_grain_size(6.0);
    assert_true(fabs(sand.density_ratio - 1.845) < 5e-4 && fabs(sand.speed_ratio - 1.1782) < 5e-5);
    assert_true(fabs(sand.loss - 0.01624) < 5e-6 && sand.volume == 0.002);
    assert_true(fabs(sand.strength - 0.004446) < 1e-6);
    assert_true(fabs(sediment_of_grain_size(-1.0).strength - 0.012937) < 1e-6);
    assert_true(fabs(mud.strength - 0.000518) < 1e-6 && mud.volume == 0.001);
}

TEST(test_lambert_is_that_at_the_angle)
{
    const struct sediment sand = sediment_of_grain_size(2.5);
    const double grazing = 0.25, mu = sediment_lambert(2.5, 0.015, grazing);
    assert_true(
        fabs(mu * sin(grazing) * sin(grazing) / sediment_backscatter(&sand, 0.015, grazing) - 1.0) <
        1e-12);
    assert_true(sediment_lambert(0.5, 0.5, 0.5 * PI) <= 1.0 / PI);
}

/* In a patch from range 0 on, the seabed lies behind the bottom's first return. */
TEST(test_lambert_is_that_of_the_seabed_in_view)
{
    struct report report = {.host = NULL};
    static struct water_layer layer = {0.0, 1500.0, 1.0};
    static const struct water water = {&layer, 1, 1, 1500.0};
    static const double first_m[] = {0.0, 12.0};
    static const double middle_m[] = {0.5 * (10.0 + 16.0), 12.0 + 8.0};
    for (int i = 0; i < 2; i++) {
        struct scene scene;
        struct patch_view view;
        scene_init(&scene);
        scene.sonar.altitude_m = 10.0;
        scene.seabed.grain_size_phi = 1.5;
        scene.geometry.column_spacing_m = 0.05;
        scene.geometry.first_slant_range_m = first_m[i];
        EXPECT_OK(&report, patch_view_init(&view, &report, &scene, &water, 0.0, 0.0, 9, 321));
        const double expected = sediment_lambert(1.5, view.wavelength_m, asin(10.0 / middle_m[i]));
        assert_true(fabs(view.seabed_lambert / expected - 1.0) < 1e-9);
    }
}

TEST_PROGRAM(NULL, NULL)
