/* The number of rays that an accuracy takes. */
#ifndef SONJECT_INJECT_ACCURACY_H
#define SONJECT_INJECT_ACCURACY_H

#include "inject/injection.h"

/* Two injections of the scene with half the usual number of rays each, whose random numbers are
 * their own. How far they differ tells how many rays the scene's accuracy takes. Neither depends on
 * device, shard or checkpoint, so every part of a run finds the same number. */
struct pilots {
    struct injection_result result[2]; /* without their images */
    struct scene *scene; /* the traced one, with as many rays as its accuracy takes; owned */
};

/* Where the scene that is traced asks for an accuracy, runs pilots, hands them to the input and
 * puts their scene in its place: of *scene, or of input->traced. *own is to be given to
 * pilots_clear after the last use of those; on failure it is empty. Progress stays at 0. Errors: as
 * injection_run; INPUT where the accuracy takes more rays than can be traced. */
sonject_status pilots_find(struct pilots *own, struct report *report, struct device *device,
                           const struct scene **scene, struct injection_input *input,
                           sonject_progress_function progress, void *user);
void pilots_clear(struct pilots *pilots);

/* The standard error of the expected energies of a result of the pilots' scene: over the energy and
 * the noise floor, its rms over the pixels that objects change. NaN where there are none. */
double pilots_error_of(const struct pilots *pilots, const struct injection_result *result);

#endif
