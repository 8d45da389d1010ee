/* What the patch would return: traced, formed, in cross-section units (m^2 and m). */
#ifndef SONJECT_INJECT_ECHOES_H
#define SONJECT_INJECT_ECHOES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"
#include "form/form.h"
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

/* Everything is rows x columns of the view unless said otherwise. */
struct echoes {
    size_t rows, columns;
    void *memory;         /* of the planes but for those of orders; owned */
    float *seabed_energy; /* expected without objects, m^2 */
    float *level_energy;  /* expected without objects and relief; NULL: there is no relief */
    float *lost_energy;   /* of seabed_energy, hidden by objects */
    float *target_energy; /* expected from all objects */
    float *target_real, *target_imaginary;     /* one realisation, m */
    float *coherent_real, *coherent_imaginary; /* the part of it that is the same in every look:
                                                  glints; NULL if unwanted */
    float *seabed_real,
        *seabed_imaginary; /* one realisation of what is in view; NULL if unwanted */
    float *energy;         /* expected from everything that was traced */
    /* Expected from paths of k interactions at [k - 1], k <= orders; NULL unless the scene asks for
     * them; each owned. */
    float *order_energy[SCENE_INTERACTIONS_MAX];
    uint32_t orders;
    struct object_echo *objects; /* owned, as all in them */
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

/* Forms all of it from impulses as they come, by rays of `traced`: the tracer itself, or one of
 * another response. Where its checkpoint is cut short, nothing is formed. On failure *echoes is
 * empty. Errors: DEVICE, MEMORY, and those of trace_impulses. */
sonject_status echoes_form(struct echoes *echoes, struct tracer *tracer,
                           const struct echo_request *request, struct tracer *traced,
                           const struct echo_request *of_traced);

void echoes_clear(struct echoes *echoes);

/* The reflectivity that the seabed's energies are traced with. With relief a composite takes an
 * even one: the ratio of two energies is then that of geometry, not of the speckle of two places;
 * the map's pattern is given to the formed energies. */
const float *seabed_map(const struct tracer *tracer, const struct echo_request *request);

/* Whether the scene's shadows are found within the beam: its sonar has a real aperture, over a
 * level seabed. Shadows over relief keep to lines from broadside. */
bool has_beam_shadows(const struct tracer *tracer);

/* A response that keeps rows apart: a ping's energies are its row's as they are. */
void response_of_pings(struct point_response *response, const struct tracer *tracer);

/* The seabed as a measured complex reflectivity: its own phases instead of new speckle. Complex
 * amplitudes of lines of SEABED, whose second plane is what is in view: the root of that energy
 * times the reflectivity of the bin's pixel, scaled so that the image's mean energy stays what
 * speckle would give. Two planes in one array for free(); NULL where memory lacks. */
float *coherent_seabed_lines(const struct tracer *tracer, const struct echo_request *request,
                             const struct impulse_lines *lines);

/* Where lines are formed once more: a lattice of points that is finer than the point response. */
struct peak_lattice {
    struct patch_view view;  /* whose pixels are the points */
    struct line_grid grid;   /* of the lines that it was laid on, as that view counts them */
    struct form_lines lines; /* that are being formed */
    float *planes;           /* two of view.rows x view.columns; owned; NULL: no echo */
};

/* What objects return by one interaction, in the making: that object's rough surfaces and glints
 * whose sets come in. */
struct object_former {
    bool is_open;
    uint32_t number;
    struct line_grid grid; /* of its tile */
    float *rough_energy;   /* of the tile; NULL: no realisation of it is drawn */
    float *glint; /* of its parts, which interfere: two planes of all rows and these columns, those
                     of its echo or all where multi-bounce paths may lead farther; owned */
    size_t first_column, columns;
    struct form_lines lines; /* of the glints or multi-bounce echoes that come in */
    struct peak_lattice glint_peak, rough_peak;
};

/* Takes lines of OBJECT, GLINT and MULTIBOUNCE. The next OBJECT finishes the one before;
 * object_echoes_finish the last. Errors: DEVICE, MEMORY. */
sonject_status object_echoes_add(struct object_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct impulse_lines *lines);
sonject_status object_echoes_finish(struct object_former *former, struct echoes *echoes,
                                    struct tracer *tracer);
void object_former_clear(struct object_former *former);

/* Formed pixels, both planes in one array. */
struct formed {
    float *planes;                       /* owned */
    size_t first_column, columns, count; /* count: of one plane, all rows */
};

/* Combines all lines into *formed, whose planes are the caller's for free(), and ends them. Errors:
 * DEVICE, MEMORY. */
sonject_status form_end(struct form_lines *lines, struct formed *formed);

/* Forms a realisation of energies on a grid: sqrt(energy) times complex normal deviates. Errors:
 * DEVICE, MEMORY. */
sonject_status form_speckle(struct tracer *tracer, const struct line_grid *grid,
                            const float *energy, uint32_t stream, struct formed *formed);

#endif
