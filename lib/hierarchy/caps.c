/* SPDX-License-Identifier: MIT */
/* Caps of vertices of many triangles; those of the others are made with the leaf: leaves.c. */
#include "hierarchy/caps.h"

SPH__INLINE void subtract(const float *q, const float *p, size_t s, size_t i, sph__v8d e[3])
{
    for (size_t k = 0; k < 3; ++k) {
        if (s == 1) /* a single frame */
            e[k][0] = (double)q[k] - (double)p[k];
        else
            e[k] = sph__load(q, k * s + i) - sph__load(p, k * s + i);
    }
}

/* Eight frames of the sum of angles around v. */
SPH__INLINE void sum_angles(const sph__builder *b, uint32_t v, size_t i, sph__turn *turn)
{
    const size_t s = b->stride;
    const float *p = sph__node_center(b, v);
    sph__turn_start(turn);
    for (size_t c = b->cell_starts[v]; c < b->cell_starts[v + 1]; ++c) {
        const uint32_t *others = b->vertex_cells[c];
        sph__v8d e[3] = {{0}}, f[3] = {{0}}, n[3], cosine, sine, size;
        subtract(sph__node_center(b, others[0]), p, s, i, e);
        subtract(sph__node_center(b, others[1]), p, s, i, f);
        n[0] = e[1] * f[2] - e[2] * f[1];
        n[1] = e[2] * f[0] - e[0] * f[2];
        n[2] = e[0] * f[1] - e[1] * f[0];
        cosine = SPH__DOT(e, f);
        sine = SPH__DOT(n, n);
        sine = sph__root(sine);
        sph__turn_by(&cosine, &sine, turn);
        sph__bring_near_one(&turn->x, &turn->y, &size);
    }
}

SPH__CLONES static double add_cap(const sph__builder *b, uint32_t v, double weight, float *block)
{
    sph__v8d total = {0};
    for (size_t i = 0; i < b->stride; i += SPH__LANES) {
        sph__turn angles;
        sum_angles(b, v, i, &angles);
        sph__add_cap_plane(&angles, weight, block + i * b->leaf_rows, &total);
    }
    return sph__sum(total);
}

double sph__cap_weight(const sph__builder *b, uint32_t v)
{
    const double radius = SPH__CAP_RADIUS * b->h->bounding_diagonal;
    return b->options.importance == SPH_IMPORTANCE_CURVATURE && !b->cell_open[v] ? 2 * radius * radius : 0;
}

double sph__add_cap(const sph__builder *b, uint32_t v, float *block)
{
    const double weight = sph__cap_weight(b, v);
    return weight > 0 ? add_cap(b, v, weight, block) : 0;
}
