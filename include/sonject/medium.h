/* The water: its sound speed, in layers if need be, and what it absorbs. SI units. */
#ifndef SONJECT_MEDIUM_H
#define SONJECT_MEDIUM_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

typedef struct sonject_medium_params {
    uint32_t struct_size;
    uint32_t reserved;
    double sound_speed_mps;           /* of the water, 100...10000; of no meaning with layers */
    double reference_sound_speed_mps; /* that the image processor assumed; 0: the true one (with
                                         layers: that around the seabed). A target at range r
                                         appears at r * reference / true */
    double absorption_db_per_m;       /* 0...100; sonject_absorption gives that of sea water */
} sonject_medium_params;

/* Isovelocity water at 1500 m/s that absorbs nothing. */
SONJECT_API void sonject_medium_params_init(sonject_medium_params *medium);

/* Absorption of sea water in dB/m after Francois and Garrison (J. Acoust. Soc. Am. 72, 1982, 896
 * and 1879): frequency 200 Hz...1 MHz, temperature -2...30 degrees Celsius, salinity 0...40 per
 * mille, depth 0...5000 m below the sea surface, pH 7...9. NaN outside of these. */
SONJECT_API double sonject_absorption(double frequency_hz, double temperature_celsius,
                                      double salinity_permille, double depth_m, double ph);

SONJECT_END_DECLARATIONS

#endif
