/* The geometry that an image file says of itself: written by sonject, read by quicklook. */
#ifndef SONJECT_API_GEOMETRY_NOTES_H
#define SONJECT_API_GEOMETRY_NOTES_H

#include <sonject/image.h>
#include <sonject/sonar.h>

#include "base/report.h"
#include "image/raster.h"
#include "io/raster_file.h"
#include "io/swath_file.h"

#define GEOMETRY_NOTES_COUNT 9

/* The texts and the attributes that point at them. */
struct geometry_notes {
    char texts[GEOMETRY_NOTES_COUNT][48];
    struct raster_attribute attributes[GEOMETRY_NOTES_COUNT];
};

/* first_row, first_column: where the file's pixel (0, 0) lies in the geometry. */
void geometry_notes_init(struct geometry_notes *notes, const sonject_sonar_params *sonar,
                         const sonject_geometry_params *geometry, double first_row,
                         double first_column);

/* Reads them back; false (and nothing changed) if the file does not say all of it. */
bool geometry_notes_read(const struct swath_file *file, sonject_geometry_params *geometry,
                         double *altitude_m);

#endif
