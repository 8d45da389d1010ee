/* How targets are put into an image. */
#ifndef SONJECT_INJECTION_H
#define SONJECT_INJECTION_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

/* Whether objects are composed into the patch, or the whole patch is traced anew. */
typedef enum sonject_injection_mode {
    SONJECT_MODE_COMPOSITE = 0, /* measured pixels outside the target's influence keep every bit */
    SONJECT_MODE_RESYNTHESISE = 1 /* the whole patch is traced anew from the reflectivity map */
} sonject_injection_mode;

/* How paths to the source are found. */
typedef enum sonject_estimator {
    SONJECT_ESTIMATOR_CONNECT = 0, /* every hit is connected to the source; targets are sampled on
                                      purpose */
    SONJECT_ESTIMATOR_BRUTE_FORCE = 1 /* the paper's: rays are spawned into hemisphere and specular
                                         cone and count when they happen to hit the source's
                                         rectangle (transducer side > 0); resynthesise only */
} sonject_estimator;

/* Which column an echo of several interactions goes to. With one interaction both are the same. */
typedef enum sonject_column_rule {
    SONJECT_COLUMNS_FOCUSED = 0, /* mean along-track position of first and last hit */
    SONJECT_COLUMNS_PAPER = 1    /* the first hit's */
} sonject_column_rule;

/* Where a property of what is put into a measured magnitude image comes from (composite; complex,
 * uniform and synthetic images are taken as the sonar's parameters say). */
typedef enum sonject_match {
    SONJECT_MATCH_NOMINAL = 0, /* the sonar's parameters, the file's full scale */
    SONJECT_MATCH_IMAGE = 1    /* the image around the objects, where it clearly differs */
} sonject_match;

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
    uint32_t interactions;   /* surfaces that a path may meet, 1...8 */
    uint32_t estimator;      /* sonject_estimator */
    uint32_t order_energies; /* 1: keep the energy of each number of interactions (layers) */
    uint32_t match_response; /* sonject_match: the point response's widths */
    double match_looks; /* looks averaged in a magnitude pixel of the input: 1...64; 0: estimated
                           from the image around the objects */
    uint32_t match_saturation; /* sonject_match: the amplitude at which highlights are cut */
    uint32_t reserved;
} sonject_injection_params;

/* Composite, focused columns, estimated noise, -40 dB, ray scale 1, seed 1, one
 * interaction, connected; response, looks and saturation matched to the image. */
SONJECT_API void sonject_injection_params_init(sonject_injection_params *injection);

SONJECT_END_DECLARATIONS

#endif
