/* The compressed pulse: what a point looks like in range. SI units. */
#ifndef SONJECT_PULSE_H
#define SONJECT_PULSE_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

typedef enum sonject_pulse_kind {
    SONJECT_PULSE_GAUSSIAN = 0, /* half-power width c / (2 bandwidth) */
    SONJECT_PULSE_CHIRP = 1,    /* a linear sweep over the bandwidth, compressed: the transform of
                                   the spectrum's weighting */
    SONJECT_PULSE_TABLE = 2     /* samples: sonject_scene_set_pulse_table */
} sonject_pulse_kind;

/* Weighting of a compressed sweep's spectrum over the bandwidth B. Half-power widths, in c / 2B:
 * 0.886, 1.441, and Taylor's between them. */
typedef enum sonject_pulse_window {
    SONJECT_PULSE_RECTANGULAR = 0, /* sinc: side lobes at -13.3 dB */
    SONJECT_PULSE_HANN = 1,        /* side lobes at -31.5 dB, soon below */
    SONJECT_PULSE_TAYLOR = 2       /* side lobes at -taylor_sidelobe_db */
} sonject_pulse_window;

/* What the positions of a table's samples are. */
typedef enum sonject_pulse_axis {
    SONJECT_PULSE_AXIS_RANGE = 0, /* m of slant range beyond the target */
    SONJECT_PULSE_AXIS_TIME = 1   /* s after the target's echo; range is half the reference sound
                                     speed times this */
} sonject_pulse_axis;

typedef struct sonject_pulse_params {
    uint32_t struct_size;
    uint32_t kind;             /* sonject_pulse_kind; TABLE only where the scene has a table */
    uint32_t window;           /* sonject_pulse_window, of a chirp */
    uint32_t taylor_terms;     /* 2...16 */
    double taylor_sidelobe_db; /* 1...120 */
} sonject_pulse_params;

/* Gaussian; window rectangular; Taylor 35 dB, 5 terms. */
SONJECT_API void sonject_pulse_params_init(sonject_pulse_params *pulse);

SONJECT_END_DECLARATIONS

#endif
