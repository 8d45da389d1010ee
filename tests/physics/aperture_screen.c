#include "aperture_screen.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "trace/aspects.h"

void open_synthetic_aperture(struct bench *bench, double range_m, uint32_t window, double ray_scale)
{
    bench_open(bench, ROWS, COLUMNS, range_m);
    bench->scene.geometry.row_spacing_m = ROW_SPACING;
    bench->scene.sonar.aperture_rad = -1.0;
    bench->scene.sonar.response_window = window;
    bench->scene.injection.ray_scale = ray_scale;
}

void add_screen(struct bench *bench, double width_m, double height_m, double ground_range_m)
{
    sonject_object_params *screen =
        bench_add(bench, SONJECT_SHAPE_PLANE, width_m, 2.0 * height_m, 0.0);
    screen->roll_rad = 0.5 * PI;
    screen->burial_m = height_m;
    screen->position_kind = SONJECT_POSITION_PIXELS;
    screen->position_along = MIDDLE_ROW;
    bench_ready(bench);
    screen->position_range = view_column_of_range(
        &bench->tracer.view, hypot(ground_range_m, bench->tracer.view.altitude_m));
}

double *visibility_of(struct bench *bench)
{
    struct echoes echoes;
    bench_ready(bench);
    bench_echoes(bench, NULL, SEABED_FIELD_NONE, &echoes);
    double *visibility = calloc(ROWS * COLUMNS, sizeof *visibility);
    assert_non_null(visibility);
    for (size_t i = 0; i < ROWS * COLUMNS; i++)
        visibility[i] = 1.0 - (double)echoes.lost_energy[i] / echoes.seabed_energy[i];
    echoes_clear(&echoes);
    return visibility;
}

double window_energy(uint32_t window, double offset)
{
    const double amplitude =
        window == SONJECT_WINDOW_HAMMING ? 0.54 + 0.46 * cos(2.0 * PI * offset) : 1.0;
    return amplitude * amplitude;
}

double expected_visibility(double x, double width, double d, double largest_sine, uint32_t window)
{
    const int steps = 4000;
    double seen = 0.0, all = 0.0;
    for (int i = 0; i < steps; i++) {
        const double offset = (i + 0.5) / steps - 0.5;
        const double sine = 2.0 * largest_sine * offset;
        const double energy = window_energy(window, offset) * (1.0 - sine * sine);
        const double at_screen = x - d * sine / sqrt(1.0 - sine * sine);
        seen += fabs(at_screen) > 0.5 * width ? energy : 0.0;
        all += energy;
    }
    return seen / all;
}

double distance_behind(const struct bench *bench, double column, double screen_ground)
{
    const double range = view_apparent_range(&bench->tracer.view, column);
    const double ground = view_ground_range(&bench->tracer.view, range);
    return (ground - screen_ground) * range / ground;
}

size_t column_behind(const struct bench *bench, double screen_ground, double distance)
{
    size_t column = 0;
    while (column + 1 < COLUMNS && distance_behind(bench, (double)column, screen_ground) < distance)
        column++;
    return column;
}

double visibility_at(const double *visibility, size_t row, size_t column)
{
    double mean = 0.0;
    for (size_t k = column - 4; k <= column + 4; k++)
        mean += visibility[row * COLUMNS + k] / 9.0;
    return mean;
}

double line_error(const double *visibility, const struct bench *bench, double width, double ground,
                  size_t column, uint32_t window)
{
    const double sine = aspects_sine(&bench->tracer);
    const double d = distance_behind(bench, (double)column, ground);
    double square = 0.0;
    for (size_t row = 0; row < ROWS; row++) {
        const double x = ((double)row - MIDDLE_ROW) * bench->tracer.view.row_spacing_m;
        const double error =
            visibility_at(visibility, row, column) - expected_visibility(x, width, d, sine, window);
        square += error * error;
    }
    return sqrt(square / ROWS);
}
