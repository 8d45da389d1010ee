#include "inject/swath.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "image/raster.h"
#include "swath/geometry_notes.h"
#include "swath/raster_file.h"
#include "swath/swath_file.h"

/* Chooses the scene's patch. All zeros mean the whole swath, or the scene's side of two. */
static sonject_status choose_patch(struct report *report, const struct scene *scene,
                                   struct swath *swath)
{
    if (scene->calibrates_itself)
        return scene_locate(scene, report,
                            report_failure(report, SONJECT_ERROR_INPUT,
                                           "auto is for run and campaign: make a file with sonject "
                                           "calibrate and name it"),
                            "input.calibration");
    const sonject_patch_params *asked = &scene->patch;
    const struct raster_layout *layout = &swath->layout;
    struct region *patch = &swath->patch;
    uint64_t first, columns;
    if (!geometry_side(&scene->geometry, layout->columns, &first, &columns))
        return scene_locate(
            scene, report,
            report_failure(report, SONJECT_ERROR_INPUT,
                           "nadir_column %g does not lie among the image's %llu columns with some "
                           "to %s: if all of them lie to one side, name the column nearest to "
                           "nadir and, as first_slant_range, its range",
                           scene->geometry.nadir_column, (unsigned long long)layout->columns,
                           scene->geometry.side == SONJECT_SIDE_PORT ? "port" : "starboard"),
            "input.geometry.nadir_column");
    patch->first_row = asked->first_row;
    patch->first_column = asked->columns ? asked->first_column : first;
    patch->rows = asked->rows ? asked->rows : layout->rows;
    patch->columns = asked->columns ? asked->columns : columns;
    if (asked->first_row >= layout->rows || asked->first_column >= layout->columns ||
        !region_is_inside(layout, patch))
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "the patch (row %llu, column %llu, %llu x %llu) is not inside the image of %llu x %llu "
            "pixels: correct patch",
            (unsigned long long)asked->first_row, (unsigned long long)asked->first_column,
            (unsigned long long)asked->rows, (unsigned long long)asked->columns,
            (unsigned long long)layout->rows, (unsigned long long)layout->columns);
    if (patch->rows * patch->columns > (uint64_t)1 << 31 || patch->rows > (uint64_t)1 << 24 ||
        patch->columns > (uint64_t)1 << 24)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the patch of %llu x %llu pixels is too large: choose one of at most "
                              "2^31 pixels with patch",
                              (unsigned long long)patch->rows, (unsigned long long)patch->columns);
    return SONJECT_OK;
}

static sonject_status ping_list_copy(struct ping_list *list, struct report *report,
                                     const struct ping_list *from)
{
    if (from->count == 0)
        return SONJECT_OK;
    list->numbers = allocate_array((size_t)from->count, sizeof *list->numbers);
    CHECK_MEMORY(report, list->numbers, "the empty pings");
    memcpy(list->numbers, from->numbers, (size_t)from->count * sizeof *list->numbers);
    list->count = from->count;
    return SONJECT_OK;
}

static sonject_status describe_file(struct report *report, const struct scene *scene,
                                    const struct swath_file *file, struct swath *swath)
{
    const struct recording *recording = swath_file_recording(file);
    swath_file_layout(file, &swath->layout);
    swath->new_extension = swath_file_new_extension(file);
    swath->is_complex = swath->layout.channels == 2;
    swath->transfer = scene->transfer;
    swath->is_whole = swath_file_largest(file) > 0;
    swath->full_scale = swath_file_full_scale(file);
    swath_file_limit(file, &swath->transfer);
    struct noted_geometry noted;
    geometry_notes_read(file, &noted);
    memcpy(swath->grey_db, noted.grey_db, sizeof swath->grey_db);
    swath->files_geometry = scene->geometry;
    swath->tells_geometry = geometry_notes_to_params(&noted, &swath->files_geometry);
    if (swath_file_range_axis(file) == RANGE_GROUND)
        return report_failure(
            report, SONJECT_ERROR_INPUT,
            "%s is in ground range, and runs work in slant range: convert it first "
            "with sonject convert --range-axis slant",
            scene->input_path);
    if (swath->is_complex && !scene->input_is_complex)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s has 2 channels: say complex: true under input if they are real "
                              "and imaginary part",
                              scene->input_path);
    if (!swath->is_complex && scene->input_is_complex)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s has 1 channel, but input says complex: true, which needs 2 (real "
                              "and imaginary part)",
                              scene->input_path);
    if (swath->is_complex && swath->layout.type != PIXEL_FLOAT32)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "%s has integer pixels; complex images must be 32-bit float",
                              scene->input_path);
    if (swath->is_complex && scene->transfer.kind != SONJECT_TRANSFER_AMPLITUDE)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "a complex image cannot have a transfer function: take transfer out");
    if (!recording)
        return SONJECT_OK;
    CHECK(ping_list_copy(&swath->skipped, report, &recording->empty));
    return track_of_recording(&swath->track, report, recording);
}

static sonject_status open_input(struct report *report, const struct scene *scene,
                                 struct swath_file **file)
{
    file_protect(report, scene->input_path);
    return swath_file_open_array(report, scene->input_path, scene->channel, scene->array, file);
}

static sonject_status open_and_describe(struct report *report, const struct scene *scene,
                                        struct swath *swath, struct swath_file **file)
{
    memset(swath, 0, sizeof *swath);
    *file = NULL;
    sonject_status status = SONJECT_OK;
    if (scene->input_kind == SONJECT_INPUT_MEMORY)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the scene has no input image: give input.path");
    if (scene->input_kind == SONJECT_INPUT_FILE) {
        status = open_input(report, scene, file);
        THEN(status, describe_file(report, scene, *file, swath));
        status = scene_locate(scene, report, status, "input.path");
    } else {
        swath->layout = made_layout(scene);
        swath->is_complex = swath->layout.channels == 2;
        swath->is_made = true;
        swath->full_scale = pixel_full_scale(swath->layout.type);
        swath->new_extension = ".tif";
    }
    THEN(status, scene_locate(scene, report, choose_patch(report, scene, swath), "patch"));
    if (status != SONJECT_OK) {
        swath_file_close(file);
        swath_close(swath);
    }
    return status;
}

sonject_status swath_describe(struct report *report, const struct scene *scene, struct swath *swath)
{
    struct swath_file *file;
    const sonject_status status = open_and_describe(report, scene, swath, &file);
    swath_file_close(&file);
    return status;
}

static sonject_status identify(struct report *report, struct swath *swath, const void *pixels,
                               size_t bytes)
{
    struct hash *hash = hash_begin();
    CHECK_MEMORY(report, hash, "a hash");
    hash_add(hash, &swath->layout.rows, sizeof swath->layout.rows);
    hash_add(hash, &swath->layout.columns, sizeof swath->layout.columns);
    hash_add(hash, pixels, bytes);
    hash_end(hash, swath->identity);
    return SONJECT_OK;
}

/* path: NULL if there is no file. */
static sonject_status bad_pixel(struct report *report, const char *path, const struct swath *swath,
                                size_t index)
{
    const size_t pixel = swath->is_complex ? index / 2 : index;
    const size_t columns = (size_t)swath->patch.columns;
    const double value = pixel_number(swath->layout.type, swath->stored, index);
    const char *what = !isfinite(value) ? "not a finite number"
                       : value < 0.0    ? "a negative amplitude"
                                        : "outside the range of its transfer function";
    char text[160];
    snprintf(text, sizeof text,
             "the pixel at row %llu, column %llu is %s: mend the image or choose another patch",
             (unsigned long long)(swath->patch.first_row + pixel / columns),
             (unsigned long long)(swath->patch.first_column + pixel % columns), what);
    return path ? input_failure(report, path, "%s", text)
                : report_failure(report, SONJECT_ERROR_INPUT, "%s", text);
}

/* Returns the bytes of a pixel as it is stored. */
static size_t stored_bytes(const struct swath *swath)
{
    return swath->layout.channels * pixel_bytes(swath->layout.type);
}

/* Returns a row of the patch among the stored pixels of a whole swath. */
static unsigned char *row_in_swath(const struct swath *swath, const void *whole, size_t row)
{
    return (unsigned char *)whole +
           (((size_t)swath->patch.first_row + row) * (size_t)swath->layout.columns +
            (size_t)swath->patch.first_column) *
               stored_bytes(swath);
}

/* Copies the patch out of a whole swath. */
static void cut_patch(const struct swath *swath, const void *whole, void *patch)
{
    const size_t bytes = (size_t)swath->patch.columns * stored_bytes(swath);
    for (size_t row = 0; row < swath->patch.rows; row++)
        memcpy((unsigned char *)patch + row * bytes, row_in_swath(swath, whole, row), bytes);
}

static bool is_zero(const unsigned char *bytes, size_t count)
{
    size_t i = 0;
    while (i < count && bytes[i] == 0)
        i++;
    return i == count;
}

/* Finds rows that are empty all across the swath: a row that is dark in the patch alone is a ping.
 * whole: as in read_patch. */
static sonject_status find_empty_rows(struct report *report, struct swath_file *file,
                                      const void *whole, struct swath *swath)
{
    const size_t patch_bytes = (size_t)swath->patch.columns * stored_bytes(swath);
    const void *patch = swath->stored ? swath->stored : swath->pixels;
    const size_t row_bytes = (size_t)swath->layout.columns * stored_bytes(swath);
    unsigned char *line = allocate_array(row_bytes, 1);
    sonject_status status = SONJECT_OK;
    swath->empty.numbers = allocate_array((size_t)swath->patch.rows, sizeof(uint64_t));
    if (!line || !swath->empty.numbers)
        status = report_out_of_memory(report, "the patch");
    for (size_t i = 0; status == SONJECT_OK && i < swath->patch.rows; i++) {
        const struct region row = {swath->patch.first_row + i, 0, 1, swath->layout.columns};
        const unsigned char *bytes = line;
        if (!is_zero((const unsigned char *)patch + i * patch_bytes, patch_bytes))
            continue;
        if (whole)
            bytes = (const unsigned char *)whole + (size_t)row.first_row * row_bytes;
        else
            status = swath_file_read(report, file, &row, line);
        if (status == SONJECT_OK && is_zero(bytes, row_bytes))
            swath->empty.numbers[swath->empty.count++] = row.first_row;
    }
    free(line);
    return status;
}

/* Fills the empty rows, so that neither levels nor floors are measured where nothing was heard. */
static sonject_status fill_empty_rows(struct report *report, const struct scene *scene,
                                      const struct swath *swath)
{
    const size_t rows = (size_t)swath->patch.rows;
    const size_t line = (size_t)swath->patch.columns * (swath->is_complex ? 2 : 1);
    const struct ping_list *empty = &swath->empty;
    if (empty->count == rows)
        return scene_locate(scene, report,
                            report_failure(report, SONJECT_ERROR_INPUT,
                                           "all rows of the patch are empty (0): choose another"),
                            "patch");
    size_t from = 0; /* first row that is not empty */
    while (from < empty->count && empty->numbers[from] == swath->patch.first_row + from)
        from++;
    for (size_t i = 0; i < empty->count; i++) {
        const size_t row = (size_t)(empty->numbers[i] - swath->patch.first_row);
        memcpy(swath->pixels + row * line, swath->pixels + (row > from ? row - 1 : from) * line,
               line * sizeof(float));
    }
    return SONJECT_OK;
}

void swath_leave_empty(const struct swath *swath, struct injection_result *result)
{
    const size_t line = result->columns * (result->is_complex ? 2 : 1);
    for (uint64_t i = 0; i < swath->empty.count; i++) {
        const size_t row = (size_t)(swath->empty.numbers[i] - swath->patch.first_row);
        const size_t first = row * result->columns;
        for (size_t k = 0; k < result->columns; k++)
            result->statistics.changed_pixels -= result->influence[first + k] != 0;
        memset(swath->pixels + row * line, 0, line * sizeof(float));
        memset(result->image + row * line, 0, line * sizeof(float));
        memset(result->influence + first, 0, result->columns);
    }
}

const char *ping_list_text(const struct ping_list *list, char text[PING_LIST_CAPACITY])
{
    size_t length = 0;
    uint64_t i = 0;
    for (*text = '\0'; i < list->count && length < PING_LIST_CAPACITY - 60; i++)
        length += (size_t)snprintf(text + length, PING_LIST_CAPACITY - length, "%s%llu",
                                   i > 0 ? ", " : "", (unsigned long long)list->numbers[i]);
    if (i < list->count)
        snprintf(text + length, PING_LIST_CAPACITY - length, " and %llu more",
                 (unsigned long long)(list->count - i));
    return text;
}

sonject_status swath_linearise(struct report *report, const char *path, struct swath *swath)
{
    size_t bad = 0;
    const size_t count =
        (size_t)swath->patch.rows * (size_t)swath->patch.columns * (swath->is_complex ? 2 : 1);
    swath->pixels = allocate_array(count, sizeof(float));
    CHECK_MEMORY(report, swath->pixels, "the patch");
    if (transfer_to_amplitude(&swath->transfer, swath->layout.type, swath->stored, count,
                              swath->pixels, &bad, &swath->clipped) != SONJECT_OK)
        return bad_pixel(report, path, swath, bad);
    for (size_t i = 0; !swath->is_complex && i < count; i++)
        if (swath->pixels[i] < 0.0f)
            return bad_pixel(report, path, swath, i);
    return SONJECT_OK;
}

/* Copies the pixels that the caller lent. */
static sonject_status own_pixels(struct report *report, struct swath *swath)
{
    const size_t count =
        (size_t)swath->patch.rows * (size_t)swath->patch.columns * (swath->is_complex ? 2 : 1);
    float *pixels = allocate_array(count, sizeof *pixels);
    CHECK_MEMORY(report, pixels, "the patch");
    memcpy(pixels, swath->pixels, count * sizeof *pixels);
    swath->pixels = pixels;
    swath->borrows_pixels = false;
    return SONJECT_OK;
}

sonject_status swath_find_empty(struct report *report, const struct scene *scene,
                                struct swath *swath)
{
    CHECK(find_empty_rows(report, NULL, swath->stored ? swath->stored : swath->pixels, swath));
    if (swath->empty.count > 0 && swath->borrows_pixels)
        CHECK(own_pixels(report, swath));
    return fill_empty_rows(report, scene, swath);
}

/* whole: the file's pixels if they are in memory, else NULL. */
static sonject_status read_patch(struct report *report, const struct scene *scene,
                                 struct swath_file *file, const void *whole, struct swath *swath)
{
    size_t bytes;
    if (!region_bytes(&swath->layout, &swath->patch, &bytes))
        return report_out_of_memory(report, "the patch");
    swath->stored = allocate_array(bytes, 1);
    CHECK_MEMORY(report, swath->stored, "the patch");
    if (whole)
        cut_patch(swath, whole, swath->stored);
    else
        CHECK(swath_file_read(report, file, &swath->patch, swath->stored));
    CHECK(swath_linearise(report, scene->input_path, swath));
    CHECK(identify(report, swath, swath->stored, bytes));
    CHECK(find_empty_rows(report, file, whole, swath));
    return fill_empty_rows(report, scene, swath);
}

/* Makes the whole swath, which is kept for writing, and cuts the patch out of it. */
static sonject_status make_patch(struct report *report, const struct scene *scene,
                                 struct swath *swath)
{
    struct injection_input whole;
    CHECK(make_input(report, scene, &whole));
    swath->stored = (void *)whole.pixels;
    swath->pixels = allocate_array((size_t)swath->patch.rows * (size_t)swath->patch.columns,
                                   stored_bytes(swath));
    CHECK_MEMORY(report, swath->pixels, "the patch");
    cut_patch(swath, whole.pixels, swath->pixels);
    return identify(report, swath, whole.pixels, whole.rows * whole.columns * stored_bytes(swath));
}

sonject_status swath_open(struct report *report, const struct scene *scene, struct swath *swath)
{
    struct swath_file *file;
    sonject_status status = open_and_describe(report, scene, swath, &file);
    THEN(status,
         file ? read_patch(report, scene, file, NULL, swath) : make_patch(report, scene, swath));
    swath_file_close(&file);
    if (status != SONJECT_OK)
        swath_close(swath);
    return status;
}

/* The largest swath that is kept in memory, bytes. */
#define STORE_BYTES_MAX ((size_t)256 << 20)

void swath_store_close(struct swath_store *store)
{
    swath_file_close(&store->file);
    free(store->path);
    free(store->array);
    free(store->pixels);
    memset(store, 0, sizeof *store);
}

/* Returns whether the store holds the scene's input. */
static bool store_holds(const struct swath_store *store, const struct scene *scene)
{
    const bool is_same_array = store->array && scene->array
                                   ? strcmp(store->array, scene->array) == 0
                                   : !store->array && !scene->array;
    return store->path && strcmp(store->path, scene->input_path) == 0 &&
           store->channel == scene->channel && is_same_array;
}

static sonject_status store_take(struct report *report, const struct scene *scene,
                                 struct swath_store *store)
{
    struct raster_layout layout;
    size_t bytes;
    if (store_holds(store, scene))
        return SONJECT_OK;
    swath_store_close(store);
    sonject_status status = open_input(report, scene, &store->file);
    if (status != SONJECT_OK)
        return status;
    store->channel = scene->channel;
    store->path = copy_text(scene->input_path);
    store->array = scene->array ? copy_text(scene->array) : NULL;
    swath_file_layout(store->file, &layout);
    const struct region all = {0, 0, layout.rows, layout.columns};
    if (region_bytes(&layout, &all, &bytes) && bytes <= STORE_BYTES_MAX) {
        store->pixels = allocate_array(bytes, 1);
        if (store->pixels)
            status = swath_file_read(report, store->file, &all, store->pixels);
    }
    if (status == SONJECT_OK && (!store->path || (scene->array && !store->array)))
        status = report_out_of_memory(report, "a path");
    if (status != SONJECT_OK)
        swath_store_close(store);
    return status;
}

sonject_status swath_open_stored(struct report *report, const struct scene *scene,
                                 struct swath_store *store, struct swath *swath)
{
    memset(swath, 0, sizeof *swath);
    sonject_status status = store_take(report, scene, store);
    THEN(status, describe_file(report, scene, store->file, swath));
    THEN(status, choose_patch(report, scene, swath));
    THEN(status, read_patch(report, scene, store->file, store->pixels, swath));
    if (status != SONJECT_OK)
        swath_close(swath);
    return status;
}

struct injection_input swath_input(const struct swath *swath)
{
    struct injection_input input;
    memset(&input, 0, sizeof input);
    input.rows = (size_t)swath->patch.rows;
    input.columns = (size_t)swath->patch.columns;
    input.first_row = (double)swath->patch.first_row;
    input.first_column = (double)swath->patch.first_column;
    input.is_complex = swath->is_complex;
    input.is_made = swath->is_made;
    input.pixels = swath->pixels;
    input.empty = &swath->empty;
    if (!swath->is_made && !swath->is_complex)
        input.ceiling = transfer_ceiling(&swath->transfer, swath->layout.type, swath->is_whole);
    return input;
}

void swath_close(struct swath *swath)
{
    free(swath->stored);
    if (!swath->borrows_pixels)
        free(swath->pixels);
    free(swath->skipped.numbers);
    free(swath->empty.numbers);
    track_clear(&swath->track);
    memset(swath, 0, sizeof *swath);
}

char *swath_image_name(const struct scene *scene, const struct swath *swath)
{
    const char *extension = swath->new_extension;
    if (!extension) {
        const char *dot = strrchr(path_name(scene->input_path), '.');
        extension = dot ? dot : ".tif";
    }
    char *name = allocate_array(strlen("image") + strlen(extension) + 1, 1);
    if (name)
        strcat(strcpy(name, "image"), extension);
    return name;
}

void *swath_stored_result(const struct swath *swath, const struct injection_result *result,
                          uint64_t *clipped)
{
    const size_t pixels = result->rows * result->columns;
    const size_t bytes = stored_bytes(swath);
    unsigned char *stored = allocate_array(pixels, bytes);
    uint32_t step =
        quantisation_step(swath->layout.type, swath->stored, pixels * swath->layout.channels);
    if (step == 0 && swath->is_whole)
        step = 1;
    if (stored)
        memcpy(stored, swath->stored, pixels * bytes);
    for (size_t i = 0; stored && i < pixels; i++)
        if (result->influence[i] && swath->is_complex)
            memcpy(stored + i * bytes, result->image + 2 * i, bytes);
        else if (result->influence[i])
            transfer_to_stored(&swath->transfer, swath->layout.type, step, result->image + i, 1,
                               stored + i * bytes, clipped);
    return stored;
}

static sonject_status write_made(struct report *report, const struct scene *scene,
                                 const struct swath *swath, const struct injection_result *result,
                                 const char *path)
{
    const size_t bytes = (size_t)swath->patch.columns * stored_bytes(swath);
    float *whole = swath->stored;
    for (size_t row = 0; row < result->rows; row++)
        memcpy(row_in_swath(swath, whole, row), (const char *)result->image + row * bytes, bytes);
    static const char *const complex_names[] = {"real", "imag"};
    struct geometry_notes notes;
    geometry_notes_init(&notes, &scene->sonar, &scene->geometry);
    return raster_file_write(report, path, &swath->layout, swath->is_complex ? complex_names : NULL,
                             notes.attributes, notes.count, whole);
}

sonject_status swath_write(struct report *report, const struct scene *scene,
                           const struct swath *swath, const struct injection_result *result,
                           const char *path, sonject_progress_function progress, void *user,
                           uint64_t *clipped)
{
    *clipped = 0;
    if (scene->input_kind != SONJECT_INPUT_FILE)
        return write_made(report, scene, swath, result, path);
    void *stored = swath_stored_result(swath, result, clipped);
    CHECK_MEMORY(report, stored, "the patch");
    struct swath_file *file;
    sonject_status status = open_input(report, scene, &file);
    THEN(status,
         swath_file_copy_with_patch(report, file, path, &swath->patch, stored, progress, user));
    swath_file_close(&file);
    free(stored);
    return status;
}

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text);
    const size_t end_length = strlen(end);
    return length >= end_length && strcmp(text + length - end_length, end) == 0;
}

/* Turns amplitudes into 8-bit numbers, 1 into 255. Works in place, since these need less room. */
static void to_bytes(float *pixels, size_t count)
{
    unsigned char *bytes = (unsigned char *)pixels;
    for (size_t i = 0; i < count; i++)
        bytes[i] = (unsigned char)fminf(255.0f, floorf(pixels[i] * 255.0f + 0.5f));
}

sonject_status write_seabed(struct report *report, const struct scene *scene, const char *path)
{
    static const char *const complex_names[] = {"real", "imag"};
    const bool is_png = ends_with(path, ".png");
    const bool is_complex = scene->synthetic.complex_pixels;
    struct geometry_notes notes;
    struct injection_input input;
    if (scene->input_kind != SONJECT_INPUT_SYNTHETIC)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "the scene's input is no synthetic seabed: set input.synthetic");
    if (!is_png && !ends_with(path, ".tif"))
        return input_failure(report, path, "a synthetic seabed is written as .tif or .png");
    if (is_complex && is_png)
        return input_failure(report, path, "complex pixels need .tif");
    CHECK(make_input(report, scene, &input));
    const struct raster_layout layout = {input.rows, input.columns, is_complex ? 2 : 1,
                                         is_png ? PIXEL_UINT8 : PIXEL_FLOAT32};
    geometry_notes_init(&notes, &scene->sonar, &scene->geometry);
    if (is_png)
        to_bytes((float *)input.pixels, input.rows * input.columns);
    const sonject_status status =
        raster_file_write(report, path, &layout, is_complex ? complex_names : NULL,
                          notes.attributes, notes.count, input.pixels);
    free((void *)input.pixels);
    return status;
}
