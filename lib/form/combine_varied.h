/* The cross-range response where it is not one real function: complex (a measured one), another at
 * each range (a real aperture), or another for each row (residual motion). */
#ifndef SONJECT_FORM_COMBINE_VARIED_H
#define SONJECT_FORM_COMBINE_VARIED_H

#include "form/form.h"

/* Combines all lines into two planes of rows x stride floats. Errors: DEVICE, MEMORY. */
sonject_status combine_varied(struct form_lines *lines, device_buffer real_out,
                              device_buffer imaginary_out);

#endif
