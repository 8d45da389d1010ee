/* What a synthetic aperture's shadows become with range: in them, at 0.6 of their length behind
 * the target, penumbrae are wider and narrow targets' shadows brighter the farther the target is.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "aperture_screen.h"

#define SCREEN_HEIGHT 0.5 /* m */

static const double ranges[] = {25.0, 60.0, 150.0};
static const size_t range_count = sizeof ranges / sizeof *ranges;

/* What is seen within a screen's shadow. */
struct shadow {
    double *visibility; /* of every pixel */
    size_t column;
    double distance;         /* m behind the screen */
    double slope_of_aspects; /* wavelength over twice the resolution */
};

static struct shadow shadow_behind(double range, double width)
{
    struct bench bench;
    struct shadow shadow;
    open_synthetic_aperture(&bench, range, SONJECT_WINDOW_RECTANGULAR, 16.0);
    bench_ready(&bench);
    const double altitude = bench.tracer.view.altitude_m;
    const double near_range = range - 4.0;
    const double ground = sqrt(near_range * near_range - altitude * altitude);
    add_screen(&bench, width, SCREEN_HEIGHT, ground);
    shadow.visibility = visibility_of(&bench);
    /* the ray over the screen's top: as long as the way to its foot, times height over what is left
     * of the altitude */
    const double length = SCREEN_HEIGHT / (altitude - SCREEN_HEIGHT) * near_range;
    shadow.column = column_behind(&bench, ground, 0.6 * length);
    shadow.distance = distance_behind(&bench, (double)shadow.column, ground);
    shadow.slope_of_aspects = bench.tracer.view.wavelength_m / (2.0 * ROW_SPACING);
    bench_close(&bench);
    return shadow;
}

/* A ramp of visibility v from 0 to 1 has a width of six times the integral of v (1 - v): here both
 * edges of a screen that is wider than its penumbrae, in rows that hold nothing else. Nine columns
 * of 560 stratified rays a point leave a rms of visibility below 0.01, which takes 6 x 10^-4 of the
 * width; rows of 2.5 cm add less than 0.01 to the narrowest. */
static void test_penumbra_grows_with_range(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < range_count; i++) {
        const struct shadow shadow = shadow_behind(ranges[i], 2.0);
        double integral = 0.0;
        for (size_t row = 0; row < ROWS; row++) {
            const double v = visibility_at(shadow.visibility, row, shadow.column);
            integral += v * (1.0 - v) * ROW_SPACING;
        }
        const double geometry = shadow.distance * shadow.slope_of_aspects;
        print_message("%.0f m, %.2f m behind the screen: ", ranges[i], shadow.distance);
        expect_close("width of the penumbra over the geometry's", 0.5 * 6.0 * integral / geometry,
                     1.0, 0.03);
        free(shadow.visibility);
    }
}

/* Behind a screen of width w, from 2 w resolution / wavelength on, the aspects that look around it
 * are a share of 1 - that / d: a shadow's contrast falls with range as its length grows. */
static void test_contrast_falls_with_range(void **unused)
{
    (void)unused;
    static const double width = 0.24;
    double last = -1.0;
    for (size_t i = 0; i < range_count; i++) {
        const struct shadow shadow = shadow_behind(ranges[i], width);
        const double closing = width / shadow.slope_of_aspects;
        const double lit = shadow.distance < closing ? 0.0 : 1.0 - closing / shadow.distance;
        const double seen = visibility_at(shadow.visibility, MIDDLE_ROW, shadow.column);
        print_message("%.0f m, %.2f m behind the screen: ", ranges[i], shadow.distance);
        /* noise as above; the tangent's growth over the sine's and cos^2 are below 0.02 */
        expect_close("visibility in the middle", seen, lit, 0.03);
        assert_true(seen > last);
        last = seen;
        free(shadow.visibility);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_penumbra_grows_with_range),
                                       cmocka_unit_test(test_contrast_falls_with_range)};
    return bench_run_on_devices(tests, sizeof tests / sizeof *tests);
}
