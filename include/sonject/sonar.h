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

/* How the image gets its resolution along the track. */
typedef enum sonject_sonar_kind {
    SONJECT_SONAR_SYNTHETIC = 0, /* of an aperture that the track makes: the same at every range */
    SONJECT_SONAR_REAL = 1 /* sidescan: of the array's two-way beam, which widens with range */
} sonject_sonar_kind;

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
    uint32_t kind;                   /* sonject_sonar_kind */
    double aperture_rad; /* synthetic: full angle of the aspects that shadows and rough highlights
                            are integrated over, at most pi/2; 0: broadside alone; negative: the
                            response's own, wavelength/(2 resolution). Smooth highlights always
                            have the response's own */
    /* Real: the array, a uniform rectangle that sends and receives. Its long side lies along the
     * track and its beam looks abreast; then it is turned. */
    double array_length_m;       /* > 0 where kind is real; two-way energy sinc(length u /
                                    wavelength)^4 with sinc z = sin(pi z)/(pi z) and u the cosine
                                    between the long side and the way to the echo */
    double array_height_m;       /* likewise across; 0: all elevations are heard alike */
    double array_heading_rad;    /* of the long side, from along-track (+x) towards range (+y),
                                    whichever side that is; within pi/4 */
    double array_pitch_rad;      /* of the long side over the horizontal; within pi/4 */
    double array_depression_rad; /* of the beam below the horizontal, 0...pi/2 */
} sonject_sonar_params;

/* 100 kHz, 30 kHz bandwidth, 10 m altitude, point source, rectangular window; synthetic, with the
 * response's own aspects. */
SONJECT_API void sonject_sonar_params_init(sonject_sonar_params *sonar);

SONJECT_END_DECLARATIONS

#endif
