#include "scene/relief_bumps.h"

#include <math.h>

#define PI 3.14159265358979323846

double relief_raised_cosine(double share)
{
    return share < 1.0 ? 0.5 + 0.5 * cos(PI * share) : 0.0;
}

/* Grid points that a square about a point holds. */
struct grid_window {
    uint32_t first_row, end_row, first_column, end_column;
};

static uint32_t limited_index(double index, uint32_t count)
{
    return (uint32_t)fmin(fmax(index, 0.0), count);
}

static struct grid_window window_about(const struct relief *relief, double x, double y,
                                       double reach)
{
    const double row = (x - relief->first_x_m) / relief->row_step_m;
    const double column = (y - relief->first_y_m) / relief->column_step_m;
    const double rows = reach / relief->row_step_m;
    const double columns = reach / relief->column_step_m;
    const struct grid_window window = {
        limited_index(floor(row - rows), relief->rows),
        limited_index(ceil(row + rows) + 1.0, relief->rows),
        limited_index(floor(column - columns), relief->columns),
        limited_index(ceil(column + columns) + 1.0, relief->columns)};
    return window;
}

void relief_add_bump(const struct relief *relief, double *heights, double x, double y,
                     double radius, double height)
{
    const struct grid_window window = window_about(relief, x, y, radius);
    for (uint32_t row = window.first_row; row < window.end_row; row++)
        for (uint32_t column = window.first_column; column < window.end_column; column++) {
            const double distance =
                hypot(relief_x(relief, row) - x, relief_y(relief, column) - y) / radius;
            if (distance < 1.0)
                heights[(size_t)row * relief->columns + column] +=
                    height * relief_raised_cosine(distance);
        }
}

/* Distance from what an object covers of the ground, 0 within it. */
static double outside_of(const struct footprint *footprint, double x, double y)
{
    const double dx = x - footprint->x_m;
    const double dy = y - footprint->y_m;
    const double along = fabs(dx * footprint->along_x + dy * footprint->along_y);
    const double across = fabs(dx * footprint->along_y - dy * footprint->along_x);
    return fmax(0.0, hypot(fmax(0.0, along - footprint->half_length_m), across) -
                         footprint->half_width_m);
}

void relief_add_scour(const struct relief *relief, double *heights,
                      const struct footprint *footprint, double width, double depth)
{
    const struct grid_window window =
        window_about(relief, footprint->x_m, footprint->y_m,
                     footprint->half_length_m + footprint->half_width_m + width);
    for (uint32_t row = window.first_row; row < window.end_row; row++)
        for (uint32_t column = window.first_column; column < window.end_column; column++) {
            const double distance =
                outside_of(footprint, relief_x(relief, row), relief_y(relief, column)) / width;
            if (distance < 1.0)
                heights[(size_t)row * relief->columns + column] -=
                    depth * relief_raised_cosine(distance);
        }
}
