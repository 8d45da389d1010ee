/* The incoherent part: expected energies of seabed and rough surfaces, strip by strip, straight and
 * by image sources. A tile is the rectangle of strips and bins around one object's echoes. */
#ifndef SONJECT_TRACE_ROUGH_H
#define SONJECT_TRACE_ROUGH_H

#include "trace/fan.h"
#include "trace/tracer.h"

struct rough_tile {
    struct line_grid grid;
    size_t offset; /* place of the tile's first plane in the tiles */
};

struct rough_trace {
    struct line_grid grid; /* the patch's, with its margins */
    struct rough_tile tiles[SCENE_OBJECTS_MAX];
    size_t tile_elements;     /* elements of all tiles and planes */
    double energy_of_quantum; /* m^2 */
    /* Strips traced besides those whose seabed is wanted, for rays that come from there: on both
     * sides of a chunk (relief_halo), and beyond the patch's ends (object_halo). */
    int32_t relief_halo, object_halo;
    int32_t chunk; /* most strips of a call of rough_trace_strips */
    struct fan_edges edges;
    struct launch launch;
};

/* Returns the bins of the grid, or the strips of it and beyond, where echoes and shadow of a part
 * can lie. Echoes by image sources and several faces count too. by_beam: as pings of a real
 * aperture hear them. */
struct span rough_bins_of_part(const struct tracer *tracer, uint32_t number,
                               const struct line_grid *grid, bool by_beam);
struct span rough_strips_of_part(const struct tracer *tracer, uint32_t number,
                                 const struct line_grid *grid, bool by_beam);

/* Prepares a trace. map: rows x columns of the view, reflectivity over mu0 (values >= 0, finite),
 * or NULL for 1 everywhere. After success the caller calls rough_trace_end, also after later
 * failures; on failure nothing is held. Errors: INPUT (too many rays), DEVICE, MEMORY. */
sonject_status rough_trace_begin(struct rough_trace *trace, struct tracer *tracer,
                                 const float *map);
void rough_trace_end(struct rough_trace *trace);

/* Prepares a trace of an even seabed as the beam of a real aperture sees it. A ping is one strip,
 * with all that the ping hears, so the energies of a row are those of its ping. response: gives the
 * grid, and is as narrow as a row. */
sonject_status rough_trace_begin_beam(struct rough_trace *trace, struct tracer *tracer,
                                      const struct point_response *response);

/* Lays the fan for some of the patch's strips. rough_trace_strips does so itself. */
void rough_trace_aim(struct rough_trace *trace, struct span strips);

/* Traces strips.count <= chunk strips and writes the energies (m^2) that the seabed would return
 * without objects, strips.count x bins.count. The objects' tiles add up on the device. */
sonject_status rough_trace_strips(struct rough_trace *trace, struct tracer *tracer,
                                  struct span strips, float *seabed);

/* Removes relief and objects: the trace is of the mean plane alone from then on. Tiles stay. */
void rough_trace_flatten(struct rough_trace *trace);

/* Fills in the place of an object's tile in the record of one of its parts. */
void rough_tile_describe(const struct rough_trace *trace, uint32_t object,
                         struct object_record *record);

/* Reads all tiles as energies (planes TILE_ENERGY, TILE_LOST; m^2) and counts (TILE_FOOTPRINT):
 * tile_elements floats. Plane p of a tile starts at offset + p * line_grid_cells(&tile.grid). */
sonject_status rough_trace_tiles(struct rough_trace *trace, struct tracer *tracer, float *tiles);

/* Adds to the objects' tiles (TILE_ENERGY) the sound that image sources carry to and from their
 * rough surfaces. Errors: DEVICE, MEMORY. */
sonject_status rough_trace_images(struct rough_trace *trace, struct tracer *tracer);

#endif
