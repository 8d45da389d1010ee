/* What a swath tells of itself: how its numbers came from amplitudes, its ceiling, its speckle, its
 * noise floor, its water column. All of it is estimated from fixed tiles over the whole swath, each
 * with a standard error, or with the reason why it is not seen. Formulas: kernels/MATH.md,
 * "Calibration". */
#ifndef SONJECT_MEASURE_CALIBRATION_H
#define SONJECT_MEASURE_CALIBRATION_H

#include <stdint.h>

#include <jansson.h>

#include <sonject/calibrate.h>

#include "base/report.h"
#include "image/raster.h"
#include "measure/first_return.h"
#include "scene/scene.h"

#define DECIBELS         4.3429448190325182 /* of one neper of intensity */
#define CLEARLY          3.0                /* standard errors */
#define ALTITUDES_ALIKE  0.05               /* recorded ones and first returns, but for slopes */
#define SIDE_UNKNOWN     UINT32_MAX
#define CURVE_FAMILIES   3
#define CALIBRATION_LAGS 12 /* 0...11 pixels */
#define GAIN_BANDS       24
#define PAGE_BINS        256

/* An estimate and its standard error; unseen: NULL, or why there is none. */
struct estimate {
    double value, error;
    const char *unseen;
    const char *how; /* it was found */
};

/* A swath's stored numbers; of complex pixels their magnitudes. */
struct stored_swath {
    const float *values; /* rows x columns, owned by the caller */
    size_t rows, columns;
    double unit;      /* that they are whole multiples of; 0: they are floats */
    double type_full; /* full scale of the pixel type */
    bool is_complex;
};

/* Tiles of the plainer seabed, and how many of their numbers lie in each cell between edges. */
#define CELLS_MAX   72
#define TILES_LEAST 12
struct plain_tiles {
    size_t side, count;
    size_t *rows, *columns; /* of their first pixels */
    float *unevenness;      /* of the medians of their parts, over the spread of their pixels */
    size_t edge_count;      /* cells are one more */
    double edges[CELLS_MAX];
    uint16_t *counts; /* count x (edge_count + 1) */
};

/* The relations between stored number and amplitude, as families of one parameter. A power is
 * amplitude (1), intensity (1/2) or gamma. */
enum curve_family {
    CURVE_POWER,
    CURVE_DECIBEL,
    CURVE_SCHLICK
};

struct curve_fit {
    double parameter, parameter_error; /* errors of logarithms */
    double looks, looks_error;
    double texture; /* 1 / shape of the K distribution */
    double texture_error;
    double likelihood; /* logarithm */
    double misfit;     /* largest distance between the law and what is in the tiles, as shares */
    double misfit_error;
    double *by_tile; /* the same of each tile; owned */
    double *levels;  /* log of each tile's mean intensity; owned */
};

/* Fits a family to the tiles; looks, parameter: NAN where they are to be found. full_scale: of the
 * curve. texture: is taken as it is. fit: all zeros or an earlier one of the same tiles. Errors:
 * MEMORY. */
sonject_status curve_fit_find(struct report *report, const struct plain_tiles *tiles,
                              double full_scale, enum curve_family family, double parameter,
                              double looks, double texture, struct curve_fit *fit);
void curve_fit_clear(struct curve_fit *fit);

/* Sets a fit's parameter so that the median tile's amplitudes have the contrast of one look.
 * Errors: MEMORY. */
sonject_status find_by_contrast(struct report *report, const struct plain_tiles *tiles,
                                const struct stored_swath *swath, double full_scale,
                                enum curve_family family, struct curve_fit *fit);

/* Log intensity of a stored number, but for a constant of decibels. */
double curve_log_intensity(enum curve_family family, double parameter, double full_scale,
                           double value);

/* The stored number of that log intensity, not limited to what is stored; NAN where there is none.
 */
double curve_value(enum curve_family family, double parameter, double full_scale,
                   double log_intensity);

/* Chooses tiles outside the water and fills cells. ceiling: the largest number, infinite if none
 * clips. Errors: MEMORY. */
sonject_status plain_tiles_init(struct plain_tiles *tiles, struct report *report,
                                const struct stored_swath *swath, const struct first_returns *water,
                                double ceiling);
void plain_tiles_clear(struct plain_tiles *tiles);

struct calibration {
    size_t rows, columns;
    sonject_transfer_params transfer; /* full_scale 0: the type's */
    struct estimate parameter;        /* of the transfer; unseen where its kind has none */
    struct estimate transfer_kind;    /* its value and error mean nothing */
    bool alike[CURVE_FAMILIES];       /* families that the tiles cannot tell from the one chosen */
    double alike_exponent;            /* of powers, where they are among them */
    struct curve_fit fits[CURVE_FAMILIES];
    enum curve_family family;
    struct plain_tiles tiles;
    struct estimate full_scale, clipped, looks, shape;
    struct estimate room_db;        /* of the ceiling over the seabed in the middle columns */
    size_t plain_row, plain_column; /* middle of a plain tile there, darker than most */
    struct estimate along_rows, range_columns; /* half-power widths of the response, pixels */
    struct estimate noise_floor_db;            /* over the seabed about shadows */
    size_t shadows;                            /* that tell it */
    struct estimate nadir_column, altitude_m;
    double altitude_ends_m[2]; /* which 5 and 95 % of pings lie below */
    struct first_returns returns;
    double median_return;                                        /* of these, columns; 0: unseen */
    double row_spacing_m, column_spacing_m, first_slant_range_m; /* NAN: unknown */
    uint32_t side;              /* SONJECT_SIDE_... that the file tells; SIDE_UNKNOWN */
    double recorded_altitude_m; /* that the file tells, in the median or mean; 0: it does not */
    double recorded_share;      /* median of what pings tell over their first returns; 0: unknown */
    /* For the page. */
    double correlation[2][CALIBRATION_LAGS]; /* of intensity, along rows' axis and columns' */
    double gain_db[GAIN_BANDS], gain_error_db[GAIN_BANDS]; /* of gain_bands; NAN: no tiles there */
    double histogram[PAGE_BINS]; /* shares of values from 0 to histogram_top */
    double histogram_top;
    size_t gain_bands;
};

/* Geometry that is known beside the swath, NAN or 0 where it is not. */
struct calibration_geometry {
    double row_spacing_m, column_spacing_m, first_slant_range_m;
};

/* Estimates all. On failure there is nothing to clear. Errors: MEMORY. */
sonject_status calibrate_swath(struct report *report, const struct stored_swath *swath,
                               const struct calibration_geometry *geometry,
                               struct calibration *calibration);
void calibration_clear(struct calibration *calibration);

/* A family's curve, chosen or alike: "schlick 3.9". Returns text. */
#define CURVE_TEXT_CAPACITY 64
const char *curve_text(const struct calibration *calibration, enum curve_family family,
                       char text[CURVE_TEXT_CAPACITY]);

/* Whether the tiles' numbers lie about the fitted law as samples of it do. */
bool curve_fits(const struct curve_fit *fit);

/* As a document: keys of scenes, and `measured` with standard errors. Numbers have four significant
 * digits. NULL where memory is out; for json_decref. */
json_t *calibration_document(const struct calibration *calibration, const char *path,
                             const char *hash, const char *channel);

/* A document as YAML; for free(). Errors: MEMORY. */
sonject_status document_as_yaml(struct report *report, const json_t *document, char **text);

/* Calibrates a file, or pixels in memory (NULL: the file), whose rows, columns, values and
 * is_complex are filled; leaves the files that are asked for; *text is for free(). for_scene: whose
 * own notes tell of its altitude. Errors: INPUT, STORAGE, MEMORY, UNSUPPORTED. */
sonject_status calibrate_image(struct report *report, const sonject_calibrate_params *params,
                               const struct image_options *options, struct stored_swath *pixels,
                               bool for_scene, char **text);

/* Draws the page that shows why to believe it. Errors: STORAGE, MEMORY, UNSUPPORTED. */
sonject_status calibration_page_write(struct report *report, const struct calibration *calibration,
                                      const struct stored_swath *swath, const char *title,
                                      const char *path);

#endif
