#include "layered_sea.h"

#include <math.h>

void layered_sea_open(struct bench *bench, size_t rows, size_t columns, double middle_range_m,
                      const struct water_layer *layers, size_t count)
{
    bench_open(bench, rows, columns, middle_range_m);
    bench->scene.sonar.altitude_m = ALTITUDE;
    bench->scene.medium.reference_sound_speed_mps = REFERENCE;
    bench_set_layers(bench, layers, count);
}

struct reference_way way_through_bench(const struct bench *bench)
{
    const struct reference_way way = {
        bench->water.layers, bench->water.count, bench->scene.sonar.altitude_m, 0.0, 0, false};
    return way;
}

struct reference_sound sound_in_bench(const struct bench *bench, double range, double height)
{
    const struct reference_way way = way_through_bench(bench);
    return reference_sound_at(&way, range, height);
}

struct reference_sound sound_on_seabed(const struct bench *bench, double apparent_range,
                                       double *area)
{
    const struct reference_way way = way_through_bench(bench);
    const long double p = reference_parameter_of_time(&way, apparent_range / REFERENCE);
    const double length =
        sqrt(PI / (4.0 * log(2.0))) * REFERENCE / (2.0 * bench->scene.sonar.bandwidth_hz);
    *area = bench->scene.geometry.row_spacing_m * length / (REFERENCE * (double)p);
    return reference_sound_at(&way, (double)reference_sum(&way, 0.0, p).range, 0.0);
}
