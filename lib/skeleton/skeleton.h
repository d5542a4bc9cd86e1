/* SPDX-License-Identifier: MIT */
/* Internal door of the room "skeleton". */
#ifndef SPH_SKELETON_INTERNAL_H
#define SPH_SKELETON_INTERNAL_H

#include <sphmesh/skeleton.h>

#include "base/base.h"
#include "skin/skin.h"

struct sph_skeleton {
    sph_context *context; /* retained */
    uint32_t bone_count, joint_count;
    uint32_t *parents, *order;   /* [joint_count] */
    double *positions;           /* [joint_count][3] */
    double *rest, *inverse_bind; /* [joint_count][12] */
    double *gaps;                /* [joint_count] */
};

/* Two bones, and the joint between them. */
typedef struct sph__bond {
    uint32_t bones[2];
    double position[3], gap;
    double cost; /* squared length; finite */
} sph__bond;

/* --- joint.c --- */
/* Fills in all but the bones. */
void sph__bond_fit(const sph_skin *skin, sph__bond *bond);

/* --- tree.c --- */
/* J - 1 bonds, on which every bone hangs together. */
sph_status sph__tree_span(const sph_skin *skin, sph__progress *progress, sph__bond *bonds);

/* Ways along the bonds of a tree. */
typedef struct sph__walk {
    uint32_t *order;  /* [J]: the start, then each bone after the one before it on the way */
    uint32_t *before; /* [J]: that bone; SPH_NO_JOINT for the start */
    uint32_t *by;     /* [J]: the bond between the two */
    double *way;      /* [J]: length of the way in the rest pose */
} sph__walk;

typedef struct sph__tree {
    const sph_context *context; /* borrowed */
    const sph_skin *skin;       /* borrowed */
    const sph__bond *bonds;     /* borrowed */
    uint32_t *starts, *around;  /* bonds of each bone */
    sph__walk walk;
} sph__tree;

/* Free after failure too. */
sph_status sph__tree_open(sph__tree *tree, const sph_skin *skin, const sph__bond *bonds);
void sph__tree_close(sph__tree *tree);
/* Fills tree->walk. */
void sph__tree_walk_from(sph__tree *tree, uint32_t bone);
/* Uses tree->walk. */
uint32_t sph__tree_center(sph__tree *tree);

#endif
