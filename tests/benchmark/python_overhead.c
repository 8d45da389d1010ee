/* One injection in C for each line of standard input, as python_overhead.py does it in Python: a
 * scene made, a capsule put into SIDE x SIDE pixels of the file that is named, the image copied
 * out. Prints the seconds that it took, those of processors, and a digest of the image. */
#define _POSIX_C_SOURCE 200809L
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <sonject/sonject.h>

#define SIDE 512

static float pixels[SIDE * SIDE], image[SIDE * SIDE];

struct times {
    double wall_s, processor_s;
};

static double read_clock(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void expect(sonject_status status, const sonject_context *context)
{
    if (status == SONJECT_OK)
        return;
    fprintf(stderr, "%s: %s\n", sonject_status_name(status),
            context ? sonject_context_message(context) : "");
    exit(EXIT_FAILURE);
}

static sonject_scene *make_scene(sonject_context *context)
{
    const sonject_scene_read_params params = {
        .struct_size = sizeof params,
        .text = "sonject: 1\n"
                "input: {geometry: {row_spacing: 0.025, column_spacing: 0.025, first_slant_range: "
                "43.6}}\n"
                "sonar: {frequency: 100e3, bandwidth: 30e3, altitude: 10}\n"
                "objects: [{shape: capsule, length: 2.3, diameter: 0.3, heading: 0.6 rad, burial: "
                "0.1}]\n"};
    sonject_scene *scene;
    expect(sonject_scene_read(context, NULL, &params, &scene), context);
    return scene;
}

static struct times inject(sonject_context *context)
{
    const sonject_pixels patch = {sizeof patch, SONJECT_PIXELS_AMPLITUDE, SIDE, SIDE, 0, pixels};
    const double wall = read_clock(CLOCK_MONOTONIC);
    const double processor = read_clock(CLOCK_PROCESS_CPUTIME_ID);
    sonject_result *result;
    sonject_scene *scene = make_scene(context);
    expect(sonject_inject(context, scene, &patch, NULL, NULL, &result), context);
    expect(sonject_result_layer(result, SONJECT_LAYER_IMAGE, image, sizeof image), context);
    sonject_result_release(&result);
    sonject_scene_release(&scene);
    const struct times taken = {read_clock(CLOCK_MONOTONIC) - wall,
                                read_clock(CLOCK_PROCESS_CPUTIME_ID) - processor};
    return taken;
}

static uint64_t digest(void)
{
    uint64_t sum = UINT64_C(0xCBF29CE484222325);
    const unsigned char *bytes = (const unsigned char *)image;
    for (size_t i = 0; i < sizeof image; i++)
        sum = (sum ^ bytes[i]) * UINT64_C(0x100000001B3);
    return sum;
}

int main(int argc, char **argv)
{
    sonject_context *context;
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (!file || fread(pixels, sizeof *pixels, SIDE * SIDE, file) != SIDE * SIDE) {
        fprintf(stderr, "usage: python_overhead PIXELS\n");
        return EXIT_FAILURE;
    }
    fclose(file);
    expect(sonject_context_create(NULL, &context), NULL);
    while (getchar() != EOF) {
        const struct times taken = inject(context);
        printf("%.9f %.9f %016llx\n", taken.wall_s, taken.processor_s,
               (unsigned long long)digest());
        fflush(stdout);
    }
    sonject_context_release(&context);
    return EXIT_SUCCESS;
}
