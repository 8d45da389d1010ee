/* The questions of sonject init about facts that an image lacks. */
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
    char other_calibration[NAME], other_picture[NAME]; /* the other side's; "": none */
    char folder[NAME];               /* folder of relative names; "": the scene's */
    char *objects;                   /* override with the target's file; owned; NULL: none */
    bool has_mesh;                   /* the target is a mesh */
    bool is_complex;                 /* the image's pixels are */
    bool has_geometry, has_altitude; /* in the image's file */
    /* Facts from the calibration of the image; NAN: not found. */
    bool has_nadir;
    bool is_reversed;              /* range grows to the left, as answered */
    bool is_decibel, is_amplitude; /* the kind of the curve */
    bool has_returns;              /* first returns were found, which give the altitude */
    double columns, nadir_column, frequency_hz, column_spacing_m, altitude_m, recorded_altitude_m,
        full_scale, largest_number, ceiling_over_seabed_db, seabed_db, plain_row, plain_column;
    bool assumes_bandwidth; /* the answer is the bandwidth of the column spacing */
};

/* Returns the answer about a key; NULL if it was not asked for or left empty. */
const char *answer_about(const struct interview *interview, const char *key);

/* Reads a scene of the image with the answers so far; text: its other keys. */
sonject_status read_image_scene(const struct interview *interview, const char *text,
                                sonject_scene **scene);

/* Asks for the facts that the image lacks. Returns false after a message if the input ends. */
bool ask_all(struct interview *interview);

#endif
