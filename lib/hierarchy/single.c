/* SPDX-License-Identifier: MIT */
#include "hierarchy/single.h"

/* Member by member: a copy of all would wait for the last of them to be written. */
static inline void read_region(const sph__builder *b, const sph__slot *slot, sph__region *region)
{
    const float *rows = sph__single_rows(b, (size_t)(slot - b->slots));
    region->block = rows;
    region->radius = (double)rows[SPH__SINGLE_RADIUS];
    region->w = slot->w;
    region->b = slot->b;
    region->c = slot->c;
}

/* Up to eight edges; lanes without one repeat the first. */
static void evaluate_eight(const sph__builder *b, const uint32_t *edges, size_t count, double *costs)
{
    const sph__slot *su[SPH__LANES], *sv[SPH__LANES];
    sph__region us[SPH__LANES], vs[SPH__LANES];
    sph__sums sums[SPH__LANES];
    sph__parabola parabola; /* costs are exact */
    for (size_t l = 0; l < count; ++l) {
        uint32_t nu, nv;
        sph__edge_ends(&b->mesh, edges[l], &nu, &nv);
        su[l] = sph__slot_of(b, nu);
        sv[l] = sph__slot_of(b, nv);
        read_region(b, su[l], &us[l]);
        read_region(b, sv[l], &vs[l]);
    }
    for (size_t l = count; l < SPH__LANES; ++l) {
        us[l].block = us[0].block;
        vs[l].block = vs[0].block;
    }
    sph__kernel_pair_sums(us, vs, count, sums);
    for (size_t l = 0; l < count; ++l)
        costs[l] = sph__evaluate_sums(b, &sums[l], us[l].radius, su[l], sv[l], &b->candidates[edges[l]], &parabola);
}

/* Asks for what later edges read: the vertices of a mesh may be in any order. */
static void ask_for_ends(const sph__builder *b, const uint32_t *edges, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        for (unsigned k = 0; k < 2; ++k) {
            const sph__slot *slot = sph__slot_of(b, b->mesh.edges[edges[i]].ends[k]);
            __builtin_prefetch(slot);
            __builtin_prefetch(sph__single_rows(b, (size_t)(slot - b->slots)));
            sph__prefetch_widths(b, slot);
        }
}

void sph__single_evaluate(const sph__builder *b, const uint32_t *edges, size_t count, double *costs)
{
    for (size_t i = 0; i < count; i += SPH__LANES) {
        if (i + 2 * SPH__LANES <= count) ask_for_ends(b, edges + i + SPH__LANES, SPH__LANES);
        evaluate_eight(b, edges + i, count - i < SPH__LANES ? count - i : SPH__LANES, costs + i);
    }
}

void sph__single_center(const sph__builder *b, uint32_t u, uint32_t v, const sph__candidate *candidate)
{
    sph__region ru, rv;
    read_region(b, sph__slot_of(b, u), &ru);
    read_region(b, sph__slot_of(b, v), &rv);
    sph__kernel_single_center(&ru, &rv, candidate->lambda, (double)candidate->radius, b->new_center);
}

static const float *center_of(const sph__builder *b, uint32_t node)
{
    return sph__single_rows(b, b->mesh.nodes[node].slot) + SPH__SINGLE_CENTER;
}

/* The triangles of `node`, eight at once. */
static bool inverts_around(const sph__builder *b, uint32_t node, uint32_t other, const float *center)
{
    const uint32_t *triangles = sph__triangles_of(&b->mesh, node), count = sph__triangle_count_of(&b->mesh, node);
    const float *own = center_of(b, node), *p[SPH__LANES], *q[SPH__LANES];
    size_t lane = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t x[2];
        sph__triangle_others(&b->mesh, triangles[i], node, x);
        if (x[0] == other || x[1] == other) continue;
        p[lane] = center_of(b, x[0]);
        q[lane] = center_of(b, x[1]);
        if (++lane < SPH__LANES) continue;
        if (sph__kernel_any_inversion(p, q, own, center)) return true;
        lane = 0;
    }
    if (lane == 0) return false;
    for (; lane < SPH__LANES; ++lane) p[lane] = q[lane] = own; /* no triangle: a point, which does not turn */
    return sph__kernel_any_inversion(p, q, own, center);
}

bool sph__single_inverts(const sph__builder *b, uint32_t u, uint32_t v, const float *center)
{
    return inverts_around(b, u, v, center) || inverts_around(b, v, u, center);
}

void sph__single_unite(const sph__builder *b, uint32_t u, uint32_t v, const sph__candidate *candidate)
{
    sph__slot *slot = sph__slot_of(b, u);
    sph__region ru, rv;
    read_region(b, slot, &ru);
    read_region(b, sph__slot_of(b, v), &rv);
    sph__kernel_single_unite(&ru, &rv, b->new_center, (double)candidate->radius, slot->block, &slot->w, &slot->b,
                             &slot->c);
}
