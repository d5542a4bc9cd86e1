/* SPDX-License-Identifier: MIT */
/* The mesh of a skin with its seams closed: vertices that share a place and weights at rest are one node. */
#ifndef SPH_IMPLICIT_SHELL_H
#define SPH_IMPLICIT_SHELL_H

#include "base/base.h"
#include "skin/skin.h"

typedef struct sph__shell {
    const sph_context *context; /* borrowed */
    uint32_t vertex_count, node_count;
    uint32_t *nodes; /* [n]: of a vertex */
    uint32_t
        *vertices;   /* [node_count]: the lowest of each; nodes are in order of parts, and near ones near each other */
    uint32_t *parts; /* [node_count] */
    float *rest;     /* [node_count][3] */
    size_t triangle_count;
    uint32_t *triangles; /* [t][3] of nodes, with three different ones; in the skin's order */
    double *normals;     /* [node_count][3]: each triangle as heavy as its area; 0 where there are none */
    size_t *starts;      /* [node_count + 1]: of the nodes around a node */
    uint32_t *ring;      /* rising */
    float *shares;       /* mean value coordinates of a node in its ring, by `ring`; all 0 where there are none */
    double diagonal;     /* of the box around the rest pose */
} sph__shell;

/* `parts` may be NULL: those of the largest weights. Free after failure too. */
sph_status sph__shell_init(sph__shell *shell, const sph_skin *skin, const uint32_t *parts);
void sph__shell_free(sph__shell *shell);

/* --- coordinates.c --- */
sph_status sph__shell_find_shares(sph__shell *shell);

#endif
