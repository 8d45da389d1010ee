#include "base/fourier.h"

#include <math.h>

#define PI 3.14159265358979323846

void fourier_roots(double *root_real, double *root_imaginary, size_t count)
{
    for (size_t m = 0; m < count / 2; m++) {
        root_real[m] = cos(2.0 * PI * (double)m / (double)count);
        root_imaginary[m] = sin(2.0 * PI * (double)m / (double)count);
    }
}

static void swap(double *values, size_t a, size_t b)
{
    const double value = values[a];
    values[a] = values[b];
    values[b] = value;
}

/* Puts each element where its number's bits, reversed, say. */
static void reverse_bits(double *real_part, double *imaginary_part, size_t count)
{
    size_t reversed = 0;
    for (size_t i = 1; i < count; i++) {
        size_t bit = count / 2;
        for (; reversed & bit; bit /= 2)
            reversed ^= bit;
        reversed ^= bit;
        if (i < reversed) {
            swap(real_part, i, reversed);
            swap(imaginary_part, i, reversed);
        }
    }
}

void fourier_transform(double *real_part, double *imaginary_part, size_t count,
                       const double *root_real, const double *root_imaginary)
{
    reverse_bits(real_part, imaginary_part, count);
    for (size_t half = 1; half < count; half *= 2) {
        const size_t stride = count / (2 * half); /* of the roots */
        for (size_t start = 0; start < count; start += 2 * half)
            for (size_t i = 0; i < half; i++) {
                const size_t low = start + i;
                const size_t high = low + half;
                const double c = root_real[i * stride];
                const double s = root_imaginary[i * stride];
                const double a = real_part[high] * c - imaginary_part[high] * s;
                const double b = real_part[high] * s + imaginary_part[high] * c;
                real_part[high] = real_part[low] - a;
                imaginary_part[high] = imaginary_part[low] - b;
                real_part[low] += a;
                imaginary_part[low] += b;
            }
    }
}
