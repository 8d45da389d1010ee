/* The sea's images and injections (sea.h). */
#include "sea.h"

static double complex *join_planes(const float *real_part, const float *imaginary_part,
                                   size_t count)
{
    double complex *joined = real_part ? claim_memory(count, sizeof *joined) : NULL;
    for (size_t i = 0; real_part && i < count; i++)
        joined[i] = real_part[i] + I * (double)imaginary_part[i];
    return joined;
}

static void clear_echoes(void *echoes)
{
    echoes_clear(echoes);
}

static void clear_result(void *result)
{
    injection_result_clear(result);
}

static void clear_level(void *level)
{
    patch_level_clear(level);
}

const struct image *sea_image_of(struct sea *sea, const float *map, bool has_speckle)
{
    struct image *image = claim_memory(1, sizeof *image);
    struct echoes *echoes = claim_memory(1, sizeof *echoes);
    const struct echo_request request = {
        .map = map, .field = has_speckle ? SEABED_FIELD_SPECKLE : SEABED_FIELD_NONE};
    sea_lay(sea);
    EXPECT_OK(&sea->bench->report,
              echoes_form(echoes, &sea->bench->tracer, &request, &sea->bench->tracer, &request));
    claim_end(clear_echoes, echoes);
    *image = (struct image){.rows = echoes->rows,
                            .columns = echoes->columns,
                            .pixels = echoes->rows * echoes->columns,
                            .seabed_energy = echoes->seabed_energy,
                            .level_energy = echoes->level_energy,
                            .lost_energy = echoes->lost_energy,
                            .target_energy = echoes->target_energy,
                            .energy = echoes->energy,
                            .orders = echoes->orders,
                            .objects = echoes->objects};
    for (uint32_t order = 0; order < echoes->orders && order < CHAIN_ORDERS; order++)
        image->order_energy[order] = echoes->order_energy[order];
    image->target = join_planes(echoes->target_real, echoes->target_imaginary, image->pixels);
    image->seabed = join_planes(echoes->seabed_real, echoes->seabed_imaginary, image->pixels);
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

struct estimate level_over(const struct sea *sea, const struct image *image, size_t edge_rows,
                           size_t edge_columns, bool is_field, expected_level *expected)
{
    double sum = 0.0, squares = 0.0;
    for (size_t column = edge_columns; column + edge_columns < sea->columns; column++) {
        double mean = 0.0;
        for (size_t row = edge_rows; row + edge_rows < sea->rows; row++) {
            const size_t i = row * sea->columns + column;
            mean += is_field ? pow(cabs(image->seabed[i]), 2.0) : image->seabed_energy[i];
        }
        mean /= (double)(sea->rows - 2 * edge_rows) * expected(sea, sea_range(sea, (double)column));
        sum += mean;
        squares += mean * mean;
    }
    struct estimate level =
        estimate_of_sums(sum, squares, (double)(sea->columns - 2 * edge_columns));
    level.error *= sqrt(3.0);
    return level;
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

static const float *plane_of(const struct injection_result *result, enum injected_plane plane)
{
    float *pixels = claim_memory(2 * result->rows * result->columns, sizeof *pixels);
    injection_result_plane(result, plane, pixels);
    return pixels;
}

static const struct injected *inject(struct sea *sea, const float *pixels, bool is_complex,
                                     bool is_whole)
{
    struct injection_result *result = claim_memory(1, sizeof *result);
    struct injected *injected = claim_memory(1, sizeof *injected);
    const struct injection_input input = {.rows = sea->rows,
                                          .columns = sea->columns,
                                          .is_complex = is_complex,
                                          .pixels = pixels,
                                          .is_whole = is_whole};
    EXPECT_OK(&sea->bench->report, injection_run(&sea->bench->report, sea->bench->tracer.device,
                                                 &sea->bench->scene, &input, NULL, NULL, result));
    claim_end(clear_result, result);
    *injected = (struct injected){.image = result->image,
                                  .field = plane_of(result, INJECTED_FIELD),
                                  .energy = plane_of(result, INJECTED_ENERGY),
                                  .visibility = plane_of(result, INJECTED_VISIBILITY),
                                  .highlight = result->highlight,
                                  .shadow = result->shadow,
                                  .labels = result->labels,
                                  .influence = result->influence,
                                  .objects = result->objects,
                                  .statistics = result->statistics,
                                  .windows = result->windows,
                                  .window_count = result->window_count};
    for (uint32_t order = 0; order < result->orders && order < CHAIN_ORDERS; order++)
        injected->order_energy[order] = plane_of(result, INJECTED_ORDER + order);
    return injected;
}

const struct injected *sea_inject(struct sea *sea, const float *pixels, bool is_complex)
{
    return inject(sea, pixels, is_complex, false);
}

const struct injected *sea_inject_whole(struct sea *sea, const float *pixels, bool is_complex)
{
    return inject(sea, pixels, is_complex, true);
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

const struct patch_level *sea_level(struct sea *sea, const float *pixels, bool is_complex)
{
    struct patch_level *level = claim_memory(1, sizeof *level);
    struct report *report = &sea->bench->report;
    struct patch_facts facts;
    EXPECT_OK(report, patch_facts_init(&facts, report, &sea->bench->scene, sea_view(sea), pixels,
                                       is_complex));
    EXPECT_OK(report, patch_level_init(level, &sea->bench->tracer, sea_view(sea), &facts, pixels,
                                       is_complex));
    claim_end(clear_level, level);
    return level;
}
