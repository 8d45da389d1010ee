#include "inject/seabed_echoes.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "inject/coherent_seabed.h"

sonject_status form_energies_as_they_come(struct form_lines *energies, struct tracer *tracer,
                                          const struct point_response *response,
                                          const struct impulse_lines *lines, float *formed)
{
    sonject_status status = SONJECT_OK;
    if (impulse_lines_begin(lines))
        status = form_lines_begin(energies, tracer->report, tracer->device, &tracer->view, response,
                                  FORM_ENERGY, &lines->grid);
    THEN(status,
         form_lines_add(energies, lines->strips.first, lines->strips.count, lines->plane[0], NULL));
    if (status != SONJECT_OK || !impulse_lines_end(lines))
        return status;
    status = form_lines_finish(energies, formed, NULL);
    form_lines_end(energies);
    return status;
}

/* The measured complex reflectivity with the energies that are in view. */
static sonject_status add_coherent(struct seabed_former *former, struct tracer *tracer,
                                   const struct echo_request *request,
                                   const struct impulse_lines *lines)
{
    const size_t cells = (size_t)lines->strips.count * (size_t)lines->grid.bins.count;
    free(former->in_view);
    free(former->imaginary);
    former->in_view = allocate_array(cells, sizeof(float));
    former->imaginary = allocate_array(cells, sizeof(float));
    if (!former->in_view || !former->imaginary)
        return report_out_of_memory(tracer->report, "the seabed");
    memcpy(former->in_view, lines->plane[1], cells * sizeof(float));
    coherent_seabed_lines(&lines->grid, tracer, lines->strips, request->reflectivity_real,
                          request->reflectivity_imaginary, former->in_view, former->imaginary);
    return form_lines_add(&former->field, lines->strips.first, lines->strips.count, former->in_view,
                          former->imaginary);
}

static sonject_status take_field(struct seabed_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct echo_request *request,
                                 const struct impulse_lines *lines)
{
    sonject_status status = SONJECT_OK;
    if (impulse_lines_begin(lines))
        status = form_lines_begin(&former->field, tracer->report, tracer->device, &tracer->view,
                                  &tracer->response, FORM_SPECKLE, &lines->grid);
    if (status == SONJECT_OK)
        status = request->field == SEABED_FIELD_COHERENT
                     ? add_coherent(former, tracer, request, lines)
                     : form_lines_add_speckle(&former->field, lines->strips.first,
                                              lines->strips.count, lines->plane[1],
                                              tracer->scene->injection.seed, STREAM_SEABED_SPECKLE);
    if (status == SONJECT_OK && impulse_lines_end(lines)) {
        status = form_lines_finish(&former->field, echoes->seabed_real, echoes->seabed_imaginary);
        form_lines_end(&former->field);
    }
    return status;
}

sonject_status seabed_echoes_take(struct seabed_former *former, struct echoes *echoes,
                                  struct tracer *tracer, const struct echo_request *request,
                                  const struct impulse_lines *lines)
{
    sonject_status status = form_energies_as_they_come(&former->energies, tracer, &tracer->response,
                                                       lines, echoes->seabed_energy);
    if (status == SONJECT_OK && request->field != SEABED_FIELD_NONE)
        status = take_field(former, echoes, tracer, request, lines);
    return status;
}

void seabed_former_clear(struct seabed_former *former)
{
    form_lines_end(&former->energies);
    form_lines_end(&former->field);
    free(former->in_view);
    free(former->imaginary);
    memset(former, 0, sizeof *former);
}
