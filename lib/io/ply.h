/* SPDX-License-Identifier: MIT */
/* PLY files between the reading of the header and that of the elements. */
#ifndef SPH_IO_PLY_H
#define SPH_IO_PLY_H

#include "io/reader.h"

enum {
    SPH__PLY_NONE,
    SPH__PLY_INT8,
    SPH__PLY_UINT8,
    SPH__PLY_INT16,
    SPH__PLY_UINT16,
    SPH__PLY_INT32,
    SPH__PLY_UINT32,
    SPH__PLY_FLOAT32,
    SPH__PLY_FLOAT64,
    SPH__PLY_TYPES
};

/* What a property is for. */
enum { SPH__PLY_SKIP, SPH__PLY_X, SPH__PLY_Y, SPH__PLY_Z, SPH__PLY_CORNERS, SPH__PLY_START, SPH__PLY_END };

typedef struct sph__ply_property {
    unsigned char type, count_type; /* count_type of a list, else SPH__PLY_NONE */
    unsigned char role;
} sph__ply_property;

enum { SPH__PLY_OTHER, SPH__PLY_VERTEX, SPH__PLY_FACE, SPH__PLY_EDGE, SPH__PLY_STRIPS };

typedef struct sph__ply_element {
    const char *name; /* in the file */
    int name_length;
    unsigned kind, roles; /* bits of those that its properties have */
    size_t count;
    size_t first, property_count; /* its properties */
    size_t least; /* bytes that one takes at least; all that it takes where it is binary without lists */
    bool lists;
} sph__ply_element;

typedef struct sph__ply {
    sph__io_text text;
    const char *start;
    sph__io_mesh *mesh;
    sph__io_watch watch;
    bool binary, big;
    sph__ply_element *elements;
    sph__ply_property *properties;
    size_t element_count, element_capacity, property_count, property_capacity;
    size_t vertex_count;
} sph__ply;

/* Bytes of a number of each type. */
extern const unsigned char sph__ply_sizes[SPH__PLY_TYPES];

/* Up to the first element; checks that the file is large enough for what the header says. */
sph_status sph__ply_read_header(sph__ply *ply);

#endif
