#include "inject/echoes.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/report.h"
#include "inject/chain_echoes.h"
#include "inject/object_echoes.h"
#include "inject/seabed_echoes.h"
#include "inject/traced_impulses.h"

sonject_status echo_request_tell(const struct echo_request *request, struct report *report,
                                 double fraction, const char *stage)
{
    if (request->progress && request->progress(request->user, fraction, stage))
        return report_failure(report, SONJECT_CANCELLED, "cancelled while %s", stage);
    return SONJECT_OK;
}

static sonject_status allocate_orders(struct echoes *echoes, struct tracer *tracer)
{
    const size_t pixels = echoes->rows * echoes->columns;
    if (!tracer->scene->injection.order_energies)
        return SONJECT_OK;
    echoes->orders = tracer->scene->injection.interactions;
    for (uint32_t i = 0; i < echoes->orders; i++) {
        echoes->order_energy[i] = allocate_array(pixels, sizeof(float));
        if (!echoes->order_energy[i])
            return report_out_of_memory(tracer->report, "energies of each order");
    }
    return SONJECT_OK;
}

static sonject_status allocate_planes(struct echoes *echoes, struct tracer *tracer,
                                      const struct echo_request *request)
{
    const size_t pixels = tracer->view.rows * tracer->view.columns;
    const bool wants_field = request->field != SEABED_FIELD_NONE;
    echoes->rows = tracer->view.rows;
    echoes->columns = tracer->view.columns;
    echoes->object_count = tracer->scene->object_count;
    echoes->objects = allocate_array(echoes->object_count, sizeof *echoes->objects);
    echoes->seabed_energy = allocate_array(pixels, sizeof(float));
    echoes->lost_energy = allocate_array(pixels, sizeof(float));
    echoes->target_energy = allocate_array(pixels, sizeof(float));
    echoes->energy = allocate_array(pixels, sizeof(float));
    echoes->target_real = allocate_array(pixels, sizeof(float));
    echoes->target_imaginary = allocate_array(pixels, sizeof(float));
    echoes->seabed_real = wants_field ? allocate_array(pixels, sizeof(float)) : NULL;
    echoes->seabed_imaginary = wants_field ? allocate_array(pixels, sizeof(float)) : NULL;
    echoes->coherent_real = request->wants_coherent ? allocate_array(pixels, sizeof(float)) : NULL;
    echoes->coherent_imaginary =
        request->wants_coherent ? allocate_array(pixels, sizeof(float)) : NULL;
    if (!echoes->objects || !echoes->seabed_energy || !echoes->lost_energy ||
        !echoes->target_energy || !echoes->energy || !echoes->target_real ||
        !echoes->target_imaginary ||
        (request->wants_coherent && (!echoes->coherent_real || !echoes->coherent_imaginary)) ||
        (wants_field && (!echoes->seabed_real || !echoes->seabed_imaginary)))
        return report_out_of_memory(tracer->report, "the patch");
    return allocate_orders(echoes, tracer);
}

void echoes_clear(struct echoes *echoes)
{
    for (uint32_t i = 0; echoes->objects && i < echoes->object_count; i++) {
        free(echoes->objects[i].energy);
        free(echoes->objects[i].lost);
        free(echoes->objects[i].covered);
    }
    free(echoes->objects);
    free(echoes->seabed_energy);
    free(echoes->level_energy);
    free(echoes->lost_energy);
    free(echoes->target_energy);
    free(echoes->energy);
    for (int i = 0; i < SCENE_INTERACTIONS_MAX; i++)
        free(echoes->order_energy[i]);
    free(echoes->target_real);
    free(echoes->target_imaginary);
    free(echoes->coherent_real);
    free(echoes->coherent_imaginary);
    free(echoes->seabed_real);
    free(echoes->seabed_imaginary);
    memset(echoes, 0, sizeof *echoes);
}

/* What impulses are formed with. */
struct forming {
    struct echoes *echoes;
    struct tracer *tracer;
    const struct echo_request *request;
    struct seabed_former seabed;
    struct object_former object;
    struct beam_former beam;
    struct chain_former chains;
};

static sonject_status form_set(struct forming *forming, const struct impulse_lines *lines)
{
    struct echoes *echoes = forming->echoes;
    struct tracer *tracer = forming->tracer;
    switch (lines->kind) {
    case IMPULSES_SEABED:
        return seabed_echoes_add(&forming->seabed, echoes, tracer, forming->request, lines);
    case IMPULSES_LEVEL:
        return level_seabed_add(&forming->seabed, echoes, tracer, forming->request, lines);
    case IMPULSES_OBJECT:
    case IMPULSES_GLINT:
        return object_echoes_add(&forming->object, echoes, tracer, lines);
    case IMPULSES_BEAM:
    case IMPULSES_HIDDEN:
        return beam_shadows_add(&forming->beam, echoes, tracer, lines);
    case IMPULSES_CHAINS:
        return chain_echoes_add(&forming->chains, echoes, tracer, lines);
    }
    return SONJECT_OK;
}

static sonject_status take(void *taker, const struct impulse_lines *lines)
{
    struct forming *forming = taker;
    const double start = clock_seconds();
    const sonject_status status = form_set(forming, lines);
    forming->echoes->form_s += clock_seconds() - start;
    return status;
}

static sonject_status finish(struct forming *forming)
{
    const double start = clock_seconds();
    sonject_status status =
        object_echoes_finish(&forming->object, forming->echoes, forming->tracer);
    THEN(status, chain_echoes_finish(&forming->chains, forming->echoes, forming->tracer));
    forming->echoes->form_s += clock_seconds() - start;
    return status;
}

sonject_status echoes_form(struct echoes *echoes, struct tracer *tracer,
                           const struct echo_request *request, const struct impulse_source *source)
{
    struct forming forming;
    const struct impulse_sink sink = {take, &forming};
    const double start = clock_seconds();
    memset(echoes, 0, sizeof *echoes);
    memset(&forming, 0, sizeof forming);
    forming.echoes = echoes;
    forming.tracer = tracer;
    forming.request = request;
    sonject_status status = allocate_planes(echoes, tracer, request);
    THEN(status, source->deliver(source->giver, tracer, request, &sink));
    THEN(status, finish(&forming));
    seabed_former_clear(&forming.seabed);
    object_former_clear(&forming.object);
    beam_former_clear(&forming.beam);
    chain_former_clear(&forming.chains);
    echoes->trace_s = clock_seconds() - start - echoes->form_s;
    if (status != SONJECT_OK)
        echoes_clear(echoes);
    return status;
}

sonject_status echoes_compute(struct echoes *echoes, struct tracer *tracer,
                              const struct echo_request *request)
{
    const struct impulse_source source = traced_impulses();
    return echoes_form(echoes, tracer, request, &source);
}
