/* What a patch costs by its size and its objects: a composite traced in windows about what objects
 * change, beside all of the patch traced, in one run. Prints a table: seconds of an injection in
 * memory and million rays, of both, and how many windows there are. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/system/process.h"
#include "benchmark_scene.h"
#include "inject/injection.h"

#define FIRST_RANGE_M  60.0
#define REPEATS        5    /* of windows, the fastest counts; all of the patch is traced once */
#define WHOLE_PIXELS   2048 /* the largest patch that all is traced of */
#define OBJECTS_A_SIDE 4

/* Capsules on a lattice in the middle of the patch, where they are in all sizes. */
static void lay(struct benchmark_scene *set, size_t pixels, uint32_t objects)
{
    const size_t spacing = pixels / (OBJECTS_A_SIDE + 1);
    for (uint32_t i = 0; i < objects; i++) {
        sonject_object_params capsule;
        object_init(&capsule);
        capsule.shape = SHAPE_CAPSULE;
        capsule.length_m = 2.3;
        capsule.diameter_m = 0.5;
        capsule.heading_rad = 0.6 + i;
        capsule.burial_m = 0.1;
        capsule.position_kind = SONJECT_POSITION_PIXELS;
        capsule.position_along =
            (double)(objects == 1 ? pixels / 2 : spacing * (1 + i % OBJECTS_A_SIDE));
        capsule.position_range =
            (double)(objects == 1 ? pixels / 2 : spacing * (1 + i / OBJECTS_A_SIDE));
        benchmark_expect(&set->report, scene_append_object(&set->scene, &set->report, &capsule));
    }
}

static double seconds(struct benchmark_scene *set, const struct injection_input *input, int repeats,
                      struct injection_result *result)
{
    double fastest = INFINITY;
    for (int i = 0; i < repeats; i++) {
        const double start = clock_seconds();
        benchmark_expect(&set->report, injection_run(&set->report, set->tracer.device, &set->scene,
                                                     input, NULL, NULL, result));
        fastest = fmin(fastest, clock_seconds() - start);
        if (i + 1 < repeats)
            injection_result_clear(result);
    }
    return fastest;
}

static void print_row(size_t pixels, uint32_t objects, uint32_t interactions)
{
    static struct benchmark_scene set;
    struct injection_result result;
    benchmark_begin(&set, NULL, pixels);
    set.scene.sonar.response_window = SONJECT_WINDOW_TAYLOR;
    set.scene.geometry.first_slant_range_m = FIRST_RANGE_M;
    set.scene.injection.interactions = interactions;
    set.scene.injection.estimate_noise = 0;
    lay(&set, pixels, objects);
    float *amplitudes = benchmark_array(pixels * pixels, sizeof *amplitudes);
    for (size_t i = 0; i < pixels * pixels; i++)
        amplitudes[i] = 1.0f;
    struct injection_input input = {.rows = pixels, .columns = pixels, .pixels = amplitudes};
    const double in_windows = seconds(&set, &input, REPEATS, &result);
    printf("%5zu %7u %12u | %7zu %8.3f %8.1f", pixels, (unsigned)objects, (unsigned)interactions,
           result.window_count, in_windows, 1e-6 * (double)result.statistics.rays);
    injection_result_clear(&result);
    if (pixels <= WHOLE_PIXELS) {
        input.is_whole = true;
        const double whole = seconds(&set, &input, 1, &result);
        printf(" | %8.3f %8.1f | %6.1f", whole, 1e-6 * (double)result.statistics.rays,
               whole / in_windows);
        injection_result_clear(&result);
    }
    printf("\n");
    fflush(stdout);
    free(amplitudes);
    benchmark_clear(&set);
}

int main(void)
{
    printf("pixels objects interactions | windows   s      Mrays | whole: s    Mrays | times\n");
    for (uint32_t interactions = 1; interactions <= 2; interactions++)
        for (size_t pixels = 256; pixels <= 4096; pixels *= 2)
            print_row(pixels, 1, interactions);
    for (uint32_t objects = 4; objects <= 16; objects *= 2)
        print_row(2048, objects, 1);
    return 0;
}
