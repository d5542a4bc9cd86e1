/* SPDX-License-Identifier: MIT */
/* Internal door of the room "pose": the handle laid open, and its kernel. */
#ifndef SPH_POSE_INTERNAL_H
#define SPH_POSE_INTERNAL_H

#include <sphmesh/pose.h>

#include "base/base.h"

/*
 * What the kernel knows of a bone in a pose, in rows of four numbers. Linear: the columns of its transform. Dual
 * quaternions: the columns of what is applied first, then the real and the dual part (x, y, z, w).
 */
enum { SPH__BONE_SIZE = 24, SPH__BONE_REAL = 16, SPH__BONE_DUAL = 20 };

/* Poses that are prepared together, so that few vertices keep many threads busy too. */
enum { SPH__POSE_BATCH = 8 };

struct sph_deformer {
    sph_context *context; /* retained */
    uint32_t vertex_count, bone_count, influence_count;
    float *rest;                     /* [n][3] */
    float *normals;                  /* [n][3]; NULL: there are none */
    uint32_t *bones;                 /* [n][k] */
    float *weights;                  /* [n][k], falling along a vertex's slots */
    double *pivots;                  /* [J][3] */
    double *palette;                 /* [SPH__POSE_BATCH][J][SPH__BONE_SIZE] */
    bool stretched[SPH__POSE_BATCH]; /* whether what is applied first is more than the identity */
};

/* Lays out the transforms of a pose; true where bones do more than turn and move. */
bool sph__pose_prepare(const sph_deformer *deformer, const double *transforms, int32_t method, double *palette);

/* Vertices begin .. end - 1 of one pose. Any output may be NULL. */
void sph__pose_kernel_linear(const sph_deformer *deformer, const double *palette, size_t begin, size_t end,
                             float *positions, float *normals);
void sph__pose_kernel_dual(const sph_deformer *deformer, const double *palette, bool stretched, size_t begin,
                           size_t end, float *positions, float *normals);

#endif
