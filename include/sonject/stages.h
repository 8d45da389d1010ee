/* The two stages of a run apart: tracing, whose sums go to a file, and forming images of them,
 * as often as wanted, also with another pulse, bandwidth or cross-range response. */
#ifndef SONJECT_STAGES_H
#define SONJECT_STAGES_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/scene.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* Traces the scene and writes what rays added up to the file, for sonject_form. It appears whole or
 * not at all, and keeps the scene's text, and the names of the files that it names, but not these:
 * they, and the input image, are needed again; of a scene with tables in memory it keeps no text.
 * Errors: ARGUMENT, INPUT, DEVICE, STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
SONJECT_API sonject_status sonject_trace(sonject_context *context, const sonject_scene *scene,
                                         const char *file, sonject_progress_function progress,
                                         void *user);

typedef struct sonject_form_params {
    uint32_t struct_size;
    uint32_t override_count;
    const char *file;             /* that sonject_trace wrote */
    const char *folder;           /* for the results; made where missing */
    const char *const *overrides; /* of the scene whose text the file keeps, "key.path=value" of
                                     sonar.bandwidth, .pulse, .resolution, .response,
                                     .measured_response and .motion, what is below these, and
                                     input.path (the same image elsewhere); no other key */
    uint32_t labels;              /* as of sonject_run_params */
    uint32_t overwrites;          /* as of sonject_run_params */
} sonject_form_params;

/* Forms the image of the scene that was traced, or of `scene`, which then may differ in the
 * same keys unless the file keeps no text (NULL: the scene of that text), and writes into
 * params->folder what sonject_run would: with nothing overridden every file is the same byte for
 * byte, but for times and memory in run.json. A bandwidth may be at most the one that was traced
 * and not much below a third of it, a resolution no finer than that one: trace at the largest
 * bandwidth that is wanted. The measured pixels stay as they are. Against a run at the other
 * bandwidth the rays are the same only where that lays the same fine grid (lib/scene/patch_view.h);
 * else energies differ by the noise of two sets of rays, and the outermost pixels lack up to 2 % of
 * their energy. Errors: ARGUMENT, INPUT (not such a file, damaged, of another version, of another
 * scene or image; traced on a machine of another kind, whose mathematics differ; a key or value
 * that needs a new trace), DEVICE, STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
SONJECT_API sonject_status sonject_form(sonject_context *context, const sonject_scene *scene,
                                        const sonject_form_params *params,
                                        sonject_progress_function progress, void *user,
                                        int *was_finished);

SONJECT_END_DECLARATIONS

#endif
