/* SPDX-License-Identifier: MIT */
/* From clips to a rig: the level, the skin, its errors, and the file. */
#ifndef RIGGING_H
#define RIGGING_H

#include "clips.h"

typedef struct rigging_options {
    const char *level; /* a level, or a hierarchy; NULL: one is built */
    uint32_t spheres;  /* 0: as many as the level has */
    sph_skin_options skin;
    sph_skeleton_options joints;
    sph_io_rig_options file;
} rigging_options;

typedef struct rigging {
    sph_skin *skin;
    sph_skin_arrays arrays; /* of the skin */
    uint32_t influences;    /* that the vertex of most has */
    uint32_t joint_count;
    sph_skin_error error, *frames;
    double hierarchy_s, skin_s; /* below 0: none was built */
} rigging;

/* DONE, or FAILED or USAGE after it has said why. Free it also then. */
int rigging_make(session *s, const rigging_options *o, const clips *c, rigging *out);
int rigging_save(session *s, const rigging_options *o, rigging *r, const char *path);
void rigging_free(rigging *r);
sph_skin_error rigging_clip_error(const rigging *r, uint32_t clip);
/* Of the file, and of the one beside a .gltf. */
uint64_t rigging_bytes(const char *path);

#endif
