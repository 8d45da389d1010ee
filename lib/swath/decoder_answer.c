/* What the decoder does, in its own process or in the library's: images are OpenImageIO's or
 * HDF5's. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/byte_file.h"
#include "base/file.h"
#include "base/memory.h"
#include "swath/decoder.h"
#include "swath/hdf5_array.h"
#include "swath/raster_module.h"

#define TEXT_OF(number)   #number
#define DIGITS_OF(number) TEXT_OF(number)

void decoder_stamp(char stamp[64])
{
    snprintf(stamp, 64, "%s %zu %zu %d",
             DIGITS_OF(SONJECT_VERSION_MAJOR) "." DIGITS_OF(SONJECT_VERSION_MINOR) "." DIGITS_OF(
                 SONJECT_VERSION_PATCH),
             sizeof(struct decoder_request), sizeof(struct decoder_reply), DECODER_FUNCTIONS);
}

struct opened {
    char *path;                         /* in messages; NULL: none is open */
    struct raster_image *raster;        /* NULL: it is image */
    const struct raster_module *module; /* whose raster is */
    struct raster_layout layout;        /* of raster */
    struct hdf5_array *image;
};

struct decoder_state {
    struct opened files[DECODER_FILES_MAX]; /* a handle is a place here, and 1 */
};

/* One request. */
struct question {
    struct report *report;
    struct decoder_state *state;
    const struct decoder_request *request;
    struct opened *file; /* of its handle; NULL: it has none */
    const char *texts[3];
    const void *samples; /* the same bytes as the texts */
    struct decoder_reply *reply;
    void *out;
};

struct decoder_state *decoder_state_make(void)
{
    return allocate_array(1, sizeof(struct decoder_state));
}

static void close_file(struct opened *file)
{
    if (file->raster)
        file->module->close(&file->raster);
    else if (file->image)
        hdf5_array_close(&file->image);
    free(file->path);
    memset(file, 0, sizeof *file);
}

void decoder_state_release(struct decoder_state **state)
{
    for (size_t i = 0; *state && i < DECODER_FILES_MAX; i++)
        close_file(&(*state)->files[i]);
    free(*state);
    *state = NULL;
}

/* The place of a file to be opened; NULL: too many are. */
static struct opened *free_place(struct question *question)
{
    for (uint32_t i = 0; i < DECODER_FILES_MAX; i++)
        if (!question->state->files[i].path) {
            question->reply->handle = i + 1;
            question->file = &question->state->files[i];
            return question->file;
        }
    (void)report_failure(question->report, SONJECT_ERROR_STORAGE, "%s: %d files are open",
                         question->texts[0], DECODER_FILES_MAX);
    return NULL;
}

/* False: it is HDF5's. */
static bool is_raster(const char *path)
{
    unsigned char head[16] = {0};
    enum image_kind kind;
    uint64_t bytes;
    FILE *file = byte_file_open(path, &bytes);
    const size_t got = file ? fread(head, 1, sizeof head, file) : 0;
    if (file)
        fclose(file);
    return image_kind_of_beginning(head, got, &kind);
}

static sonject_status open_raster(struct question *question, struct opened *place)
{
    place->path = copy_text(question->texts[0]);
    sonject_status status = place->path
                                ? raster_module_find(question->report, place->path, &place->module)
                                : report_out_of_memory(question->report, "a path");
    if (status == SONJECT_OK)
        status = place->module->open(question->report, question->texts[0], question->texts[1],
                                     &place->raster, &place->layout);
    question->reply->layout = place->layout;
    if (status != SONJECT_OK) {
        free(place->path);
        place->path = NULL;
    }
    return status;
}

static sonject_status open_image(struct question *question)
{
    const char *array = *question->texts[2] ? question->texts[2] : NULL;
    struct opened *place = free_place(question);
    if (!place)
        return SONJECT_ERROR_STORAGE;
    if (!array && is_raster(question->texts[1]))
        return open_raster(question, place);
    const sonject_status status =
        hdf5_array_open(question->report, question->texts[0], question->texts[1], array,
                        question->request->function == DECODER_OPEN_COPY, &place->image);
    place->path = status == SONJECT_OK ? copy_text(question->texts[0]) : NULL;
    if (status != SONJECT_OK)
        return status;
    if (!place->path) {
        hdf5_array_close(&place->image);
        return report_out_of_memory(question->report, question->texts[0]);
    }
    hdf5_array_layout(place->image, &question->reply->layout);
    question->reply->largest = hdf5_array_largest(place->image);
    question->reply->is_turned = hdf5_array_is_turned(place->image);
    return SONJECT_OK;
}

static sonject_status close_handle(struct question *question)
{
    close_file(question->file);
    return SONJECT_OK;
}

static sonject_status give_text(struct question *question, char *text)
{
    question->out = text;
    question->reply->value = 1;
    question->reply->bytes = strlen(text) + 1;
    return SONJECT_OK;
}

static sonject_status read_attribute(struct question *question)
{
    const struct opened *file = question->file;
    char *text = file->raster ? file->module->attribute(file->raster, question->texts[0]) : NULL;
    const bool is_there =
        file->raster ? text != NULL : hdf5_array_attribute(file->image, question->texts[0], &text);
    return is_there ? give_text(question, text) : SONJECT_OK;
}

/* Of the region's samples, as the layout has them. */
static bool make_room(struct question *question, const struct raster_layout *layout)
{
    size_t bytes = 0;
    if (region_bytes(layout, &question->request->region, &bytes))
        question->out = malloc(bytes + 1);
    question->reply->bytes = bytes;
    return question->out != NULL;
}

static sonject_status read_samples(struct question *question)
{
    struct opened *file = question->file;
    struct raster_layout layout = file->layout;
    if (!file->raster)
        hdf5_array_layout(file->image, &layout);
    if (!make_room(question, &layout))
        return report_out_of_memory(question->report, "samples");
    if (file->raster)
        return file->module->read(question->report, file->raster, &question->request->region,
                                  question->out);
    return hdf5_array_read(question->report, question->file->image, &question->request->region,
                           question->out);
}

static sonject_status write_samples(struct question *question)
{
    const struct opened *file = question->file;
    if (file->raster)
        return file->module->change(question->report, file->raster, &question->request->region,
                                    question->samples);
    return hdf5_array_change(question->report, question->file->image, &question->request->region,
                             question->samples);
}

static sonject_status finish_copy(struct question *question)
{
    const sonject_status status = question->file->raster
                                      ? SONJECT_OK
                                      : hdf5_array_finish(question->report, question->file->image);
    close_file(question->file);
    return status;
}

/* What each function needs: texts, a handle of an image. */
static const struct answer {
    sonject_status (*give)(struct question *question);
    unsigned texts;
    bool needs_image;
} answers[DECODER_FUNCTIONS] = {
    [DECODER_OPEN_IMAGE] = {open_image, 3, false}, [DECODER_OPEN_COPY] = {open_image, 3, false},
    [DECODER_CLOSE] = {close_handle, 0, false},    [DECODER_ATTRIBUTE] = {read_attribute, 1, true},
    [DECODER_READ] = {read_samples, 0, true},      [DECODER_WRITE] = {write_samples, 0, true},
    [DECODER_FINISH] = {finish_copy, 0, true},
};

static bool is_possible(struct question *question, const struct answer *answer)
{
    const struct decoder_request *request = question->request;
    const char *text = request->bytes > 0 ? question->samples : "";
    const char *end = text + request->bytes;
    for (unsigned i = 0; i < answer->texts; i++) {
        const char *zero = text < end ? memchr(text, '\0', (size_t)(end - text)) : NULL;
        if (!zero)
            return false;
        question->texts[i] = text;
        text = zero + 1;
    }
    if (request->handle > 0 && request->handle <= DECODER_FILES_MAX)
        question->file = &question->state->files[request->handle - 1];
    const struct opened *file = question->file;
    const bool is_image = file && (file->image || file->raster);
    return (!answer->needs_image || is_image) &&
           (request->function != DECODER_CLOSE || question->file);
}

/* Where the disk could not be read HDF5 says that it is damaged, or does without what lies there: a
 * walk through a file may then find another array. */
static sonject_status tell_disk(struct question *question, sonject_status status)
{
    const char *path =
        question->file && question->file->path ? question->file->path : question->texts[0];
    if ((status != SONJECT_OK && status != SONJECT_ERROR_INPUT) ||
        file_check_disk(question->report, path, SONJECT_ERROR_INPUT) == SONJECT_ERROR_INPUT)
        return status;
    if (question->file && question->request->function <= DECODER_OPEN_COPY)
        close_file(question->file);
    return SONJECT_ERROR_STORAGE;
}

sonject_status decoder_answer(struct report *report, struct decoder_state *state,
                              const struct decoder_request *request, const void *in,
                              struct decoder_reply *reply, void **out)
{
    struct question question = {report, state, request, NULL, {"", "", ""}, in, reply, NULL};
    const struct answer *answer =
        request->function < DECODER_FUNCTIONS ? &answers[request->function] : NULL;
    sonject_status status;
    if (!answer || !answer->give || !is_possible(&question, answer)) {
        status =
            report_failure(report, SONJECT_ERROR_INPUT, "a decoder was asked what it cannot do");
    } else {
        errno = 0;
        status = answer->give(&question);
        status = tell_disk(&question, status);
    }
    if (status != SONJECT_OK) {
        free(question.out);
        question.out = NULL;
        reply->bytes = 0;
    }
    *out = question.out;
    return status;
}
