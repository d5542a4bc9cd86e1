/* SPDX-License-Identifier: MIT */
/* A rig that was read, laid open. */
#ifndef SPH_IO_RIG_OPEN_H
#define SPH_IO_RIG_OPEN_H

#include "io/gltf.h"

struct sph_io_rig {
    SPH__IO_MARK
    sph_context *context; /* the skin keeps it alive, until the rig is destroyed */
    sph_skin *skin;
    uint32_t bone_count, frame_count, name_count;
    uint32_t morphs;
    char **node_names;  /* [name_count], by node; NULL: not a bone */
    const char **names; /* [J] */
    uint32_t *nodes, *parents;
    double *inverse_bind, *joints_rest, *joints;
    size_t edge_count;
    uint32_t *edges;
};

/* Checks a caller's options; frames per second become those that are meant. */
sph_status sph__io_rig_read_options(sph_context *context, const sph_io_open_rig_options *in,
                                    sph_io_open_rig_options *o);

/* Maps a file and opens its document, which must be a glTF; close both, the document first, where it succeeds. */
sph_status sph__io_rig_map(sph_context *context, const char *path, sph__io_map *map, sph__gltf_document *d);
/*
 * The document's rig, with checked options, and the scene that it is of; both are to be given back after failure too.
 * Progress comes to `share` of the call.
 */
sph_status sph__io_rig_read(sph__gltf_document *d, const sph_io_open_rig_options *options, double share,
                            sph__io_gltf **scene, sph_io_rig **out);

#endif
