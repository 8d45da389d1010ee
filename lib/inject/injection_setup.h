/* What tracing and forming of a patch begin with: the scene laid out on it, what is asked of its
 * seabed, and the pixels of patches that need no file: uniform and synthetic seabeds. */
#ifndef SONJECT_INJECT_INJECTION_SETUP_H
#define SONJECT_INJECT_INJECTION_SETUP_H

#include "inject/echoes.h"
#include "inject/injection.h"
#include "inject/patch_level.h"

/* Makes the pixels of the scene's uniform or synthetic input (its whole swath) and describes them
 * in *input. input->pixels is to be given to free(). Errors: MEMORY. */
sonject_status make_input(struct report *report, const struct scene *scene,
                          struct injection_input *input);

/* Reverses the order of rows in place; scratch holds one row. */
void flip_rows(void *plane, size_t rows, size_t row_bytes, char *scratch);

/* Patch and scene, ready for rays or for impulses. */
struct injection_setup {
    struct placements placements;
    struct water water;
    struct tracer tracer;
    float *pixels; /* in the view's row order */
    char *scratch; /* a row of the widest layer, the field */
};

/* Lays the scene out without the pixels, which stay NULL: geometry, water, objects, response.
 * device may be NULL where no ray follows. All that is wrong is told, a line each. To be given to
 * injection_setup_clear, also on failure. Errors: INPUT, MEMORY. */
sonject_status injection_setup_init_scene(struct injection_setup *setup, struct report *report,
                                          struct device *device, const struct scene *scene,
                                          const struct injection_input *input);

/* The same with the pixels. */
sonject_status injection_setup_init(struct injection_setup *setup, struct report *report,
                                    struct device *device, const struct scene *scene,
                                    const struct injection_input *input);
void injection_setup_clear(struct injection_setup *setup);

/* What echoes are asked for, from the measured patch. */
struct patch_request {
    struct patch_level level;
    float *real_part, *imaginary_part; /* of the coherent map; NULL: none */
    struct echo_request request;
};

/* pixels: in the view's row order. On success to be given to patch_request_clear; on failure
 * nothing is held. Errors: INPUT, MEMORY. */
sonject_status patch_request_init(struct patch_request *patch, struct tracer *tracer,
                                  const float *pixels, bool is_complex,
                                  sonject_progress_function progress, void *user);
void patch_request_clear(struct patch_request *patch);

#endif
