/* The echoes that the patch would return: traced, formed, in cross-section units (m^2 and m). */
#ifndef SONJECT_INJECT_ECHOES_H
#define SONJECT_INJECT_ECHOES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/report.h"
#include "form/form.h"
#include "inject/impulses.h"
#include "trace/tracer.h"

/* One object's part in a window of columns (all rows). */
struct object_echo {
    size_t first_column, columns;
    float *energy;                    /* expected cross-section, rough and smooth part, m^2 */
    float *lost;                      /* seabed energy that the object hides, m^2 */
    uint8_t *covered;                 /* 1 where some ray of the pixel hit the object */
    size_t lobe_rows, lobe_columns;   /* pixels from these that the echo's main lobe may reach */
    double peak_energy, peak_range_m; /* peak of the echo, between pixels too: m^2, 0 if none, and
                                         its processor range */
};

/* The formed echoes. Planes have rows x columns of the view unless said otherwise. */
struct echoes {
    size_t rows, columns;
    void *memory;         /* memory of all planes but order_energy; owned */
    float *seabed_energy; /* expected without objects, m^2 */
    float *level_energy;  /* expected without objects and relief; NULL: there is no relief */
    float *lost_energy;   /* part of seabed_energy that objects hide */
    float *target_energy; /* expected from all objects */
    float *target_real, *target_imaginary;     /* one realisation, m; holds speckle and glints */
    float *coherent_real, *coherent_imaginary; /* the glints in it, which are the same in every
                                                  look; NULL if unwanted */
    float *seabed_real,
        *seabed_imaginary; /* one realisation of the visible seabed; NULL if unwanted */
    float *energy;         /* expected from everything that was traced */
    /* Expected energy from paths of k interactions at [k - 1], k <= orders; each owned; NULL unless
     * the scene asks for it. */
    float *order_energy[SCENE_INTERACTIONS_MAX];
    uint32_t orders;
    struct object_echo *objects; /* owned, with all their members */
    uint32_t object_count;
    double trace_s, form_s; /* wall clock; trace_s: time in the impulses' source */
};

/* The way in which the seabed's realisation is drawn. */
enum seabed_field {
    SEABED_FIELD_NONE,
    SEABED_FIELD_SPECKLE, /* complex normal deviates */
    SEABED_FIELD_COHERENT /* the measured complex reflectivity */
};

struct echo_request {
    const float *map; /* reflectivity over mu0, or NULL */
    enum seabed_field field;
    const float *reflectivity_real, *reflectivity_imaginary; /* COHERENT: unit mean square */
    sonject_progress_function progress;                      /* progress may be NULL */
    void *user;
    bool wants_coherent; /* keeps the coherent part of the targets' echoes */
};

/* The shares of a run's progress that stages take: seabed, objects, several interactions. */
#define ROUGH_SHARE  0.4
#define OBJECT_SHARE 0.25
#define CHAINS_SHARE 0.3

/* Tells the caller how far the work is. Errors: CANCELLED, if the caller asks for that. */
sonject_status echo_request_tell(const struct echo_request *request, struct report *report,
                                 double fraction, const char *stage);

/* Forms all echoes from impulses as they come. Rays are those of `traced`: the tracer itself, or
 * one of another response. Nothing is formed where a checkpoint cuts the tracing short. On failure
 * *echoes is empty. Errors: DEVICE, MEMORY, and those of trace_impulses. */
sonject_status echoes_form(struct echoes *echoes, struct tracer *tracer,
                           const struct echo_request *request, struct tracer *traced,
                           const struct echo_request *of_traced);

void echoes_clear(struct echoes *echoes);

/* Returns the reflectivity that the seabed's energies are traced with. With relief a composite
 * takes an even one, so that the ratio of two energies is that of geometry, not of the speckle of
 * two places. The formed energies get the map's pattern afterwards. */
const float *seabed_map(const struct tracer *tracer, const struct echo_request *request);

/* Returns whether shadows are found within the beam: the sonar has a real aperture, and the seabed
 * is level. Shadows over relief keep to lines from broadside. */
bool has_beam_shadows(const struct tracer *tracer);

/* Sets up a response that keeps rows apart, so that a ping's energies are its row's. */
void response_of_pings(struct point_response *response, const struct tracer *tracer);

/* Returns complex amplitudes of the lines of SEABED, from the measured complex reflectivity: its
 * own phases instead of new speckle. An amplitude is the root of the mean energy in view there
 * times the reflectivity of the bin's pixel. The scale keeps the image's mean energy
 * what speckle would give. The result has two planes, for free(); NULL where memory is out. */
float *coherent_seabed_lines(const struct tracer *tracer, const struct echo_request *request,
                             const struct impulse_lines *lines);

/* A lattice of points, finer than the point response, on which lines are formed again. */
struct peak_lattice {
    struct patch_view view;  /* view whose pixels are the points */
    struct line_grid grid;   /* strips and bins between points, and those at its corner */
    struct form_lines lines; /* lines that are being formed */
    float *planes;           /* two planes of view.rows x view.columns; owned; NULL: no echo */
};

/* An object's echoes by one interaction, in the making. Rough surfaces and glints come as sets. */
struct object_former {
    bool is_open;
    uint32_t number;
    struct line_grid grid; /* grid of the object's tile */
    float *rough_energy;   /* the tile's; NULL: no realisation is drawn */
    float *glint;          /* field of the object's parts, which interfere: two planes of all rows.
                              Columns are those of the echo, or all where multi-bounce paths may lead
                              farther; owned */
    size_t first_column, columns;
    struct span glint_rows;  /* rows outside which the field is 0 */
    struct form_lines lines; /* lines of the glints or multi-bounce echoes that come in */
    struct peak_lattice glint_peak, rough_peak;
};

/* Takes lines of OBJECT, GLINT and MULTIBOUNCE. The next OBJECT finishes the one before, and
 * object_echoes_finish the last. Errors: DEVICE, MEMORY. */
sonject_status object_echoes_add(struct object_former *former, struct echoes *echoes,
                                 struct tracer *tracer, const struct impulse_lines *lines);
sonject_status object_echoes_finish(struct object_former *former, struct echoes *echoes,
                                    struct tracer *tracer);
void object_former_clear(struct object_former *former);

/* Formed pixels, both planes in one array. */
struct formed {
    float *planes;    /* owned */
    struct window at; /* the view's pixels that they hold */
    size_t count;     /* pixels of one plane */
};

/* Combines all lines into *formed and ends them. The caller frees the planes by free(). Errors:
 * DEVICE, MEMORY. */
sonject_status form_end(struct form_lines *lines, struct formed *formed);

/* Adds formed pixels to a plane of all of the view's pixels. */
void echoes_add_window(float *patch, const struct echoes *echoes, const float *window,
                       const struct window *at);

/* Adds both parts of formed pixels to a field of all of the view's pixels. */
void echoes_add_field(const struct echoes *echoes, const struct formed *formed, float *real_part,
                      float *imaginary_part);

/* Forms a realisation of energies on a grid: sqrt(energy) times complex normal deviates. Errors:
 * DEVICE, MEMORY. */
sonject_status form_speckle(struct tracer *tracer, const struct line_grid *grid,
                            const float *energy, uint32_t stream, struct formed *formed);

#endif
