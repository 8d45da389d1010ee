/* A small sea for tests below the public interface: one patch, some objects, one device. */
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
    struct placement *placements; /* borrowed from `placed` */
    struct water water;
    struct tracer tracer;
    size_t rows, columns;
    struct device *device; /* the device that was opened first, and its lanes */
    uint32_t device_width;
};

/* Opens bench_device and lays a patch of pixels. Parameters are the default ones (100 kHz, 30 kHz,
 * 10 m altitude, 2.5 cm), but all rays are broadside. The middle column is at middle_range_m. The
 * test fails if a call fails. */
void bench_open(struct bench *bench, size_t rows, size_t columns, double middle_range_m);
void bench_close(struct bench *bench);

/* Opens the bench's device once more, without programs. The caller closes it by device_close. */
struct device *bench_open_device(struct bench *bench);

/* Opens the bench's device once more, for kernels of `width` lanes. With one lane PoCL works as a
 * GPU does, in groups of work-items that share their tallies. */
struct device *bench_open_width(struct bench *bench, uint32_t width);

/* Opens the device native with the fewest lanes that it has: kernels as plain C. All other devices
 * must give the same bits. The caller closes it by device_close. */
struct device *bench_open_reference(struct bench *bench);

/* Gives the bench a device of another number of lanes, without the programs of the one before. */
void bench_set_width(struct bench *bench, uint32_t width);

/* Moves the middle column to a processor range, also after spacing or size changed. */
void bench_move(struct bench *bench, double middle_range_m);

/* Copies layers of water into the scene. To be called before bench_ready. */
void bench_set_layers(struct bench *bench, const struct water_layer *layers, size_t count);

/* Adds an object in the middle of the patch, rigid and without a rough part, to be changed at will.
 * Each length is the shape's own dimension of that name. */
sonject_object_params *bench_add(struct bench *bench, enum shape_kind shape, double length_m,
                                 double width_m, double diameter_m);

/* Puts an object at a place in pixels and makes it scatter, too. Returns the object. */
sonject_object_params *bench_place(sonject_object_params *object, double row, double column,
                                   double heading, double pitch, double roll);

/* Adds a feature of the seabed's relief in the middle of the patch, to be changed at will. */
struct relief_feature *bench_add_relief(struct bench *bench, enum relief_kind kind);

/* Adds the scene's only mesh: a tetrahedron within 0.5 m of its middle. */
void bench_add_tetrahedron(struct bench *bench);

/* Returns the bytes of a buffer of the device. Native's may be rounded up. */
size_t bench_buffer_bytes(struct bench *bench, device_buffer buffer);

/* Returns a copy of a whole buffer of the device, to be given to free(). */
void *bench_copy_buffer(struct bench *bench, device_buffer buffer);

/* Fails the test where two lists of sums differ. Returns how many expected sums are not 0. */
size_t bench_expect_sums(const char *what, const int64_t *measured, const int64_t *expected,
                         size_t count);

/* Works out view, response and placements from the scene as it now is. Every trace needs them. */
void bench_ready(struct bench *bench);

/* A part of the name of the device that bench_open opens. NULL: the default device. */
extern const char *bench_device;

/* Gives the numbers of lanes to try on bench_device and returns their count. On native they are
 * those that were built and that the processor has, else 1 and the device's own number. */
#define BENCH_WIDTHS 3
size_t bench_widths(uint32_t widths[BENCH_WIDTHS]);

/* Runs the tests on every device. Returns the number of failed tests, for main to return. */
struct CMUnitTest;
int bench_run_on_devices(const struct CMUnitTest *tests, size_t count);

/* Runs the tests on the default device alone. Returns the number of failed tests. */
int bench_run_on_default(const struct CMUnitTest *tests, size_t count);

/* Gives the names of all devices and returns their number, BENCH_DEVICES at most. */
#define BENCH_DEVICES 16
size_t bench_devices(char names[BENCH_DEVICES][128]);

#endif
