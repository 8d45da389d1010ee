/* The questions of sonject init, which an image leaves open. */
#ifndef SONJECT_TOOLS_INTERVIEW_H
#define SONJECT_TOOLS_INTERVIEW_H

#include <stdbool.h>
#include <stddef.h>

#include <sonject/sonject.h>

enum {
    ANSWER = 100,
    ANSWERS = 12,
    NAME = 1024
};

struct init_options {
    const char *image;
    const char *output;
    const char *channel;
    const char *array;
    const char *target; /* file of a mesh or a target; NULL: a cylinder */
    bool makes_campaign;
};

struct interview {
    sonject_context *context;
    const struct init_options *options;
    char answers[ANSWERS][ANSWER]; /* "key=value" */
    size_t count;
    char scene[NAME], calibration[NAME], picture[NAME], campaign[NAME]; /* files */
    char other_calibration[NAME], other_picture[NAME]; /* of a recording's other side; "": none */
    char folder[NAME]; /* that names of other files are meant from; "": the scene's */
    char *objects;     /* override with the target's file; owned; NULL: there is none */
    bool has_mesh;     /* it is one of a mesh */
    bool has_geometry, has_altitude; /* the image's file */
    /* The image, as its calibration found; NAN: it did not. */
    bool has_nadir;
    bool is_reversed; /* range grows to the left; an answer */
    bool has_returns; /* first ones, so that they tell the altitude */
    double columns, nadir_column, frequency_hz, column_spacing_m, altitude_m, recorded_altitude_m,
        full_scale, ceiling_over_seabed_db, plain_row, plain_column;
    bool assumes_bandwidth; /* that of the columns */
};

/* The answer about a key; NULL: it was not asked for, or there was none. */
const char *answer_about(const struct interview *interview, const char *key);

/* Reads a scene of the image with what was answered so far; text: its other keys. */
sonject_status read_image_scene(const struct interview *interview, const char *text,
                                sonject_scene **scene);

/* Asks what the image does not tell. False after a message: there was no answer. */
bool ask_all(struct interview *interview);

#endif
