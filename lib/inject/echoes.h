/* What the patch would return: traced, formed, in cross-section units (m^2 and m). */
#ifndef SONJECT_INJECT_ECHOES_H
#define SONJECT_INJECT_ECHOES_H

#include <stdint.h>

#include "base/report.h"
#include "inject/impulses.h"
#include "trace/tracer.h"

/* One object's part, on a window of columns (all rows). */
struct object_echo {
    size_t first_column, columns;
    float *energy;                    /* expected cross-section, rough and smooth part, m^2 */
    float *lost;                      /* seabed energy that it hides, m^2 */
    uint8_t *covered;                 /* 1 where some ray of that pixel hit it */
    double peak_energy, peak_range_m; /* of its echo, wherever pixels lie: m^2, 0 where there is
                                         none, and the processor range where it is */
};

/* Everything is rows x columns of the view unless said otherwise. Owned. */
struct echoes {
    size_t rows, columns;
    float *seabed_energy; /* expected without objects, m^2 */
    float *level_energy;  /* expected without objects and relief; NULL: there is no relief */
    float *lost_energy;   /* of it, hidden by objects */
    float *target_energy; /* expected from all objects */
    float *target_real, *target_imaginary;     /* one realisation, m */
    float *coherent_real, *coherent_imaginary; /* the part of it that is the same in every look:
                                                  glints; NULL if unwanted */
    float *seabed_real,
        *seabed_imaginary; /* one realisation of what is in view; NULL if unwanted */
    float *energy;         /* expected from everything that was traced */
    /* Expected from paths of k interactions at [k - 1], k <= orders; NULL unless the scene asks for
     * them. */
    float *order_energy[SCENE_INTERACTIONS_MAX];
    uint32_t orders;
    struct object_echo *objects;
    uint32_t object_count;
    double trace_s, form_s; /* wall clock; trace_s: of the impulses' source */
};

/* How the seabed's realisation is drawn. */
enum seabed_field {
    SEABED_FIELD_NONE,
    SEABED_FIELD_SPECKLE, /* complex normal deviates */
    SEABED_FIELD_COHERENT /* the measured complex reflectivity */
};

struct echo_request {
    const float *map; /* reflectivity over mu0, or NULL */
    enum seabed_field field;
    const float *reflectivity_real, *reflectivity_imaginary; /* COHERENT: unit mean square */
    sonject_progress_function progress;                      /* may be NULL */
    void *user;
    bool wants_coherent; /* keep the coherent part of the targets' echoes */
};

/* Progress of the stages, as fractions of a run: the seabed, the objects, several interactions. */
#define ROUGH_SHARE  0.4
#define OBJECT_SHARE 0.25
#define CHAINS_SHARE 0.3

/* Tells the caller how far the work is. Errors: CANCELLED, if that says so. */
sonject_status echo_request_tell(const struct echo_request *request, struct report *report,
                                 double fraction, const char *stage);

/* Forms all of it from impulses as they come. On failure *echoes is empty. Errors: DEVICE, MEMORY,
 * and the source's own. */
sonject_status echoes_form(struct echoes *echoes, struct tracer *tracer,
                           const struct echo_request *request, const struct impulse_source *source);

/* The same from rays: traces and forms. Errors: INPUT, DEVICE, MEMORY, CANCELLED. */
sonject_status echoes_compute(struct echoes *echoes, struct tracer *tracer,
                              const struct echo_request *request);
void echoes_clear(struct echoes *echoes);

/* Rows and columns of a view. */
struct window {
    size_t first_row, rows, first_column, columns;
};

/* A field of complex normal deviates of unit mean square with the sonar's point response, in two
 * planes of rows x columns of the view. Only the window is filled; its values do not depend on the
 * window's size. Errors: DEVICE, MEMORY. */
sonject_status coloured_noise(struct tracer *tracer, uint32_t stream, const struct window *window,
                              float *real_part, float *imaginary_part);

#endif
