/* What the decoder does, in its own process or in the library's: images are OpenImageIO's or
 * HDF5's, trees HDF5's. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/file.h"
#include "base/memory.h"
#include "io/byte_file.h"
#include "io/decoder.h"
#include "io/hdf5_array.h"
#include "io/raster_module.h"
#ifdef HAS_HDF5
#include "base/hdf5_values.h"
#endif

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
    struct raster_image *raster;        /* NULL, and so is image: it is a tree */
    const struct raster_module *module; /* whose raster is */
    struct raster_layout layout;        /* of raster */
    struct hdf5_array *image;
    int64_t tree; /* HDF5's number */
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
    if (file->raster) {
        file->module->close(&file->raster);
    } else if (file->image) {
        hdf5_array_close(&file->image);
    } else if (file->path) {
#ifdef HAS_HDF5
        struct hdf5_session session;
        hdf5_enter(&session);
        H5Fclose(file->tree);
        hdf5_leave(&session);
#endif
    }
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
        status = place->module->open(question->report, question->texts[1], &place->raster,
                                     &place->layout);
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
    if (question->request->function == DECODER_OPEN_IMAGE && !array &&
        is_raster(question->texts[1]))
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
    return hdf5_array_change(question->report, question->file->image, &question->request->region,
                             question->samples);
}

static sonject_status finish_copy(struct question *question)
{
    const sonject_status status = hdf5_array_finish(question->report, question->file->image);
    close_file(question->file);
    return status;
}

#ifdef HAS_HDF5
static sonject_status refuse(struct question *question, const char *what)
{
    return report_failure(question->report, SONJECT_ERROR_INPUT, "%s: %s %s is damaged",
                          question->file->path, question->texts[0], what);
}

static sonject_status open_tree(struct question *question)
{
    struct opened *place = free_place(question);
    if (!place)
        return SONJECT_ERROR_STORAGE;
    const hid_t tree = H5Fopen(question->texts[1], H5F_ACC_RDONLY, H5P_DEFAULT);
    place->path = tree < 0 ? NULL : copy_text(question->texts[0]);
    if (place->path) {
        place->tree = tree;
        return SONJECT_OK;
    }
    if (tree >= 0)
        H5Fclose(tree);
    return report_failure(question->report, SONJECT_ERROR_INPUT,
                          "%s: HDF5 cannot open it: it is damaged or cut short",
                          question->texts[0]);
}

/* Groups are asked for one after the other, since HDF5 fails where one in between is missing. */
static bool has_link(hid_t tree, const char *path)
{
    char part[256];
    const size_t length = strlen(path);
    for (size_t end = 1; end <= length && length < sizeof part; end++)
        if (end == length || path[end] == '/') {
            memcpy(part, path, end);
            part[end] = '\0';
            if (strcmp(part, "/") != 0 && H5Lexists(tree, part, H5P_DEFAULT) <= 0)
                return false;
        }
    return length < sizeof part;
}

static hid_t open_group(const struct question *question)
{
    const char *path = question->texts[0];
    return has_link(question->file->tree, path) ? H5Gopen2(question->file->tree, path, H5P_DEFAULT)
                                                : -1;
}

static sonject_status has_group(struct question *question)
{
    const hid_t group = open_group(question);
    question->reply->value = group >= 0;
    if (group >= 0)
        H5Gclose(group);
    return SONJECT_OK;
}

static bool read_value(struct question *question, hid_t group, const char *name)
{
    uint64_t *value = &question->reply->value;
    double number = 0.0;
    int32_t integer = 0;
    char *text = NULL;
    bool is_read = false;
    switch (question->request->function) {
    case DECODER_WHOLE:
        return hdf5_read_whole(group, name, value);
    case DECODER_INTEGER:
        is_read = hdf5_read_integer(group, name, INT32_MIN, INT32_MAX, &integer);
        *value = (uint64_t)(int64_t)integer;
        return is_read;
    case DECODER_NUMBER:
        is_read = hdf5_read_number(group, name, &number);
        memcpy(value, &number, sizeof number);
        return is_read;
    default:
        return hdf5_read_text(group, name, &text) && give_text(question, text) == SONJECT_OK;
    }
}

static sonject_status read_group_value(struct question *question)
{
    const hid_t group = open_group(question);
    const bool is_read = group >= 0 && read_value(question, group, question->texts[1]);
    if (group >= 0)
        H5Gclose(group);
    return is_read ? SONJECT_OK : refuse(question, question->texts[1]);
}

/* One after the other, each with its 0. */
static sonject_status join(struct question *question, char **texts, size_t count)
{
    size_t bytes = 0;
    for (size_t i = 0; i < count; i++)
        bytes += strlen(texts[i]) + 1;
    char *joined = allocate_array(bytes, 1);
    question->out = joined;
    question->reply->bytes = bytes;
    question->reply->value = count;
    for (size_t i = 0; i < count; i++) {
        if (joined)
            joined = (char *)memcpy(joined, texts[i], strlen(texts[i]) + 1) + strlen(texts[i]) + 1;
        free(texts[i]);
    }
    free(texts);
    return question->out ? SONJECT_OK : report_out_of_memory(question->report, "texts");
}

static sonject_status read_texts(struct question *question)
{
    char **texts = NULL;
    size_t count = 0;
    const hid_t group = open_group(question);
    const bool is_there = group >= 0 && H5Lexists(group, question->texts[1], H5P_DEFAULT) > 0;
    const bool is_read = is_there && hdf5_read_texts(group, question->texts[1], &texts, &count);
    if (group >= 0)
        H5Gclose(group);
    if (is_there && !is_read)
        return refuse(question, question->texts[1]);
    return is_read ? join(question, texts, count) : SONJECT_OK;
}

/* 32-bit floats of two dimensions. */
static bool look_at_plane(hid_t plane, hid_t space, struct raster_layout *layout)
{
    hsize_t sides[2] = {0, 0};
    const hid_t type = H5Dget_type(plane);
    const bool is_sound = type >= 0 && space >= 0 && H5Tget_class(type) == H5T_FLOAT &&
                          H5Tget_size(type) == sizeof(float) &&
                          H5Sget_simple_extent_ndims(space) == 2 &&
                          H5Sget_simple_extent_dims(space, sides, NULL) == 2;
    if (type >= 0)
        H5Tclose(type);
    *layout = (struct raster_layout){sides[0], sides[1], 1, PIXEL_FLOAT32};
    return is_sound;
}

static bool read_lines(struct question *question, hid_t plane, hid_t space)
{
    struct raster_layout *layout = &question->reply->layout;
    const struct region *region = &question->request->region;
    if (!look_at_plane(plane, space, layout))
        return false;
    if (region->rows == 0)
        return true;
    if (!region_is_inside(layout, region) || !make_room(question, layout))
        return false;
    const hsize_t first[2] = {region->first_row, region->first_column};
    const hsize_t count[2] = {region->rows, region->columns};
    const hid_t memory = H5Screate_simple(2, count, NULL);
    const bool is_done =
        memory >= 0 && H5Sselect_hyperslab(space, H5S_SELECT_SET, first, NULL, count, NULL) >= 0 &&
        H5Dread(plane, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, question->out) >= 0;
    if (memory >= 0)
        H5Sclose(memory);
    return is_done;
}

static sonject_status read_plane(struct question *question)
{
    const char *name = question->texts[1];
    const hid_t group = open_group(question);
    const hid_t plane = group >= 0 && H5Lexists(group, name, H5P_DEFAULT) > 0
                            ? H5Dopen2(group, name, H5P_DEFAULT)
                            : -1;
    const hid_t space = plane < 0 ? -1 : H5Dget_space(plane);
    const bool is_read = space >= 0 && read_lines(question, plane, space);
    if (space >= 0)
        H5Sclose(space);
    if (plane >= 0)
        H5Dclose(plane);
    if (group >= 0)
        H5Gclose(group);
    return is_read ? SONJECT_OK : refuse(question, name);
}
#endif

/* What each function needs: texts, a handle of an image or a tree. */
static const struct answer {
    sonject_status (*give)(struct question *question);
    unsigned texts;
    bool needs_image, needs_tree;
} answers[DECODER_FUNCTIONS] = {
    [DECODER_OPEN_IMAGE] = {open_image, 3, false, false},
    [DECODER_OPEN_COPY] = {open_image, 3, false, false},
    [DECODER_CLOSE] = {close_handle, 0, false, false},
    [DECODER_ATTRIBUTE] = {read_attribute, 1, true, false},
    [DECODER_READ] = {read_samples, 0, true, false},
    [DECODER_WRITE] = {write_samples, 0, true, false},
    [DECODER_FINISH] = {finish_copy, 0, true, false},
#ifdef HAS_HDF5
    [DECODER_OPEN_TREE] = {open_tree, 3, false, false},
    [DECODER_HAS_GROUP] = {has_group, 1, false, true},
    [DECODER_WHOLE] = {read_group_value, 2, false, true},
    [DECODER_INTEGER] = {read_group_value, 2, false, true},
    [DECODER_NUMBER] = {read_group_value, 2, false, true},
    [DECODER_TEXT] = {read_group_value, 2, false, true},
    [DECODER_TEXTS] = {read_texts, 2, false, true},
    [DECODER_PLANE] = {read_plane, 2, false, true},
#endif
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
    const bool changes = request->function == DECODER_WRITE || request->function == DECODER_FINISH;
    const bool is_image = file && (file->image || (file->raster && !changes));
    const bool is_tree = file && file->path && !file->image && !file->raster;
    return (!answer->needs_image || is_image) && (!answer->needs_tree || is_tree) &&
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
    if (question->file && question->request->function <= DECODER_OPEN_TREE)
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
#ifdef HAS_HDF5
        /* images see to it themselves */
        const bool enters = answer->needs_tree || request->function == DECODER_OPEN_TREE;
        struct hdf5_session session;
        if (enters)
            hdf5_enter(&session);
#endif
        errno = 0;
        status = answer->give(&question);
#ifdef HAS_HDF5
        if (enters)
            hdf5_leave(&session);
#endif
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
