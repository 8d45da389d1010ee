#include "mesh_drafts.h"

#include "claims.h"

void put(struct draft *draft, const void *bytes, size_t count)
{
    if (draft->count + count + 1 > draft->capacity) {
        draft->capacity = 2 * (draft->count + count) + 64;
        draft->bytes = realloc(draft->bytes, draft->capacity);
        assert_non_null(draft->bytes);
    }
    memcpy(draft->bytes + draft->count, bytes, count);
    draft->count += count;
    draft->bytes[draft->count] = '\0';
}

void put_text(struct draft *draft, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    assert_in_range(length, 0, sizeof text - 1);
    put(draft, text, (size_t)length);
}

static void put_reversed(struct draft *draft, const void *bytes, size_t count, int is_reversed)
{
    for (size_t i = 0; i < count; i++)
        put(draft, (const char *)bytes + (is_reversed ? count - 1 - i : i), 1);
}

void clear_draft(struct draft *draft)
{
    free(draft->bytes);
    memset(draft, 0, sizeof *draft);
}

static int is_big_endian(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 0;
}

static float coordinate_of(const struct mesh_sample *sample, size_t corner, size_t axis)
{
    return (float)sample->positions[3 * (size_t)sample->corners[corner] + axis];
}

static void write_stl_text(struct draft *draft, const struct mesh_sample *sample)
{
    put_text(draft, "solid a sample of facets\n");
    for (size_t i = 0; i < sample->triangles; i++) {
        put_text(draft, "  facet normal nan 0 0\r\n\touter loop\n");
        for (size_t corner = 3 * i; corner < 3 * i + 3; corner++)
            put_text(draft, "VERTEX %.9g %.9e %.9g\n", (double)coordinate_of(sample, corner, 0),
                     (double)coordinate_of(sample, corner, 1),
                     (double)coordinate_of(sample, corner, 2));
        put_text(draft, "endloop\nendfacet\n");
    }
    put_text(draft, "endsolid a sample\n");
}

static void write_stl_binary(struct draft *draft, const struct mesh_sample *sample)
{
    const char header[80] = "solid, says the header of a binary file";
    const uint32_t count = (uint32_t)sample->triangles;
    put(draft, header, 80);
    put_reversed(draft, &count, 4, is_big_endian());
    for (size_t i = 0; i < sample->triangles; i++) {
        const float nothing = 0.0f;
        for (int axis = 0; axis < 3; axis++)
            put(draft, &nothing, 4);
        for (size_t corner = 3 * i; corner < 3 * i + 3; corner++)
            for (size_t axis = 0; axis < 3; axis++) {
                const float value = coordinate_of(sample, corner, axis);
                put_reversed(draft, &value, 4, is_big_endian());
            }
        put(draft, "\0\0", 2);
    }
}

static void write_obj(struct draft *draft, const struct mesh_sample *sample)
{
    put_text(draft, "# a sample\nmtllib none.mtl\no part\nv 1e3 1e3 1e3\n");
    for (size_t i = 0; i < sample->vertices; i++)
        put_text(draft, "v %.17g %.17g %.17g 0.5 0.5 0.5\nvt 0 0\n", sample->positions[3 * i],
                 sample->positions[3 * i + 1], sample->positions[3 * i + 2]);
    for (size_t i = 0; i < sample->triangles; i++) {
        const uint32_t *corners = &sample->corners[3 * i];
        if (i % 2)
            put_text(draft, "f %u/1 %u//3 \\\n %u/1/2 # a face\n", corners[0] + 2, corners[1] + 2,
                     corners[2] + 2);
        else
            put_text(draft, "f %d %d %d\n", (int)corners[0] - (int)sample->vertices,
                     (int)corners[1] - (int)sample->vertices,
                     (int)corners[2] - (int)sample->vertices);
    }
}

static void write_ply_header(struct draft *draft, const struct mesh_sample *sample,
                             const char *format)
{
    put_text(draft,
             "ply\nformat %s 1.0\ncomment a sample\nelement vertex %zu\nproperty float confidence\n"
             "property double x\nproperty double y\nproperty double z\nelement camera 1\n"
             "property short number\nelement face %zu\nproperty list uchar float weights\n"
             "property list uchar int vertex_indices\nend_header\n",
             format, sample->vertices, sample->triangles);
}

static void write_ply_text(struct draft *draft, const struct mesh_sample *sample)
{
    write_ply_header(draft, sample, "ascii");
    for (size_t i = 0; i < sample->vertices; i++)
        put_text(draft, "0.5 %.17g %.17g %.17g\n", sample->positions[3 * i],
                 sample->positions[3 * i + 1], sample->positions[3 * i + 2]);
    put_text(draft, "7\n");
    for (size_t i = 0; i < sample->triangles; i++)
        put_text(draft, "2 0.5 0.25 3 %u %u %u\n", sample->corners[3 * i],
                 sample->corners[3 * i + 1], sample->corners[3 * i + 2]);
}

static void write_ply_binary(struct draft *draft, const struct mesh_sample *sample, int is_big)
{
    const int is_reversed = is_big != is_big_endian();
    const float weight = 0.5f;
    const int16_t camera = 7;
    write_ply_header(draft, sample, is_big ? "binary_big_endian" : "binary_little_endian");
    for (size_t i = 0; i < sample->vertices; i++) {
        put_reversed(draft, &weight, 4, is_reversed);
        for (size_t axis = 0; axis < 3; axis++)
            put_reversed(draft, &sample->positions[3 * i + axis], 8, is_reversed);
    }
    put_reversed(draft, &camera, 2, is_reversed);
    for (size_t i = 0; i < sample->triangles; i++) {
        put(draft, "\1", 1);
        put_reversed(draft, &weight, 4, is_reversed);
        put(draft, "\3", 1);
        for (size_t corner = 0; corner < 3; corner++)
            put_reversed(draft, &sample->corners[3 * i + corner], 4, is_reversed);
    }
}

const char *const draft_names[] = {"text.stl", "binary.STL", "sample.obj",
                                   "text.ply", "little.ply", "big.ply"};

struct draft write_format(enum format format, const struct mesh_sample *sample)
{
    struct draft draft = {NULL, 0, 0};
    if (format == STL_TEXT)
        write_stl_text(&draft, sample);
    else if (format == STL_BINARY)
        write_stl_binary(&draft, sample);
    else if (format == OBJ)
        write_obj(&draft, sample);
    else if (format == PLY_AS_TEXT)
        write_ply_text(&draft, sample);
    else
        write_ply_binary(&draft, sample, format == PLY_BIG);
    return draft;
}
