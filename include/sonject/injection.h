/* How targets are put into an image. */
#ifndef SONJECT_INJECTION_H
#define SONJECT_INJECTION_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

typedef enum sonject_injection_mode {
    SONJECT_MODE_COMPOSITE = 0, /* measured pixels outside the target's influence keep every bit */
    SONJECT_MODE_RESYNTHESISE = 1 /* the whole patch is traced anew from the reflectivity map */
} sonject_injection_mode;

/* Which column an echo of several interactions goes to. With one interaction both are the same. */
typedef enum sonject_column_rule {
    SONJECT_COLUMNS_FOCUSED = 0, /* mean along-track position of first and last hit */
    SONJECT_COLUMNS_PAPER = 1    /* the first hit's */
} sonject_column_rule;

typedef struct sonject_injection_params {
    uint32_t struct_size;
    uint32_t mode;           /* sonject_injection_mode */
    uint32_t column_rule;    /* sonject_column_rule */
    uint32_t estimate_noise; /* 1: noise floor estimated from the patch, noise_floor_db unused */
    double noise_floor_db;   /* noise energy over local mean seabed energy, dB, < 0 */
    double influence_db;     /* composite: a pixel is the target's when the change that it makes is
                                above this level over the seabed; default -40; -200...0 */
    double ray_scale;        /* factor on the number of rays; default 1; 1/64...4096 */
    uint64_t seed;
} sonject_injection_params;

/* Composite, focused columns, estimated noise, -40 dB, ray scale 1, seed 1. */
SONJECT_API void sonject_injection_params_init(sonject_injection_params *injection);

SONJECT_END_DECLARATIONS

#endif
