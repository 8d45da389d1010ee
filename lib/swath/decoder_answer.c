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
#include "swath/image_kind.h"
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
    char *path; /* in messages; NULL: none is open */
    const struct image_library *library;
    void *image; /* of the library's */
    struct raster_layout layout;
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
    if (file->image)
        file->library->close(file->image);
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

static sonject_status find_library(struct report *report, const char *name, bool is_of_rasters,
                                   const struct image_library **library)
{
    const struct raster_module *module;
    if (!is_of_rasters)
        return hdf5_library_find(report, name, library);
    CHECK(raster_module_find(report, name, &module));
    *library = &module->library;
    return SONJECT_OK;
}

static sonject_status open_image(struct question *question)
{
    const char *name = question->texts[0];
    const char *array = *question->texts[2] ? question->texts[2] : NULL;
    const bool is_of_rasters = !array && is_raster(question->texts[1]);
    struct opened *place = free_place(question);
    struct image_facts facts = {{0, 0, 0, PIXEL_UINT8}, 0, false};
    if (!place)
        return SONJECT_ERROR_STORAGE;
    CHECK(find_library(question->report, name, is_of_rasters, &place->library));
    place->path = copy_text(name);
    CHECK_MEMORY(question->report, place->path, name);
    const sonject_status status = place->library->open(
        question->report, name, question->texts[1], array,
        question->request->function == DECODER_OPEN_COPY, &place->image, &facts);
    place->layout = question->reply->layout = facts.layout;
    question->reply->largest = facts.largest;
    question->reply->is_turned = facts.is_turned;
    if (status != SONJECT_OK)
        close_file(place);
    return status;
}

static sonject_status close_handle(struct question *question)
{
    close_file(question->file);
    return SONJECT_OK;
}

static sonject_status read_attribute(struct question *question)
{
    const struct opened *file = question->file;
    char *text = file->library->attribute(file->image, question->texts[0]);
    if (text && strlen(text) < question->request->capacity) {
        question->out = text;
        question->reply->bytes = strlen(text) + 1;
    } else {
        free(text);
    }
    return SONJECT_OK;
}

static sonject_status read_samples(struct question *question)
{
    const struct opened *file = question->file;
    const struct region *region = &question->request->region;
    size_t bytes = 0;
    if (region_bytes(&file->layout, region, &bytes))
        question->out = malloc(bytes + 1);
    CHECK_MEMORY(question->report, question->out, "samples");
    question->reply->bytes = bytes;
    return file->library->read(question->report, file->image, region, question->out);
}

static sonject_status write_samples(struct question *question)
{
    return question->file->library->change(question->report, question->file->image,
                                           &question->request->region, question->samples);
}

static sonject_status finish_copy(struct question *question)
{
    const sonject_status status =
        question->file->library->finish(question->report, question->file->image);
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
    const bool is_open = question->file && question->file->image;
    const bool is_of_region =
        request->function == DECODER_READ || request->function == DECODER_WRITE;
    return (!answer->needs_image || is_open) &&
           (request->function != DECODER_CLOSE || question->file) &&
           (!is_of_region || region_is_inside(&question->file->layout, &request->region));
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
