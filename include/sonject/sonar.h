/* The sonar as its images show it. SI units. */
#ifndef SONJECT_SONAR_H
#define SONJECT_SONAR_H

#include <stdint.h>

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

/* Weighting of the aspects that form a pixel; it shapes the along-track point response. */
typedef enum sonject_response_window {
    SONJECT_WINDOW_RECTANGULAR = 0, /* sinc(x / resolution) */
    SONJECT_WINDOW_HAMMING = 1,
    SONJECT_WINDOW_TAYLOR = 2 /* side lobes at -taylor_sidelobe_db, taylor_terms constant ones */
} sonject_response_window;

typedef struct sonject_sonar_params {
    uint32_t struct_size;
    uint32_t response_window;        /* sonject_response_window */
    double centre_frequency_hz;      /* > 0 */
    double bandwidth_hz;             /* > 0, below twice the centre frequency; -3 dB range width is
                                        c/(2 bandwidth) */
    double altitude_m;               /* > 0, height of the track over the mean seabed */
    double along_track_resolution_m; /* the aspects integrated are sin(aspect) within
                                        +-wavelength/(4 resolution); 0: the image's row spacing */
    double transducer_side_m;        /* side of the source that rays are connected to; 0: a point */
    double taylor_sidelobe_db;       /* 1...120, for the Taylor window */
    uint32_t taylor_terms;           /* 2...16 */
    uint32_t reserved;
} sonject_sonar_params;

/* 100 kHz, 30 kHz bandwidth, 10 m altitude, point source, rectangular window. */
SONJECT_API void sonject_sonar_params_init(sonject_sonar_params *sonar);

SONJECT_END_DECLARATIONS

#endif
