#include "scene/response_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define BISECTIONS 60

static double square_of(struct complex_number value)
{
    return value.real_part * value.real_part + value.imaginary_part * value.imaginary_part;
}

sonject_status response_table_set(struct response_table *table, struct report *report,
                                  const double *positions, const double *real_part,
                                  const double *imaginary_part, size_t count, bool is_time)
{
    struct response_table taken = {allocate_array(count, sizeof *taken.positions),
                                   allocate_array(count, sizeof *taken.values), count, is_time};
    struct complex_number peak = {0.0, 0.0};
    if (!taken.positions || !taken.values)
        response_table_clear(&taken);
    CHECK_MEMORY(report, taken.positions, "a table of samples");
    for (size_t i = 0; i < count; i++) {
        taken.positions[i] = positions[i];
        taken.values[i].real_part = real_part[i];
        taken.values[i].imaginary_part = imaginary_part ? imaginary_part[i] : 0.0;
        if (square_of(taken.values[i]) > square_of(peak))
            peak = taken.values[i];
    }
    const double energy = square_of(peak);
    for (size_t i = 0; i < count; i++) {
        const struct complex_number v = taken.values[i];
        taken.values[i].real_part =
            (v.real_part * peak.real_part + v.imaginary_part * peak.imaginary_part) / energy;
        taken.values[i].imaginary_part =
            (v.imaginary_part * peak.real_part - v.real_part * peak.imaginary_part) / energy;
    }
    response_table_clear(table);
    *table = taken;
    return SONJECT_OK;
}

void response_table_clear(struct response_table *table)
{
    free(table->positions);
    free(table->values);
    memset(table, 0, sizeof *table);
}

size_t piece_at(const double *positions, size_t count, double x)
{
    size_t low = 0;
    size_t high = count - 1;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (positions[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static struct complex_number secant(const struct response_table *table, size_t i)
{
    const double step = table->positions[i + 1] - table->positions[i];
    return (struct complex_number){
        (table->values[i + 1].real_part - table->values[i].real_part) / step,
        (table->values[i + 1].imaginary_part - table->values[i].imaginary_part) / step};
}

/* Returns the slope of the parabola through a sample and its neighbours, or of the end piece. */
static struct complex_number slope_at(const struct response_table *table, size_t i)
{
    if (i == 0)
        return secant(table, 0);
    if (i + 1 == table->count)
        return secant(table, i - 1);
    const struct complex_number before = secant(table, i - 1);
    const struct complex_number after = secant(table, i);
    const double all = table->positions[i + 1] - table->positions[i - 1];
    const double share = (table->positions[i] - table->positions[i - 1]) / all;
    return (struct complex_number){(1.0 - share) * before.real_part + share * after.real_part,
                                   (1.0 - share) * before.imaginary_part +
                                       share * after.imaginary_part};
}

static double hermite(double t, double step, double a, double slope_a, double b, double slope_b)
{
    const double rest = 1.0 - t;
    return a * (1.0 + 2.0 * t) * rest * rest + b * (3.0 - 2.0 * t) * t * t +
           step * t * rest * (slope_a * rest - slope_b * t);
}

struct complex_number response_table_at(const struct response_table *table, double position)
{
    if (!(position >= table->positions[0] && position <= table->positions[table->count - 1]))
        return (struct complex_number){0.0, 0.0};
    const size_t i = piece_at(table->positions, table->count, position);
    const double step = table->positions[i + 1] - table->positions[i];
    const double t = (position - table->positions[i]) / step;
    const struct complex_number a = table->values[i];
    const struct complex_number b = table->values[i + 1];
    const struct complex_number slope_a = slope_at(table, i);
    const struct complex_number slope_b = slope_at(table, i + 1);
    return (struct complex_number){
        hermite(t, step, a.real_part, slope_a.real_part, b.real_part, slope_b.real_part),
        hermite(t, step, a.imaginary_part, slope_a.imaginary_part, b.imaginary_part,
                slope_b.imaginary_part)};
}

/* Integrates by four points of Gauss and Legendre, exact for the square of a cubic. */
static double energy_of_piece(const struct response_table *table, double low, double high)
{
    static const double points[2] = {0.33998104358485626, 0.86113631159405258};
    static const double weights[2] = {0.65214515486254614, 0.34785484513745386};
    const double middle = 0.5 * (low + high);
    const double half = 0.5 * (high - low);
    double sum = 0.0;
    for (int i = 0; i < 2; i++)
        sum += weights[i] * (square_of(response_table_at(table, middle - points[i] * half)) +
                             square_of(response_table_at(table, middle + points[i] * half)));
    return sum * half;
}

double response_table_energy(const struct response_table *table, double low, double high)
{
    double sum = 0.0;
    for (size_t i = 0; i + 1 < table->count; i++) {
        const double start = fmax(low, table->positions[i]);
        const double end = fmin(high, table->positions[i + 1]);
        if (end > start)
            sum += energy_of_piece(table, start, end);
    }
    return sum;
}

double response_table_reach(const struct response_table *table, double share)
{
    const double total = response_table_energy(table, -HUGE_VAL, HUGE_VAL);
    double inside = 0.0;
    double outside = fmax(-table->positions[0], table->positions[table->count - 1]);
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (inside + outside);
        if (response_table_energy(table, -middle, middle) < (1.0 - share) * total)
            inside = middle;
        else
            outside = middle;
    }
    return outside;
}

/* Returns where the energy has fallen to one half, from the largest sample towards an end. */
static double half_power_point(const struct response_table *table, size_t peak, int direction)
{
    size_t i = peak;
    while (square_of(table->values[i]) > 0.5) {
        if (i == (direction < 0 ? 0 : table->count - 1))
            return table->positions[i];
        i = direction < 0 ? i - 1 : i + 1;
    }
    double low = table->positions[i];
    double high = table->positions[direction < 0 ? i + 1 : i - 1];
    for (int n = 0; n < BISECTIONS; n++) {
        const double middle = 0.5 * (low + high);
        if (square_of(response_table_at(table, middle)) > 0.5)
            high = middle;
        else
            low = middle;
    }
    return low;
}

double response_table_width(const struct response_table *table)
{
    size_t peak = 0;
    for (size_t i = 1; i < table->count; i++)
        if (square_of(table->values[i]) > square_of(table->values[peak]))
            peak = i;
    return half_power_point(table, peak, 1) - half_power_point(table, peak, -1);
}
