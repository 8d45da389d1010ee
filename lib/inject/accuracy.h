/* The number of rays that an accuracy takes. */
#ifndef SONJECT_INJECT_ACCURACY_H
#define SONJECT_INJECT_ACCURACY_H

#include "inject/injection.h"

/* Two injections of the scene with half the usual number of rays each, and random numbers of their
 * own. Their difference tells how many rays the scene's accuracy takes. The pilots do not depend on
 * device, shard or checkpoint, so every part of a run finds the same number. */
struct pilots {
    struct injection_result result[2]; /* without their images */
    struct scene *scene; /* the traced scene, with the rays that its accuracy takes; owned */
};

/* Runs pilots if the scene that is traced asks for an accuracy, that is, *scene or input->traced.
 * Hands the pilots to the input and replaces that scene by theirs. The caller gives *own to
 * pilots_clear after the last use of both; on failure it is empty. Progress stays at 0. Errors: as
 * injection_run; INPUT where the accuracy takes more rays than can be traced. */
sonject_status pilots_find(struct pilots *own, struct report *report, struct device *device,
                           const struct scene **scene, struct injection_input *input,
                           sonject_progress_function progress, void *user);
void pilots_clear(struct pilots *pilots);

/* Returns the standard error of the expected energies of a result of the pilots' scene: relative to
 * energy and noise floor, rms over the pixels that objects change. NaN if there are none. */
double pilots_error_of(const struct pilots *pilots, const struct injection_result *result);

#endif
