/* SPDX-License-Identifier: MIT */
/* A skin and its skeleton on the way to a glTF: rig_save.c in front, rig_json.c, rig_mesh.c and rig_keys.c behind. */
#ifndef SPH_IO_RIG_H
#define SPH_IO_RIG_H

#include "io/gltf_write.h"

enum { SPH__RIG_SET = 4 }; /* influences of a JOINTS_n and WEIGHTS_n */

typedef struct sph__rig {
    sph_context *context; /* not retained */
    const char *path;     /* for messages */
    sph_skin_arrays skin;
    sph_skeleton_arrays joints;
    sph_io_rig_options options;
    unsigned set_count; /* that any vertex needs */
    bool wide_joints;   /* u16, else u8 */
    bool wide_indices;  /* u32, else u16 */
    /* For each clip and each bone the rotations x y z w of its frames, then their translations. */
    float *keys;
    float *rest;     /* [joint_count][3]: translations to the parent at rest */
    double reported; /* of the call's progress, before the keys: a skeleton made for the call goes to 1 by itself */
} sph__rig;

/* --- rig_mesh.c --- */
/* Unit normals of the rest pose, each corner of a triangle as heavy as its angle; (0, 1, 0) where there is no area. */
sph_status sph__rig_put_normals(const sph__rig *rig, sph__io_output *o);
/* How many influences the vertex of most has, as they are written; at least 1. */
uint32_t sph__rig_count_influences(const sph__rig *rig);
void sph__rig_put_joints(const sph__rig *rig, unsigned set, sph__io_output *o);
void sph__rig_put_weights(const sph__rig *rig, unsigned set, sph__io_output *o);

/* --- rig_keys.c --- */
/* Floats of all keys; SPH_E_NOMEM where that overflows. Progress: the first half of what is left of the call's. */
sph_status sph__rig_make_keys(sph__rig *rig);
/* Reports that all frames before the clip's are done, in the half that begins at `half`, 0 or 0.5, of what is left. */
sph_status sph__rig_report(const sph__rig *rig, const char *stage, double half, const sph_skin_clip *clip);
static inline uint32_t sph__rig_root(const sph__rig *rig) /* the joint of no bone; or no joint's number */
{
    return rig->joints.bone_count;
}

/* --- rig_json.c --- */
/* Describes everything; views in the order in which the bytes are written. `uri` as for sph__io_gltf_close_json. */
void sph__rig_describe(const sph__rig *rig, sph__io_gltf_writer *w, const char *uri);
/* Frames per second that a clip is written at. */
double sph__rig_rate(const sph__rig *rig, const sph_skin_clip *clip);

#endif
