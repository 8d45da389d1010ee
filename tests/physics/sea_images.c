/* What is formed of rays, and put into measured images. */
#include "sea.h"

#include "bench.h"
#include "inject/injection.h"

static void *copy_bytes(const void *from, size_t bytes)
{
    void *copy = claim_memory(bytes + 1, 1);
    if (bytes > 0)
        memcpy(copy, from, bytes);
    return copy;
}

static float *copy_plane(const float *plane, size_t count)
{
    return plane ? copy_bytes(plane, count * sizeof *plane) : NULL;
}

static double complex *join_planes(const float *real_part, const float *imaginary_part,
                                   size_t count)
{
    double complex *joined = real_part ? claim_memory(count, sizeof *joined) : NULL;
    for (size_t i = 0; real_part && i < count; i++)
        joined[i] = real_part[i] + I * (double)imaginary_part[i];
    return joined;
}

static const struct object_image *copy_objects(const struct echoes *echoes)
{
    struct object_image *objects = claim_memory(echoes->object_count + 1, sizeof *objects);
    for (uint32_t i = 0; i < echoes->object_count; i++) {
        const struct object_echo *echo = &echoes->objects[i];
        objects[i].first_column = echo->first_column;
        objects[i].columns = echo->columns;
        objects[i].energy = copy_plane(echo->energy, echoes->rows * echo->columns);
        objects[i].peak_energy = echo->peak_energy;
    }
    return objects;
}

const struct image *sea_image_of(struct sea *sea, const float *map, bool has_speckle)
{
    struct image *image = claim_memory(1, sizeof *image);
    struct echoes echoes;
    struct echo_request request;
    memset(&request, 0, sizeof request);
    request.map = map;
    request.field = has_speckle ? SEABED_FIELD_SPECKLE : SEABED_FIELD_NONE;
    EXPECT_OK(&sea->bench->report, echoes_compute(&echoes, &sea->bench->tracer, &request));
    const size_t count = echoes.rows * echoes.columns;
    image->rows = echoes.rows;
    image->columns = echoes.columns;
    image->pixels = count;
    image->seabed_energy = copy_plane(echoes.seabed_energy, count);
    image->level_energy = copy_plane(echoes.level_energy, count);
    image->lost_energy = copy_plane(echoes.lost_energy, count);
    image->target_energy = copy_plane(echoes.target_energy, count);
    image->energy = copy_plane(echoes.energy, count);
    image->orders = echoes.orders;
    for (uint32_t order = 0; order < echoes.orders && order < CHAIN_ORDERS; order++)
        image->order_energy[order] = copy_plane(echoes.order_energy[order], count);
    image->target = join_planes(echoes.target_real, echoes.target_imaginary, count);
    image->seabed = join_planes(echoes.seabed_real, echoes.seabed_imaginary, count);
    image->objects = copy_objects(&echoes);
    echoes_clear(&echoes);
    return image;
}

const struct image *sea_image(struct sea *sea)
{
    return sea_image_of(sea, NULL, false);
}

double sum_of(const float *plane, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += (double)plane[i];
    return sum;
}

double complex brightest(const struct image *image, size_t *row, size_t *column)
{
    size_t at = 0;
    for (size_t i = 1; i < image->pixels; i++)
        if (cabs(image->target[i]) > cabs(image->target[at]))
            at = i;
    *row = at / image->columns;
    *column = at % image->columns;
    return image->target[at];
}

double *visibility_of(const struct image *image)
{
    double *visibility = claim_memory(image->pixels, sizeof *visibility);
    for (size_t i = 0; i < image->pixels; i++)
        visibility[i] = 1.0 - (double)image->lost_energy[i] / image->seabed_energy[i];
    return visibility;
}

bool images_differ(const struct image *one, const struct image *other)
{
    const size_t bytes = one->pixels * sizeof(float);
    bool differ =
        memcmp(one->target, other->target, one->pixels * sizeof *one->target) != 0 ||
        memcmp(one->target_energy, other->target_energy, bytes) != 0 ||
        memcmp(one->seabed_energy, other->seabed_energy, bytes) != 0 ||
        memcmp(one->lost_energy, other->lost_energy, bytes) != 0 ||
        memcmp(one->energy, other->energy, bytes) != 0 || one->orders != other->orders ||
        (one->seabed && memcmp(one->seabed, other->seabed, one->pixels * sizeof *one->seabed) != 0);
    for (uint32_t order = 0; order < one->orders && order < CHAIN_ORDERS; order++)
        differ = differ || memcmp(one->order_energy[order], other->order_energy[order], bytes) != 0;
    return differ;
}

double image_difference(const struct image *one, const struct image *other, double *peak)
{
    double largest = 0.0;
    *peak = 0.0;
    for (size_t i = 0; i < one->pixels; i++) {
        *peak = fmax(*peak, cabs(one->target[i]));
        largest = fmax(largest, cabs(one->target[i] - other->target[i]));
    }
    return largest;
}

double complex *sea_noise(struct sea *sea, enum noise kind)
{
    const uint32_t stream = kind == NOISE_OF_IMAGE   ? STREAM_NOISE
                            : kind == NOISE_OF_PHASE ? STREAM_INPUT_PHASE
                                                     : 75 + (uint32_t)kind;
    const struct window window = {0, sea->rows, 0, sea->columns};
    float *parts[2];
    for (int k = 0; k < 2; k++)
        parts[k] = claim_memory(sea->pixels, sizeof *parts[k]);
    EXPECT_OK(&sea->bench->report,
              coloured_noise(&sea->bench->tracer, stream, &window, parts[0], parts[1]));
    return join_planes(parts[0], parts[1], sea->pixels);
}

struct estimate level_over(const struct sea *sea, const struct image *image, size_t edge,
                           bool is_field)
{
    double sum = 0.0, squares = 0.0;
    for (size_t column = edge; column + edge < sea->columns; column++) {
        const double expected = sea_seabed_level(sea, sea_range(sea, (double)column));
        double mean = 0.0;
        for (size_t row = 0; row < sea->rows; row++) {
            const size_t i = row * sea->columns + column;
            mean += (is_field ? pow(cabs(image->seabed[i]), 2.0) : image->seabed_energy[i]) /
                    expected / (double)sea->rows;
        }
        sum += mean;
        squares += mean * mean;
    }
    return estimate_of_sums(sum, squares, (double)(sea->columns - 2 * edge));
}

double complex correlation_of(const struct sea *sea, const double complex *field, size_t rows,
                              size_t columns, size_t edge)
{
    double complex sum = 0.0;
    double count = 0.0;
    for (size_t row = 0; row + rows < sea->rows; row++)
        for (size_t column = edge; column + columns + edge <= sea->columns; column++) {
            const size_t i = row * sea->columns + column;
            sum += conj(field[i]) * field[i + rows * sea->columns + columns];
            count += 1.0;
        }
    return sum / count;
}

double complex *unit_field(const struct sea *sea, const double complex *field, const float *energy)
{
    double complex *unit = claim_memory(sea->pixels, sizeof *unit);
    for (size_t i = 0; i < sea->pixels; i++)
        unit[i] = field[i] / sqrt((double)energy[i]);
    return unit;
}

const struct injected *sea_inject(struct sea *sea, const float *pixels, bool is_complex)
{
    struct injected *injected = claim_memory(1, sizeof *injected);
    struct injection_input input;
    struct injection_result result;
    memset(&input, 0, sizeof input);
    input.rows = sea->rows;
    input.columns = sea->columns;
    input.is_complex = is_complex;
    input.pixels = pixels;
    EXPECT_OK(&sea->bench->report, injection_run(&sea->bench->report, sea->bench->tracer.device,
                                                 &sea->bench->scene, &input, NULL, NULL, &result));
    injected->image = copy_plane(result.image, sea->pixels * (is_complex ? 2 : 1));
    injected->field = copy_plane(result.field, 2 * sea->pixels);
    injected->energy = copy_plane(result.energy, sea->pixels);
    injected->visibility = copy_plane(result.visibility, sea->pixels);
    for (uint32_t order = 0; order < result.orders && order < CHAIN_ORDERS; order++)
        injected->order_energy[order] = copy_plane(result.order_energy[order], sea->pixels);
    injected->highlight = copy_bytes(result.highlight, sea->pixels);
    injected->labels = copy_bytes(result.labels, sea->pixels);
    injected->influence = copy_bytes(result.influence, sea->pixels);
    injected->objects = copy_bytes(result.objects, result.object_count * sizeof *result.objects);
    injected->statistics = result.statistics;
    injection_result_clear(&result);
    return injected;
}

float *pairs_of(const double complex *field, size_t count)
{
    float *pairs = claim_memory(2 * count, sizeof *pairs);
    for (size_t i = 0; i < count; i++) {
        pairs[2 * i] = (float)creal(field[i]);
        pairs[2 * i + 1] = (float)cimag(field[i]);
    }
    return pairs;
}

float *magnitudes_of(const double complex *field, size_t count)
{
    float *magnitudes = claim_memory(count, sizeof *magnitudes);
    for (size_t i = 0; i < count; i++)
        magnitudes[i] = (float)cabs(field[i]);
    return magnitudes;
}

struct level sea_level(struct sea *sea, const float *pixels, bool is_complex)
{
    struct patch_level level;
    EXPECT_OK(&sea->bench->report,
              patch_level_init(&level, &sea->bench->report, &sea->bench->scene,
                               &sea->bench->tracer.view, &sea->bench->tracer.response, pixels,
                               is_complex));
    const struct level copy = {copy_plane(level.level, sea->pixels),
                               copy_plane(level.cell_energy, sea->columns), level.noise_ratio};
    patch_level_clear(&level);
    return copy;
}
