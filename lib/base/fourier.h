/* The discrete Fourier transform, in double precision. */
#ifndef SONJECT_BASE_FOURIER_H
#define SONJECT_BASE_FOURIER_H

#include <stddef.h>

/* Replaces a sequence by sum over m of a[m] exp(+2 pi i m n / count), in place. count: a power of
 * two. roots: count / 2 complex numbers as fourier_roots makes them; both planes real, imaginary.
 */
void fourier_transform(double *real_part, double *imaginary_part, size_t count,
                       const double *root_real, const double *root_imaginary);

/* exp(+2 pi i m / count), m from 0 to count / 2 - 1. */
void fourier_roots(double *root_real, double *root_imaginary, size_t count);

#endif
