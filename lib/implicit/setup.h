/* SPDX-License-Identifier: MIT */
/* What the making of a set-up shares between its files. */
#ifndef SPH_IMPLICIT_SETUP_H
#define SPH_IMPLICIT_SETUP_H

#include "implicit/implicit.h"
#include "implicit/shell.h"

/* Where the meshes of two joined parts meet. */
typedef struct sph__opening {
    uint32_t corner_count; /* 0: they do not */
    double center[3];      /* of what the part is closed about: the joint, or the opening's middle where that is far */
    double distance;       /* of the nearest node of both parts */
    double reach;          /* of the farthest corner of a triangle of both */
} sph__opening;

typedef struct sph__setup {
    const sph_skin *skin;
    const sph_implicit_options *options;
    sph_implicit *implicit;
    sph__shell shell;
    uint32_t *owners; /* [t]: the part of a triangle */
    size_t *starts;   /* [J + 1]: a part's triangles in `members` */
    uint32_t *members;
    size_t *node_starts;        /* [J + 1]: a part's nodes */
    double *signs;              /* [node_count]: -1 where the mesh is wound inside out */
    sph_implicit_joint *joints; /* in order of their bones */
    uint32_t joint_count;
    uint32_t *upper;        /* [joint_count]: which of a joint's bones hangs on the other; SPH__NO_PART: neither */
    sph__opening *openings; /* [joint_count] */
    bool out_of_memory;
} sph__setup;

/* --- parts.c --- */
sph_status sph__setup_parts(sph__setup *setup);
/* --- joints.c --- */
sph_status sph__setup_joints(sph__setup *setup);
/* --- samples.c: the fields of bones begin .. end - 1 --- */
void sph__setup_fields(void *setup, size_t begin, size_t end);

#endif
