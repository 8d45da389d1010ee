/* Patches that need no file: uniform and synthetic seabeds. */
#ifndef SONJECT_INJECT_INPUT_PATCH_H
#define SONJECT_INJECT_INPUT_PATCH_H

#include "inject/injection.h"

/* Makes the pixels of the scene's uniform or synthetic input (its whole swath) and describes them
 * in *input. input->pixels is to be given to free(). Errors: MEMORY. */
sonject_status make_input(struct report *report, const struct scene *scene,
                          struct injection_input *input);

#endif
