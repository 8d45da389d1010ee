#include "inject/echoes.h"

#include <stdlib.h>

#include "base/memory.h"
#include "form/form.h"

sonject_status coloured_noise(struct tracer *tracer, uint32_t stream, float *real_part,
                              float *imaginary_part)
{
    struct line_grid grid;
    line_grid_for_patch(&grid, &tracer->view, &tracer->response);
    const double cell = tracer->view.row_spacing_m / grid.strips_per_row *
                        tracer->view.column_spacing_m / grid.bins_per_pixel;
    const float energy = (float)(cell / (along_track_energy_width(&tracer->response) *
                                         range_energy_width(&tracer->response)));
    const int32_t chunk = 256;
    float *energies = allocate_array((size_t)chunk * (size_t)grid.bins.count, sizeof *energies);
    if (!energies)
        return report_out_of_memory(tracer->report, "noise");
    for (size_t i = 0; i < (size_t)chunk * (size_t)grid.bins.count; i++)
        energies[i] = energy;
    struct form_lines lines;
    sonject_status status = form_lines_begin(&lines, tracer->report, tracer->device, &tracer->view,
                                             &tracer->response, FORM_SPECKLE, &grid);
    if (status == SONJECT_OK) {
        for (int32_t done = 0; status == SONJECT_OK && done < grid.strips.count; done += chunk)
            status = form_lines_add_speckle(
                &lines, grid.strips.first + done,
                grid.strips.count - done < chunk ? grid.strips.count - done : chunk, energies,
                tracer->scene->injection.seed, stream);
        if (status == SONJECT_OK)
            status = form_lines_finish(&lines, real_part, imaginary_part);
        form_lines_end(&lines);
    }
    free(energies);
    return status;
}
