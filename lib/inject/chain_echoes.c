#include "inject/chain_echoes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "inject/seabed_echoes.h"

static bool is_brute_force(const struct tracer *tracer)
{
    return tracer->scene->injection.estimator == SONJECT_ESTIMATOR_BRUTE_FORCE;
}

/* A plane of energies on the grid to the patch. */
static sonject_status form_energies(const struct line_grid *grid, struct tracer *tracer,
                                    const float *energy, float *formed)
{
    struct form_lines energies;
    struct impulse_lines lines = {IMPULSES_CHAINS, 0, *grid, grid->strips, 1, {energy}};
    memset(&energies, 0, sizeof energies);
    const sonject_status status =
        form_energies_as_they_come(&energies, tracer, &tracer->response, &lines, formed);
    form_lines_end(&energies);
    return status;
}

static sonject_status draw_speckle(const struct line_grid *grid, struct tracer *tracer,
                                   const float *energy, float *real_part, float *imaginary_part)
{
    struct form_lines lines;
    CHECK(form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view, &tracer->response,
                           FORM_SPECKLE, grid));
    sonject_status status =
        form_lines_add_speckle(&lines, grid->strips.first, grid->strips.count, energy,
                               tracer->scene->injection.seed, STREAM_CHAIN_SPECKLE);
    THEN(status, form_lines_finish(&lines, real_part, imaginary_part));
    form_lines_end(&lines);
    return status;
}

static void add_plane(float *sum, const float *plane, size_t count)
{
    for (size_t i = 0; i < count; i++)
        sum[i] += plane[i];
}

void chain_former_clear(struct chain_former *former)
{
    free(former->sum);
    memset(former, 0, sizeof *former);
}

sonject_status chain_echoes_add(struct chain_former *former, struct echoes *echoes,
                                struct tracer *tracer, const struct impulse_lines *lines)
{
    const size_t cells = line_grid_cells(&lines->grid);
    float *kept = echoes->order_energy[lines->number - 1];
    sonject_status status = SONJECT_OK;
    if (!former->sum) {
        former->grid = lines->grid;
        former->sum = allocate_array(cells, sizeof(float));
    }
    CHECK_MEMORY(tracer->report, former->sum, "multiple interactions");
    if (kept)
        status = form_energies(&former->grid, tracer, lines->plane[0], kept);
    add_plane(former->sum, lines->plane[0], cells);
    return status;
}

/* Planes of the size of the patch. */
struct chain_image {
    float *energy, *real_part, *imaginary_part;
};

static void add_to_image(const struct chain_image *image, struct echoes *echoes,
                         bool replaces_seabed)
{
    const size_t pixels = echoes->rows * echoes->columns;
    if (replaces_seabed) {
        memcpy(echoes->seabed_real, image->real_part, pixels * sizeof(float));
        memcpy(echoes->seabed_imaginary, image->imaginary_part, pixels * sizeof(float));
        add_plane(echoes->energy, image->energy, pixels);
        return;
    }
    add_plane(echoes->target_energy, image->energy, pixels);
    add_plane(echoes->energy, image->energy, pixels);
    add_plane(echoes->target_real, image->real_part, pixels);
    add_plane(echoes->target_imaginary, image->imaginary_part, pixels);
}

/* What one interaction brings: the energy of the objects' echoes, and of the seabed in view. By
 * brute force the chains bring it anew, all but the glints. */
static void copy_first_order(struct echoes *echoes, const struct tracer *tracer)
{
    for (size_t i = 0; i < echoes->rows * echoes->columns; i++) {
        const float in_view = fmaxf(0.0f, echoes->seabed_energy[i] - echoes->lost_energy[i]);
        echoes->energy[i] = is_brute_force(tracer) ? 0.0f : echoes->target_energy[i] + in_view;
    }
    if (echoes->order_energy[0] && !is_brute_force(tracer))
        memcpy(echoes->order_energy[0], echoes->energy,
               echoes->rows * echoes->columns * sizeof(float));
}

sonject_status chain_echoes_finish(struct chain_former *former, struct echoes *echoes,
                                   struct tracer *tracer)
{
    const size_t pixels = echoes->rows * echoes->columns;
    copy_first_order(echoes, tracer);
    if (!former->sum)
        return SONJECT_OK;
    struct chain_image image = {allocate_array(pixels, sizeof(float)),
                                allocate_array(pixels, sizeof(float)),
                                allocate_array(pixels, sizeof(float))};
    sonject_status status = image.energy && image.real_part && image.imaginary_part
                                ? SONJECT_OK
                                : report_out_of_memory(tracer->report, "multiple interactions");
    THEN(status, form_energies(&former->grid, tracer, former->sum, image.energy));
    THEN(status,
         draw_speckle(&former->grid, tracer, former->sum, image.real_part, image.imaginary_part));
    if (status == SONJECT_OK)
        add_to_image(&image, echoes, is_brute_force(tracer));
    free(image.energy);
    free(image.real_part);
    free(image.imaginary_part);
    return status;
}
