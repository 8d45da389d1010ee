/* The two stages of a run. Tracing writes its sums to a file. Forming makes images of them as often
 * as wanted, also with another pulse, bandwidth or cross-range response. */
#ifndef SONJECT_STAGES_H
#define SONJECT_STAGES_H

#include <stddef.h>
#include <stdint.h>

#include <sonject/export.h>
#include <sonject/scene.h>
#include <sonject/status.h>

SONJECT_BEGIN_DECLARATIONS

/* Traces the scene and writes the sums over all rays to the file, for sonject_form. The file
 * appears whole or not at all. It keeps the scene's text (not if tables are in memory) and the
 * names of the scene's files, but not these files: they and the input image are needed again.
 * Errors: ARGUMENT, INPUT, DEVICE, STORAGE, MEMORY, UNSUPPORTED, CANCELLED. */
SONJECT_API sonject_status sonject_trace(sonject_context *context, const sonject_scene *scene,
                                         const char *file, sonject_progress_function progress,
                                         void *user);

typedef struct sonject_form_params {
    uint32_t struct_size;
    uint32_t override_count;
    const char *file;   /* file that sonject_trace wrote */
    const char *folder; /* folder for the results; created if missing */
    const char *const
        *overrides;  /* "key.path=value" for the scene whose text the file keeps: sonar.bandwidth,
                        .pulse, .resolution, .response, .measured_response and .motion, keys below
                        these, and input.path (the same image elsewhere); no other key */
    uint32_t labels; /* see sonject_run_params */
    uint32_t overwrites; /* see sonject_run_params */
} sonject_form_params;

/* Forms the image and writes into params->folder the files that sonject_run would. scene: NULL for
 * the scene whose text the file keeps, or another, which may differ from the traced one in the keys
 * of the overrides (only if the file keeps a text). With nothing overridden every file is the same
 * byte for byte, except for times and memory in run.json. The bandwidth may be at most the traced
 * one and not much below a third of it, and the resolution no finer, so trace at the largest
 * bandwidth wanted. Measured pixels stay as they are. Compared with a run at the other bandwidth,
 * the rays are the same only if that run has the same fine grid (lib/scene/patch_view.h). Otherwise
 * energies differ by the noise of two sets of rays, and the outermost pixels lack up to 2 % of
 * their energy. Shadows and rough highlights keep the aspects that were traced; a note says so if
 * the resolution or the response has others. Errors: ARGUMENT, INPUT (not such a file, damaged, of
 * another version, of another scene or image; traced on a machine of another kind, whose
 * mathematics differ; a key or value that needs a new trace), DEVICE, STORAGE, MEMORY, UNSUPPORTED,
 * CANCELLED. */
SONJECT_API sonject_status sonject_form(sonject_context *context, const sonject_scene *scene,
                                        const sonject_form_params *params,
                                        sonject_progress_function progress, void *user,
                                        int *was_finished);

SONJECT_END_DECLARATIONS

#endif
