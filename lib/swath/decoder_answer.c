/* The decoder's work, in its own process or in the library's. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hdf5_values.h"
#include "base/memory.h"
#include "swath/decoder.h"
#include "swath/image_library.h"

void decoder_stamp(char stamp[64])
{
    snprintf(stamp, 64, "%s %zu %zu %d", VERSION_TEXT, sizeof(struct decoder_request),
             sizeof(struct decoder_reply), DECODER_FUNCTIONS);
}

struct opened {
    char *name;  /* for messages; NULL: no file is open here */
    char *place; /* the file's path */
    const struct image_library *library;
    void *image; /* the library's own */
    struct raster_layout layout;
};

struct decoder_state {
    struct opened files[DECODER_FILES_MAX]; /* a handle is an index here plus 1 */
};

/* A request and what its answer needs. */
struct question {
    struct report *report;
    struct decoder_state *state;
    const struct decoder_request *request;
    const char *texts[3]; /* name, path and array to open; else "" */
    const void *in;
    struct opened *file; /* the file of the handle; NULL: none */
    struct decoder_reply *reply;
    void *out;
};

struct decoder_state *decoder_state_make(void)
{
    return allocate_array(1, sizeof(struct decoder_state));
}

static sonject_status close_file(struct report *report, struct opened *file)
{
    const sonject_status status =
        file->image ? file->library->close(report, file->image) : SONJECT_OK;
    free(file->name);
    free(file->place);
    memset(file, 0, sizeof *file);
    return status;
}

/* Returns false if the file is left to HDF5. */
static bool is_raster(const char *path, enum image_kind *kind)
{
    unsigned char head[16] = {0};
    uint64_t bytes;
    FILE *file = byte_file_open(path, &bytes);
    const size_t got = file ? fread(head, 1, sizeof head, file) : 0;
    if (file)
        fclose(file);
    return image_kind_of_beginning(head, got, kind);
}

static sonject_status find_library(const struct question *question,
                                   const struct image_library **library)
{
    static const struct image_library *const libraries[IMAGE_KINDS] = {
        [IMAGE_TIFF] = &tiff_library, [IMAGE_PNG] = &png_library, [IMAGE_JPEG] = &jpeg_library};
    enum image_kind kind;
    if (!*question->texts[2] && is_raster(question->texts[1], &kind)) {
        *library = libraries[kind];
        return SONJECT_OK;
    }
#ifdef HAS_HDF5
    *library = &hdf5_library;
    return SONJECT_OK;
#else
    return report_failure(
        question->report, SONJECT_ERROR_UNSUPPORTED,
        "%s: this build of sonject reads no HDF5: save its arrays as .npy, by h5py say",
        question->texts[0]);
#endif
}

static sonject_status open_image(struct question *question)
{
    const char *name = question->texts[0];
    const char *array = *question->texts[2] ? question->texts[2] : NULL;
    struct image_facts facts = {.description = NULL};
    struct report unheard = {.host = NULL};
    uint32_t place = 0;
    while (place < DECODER_FILES_MAX && question->state->files[place].name)
        place++;
    if (place == DECODER_FILES_MAX)
        return report_failure(question->report, SONJECT_ERROR_STORAGE, "%s: %d files are open",
                              name, DECODER_FILES_MAX);
    struct opened *file = question->file = &question->state->files[place];
    CHECK(find_library(question, &file->library));
    file->name = copy_text(name);
    file->place = copy_text(question->texts[1]);
    const sonject_status status =
        file->name && file->place
            ? file->library->open(question->report, file->name, file->place, array,
                                  question->request->function == DECODER_OPEN_COPY, &file->image,
                                  &facts)
            : report_out_of_memory(question->report, name);
    file->layout = question->reply->layout = facts.layout;
    question->reply->handle = place + 1;
    question->reply->largest = facts.largest;
    question->reply->is_column_major = facts.is_column_major;
    question->reply->jpeg_quality = facts.jpeg_quality;
    if (status == SONJECT_OK && facts.description &&
        strlen(facts.description) < DESCRIPTION_MAX - 1)
        question->reply->bytes = strlen(facts.description) + 1;
    question->out = facts.description;
    if (status != SONJECT_OK)
        (void)close_file(&unheard, file);
    return status;
}

static sonject_status read_samples(struct question *question)
{
    const struct opened *file = question->file;
    size_t bytes = 0;
    if (region_bytes(&file->layout, &question->request->region, &bytes))
        question->out = malloc(bytes + 1);
    CHECK_MEMORY(question->report, question->out, "samples");
    question->reply->bytes = bytes;
    return file->library->read(question->report, file->image, &question->request->region,
                               question->out);
}

/* Answers a request. The library sends only valid requests, so nothing is checked. */
static sonject_status give_answer(struct question *question)
{
    const struct decoder_request *request = question->request;
    const char *text = question->in;
    if (request->function <= DECODER_OPEN_COPY) {
        for (int i = 0; i < 3; i++, text += strlen(text) + 1)
            question->texts[i] = text;
        return open_image(question);
    }
    question->file = &question->state->files[request->handle - 1];
    if (request->function == DECODER_READ)
        return read_samples(question);
    if (request->function == DECODER_WRITE)
        return question->file->library->change(question->report, question->file->image,
                                               &request->region, question->in);
    return close_file(question->report, question->file);
}

/* Reports STORAGE if the disk failed. HDF5 then says that the file is damaged, or goes on without
 * the unread part. A walk through the file may find another array. */
static sonject_status tell_disk(struct question *question, sonject_status status)
{
    const char *path =
        question->file && question->file->name ? question->file->name : question->texts[0];
    if ((status != SONJECT_OK && status != SONJECT_ERROR_INPUT) ||
        file_check_disk(question->report, path, SONJECT_ERROR_INPUT) == SONJECT_ERROR_INPUT)
        return status;
    if (question->file && question->request->function <= DECODER_OPEN_COPY)
        (void)close_file(question->report, question->file);
    return SONJECT_ERROR_STORAGE;
}

void decoder_state_release(struct decoder_state **state)
{
    struct report unheard = {.host = NULL};
    struct hdf5_session session;
    if (!*state)
        return;
    hdf5_enter(&session);
    for (size_t i = 0; i < DECODER_FILES_MAX; i++)
        (void)close_file(&unheard, &(*state)->files[i]);
    hdf5_leave(&session);
    free(*state);
    *state = NULL;
}

sonject_status decoder_answer(struct report *report, struct decoder_state *state,
                              const struct decoder_request *request, const void *in,
                              struct decoder_reply *reply, void **out)
{
    struct question question = {report, state, request, {"", "", ""}, in, NULL, reply, NULL};
    struct hdf5_session session;
    hdf5_enter(&session);
    errno = 0;
    const sonject_status status = tell_disk(&question, give_answer(&question));
    hdf5_leave(&session);
    if (status != SONJECT_OK) {
        free(question.out);
        question.out = NULL;
        reply->bytes = 0;
    }
    *out = question.out;
    return status;
}
