/* Calibration: estimates of what a swath tells of itself, that is, the curve from amplitudes to its
 * numbers, its ceiling, speckle, noise floor and water column. All estimates come from fixed tiles
 * over the whole swath. Each has a standard error, or the reason why it is not seen. Formulas:
 * kernels/MATH.md, "Calibration". */
#ifndef SONJECT_MEASURE_CALIBRATION_H
#define SONJECT_MEASURE_CALIBRATION_H

#include <stdint.h>

#include <jansson.h>

#include <sonject/calibrate.h>

#include "base/report.h"
#include "image/raster.h"
#include "measure/first_return.h"
#include "scene/scene.h"

#define DECIBELS         4.3429448190325182 /* dB for one neper of intensity */
#define CLEARLY          3.0                /* standard errors that make a difference clear */
#define ALTITUDES_ALIKE  0.05 /* relative difference to first returns that slopes explain */
#define SIDE_UNKNOWN     UINT32_MAX
#define CURVE_FAMILIES   3
#define CALIBRATION_LAGS 12 /* lags of 0...11 pixels */
#define GAIN_BANDS       24
#define PAGE_BINS        256

/* An estimate and its standard error. unseen is NULL, or the reason why there is no estimate. */
struct estimate {
    double value, error;
    const char *unseen;
    const char *how; /* the method */
};

/* A swath's stored numbers, or the magnitudes of complex pixels. */
struct stored_swath {
    const float *values; /* rows x columns, owned by the caller */
    size_t rows, columns;
    double unit;      /* all values are whole multiples of this unit; 0: floats */
    double type_full; /* full scale of the pixel type */
    bool is_complex;
};

/* Tiles of the plainer half of the seabed. Cells are the intervals between edges; counts has how
 * many of a tile's numbers lie in each cell. */
#define CELLS_MAX   72
#define TILES_LEAST 12
struct plain_tiles {
    size_t side, count;
    size_t *rows, *columns; /* first row and column of each tile */
    float *unevenness;      /* deviation of a tile's parts' medians, over its pixels' spread */
    size_t edge_count;      /* number of edges; there is one cell more */
    double edges[CELLS_MAX];
    uint16_t *counts; /* count x (edge_count + 1) */
};

/* Families of curves from stored number to amplitude, each of one parameter. A power's parameter is
 * its exponent: 1 for stored amplitude, 1/2 for stored intensity, others for gamma. */
enum curve_family {
    CURVE_POWER,
    CURVE_DECIBEL,
    CURVE_SCHLICK
};

struct curve_fit {
    double parameter, parameter_error; /* here and for looks: the standard error of the logarithm */
    double looks, looks_error;
    double texture; /* 1 / shape of the K distribution */
    double texture_error;
    double likelihood; /* logarithm of the likelihood */
    double misfit;     /* largest difference of the law's and the tiles' cumulative shares */
    double misfit_error;
    double *by_tile; /* log likelihood of each tile; owned */
    double *levels;  /* logarithm of each tile's mean intensity; owned */
};

/* Fits a family to the tiles. Finds parameter and looks where they are NAN, and keeps texture as
 * given. full_scale: the stored number that the curve takes for 1. fit: all zeros, or an earlier
 * fit of the same tiles. Errors: MEMORY. */
sonject_status curve_fit_find(struct report *report, const struct plain_tiles *tiles,
                              double full_scale, enum curve_family family, double parameter,
                              double looks, double texture, struct curve_fit *fit);
void curve_fit_clear(struct curve_fit *fit);

/* Sets a fit's parameter so that the median tile's amplitudes have the contrast of one look.
 * Errors: MEMORY. */
sonject_status find_by_contrast(struct report *report, const struct plain_tiles *tiles,
                                const struct stored_swath *swath, double full_scale,
                                enum curve_family family, struct curve_fit *fit);

/* Returns the log intensity of a stored number. The decibel family leaves out a constant. */
double curve_log_intensity(enum curve_family family, double parameter, double full_scale,
                           double value);

/* Returns the stored number of a log intensity, not limited to the range of stored numbers. */
double curve_value(enum curve_family family, double parameter, double full_scale,
                   double log_intensity);

/* Chooses tiles outside the water column and counts their numbers in cells. grain: rows and columns
 * of a grain of speckle, 1...GRAIN_MOST. ceiling: the largest number, infinite if nothing clips.
 * Errors: MEMORY. */
#define GRAIN_MOST 4
sonject_status plain_tiles_init(struct plain_tiles *tiles, struct report *report,
                                const struct stored_swath *swath, const struct first_returns *water,
                                const size_t grain[2], double ceiling);
void plain_tiles_clear(struct plain_tiles *tiles);

struct calibration {
    size_t rows, columns;
    sonject_transfer_params transfer; /* full_scale 0: the pixel type's */
    struct estimate parameter;        /* the transfer's; meaningless for kinds without one */
    struct estimate transfer_kind;    /* only unseen has a meaning */
    bool alike[CURVE_FAMILIES];       /* families that the tiles cannot tell from the chosen one */
    double alike_exponent;            /* exponent of the power curve that is alike, if any */
    struct curve_fit fits[CURVE_FAMILIES];
    enum curve_family family;
    struct plain_tiles tiles;
    size_t grain[2]; /* rows and columns of a grain of speckle, rounded down, 1...GRAIN_MOST */
    double largest_number; /* that the swath's type holds */
    struct estimate full_scale, clipped, looks, shape;
    struct estimate seabed_db;      /* level of the seabed in a side's middle columns, over 1 */
    struct estimate room_db;        /* ceiling over that, dB */
    size_t plain_row, plain_column; /* middle of a plain tile there that is darker than most */
    struct estimate along_rows, range_columns; /* half-power widths of the response, pixels */
    struct estimate noise_floor_db;            /* over the seabed around shadows */
    size_t shadows;                            /* number of shadows that tell the noise floor */
    struct estimate nadir_column, altitude_m;
    double altitude_ends_m[2]; /* 5 % and 95 % quantiles of the pings' altitudes */
    struct first_returns returns;
    double median_return; /* median of returns.columns; 0: unseen */
    double row_spacing_m, column_spacing_m, first_slant_range_m; /* NAN: unknown */
    uint32_t side;              /* SONJECT_SIDE_... as the file tells, or SIDE_UNKNOWN */
    double recorded_altitude_m; /* median or mean altitude in the file; 0: none */
    double recorded_share;      /* median of recorded altitude over first return; 0: unknown */
    /* The members below are for the page. */
    double correlation[2][CALIBRATION_LAGS]; /* intensity's: [0] along the track, [1] in range */
    double gain_db[GAIN_BANDS], gain_error_db[GAIN_BANDS]; /* bands' levels; NAN: < 2 tiles */
    double histogram[PAGE_BINS]; /* shares of pixels, in bins from 0 to histogram_top */
    double histogram_top;
    size_t gain_bands;
};

/* Makes all estimates. geometry: what is known beside the swath; only the spacings and the first
 * range count, and an unknown one is NAN or 0. On failure there is nothing to clear. Errors:
 * MEMORY. */
sonject_status calibrate_swath(struct report *report, const struct stored_swath *swath,
                               const sonject_geometry_params *geometry,
                               struct calibration *calibration);
void calibration_clear(struct calibration *calibration);

/* Writes the curve of a family, chosen or alike, such as "schlick 3.9". Returns text. */
#define CURVE_TEXT_CAPACITY 64
const char *curve_text(const struct calibration *calibration, enum curve_family family,
                       char text[CURVE_TEXT_CAPACITY]);

/* Returns whether the tiles' numbers follow the fitted law within the errors. */
bool curve_fits(const struct curve_fit *fit);

/* Returns a calibration as a JSON document: the keys that a scene takes, and `measured` with
 * standard errors. Numbers have four significant digits. The caller releases the document by
 * json_decref. Returns NULL where memory is out. */
json_t *calibration_document(const struct calibration *calibration, const char *path,
                             const char *hash, const char *channel);

/* Writes a document as YAML into *text, which the caller frees by free(). Errors: MEMORY. */
sonject_status document_as_yaml(struct report *report, const json_t *document, char **text);

/* Calibrates a file or, where pixels is not NULL, pixels in memory, whose rows, columns, values and
 * is_complex the caller fills. Writes the files that params asks for. The caller frees *text by
 * free(). for_scene: leaves out the note on the altitude, since a scene's own notes have it.
 * Errors: INPUT, STORAGE, MEMORY, UNSUPPORTED. */
sonject_status calibrate_image(struct report *report, const sonject_calibrate_params *params,
                               const struct image_options *options, struct stored_swath *pixels,
                               bool for_scene, char **text);

/* Draws the page that shows why to believe a calibration. Errors: STORAGE, MEMORY, UNSUPPORTED. */
sonject_status calibration_page_write(struct report *report, const struct calibration *calibration,
                                      const struct stored_swath *swath, const char *title,
                                      const char *path);

#endif
