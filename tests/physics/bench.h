/* A small sea for tests: one patch, some objects, one device, driven below the public interface. */
#ifndef SONJECT_TESTS_BENCH_H
#define SONJECT_TESTS_BENCH_H

#include <stdint.h>

#include "estimate.h"
#include "form/form.h"
#include "inject/compose.h"
#include "trace/chains.h"
#include "trace/glints.h"
#include "trace/multibounce.h"
#include "trace/rough.h"
#include "trace/tracer.h"

struct bench {
    struct report report;
    struct scene scene;
    struct placements placed;
    struct placement *placements; /* of placed */
    struct water water;
    struct tracer tracer;
    size_t rows, columns;
    struct device *device; /* the tracer's when it was opened, and its lanes */
    uint32_t device_width;
};

/* Opens bench_device, and lays a patch of pixels with default parameters: 100 kHz, 30 kHz, 10 m
 * altitude, 2.5 cm, but with broadside rays alone. Its middle column is at middle_range_m. Fails
 * the test where a call fails. */
void bench_open(struct bench *bench, size_t rows, size_t columns, double middle_range_m);
void bench_close(struct bench *bench);

/* The bench's device once more, without programs, to be closed by device_close. */
struct device *bench_open_device(struct bench *bench);

/* The same with kernels of a number of lanes. With one lane PoCL works as a GPU does, in groups of
 * work-items that share what they count. */
struct device *bench_open_width(struct bench *bench, uint32_t width);

/* The device native with the fewest lanes that it has, for device_close: kernels as the C compiler
 * takes them, which all others are to give the bits of. */
struct device *bench_open_reference(struct bench *bench);

/* Gives the bench's device another number of lanes, and none of the programs of before. */
void bench_set_width(struct bench *bench, uint32_t width);

/* Puts the middle column somewhere else (processor range), after spacing or size changed. */
void bench_move(struct bench *bench, double middle_range_m);

/* Layers of water, copied; before bench_ready. */
void bench_set_layers(struct bench *bench, const struct water_layer *layers, size_t count);

/* An object in the middle of the patch, rigid and without a rough part, to be changed at will.
 * All lengths are those of the shape's own words. */
sonject_object_params *bench_add(struct bench *bench, enum shape_kind shape, double length_m,
                                 double width_m, double diameter_m);

/* Puts an object somewhere, in pixels, and makes it scatter, too; returns it. */
sonject_object_params *bench_place(sonject_object_params *object, double row, double column,
                                   double heading, double pitch, double roll);

/* A feature of the seabed's relief, in the middle of the patch, to be changed at will. */
struct relief_feature *bench_add_relief(struct bench *bench, enum relief_kind kind);

/* A mesh, the scene's only one: a tetrahedron within 0.5 m of its middle. */
void bench_add_tetrahedron(struct bench *bench);

/* Bytes of a buffer of the device; native's may be rounded up. */
size_t bench_buffer_bytes(struct bench *bench, device_buffer buffer);

/* A copy of a whole buffer of the device, for free(). */
void *bench_copy_buffer(struct bench *bench, device_buffer buffer);

/* Fails where two lists of sums differ; how many of them are not 0. */
size_t bench_expect_sums(const char *what, const int64_t *measured, const int64_t *expected,
                         size_t count);

/* Works out view, response and placements from the scene as it now is; before any trace. */
void bench_ready(struct bench *bench);

/* The device that bench_open opens: one whose name contains this; NULL: the default one. */
extern const char *bench_device;

/* The numbers of lanes to try on bench_device: on native those that were built and that the
 * processor has, else 1 and the device's own. Returns how many there are. */
#define BENCH_WIDTHS 3
size_t bench_widths(uint32_t widths[BENCH_WIDTHS]);

/* Runs the tests on every device; the number of those that failed, which a program returns. */
struct CMUnitTest;
int bench_run_on_devices(const struct CMUnitTest *tests, size_t count);

/* The same on the default device alone. */
int bench_run_on_default(const struct CMUnitTest *tests, size_t count);

/* The names of all devices; the number of them. */
#define BENCH_DEVICES 16
size_t bench_devices(char names[BENCH_DEVICES][128]);

#endif
