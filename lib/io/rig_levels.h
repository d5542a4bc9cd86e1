/* SPDX-License-Identifier: MIT */
/* Levels of a rigged glTF: what is read for them, and the document that they become. */
#ifndef SPH_IO_RIG_LEVELS_H
#define SPH_IO_RIG_LEVELS_H

#include <sphmesh/io_simplify.h>

#include "io/gltf.h"
#include "io/gltf_write.h"
#include "io/rig_open.h"

enum { SPH__LEVELS_LIMIT = 64 };

/* An attribute of a part's vertices: some columns of all their numbers. */
typedef struct sph__levels_attribute {
    uint32_t name;   /* in the JSON: TEXCOORD_0 or the like */
    uint32_t target; /* which morph target it belongs to; SPH__GLTF_NONE: none */
    uint32_t column, width;
    bool normal; /* NORMAL of the part itself, which has no columns */
} sph__levels_attribute;

/* What is known of one part of the scene. */
typedef struct sph__levels_part {
    size_t triangle_count;
    size_t first_attribute, attribute_count;
} sph__levels_part;

struct sph_io_rig_levels {
    SPH__IO_MARK
    sph_context *context; /* the progressive mesh keeps it alive */
    char *path;
    sph__io_map map;
    sph__gltf_document d;
    sph__io_gltf *g;
    sph_io_rig *rig;
    sph_progressive *progressive;
    sph__levels_part *parts; /* as g->parts */
    sph__levels_attribute *attributes;
    size_t attribute_count, attribute_capacity;
    uint32_t columns;
    size_t triangle_count; /* of the rig */
    float *numbers;        /* [n][columns] */
    float *normals;        /* [n][3]; NULL: no part has any */
    uint32_t *groups;      /* [n] */
};

/* One level, while it is written. */
typedef struct sph__levels_mesh {
    sph_skin *skin;
    sph_skin_arrays a;
    float *normals, *numbers;
    uint32_t *sources;      /* triangles of the input */
    uint32_t *place, *used; /* [vertex_count]: of a vertex in a part's mesh, and back */
} sph__levels_mesh;

/* Bytes of the buffer to be. */
typedef struct sph__levels_chunk {
    const void *bytes;
    size_t size;
    void *owned; /* to be released; NULL: borrowed */
} sph__levels_chunk;

typedef struct sph__levels_writer {
    const sph_io_rig_levels *l;
    const char *path;
    sph__io_gltf_writer w;
    sph__levels_chunk *chunks;
    size_t chunk_count, chunk_capacity;
    uint32_t *views, *accessors; /* of the file: their new numbers; SPH__GLTF_NONE: not there yet */
    uint32_t level_count, mesh_count;
    const uint32_t *level_numbers;
    uint32_t *meshes; /* [level_count][drawn_count]: numbers of the meshes; SPH__GLTF_NONE: empty */
    sph_status status;
} sph__levels_writer;

/* --- rig_levels_open.c --- */
sph_status sph__levels_read(sph_io_rig_levels *l);

/* --- rig_levels_copy.c: what the file has, with its numbers made new; failures stay in w->status --- */
/* Takes over the bytes, or borrows them; returns the number of the view. */
uint32_t sph__levels_add_view(sph__levels_writer *w, const void *bytes, size_t size, void *owned, uint32_t stride,
                              uint32_t target);
uint32_t sph__levels_keep_accessor(sph__levels_writer *w, uint32_t accessor);
/* A value as it is, but for numbers of views. */
void sph__levels_copy(sph__levels_writer *w, sph__io_text *to, uint32_t value);
/* All members of the object but those named; each with a comma before it, except the first of an empty object. */
void sph__levels_copy_members(sph__levels_writer *w, sph__io_text *to, uint32_t object, const char *const *except,
                              bool *first);
/* "name": with the comma that it needs. */
void sph__levels_member(sph__io_text *to, const char *name, bool *first);
/* Animations, skins and images. */
void sph__levels_copy_animations(sph__levels_writer *w);
void sph__levels_copy_skins(sph__levels_writer *w);
void sph__levels_copy_images(sph__levels_writer *w);

/* --- rig_levels_mesh.c --- */
sph_status sph__levels_open_mesh(const sph_io_rig_levels *l, uint32_t level, sph__levels_mesh *m);
void sph__levels_close_mesh(const sph_io_rig_levels *l, sph__levels_mesh *m);
/* Writes the primitive of a part; false where the level leaves it nothing. */
bool sph__levels_put_part(sph__levels_writer *w, sph__levels_mesh *m, size_t part, bool first);

/* --- rig_levels_nodes.c --- */
void sph__levels_put_meshes(sph__levels_writer *w);
void sph__levels_put_nodes(sph__levels_writer *w);

#endif
